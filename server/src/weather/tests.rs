use super::*;
use crate::world::Maps;
use prairie_core::bend::{Bend, Field, Kinds};
use prairie_core::body::BodyPose;
use prairie_core::grid::PatchLayout;
use prairie_core::scene::{Primitive, PrimitiveKind};
use prairie_core::scene::{VehicleKind, WindAdvection, WindBoundary, WindDiffusion, WindMethod, WindPressure, WindTerrain, WindTime};
use prairie_core::terrain::grey_png;

mod intensity;
mod interval;
mod solids;

fn meadow() -> (Scene, Maps) {
    let loaded = crate::scenes::load("meadow").unwrap();
    let maps = loaded.maps();
    (loaded.scene, maps)
}

fn flat() -> HeightMap {
    HeightMap::from_heights(2, 2, [256.0; 2], vec![0.0; 4])
}

fn grass(scene: &Scene) -> Field {
    Field::new(PatchLayout::from(&scene.patches), Kinds::one(scene.grass.waves))
}

fn hovering(velocity_m_per_s: [f32; 3]) -> Motion {
    let pose = BodyPose { position_m: [64.0, 5.0, 64.0], rotation: [0.0, 0.0, 0.0, 1.0] };
    Motion { kind: VehicleKind::Helicopter, from: pose, to: pose, velocity_m_per_s, part_rad: 0.0, is_at_rest: false }
}

/// A small wind with dust, after `ticks` ticks.
fn blown(change: impl FnOnce(&mut Scene), ticks: u64) -> Result<Weather, WeatherError> {
    let (mut scene, maps) = meadow();
    (scene.wind.cells, scene.wind.spacing_m) = ([16, 8, 16], [16.0, 2.0, 16.0]);
    scene.wind.dust.release_per_s = 1.0;
    change(&mut scene);
    check(&scene)?;
    let mut weather = Weather::new(&scene, &maps.height, &maps.cover)?;
    let grass = grass(&scene);
    (1..=ticks).for_each(|tick| weather.step(tick, &[hovering([0.0; 3])], &maps.height, &grass));
    Ok(weather)
}

fn is_alive(weather: &Weather) -> bool {
    let fastest = weather.field().velocities().iter().map(|velocity| velocity.length()).fold(0.0, f32::max);
    weather.resets() == 0 && (1.0..60.0).contains(&fastest) && weather.frame().codes.iter().any(|&code| code != 0)
}

#[test]
fn every_wind_setting_runs() {
    for (&advection, &time) in WindAdvection::ALL.iter().flat_map(|advection| WindTime::ALL.iter().map(move |time| (advection, time))) {
        if time.allows(advection) {
            let schemes =
                |scene: &mut Scene| (scene.wind.advection, scene.wind.time, scene.wind.dust.advection) = (advection, time, advection);
            assert!(is_alive(&blown(schemes, 12).unwrap()), "{advection:?} {time:?}");
        }
    }
    for diffusion in [WindDiffusion::Explicit, WindDiffusion::GaussSeidel, WindDiffusion::Implicit, WindDiffusion::CrankNicolson] {
        assert!(is_alive(&blown(|scene| scene.wind.diffusion = diffusion, 12).unwrap()), "{diffusion:?}");
    }
    use WindPressure::{ConjugateGradients, Direct, GaussSeidel, Jacobi, Multigrid, Sor};
    for pressure in [Direct, Jacobi, GaussSeidel, Sor, ConjugateGradients, Multigrid] {
        let weather = blown(|scene| (scene.wind.pressure, scene.wind.pressure_sweeps) = (pressure, 20), 12).unwrap();
        assert!(is_alive(&weather), "{pressure:?}");
        assert_eq!(weather.report().pressure_sweeps == 0, pressure == Direct, "{pressure:?}");
    }
    for tiling in [WindTiling::Box, WindTiling::Patch, WindTiling::Follow] {
        assert!(is_alive(&blown(|scene| scene.wind.tiling = tiling, 12).unwrap()), "{tiling:?}");
    }
    for kind in [PrimitiveKind::Uniform, PrimitiveKind::Source, PrimitiveKind::Sink, PrimitiveKind::Vortex, PrimitiveKind::Cyclone] {
        let weather = blown(|scene| scene.wind.primitives.push(Primitive { dust: 1.0, ..Primitive::new(kind, [128.0, 4.0, 128.0]) }), 12);
        assert!(is_alive(&weather.unwrap()), "{kind:?}");
    }
    let stable_fluids = blown(
        |scene| scene.wind = prairie_core::scene::Wind { cells: [16, 8, 16], ..prairie_core::scene::Wind::of(WindMethod::StableFluids) },
        12,
    );
    assert!(is_alive(&stable_fluids.unwrap()));
}

