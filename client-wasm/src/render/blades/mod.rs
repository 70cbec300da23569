//! Single plants: compute passes sift those that stand in view, bend and list them; indirect draws make strips of the blades, and the flower heads.
//! Nine grids about the camera keep their plants' postures; those of the grids beyond stand as the wind of the moment would have them.

mod grids;
mod horizon;
mod laid;
mod order;
mod sift;
mod strips;

use super::cull::Frustum;
use super::detail::{Detail, PLANTS_LIMIT, blades_of_grid};
use super::gpu::Gpu;
use super::kept::Kept;
use super::paint;
use super::pipeline::{ByLamps, BySpheres, Draw, Maker, bind, storage, storage_rw, texture, uniform};
use super::shaders;
use super::uniforms::{Plants, StripList};
use super::{Far, Look, Order, Quality};
use crate::state::Land;
use glam::Vec3;
use grids::Grids;
pub(super) use grids::{grid_is_seen, square_is_seen};
use laid::{Laid, Listed};
use shared::scene::{BLADE_STEPS_LIMIT, BladeShape};
use sift::Sift;
use std::f32::consts::{PI, TAU};
use strips::{disc_indices, head_indices, strip_indices};
use wgpu::BufferUsages;

/// Plants in one instance of an indirect draw; twin of the constants in `blades.wgsl` and `flowers.wgsl`.
const CHUNK: u32 = 64;
/// Bytes of a drawn blade and of its sway, as in `common.wgsl` and `blade.wgsl`.
pub(super) const BLADE_BYTES: u64 = 112;
pub(super) const SWAY_BYTES: u64 = 48;
/// Most steps in a frame, of an integrator that needs several: as many as a scene may ask for in 1/15 s. In longer frames its blades move in slow motion.
const STEP_LIMIT: f32 = 4.0 * BLADE_STEPS_LIMIT as f32;
/// Longest step of the exact one (s): wind and obstacles stay as they are for a step.
const EXACT_STEP_SECS: f32 = 0.1;
/// A flower's lot by its place in the sequence of its grid falls with this power, so that flowers thin out more slowly than blades do.
pub(super) const FLOWER_POWER: f32 = -0.8;
/// Most plants that are listed at once, as WebGPU lets a shader see 128 MiB of a buffer.
const LISTED_LIMIT: u32 = ((128 << 20) / BLADE_BYTES) as u32;
/// Most plants of a turn, and so of one list, where there would be more: then they are drawn by turns.
const TURN_LIMIT: u32 = LISTED_LIMIT / 3;
/// Share by which the distance up to which a blade is fine differs from one to another, up or down, so that no ring of them changes at once; twin of the
/// constant in `bend.wgsl`.
const FINE_SPREAD: f32 = 0.15;

/// Lists that are drawn: fine blades, coarse ones, those of one segment, near flower heads, far ones.
const LISTS: usize = 5;
const SINGLE: usize = 2;
const HEADS: [usize; 2] = [3, 4];
const STRIPS: usize = 3;
/// Bytes of an indirect draw.
const DRAW_BYTES: u64 = 20;

pub(super) struct Blades {
    sift: Sift,
    /// Of near plants, and of those beyond.
    bend: BySpheres<[wgpu::ComputePipeline; 2]>,
    finish: wgpu::ComputePipeline,
    pub(super) laid: Kept<Laid>,
    pub(super) listed: Listed,
    heads: ByLamps<[wgpu::RenderPipeline; 2]>,
    plants: wgpu::Buffer,
    #[cfg(test)]
    pub(super) sways: wgpu::Buffer,
    draws: wgpu::Buffer,
    compute_group: wgpu::BindGroup,
    lists: [wgpu::BindGroup; LISTS],
    /// Of blades that end broad, and of pointed ones.
    strips: [[wgpu::Buffer; STRIPS]; 2],
    head_indices: [wgpu::Buffer; 2],
    /// Whether `draws` is of pointed blades.
    are_pointed: bool,
    grids: Grids,
    by_turns: bool,
    /// Whether blades fade into what stands for far plants.
    fades: bool,
    /// Plants of each near grid.
    places: u32,
    /// Near plants that may stand in this frame.
    standing: u32,
    near_workgroups: u32,
    /// Whether a grid has moved into a slot in this turn.
    any_moves_in: bool,
    /// Number of the newest frame, of those in which time passes or a grid moves in.
    frame: u32,
    /// Most blades drawn fine, most of all others, and most flower heads.
    pub(super) capacities: [u32; 3],
    thinnest_px: f32,
    /// Longest step that every blade bears (s).
    longest_step_secs: f32,
    /// Grid of each slot, and the number of the frame in which it has moved in.
    slots: [([i32; 2], u32); 9],
    /// Lot of the first plant of a grid to be a flower.
    first_flower: f32,
}

