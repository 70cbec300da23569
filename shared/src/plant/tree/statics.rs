//! Statics of a tree: its components as a plan, which bends as that of underbrush does (Endo et al. 2003, §3.2).
//!
//! The load of a component is its weight, and the drag of the air, with all that it carries, spread evenly along it; its axis is straight until it bends.
//!
//! A skeleton is the shape of a tree that stands in calm air under its own weight. So each component leaves its carrier more steeply than the skeleton does, by
//! as much as its weight bends it down, and its tip is where that of the skeleton is.

use super::colonise::CrownForm;
use super::skeleton::{Limb, Skeleton};
use crate::GRAVITY_M_PER_S2;
use crate::plant::snow_load::LEAF_KG_M2;
use crate::plant::underbrush::plan::{LEAF_DRAG, Placed, Plan, PlannedComponent, frequency_rad_per_s};
use crate::plant::underbrush::plant::{Forces, LookUp, Posed, Section, Stand, Unbent, ground_frame, posed_on, unbent};
use crate::plant::underbrush::posture::{Nodes, Postures};
use crate::plant::underbrush::rest::joints;
use crate::plant::underbrush::strength::fractions;
use crate::scene::{Component, ComponentKind};
use glam::{Quat, Vec3};

/// Straight sections of a component.
pub const SECTIONS: usize = 8;
/// Size of the table of postures that all components share.
pub const NODES: Nodes = Nodes { angles: 33, loads: 33 };

/// Young's modulus of living branches (Pa): about the middle of the 0.7 to 4.6 GPa that Cannell & Morgan (1987) measured.
const WOOD_PA: f32 = 2.5e9;
/// Density of fresh wood (kg/m³).
const WOOD_KG_PER_M3: f32 = 900.0;
/// Fresh mass of leaves above a square metre of ground (kg/m²).
const LEAVES_KG_PER_M2: f32 = TREE_LEAF_AREA_INDEX * LEAF_KG_M2;
/// Area of the leaves above a square metre of ground (m²).
pub const TREE_LEAF_AREA_INDEX: f32 = 4.0;
/// Rigidity at the tip of a component as a fraction of that at its foot: it tapers to 0.56 of its radius.
const TIP_STIFFNESS: f32 = 0.1;
/// Rounds in which the direction of an unbent component is found, at most, and the angle to its tip that is near enough (rad).
const AIMS: usize = 40;
const AIMED_RAD: f32 = 1e-3;
/// Slope of a component from which snow slides off (rad). It is not the scene's angle of repose, which is that of snow on snow.
const SLIDE_RAD: f32 = std::f32::consts::FRAC_PI_4;
/// Halvings in which the snow that stays is found.
const SLIDES: usize = 8;

/// The components of a tree with their statics.
#[derive(Clone, Debug, PartialEq)]
pub struct TreePlan {
    /// Height of the tree (m), at a size of 1.
    pub tree_m: f32,
    /// One kind of component for each limb of the skeleton, in its order, and the table that they share.
    pub plan: Plan,
    /// The components, in the same order.
    pub placed: Vec<Placed>,
    /// Foot (m, in a tree one metre tall), axis and right side of each in the skeleton.
    pub frames: Vec<LimbFrame>,
}

/// Foot, axis and right side of a component in the skeleton of a tree one metre tall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LimbFrame {
    /// Position above the foot of the tree (m).
    pub foot: Vec3,
    /// Unit vector along its axis.
    pub axis: Vec3,
    /// Unit vector across it.
    pub side: Vec3,
    /// Length of the axis (m).
    pub length: f32,
}

impl LimbFrame {
    /// A point of the tree relative to this component: to its right, along its axis, and across both.
    pub fn local(&self, at: Vec3) -> Vec3 {
        self.local_direction(at - self.foot)
    }

    /// A direction relative to this component.
    pub fn local_direction(&self, direction: Vec3) -> Vec3 {
        Vec3::new(direction.dot(self.side), direction.dot(self.axis), direction.dot(self.axis.cross(self.side)))
    }
}

