//! Sky, drawn last where nothing else is.

use super::pipeline::{Draw, Maker};
use super::shaders;

pub(super) struct Sky {
    pipeline: wgpu::RenderPipeline,
}

impl Sky {
    pub(super) fn new(maker: &Maker<'_>) -> Self {
        let module = maker.shader("sky", shaders::SKY, &[]);
        let draw = Draw { label: "sky", depth_write: false, ..Draw::default() };
        Self { pipeline: maker.draw(&module, None, &draw) }
    }

    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_pipeline(&self.pipeline);
        pass.draw(0..3, 0..1);
    }
}
