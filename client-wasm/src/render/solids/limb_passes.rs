//! The compute pass that bends the components of trees.

use crate::render::gpu::constants::{NO_LIMBS, TREE_SECTIONS, WORKGROUP_SIZE};
use crate::render::gpu::device::Gpu;
use crate::render::gpu::pipeline::{PassFactory, bind_as, storage, storage_rw};
use crate::render::solids::grown_trees::GrownTree;
use crate::render::solids::instances::Instance;
use crate::render::solids::trees_and_stones::TreeDetail;
use bytemuck::{Pod, Zeroable};
use wgpu::BufferUsages;

/// Bytes of a bent component in `limbs.wgsl`.
pub(crate) const BENT_LIMB_BYTES: u64 = 64 + 16 * TREE_SECTIONS as u64;
/// Maximum number of bent components in a frame. Where there are more, farther trees are distant ones, which have one each.
const BENT_LIMIT: usize = 65_536;

/// A component in `limbs.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct TreeLimb {
    angle: [f32; 2],
    turn: [f32; 2],
    load_s2_per_m2: f32,
    load_per_pa: f32,
    length: f32,
    host_fraction: f32,
    host: u32,
    depth: u32,
    swing_rad_m_per_s: f32,
    unused: f32,
}

impl TreeLimb {
    /// All components of a tree.
    pub(crate) fn of(tree: &GrownTree) -> Vec<Self> {
        let statics = &tree.statics;
        let limb = |(number, placed): (usize, &prairie_core::plant::underbrush::plan::Placed)| {
            let planned = &statics.plan.components[number];
            let carriers = std::iter::successors(placed.on, |&on| statics.placed[on].on);
            Self {
                angle: [placed.angle_rad.cos(), placed.angle_rad.sin()],
                turn: [placed.turn_rad.cos(), placed.turn_rad.sin()],
                load_s2_per_m2: planned.weight_s2_per_m / statics.tree_m,
                load_per_pa: planned.drag_per_pa,
                length: statics.frames[number].length,
                host_fraction: placed.at_fraction,
                host: placed.on.unwrap_or(0) as u32,
                depth: carriers.count() as u32,
                swing_rad_m_per_s: statics.frequency_rad_per_s(number) * statics.tree_m,
                unused: 0.0,
            }
        };
        statics.placed.iter().enumerate().map(limb).collect()
    }
}

/// Angles of the sections in the table of a tree, without the lever at the end of each node.
pub(crate) fn postures(tree: &GrownTree) -> Vec<f32> {
    let table = &tree.statics.plan.tables[0];
    table.values().chunks(table.stride()).flat_map(|node| &node[..TREE_SECTIONS as usize]).copied().collect()
}

/// Bends the components of the trees of a frame.
pub(crate) struct LimbPasses {
    pipeline: wgpu::ComputePipeline,
    group: wgpu::BindGroup,
    /// Instance and component of each invocation.
    listed: wgpu::Buffer,
    /// First component of each shape.
    first_limbs: Vec<u32>,
    /// Components of each shape that bend, by level of detail.
    counts: Vec<[u32; 3]>,
    /// Workgroups of the newest frame.
    groups: u32,
}

impl LimbPasses {
    /// Passes for those shapes, with the instances and their sways, which write to `bent`.
    pub(crate) fn new(
        factory: &PassFactory,
        module: &wgpu::ShaderModule,
        trees: &[GrownTree],
        [instances, sways, bent]: [&wgpu::Buffer; 3],
    ) -> Self {
        let gpu = &factory.gpu;
        let rows: Vec<Vec<TreeLimb>> = trees.iter().map(TreeLimb::of).collect();
        let first_limbs = rows.iter().scan(0, |next, rows| Some(std::mem::replace(next, *next + rows.len() as u32))).collect();
        let counts = trees.iter().map(|tree| TreeDetail::ALL.map(|detail| tree.limbs(detail) as u32)).collect();
        let limbs = gpu.buffer("limbs of trees", bytemuck::cast_slice(&rows.concat()), BufferUsages::STORAGE);
        // All trees share one table.
        let postures = gpu.buffer("postures of trees", bytemuck::cast_slice(&postures(&trees[0])), BufferUsages::STORAGE);
        let listed = gpu.empty_buffer("listed limbs", 8 * BENT_LIMIT as u64, BufferUsages::STORAGE | BufferUsages::COPY_DST);
        let layout = factory.layout("bow", &[storage(0), storage(2), storage_rw(5), storage(6), storage(7), storage(8)]);
        let buffers = [(0, instances), (2, sways), (5, bent), (6, &limbs), (7, &postures), (8, &listed)];
        let group = bind_as(gpu, "bow", &layout, &buffers);
        Self { pipeline: factory.compute("bow", module, "bow", &layout), group, listed, first_limbs, counts, groups: 0 }
    }

    /// The buffer of bent components, which vertex shaders read: a single one if no tree has any.
    pub(crate) fn bent(gpu: &Gpu, is_used: bool) -> wgpu::Buffer {
        let limit = if is_used { BENT_LIMIT as u64 } else { 1 };
        gpu.empty_buffer("bent limbs", limit * BENT_LIMB_BYTES, BufferUsages::STORAGE | BufferUsages::COPY_SRC)
    }

    /// Components that may bend beside one for each of `instances`.
    pub(crate) fn spare(instances: usize) -> usize {
        BENT_LIMIT - instances
    }

    /// First component of a shape, and the number that bends at a level of detail.
    pub(crate) fn range(&self, shape: u32, detail: TreeDetail) -> [u32; 2] {
        [self.first_limbs[shape as usize], self.counts[shape as usize][detail as usize]]
    }

    /// Allocates the components of the instances of a frame.
    pub(crate) fn assign(&mut self, gpu: &Gpu, instances: &mut [Instance]) {
        let mut listed: Vec<[u32; 2]> = Vec::new();
        for (number, instance) in instances.iter_mut().enumerate().filter(|(_, instance)| instance.limbs > 0) {
            let first = listed.len();
            listed.extend((0..instance.limbs).map(|limb| [number as u32, limb]));
            let has_room = listed.len() <= BENT_LIMIT;
            instance.first_bent = if has_room { first as u32 } else { NO_LIMBS };
            listed.truncate(if has_room { listed.len() } else { first });
        }
        self.groups = (listed.len() as u32).div_ceil(WORKGROUP_SIZE);
        listed.resize((self.groups * WORKGROUP_SIZE) as usize, [NO_LIMBS; 2]);
        gpu.queue.write_buffer(&self.listed, 0, bytemuck::cast_slice(&listed));
    }

    /// Bends all components of the newest frame.
    pub(crate) fn bend(&self, pass: &mut wgpu::ComputePass<'_>) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(1, &self.group, &[]);
        pass.dispatch_workgroups(self.groups, 1, 1);
    }
}
