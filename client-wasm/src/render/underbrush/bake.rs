//! Plants of a species as rows of vectors, bent beforehand by winds of every heading and a range of strengths (004 §4.2), for a level of detail.
//!
//! A row is a point on a component's axis with the direction of its side and of its axis; borders stand half a width off it. All plants of a species have the
//! same rows, whatever bends them, so that the GPU blends rows and no more.

use glam::Vec3;
use shared::plant::flora::reach_m;
use shared::plant::underbrush::drops::{DROP_M_PER_S, Struck};
use shared::plant::underbrush::plan::{Part, Placed, Plan};
use shared::plant::underbrush::plant::{Forces, LookUp, Posed, Stand, posed};
use shared::plant::underbrush::vectors::{petals, vectors};
use shared::scene::{Component, ComponentKind, Underbrush};
use std::f32::consts::{FRAC_PI_4, TAU};

/// Plants of different make of each species.
pub(super) const VARIANTS: u32 = 4;
/// Headings of the wind that they are bent by, evenly round; twin of the constant in `underbrush.wgsl`.
pub(super) const HEADINGS: u32 = 8;
/// Strengths of it, at dynamic pressures of [`pressure_pa`]; twin of the constant in `underbrush.wgsl`.
pub(super) const STRENGTHS: u32 = 7;
/// Pressure in the middle of the range (Pa), that of 3.7 m/s; twin of the constant in `underbrush.wgsl`.
const MIDDLE_PA: f32 = 8.0;
/// q/(q + 8) of the strongest; twin of the constant in `underbrush.wgsl`.
const STRONGEST: f32 = 0.93;
/// Levels of detail: every section, every second, fourth, and the whole component as one, of fewer components.
pub(super) const LEVELS: usize = 4;
/// Most leaves of a plant in the coarsest level.
const COARSE_LEAVES: usize = 10;
/// Half-widths are in units of this (m); twin of the constant in `underbrush.wgsl`.
const WIDTH_UNIT_M: f32 = 1.0 / 16_384.0;

/// Greatest time in which a component that trembles is as far off as it gets (s), and greatest area on which drops strike it (m²); twins of the constants in
/// `underbrush.wgsl`.
const SETTLE_FULL_SECS: f32 = 4.0;
const CATCHES_FULL_M2: f32 = 0.1;
/// Shortest time in which a component that trembles is as far off as it gets (s).
const FASTEST_SECS: f32 = 1.0 / 60.0;

const GRAVITY: Vec3 = Vec3::new(0.0, -9.81, 0.0);

/// What of a row stays as it is however it bends: half its width, its colour, what it is of, and how rain moves it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Look {
    half_m: f32,
    rgb: Vec3,
    stuff: Stuff,
    /// Where it is on its component, 0 at the foot and 1 at the tip.
    share: f32,
    trembling: Trembling,
}

/// How drops of rain make a component tremble.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Trembling {
    /// Number of the component in its plant.
    number: u32,
    struck: Struck,
    length_m: f32,
    /// Area on which drops strike it (m²); 0 for what does not tremble.
    catches_m2: f32,
}

/// What a row is of; twins of the constants in `underbrush.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stuff {
    Leaf = 0,
    Stalk = 1,
    Petal = 2,
}

impl Look {
    /// Half width, stuff and length (mm), then the colour, as `underbrush.wgsl` takes them: the square root keeps dark colours apart in 8 bits. Then speed, time,
    /// area and place of a strike, each as a share of its greatest, and the component's number.
    pub(super) fn packed(&self) -> [u32; 4] {
        let half_width = (self.half_m / WIDTH_UNIT_M).round().clamp(0.0, 65_535.0) as u32;
        let [r, g, b] = self.rgb.to_array().map(|v| (v.clamp(0.0, 1.0).sqrt() * 255.0 + 0.5) as u32);
        let Trembling { number, struck: Struck { speed_m_per_s, settle_secs }, length_m, catches_m2 } = self.trembling;
        let length_mm = (length_m * 1000.0).clamp(0.0, 16_383.0) as u32;
        let of_full = |value: f32, full: f32| (value / full * 65_535.0).round().clamp(0.0, 65_535.0) as u32;
        let [speed, settle, catches] =
            [of_full(speed_m_per_s, DROP_M_PER_S), of_full(settle_secs, SETTLE_FULL_SECS), of_full(catches_m2, CATCHES_FULL_M2)];
        let share = (self.share * 255.0).round() as u32;
        [
            half_width | (self.stuff as u32) << 16 | length_mm << 18,
            r | g << 8 | b << 16,
            speed | settle << 16,
            catches | share << 16 | number << 24,
        ]
    }
}

