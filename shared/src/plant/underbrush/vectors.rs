//! The outline of a bent component as vectors (004 §3.1): along its axis, and to its left and right borders.

use super::plan::{Part, STALK_SHARE};
use super::plant::Posed;
use crate::scene::ComponentKind;
use glam::Vec3;

/// Angle at which petals stand off their flower's stalk (rad).
pub const PETAL_RAD: f32 = 1.15;

/// One vector of each of the three sets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vectors {
    /// Along the axis (m), from the end of the one before.
    pub axis_m: Vec3,
    /// From the end of that to the left border (m), across it.
    pub left_m: Vec3,
    /// And to the right border.
    pub right_m: Vec3,
}

/// Vectors of a component up from its foot, one for every `every` sections (004 §5.1: fewer, further away) and always one to its tip. The first
/// is the foot: it has no axis, and its borders are across the next.
pub fn vectors(part: &Part, posed: &Posed, every: usize) -> Vec<Vectors> {
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
        let border = |share: f32| side * (0.5 * width_m(part, posed.size, share));
        if out.is_empty() {
            out.push(Vectors { axis_m: Vec3::ZERO, left_m: -border(0.0), right_m: border(0.0) });
        }
        let border = border((index + 1) as f32 / sections.len() as f32);
        out.push(Vectors { axis_m, left_m: -border, right_m: border });
        from_m = section.end_m;
    }
    out
}

/// Width of a component's outline (m) at a share of its length. A leaf is widest at 0.425 of it, 0.45 as wide at its foot, and pointed; a branch, or the
/// stalk of a flower, is half as thick at its tip.
fn width_m(part: &Part, size: f32, share: f32) -> f32 {
    let width_m = part.component.width_m * size;
    match part.component.kind {
        ComponentKind::Leaf => width_m * (share + 0.15) * (1.0 - share) / (0.575 * 0.575),
        ComponentKind::Branch => width_m * (1.0 - 0.5 * share),
        ComponentKind::Flower => width_m * STALK_SHARE * (1.0 - 0.5 * share),
    }
}

/// Vectors of the petals of a flower, each from the tip of its stalk to its own tip, with borders at its middle; none of what is no flower.
pub fn petals(part: &Part, posed: &Posed) -> Vec<Vectors> {
    let (ComponentKind::Flower, Some(tip)) = (part.component.kind, posed.sections().last()) else {
        return Vec::new();
    };
    let other = tip.direction.cross(tip.side);
    let radius_m = 0.5 * part.component.width_m * posed.size;
    let step_rad = std::f32::consts::TAU / part.component.petals as f32;
    let (open_sine, open_cosine) = PETAL_RAD.sin_cos();
    let petal = |nth: u32| {
        let (sine, cosine) = (step_rad * nth as f32).sin_cos();
        let outward = tip.side * cosine + other * sine;
        // As wide at its middle as its share of the ring there.
        let right_m = (other * cosine - tip.side * sine) * (0.25 * step_rad * radius_m);
        Vectors { axis_m: (tip.direction * open_cosine + outward * open_sine) * radius_m, left_m: -right_m, right_m }
    };
    (0..part.component.petals).map(petal).collect()
}
