//! Vehicles stay on the terrain, in the world and apart, and follow their controls.

use prairie::charts::worlds;
use prairie::objects::{Environment, Objects};
use prairie::world::{Camera, Command, World};
use prairie_core::scene::VehicleKind::{Ball, Car, Helicopter, Monster, Sled, Walker};
use prairie_core::scene::{Scene, VehicleKind};
use prairie_core::wire::{Drive, ObjectPose};
use std::sync::Arc;

fn spawn(world: &mut World, client: u32, kind: VehicleKind) {
    world.step(&[Command::Spawn { client, kind }]);
    assert!(world.object_of(client).is_some(), "no room for a {}", kind.name());
}

fn drive(world: &mut World, client: u32, drive: Drive, ticks: u32) -> ObjectPose {
    world.step(&[Command::Drive { client, number: 0, drive }]);
    (1..ticks).for_each(|_| world.step(&[]));
    pose(world, client)
}

fn pose(world: &mut World, client: u32) -> ObjectPose {
    let id = world.object_of(client).expect("the client has a vehicle");
    *world.snapshot().objects.iter().find(|pose| pose.id == id).expect("a vehicle has a pose")
}

fn speed(pose: &ObjectPose) -> f32 {
    let [x, _, z] = pose.velocity_m_per_s;
    x.hypot(z)
}

const AHEAD: Drive = Drive { throttle: 1.0, steer: 0.0, lift: 0.0, brake: 0.0 };

#[test]
fn a_car_rests_accelerates_steers_and_brakes() {
    let mut world = worlds::flat(&worlds::scene(30));
    spawn(&mut world, 1, Car);
    let standing = drive(&mut world, 1, Drive::default(), 120);
    assert!(speed(&standing) < 0.05 && (standing.position_m[1] - 0.7).abs() < 0.08, "{standing:?}");
    let fast = drive(&mut world, 1, AHEAD, 360);
    assert!(speed(&fast) > 20.0, "after 6 s: {} m/s", speed(&fast));
    let turning = drive(&mut world, 1, Drive { steer: 1.0, throttle: 0.3, ..AHEAD }, 60);
    let turned = fast.velocity_m_per_s[0] * turning.velocity_m_per_s[2] - fast.velocity_m_per_s[2] * turning.velocity_m_per_s[0];
    assert!(turned > 0.0 && turning.part_rad > 0.0, "right is from −Z to +X: {turned}");
    let stopped = drive(&mut world, 1, Drive { brake: 1.0, ..Drive::default() }, 300);
    assert!(speed(&stopped) < 0.3, "after 5 s of braking: {} m/s", speed(&stopped));
}

#[test]
fn a_second_car_drives_off_from_land_that_is_already_there() -> anyhow::Result<()> {
    for second_x_m in [10.0, 12.0, 14.0, 16.0, 18.0, 20.0] {
        let mut loaded = prairie::scenes::load("blades")?;
        loaded.scene.objects.self_driving = 0;
        let mut world = World::new(&loaded.scene, loaded.maps())?;
        let cameras = [(1, 2.0), (2, second_x_m)].map(|(client, x_m)| Camera { client, eye_m: [x_m, 2.0, 24.0] });
        world.step(&[Command::Cameras(cameras.to_vec())]);
        for client in [1, 2] {
            spawn(&mut world, client, Car);
            let [x_m, _, z_m] = pose(&mut world, client).position_m;
            let [x_after_m, _, z_after_m] = drive(&mut world, client, AHEAD, 60).position_m;
            let driven_m = (x_after_m - x_m).hypot(z_after_m - z_m);
            anyhow::ensure!(driven_m > 1.0, "car {client} of the page at {second_x_m} m drove {driven_m} m from {x_m}, {z_m} m");
        }
    }
    Ok(())
}

#[test]
fn a_car_climbs_a_hill() {
    let scene = worlds::scene(12);
    let maps = worlds::maps(&scene, |_, z| (0.25 * (90.0 - z)).clamp(0.0, 15.0), |_, _| 255);
    let mut world = World::new(&scene, maps).expect("a sound scene");
    let view = Camera { client: 1, eye_m: [96.0, 2.0, 120.0] };
    world.step(&[Command::Cameras(vec![view])]);
    spawn(&mut world, 1, Car);
    // Turn until heading north, then climb.
    for _ in 0..1200 {
        let [_, y, _, w] = pose(&mut world, 1).rotation;
        let heading = -2.0 * y.atan2(w);
        let heading = (heading + std::f32::consts::PI).rem_euclid(std::f32::consts::TAU) - std::f32::consts::PI;
        drive(&mut world, 1, Drive { throttle: 0.6, steer: (-2.0 * heading).clamp(-1.0, 1.0), ..AHEAD }, 1);
    }
    let top = pose(&mut world, 1);
    assert!(top.position_m[1] > 12.0, "{top:?}");
}

