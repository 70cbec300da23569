//! Allowed values of every field of a scene file, in one table for the parser, the reference in the README and its tests.

use super::accuracy::CELLS;
use super::objects::OBJECT_FIELDS;
use super::{
    BladeIntegrator, BladeShape, COMPONENTS_LIMIT, ComponentKind, FlowerShape, GATES_LIMIT, LAMPS_LIMIT, LagWay, MODEL_SIDE_M,
    MODELS_LIMIT, ObjectContact, PlantCover, PrimitiveIntensity, PrimitiveKind, SPECIES_LIMIT, ShellExtrusion, TreeShape, WindAdvection,
    WindBoundary, WindDiffusion, WindMethod, WindPressure, WindTerrain, WindTiling, WindTime,
};
use crate::bend::{Edges, GroundContact, Scheme, Seams};
use crate::lod::shells::LAYERS_LIMIT;
use crate::plant::underbrush::plan::SECTIONS_LIMIT;
use std::fmt;

/// Values that a field may hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Allowed {
    /// Any text.
    Text,
    /// Text that is not blank.
    Name,
    /// A number from the first to the second, both included; in an array, each element.
    Range(f64, f64),
    /// One of these words.
    OneOf(&'static [&'static str]),
    /// A list with a number of sections in this range.
    Sections(usize, usize),
    /// A list of points [x, z]: range of their number, then range of each coordinate.
    Places(usize, usize, f64, f64),
    /// A list of points [secs, intensity] of a function of time: range of their number, then range of the times and range of the intensities.
    Course(usize, usize, [f64; 2], [f64; 2]),
}

use Allowed::{Course, Name, OneOf, Places, Range, Sections, Text};

/// Every field by its path, in the order of the structs; for a list of sections, the fields of one section. For `species` only its own fields are
/// listed; the others are as in `grass` and `plants`, see [`Allowed::at`].
pub static FIELDS: [(&str, Allowed); BEFORE_OBJECTS.len() + OBJECT_FIELDS.len() + AFTER_OBJECTS.len()] =
    joined(&[BEFORE_OBJECTS, OBJECT_FIELDS, AFTER_OBJECTS]);