/// What a frame's plants depend on besides the land.
pub(super) struct Standpoint<'a> {
    pub(super) eye_m: Vec3,
    pub(super) frustum: &'a Frustum,
    pub(super) detail: &'a Detail,
    pub(super) look: Look,
    pub(super) dt_secs: f32,
}

impl Blades {
    pub(super) fn new(maker: &Maker<'_>, quality: Quality, land: &Land) -> Self {
        let gpu = maker.gpu;
        let detail = quality.detail().on(&land.scene().plants);
        let grid_m = land.scene().plants.grid_m;
        let places = plants_of_grid(land);
        let plants_per_m2 = places as f32 / (grid_m * grid_m);
        let stand = |within_m: f32| plants_per_m2 * full_area_m2(detail.full_m, within_m);
        let all = stand(detail.blades_m);
        let [surely_fine_m, fine_m] = [1.0 - FINE_SPREAD, 1.0 + FINE_SPREAD].map(|share| (share * detail.fine_m).min(detail.blades_m));
        let flowers_per_m2 = land.scene().plants.flowers_per_m2;
        let thinned = full_area_m2(detail.heads_m, detail.blades_m);
        let wanted = [stand(fine_m), all - stand(surely_fine_m), flowers_per_m2 * thinned].map(most_standing);
        let by_turns = wanted.iter().map(|&count| u64::from(count)).sum::<u64>() > u64::from(LISTED_LIMIT);
        let capacities = if by_turns { wanted.map(|count| count.min(TURN_LIMIT)) } else { wanted };
        let grids = Grids::new(maker, land, &detail, places, by_turns);
        let segments = quality.segments();

        let storage_usage = BufferUsages::STORAGE;
        let plants = gpu.empty_buffer("plants", size_of::<Plants>() as u64, BufferUsages::UNIFORM | BufferUsages::COPY_DST);
        let sways = gpu.empty_buffer("sways", u64::from(places) * 9 * SWAY_BYTES, storage_usage | BufferUsages::COPY_SRC);
        let moved = gpu.empty_buffer("moved", u64::from(places) * 9 * 4, storage_usage);
        let drawn_count = capacities.iter().sum::<u32>();
        let drawn = gpu.empty_buffer("drawn plants", u64::from(drawn_count) * BLADE_BYTES, storage_usage | BufferUsages::COPY_SRC);
        let counters = gpu.empty_buffer("counters", 4 * LISTS as u64, storage_usage | BufferUsages::COPY_DST | BufferUsages::COPY_SRC);
        let indices = |list: Vec<u16>| gpu.buffer("plant", bytemuck::cast_slice(&list), BufferUsages::INDEX);
        let [fine_segments, coarse_segments] = segments;
        let strips = [false, true]
            .map(|are_pointed| [fine_segments, coarse_segments, 1].map(|segments| indices(strip_indices(segments, are_pointed))));
        let head_indices = [head_indices(), disc_indices()].map(indices);
        let draw_args: Vec<u32> = strips[0].iter().chain(&head_indices).flat_map(|list| [index_count(list), 0, 0, 0, 0]).collect();
        let usage = storage_usage | BufferUsages::INDIRECT | BufferUsages::COPY_DST;
        let draws = gpu.buffer("plant draws", bytemuck::cast_slice(&draw_args), usage);

        let bend = maker.shader("bend", shaders::BEND, &[]);
        let sift = Sift::new(maker, &bend, &plants, &grids, places);
        let entries =
            [uniform(0), storage_rw(1), storage_rw(2), storage_rw(3), storage_compute(4), storage_rw(5), storage_compute(6), storage_rw(7)];
        let compute_layout = maker.layout("bend", &entries);
        let buffers = [&plants, &sways, &drawn, &counters, grids.chunks(), &draws, sift.standing(), &moved];
        let compute_group = bind(gpu, "bend", &compute_layout, &buffers.map(|buffer| buffer.as_entire_binding()));

        let list_layout = list_layout(maker);
        let shapes = gpu.texture("blades", wgpu::TextureFormat::Rgba8Unorm, paint::BLADE_PX, &paint::blades());
        let shapes = shapes.create_view(&Default::default());
        let [fine, others, heads] = capacities;
        // Blades of one segment fill the place of the coarse ones from its end, far heads that of the near ones.
        let of_list = [
            StripList { range: [0, fine, segments[0], 0], order: [1, 0, 0, 0] },
            StripList { range: [fine, others, segments[1], 1], order: [1, 0, 0, 0] },
            StripList { range: [fine + others - 1, others, 1, SINGLE as u32], order: [-1, 0, 0, 0] },
            StripList { range: [fine + others, heads, 0, HEADS[0] as u32], order: [1, 0, 0, 0] },
            StripList { range: [fine + others + heads - 1, heads, 0, HEADS[1] as u32], order: [-1, 0, 0, 0] },
        ];
        let lists = of_list.map(|list| {
            let list = gpu.buffer("list", bytemuck::bytes_of(&list), BufferUsages::UNIFORM);
            let [drawn, counters, list] = [&drawn, &counters, &list].map(|buffer| buffer.as_entire_binding());
            bind(gpu, "plant list", &list_layout, &[drawn, counters, list, wgpu::BindingResource::TextureView(&shapes)])
        });
        let heads = ByLamps::new(|lamps| {
            let flowers = maker.shader("flowers", shaders::FLOWERS, &[lamps]);
            ["vs", "vs_disc"].map(|vertex| {
                let draw = Draw { label: "flowers", vertex, ..Draw::default() };
                maker.draw(&flowers, Some(&list_layout), &draw)
            })
        });
        let are_textured = land.scene().plants.blade_shape == BladeShape::Textured;
        let listed = Listed { blades: drawn, counters, shapes, are_textured, capacities: [fine, others], segments, grid_m };
        let mut own = Self {
            sift,
            bend: BySpheres::new(|constants| {
                let bend = maker.shader("bend", shaders::BEND, &constants);
                ["bend_near", "bend_far"].map(|entry| maker.compute(entry, &bend, entry, &compute_layout))
            }),
            finish: maker.compute("finish", &bend, "finish", &compute_layout),
            laid: Kept::new(Order::default(), Laid::new(maker, Order::default(), &listed)),
            listed,
            heads,
            plants,
            #[cfg(test)]
            sways,
            draws,
            compute_group,
            lists,
            strips,
            head_indices,
            are_pointed: false,
            grids,
            by_turns,
            fades: false,
            places,
            standing: 0,
            near_workgroups: 0,
            any_moves_in: false,
            frame: 0,
            capacities,
            thinnest_px: quality.thinnest_px(),
            longest_step_secs: land.scene().blade_step_secs(),
            slots: [([i32::MIN; 2], 0); 9],
            first_flower: flower_lot(flowers_per_m2 * grid_m * grid_m, places),
        };
        own.set_order(maker, Order::default());
        own
    }

