//! Posed plants: the shape of a plant under given forces; `bent_row` in `client-wasm/shaders` is its twin.

use super::plan::{Placed, Plan, SECTIONS_LIMIT};
use super::posture::Postures;
use glam::{Quat, Vec3};

/// Lookup of postures (Endo et al. 2003, §4.2).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LookUp {
    /// The nearest node of the table; for distant plants.
    Nearest,
    /// Interpolated between nodes; for near plants.
    Interpolated,
}

/// Position and orientation of a plant on the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stand {
    /// Size relative to its species.
    pub size: f32,
    /// Heading at which rotations start (rad).
    pub heading_rad: f32,
    /// Lean of the surrounding grass (rad, as a vector along X and Z), which tilts the base of the plant.
    pub lean_rad: [f32; 2],
}

/// Forces on a plant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forces {
    /// Force per mass (m/s²): gravity and other body forces.
    pub per_mass_m_per_s2: Vec3,
    /// Dynamic pressure of the air, ½·ρ·|u|·u (Pa).
    pub pressure_pa: Vec3,
}

/// A bent section.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Section {
    /// Its upper end (m, relative to the plant's root).
    pub end_m: Vec3,
    /// Unit vector from its lower to its upper end.
    pub direction: Vec3,
    /// Unit vector to its right, across the direction.
    pub side: Vec3,
}

/// A component with its bent sections.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Posed {
    /// Index among the components of the plan.
    pub planned: usize,
    /// Its size relative to its planned component.
    pub size: f32,
    /// Its base (m, relative to the plant's root).
    pub foot_m: Vec3,
    /// Unit vector along its unbent axis.
    pub axis: Vec3,
    /// Unit vector across the axis, towards the load: it bends in the plane of both.
    pub towards: Vec3,
    /// Largest moment relative to the strength; it breaks above 1. 0 if it never breaks.
    pub strain: f32,
    count: usize,
    sections: [Section; SECTIONS_LIMIT],
}

impl Posed {
    /// Its sections, from the base.
    pub fn sections(&self) -> &[Section] {
        &self.sections[..self.count]
    }

    /// Position at a fraction of its length, and the section that contains it.
    pub(in crate::plant) fn at(&self, fraction: f32) -> (Vec3, Section) {
        let along = fraction.clamp(0.0, 1.0) * self.count as f32;
        let index = (along as usize).min(self.count - 1);
        let start_m = if index == 0 { self.foot_m } else { self.sections[index - 1].end_m };
        let section = self.sections[index];
        (start_m.lerp(section.end_m, along - index as f32), section)
    }
}

/// Poses the components of a plant as [`Plan::placed`] gives them, each on the bent shape of its carrier. Bit i of `broken` marks component i as
/// broken.
///
/// No section goes below the level of the plant's root: it lies on the ground there.
pub fn posed(plan: &Plan, placed: &[Placed], stand: Stand, forces: Forces, look_up: LookUp, broken: u64) -> Vec<Posed> {
    let ground = ground_frame(stand);
    let mut posed: Vec<Posed> = Vec::with_capacity(placed.len());
    for (index, one) in placed.iter().enumerate() {
        let foot = one.on.map_or((Vec3::ZERO, ground), |on| posed[on].at(one.at_fraction));
        posed.push(posed_on(foot, plan, one, stand.size, forces, look_up, broken >> index & 1 == 1));
    }
    posed
}

/// Poses a component whose foot is at a position (m) on a section of its carrier, in a plant of that size.
pub(in crate::plant) fn posed_on(
    (foot_m, frame): (Vec3, Section),
    plan: &Plan,
    one: &Placed,
    size: f32,
    forces: Forces,
    look_up: LookUp,
    is_broken: bool,
) -> Posed {
    let planned = &plan.components[one.planned];
    let unbent = unbent(foot_m, frame, one);
    let size = one.size * size;
    let load = forces.per_mass_m_per_s2 * (planned.weight_s2_per_m * size) + forces.pressure_pa * planned.drag_per_pa;
    let table = &plan.tables[planned.broken.filter(|_| is_broken).unwrap_or(planned.whole)];
    let (towards, node) = posture(table, &unbent, load, look_up);
    let (sections, count) = bent(&unbent, towards, size * planned.component.length_m, &node[..table.stride() - 1]);
    let moment = load.length() * node[table.stride() - 1];
    Posed {
        planned: one.planned,
        size,
        foot_m,
        axis: unbent.axis,
        towards,
        strain: if planned.strength > 0.0 { moment / planned.strength } else { 0.0 },
        count,
        sections,
    }
}

/// Frame at the plant's root: the vertical, tilted by the lean of the grass, and the side at which rotations start.
pub(in crate::plant) fn ground_frame(stand: Stand) -> Section {
    let [lean_x, lean_z] = stand.lean_rad;
    let lean = Quat::from_scaled_axis(Vec3::new(lean_z, 0.0, -lean_x));
    let (sine, cosine) = stand.heading_rad.sin_cos();
    Section { end_m: Vec3::ZERO, direction: lean * Vec3::Y, side: lean * Vec3::new(sine, 0.0, -cosine) }
}

/// A component before it bends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::plant) struct Unbent {
    pub(in crate::plant) foot_m: Vec3,
    pub(in crate::plant) axis: Vec3,
    /// To its right.
    pub(in crate::plant) side: Vec3,
}

/// A component on a carrier with the direction `frame`. Leaves face up: their width is level, or, if the axis is vertical, across the rotation.
pub(in crate::plant) fn unbent(foot_m: Vec3, frame: Section, one: &Placed) -> Unbent {
    let other = frame.direction.cross(frame.side);
    let (turn_sine, turn_cosine) = one.turn_rad.sin_cos();
    let (sine, cosine) = one.angle_rad.sin_cos();
    let outward = frame.side * turn_cosine - other * turn_sine;
    let across = outward.cross(frame.direction);
    let axis = (frame.direction * cosine + outward * sine).normalize_or(Vec3::Y);
    Unbent { foot_m, axis, side: square(axis.cross(Vec3::Y) + across * 1e-3, axis).normalize_or(across) }
}

/// Component of a vector perpendicular to a unit vector.
fn square(vector: Vec3, direction: Vec3) -> Vec3 {
    vector - direction * vector.dot(direction)
}

/// The posture of a component under a load, and the direction across its axis in which it bends: towards the load, or outward if the axis is parallel
/// to the load.
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

/// The sections of a component of that length, each rotated by its angle from the unbent axis, and their number.
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
        // Normalised again: if the ground has laid the section along its side, the remainder is small and imprecise.
        *section = Section { end_m, direction, side: square(side, direction).normalize_or(side) };
    }
    (sections, bends_rad.len())
}

/// Direction of a section that starts `height` of its lengths above the ground: unchanged, or just steep enough to end on the ground. One that falls
/// straight down lies down towards `front`.
fn above_ground(direction: Vec3, front: Vec3, height: f32) -> Vec3 {
    let up = direction.y.max(-height.max(0.0));
    let level = Vec3::new(direction.x + 1e-4 * front.x, 0.0, direction.z + 1e-4 * front.z).normalize_or_zero();
    let laid = Vec3::new(0.0, up, 0.0) + level * (1.0 - up * up).max(0.0).sqrt();
    if up > direction.y { laid } else { direction }.normalize_or(Vec3::Y)
}

#[cfg(test)]
mod tests;
