//! Land, stones and vehicles in the wind, and grass that sways.

use super::*;
use prairie_core::scene::CoverModel;
use prairie_core::terrain::grey_png;

/// Wind (m/s) 5 m above the plain upwind of a ridge, its crest and its lee, 1 m above the ground in the lee, and the steps that failed.
fn over_a_ridge(terrain: WindTerrain, pressure: WindPressure) -> ([f32; 4], u64) {
    let ridge = |x: f32| 8.0 * (1.0 - ((x - 128.0) / 48.0).powi(2)).max(0.0);
    let heights = (0..33 * 33).map(|n| ridge((n % 33) as f32 * 8.0)).collect();
    let (mut scene, maps) = meadow();
    let height = HeightMap::from_heights(33, 33, [8.0; 2], heights);
    (scene.wind.cells, scene.wind.spacing_m) = ([64, 16, 4], [4.0, 2.0, 64.0]);
    (scene.wind.terrain, scene.wind.pressure, scene.wind.turbulence) = (terrain, pressure, 0.0);
    (scene.wind.sources, scene.wind.mean_m_per_s, scene.wind.canopy_drag_per_m) = (0, [5.0, 0.0], 0.0);
    let mut weather = Weather::new(&scene, &height, &maps.cover).unwrap();
    let grass = grass(&scene);
    (1..=240).for_each(|tick| weather.step(tick, &[], &height, &grass));
    let at = |x_m: f32, above_m: f32| weather.field().wind_at([x_m, above_m, 128.0])[0];
    ([at(32.0, 5.0), at(128.0, 5.0), at(168.0, 5.0), at(168.0, 1.0)], weather.resets())
}

#[test]
fn land_immersed_for_the_direct_solver_speeds_the_wind_up_over_its_crest() {
    let ([plain, crest, _, _], resets) = over_a_ridge(WindTerrain::Obstacle, WindPressure::Direct);
    let ([solid_plain, solid_crest, _, _], _) = over_a_ridge(WindTerrain::Obstacle, WindPressure::Multigrid);
    let ([level_plain, level_crest, _, _], _) = over_a_ridge(WindTerrain::Follow, WindPressure::Direct);
    println!(
        "plain and crest: immersed {plain:.2} {crest:.2}, solid cells {solid_plain:.2} {solid_crest:.2}, floor that follows {level_plain:.2} {level_crest:.2}"
    );
    assert!(resets == 0 && crest > 1.2 * plain && plain > 1.0, "5 m above the crest {crest} m/s, above the plain {plain} m/s");
    let [immersed, solid] = [crest / plain, solid_crest / solid_plain];
    assert!((immersed / solid - 1.0).abs() < 0.15, "speed-up {immersed} with the immersed land, {solid} with solid cells");
    assert!((level_crest / level_plain - 1.0).abs() < 0.02, "a floor that follows the land has no crest");
}

/// Wind (m/s) along X over level ground in the lee of something at (33, 33) m, and beside it, 1 m above the ground.
fn around(change: impl FnOnce(&mut Scene), ids: &[u8], motion: Option<Motion>) -> [f32; 2] {
    let (mut scene, _) = meadow();
    let cover = CoverMap::from_png(&grey_png([128; 2], ids)).unwrap();
    (scene.wind.cells, scene.wind.spacing_m) = ([32, 12, 32], [2.0; 3]);
    (scene.wind.sources, scene.wind.mean_m_per_s, scene.wind.turbulence) = (0, [6.0, 0.0], 0.0);
    scene.wind.canopy_drag_per_m = 0.0;
    change(&mut scene);
    let mut weather = Weather::new(&scene, &flat(), &cover).unwrap();
    let (grass, motions) = (grass(&scene), Vec::from_iter(motion));
    (1..=200).for_each(|tick| weather.step(tick, &motions, &flat(), &grass));
    assert_eq!(weather.resets(), 0);
    [[41.0, 33.0], [33.0, 53.0]].map(|[x, z]| weather.field().wind_at([x, 1.0, z])[0])
}

fn grass_with(id: u8) -> Vec<u8> {
    let mut ids = vec![255; 128 * 128];
    ids[16 + 128 * 16] = id;
    ids
}

#[test]
fn stones_leave_a_lee_as_walls_and_as_drag() {
    let of = |stone_m: f32| around(|scene| scene.plants.stone_m = stone_m, &grass_with(254), None);
    let [[large, large_beside], [small, small_beside]] = [of(12.0), of(2.0)];
    let [open, open_beside] = around(|_| (), &grass_with(255), None);
    println!("lee and beside: 12 m {large:.2} {large_beside:.2}, 2 m {small:.2} {small_beside:.2}, none {open:.2} {open_beside:.2} m/s");
    assert!(large < 0.4 * large_beside, "behind a stone of six cells {large} m/s, beside it {large_beside} m/s");
    assert!(small < 0.98 * small_beside && small > large, "behind a stone of one cell {small} m/s, beside it {small_beside} m/s");
    assert!((open / open_beside - 1.0).abs() < 0.01, "without a stone {open} and {open_beside} m/s");
}

