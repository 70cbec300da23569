//! The built-in models of what a visitor can drive, and how their parts move.

use super::mesh::{Paint, Solid};
use glam::{Affine3A, Quat, Vec2, Vec3};
use shared::outline::convex_parts;
use shared::scene::{Objects, VehicleKind};
use shared::wire::ObjectPose;
use std::f32::consts::{FRAC_PI_2, PI, TAU};

/// A part of a vehicle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Part {
    CarBody,
    Wheel,
    MonsterBody,
    MonsterLeg,
    MonsterArm,
    HelicopterBody,
    Rotor,
    TailRotor,
    SledFrame,
    Ball,
}

impl Part {
    pub(super) const ALL: [Self; 10] = [
        Self::CarBody,
        Self::Wheel,
        Self::MonsterBody,
        Self::MonsterLeg,
        Self::MonsterArm,
        Self::HelicopterBody,
        Self::Rotor,
        Self::TailRotor,
        Self::SledFrame,
        Self::Ball,
    ];

    /// The built-in model, for objects with these settings.
    pub(super) fn solid(self, objects: &Objects) -> Solid {
        match self {
            Self::CarBody => car_body(),
            Self::Wheel => wheel(),
            Self::MonsterBody => monster_body(),
            Self::MonsterLeg => limb(0.42, 0.17),
            Self::MonsterArm => limb(0.50, 0.11),
            Self::HelicopterBody => helicopter_body(),
            Self::Rotor => rotor(4, 4.2, 0.22),
            Self::TailRotor => rotor(3, 0.62, 0.12),
            Self::SledFrame => sled_frame(&objects.sled_outline_m, objects.half_extents_m(VehicleKind::Sled)[1]),
            Self::Ball => ball(objects.ball_radius_m),
        }
    }

    /// The vehicle that has this part.
    pub(super) fn kind(self) -> VehicleKind {
        match self {
            Self::CarBody | Self::Wheel => VehicleKind::Car,
            Self::MonsterBody | Self::MonsterLeg | Self::MonsterArm => VehicleKind::Monster,
            Self::HelicopterBody | Self::Rotor | Self::TailRotor => VehicleKind::Helicopter,
            Self::SledFrame => VehicleKind::Sled,
            Self::Ball => VehicleKind::Ball,
        }
    }

    /// The part that a model of one's own stands for.
    pub(super) fn body(kind: VehicleKind) -> Self {
        match kind {
            VehicleKind::Car => Self::CarBody,
            VehicleKind::Monster => Self::MonsterBody,
            VehicleKind::Helicopter => Self::HelicopterBody,
            VehicleKind::Sled => Self::SledFrame,
            VehicleKind::Ball => Self::Ball,
        }
    }
}

const WHEEL_RADIUS_M: f32 = 0.36;

/// Parts of an object with their places in its body; `rolled_m` is the distance it has gone forward.
pub(super) fn parts(pose: &ObjectPose, rolled_m: f32, time_secs: f32) -> Vec<(Part, Affine3A)> {
    let place = |part, at: Vec3, turn: Quat| (part, Affine3A::from_rotation_translation(turn, at));
    match pose.kind {
        VehicleKind::Car => {
            let roll = Quat::from_rotation_x(-(rolled_m / WHEEL_RADIUS_M) % TAU);
            let steer = Quat::from_rotation_y(-pose.part_rad);
            let wheel = |x: f32, z: f32, turn: Quat| place(Part::Wheel, Vec3::new(x, WHEEL_RADIUS_M - 0.70, z), turn * roll);
            vec![
                place(Part::CarBody, Vec3::ZERO, Quat::IDENTITY),
                wheel(-0.80, -1.38, steer),
                wheel(0.80, -1.38, steer),
                wheel(-0.80, 1.32, Quat::IDENTITY),
                wheel(0.80, 1.32, Quat::IDENTITY),
            ]
        }
        VehicleKind::Monster => {
            let swing = pose.part_rad.sin() * 0.65;
            let limb = |part, x: f32, y: f32, angle: f32, out: f32| {
                place(part, Vec3::new(x, y, 0.0), Quat::from_rotation_z(out) * Quat::from_rotation_x(angle))
            };
            vec![
                place(Part::MonsterBody, Vec3::Y * (0.04 * pose.part_rad.cos().abs()), Quat::IDENTITY),
                limb(Part::MonsterLeg, -0.24, -0.42, swing, 0.0),
                limb(Part::MonsterLeg, 0.24, -0.42, -swing, 0.0),
                limb(Part::MonsterArm, -0.50, 0.22, -swing * 0.8, -0.35),
                limb(Part::MonsterArm, 0.50, 0.22, swing * 0.8, 0.35),
            ]
        }
        VehicleKind::Helicopter => {
            let phase = pose.part_rad + (time_secs * 0.37).fract() * TAU;
            vec![
                place(Part::HelicopterBody, Vec3::ZERO, Quat::IDENTITY),
                place(Part::Rotor, Vec3::new(0.0, 1.28, -0.75), Quat::from_rotation_y(phase)),
                place(Part::TailRotor, Vec3::new(0.20, 0.62, 3.95), Quat::from_rotation_z(-FRAC_PI_2) * Quat::from_rotation_y(phase * 1.7)),
            ]
        }
        VehicleKind::Sled => vec![place(Part::SledFrame, Vec3::ZERO, Quat::IDENTITY)],
        VehicleKind::Ball => vec![place(Part::Ball, Vec3::ZERO, Quat::IDENTITY)],
    }
}

