//! Blend states of plants that overlap, by blend order.

use crate::render::gpu::pipeline::{COLOR, DrawDescriptor, PassFactory, color_target};
use crate::render::options::render_options::BlendOrder;

/// Formats of the targets of weighted OIT: the weighted sum, and the transmittance (fraction of a pixel that stays uncovered).
pub(crate) const SUM: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
pub(crate) const TRANSMITTANCE: wgpu::TextureFormat = wgpu::TextureFormat::R16Float;

/// Adds the source and the destination, each times its factor.
const fn blended(src_factor: wgpu::BlendFactor, dst_factor: wgpu::BlendFactor) -> wgpu::BlendState {
    let component = wgpu::BlendComponent { src_factor, dst_factor, operation: wgpu::BlendOperation::Add };
    wgpu::BlendState { color: component, alpha: component }
}

/// Zhang, Eq. (10), in all four channels: S·Sₐ + D·(1 − Sₐ). The resulting alpha, Sₐ² + Dₐ·(1 − Sₐ), is not the covered fraction of the pixel; nothing
/// reads it. Light is not clamped to 0..1 before tone mapping.
const OVER: wgpu::BlendState = blended(wgpu::BlendFactor::SrcAlpha, wgpu::BlendFactor::OneMinusSrcAlpha);

/// Pipeline that draws plants over each other in an order.
pub(crate) fn blend_pipeline(
    factory: &PassFactory,
    module: &wgpu::ShaderModule,
    own: Option<&wgpu::BindGroupLayout>,
    draw: &DrawDescriptor<'_>,
    order: BlendOrder,
) -> wgpu::RenderPipeline {
    use wgpu::BlendFactor::{One, OneMinusSrc, Zero};
    match order {
        BlendOrder::Cut => factory.draw(module, own, draw),
        BlendOrder::Coverage => factory.render_pipeline(module, own, draw, &[color_target(COLOR, None)], true),
        // Later plants are nearer. Where leaning plants cross, the depth test keeps the nearer one.
        BlendOrder::Sorted | BlendOrder::Precomputed => {
            factory.render_pipeline(module, own, draw, &[color_target(COLOR, Some(OVER))], false)
        }
        BlendOrder::Weighted => {
            let targets = [color_target(SUM, Some(blended(One, One))), color_target(TRANSMITTANCE, Some(blended(Zero, OneMinusSrc)))];
            factory.render_pipeline(module, own, &DrawDescriptor { depth_write: false, ..*draw }, &targets, false)
        }
    }
}
