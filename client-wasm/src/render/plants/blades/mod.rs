//! Single plants: compute passes cull, bend and list them; indirect draws render blades as strips, and flower heads.
//! Plants of the nine grids around the camera are simulated; those of farther grids take the equilibrium posture in the current wind.

mod buffers;
mod culling;
mod far_grids;
mod flower_texture;
mod layout;
mod shape_texture;
mod sort;
mod strip_pipelines;
mod strips;

use crate::render::gpu::constants::{DRAW_WORDS, FINE_SPREAD};
use crate::render::gpu::device::Gpu;
use crate::render::gpu::pipeline::{DrawDescriptor, PassFactory, storage_rw, uniform};
use crate::render::gpu::shaders;
use crate::render::gpu::uniforms::{GridSlot, Plants};
use crate::render::gpu::variants::{LampVariants, SphereVariants};
use crate::render::inputs::viewpoint::Viewpoint;
use crate::render::options::detail::{Detail, PLANTS_LIMIT, blades_per_grid};
use crate::render::options::quality::Quality;
use crate::render::options::render_options::{BlendOrder, FarPlants};
use crate::render::plants::force_field::CameraForceField;
use crate::render::plants::per_blend_order::PerBlendOrder;
use crate::state::DecodedScene;
use buffers::{BladeBuffers, InstanceIndices};
use bytemuck::Zeroable;
use culling::PlantCulling;
use far_grids::FarGrids;
pub(crate) use far_grids::{grid_is_seen, square_is_seen};
use layout::{BATCH_LIMIT, CHUNK, HEADS, LISTED_LIMIT, LISTS, NEAR_SLOTS, density, index_count, list_layout, storage_compute};
#[cfg(test)]
pub(crate) use layout::{BLADE_BYTES, SWAY_BYTES};
use prairie_core::scene::{BLADE_STEPS_LIMIT, BladeShape, FlowerShape, Plants as PlantSettings};
use std::f32::consts::{PI, TAU};
use strip_pipelines::{BladeDrawList, StripPipelines};

/// Maximum number of steps per frame of an integrator with a stability limit: as many as a scene may need in 1/15 s. In longer frames blades move in slow motion.
const STEP_LIMIT: f32 = 4.0 * BLADE_STEPS_LIMIT as f32;
/// Longest step of the exact integrator (s): wind and obstacles are constant during a step.
const EXACT_STEP_SECS: f32 = 0.1;
/// Exponent of the probability of a flower along the sequence of a grid's plants: with it flowers thin out more slowly than blades.
pub(crate) const FLOWER_POWER: f32 = -0.8;

/// Bytes of an indirect draw.
const DRAW_BYTES: u64 = 4 * DRAW_WORDS as u64;
pub(crate) struct Blades {
    culling: PlantCulling,
    /// Pipelines for near plants, and for those beyond.
    bend: SphereVariants<[wgpu::ComputePipeline; 2]>,
    finish: wgpu::ComputePipeline,
    pub(crate) strip_pipelines: PerBlendOrder<StripPipelines>,
    pub(crate) listed: BladeDrawList,
    heads: LampVariants<[wgpu::RenderPipeline; 2]>,
    uniforms: wgpu::Buffer,
    #[cfg(test)]
    pub(crate) sways: wgpu::Buffer,
    draws: wgpu::Buffer,
    compute_group: wgpu::BindGroup,
    lists: [wgpu::BindGroup; LISTS],
    indices: InstanceIndices,
    /// Whether `draws` is set up for pointed blades.
    are_pointed: bool,
    grids: FarGrids,
    by_batches: bool,
    /// Whether blades fade into clumps or shells.
    fades: bool,
    /// Plants of each near grid.
    places: u32,
    /// Near plants in the newest frame, before culling.
    near_plants: u32,
    near_workgroups: u32,
    /// Grids of the newest frame whose plants are simulated, and whether they may be in view.
    near_grids: [([i32; 2], bool); NEAR_SLOTS],
    /// Whether a grid has moved into a slot in this batch.
    any_moves_in: bool,
    /// Number of the newest frame; counts frames in which time advances or a grid moves in.
    frame: u32,
    /// Capacities of the lists of fine blades, of other blades, and of flower heads.
    pub(crate) capacities: [u32; 3],
    min_blade_px: f32,
    /// Stability limit of the integrator (s).
    longest_step_secs: f32,
    /// Grid of each slot, and the number of the frame in which it moved in.
    slots: [([i32; 2], u32); NEAR_SLOTS],
    /// Probability that the first plant of a grid is a flower.
    first_flower: f32,
}

