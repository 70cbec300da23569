//! Materials that several vehicles share.

use crate::render::solids::mesh::Paint;
use glam::Vec2;

pub(super) const RUBBER: Paint = Paint::new(0.018, 0.018, 0.02, 0.10);
pub(super) const STEEL: Paint = Paint::new(0.42, 0.43, 0.45, 0.75);
pub(super) const GLASS: Paint = Paint::new(0.012, 0.020, 0.026, 1.0);
pub(super) const TRIM: Paint = Paint::new(0.022, 0.023, 0.025, 0.25);
pub(super) const LAMP: Paint = Paint::new(0.92, 0.90, 0.80, 0.9);
pub(super) const TAIL_LAMP: Paint = Paint::new(0.55, 0.012, 0.010, 0.8);

/// Corner of a profile for [`Solid::extrude`](crate::render::solids::mesh::Solid::extrude).
pub(super) fn profile_point(back: f32, up: f32) -> Vec2 {
    Vec2::new(back, up)
}
