//! Buffers, pipelines and bind groups of the underbrush.

use super::bake::LEVELS;
use super::layout::{BLOCK, CHUNK, COUNTER_BYTES, RESPONSE_BYTES, ROW_BYTES, VISIBLE_PLANT_BYTES};
use super::lists::Lists;
use super::tiles::UnderbrushPlant;
use crate::render::gpu::device::Gpu;
use crate::render::gpu::pipeline::{DrawDescriptor, PassFactory, bind_as, bind_at, storage, storage_rw, uniform};
use crate::render::gpu::shaders;
use crate::render::gpu::uniforms::DrawnList;
use crate::render::gpu::uniforms::UnderbrushFrame;
use crate::render::gpu::variants::{LampVariants, OcclusionVariants, SphereVariants};
use crate::render::inputs::depth_pyramid::{PYRAMID_BINDING, pyramid_layout};
use crate::render::plants::force_field::CameraForceField;
use prairie_core::plant::flora::Flora;
use wgpu::BufferUsages;

pub(super) struct UnderbrushBuffers {
    pub(super) frame: wgpu::Buffer,
    plants: wgpu::Buffer,
    /// Ranges of plants that may be visible, one per workgroup.
    pub(super) chunks: wgpu::Buffer,
    /// Number of visible plants, and their list; and their workgroups, for an indirect dispatch.
    pub(super) sifted: wgpu::Buffer,
    pub(super) sifted_groups: wgpu::Buffer,
    /// Forces on the plants.
    pub(super) responses: wgpu::Buffer,
    /// Postures of the visible plants.
    pub(super) visible_plants: wgpu::Buffer,
    /// Visible plants by list.
    pub(super) listed: wgpu::Buffer,
    /// Direction in which the plant of each site fell.
    pub(super) broken: wgpu::Buffer,
    pub(super) counters: wgpu::Buffer,
    /// Plant of each block of rows.
    pub(super) owners: wgpu::Buffer,
    /// Workgroups of the rows, for an indirect dispatch.
    ribbon_groups: wgpu::Buffer,
    /// Left and right border of each row.
    pub(super) borders: wgpu::Buffer,
}

impl UnderbrushBuffers {
    /// Buffers with this capacity in plants and in blocks of rows.
    pub(super) fn new(
        gpu: &Gpu,
        grown: &[UnderbrushPlant],
        flora: &Flora,
        lists: &Lists,
        [plant_room, block_room]: [u64; 2],
        chunk_limit: u64,
    ) -> Self {
        let count = grown.len() as u64;
        let storage = BufferUsages::STORAGE;
        let written = storage | BufferUsages::COPY_DST;
        let read_back = storage | BufferUsages::COPY_SRC;
        let uniforms = BufferUsages::UNIFORM | BufferUsages::COPY_DST;
        let sites = flora.grown().sites.total() as u64;
        // A multiple of the blocks per workgroup.
        let owner_room = block_room.next_multiple_of(u64::from(CHUNK / BLOCK));
        Self {
            frame: gpu.empty_buffer("underbrush frame", size_of::<UnderbrushFrame>() as u64, uniforms),
            plants: gpu.buffer("underbrush", bytemuck::cast_slice(grown), storage),
            chunks: gpu.empty_buffer("underbrush chunks", chunk_limit * 8, written),
            sifted: gpu.empty_buffer("sifted underbrush", (1 + count) * 4, written),
            sifted_groups: gpu.empty_buffer("sifted groups", 12, written | BufferUsages::INDIRECT),
            responses: gpu.empty_buffer("responses", count * RESPONSE_BYTES, read_back),
            visible_plants: gpu.empty_buffer("underbrush visible_plants", plant_room * VISIBLE_PLANT_BYTES, read_back),
            listed: gpu.empty_buffer("listed underbrush", u64::from(lists.places) * 4, read_back),
            broken: gpu.empty_buffer("broken plants", sites.next_multiple_of(4), written),
            counters: gpu.empty_buffer("underbrush counters", COUNTER_BYTES as u64, written | BufferUsages::COPY_SRC),
            owners: gpu.empty_buffer("owners of rows", owner_room * 4, read_back),
            ribbon_groups: gpu.empty_buffer("ribbon groups", 12, storage | BufferUsages::INDIRECT),
            borders: gpu.empty_buffer("borders of rows", block_room * u64::from(BLOCK) * ROW_BYTES, read_back),
        }
    }
}