impl TreePlan {
    /// The statics of a skeleton in a crown, for a tree of that height (m) whose leaves bear snow of a mass relative to their own (see
    /// [`relative_load`](crate::plant::snow_load::relative_load)). Without snow it stands in calm air as its skeleton; snow bends it down from there.
    pub fn new(form: &CrownForm, skeleton: &Skeleton, tree_m: f32, snow_load: f32) -> Self {
        let joints = joints(SECTIONS, TIP_STIFFNESS.into());
        let table = Postures::new(&joints, &fractions(SECTIONS, TIP_STIFFNESS.into()), NODES);
        let components: Vec<PlannedComponent> = skeleton.limbs.iter().map(|limb| planned(form, limb, tree_m)).collect();
        let settle_secs = components.first().map_or(1.0, |trunk| 1.0 / frequency_rad_per_s(&trunk.component, 0.0));
        let mut tree = Self {
            tree_m,
            plan: Plan { components, tables: vec![table], settle_secs },
            placed: Vec::with_capacity(skeleton.limbs.len()),
            frames: Vec::with_capacity(skeleton.limbs.len()),
        };
        let ground = ground_frame(Stand { size: 1.0, heading_rad: 0.0, lean_rad: [0.0; 2] });
        let mut calm: Vec<Posed> = Vec::with_capacity(skeleton.limbs.len());
        for (number, limb) in skeleton.limbs.iter().enumerate() {
            let foot = limb.on.map_or((Vec3::ZERO, ground), |on| calm[on].at(limb.at_fraction));
            let (placed, posed) = tree.aimed(foot, limb, number);
            let axis = (limb.tip - limb.foot).normalize_or(foot.1.direction);
            let Unbent { side, .. } = unbent(foot.0, foot.1, &placed);
            let side = (side - axis * side.dot(axis)).normalize_or(axis.any_orthonormal_vector());
            tree.frames.push(LimbFrame { foot: limb.foot, axis, side, length: limb.length() });
            tree.placed.push(placed);
            calm.push(posed);
        }
        if snow_load > 0.0 {
            tree.bear_snow(form, skeleton, snow_load);
        }
        tree
    }

    /// Loads the components, from the trunk on, with snow of a mass relative to that of their leaves. Where a component would hang more steeply than
    /// [`SLIDE_RAD`], the snow slides off until it does not, or all is gone. Its carriers bear all of it nevertheless, as if their leaves had caught it.
    fn bear_snow(&mut self, form: &CrownForm, skeleton: &Skeleton, snow_load: f32) {
        let ground = ground_frame(Stand { size: 1.0, heading_rad: 0.0, lean_rad: [0.0; 2] });
        let mut laden: Vec<Posed> = Vec::with_capacity(skeleton.limbs.len());
        for (number, limb) in skeleton.limbs.iter().enumerate() {
            let foot = limb.on.map_or((Vec3::ZERO, ground), |on| laden[on].at(limb.at_fraction));
            let bare = self.plan.components[number].clone();
            let most_kg = snow_load * leaves_kg(form, limb, self.tree_m);
            let mut with_share = |share: f32| {
                let planned = &mut self.plan.components[number];
                planned.component.mass_kg = bare.component.mass_kg + share * most_kg;
                planned.weight_s2_per_m = bare.weight_s2_per_m * planned.component.mass_kg / bare.component.mass_kg;
                posed_on(foot, &self.plan, &self.placed[number], 1.0, weight(), LookUp::Interpolated, false)
            };
            let mut posed = with_share(1.0);
            if hang_rad(&posed) > SLIDE_RAD {
                let [mut held, mut slid] = [0.0, 1.0];
                for _ in 0..SLIDES {
                    let share = 0.5 * (held + slid);
                    let hangs = hang_rad(&with_share(share)) > SLIDE_RAD;
                    *(if hangs { &mut slid } else { &mut held }) = share;
                }
                posed = with_share(held);
            }
            laden.push(posed);
        }
    }

    /// A limb on its calm carrier, such that its weight bends its tip to that of the skeleton, and its posture then.
    fn aimed(&self, foot: (Vec3, Section), limb: &Limb, number: usize) -> (Placed, Posed) {
        let wanted = (limb.tip * self.tree_m - foot.0).normalize_or(foot.1.direction);
        let bent = |axis: Vec3| {
            let placed = placed_on(foot.1, axis, limb, number);
            (placed, posed_on(foot, &self.plan, &placed, 1.0, weight(), LookUp::Interpolated, false))
        };
        let mut axis = wanted;
        let mut aimed = bent(axis);
        for _ in 0..AIMS {
            let tip_m = aimed.1.sections()[SECTIONS - 1].end_m - foot.0;
            let reached = tip_m.normalize_or(axis);
            if reached.angle_between(wanted) < AIMED_RAD {
                break;
            }
            axis = (Quat::from_rotation_arc(reached, wanted) * axis).normalize_or(axis);
            aimed = bent(axis);
        }
        aimed
    }

