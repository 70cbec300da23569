//! Meshes of trees of components, whose vertices follow trunk, limbs and twigs.

use crate::render::inputs::random::Random;
use crate::render::solids::bounding_sphere::BoundingSphere;
use crate::render::solids::mesh::{Solid, Vertex};
use crate::render::solids::trees_and_stones::{BARK, TREE_SHAPES, TreeDetail, TreeForm};
use glam::Vec3;
use prairie_core::GRAVITY_M_PER_S2;
use prairie_core::plant::snow_load::relative_load;
use prairie_core::plant::tree::colonise::CrownForm;
use prairie_core::plant::tree::skeleton::{Skeleton, Wood};
use prairie_core::plant::tree::statics::{LimbFrame, TREE_LEAF_AREA_INDEX, TreePlan};
use prairie_core::plant::underbrush::plant::{Forces, LookUp, Posed, Stand, posed};
use prairie_core::scene::{Scene, TreeShape};
use std::f32::consts::TAU;

/// Seed of the skeletons; each shape adds its number.
const SEED: u32 = 900;
/// Sprays of leaves of a fine tree, and of a coarse and a distant one, which have the first of them.
const SPRAYS: [usize; 3] = [286, 78, 52];
/// Pieces of wood of a fine tree beside its trunk: the thickest.
const FINE_WOOD: usize = 60;
/// Radius from which a piece of wood has five sides instead of three (m), in a tree one metre tall.
const ROUND_RADIUS: f32 = 0.004;
/// Strongest pressure for which a tree stays within its bounding sphere (Pa): that of a wind of 40 m/s.
const LIMIT_PA: f32 = 960.0;

/// A shape of trees of components.
#[derive(Clone, Debug)]
pub(crate) struct GrownTree {
    shape: u32,
    pub(crate) skeleton: Skeleton,
    pub(crate) statics: TreePlan,
}

impl GrownTree {
    /// All shapes of a scene; none if its trees are modelled.
    pub(crate) fn of_scene(scene: &Scene) -> Vec<Self> {
        let shapes = if scene.plants.tree_shape == TreeShape::Grown { TREE_SHAPES } else { 0 };
        let snow_load = relative_load(&scene.snow, TREE_LEAF_AREA_INDEX);
        (0..shapes).map(|shape| Self::new(shape, scene.plants.tree_m, snow_load)).collect()
    }

    /// A shape, for trees of that height (m) whose leaves bear snow of a mass relative to their own.
    pub(crate) fn new(shape: u32, tree_m: f32, snow_load: f32) -> Self {
        let TreeForm { crown, is_cone, trunk_top, .. } = TreeForm::new(shape, &mut Random::new(SEED.into()));
        let form = CrownForm { low: crown.low, high: crown.high, wide: crown.wide, is_cone, trunk_top };
        let skeleton = Skeleton::grown(&form, SEED + shape);
        let statics = TreePlan::new(&form, &skeleton, tree_m, snow_load);
        Self { shape, skeleton, statics }
    }

    /// Number of components, from the first, that bend by themselves at a level of detail.
    pub(crate) fn limbs(&self, detail: TreeDetail) -> usize {
        match detail {
            TreeDetail::Fine => self.skeleton.limbs.len(),
            TreeDetail::Coarse => self.skeleton.large,
            TreeDetail::Distant => 1,
        }
    }

    /// The component that moves another one's vertices at a level of detail: itself, or a carrier.
    fn mover(&self, limb: usize, detail: TreeDetail) -> usize {
        let bends = |limb: &usize| *limb < self.limbs(detail);
        std::iter::successors(Some(limb), |&limb| self.skeleton.limbs[limb].on).find(bends).unwrap_or(0)
    }

    /// The mesh of a tree one metre tall. Its vertices are relative to the components that move them.
    pub(crate) fn mesh(&self, detail: TreeDetail) -> Solid {
        let mut mesh = Solid::default();
        for (limb, part) in self.unbent(detail).into_iter().enumerate() {
            let frame = &self.statics.frames[limb];
            let first = mesh.vertices.len() as u32;
            for vertex in &part.vertices {
                let [x, y, z, _] = vertex.normal.map(f32::from);
                let normal = frame.local_direction(Vec3::new(x, y, z)).normalize_or_zero() * 127.0;
                let [x, y, z] = normal.to_array().map(|v| v.round() as i8);
                let position = frame.local(Vec3::from(vertex.position)).to_array();
                mesh.vertices.push(Vertex { position, normal: [x, y, z, limb as i8], ..*vertex });
            }
            mesh.indices.extend(part.indices.iter().map(|index| first + index));
        }
        mesh
    }

    /// The parts of an unbent tree that each of its components moves.
    fn unbent(&self, detail: TreeDetail) -> Vec<Solid> {
        let mut parts = vec![Solid::default(); self.limbs(detail)];
        let pieces = if detail == TreeDetail::Fine { FINE_WOOD } else { 0 };
        for (number, wood) in self.skeleton.wood.iter().enumerate().take(1 + pieces) {
            add_wood(&mut parts[self.mover(wood.limb, detail)], wood, number == 0, detail);
        }
        let mut random = Random::new((SEED + self.shape).into());
        let form = TreeForm::new(self.shape, &mut random);
        let ends = spread(&self.skeleton.tips);
        let count = SPRAYS[detail as usize];
        let upward = |end: Vec3| ((end.y - form.crown.low) / (form.crown.high - form.crown.low)).clamp(0.0, 1.0);
        for &(end, limb) in ends.iter().cycle().take(count) {
            let mut spray = form.spray(end, upward(end), &mut random);
            spray.size *= detail.spray_scale();
            form.add_spray(&mut parts[self.mover(limb, detail)], &spray);
        }
        parts
    }

