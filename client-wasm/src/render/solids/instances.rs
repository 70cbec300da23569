//! Instances of meshes in a frame, and the lists in which they are collected.

use crate::render::gpu::constants::{self, NO_LIMBS};
use crate::render::solids::bounding_sphere::BoundingSphere;
use crate::render::solids::model_meshes::ModelMeshes;
use crate::render::solids::occlusion::Tested;
use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec3};
use std::f32::consts::PI;
use std::ops::Range;

/// Maximum number of instances in a frame.
pub(super) const INSTANCE_LIMIT: usize = constants::INSTANCE_LIMIT as usize;
/// Marks of vehicles, gates and the ghost, for occlusion; those of placed models follow.
pub(super) const RIGID_MARKS: u32 = 1024;

#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct Instance {
    world_from_model: [f32; 16],
    tint: [f32; 4],
    /// First of its bent components, or `NO_LIMBS`; allocated once all instances are listed.
    pub(super) first_bent: u32,
    /// First component of its shape, and the number of those that bend.
    first_limb: u32,
    pub(super) limbs: u32,
    unused: u32,
}

impl Instance {
    /// An instance without components.
    pub(super) fn new(world_from_model: &Mat4, tint: [f32; 4]) -> Self {
        Self { world_from_model: world_from_model.to_cols_array(), tint, first_bent: NO_LIMBS, first_limb: 0, limbs: 0, unused: 0 }
    }

    /// The instance with `limbs` components from `first_limb` on.
    pub(super) fn with_limbs(self, [first_limb, limbs]: [u32; 2]) -> Self {
        Self { first_limb, limbs, ..self }
    }
}

/// Instances by mesh: in the picture, and in each cascade.
pub(super) struct InstanceLists {
    pub(super) picture: Vec<Vec<Instance>>,
    /// Bounds of those in the picture.
    pub(super) tested: Vec<Vec<Tested>>,
    pub(super) cascades: [Vec<Vec<Instance>>; 2],
    /// Vehicles, gates and parts of them so far.
    pub(super) rigid: u32,
}

impl InstanceLists {
    /// Shows an instance with a mark of its own in the picture.
    pub(super) fn show(&mut self, mesh: usize, instance: Instance, bounds: BoundingSphere, mark: u32) {
        self.picture[mesh].push(instance);
        self.tested[mesh].push(Tested { bounds, mark });
    }

    /// Shows a rigid instance that is no placed model, if its bounding sphere is seen.
    pub(super) fn show_rigid(&mut self, meshes: &ModelMeshes, mesh: usize, instance: Instance, is_seen: impl Fn(&BoundingSphere) -> bool) {
        let bounds = meshes.sphere_of(mesh, &Mat4::from_cols_array(&instance.world_from_model));
        if is_seen(&bounds) {
            self.show(mesh, instance, bounds, self.rigid.min(RIGID_MARKS - 1));
        }
        self.rigid += 1;
    }

    /// Fraction of a picture that the bounding spheres of its solids other than `trees` cover, each counted by itself.
    pub(super) fn share(&self, trees: &Range<usize>, eye_m: Vec3, picture_sr: f32) -> f32 {
        let covered_sr = |own: &Tested| {
            let distance_m = own.bounds.centre_m.distance(eye_m).max(own.bounds.radius_m);
            PI * (own.bounds.radius_m / distance_m).powi(2)
        };
        let others = (0..).zip(&self.tested).filter(|(mesh, _)| !trees.contains(mesh));
        others.flat_map(|(_, tested)| tested).map(covered_sr).sum::<f32>() / picture_sr
    }
}

/// Meshes to draw, each with its range of instances.
pub(super) type DrawList = Vec<(usize, Range<u32>)>;

/// Appends the instances of all meshes to `all`, as far as there is room, and returns the range of each mesh.
pub(super) fn join(by_mesh: &[Vec<Instance>], all: &mut Vec<Instance>) -> DrawList {
    let mut list = Vec::new();
    for (mesh, instances) in by_mesh.iter().enumerate().filter(|(_, instances)| !instances.is_empty()) {
        let first = all.len() as u32;
        all.extend_from_slice(&instances[..instances.len().min(INSTANCE_LIMIT - all.len())]);
        list.push((mesh, first..all.len() as u32));
    }
    list
}
