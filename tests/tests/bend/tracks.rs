//! Heavy objects flatten the grass: tracks stay, fade with their own time constant, and are sent although their patches sleep.

use prairie::charts::worlds;
use prairie::snapshot::PatchQuantiser;
use prairie::world::{Camera, Command, World};
use prairie_core::bend::{Field, Kinds, TILE};
use prairie_core::grass::flattened::{QUANTUM_RAD, TILE_BYTES};
use prairie_core::grid::PatchLayout;
use prairie_core::scene::{Grass, Scene, VehicleKind};
use prairie_core::wire::Drive;
use prairie_core::wire::quantise::CodeSteps;

const AHEAD: Drive = Drive { throttle: 1.0, steer: 0.0, lift: 0.0, brake: 0.0 };

fn run(world: &mut World, secs: f32) {
    (0..(secs * 60.0).round() as u32).for_each(|_| world.step(&[]));
}

fn look_from(world: &mut World, eye_m: [f32; 3]) {
    world.step(&[Command::Cameras(vec![Camera { client: 1, eye_m }])]);
}

/// A world after a car has driven for five seconds and been removed.
fn driven(scene: &Scene) -> World {
    let mut world = worlds::flat(scene);
    look_from(&mut world, [128.0, 2.0, 200.0]);
    world.step(&[Command::Spawn { client: 1, kind: VehicleKind::Car }, Command::Drive { client: 1, number: 0, drive: AHEAD }]);
    run(&mut world, 5.0);
    world.step(&[Command::Remove { client: 1 }]);
    world
}

#[test]
fn an_awake_cell_with_its_flattened_grass_takes_at_most_32_bytes() {
    let layout = PatchLayout { count: [3; 2], cells: 120, cell_m: 0.4572 };
    let mut field = Field::new(layout, Kinds::one(Grass::default().waves));
    assert_eq!(field.memory_bytes(), 0, "grass that sleeps holds none");
    field.wake(4);
    let bytes = field.memory_bytes() as f64 / 120.0_f64.powi(2) + TILE_BYTES as f64 / (TILE as f64).powi(2);
    assert!(bytes > 24.0 && bytes <= 32.0, "{bytes} bytes a cell");
}

/// Number of bent cells sent to a client, and the largest bend among them (rad).
fn shown(world: &mut World) -> (usize, f32) {
    let snapshot = world.snapshot();
    let thetas = snapshot.patches.values().flat_map(|patch| patch.codes[..patch.codes.len() / 3].to_vec());
    let bent: Vec<f32> = thetas.filter(|&code| code != 0).map(|code| CodeSteps::default().theta_rad(code).abs()).collect();
    (bent.len(), bent.into_iter().fold(0.0, f32::max))
}

#[test]
fn a_track_stays_only_where_weight_has_flattened_the_grass() {
    let mut scene = worlds::scene(16);
    let mut world = driven(&scene);
    run(&mut world, 30.0);
    assert_eq!(world.bend().field().awake_count(), 0, "flattened grass at rest costs no step");
    let (cells, largest_rad) = shown(&mut world);
    // Half of 1.45 rad, less half a time constant.
    assert!(cells > 200 && (0.35..0.5).contains(&largest_rad), "{cells} cells, up to {largest_rad} rad");

    scene.objects.car.lays_share = 0.0;
    let mut world = driven(&scene);
    run(&mut world, 30.0);
    assert_eq!(shown(&mut world), (0, 0.0));
    assert_eq!(world.bend().flattened().tiles(), 0);
}

#[test]
fn a_track_fades_by_its_own_time_constant() {
    let mut scene = worlds::scene(16);
    scene.grass.laid_recovery_secs = 20.0;
    let mut world = driven(&scene);
    run(&mut world, 1.0);
    let flattened = |world: &World| {
        let flattened = world.bend().flattened();
        flattened
            .patches()
            .flat_map(|patch| flattened.cells(patch).map(move |(cell, lean)| (patch, cell, lean)).collect::<Vec<_>>())
            .collect::<Vec<_>>()
    };
    let at_first = flattened(&world);
    assert!(at_first.len() > 200);
    for second in 1..=40 {
        run(&mut world, 1.0);
        let fraction = (-f64::from(second) / 20.0).exp() as f32;
        for (patch, [i, j], lean_rad) in &at_first {
            let found = world.bend().flattened().lean_rad(*patch, *i, *j);
            for axis in 0..2 {
                let off_rad = (found[axis] - lean_rad[axis] * fraction).abs();
                assert!(off_rad <= 2.0 * QUANTUM_RAD, "after {second} s {off_rad} rad off");
            }
        }
    }
    run(&mut world, 60.0);
    assert_eq!(world.bend().flattened().tiles(), 0, "and ends");
    assert_eq!(shown(&mut world), (0, 0.0));
}

#[test]
fn tracks_are_sent_only_near_cameras_and_only_when_changed() {
    let mut scene = worlds::scene(96);
    scene.grass.laid_recovery_secs = 1000.0;
    let mut world = driven(&scene);
    run(&mut world, 30.0);
    let (cells, _) = shown(&mut world);
    assert!(cells > 200);
    let mut quantiser = PatchQuantiser::default();
    let before = world.publish(&mut quantiser).patches;
    world.step(&[]);
    let after = world.publish(&mut quantiser).patches;
    assert!(before.iter().all(|(index, codes)| std::sync::Arc::ptr_eq(codes, &after[index])), "the same memory");
    look_from(&mut world, [1500.0, 2.0, 1500.0]);
    assert_eq!(shown(&mut world).0, 0, "no camera is near");
    look_from(&mut world, [128.0, 2.0, 200.0]);
    assert_eq!(shown(&mut world).0, cells, "a camera comes back");
}

#[test]
fn the_sent_direction_is_that_of_the_flattened_grass() {
    let mut world = driven(&worlds::scene(16));
    run(&mut world, 20.0);
    let snapshot = world.snapshot();
    let (steps, mut agree) = (CodeSteps::default(), 0);
    for (&index, patch) in snapshot.patches.iter() {
        let plane = patch.codes.len() / 3;
        for ([i, j], [x, z]) in world.bend().flattened().cells(index).filter(|(_, [x, z])| x.hypot(*z) > 0.1) {
            let at = j * 64 + i;
            let bend_rad = steps.theta_rad(patch.codes[at]);
            let omega = [plane, 2 * plane].map(|start| steps.omega_rad_per_s(patch.codes[start + at]));
            let speed = omega[0].hypot(omega[1]);
            let along = (omega[0] * x + omega[1] * z) / (speed * x.hypot(z));
            assert!((bend_rad - x.hypot(z)).abs() < 0.02 && along > 0.95, "shown {bend_rad} rad along {omega:?}, flattened {x}, {z}");
            agree += 1;
        }
    }
    assert!(agree > 200);
}