const BEFORE_OBJECTS: &[(&str, Allowed)] = &[
    ("summary", Text),
    ("seed", Range(0.0, i64::MAX as f64)),
    ("tick_hz", Range(10.0, 240.0)),
    ("species", Sections(0, 16)),
    ("underbrush_file", Text),
    ("underbrush", Sections(0, SPECIES_LIMIT)),
    ("models", Sections(0, MODELS_LIMIT)),
    ("drawn_winds", Sections(0, 16)),
    ("lights", Sections(0, LAMPS_LIMIT)),
    ("patches.count", Range(1.0, 2048.0)),
    ("patches.cells", Range(8.0, 256.0)),
    ("patches.cell_m", Range(0.05, 10.0)),
    ("patches.awake_limit", Range(9.0, 4096.0)),
    ("terrain.height_map", Text),
    ("terrain.covering_map", Text),
    ("terrain.pixel_m", Range(0.01, 1000.0)),
    ("terrain.level_m", Range(0.0, 1000.0)),
    ("terrain.base_m", Range(-12000.0, 12000.0)),
    ("wind.cells", Range(2.0, 256.0)),
    ("wind.spacing_m", Range(0.1, 1000.0)),
    ("wind.tiling", OneOf(WindTiling::WORDS)),
    ("wind.terrain", OneOf(WindTerrain::WORDS)),
    ("wind.mean_m_per_s", Range(-40.0, 40.0)),
    ("wind.reference_height_m", Range(0.0, 1000.0)),
    ("wind.mean_rate_per_s", Range(0.0, 10.0)),
    ("wind.viscosity_m2_per_s", Range(0.0, 100.0)),
    ("wind.canopy_drag_per_m", Range(0.0, 10.0)),
    ("wind.canopy_frequency_hz", Range(0.0, 20.0)),
    ("wind.canopy_damping_ratio", Range(0.0, 2.0)),
    ("wind.canopy_mass_kg_per_m2", Range(0.01, 100.0)),
    ("wind.crown_drag_per_m", Range(0.0, 10.0)),
    ("wind.body_force_m_per_s2", Range(-1.0, 1.0)),
    ("wind.sources", Range(0.0, 1000.0)),
    ("wind.source_m_per_s", Range(0.0, 40.0)),
    ("wind.source_radius_m", Range(0.0, 1000.0)),
    ("wind.turbulence", Range(0.0, 3.0)),
    ("wind.turbulence_below_m", Range(0.0, 10_000.0)),
    ("wind.step_secs", Range(0.004, 0.5)),
    ("wind.warm_up_secs", Range(0.0, 60.0)),
    ("wind.method", OneOf(WindMethod::WORDS)),
    ("wind.advection", OneOf(WindAdvection::WORDS)),
    ("wind.time", OneOf(WindTime::WORDS)),
    ("wind.diffusion", OneOf(WindDiffusion::WORDS)),
    ("wind.diffusion_sweeps", Range(1.0, 1000.0)),
    ("wind.pressure", OneOf(WindPressure::WORDS)),
    ("wind.pressure_tolerance", Range(1e-12, 0.1)),
    ("wind.pressure_sweeps", Range(1.0, 100_000.0)),
    ("wind.primitives", Sections(0, 64)),
    ("wind.faces.west", OneOf(WindBoundary::WORDS)),
    ("wind.faces.east", OneOf(WindBoundary::WORDS)),
    ("wind.faces.bottom", OneOf(WindBoundary::WORDS)),
    ("wind.faces.top", OneOf(WindBoundary::WORDS)),
    ("wind.faces.north", OneOf(WindBoundary::WORDS)),
    ("wind.faces.south", OneOf(WindBoundary::WORDS)),
    ("wind.faces.lid_m_per_s", Range(-40.0, 40.0)),
    ("wind.dust.release_per_s", Range(0.0, 100.0)),
    ("wind.dust.settling_per_s", Range(0.0, 100.0)),
    ("wind.dust.diffusivity_m2_per_s", Range(0.0, 100.0)),
    ("wind.dust.advection", OneOf(WindAdvection::WORDS)),
    ("wind.primitives.kind", OneOf(PrimitiveKind::WORDS)),
    ("wind.primitives.at_m", Range(0.0, 100_000.0)),
    ("wind.primitives.radius_m", Range(0.1, 100_000.0)),
    ("wind.primitives.speed_m_per_s", Range(0.0, 40.0)),
    ("wind.primitives.heading_rad", Range(-6.3, 6.3)),
    ("wind.primitives.drift_m_per_s", Range(-40.0, 40.0)),
    ("wind.primitives.dust", Range(0.0, 1.0)),
    ("wind.primitives.intensity", OneOf(PrimitiveIntensity::WORDS)),
    ("wind.primitives.attack_secs", Range(0.0, 3600.0)),
    ("wind.primitives.hold_secs", Range(0.0, 3600.0)),
    ("wind.primitives.fall_secs", Range(0.0, 3600.0)),
    ("wind.primitives.period_secs", Range(0.0, 86_400.0)),
    ("wind.primitives.intensity_points", Course(0, 32, [0.0, 86_400.0], [-2.0, 2.0])),
    ("wind.primitives.front_m_per_s", Range(0.0, 1000.0)),
    ("wind.primitives.step_m", Range(0.0, 1000.0)),
    ("natural_wind.strength_rad_per_s2", Range(0.0, 20.0)),
    ("natural_wind.scale_m", Range(8.0, 1000.0)),
    ("natural_wind.drift_m_per_s", Range(-40.0, 40.0)),
    ("natural_wind.reach_m", Range(0.0, 500.0)),
    ("rain.rate_mm_per_h", Range(0.0, 200.0)),
    ("snow.depth_m", Range(0.0, 2.0)),
    ("snow.density_kg_m3", Range(30.0, 600.0)),
    ("snow.pressed_density_kg_m3", Range(30.0, 900.0)),
    ("snow.pushed_share", Range(0.0, 1.0)),
    ("snow.repose_deg", Range(10.0, 80.0)),
    ("snow.fall_m_per_h", Range(0.0, 0.5)),
    ("snow.leaf_load_kg_m2", Range(0.0, 5.0)),
    ("bend.scheme", OneOf(Scheme::WORDS)),
    ("bend.seams", OneOf(Seams::WORDS)),
    ("bend.edges", OneOf(Edges::WORDS)),
    ("bend.rest_theta_rad", Range(0.0, 0.1)),
    ("bend.rest_omega_rad_per_s", Range(0.0, 2.0)),
    ("bend.ground_contact", OneOf(GroundContact::WORDS)),
    ("bend.object_contact", OneOf(ObjectContact::WORDS)),
    ("grass.c0_m_per_s", Range(0.0, 50.0)),
    ("grass.mu_m_per_rad", Range(0.0, 10.0)),
    ("grass.c_omega_m_per_s", Range(0.0, 50.0)),
    ("grass.theta_damping_per_s", Range(0.0, 200.0)),
    ("grass.omega_damping_per_s", Range(0.0, 200.0)),
    ("grass.stiffness_per_s2", Range(0.0, 10000.0)),
    ("grass.theta_max_rad", Range(0.1, 1.57)),
    ("grass.wind_bend_rad", Range(0.0, 1.5)),
    ("grass.lag_secs", Range(0.0, 1.0)),
    ("grass.recovery_lag_share", Range(0.0, 1.0)),
    ("grass.segments", Range(1.0, 6.0)),
    ("grass.laid_recovery_secs", Range(0.5, 86_400.0)),
    ("plants.cover", OneOf(PlantCover::WORDS)),
    ("plants.grid_m", Range(1.0, 64.0)),
    ("plants.plants_per_side", Range(2.0, 256.0)),
    ("plants.near_ratio", Range(1.0, 5.0)),
    ("plants.blade_segments", Range(0.0, 12.0)),
    ("plants.highest_detail", Range(0.0, 3.0)),
    ("plants.height_m", Range(0.02, 5.0)),
    ("plants.height_variation", Range(0.0, 0.9)),
    ("plants.width_m", Range(0.001, 0.5)),
    ("plants.flowers_per_m2", Range(0.0, 50.0)),
    ("plants.root_rgb", Range(0.0, 1.0)),
    ("plants.tip_rgb", Range(0.0, 1.0)),
    ("plants.tree_m", Range(0.5, 60.0)),
    ("plants.stone_m", Range(0.05, 20.0)),
    ("plants.lag", OneOf(LagWay::WORDS)),
    ("plants.blade_shape", OneOf(BladeShape::WORDS)),
    ("plants.flower_shape", OneOf(FlowerShape::WORDS)),
    ("plants.tree_shape", OneOf(TreeShape::WORDS)),
    ("plants.swing_hz", Range(0.05, 50.0)),
    ("plants.swing_damping", Range(0.005, 5.0)),
    ("plants.integrator", OneOf(BladeIntegrator::WORDS)),
    ("shells.layers", Range(1.0, LAYERS_LIMIT as f64)),
    ("shells.slices", Range(1.0, 32.0)),
    ("shells.blades_per_m2", Range(100.0, 40_000.0)),
    ("shells.root_light", Range(0.0, 1.0)),
    ("shells.extrusion", OneOf(ShellExtrusion::WORDS)),
    ("shells.stiffness_profile", Range(-0.9, 4.0)),
    ("species.name", Name),
    ("species.cover", Range(1.0, 252.0)),
    ("underbrush.name", Name),
    ("underbrush.cover", Range(0.0, 252.0)),
    ("underbrush.settle_secs", Range(0.0, 10.0)),
    ("underbrush.posture_angles", Range(2.0, 65.0)),
    ("underbrush.posture_loads", Range(2.0, 65.0)),
    ("underbrush.size_variation", Range(0.0, 0.9)),
    ("underbrush.room_m", Range(0.05, 20.0)),
    ("underbrush.reach_m", Range(0.0, 50.0)),
    ("underbrush.propagation_points", Range(0.0, 10_000.0)),
    ("underbrush.needs", Range(0.0, 1.0)),
    ("underbrush.uptake", Range(0.0, 1.0)),
    ("underbrush.light_need", Range(0.0, 1.0)),
    ("underbrush.components", Sections(1, COMPONENTS_LIMIT)),
    ("underbrush.components.name", Name),
    ("underbrush.components.kind", OneOf(ComponentKind::WORDS)),
    ("underbrush.components.on", Text),
    ("underbrush.components.count", Range(1.0, 32.0)),
    ("underbrush.components.from_share", Range(0.0, 1.0)),
    ("underbrush.components.to_share", Range(0.0, 1.0)),
    ("underbrush.components.length_m", Range(0.005, 5.0)),
    ("underbrush.components.length_variation", Range(0.0, 0.9)),
    ("underbrush.components.width_m", Range(0.0005, 1.0)),
    ("underbrush.components.petals", Range(3.0, 16.0)),
    ("underbrush.components.sections", Range(1.0, SECTIONS_LIMIT as f64)),
    ("underbrush.components.mass_kg", Range(1e-6, 10.0)),
    ("underbrush.components.stiffness_n_m2", Range(1e-9, 1000.0)),
    ("underbrush.components.tip_stiffness_share", Range(0.01, 1.0)),
    ("underbrush.components.strength_n_m", Range(0.0, 10_000.0)),
    ("underbrush.components.angle_rad", Range(0.0, 3.1)),
    ("underbrush.components.angle_variation_rad", Range(0.0, 1.5)),
    ("underbrush.components.turn_rad", Range(-6.3, 6.3)),
    ("underbrush.components.root_rgb", Range(0.0, 1.0)),
    ("underbrush.components.tip_rgb", Range(0.0, 1.0)),
    ("growth.nutrient_map", Text),
    ("growth.richness", Range(0.0, 1.0)),
    ("growth.patch_m", Range(1.0, 1000.0)),
    ("growth.spacing_m", Range(0.05, 20.0)),
    ("growth.shade", Range(0.0, 1.0)),
    ("models.name", Name),
    ("models.cover", Range(1.0, 252.0)),
    ("models.model", Name),
    ("models.size_m", Range(0.0, MODEL_SIDE_M[1] as f64)),
    ("models.size_variation", Range(0.0, 0.5)),
    ("models.heading_rad", Range(-6.3, 6.3)),
    ("models.heading_variation_rad", Range(0.0, 3.15)),
    ("models.apart_m", Range(0.0, 1000.0)),
];