#[test]
fn a_minute_of_wild_driving_stays_on_the_terrain_and_in_the_world() {
    for seed in 1..=3_u32 {
        let scene = Scene { seed: seed.into(), ..worlds::scene(10) };
        let mut world = worlds::hills(&scene);
        let mut random = seed.wrapping_mul(2_654_435_769);
        let mut next = || {
            random ^= random << 13;
            random ^= random >> 17;
            random ^= random << 5;
            (random >> 8) as f32 / 8_388_608.0 - 1.0
        };
        let kinds = [Car, Monster, Helicopter, Sled, Ball, Walker];
        for (client, kind) in (0..).zip(kinds) {
            spawn(&mut world, client, kind);
        }
        let land = worlds::hills_m;
        for tick in 0..3600 {
            let commands: Vec<_> = (0..6)
                .filter(|_| tick % 45 == 0)
                .map(|client| Command::Drive {
                    client,
                    number: 0,
                    drive: Drive { throttle: next(), steer: next(), lift: next(), brake: next().max(0.0) * 0.2 },
                })
                .collect();
            world.step(&commands);
            if tick % 10 == 0 {
                for pose in world.snapshot().objects {
                    let [x, y, z] = pose.position_m;
                    assert!([x, y, z].iter().chain(&pose.rotation).all(|v| v.is_finite()), "{pose:?}");
                    assert!((0.0..=160.0).contains(&x) && (0.0..=160.0).contains(&z), "outside: {pose:?}");
                    assert!(y > land(x, z) - 0.1, "below the land ({}) at tick {tick}: {pose:?}", land(x, z));
                    assert!(pose.kind == Helicopter || y < land(x, z) + 15.0, "in the sky at tick {tick}: {pose:?}");
                }
            }
        }
    }
}

#[test]
fn an_overturned_car_rights_itself() {
    // A steep dam for falling off sideways.
    let scene = worlds::scene(8);
    let maps = worlds::maps(&scene, |x, _| if (60.0..68.0).contains(&x) { 5.0 } else { 0.0 }, |_, _| 255);
    let mut world = World::new(&scene, maps).expect("a sound scene");
    for client in 0..4 {
        spawn(&mut world, client, Car);
    }
    for client in 0..4 {
        drive(&mut world, client, Drive { throttle: 1.0, steer: if client % 2 == 0 { 1.0 } else { -0.7 }, ..AHEAD }, 300);
    }
    for client in 0..4 {
        let pose = drive(&mut world, client, Drive { brake: 1.0, ..Drive::default() }, 900);
        let [x, _, z, _] = pose.rotation;
        assert!(1.0 - 2.0 * (x * x + z * z) > 0.4, "up axis of {pose:?}");
    }
}

#[test]
fn a_monster_walks_on_the_terrain() {
    let scene = worlds::scene(10);
    let mut world = worlds::hills(&scene);
    spawn(&mut world, 1, Monster);
    for _ in 0..20 {
        let pose = drive(&mut world, 1, Drive { steer: 0.2, ..AHEAD }, 30);
        let [x, y, z] = pose.position_m;
        assert!((y - 0.9 - worlds::hills_m(x, z)).abs() < 0.3, "feet at {}, land at {}", y - 0.9, worlds::hills_m(x, z));
    }
}

#[test]
fn a_walker_walks_runs_and_jumps() {
    let mut world = worlds::hills(&worlds::scene(10));
    spawn(&mut world, 1, Walker);
    let feet_m = |pose: &ObjectPose| pose.position_m[1] - 0.9 - worlds::hills_m(pose.position_m[0], pose.position_m[2]);
    let walks = drive(&mut world, 1, AHEAD, 60);
    assert!((1.2..1.9).contains(&speed(&walks)) && feet_m(&walks).abs() < 0.1, "{walks:?}");
    let runs = drive(&mut world, 1, Drive { lift: -1.0, ..AHEAD }, 60);
    assert!((3.5..5.1).contains(&speed(&runs)) && feet_m(&runs).abs() < 0.2, "{runs:?}");
    // One jump for each press, however long it is held.
    let jump = Drive { lift: 1.0, ..AHEAD };
    let highest_m = |world: &mut World, drive_: Drive| (0..60).map(|_| feet_m(&drive(world, 1, drive_, 1))).fold(0.0, f32::max);
    let jumped_m = highest_m(&mut world, jump);
    assert!((0.4..0.9).contains(&jumped_m), "{jumped_m} m high");
    let [held_m, walked_m, again_m] = [jump, AHEAD, jump].map(|drive| highest_m(&mut world, drive));
    assert!(held_m < 0.2 && walked_m < 0.2 && again_m > 0.4, "{held_m} m while it is held, {walked_m} m without, {again_m} m again");
    let stands = drive(&mut world, 1, Drive::default(), 60);
    assert!(speed(&stands) < 0.05 && feet_m(&stands).abs() < 0.05, "{stands:?}");
}

