//! Shade that grass casts on grass and ground: compute passes that follow rays to the sun through the sward around the camera.

use crate::render::gpu::constants::{SHADE_CELLS, SHADE_MAPS, SHADE_PX, WORKGROUP_SIZE};
use crate::render::gpu::pipeline::{PassFactory, bind_as, storage_rw};
use crate::render::gpu::shaders;
use wgpu::BufferUsages;

/// Bytes of `Column` in `shade_map.wgsl`, and of a texel of the map.
const COLUMN_BYTES: u64 = 12;
const TEXEL_BYTES: u32 = 8;

pub(crate) struct ShadeMap {
    /// Finds the columns of the sward, then follows the rays.
    passes: [wgpu::ComputePipeline; 2],
    group: wgpu::BindGroup,
    pub(crate) texels: wgpu::Buffer,
    /// Whether a test has given the shade.
    #[cfg(test)]
    pub(crate) is_given: bool,
}

impl ShadeMap {
    pub(crate) fn new(factory: &PassFactory) -> Self {
        let gpu = &factory.gpu;
        let cells = u64::from(SHADE_MAPS * SHADE_CELLS);
        let columns = gpu.empty_buffer("columns of grass", cells * COLUMN_BYTES, BufferUsages::STORAGE);
        let texels = gpu.empty_buffer(
            "texels of the shade",
            cells * u64::from(TEXEL_BYTES),
            BufferUsages::STORAGE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST,
        );
        let layout = factory.layout("shade of grass", &[storage_rw(0), storage_rw(1)]);
        let group = bind_as(gpu, "shade of grass", &layout, &[(0, &columns), (1, &texels)]);
        let module = factory.shader("shade of grass", shaders::SHADE_MAP, &[]);
        let passes = ["stand", "cast_shade"].map(|entry| factory.compute("shade of grass", &module, entry, &layout));
        Self {
            passes,
            group,
            texels,
            #[cfg(test)]
            is_given: false,
        }
    }

    /// Computes the shade; the bind group of the frame is set.
    pub(crate) fn cast(&self, pass: &mut wgpu::ComputePass<'_>) {
        #[cfg(test)]
        if self.is_given {
            return;
        }
        pass.set_bind_group(1, &self.group, &[]);
        for pipeline in &self.passes {
            pass.set_pipeline(pipeline);
            pass.dispatch_workgroups((SHADE_MAPS * SHADE_CELLS).div_ceil(WORKGROUP_SIZE), 1, 1);
        }
    }

    /// Copies the shade to the texture that the other passes sample.
    pub(crate) fn show(&self, encoder: &mut wgpu::CommandEncoder, maps: &wgpu::Texture) {
        let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(SHADE_PX * TEXEL_BYTES), rows_per_image: Some(SHADE_PX) };
        encoder.copy_buffer_to_texture(wgpu::TexelCopyBufferInfo { buffer: &self.texels, layout }, maps.as_image_copy(), maps.size());
    }
}