    /// First natural frequency of a component, with all that it carries (rad/s).
    pub fn frequency_rad_per_s(&self, limb: usize) -> f32 {
        frequency_rad_per_s(&self.plan.components[limb].component, 0.0)
    }

    /// Position (m, relative to the foot of the tree) of a point that moves with a component of `posed`. `local` is its place relative to the unbent
    /// component of a tree one metre tall, as [`LimbFrame::local`] gives it. `of_limb` in `client-wasm/shaders` is its twin.
    pub fn followed_m(&self, posed: &Posed, local: Vec3) -> Vec3 {
        let sections = posed.sections();
        let length_m = self.plan.components[posed.planned].component.length_m * posed.size;
        let along_m = local.y * self.tree_m * posed.size;
        let place = (along_m / length_m).clamp(0.0, 1.0) * sections.len() as f32;
        let number = (place as usize).min(sections.len() - 1);
        let start_m = if number == 0 { posed.foot_m } else { sections[number - 1].end_m };
        let Section { direction, side, .. } = sections[number];
        let rest_m = along_m - length_m * number as f32 / sections.len() as f32;
        start_m + direction * rest_m + (side * local.x + direction.cross(side) * local.z) * (self.tree_m * posed.size)
    }
}

/// The forces of calm air.
fn weight() -> Forces {
    Forces { per_mass_m_per_s2: Vec3::NEG_Y * GRAVITY_M_PER_S2 as f32, pressure_pa: Vec3::ZERO }
}

/// Angle of a component's chord below the level (rad).
fn hang_rad(posed: &Posed) -> f32 {
    let chord_m = posed.sections()[SECTIONS - 1].end_m - posed.foot_m;
    (-chord_m.y).atan2(chord_m.x.hypot(chord_m.z))
}

/// Mass of the leaves that a limb carries, itself or on others (kg).
fn leaves_kg(form: &CrownForm, limb: &Limb, tree_m: f32) -> f32 {
    LEAVES_KG_PER_M2 * form.ground_m2() * tree_m * tree_m * limb.leaves
}

/// A limb as a component of a tree of that height (m).
fn planned(form: &CrownForm, limb: &Limb, tree_m: f32) -> PlannedComponent {
    let radius_m = limb.radius * tree_m;
    let stiffness_n_m2 = WOOD_PA * std::f32::consts::FRAC_PI_4 * radius_m * radius_m * radius_m * radius_m;
    let component = Component {
        length_m: limb.length() * tree_m,
        width_m: 2.0 * radius_m,
        sections: SECTIONS as u32,
        mass_kg: WOOD_KG_PER_M3 * limb.wood_m3 * tree_m * tree_m * tree_m + leaves_kg(form, limb, tree_m),
        stiffness_n_m2,
        tip_stiffness_share: TIP_STIFFNESS,
        ..Component::new("limb", ComponentKind::Branch)
    };
    let square_per_rigidity = component.length_m * component.length_m / stiffness_n_m2;
    let drag_m2 = LEAF_DRAG * form.silhouette_m2() * tree_m * tree_m * limb.leaves;
    PlannedComponent {
        on: limb.on,
        weight_s2_per_m: component.mass_kg * square_per_rigidity,
        drag_per_pa: drag_m2 * square_per_rigidity,
        strength: 0.0,
        whole: 0,
        broken: None,
        component,
    }
}

