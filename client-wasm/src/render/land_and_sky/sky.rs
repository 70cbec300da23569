//! Sky, drawn behind everything else.

use crate::render::gpu::pipeline::{DrawDescriptor, PassFactory};
use crate::render::gpu::shaders;

pub(crate) struct Sky {
    pipeline: wgpu::RenderPipeline,
}

impl Sky {
    pub(crate) fn new(factory: &PassFactory) -> Self {
        let module = factory.shader("sky", shaders::SKY, &[]);
        let draw = DrawDescriptor { label: "sky", depth_write: false, ..DrawDescriptor::default() };
        Self { pipeline: factory.draw(&module, None, &draw) }
    }

    pub(crate) fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_pipeline(&self.pipeline);
        pass.draw(0..3, 0..1);
    }
}
