//! Single plants: compute passes bend them and list those in view, two indirect draws make strips of the blades and one
//! makes the flower heads. Nine grids about the camera keep their plants' postures; rings of grids beyond stand still.

use super::Quality;
use super::cull::Frustum;
use super::gpu::Gpu;
use super::paint;
use super::pipeline::{Draw, Maker, bind, storage, storage_rw, texture, uniform};
use super::shaders;
use super::uniforms::Plants;
use crate::state::Land;
use glam::Vec3;
use shared::scene::BLADE_STEPS_LIMIT;
use std::f32::consts::{PI, TAU};
use wgpu::BufferUsages;

/// Plants in one instance of an indirect draw; twin of the constants in `blades.wgsl` and `flowers.wgsl`.
const CHUNK: u32 = 64;
/// Vertices of a flower head; twin of `VERTICES` in `flowers.wgsl`.
const FLOWER_VERTICES: u32 = 67;
/// Bytes of a drawn blade and of its sway, as in `common.wgsl` and `blade.wgsl`.
pub(super) const BLADE_BYTES: u64 = 64;
pub(super) const SWAY_BYTES: u64 = 48;
/// Most plants of a near grid.
const PLANTS_LIMIT: u32 = 60_000;
/// Most steps in a frame, of an integrator that needs several: as many as a scene may ask for in 1/15 s. In longer frames its blades move in slow motion.
const STEP_LIMIT: f32 = 4.0 * BLADE_STEPS_LIMIT as f32;
/// Longest step of the exact one (s): wind and obstacles stay as they are for a step.
const EXACT_STEP_SECS: f32 = 0.1;

pub(super) struct Blades {
    near: wgpu::ComputePipeline,
    far: wgpu::ComputePipeline,
    finish: wgpu::ComputePipeline,
    strips: wgpu::RenderPipeline,
    heads: wgpu::RenderPipeline,
    plants: wgpu::Buffer,
    #[cfg(test)]
    pub(super) sways: wgpu::Buffer,
    pub(super) counters: wgpu::Buffer,
    far_grids: wgpu::Buffer,
    draws: wgpu::Buffer,
    compute_group: wgpu::BindGroup,
    lists: [wgpu::BindGroup; 3],
    indices: [wgpu::Buffer; 3],
    grid_m: f32,
    rings: i32,
    near_plants: u32,
    far_plants: u32,
    flower_share: f32,
    /// Most blades drawn fine and coarse, and most flower heads.
    pub(super) capacities: [u32; 3],
    segments: [u32; 2],
    /// Longest step that every blade bears (s).
    longest_step_secs: f32,
    slots: [Option<[i32; 2]>; 9],
    far_count: u32,
}