/// A limb on its carrier: angle and turn there of its unbent axis.
fn placed_on(host: Section, axis: Vec3, limb: &Limb, number: usize) -> Placed {
    let other = host.direction.cross(host.side);
    Placed {
        planned: number,
        on: limb.on,
        at_fraction: limb.at_fraction,
        size: 1.0,
        angle_rad: axis.dot(host.direction).clamp(-1.0, 1.0).acos(),
        turn_rad: (-axis.dot(other)).atan2(axis.dot(host.side)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plant::underbrush::elastica;
    use crate::plant::underbrush::plant::{Forces, LookUp, posed};
    use crate::plant::underbrush::rest::Load;

    const OAK: CrownForm = CrownForm { low: 0.26, high: 1.0, wide: 0.42, is_cone: false, trunk_top: 0.59 };
    const STAND: Stand = Stand { size: 1.0, heading_rad: 0.0, lean_rad: [0.0; 2] };

    fn oak() -> TreePlan {
        TreePlan::new(&OAK, &Skeleton::grown(&OAK, 1), 7.0, 0.0)
    }

    fn blown(tree: &TreePlan, pascals: f32) -> (Forces, Vec<Posed>) {
        let forces =
            Forces { per_mass_m_per_s2: Vec3::NEG_Y * crate::GRAVITY_M_PER_S2 as f32, pressure_pa: Vec3::new(0.8, 0.0, 0.6) * pascals };
        (forces, posed(&tree.plan, &tree.placed, STAND, forces, LookUp::Interpolated, 0))
    }

    /// Largest distance of a component's tip from that of the elastica under its load, in lengths, if the beam is `softer` than the component.
    fn off(tree: &TreePlan, pascals: f32, softer: f64) -> f64 {
        let (forces, all) = blown(tree, pascals);
        let errors = all.iter().map(|one| {
            let planned = &tree.plan.components[one.planned];
            let load = forces.per_mass_m_per_s2 * planned.weight_s2_per_m + forces.pressure_pa * planned.drag_per_pa;
            let direction = load.normalize();
            let unbent_rad = f64::from(-direction.dot(one.axis)).clamp(-1.0, 1.0).acos();
            let spread = f64::from(load.length()) * softer;
            // Without a lean the elastica stands straight: no component is near its buckling load.
            let bent = || elastica::tip(TIP_STIFFNESS.into(), Load { spread, tip: 0.0 }, unbent_rad);
            let [aside, up] = if unbent_rad < 1e-3 { [0.0, 1.0] } else { bent() };
            // Across the load, on the side of the unbent axis, as the elastica counts.
            let across = one.axis - direction * one.axis.dot(direction);
            let level = if unbent_rad < 1e-3 { one.towards } else { across.normalize() };
            let tip = (one.sections()[SECTIONS - 1].end_m - one.foot_m) / planned.component.length_m;
            (f64::from(tip.dot(level)) - aside).hypot(f64::from(-tip.dot(direction)) - up)
        });
        errors.fold(0.0, f64::max)
    }

    #[test]
    fn trunk_and_branches_bend_like_the_elastica() {
        let tree = oak();
        for metres_per_s in [0.0_f32, 10.0, 20.0, 30.0] {
            let pascals = 0.6 * metres_per_s * metres_per_s;
            let found = off(&tree, pascals, 1.0);
            assert!(found < 0.01, "{found} of the length at {metres_per_s} m/s");
        }
        // Negative control: a beam that is a tenth softer.
        assert!(off(&tree, 240.0, 1.1) > 0.01, "{}", off(&tree, 240.0, 1.1));
    }

    /// Largest distance of a tip, and of a vertex at the foot or the tip of a component, from the skeleton's, in heights of the tree, under so many times the
    /// weight.
    fn off_skeleton(tree: &TreePlan, skeleton: &Skeleton, weights: f32) -> [f32; 2] {
        let gravity = Vec3::NEG_Y * crate::GRAVITY_M_PER_S2 as f32 * weights;
        let forces = Forces { per_mass_m_per_s2: gravity, pressure_pa: Vec3::ZERO };
        let all = posed(&tree.plan, &tree.placed, STAND, forces, LookUp::Interpolated, 0);
        let mut off = [0.0_f32; 2];
        for ((one, limb), frame) in all.iter().zip(&skeleton.limbs).zip(&tree.frames) {
            off[0] = off[0].max(one.sections()[SECTIONS - 1].end_m.distance(7.0 * limb.tip) / 7.0);
            for at in [limb.foot, limb.tip, limb.foot + Vec3::new(0.02, -0.05, 0.03)] {
                off[1] = off[1].max(tree.followed_m(one, frame.local(at)).distance(7.0 * at) / 7.0);
            }
        }
        off
    }

    #[test]
    fn the_calm_tree_is_its_skeleton() {
        // A hand's breadth of a tree of 7 m is hard to see.
        let (tree, skeleton) = (oak(), Skeleton::grown(&OAK, 1));
        let [tips, vertices] = off_skeleton(&tree, &skeleton, 1.0);
        println!("tips are within {tips}, vertices within {vertices} of the height");
        assert!(tips < 0.015 && vertices < 0.03, "{tips}, {vertices}");
        // Negative control: half as heavy, it stands higher.
        let [tips, _] = off_skeleton(&tree, &skeleton, 0.5);
        assert!(tips > 0.015, "{tips}");
    }

    #[test]
    fn snow_bends_limbs_down_by_its_weight() {
        let skeleton = Skeleton::grown(&OAK, 1);
        let mean_m = |snow_load: f32| {
            let tree = TreePlan::new(&OAK, &skeleton, 7.0, snow_load);
            let (_, all) = blown(&tree, 0.0);
            let tips = all[1..].iter().map(|one| one.sections()[SECTIONS - 1].end_m.y);
            tips.sum::<f32>() / (all.len() - 1) as f32
        };
        let [bare, dusted, laden] = [0.0, 0.5, 1.5].map(mean_m);
        println!(
            "mean height of the tips: {bare} m, {dusted} m with half as much snow as leaves, {laden} m with one and a half times as much"
        );
        // A stiff beam yields in proportion to its load.
        let proportion = (bare - laden) / (bare - dusted);
        assert!(bare - laden > 0.1 && (2.5..3.5).contains(&proportion), "{proportion}");
    }

    #[test]
    fn snow_slides_off_limbs_that_hang_steeply() {
        let (bare, skeleton) = (oak(), Skeleton::grown(&OAK, 1));
        let bare_kg = |number: usize| bare.plan.components[number].component.mass_kg;
        // The steepest component that bears snow.
        let steepest_rad = |tree: &TreePlan| {
            let laden = |number: &usize| tree.plan.components[*number].component.mass_kg > 1.01 * bare_kg(*number);
            let (_, all) = blown(tree, 0.0);
            (0..all.len()).filter(laden).map(|number| hang_rad(&all[number])).fold(0.0, f32::max)
        };
        let snow_load = 6.0;
        let laden = TreePlan::new(&OAK, &skeleton, 7.0, snow_load);
        // Negative control: all of the snow stays.
        let mut stuck = bare.clone();
        for (planned, limb) in stuck.plan.components.iter_mut().zip(&skeleton.limbs) {
            let bare_kg = planned.component.mass_kg;
            planned.component.mass_kg += snow_load * leaves_kg(&OAK, limb, 7.0);
            planned.weight_s2_per_m *= planned.component.mass_kg / bare_kg;
        }
        let [held_rad, stuck_rad] = [&laden, &stuck].map(steepest_rad);
        println!("the steepest component with snow hangs at {held_rad} rad, and at {stuck_rad} rad if none slides off");
        assert!(held_rad < SLIDE_RAD + 0.01 && stuck_rad > SLIDE_RAD + 0.1, "{held_rad}, {stuck_rad}");
    }

    #[test]
    fn twigs_bend_more_than_limbs_and_limbs_more_than_the_trunk() {
        let (tree, skeleton) = (oak(), Skeleton::grown(&OAK, 1));
        let [(_, calm), (_, windy)] = [0.0, 60.0].map(|pascals| blown(&tree, pascals));
        let moved_m = |limb: usize| {
            let tip = |all: &[Posed]| all[limb].sections()[SECTIONS - 1].end_m - all[limb].foot_m;
            tip(&windy).distance(tip(&calm)) / tree.plan.components[limb].component.length_m
        };
        let mean = |range: std::ops::Range<usize>| range.clone().map(moved_m).sum::<f32>() / range.len() as f32;
        let [trunk, limbs, twigs] = [0..1, 1..skeleton.large, skeleton.large..skeleton.limbs.len()].map(mean);
        println!(
            "tips move by {trunk}, {limbs} and {twigs} of the length at 10 m/s; frequencies {:?} rad/s",
            [0, 1, skeleton.large].map(|n| tree.frequency_rad_per_s(n))
        );
        assert!(trunk < limbs && limbs < twigs && (0.01..0.3).contains(&twigs), "{trunk}, {limbs}, {twigs}");
    }
}