#[test]
fn every_boundary_condition_runs() {
    let faces = [
        [
            WindBoundary::Inflow,
            WindBoundary::Outflow,
            WindBoundary::FreeSlip,
            WindBoundary::Outflow,
            WindBoundary::NoSlip,
            WindBoundary::Reflect,
        ],
        [WindBoundary::Wrap, WindBoundary::Wrap, WindBoundary::NoSlip, WindBoundary::Lid, WindBoundary::Wrap, WindBoundary::Wrap],
    ];
    assert!(WindBoundary::ALL.iter().all(|face| faces.as_flattened().contains(face)), "every boundary condition is tried");
    for [west, east, bottom, top, north, south] in faces {
        let weather = blown(
            |scene| {
                let lid_m_per_s = [6.0, 0.0, 0.0];
                scene.wind.faces = prairie_core::scene::WindFaces { west, east, bottom, top, north, south, lid_m_per_s };
                scene.wind.mean_m_per_s = [4.0, 0.0];
            },
            30,
        );
        assert!(is_alive(&weather.unwrap()), "{west:?} {top:?}");
    }
}

#[test]
fn incompatible_settings_are_rejected() {
    let error = blown(|scene| scene.wind.time = WindTime::Reflection, 1).err().expect("conservative advection has no reflection");
    assert!(error.to_string().contains("time"), "{error}");
    let error = blown(|scene| scene.wind.method = WindMethod::StableFluids, 1).err().expect("that method has no canopy");
    assert!(error.to_string().contains("canopy"), "{error}");
}

#[test]
fn wind_over_solid_terrain_is_sampled_above_the_ground_and_fastest_on_the_hill() {
    let ridge = |x: f32| 8.0 * (1.0 - ((x - 128.0) / 48.0).powi(2)).max(0.0);
    let heights = (0..33 * 33).map(|n| ridge((n % 33) as f32 * 8.0)).collect();
    let (mut scene, maps) = meadow();
    let maps = Maps { height: HeightMap::from_heights(33, 33, [8.0; 2], heights), ..maps };
    (scene.wind.cells, scene.wind.spacing_m) = ([32, 12, 8], [8.0, 2.0, 32.0]);
    (scene.wind.terrain, scene.wind.pressure) = (WindTerrain::Obstacle, WindPressure::Multigrid);
    (scene.wind.sources, scene.wind.mean_m_per_s, scene.wind.canopy_drag_per_m) = (0, [5.0, 0.0], 0.0);
    let mut weather = Weather::new(&scene, &maps.height, &maps.cover).unwrap();
    let grass = grass(&scene);
    (1..=120).for_each(|tick| weather.step(tick, &[], &maps.height, &grass));
    let [crest, foot] = [16, 4].map(|i| weather.field().velocities()[i + 32 * (2 + 12 * 4)].x);
    assert!(crest > 1.3 * foot && foot > 1.0, "5 m above the crest {crest}, above the plain {foot}");
    assert!(weather.report().pressure_residual <= 1e-5 && weather.resets() == 0);
}

#[test]
fn bent_grass_slows_the_wind_less() {
    let (mut scene, maps) = meadow();
    (scene.wind.sources, scene.wind.canopy_drag_per_m, scene.wind.mean_rate_per_s, scene.plants.height_m) = (0, 1.0, 0.0, 2.0);
    let near_ground = |grass: &Field| {
        let mut weather = Weather::new(&scene, &maps.height, &maps.cover).unwrap();
        (1..=30).for_each(|tick| weather.step(tick, &[], &maps.height, grass));
        let velocities: Vec<_> = weather.air.cell_velocities().collect();
        [20, 4].map(|i| velocities[i + 32 * 8 * 16].length())
    };
    let mut grass = grass(&scene);
    let [same, there] = near_ground(&grass);
    // The covering map makes columns differ, so each is compared with itself.
    for index in 0..grass.layout().patches() as u32 {
        if grass.layout().corner_m(index)[0] < 64.0 {
            let patch = grass.wake(index);
            (0..64).for_each(|j| (0..64).for_each(|i| patch.press(i, j, Bend { theta: 1.4, ..Bend::default() })));
        }
    }
    let [still_same, faster] = near_ground(&grass);
    assert!(faster > 1.1 * there, "over lying grass {faster} m/s, over the same standing {there}");
    assert!((still_same / same - 1.0).abs() < 0.1, "elsewhere {still_same}, before {same}");
}

