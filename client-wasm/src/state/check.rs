//! Range checks of a received scene and its models.

use super::check_underbrush::check_underbrush;
use super::error::{MirrorError, range, within};
use prairie_core::body::Body;
use prairie_core::lod::shells::LAYERS_LIMIT;
use prairie_core::scene::{GATES_LIMIT, LAMPS_LIMIT, MODEL_SIDE_M, MODELS_LIMIT, Scene, Snow, Stream, WIND_CELLS_LIMIT};
use prairie_core::wire::{Mesh, STANDINGS_LIMIT, Standing};

/// Checks all settings that the client relies on.
pub(super) fn check(scene: &Scene) -> Result<(), MirrorError> {
    check_grids(scene)?;
    check_world(scene)?;
    check_light(scene)?;
    check_grass(scene)?;
    check_winds(scene)?;
    check_race(scene)?;
    check_models(scene)?;
    check_underbrush(scene)
}

fn check_grids(scene: &Scene) -> Result<(), MirrorError> {
    let cells = scene.patches.cells;
    if !(8..=256).contains(&cells) || !cells.is_multiple_of(8) {
        return Err(range("patches.cells", cells, "8..=256, a multiple of 8"));
    }
    within("patches.awake_limit", scene.patches.awake_limit as f32, 9.0, 4096.0)?;
    for count in scene.patches.count {
        within("patches.count", count as f32, 1.0, 2048.0)?;
    }
    for cells in scene.wind.cells {
        within("wind.cells", cells as f32, 2.0, 256.0)?;
    }
    let wind_cells = scene.wind.cells.iter().map(|&n| u64::from(n)).product::<u64>();
    if wind_cells > WIND_CELLS_LIMIT {
        return Err(range("total number of wind cells", wind_cells, format!("0..={WIND_CELLS_LIMIT}")));
    }
    for spacing in scene.wind.spacing_m {
        within("wind.spacing_m", spacing, 0.1, 1000.0)?;
    }
    for mean in scene.wind.mean_m_per_s {
        within("wind.mean_m_per_s", mean, -40.0, 40.0)?;
    }
    within("wind.turbulence_below_m", scene.wind.turbulence_below_m, 0.0, 10_000.0)?;
    let Stream { theta_error_deg, omega_error_rad_per_s, wind_error_m_per_s, dust_error } = scene.stream;
    within("stream.theta_error_deg", theta_error_deg, 0.05, 5.0)?;
    within("stream.omega_error_rad_per_s", omega_error_rad_per_s, 0.01, 1.0)?;
    within("stream.wind_error_m_per_s", wind_error_m_per_s, 0.01, 1.0)?;
    within("stream.dust_error", dust_error, 0.005, 0.5)
}

fn check_world(scene: &Scene) -> Result<(), MirrorError> {
    for pixel in scene.terrain.pixel_m {
        within("terrain.pixel_m", pixel, 0.01, 1000.0)?;
    }
    let plants = &scene.plants;
    within("tick_hz", scene.tick_hz, 10.0, 240.0)?;
    within("patches.cell_m", scene.patches.cell_m, 0.05, 10.0)?;
    within("terrain.level_m", scene.terrain.level_m, 0.0, 1000.0)?;
    within("terrain.base_m", scene.terrain.base_m, -20_000.0, 20_000.0)?;
    within("plants.grid_m", plants.grid_m, 1.0, 64.0)?;
    within("plants.plants_per_side", plants.plants_per_side as f32, 2.0, 256.0)?;
    within("plants.near_ratio", plants.near_ratio, 1.0, 5.0)?;
    for segments in plants.blade_segments {
        within("plants.blade_segments", segments as f32, 0.0, 12.0)?;
    }
    within("plants.highest_detail", plants.highest_detail, 0.0, 3.0)?;
    within("plants.height_variation", plants.height_variation, 0.0, 0.9)?;
    within("plants.width_m", plants.width_m, 0.001, 0.5)?;
    within("plants.flowers_per_m2", plants.flowers_per_m2, 0.0, 50.0)?;
    within("plants.tree_m", plants.tree_m, 0.5, 60.0)?;
    within("plants.stone_m", plants.stone_m, 0.05, 20.0)?;
    within("plants.swing_damping", plants.swing_damping, 0.005, 5.0)?;
    let shells = &scene.shells;
    within("shells.layers", shells.layers as f32, 1.0, LAYERS_LIMIT as f32)?;
    within("shells.slices", shells.slices as f32, 1.0, 32.0)?;
    within("shells.blades_per_m2", shells.blades_per_m2, 100.0, 40_000.0)?;
    within("shells.root_light", shells.root_light, 0.0, 1.0)?;
    within("shells.stiffness_profile", shells.stiffness_profile, -0.9, 4.0)?;
    within("rain.rate_mm_per_h", scene.rain.rate_mm_per_h, 0.0, 200.0)?;
    check_snow(scene)?;
    within("objects.balls", scene.objects.balls as f32, 0.0, 64.0)?;
    within("objects.ball_radius_m", scene.objects.ball_radius_m, 0.1, 5.0)?;
    Ok(())
}