#[test]
fn models_leave_a_lee_as_walls_and_as_drag() {
    let house = |size_m: [f32; 3], heading_rad: f32| {
        let change = |scene: &mut Scene| scene.models = vec![CoverModel { size_m, heading_rad, ..CoverModel::new("house", 9, "") }];
        around(change, &grass_with(9), None)
    };
    let [[large, large_beside], [small, small_beside]] = [[12.0, 8.0, 12.0], [2.0, 1.5, 2.0]].map(|size_m| house(size_m, 0.0));
    // A wall of three cells that faces the wind, and with its narrow side to it.
    let [[facing, _], [along, along_beside]] = [0.0, std::f32::consts::FRAC_PI_2].map(|heading_rad| house([6.0, 6.0, 20.0], heading_rad));
    println!(
        "lee and beside: 12 m {large:.2} {large_beside:.2}, 2 m {small:.2} {small_beside:.2}; wall across {facing:.2}, along {along:.2} m/s"
    );
    assert!(large < 0.4 * large_beside, "behind a house of six cells {large} m/s, beside it {large_beside} m/s");
    assert!(small < 0.98 * small_beside && small > large, "behind one of a cell {small} m/s, beside it {small_beside} m/s");
    assert!(
        facing < 0.4 * along_beside && along_beside > 3.0,
        "a wall across the wind {facing} m/s, along it {along} and {along_beside} m/s"
    );
    let patch = |scene: &mut Scene| {
        scene.wind.tiling = WindTiling::Patch;
        scene.models = vec![CoverModel { size_m: [12.0, 8.0, 12.0], ..CoverModel::new("house", 9, "") }];
    };
    let [tiled, tiled_beside] = around(patch, &grass_with(9), None);
    assert!((tiled / tiled_beside - 1.0).abs() < 0.01, "in a box tiled by patch it would be in every patch: {tiled}, {tiled_beside}");
}

/// A car at (33, 33) m that moves along X.
fn car(speed_m_per_s: f32) -> Motion {
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let pose = BodyPose { position_m: [33.0, 0.7, 33.0], rotation: [0.0, half, 0.0, half] };
    let velocity_m_per_s = [speed_m_per_s, 0.0, 0.0];
    Motion { kind: VehicleKind::Car, from: pose, to: pose, velocity_m_per_s, part_rad: 0.0, is_at_rest: speed_m_per_s == 0.0 }
}

#[test]
fn vehicles_hold_the_wind_back_or_drag_it_along() {
    let lee = |motion| around(|_| (), &grass_with(255), motion)[0];
    let [open, parked, along, fast] = [None, Some(car(0.0)), Some(car(6.0)), Some(car(20.0))].map(lee);
    println!("behind the car: open {open:.2}, parked {parked:.2}, with the wind {along:.2}, at 20 m/s {fast:.2} m/s");
    assert!(parked < 0.95 * open, "a parked car holds the wind back: {parked} m/s behind it, {open} m/s without it");
    assert!((along / open - 1.0).abs() < 0.02, "one that moves with the wind does nothing: {along} m/s");
    assert!(fast > 1.1 * open, "a fast one drags it along: {fast} m/s");
    let tiled = |motion| around(|scene| scene.wind.tiling = WindTiling::Patch, &grass_with(255), motion)[0];
    assert_eq!(tiled(Some(car(0.0))).to_bits(), tiled(None).to_bits(), "in a box tiled by patch it would be in every patch");
}

#[test]
fn grass_that_sways_keeps_its_state_in_a_checkpoint() {
    let (mut scene, maps) = meadow();
    (scene.wind.canopy_frequency_hz, scene.wind.canopy_drag_per_m) = (1.05, 0.8);
    let grass = grass(&scene);
    let mut weather = Weather::new(&scene, &maps.height, &maps.cover).unwrap();
    let displaced =
        |weather: &Weather| weather.air.canopy_displacements_m().expect("grass that sways").map(|[x, _]| x.abs()).fold(0.0, f32::max);
    (1..=60).for_each(|tick| weather.step(tick, &[], &maps.height, &grass));
    let mut state = WeatherState::default();
    weather.save_into(&mut state);
    let mut restored = Weather::restored(&scene, &maps.height, &maps.cover, &state).unwrap();
    (61..=120).for_each(|tick| [&mut weather, &mut restored].into_iter().for_each(|weather| weather.step(tick, &[], &maps.height, &grass)));
    let sums = [&weather, &restored].map(|weather| {
        let mut sum = Checksum::default();
        weather.hash(&mut sum);
        sum.value()
    });
    assert!(sums[0] == sums[1] && displaced(&weather) > 0.001, "{sums:?}, {} m", displaced(&weather));
    scene.wind.canopy_frequency_hz = 0.0;
    assert!(
        Weather::restored(&scene, &maps.height, &maps.cover, &state).is_err(),
        "a state with stems is not one of grass that holds still"
    );
}