#[test]
fn a_sled_glides_over_the_terrain_and_tilts_with_it() {
    let scene = worlds::scene(24);
    let mut world = worlds::hills(&scene);
    spawn(&mut world, 1, Sled);
    let mut fastest = 0.0_f32;
    for _ in 0..30 {
        let pose = drive(&mut world, 1, Drive { steer: 0.3, ..AHEAD }, 20);
        let [x, y, z] = pose.position_m;
        assert!((y - 0.35 - worlds::hills_m(x, z)).abs() < 0.35, "floor at {}, land at {}", y - 0.25, worlds::hills_m(x, z));
        let slope = [worlds::hills_m(x + 0.1, z) - worlds::hills_m(x - 0.1, z), worlds::hills_m(x, z + 0.1) - worlds::hills_m(x, z - 0.1)];
        let land = glam::Vec3::new(-slope[0], 0.2, -slope[1]).normalize();
        let up = glam::Quat::from_array(pose.rotation) * glam::Vec3::Y;
        assert!(up.dot(land) > 0.9, "up {up}, land {land}");
        fastest = fastest.max(speed(&pose));
    }
    assert!((10.0..16.0).contains(&fastest), "{fastest} m/s");
    let stopped = drive(&mut world, 1, Drive { brake: 1.0, ..Drive::default() }, 240);
    assert!(speed(&stopped) < 0.3, "after 4 s of braking: {} m/s", speed(&stopped));
}

/// Serde itself lists the variants of the enum: a kind missing from `ALL` or `WORDS` is found.
#[test]
fn every_kind_of_vehicle_is_listed_with_its_name() {
    let error = serde_json::from_str::<VehicleKind>("\"submarine\"").expect_err("there is no such kind").to_string();
    let variants: Vec<&str> = error.split('`').skip(3).step_by(2).collect();
    assert_eq!(variants, VehicleKind::ALL.map(VehicleKind::name), "{error}");
}

#[test]
fn vehicles_of_every_kind_drive_themselves() {
    for kind in VehicleKind::ALL {
        let mut scene = worlds::scene(20);
        (scene.objects.self_driving, scene.objects.self_driving_kind) = (3, kind);
        // A gust against a ball may make it slow for a moment.
        scene.wind.turbulence = 0.0;
        let mut world = worlds::flat(&scene);
        (0..600).for_each(|_| world.step(&[]));
        let poses = world.snapshot().objects;
        assert!(poses.len() == 3 && poses.iter().all(|pose| pose.kind == kind && speed(pose) > 2.0), "{poses:?}");
        assert!(kind != Helicopter || poses.iter().all(|pose| (3.0..10.0).contains(&pose.position_m[1])), "{poses:?}");
    }
}

#[test]
fn a_helicopter_climbs_hovers_flies_and_lands() {
    let mut world = worlds::flat(&worlds::scene(30));
    spawn(&mut world, 1, Helicopter);
    let up = drive(&mut world, 1, Drive { lift: 1.0, ..Drive::default() }, 240);
    assert!(up.position_m[1] > 15.0, "{up:?}");
    let settled = drive(&mut world, 1, Drive::default(), 180);
    let hovering = drive(&mut world, 1, Drive::default(), 600);
    let drift: f32 = (0..3).map(|axis| (hovering.position_m[axis] - settled.position_m[axis]).powi(2)).sum::<f32>().sqrt();
    assert!(drift < 0.3, "drifted {drift} m in 10 s");
    assert!(speed(&drive(&mut world, 1, AHEAD, 480)) > 20.0);
    drive(&mut world, 1, Drive::default(), 300);
    let landed = drive(&mut world, 1, Drive { lift: -1.0, ..Drive::default() }, 900);
    assert!((landed.position_m[1] - 1.3).abs() < 0.1 && speed(&landed) < 0.05, "{landed:?}");
}