/// A draw list: a species at a level of detail.
pub(super) struct SpeciesDrawList {
    pub(super) number: usize,
    pub(super) indices: wgpu::Buffer,
    pub(super) group: wgpu::BindGroup,
}

/// A compute pass with its bind group.
struct Step<P> {
    pipeline: P,
    group: wgpu::BindGroup,
}

pub(super) struct Passes {
    sift: Step<OcclusionVariants<wgpu::ComputePipeline>>,
    stand: Step<LampVariants<wgpu::ComputePipeline>>,
    finish: Step<wgpu::ComputePipeline>,
    ribbons: Step<SphereVariants<wgpu::ComputePipeline>>,
    drawing: wgpu::RenderPipeline,
    /// Draws the finest level as curves with veins.
    close: Option<wgpu::RenderPipeline>,
    list_layout: wgpu::BindGroupLayout,
}

impl Passes {
    pub(super) fn new(
        factory: &PassFactory,
        buffers: &UnderbrushBuffers,
        lists: &Lists,
        force_field: &CameraForceField,
        [rains, curves]: [bool; 2],
    ) -> Self {
        let module = factory.shader("underbrush", shaders::UNDERBRUSH, &[]);
        let step = |entry, entries: &[_], resources: &[_]| {
            let layout = factory.layout(entry, entries);
            Step { pipeline: factory.compute(entry, &module, entry, &layout), group: bind_as(&factory.gpu, entry, &layout, resources) }
        };
        let UnderbrushBuffers { frame, counters, owners, ribbon_groups, .. } = buffers;
        let list_layout = factory.layout("underbrush list", &[storage(11), storage(12), uniform(15), storage(24), uniform(25)]);
        let close =
            DrawDescriptor { label: "underbrush close up", vertex: "vs_close", fragment: Some("fs_close"), ..DrawDescriptor::default() };
        Self {
            sift: sift_step(factory, buffers),
            finish: step(
                "finish",
                &[uniform(0), storage_rw(5), storage_rw(8), uniform(15), storage_rw(20), storage_rw(22)],
                &[(0, frame), (5, counters), (8, &lists.draws), (15, &lists.settings), (20, owners), (22, ribbon_groups)],
            ),
            stand: stand_step(factory, buffers, lists, force_field),
            ribbons: ribbon_step(factory, buffers, lists, [rains, curves]),
            drawing: factory.draw(&module, Some(&list_layout), &DrawDescriptor { label: "underbrush", ..DrawDescriptor::default() }),
            close: curves.then(|| factory.draw(&module, Some(&list_layout), &close)),
            list_layout,
        }
    }

    /// The pipeline that draws a list.
    pub(super) fn drawing_of(&self, list: &SpeciesDrawList) -> &wgpu::RenderPipeline {
        self.close.as_ref().filter(|_| list.number.is_multiple_of(LEVELS)).unwrap_or(&self.drawing)
    }

    /// The draw lists of all species and levels of detail that have plants.
    pub(super) fn draw_lists(&self, gpu: &Gpu, buffers: &UnderbrushBuffers, lists: &Lists) -> Vec<SpeciesDrawList> {
        let list = |(number, indices): &(usize, wgpu::Buffer)| {
            let drawn = gpu.buffer(
                "underbrush list",
                bytemuck::bytes_of(&DrawnList { number: *number as u32, _pad: [0; 12] }),
                BufferUsages::UNIFORM,
            );
            let UnderbrushBuffers { listed, counters, borders, .. } = buffers;
            let resources = [(11, listed), (12, counters), (15, &lists.settings), (24, borders), (25, &drawn)];
            SpeciesDrawList {
                number: *number,
                indices: indices.clone(),
                group: bind_as(gpu, "underbrush list", &self.list_layout, &resources),
            }
        };
        lists.indices.iter().map(list).collect()
    }

    /// Creates a variant of a pipeline that no frame has needed yet. Returns false if there is none.
    pub(super) fn create_next(&self) -> bool {
        self.ribbons.pipeline.create_next() || self.sift.pipeline.create_next() || self.stand.pipeline.create_next()
    }

