//! How a plant stands under the forces that it feels; `bent_row` in client-wasm/shaders/ribbons.wgsl is its twin.

use super::plan::{Placed, Plan, SECTIONS_LIMIT};
use super::posture::Postures;
use glam::{Quat, Vec3};

/// How postures are looked up (004 §4.2).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LookUp {
    /// The nearest one of the table; for plants far away.
    Nearest,
    /// Between those about it; for plants near by.
    Interpolated,
}

/// How a plant stands on the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stand {
    /// Size over that of its species.
    pub size: f32,
    /// Heading of its first turn (rad).
    pub heading_rad: f32,
    /// Lean of what grows there (rad, as a vector along X and Z), which turns the plant's foot.
    pub lean_rad: [f32; 2],
}

/// What a plant feels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forces {
    /// Force per mass (m/s²): gravity, and what acts as it does.
    pub per_mass_m_per_s2: Vec3,
    /// Dynamic pressure of the air, ½·ρ·|u|·u (Pa).
    pub pressure_pa: Vec3,
}

/// A bent section.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Section {
    /// Its upper end (m, from the plant's root).
    pub end_m: Vec3,
    /// From its lower to its upper end, of length 1.
    pub direction: Vec3,
    /// To its right, across the direction, of length 1.
    pub side: Vec3,
}

/// A component as it is bent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Posed {
    /// Index among the parts of the plan.
    pub part: usize,
    /// Its size over that of its part.
    pub size: f32,
    /// Its foot (m, from the plant's root).
    pub foot_m: Vec3,
    /// Its unbent axis, of length 1.
    pub axis: Vec3,
    /// Across the axis, towards the load, of length 1: it bends in the plane of both.
    pub towards: Vec3,
    /// Largest moment over what it bears; it breaks above 1. 0 if it never does.
    pub strain: f32,
    count: usize,
    sections: [Section; SECTIONS_LIMIT],
}

impl Posed {
    /// Its sections, foot first.
    pub fn sections(&self) -> &[Section] {
        &self.sections[..self.count]
    }

    /// A place along it, as a share of its length, and the section it is on.
    fn at(&self, share: f32) -> (Vec3, Section) {
        let along = share.clamp(0.0, 1.0) * self.count as f32;
        let index = (along as usize).min(self.count - 1);
        let start_m = if index == 0 { self.foot_m } else { self.sections[index - 1].end_m };
        let section = self.sections[index];
        (start_m.lerp(section.end_m, along - index as f32), section)
    }
}

/// Poses the components of a plant, each on the bent shape of what it stands on; they are as [`Plan::placed`] gives them. Bit i of `broken` says that the
/// one at i is broken.
///
/// No section goes below the level of the plant's root: it lies on the ground there.
pub fn posed(plan: &Plan, placed: &[Placed], stand: Stand, forces: Forces, look_up: LookUp, broken: u64) -> Vec<Posed> {
    let ground = ground_frame(stand);
    let mut posed: Vec<Posed> = Vec::with_capacity(placed.len());
    for (index, one) in placed.iter().enumerate() {
        let part = &plan.parts[one.part];
        let (foot_m, frame) = one.on.map_or((Vec3::ZERO, ground), |on| posed[on].at(one.at_share));
        let unbent = unbent(foot_m, frame, one);
        let load = forces.per_mass_m_per_s2 * (part.weight_secs2_per_m * one.size * stand.size) + forces.pressure_pa * part.drag_per_pa;
        let is_broken = broken >> index & 1 == 1;
        let table = &plan.tables[part.broken.filter(|_| is_broken).unwrap_or(part.whole)];
        let (towards, node) = posture(table, &unbent, load, look_up);
        let (sections, count) = bent(&unbent, towards, one.size * stand.size * part.component.length_m, &node[..table.stride() - 1]);
        let moment = load.length() * node[table.stride() - 1];
        posed.push(Posed {
            part: one.part,
            size: one.size * stand.size,
            foot_m,
            axis: unbent.axis,
            towards,
            strain: if part.strength > 0.0 { moment / part.strength } else { 0.0 },
            count,
            sections,
        });
    }
    posed
}

