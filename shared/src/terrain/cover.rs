//! Covering map: gap, tree, stone, grass, species or model by position (Zhang §5.5.2, Table 2).

use super::{MapError, decode_grey};

/// Cover of a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cover {
    /// Bare ground (ID 0).
    Gap,
    /// A tree (ID 253).
    Tree,
    /// A stone (ID 254).
    Stone,
    /// Grass (ID 255).
    Grass,
    /// Any other ID: a species of grass or of underbrush if the scene [names it](crate::scene::Scene::is_grass), else bare ground; a
    /// [model](crate::scene::CoverModel) may stand on it.
    Free(u8),
}

impl From<u8> for Cover {
    fn from(id: u8) -> Self {
        match id {
            0 => Self::Gap,
            253 => Self::Tree,
            254 => Self::Stone,
            255 => Self::Grass,
            free => Self::Free(free),
        }
    }
}

/// Covering IDs over the whole world; the map is stretched to the world's extent, nearest pixel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CoverMap {
    width_px: u32,
    depth_px: u32,
    ids: Vec<u8>,
}

impl CoverMap {
    /// Reads an 8-bit grey PNG.
    ///
    /// # Errors
    /// [`MapError`] when the bytes are not a PNG of that kind, or its sides are out of range.
    pub fn from_png(png_bytes: &[u8]) -> Result<Self, MapError> {
        let image = decode_grey(png_bytes, false)?;
        let ids = image.levels.iter().map(|&level| level as u8).collect();
        Ok(Self { width_px: image.width, depth_px: image.height, ids })
    }

    /// Pixels along X and Z.
    pub fn size_px(&self) -> [u32; 2] {
        [self.width_px, self.depth_px]
    }

    /// IDs row by row from the north.
    pub fn ids(&self) -> &[u8] {
        &self.ids
    }

    /// Cover at the point `(x_m, z_m)` of a world of `extent_m`; gap outside the world.
    pub fn at(&self, x_m: f32, z_m: f32, extent_m: [f32; 2]) -> Cover {
        let px = (x_m / extent_m[0] * self.width_px as f32).floor();
        let pz = (z_m / extent_m[1] * self.depth_px as f32).floor();
        if px < 0.0 || pz < 0.0 || px >= self.width_px as f32 || pz >= self.depth_px as f32 {
            return Cover::Gap;
        }
        Cover::from(self.ids[pz as usize * self.width_px as usize + px as usize])
    }

    /// The first pixel, row by row from the north-west, whose ID satisfies `is_meant`: its column and row, and the ID.
    pub fn find(&self, is_meant: impl Fn(u8) -> bool) -> Option<([u32; 2], u8)> {
        let index = self.ids.iter().position(|&id| is_meant(id))?;
        let width = self.width_px as usize;
        Some(([(index % width) as u32, (index / width) as u32], self.ids[index]))
    }

    /// Makes gaps of the pixels between the lowest and the highest X and Z of `bounds_m` that `is_cleared`, given ID, north-western corner and sides (m).
    pub(super) fn clear_where(
        &mut self,
        [low_m, high_m]: [[f32; 2]; 2],
        extent_m: [f32; 2],
        is_cleared: impl Fn(u8, [f32; 2], [f32; 2]) -> bool,
    ) {
        let size_px = self.size_px();
        let side_m: [f32; 2] = std::array::from_fn(|axis| extent_m[axis] / size_px[axis] as f32);
        // Casts saturate at 0; a pixel more on each side covers the rounding.
        let [columns, rows] = [0, 1].map(|axis| {
            let first = ((low_m[axis] / side_m[axis]) as u32).saturating_sub(1);
            first..((high_m[axis] / side_m[axis]) as u32).saturating_add(2).min(size_px[axis])
        });
        for row in rows {
            for column in columns.clone() {
                let id = &mut self.ids[row as usize * self.width_px as usize + column as usize];
                if *id != 0 && is_cleared(*id, [column as f32 * side_m[0], row as f32 * side_m[1]], side_m) {
                    *id = 0;
                }
            }
        }
    }

    /// World coordinates of the centres of the pixels with this `cover` (m).
    pub fn places_m(&self, cover: Cover, extent_m: [f32; 2]) -> impl Iterator<Item = [f32; 2]> + '_ {
        let pixel_m = [extent_m[0] / self.width_px as f32, extent_m[1] / self.depth_px as f32];
        let width = self.width_px as usize;
        self.ids
            .iter()
            .enumerate()
            .filter(move |&(_, &id)| Cover::from(id) == cover)
            .map(move |(i, _)| [((i % width) as f32 + 0.5) * pixel_m[0], ((i / width) as f32 + 0.5) * pixel_m[1]])
    }
}
