//! Sky, drawn behind everything else: a dome at infinity.

use crate::render::gpu::constants::{SKY_HEADINGS, SKY_RINGS};
use crate::render::gpu::pipeline::{DrawDescriptor, PassFactory};
use crate::render::gpu::shaders;
use crate::render::gpu::variants::Variants;

pub(crate) struct Sky {
    /// Pipelines without and with stars, each without and with rain clouds.
    pipelines: Variants<2, wgpu::RenderPipeline>,
    indices: wgpu::Buffer,
    index_count: u32,
}

impl Sky {
    pub(crate) fn new(factory: &PassFactory) -> Self {
        let indices = dome_indices();
        let indices_buffer = factory.gpu.buffer("dome", bytemuck::cast_slice(&indices), wgpu::BufferUsages::INDEX);
        let factory = factory.clone();
        let pipelines = Variants::by(["has_stars", "has_rain_clouds"], move |constants| {
            let module = factory.shader("sky", shaders::SKY, &constants);
            let draw = DrawDescriptor { label: "sky", depth_write: false, ..DrawDescriptor::default() };
            factory.draw(&module, None, &draw)
        });
        Self { pipelines, indices: indices_buffer, index_count: indices.len() as u32 }
    }

    /// Creates a variant of the pipeline that no frame has needed yet. Returns false if there is none.
    pub(crate) fn create_next(&self) -> bool {
        self.pipelines.create_next()
    }

    /// Draws the sky; `shows` says whether there are stars and rain clouds.
    pub(crate) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, shows: [bool; 2]) {
        pass.set_pipeline(self.pipelines.with(shows));
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint16);
        pass.draw_indexed(0..self.index_count, 0, 0..1);
    }
}

/// Two triangles between each two headings and rings.
fn dome_indices() -> Vec<u16> {
    let row = SKY_HEADINGS as u16 + 1;
    let cells = (0..SKY_RINGS as u16 - 1).flat_map(|ring| (0..SKY_HEADINGS as u16).map(move |heading| ring * row + heading));
    cells.flat_map(|low| [low, low + 1, low + row, low + row, low + 1, low + row + 1]).collect()
}
