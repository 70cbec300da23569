//! Underbrush (Endo et al. 2003): compute passes cull the plants, compute the forces on them, list them by species and level of detail, and bend and
//! light the rows of their ribbons by precomputed tables of postures; indirect draws render the rows.

mod bake;
mod close_up;
mod layout;
mod lists;
mod passes;
mod tiles;

use crate::render::gpu::constants::{CLOSE_PX, SPARE_DIVISOR};
use crate::render::gpu::device::Gpu;
use crate::render::gpu::pipeline::PassFactory;
use crate::render::gpu::uniforms::{Nature, UnderbrushFrame};
use crate::render::inputs::viewpoint::Viewpoint;
use crate::render::options::quality::Quality;
use crate::render::plants::force_field::CameraForceField;
use crate::state::DecodedScene;
use layout::{BLOCK, CHUNK, CHUNKS_LIMIT, COUNTER_BYTES};
pub(crate) use layout::{ROW_BYTES, VISIBLE_PLANT_BYTES};
use lists::{DRAW_WORDS, Lists};
use passes::{Passes, SpeciesDrawList, UnderbrushBuffers};
use prairie_core::plant::flora::{self, Flora, height_m};
use prairie_core::plant::growth::SPECIES_LIMIT;
use tiles::PlantTile;
#[cfg(test)]
pub(crate) use tiles::UnderbrushPlant;
use tiles::tile_number;
pub(crate) use tiles::tiles;

/// Height of plants that no picture has (px).
const NEVER_PX: f32 = 1e9;

pub(crate) struct Underbrush {
    passes: Passes,
    buffers: UnderbrushBuffers,
    draw_lists: Vec<SpeciesDrawList>,
    draws: wgpu::Buffer,
    /// Sorted by row.
    tiles: Vec<PlantTile>,
    species: [Nature; SPECIES_LIMIT],
    /// Plants and blocks of rows that the buffers hold.
    room: [u32; 2],
    /// Number of the newest frame in which time advanced; starts at 2, so that no plant counts as visible in the frame before the first.
    frame_number: u32,
    /// Height from which plants are drawn as curves with veins (px).
    close_px: f32,
    chunk_count: u32,
    shown_broken: u32,
    plants: u32,
    #[cfg(test)]
    pub(crate) seen: TestBuffers,
}

/// Results of the compute passes, for tests.
#[cfg(test)]
pub(crate) struct TestBuffers {
    pub(crate) responses: wgpu::Buffer,
    visible_plants: wgpu::Buffer,
    listed: wgpu::Buffer,
    owners: wgpu::Buffer,
    borders: wgpu::Buffer,
    lists: Vec<crate::render::gpu::uniforms::BrushList>,
}

impl Underbrush {
    /// The underbrush of a scene; `None` if none grows.
    pub(crate) fn new(factory: &PassFactory, quality: Quality, decoded: &DecodedScene, force_field: &CameraForceField) -> Option<Self> {
        let flora = decoded.flora()?;
        let gpu = &factory.gpu;
        let (grown, tiles) = tiles(decoded, flora);
        if grown.is_empty() {
            return None;
        }
        let mut counts = [0_u32; SPECIES_LIMIT];
        grown.iter().for_each(|plant| counts[(plant.species_and_variant & 255) as usize] += 1);
        let rain_mm_per_h = decoded.scene().rain.rate_mm_per_h;
        let lists = Lists::new(gpu, flora, &counts, rain_mm_per_h, quality.has_close_ups());
        let mut species = [<Nature as bytemuck::Zeroable>::zeroed(); SPECIES_LIMIT];
        for (entry, (own, plan)) in species.iter_mut().zip(flora.species().iter().zip(flora.plans())) {
            *entry = Nature { height_m: height_m(own), settle_secs: plan.settle_secs, reach_m: flora::reach_m(own), _pad: [0; 4] };
        }
        let room = room(gpu, quality, flora, &lists, &counts);
        let chunk_limit = tiles.iter().map(|tile| u64::from(tile.count.div_ceil(CHUNK))).sum::<u64>().max(1);
        let buffers = UnderbrushBuffers::new(gpu, &grown, flora, &lists, room, chunk_limit);
        let passes = Passes::new(factory, &buffers, &lists, force_field, [rain_mm_per_h > 0.0, quality.has_close_ups()]);
        let draw_lists = passes.draw_lists(gpu, &buffers, &lists);
        Some(Self {
            passes,
            draw_lists,
            draws: lists.draws,
            tiles,
            species,
            room: room.map(|count| count as u32),
            frame_number: 2,
            close_px: if quality.has_close_ups() { CLOSE_PX } else { NEVER_PX },
            chunk_count: 0,
            shown_broken: 0,
            plants: grown.len() as u32,
            #[cfg(test)]
            seen: TestBuffers {
                responses: buffers.responses.clone(),
                visible_plants: buffers.visible_plants.clone(),
                listed: buffers.listed.clone(),
                owners: buffers.owners.clone(),
                borders: buffers.borders.clone(),
                lists: lists.of,
            },
            buffers,
        })
    }

