//! What the GPU bends the plants of a species with: their components, tables of postures (004 §4.2) and rows, for a level of detail.
//!
//! A row is a place on a component's axis from whose sides the borders stand half a width off, or one of a petal. `ribbons.wgsl` walks to it from the root
//! along sections of fixed lengths, each turned as the tables say for the load on its own component: as [`posed`] does, whose twin it is. What is laid aside
//! by spheres is the shader's alone.
//!
//! # Accuracy
//! Over the species that ship, all headings, winds up to 11 m/s, leans and sizes 0.4 to 1.35, with every section: lengths are exact (to 1e-5, rounding); tips
//! are off those of [`posed`] by 2e-4 of the component's length at most, root mean square (all but upright ones by 5e-3 at most, where it is a matter of
//! rounding which side they fall to), and off those of the balance itself by 0.25 % (99 of 100 by less than 0.5 %, the worst by 8 %). With every second
//! section, every fourth and one, by 0.2 %, 0.6 % and 2 % of the plant's reach (at worst 4 %, 8 % and 15 %): components then stand on straight steps, and
//! with one section at the nearest posture.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use shared::plant::underbrush::drops::Struck;
use shared::plant::underbrush::plan::{Part, Placed, Plan, SECTIONS_LIMIT};
use shared::plant::underbrush::plant::{Forces, LookUp, Posed, Stand, posed};
use shared::plant::underbrush::posture::Postures;
use shared::plant::underbrush::vectors::{PETAL_RAD, vectors};
use shared::scene::ComponentKind;
use std::f32::consts::{FRAC_PI_4, TAU};

/// Plants of different make of each species; twin of the constant in `underbrush.wgsl`.
pub(super) const VARIANTS: u32 = 4;
/// Levels of detail: every section, every second, fourth, and the whole component as one, of fewer components.
pub(super) const LEVELS: usize = 4;
/// Sections that each level shows as one.
pub(super) const EVERY: [usize; LEVELS] = [1, 2, 4, SECTIONS_LIMIT];
/// Most leaves of a plant in the coarsest level.
const COARSE_LEAVES: usize = 10;
/// Half-widths are in units of this (m); twin of the constant in `ribbons.wgsl`.
const WIDTH_UNIT_M: f32 = 1.0 / 16_384.0;
/// Area of a leaf over its length times its width.
const LEAF_SHARE: f32 = 0.73;
/// Shortest time in which a component that trembles is as far off as it gets (s): what is back before the next picture can't be seen.
const FASTEST_SECS: f32 = 1.0 / 60.0;

const GRAVITY: Vec3 = Vec3::new(0.0, -9.81, 0.0);

/// What a row is of; twins of the constants in `ribbons.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stuff {
    Leaf = 0,
    Stalk = 1,
    Petal = 2,
}

/// A row; its twin is in `ribbons.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(super) struct Row {
    /// Half its width and what it is of; its colour; the component that it is on and the steps below it there; unused.
    look: [u32; 4],
    /// Of a petal: how far it is from the tip of the stalk (m), cosine and sine of its turn about that, and sine of the angle at which it stands off.
    petal: [f32; 4],
}

#[cfg(test)]
impl Row {
    /// Whether it is of a petal.
    pub(super) fn is_petal(&self) -> bool {
        self.look[0] >> 16 == Stuff::Petal as u32
    }

    /// Number of its component in the plant.
    pub(super) fn limb(&self) -> usize {
        (self.look[2] & 0xffff) as usize
    }
}

/// A component of a plant; its twin is in `ribbons.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(super) struct Limb {
    /// Cosine and sine of its angle from what it stands on, and of its turn about that.
    turns: [f32; 4],
    /// Load Λ per force per mass (s²/m) and per pressure (1/Pa); length (m); where it stands, in steps of what it stands on. All at the plant's size 1.
    nature: [f32; 4],
    /// First step of its table; its steps; what it stands on; on how many, one on the other.
    table: [u32; 4],
    /// Speed at which a drop of rain sets its tip off (m/s), time in which that is as far off as it gets (s), area on which drops strike it (m²; 0 for what does
    /// not tremble); unused.
    struck: [f32; 4],
}

/// A species at a level of detail.
pub(super) struct Baked {
    /// Make by make.
    pub(super) rows: Vec<Row>,
    /// Rows of each component or petal, in order.
    pub(super) ribbons: Vec<u32>,
    /// By make, whole plants first, then broken ones.
    pub(super) limbs: Vec<Limb>,
    /// Steps of all tables: angle from the unbent axis (rad) and share of the component's length, by table, angle and load as in [`Postures`].
    pub(super) steps: Vec<[f32; 2]>,
}