fn check_snow(scene: &Scene) -> Result<(), MirrorError> {
    let Snow { depth_m, density_kg_m3, pressed_density_kg_m3, pushed_share, repose_deg, fall_m_per_h, leaf_load_kg_m2 } = scene.snow;
    within("snow.depth_m", depth_m, 0.0, 2.0)?;
    within("snow.density_kg_m3", density_kg_m3, 30.0, 600.0)?;
    within("snow.pressed_density_kg_m3", pressed_density_kg_m3, density_kg_m3, 900.0)?;
    within("snow.pushed_share", pushed_share, 0.0, 1.0)?;
    within("snow.repose_deg", repose_deg, 10.0, 80.0)?;
    within("snow.fall_m_per_h", fall_m_per_h, 0.0, 0.5)?;
    within("snow.leaf_load_kg_m2", leaf_load_kg_m2, 0.0, 5.0)
}

fn check_light(scene: &Scene) -> Result<(), MirrorError> {
    let light = &scene.light;
    within("light.sun_elevation_rad", light.sun_elevation_rad, -0.1, 1.58)?;
    within("light.sun_heading_rad", light.sun_heading_rad, -100.0, 100.0)?;
    within("light.hour", light.hour, -1.0, 24.0)?;
    within("light.latitude_deg", light.latitude_deg, -90.0, 90.0)?;
    within("light.day_of_year", light.day_of_year, 1.0, 366.0)?;
    within("light.day_length_secs", light.day_length_secs, 0.0, 1_000_000.0)?;
    within("light.haze_m", light.haze_m, 10.0, 100_000.0)?;
    within("light.mist_m", light.mist_m, 0.0, 100_000.0)?;
    within("light.mist_height_m", light.mist_height_m, 0.5, 200.0)?;
    if scene.lights.len() > LAMPS_LIMIT {
        return Err(range("number of lights", scene.lights.len(), format!("at most {LAMPS_LIMIT}")));
    }
    for lamp in &scene.lights {
        for coordinate in lamp.at_m {
            within("lights.at_m", coordinate, -100_000.0, 100_000.0)?;
        }
        within("lights.candela", lamp.candela, 0.0, 1_000_000.0)?;
        for term in lamp.attenuation {
            within("lights.attenuation", term, 0.0, 100.0)?;
        }
    }
    Ok(())
}

fn check_race(scene: &Scene) -> Result<(), MirrorError> {
    let race = &scene.race;
    if race.gates.len() > GATES_LIMIT {
        return Err(range("number of gates", race.gates.len(), format!("at most {GATES_LIMIT}")));
    }
    within("race.laps", race.laps as f32, 1.0, 99.0)?;
    within("race.light_period_secs", race.light_period_secs, 0.0, 3600.0)?;
    for gate in &race.gates {
        for coordinate in gate.at_m {
            within("race.gates.at_m", coordinate, 0.0, 100_000.0)?;
        }
        within("race.gates.heading_rad", gate.heading_rad, -6.3, 6.3)?;
        within("race.gates.width_m", gate.width_m, 6.0, 100.0)?;
    }
    Ok(())
}

/// Checks the models of the covering map.
fn check_models(scene: &Scene) -> Result<(), MirrorError> {
    if scene.models.len() > MODELS_LIMIT {
        return Err(range("number of models", scene.models.len(), format!("at most {MODELS_LIMIT}")));
    }
    let [shortest_m, longest_m] = MODEL_SIDE_M;
    for model in &scene.models {
        for side_m in model.size_m {
            within("models.size_m", side_m, shortest_m, longest_m)?;
        }
        within("models.size_variation", model.size_variation, 0.0, 0.5)?;
        within("models.heading_rad", model.heading_rad, -6.3, 6.3)?;
        within("models.heading_variation_rad", model.heading_variation_rad, 0.0, 3.15)?;
        within("models.apart_m", model.apart_m, 0.0, 1000.0)?;
    }
    Ok(())
}

/// Checks a received race in a scene with this number of gates: its size, its gates and its times.
pub(super) fn check_standings(standings: &[Standing], gates: usize) -> Result<(), MirrorError> {
    if standings.len() > STANDINGS_LIMIT {
        return Err(range("number of standings", standings.len(), format!("at most {STANDINGS_LIMIT}")));
    }
    for standing in standings {
        if usize::from(standing.next_gate) >= gates {
            return Err(range("standings.next_gate", standing.next_gate, format!("less than the number of gates, {gates}")));
        }
        let Standing { last_secs, best_secs, race_secs, gap_secs, .. } = *standing;
        let began_secs = standing.began_secs.map(|secs| secs as f32);
        for secs in [began_secs, last_secs, best_secs, race_secs, gap_secs].into_iter().flatten() {
            if !secs.is_finite() {
                return Err(range("times of standings", secs, "finite numbers"));
            }
        }
    }
    Ok(())
}