impl Blades {
    pub(super) fn new(maker: &Maker<'_>, quality: Quality, land: &Land) -> Self {
        let gpu = maker.gpu;
        let scene_plants = &land.scene().plants;
        let grid_m = scene_plants.grid_m;
        let blades = quality.blades_per_side(scene_plants.plants_per_side).pow(2) as f32;
        let flowers = scene_plants.flowers_per_m2 * grid_m * grid_m;
        let near_plants = ((blades + flowers).round() as u32).min(PLANTS_LIMIT);
        let flower_share = flowers / (blades + flowers);
        let rings = quality.rings();
        let far_plants = (near_plants as f32 * full_density_m(quality) / grid_m * 1.1).min(near_plants as f32) as u32;
        let reach_m = (rings + 1) as f32 * grid_m;
        let plants_per_m2 = near_plants as f32 / (grid_m * grid_m);
        let most = |per_m2: f32, within_m: f32| most_standing(per_m2 * full_area_m2(full_density_m(quality), within_m));
        let capacities = [most(plants_per_m2, fine_m(quality)), most(plants_per_m2, reach_m), most(plants_per_m2 * flower_share, reach_m)];
        let segments = quality.segments();

        let storage_usage = BufferUsages::STORAGE;
        let plants = gpu.empty_buffer("plants", size_of::<Plants>() as u64, BufferUsages::UNIFORM | BufferUsages::COPY_DST);
        let sways = gpu.empty_buffer("sways", u64::from(near_plants) * 9 * SWAY_BYTES, storage_usage | BufferUsages::COPY_SRC);
        let drawn_count = capacities.iter().sum::<u32>();
        let drawn = gpu.empty_buffer("drawn plants", u64::from(drawn_count) * BLADE_BYTES, storage_usage);
        let counters = gpu.empty_buffer("counters", 16, storage_usage | BufferUsages::COPY_DST | BufferUsages::COPY_SRC);
        let far_limit = ((2 * rings + 3) * (2 * rings + 3)) as u64;
        let far_grids = gpu.empty_buffer("far grids", far_limit * 16, storage_usage | BufferUsages::COPY_DST);
        let indices = [strip_indices(segments[0]), strip_indices(segments[1]), flower_indices()];
        let draw_args: Vec<u32> = indices.iter().flat_map(|list| [list.len() as u32, 0, 0, 0, 0]).collect();
        let draws = gpu.buffer("plant draws", bytemuck::cast_slice(&draw_args), storage_usage | BufferUsages::INDIRECT);

        let bend = gpu.shader("bend", shaders::BEND);
        let compute_layout =
            maker.layout("bend", &[uniform(0), storage_rw(1), storage_rw(2), storage_rw(3), storage_compute(4), storage_rw(5)]);
        let buffers = [&plants, &sways, &drawn, &counters, &far_grids, &draws];
        let compute_group = bind(gpu, "bend", &compute_layout, &buffers.map(|buffer| buffer.as_entire_binding()));

        let list_layout = maker.layout("plant list", &[storage(0), storage(1), uniform(2), texture(3)]);
        let shapes = gpu.texture("blades", wgpu::TextureFormat::Rgba8Unorm, paint::BLADE_PX, &paint::blades());
        let shapes = shapes.create_view(&Default::default());
        let mut first = 0;
        let lists = std::array::from_fn(|list| {
            let range = [first, capacities[list], segments.get(list).copied().unwrap_or(0), list as u32];
            first += capacities[list];
            let range = gpu.buffer("list", bytemuck::bytes_of(&range), BufferUsages::UNIFORM);
            let [drawn, counters, range] = [&drawn, &counters, &range].map(|buffer| buffer.as_entire_binding());
            bind(gpu, "plant list", &list_layout, &[drawn, counters, range, wgpu::BindingResource::TextureView(&shapes)])
        });
        let draw = |label| Draw { label, vertex: "vs", fragment: Some("fs"), buffers: &[], depth_write: true, cull: None, blend: None };
        let strips = maker.draw(&gpu.shader("blades", shaders::BLADES), Some(&list_layout), &draw("blades"));
        let heads = maker.draw(&gpu.shader("flowers", shaders::FLOWERS), Some(&list_layout), &draw("flowers"));
        let compute = |entry| maker.compute(entry, &bend, entry, &compute_layout);
        Self {
            near: compute("bend_near"),
            far: compute("bend_far"),
            finish: compute("finish"),
            strips,
            heads,
            plants,
            #[cfg(test)]
            sways,
            counters,
            far_grids,
            draws,
            compute_group,
            lists,
            indices: indices.map(|list| gpu.buffer("plant", bytemuck::cast_slice(&list), BufferUsages::INDEX)),
            grid_m,
            rings,
            near_plants,
            far_plants,
            flower_share,
            capacities,
            segments,
            longest_step_secs: land.scene().blade_step_secs(),
            slots: [None; 9],
            far_count: 0,
        }
    }

    /// Plants whose posture is simulated.
    pub(super) fn simulated(&self) -> u32 {
        self.near_plants * 9
    }

    /// Distance (m) that single plants reach at least.
    pub(super) fn reach_m(&self) -> f32 {
        (self.rings + 1) as f32 * self.grid_m
    }

