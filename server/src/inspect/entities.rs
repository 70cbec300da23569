//! The entities of a recording: one table of their paths, archetypes, units, rates and precision.
//!
//! The recording takes its paths and rates from [`ENTITIES`]; the table in `server/README.md` shows it, and a test compares it with a file.

/// A quantity that is recorded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Entity {
    World,
    Ground,
    WindArrows,
    Streamlines,
    Objects,
    Outlines,
    Footprints,
    Velocities,
    Contacts,
    Trails,
    Map,
    MapScale,
    MapBend,
    MapObjects,
    Land,
    LandHeight,
    LandCover,
    WindVelocity,
    WindGround,
    WindSection,
    WindVorticity,
    WindDivergence,
    WindGusts,
    WindDust,
    BendAngle,
    BendVelocity,
    BendActivity,
    BendEvictions,
    Decisions,
    Events,
    Metrics,
}

/// Default rate of an entity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Rate {
    /// Once, at the start, on no timeline.
    Once,
    /// When it happens.
    Event,
    /// At most so many times per simulated second.
    Hz(f64),
}

/// A row of the table.
#[derive(Debug)]
#[cfg_attr(not(test), allow(dead_code, reason = "tests compare the whole row with the README and with recordings"))]
pub(super) struct Row {
    pub(super) entity: Entity,
    pub(super) path: &'static str,
    /// Type in rerun.
    pub(super) archetype: &'static str,
    /// Unit; empty where there is none.
    pub(super) unit: &'static str,
    /// Meaning, one line of Markdown.
    pub(super) meaning: &'static str,
    pub(super) rate: Rate,
    /// Precision, in Markdown.
    pub(super) precision: &'static str,
}