impl Blades {
    pub(crate) fn new(factory: &PassFactory, quality: Quality, decoded: &DecodedScene, forces: &CameraForceField) -> Self {
        let gpu = &factory.gpu;
        let plants = &decoded.scene().plants;
        let (detail, grid_m, places) = (quality.detail().on(plants), plants.grid_m, plants_per_grid(decoded));
        let (capacities, by_batches) = list_capacities(plants, &detail, places);
        let grids = FarGrids::new(factory, decoded, quality, places, by_batches);
        let segments = segments_of(plants, quality);
        let buffers = BladeBuffers::new(gpu, places, capacities);
        let indices = InstanceIndices::new(gpu, segments, plants.flower_shape);
        let bend = factory.shader("bend", shaders::BEND, &[]);
        let culling = PlantCulling::new(factory, &bend, &buffers.plants, &grids, places);
        let draws = indices.draws(gpu);
        let compute_layout = compute_layout(factory);
        let compute_group = buffers.compute_group(gpu, &compute_layout, [grids.chunks(), &draws, culling.standing()], forces);
        let shapes = gpu.texture("blades", wgpu::TextureFormat::Rgba8Unorm, shape_texture::BLADE_PX, &shape_texture::blade_shapes());
        let shapes = shapes.create_view(&Default::default());
        let flowers = flower_squares(gpu, plants.flower_shape);
        let lists = buffers.list_groups(factory, capacities, segments, [&shapes, flowers.as_ref().unwrap_or(&shapes)]);
        let listed = BladeDrawList {
            blades: buffers.drawn,
            counters: buffers.counters,
            shapes,
            are_textured: plants.blade_shape == BladeShape::Textured,
            capacities: [capacities[0], capacities[1]],
            segments,
            grid_m,
        };
        let mut own = Self {
            culling,
            bend: bend_pipelines(factory, &compute_layout),
            finish: factory.compute("finish", &bend, "finish", &compute_layout),
            strip_pipelines: PerBlendOrder::new(BlendOrder::default(), StripPipelines::new(factory, BlendOrder::default(), &listed)),
            listed,
            heads: head_pipelines(factory, plants.flower_shape),
            uniforms: buffers.plants,
            #[cfg(test)]
            sways: buffers.sways,
            draws,
            compute_group,
            lists,
            indices,
            are_pointed: false,
            grids,
            by_batches,
            fades: false,
            places,
            near_plants: 0,
            near_workgroups: 0,
            near_grids: [([i32::MIN; 2], false); NEAR_SLOTS],
            any_moves_in: false,
            frame: 0,
            capacities,
            min_blade_px: quality.min_blade_px(),
            longest_step_secs: decoded.scene().blade_step_secs(),
            slots: [([i32::MIN; 2], 0); NEAR_SLOTS],
            first_flower: flower_probability(plants.flowers_per_m2 * grid_m * grid_m, places),
        };
        own.set_order(factory, BlendOrder::default());
        own
    }

