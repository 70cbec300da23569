//! Data from which the GPU bends the plants of a species at a level of detail: components, tables of postures (Endo et al. 2003, §4.2) and rows.
//!
//! A row is a point on the axis of a component, or of a petal, with a border half a width away on either side. `ribbons.wgsl` walks to it from the root along
//! sections of fixed lengths, each rotated according to the table for the load on its component, like [`posed`]. Only the shader lets spheres push plants
//! aside.
//!
//! # Accuracy
//! Errors over the shipped species, all headings, winds up to 11 m/s, leans, and sizes of 0.4 to 1.35:
//! - Lengths with every section: at most 1e-5, by rounding.
//! - Tips with every section, against [`posed`]: at most 2e-4 of the component's length, root mean square. Single tips differ by at most 5e-3, except those of
//!   upright components, which rounding lets fall to either side.
//! - Tips with every section, against the balance of moments itself: 0.25 %, root mean square; 99 of 100 differ by less than 0.5 %, the worst by 8 %.
//! - Tips with every second section, every fourth, and one section: 0.2 %, 0.6 % and 2 % of the plant's reach, at worst 4 %, 8 % and 15 %. Components are then
//!   attached to straight steps, and with one section use the nearest posture.

use super::close_up::close_up;
pub(super) use crate::render::gpu::constants::VARIANTS;
use crate::render::gpu::constants::{GRAVITY_M_PER_S2, PETAL, STALK, UNDERBRUSH_LEVELS, WIDTH_UNIT_M};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use prairie_core::plant::underbrush::drops::Struck;
use prairie_core::plant::underbrush::plan::{Placed, Plan, PlannedComponent, SECTIONS_LIMIT};
use prairie_core::plant::underbrush::plant::{Forces, LookUp, Posed, Stand, posed};
use prairie_core::plant::underbrush::posture::Postures;
use prairie_core::plant::underbrush::vectors::{PETAL_RAD, vectors};
use prairie_core::scene::ComponentKind;
use std::f32::consts::{FRAC_PI_4, TAU};

/// Levels of detail: every section, every second, every fourth, and whole components as one section with fewer components.
pub(super) const LEVELS: usize = UNDERBRUSH_LEVELS as usize;
/// Sections that each level merges into one.
pub(super) const EVERY: [usize; LEVELS] = [1, 2, 4, SECTIONS_LIMIT];
/// Maximum number of leaves of a plant at the coarsest level.
const COARSE_LEAVES: usize = 10;
/// Area of a leaf relative to its length times its width.
const LEAF_AREA: f32 = 0.73;
/// Shortest time to the maximum deflection of a trembling component (s); faster motion is not visible between frames.
const FASTEST_SECS: f32 = 1.0 / 60.0;

const GRAVITY: Vec3 = Vec3::new(0.0, -GRAVITY_M_PER_S2, 0.0);

/// Material of a row; same as in `ribbons.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum RowMaterial {
    Leaf = 0,
    Stalk = STALK as isize,
    Petal = PETAL as isize,
}

/// A row; same as in `ribbons.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(super) struct Row {
    /// Half its width in the low half, material in the high half.
    width_and_material: u32,
    /// Square root of its linear colour, a byte per channel.
    rgb: u32,
    /// Number of its component in the low half, number of steps below it there in the high half.
    limb_and_steps: u32,
    /// Properties for close-ups.
    close: u32,
    /// Place in its petal; zero for other rows.
    petal: PetalPlace,
}

/// Place of a row in a petal.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
struct PetalPlace {
    /// Distance from the tip of the stalk (m).
    from_stalk_m: f32,
    /// Cosine and sine of the petal's rotation around the stalk.
    turn_cosine: f32,
    turn_sine: f32,
    /// Sine of its angle from the stalk.
    sine: f32,
}

#[cfg(test)]
impl Row {
    /// Whether it belongs to a petal.
    pub(super) fn is_petal(&self) -> bool {
        self.width_and_material >> 16 == RowMaterial::Petal as u32
    }