const fn row(
    entity: Entity,
    (path, archetype, unit): (&'static str, &'static str, &'static str),
    rate: Rate,
    precision: &'static str,
    meaning: &'static str,
) -> Row {
    Row { entity, path, archetype, unit, meaning, rate, precision }
}

/// Rate of entities that are recorded in every frame of a file.
const EACH_FRAME: Rate = Rate::Hz(10.0);
/// Rate of a volume of the wind (Hz).
const VOLUME: Rate = Rate::Hz(0.2);
/// Rate of the exact bend field (Hz).
const FIELD: Rate = Rate::Hz(0.1);

const WIND_STEP: &str = "exact: code × 2 `stream.wind_error_m_per_s`, f32";
const FROM_CODES: &str = "f32, from the exact codes";
const F32: &str = "f32";

/// Every entity, in the order of [`Entity`].
pub(super) const ENTITIES: &[Row] = &[
    row(Entity::World, ("world", "ViewCoordinates", ""), Rate::Once, "", "axes: X east, Y up, Z south, in metres"),
    row(
        Entity::Ground,
        ("world/ground", "Mesh3D", "m"),
        EACH_FRAME,
        "at most 192 × 192 vertices; colours as `map/bend`",
        "terrain, textured with the bending angles",
    ),
    row(
        Entity::WindArrows,
        ("world/wind", "Arrows3D", "m"),
        EACH_FRAME,
        "at most 1500 arrows",
        "wind: the length is the distance covered in 1.2 s, the colour is the speed",
    ),
    row(
        Entity::Streamlines,
        ("world/streamlines", "LineStrips3D", "m"),
        Rate::Hz(1.0),
        "RK4 with steps of half a cell",
        "streamlines of the resolved wind, seeded in the lowest cells",
    ),
    row(Entity::Objects, ("world/objects", "Boxes3D", "m"), EACH_FRAME, F32, "boxes of the objects with name and speed"),
    row(
        Entity::Outlines,
        ("world/outlines", "LineStrips3D", "m"),
        EACH_FRAME,
        "poses as rounded for the grass",
        "edges of the prisms in which objects touch grass",
    ),
    row(
        Entity::Footprints,
        ("world/footprints", "LineStrips3D", "m"),
        EACH_FRAME,
        "poses as rounded for the grass",
        "floors of those prisms that are lower than the grass, on the terrain",
    ),
    row(Entity::Velocities, ("world/velocities", "Arrows3D", "m"), EACH_FRAME, F32, "velocities of the objects: the way in 1 s"),
    row(
        Entity::Contacts,
        ("world/contacts", "Arrows3D", "m"),
        EACH_FRAME,
        "poses as rounded for the grass",
        "velocities of the corners of the footprints in the newest step: the way in 1 s",
    ),
    row(Entity::Trails, ("world/trails", "LineStrips3D", "m"), EACH_FRAME, "points 0.2 m apart", "trails of the objects, the last seconds"),
    row(Entity::Map, ("map", "AnnotationContext", "°"), Rate::Once, "", "names and colours of the classes of `map/bend`"),
    row(Entity::MapScale, ("map/scale", "LineStrips2D", "°"), Rate::Once, "", "colour scale of the angles"),
    row(
        Entity::MapBend,
        ("map/bend", "SegmentationImage", "90/127 °"),
        EACH_FRAME,
        "7 bits; the largest angle of the cells below a pixel, at most 512 × 512 pixels",
        "bending angles, wind included, from above",
    ),
    row(Entity::MapObjects, ("map/objects", "Points2D", "pixels"), EACH_FRAME, F32, "positions of the objects on the map"),
    row(Entity::Land, ("land", "AnnotationContext", ""), Rate::Once, "", "names of the covering IDs"),
    row(
        Entity::LandHeight,
        ("land/height", "DepthImage", "m"),
        Rate::Once,
        "exact, f32",
        "heights of the land, the pixels of the height map",
    ),
    row(
        Entity::LandCover,
        ("land/cover", "SegmentationImage", "ID"),
        Rate::Once,
        "exact, 8 bits",
        "covering map: species, trees, stones and gaps",
    ),
    row(Entity::WindVelocity, ("wind/velocity", "Tensor", "m/s"), VOLUME, WIND_STEP, "wind (u, v, w) at the cell centres"),
    row(
        Entity::WindGround,
        ("wind/ground", "DepthImage", "m/s"),
        Rate::Hz(1.0),
        FROM_CODES,
        "speed in the lowest cells, north up: a horizontal slice",
    ),
    row(
        Entity::WindSection,
        ("wind/section", "DepthImage", "m/s"),
        Rate::Hz(1.0),
        FROM_CODES,
        "speed in the vertical slice along X through the middle of the box, the top layer first",
    ),
    row(
        Entity::WindVorticity,
        ("wind/vorticity", "Tensor", "1/s"),
        VOLUME,
        "f32; central differences, second order",
        "vorticity (X, Y, Z) of the streamed wind",
    ),
    row(
        Entity::WindDivergence,
        ("wind/divergence", "Tensor", "1/s"),
        VOLUME,
        "f32; central differences, second order",
        "divergence of the streamed wind between cell centres, which is not that of the solver's faces",
    ),
    row(
        Entity::WindGusts,
        ("wind/gusts", "Tensor", "m/s"),
        Rate::Hz(1.0),
        F32,
        "gusts (u, w) that the cells do not resolve, at the cell centres, the same at all heights",
    ),
    row(
        Entity::WindDust,
        ("wind/dust", "Tensor", "1"),
        VOLUME,
        "exact: (code × `stream.dust_error`)², f32",
        "concentration of dust, in scenes that release it",
    ),
    row(
        Entity::BendAngle,
        ("bend/angle", "DepthImage", "rad"),
        FIELD,
        "exact: code × 2 `stream.theta_error_deg`, f32; at most 512 × 512 cells about the start",
        "bending angle of the bend field and of laid grass, without the lean in the wind",
    ),
    row(
        Entity::BendVelocity,
        ("bend/velocity", "Tensor", "rad/s"),
        FIELD,
        "exact: ±(code × `stream.omega_error_rad_per_s`)², f32; at most 512 × 512 cells about the start",
        "bending velocity (ωx, ωz)",
    ),
    row(
        Entity::BendActivity,
        ("bend/activity", "DepthImage", "rad², rad²/s²"),
        Rate::Hz(1.0),
        "f32; at most 512 × 512 patches about the start",
        "sum of θ² + ω² of each patch; 0 in patches at rest",
    ),
    row(
        Entity::BendEvictions,
        ("bend/evictions", "DepthImage", "1"),
        Rate::Hz(1.0),
        "exact counts as f32; at most 512 × 512 patches about the start",
        "how often each patch was put to sleep because too many were awake, since the recording began",
    ),
    row(Entity::Decisions, ("decisions", "TextLog", ""), Rate::Event, "", "changes of the detail of the simulation, each with its reason"),
    row(Entity::Events, ("events", "TextLog", ""), Rate::Event, "", "objects that join and leave, patches evicted, tracks discarded"),
    row(Entity::Metrics, ("metrics", "Scalars", "of the plot"), EACH_FRAME, "f64", "`metrics/PLOT/METRIC`: the metrics of the plots"),
];

impl Entity {
    /// Its row.
    pub(super) fn row(self) -> &'static Row {
        &ENTITIES[self as usize]
    }

    /// Its path.
    pub(super) fn path(self) -> &'static str {
        self.row().path
    }

    /// The entity with a path of the table.
    pub(super) fn named(path: &str) -> Option<Self> {
        ENTITIES.iter().find(|row| row.path == path).map(|row| row.entity)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    /// A line of the README's table.
    fn markdown(row: &Row) -> String {
        let rate = match row.rate {
            Rate::Once => "once".to_owned(),
            Rate::Event => "event".to_owned(),
            Rate::Hz(hz) => hz.to_string(),
        };
        format!("| `{}` | {} | {} | {} | {rate} | {} |\n", row.path, row.archetype, row.meaning, row.unit, row.precision)
    }

    #[test]
    fn rows_are_in_the_order_of_the_entities_with_paths_of_their_own() {
        for (at, row) in ENTITIES.iter().enumerate() {
            assert_eq!(row.entity as usize, at, "{}", row.path);
            assert_eq!(Entity::named(row.path), Some(row.entity));
        }
        assert_eq!(ENTITIES.iter().map(|row| row.path).collect::<BTreeSet<_>>().len(), ENTITIES.len());
        assert_eq!(Entity::Metrics as usize + 1, ENTITIES.len());
    }

    #[test]
    fn the_readme_lists_every_entity() {
        let rows: String = ENTITIES.iter().map(markdown).collect();
        assert!(include_str!("../../README.md").contains(&rows), "server/README.md must hold these rows:\n{rows}");
    }
}