const RUBBER: Paint = Paint::new(0.018, 0.018, 0.02, 0.10);
const STEEL: Paint = Paint::new(0.42, 0.43, 0.45, 0.75);
const GLASS: Paint = Paint::new(0.012, 0.020, 0.026, 1.0);
const TRIM: Paint = Paint::new(0.022, 0.023, 0.025, 0.25);
const LAMP: Paint = Paint::new(0.92, 0.90, 0.80, 0.9);
const TAIL_LAMP: Paint = Paint::new(0.55, 0.012, 0.010, 0.8);

fn v(back: f32, up: f32) -> Vec2 {
    Vec2::new(back, up)
}

/// A small off-roader with a roof rack; forward is −Z, the box is ±(0.95, 0.7, 2.2).
fn car_body() -> Solid {
    let body = Paint::new(0.62, 0.085, 0.035, 0.55);
    let roof = Paint::new(0.80, 0.77, 0.68, 0.45);
    let mut car = Solid::default();
    let hull = [v(2.12, -0.34), v(2.16, 0.10), v(2.05, 0.22), v(-2.02, 0.17), v(-2.18, 0.02), v(-2.16, -0.34)];
    car.extrude(&hull, Vec3::ZERO, 0.86, 0.90, 0.05, body);
    car.extrude(&[v(-0.75, 0.17), v(-0.70, 0.25), v(-2.00, 0.22), v(-2.08, 0.14)], Vec3::ZERO, 0.78, 0.74, 0.03, body);
    let cabin = [v(1.98, 0.20), v(1.78, 0.66), v(-0.28, 0.66), v(-0.88, 0.20)];
    car.extrude(&cabin, Vec3::ZERO, 0.84, 0.68, 0.03, GLASS);
    let top = [v(1.84, 0.62), v(1.78, 0.70), v(-0.28, 0.70), v(-0.38, 0.62)];
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

const FUR: Paint = Paint::new(0.16, 0.22, 0.34, 0.06);
const PALE_FUR: Paint = Paint::new(0.46, 0.48, 0.46, 0.05);

/// A shaggy, friendly beast; the box is ±(0.6, 0.9, 0.6).
fn monster_body() -> Solid {
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

/// A light helicopter with a glass nose; the box is ±(1.1, 1.3, 3.4).
fn helicopter_body() -> Solid {
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
    let fin = [v(4.25, 1.30), v(3.92, 1.32), v(3.55, 0.52), v(4.02, 0.42)];
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

/// A drag frame of planks over the scene's own outline, between ±`half_m`: a dark runner below, a rail around the rim.
fn sled_frame(outline_m: &[[f32; 2]], half_m: f32) -> Solid {
    const PLANK: Paint = Paint::new(0.34, 0.19, 0.075, 0.25);
    const RAIL_M: f32 = 0.055;
    let (floor, middle, deck) = (-half_m, -0.4 * half_m, half_m - RAIL_M);
    let mut frame = Solid::default();
    for part in convex_parts(outline_m) {
        let at = |[x, z]: [f32; 2], y: f32| Vec3::new(x, y, z);
        let corners = || part.corners_m.iter().copied();
        frame.polygon(&corners().map(|corner| at(corner, floor)).collect::<Vec<_>>(), TRIM);
        frame.polygon(&corners().rev().map(|corner| at(corner, deck)).collect::<Vec<_>>(), PLANK);
        for ((a, b), seam) in corners().zip(corners().cycle().skip(1)).zip(&part.seams) {
            if !seam {
                frame.polygon(&[at(a, floor), at(a, middle), at(b, middle), at(b, floor)], TRIM);
                frame.polygon(&[at(a, middle), at(a, deck), at(b, deck), at(b, middle)], PLANK);
                frame.tube(&[(at(a, deck), RAIL_M), (at(b, deck), RAIL_M)], 8, STEEL);
            }
        }
    }
    frame
}

/// A ball of four rings of eight panels in two colours, so that one sees it roll.
fn ball(radius_m: f32) -> Solid {
    const PAINTS: [Paint; 2] = [Paint::new(0.78, 0.10, 0.05, 0.5), Paint::new(0.85, 0.83, 0.76, 0.5)];
    const RINGS: usize = 4;
    const PANELS: usize = 8;
    /// Parts of a panel along each of its edges.
    const FINE: usize = 4;
    let direction = |up: usize, around: usize| {
        let (sin, cos) = (PI * up as f32 / (RINGS * FINE) as f32).sin_cos();
        let (s, c) = (TAU * around as f32 / (PANELS * FINE) as f32).sin_cos();
        Vec3::new(c * sin, -cos, -s * sin)
    };
    let mut ball = Solid::default();
    for (up, around) in (0..RINGS * FINE).flat_map(|up| (0..PANELS * FINE).map(move |around| (up, around))) {
        let paint = PAINTS[(up / FINE + around / FINE) % 2];
        let corners = [(up, around), (up, around + 1), (up + 1, around + 1), (up + 1, around)];
        let [a, b, c, d] = corners.map(|(up, around)| {
            let outward = direction(up, around);
            ball.vertex(outward * radius_m, outward, paint, Vec2::ZERO)
        });
        ball.indices.extend([a, b, c, a, c, d]);
    }
    ball
}

/// Blades about Y.
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