impl Baked {
    /// Plants made by `plan`, as a level of detail shows them.
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
            // Rows take its widths, which don't depend on how it is bent.
            let forces = Forces { per_mass_m_per_s2: Vec3::ZERO, pressure_pa: Vec3::ZERO };
            let unbent = posed(plan, placed, Stand { size: 1.0, heading_rad: 0.0, lean_rad: [0.0; 2] }, forces, LookUp::Nearest, 0);
            for &(index, wider) in &kept {
                for ribbon in ribbons(&plan.parts[placed[index].part], &unbent[index], index, level, wider) {
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
                let struck = |index: usize| struck(&plan.parts[placed[index].part], &calm[index]);
                let limb = |index: usize| Limb { struck: struck(index), ..limb(plan, &tables, placed, index, every, is_broken) };
                baked.limbs.extend((0..placed.len()).map(limb));
            }
        }
        baked
    }

    /// Components of a plant.
    pub(super) fn limb_count(&self) -> u32 {
        self.limbs.len() as u32 / (2 * VARIANTS)
    }

    /// Triangles of so many plants, two vertices a row.
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

/// The postures of a table with `every` sections as one straight step: its angle from the unbent axis (rad) and its share of the component's length.
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
    let part = &plan.parts[one.part];
    let table = part.broken.filter(|_| is_broken).unwrap_or(part.whole);
    let sections = |table: usize| plan.tables[table].stride() - 1;
    let at_step = one.on.map_or(0.0, |on| {
        let sections = sections(plan.parts[placed[on].part].whole);
        let at = one.at_share.clamp(0.0, 1.0) * sections as f32;
        let step = (at as usize).min(sections - 1) / every;
        let held = every.min(sections - step * every);
        step as f32 + (at - (step * every) as f32) / held as f32
    });
    let depth = std::iter::successors(one.on, |&on| placed[on].on).count();
    let ((sine, cosine), (turn_sine, turn_cosine)) = (one.angle_rad.sin_cos(), one.turn_rad.sin_cos());
    Limb {
        turns: [cosine, sine, turn_cosine, turn_sine],
        nature: [part.weight_secs2_per_m * one.size, part.drag_per_pa, part.component.length_m * one.size, at_step],
        table: [tables[table], sections(table).div_ceil(every) as u32, one.on.unwrap_or(0) as u32, depth as u32],
        struck: [0.0; 4],
    }
}

/// How a component answers drops of rain, as [`Limb`] has it. Of a leaf what is seen from above catches them, of a flower the disc of its petals; stalks are stiff.
fn struck(part: &Part, calm: &Posed) -> [f32; 4] {
    let component = &part.component;
    let Struck { speed_m_per_s, settle_secs } = Struck::new(component, calm.size);
    let catches_m2 = match component.kind {
        _ if settle_secs < FASTEST_SECS => 0.0,
        ComponentKind::Branch => 0.0,
        ComponentKind::Flower => FRAC_PI_4 * (component.width_m * calm.size).powi(2),
        ComponentKind::Leaf => {
            let outline = vectors(part, calm, 1);
            let area = |length_m: fn(Vec3) -> f32| -> f32 {
                outline.windows(2).map(|pair| (pair[0].right_m.length() + pair[1].right_m.length()) * length_m(pair[1].axis_m)).sum()
            };
            let seen_share = area(|axis_m| axis_m.with_y(0.0).length()) / area(Vec3::length);
            LEAF_SHARE * component.width_m * component.length_m * calm.size * calm.size * seen_share
        }
    };
    [speed_m_per_s, settle_secs, catches_m2, 0.0]
}