    /// Lays blades in another order from now on.
    pub(super) fn set_order(&mut self, maker: &Maker<'_>, order: Order) {
        self.laid.set(order, || Laid::new(maker, order, &self.listed));
        let are_pointed = self.listed.are_pointed(order);
        if are_pointed != self.are_pointed {
            self.are_pointed = are_pointed;
            for (list, indices) in self.strips[usize::from(are_pointed)].iter().enumerate() {
                maker.gpu.queue.write_buffer(&self.draws, DRAW_BYTES * list as u64, bytemuck::bytes_of(&index_count(indices)));
            }
        }
    }

    /// Whether a frame may need several turns.
    pub(super) fn by_turns(&self) -> bool {
        self.by_turns
    }

    /// Near plants of the newest frame, of which those in view are moved.
    pub(super) fn standing(&self) -> u32 {
        self.standing
    }

    pub(super) fn prepare(&mut self, gpu: &Gpu, land: &Land, from: &Standpoint<'_>) {
        let detail = from.detail;
        self.fades = from.look.far != Far::Land;
        let home = [from.eye_m.x, from.eye_m.z].map(|m| (m / self.listed.grid_m).floor() as i32);
        let mut slots = [[0; 4]; 9];
        let mut most = 0;
        self.standing = 0;
        let slot_of = |grid: [i32; 2]| (grid[0].rem_euclid(3) + 3 * grid[1].rem_euclid(3)) as usize;
        let about = || (-1..=1).flat_map(|dz| (-1..=1).map(move |dx| [home[0] + dx, home[1] + dz]));
        self.any_moves_in = about().any(|grid| self.slots[slot_of(grid)].0 != grid);
        self.frame = self.frame.wrapping_add(u32::from(from.dt_secs > 0.0 || self.any_moves_in));
        for grid in about() {
            let slot = slot_of(grid);
            if self.slots[slot].0 != grid {
                self.slots[slot] = (grid, self.frame);
            }
            let bounds = grids::bounds_m(land, grid, self.listed.grid_m);
            let distance_m = from.eye_m.distance(from.eye_m.clamp(bounds[0], bounds[1]));
            let is_seen = !from.look.culls || from.frustum.sees_box(bounds[0], bounds[1]);
            let stands = if is_seen { (self.places as f32 * density(distance_m, detail.full_m)).ceil() as u32 } else { 0 };
            self.standing += stands;
            most = most.max(stands);
            slots[slot] = [grid[0], grid[1], self.slots[slot].1 as i32, stands as i32];
        }
        self.near_workgroups = most.div_ceil(CHUNK);
        let looks = &land.scene().plants;
        let (steps, step_secs) = steps(self.longest_step_secs, from.dt_secs);
        let plants = Plants {
            slots,
            counts: [
                self.places,
                u32::from(from.look.culls),
                u32::from(!matches!(self.laid.order(), Order::Cut | Order::Weighted)),
                self.frame,
            ],
            capacities: [self.capacities[0], self.capacities[1], self.capacities[2], 0],
            shape: [self.listed.grid_m, detail.full_m, detail.fine_m, looks.swing_damping],
            steps: [steps, looks.integrator as u32, self.listed.segments[0], self.listed.segments[1]],
            time: [step_secs, self.first_flower, FLOWER_POWER, self.thinnest_px],
            reach: [self.grids.beyond_m, detail.heads_m, f32::from(u8::from(!self.fades)), 0.0],
        };
        gpu.queue.write_buffer(&self.plants, 0, bytemuck::bytes_of(&plants));
        if let Some(ordered) = self.laid.get().ordered() {
            ordered.prepare(gpu, home);
        }
        self.grids.prepare(from, home, self.places);
    }