    /// Culls the plants of `chunk_count` chunks and bends the visible ones.
    pub(super) fn bend(
        &self,
        pass: &mut wgpu::ComputePass<'_>,
        buffers: &UnderbrushBuffers,
        chunk_count: u32,
        [has_spheres, has_lamps, occludes]: [bool; 3],
    ) {
        pass.set_pipeline(self.sift.pipeline.with([occludes]));
        pass.set_bind_group(1, &self.sift.group, &[]);
        pass.dispatch_workgroups(chunk_count, 1, 1);
        pass.set_pipeline(self.stand.pipeline.of(has_lamps));
        pass.set_bind_group(1, &self.stand.group, &[]);
        pass.dispatch_workgroups_indirect(&buffers.sifted_groups, 0);
        pass.set_pipeline(&self.finish.pipeline);
        pass.set_bind_group(1, &self.finish.group, &[]);
        pass.dispatch_workgroups(1, 1, 1);
        pass.set_pipeline(self.ribbons.pipeline.of(has_spheres, has_lamps));
        pass.set_bind_group(1, &self.ribbons.group, &[]);
        pass.dispatch_workgroups_indirect(&buffers.ribbon_groups, 0);
    }
}

/// The pass that computes forces and postures, and lists the plants.
fn stand_step(
    factory: &PassFactory,
    buffers: &UnderbrushBuffers,
    lists: &Lists,
    force_field: &CameraForceField,
) -> Step<LampVariants<wgpu::ComputePipeline>> {
    let UnderbrushBuffers { frame, plants, sifted, responses, visible_plants, listed, broken, counters, owners, .. } = buffers;
    let rest = [read(1), storage_rw(3), storage_rw(4), storage_rw(5), storage_rw(6), read(7), read(19), storage_rw(20)];
    let entries: Vec<_> = rest.into_iter().chain([uniform(0), uniform(15)]).chain(CameraForceField::layout()).collect();
    let layout = factory.layout("stand", &entries);
    let resources = [
        (1, plants),
        (3, responses),
        (4, visible_plants),
        (5, counters),
        (6, listed),
        (7, broken),
        (19, sifted),
        (20, owners),
        (0, frame),
        (15, &lists.settings),
    ];
    let resources = resources.map(|(binding, buffer)| (binding, buffer.as_entire_binding()));
    let group = bind_at(&factory.gpu, "stand", &layout, resources.into_iter().chain(force_field.resources()));
    let factory = factory.clone();
    let pipeline = LampVariants::new(move |lamps| {
        let module = factory.shader("underbrush", shaders::UNDERBRUSH, &lamps);
        factory.compute("stand", &module, "stand", &layout)
    });
    Step { pipeline, group }
}

/// The pass that lists the plants that may be in view.
fn sift_step(factory: &PassFactory, buffers: &UnderbrushBuffers) -> Step<OcclusionVariants<wgpu::ComputePipeline>> {
    let UnderbrushBuffers { frame, plants, chunks, sifted, sifted_groups, .. } = buffers;
    let layout = factory.layout("sift", &[uniform(0), read(1), read(2), storage_rw(17), storage_rw(18), pyramid_layout()]);
    let resources = [(0, frame), (1, plants), (2, chunks), (17, sifted), (18, sifted_groups), (PYRAMID_BINDING, &factory.pyramid)];
    let group = bind_as(&factory.gpu, "sift", &layout, &resources);
    let factory = factory.clone();
    let pipeline = OcclusionVariants::tested(move |constants| {
        let module = factory.shader("underbrush", shaders::UNDERBRUSH, &constants);
        factory.compute("sift", &module, "sift", &layout)
    });
    Step { pipeline, group }
}

/// The pass that bends and lights the rows of the ribbons.
fn ribbon_step(
    factory: &PassFactory,
    buffers: &UnderbrushBuffers,
    lists: &Lists,
    [rains, curves]: [bool; 2],
) -> Step<SphereVariants<wgpu::ComputePipeline>> {
    let layout = factory.layout("ribbons", &[read(10), read(13), read(14), uniform(15), read(16), read(21), storage_rw(23)]);
    let Lists { steps, rows, settings, limbs, .. } = lists;
    let UnderbrushBuffers { visible_plants, owners, borders, .. } = buffers;
    let resources = [(10, visible_plants), (13, steps), (14, rows), (15, settings), (16, limbs), (21, owners), (23, borders)];
    let group = bind_as(&factory.gpu, "ribbons", &layout, &resources);
    let factory = factory.clone();
    let pipeline = SphereVariants::new(move |[lamps, spheres]| {
        let module = factory.shader("underbrush", shaders::UNDERBRUSH, &[lamps, spheres, ("trembles", rains), ("curves", curves)]);
        factory.compute("ribbons", &module, "ribbons", &layout)
    });
    Step { pipeline, group }
}

fn read(binding: u32) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry { visibility: wgpu::ShaderStages::COMPUTE, ..storage(binding) }
}