/// Wind (m/s) 5 m above the ground and lean (rad) of the grass in the lee of a tree of 12 m, and beside it. The lee reaches the grass two heights behind the
/// tree: the air that passes below the crown is faster.
fn around_a_tree(crown_drag_per_m: f32) -> [[f32; 2]; 2] {
    let (mut scene, maps) = meadow();
    let mut ids = [255; 128 * 128];
    ids[16 + 128 * 16] = 253;
    let cover = CoverMap::from_png(&grey_png([128; 2], &ids)).unwrap();
    scene.plants.tree_m = 12.0;
    (scene.wind.cells, scene.wind.spacing_m) = ([32, 12, 32], [2.0; 3]);
    (scene.wind.sources, scene.wind.mean_m_per_s, scene.wind.turbulence) = (0, [6.0, 0.0], 0.0);
    scene.wind.crown_drag_per_m = crown_drag_per_m;
    let mut weather = Weather::new(&scene, &maps.height, &cover).unwrap();
    let grass = grass(&scene);
    (1..=400).for_each(|tick| weather.step(tick, &[], &maps.height, &grass));
    let wind = |[x, z]: [f32; 2]| weather.field().wind_at([x, 5.0, z])[0];
    let lean = |at_m: [f32; 2]| weather.field().lean_at(at_m).into_iter().fold(0.0, f32::hypot);
    [[wind([39.0, 33.0]), lean([57.0, 33.0])], [wind([33.0, 45.0]), lean([33.0, 45.0])]]
}

#[test]
fn a_tree_leaves_a_lee_that_the_grass_shows() {
    let [[lee, lee_rad], [beside, beside_rad]] = around_a_tree(0.4);
    println!("lee {lee:.2} m/s and {lee_rad:.3} rad, beside {beside:.2} m/s and {beside_rad:.3} rad");
    assert!(lee < 0.7 * beside, "wind in the lee {lee} m/s, beside {beside} m/s");
    assert!(lee_rad < 0.9 * beside_rad, "lean in the lee {lee_rad} rad, beside {beside_rad} rad");
    let [[open, open_rad], [open_beside, open_beside_rad]] = around_a_tree(0.0);
    println!("without it {open:.2} and {open_beside:.2} m/s, {open_rad:.3} and {open_beside_rad:.3} rad");
    assert!((open / open_beside - 1.0).abs() < 0.02 && (open_rad / open_beside_rad - 1.0).abs() < 0.02);
    assert!(
        beside_rad > open_beside_rad,
        "the air goes round the tree: grass beside it leans by {beside_rad} rad, by {open_beside_rad} rad without it"
    );
}

#[test]
fn a_box_that_follows_the_objects_stops_periodic_wakes() {
    let swirl_that_comes_round = |tiling| {
        let wind = |scene: &mut Scene| {
            (scene.wind.tiling, scene.wind.sources, scene.wind.mean_m_per_s) = (tiling, 0, [12.0, 0.0]);
            (scene.wind.viscosity_m2_per_s, scene.wind.canopy_drag_per_m) = (0.0, 0.0);
        };
        let weather = blown(wind, 2400).unwrap();
        // The helicopter hovers at x = 64 of 256 m: its downwash drifts east and returns across the seam at x = 192. Without it there is no vertical or lateral wind.
        let west = (0..16).flat_map(|k| (0..8).map(move |j| 16 * (j + 8 * k)));
        west.map(|at| weather.field().velocities()[at].y.hypot(weather.field().velocities()[at].z)).fold(0.0, f32::max)
    };
    let [repeated, cut] = [WindTiling::Box, WindTiling::Follow].map(swirl_that_comes_round);
    println!("swirl that comes round: {repeated:.3} m/s repeated, {cut:.3} m/s cut");
    assert!(repeated > 0.05 && cut < 0.7 * repeated, "{cut} with the cut, {repeated} without");
}

