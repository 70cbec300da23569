//! Minimum heights of the ground on a coarse grid, for conservative occlusion culling by hills.

use crate::render::gpu::device::Gpu;
use crate::state::DecodedScene;

/// Maximum number of cells along a side.
const SIDE_LIMIT: u32 = 512;

/// Minimum heights (m) row by row, number of cells along X and Z, and size of a cell (m).
pub(super) struct LowestLand {
    pub(super) heights_m: Vec<f32>,
    pub(super) cells: [u32; 2],
    pub(super) cell_m: [f32; 2],
}

impl LowestLand {
    /// Minimum heights of the whole map, in cells of about `grid_m`.
    pub(super) fn new(decoded: &DecodedScene, grid_m: f32) -> Self {
        let heights = decoded.heights();
        let (size, pixel_m, extent_m) = (heights.size_px(), heights.pixel_m(), decoded.scene().extent_m());
        let cells = extent_m.map(|extent_m| ((extent_m / grid_m) as u32).clamp(1, SIDE_LIMIT));
        let cell_m = [0, 1].map(|axis| extent_m[axis] / cells[axis] as f32);
        // The ground is bilinear between pixels, so never lower than the lowest of them.
        let span = |axis: usize, cell: u32| {
            let at = |n: u32| n as f32 * cell_m[axis] / pixel_m[axis];
            let last = size[axis] as usize - 1;
            (at(cell) as usize).min(last)..=(at(cell + 1).ceil() as usize).min(last)
        };
        let lowest = |x: u32, z: u32| {
            let rows = span(1, z).map(|row| &heights.heights_m()[row * size[0] as usize..]);
            rows.flat_map(|row| &row[span(0, x)]).copied().fold(f32::MAX, f32::min)
        };
        let heights_m = (0..cells[1]).flat_map(|z| (0..cells[0]).map(move |x| [x, z])).map(|[x, z]| lowest(x, z)).collect();
        Self { heights_m, cells, cell_m }
    }

    pub(super) fn texture(&self, gpu: &Gpu) -> wgpu::TextureView {
        let texels = bytemuck::cast_slice(&self.heights_m).to_vec();
        gpu.texture("lowest land", wgpu::TextureFormat::R32Float, self.cells, &[texels]).create_view(&Default::default())
    }
}
