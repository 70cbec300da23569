//! Posts of gates: in the way of every vehicle, of its prediction, and of those who look for a place to start.

use anyhow::{Context as _, Result};
use prairie::charts::worlds;
use prairie::objects::Environment;
use prairie::world::{Camera, Command, World};
use prairie_core::body::BodyPose;
use prairie_core::race::{GatePost, POST_HALF_M};
use prairie_core::scene::{RaceGate, Scene, VehicleKind};
use prairie_core::wire::Drive;
use prairie_vehicles::{LoneVehicle, TerrainColliders, VehicleMotion};
use std::sync::Arc;

/// Error bound of a prediction (m), as in [`LoneVehicle`].
const ERROR_M: f32 = 0.25;

/// A scene of 128 m with a circuit, or without for the controls. Its first gate is passed towards the east.
fn scene(has_gates: bool) -> Scene {
    let east = RaceGate { width_m: 8.0, ..RaceGate::new([80.0, 60.0], std::f32::consts::FRAC_PI_2) };
    let mut scene = worlds::scene(8);
    scene.race.gates = if has_gates { vec![east, RaceGate::new([30.0, 30.0], 0.0)] } else { vec![] };
    scene
}

fn environment(scene: &Scene) -> Environment {
    let maps = worlds::maps(scene, |_, _| 0.0, |_, _| 255);
    Environment { height: Arc::new(maps.height), cover: Arc::new(maps.cover), extent_m: scene.extent_m() }
}

/// The left post of the first gate.
fn post() -> GatePost {
    GatePost::pair(&scene(true).race.gates[0], |_, _| 0.0)[0]
}

/// Input that drives a kind straight ahead, near the ground.
fn ahead(kind: VehicleKind) -> Drive {
    let lift = match kind {
        VehicleKind::Helicopter => 0.02,
        // It runs.
        VehicleKind::Walker => -1.0,
        _ => 0.0,
    };
    Drive { throttle: 0.6, lift, ..Drive::default() }
}

/// Largest distance beyond the post (m) of the middle of a vehicle that drives at it from the west for 5 s, and its way in a step at its fastest (m).
fn driven_at_the_post_m(kind: VehicleKind, has_gates: bool) -> [f32; 2] {
    let scene = scene(has_gates);
    let mut vehicle = LoneVehicle::new(&scene, environment(&scene), kind);
    let [x, z] = post().at_m;
    vehicle.place([x - 12.0, scene.objects.half_extents_m(kind)[1] + 0.05, z], std::f32::consts::FRAC_PI_2);
    let (mut beyond_m, mut step_m) = (f32::MIN, 0.0_f32);
    for _ in 0..300 {
        vehicle.step(ahead(kind), |_| [0.0; 3]);
        let motion = vehicle.motion();
        beyond_m = beyond_m.max(motion.pose.position_m[0] - x);
        step_m = step_m.max(motion.velocity_m_per_s[0] * scene.dt_secs());
    }
    [beyond_m, step_m]
}

#[test]
fn every_vehicle_runs_into_a_post() {
    for kind in VehicleKind::ALL {
        let [[stopped_m, step_m], [through_m, _]] = [true, false].map(|has_gates| driven_at_the_post_m(kind, has_gates));
        let half_m = scene(true).objects.half_extents_m(kind);
        let front_m = match kind {
            // Its front is open; its crossbar begins 1.7 m behind its middle.
            VehicleKind::Sled => -1.7,
            // The lower corner of its nose, which is nearest to it where it tilts by 30°, as it does at most.
            VehicleKind::Helicopter => half_m[2] * 0.866 - half_m[1] * 0.5,
            _ => half_m[2],
        };
        println!("{}: {stopped_m:.2} m beyond a post, {through_m:.2} m without; {step_m:.2} m in a step", kind.name());
        // A step may end as deep in the post as the vehicle goes in it.
        assert!(stopped_m < 0.15 + step_m - front_m - POST_HALF_M, "a {} goes {stopped_m} m beyond the post", kind.name());
        assert!(through_m > 1.0, "without posts a {} goes {through_m} m beyond", kind.name());
    }
}

#[test]
fn a_prediction_runs_into_the_post_as_the_server_does() -> Result<()> {
    let (scene, [x, z]) = (scene(true), post().at_m);
    for kind in [VehicleKind::Car, VehicleKind::Walker] {
        let mut world = World::new(&scene, worlds::maps(&scene, |_, _| 0.0, |_, _| 255))?;
        // The first place is 9 m to the east of the camera, heading away from it.
        let view = Camera { client: 1, eye_m: [x - 17.0, 2.0, z] };
        world.step(&[Command::Cameras(vec![view])]);
        world.step(&[Command::Spawn { client: 1, kind }]);
        let mut lone = LoneVehicle::new(&scene, environment(&scene), kind);
        let (mut apart_m, mut nearest_m) = (0.0_f32, f32::MAX);
        // As with each frame of a client, the prediction goes on from the server's motion, and is compared 9 steps later.
        for tick in 0..240_u32 {
            let pose = *world.snapshot().objects.first().context("a vehicle")?;
            if tick % 9 == 0 {
                let pose_now = BodyPose { position_m: pose.position_m, rotation: pose.rotation };
                lone.assume(&VehicleMotion { pose: pose_now, velocity_m_per_s: pose.velocity_m_per_s, ..lone.motion() });
            }
            world.step(&[Command::Drive { client: 1, number: 0, drive: ahead(kind) }]);
            lone.step(ahead(kind), |_| [0.0; 3]);
            let ([at_x, _, at_z], [own_x, _, own_z]) = (world.snapshot().objects[0].position_m, lone.motion().pose.position_m);
            apart_m = apart_m.max((at_x - own_x).hypot(at_z - own_z));
            nearest_m = nearest_m.min((at_x - x).hypot(at_z - z));
        }
        println!("{}: {nearest_m:.2} m from the post at the least; the prediction is {apart_m:.4} m apart", kind.name());
        assert!(nearest_m < 2.6, "it meets the post: {nearest_m} m");
        assert!(apart_m < ERROR_M, "the prediction of a {} is {apart_m} m apart", kind.name());
    }
    Ok(())
}

#[test]
fn nobody_starts_in_a_post() {
    let [with, without] = [true, false].map(|has_gates| {
        let scene = scene(has_gates);
        TerrainColliders::new(&environment(&scene), &scene)
    });
    let [x, z] = post().at_m;
    assert!(!with.is_free([x + 1.0, z], 1.0) && with.is_free([x + 1.5, z], 1.0));
    assert!(without.is_free([x, z], 1.0), "the control");
}

#[test]
fn a_collision_with_a_post_has_the_same_bits_each_time() -> Result<()> {
    let run = |has_gates: bool| -> Result<u64> {
        let scene = scene(has_gates);
        let mut world = World::new(&scene, worlds::maps(&scene, |_, _| 0.0, |_, _| 255))?;
        let [x, z] = post().at_m;
        world.step(&[Command::Cameras(vec![Camera { client: 1, eye_m: [x - 17.0, 2.0, z] }])]);
        world.step(&[
            Command::Spawn { client: 1, kind: VehicleKind::Car },
            Command::Drive { client: 1, number: 0, drive: ahead(VehicleKind::Car) },
        ]);
        (0..150).for_each(|_| world.step(&[]));
        // With the same poses the sums would be equal.
        Ok(world.checksum())
    };
    assert_eq!(run(true)?, run(true)?);
    assert_ne!(run(true)?, run(false)?, "the control");
    Ok(())
}
