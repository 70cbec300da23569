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
use shared::scene::BladeIntegrator;
use wgpu::BufferUsages;

/// Plants in one instance of an indirect draw; twin of the constants in `blades.wgsl` and `flowers.wgsl`.
const CHUNK: u32 = 64;
/// Pairs of vertices below the tip, of a fine and of a coarse blade.
const ROWS: [u32; 2] = [7, 3];
/// Vertices of a flower head; twin of `VERTICES` in `flowers.wgsl`.
const FLOWER_VERTICES: u32 = 67;
/// Bytes of a drawn blade and of its sway, as in `common.wgsl` and `blade.wgsl`.
pub(super) const BLADE_BYTES: u64 = 64;
pub(super) const SWAY_BYTES: u64 = 48;
/// Longest step of the schemes that have a limit (s), and most of them in a frame; below 15 frames a second such blades move in slow motion.
const STEP_SECS: f32 = 1.0 / 120.0;
const STEP_LIMIT: f32 = 8.0;
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
    counters: wgpu::Buffer,
    far_grids: wgpu::Buffer,
    draws: wgpu::Buffer,
    compute_group: wgpu::BindGroup,
    lists: [wgpu::BindGroup; 3],
    indices: [wgpu::Buffer; 3],
    grid_m: f32,
    rings: i32,
    near_blades: u32,
    far_blades: u32,
    flowers: u32,
    capacities: [u32; 3],
    slots: [Option<[i32; 2]>; 9],
    far_count: u32,
}

