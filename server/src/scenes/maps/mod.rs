//! The maps of the built-in scenes, made with fixed seeds.
//!
//! Only `+ − × ÷`, square roots and lattice noise go into them, so that every machine makes the same pixels.

mod dice;
mod jacksboro;
mod land;
mod meadow;

use std::io;
use std::path::{Path, PathBuf};

/// A grey 8-bit image, row by row from the north.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GreyMap {
    /// File name in the folder of the built-in scenes.
    pub name: &'static str,
    /// Pixels along X and Z.
    pub size_px: [u32; 2],
    /// Grey levels.
    pub levels: Vec<u8>,
}

impl GreyMap {
    /// The image as a PNG file.
    ///
    /// # Errors
    /// When the encoder refuses the image.
    pub fn to_png(&self) -> Result<Vec<u8>, png::EncodingError> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, self.size_px[0], self.size_px[1]);
        encoder.set_color(png::ColorType::Grayscale);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_compression(png::Compression::High);
        encoder.write_header()?.write_image_data(&self.levels)?;
        Ok(bytes)
    }
}

/// Makes every generated map anew.
pub fn generate() -> Vec<GreyMap> {
    let [height, covering] = meadow::maps();
    vec![height, covering, jacksboro::covering()]
}

/// Writes every generated map into `folder`, and names the files.
///
/// # Errors
/// When a file cannot be written.
pub fn write(folder: &Path) -> io::Result<Vec<PathBuf>> {
    std::fs::create_dir_all(folder)?;
    let file = |map: GreyMap| {
        let path = folder.join(map.name);
        std::fs::write(&path, map.to_png().map_err(io::Error::other)?)?;
        Ok(path)
    };
    generate().into_iter().map(file).collect()
}
