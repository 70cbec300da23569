//! Height map: bilinear heights and normals at any position (Zhang §5.5.1, Eqs 11–13).

use super::{MapError, decode_grey};
use crate::scene::TerrainMaps;
use glam::Vec3;

/// Heights of the land, bilinear between pixels and constant outside the map.
#[derive(Clone, Debug, PartialEq)]
pub struct HeightMap {
    width_px: u32,
    depth_px: u32,
    pixel_m: [f32; 2],
    heights_m: Vec<f32>,
}

impl HeightMap {
    /// Reads a grey PNG of 8 or 16 bits with the scale of `maps`.
    ///
    /// # Errors
    /// [`MapError`] when the bytes are not a PNG of that kind, or its sides are out of range.
    pub fn from_png(png_bytes: &[u8], maps: &TerrainMaps) -> Result<Self, MapError> {
        let image = decode_grey(png_bytes, true)?;
        debug_assert!(image.bits == 8 || image.bits == 16);
        let heights_m = image.levels.iter().map(|&level| maps.base_m + maps.level_m * f32::from(level)).collect();
        Ok(Self { width_px: image.width, depth_px: image.height, pixel_m: maps.pixel_m, heights_m })
    }

    /// A map from heights: `width_px × depth_px` values in metres, row by row from the north.
    ///
    /// # Panics
    /// When the number of heights is not `width_px · depth_px`, or a side is less than 2.
    pub fn from_heights(width_px: u32, depth_px: u32, pixel_m: [f32; 2], heights_m: Vec<f32>) -> Self {
        assert!(width_px >= 2 && depth_px >= 2 && heights_m.len() == (width_px * depth_px) as usize);
        Self { width_px, depth_px, pixel_m, heights_m }
    }

    /// Pixels along X and Z.
    pub fn size_px(&self) -> [u32; 2] {
        [self.width_px, self.depth_px]
    }

    /// Distance between pixel centres along X and Z (m).
    pub fn pixel_m(&self) -> [f32; 2] {
        self.pixel_m
    }

    /// Heights in metres, row by row from the north.
    pub fn heights_m(&self) -> &[f32] {
        &self.heights_m
    }

    /// Lowest and highest height (m).
    pub fn range_m(&self) -> [f32; 2] {
        self.heights_m.iter().fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], &h| [low.min(h), high.max(h)])
    }

    /// Height of the land at `(x_m, z_m)` (m).
    pub fn height_m(&self, x_m: f32, z_m: f32) -> f32 {
        let (corners, fx, fz) = self.cell(x_m, z_m);
        let [nw, ne, sw, se] = corners;
        let north = nw + (ne - nw) * fx;
        let south = sw + (se - sw) * fx;
        north + (south - north) * fz
    }

    /// Slope of the bilinear surface (∂h/∂x, ∂h/∂z) at `(x_m, z_m)`.
    pub fn slope(&self, x_m: f32, z_m: f32) -> [f32; 2] {
        let ([nw, ne, sw, se], fx, fz) = self.cell(x_m, z_m);
        let east = (ne - nw) + ((se - sw) - (ne - nw)) * fz;
        let south = (sw - nw) + ((se - ne) - (sw - nw)) * fx;
        [east / self.pixel_m[0], south / self.pixel_m[1]]
    }

    /// Unit normal of the land at `(x_m, z_m)`.
    pub fn normal(&self, x_m: f32, z_m: f32) -> Vec3 {
        let [east, south] = self.slope(x_m, z_m);
        Vec3::new(-east, 1.0, -south).normalize()
    }

    fn cell(&self, x_m: f32, z_m: f32) -> ([f32; 4], f32, f32) {
        let (x0, fx) = split(x_m / self.pixel_m[0], self.width_px);
        let (z0, fz) = split(z_m / self.pixel_m[1], self.depth_px);
        let row = self.width_px as usize;
        let nw = z0 * row + x0;
        let h = &self.heights_m;
        ([h[nw], h[nw + 1], h[nw + row], h[nw + row + 1]], fx, fz)
    }
}

/// Lower pixel and fraction towards the next one, clamped so that both pixels exist.
fn split(at_px: f32, count_px: u32) -> (usize, f32) {
    let at_px = at_px.clamp(0.0, (count_px - 1) as f32);
    let low = (at_px as usize).min(count_px as usize - 2);
    (low, at_px - low as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tilted() -> HeightMap {
        let heights = (0..4 * 3).map(|i| (i % 4) as f32 * 2.0 + (i / 4) as f32 * 0.5).collect();
        HeightMap::from_heights(4, 3, [2.0, 0.5], heights)
    }

    #[test]
    fn a_plane_is_reproduced_everywhere() {
        let map = tilted();
        for (x, z) in [(0.0, 0.0), (1.3, 0.2), (5.9, 0.99), (3.0, 0.5)] {
            assert!((map.height_m(x, z) - (x + z)).abs() < 1e-5, "at {x}, {z}");
            let [east, south] = map.slope(x, z);
            assert!((east - 1.0).abs() < 1e-5 && (south - 1.0).abs() < 1e-5);
        }
    }

    #[test]
    fn the_edge_value_holds_outside() {
        let map = tilted();
        assert_eq!(map.height_m(-50.0, -50.0), map.height_m(0.0, 0.0));
        assert_eq!(map.height_m(500.0, 500.0), map.height_m(6.0, 1.0));
    }
}
