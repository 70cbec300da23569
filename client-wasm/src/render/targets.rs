//! Textures that the passes of a frame draw to, and the descriptions of those passes.

use crate::render::gpu::device::Gpu;
use crate::render::gpu::pipeline::{COLOR, DEPTH};
use crate::render::options::quality::Quality;
use wgpu::{LoadOp, StoreOp};

/// Colour and depth of the picture before tone mapping.
pub(super) struct Targets {
    pub(super) size_px: [u32; 2],
    /// Rendered pixels per output pixel, along X and Y.
    pub(super) scale: [f32; 2],
    pub(super) color: wgpu::TextureView,
    pub(super) depth: wgpu::TextureView,
}

impl Targets {
    /// Targets for an output of `output_px` at a fraction of the quality's resolution. A picture that is larger than its output has whole pixels for each of the
    /// output's.
    pub(super) fn new(gpu: &Gpu, output_px: [u32; 2], quality: Quality, resolution: f32) -> Self {
        let samples = quality.samples(gpu.is_software);
        let factor = quality.supersampling(output_px, gpu.side_limit_px()) as f32 * resolution;
        let factor = if factor > 1.0 { factor.floor() } else { factor };
        let size_px = output_px.map(|side_px| (side_px as f32 * factor).round().max(1.0) as u32);
        let scale = std::array::from_fn(|axis| size_px[axis] as f32 / output_px[axis] as f32);
        let texture = |label, format| gpu.render_target(label, format, size_px, samples);
        Self { size_px, scale, color: texture("color", COLOR), depth: texture("depth", DEPTH) }
    }

    /// Begins or resumes the pass that draws the picture. The first one clears both textures; the last one discards depth.
    pub(super) fn picture_pass(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        [is_first, is_last]: [bool; 2],
        timestamp_writes: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) -> wgpu::RenderPass<'static> {
        let color_load = if is_first { LoadOp::Clear(wgpu::Color::BLACK) } else { LoadOp::Load };
        let depth_load = if is_first { LoadOp::Clear(0.0) } else { LoadOp::Load };
        let depth_store = if is_last { StoreOp::Discard } else { StoreOp::Store };
        let descriptor = wgpu::RenderPassDescriptor {
            label: Some("picture"),
            color_attachments: &[color_attachment(&self.color, color_load)],
            depth_stencil_attachment: depth_attachment(&self.depth, depth_load, depth_store),
            timestamp_writes,
            ..Default::default()
        };
        encoder.begin_render_pass(&descriptor).forget_lifetime()
    }
}

impl Drop for Targets {
    /// Frees the textures at once: a browser frees dropped ones only when it collects garbage.
    fn drop(&mut self) {
        [&self.color, &self.depth].into_iter().for_each(|view| view.texture().destroy());
    }
}

/// Begins the pass that draws a cascade of the shadow map.
pub(super) fn shadow_pass(
    encoder: &mut wgpu::CommandEncoder,
    depth: &wgpu::TextureView,
    timestamp_writes: Option<wgpu::RenderPassTimestampWrites<'_>>,
) -> wgpu::RenderPass<'static> {
    let descriptor = wgpu::RenderPassDescriptor {
        label: Some("shadows"),
        depth_stencil_attachment: depth_attachment(depth, LoadOp::Clear(1.0), StoreOp::Store),
        timestamp_writes,
        ..Default::default()
    };
    encoder.begin_render_pass(&descriptor).forget_lifetime()
}

/// Begins the tone mapping pass; `keeps` preserves the previous contents of the output.
pub(super) fn tone_pass(
    encoder: &mut wgpu::CommandEncoder,
    output: &wgpu::TextureView,
    keeps: bool,
    timestamp_writes: Option<wgpu::RenderPassTimestampWrites<'_>>,
) -> wgpu::RenderPass<'static> {
    let load = if keeps { LoadOp::Load } else { LoadOp::Clear(wgpu::Color::BLACK) };
    let descriptor = wgpu::RenderPassDescriptor {
        label: Some("tone"),
        color_attachments: &[color_attachment(output, load)],
        timestamp_writes,
        ..Default::default()
    };
    encoder.begin_render_pass(&descriptor).forget_lifetime()
}

/// Begins the pass that draws over the finished output.
pub(super) fn overlay_pass(encoder: &mut wgpu::CommandEncoder, output: &wgpu::TextureView) -> wgpu::RenderPass<'static> {
    let descriptor = wgpu::RenderPassDescriptor {
        label: Some("overlay"),
        color_attachments: &[color_attachment(output, LoadOp::Load)],
        ..Default::default()
    };
    encoder.begin_render_pass(&descriptor).forget_lifetime()
}

fn color_attachment(view: &wgpu::TextureView, load: LoadOp<wgpu::Color>) -> Option<wgpu::RenderPassColorAttachment<'_>> {
    let ops = wgpu::Operations { load, store: StoreOp::Store };
    Some(wgpu::RenderPassColorAttachment { view, depth_slice: None, resolve_target: None, ops })
}

fn depth_attachment(view: &wgpu::TextureView, load: LoadOp<f32>, store: StoreOp) -> Option<wgpu::RenderPassDepthStencilAttachment<'_>> {
    let depth_ops = Some(wgpu::Operations { load, store });
    Some(wgpu::RenderPassDepthStencilAttachment { view, depth_ops, stencil_ops: None })
}
