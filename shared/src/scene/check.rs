//! Checks of values against each other; the range of each single value is in [`FIELDS`](super::FIELDS).

use super::{Scene, WindBoundary};

/// Largest side of the world (m): up to here a coordinate in single precision resolves 1 cm.
pub const EXTENT_LIMIT_M: f32 = 100_000.0;

/// Most cells of the bend field that may hold memory at once, about 1 GB.
pub const AWAKE_CELLS_LIMIT: u64 = 1 << 25;

/// Most cells of the wind's box.
pub const WIND_CELLS_LIMIT: u64 = 1 << 21;

/// Values that are fine by themselves and do not fit together.
pub(super) struct Misfit {
    /// Paths of the fields that take part; the message is about the first.
    pub(super) fields: &'static [&'static str],
    /// What is wrong.
    pub(super) message: String,
}

/// What does not fit together in `scene`.
pub(super) fn cross_checks(scene: &Scene) -> Vec<Misfit> {
    let mut misfits = Vec::new();
    let mut note = |fields, message| misfits.push(Misfit { fields, message });
    let Scene { patches, wind, objects, .. } = scene;

    if !patches.cells.is_multiple_of(8) {
        note(&["patches.cells"], format!("is {}; allowed: a multiple of 8", patches.cells));
    }
    let [width_m, depth_m] = scene.extent_m();
    if width_m.max(depth_m) > EXTENT_LIMIT_M {
        let message = format!("makes a world of {width_m} m × {depth_m} m; allowed: count × cells × cell_m up to {EXTENT_LIMIT_M} m");
        note(&["patches.count", "patches.cells", "patches.cell_m"], message);
    }
    let awake_cells = u64::from(patches.awake_limit) * u64::from(patches.cells) * u64::from(patches.cells);
    if awake_cells > AWAKE_CELLS_LIMIT {
        let message = format!(
            "lets {} patches of {}² cells be awake, {awake_cells} in all; allowed: {AWAKE_CELLS_LIMIT}",
            patches.awake_limit, patches.cells
        );
        note(&["patches.awake_limit", "patches.cells"], message);
    }

    let [nx, ny, nz] = wind.cells;
    let wind_cells = u64::from(nx) * u64::from(ny) * u64::from(nz);
    if wind_cells > WIND_CELLS_LIMIT {
        note(&["wind.cells"], format!("has {wind_cells} cells in all; allowed: {WIND_CELLS_LIMIT}"));
    }
    if u64::from(wind.sources) > wind_cells {
        note(&["wind.sources", "wind.cells"], format!("is {}, more than the {wind_cells} cells of the wind's box", wind.sources));
    }
    let [east, south] = wind.mean_m_per_s.map(f64::from);
    let speed = (east * east + south * south).sqrt();
    if speed > 40.0 {
        note(&["wind.mean_m_per_s"], format!("has a length of {speed:.1} m/s; allowed: up to 40"));
    }
    let box_m = [nx as f32 * wind.spacing_m[0], nz as f32 * wind.spacing_m[2]];
    if wind.sides == WindBoundary::Wall && (box_m[0] < width_m || box_m[1] < depth_m) {
        let message = format!(
            "is \"wall\", which needs a box that covers the world of {width_m} m × {depth_m} m, and cells × spacing_m is {} m × {} m; \
             make it larger or use \"wrap\"",
            box_m[0], box_m[1]
        );
        note(&["wind.sides", "wind.cells", "wind.spacing_m", "patches.count", "patches.cells", "patches.cell_m"], message);
    }

    if wind.sides == WindBoundary::Wall && wind.mean_m_per_s != [0.0; 2] {
        let message = format!(
            "is {:?}; allowed with walls: [0, 0], since nothing blows through a wall. Or use `sides = \"wrap\"`",
            wind.mean_m_per_s
        );
        note(&["wind.mean_m_per_s", "wind.sides"], message);
    }

    if objects.self_driving > objects.limit {
        let message = format!("is {}; allowed: up to `objects.limit`, {}", objects.self_driving, objects.limit);
        note(&["objects.self_driving", "objects.limit"], message);
    }
    misfits
}