    pub(super) fn prepare(&mut self, gpu: &Gpu, quality: Quality, land: &Land, eye_m: Vec3, frustum: &Frustum, dt_secs: f32) {
        let home = [eye_m.x, eye_m.z].map(|m| (m / self.grid_m).floor() as i32);
        let mut slots = [[0; 4]; 9];
        for dz in -1..=1 {
            for dx in -1..=1 {
                let grid = [home[0] + dx, home[1] + dz];
                let slot = (grid[0].rem_euclid(3) + 3 * grid[1].rem_euclid(3)) as usize;
                let is_new = self.slots[slot] != Some(grid);
                self.slots[slot] = Some(grid);
                slots[slot] = [grid[0], grid[1], i32::from(is_new), 0];
            }
        }
        let reach = self.rings + 1;
        let mut far = Vec::new();
        for dz in -reach..=reach {
            for dx in -reach..=reach {
                let grid = [home[0] + dx, home[1] + dz];
                if (dx.abs() > 1 || dz.abs() > 1) && grid_is_seen(land, grid, self.grid_m, frustum) {
                    far.push([grid[0], grid[1], 0, 0]);
                }
            }
        }
        self.far_count = far.len() as u32;
        let looks = &land.scene().plants;
        let (steps, step_secs) = steps(self.longest_step_secs, dt_secs);
        let plants = Plants {
            slots,
            counts: [self.near_plants, 0, self.far_count, self.far_plants],
            capacities: [self.capacities[0], self.capacities[1], self.capacities[2], 0],
            shape: [self.grid_m, full_density_m(quality), fine_m(quality), looks.swing_damping],
            steps: [steps, looks.integrator as u32, self.segments[0], self.segments[1]],
            time: [step_secs, self.flower_share, 0.0, 0.0],
        };
        gpu.queue.write_buffer(&self.plants, 0, bytemuck::bytes_of(&plants));
        gpu.queue.write_buffer(&self.counters, 0, &[0; 16]);
        gpu.queue.write_buffer(&self.far_grids, 0, bytemuck::cast_slice(&far));
    }

    pub(super) fn bend(&self, pass: &mut wgpu::ComputePass<'_>) {
        pass.set_bind_group(1, &self.compute_group, &[]);
        pass.set_pipeline(&self.near);
        pass.dispatch_workgroups(self.near_plants.div_ceil(CHUNK), 9, 1);
        if self.far_count > 0 {
            pass.set_pipeline(&self.far);
            pass.dispatch_workgroups(self.far_plants.div_ceil(CHUNK), self.far_count, 1);
        }
        pass.set_pipeline(&self.finish);
        pass.dispatch_workgroups(1, 1, 1);
    }

    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        for (list, group) in self.lists.iter().enumerate() {
            pass.set_pipeline(if list < 2 { &self.strips } else { &self.heads });
            pass.set_bind_group(1, group, &[]);
            pass.set_index_buffer(self.indices[list].slice(..), wgpu::IndexFormat::Uint16);
            pass.draw_indexed_indirect(&self.draws, list as u64 * 20);
        }
    }
}

/// How many steps a frame of `dt_secs` takes, and how long each is (s), where blades bear one of `longest_secs`.
fn steps(longest_secs: f32, dt_secs: f32) -> (u32, f32) {
    let dt_secs = dt_secs.max(0.0);
    if longest_secs == f32::INFINITY {
        return (u32::from(dt_secs > 0.0), dt_secs.min(EXACT_STEP_SECS));
    }
    let count = (dt_secs / longest_secs).ceil().min(STEP_LIMIT);
    (count as u32, (dt_secs / count.max(1.0)).min(longest_secs))
}

/// Area (m²) at full density that holds as many plants as stand within a distance; twin of `density` in `bend.wgsl`.
fn full_area_m2(full_m: f32, within_m: f32) -> f32 {
    let inner_m = full_m.min(within_m);
    PI * inner_m * inner_m + TAU / 0.75 * full_m.powf(1.25) * (within_m.powf(0.75) - inner_m.powf(0.75))
}

/// Most plants that stand where `mean` do on the average, each by a lot of its own: six standard deviations more.
fn most_standing(mean: f32) -> u32 {
    (mean + 6.0 * mean.sqrt() + 64.0) as u32
}

/// Whether any plant of a grid may be in view.
pub(super) fn grid_is_seen(land: &Land, grid: [i32; 2], grid_m: f32, frustum: &Frustum) -> bool {
    square_is_seen(land, grid.map(|n| n as f32 * grid_m), grid_m, frustum)
}

