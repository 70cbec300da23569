//! Minimum heights of the ground on a coarse grid, and the conservative horizon test: what hills hide from the eye.

use crate::render::gpu::constants::{DRAWN_LOWER, DRAWN_LOWER_M, HORIZON_SAMPLES};
use crate::render::gpu::device::Gpu;
use crate::state::DecodedScene;
use glam::Vec3;

/// Maximum number of cells along a side.
const SIDE_LIMIT: u32 = 512;

/// Minimum heights (m) row by row, number of cells along X and Z, and size of a cell (m).
pub(crate) struct LowestLand {
    pub(crate) heights_m: Vec<f32>,
    pub(crate) cells: [u32; 2],
    pub(crate) cell_m: [f32; 2],
}

impl LowestLand {
    /// Minimum heights of the whole map, in cells of about `grid_m`.
    pub(crate) fn new(decoded: &DecodedScene, grid_m: f32) -> Self {
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

    /// Whether hills hide a box (m) from an eye whose ground is at `ground_m`: at some fraction of the way all rays to the box cross one rectangle, whose lowest
    /// ground, as it is drawn, is above the ray to the top of the box. Twin of `is_hidden` in `grids.wgsl`.
    pub(crate) fn hides(&self, eye_m: Vec3, ground_m: f32, [low_m, high_m]: [Vec3; 2]) -> bool {
        // An eye below the ground sees through it.
        if eye_m.y < ground_m + DRAWN_LOWER_M {
            return false;
        }
        let far_m = (low_m - eye_m).abs().max((high_m - eye_m).abs()).with_y(0.0).length();
        (1..HORIZON_SAMPLES).any(|sample| {
            let fraction = sample as f32 / HORIZON_SAMPLES as f32;
            let [low, high] = [low_m, high_m].map(|end_m| eye_m.lerp(end_m, fraction));
            let lowest_m = self.lowest_within_m([low.x, low.z], [high.x, high.z]);
            lowest_m - DRAWN_LOWER_M - DRAWN_LOWER * far_m * fraction > high.y
        })
    }

    /// Lower bound of the height of the ground in a rectangle (m); −∞ beyond the edge of the map.
    fn lowest_within_m(&self, low_m: [f32; 2], high_m: [f32; 2]) -> f32 {
        let cell = |at_m: [f32; 2]| [0, 1].map(|axis| (at_m[axis] / self.cell_m[axis]).floor());
        let (first, last) = (cell(low_m), cell(high_m));
        if (0..2).any(|axis| first[axis] < 0.0 || last[axis] >= self.cells[axis] as f32) {
            return f32::NEG_INFINITY;
        }
        let row = |z: usize| &self.heights_m[z * self.cells[0] as usize..][first[0] as usize..=last[0] as usize];
        (first[1] as usize..=last[1] as usize).flat_map(row).copied().fold(f32::INFINITY, f32::min)
    }

    pub(crate) fn texture(&self, gpu: &Gpu) -> wgpu::TextureView {
        let texels = bytemuck::cast_slice(&self.heights_m).to_vec();
        gpu.texture("lowest land", wgpu::TextureFormat::R32Float, self.cells, &[texels]).create_view(&Default::default())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use prairie_core::scene::{Scene, TerrainMaps};
    use prairie_core::terrain::grey_png;
    use prairie_core::wire::ServerMessage;

    /// Flat land with a ridge 10 m high across its middle, from 120 m to 136 m along X.
    fn ridge() -> LowestLand {
        let maps = TerrainMaps { height_map: String::new(), covering_map: String::new(), pixel_m: [8.0; 2], level_m: 0.1, base_m: 0.0 };
        let heights: Vec<u8> = (0..33 * 33).map(|at| if (15..=17).contains(&(at % 33)) { 100 } else { 0 }).collect();
        let mut mirror = crate::state::Mirror::default();
        let scene = ServerMessage::Scene {
            scene: Box::new(Scene::new(maps)),
            height_png: grey_png([33; 2], &heights),
            covering_png: grey_png([64; 2], &[255; 64 * 64]),
            nutrient_png: Vec::new(),
            models: Vec::new(),
            shapes: Default::default(),
        };
        mirror.apply(scene).expect("a sound scene");
        LowestLand::new(mirror.decoded_scene().expect("a scene"), 8.0)
    }

    fn tree(x_m: f32, tall_m: f32) -> [Vec3; 2] {
        [Vec3::new(x_m - 2.0, 0.0, 126.0), Vec3::new(x_m + 2.0, tall_m, 130.0)]
    }

    #[test]
    fn a_ridge_hides_what_is_low_behind_it() {
        let (land, eye_m) = (ridge(), Vec3::new(60.0, 2.0, 128.0));
        assert!(land.hides(eye_m, 0.0, tree(180.0, 6.0)));
        // Taller than the ridge, before it, seen from above it, and with an eye below the ground.
        assert!(!land.hides(eye_m, 0.0, tree(180.0, 30.0)));
        assert!(!land.hides(eye_m, 0.0, tree(100.0, 6.0)));
        assert!(!land.hides(eye_m.with_y(30.0), 0.0, tree(180.0, 6.0)));
        assert!(!land.hides(eye_m, 5.0, tree(180.0, 6.0)));
        // The way leaves the map.
        assert!(!land.hides(Vec3::new(-60.0, 2.0, 128.0), 0.0, tree(-90.0, 6.0)));
    }
}
