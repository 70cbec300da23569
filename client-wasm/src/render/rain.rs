//! Rain that one sees: streaks about the camera.

use super::Quality;
use super::pipeline::{Draw, Maker, bind, uniform};
use super::shaders;
use super::uniforms::Shower;
use crate::state::Land;
use shared::plant::underbrush::drops::DROP_M_PER_S;
use wgpu::BufferUsages;

/// Side and height of the box about the camera that streaks are in (m).
const SQUARE_M: f32 = 26.0;
const TALL_M: f32 = 14.0;
/// Rate at which all streaks are drawn (mm/h).
const FULL_MM_PER_H: f32 = 30.0;

pub(super) struct RainPass {
    pipeline: wgpu::RenderPipeline,
    group: wgpu::BindGroup,
    drops: u32,
}

impl RainPass {
    /// The rain of a scene; none where none falls.
    pub(super) fn new(maker: &Maker<'_>, quality: Quality, land: &Land) -> Option<Self> {
        let rate_mm_per_h = land.scene().rain.rate_mm_per_h;
        if rate_mm_per_h <= 0.0 {
            return None;
        }
        let drops = (quality.drops() as f32 * (rate_mm_per_h / FULL_MM_PER_H).clamp(0.05, 1.0)) as u32;
        let contents = Shower { counts: [drops, 0, 0, 0], shape: [SQUARE_M, TALL_M, DROP_M_PER_S, 0.75] };
        let shower = maker.gpu.buffer("shower", bytemuck::bytes_of(&contents), BufferUsages::UNIFORM);
        let layout = maker.layout("rain", &[uniform(0)]);
        let draw =
            Draw { label: "rain", depth_write: false, blend: Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING), ..Draw::default() };
        let pipeline = maker.draw(&maker.shader("rain", shaders::RAIN, &[]), Some(&layout), &draw);
        Some(Self { pipeline, group: bind(maker.gpu, "rain", &layout, &[shower.as_entire_binding()]), drops })
    }

    /// To be drawn after all that is solid.
    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(1, &self.group, &[]);
        pass.draw(0..self.drops * 6, 0..1);
    }
}