/// Where a row is.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Row {
    at_m: Vec3,
    side: Vec3,
    along: Vec3,
}

/// All plants of a species that are made beforehand, bent in all ways: by make (whole ones, then broken ones), heading and strength.
pub(super) struct Bent {
    placed: Vec<Placed>,
    poses: Vec<Vec<Posed>>,
    extent_m: f32,
}

impl Bent {
    /// Bends the plants of `species`, made by `plan`.
    pub(super) fn new(species: &Underbrush, plan: &Plan) -> Self {
        let mut poses = Vec::new();
        for broken in [0, u64::MAX] {
            for number in 0..VARIANTS {
                let placed = plan.placed(number);
                let winds = (0..HEADINGS).flat_map(|heading| (0..STRENGTHS).map(move |strength| (heading, strength)));
                poses.extend(winds.map(|(heading, strength)| bent(plan, &placed, broken, heading, strength)));
            }
        }
        Self { placed: plan.placed(0), poses, extent_m: reach_m(species) }
    }

    /// Unit of the rows' places (m): no plant of the species' own size reaches farther.
    pub(super) fn extent_m(&self) -> f32 {
        self.extent_m
    }
}

/// A species at a level of detail.
pub(super) struct Baked {
    /// Of each row, make by make.
    pub(super) looks: Vec<Look>,
    /// Rows of each component or petal, in order.
    pub(super) ribbons: Vec<u32>,
    /// Rows by make, heading, strength and number, each packed in three words.
    pub(super) rows: Vec<[u32; 3]>,
}

