//! Snow under wheels, in a whole world.

use prairie::charts::worlds;
use prairie::world::{Command, World};
use prairie_core::scene::{Scene, Snow, VehicleKind};
use prairie_core::wire::Drive;

/// A still, flat world in snow.
fn snowy() -> (Scene, World) {
    let mut scene = worlds::scene(12);
    scene.wind.sources = 0;
    scene.wind.cells = [4, 4, 4];
    scene.wind.spacing_m = [48.0, 4.0, 48.0];
    scene.snow = Snow { depth_m: 0.2, ..Snow::default() };
    let world = worlds::flat(&scene);
    (scene, world)
}

/// Drives a car in a curve for 6 s.
fn drive(world: &mut World) {
    world.step(&[Command::Spawn { client: 1, kind: VehicleKind::Car }]);
    world.step(&[Command::Drive { client: 1, number: 0, drive: Drive { throttle: 0.6, steer: 0.15, ..Drive::default() } }]);
    (0..360).for_each(|_| world.step(&[]));
}

/// Mass of the snow in the tiles that are kept, undisturbed (kg).
fn undisturbed_kg(scene: &Scene, tiles: usize) -> f64 {
    let tile_m = 8.0 * scene.patches.cell_m;
    f64::from(scene.snow.mass_kg_m2() * tile_m * tile_m) * tiles as f64
}

#[test]
fn a_drive_conserves_the_mass_of_the_snow_and_leaves_ruts_with_rims() {
    let (scene, mut world) = snowy();
    drive(&mut world);
    let snow = world.bend().snow().expect("snow lies");
    let kept_kg = undisturbed_kg(&scene, snow.tiles());
    assert!(snow.tiles() > 20 && (snow.mass_difference_kg() / kept_kg).abs() < 1e-6, "{} kg of {kept_kg}", snow.mass_difference_kg());
    let differences: Vec<_> = snow.patches().flat_map(|patch| snow.differences(patch)).map(|(_, um)| um as f64 * 1e-6).collect();
    let [lowest_m, highest_m] = [f64::min, f64::max].map(|pick| differences.iter().copied().fold(0.0, pick));
    // Undisturbed snow of 0.2 m is pressed to at most 0.2 · 120 / 450 = 0.053 m.
    assert!(lowest_m < -0.145 && lowest_m > -0.2 && highest_m > 0.01, "{lowest_m} m to {highest_m} m");
    let ruts = differences.iter().filter(|m| **m < -0.1).count();
    assert!(ruts > 100, "{ruts} cells lie in ruts");
}

#[test]
fn ruts_stay_when_the_car_has_left_and_the_grass_sleeps() {
    let (_, mut world) = snowy();
    drive(&mut world);
    world.step(&[Command::Remove { client: 1 }]);
    let before = world.bend().snow().expect("snow lies").state();
    (0..1200).for_each(|_| world.step(&[]));
    let snow = world.bend().snow().expect("snow lies");
    assert_eq!(world.bend().field().awake_count(), 0, "the grass sleeps");
    let mut after = before.clone();
    snow.save_into(&mut after);
    assert!(snow.patches().count() > 1 && after.cells() == before.cells());
}