    /// Plants in the scene.
    pub(crate) fn plants(&self) -> u32 {
        self.plants
    }

    /// Number of plants that the newest frame drew of each species at each level of detail, and numbers of requested blocks of rows.
    #[cfg(not(target_arch = "wasm32"))]
    pub(crate) fn counters(&self) -> &wgpu::Buffer {
        &self.buffers.counters
    }

    /// Number of drawn plants by these counters.
    #[cfg(not(target_arch = "wasm32"))]
    pub(crate) fn drawn(counters: &[u8]) -> u32 {
        let counts: Vec<u32> = bytemuck::pod_collect_to_vec(counters);
        counts[..layout::LISTS].iter().sum()
    }

    /// Lists the plants of the squares that may be visible.
    pub(crate) fn prepare(&mut self, gpu: &Gpu, from: &Viewpoint<'_>) {
        let (eye_m, reach_m) = (from.eye_m, from.detail.underbrush_m);
        let mut chunks: Vec<[u32; 2]> = Vec::new();
        // Plants rooted on rows beyond are not drawn.
        let first = self.tiles.partition_point(|tile| tile.row < tile_number(eye_m.z - reach_m));
        let end = self.tiles.partition_point(|tile| tile.row <= tile_number(eye_m.z + reach_m));
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
        let [plant_room, block_room] = self.room;
        let frame = UnderbrushFrame {
            frame_number: self.frame_number,
            culls: u32::from(from.options.culls),
            plant_limit: plant_room,
            block_limit: block_room,
            step_secs: from.dt_secs.max(0.0),
            reach_m,
            coarseness: from.detail.coarser,
            close_px: self.close_px,
            species: self.species,
        };
        gpu.queue.write_buffer(&self.buffers.frame, 0, bytemuck::bytes_of(&frame));
        gpu.queue.write_buffer(&self.buffers.chunks, 0, bytemuck::cast_slice(&chunks));
        gpu.queue.write_buffer(&self.buffers.sifted, 0, &[0; 4]);
        gpu.queue.write_buffer(&self.buffers.sifted_groups, 0, bytemuck::bytes_of(&[0_u32, 1, 1]));
        gpu.queue.write_buffer(&self.buffers.counters, 0, &[0; COUNTER_BYTES]);
    }

    /// Sets the direction in which the plant of each site fell, 0 for an upright one, and the number of broken plants.
    pub(crate) fn show_broken(&mut self, gpu: &Gpu, falls: &[u8], count: u32) {
        if count != self.shown_broken {
            self.shown_broken = count;
            gpu.queue.write_buffer(&self.buffers.broken, 0, falls);
        }
    }

    /// Lists and bends the plants in view; if `occludes`, without those that the depth pyramid hides.
    pub(crate) fn bend(&self, pass: &mut wgpu::ComputePass<'_>, [has_spheres, has_lamps, occludes]: [bool; 3]) {
        if self.chunk_count > 0 {
            self.passes.bend(pass, &self.buffers, self.chunk_count, [has_spheres, has_lamps, occludes]);
        }
    }

    /// Creates a variant of a pipeline that no frame has needed yet. Returns false if there is none.
    pub(crate) fn create_next(&self) -> bool {
        self.passes.create_next()
    }

    pub(crate) fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        if self.chunk_count == 0 {
            return;
        }
        for list in &self.draw_lists {
            pass.set_pipeline(self.passes.drawing_of(list));
            pass.set_bind_group(1, &list.group, &[]);
            pass.set_index_buffer(list.indices.slice(..), wgpu::IndexFormat::Uint32);
            pass.draw_indexed_indirect(&self.draws, (list.number * DRAW_WORDS * 4) as u64);
        }
    }
}

/// Plants and blocks of rows that the buffers hold.
fn room(gpu: &Gpu, quality: Quality, flora: &Flora, lists: &Lists, counts: &[u32; SPECIES_LIMIT]) -> [u64; 2] {
    let plants: u64 = counts.iter().map(|&count| u64::from(count)).sum();
    let bytes = quality.underbrush_bytes().min(gpu.device.limits().max_storage_buffer_binding_size);
    let blocks = |species: usize| u64::from(counts[species]) * u64::from(lists.most_blocks(species));
    let all_blocks = (0..flora.species().len()).map(blocks).sum::<u64>();
    [plants.min(bytes / VISIBLE_PLANT_BYTES), room_for(all_blocks).min(bytes / (ROW_BYTES * u64::from(BLOCK)))]
}

/// Blocks to reserve so that `blocks` fit beside the reserve, as in `main_room` of `underbrush.wgsl`.
fn room_for(blocks: u64) -> u64 {
    (u64::from(SPARE_DIVISOR) * blocks).div_ceil(u64::from(SPARE_DIVISOR - 1))
}

#[cfg(test)]
mod tests;
