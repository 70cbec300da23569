//! The maps of the built-in scenes, made with fixed seeds.
//!
//! Only `+ − × ÷`, square roots and lattice noise go into them, so that every machine makes the same pixels.

mod blades;
mod continuum;
mod dice;
mod jacksboro;
mod knolls;
mod land;
mod meadow;

use shared::terrain::{grey_png, grey_png_16};
use std::io;
use std::path::{Path, PathBuf};

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
    /// 8 bits a pixel.
    Eight(Vec<u8>),
    /// 16 bits a pixel.
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

/// Makes every generated map anew.
pub fn generate() -> Vec<GreyMap> {
    let mut maps = vec![jacksboro::covering()];
    maps.extend(meadow::maps());
    maps.extend(continuum::maps());
    maps.extend(blades::maps());
    maps.extend(knolls::maps());
    maps
}

/// Writes every generated map into `folder`, and names the files.
///
/// # Errors
/// When a file cannot be written.
pub fn write(folder: &Path) -> io::Result<Vec<PathBuf>> {
    std::fs::create_dir_all(folder)?;
    let file = |map: GreyMap| {
        let path = folder.join(map.name);
        std::fs::write(&path, map.to_png())?;
        Ok(path)
    };
    generate().into_iter().map(file).collect()
}