const AFTER_OBJECTS: &[(&str, Allowed)] = &[
    ("drawn_winds.shape", Text),
    ("drawn_winds.path_m", Places(1, 64, 0.0, 100_000.0)),
    ("drawn_winds.travel_m_per_s", Range(0.0, 60.0)),
    ("drawn_winds.turns_per_s", Range(-10.0, 10.0)),
    ("drawn_winds.radius_m", Range(0.5, 500.0)),
    ("drawn_winds.speed_m_per_s", Range(0.0, 60.0)),
    ("drawn_winds.bend_rad", Range(0.0, 1.5)),
    ("drawn_winds.strike_height_m", Range(0.05, 5.0)),
    ("drawn_winds.height_m", Range(0.0, 30.0)),
    ("race.laps", Range(1.0, 99.0)),
    ("race.light_period_secs", Range(0.0, 3600.0)),
    ("race.gates", Sections(0, GATES_LIMIT)),
    ("race.gates.at_m", Range(0.0, 100_000.0)),
    ("race.gates.heading_rad", Range(-6.3, 6.3)),
    ("race.gates.width_m", Range(6.0, 100.0)),
    ("camera.at", Range(0.0, 1.0)),
    ("camera.height_m", Range(0.02, 2000.0)),
    ("camera.heading_rad", Range(-6.3, 6.3)),
    ("camera.pitch_rad", Range(-1.5, 1.5)),
    ("light.sun_heading_rad", Range(-6.3, 6.3)),
    ("light.sun_elevation_rad", Range(-0.1, 1.57)),
    ("light.hour", Range(-1.0, 24.0)),
    ("light.latitude_deg", Range(-90.0, 90.0)),
    ("light.day_of_year", Range(1.0, 366.0)),
    ("light.day_length_secs", Range(0.0, 1_000_000.0)),
    ("light.haze_m", Range(10.0, 100_000.0)),
    ("light.mist_m", Range(0.0, 100_000.0)),
    ("light.mist_height_m", Range(0.5, 200.0)),
    ("lights.at_m", Range(-100_000.0, 100_000.0)),
    ("lights.rgb", Range(0.0, 1.0)),
    ("lights.candela", Range(0.0, 1_000_000.0)),
    ("lights.attenuation", Range(0.0, 100.0)),
    ("stream.theta_error_deg", Range(0.05, 5.0)),
    ("stream.omega_error_rad_per_s", Range(0.01, 1.0)),
    ("stream.wind_error_m_per_s", Range(0.01, 1.0)),
    ("stream.dust_error", Range(0.005, 0.5)),
    ("accuracy.wind", Text),
    ("accuracy.bend", Text),
    ("accuracy.blades", Text),
    ("accuracy.picture", Range(0.0, 1.0)),
    ("accuracy.cells", OneOf(CELLS)),
    ("budget.server_ms", Range(0.0, 1000.0)),
    ("budget.client_ms", Range(0.0, 1000.0)),
    ("budget.kbit_per_s", Range(0.0, 1_000_000.0)),
];