#[test]
fn objects_start_apart_and_never_exceed_the_limit() {
    let mut scene = worlds::scene(16);
    scene.objects.limit = 40;
    let mut world = worlds::hills(&scene);
    let view = Camera { client: 7, eye_m: [100.0, 2.0, 60.0] };
    let mut commands = vec![Command::Cameras(vec![view])];
    commands.extend((0..50).map(|client| Command::Spawn { client, kind: VehicleKind::ALL[client as usize % VehicleKind::ALL.len()] }));
    world.step(&commands);
    assert_eq!((0..50).filter(|&client| world.object_of(client).is_none()).count(), 10);
    let objects = world.snapshot().objects;
    assert_eq!(objects.len(), 40);
    for (n, a) in objects.iter().enumerate() {
        for b in &objects[..n] {
            let reach: f32 = [a, b].map(|pose| scene.objects.half_extents_m(pose.kind)).iter().map(|[x, _, z]| x.max(*z)).sum();
            let [x, z] = [a.position_m[0] - b.position_m[0], a.position_m[2] - b.position_m[2]];
            assert!(x.hypot(z) > reach, "{a:?} in {b:?}");
        }
    }
    let near = pose(&mut world, 7).position_m;
    assert!((near[0] - 100.0).hypot(near[2] - 60.0) < 40.0, "appears near the camera: {near:?}");
    world.step(&[Command::Remove { client: 7 }]);
    assert_eq!(world.object_of(7), None);
    world.step(&[Command::Spawn { client: 7, kind: Car }, Command::Spawn { client: 7, kind: Monster }]);
    assert_eq!(world.snapshot().objects.len(), 40, "choosing again gives the first up");
}

#[test]
fn absurd_terrain_and_constants_give_finite_poses() {
    let mut scene = worlds::scene(4);
    scene.grass.waves.c0_m_per_s = 50.0;
    scene.grass.waves.theta_damping_per_s = 200.0;
    scene.grass.waves.stiffness_per_s2 = 10_000.0;
    scene.objects.self_driving = 4;
    let spikes = |x: f32, z: f32| if ((x + z) / 2.0) as i32 % 2 == 0 { 40.0 } else { 0.0 };
    let mut world = World::new(&scene, worlds::maps(&scene, spikes, |_, _| 253)).expect("a sound scene");
    for (client, kind) in (0..).zip(VehicleKind::ALL) {
        world.step(&[Command::Spawn { client, kind }, Command::Drive { client, number: 0, drive: AHEAD }]);
    }
    for _ in 0..600 {
        world.step(&[]);
    }
    let snapshot = world.snapshot();
    assert!(snapshot.diagnostics.bend_activity.is_finite() && snapshot.diagnostics.wind_energy.is_finite());
    for pose in snapshot.objects {
        assert!(pose.position_m.iter().chain(&pose.rotation).chain(&pose.velocity_m_per_s).all(|v| v.is_finite()), "{pose:?}");
    }
    scene.grass.waves.mu_m_per_rad = 10.0;
    let maps = worlds::maps(&scene, spikes, |_, _| 255);
    let refused = World::new(&scene, maps).err().expect("too many sub-steps").to_string();
    assert!(refused.contains("mu_m_per_rad = 10") && refused.contains("allowed: 64"), "{refused}");
}

/// The scene `continuum` with only the given self-driving cars, at 20 m/s.
fn self_driving(cars: u32, apart_m: f32) -> (Scene, Objects) {
    let (scene, maps) = worlds::continuum(cars, apart_m);
    let environment = Environment { height: Arc::new(maps.height), cover: Arc::new(maps.cover), extent_m: scene.extent_m() };
    let objects = Objects::new(&scene, environment);
    assert_eq!(objects.poses().len(), cars as usize);
    (scene, objects)
}

#[test]
fn self_driving_cars_start_at_the_requested_distance() {
    for (cars, apart_m) in [(64, 200.0), (256, 140.0)] {
        let (scene, objects) = self_driving(cars, apart_m);
        let poses = objects.poses();
        for (n, a) in poses.iter().enumerate() {
            assert!([0, 2].iter().all(|&axis| (0.0..scene.extent_m()[0]).contains(&a.position_m[axis])), "{a:?}");
            for b in &poses[..n] {
                let [x, z] = [0, 2].map(|axis| a.position_m[axis] - b.position_m[axis]);
                assert!(x.hypot(z) > apart_m, "{cars} cars: {} and {} start {} m apart", a.id, b.id, x.hypot(z));
            }
        }
    }
}

#[test]
fn self_driving_cars_hold_their_speed_on_wide_circles() {
    let (scene, mut objects) = self_driving(64, 200.0);
    let starts = objects.poses();
    for tick in 1..=2400 {
        objects.step(scene.dt_secs(), |_| [0.0; 3]);
        let poses = objects.poses();
        for (pose, start) in poses.iter().zip(&starts) {
            let [x, z] = [0, 2].map(|axis| pose.position_m[axis] - start.position_m[axis]);
            assert!(x.hypot(z) < 300.0, "tick {tick}: car {} has gone {} m from where it started", pose.id, x.hypot(z));
        }
        // A car that has hit a stone, a tree or another car backs off and regains its speed.
        let delayed: Vec<_> = poses.iter().filter(|pose| (speed(pose) - 20.0).abs() > 1.5).map(|pose| (pose.id, speed(pose))).collect();
        assert!(tick < 600 || delayed.len() <= 6, "tick {tick}: {delayed:?}");
    }
}