    /// Number of its component in the plant.
    pub(super) fn limb(&self) -> usize {
        (self.limb_and_steps & 0xffff) as usize
    }
}

/// A component of a plant; same as in `ribbons.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(super) struct Limb {
    /// Cosine and sine of its angle from its parent component.
    angle: [f32; 2],
    /// Cosine and sine of its rotation around the parent.
    turn: [f32; 2],
    /// Load Λ per force per mass (s²/m), of a plant of size 1 as all that follows.
    load_s2_per_m: f32,
    /// Load Λ per pressure (1/Pa).
    load_per_pa: f32,
    /// Length (m).
    length_m: f32,
    /// Position along its parent (steps).
    host_steps: f32,
    /// First step of its table.
    first_step: u32,
    /// Number of steps.
    steps: u32,
    /// Number of its parent component.
    host: u32,
    /// Depth in the hierarchy.
    depth: u32,
    /// Response to rain.
    drop: DropResponse,
}

/// Response of a component to a drop of rain.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
struct DropResponse {
    /// Initial speed of its tip after the impact (m/s).
    speed_m_per_s: f32,
    /// Time to the maximum deflection (s).
    settle_secs: f32,
    /// Area exposed to rain (m²); 0 if it does not tremble.
    area_m2: f32,
    _unused: f32,
}

/// A species at a level of detail.
pub(super) struct Baked {
    /// Rows by variant.
    pub(super) rows: Vec<Row>,
    /// Rows of each component or petal, in order.
    pub(super) ribbons: Vec<u32>,
    /// Components by variant, upright plants first, then broken ones.
    pub(super) limbs: Vec<Limb>,
    /// Steps of all tables: angle from the unbent axis (rad) and length relative to the component, by table, angle and load as in [`Postures`].
    pub(super) steps: Vec<[f32; 2]>,
}

impl Baked {
    /// Data of the plants of a plan at a level of detail.
    pub(super) fn new(plan: &Plan, level: usize) -> Self {
        let every = EVERY[level];
        let mut steps = Vec::new();
        let tables: Vec<u32> = plan
            .tables
            .iter()
            .map(|table| {
                let first = steps.len() as u32;
                steps.extend(chords(table, every));
                first
            })
            .collect();
        let makes: Vec<Vec<Placed>> = (0..VARIANTS).map(|number| plan.placed(number)).collect();
        let kept = kept(plan, &makes[0], level);
        let mut baked = Self { rows: Vec::new(), ribbons: Vec::new(), limbs: Vec::new(), steps };
        for (number, placed) in makes.iter().enumerate() {
            // Only the widths are used, which do not depend on the posture.
            let forces = Forces { per_mass_m_per_s2: Vec3::ZERO, pressure_pa: Vec3::ZERO };
            let unbent = posed(plan, placed, Stand { size: 1.0, heading_rad: 0.0, lean_rad: [0.0; 2] }, forces, LookUp::Nearest, 0);
            for &(index, wider) in &kept {
                let planned = &plan.components[placed[index].planned];
                for (nth, mut ribbon) in ribbons(planned, &unbent[index], index, level, wider).into_iter().enumerate() {
                    let rows = ribbon.len();
                    ribbon.iter_mut().enumerate().for_each(|(at, row)| row.close = close_up(&planned.component, nth > 0, at, rows));
                    if number == 0 {
                        baked.ribbons.push(ribbon.len() as u32);
                    }
                    baked.rows.extend(ribbon);
                }
            }
        }
        for is_broken in [false, true] {
            for placed in &makes {
                let calm = Forces { per_mass_m_per_s2: GRAVITY, pressure_pa: Vec3::ZERO };
                let calm = posed(plan, placed, Stand { size: 1.0, heading_rad: 0.0, lean_rad: [0.0; 2] }, calm, LookUp::Nearest, 0);
                let drop = |index: usize| drop_response(&plan.components[placed[index].planned], &calm[index]);
                let limb = |index: usize| Limb { drop: drop(index), ..limb(plan, &tables, placed, index, every, is_broken) };
                baked.limbs.extend((0..placed.len()).map(limb));
            }
        }
        baked
    }

