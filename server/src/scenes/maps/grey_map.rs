//! Grey images.

use prairie_core::terrain::{grey_png, grey_png_16};

/// A grey image, row by row from the north.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GreyMap {
    /// File name in the folder of the built-in scenes.
    pub name: &'static str,
    /// Pixels along X and Z.
    pub size_px: [u32; 2],
    /// Grey levels.
    pub levels: Levels,
}

/// Grey levels of a map.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Levels {
    /// 8 bits per pixel.
    Eight(Vec<u8>),
    /// 16 bits per pixel.
    Sixteen(Vec<u16>),
}

impl GreyMap {
    /// The image as a PNG file.
    pub fn to_png(&self) -> Vec<u8> {
        match &self.levels {
            Levels::Eight(levels) => grey_png(self.size_px, levels),
            Levels::Sixteen(levels) => grey_png_16(self.size_px, levels),
        }
    }
}