/// Upright, turned by the lean of the ground: direction of what stands there, and the side where turns begin.
fn ground_frame(stand: Stand) -> Section {
    let [lean_x, lean_z] = stand.lean_rad;
    let lean = Quat::from_scaled_axis(Vec3::new(lean_z, 0.0, -lean_x));
    let (sine, cosine) = stand.heading_rad.sin_cos();
    Section { end_m: Vec3::ZERO, direction: lean * Vec3::Y, side: lean * Vec3::new(sine, 0.0, -cosine) }
}

/// A component before it bends.
struct Unbent {
    foot_m: Vec3,
    axis: Vec3,
    /// To its right.
    side: Vec3,
}

/// A component on what is directed as `frame`. Leaves hold their faces up: their width is level, or, where the axis is upright, across the turn.
fn unbent(foot_m: Vec3, frame: Section, one: &Placed) -> Unbent {
    let other = frame.direction.cross(frame.side);
    let (turn_sine, turn_cosine) = one.turn_rad.sin_cos();
    let (sine, cosine) = one.angle_rad.sin_cos();
    let outward = frame.side * turn_cosine - other * turn_sine;
    let across = outward.cross(frame.direction);
    let axis = (frame.direction * cosine + outward * sine).normalize_or(Vec3::Y);
    Unbent { foot_m, axis, side: square(axis.cross(Vec3::Y) + across * 1e-3, axis).normalize_or(across) }
}

/// What of a vector is across a direction of length 1.
fn square(vector: Vec3, direction: Vec3) -> Vec3 {
    vector - direction * vector.dot(direction)
}

/// The posture of a component under a load, and the direction across its axis in which it bends: towards the load, or, where the axis is exactly against the
/// load or along it, outward.
fn posture(table: &Postures, unbent: &Unbent, load: Vec3, look_up: LookUp) -> (Vec3, [f32; SECTIONS_LIMIT + 1]) {
    let &Unbent { axis, side, .. } = unbent;
    let size = load.length();
    let direction = load / size.max(f32::MIN_POSITIVE);
    let cosine = -direction.dot(axis);
    let mut node = [0.0; SECTIONS_LIMIT + 1];
    match look_up {
        LookUp::Nearest => node[..table.stride()].copy_from_slice(table.nearest(cosine, size)),
        LookUp::Interpolated => table.interpolated(cosine, size, &mut node),
    }
    let outward = axis.cross(side);
    (square(square(direction, axis) + outward * 1e-6, axis).normalize_or(outward), node)
}

/// The sections of a component of that length, each turned by its angle from the unbent axis, and their number.
fn bent(unbent: &Unbent, towards: Vec3, length_m: f32, bends_rad: &[f32]) -> ([Section; SECTIONS_LIMIT], usize) {
    let &Unbent { foot_m, axis, side, .. } = unbent;
    let section_m = length_m / bends_rad.len() as f32;
    let around = axis.cross(towards);
    let mut sections = [Section::default(); SECTIONS_LIMIT];
    let mut end_m = foot_m;
    for (section, &bend_rad) in sections.iter_mut().zip(bends_rad) {
        let (sine, cosine) = bend_rad.sin_cos();
        let free = axis * cosine + towards * sine;
        let turned = around * side.dot(around) + (towards * cosine - axis * sine) * side.dot(towards);
        let direction = above_ground(free, free.cross(turned), end_m.y / section_m);
        end_m += direction * section_m;
        let side = square(turned, direction).normalize_or(turned);
        // Once more, as little is left, of few digits, of a side that the ground has laid the section along.
        *section = Section { end_m, direction, side: square(side, direction).normalize_or(side) };
    }
    (sections, bends_rad.len())
}

/// The direction of a section that begins `height` of its lengths above the ground: as it is, or just as steep that it ends on the ground. One that falls
/// straight down lies down towards `front`.
fn above_ground(direction: Vec3, front: Vec3, height: f32) -> Vec3 {
    let up = direction.y.max(-height.max(0.0));
    let level = Vec3::new(direction.x + 1e-4 * front.x, 0.0, direction.z + 1e-4 * front.z).normalize_or_zero();
    let laid = Vec3::new(0.0, up, 0.0) + level * (1.0 - up * up).max(0.0).sqrt();
    if up > direction.y { laid } else { direction }.normalize_or(Vec3::Y)
}

#[cfg(test)]
mod tests;
