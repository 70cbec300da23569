//! Helicopter.

use super::materials::{GLASS, STEEL, TRIM, profile_point};
use super::model::{Motion, VehicleModel, WindBlocking, part};
use crate::render::solids::mesh::{Paint, Solid};
use glam::{Affine3A, Quat, Vec3};
use prairie_core::wire::ObjectPose;
use std::f32::consts::{FRAC_PI_2, TAU};

/// Parts: body, main rotor, tail rotor. Much of its box is open around the tail and the skids.
pub(super) const MODEL: VehicleModel = VehicleModel {
    parts: |_| vec![body(), rotor(4, 4.2, 0.22), rotor(3, 0.62, 0.12)],
    place,
    headlights: |_| Vec::new(),
    wind_blocking: WindBlocking::Box(0.5),
};

fn place(pose: &ObjectPose, motion: Motion) -> Vec<(usize, Affine3A)> {
    let phase = pose.part_rad + (motion.time_secs * 0.37).fract() * TAU;
    vec![
        part(0, Vec3::ZERO, Quat::IDENTITY),
        part(1, Vec3::new(0.0, 1.28, -0.75), Quat::from_rotation_y(phase)),
        part(2, Vec3::new(0.20, 0.62, 3.95), Quat::from_rotation_z(-FRAC_PI_2) * Quat::from_rotation_y(phase * 1.7)),
    ]
}

/// A light helicopter with a glass nose; the box is ±(1.1, 1.3, 3.4).
fn body() -> Solid {
    let body = Paint::new(0.80, 0.50, 0.035, 0.55);
    let dark = Paint::new(0.030, 0.045, 0.085, 0.5);
    let mut craft = Solid::default();
    craft.ellipsoid(Vec3::new(0.0, -0.05, -0.95), Vec3::new(0.92, 0.88, 1.65), body);
    craft.ellipsoid(Vec3::new(0.0, 0.06, -1.42), Vec3::new(0.86, 0.76, 1.30), GLASS);
    craft.ellipsoid(Vec3::new(0.0, -0.52, -1.15), Vec3::new(0.80, 0.46, 1.55), body);
    craft.ellipsoid(Vec3::new(0.0, 0.66, -0.45), Vec3::new(0.48, 0.36, 0.95), dark);
    for x in [-0.30, 0.30] {
        let bar = [(Vec3::new(x * 0.9, -0.30, -2.55), 0.035), (Vec3::new(x, 0.42, -2.32), 0.035), (Vec3::new(x * 1.2, 0.80, -1.55), 0.035)];
        craft.tube(&bar, 6, body);
    }
    let boom = [
        (Vec3::new(0.0, 0.22, 0.35), 0.46),
        (Vec3::new(0.0, 0.32, 1.40), 0.26),
        (Vec3::new(0.0, 0.44, 3.0), 0.16),
        (Vec3::new(0.0, 0.50, 3.95), 0.12),
    ];
    craft.tube(&boom, 14, body);
    craft.tube(&[(Vec3::new(0.0, 0.385, 2.2), 0.225), (Vec3::new(0.0, 0.415, 2.6), 0.20)], 14, dark);
    let fin = [profile_point(4.25, 1.30), profile_point(3.92, 1.32), profile_point(3.55, 0.52), profile_point(4.02, 0.42)];
    craft.extrude(&fin, Vec3::ZERO, 0.05, 0.035, 0.015, dark);
    craft.block(Vec3::new(0.0, 0.46, 3.20), Vec3::new(0.78, 0.03, 0.20), 0.012, dark);
    craft.tube(&[(Vec3::new(0.0, 0.85, -0.75), 0.12), (Vec3::new(0.0, 1.30, -0.75), 0.07)], 10, STEEL);
    for side in [-1.0_f32, 1.0] {
        let skid = [
            (Vec3::new(side * 0.92, -1.08, -2.35), 0.045),
            (Vec3::new(side * 0.92, -1.25, -2.10), 0.05),
            (Vec3::new(side * 0.92, -1.25, 0.65), 0.05),
        ];
        craft.tube(&skid, 8, dark);
        for z in [-1.60, 0.05] {
            let leg = [(Vec3::new(side * 0.50, -0.60, z), 0.04), (Vec3::new(side * 0.92, -1.24, z), 0.04)];
            craft.tube(&leg, 7, dark);
        }
        craft.block(Vec3::new(side * 0.10, 0.62, 3.95), Vec3::new(0.09, 0.035, 0.035), 0.01, STEEL);
    }
    craft
}

/// A rotor about Y.
fn rotor(blades: u32, length_m: f32, chord_m: f32) -> Solid {
    let mut rotor = Solid::default();
    rotor.ellipsoid(Vec3::ZERO, Vec3::new(0.045, 0.03, 0.045) * length_m, STEEL);
    for blade in 0..blades {
        let mut bar = Solid::default();
        let middle = Vec3::new(length_m * 0.52, 0.0, 0.0);
        bar.block(middle, Vec3::new(length_m * 0.48, 0.018, chord_m * 0.5), 0.012, TRIM);
        bar.block(
            Vec3::new(length_m * 0.97, 0.0, 0.0),
            Vec3::new(length_m * 0.04, 0.020, chord_m * 0.5),
            0.012,
            Paint::new(0.80, 0.50, 0.035, 0.3),
        );
        let turn = Quat::from_rotation_y(TAU * blade as f32 / blades as f32) * Quat::from_rotation_x(0.09);
        rotor.add(&bar, Affine3A::from_quat(turn));
    }
    rotor
}