    /// Sets the blend order of the following frames.
    pub(crate) fn set_order(&mut self, factory: &PassFactory, order: BlendOrder) {
        self.strip_pipelines.set(order, || StripPipelines::new(factory, order, &self.listed));
        let are_pointed = self.listed.are_pointed(order);
        if are_pointed != self.are_pointed {
            self.are_pointed = are_pointed;
            for (list, indices) in self.indices.strips[usize::from(are_pointed)].iter().enumerate() {
                factory.gpu.queue.write_buffer(&self.draws, DRAW_BYTES * list as u64, bytemuck::bytes_of(&index_count(indices)));
            }
        }
    }

    /// Whether a frame may need several batches.
    pub(crate) fn by_batches(&self) -> bool {
        self.by_batches
    }

    /// Near plants of the newest frame; those in view are simulated.
    pub(crate) fn near_plants(&self) -> u32 {
        self.near_plants
    }

    /// Grids whose plants are simulated, and whether they may be in view.
    pub(crate) fn near_grids(&self) -> &[([i32; 2], bool)] {
        &self.near_grids
    }

    /// Grids beyond whose plants the newest batch lists.
    #[cfg(test)]
    pub(crate) fn listed_grids(&self, gpu: &Gpu) -> std::collections::BTreeSet<[i32; 2]> {
        self.grids.listed(gpu)
    }

    /// States of the grids beyond, as `GRID_SHOWN`, of a square of grids: its first one, and the number along its side.
    pub(crate) fn far_grids(&self) -> (&wgpu::Buffer, [i32; 2], i32) {
        let (first, side) = self.grids.square();
        (self.grids.states(), first, side)
    }

    pub(crate) fn prepare(&mut self, gpu: &Gpu, decoded: &DecodedScene, from: &Viewpoint<'_>) {
        let detail = from.detail;
        self.fades = from.options.far_plants != FarPlants::Land;
        let home = [from.eye_m.x, from.eye_m.z].map(|m| (m / self.listed.grid_m).floor() as i32);
        let mut slots = [GridSlot::zeroed(); NEAR_SLOTS];
        let mut most = 0;
        self.near_plants = 0;
        let slot_of = |grid: [i32; 2]| (grid[0].rem_euclid(3) + 3 * grid[1].rem_euclid(3)) as usize;
        let about = || (-1..=1).flat_map(|dz| (-1..=1).map(move |dx| [home[0] + dx, home[1] + dz]));
        self.any_moves_in = about().any(|grid| self.slots[slot_of(grid)].0 != grid);
        self.frame = self.frame.wrapping_add(u32::from(from.dt_secs > 0.0 || self.any_moves_in));
        for grid in about() {
            let slot = slot_of(grid);
            if self.slots[slot].0 != grid {
                self.slots[slot] = (grid, self.frame);
            }
            let bounds = far_grids::bounds_m(decoded, grid, self.listed.grid_m);
            let distance_m = from.eye_m.distance(from.eye_m.clamp(bounds[0], bounds[1]));
            let is_seen = !from.options.culls || from.frustum.sees_box(bounds[0], bounds[1]);
            let stands = if is_seen { (self.places as f32 * density(distance_m, detail.full_m)).ceil() as u32 } else { 0 };
            self.near_plants += stands;
            most = most.max(stands);
            slots[slot] = GridSlot { grid, moved_in: self.slots[slot].1, plants: stands };
            self.near_grids[slot] = (grid, is_seen);
        }
        self.near_workgroups = most.div_ceil(CHUNK);
        let settings = &decoded.scene().plants;
        let (step_count, step_secs) = steps(self.longest_step_secs, from.dt_secs);
        let plants = Plants {
            slots,
            grid_plants: self.places,
            culls: u32::from(from.options.culls),
            is_ordered: u32::from(!matches!(self.strip_pipelines.order(), BlendOrder::Cut | BlendOrder::Weighted)),
            frame_number: self.frame,
            fine_capacity: self.capacities[0],
            other_capacity: self.capacities[1],
            head_capacity: self.capacities[2],
            step_count,
            integrator: settings.integrator as u32,
            fine_segments: self.listed.segments[0],
            coarse_segments: self.listed.segments[1],
            grid_m: self.listed.grid_m,
            full_density_m: detail.full_m,
            fine_m: detail.fine_m,
            damping_ratio: settings.swing_damping,
            step_secs,
            first_flower: self.first_flower,
            flower_power: FLOWER_POWER,
            thinnest_px: self.min_blade_px,
            plant_reach_m: self.grids.beyond_m,
            heads_thin_m: detail.heads_m,
            shrinks: f32::from(u8::from(!self.fades)),
            _pad: [0; 8],
        };
        gpu.queue.write_buffer(&self.uniforms, 0, bytemuck::bytes_of(&plants));
        if let Some(ordered) = self.strip_pipelines.get().ordered() {
            ordered.prepare(gpu, home);
        }
        self.grids.prepare(from, home, self.places);
    }

