//! Walker: a visitor on foot in a coat and a straw hat.

use super::materials::TRIM;
use super::model::{Motion, VehicleModel, WindBlocking, part};
use crate::render::solids::mesh::{Paint, Solid};
use glam::{Affine3A, Quat, Vec3};
use prairie_core::wire::ObjectPose;
use std::f32::consts::{PI, TAU};

/// Parts: trunk with head and hat, thigh, shin with its shoe, arm. Much of its box is open between the limbs.
pub(super) const MODEL: VehicleModel = VehicleModel {
    parts: |_| vec![trunk(), thigh(), shin(), arm()],
    place,
    headlights: |_| Vec::new(),
    wind_blocking: WindBlocking::Box(0.6),
};

/// Height of the hips, and of the shoulders, above the middle (m).
const HIPS_M: f32 = 0.0;
const SHOULDERS_M: f32 = 0.52;
/// Length of a thigh and of a shin (m).
const LEG_M: [f32; 2] = [0.45, 0.42];
/// Swing of a leg to either side of upright while it stands (rad): at its ends its foot is as far ahead and behind as the grass is pressed.
const SWING_RAD: f32 = 0.6;
/// Bend of the knee in the middle of the swing forward (rad).
const KNEE_RAD: f32 = 1.1;

const COAT: Paint = Paint::new(0.09, 0.16, 0.27, 0.15);
const TROUSERS: Paint = Paint::new(0.20, 0.15, 0.09, 0.1);
const SKIN: Paint = Paint::new(0.52, 0.33, 0.22, 0.3);
const STRAW: Paint = Paint::new(0.62, 0.47, 0.20, 0.1);

/// Angle of a leg ahead of upright and bend of its knee (rad), at a fraction of the walk since its foot was set down. While it stands
/// it is straight.
fn leg_rad(since: f32) -> [f32; 2] {
    let since = since.rem_euclid(1.0);
    if since < 0.5 {
        [SWING_RAD * (1.0 - 4.0 * since), 0.0]
    } else {
        [SWING_RAD * (TAU * since).cos(), KNEE_RAD * (TAU * (since - 0.5)).sin()]
    }
}

fn place(pose: &ObjectPose, _motion: Motion) -> Vec<(usize, Affine3A)> {
    let walk = pose.part_rad / TAU;
    let [left, right] = [walk, walk - 0.5].map(leg_rad);
    let swing_rad = left[0];
    // The hips sink where the leg that stands is oblique, so that its foot stays on the ground.
    let [standing_rad, _] = if walk.rem_euclid(1.0) < 0.5 { left } else { right };
    let sunk_m = (LEG_M[0] + LEG_M[1]) * (1.0 - standing_rad.cos());
    let mut placed = vec![part(0, Vec3::Y * -sunk_m, Quat::IDENTITY)];
    for ([ahead_rad, knee_rad], x) in [(left, -0.1), (right, 0.1)] {
        let hip = Vec3::new(x, HIPS_M - sunk_m, 0.0);
        let turn = Quat::from_rotation_x(ahead_rad);
        placed.push(part(1, hip, turn));
        placed.push(part(2, hip + turn * (-LEG_M[0] * Vec3::Y), turn * Quat::from_rotation_x(-knee_rad)));
    }
    for (x, ahead_rad) in [(-0.25_f32, -0.7 * swing_rad), (0.25, 0.7 * swing_rad)] {
        let out = Quat::from_rotation_z(0.12 * x.signum());
        placed.push(part(3, Vec3::new(x, SHOULDERS_M - sunk_m, 0.0), out * Quat::from_rotation_x(ahead_rad)));
    }
    placed
}

