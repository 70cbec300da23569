//! Meshes of all vehicles, gates, trees, stones and models of the scene's own in one vertex and one index buffer.

use crate::render::gpu::constants::DRAW_WORDS;
use crate::render::gpu::device::Gpu;
use crate::render::solids::bounding_sphere::BoundingSphere;
use crate::render::solids::gates::{self, GatePart};
use crate::render::solids::grown_trees::GrownTree;
use crate::render::solids::mesh::{Paint, Solid};
use crate::render::solids::trees_and_stones::{self, PlacedKind, PlacedModel, STONE_SHAPES, TREE_SHAPES, TreeDetail};
use crate::render::solids::vehicles::vehicle_model;
use crate::state::DecodedScene;
use glam::{Mat4, Vec2, Vec3};
use prairie_core::scene::VehicleKind;
use prairie_core::wire::{Mesh, ModelUse};
use std::ops::Range;
use wgpu::BufferUsages;

/// Position of a mesh in the shared buffers.
struct MeshRange {
    indices: Range<u32>,
    base_vertex: i32,
}

/// The meshes: parts of vehicles by kind, then those of gates, then fine, coarse and distant trees, then stones, then
/// the models of the scene's own.
pub(crate) struct ModelMeshes {
    vertices: wgpu::Buffer,
    indices: wgpu::Buffer,
    ranges: Vec<MeshRange>,
    /// First mesh of each kind of vehicle.
    first_part: [usize; VehicleKind::ALL.len()],
    first_gate_part: usize,
    first_tree: usize,
    /// Bounding spheres of the tree shapes, then of the stone shapes, then of the models.
    bounds: Vec<BoundingSphere>,
    /// Bounding sphere of each mesh at rest.
    spheres: Vec<BoundingSphere>,
}

impl ModelMeshes {
    /// The meshes of a scene, whose trees have the shapes of `trees`, or are modelled if there are none.
    pub(crate) fn new(gpu: &Gpu, decoded: &DecodedScene, trees: &[GrownTree]) -> Self {
        let mut solids: Vec<Solid> = Vec::new();
        let first_part = VehicleKind::ALL.map(|kind| {
            let first = solids.len();
            solids.extend(vehicle_parts(decoded, kind));
            first
        });
        let first_gate_part = solids.len();
        solids.extend(gates::solids());
        let first_tree = solids.len();
        let details = TreeDetail::ALL.into_iter();
        let tree =
            |shape: u32, detail| trees.get(shape as usize).map_or_else(|| trees_and_stones::tree(shape, detail), |tree| tree.mesh(detail));
        solids.extend(details.flat_map(|detail| (0..TREE_SHAPES).map(move |shape| tree(shape, detail))));
        solids.extend((0..STONE_SHAPES).map(trees_and_stones::stone));
        let own_models = decoded.scene().models.len();
        solids.extend((0..own_models).map(|model| custom_model(decoded, ModelUse::Cover(model as u8)).unwrap_or_default()));
        let (mut vertices, mut indices, mut ranges) = (Vec::new(), Vec::new(), Vec::new());
        for solid in &solids {
            let first = indices.len() as u32;
            ranges.push(MeshRange { base_vertex: vertices.len() as i32, indices: first..first + solid.indices.len() as u32 });
            vertices.extend_from_slice(&solid.vertices);
            indices.extend_from_slice(&solid.indices);
        }
        let mut meshes = Self {
            vertices: gpu.buffer("meshes", bytemuck::cast_slice(&vertices), BufferUsages::VERTEX),
            indices: gpu.buffer("mesh indices", bytemuck::cast_slice(&indices), BufferUsages::INDEX),
            ranges,
            first_part,
            first_gate_part,
            first_tree,
            bounds: Vec::new(),
            spheres: solids.iter().map(BoundingSphere::around_mesh).collect(),
        };
        let of_tree = |shape| TreeDetail::ALL.map(|detail| &solids[meshes.tree(shape, detail)]);
        let modelled = |shape| BoundingSphere::around_meshes(of_tree(shape).into_iter());
        let trees = (0..TREE_SHAPES).map(|shape| trees.get(shape as usize).map_or_else(|| modelled(shape), GrownTree::bounds));
        let stones = (0..STONE_SHAPES).map(|shape| BoundingSphere::around_meshes([&solids[meshes.stone(shape)]].into_iter()));
        let models = (0..own_models as u32).map(|model| BoundingSphere::around_meshes([&solids[meshes.own_model(model)]].into_iter()));
        meshes.bounds = trees.chain(stones).chain(models).collect();
        meshes
    }

