//! Visible dust: motes and puffs of haze that drift with the streamed wind.

use crate::render::gpu::constants::{DUSTY_CELLS, WORKGROUP_SIZE};
use crate::render::gpu::device::Gpu;
use crate::render::gpu::pipeline::{DrawDescriptor, PassFactory, bind_as, storage, storage_rw, uniform};
use crate::render::gpu::shaders;
use crate::render::gpu::uniforms::Drift;
use crate::render::inputs::dusty_cells::DustyCells;
use crate::render::inputs::random::random3;
use crate::render::options::quality::Quality;
use crate::state::DecodedScene;
use prairie_core::scene::{Wind, WindTiling};
use wgpu::BufferUsages;

/// Side of the square of motes around the camera (m). Farther away they are too small to be visible.
const MOTE_SQUARE_M: f32 = 44.0;
/// Maximum height of motes (m).
const TOP_M: f32 = 12.0;
/// Longest drift per frame (s): after a pause, dust continues from its last position.
const LONGEST_SECS: f32 = 0.1;
/// Bytes of `Sprite` in `dust.wgsl`.
const SPRITE_BYTES: u64 = 48;
/// Age of a puff that has not lived yet, see `DustPlace` in `dust.wgsl`.
const NEVER_LIVED: f32 = 2.0;

pub(crate) struct Dust {
    pipeline: wgpu::RenderPipeline,
    blow: wgpu::ComputePipeline,
    group: wgpu::BindGroup,
    blow_group: wgpu::BindGroup,
    drift: wgpu::Buffer,
    dusty_cells: wgpu::Buffer,
    count: u32,
    /// Wind domains over which the puffs are spread, relative to the number of puffs.
    domains_per_puff: f32,
}

impl Dust {
    /// The dust of a scene; `None` if its wind carries none.
    pub(crate) fn new(factory: &PassFactory, quality: Quality, decoded: &DecodedScene) -> Option<Self> {
        decoded.scene().wind.has_dust().then(|| Self::make(factory, quality, decoded))
    }

    fn make(factory: &PassFactory, quality: Quality, decoded: &DecodedScene) -> Self {
        let gpu = &factory.gpu;
        let ((puffs, puff_square_m), motes) = (quality.puffs(), quality.motes());
        let count = puffs + motes;
        let wind = &decoded.scene().wind;
        let top_m = TOP_M.min(wind.cells[1] as f32 * wind.spacing_m[1]);
        let contents =
            Drift { puffs, motes, puff_square_m, mote_square_m: MOTE_SQUARE_M, top_m, step_secs: 0.0, puff_m3: 0.0, _pad: [0; 4] };
        let drift = gpu.buffer("drift", bytemuck::bytes_of(&contents), BufferUsages::UNIFORM | BufferUsages::COPY_DST);
        // `DustPlace` in `dust.wgsl`.
        let positions: Vec<[f32; 8]> = (0..count)
            .map(|number| {
                let [x, y, z] = random3([0, 0], number);
                let [own, ..] = random3([1, 0], number);
                [x * MOTE_SQUARE_M, y * top_m, z * MOTE_SQUARE_M, own, NEVER_LIVED, 0.0, 0.0, 0.0]
            })
            .collect();
        let positions = gpu.buffer("dust", bytemuck::cast_slice(&positions), BufferUsages::STORAGE);
        let sprites = gpu.empty_buffer("dust sprites", u64::from(count) * SPRITE_BYTES, BufferUsages::STORAGE);
        let dusty_cells = gpu.empty_buffer("dusty cells", u64::from(DUSTY_CELLS) * 4, BufferUsages::STORAGE | BufferUsages::COPY_DST);
        let blow_layout = factory.layout("dust drifts", &[uniform(0), storage_rw(1), storage_rw(2), storage(4)]);
        let resources = [(0, &drift), (1, &positions), (2, &sprites), (4, &dusty_cells)];
        let blow_group = bind_as(gpu, "dust drifts", &blow_layout, &resources);
        let layout = factory.layout("dust", &[uniform(0), storage(3)]);
        let group = bind_as(gpu, "dust", &layout, &[(0, &drift), (3, &sprites)]);
        let module = factory.shader("dust", shaders::DUST, &[]);
        let draw = DrawDescriptor {
            label: "dust",
            depth_write: false,
            blend: Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
            ..DrawDescriptor::default()
        };
        Self {
            pipeline: factory.draw(&module, Some(&layout), &draw),
            blow: factory.compute("dust drifts", &module, "blow", &blow_layout),
            group,
            blow_group,
            drift,
            dusty_cells,
            count,
            domains_per_puff: domains(wind, puff_square_m) / puffs as f32,
        }
    }

    /// Sets the time since the previous frame, and where new puffs start.
    pub(crate) fn prepare(&self, gpu: &Gpu, dusty: &DustyCells, dt_secs: f32) {
        let at = std::mem::offset_of!(Drift, step_secs);
        let values = [dt_secs.clamp(0.0, LONGEST_SECS), dusty.volume_m3 * self.domains_per_puff];
        gpu.queue.write_buffer(&self.drift, at as u64, bytemuck::bytes_of(&values));
        gpu.queue.write_buffer(&self.dusty_cells, 0, bytemuck::cast_slice(&dusty.cells));
    }

    /// Moves and lights all sprites.
    pub(crate) fn drift(&self, pass: &mut wgpu::ComputePass<'_>) {
        pass.set_pipeline(&self.blow);
        pass.set_bind_group(1, &self.blow_group, &[]);
        pass.dispatch_workgroups(self.count.div_ceil(WORKGROUP_SIZE), 1, 1);
    }

    /// Draws the dust over the opaque picture.
    pub(crate) fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(1, &self.group, &[]);
        pass.draw(0..self.count * 6, 0..1);
    }
}

/// Number of wind domains, side by side, over which the puffs are spread.
fn domains(wind: &Wind, square_m: f32) -> f32 {
    let ([x_m, _, z_m], [wraps_x, _, wraps_z]) = (wind.box_m(), wind.faces.wraps());
    let by_patch = wind.tiling == WindTiling::Patch;
    let along = |side_m: f32, wraps: bool| if wraps || by_patch { (square_m / side_m - 1.0).max(1.0) } else { 1.0 };
    along(x_m, wraps_x) * along(z_m, wraps_z)
}
