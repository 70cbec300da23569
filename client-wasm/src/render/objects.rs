//! Everything made of meshes: vehicles, trees and stones; drawn for the eye and for the sun.

use super::blades::Standpoint;
use super::cull::Beam;
use super::flora::{self, STONE_SHAPES, Standing, TREE_SHAPES, TreeDetail};
use super::gpu::Gpu;
use super::grove::{Ball, Grove};
use super::mesh::{Paint, Solid, VERTEX_ATTRIBUTES, Vertex};
use super::paint;
use super::pipeline::{ByLamps, Draw, Maker, bind, storage, storage_rw, texture};
use super::quality::Quality;
use super::shaders;
use super::vehicles::{self, Part};
use crate::state::{Land, OBJECT_LIMIT};
use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Quat, Vec2, Vec3};
use shared::wire::{Mesh, ObjectId, ObjectPose};
use std::collections::HashMap;
use std::ops::Range;
use wgpu::BufferUsages;

/// Most instances in a frame.
const INSTANCE_LIMIT: usize = 12_288;
/// Heights in the picture from which on trees are fine, and below which they are distant (px), at high quality.
const FINE_TREE_PX: f32 = 130.0;
const DISTANT_TREE_PX: f32 = 26.0;
/// How finely trees are made that throw shadows into the layers of the shadow map.
const SHADOW_DETAIL: [TreeDetail; 2] = [TreeDetail::Coarse, TreeDetail::Distant];

#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct Instance {
    world_from_model: [f32; 16],
    tint: [f32; 4],
}

/// Where a mesh lies in the shared buffers.
#[derive(Clone, Debug)]
struct MeshRange {
    indices: Range<u32>,
    base_vertex: i32,
}

struct Pipelines {
    /// What may be glossy: vehicles.
    glossy: wgpu::RenderPipeline,
    matte: wgpu::RenderPipeline,
    /// Trees that are not fine, lit at their vertices where the [quality](Quality::lights_trees_at_vertices) says so.
    afar: wgpu::RenderPipeline,
}

pub(super) struct Objects {
    pipelines: ByLamps<Pipelines>,
    shadow_pipelines: [wgpu::RenderPipeline; 2],
    group: wgpu::BindGroup,
    blow: wgpu::ComputePipeline,
    blow_group: wgpu::BindGroup,
    vertices: wgpu::Buffer,
    indices: wgpu::Buffer,
    instances: wgpu::Buffer,
    /// Instances of the newest frame.
    count: u32,
    meshes: Vec<MeshRange>,
    grove: Grove,
    rolled_m: HashMap<ObjectId, f32>,
    /// Mesh and instances of each draw, for the eye and for the layers of the sun's map.
    seen: Vec<(usize, Range<u32>)>,
    lit: [Vec<(usize, Range<u32>)>; 2],
}

/// Order of the meshes: parts, fine, coarse and distant trees, stones.
fn tree_mesh(shape: u32, detail: TreeDetail) -> usize {
    Part::ALL.len() + (shape + detail as u32 * TREE_SHAPES) as usize
}

fn stone_mesh(shape: u32) -> usize {
    Part::ALL.len() + TreeDetail::ALL.len() * TREE_SHAPES as usize + shape as usize
}

fn part_mesh(part: Part) -> usize {
    Part::ALL.iter().position(|&other| other == part).expect("every part is in the list of all")
}

