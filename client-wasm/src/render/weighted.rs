//! Plants blended without order, each fragment weighted by how near it is (McGuire & Bavoil 2013): a pass sums them up over the depth of the opaque
//! picture, another one lays their mean over it.

use super::gpu::Gpu;
use super::pipeline::{COVERED, Draw, Maker, SUM, bind, texture};
use super::shaders;

pub(super) struct Weighted {
    compose: wgpu::RenderPipeline,
    group: wgpu::BindGroup,
    sums: Target,
    left: Target,
}

/// A target, and where its samples go if it has more than one.
struct Target {
    view: wgpu::TextureView,
    resolved: Option<wgpu::TextureView>,
}

impl Target {
    fn new(gpu: &Gpu, format: wgpu::TextureFormat, size_px: [u32; 2], samples: u32) -> Self {
        let texture = |samples| {
            let descriptor = wgpu::TextureDescriptor {
                label: Some("weighted"),
                size: wgpu::Extent3d { width: size_px[0], height: size_px[1], depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: samples,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
                view_formats: &[],
            };
            gpu.device.create_texture(&descriptor).create_view(&Default::default())
        };
        Self { view: texture(samples), resolved: (samples > 1).then(|| texture(1)) }
    }

    fn picture(&self) -> &wgpu::TextureView {
        self.resolved.as_ref().unwrap_or(&self.view)
    }

    fn attachment(&self, cleared: f64) -> Option<wgpu::RenderPassColorAttachment<'_>> {
        let store = if self.resolved.is_some() { wgpu::StoreOp::Discard } else { wgpu::StoreOp::Store };
        let clear = wgpu::Color { r: cleared, g: cleared, b: cleared, a: cleared };
        Some(wgpu::RenderPassColorAttachment {
            view: &self.view,
            depth_slice: None,
            resolve_target: self.resolved.as_ref(),
            ops: wgpu::Operations { load: wgpu::LoadOp::Clear(clear), store },
        })
    }
}

impl Weighted {
    pub(super) fn new(maker: &Maker<'_>, size_px: [u32; 2]) -> Self {
        let gpu = maker.gpu;
        let layout = maker.layout("compose", &[texture(0), texture(1)]);
        let blend = Some(wgpu::BlendState::ALPHA_BLENDING);
        let draw = Draw { label: "compose", depth_write: false, blend, ..Draw::default() };
        let [sums, left] = [SUM, COVERED].map(|format| Target::new(gpu, format, size_px, maker.samples));
        let views = [sums.picture(), left.picture()].map(wgpu::BindingResource::TextureView);
        Self {
            compose: maker.draw(&maker.shader("compose", shaders::COMPOSE, &[]), Some(&layout), &draw),
            group: bind(gpu, "compose", &layout, &views),
            sums,
            left,
        }
    }

    /// The pass that sums up, over the depth of what is opaque.
    pub(super) fn pass<'a>(&self, encoder: &'a mut wgpu::CommandEncoder, depth: &wgpu::TextureView) -> wgpu::RenderPass<'a> {
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("weighted"),
            color_attachments: &[self.sums.attachment(0.0), self.left.attachment(1.0)],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: depth,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store }),
                stencil_ops: None,
            }),
            timestamp_writes: None,
            occlusion_query_set: None,
            multiview_mask: None,
        })
    }

    /// Lays the sums over the picture.
    pub(super) fn compose(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_pipeline(&self.compose);
        pass.set_bind_group(1, &self.group, &[]);
        pass.draw(0..3, 0..1);
    }
}
