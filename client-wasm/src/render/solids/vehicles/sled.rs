//! Sled: a drag frame with the outline that the scene sets.

use super::materials::{STEEL, TRIM};
use super::model::{VehicleModel, WindBlocking, part};
use crate::render::solids::mesh::{Paint, Solid};
use glam::{Quat, Vec3};
use prairie_core::outline::convex_parts;
use prairie_core::scene::VehicleKind;

pub(super) const MODEL: VehicleModel = VehicleModel {
    parts: |objects| vec![frame(&objects.sled_outline_m, objects.half_extents_m(VehicleKind::Sled)[1])],
    place: |_, _| vec![part(0, Vec3::ZERO, Quat::IDENTITY)],
    headlights: |_| Vec::new(),
    wind_blocking: WindBlocking::Box(1.0),
};

/// A frame of planks of height ±`half_m`, with a dark runner below and a rail around the rim.
fn frame(outline_m: &[[f32; 2]], half_m: f32) -> Solid {
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
