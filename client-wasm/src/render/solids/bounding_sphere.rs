//! Bounding spheres of models.

use crate::render::gpu::constants::FLUTTER_M;
use crate::render::solids::mesh::Solid;
use crate::render::solids::trees_and_stones::PlacedModel;
use glam::{Mat4, Vec3};

/// Maximum flutter of leaves (m): 1.9 times along (1, 0.6, -1).
const FLUTTER_LIMIT_M: f32 = 0.103;
const _: () = assert!(FLUTTER_LIMIT_M > 1.9 * 1.5363 * FLUTTER_M);

/// A sphere around a model.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BoundingSphere {
    pub(crate) centre_m: Vec3,
    pub(crate) radius_m: f32,
}

impl BoundingSphere {
    /// Sphere around several meshes of a model, with its centre above the origin.
    pub(crate) fn around_meshes<'a>(solids: impl Iterator<Item = &'a Solid>) -> Self {
        let positions: Vec<Vec3> = solids.flat_map(|solid| &solid.vertices).map(|vertex| Vec3::from(vertex.position)).collect();
        let [low, high] = positions.iter().fold([f32::MAX, f32::MIN], |[low, high], at| [low.min(at.y), high.max(at.y)]);
        let centre_m = Vec3::Y * (0.5 * (low + high));
        Self { centre_m, radius_m: positions.iter().map(|at| at.distance(centre_m)).fold(0.0, f32::max) }
    }

    /// Sphere around a mesh and the middle of its box.
    pub(crate) fn around_mesh(solid: &Solid) -> Self {
        let positions = solid.vertices.iter().map(|vertex| Vec3::from(vertex.position));
        let ends = [Vec3::INFINITY, Vec3::NEG_INFINITY];
        let [low, high] = positions.clone().fold(ends, |[low, high], at| [low.min(at), high.max(at)]);
        let centre_m = if solid.vertices.is_empty() { Vec3::ZERO } else { 0.5 * (low + high) };
        Self { centre_m, radius_m: positions.map(|at| at.distance(centre_m)).fold(0.0, f32::max) }
    }

    /// The sphere around a rigid instance of the model.
    pub(crate) fn moved(self, matrix: &Mat4) -> Self {
        let larger = [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(|axis| axis.length()).into_iter().fold(0.0, f32::max);
        Self { centre_m: matrix.transform_point3(self.centre_m), radius_m: self.radius_m * larger }
    }

    /// The sphere around an instance of the model, including its sway in the wind.
    pub(crate) fn placed(self, placed: &PlacedModel) -> Self {
        let matrix = &placed.world_from_model;
        let [wide_m, tall_m, deep_m] = [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(|axis| axis.length());
        let [.., sway_rad] = placed.tint;
        // As in `swayed` of `objects.wgsl`, for the top.
        let top = self.centre_m.y + self.radius_m;
        let swayed_m = tall_m * (sway_rad * top * top + 2.0 / 3.0 * sway_rad * sway_rad * top * top * top);
        let flutter_m = if placed.is_tree() { FLUTTER_LIMIT_M } else { 0.0 };
        let radius_m = self.radius_m * wide_m.max(tall_m).max(deep_m) + swayed_m + flutter_m;
        Self { centre_m: matrix.transform_point3(self.centre_m), radius_m }
    }

    /// Sphere around other spheres.
    pub(super) fn around_spheres(spheres: impl Iterator<Item = Self> + Clone) -> Self {
        let ends = [Vec3::INFINITY, Vec3::NEG_INFINITY];
        let [low_m, high_m] =
            spheres.clone().map(|sphere| sphere.corners_m()).fold(ends, |[low, high], own| [low.min(own[0]), high.max(own[1])]);
        let centre_m = 0.5 * (low_m + high_m);
        let radius_m = spheres.map(|sphere| sphere.centre_m.distance(centre_m) + sphere.radius_m).fold(0.0, f32::max);
        Self { centre_m, radius_m }
    }

    /// Corners of the box around it.
    pub(crate) fn corners_m(&self) -> [Vec3; 2] {
        [self.centre_m - self.radius_m, self.centre_m + self.radius_m]
    }
}
