//! Underbrush (004): a compute pass finds what the plants in view feel and lists them by species and level of detail; indirect draws bend them by tables of
//! postures, which are made beforehand.

mod bake;

use super::blades::Standpoint;
use super::forces::Forces;
use super::gpu::Gpu;
use super::pipeline::{ByLamps, Draw, Maker, sampled, storage, storage_rw, uniform};
use super::shaders;
use super::uniforms::{BrushList, UnderbrushFrame};
use crate::state::Land;
use bake::{Baked, LEVELS, VARIANTS};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use shared::plant::flora::{self, Flora, height_m};
use shared::plant::growth::SPECIES_LIMIT;
use shared::plant::underbrush::drops::drops_per_m2_s;
use wgpu::BufferUsages;

/// Plants of a workgroup.
const CHUNK: u32 = 64;
/// Side of the squares that are culled as one (m).
const TILE_M: f32 = 8.0;
/// Share of plants that is left at least where they are but a few pixels tall; those are larger by its power of -0.3. Twin of the constant in `underbrush.wgsl`.
const FEWEST: f32 = 0.06;
/// Vertices of an instance, about: many small plants are drawn as one.
const INSTANCE_VERTICES: u32 = 512;
/// Bytes of a plant's feelings and of how it stands, as in `underbrush.wgsl`.
const FELT_BYTES: u64 = 32;
pub(super) const STAND_BYTES: u64 = 128;
/// Most plants that are drawn: as many stand in the 128 MiB that every device binds at once.
const PLANT_LIMIT: usize = (128 << 20) / STAND_BYTES as usize;
/// Levels whose leaves tremble in the rain; of coarser ones that is a pixel at most.
const TREMBLING_LEVELS: usize = 2;
/// Words of an indirect draw and of what `finish` needs beside it.
const DRAW_WORDS: usize = 8;

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
    trembles: bool,
}

/// How lists are drawn: while no sphere is about, and while any is.
type BySpheres = [ByLamps<wgpu::RenderPipeline>; 2];

pub(super) struct Underbrush {
    stand: wgpu::ComputePipeline,
    finish: wgpu::ComputePipeline,
    calm: BySpheres,
    /// For leaves that tremble, where it rains.
    trembling: Option<BySpheres>,
    frame: wgpu::Buffer,
    chunks: wgpu::Buffer,
    broken: wgpu::Buffer,
    shown_broken: u32,
    tally: wgpu::Buffer,
    draws: wgpu::Buffer,
    #[cfg(test)]
    pub(super) felt: wgpu::Buffer,
    compute_group: wgpu::BindGroup,
    lists: Vec<List>,
    /// Row by row.
    tiles: Vec<Tile>,
    species: [[f32; 4]; SPECIES_LIMIT],
    places: [[u32; 4]; SPECIES_LIMIT],
    /// Number of the newest frame, of those in which time passes; the first is the second, so that nothing has been seen right before it.
    frame_number: u32,
    chunk_count: u32,
    plants: u32,
    #[cfg(test)]
    stands: wgpu::Buffer,
    #[cfg(test)]
    listed: wgpu::Buffer,
}