    /// Components of a plant.
    pub(super) fn limb_count(&self) -> u32 {
        self.limbs.len() as u32 / (2 * VARIANTS)
    }

    /// Indices of this number of plants, two vertices per row.
    pub(super) fn indices(&self, plants: u32) -> Vec<u32> {
        let mut indices = Vec::new();
        let mut first = 0;
        for _ in 0..plants {
            for &rows in &self.ribbons {
                let quads = (0..rows - 1).map(|row| first + 2 * row);
                indices.extend(quads.flat_map(|a| [a, a + 1, a + 2, a + 2, a + 1, a + 3]));
                first += 2 * rows;
            }
        }
        indices
    }
}

/// Postures of a table with `every` sections merged into one straight step: its angle from the unbent axis (rad) and its length relative to the component.
fn chords(table: &Postures, every: usize) -> impl Iterator<Item = [f32; 2]> {
    let sections = table.stride() - 1;
    let chord = move |bends_rad: &[f32]| {
        if let &[bend_rad] = bends_rad {
            return [bend_rad, 1.0 / sections as f32];
        }
        let [x, y] = bends_rad.iter().fold([0.0_f32; 2], |[x, y], bend_rad| [x + bend_rad.cos(), y + bend_rad.sin()]);
        [y.max(0.0).atan2(x), x.hypot(y) / sections as f32]
    };
    table.values().chunks_exact(table.stride()).flat_map(move |node| node[..sections].chunks(every).map(chord))
}

fn limb(plan: &Plan, tables: &[u32], placed: &[Placed], index: usize, every: usize, is_broken: bool) -> Limb {
    let one = &placed[index];
    let planned = &plan.components[one.planned];
    let table = planned.broken.filter(|_| is_broken).unwrap_or(planned.whole);
    let sections = |table: usize| plan.tables[table].stride() - 1;
    let at_step = one.on.map_or(0.0, |on| {
        let sections = sections(plan.components[placed[on].planned].whole);
        let at = one.at_fraction.clamp(0.0, 1.0) * sections as f32;
        let step = (at as usize).min(sections - 1) / every;
        let held = every.min(sections - step * every);
        step as f32 + (at - (step * every) as f32) / held as f32
    });
    let depth = std::iter::successors(one.on, |&on| placed[on].on).count();
    let ((sine, cosine), (turn_sine, turn_cosine)) = (one.angle_rad.sin_cos(), one.turn_rad.sin_cos());
    Limb {
        angle: [cosine, sine],
        turn: [turn_cosine, turn_sine],
        load_s2_per_m: planned.weight_s2_per_m * one.size,
        load_per_pa: planned.drag_per_pa,
        length_m: planned.component.length_m * one.size,
        host_steps: at_step,
        first_step: tables[table],
        steps: sections(table).div_ceil(every) as u32,
        host: one.on.unwrap_or(0) as u32,
        depth: depth as u32,
        drop: DropResponse::default(),
    }
}

/// Response of a component to a drop of rain. Leaves catch drops with their area as seen from above, flowers with the disc of their petals; stalks are
/// stiff.
fn drop_response(planned: &PlannedComponent, calm: &Posed) -> DropResponse {
    let component = &planned.component;
    let Struck { speed_m_per_s, settle_secs } = Struck::new(component, calm.size);
    let area_m2 = match component.kind {
        _ if settle_secs < FASTEST_SECS => 0.0,
        ComponentKind::Branch => 0.0,
        ComponentKind::Flower => FRAC_PI_4 * (component.width_m * calm.size).powi(2),
        ComponentKind::Leaf => {
            let outline = vectors(planned, calm, 1);
            let area = |length_m: fn(Vec3) -> f32| -> f32 {
                outline.windows(2).map(|pair| (pair[0].right_m.length() + pair[1].right_m.length()) * length_m(pair[1].axis_m)).sum()
            };
            let seen_fraction = area(|axis_m| axis_m.with_y(0.0).length()) / area(Vec3::length);
            LEAF_AREA * component.width_m * component.length_m * calm.size * calm.size * seen_fraction
        }
    };
    DropResponse { speed_m_per_s, settle_secs, area_m2, _unused: 0.0 }
}