    /// Sphere around the tree, one metre tall, in winds of up to 40 m/s.
    pub(crate) fn bounds(&self) -> BoundingSphere {
        let parts = TreeDetail::ALL.map(|detail| self.unbent(detail));
        let unbent = BoundingSphere::around_meshes(parts.iter().flatten());
        // Largest distance of the vertices of each component from the centre.
        let mut reach_m = vec![0.0_f32; self.limbs(TreeDetail::Fine)];
        for part in &parts {
            for (reach_m, solid) in reach_m.iter_mut().zip(part) {
                let distances = solid.vertices.iter().map(|vertex| Vec3::from(vertex.position).distance(unbent.centre_m));
                *reach_m = distances.fold(*reach_m, f32::max);
            }
        }
        let blown = (0..8).flat_map(|n| [0.0, 0.1, 0.3, 1.0].map(|part| (TAU * n as f32 / 8.0, part * LIMIT_PA)));
        let radius_m = blown.fold(unbent.radius_m, |radius_m, (heading_rad, pascals)| {
            let all = self.posed(Vec3::new(heading_rad.cos(), 0.0, heading_rad.sin()) * pascals);
            let moved = all.iter().zip(&self.statics.frames).map(|(posed, frame)| moved_m(posed, frame, self.statics.tree_m));
            moved.zip(&reach_m).map(|(moved_m, reach_m)| moved_m + reach_m).fold(radius_m, f32::max)
        });
        BoundingSphere { radius_m, ..unbent }
    }

    /// Its components at a size of 1 under their weight and a pressure (Pa).
    pub(crate) fn posed(&self, pressure_pa: Vec3) -> Vec<Posed> {
        let forces = Forces { per_mass_m_per_s2: Vec3::NEG_Y * GRAVITY_M_PER_S2 as f32, pressure_pa };
        let stand = Stand { size: 1.0, heading_rad: 0.0, lean_rad: [0.0; 2] };
        posed(&self.statics.plan, &self.statics.placed, stand, forces, LookUp::Interpolated, 0)
    }
}

/// Distance of a component's tip from where it is unbent (m), in a tree one metre tall.
fn moved_m(posed: &Posed, frame: &LimbFrame, tree_m: f32) -> f32 {
    let tip_m = posed.sections().last().map_or(posed.foot_m, |section| section.end_m);
    tip_m.distance((frame.foot + frame.axis * frame.length) * tree_m) / tree_m
}

/// Adds a piece of wood: a tube with open ends.
fn add_wood(part: &mut Solid, wood: &Wood, is_trunk: bool, detail: TreeDetail) {
    let [trunk_sides, trunk_rings, _] = detail.counts();
    let radius = wood.points[0].1;
    let (sides, rings) = match (is_trunk, radius > ROUND_RADIUS) {
        (true, _) => (trunk_sides, trunk_rings),
        (false, true) => (5, 3),
        (false, false) => (3, 2),
    };
    let last = wood.points.len() - 1;
    let mut across = (wood.points[last].0 - wood.points[0].0).any_orthonormal_vector();
    let rings: Vec<Vec<Vec3>> = (0..=rings)
        .map(|ring| {
            let at = ring * last / rings;
            let (centre, radius) = wood.points[at];
            let along = (wood.points[(at + 1).min(last)].0 - wood.points[at.saturating_sub(1)].0).normalize_or(Vec3::Y);
            across = (across - along * across.dot(along)).normalize_or(along.any_orthonormal_vector());
            // The trunk is wider at its foot.
            let radius = radius + if is_trunk { 0.014 * (1.0 - 6.0 * centre.y).max(0.0) } else { 0.0 };
            let other = along.cross(across);
            let point = |n: usize| {
                let (sine, cosine) = (TAU * n as f32 / sides as f32).sin_cos();
                centre + radius * (across * cosine + other * sine)
            };
            (0..sides).map(point).collect()
        })
        .collect();
    part.skin(&rings, BARK);
}

/// Ends of the wood in an order in which the first of them, however many, are far apart.
fn spread(tips: &[(Vec3, usize)]) -> Vec<(Vec3, usize)> {
    let mut left: Vec<(f32, (Vec3, usize))> = tips.iter().map(|&tip| (tip.0.y + 9.0, tip)).collect();
    let mut spread = Vec::new();
    while let Some(at) = (0..left.len()).max_by(|&a, &b| left[a].0.total_cmp(&left[b].0)) {
        let (_, next) = left.swap_remove(at);
        left.iter_mut().for_each(|(apart, tip)| *apart = apart.min(tip.0.distance(next.0)));
        spread.push(next);
    }
    spread
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn meshes_follow_components_that_bend_at_their_level() {
        for shape in 0..TREE_SHAPES {
            let tree = GrownTree::new(shape, 7.0, 0.0);
            let [fine, coarse, distant] = TreeDetail::ALL.map(|detail| tree.mesh(detail));
            for (mesh, detail) in [(&fine, TreeDetail::Fine), (&coarse, TreeDetail::Coarse), (&distant, TreeDetail::Distant)] {
                let limbs: Vec<usize> = mesh.vertices.iter().map(|vertex| vertex.normal[3] as usize).collect();
                assert_eq!(limbs.iter().max(), Some(&(tree.limbs(detail) - 1)), "{detail:?}");
            }
            assert!(fine.indices.len() > 2 * coarse.indices.len() && coarse.indices.len() > distant.indices.len());
            println!("shape {shape}: {} limbs, {} triangles", tree.limbs(TreeDetail::Fine), fine.indices.len() / 3);
            let bounds = tree.bounds();
            // In a storm twigs reach out; twice the crown would cull nothing.
            assert!((0.4..1.5).contains(&bounds.radius_m), "{bounds:?}");
        }
    }
}
