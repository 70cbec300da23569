//! Dust that one sees: motes and puffs of haze that drift with the streamed wind about the camera.

use super::Quality;
use super::billboards::random3;
use super::gpu::Gpu;
use super::pipeline::{Draw, Maker, bind, storage, storage_rw, uniform};
use super::shaders;
use super::uniforms::Drift;
use crate::state::Land;
use wgpu::BufferUsages;

/// Side of the square about the camera that the motes are in (m): farther off they are too small to be seen.
const MOTE_SQUARE_M: f32 = 44.0;
/// Height up to which there are motes and puffs (m).
const TOP_M: f32 = 12.0;
/// Longest time that a frame lets them drift for (s): after a pause they go on from where they were.
const LONGEST_SECS: f32 = 0.1;
/// Bytes of `Sprite` in `dust.wgsl`.
const SPRITE_BYTES: u64 = 48;

pub(super) struct Dust {
    pipeline: wgpu::RenderPipeline,
    blow: wgpu::ComputePipeline,
    group: wgpu::BindGroup,
    blow_group: wgpu::BindGroup,
    drift: wgpu::Buffer,
    count: u32,
}

impl Dust {
    /// The dust of a scene; none where the wind carries none.
    pub(super) fn new(maker: &Maker<'_>, quality: Quality, land: &Land) -> Option<Self> {
        land.scene().wind.has_dust().then(|| Self::make(maker, quality, land))
    }

    fn make(maker: &Maker<'_>, quality: Quality, land: &Land) -> Self {
        let gpu = maker.gpu;
        let ((puffs, square_m), motes) = (quality.puffs(), quality.motes());
        let count = puffs + motes;
        let wind = &land.scene().wind;
        let top_m = TOP_M.min(wind.cells[1] as f32 * wind.spacing_m[1]);
        let contents = Drift { counts: [puffs, motes, 0, 0], shape: [square_m, MOTE_SQUARE_M, top_m, 0.0] };
        let drift = gpu.buffer("drift", bytemuck::bytes_of(&contents), BufferUsages::UNIFORM | BufferUsages::COPY_DST);
        let places: Vec<[f32; 4]> = (0..count)
            .map(|number| {
                let side_m = if number < puffs { square_m } else { MOTE_SQUARE_M };
                let [x, y, z] = random3([0, 0], number);
                let [own, ..] = random3([1, 0], number);
                [x * side_m, y * top_m, z * side_m, own]
            })
            .collect();
        let places = gpu.buffer("dust", bytemuck::cast_slice(&places), BufferUsages::STORAGE);
        let sprites = gpu.empty_buffer("dust sprites", u64::from(count) * SPRITE_BYTES, BufferUsages::STORAGE);
        let blow_layout = maker.layout("dust drifts", &[uniform(0), storage_rw(1), storage_rw(2)]);
        let resources = [&drift, &places, &sprites].map(|buffer| buffer.as_entire_binding());
        let blow_group = bind(gpu, "dust drifts", &blow_layout, &resources);
        let layout = maker.layout("dust", &[uniform(0), storage(3)]);
        let entries =
            [(0, &drift), (3, &sprites)].map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() });
        let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some("dust"), layout: &layout, entries: &entries });
        let module = maker.shader("dust", shaders::DUST, &[]);
        let draw =
            Draw { label: "dust", depth_write: false, blend: Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING), ..Draw::default() };
        Self {
            pipeline: maker.draw(&module, Some(&layout), &draw),
            blow: maker.compute("dust drifts", &module, "blow", &blow_layout),
            group,
            blow_group,
            drift,
            count,
        }
    }

    /// Says how long the air has blown since the frame before.
    pub(super) fn prepare(&self, gpu: &Gpu, dt_secs: f32) {
        let at = std::mem::offset_of!(Drift, shape) + 3 * size_of::<f32>();
        gpu.queue.write_buffer(&self.drift, at as u64, bytemuck::bytes_of(&dt_secs.clamp(0.0, LONGEST_SECS)));
    }

    /// Lets everything drift, and finds how it looks there.
    pub(super) fn blow(&self, pass: &mut wgpu::ComputePass<'_>) {
        pass.set_pipeline(&self.blow);
        pass.set_bind_group(1, &self.blow_group, &[]);
        pass.dispatch_workgroups(self.count.div_ceil(64), 1, 1);
    }

    /// To be drawn after all that is solid.
    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(1, &self.group, &[]);
        pass.draw(0..self.count * 6, 0..1);
    }
}