/// The components that a level shows, and how much wider it shows them to cover as much: the coarsest leaves thin stalks out, and most leaves.
fn kept(plan: &Plan, placed: &[Placed], level: usize) -> Vec<(usize, f32)> {
    let kind = |index: usize| plan.parts[placed[index].part].component.kind;
    let is_stout = |index: usize| plan.parts[placed[index].part].component.width_m > 0.006;
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

/// The ribbons of the component at `index` of a plant: its own, and those of its petals.
fn ribbons(part: &Part, one: &Posed, index: usize, level: usize, wider: f32) -> Vec<Vec<Row>> {
    let component = &part.component;
    let (root, tip) = (Vec3::from(component.root_rgb), Vec3::from(component.tip_rgb));
    let outline = vectors(part, one, EVERY[level]);
    let steps = outline.len() - 1;
    let row = |step: usize, half_m: f32, rgb: Vec3, stuff: Stuff, petal: [f32; 4]| {
        let half = (half_m / WIDTH_UNIT_M).round().clamp(0.0, 65_535.0) as u32;
        // The square root keeps dark colours apart in 8 bits.
        let [r, g, b] = rgb.to_array().map(|v| (v.clamp(0.0, 1.0).sqrt() * 255.0 + 0.5) as u32);
        Row { look: [half | (stuff as u32) << 16, r | g << 8 | b << 16, index as u32 | (step as u32) << 16, 0], petal }
    };
    // A coarse outline cuts the belly of a leaf off: it is widened until its area is the leaf's.
    let halves: Vec<f32> = outline.iter().map(|vector| vector.right_m.length()).collect();
    let area: f32 = halves.windows(2).map(|pair| pair[0] + pair[1]).sum::<f32>() / steps.max(1) as f32;
    let whole = if component.kind == ComponentKind::Leaf { LEAF_SHARE * component.width_m * one.size } else { area };
    let fill = if area > 0.0 { whole / area } else { 1.0 };
    let stuff = if component.kind == ComponentKind::Leaf { Stuff::Leaf } else { Stuff::Stalk };
    let own = halves.iter().enumerate().map(|(step, half_m)| {
        let share = step as f32 / steps.max(1) as f32;
        let color = if component.kind == ComponentKind::Flower { root } else { root.lerp(tip, share) };
        row(step, half_m * fill * wider, color, stuff, [0.0; 4])
    });
    let mut all = vec![own.collect::<Vec<_>>()];
    if component.kind != ComponentKind::Flower {
        return all;
    }
    let radius_m = 0.5 * component.width_m * one.size;
    if level + 1 == LEVELS {
        // One face for the ring of petals.
        all.push([-1.0, 1.0].map(|sign| row(steps, 0.8 * radius_m, tip, Stuff::Petal, [sign * radius_m, 0.0, 1.0, 1.0])).to_vec());
        return all;
    }
    let step_rad = TAU / component.petals as f32;
    for nth in 0..component.petals {
        let (sine, cosine) = (step_rad * nth as f32).sin_cos();
        let petal = |share: f32, wide: f32| {
            let half_m = 0.25 * step_rad * radius_m * wide;
            row(steps, half_m, tip * (0.7 + 0.3 * share), Stuff::Petal, [share * radius_m, cosine, sine, PETAL_RAD.sin()])
        };
        all.push(vec![petal(0.0, 0.25), petal(0.55, 1.0), petal(1.0, 0.55)]);
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::plant::underbrush::posture::Nodes;
    use shared::scene::{Component, Underbrush};

    fn tuft() -> Underbrush {
        let mut leaf = Component::new("leaf", ComponentKind::Leaf);
        (leaf.count, leaf.sections) = (12, 16);
        let mut flower = Component::new("flower", ComponentKind::Flower);
        (flower.count, flower.width_m, flower.petals) = (2, 0.06, 5);
        Underbrush::new("tuft", vec![leaf, flower])
    }

    #[test]
    fn every_make_has_the_same_rows_and_components() {
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

    /// Twin of the constant in `underbrush.wgsl`.
    const FALL_PA: f32 = 8.0;

    #[test]
    fn what_is_broken_lies_where_it_is_pressed_as_by_its_own_fall() {
        assert!(crate::render::shaders::UNDERBRUSH.contains(&format!("const FALL_PA: f32 = {FALL_PA:?};")));
        let mut species = shared::scene::parse_underbrush(include_str!("../../../../server/scenes/species.toml")).expect("sound species");
        species.retain(|species| ["reed", "tall grass", "poppy"].contains(&species.name.as_str()));
        assert_eq!(species.len(), 3);
        for (own, number) in species.iter().flat_map(|own| (0..VARIANTS).map(move |number| (own, number))) {
            let plan = Plan::new(own, Nodes::default());
            let placed = plan.placed(number);
            // As hard as by a fall, and beyond that in a wind of 13 m/s.
            for (heading, pressure_pa) in (0..8).flat_map(|heading| [FALL_PA, 30.0, 101.0].map(|pressure_pa| (heading, pressure_pa))) {
                let (sine, cosine) = (TAU * heading as f32 / 8.0).sin_cos();
                let forces = Forces { per_mass_m_per_s2: GRAVITY, pressure_pa: Vec3::new(cosine, 0.0, sine) * pressure_pa };
                let stand = Stand { size: 1.0, heading_rad: 0.0, lean_rad: [0.0; 2] };
                for one in posed(&plan, &placed, stand, forces, LookUp::Interpolated, u64::MAX) {
                    let part = &plan.parts[one.part];
                    if part.on.is_some() || part.broken.is_none() {
                        continue;
                    }
                    let tip_m = one.sections()[one.sections().len() - 1].end_m / (part.component.length_m * one.size);
                    let along = tip_m.x * cosine + tip_m.z * sine;
                    assert!(along > 0.9 && tip_m.y < 0.1, "{} of {}: {tip_m} at heading {heading}", part.component.name, own.name);
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
                baked.rows[..baked.ribbons[0] as usize].iter().map(|row| (row.look[0] & 0xffff) as f32 * WIDTH_UNIT_M).collect();
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
            Baked::new(&plan, 0).limbs[0].struck[2]
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
