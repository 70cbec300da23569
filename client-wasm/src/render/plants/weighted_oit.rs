//! Weighted blended order-independent transparency (McGuire & Bavoil 2013): one pass sums the fragments of plants, weighted by depth; another blends their
//! mean over the picture.

use crate::render::gpu::device::Gpu;
use crate::render::gpu::pipeline::{DrawDescriptor, PassFactory, bind, texture};
use crate::render::gpu::shaders;
use crate::render::plants::blending::{SUM, TRANSMITTANCE};

pub(crate) struct WeightedOit {
    compose: wgpu::RenderPipeline,
    group: wgpu::BindGroup,
    sums: Target,
    transmittance: Target,
}

/// A target, and its resolve target if it is multisampled.
struct Target {
    view: wgpu::TextureView,
    resolved: Option<wgpu::TextureView>,
}

impl Drop for Target {
    /// Frees the textures at once, as those of the picture.
    fn drop(&mut self) {
        [Some(&self.view), self.resolved.as_ref()].into_iter().flatten().for_each(|view| view.texture().destroy());
    }
}

impl Target {
    fn new(gpu: &Gpu, format: wgpu::TextureFormat, size_px: [u32; 2], samples: u32) -> Self {
        let texture = |samples| gpu.render_target("weighted", format, size_px, samples);
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

impl WeightedOit {
    pub(crate) fn new(factory: &PassFactory, size_px: [u32; 2]) -> Self {
        let gpu = &factory.gpu;
        let layout = factory.layout("compose", &[texture(0), texture(1)]);
        let blend = Some(wgpu::BlendState::ALPHA_BLENDING);
        let draw = DrawDescriptor { label: "compose", depth_write: false, blend, ..DrawDescriptor::default() };
        let [sums, transmittance] = [SUM, TRANSMITTANCE].map(|format| Target::new(gpu, format, size_px, factory.samples));
        let views = [sums.picture(), transmittance.picture()].map(wgpu::BindingResource::TextureView);
        Self {
            compose: factory.draw(&factory.shader("compose", shaders::COMPOSE, &[]), Some(&layout), &draw),
            group: bind(gpu, "compose", &layout, &views),
            sums,
            transmittance,
        }
    }

    /// Begins the pass that sums fragments, tested against the depth of the opaque picture.
    pub(crate) fn pass(&self, encoder: &mut wgpu::CommandEncoder, depth: &wgpu::TextureView) -> wgpu::RenderPass<'static> {
        let descriptor = wgpu::RenderPassDescriptor {
            label: Some("weighted"),
            color_attachments: &[self.sums.attachment(0.0), self.transmittance.attachment(1.0)],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: depth,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store }),
                stencil_ops: None,
            }),
            timestamp_writes: None,
            occlusion_query_set: None,
            multiview_mask: None,
        };
        encoder.begin_render_pass(&descriptor).forget_lifetime()
    }

    /// Blends the mean over the picture.
    pub(crate) fn compose(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_pipeline(&self.compose);
        pass.set_bind_group(1, &self.group, &[]);
        pass.draw(0..3, 0..1);
    }
}
