//! Visible dust: motes and puffs of haze around the camera that drift with the streamed wind.

use crate::render::gpu::constants::WORKGROUP_SIZE;
use crate::render::gpu::device::Gpu;
use crate::render::gpu::pipeline::{DrawDescriptor, PassFactory, bind, storage, storage_rw, uniform};
use crate::render::gpu::shaders;
use crate::render::gpu::uniforms::Drift;
use crate::render::inputs::random::random3;
use crate::render::options::quality::Quality;
use crate::state::DecodedScene;
use wgpu::BufferUsages;

/// Side of the square of motes around the camera (m). Farther away they are too small to be visible.
const MOTE_SQUARE_M: f32 = 44.0;
/// Maximum height of motes and puffs (m).
const TOP_M: f32 = 12.0;
/// Longest drift per frame (s): after a pause, dust continues from its last position.
const LONGEST_SECS: f32 = 0.1;
/// Bytes of `Sprite` in `dust.wgsl`.
const SPRITE_BYTES: u64 = 48;

pub(crate) struct Dust {
    pipeline: wgpu::RenderPipeline,
    blow: wgpu::ComputePipeline,
    group: wgpu::BindGroup,
    blow_group: wgpu::BindGroup,
    drift: wgpu::Buffer,
    count: u32,
}

impl Dust {
    /// The dust of a scene; `None` if its wind carries none.
    pub(crate) fn new(factory: &PassFactory, quality: Quality, decoded: &DecodedScene) -> Option<Self> {
        decoded.scene().wind.has_dust().then(|| Self::make(factory, quality, decoded))
    }

    fn make(factory: &PassFactory, quality: Quality, decoded: &DecodedScene) -> Self {
        let gpu = &factory.gpu;
        let ((puffs, square_m), motes) = (quality.puffs(), quality.motes());
        let count = puffs + motes;
        let wind = &decoded.scene().wind;
        let top_m = TOP_M.min(wind.cells[1] as f32 * wind.spacing_m[1]);
        let contents = Drift { puffs, motes, puff_square_m: square_m, mote_square_m: MOTE_SQUARE_M, top_m, step_secs: 0.0, _pad: [0; 8] };
        let drift = gpu.buffer("drift", bytemuck::bytes_of(&contents), BufferUsages::UNIFORM | BufferUsages::COPY_DST);
        let positions: Vec<[f32; 4]> = (0..count)
            .map(|number| {
                let side_m = if number < puffs { square_m } else { MOTE_SQUARE_M };
                let [x, y, z] = random3([0, 0], number);
                let [own, ..] = random3([1, 0], number);
                [x * side_m, y * top_m, z * side_m, own]
            })
            .collect();
        let positions = gpu.buffer("dust", bytemuck::cast_slice(&positions), BufferUsages::STORAGE);
        let sprites = gpu.empty_buffer("dust sprites", u64::from(count) * SPRITE_BYTES, BufferUsages::STORAGE);
        let blow_layout = factory.layout("dust drifts", &[uniform(0), storage_rw(1), storage_rw(2)]);
        let resources = [&drift, &positions, &sprites].map(|buffer| buffer.as_entire_binding());
        let blow_group = bind(gpu, "dust drifts", &blow_layout, &resources);
        let layout = factory.layout("dust", &[uniform(0), storage(3)]);
        let entries =
            [(0, &drift), (3, &sprites)].map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() });
        let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some("dust"), layout: &layout, entries: &entries });
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
            count,
        }
    }

    /// Sets the time since the previous frame.
    pub(crate) fn prepare(&self, gpu: &Gpu, dt_secs: f32) {
        let at = std::mem::offset_of!(Drift, step_secs);
        gpu.queue.write_buffer(&self.drift, at as u64, bytemuck::bytes_of(&dt_secs.clamp(0.0, LONGEST_SECS)));
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