fn check_grass(scene: &Scene) -> Result<(), MirrorError> {
    if scene.species.len() > 16 {
        return Err(range("number of species", scene.species.len(), "at most 16"));
    }
    for grass in scene.kinds() {
        within("*.c0_m_per_s", grass.waves.c0_m_per_s, 0.0, 50.0)?;
        within("*.mu_m_per_rad", grass.waves.mu_m_per_rad, 0.0, 10.0)?;
        within("*.stiffness_per_s2", grass.waves.stiffness_per_s2, 0.0, 10_000.0)?;
        within("*.wind_bend_rad", grass.wind_bend_rad, 0.0, 1.5)?;
        within("*.lag_secs", grass.lag_secs, 0.0, 1.0)?;
        within("*.recovery_lag_share", grass.recovery_lag_share, 0.0, 1.0)?;
        within("*.segments", grass.segments as f32, 1.0, 6.0)?;
    }
    for plants in scene.kinds_of_plants() {
        within("*.height_m", plants.height_m, 0.02, 5.0)?;
        within("*.swing_hz", plants.swing_hz, 0.05, 50.0)?;
        for channel in plants.root_rgb.into_iter().chain(plants.tip_rgb) {
            within("*_rgb", channel, 0.0, 1.0)?;
        }
    }
    Ok(())
}

/// Checks the winds that press the grass.
fn check_winds(scene: &Scene) -> Result<(), MirrorError> {
    within("natural_wind.scale_m", scene.natural_wind.scale_m, 8.0, 1000.0)?;
    within("natural_wind.reach_m", scene.natural_wind.reach_m, 0.0, 500.0)?;
    if scene.drawn_winds.len() > 16 {
        return Err(range("number of drawn winds", scene.drawn_winds.len(), "at most 16"));
    }
    for wind in &scene.drawn_winds {
        within("drawn_winds.radius_m", wind.radius_m, 0.5, 500.0)?;
        within("drawn_winds.travel_m_per_s", wind.travel_m_per_s, 0.0, 60.0)?;
        within("drawn_winds.strike_height_m", wind.strike_height_m, 0.05, 5.0)?;
        if wind.path_m.len() > 64 {
            return Err(range("corners of a drawn wind's path", wind.path_m.len(), "at most 64"));
        }
    }
    Ok(())
}

/// Largest number of kinds of objects, of prisms of one of them, and of corners of a prism.
const BODY_LIMITS: [usize; 3] = [64, 256, 64];

/// Checks the shapes of objects.
pub(super) fn check_bodies(bodies: &[Body]) -> Result<(), MirrorError> {
    let [kinds, prisms, corners] = BODY_LIMITS;
    if bodies.len() > kinds {
        return Err(range("number of shapes", bodies.len(), format!("at most {kinds}")));
    }
    for body in bodies {
        if body.prisms.len() > prisms {
            return Err(range("prisms of a shape", body.prisms.len(), format!("at most {prisms}")));
        }
        within("stride of a shape", body.stride_m, 0.0, 100.0)?;
        for prism in &body.prisms {
            if !(3..=corners).contains(&prism.outline_m.len()) || prism.seams.len() != prism.outline_m.len() {
                return Err(range("corners of a prism", prism.outline_m.len(), format!("3..={corners}, each with a seam")));
            }
            for coordinate in prism.outline_m.iter().flatten().chain(&prism.span_m) {
                within("coordinate of a prism", *coordinate, -100.0, 100.0)?;
            }
        }
    }
    Ok(())
}

/// Checks the sizes and indices of a model.
pub(super) fn check_mesh(mesh: &Mesh) -> Result<(), MirrorError> {
    let vertices = mesh.positions_m.len();
    if vertices > Mesh::VERTEX_LIMIT || mesh.normals.len() != vertices || mesh.rgb.len() != vertices {
        return Err(range("vertices of a model", vertices, "at most 65536, each with a normal and a colour"));
    }
    if mesh.indices.len() > Mesh::INDEX_LIMIT || !mesh.indices.len().is_multiple_of(3) {
        return Err(range("indices of a model", mesh.indices.len(), "at most 1048576, a multiple of 3"));
    }
    match mesh.indices.iter().find(|&&index| index as usize >= vertices) {
        Some(index) => Err(range("index of a model", index, format!("0..{vertices}"))),
        None => Ok(()),
    }
}