impl Underbrush {
    /// Of a scene in which any grows.
    pub(super) fn new(maker: &Maker<'_>, land: &Land, forces: &Forces) -> Option<Self> {
        let flora = land.flora()?;
        let gpu = maker.gpu;
        let (grown, tiles) = tiles(land, flora);
        if grown.is_empty() {
            return None;
        }
        let count = grown.len() as u64;
        let storage_usage = BufferUsages::STORAGE;

        let mut places = [[0; 4]; SPECIES_LIMIT];
        let mut first = 0;
        for (number, place) in places.iter_mut().enumerate().take(flora.species().len()) {
            let own = grown.iter().filter(|plant| (plant.make & 255) as usize == number).count() as u32;
            *place = [first, own, 0, 0];
            first += own * LEVELS as u32;
        }
        let mut species = [[0.0; 4]; SPECIES_LIMIT];

        let sites = flora.grown().sites.total() as u64;
        let plants = gpu.buffer("underbrush", bytemuck::cast_slice(&grown), storage_usage);
        let frame =
            gpu.empty_buffer("underbrush frame", size_of::<UnderbrushFrame>() as u64, BufferUsages::UNIFORM | BufferUsages::COPY_DST);
        let chunk_limit = tiles.iter().map(|tile| u64::from(tile.count.div_ceil(CHUNK))).sum::<u64>().max(1);
        let chunks = gpu.empty_buffer("underbrush chunks", chunk_limit * 8, storage_usage | BufferUsages::COPY_DST);
        let felt = gpu.empty_buffer("felt", count * FELT_BYTES, storage_usage | BufferUsages::COPY_SRC);
        let stands = gpu.empty_buffer("underbrush stands", count * STAND_BYTES, storage_usage | BufferUsages::COPY_SRC);
        let tally = gpu.empty_buffer(
            "underbrush tally",
            (SPECIES_LIMIT * LEVELS * 4) as u64,
            storage_usage | BufferUsages::COPY_DST | BufferUsages::COPY_SRC,
        );
        let listed = gpu.empty_buffer("listed underbrush", u64::from(first.max(1)) * 4, storage_usage | BufferUsages::COPY_SRC);
        let broken = gpu.empty_buffer("broken plants", sites.next_multiple_of(4), storage_usage | BufferUsages::COPY_DST);

        let module = gpu.shader("underbrush", shaders::UNDERBRUSH);
        let read = |binding| wgpu::BindGroupLayoutEntry { visibility: wgpu::ShaderStages::COMPUTE, ..storage(binding) };
        let entries =
            [uniform(0), read(1), read(2), storage_rw(3), storage_rw(4), storage_rw(5), storage_rw(6), read(7), storage_rw(8), volumes(9)];
        let compute_layout = maker.layout("underbrush", &entries);
        let list_layout =
            maker.layout("underbrush list", &[storage(10), storage(11), storage(12), storage(13), storage(14), uniform(15), storage(16)]);
        let rain_mm_per_h = land.scene().rain.rate_mm_per_h;
        let pipelines = |trembles: f64| {
            [0.0, 1.0].map(|spheres| {
                ByLamps::new(|lamps| {
                    let constants = [lamps, ("meets_spheres", spheres), ("trembles", trembles)];
                    let draw = Draw { label: "underbrush", constants: &constants, ..Draw::default() };
                    maker.draw(&module, Some(&list_layout), &draw)
                })
            })
        };

        let mut draw_words = vec![0_u32; SPECIES_LIMIT * LEVELS * DRAW_WORDS];
        let mut lists = Vec::new();
        for (number, (own, plan)) in flora.species().iter().zip(flora.plans()).enumerate() {
            species[number] = [height_m(own), plan.settle_secs, flora::reach_m(own), 0.0];
            for level in 0..LEVELS {
                let baked = Baked::new(plan, level);
                let rows = baked.ribbons.iter().sum::<u32>();
                let held = (INSTANCE_VERTICES / (2 * rows)).clamp(1, 64);
                let indices = baked.indices(held);
                let list = number * LEVELS + level;
                draw_words[list * DRAW_WORDS] = indices.len() as u32;
                draw_words[list * DRAW_WORDS + 5] = held;
                let nodes = plan.tables[0].nodes();
                let trembles = rain_mm_per_h > 0.0 && level < TREMBLING_LEVELS;
                let settings = BrushList {
                    rows: [rows, held, baked.limb_count(), 0],
                    which: [list as u32, places[number][0] + level as u32 * places[number][1], u32::from(level + 1 == LEVELS), 0],
                    nodes: [nodes.angles as u32, nodes.loads as u32, 0, 0],
                    rain: [if trembles { drops_per_m2_s(rain_mm_per_h) } else { 0.0 }, 0.0, 0.0, 0.0],
                };
                let steps = gpu.buffer("steps", bytemuck::cast_slice(&baked.steps), storage_usage);
                let rows = gpu.buffer("rows", bytemuck::cast_slice(&baked.rows), storage_usage);
                let limbs = gpu.buffer("limbs", bytemuck::cast_slice(&baked.limbs), storage_usage);
                let settings = gpu.buffer("underbrush list", bytemuck::bytes_of(&settings), BufferUsages::UNIFORM);
                let buffers = [&stands, &listed, &tally, &steps, &rows, &settings, &limbs];
                lists.push(List {
                    number: list,
                    indices: gpu.buffer("underbrush indices", bytemuck::cast_slice(&indices), BufferUsages::INDEX),
                    group: numbered(gpu, "underbrush list", &list_layout, 10, &buffers, None),
                    trembles,
                });
            }
        }
        let draws = gpu.buffer(
            "underbrush draws",
            bytemuck::cast_slice(&draw_words),
            storage_usage | BufferUsages::INDIRECT | BufferUsages::COPY_SRC,
        );
        let buffers = [&frame, &plants, &chunks, &felt, &stands, &tally, &listed, &broken, &draws];
        let forces = (9, wgpu::BindingResource::TextureView(&forces.view));
        Some(Self {
            stand: maker.compute("stand", &module, "stand", &compute_layout),
            finish: maker.compute("finish", &module, "finish", &compute_layout),
            calm: pipelines(0.0),
            trembling: (rain_mm_per_h > 0.0).then(|| pipelines(1.0)),
            compute_group: numbered(gpu, "underbrush", &compute_layout, 0, &buffers, Some(forces)),
            frame,
            chunks,
            broken,
            shown_broken: 0,
            tally,
            draws,
            #[cfg(test)]
            felt,
            lists,
            tiles,
            species,
            places,
            frame_number: 2,
            chunk_count: 0,
            plants: grown.len() as u32,
            #[cfg(test)]
            stands,
            #[cfg(test)]
            listed,
        })
    }