#[test]
fn dust_is_published_when_the_scene_has_it() {
    let (mut scene, maps) = meadow();
    assert!(!Weather::new(&scene, &maps.height, &maps.cover).unwrap().frame().has_dust(), "no byte more for clear air");
    scene.wind.dust.release_per_s = 2.0;
    let frame = Arc::clone(Weather::new(&scene, &maps.height, &maps.cover).unwrap().frame());
    let dust = &frame.codes[3 * frame.volume()..];
    assert_eq!(dust.len(), frame.volume());
    assert!(dust.iter().all(|&code| code >= 0) && dust.iter().any(|&code| code > 20) && dust.contains(&0), "clouds in clear air");
}

#[test]
fn vehicles_make_no_jets_in_a_box_tiled_by_patch() {
    let (mut scene, maps) = meadow();
    (scene.wind.cells, scene.wind.spacing_m, scene.wind.sources, scene.wind.canopy_drag_per_m) = ([8; 3], [2.0; 3], 0, 0.0);
    let grass = grass(&scene);
    let mut strongest_updraught = |tiling| {
        scene.wind.tiling = tiling;
        let mut weather = Weather::new(&scene, &maps.height, &maps.cover).unwrap();
        (1..=20).for_each(|tick| weather.step(tick, &[hovering([0.0; 3])], &flat(), &grass));
        weather.field().velocities().iter().map(|velocity| velocity.y.abs()).fold(0.0, f32::max)
    };
    assert!(strongest_updraught(WindTiling::Box) > 0.5);
    assert!(strongest_updraught(WindTiling::Patch) < 1e-3);
}

#[test]
fn a_failed_step_restarts_the_wind_and_is_counted() {
    let (scene, maps) = meadow();
    let grass = grass(&scene);
    let mut weather = Weather::new(&scene, &maps.height, &maps.cover).unwrap();
    let mut advance = |motions: &[Motion]| {
        let ticks = weather.ticks_per_step;
        (1..=ticks).for_each(|tick| weather.step(tick, motions, &flat(), &grass));
        (weather.resets(), weather.field().velocities().iter().all(|velocity| velocity.is_finite()))
    };
    assert_eq!(advance(&[]), (0, true));
    assert_eq!(advance(&[hovering([f32::MAX; 3])]), (1, true));
    assert_eq!(advance(&[]), (1, true));
}

#[test]
fn the_wind_at_a_position_is_that_of_its_cell_and_weaker_close_to_the_ground() {
    for tiling in [WindTiling::Box, WindTiling::Patch] {
        let mut scene = meadow().0;
        scene.wind.tiling = tiling;
        let weather = blown(|scene| (scene.wind.tiling, scene.wind.turbulence) = (tiling, 0.0), 12).unwrap();
        let cell = |[i, j, k]: [usize; 3]| weather.field().velocities()[i + 16 * (j + 8 * k)];
        // The centre of the patch in which the box is offset by this many cells.
        let at_m = |i: usize, k: usize| [(i as f32 + 0.5) * 16.0, (k as f32 + 0.5) * 16.0];
        for [i, j, k] in [[0, 0, 0], [3, 1, 7], [15, 7, 15], [8, 2, 4]] {
            let [x, z] = at_m(i, k);
            let [moved_x, moved_z] = match tiling {
                WindTiling::Patch => {
                    prairie_core::wind::offset_cells(prairie_core::wind::WindTiles::new(&scene).seed(), [i as i32, k as i32], [16, 16])
                }
                _ => [0, 0],
            };
            let wanted = cell([(i + moved_x as usize) % 16, j, (k + moved_z as usize) % 16]);
            let height_m = (j as f32 + 0.5) * 2.0;
            let found = Vec3::from(weather.field().wind_at([x, height_m, z]));
            let factor = prairie_core::wind::near_ground_fraction(height_m);
            assert!((found - wanted * factor).length() < 1e-4, "{tiling:?} {found} instead of {wanted} at {i}, {j}, {k}");
        }
        let [low, lowest] = [1.0, 0.25].map(|height_m| Vec3::from(weather.field().wind_at([100.0, height_m, 60.0])));
        assert!((lowest - low * 0.5_f32.sqrt()).length() < 1e-4, "a quarter of the height, a quarter-power law");
        let positions = (0..4000).map(|n| [(n % 61) as f32 * 4.3, 0.01 * (n % 97) as f32, (n % 53) as f32 * 4.9]);
        for (height_m, layers) in [(0.97, 1), (1.1, 2), (40.0, 8)] {
            let strongest = weather.field().strongest_m_per_s(height_m);
            let rows = (0..16).flat_map(|k| (0..layers).flat_map(move |j| (0..16).map(move |i| [i, j, k])));
            assert_eq!(strongest, rows.map(|at| cell(at).length_squared()).fold(0.0, f32::max).sqrt());
        }
        let fastest = positions.map(|at_m| Vec3::from(weather.field().wind_at(at_m)).length()).fold(0.0, f32::max);
        assert!(fastest > 0.5 && fastest <= weather.field().strongest_m_per_s(0.97));
    }
}