    /// Batches in which plants are listed and drawn: one, except at reference quality.
    pub(crate) fn batches(&self) -> u32 {
        self.grids.batches()
    }

    /// Numbers of the near and of the far plants in view, followed by both lists.
    #[cfg(not(target_arch = "wasm32"))]
    pub(crate) fn in_view(&self) -> &wgpu::Buffer {
        self.culling.standing()
    }

    /// Selects the plants of a batch.
    pub(crate) fn begin_batch(&mut self, gpu: &Gpu, batch: u32) {
        if batch > 0 {
            self.near_workgroups = 0;
            self.any_moves_in = false;
        }
        gpu.queue.write_buffer(&self.listed.counters, 0, &[0; 4 * LISTS]);
        self.culling.begin_batch(gpu);
        self.grids.begin_batch(gpu, batch);
    }

    /// Lists and bends the plants in view; if `occludes`, without those that the depth pyramid hides.
    pub(crate) fn bend(&self, pass: &mut wgpu::ComputePass<'_>, [has_spheres, has_lamps, occludes]: [bool; 3]) {
        self.grids.list(pass, occludes);
        if self.any_moves_in {
            self.culling.find_ground(pass, self.places.div_ceil(CHUNK));
        }
        self.culling.run(pass, self.near_workgroups, self.grids.workgroups(), occludes);
        pass.set_bind_group(1, &self.compute_group, &[]);
        for (list, bend) in self.bend.of(has_spheres, has_lamps).iter().enumerate() {
            pass.set_pipeline(bend);
            pass.dispatch_workgroups_indirect(self.culling.workgroups(), 12 * list as u64);
        }
        pass.set_pipeline(&self.finish);
        pass.dispatch_workgroups(1, 1, 1);
        if let Some(ordered) = self.strip_pipelines.get().ordered() {
            ordered.run(pass);
        }
    }

    /// Creates a variant of a pipeline that no frame has needed yet. Returns false if there is none.
    pub(crate) fn create_next(&self) -> bool {
        self.bend.create_next()
            || self.grids.create_next()
            || self.culling.create_next()
            || self.strip_pipelines.get().create_next(self.fades)
            || self.heads.create_next()
    }

