//! The chase camera among the trees and hills of the meadow: it keeps out of crowns and above the land, and moves smoothly.

use anyhow::{Context as _, Result, ensure};
use glam::{Quat, Vec3};
use prairie::scenes;
use prairie_client::camera::Camera;
use prairie_client::controls::Controls;
use prairie_client::rig::Rig;
use prairie_client::sight::Sight;
use prairie_client::state::Mirror;
use prairie_core::scene::VehicleKind;
use prairie_core::wire::ObjectPose;

/// Time of a frame (s), and speed of the car (m/s).
const DT_SECS: f32 = 1.0 / 60.0;
const SPEED_M_PER_S: f32 = 12.0;
/// Frames of the drive: five minutes.
const FRAMES: u32 = 18_000;
/// Time after which the camera has reached a vehicle that was taken (s).
const TAKEN_SECS: f32 = 3.0;
/// Least height of the camera above the land (m), and largest movement of the camera between two frames, beyond that of the car (m).
const ABOVE_M: f32 = 0.3;
const JUMP_M: f32 = 2.0;

/// Findings of a drive.
#[derive(Debug, Default)]
struct Found {
    frames: u32,
    in_crown: u32,
    /// Frames in which the camera is in a crown though the car is not, and not as near to the car as it may come.
    avoidable: u32,
    lowest_m: f32,
    largest_jump_m: f32,
    jumps: u32,
}

/// A car on a winding way that keeps to the map: a Lissajous figure that passes trees at all distances, through them, too.
fn pose(secs: f32, extent_m: [f32; 2], ground_m: impl Fn(f32, f32) -> f32) -> ObjectPose {
    let rate = 2.0 * SPEED_M_PER_S / extent_m[0];
    let at = |secs: f32| {
        let turn = rate * secs;
        let [x, z] = [(turn * 1.0).sin(), (turn * 1.371 + 0.6).sin()];
        [(0.5 + 0.4 * x) * extent_m[0], (0.5 + 0.4 * z) * extent_m[1]]
    };
    let ([x, z], [ahead_x, ahead_z]) = (at(secs), at(secs + 0.05));
    let heading = (ahead_x - x).atan2(z - ahead_z);
    ObjectPose {
        id: 1,
        kind: VehicleKind::Car,
        position_m: [x, ground_m(x, z) + 0.7, z],
        rotation: Quat::from_rotation_y(-heading).to_array(),
        velocity_m_per_s: [(ahead_x - x) / 0.05, 0.0, (ahead_z - z) / 0.05],
        part_rad: 0.0,
    }
}

/// Follows the drive with a camera that knows the trees of `sight`; the crowns of `trees` are looked for.
fn follow(mirror: &Mirror, sight: &Sight, trees: &Sight) -> Result<Found> {
    let extent_m = mirror.decoded_scene().context("a scene")?.scene().extent_m();
    let ground_m = |x: f32, z: f32| mirror.ground_m(x, z);
    let mut rig = Rig::new(Camera::default(), 0.0);
    let mut found = Found { lowest_m: f32::INFINITY, ..Found::default() };
    let mut last: Option<(Vec3, Vec3)> = None;
    for frame in 0..FRAMES {
        let secs = frame as f32 * DT_SECS;
        let car = pose(secs, extent_m, ground_m);
        rig.advance(Controls::default(), Some(&car), sight, ground_m, DT_SECS);
        let (camera, car_m) = (rig.camera(), Vec3::from(car.position_m));
        if secs < TAKEN_SECS {
            continue;
        }
        let (eye_m, target_m) = (camera.eye_m, camera.target_m.context("a target")?);
        let is_inside = trees.is_in_crown(eye_m);
        // 8.48 m is the whole arm; a raised one is longer.
        let may_be = trees.is_in_crown(target_m) || eye_m.distance(target_m) < 0.36 * 8.48;
        found.frames += 1;
        found.in_crown += u32::from(is_inside);
        found.avoidable += u32::from(is_inside && !may_be);
        found.lowest_m = found.lowest_m.min(eye_m.y - ground_m(eye_m.x, eye_m.z));
        if let Some((last_eye_m, last_car_m)) = last.replace((eye_m, car_m)) {
            let jump_m = ((eye_m - last_eye_m) - (car_m - last_car_m)).length();
            found.largest_jump_m = found.largest_jump_m.max(jump_m);
            found.jumps += u32::from(jump_m > JUMP_M);
        }
    }
    Ok(found)
}

#[test]
fn the_chase_camera_keeps_out_of_crowns_and_above_the_land() -> Result<()> {
    let meadow = scenes::load("meadow")?;
    let mut mirror = Mirror::default();
    mirror.apply(meadow.message())?;
    let trees = Sight::new(mirror.decoded_scene().context("a scene")?);
    let found = follow(&mirror, &trees, &trees)?;
    let blind = follow(&mirror, &Sight::default(), &trees)?;
    println!("{found:?}\nwithout the trees: {blind:?}");
    ensure!(found.avoidable == 0, "{found:?}");
    ensure!(found.lowest_m > ABOVE_M && found.jumps == 0, "{found:?}");
    ensure!(blind.avoidable > 100, "a camera that knows no trees would enter none: {blind:?}");
    Ok(())
}
