//! Visible rain and snowfall: streaks of drops or flakes around the camera.

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
/// Snowfall at which all flakes are drawn (m/h).
const FULL_SNOW_M_PER_H: f32 = 0.05;
/// Fall speed of snowflakes (m/s).
const FLAKE_M_PER_S: f32 = 1.0;

pub(crate) struct Rain {
    pipeline: wgpu::RenderPipeline,
    group: wgpu::BindGroup,
    drops: u32,
}

impl Rain {
    /// The rain of a scene, or its snowfall if there is any; `None` if neither falls.
    pub(crate) fn new(factory: &PassFactory, quality: Quality, decoded: &DecodedScene) -> Option<Self> {
        let (rain, snow) = (decoded.scene().rain.rate_mm_per_h / FULL_MM_PER_H, decoded.scene().snow.fall_m_per_h / FULL_SNOW_M_PER_H);
        if rain.max(snow) <= 0.0 {
            return None;
        }
        let drops = (quality.drops() as f32 * if snow > 0.0 { snow } else { rain }.clamp(0.05, 1.0)) as u32;
        let (fall_m_per_s, streak_secs, half_width_m) =
            if snow > 0.0 { (FLAKE_M_PER_S, 0.006, 0.003) } else { (DROP_M_PER_S, 0.045, 0.0020) };
        let contents = Shower { side_m: SQUARE_M, height_m: TALL_M, fall_m_per_s, opacity: 0.75, streak_secs, half_width_m, _pad: [0; 8] };
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
