//! Car: a small off-road vehicle.

use super::materials::{GLASS, LAMP, RUBBER, STEEL, TAIL_LAMP, TRIM, profile_point};
use super::model::{Motion, VehicleModel, WindBlocking, part};
use crate::render::inputs::lamps::SpotLight;
use crate::render::solids::mesh::{Paint, Solid};
use glam::{Affine3A, Quat, Vec3};
use prairie_core::wire::ObjectPose;
use std::f32::consts::{FRAC_PI_2, PI, TAU};

/// Parts: body, wheel.
pub(super) const MODEL: VehicleModel =
    VehicleModel { parts: |_| vec![body(), wheel()], place, headlights, wind_blocking: WindBlocking::Box(1.0) };

const WHEEL_RADIUS_M: f32 = 0.36;
/// Position of the headlights in the car's frame (m), mirrored for the other side.
const HEADLIGHT_M: Vec3 = Vec3::new(0.62, 0.02, -2.2);
/// Luminous intensity in the middle of a dipped beam (cd), its angle below the horizontal (rad), and the cosines of the cone's outer and inner angle.
const HEADLIGHT_CD: f32 = 9000.0;
const HEADLIGHT_DOWN_RAD: f32 = 0.05;
const HEADLIGHT_CONE: [f32; 2] = [0.88, 0.985];
const HEADLIGHT_RGB: Vec3 = Vec3::new(1.0, 0.90, 0.74);

fn place(pose: &ObjectPose, motion: Motion) -> Vec<(usize, Affine3A)> {
    let roll = Quat::from_rotation_x(-(motion.rolled_m / WHEEL_RADIUS_M) % TAU);
    let steer = Quat::from_rotation_y(-pose.part_rad);
    let wheel = |x: f32, z: f32, turn: Quat| part(1, Vec3::new(x, WHEEL_RADIUS_M - 0.70, z), turn * roll);
    vec![
        part(0, Vec3::ZERO, Quat::IDENTITY),
        wheel(-0.80, -1.38, steer),
        wheel(0.80, -1.38, steer),
        wheel(-0.80, 1.32, Quat::IDENTITY),
        wheel(0.80, 1.32, Quat::IDENTITY),
    ]
}

fn headlights(pose: &ObjectPose) -> Vec<SpotLight> {
    let rotation = Quat::from_array(pose.rotation);
    let direction = rotation * (Quat::from_rotation_x(-HEADLIGHT_DOWN_RAD) * Vec3::NEG_Z);
    let position_m = |side| Vec3::from(pose.position_m) + rotation * (HEADLIGHT_M * Vec3::new(side, 1.0, 1.0));
    let light = |side| SpotLight {
        position_m: position_m(side),
        direction,
        rgb: HEADLIGHT_RGB,
        candela: HEADLIGHT_CD,
        cone_cosines: HEADLIGHT_CONE,
    };
    [-1.0, 1.0].map(light).to_vec()
}