    /// Bounding sphere of a placed model, swaying included.
    pub(crate) fn bounds_of(&self, placed: &PlacedModel) -> BoundingSphere {
        let first = match placed.kind {
            PlacedKind::Tree => 0,
            PlacedKind::Stone => TREE_SHAPES,
            PlacedKind::Own => TREE_SHAPES + STONE_SHAPES,
        };
        self.bounds[(first + placed.shape) as usize].placed(placed)
    }

    /// Bounding sphere of a rigid mesh in its place.
    pub(crate) fn sphere_of(&self, mesh: usize, world_from_mesh: &Mat4) -> BoundingSphere {
        self.spheres[mesh].moved(world_from_mesh)
    }

    /// Mesh of a part of a vehicle.
    pub(crate) fn part(&self, kind: VehicleKind, part: usize) -> usize {
        self.first_part[kind as usize] + part
    }

    /// Mesh of a gate's part.
    pub(crate) fn gate_part(&self, part: GatePart) -> usize {
        self.first_gate_part + part as usize
    }

    /// Mesh of a tree shape.
    pub(crate) fn tree(&self, shape: u32, detail: TreeDetail) -> usize {
        self.first_tree + (shape + detail as u32 * TREE_SHAPES) as usize
    }

    /// Mesh of a stone shape.
    pub(crate) fn stone(&self, shape: u32) -> usize {
        self.first_tree + TreeDetail::ALL.len() * TREE_SHAPES as usize + shape as usize
    }

    /// Mesh of a model of the scene's own, by its index there.
    pub(crate) fn own_model(&self, model: u32) -> usize {
        self.stone(STONE_SHAPES) + model as usize
    }

    /// Number of meshes.
    pub(crate) fn count(&self) -> usize {
        self.ranges.len()
    }

    /// Triangles of a mesh.
    pub(crate) fn triangles(&self, mesh: usize) -> u64 {
        self.ranges[mesh].indices.len() as u64 / 3
    }

    /// Indirect draw of a mesh without instances.
    pub(crate) fn indirect_draw(&self, mesh: usize) -> [u32; DRAW_WORDS as usize] {
        let MeshRange { indices, base_vertex } = &self.ranges[mesh];
        [indices.len() as u32, 0, indices.start, *base_vertex as u32, 0]
    }

    /// Sets the shared buffers for draws.
    pub(crate) fn set(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
    }

    /// Draws a mesh with a range of instances.
    pub(crate) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, mesh: usize, instances: Range<u32>) {
        let range = &self.ranges[mesh];
        pass.draw_indexed(range.indices.clone(), range.base_vertex, instances);
    }
}

/// The built-in parts of a vehicle. A custom model of the scene replaces the first; the others are then empty.
fn vehicle_parts(decoded: &DecodedScene, kind: VehicleKind) -> Vec<Solid> {
    let mut parts = (vehicle_model(kind).parts)(&decoded.scene().objects);
    if let Some(model) = custom_model(decoded, ModelUse::Vehicle(kind)) {
        parts.fill(Solid::default());
        parts[0] = model;
    }
    parts
}

/// The model that came with the scene for this use.
fn custom_model(decoded: &DecodedScene, used: ModelUse) -> Option<Solid> {
    let (_, mesh) = decoded.models().iter().find(|(own, _)| *own == used)?;
    Some(solid_of(mesh))
}

fn solid_of(mesh: &Mesh) -> Solid {
    let mut solid = Solid::default();
    for ((position, normal), rgb) in mesh.positions_m.iter().zip(&mesh.normals).zip(&mesh.rgb) {
        let [r, g, b] = rgb.map(|v| f32::from(v) / 255.0);
        solid.vertex(Vec3::from(*position), Vec3::from(*normal), Paint::new(r, g, b, 0.15), Vec2::ZERO);
    }
    solid.indices.clone_from(&mesh.indices);
    solid
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_vehicle_has_a_body_and_places_only_parts_that_it_has() {
        use crate::render::solids::vehicles::Motion;
        use prairie_core::scene::Objects;
        use prairie_core::wire::ObjectPose;

        for kind in VehicleKind::ALL {
            let model = vehicle_model(kind);
            let parts = (model.parts)(&Objects::default());
            assert!(parts.iter().all(|part| !part.indices.is_empty()), "{kind:?}");
            let (position_m, rotation) = ([0.0; 3], [0.0, 0.0, 0.0, 1.0]);
            let pose = ObjectPose { id: 1, kind, position_m, rotation, velocity_m_per_s: [0.0; 3], part_rad: 0.3 };
            let placed = (model.place)(&pose, Motion { rolled_m: 1.0, time_secs: 2.0 });
            assert!((0..parts.len()).all(|part| placed.iter().any(|(number, _)| *number == part)), "{kind:?}");
            assert!(placed.iter().all(|(number, _)| *number < parts.len()), "{kind:?}");
        }
    }
}