impl Objects {
    pub(super) fn new(maker: &Maker<'_>, quality: Quality, land: &Land, standing: Vec<Standing>) -> Self {
        let gpu = maker.gpu;
        let mut solids: Vec<Solid> = Part::ALL.iter().map(|&part| part_solid(land, part)).collect();
        let details = TreeDetail::ALL.into_iter();
        solids.extend(details.flat_map(|detail| (0..TREE_SHAPES).map(move |shape| flora::tree(shape, detail))));
        solids.extend((0..STONE_SHAPES).map(flora::stone));
        let (mut vertices, mut indices, mut meshes) = (Vec::new(), Vec::new(), Vec::new());
        for solid in &solids {
            let first = indices.len() as u32;
            meshes.push(MeshRange { base_vertex: vertices.len() as i32, indices: first..first + solid.indices.len() as u32 });
            vertices.extend_from_slice(&solid.vertices);
            indices.extend_from_slice(&solid.indices);
        }

        let trees = (0..TREE_SHAPES).map(|shape| Ball::about(TreeDetail::ALL.iter().map(|&detail| &solids[tree_mesh(shape, detail)])));
        let stones = (0..STONE_SHAPES).map(|shape| Ball::about([&solids[stone_mesh(shape)]].into_iter()));
        let balls: Vec<Ball> = trees.chain(stones).collect();
        let model = |standing: &Standing| balls[(standing.shape + if standing.is_tree { 0 } else { TREE_SHAPES }) as usize];
        let grove = Grove::new(standing.into_iter().map(|standing| (standing, model(&standing).of(&standing))).collect());

        let module = maker.shader("objects", shaders::OBJECTS, &[]);
        let layout = maker.layout("objects", &[storage(0), texture(1), storage(2)]);
        let buffer = wgpu::VertexBufferLayout {
            array_stride: size_of::<Vertex>() as u64,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &VERTEX_ATTRIBUTES,
        };
        let buffers = [Some(buffer)];
        let draw = Draw { label: "objects", buffers: &buffers, ..Draw::default() };
        let pipelines = ByLamps::new(|lamps| {
            let [with_gloss, without] =
                [true, false].map(|gloss| maker.shader("objects", shaders::OBJECTS, &[lamps, ("is_glossy", gloss)]));
            let [glossy, matte] = [&with_gloss, &without].map(|module| maker.draw(module, Some(&layout), &draw));
            let at_vertices = Draw { vertex: "vs_afar", fragment: Some("fs_afar"), ..draw };
            let is_at_vertices = quality.lights_trees_at_vertices(gpu.is_software);
            let afar = if is_at_vertices { maker.draw(&without, Some(&layout), &at_vertices) } else { matte.clone() };
            Pipelines { glossy, matte, afar }
        });
        let shadow_pipelines = ["vs_shadow", "vs_shadow_far"].map(|vertex| {
            let shadow = Draw { label: "shadows", vertex, fragment: Some("fs_shadow"), ..draw };
            maker.draw(&module, Some(&layout), &shadow)
        });
        let size = (INSTANCE_LIMIT * size_of::<Instance>()) as u64;
        let instances = gpu.empty_buffer("instances", size, BufferUsages::STORAGE | BufferUsages::COPY_DST);
        let leaves = gpu.texture("leaves", wgpu::TextureFormat::Rgba8Unorm, [paint::LEAF_PX; 2], &paint::leaves());
        let leaves = leaves.create_view(&Default::default());
        let sways = gpu.empty_buffer("sways of objects", (INSTANCE_LIMIT * 16) as u64, BufferUsages::STORAGE);
        let resources = [instances.as_entire_binding(), wgpu::BindingResource::TextureView(&leaves), sways.as_entire_binding()];
        let blow_layout = maker.layout("blow", &[storage(0), storage_rw(3)]);
        let entries =
            [(0, &instances), (3, &sways)].map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() });
        let blow_group =
            gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some("blow"), layout: &blow_layout, entries: &entries });
        Self {
            pipelines,
            shadow_pipelines,
            group: bind(gpu, "objects", &layout, &resources),
            blow: maker.compute("blow", &module, "blow", &blow_layout),
            blow_group,
            count: 0,
            vertices: gpu.buffer("meshes", bytemuck::cast_slice(&vertices), BufferUsages::VERTEX),
            indices: gpu.buffer("mesh indices", bytemuck::cast_slice(&indices), BufferUsages::INDEX),
            instances,
            meshes,
            grove,
            rolled_m: HashMap::new(),
            seen: Vec::new(),
            lit: Default::default(),
        }
    }

    /// Lists what is in view, and what throws shadows into the layers of the sun's map that are drawn, whose beams these are.
    pub(super) fn prepare(
        &mut self,
        gpu: &Gpu,
        poses: &[ObjectPose],
        from: &Standpoint<'_>,
        beams: [Option<Beam>; 2],
        time_secs: f32,
        pixel_rad: f32,
    ) {
        let mut by_mesh: Vec<Vec<Instance>> = vec![Vec::new(); self.meshes.len()];
        let mut by_mesh_lit = [by_mesh.clone(), by_mesh.clone()];
        self.rolled_m.retain(|id, _| poses.iter().any(|pose| pose.id == *id));
        for pose in poses.iter().take(OBJECT_LIMIT) {
            let rotation = Quat::from_array(pose.rotation);
            let forward = rotation * Vec3::NEG_Z;
            let rolled = self.rolled_m.entry(pose.id).or_default();
            *rolled = (*rolled + Vec3::from(pose.velocity_m_per_s).dot(forward) * from.dt_secs) % 1000.0;
            let body = glam::Affine3A::from_rotation_translation(rotation, Vec3::from(pose.position_m));
            for (part, place) in vehicles::parts(pose, *rolled, time_secs) {
                let world_from_model = Mat4::from(body * place).to_cols_array();
                let instance = Instance { world_from_model, tint: [1.0, 1.0, 1.0, 0.0] };
                by_mesh[part_mesh(part)].push(instance);
                by_mesh_lit
                    .iter_mut()
                    .zip(&beams)
                    .filter(|(_, beam)| beam.is_some())
                    .for_each(|(lit, _)| lit[part_mesh(part)].push(instance));
            }
        }
        let is_seen = |ball: &Ball| {
            let [low_m, high_m] = ball.corners_m();
            from.frustum.sees_box(low_m, high_m)
        };
        let is_lit = |beam: &Option<Beam>, ball: &Ball| {
            beam.as_ref().is_some_and(|beam| !from.look.culls || beam.meets_ball(ball.middle_m, ball.radius_m))
        };
        let may_show = |ball: &Ball| is_seen(ball) || beams.iter().any(|beam| is_lit(beam, ball));
        let room = INSTANCE_LIMIT.saturating_sub(18 * OBJECT_LIMIT.min(poses.len()));
        for (distance_m, (standing, ball)) in self.grove.near(from.eye_m, from.detail.trees_m, room / 3, may_show) {
            let tall_px = standing.size_m / (distance_m * pixel_rad * from.detail.coarser);
            let detail = match tall_px {
                FINE_TREE_PX.. => TreeDetail::Fine,
                DISTANT_TREE_PX.. => TreeDetail::Coarse,
                _ => TreeDetail::Distant,
            };
            let mesh = |detail| match standing.is_tree {
                true => tree_mesh(standing.shape, detail),
                false => stone_mesh(standing.shape),
            };
            let instance = Instance { world_from_model: standing.world_from_model.to_cols_array(), tint: standing.tint };
            if is_seen(ball) {
                by_mesh[mesh(detail)].push(instance);
            }
            for ((lit, beam), detail) in by_mesh_lit.iter_mut().zip(&beams).zip(SHADOW_DETAIL) {
                if is_lit(beam, ball) {
                    lit[mesh(detail)].push(instance);
                }
            }
        }
        let mut all = Vec::new();
        let [near, far] = &mut self.lit;
        for (lists, draws) in [(&by_mesh, &mut self.seen), (&by_mesh_lit[0], near), (&by_mesh_lit[1], far)] {
            draws.clear();
            for (mesh, list) in lists.iter().enumerate().filter(|(_, list)| !list.is_empty()) {
                let first = all.len() as u32;
                all.extend_from_slice(&list[..list.len().min(INSTANCE_LIMIT - all.len())]);
                draws.push((mesh, first..all.len() as u32));
            }
        }
        self.count = all.len() as u32;
        gpu.queue.write_buffer(&self.instances, 0, bytemuck::cast_slice(&all));
    }

    /// Triangles that [`draw`](Self::draw) feeds in.
    pub(super) fn triangles(&self) -> u64 {
        self.seen.iter().map(|(mesh, range)| u64::from((self.meshes[*mesh].indices.len() / 3) as u32) * range.len() as u64).sum()
    }

    /// Finds how the wind holds each of them, for all that is drawn in this frame.
    pub(super) fn blow(&self, pass: &mut wgpu::ComputePass<'_>) {
        pass.set_pipeline(&self.blow);
        pass.set_bind_group(1, &self.blow_group, &[]);
        pass.dispatch_workgroups(self.count.div_ceil(64), 1, 1);
    }

    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, has_lamps: bool) {
        let Pipelines { glossy, matte, afar } = self.pipelines.of(has_lamps);
        let ends = [Part::ALL.len(), tree_mesh(0, TreeDetail::Coarse), stone_mesh(0), usize::MAX];
        let mut rest = self.seen.as_slice();
        for (pipeline, end) in [glossy, matte, afar, matte].into_iter().zip(ends) {
            let (list, others) = rest.split_at(rest.partition_point(|&(mesh, _)| mesh < end));
            rest = others;
            pass.set_pipeline(pipeline);
            self.draw_list(pass, list);
        }
    }

    /// Draws what throws shadows into a layer of the map.
    pub(super) fn draw_shadows(&self, pass: &mut wgpu::RenderPass<'_>, layer: usize) {
        pass.set_pipeline(&self.shadow_pipelines[layer]);
        self.draw_list(pass, &self.lit[layer]);
    }

    fn draw_list(&self, pass: &mut wgpu::RenderPass<'_>, list: &[(usize, Range<u32>)]) {
        pass.set_bind_group(1, &self.group, &[]);
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
        for (mesh, instances) in list {
            let range = &self.meshes[*mesh];
            pass.draw_indexed(range.indices.clone(), range.base_vertex, instances.clone());
        }
    }
}

/// The built-in part, or the scene's own model in its place; the other parts of a replaced vehicle are empty.
fn part_solid(land: &Land, part: Part) -> Solid {
    for (kind, mesh) in land.models() {
        if part == Part::body(*kind) {
            return model(mesh);
        }
        if part.kind() == *kind {
            return Solid::default();
        }
    }
    part.solid(&land.scene().objects)
}

fn model(mesh: &Mesh) -> Solid {
    let mut solid = Solid::default();
    for ((position, normal), rgb) in mesh.positions_m.iter().zip(&mesh.normals).zip(&mesh.rgb) {
        let [r, g, b] = rgb.map(|v| f32::from(v) / 255.0);
        solid.vertex(Vec3::from(*position), Vec3::from(*normal), Paint::new(r, g, b, 0.15), Vec2::ZERO);
    }
    solid.indices.clone_from(&mesh.indices);
    solid
}