    /// Draws the blades in the current blend order.
    pub(crate) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, has_lamps: bool) {
        let strips = &self.indices.strips[usize::from(self.are_pointed)];
        self.strip_pipelines.get().draw(pass, self.fades, has_lamps, |pass| {
            strips.iter().enumerate().for_each(|(list, indices)| self.draw_list(pass, list, indices));
        });
    }

    pub(crate) fn draw_flowers(&self, pass: &mut wgpu::RenderPass<'_>, has_lamps: bool) {
        for ((heads, list), indices) in self.heads.of(has_lamps).iter().zip(HEADS).zip(&self.indices.heads) {
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

/// Capacities of the lists of fine blades, of other blades and of flower heads, and whether plants must be drawn in batches.
fn list_capacities(plants: &PlantSettings, detail: &Detail, places: u32) -> ([u32; 3], bool) {
    let plants_per_m2 = places as f32 / (plants.grid_m * plants.grid_m);
    let within = |reach_m: f32| plants_per_m2 * full_area_m2(detail.full_m, reach_m);
    let all = within(detail.blades_m);
    let [surely_fine_m, fine_m] = [1.0 - FINE_SPREAD, 1.0 + FINE_SPREAD].map(|factor| (factor * detail.fine_m).min(detail.blades_m));
    let heads = plants.flowers_per_m2 * full_area_m2(detail.heads_m, detail.blades_m);
    let wanted = [within(fine_m), all - within(surely_fine_m), heads].map(upper_bound);
    let by_batches = wanted.iter().map(|&count| u64::from(count)).sum::<u64>() > u64::from(LISTED_LIMIT);
    (if by_batches { wanted.map(|count| count.min(BATCH_LIMIT)) } else { wanted }, by_batches)
}

fn bend_pipelines(factory: &PassFactory, layout: &wgpu::BindGroupLayout) -> SphereVariants<[wgpu::ComputePipeline; 2]> {
    let (factory, layout) = (factory.clone(), layout.clone());
    SphereVariants::new(move |constants| {
        let bend = factory.shader("bend", shaders::BEND, &constants);
        ["bend_near", "bend_far"].map(|entry| factory.compute(entry, &bend, entry, &layout))
    })
}

/// Texture of near flower heads, if they have one.
fn flower_squares(gpu: &Gpu, shape: FlowerShape) -> Option<wgpu::TextureView> {
    let levels = (shape == FlowerShape::Textured).then(flower_texture::flowers)?;
    let texture = gpu.texture("flowers", wgpu::TextureFormat::Rgba8Unorm, flower_texture::FLOWERS_PX, &levels);
    Some(texture.create_view(&Default::default()))
}

/// Segments of near and of farther blades: those of the scene, or else of the quality.
fn segments_of(plants: &PlantSettings, quality: Quality) -> [u32; 2] {
    let [near, farther] = plants.blade_segments;
    let [fine, coarse] = quality.segments();
    [if near > 0 { near } else { fine }, if farther > 0 { farther } else { coarse }]
}

/// Pipelines of near and of far flower heads.
fn head_pipelines(factory: &PassFactory, shape: FlowerShape) -> LampVariants<[wgpu::RenderPipeline; 2]> {
    let (factory, layout) = (factory.clone(), list_layout(factory));
    let near = match shape {
        FlowerShape::Modelled => ("vs", "fs"),
        FlowerShape::Textured => ("vs_square", "fs_square"),
    };
    LampVariants::new(move |lamps| {
        let flowers = factory.shader("flowers", shaders::FLOWERS, &lamps);
        [near, ("vs_disc", "fs")].map(|(vertex, fragment)| {
            let draw = DrawDescriptor { label: "flowers", vertex, fragment: Some(fragment), ..DrawDescriptor::default() };
            factory.draw(&flowers, Some(&layout), &draw)
        })
    })
}

/// Plants of a grid near the camera, blades and flowers.
fn plants_per_grid(decoded: &DecodedScene) -> u32 {
    let plants = &decoded.scene().plants;
    let flowers = plants.flowers_per_m2 * plants.grid_m * plants.grid_m;
    (blades_per_grid(plants) + flowers).round().min(PLANTS_LIMIT) as u32
}

/// Factor c for which `flowers` of `plants` are flowers on average, if plant i is one with the probability min(1, c·(i + 1)^[`FLOWER_POWER`]).
pub(crate) fn flower_probability(flowers: f32, plants: u32) -> f32 {
    /// Probabilities that are summed one by one; the others, which vary slowly, are integrated.
    const FIRST: u32 = 64;
    let expected = |factor: f32| {
        let probability = |i: u32| (factor * (i as f32 + 1.0).powf(FLOWER_POWER)).min(1.0);
        let sure = factor.powf(-1.0 / FLOWER_POWER).clamp(FIRST.min(plants) as f32, plants as f32);
        let power = FLOWER_POWER + 1.0;
        let rest = factor / power * ((plants as f32 + 0.5).powf(power) - (sure + 0.5).powf(power));
        (0..FIRST.min(plants)).map(probability).sum::<f32>() + (sure - FIRST.min(plants) as f32) + rest.max(0.0)
    };
    let (mut low, mut high) = (0.0_f32, plants as f32 + 1.0);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if expected(middle) < flowers { low = middle } else { high = middle }
    }
    low
}

/// Number and length (s) of the steps of a frame of `dt_secs`, for a stability limit of `longest_secs`.
fn steps(longest_secs: f32, dt_secs: f32) -> (u32, f32) {
    let dt_secs = dt_secs.max(0.0);
    if longest_secs == f32::INFINITY {
        return (u32::from(dt_secs > 0.0), dt_secs.min(EXACT_STEP_SECS));
    }
    let count = (dt_secs / longest_secs).ceil().min(STEP_LIMIT);
    (count as u32, (dt_secs / count.max(1.0)).min(longest_secs))
}

/// Area (m²) that at full density contains as many plants as are drawn within `within_m`.
fn full_area_m2(full_m: f32, within_m: f32) -> f32 {
    let inner_m = full_m.min(within_m);
    PI * inner_m * inner_m + TAU * full_m * full_m * (within_m / inner_m).ln()
}

/// Upper bound of a random number of plants with this mean: six standard deviations above it.
fn upper_bound(mean: f32) -> u32 {
    (mean + 6.0 * mean.sqrt() + 64.0) as u32
}

/// Layout of the bind group of the bend passes.
fn compute_layout(factory: &PassFactory) -> wgpu::BindGroupLayout {
    let entries =
        [uniform(0), storage_rw(1), storage_rw(2), storage_rw(3), storage_compute(4), storage_rw(5), storage_compute(6), storage_rw(7)];
    factory.layout("bend", &[&entries[..], &CameraForceField::layout()].concat())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_stay_within_the_stability_limit() {
        let found = [0.0, 0.004, 1.0 / 60.0, 0.02, 1.0, -1.0].map(|dt_secs| steps(0.008, dt_secs));
        assert_eq!(found.map(|(count, _)| count), [0, 1, 3, 3, 32, 0]);
        assert!(found.iter().all(|&(_, step_secs)| step_secs <= 0.008));
        assert!((found[3].1 - 0.02 / 3.0).abs() < 1e-6);
        assert_eq!([0.0, 0.02, 5.0].map(|dt_secs| steps(f32::INFINITY, dt_secs)), [(0, 0.0), (1, 0.02), (1, EXACT_STEP_SECS)]);
    }

    #[test]
    fn flower_probabilities_sum_to_the_number_of_flowers() {
        for (flowers, plants) in [(38.4, 1062), (38.4, 25_638), (3200.0, 4000), (1.2, 400)] {
            let factor = flower_probability(flowers, plants);
            let sum: f32 = (0..plants).map(|i| (factor * (i as f32 + 1.0).powf(FLOWER_POWER)).min(1.0)).sum();
            assert!((sum / flowers - 1.0).abs() < 0.02, "{sum} of {flowers}");
        }
        assert_eq!(flower_probability(0.0, 1000), 0.0);
    }

    #[test]
    fn full_area_is_the_integral_of_the_density() {
        let (full_m, within_m) = (8.0, 100.0);
        let rings = 200_000;
        let step_m = within_m / rings as f32;
        let sum: f64 = (0..rings).map(|i| (i as f32 + 0.5) * step_m).map(|r_m| f64::from(TAU * r_m * step_m * density(r_m, full_m))).sum();
        assert!((sum / f64::from(full_area_m2(full_m, within_m)) - 1.0).abs() < 1e-3);
    }
}
