//! Occlusion culling of solids in two phases (Haar & Aaltonen 2015): those that were visible in the previous frame are drawn first, and of the others those
//! that the depth pyramid of these does not hide.

use crate::render::gpu::constants::{DRAW_WORDS, INSTANCE_LIMIT, MESH_LIMIT};
use crate::render::gpu::device::Gpu;
use crate::render::gpu::pipeline::{PassFactory, bind_as, storage, storage_rw};
use crate::render::gpu::shaders;
use crate::render::inputs::depth_pyramid::{PYRAMID_BINDING, pyramid_layout};
use crate::render::solids::bounding_sphere::BoundingSphere;
use bytemuck::{Pod, Zeroable};
use std::ops::Range;
use wgpu::BufferUsages;

/// Bytes of an indirect draw.
const DRAW_BYTES: u64 = 4 * DRAW_WORDS as u64;

/// Solids of a frame that a call draws.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Phase {
    /// All in view: nothing is tested.
    Whole,
    /// Those that were visible in the previous frame.
    Known,
    /// Of the others, those that are not hidden.
    New,
}

/// Bounding sphere of an instance in view, and its mark: an index that is the same in all frames.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tested {
    pub(super) bounds: BoundingSphere,
    pub(super) mark: u32,
}

/// A bounding sphere in `occlusion.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct Bounds {
    centre_m: [f32; 3],
    radius_m: f32,
}

/// The passes that list the solids of both phases.
pub(super) struct SolidOcclusion {
    known: wgpu::ComputePipeline,
    new: wgpu::ComputePipeline,
    groups: [wgpu::BindGroup; 2],
    bounds: wgpu::Buffer,
    runs: wgpu::Buffer,
    marks: wgpu::Buffer,
    /// Instances of the first phase, of the second one, and all of them in order.
    order: wgpu::Buffer,
    /// Indirect draws of both phases.
    draws: wgpu::Buffer,
    /// Meshes with instances in the newest frame.
    meshes: u32,
}

impl SolidOcclusion {
    /// Passes for a scene with this number of marks.
    pub(super) fn new(factory: &PassFactory, marks: u32) -> Self {
        let gpu = &factory.gpu;
        let module = factory.shader("occlusion of solids", shaders::OCCLUSION, &[]);
        let (instances, written) = (u64::from(INSTANCE_LIMIT), BufferUsages::STORAGE | BufferUsages::COPY_DST);
        let bounds = gpu.empty_buffer("bounds of solids", size_of::<Bounds>() as u64 * instances, written);
        let runs = gpu.empty_buffer("meshes in view", 8 * u64::from(MESH_LIMIT), written);
        let of_instances = gpu.empty_buffer("marks of solids", 4 * instances, written);
        let visible = gpu.empty_buffer("visible solids", 4 * u64::from(marks.max(1)), BufferUsages::STORAGE);
        let listed = gpu.empty_buffer("known solids", 4 * instances, BufferUsages::STORAGE);
        let order = gpu.empty_buffer("order of solids", 3 * 4 * instances, written | BufferUsages::VERTEX);
        let all: Vec<u32> = (0..INSTANCE_LIMIT).collect();
        gpu.queue.write_buffer(&order, 2 * 4 * instances, bytemuck::cast_slice(&all));
        let usage = written | BufferUsages::INDIRECT | BufferUsages::COPY_SRC;
        let draws = gpu.empty_buffer("draws of solids", 2 * DRAW_BYTES * u64::from(MESH_LIMIT), usage);
        let own = [storage(1), storage(2), storage_rw(3), storage_rw(4), storage_rw(5), storage_rw(6)];
        let buffers = [(1, &runs), (2, &of_instances), (3, &visible), (4, &listed), (5, &order), (6, &draws)];
        let pass = |entry, entries: &[_], more: &[(u32, &wgpu::Buffer)]| {
            let layout = factory.layout(entry, &[&own, entries].concat());
            (factory.compute(entry, &module, entry, &layout), bind_as(gpu, entry, &layout, &[&buffers, more].concat()))
        };
        let (known, known_group) = pass("list_known", &[], &[]);
        let (new, new_group) = pass("list_new", &[storage(0), pyramid_layout()], &[(0, &bounds), (PYRAMID_BINDING, &factory.pyramid)]);
        Self { known, new, groups: [known_group, new_group], bounds, runs, marks: of_instances, order, draws, meshes: 0 }
    }