fn trunk() -> Solid {
    let mut trunk = Solid::default();
    trunk.ellipsoid(Vec3::new(0.0, 0.28, 0.0), Vec3::new(0.22, 0.34, 0.14), COAT);
    trunk.ellipsoid(Vec3::new(0.0, 0.0, 0.0), Vec3::new(0.19, 0.17, 0.14), COAT);
    trunk.tube(&[(Vec3::new(0.0, 0.55, 0.0), 0.06), (Vec3::new(0.0, 0.68, -0.01), 0.055)], 10, SKIN);
    trunk.ellipsoid(Vec3::new(0.0, 0.74, -0.02), Vec3::new(0.09, 0.12, 0.11), SKIN);
    // The hat: a brim, a crown and its band.
    let up = |y: f32| Vec3::new(0.0, y, -0.01);
    trunk.ellipsoid(up(0.80), Vec3::new(0.21, 0.018, 0.21), STRAW);
    trunk.tube(&[(up(0.80), 0.113), (up(0.835), 0.111)], 16, TRIM);
    trunk.ellipsoid(up(0.82), Vec3::new(0.108, 0.09, 0.108), STRAW);
    // A satchel on the back.
    trunk.block(Vec3::new(0.0, 0.30, 0.17), Vec3::new(0.13, 0.16, 0.05), 0.03, STRAW);
    trunk
}

fn thigh() -> Solid {
    let mut thigh = Solid::default();
    thigh.tube(&[(Vec3::Y * 0.03, 0.085), (Vec3::Y * (-0.6 * LEG_M[0]), 0.075), (Vec3::Y * -LEG_M[0], 0.06)], 12, TROUSERS);
    thigh
}

fn shin() -> Solid {
    let mut shin = Solid::default();
    shin.tube(&[(Vec3::ZERO, 0.06), (Vec3::Y * (-0.4 * LEG_M[1]), 0.06), (Vec3::Y * -LEG_M[1], 0.045)], 12, TROUSERS);
    shin.ellipsoid(Vec3::new(0.0, -LEG_M[1] + 0.01, -0.06), Vec3::new(0.05, 0.04, 0.13), TRIM);
    shin
}

fn arm() -> Solid {
    let mut arm = Solid::default();
    let elbow = Vec3::new(0.0, -0.27, 0.0);
    let hand = elbow + Vec3::new(0.0, -0.22 * (PI / 9.0).cos(), -0.22 * (PI / 9.0).sin());
    arm.tube(&[(Vec3::ZERO, 0.06), (elbow, 0.05), (hand, 0.04)], 10, COAT);
    arm.ellipsoid(hand, Vec3::new(0.04, 0.06, 0.045), SKIN);
    arm
}

#[cfg(test)]
mod tests {
    use super::*;
    use prairie_core::scene::VehicleKind;

    /// Heights of the left and the right ankle (m) at a fraction of the walk.
    fn ankles_m(walk: f32) -> [f32; 2] {
        let pose = ObjectPose {
            id: 1,
            kind: VehicleKind::Walker,
            position_m: [0.0; 3],
            rotation: [0.0, 0.0, 0.0, 1.0],
            velocity_m_per_s: [0.0; 3],
            part_rad: walk * TAU,
        };
        let shins: Vec<_> = place(&pose, Motion { rolled_m: 0.0, time_secs: 0.0 }).into_iter().filter(|(part, _)| *part == 2).collect();
        [0, 1].map(|leg: usize| shins[leg].1.transform_point3(-LEG_M[1] * Vec3::Y).y)
    }

    #[test]
    fn the_foot_that_stands_stays_on_the_ground() {
        for n in 0..64 {
            let walk = (n as f32 + 0.5) / 64.0;
            let [left_m, right_m] = ankles_m(walk).map(|y| y + LEG_M[0] + LEG_M[1]);
            let [standing_m, swung_m] = if walk < 0.5 { [left_m, right_m] } else { [right_m, left_m] };
            assert!(standing_m.abs() < 1e-3, "{walk} of the walk: {standing_m} m above the ground");
            let is_midway = (0.15..0.35).contains(&(walk % 0.5));
            assert!(!is_midway || swung_m > 0.05, "{walk} of the walk: the other foot is {swung_m} m above the ground");
        }
    }
}