/// Components drawn at a level of detail, with a factor on their width that preserves coverage. The coarsest level omits thin stalks and most leaves.
fn kept(plan: &Plan, placed: &[Placed], level: usize) -> Vec<(usize, f32)> {
    let kind = |index: usize| plan.components[placed[index].planned].component.kind;
    let is_stout = |index: usize| plan.components[placed[index].planned].component.width_m > 0.006;
    if level + 1 < LEVELS {
        return (0..placed.len()).map(|index| (index, 1.0)).collect();
    }
    let leaves: Vec<usize> = (0..placed.len()).filter(|&index| kind(index) == ComponentKind::Leaf).collect();
    let step = leaves.len().div_ceil(COARSE_LEAVES).max(1);
    let thinned: Vec<usize> = leaves.iter().copied().step_by(step).collect();
    let wider = leaves.len() as f32 / thinned.len().max(1) as f32;
    let is_all_thin = leaves.is_empty() && !(0..placed.len()).any(is_stout);
    let shown = |index: &usize| match kind(*index) {
        ComponentKind::Leaf => thinned.contains(index),
        ComponentKind::Branch => is_all_thin || is_stout(*index),
        ComponentKind::Flower => true,
    };
    let width = |index: usize| (index, if kind(index) == ComponentKind::Leaf { wider.powf(0.75) } else { 1.0 });
    (0..placed.len()).filter(shown).map(width).collect()
}