impl Blades {
    pub(super) fn new(maker: &Maker<'_>, quality: Quality, land: &Land) -> Self {
        let gpu = maker.gpu;
        let scene_plants = &land.scene().plants;
        let grid_m = scene_plants.grid_m;
        // The quality counts on grids of 8 m; others get the same plants per area, within what the buffers hold.
        let per_grid = quality.blades_per_side().pow(2) as f32 * (grid_m / 8.0).powi(2);
        let near_blades = (per_grid as u32).clamp(64, 60_000);
        let flowers = ((scene_plants.flowers_per_m2 * grid_m * grid_m) as u32).min(near_blades / 3);
        let rings = quality.rings();
        let far_blades = (near_blades as f32 * full_density_m(quality) / grid_m * 1.1).min(near_blades as f32) as u32;
        let capacities = [near_blades.max(4096), near_blades * 9 / 2 + far_blades * 6, near_blades / 2 + 256];

        let storage_usage = BufferUsages::STORAGE;
        let plants = gpu.empty_buffer("plants", size_of::<Plants>() as u64, BufferUsages::UNIFORM | BufferUsages::COPY_DST);
        let sways = gpu.empty_buffer("sways", u64::from(near_blades) * 9 * SWAY_BYTES, storage_usage | BufferUsages::COPY_SRC);
        let drawn_count = capacities.iter().sum::<u32>();
        let drawn = gpu.empty_buffer("drawn plants", u64::from(drawn_count) * BLADE_BYTES, storage_usage);
        let counters = gpu.empty_buffer("counters", 16, storage_usage | BufferUsages::COPY_DST);
        let far_limit = ((2 * rings + 3) * (2 * rings + 3)) as u64;
        let far_grids = gpu.empty_buffer("far grids", far_limit * 16, storage_usage | BufferUsages::COPY_DST);
        let indices = [strip_indices(ROWS[0]), strip_indices(ROWS[1]), flower_indices()];
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
            let rows = ROWS.get(list).copied().unwrap_or(0);
            let range = [first, capacities[list], rows, list as u32];
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
            near_blades,
            far_blades,
            flowers,
            capacities,
            slots: [None; 9],
            far_count: 0,
        }
    }

    /// Plants whose posture is simulated.
    pub(super) fn simulated(&self) -> u32 {
        self.near_blades * 9
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
        let (steps, step_secs) = steps(looks.integrator, dt_secs);
        let plants = Plants {
            slots,
            counts: [self.near_blades, self.flowers, self.far_count, self.far_blades],
            capacities: [self.capacities[0], self.capacities[1], self.capacities[2], 0],
            shape: [self.grid_m, full_density_m(quality), fine_m(quality), looks.swing_damping],
            steps: [steps, looks.integrator as u32, 0, 0],
            time: [step_secs, 0.0, 0.0, 0.0],
        };
        gpu.queue.write_buffer(&self.plants, 0, bytemuck::bytes_of(&plants));
        gpu.queue.write_buffer(&self.counters, 0, &[0; 16]);
        gpu.queue.write_buffer(&self.far_grids, 0, bytemuck::cast_slice(&far));
    }

    pub(super) fn bend(&self, pass: &mut wgpu::ComputePass<'_>) {
        pass.set_bind_group(1, &self.compute_group, &[]);
        pass.set_pipeline(&self.near);
        pass.dispatch_workgroups(self.near_blades.div_ceil(CHUNK), 9, 1);
        if self.far_count > 0 {
            pass.set_pipeline(&self.far);
            pass.dispatch_workgroups(self.far_blades.div_ceil(CHUNK), self.far_count, 1);
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

/// How many steps a frame of `dt_secs` takes, and how long each is (s).
fn steps(integrator: BladeIntegrator, dt_secs: f32) -> (u32, f32) {
    let dt_secs = dt_secs.max(0.0);
    if integrator == BladeIntegrator::Exact {
        return (u32::from(dt_secs > 0.0), dt_secs.min(EXACT_STEP_SECS));
    }
    let count = (dt_secs / STEP_SECS - 1e-3).ceil().clamp(0.0, STEP_LIMIT);
    (count as u32, (dt_secs / count.max(1.0)).min(STEP_SECS))
}

/// Whether any plant of a grid may be in view.
pub(super) fn grid_is_seen(land: &Land, grid: [i32; 2], grid_m: f32, frustum: &Frustum) -> bool {
    let [x, z] = grid.map(|n| n as f32 * grid_m);
    let h = land.heights();
    let corners = [(0.0, 0.0), (0.5, 0.5), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)];
    let heights = corners.map(|(i, j)| h.height_m(x + i * grid_m, z + j * grid_m));
    let low = heights.iter().copied().fold(f32::MAX, f32::min) - 0.1 * grid_m;
    let high = heights.iter().copied().fold(f32::MIN, f32::max) + 0.1 * grid_m + 2.0 * land.scene().tallest_m();
    frustum.sees_box(Vec3::new(x - 0.5, low, z - 0.5), Vec3::new(x + grid_m + 0.5, high, z + grid_m + 0.5))
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

/// Triangles of 64 blades with `rows` pairs of vertices and a tip.
fn strip_indices(rows: u32) -> Vec<u16> {
    let vertices = rows * 2 + 1;
    let mut indices = Vec::new();
    for blade in 0..CHUNK {
        let first = blade * vertices;
        for row in 0..rows - 1 {
            let a = first + row * 2;
            indices.extend([a, a + 1, a + 2, a + 2, a + 1, a + 3].map(|i| i as u16));
        }
        let last = first + (rows - 1) * 2;
        indices.extend([last, last + 1, last + 2].map(|i| i as u16));
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
        let found = [0.0, 0.004, 1.0 / 60.0, 0.02, 1.0, -1.0].map(|dt_secs| steps(BladeIntegrator::Verlet, dt_secs));
        assert_eq!(found.map(|(count, _)| count), [0, 1, 2, 3, 8, 0]);
        assert!(found.iter().all(|&(_, step_secs)| step_secs <= STEP_SECS));
        assert!((found[3].1 - 0.02 / 3.0).abs() < 1e-6);
        assert_eq!([0.0, 0.02, 5.0].map(|dt_secs| steps(BladeIntegrator::Exact, dt_secs)), [(0, 0.0), (1, 0.02), (1, EXACT_STEP_SECS)]);
    }

    #[test]
    fn indices_stay_within_their_chunk() {
        for (list, vertices) in [(strip_indices(7), 15), (strip_indices(3), 7), (flower_indices(), FLOWER_VERTICES)] {
            let largest = u32::from(*list.iter().max().expect("indices"));
            assert_eq!(largest, CHUNK * vertices - 1);
        }
    }
}