    /// Sets the instances in view, those of each mesh together: their bounds, and for each mesh the range of its instances and its draw without any.
    pub(super) fn prepare(&mut self, gpu: &Gpu, tested: &[Tested], meshes: &[(Range<u32>, [u32; DRAW_WORDS as usize])]) {
        let bounds = |own: &Tested| Bounds { centre_m: own.bounds.centre_m.into(), radius_m: own.bounds.radius_m };
        let bounds: Vec<Bounds> = tested.iter().map(bounds).collect();
        let marks: Vec<u32> = tested.iter().map(|own| own.mark).collect();
        let runs: Vec<[u32; 2]> = meshes.iter().map(|(instances, _)| [instances.start, instances.len() as u32]).collect();
        let draws: Vec<[u32; DRAW_WORDS as usize]> = meshes.iter().map(|(_, draw)| *draw).collect();
        self.meshes = meshes.len() as u32;
        gpu.queue.write_buffer(&self.bounds, 0, bytemuck::cast_slice(&bounds));
        gpu.queue.write_buffer(&self.marks, 0, bytemuck::cast_slice(&marks));
        gpu.queue.write_buffer(&self.runs, 0, bytemuck::cast_slice(&runs));
        for phase in [Phase::Known, Phase::New] {
            gpu.queue.write_buffer(&self.draws, draw_at(phase, 0), bytemuck::cast_slice(&draws));
        }
    }

    /// Lists the solids that were visible in the previous frame.
    pub(super) fn list_known(&self, pass: &mut wgpu::ComputePass<'_>) {
        self.list(pass, &self.known, &self.groups[0]);
    }

    /// Lists the other ones that the depth pyramid does not hide, and remembers which of all are visible.
    pub(super) fn list_new(&self, pass: &mut wgpu::ComputePass<'_>) {
        self.list(pass, &self.new, &self.groups[1]);
    }

    fn list(&self, pass: &mut wgpu::ComputePass<'_>, pipeline: &wgpu::ComputePipeline, group: &wgpu::BindGroup) {
        pass.set_pipeline(pipeline);
        pass.set_bind_group(1, group, &[]);
        pass.dispatch_workgroups(self.meshes, 1, 1);
    }

    /// All instances in order, as a vertex buffer.
    pub(super) fn all(&self) -> wgpu::BufferSlice<'_> {
        self.order.slice(4 * 2 * u64::from(INSTANCE_LIMIT)..)
    }

    /// Draws the instances of a phase of mesh `number` of those in view, which start at `first`.
    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, phase: Phase, number: usize, first: u32) {
        let before = if phase == Phase::New { INSTANCE_LIMIT } else { 0 };
        pass.set_vertex_buffer(1, self.order.slice(4 * u64::from(before + first)..));
        pass.draw_indexed_indirect(&self.draws, draw_at(phase, number));
    }

    /// Indirect draws of the newest frame, for [`drawn`](Self::drawn).
    #[cfg(not(target_arch = "wasm32"))]
    pub(super) fn draws(&self) -> &wgpu::Buffer {
        &self.draws
    }

    /// Numbers of drawn solids and of their triangles by these draws.
    #[cfg(not(target_arch = "wasm32"))]
    pub(super) fn drawn(&self, draws: &[u8]) -> [u64; 2] {
        let draws: Vec<[u32; DRAW_WORDS as usize]> = bytemuck::pod_collect_to_vec(draws);
        let phases = draws.chunks(MESH_LIMIT as usize).flat_map(|phase| phase.iter().take(self.meshes as usize));
        phases.fold([0; 2], |[solids, triangles], [indices, instances, ..]| {
            [solids + u64::from(*instances), triangles + u64::from(*instances) * u64::from(indices / 3)]
        })
    }
}

/// Offset of the draw of a mesh among the draws (bytes).
fn draw_at(phase: Phase, number: usize) -> u64 {
    let before = if phase == Phase::New { MESH_LIMIT as usize } else { 0 };
    DRAW_BYTES * (before + number) as u64
}