/// Ribbons of the component at `index` of a plant: its own, and those of its petals.
fn ribbons(planned: &PlannedComponent, one: &Posed, index: usize, level: usize, wider: f32) -> Vec<Vec<Row>> {
    let component = &planned.component;
    let (root, tip) = (Vec3::from(component.root_rgb), Vec3::from(component.tip_rgb));
    let outline = vectors(planned, one, EVERY[level]);
    let steps = outline.len() - 1;
    let row = |step: usize, half_m: f32, rgb: Vec3, material: RowMaterial, petal: PetalPlace| {
        let half = (half_m / WIDTH_UNIT_M).round().clamp(0.0, 65_535.0) as u32;
        // The square root keeps dark colours apart in 8 bits.
        let [r, g, b] = rgb.to_array().map(|v| (v.clamp(0.0, 1.0).sqrt() * 255.0 + 0.5) as u32);
        Row {
            width_and_material: half | (material as u32) << 16,
            rgb: r | g << 8 | b << 16,
            limb_and_steps: index as u32 | (step as u32) << 16,
            close: 0,
            petal,
        }
    };
    // A coarse outline cuts off the belly of a leaf, so it is widened to the same area.
    let halves: Vec<f32> = outline.iter().map(|vector| vector.right_m.length()).collect();
    let area: f32 = halves.windows(2).map(|pair| pair[0] + pair[1]).sum::<f32>() / steps.max(1) as f32;
    let whole = if component.kind == ComponentKind::Leaf { LEAF_AREA * component.width_m * one.size } else { area };
    let fill = if area > 0.0 { whole / area } else { 1.0 };
    let material = if component.kind == ComponentKind::Leaf { RowMaterial::Leaf } else { RowMaterial::Stalk };
    let own = halves.iter().enumerate().map(|(step, half_m)| {
        let fraction = step as f32 / steps.max(1) as f32;
        let color = if component.kind == ComponentKind::Flower { root } else { root.lerp(tip, fraction) };
        row(step, half_m * fill * wider, color, material, PetalPlace::default())
    });
    let mut all = vec![own.collect::<Vec<_>>()];
    if component.kind != ComponentKind::Flower {
        return all;
    }
    let radius_m = 0.5 * component.width_m * one.size;
    if level + 1 == LEVELS {
        // A single face for all petals.
        let across = |sign: f32| PetalPlace { from_stalk_m: sign * radius_m, turn_cosine: 0.0, turn_sine: 1.0, sine: 1.0 };
        all.push([-1.0, 1.0].map(|sign| row(steps, 0.8 * radius_m, tip, RowMaterial::Petal, across(sign))).to_vec());
        return all;
    }
    let step_rad = TAU / component.petals as f32;
    for nth in 0..component.petals {
        let (sine, cosine) = (step_rad * nth as f32).sin_cos();
        let petal = |fraction: f32, wide: f32| {
            let half_m = 0.25 * step_rad * radius_m * wide;
            let place = PetalPlace { from_stalk_m: fraction * radius_m, turn_cosine: cosine, turn_sine: sine, sine: PETAL_RAD.sin() };
            row(steps, half_m, tip * (0.7 + 0.3 * fraction), RowMaterial::Petal, place)
        };
        all.push(vec![petal(0.0, 0.25), petal(0.55, 1.0), petal(1.0, 0.55)]);
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::gpu::constants::FALL_PA;
    use prairie_core::plant::underbrush::posture::Nodes;
    use prairie_core::scene::{Component, Underbrush};

    fn tuft() -> Underbrush {
        let mut leaf = Component::new("leaf", ComponentKind::Leaf);
        (leaf.count, leaf.sections) = (12, 16);
        let mut flower = Component::new("flower", ComponentKind::Flower);
        (flower.count, flower.width_m, flower.petals) = (2, 0.06, 5);
        Underbrush::new("tuft", vec![leaf, flower])
    }

    #[test]
    fn all_variants_have_the_same_rows_and_components() {
        let plan = Plan::new(&tuft(), Nodes::default());
        let mut before = usize::MAX;
        for level in 0..LEVELS {
            let baked = Baked::new(&plan, level);
            let rows = baked.ribbons.iter().sum::<u32>() as usize;
            assert_eq!(baked.rows.len(), VARIANTS as usize * rows);
            assert_eq!((baked.limb_count(), baked.limbs.len()), (14, 2 * VARIANTS as usize * 14));
            assert!(rows < before, "{rows} rows after {before}");
            assert_eq!(baked.indices(3).iter().max().map(|&last| last as usize), Some(6 * rows - 1));
            assert!(level + 1 < LEVELS || baked.ribbons.iter().all(|&rows| rows == 2), "{:?}", baked.ribbons);
            before = rows;
        }
    }

    use prairie_core::plant::underbrush::bearing::bears_pa;

    #[test]
    fn broken_plants_lie_in_the_direction_of_the_force() {
        let mut species =
            prairie_core::scene::parse_underbrush(include_str!("../../../../../server/scenes/species.toml")).expect("sound species");
        // Those that a storm breaks: 100 m/s has 6 kPa.
        species.retain(|species| bears_pa(&Plan::new(species, Nodes::default())) < 6000.0);
        assert!(species.len() >= 3);
        for (own, number) in species.iter().flat_map(|own| (0..VARIANTS).map(move |number| (own, number))) {
            let plan = Plan::new(own, Nodes::default());
            let placed = plan.placed(number);
            // The force of a fall, and beyond it that of a wind of 13 m/s.
            for (heading, pressure_pa) in (0..8).flat_map(|heading| [FALL_PA, 30.0, 101.0].map(|pressure_pa| (heading, pressure_pa))) {
                let (sine, cosine) = (TAU * heading as f32 / 8.0).sin_cos();
                let forces = Forces { per_mass_m_per_s2: GRAVITY, pressure_pa: Vec3::new(cosine, 0.0, sine) * pressure_pa };
                let stand = Stand { size: 1.0, heading_rad: 0.0, lean_rad: [0.0; 2] };
                for one in posed(&plan, &placed, stand, forces, LookUp::Interpolated, u64::MAX) {
                    let planned = &plan.components[one.planned];
                    if planned.on.is_some() || planned.broken.is_none() {
                        continue;
                    }
                    let tip_m = one.sections()[one.sections().len() - 1].end_m / (planned.component.length_m * one.size);
                    let along = tip_m.x * cosine + tip_m.z * sine;
                    assert!(along > 0.9 && tip_m.y < 0.1, "{} of {}: {tip_m} at heading {heading}", planned.component.name, own.name);
                }
            }
        }
    }

    #[test]
    fn every_level_shows_something_of_every_plant() {
        for (kind, width_m) in [(ComponentKind::Branch, 0.004), (ComponentKind::Flower, 0.03), (ComponentKind::Leaf, 0.001)] {
            let species = Underbrush::new("one", vec![Component { width_m, ..Component::new("one", kind) }]);
            let plan = Plan::new(&species, Nodes::default());
            assert!((0..LEVELS).all(|level| !Baked::new(&plan, level).rows.is_empty()), "{kind:?}");
        }
    }

    #[test]
    fn a_coarse_leaf_covers_what_a_fine_one_does() {
        let species =
            Underbrush::new("leaf", vec![Component { sections: 8, length_variation: 0.0, ..Component::new("leaf", ComponentKind::Leaf) }]);
        let plan = Plan::new(&species, Nodes::default());
        let area = |level: usize| {
            let baked = Baked::new(&plan, level);
            let halves: Vec<f32> =
                baked.rows[..baked.ribbons[0] as usize].iter().map(|row| (row.width_and_material & 0xffff) as f32 * WIDTH_UNIT_M).collect();
            halves.windows(2).map(|pair| pair[0] + pair[1]).sum::<f32>() / (halves.len() - 1) as f32
        };
        for level in 0..LEVELS {
            assert!((area(level) / (0.73 * 0.01) - 1.0).abs() < 0.02, "{} at level {level}", area(level));
        }
    }

    #[test]
    fn leaves_catch_the_drops_that_fall_on_them() {
        let component = |kind, angle_rad: f32| Component {
            length_variation: 0.0,
            angle_variation_rad: 0.0,
            angle_rad,
            stiffness_n_m2: 0.01,
            ..Component::new("one", kind)
        };
        let catches_m2 = |component: Component| {
            let plan = Plan::new(&Underbrush::new("one", vec![component]), Nodes::default());
            Baked::new(&plan, 0).limbs[0].drop.area_m2
        };
        let level_m2 = catches_m2(component(ComponentKind::Leaf, 1.5));
        assert!((level_m2 / (0.73 * 0.4 * 0.01) - 1.0).abs() < 0.05, "{level_m2}");
        let upright_m2 = catches_m2(component(ComponentKind::Leaf, 0.1));
        assert!(upright_m2 < 0.2 * level_m2, "{upright_m2} of {level_m2}");
        let flower_m2 = catches_m2(component(ComponentKind::Flower, 0.3));
        assert!((flower_m2 / (FRAC_PI_4 * 1e-4) - 1.0).abs() < 1e-4, "{flower_m2}");
        assert_eq!(catches_m2(component(ComponentKind::Branch, 0.3)), 0.0, "stalks stand");
        assert_eq!(catches_m2(Component { stiffness_n_m2: 1.0, ..component(ComponentKind::Leaf, 1.5) }), 0.0, "as do stiff leaves");
    }

    #[test]
    fn steps_of_several_sections_end_where_those_do() {
        let leaf = Component { sections: 6, ..Component::new("leaf", ComponentKind::Leaf) };
        let plan = Plan::new(&Underbrush::new("leaf", vec![leaf]), Nodes { angles: 9, loads: 9 });
        let ends = |every: usize| {
            let steps: Vec<[f32; 2]> = chords(&plan.tables[0], every).collect();
            assert!(
                steps
                    .iter()
                    .all(|&[angle, length]| (0.0..=std::f32::consts::PI + 1e-4).contains(&angle) && length * 6.0 <= every as f32 + 1e-5)
            );
            let nodes = steps.chunks_exact(6_usize.div_ceil(every));
            nodes
                .map(|node| node.iter().fold(Vec3::ZERO, |end, &[angle, length]| end + Vec3::new(angle.cos(), angle.sin(), 0.0) * length))
                .collect::<Vec<_>>()
        };
        for every in [2, 4, 8] {
            assert!(ends(1).iter().zip(ends(every)).all(|(fine, coarse)| fine.distance(coarse) < 1e-6));
        }
    }
}