#[test]
fn a_hurricane_is_sent_as_it_is() {
    for error in [0.125, 0.02] {
        let hurricane = |scene: &mut Scene| {
            scene.wind.mean_m_per_s = [-36.0, 24.0];
            scene.stream.wind_error_m_per_s = error;
        };
        // Step 63 has a frame.
        let weather = blown(hurricane, 63).unwrap();
        let (released, sent) = (weather.velocities(), weather.field().velocities());
        let apart = released.iter().zip(sent).map(|(a, b)| (*a - *b).abs().max_element()).fold(0.0, f32::max);
        let fastest = released.iter().map(|velocity| velocity.x.abs()).fold(0.0, f32::max);
        assert!(fastest > 35.0 && apart <= 1.0001 * error && apart > 0.9 * error, "{fastest} m/s, off by {apart} m/s");
    }
}

/// The air of the meadow in which nothing blows, and of one in which a helicopter hovers now and then.
fn calm() -> (Weather, Scene, Maps) {
    let (mut scene, maps) = meadow();
    (scene.wind.cells, scene.wind.spacing_m) = ([16, 8, 16], [16.0, 2.0, 16.0]);
    (scene.wind.mean_m_per_s, scene.wind.sources) = ([0.0; 2], 0);
    (Weather::new(&scene, &maps.height, &maps.cover).unwrap(), scene, maps)
}

#[test]
fn still_air_takes_no_step_and_a_step_would_change_nothing() {
    let (mut weather, scene, maps) = calm();
    let grass = grass(&scene);
    let time_secs = weather.air.time_secs();
    (1..=60).for_each(|tick| weather.step(tick, &[], &maps.height, &grass));
    assert_eq!(weather.air.time_secs(), time_secs, "the solver has taken a step");
    assert_eq!(weather.frame().tick, 60 - 60 % weather.ticks_per_frame, "frames go on");
    weather.air.step(weather.step_secs, &[]).unwrap();
    assert!(weather.air.cell_velocities().all(|velocity| velocity == Vec3::ZERO), "a step moves still air");
}

#[test]
fn air_that_was_stirred_comes_to_rest() {
    let (mut weather, scene, maps) = calm();
    let grass = grass(&scene);
    (1..=120).for_each(|tick| weather.step(tick, &[hovering([0.0; 3])], &maps.height, &grass));
    let stirred = weather.air.diagnostics().max_speed_m_per_s;
    assert!(stirred.iter().sum::<f64>() > 0.5, "{stirred:?}");
    let bound_m_per_s = f64::from(0.1 * scene.stream.wind_error_m_per_s);
    let rests = (121..=60 * 600).find(|&tick| {
        let before = weather.air.diagnostics().max_speed_m_per_s.iter().sum::<f64>();
        weather.step(tick, &[], &maps.height, &grass);
        let is_zero = weather.air.diagnostics().max_speed_m_per_s == [0.0; 3];
        assert!(!is_zero || before <= bound_m_per_s, "air of {before} m/s is stopped");
        is_zero
    });
    assert!(rests.is_some(), "still at {:?}", weather.air.diagnostics().max_speed_m_per_s);
}

#[test]
fn wind_never_rests() {
    let gusts = blown(|scene| (scene.wind.mean_m_per_s, scene.wind.dust.release_per_s) = ([0.0; 2], 0.0), 12).unwrap();
    let mean = blown(|scene| (scene.wind.sources, scene.wind.dust.release_per_s) = (0, 0.0), 12).unwrap();
    let lid = |scene: &mut Scene| {
        (scene.wind.mean_m_per_s, scene.wind.sources, scene.wind.dust.release_per_s) = ([0.0; 2], 0, 0.0);
        (scene.wind.faces.top, scene.wind.faces.lid_m_per_s) = (WindBoundary::Lid, [3.0, 0.0, 0.0]);
    };
    for weather in [gusts, mean, blown(lid, 12).unwrap()] {
        assert!(!weather.rest.is_undriven(&[]));
    }
}
