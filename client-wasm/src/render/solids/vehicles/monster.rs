//! Monster: a shaggy, friendly beast.

use super::materials::TRIM;
use super::model::{Motion, VehicleModel, WindBlocking, part};
use crate::render::solids::mesh::{Paint, Solid};
use glam::{Affine3A, Quat, Vec3};
use prairie_core::wire::ObjectPose;
use std::f32::consts::PI;

/// Parts: body, leg, arm. Much of its box is open between the limbs.
pub(super) const MODEL: VehicleModel = VehicleModel {
    parts: |_| vec![body(), limb(0.42, 0.17), limb(0.50, 0.11)],
    place,
    headlights: |_| Vec::new(),
    wind_blocking: WindBlocking::Box(0.7),
};

fn place(pose: &ObjectPose, _motion: Motion) -> Vec<(usize, Affine3A)> {
    let swing = pose.part_rad.sin() * 0.65;
    let limb = |number, x: f32, y: f32, angle: f32, out: f32| {
        part(number, Vec3::new(x, y, 0.0), Quat::from_rotation_z(out) * Quat::from_rotation_x(angle))
    };
    vec![
        part(0, Vec3::Y * (0.04 * pose.part_rad.cos().abs()), Quat::IDENTITY),
        limb(1, -0.24, -0.42, swing, 0.0),
        limb(1, 0.24, -0.42, -swing, 0.0),
        limb(2, -0.50, 0.22, -swing * 0.8, -0.35),
        limb(2, 0.50, 0.22, swing * 0.8, 0.35),
    ]
}

const FUR: Paint = Paint::new(0.16, 0.22, 0.34, 0.06);
const PALE_FUR: Paint = Paint::new(0.46, 0.48, 0.46, 0.05);

/// A shaggy, friendly beast; the box is ±(0.6, 0.9, 0.6).
fn body() -> Solid {
    let mut body = Solid::default();
    body.ellipsoid(Vec3::new(0.0, 0.05, 0.02), Vec3::new(0.50, 0.58, 0.42), FUR);
    body.ellipsoid(Vec3::new(0.0, -0.02, -0.16), Vec3::new(0.34, 0.42, 0.30), PALE_FUR);
    body.ellipsoid(Vec3::new(0.0, 0.62, -0.05), Vec3::new(0.36, 0.32, 0.33), FUR);
    body.ellipsoid(Vec3::new(0.0, 0.52, -0.28), Vec3::new(0.20, 0.14, 0.16), PALE_FUR);
    body.ellipsoid(Vec3::new(0.0, 0.58, -0.43), Vec3::new(0.06, 0.045, 0.04), TRIM);
    for side in [-1.0_f32, 1.0] {
        let eye = Vec3::new(side * 0.15, 0.72, -0.31);
        body.ellipsoid(eye, Vec3::new(0.085, 0.095, 0.06), Paint::new(0.90, 0.88, 0.80, 0.7));
        body.ellipsoid(eye + Vec3::new(0.0, -0.005, -0.045), Vec3::new(0.038, 0.045, 0.03), Paint::new(0.01, 0.01, 0.01, 1.0));
        let horn = [
            (Vec3::new(side * 0.22, 0.84, 0.0), 0.075),
            (Vec3::new(side * 0.36, 0.97, 0.0), 0.055),
            (Vec3::new(side * 0.40, 1.12, -0.04), 0.030),
            (Vec3::new(side * 0.36, 1.22, -0.08), 0.008),
        ];
        body.tube(&horn, 9, Paint::new(0.56, 0.46, 0.30, 0.35));
        body.ellipsoid(Vec3::new(side * 0.37, 0.66, 0.02), Vec3::new(0.05, 0.12, 0.09), PALE_FUR);
    }
    // Tufts down the back.
    for i in 0..9 {
        let t = i as f32 / 8.0;
        let foot = Vec3::new(0.0, 0.92 - 1.05 * t, 0.20 + 0.26 * (PI * t).sin());
        body.tube(&[(foot, 0.07), (foot + Vec3::new(0.0, 0.08, 0.16), 0.006)], 6, Paint::new(0.10, 0.14, 0.24, 0.04));
    }
    body
}

/// A limb that hangs from its joint, with a foot.
fn limb(length_m: f32, radius_m: f32) -> Solid {
    let mut limb = Solid::default();
    let down = |t: f32| Vec3::new(0.0, -length_m * t, 0.0);
    limb.tube(&[(down(-0.2), radius_m * 0.8), (down(0.4), radius_m), (down(0.9), radius_m * 0.8)], 12, FUR);
    limb.ellipsoid(down(0.93) - Vec3::Z * radius_m * 0.4, Vec3::new(radius_m, radius_m * 0.55, radius_m * 1.4), PALE_FUR);
    limb
}