    /// Turns in which a frame's plants are listed and drawn: one, but where all of them are.
    pub(super) fn turns(&self) -> u32 {
        self.grids.turns()
    }

    /// How many plants stand in view, near ones and others, and the lists of both.
    #[cfg(not(target_arch = "wasm32"))]
    pub(super) fn in_view(&self) -> &wgpu::Buffer {
        self.sift.standing()
    }

    /// Lists the plants of this turn from now on.
    pub(super) fn begin_turn(&mut self, gpu: &Gpu, turn: u32) {
        if turn > 0 {
            self.near_workgroups = 0;
            self.any_moves_in = false;
        }
        gpu.queue.write_buffer(&self.listed.counters, 0, &[0; 4 * LISTS]);
        self.sift.begin_turn(gpu);
        self.grids.begin_turn(gpu, turn);
    }

    pub(super) fn bend(&self, pass: &mut wgpu::ComputePass<'_>, has_spheres: bool, has_lamps: bool) {
        self.grids.list(pass);
        if self.any_moves_in {
            self.sift.find_ground(pass, self.places.div_ceil(CHUNK));
        }
        self.sift.run(pass, self.near_workgroups, self.grids.workgroups());
        pass.set_bind_group(1, &self.compute_group, &[]);
        for (list, bend) in self.bend.of(has_spheres, has_lamps).iter().enumerate() {
            pass.set_pipeline(bend);
            pass.dispatch_workgroups_indirect(self.sift.workgroups(), 12 * list as u64);
        }
        pass.set_pipeline(&self.finish);
        pass.dispatch_workgroups(1, 1, 1);
        if let Some(ordered) = self.laid.get().ordered() {
            ordered.run(pass);
        }
    }

    /// Draws the blades in the order that is set.
    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, has_lamps: bool) {
        let strips = &self.strips[usize::from(self.are_pointed)];
        self.laid.get().draw(pass, self.fades, has_lamps, |pass| {
            strips.iter().enumerate().for_each(|(list, indices)| self.draw_list(pass, list, indices));
        });
    }

    pub(super) fn draw_flowers(&self, pass: &mut wgpu::RenderPass<'_>, has_lamps: bool) {
        for ((heads, list), indices) in self.heads.of(has_lamps).iter().zip(HEADS).zip(&self.head_indices) {
            pass.set_pipeline(heads);
            self.draw_list(pass, list, indices);
        }
    }

    fn draw_list(&self, pass: &mut wgpu::RenderPass<'_>, list: usize, indices: &wgpu::Buffer) {
        pass.set_bind_group(1, &self.lists[list], &[]);
        pass.set_index_buffer(indices.slice(..), wgpu::IndexFormat::Uint16);
        pass.draw_indexed_indirect(&self.draws, DRAW_BYTES * list as u64);
    }
}

