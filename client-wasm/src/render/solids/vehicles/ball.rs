//! Ball.

use super::model::{VehicleModel, WindBlocking, part};
use crate::render::solids::mesh::{Paint, Solid};
use glam::{Quat, Vec2, Vec3};
use std::f32::consts::{PI, TAU};

pub(super) const MODEL: VehicleModel = VehicleModel {
    parts: |objects| vec![ball(objects.ball_radius_m)],
    place: |_, _| vec![part(0, Vec3::ZERO, Quat::IDENTITY)],
    headlights: |_| Vec::new(),
    wind_blocking: WindBlocking::Sphere,
};

/// Four rings of eight panels in two colours, so that its rolling is visible.
fn ball(radius_m: f32) -> Solid {
    const PAINTS: [Paint; 2] = [Paint::new(0.78, 0.10, 0.05, 0.5), Paint::new(0.85, 0.83, 0.76, 0.5)];
    const RINGS: usize = 4;
    const PANELS: usize = 8;
    /// Quads along each edge of a panel.
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
