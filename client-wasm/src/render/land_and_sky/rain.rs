//! Visible rain: streaks around the camera.

use crate::render::gpu::pipeline::{DrawDescriptor, PassFactory, bind, uniform};
use crate::render::gpu::shaders;
use crate::render::gpu::uniforms::Shower;
use crate::render::options::quality::Quality;
use crate::state::DecodedScene;
use prairie_core::plant::underbrush::drops::DROP_M_PER_S;
use wgpu::BufferUsages;

/// Side and height of the box of streaks around the camera (m).
const SQUARE_M: f32 = 26.0;
const TALL_M: f32 = 14.0;
/// Rain rate at which all streaks are drawn (mm/h).
const FULL_MM_PER_H: f32 = 30.0;

pub(crate) struct Rain {
    pipeline: wgpu::RenderPipeline,
    group: wgpu::BindGroup,
    drops: u32,
}

impl Rain {
    /// The rain of a scene; `None` if it is dry.
    pub(crate) fn new(factory: &PassFactory, quality: Quality, decoded: &DecodedScene) -> Option<Self> {
        let rate_mm_per_h = decoded.scene().rain.rate_mm_per_h;
        if rate_mm_per_h <= 0.0 {
            return None;
        }
        let drops = (quality.drops() as f32 * (rate_mm_per_h / FULL_MM_PER_H).clamp(0.05, 1.0)) as u32;
        let contents = Shower { side_m: SQUARE_M, height_m: TALL_M, fall_m_per_s: DROP_M_PER_S, opacity: 0.75 };
        let shower = factory.gpu.buffer("shower", bytemuck::bytes_of(&contents), BufferUsages::UNIFORM);
        let layout = factory.layout("rain", &[uniform(0)]);
        let draw = DrawDescriptor {
            label: "rain",
            depth_write: false,
            blend: Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
            ..DrawDescriptor::default()
        };
        let pipeline = factory.draw(&factory.shader("rain", shaders::RAIN, &[]), Some(&layout), &draw);
        Some(Self { pipeline, group: bind(&factory.gpu, "rain", &layout, &[shower.as_entire_binding()]), drops })
    }

    /// Draws the rain over the opaque picture.
    pub(crate) fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(1, &self.group, &[]);
        pass.draw(0..self.drops * 6, 0..1);
    }
}