/// Whether any plant of a square from a corner on may be in view.
pub(super) fn square_is_seen(land: &Land, [x, z]: [f32; 2], side_m: f32, frustum: &Frustum) -> bool {
    let h = land.heights();
    let corners = [(0.0, 0.0), (0.5, 0.5), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)];
    let heights = corners.map(|(i, j)| h.height_m(x + i * side_m, z + j * side_m));
    let low = heights.iter().copied().fold(f32::MAX, f32::min) - 0.1 * side_m;
    let high = heights.iter().copied().fold(f32::MIN, f32::max) + 0.1 * side_m + 2.0 * land.scene().tallest_m();
    frustum.sees_box(Vec3::new(x - 0.5, low, z - 0.5), Vec3::new(x + side_m + 0.5, high, z + side_m + 0.5))
}

/// Distance up to which every plant stands (m).
fn full_density_m(quality: Quality) -> f32 {
    match quality {
        Quality::Low => 6.0,
        Quality::Medium => 5.0,
        Quality::High => 4.5,
        Quality::Ultra => 6.0,
    }
}

/// Distance up to which blades are fine (m).
fn fine_m(quality: Quality) -> f32 {
    match quality {
        Quality::Low => 2.5,
        Quality::Medium => 3.5,
        Quality::High => 5.0,
        Quality::Ultra => 8.0,
    }
}

fn storage_compute(binding: u32) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry { visibility: wgpu::ShaderStages::COMPUTE, ..storage(binding) }
}

/// Triangles of 64 blades of so many rectangles.
fn strip_indices(segments: u32) -> Vec<u16> {
    let mut indices = Vec::new();
    for blade in 0..CHUNK {
        for segment in 0..segments {
            let a = 2 * (blade * (segments + 1) + segment);
            indices.extend([a, a + 1, a + 2, a + 2, a + 1, a + 3].map(|i| i as u16));
        }
    }
    indices
}

/// Triangles of 64 flower heads: twelve petals of three triangles and a disc of six.
fn flower_indices() -> Vec<u16> {
    let mut indices = Vec::new();
    for head in 0..CHUNK {
        let first = head * FLOWER_VERTICES;
        for petal in 0..12 {
            let a = first + petal * 5;
            indices.extend([a, a + 1, a + 2, a + 1, a + 3, a + 2, a + 2, a + 3, a + 4].map(|i| i as u16));
        }
        let centre = first + 60;
        for i in 0..6 {
            indices.extend([centre, centre + 1 + i, centre + 1 + (i + 1) % 6].map(|i| i as u16));
        }
    }
    indices
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_take_the_steps_that_their_scheme_can_take() {
        let found = [0.0, 0.004, 1.0 / 60.0, 0.02, 1.0, -1.0].map(|dt_secs| steps(0.008, dt_secs));
        assert_eq!(found.map(|(count, _)| count), [0, 1, 3, 3, 32, 0]);
        assert!(found.iter().all(|&(_, step_secs)| step_secs <= 0.008));
        assert!((found[3].1 - 0.02 / 3.0).abs() < 1e-6);
        assert_eq!([0.0, 0.02, 5.0].map(|dt_secs| steps(f32::INFINITY, dt_secs)), [(0, 0.0), (1, 0.02), (1, EXACT_STEP_SECS)]);
    }

    #[test]
    fn a_textured_blade_is_of_rectangles_up_to_its_tip() {
        for segments in [3, 7] {
            let list = strip_indices(segments);
            assert_eq!(list.len() as u32, CHUNK * segments * 6);
            let tip = [2 * segments, 2 * segments + 1].map(|i| i as u16);
            assert!(tip.iter().all(|corner| list[..segments as usize * 6].contains(corner)));
        }
    }

    #[test]
    fn indices_stay_within_their_chunk() {
        for (list, vertices) in [(strip_indices(7), 16), (strip_indices(3), 8), (flower_indices(), FLOWER_VERTICES)] {
            let largest = u32::from(*list.iter().max().expect("indices"));
            assert_eq!(largest, CHUNK * vertices - 1);
        }
    }
}