/// Fields that a scene file must contain; for a list of sections, each section of it.
pub const REQUIRED: [&str; 22] = [
    "summary",
    "terrain",
    "terrain.height_map",
    "terrain.covering_map",
    "terrain.pixel_m",
    "terrain.level_m",
    "wind.primitives.kind",
    "wind.primitives.at_m",
    "species.name",
    "species.cover",
    "underbrush.name",
    "underbrush.components",
    "underbrush.components.name",
    "underbrush.components.kind",
    "models.name",
    "models.cover",
    "models.model",
    "drawn_winds.shape",
    "drawn_winds.path_m",
    "race.gates.at_m",
    "race.gates.heading_rad",
    "lights.at_m",
];

/// The tables one after another.
const fn joined<const N: usize>(tables: &[&[(&'static str, Allowed)]]) -> [(&'static str, Allowed); N] {
    let mut all = [("", Text); N];
    let (mut table, mut row, mut n) = (0, 0, 0);
    while n < N {
        if row < tables[table].len() {
            all[n] = tables[table][row];
            (row, n) = (row + 1, n + 1);
        } else {
            (table, row) = (table + 1, 0);
        }
    }
    all
}

impl Allowed {
    /// Allowed values of the field at `path`; text for an unknown path. Fields that `species` shares with `grass` and `plants` have the same range.
    pub fn at(path: &str) -> Self {
        let listed = |path: &str| FIELDS.iter().find(|(known, _)| *known == path).map(|&(_, allowed)| allowed);
        let shared = || {
            let field = path.strip_prefix("species.")?;
            ["grass", "plants"].iter().find_map(|section| listed(&format!("{section}.{field}")))
        };
        listed(path).or_else(shared).unwrap_or(Text)
    }

    /// Allowed values of an element of a list, or of the coordinate `n` of a point.
    pub(super) fn of_element(self, n: usize) -> Self {
        match self {
            Places(_, _, low, high) => Range(low, high),
            Course(_, _, secs, intensity) => {
                let [low, high] = if n == 0 { secs } else { intensity };
                Range(low, high)
            }
            other => other,
        }
    }

    /// Whether a number is in the range; false for anything but a range.
    pub(super) fn contains(self, value: f64) -> bool {
        matches!(self, Range(low, high) if (low..=high).contains(&value))
    }

    /// Whether a text is allowed.
    pub(super) fn admits(self, text: &str) -> bool {
        match self {
            OneOf(words) => words.contains(&text),
            Name => !text.trim().is_empty(),
            _ => true,
        }
    }
}

impl fmt::Display for Allowed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Text => f.write_str("text in quotes"),
            Name => f.write_str("a name in quotes, not empty"),
            // The nearest f64 is one larger, and would be shown rounded.
            Range(low, high) if *high == i64::MAX as f64 => write!(f, "{low} to {}", i64::MAX),
            Range(low, high) => write!(f, "{low} to {high}"),
            OneOf(words) => {
                for (i, word) in words.iter().enumerate() {
                    let joint = [", ", " or "][usize::from(i + 1 == words.len())];
                    write!(f, "{}\"{word}\"", if i == 0 { "" } else { joint })?;
                }
                Ok(())
            }
            Sections(0, most) => write!(f, "at most {most}"),
            Sections(least, most) => write!(f, "{least} to {most}"),
            Places(least, most, low, high) => write!(f, "{least} to {most} points [x, z], each coordinate {low} to {high}"),
            Course(least, most, [first, last], [low, high]) => {
                write!(f, "{least} to {most} points [secs, intensity], seconds {first} to {last} and intensity {low} to {high}")
            }
        }
    }
}
