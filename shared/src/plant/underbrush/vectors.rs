//! Outline of a bent component as vectors (Endo et al. 2003, §3.1): along its axis, and to its left and right edges.

use super::plan::{PlannedComponent, STALK_FRACTION};
use super::plant::Posed;
use crate::scene::ComponentKind;
use glam::Vec3;

/// Angle of petals from their flower's stalk (rad).
pub const PETAL_RAD: f32 = 1.15;

/// One vector of each of the three sets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vectors {
    /// Along the axis (m), from the end of the previous one.
    pub axis_m: Vec3,
    /// From that end to the left edge (m), across the axis.
    pub left_m: Vec3,
    /// From that end to the right edge (m), across the axis.
    pub right_m: Vec3,
}

/// Vectors of a component from its base up, one for every `every` sections (Endo et al. 2003, §5.1: fewer at a distance) and always one to its tip.
/// The first is the base: it has no axis, and its edges are across the next.
pub fn vectors(planned: &PlannedComponent, posed: &Posed, every: usize) -> Vec<Vectors> {
    let sections = posed.sections();
    let every = every.max(1);
    let mut from_m = posed.foot_m;
    let mut out = Vec::with_capacity(2 + sections.len() / every);
    for (index, section) in sections.iter().enumerate() {
        if (index + 1) % every != 0 && index + 1 < sections.len() {
            continue;
        }
        let axis_m = section.end_m - from_m;
        let along = axis_m.normalize_or(section.direction);
        let side = (section.side - along * section.side.dot(along)).normalize_or(section.side);
        let border = |fraction: f32| side * (0.5 * width_m(planned, posed.size, fraction));
        if out.is_empty() {
            out.push(Vectors { axis_m: Vec3::ZERO, left_m: -border(0.0), right_m: border(0.0) });
        }
        let border = border((index + 1) as f32 / sections.len() as f32);
        out.push(Vectors { axis_m, left_m: -border, right_m: border });
        from_m = section.end_m;
    }
    out
}

/// Width of a component's outline (m) at a fraction of its length. A leaf is widest at 0.425 of it, 0.45 as wide at its base, and pointed; a branch,
/// or the stalk of a flower, is half as thick at its tip.
fn width_m(planned: &PlannedComponent, size: f32, fraction: f32) -> f32 {
    let width_m = planned.component.width_m * size;
    match planned.component.kind {
        ComponentKind::Leaf => width_m * (fraction + 0.15) * (1.0 - fraction) / (0.575 * 0.575),
        ComponentKind::Branch => width_m * (1.0 - 0.5 * fraction),
        ComponentKind::Flower => width_m * STALK_FRACTION * (1.0 - 0.5 * fraction),
    }
}

/// Vectors of the petals of a flower, each from the tip of its stalk to its own tip, with edges at its middle; none for other components.
pub fn petals(planned: &PlannedComponent, posed: &Posed) -> Vec<Vectors> {
    let (ComponentKind::Flower, Some(tip)) = (planned.component.kind, posed.sections().last()) else {
        return Vec::new();
    };
    let other = tip.direction.cross(tip.side);
    let radius_m = 0.5 * planned.component.width_m * posed.size;
    let step_rad = std::f32::consts::TAU / planned.component.petals as f32;
    let (open_sine, open_cosine) = PETAL_RAD.sin_cos();
    let petal = |nth: u32| {
        let (sine, cosine) = (step_rad * nth as f32).sin_cos();
        let outward = tip.side * cosine + other * sine;
        // At its middle, a petal is as wide as its share of the ring there.
        let right_m = (other * cosine - tip.side * sine) * (0.25 * step_rad * radius_m);
        Vectors { axis_m: (tip.direction * open_cosine + outward * open_sine) * radius_m, left_m: -right_m, right_m }
    };
    (0..planned.component.petals).map(petal).collect()
}