impl Baked {
    /// What a level of detail shows of bent plants.
    pub(super) fn new(plan: &Plan, bent: &Bent, level: usize) -> Self {
        let kept = kept(plan, &bent.placed, level);
        let mut baked = Self { looks: Vec::new(), ribbons: Vec::new(), rows: Vec::new() };
        for (number, pose) in bent.poses.iter().enumerate() {
            for &(index, wider) in &kept {
                let one = &pose[index];
                let part = &plan.parts[one.part];
                let mut ribbons = ribbons(part, one, level, wider);
                let trembling = trembling(&part.component, one.size, index, &ribbons[0]);
                ribbons.iter_mut().flatten().for_each(|(_, look)| look.trembling = trembling);
                for ribbon in ribbons {
                    if number == 0 {
                        baked.ribbons.push(ribbon.len() as u32);
                    }
                    if number % (HEADINGS * STRENGTHS) as usize == 0 {
                        baked.looks.extend(ribbon.iter().map(|&(_, look)| look));
                    }
                    baked.rows.extend(ribbon.iter().map(|(row, _)| packed(row, bent.extent_m)));
                }
            }
        }
        baked
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

/// Dynamic pressure of a strength (Pa): q/(q + 8) in even steps, the last at 106 Pa, a wind of 13 m/s.
fn pressure_pa(strength: u32) -> f32 {
    let share = strength as f32 / (STRENGTHS - 1) as f32 * STRONGEST;
    MIDDLE_PA * share / (1.0 - share)
}

fn bent(plan: &Plan, placed: &[Placed], broken: u64, heading: u32, strength: u32) -> Vec<Posed> {
    let (sine, cosine) = (TAU * heading as f32 / HEADINGS as f32).sin_cos();
    let pressure_pa = Vec3::new(cosine, 0.0, sine) * pressure_pa(strength);
    let stand = Stand { size: 1.0, heading_rad: 0.0, lean_rad: [0.0; 2] };
    posed(plan, placed, stand, Forces { per_mass_m_per_s2: GRAVITY, pressure_pa }, LookUp::Interpolated, broken)
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

/// How a leaf or a flower trembles, by its own ribbon: of a leaf the rows' silhouette from above, of a flower the disc of its petals, catch drops. Stalks are
/// stiff, and what is back before the next picture can't be seen.
fn trembling(component: &Component, size: f32, number: usize, own: &[(Row, Look)]) -> Trembling {
    let struck = Struck::new(component, size);
    let level_m = |pair: &[(Row, Look)]| (pair[1].0.at_m - pair[0].0.at_m).with_y(0.0).length();
    let catches_m2 = match component.kind {
        _ if struck.settle_secs < FASTEST_SECS => 0.0,
        ComponentKind::Branch => 0.0,
        ComponentKind::Leaf => own.windows(2).map(|pair| (pair[0].1.half_m + pair[1].1.half_m) * level_m(pair)).sum(),
        ComponentKind::Flower => FRAC_PI_4 * (component.width_m * size).powi(2),
    };
    Trembling { number: number as u32, struck, length_m: component.length_m * size, catches_m2 }
}

/// The ribbons of a component: its own, and those of its petals.
fn ribbons(part: &Part, one: &Posed, level: usize, wider: f32) -> Vec<Vec<(Row, Look)>> {
    let component = &part.component;
    let (root, tip) = (Vec3::from(component.root_rgb), Vec3::from(component.tip_rgb));
    let every = 1 << level;
    let outline = vectors(part, one, every);
    // A coarse outline cuts the belly of a leaf off: it is widened until its area is the leaf's.
    let halves: Vec<f32> = outline.iter().map(|vector| vector.right_m.length()).collect();
    let area: f32 = halves.windows(2).map(|pair| pair[0] + pair[1]).sum::<f32>() / (halves.len() - 1).max(1) as f32;
    let whole = if component.kind == ComponentKind::Leaf { 0.73 * component.width_m * one.size } else { area };
    let fill = if area > 0.0 { whole / area } else { 1.0 };
    let stuff = if component.kind == ComponentKind::Leaf { Stuff::Leaf } else { Stuff::Stalk };
    let sections = one.sections();
    let mut at_m = one.foot_m;
    let own = outline.iter().enumerate().map(|(number, vector)| {
        at_m += vector.axis_m;
        let section = sections[(number * every).clamp(1, sections.len()) - 1];
        let share = number as f32 / (outline.len() - 1).max(1) as f32;
        let row = Row { at_m, side: section.side, along: section.direction };
        let color = if component.kind == ComponentKind::Flower { root } else { root.lerp(tip, share) };
        (row, Look { half_m: halves[number] * fill * wider, rgb: color, stuff, share, trembling: Trembling::default() })
    });
    let mut all = vec![own.collect::<Vec<_>>()];
    if component.kind != ComponentKind::Flower {
        return all;
    }
    let head_m = at_m;
    let petal_look = |half_m: f32, rgb: Vec3| Look { half_m, rgb, stuff: Stuff::Petal, share: 1.0, trembling: Trembling::default() };
    if level + 1 == LEVELS {
        // One face for the ring of petals.
        let last = sections[sections.len() - 1];
        let radius_m = 0.5 * component.width_m * one.size;
        let across = last.direction.cross(last.side);
        let row = |sign: f32| Row { at_m: head_m + across * (sign * radius_m), side: last.side, along: across };
        all.push([-1.0, 1.0].map(|sign| (row(sign), petal_look(0.8 * radius_m, tip))).to_vec());
        return all;
    }
    for petal in petals(part, one) {
        let along = petal.axis_m.normalize_or(Vec3::Y);
        let half_m = petal.right_m.length();
        let side = petal.right_m / half_m.max(1e-9);
        let row = |share: f32, wide: f32| {
            let shade = 0.7 + 0.3 * share;
            (Row { at_m: head_m + petal.axis_m * share, side, along }, petal_look(half_m * wide, tip * shade))
        };
        all.push(vec![row(0.0, 0.25), row(0.55, 1.0), row(1.0, 0.55)]);
    }
    all
}

/// Place, side and direction in three words: the place in 16 bits an axis, each direction in 16 (octahedral).
fn packed(row: &Row, extent_m: f32) -> [u32; 3] {
    let [x, y, z] = row.at_m.to_array().map(|m| u32::from((m / extent_m * 32_767.0).round().clamp(-32_767.0, 32_767.0) as i16 as u16));
    [x | y << 16, z | octahedral(row.side) << 16, octahedral(row.along)]
}

/// A direction as two signed bytes (Meyer et al., On Floating-Point Normal Vectors, EGSR 2010).
fn octahedral(direction: Vec3) -> u32 {
    let flat = direction / (direction.x.abs() + direction.y.abs() + direction.z.abs()).max(1e-9);
    let fold = |a: f32, b: f32| if flat.y < 0.0 { (1.0 - b.abs()) * if a < 0.0 { -1.0 } else { 1.0 } } else { a };
    let byte = |v: f32| u32::from((v * 127.0).round() as i8 as u8);
    byte(fold(flat.x, flat.z)) | byte(fold(flat.z, flat.x)) << 8
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::plant::underbrush::posture::Nodes;

    fn tuft() -> Underbrush {
        let mut leaf = Component::new("leaf", ComponentKind::Leaf);
        (leaf.count, leaf.sections) = (12, 8);
        let mut flower = Component::new("flower", ComponentKind::Flower);
        (flower.count, flower.width_m, flower.petals) = (2, 0.06, 5);
        Underbrush::new("tuft", vec![leaf, flower])
    }

    #[test]
    fn every_posture_has_the_rows_of_the_looks() {
        let species = tuft();
        let plan = Plan::new(&species, Nodes::default());
        let mut before = usize::MAX;
        let bent = Bent::new(&species, &plan);
        for level in 0..LEVELS {
            let baked = Baked::new(&plan, &bent, level);
            let rows = baked.ribbons.iter().sum::<u32>() as usize;
            assert_eq!(baked.looks.len(), 2 * VARIANTS as usize * rows);
            assert_eq!(baked.rows.len(), (HEADINGS * STRENGTHS) as usize * baked.looks.len());
            assert!(rows < before, "{rows} rows after {before}");
            assert_eq!(baked.indices(3).iter().max().map(|&last| last as usize), Some(6 * rows - 1));
            before = rows;
        }
    }

    #[test]
    fn every_level_shows_something_of_every_plant() {
        for (kind, width_m) in [(ComponentKind::Branch, 0.004), (ComponentKind::Flower, 0.03), (ComponentKind::Leaf, 0.001)] {
            let species = Underbrush::new("one", vec![Component { width_m, ..Component::new("one", kind) }]);
            let plan = Plan::new(&species, Nodes::default());
            let bent = Bent::new(&species, &plan);
            assert!((0..LEVELS).all(|level| !Baked::new(&plan, &bent, level).rows.is_empty()), "{kind:?}");
        }
    }

    #[test]
    fn a_coarse_leaf_covers_what_a_fine_one_does() {
        let species =
            Underbrush::new("leaf", vec![Component { sections: 8, length_variation: 0.0, ..Component::new("leaf", ComponentKind::Leaf) }]);
        let plan = Plan::new(&species, Nodes::default());
        let area = |level: usize| {
            let baked = Baked::new(&plan, &Bent::new(&species, &plan), level);
            let halves: Vec<f32> = baked.looks[..baked.ribbons[0] as usize].iter().map(|look| look.half_m).collect();
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
        let catches = |component: Component| {
            let species = Underbrush::new("one", vec![component]);
            let plan = Plan::new(&species, Nodes::default());
            let baked = Baked::new(&plan, &Bent::new(&species, &plan), 0);
            let first = baked.looks[0].trembling;
            assert!(baked.looks[..baked.ribbons.iter().sum::<u32>() as usize].iter().all(|look| look.trembling.number == first.number));
            (first, baked.looks[baked.ribbons[0] as usize - 1])
        };
        let (level, tip) = catches(component(ComponentKind::Leaf, 1.5));
        assert!((level.catches_m2 / (0.73 * 0.4 * 0.01) - 1.0).abs() < 0.05, "{level:?}");
        assert_eq!((tip.share, tip.packed()[3] >> 16), (1.0, 255));
        assert_eq!(tip.packed()[0] >> 18, 400, "mm");
        let (upright, _) = catches(component(ComponentKind::Leaf, 0.1));
        assert!(upright.catches_m2 < 0.2 * level.catches_m2, "{upright:?} of {level:?}");
        let (flower, _) = catches(component(ComponentKind::Flower, 0.3));
        assert!((flower.catches_m2 / (FRAC_PI_4 * 1e-4) - 1.0).abs() < 1e-4, "{flower:?}");
        assert_eq!(catches(component(ComponentKind::Branch, 0.3)).0.catches_m2, 0.0, "stalks stand");
        assert_eq!(
            catches(Component { stiffness_n_m2: 1.0, ..component(ComponentKind::Leaf, 1.5) }).0.catches_m2,
            0.0,
            "as do stiff leaves"
        );
    }

    #[test]
    fn directions_come_back_from_two_bytes() {
        for n in 0..500 {
            let angle = n as f32 * 2.4;
            let y = 1.0 - 2.0 * (n as f32 + 0.5) / 500.0;
            let wanted = Vec3::new((1.0 - y * y).sqrt() * angle.cos(), y, (1.0 - y * y).sqrt() * angle.sin());
            let word = octahedral(wanted);
            let part = |shift: u32| f32::from((word >> shift) as u8 as i8) / 127.0;
            let (a, b) = (part(0), part(8));
            let mut found = Vec3::new(a, 1.0 - a.abs() - b.abs(), b);
            if found.y < 0.0 {
                (found.x, found.z) = ((1.0 - b.abs()) * a.signum(), (1.0 - a.abs()) * b.signum());
            }
            assert!(found.normalize().distance(wanted) < 0.02, "{found:?} instead of {wanted:?}");
        }
    }
}