    /// Plants in the scene.
    pub(super) fn plants(&self) -> u32 {
        self.plants
    }

    /// How many plants the newest frame drew of each species at each level of detail.
    #[cfg(not(target_arch = "wasm32"))]
    pub(super) fn tally(&self) -> &wgpu::Buffer {
        &self.tally
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
        self.chunk_count = chunks.len() as u32;
        self.frame_number = self.frame_number.wrapping_add(u32::from(from.dt_secs > 0.0));
        let frame = UnderbrushFrame {
            counts: [self.frame_number, u32::from(from.look.culls), 0, 0],
            shape: [from.dt_secs.max(0.0), reach_m, forces.height_m(), from.detail.coarser],
            forces: forces.window_m(),
            species: self.species,
            places: self.places,
        };
        gpu.queue.write_buffer(&self.frame, 0, bytemuck::bytes_of(&frame));
        gpu.queue.write_buffer(&self.chunks, 0, bytemuck::cast_slice(&chunks));
        gpu.queue.write_buffer(&self.tally, 0, &[0; SPECIES_LIMIT * LEVELS * 4]);
    }

    /// Shows as broken what a mirror says: which way the plant of each site fell, 0 for a whole one, and how many are broken.
    pub(super) fn show_broken(&mut self, gpu: &Gpu, falls: &[u8], count: u32) {
        if count != self.shown_broken {
            self.shown_broken = count;
            gpu.queue.write_buffer(&self.broken, 0, falls);
        }
    }

    pub(super) fn bend(&self, pass: &mut wgpu::ComputePass<'_>) {
        pass.set_bind_group(1, &self.compute_group, &[]);
        if self.chunk_count > 0 {
            pass.set_pipeline(&self.stand);
            pass.dispatch_workgroups(self.chunk_count, 1, 1);
        }
        pass.set_pipeline(&self.finish);
        pass.dispatch_workgroups(1, 1, 1);
    }

    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, has_lamps: bool, has_spheres: bool) {
        if self.chunk_count == 0 {
            return;
        }
        for list in &self.lists {
            let by_spheres = self.trembling.as_ref().filter(|_| list.trembles).unwrap_or(&self.calm);
            pass.set_pipeline(by_spheres[usize::from(has_spheres)].of(has_lamps));
            pass.set_bind_group(1, &list.group, &[]);
            pass.set_index_buffer(list.indices.slice(..), wgpu::IndexFormat::Uint32);
            pass.draw_indexed_indirect(&self.draws, (list.number * DRAW_WORDS * 4) as u64);
        }
    }
}

fn volumes(binding: u32) -> wgpu::BindGroupLayoutEntry {
    sampled(binding, wgpu::TextureSampleType::Float { filterable: true }, wgpu::TextureViewDimension::D3)
}

/// A bind group of whole buffers, numbered from `first`, and perhaps one resource more.
fn numbered(
    gpu: &Gpu,
    label: &str,
    layout: &wgpu::BindGroupLayout,
    first: u32,
    buffers: &[&wgpu::Buffer],
    more: Option<(u32, wgpu::BindingResource<'_>)>,
) -> wgpu::BindGroup {
    let whole = (first..).zip(buffers).map(|(binding, buffer)| (binding, buffer.as_entire_binding()));
    let entries: Vec<_> = whole.chain(more).map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource }).collect();
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some(label), layout, entries: &entries })
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
        .take(PLANT_LIMIT)
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
