//! 8-bit RGBA pictures: reading, comparing, and writing them as PNG or JPEG.

mod scale;
mod store;
mod tile;

use std::fs;
use std::io::Cursor;
use std::path::Path;

use anyhow::{Context as _, Result, bail, ensure};
use png::{ColorType, Decoder, Transformations};

/// An 8-bit RGBA picture, rows from top to bottom.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// Width (pixels).
    pub width: u32,
    /// Height (pixels).
    pub height: u32,
    /// `width * height * 4` bytes.
    pub rgba: Vec<u8>,
}

impl Picture {
    /// Decodes a PNG of any colour type to 8-bit RGBA.
    ///
    /// # Errors
    /// When the bytes are not a complete PNG.
    pub fn from_png(png: &[u8]) -> Result<Self> {
        let mut decoder = Decoder::new(Cursor::new(png));
        decoder.set_transformations(Transformations::normalize_to_color8() | Transformations::ALPHA);
        let mut reader = decoder.read_info().context("not a PNG")?;
        let mut bytes = vec![0; reader.output_buffer_size().context("a PNG too large to decode")?];
        let info = reader.next_frame(&mut bytes)?;
        bytes.truncate(info.buffer_size());
        let rgba = match info.color_type {
            ColorType::Rgba => bytes,
            ColorType::GrayscaleAlpha => bytes.chunks_exact(2).flat_map(|pixel| [pixel[0], pixel[0], pixel[0], pixel[1]]).collect(),
            other => bail!("the PNG decoded to {other:?} instead of RGBA"),
        };
        Ok(Self { width: info.width, height: info.height, rgba })
    }

    /// Reads a PNG file.
    ///
    /// # Errors
    /// When the file cannot be read or is not a PNG.
    pub fn load(path: &Path) -> Result<Self> {
        let png = fs::read(path).with_context(|| path.display().to_string())?;
        Self::from_png(&png).with_context(|| path.display().to_string())
    }

    /// The pixel at `x` from the left and `y` from the top.
    ///
    /// # Panics
    /// Outside of the picture.
    #[must_use]
    pub fn pixel(&self, x: u32, y: u32) -> [u8; 4] {
        assert!(x < self.width && y < self.height, "pixel ({x}, {y}) of a picture of {}x{}", self.width, self.height);
        let start = (y as usize * self.width as usize + x as usize) * 4;
        [self.rgba[start], self.rgba[start + 1], self.rgba[start + 2], self.rgba[start + 3]]
    }

    /// A rectangle of the picture: left, top, width and height (px).
    ///
    /// # Panics
    /// When the rectangle reaches beyond the picture.
    #[must_use]
    pub fn cropped(&self, [left, top, width, height]: [u32; 4]) -> Self {
        let positions = (top..top + height).flat_map(|y| (left..left + width).map(move |x| [x, y]));
        Self { width, height, rgba: positions.flat_map(|[x, y]| self.pixel(x, y)).collect() }
    }

    /// Difference from another picture of the same size.
    ///
    /// # Errors
    /// When the sizes differ.
    pub fn difference(&self, other: &Self) -> Result<Difference> {
        ensure!(
            (self.width, self.height) == (other.width, other.height),
            "a picture of {}x{} compared with one of {}x{}",
            self.width,
            self.height,
            other.width,
            other.height
        );
        let distances = self.rgba.iter().zip(&other.rgba).map(|(a, b)| a.abs_diff(*b));
        let mean = distances.clone().map(f64::from).sum::<f64>() / self.rgba.len().max(1) as f64;
        let worst: Vec<u8> = self.rgba.chunks_exact(4).zip(other.rgba.chunks_exact(4)).map(|(a, b)| farthest(a, b)).collect();
        let changed = worst.iter().filter(|distance| **distance > Difference::VISIBLE).count() as f64 / worst.len().max(1) as f64;
        Ok(Difference { mean, changed })
    }
}

/// Difference between two pictures, pixel by pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference {
    /// Mean absolute difference of the channels, 0 to 255.
    pub mean: f64,
    /// Fraction of the pixels with a channel that differs by more than [`Difference::VISIBLE`].
    pub changed: f64,
}

impl Difference {
    /// Difference of a channel (of 255) above which a pixel counts as changed.
    pub const VISIBLE: u8 = 16;
    /// Largest difference at which a stored picture is not rewritten: nobody sees it.
    pub const INVISIBLE: Self = Self { mean: 0.5, changed: 0.001 };

    /// Whether neither figure exceeds its bound.
    #[must_use]
    pub fn is_within(self, bound: Self) -> bool {
        self.mean <= bound.mean && self.changed <= bound.changed
    }
}

fn farthest(a: &[u8], b: &[u8]) -> u8 {
    a.iter().zip(b).map(|(a, b)| a.abs_diff(*b)).max().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gradient() -> Picture {
        Picture { width: 3, height: 2, rgba: (0..24).map(|byte| byte * 10).collect() }
    }

    #[test]
    fn difference_counts_visible_pixels() -> Result<()> {
        let mut other = gradient();
        other.rgba[4] += Difference::VISIBLE;
        other.rgba[9] += Difference::VISIBLE + 1;
        let difference = gradient().difference(&other)?;
        assert_eq!(difference.changed, 1.0 / 6.0);
        assert_eq!(difference.mean, 33.0 / 24.0);
        Ok(())
    }

    #[test]
    fn a_rectangle_is_cropped() {
        let part = gradient().cropped([1, 0, 2, 2]);
        assert_eq!((part.width, part.height), (2, 2));
        assert_eq!(part.rgba, [&gradient().rgba[4..12], &gradient().rgba[16..24]].concat());
    }

    #[test]
    fn pictures_of_different_sizes_have_no_difference() {
        let narrow = Picture { width: 2, height: 3, rgba: vec![0; 24] };
        let error = gradient().difference(&narrow).expect_err("the sizes differ").to_string();
        assert_eq!(error, "a picture of 3x2 compared with one of 2x3");
    }
}
