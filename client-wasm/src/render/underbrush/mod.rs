//! Underbrush (004): compute passes sift the plants that may be seen, find what they feel, list them by species and level of detail, and bend and light the
//! rows of their ribbons by tables of postures, which are made beforehand; indirect draws show those.

mod bake;
mod lists;

use super::blades::Standpoint;
use super::forces::Forces;
use super::gpu::Gpu;
use super::pipeline::{ByLamps, BySpheres, Draw, Maker, bind_as, sampled, storage, storage_rw, uniform};
use super::uniforms::UnderbrushFrame;
use super::{Quality, shaders};
use crate::state::Land;
use bake::VARIANTS;
use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use lists::{DRAW_WORDS, LISTS, Lists};
use shared::plant::flora::{self, Flora, height_m};
use shared::plant::growth::SPECIES_LIMIT;
use wgpu::BufferUsages;

/// Plants of a workgroup, and the most workgroups of a dispatch that every device allows; of more plants within reach, the last rows' are left out.
const CHUNK: u32 = 64;
const CHUNKS_LIMIT: usize = 65_535;
/// Rows that a plant takes at once; twin of the constant in `underbrush.wgsl`.
const BLOCK: u32 = 8;
/// Side of the squares that are culled as one (m).
const TILE_M: f32 = 8.0;
/// Share of plants that is left at least where they are but a few pixels tall; those are larger by its power of -0.3. Twin of the constant in `underbrush.wgsl`.
const FEWEST: f32 = 0.06;
/// Bytes of a plant's feelings, of how it stands and of a row's borders, as in `underbrush.wgsl` and `ribbons.wgsl`.
const FELT_BYTES: u64 = 32;
pub(super) const STAND_BYTES: u64 = 128;
pub(super) const ROW_BYTES: u64 = 64;
/// Bytes of the lengths of all lists, and of the numbers of blocks that were asked for.
const TALLY_BYTES: usize = (LISTS + 2) * 4;

/// A plant as `underbrush.wgsl` takes it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(super) struct Grown {
    pub(super) at_m: [f32; 2],
    size: f32,
    make: u32,
    heading_rad: f32,
    pub(super) site: u32,
}

/// Plants of a square of the land.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tile {
    row: i32,
    low_m: Vec3,
    high_m: Vec3,
    first: u32,
    count: u32,
}

/// A list that is drawn: a species at a level of detail.
struct List {
    number: usize,
    indices: wgpu::Buffer,
    group: wgpu::BindGroup,
}

/// A compute pass and what it works on.
struct Step<P> {
    pipeline: P,
    group: wgpu::BindGroup,
}

pub(super) struct Underbrush {
    sift: Step<wgpu::ComputePipeline>,
    stand: Step<ByLamps<wgpu::ComputePipeline>>,
    finish: Step<wgpu::ComputePipeline>,
    ribbons: Step<BySpheres<wgpu::ComputePipeline>>,
    drawing: wgpu::RenderPipeline,
    frame: wgpu::Buffer,
    chunks: wgpu::Buffer,
    /// How many plants may be seen, and which; and the workgroups of those and of their rows, each for an indirect dispatch.
    sifted: wgpu::Buffer,
    sifted_groups: wgpu::Buffer,
    ribbon_groups: wgpu::Buffer,
    broken: wgpu::Buffer,
    shown_broken: u32,
    tally: wgpu::Buffer,
    draws: wgpu::Buffer,
    lists: Vec<List>,
    /// Row by row.
    tiles: Vec<Tile>,
    species: [[f32; 4]; SPECIES_LIMIT],
    /// Plants and blocks of rows that there is room for.
    room: [u32; 2],
    /// Number of the newest frame, of those in which time passes; the first is the second, so that nothing has been seen right before it.
    frame_number: u32,
    chunk_count: u32,
    plants: u32,
    #[cfg(test)]
    pub(super) seen: Seen,
}

/// What the compute passes leave, for tests.
#[cfg(test)]
pub(super) struct Seen {
    pub(super) felt: wgpu::Buffer,
    stands: wgpu::Buffer,
    listed: wgpu::Buffer,
    owners: wgpu::Buffer,
    borders: wgpu::Buffer,
    lists: Vec<super::uniforms::BrushList>,
}