/// A small off-roader with a roof rack; forward is −Z, the box is ±(0.95, 0.7, 2.2).
fn body() -> Solid {
    let body = Paint::new(0.62, 0.085, 0.035, 0.55);
    let roof = Paint::new(0.80, 0.77, 0.68, 0.45);
    let mut car = Solid::default();
    let hull = [
        profile_point(2.12, -0.34),
        profile_point(2.16, 0.10),
        profile_point(2.05, 0.22),
        profile_point(-2.02, 0.17),
        profile_point(-2.18, 0.02),
        profile_point(-2.16, -0.34),
    ];
    car.extrude(&hull, Vec3::ZERO, 0.86, 0.90, 0.05, body);
    car.extrude(
        &[profile_point(-0.75, 0.17), profile_point(-0.70, 0.25), profile_point(-2.00, 0.22), profile_point(-2.08, 0.14)],
        Vec3::ZERO,
        0.78,
        0.74,
        0.03,
        body,
    );
    let cabin = [profile_point(1.98, 0.20), profile_point(1.78, 0.66), profile_point(-0.28, 0.66), profile_point(-0.88, 0.20)];
    car.extrude(&cabin, Vec3::ZERO, 0.84, 0.68, 0.03, GLASS);
    let top = [profile_point(1.84, 0.62), profile_point(1.78, 0.70), profile_point(-0.28, 0.70), profile_point(-0.38, 0.62)];
    car.extrude(&top, Vec3::ZERO, 0.74, 0.70, 0.03, roof);
    for side in [-1.0_f32, 1.0] {
        for (z_low, z_high) in [(1.94, 1.76), (0.72, 0.68), (-0.84, -0.27)] {
            let foot = Vec3::new(side * 0.845, 0.20, z_low);
            car.tube(&[(foot, 0.045), (Vec3::new(side * 0.70, 0.66, z_high), 0.045)], 6, body);
        }
        car.block(Vec3::new(side * 0.905, -0.30, 0.0), Vec3::new(0.05, 0.07, 0.86), 0.02, TRIM);
        car.block(Vec3::new(side * 0.99, 0.27, -0.70), Vec3::new(0.09, 0.065, 0.05), 0.02, body);
        car.ellipsoid(Vec3::new(side * 0.62, 0.02, -2.15), Vec3::new(0.15, 0.12, 0.06), LAMP);
        car.block(Vec3::new(side * 0.72, 0.02, 2.15), Vec3::new(0.10, 0.13, 0.03), 0.015, TAIL_LAMP);
        for z in [-1.38, 1.32] {
            arch(&mut car, Vec3::new(side * 0.86, WHEEL_RADIUS_M - 0.70, z), side);
        }
        car.tube(&[(Vec3::new(side * 0.60, 0.77, -0.20), 0.022), (Vec3::new(side * 0.60, 0.77, 1.70), 0.022)], 6, TRIM);
    }
    for z in [-0.15, 0.45, 1.05, 1.65] {
        car.tube(&[(Vec3::new(-0.60, 0.77, z), 0.018), (Vec3::new(0.60, 0.77, z), 0.018)], 6, TRIM);
    }
    car.block(Vec3::new(0.0, -0.30, -2.20), Vec3::new(0.86, 0.09, 0.08), 0.03, TRIM);
    car.block(Vec3::new(0.0, -0.30, 2.18), Vec3::new(0.86, 0.09, 0.08), 0.03, TRIM);
    car.block(Vec3::new(0.0, 0.02, -2.16), Vec3::new(0.42, 0.09, 0.035), 0.02, TRIM);
    car.block(Vec3::new(0.0, -0.36, 0.0), Vec3::new(0.70, 0.06, 1.9), 0.02, TRIM);
    // Spare wheel.
    car.add(&wheel(), Affine3A::from_rotation_translation(Quat::from_rotation_y(FRAC_PI_2), Vec3::new(0.0, 0.08, 2.28)));
    car
}

/// A dark well with a flared rim.
fn arch(car: &mut Solid, centre: Vec3, side: f32) {
    let count = 9;
    for i in 0..count {
        let angle = |i: usize| PI * i as f32 / count as f32;
        let at = |angle: f32, radius: f32, x: f32| centre + Vec3::new(x, radius * angle.sin(), radius * angle.cos());
        let (a, b) = (angle(i), angle(i + 1));
        let mut rim = [at(a, 0.43, side * 0.065), at(b, 0.43, side * 0.065), at(b, 0.50, side * 0.045), at(a, 0.50, side * 0.045)];
        let mut skirt = [at(a, 0.50, side * 0.045), at(b, 0.50, side * 0.045), at(b, 0.50, side * -0.05), at(a, 0.50, side * -0.05)];
        let mut well = [at(a, 0.0, side * 0.05), at(a, 0.43, side * 0.05), at(b, 0.43, side * 0.05), at(b, 0.0, side * 0.05)];
        if side > 0.0 {
            rim.reverse();
            skirt.reverse();
        } else {
            well.reverse();
        }
        car.polygon(&rim, TRIM);
        car.polygon(&skirt, TRIM);
        car.polygon(&[well[0], well[1], well[2]], Paint::new(0.004, 0.004, 0.004, 0.0));
    }
}

/// A wheel whose axle is X, centred at its hub.
fn wheel() -> Solid {
    let mut wheel = Solid::default();
    let sides = 20;
    let profile = [(-0.13, 0.25), (-0.14, 0.31), (-0.11, 0.355), (0.11, 0.355), (0.14, 0.31), (0.13, 0.25)];
    let ring = |x: f32, radius: f32| -> Vec<Vec3> {
        (0..sides)
            .map(|j| {
                let (s, c) = (TAU * j as f32 / sides as f32).sin_cos();
                Vec3::new(x, radius * c, radius * s)
            })
            .collect()
    };
    let rings: Vec<_> = profile.iter().map(|&(x, radius)| ring(x, radius)).collect();
    wheel.skin(&rings, RUBBER);
    for side in [-1.0_f32, 1.0] {
        let dish = |x: f32, radius: f32| ring(side * x, radius);
        let mut rings = vec![dish(0.13, 0.25), dish(0.09, 0.22), dish(0.08, 0.08), dish(0.12, 0.06), dish(0.125, 1e-4)];
        if side < 0.0 {
            rings.reverse();
        }
        wheel.skin(&rings, STEEL);
        for spoke in 0..5 {
            let turn = Quat::from_rotation_x(TAU * spoke as f32 / 5.0);
            let mut bar = Solid::default();
            bar.block(Vec3::new(side * 0.105, 0.15, 0.0), Vec3::new(0.018, 0.09, 0.028), 0.008, STEEL);
            wheel.add(&bar, Affine3A::from_quat(turn));
        }
    }
    wheel
}
