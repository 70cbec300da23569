//! Heavy objects flatten grass for longer: tracks stay, fade with a time constant of their own, and are shown though their patches sleep.

use server::bend::laid::{self, QUANTUM_RAD, TILE_BYTES};
use server::world::{Command, View, World};
use shared::bend::{Field, Kinds, WaveParams};
use shared::grid::PatchLayout;
use shared::scene::{Grass, Scene, VehicleKind};
use shared::wire::Drive;
use shared::wire::quantise::{omega_rad_per_s, theta_rad};
use tests::worlds;

const AHEAD: Drive = Drive { throttle: 1.0, steer: 0.0, lift: 0.0, brake: 0.0 };

fn run(world: &mut World, secs: f32) {
    (0..(secs * 60.0).round() as u32).for_each(|_| world.step(&[]));
}

fn look_from(world: &mut World, eye_m: [f32; 3]) {
    world.step(&[Command::Views(vec![View { client: 1, eye_m }])]);
}

/// A world in which a car has driven for five seconds, and is gone.
fn driven(scene: &Scene) -> World {
    let mut world = worlds::flat(scene);
    look_from(&mut world, [128.0, 2.0, 200.0]);
    world.step(&[Command::Spawn { client: 1, kind: VehicleKind::Car }, Command::Drive { client: 1, drive: AHEAD }]);
    run(&mut world, 5.0);
    world.step(&[Command::Remove { client: 1 }]);
    world
}

#[test]
fn an_awake_cell_holds_at_most_32_bytes_with_what_is_laid() {
    let layout = PatchLayout { count: [3; 2], cells: 120, cell_m: 0.4572 };
    let mut field = Field::new(layout, Kinds::one(WaveParams::from(&Grass::default())));
    assert_eq!(field.memory_bytes(), 0, "grass that sleeps holds none");
    field.wake(4);
    let bytes = field.memory_bytes() as f64 / 120.0_f64.powi(2) + TILE_BYTES as f64 / (laid::TILE as f64).powi(2);
    assert!(bytes > 24.0 && bytes <= 32.0, "{bytes} bytes a cell");
}

/// Cells that a client is shown as bent, and the largest bend among them (rad).
fn shown(world: &mut World) -> (usize, f32) {
    let snapshot = world.snapshot();
    let thetas = snapshot.patches.values().flat_map(|patch| patch.codes[..patch.codes.len() / 3].to_vec());
    let bent: Vec<f32> = thetas.filter(|&code| code != 0).map(|code| theta_rad(code).abs()).collect();
    (bent.len(), bent.into_iter().fold(0.0, f32::max))
}

#[test]
fn a_track_stays_where_weight_has_laid_the_grass_and_goes_where_it_has_not() {
    let mut scene = worlds::scene(16);
    let mut world = driven(&scene);
    run(&mut world, 30.0);
    assert_eq!(world.meadow().field().awake_count(), 0, "what only is laid costs no step");
    let (cells, largest_rad) = shown(&mut world);
    // Half of 1.45 rad, less half a time constant.
    assert!(cells > 200 && (0.35..0.5).contains(&largest_rad), "{cells} cells, up to {largest_rad} rad");

    scene.objects.car.lays_share = 0.0;
    let mut world = driven(&scene);
    run(&mut world, 30.0);
    assert_eq!(shown(&mut world), (0, 0.0));
    assert_eq!(world.meadow().laid().tiles(), 0);
}

#[test]
fn a_track_fades_by_its_own_time_constant() {
    let mut scene = worlds::scene(16);
    scene.grass.laid_recovery_secs = 20.0;
    let mut world = driven(&scene);
    run(&mut world, 1.0);
    let laid = |world: &World| {
        let laid = world.meadow().laid();
        laid.patches()
            .flat_map(|patch| laid.cells(patch).map(move |(cell, lean)| (patch, cell, lean)).collect::<Vec<_>>())
            .collect::<Vec<_>>()
    };
    let at_first = laid(&world);
    assert!(at_first.len() > 200);
    for second in 1..=40 {
        run(&mut world, 1.0);
        let share = (-f64::from(second) / 20.0).exp() as f32;
        for (patch, [i, j], lean_rad) in &at_first {
            let found = world.meadow().laid().lean_rad(*patch, *i, *j);
            for axis in 0..2 {
                let off_rad = (found[axis] - lean_rad[axis] * share).abs();
                assert!(off_rad <= 2.0 * QUANTUM_RAD, "after {second} s {off_rad} rad off");
            }
        }
    }
    run(&mut world, 60.0);
    assert_eq!(world.meadow().laid().tiles(), 0, "and ends");
    assert_eq!(shown(&mut world), (0, 0.0));
}

#[test]
fn tracks_are_shown_near_cameras_only_and_not_anew_when_nothing_has_changed() {
    let mut scene = worlds::scene(96);
    scene.grass.laid_recovery_secs = 1000.0;
    let mut world = driven(&scene);
    run(&mut world, 30.0);
    let (cells, _) = shown(&mut world);
    assert!(cells > 200);
    let before = world.snapshot().patches;
    world.step(&[]);
    let after = world.snapshot().patches;
    assert!(before.iter().all(|(index, codes)| std::sync::Arc::ptr_eq(codes, &after[index])), "the same memory");
    look_from(&mut world, [1500.0, 2.0, 1500.0]);
    assert_eq!(shown(&mut world).0, 0, "no camera is near");
    look_from(&mut world, [128.0, 2.0, 200.0]);
    assert_eq!(shown(&mut world).0, cells, "a camera comes back");
}

#[test]
fn what_is_shown_points_the_way_that_the_grass_lies() {
    let mut world = driven(&worlds::scene(16));
    run(&mut world, 20.0);
    let snapshot = world.snapshot();
    let mut agree = 0;
    for (&index, patch) in snapshot.patches.iter() {
        let plane = patch.codes.len() / 3;
        for ([i, j], [x, z]) in world.meadow().laid().cells(index).filter(|(_, [x, z])| x.hypot(*z) > 0.1) {
            let at = j * 64 + i;
            let (bend_rad, omega) = (theta_rad(patch.codes[at]), [plane, 2 * plane].map(|start| omega_rad_per_s(patch.codes[start + at])));
            let speed = omega[0].hypot(omega[1]);
            let along = (omega[0] * x + omega[1] * z) / (speed * x.hypot(z));
            assert!((bend_rad - x.hypot(z)).abs() < 0.02 && along > 0.95, "shown {bend_rad} rad along {omega:?}, laid {x}, {z}");
            agree += 1;
        }
    }
    assert!(agree > 200);
}