impl Underbrush {
    /// Of a scene in which any grows.
    pub(super) fn new(maker: &Maker<'_>, quality: Quality, land: &Land, forces: &Forces) -> Option<Self> {
        let flora = land.flora()?;
        let gpu = maker.gpu;
        let (grown, tiles) = tiles(land, flora);
        if grown.is_empty() {
            return None;
        }
        let mut own = [0_u32; SPECIES_LIMIT];
        grown.iter().for_each(|plant| own[(plant.make & 255) as usize] += 1);
        let lists = Lists::new(gpu, flora, &own, land.scene().rain.rate_mm_per_h);
        let mut species = [[0.0; 4]; SPECIES_LIMIT];
        for (nature, (own, plan)) in species.iter_mut().zip(flora.species().iter().zip(flora.plans())) {
            *nature = [height_m(own), plan.settle_secs, flora::reach_m(own), 0.0];
        }
        let count = grown.len() as u64;
        let room_bytes = quality.underbrush_bytes().min(gpu.device.limits().max_storage_buffer_binding_size);
        let stand_room = count.min(room_bytes / STAND_BYTES);
        let most_blocks =
            (0..flora.species().len()).map(|number| u64::from(own[number]) * u64::from(lists.most_blocks(number))).sum::<u64>();
        let block_room = room_for(most_blocks).min(room_bytes / (ROW_BYTES * u64::from(BLOCK)));
        let chunk_limit = tiles.iter().map(|tile| u64::from(tile.count.div_ceil(CHUNK))).sum::<u64>().max(1);

        let storage_usage = BufferUsages::STORAGE;
        let filled = storage_usage | BufferUsages::COPY_DST;
        let read_back = storage_usage | BufferUsages::COPY_SRC;
        let plants = gpu.buffer("underbrush", bytemuck::cast_slice(&grown), storage_usage);
        let frame =
            gpu.empty_buffer("underbrush frame", size_of::<UnderbrushFrame>() as u64, BufferUsages::UNIFORM | BufferUsages::COPY_DST);
        let chunks = gpu.empty_buffer("underbrush chunks", chunk_limit * 8, filled);
        let sifted = gpu.empty_buffer("sifted underbrush", (1 + count) * 4, filled);
        let sifted_groups = gpu.empty_buffer("sifted groups", 12, filled | BufferUsages::INDIRECT);
        let felt = gpu.empty_buffer("felt", count * FELT_BYTES, read_back);
        let stands = gpu.empty_buffer("underbrush stands", stand_room * STAND_BYTES, read_back);
        let tally = gpu.empty_buffer("underbrush tally", TALLY_BYTES as u64, filled | BufferUsages::COPY_SRC);
        let listed = gpu.empty_buffer("listed underbrush", u64::from(lists.places) * 4, read_back);
        let sites = flora.grown().sites.total() as u64;
        let broken = gpu.empty_buffer("broken plants", sites.next_multiple_of(4), filled);
        // As many as whole workgroups take.
        let owners = gpu.empty_buffer("owners of rows", (block_room.next_multiple_of(u64::from(CHUNK / BLOCK))) * 4, read_back);
        let ribbon_groups = gpu.empty_buffer("ribbon groups", 12, storage_usage | BufferUsages::INDIRECT);
        let borders = gpu.empty_buffer("borders of rows", block_room * u64::from(BLOCK) * ROW_BYTES, read_back);

        let shader = |constants: &[shaders::Constant]| maker.shader("underbrush", shaders::UNDERBRUSH, constants);
        let module = shader(&[]);
        let read = |binding| wgpu::BindGroupLayoutEntry { visibility: wgpu::ShaderStages::COMPUTE, ..storage(binding) };
        let layout = |label, entries: &[_]| maker.layout(label, entries);
        let step = |entry, entries: &[_], buffers: &[_]| {
            let layout = layout(entry, entries);
            Step { pipeline: maker.compute(entry, &module, entry, &layout), group: bind_as(gpu, entry, &layout, buffers) }
        };
        let sift = step(
            "sift",
            &[uniform(0), read(1), read(2), storage_rw(17), storage_rw(18)],
            &[(0, &frame), (1, &plants), (2, &chunks), (17, &sifted), (18, &sifted_groups)],
        );
        let finish = step(
            "finish",
            &[uniform(0), storage_rw(5), storage_rw(8), uniform(15), storage_rw(20), storage_rw(22)],
            &[(0, &frame), (5, &tally), (8, &lists.draws), (15, &lists.settings), (20, &owners), (22, &ribbon_groups)],
        );
        let stand = {
            let rest = [read(1), storage_rw(3), storage_rw(4), storage_rw(5), storage_rw(6), read(7), read(19), storage_rw(20)];
            let entries: Vec<_> = rest.into_iter().chain([uniform(0), volumes(9), uniform(15)]).collect();
            let layout = layout("stand", &entries);
            let buffers = [&plants, &felt, &stands, &tally, &listed, &broken, &sifted, &owners, &frame, &lists.settings];
            let bindings = [1, 3, 4, 5, 6, 7, 19, 20, 0, 15];
            let whole = bindings.into_iter().zip(buffers).map(|(binding, buffer)| (binding, buffer.as_entire_binding()));
            let forces = (9, wgpu::BindingResource::TextureView(&forces.view));
            let entries: Vec<_> = whole.chain([forces]).map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource }).collect();
            let group =
                gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some("stand"), layout: &layout, entries: &entries });
            let pipeline = ByLamps::new(|lamps| maker.compute("stand", &shader(&[lamps]), "stand", &layout));
            Step { pipeline, group }
        };
        let ribbons = {
            let layout = layout("ribbons", &[read(10), read(13), read(14), uniform(15), read(16), read(21), storage_rw(23)]);
            let trembles = ("trembles", land.scene().rain.rate_mm_per_h > 0.0);
            let pipeline =
                BySpheres::new(|[lamps, spheres]| maker.compute("ribbons", &shader(&[lamps, spheres, trembles]), "ribbons", &layout));
            let [steps, rows, settings, limbs] = [&lists.steps, &lists.rows, &lists.settings, &lists.limbs];
            let buffers = [(10, &stands), (13, steps), (14, rows), (15, settings), (16, limbs), (21, &owners), (23, &borders)];
            Step { pipeline, group: bind_as(gpu, "ribbons", &layout, &buffers) }
        };
        let list_layout = layout("underbrush list", &[storage(11), storage(12), uniform(15), storage(24), uniform(25)]);
        let list = |(number, indices): (usize, wgpu::Buffer)| {
            let drawn = gpu.buffer("underbrush list", bytemuck::bytes_of(&[number as u32, 0, 0, 0]), BufferUsages::UNIFORM);
            let buffers = [(11, &listed), (12, &tally), (15, &lists.settings), (24, &borders), (25, &drawn)];
            List { number, indices, group: bind_as(gpu, "underbrush list", &list_layout, &buffers) }
        };
        Some(Self {
            sift,
            stand,
            finish,
            ribbons,
            drawing: maker.draw(&module, Some(&list_layout), &Draw { label: "underbrush", ..Draw::default() }),
            lists: lists.indices.into_iter().map(list).collect(),
            frame,
            chunks,
            sifted,
            sifted_groups,
            ribbon_groups,
            broken,
            shown_broken: 0,
            tally,
            draws: lists.draws,
            tiles,
            species,
            room: [stand_room as u32, block_room as u32],
            frame_number: 2,
            chunk_count: 0,
            plants: grown.len() as u32,
            #[cfg(test)]
            seen: Seen { felt, stands, listed, owners, borders, lists: lists.of },
        })
    }

    /// Plants in the scene.
    pub(super) fn plants(&self) -> u32 {
        self.plants
    }

    /// How many plants the newest frame drew of each species at each level of detail, and how many blocks of rows they asked for.
    #[cfg(not(target_arch = "wasm32"))]
    pub(super) fn tally(&self) -> &wgpu::Buffer {
        &self.tally
    }

    /// Plants that the frame drew whose tally this is.
    #[cfg(not(target_arch = "wasm32"))]
    pub(super) fn drawn(tally: &[u8]) -> u32 {
        let counts: Vec<u32> = bytemuck::pod_collect_to_vec(tally);
        counts[..LISTS].iter().sum()
    }

    /// Lists the plants of the squares that may be seen.
    pub(super) fn prepare(&mut self, gpu: &Gpu, forces: &Forces, from: &Standpoint<'_>) {
        let (eye_m, reach_m) = (from.eye_m, from.detail.underbrush_m);
        let mut chunks: Vec<[u32; 2]> = Vec::new();
        // What is rooted on rows beyond is not drawn.
        let first = self.tiles.partition_point(|tile| tile.row < number(eye_m.z - reach_m));
        let end = self.tiles.partition_point(|tile| tile.row <= number(eye_m.z + reach_m));
        for tile in &self.tiles[first..end] {
            let nearest = eye_m.clamp(tile.low_m, tile.high_m);
            if nearest.distance_squared(eye_m) < reach_m * reach_m && from.frustum.sees_box(tile.low_m, tile.high_m) {
                let starts = (0..tile.count).step_by(CHUNK as usize);
                chunks.extend(starts.map(|start| [tile.first + start, (tile.count - start).min(CHUNK)]));
            }
        }
        chunks.truncate(CHUNKS_LIMIT);
        self.chunk_count = chunks.len() as u32;
        self.frame_number = self.frame_number.wrapping_add(u32::from(from.dt_secs > 0.0));
        let [stand_room, block_room] = self.room;
        let frame = UnderbrushFrame {
            counts: [self.frame_number, u32::from(from.look.culls), stand_room, block_room],
            shape: [from.dt_secs.max(0.0), reach_m, forces.height_m(), from.detail.coarser],
            forces: forces.window_m(),
            species: self.species,
        };
        gpu.queue.write_buffer(&self.frame, 0, bytemuck::bytes_of(&frame));
        gpu.queue.write_buffer(&self.chunks, 0, bytemuck::cast_slice(&chunks));
        gpu.queue.write_buffer(&self.sifted, 0, &[0; 4]);
        gpu.queue.write_buffer(&self.sifted_groups, 0, bytemuck::bytes_of(&[0_u32, 1, 1]));
        gpu.queue.write_buffer(&self.tally, 0, &[0; TALLY_BYTES]);
    }

    /// Shows as broken what a mirror says: which way the plant of each site fell, 0 for a whole one, and how many are broken.
    pub(super) fn show_broken(&mut self, gpu: &Gpu, falls: &[u8], count: u32) {
        if count != self.shown_broken {
            self.shown_broken = count;
            gpu.queue.write_buffer(&self.broken, 0, falls);
        }
    }

    pub(super) fn bend(&self, pass: &mut wgpu::ComputePass<'_>, has_spheres: bool, has_lamps: bool) {
        if self.chunk_count == 0 {
            return;
        }
        pass.set_pipeline(&self.sift.pipeline);
        pass.set_bind_group(1, &self.sift.group, &[]);
        pass.dispatch_workgroups(self.chunk_count, 1, 1);
        pass.set_pipeline(self.stand.pipeline.of(has_lamps));
        pass.set_bind_group(1, &self.stand.group, &[]);
        pass.dispatch_workgroups_indirect(&self.sifted_groups, 0);
        pass.set_pipeline(&self.finish.pipeline);
        pass.set_bind_group(1, &self.finish.group, &[]);
        pass.dispatch_workgroups(1, 1, 1);
        pass.set_pipeline(self.ribbons.pipeline.of(has_spheres, has_lamps));
        pass.set_bind_group(1, &self.ribbons.group, &[]);
        pass.dispatch_workgroups_indirect(&self.ribbon_groups, 0);
    }

    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        if self.chunk_count == 0 {
            return;
        }
        pass.set_pipeline(&self.drawing);
        for list in &self.lists {
            pass.set_bind_group(1, &list.group, &[]);
            pass.set_index_buffer(list.indices.slice(..), wgpu::IndexFormat::Uint32);
            pass.draw_indexed_indirect(&self.draws, (list.number * DRAW_WORDS * 4) as u64);
        }
    }
}