/// How many indices a buffer of them has.
fn index_count(indices: &wgpu::Buffer) -> u32 {
    (indices.size() / size_of::<u16>() as u64) as u32
}

/// Bindings of a list of blades or flowers.
fn list_layout(maker: &Maker<'_>) -> wgpu::BindGroupLayout {
    maker.layout("plant list", &[storage(0), storage(1), uniform(2), texture(3)])
}

/// Plants of a grid near the camera, blades and flowers.
fn plants_of_grid(land: &Land) -> u32 {
    let plants = &land.scene().plants;
    let flowers = plants.flowers_per_m2 * plants.grid_m * plants.grid_m;
    (blades_of_grid(plants.plants_per_side) + flowers).round().min(PLANTS_LIMIT) as u32
}

/// Share of plants that stand at a distance; twin of `density` in `common.wgsl`.
fn density(distance_m: f32, full_m: f32) -> f32 {
    (full_m / distance_m.max(0.01)).powi(2).min(1.0)
}

/// Factor c such that of `plants` with lots min(1, c·(i + 1)^[`FLOWER_POWER`]) as many as `flowers` are flowers on the average.
pub(super) fn flower_lot(flowers: f32, plants: u32) -> f32 {
    /// Lots that are summed one by one; of the others, which differ little from one to the next, the integral.
    const FIRST: u32 = 64;
    let expected = |factor: f32| {
        let lot = |i: u32| (factor * (i as f32 + 1.0).powf(FLOWER_POWER)).min(1.0);
        let sure = factor.powf(-1.0 / FLOWER_POWER).clamp(FIRST.min(plants) as f32, plants as f32);
        let power = FLOWER_POWER + 1.0;
        let rest = factor / power * ((plants as f32 + 0.5).powf(power) - (sure + 0.5).powf(power));
        (0..FIRST.min(plants)).map(lot).sum::<f32>() + (sure - FIRST.min(plants) as f32) + rest.max(0.0)
    };
    let (mut low, mut high) = (0.0_f32, plants as f32 + 1.0);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if expected(middle) < flowers { low = middle } else { high = middle }
    }
    low
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

/// Area (m²) at full density that holds as many plants as stand within a distance.
fn full_area_m2(full_m: f32, within_m: f32) -> f32 {
    let inner_m = full_m.min(within_m);
    PI * inner_m * inner_m + TAU * full_m * full_m * (within_m / inner_m).ln()
}

/// Most plants that stand where `mean` do on the average, each by a lot of its own: six standard deviations more.
fn most_standing(mean: f32) -> u32 {
    (mean + 6.0 * mean.sqrt() + 64.0) as u32
}

fn storage_compute(binding: u32) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry { visibility: wgpu::ShaderStages::COMPUTE, ..storage(binding) }
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
    fn lots_of_flowers_sum_to_as_many_as_there_are() {
        for (flowers, plants) in [(38.4, 1062), (38.4, 25_638), (3200.0, 4000), (1.2, 400)] {
            let factor = flower_lot(flowers, plants);
            let sum: f32 = (0..plants).map(|i| (factor * (i as f32 + 1.0).powf(FLOWER_POWER)).min(1.0)).sum();
            assert!((sum / flowers - 1.0).abs() < 0.02, "{sum} of {flowers}");
        }
        assert_eq!(flower_lot(0.0, 1000), 0.0);
    }

    #[test]
    fn a_disc_holds_the_area_that_its_density_sums_to() {
        let (full_m, within_m) = (8.0, 100.0);
        let rings = 200_000;
        let step_m = within_m / rings as f32;
        let sum: f64 = (0..rings).map(|i| (i as f32 + 0.5) * step_m).map(|r_m| f64::from(TAU * r_m * step_m * density(r_m, full_m))).sum();
        assert!((sum / f64::from(full_area_m2(full_m, within_m)) - 1.0).abs() < 1e-3);
    }
}