/// Room (blocks) in which so many find a place; a quarter of it is for what finds none in the rest, as `main_room` in `underbrush.wgsl` has it.
fn room_for(blocks: u64) -> u64 {
    (4 * blocks).div_ceil(3)
}

fn volumes(binding: u32) -> wgpu::BindGroupLayoutEntry {
    sampled(binding, wgpu::TextureSampleType::Float { filterable: true }, wgpu::TextureViewDimension::D3)
}

/// Number of the square along an axis.
fn number(m: f32) -> i32 {
    (m / TILE_M).floor() as i32
}

/// All plants, square by square, and the squares, row by row.
pub(super) fn tiles(land: &Land, flora: &Flora) -> (Vec<Grown>, Vec<Tile>) {
    let reaches_m: Vec<f32> = flora.species().iter().map(flora::reach_m).collect();
    let mut by_tile: Vec<([i32; 2], Grown, f32)> = flora
        .grown()
        .plants()
        .iter()
        .map(|plant| {
            let standing = flora.standing(plant);
            let make = standing.species as u32 | (standing.number % VARIANTS) << 8;
            let grown = Grown { at_m: standing.at_m, size: standing.size, make, heading_rad: standing.heading_rad, site: plant.site };
            (standing.at_m.map(number), grown, reaches_m[standing.species] * standing.size * FEWEST.powf(-0.3))
        })
        .collect();
    by_tile.sort_by_key(|&([x, z], ..)| [z, x]);
    let mut tiles = Vec::new();
    let mut first = 0;
    for own in by_tile.chunk_by(|a, b| a.0 == b.0) {
        let (mut low_m, mut high_m) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for (_, plant, reach_m) in own {
            let [x, z] = plant.at_m;
            let ground_m = land.heights().height_m(x, z);
            low_m = low_m.min(Vec3::new(x - reach_m, ground_m - 0.1, z - reach_m));
            high_m = high_m.max(Vec3::new(x + reach_m, ground_m + reach_m, z + reach_m));
        }
        tiles.push(Tile { row: own[0].0[1], low_m, high_m, first, count: own.len() as u32 });
        first += own.len() as u32;
    }
    (by_tile.into_iter().map(|(_, plant, _)| plant).collect(), tiles)
}

#[cfg(test)]
mod tests;
