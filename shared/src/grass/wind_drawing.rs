//! Hand-drawn wind fields: direction and strength of the wind as the colours of a picture (Chen & Johan, Fig. 9b).

use super::vector::length;
use std::collections::BTreeMap;
use std::io::Cursor;
use std::sync::Arc;
use thiserror::Error;

/// Wind drawings by their names in a scene.
pub type WindDrawings = BTreeMap<String, Arc<WindDrawing>>;

/// Largest side of a drawing in pixels.
pub const SIDE_LIMIT_PX: u32 = 1024;

/// Level of red and green that means zero.
const ZERO_LEVEL: i16 = 128;

/// Wind direction and strength over a square.
#[derive(Clone, Debug, PartialEq)]
pub struct WindDrawing {
    size_px: [usize; 2],
    /// Wind vectors along X and Z, of length 0 to 1, row by row from the north.
    wind: Vec<[f32; 2]>,
    png: Vec<u8>,
}

/// Reason why a picture is not a wind drawing. The caller adds the file's name.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum DrawingError {
    /// The file is not a PNG, or is damaged.
    #[error("is not a readable PNG: {0}")]
    Unreadable(String),
    /// The PNG has another colour type or bit depth.
    #[error("is a PNG of kind {0}; allowed: RGB without alpha, 8 bits")]
    Kind(String),
    /// The size is out of range.
    #[error("is {width} × {height} pixels; allowed: 2 × 2 to {SIDE_LIMIT_PX} × {SIDE_LIMIT_PX}")]
    Size {
        /// Pixels along X.
        width: u32,
        /// Pixels along Z.
        height: u32,
    },
    /// A pixel has a strength but no direction.
    #[error(
        "has pixel ({column}, {row}) with a strength of {blue} in blue and no direction, 128 in red and in green; allowed: a direction wherever \
         blue is not 0"
    )]
    NoDirection {
        /// Column from the west, from 0.
        column: usize,
        /// Row from the north, from 0.
        row: usize,
        /// Strength of the pixel.
        blue: u8,
    },
    /// All pixels have strength zero.
    #[error("blows nowhere: blue is 0 in all pixels; allowed: a strength of 1 to 255 in some")]
    Calm,
}

impl WindDrawing {
    /// Reads an RGB PNG with 8 bits per channel. Red is the direction from west to east and green from north to south, with 128 for zero; blue is the
    /// strength.
    ///
    /// # Errors
    /// [`DrawingError`] when the file is not such a PNG, its size is out of range, a pixel has a strength but no direction, or all strengths are zero.
    pub fn from_png(png_bytes: &[u8]) -> Result<Self, DrawingError> {
        let unreadable = |error: png::DecodingError| DrawingError::Unreadable(error.to_string());
        let mut decoder = png::Decoder::new(Cursor::new(png_bytes));
        decoder.set_transformations(png::Transformations::IDENTITY);
        let mut reader = decoder.read_info().map_err(unreadable)?;
        let info = reader.info();
        let (width, height) = (info.width, info.height);
        if (info.color_type, info.bit_depth) != (png::ColorType::Rgb, png::BitDepth::Eight) {
            return Err(DrawingError::Kind(format!("{:?} {} bits", info.color_type, info.bit_depth as u8)));
        }
        let sides = 2..=SIDE_LIMIT_PX;
        if !(sides.contains(&width) && sides.contains(&height)) {
            return Err(DrawingError::Size { width, height });
        }
        let [width, height] = [width as usize, height as usize];
        let mut bytes = vec![0; width * height * 3];
        reader.next_frame(&mut bytes).map_err(unreadable)?;

        let wind = |(at, rgb): (usize, &[u8])| {
            let [x, z] = [rgb[0], rgb[1]].map(|level| f32::from(i16::from(level) - ZERO_LEVEL));
            match (rgb[2], length([x, z])) {
                (0, _) => Ok([0.0; 2]),
                (blue, 0.0) => Err(DrawingError::NoDirection { column: at % width, row: at / width, blue }),
                (blue, length) => Ok([x, z].map(|d| d / length * f32::from(blue) / 255.0)),
            }
        };
        let wind = bytes.chunks_exact(3).enumerate().map(wind).collect::<Result<Vec<_>, _>>()?;
        if wind.iter().all(|wind| *wind == [0.0; 2]) {
            return Err(DrawingError::Calm);
        }
        Ok(Self { size_px: [width, height], wind, png: png_bytes.to_vec() })
    }

    /// The bytes of the PNG file.
    pub fn png(&self) -> &[u8] {
        &self.png
    }

    /// The wind vector, of length 0 to 1, at a position in the square: −1 to 1 from west to east and from north to south. Bilinear between pixels, zero
    /// outside.
    pub fn at(&self, position: [f32; 2]) -> [f32; 2] {
        if !position.iter().all(|coordinate| (-1.0..=1.0).contains(coordinate)) {
            return [0.0; 2];
        }
        let [(west, east, across), (north, south, down)] = [0, 1].map(|axis| {
            let last = self.size_px[axis] - 1;
            let at = (0.5 * (position[axis] + 1.0) * self.size_px[axis] as f32 - 0.5).clamp(0.0, last as f32);
            (at as usize, (at as usize + 1).min(last), at.fract())
        });
        let mix = |a: [f32; 2], b: [f32; 2], weight: f32| [a[0] + (b[0] - a[0]) * weight, a[1] + (b[1] - a[1]) * weight];
        let row = |z: usize| mix(self.wind[z * self.size_px[0] + west], self.wind[z * self.size_px[0] + east], across);
        mix(row(north), row(south), down)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn png([width, height]: [u32; 2], color: png::ColorType, bytes: &[u8]) -> Vec<u8> {
        let mut file = vec![];
        let mut encoder = png::Encoder::new(&mut file, width, height);
        encoder.set_color(color);
        encoder.set_depth(png::BitDepth::Eight);
        let mut writer = encoder.write_header().unwrap();
        writer.write_image_data(bytes).unwrap();
        writer.finish().unwrap();
        file
    }

    fn rgb(size_px: [u32; 2], pixels: &[[u8; 3]]) -> Vec<u8> {
        png(size_px, png::ColorType::Rgb, &pixels.concat())
    }

    #[test]
    fn a_drawing_gives_the_direction_and_strength_of_its_pixels() {
        // East at full strength, west at half, south at full, and no wind.
        let drawn = rgb([2, 2], &[[255, 128, 255], [1, 128, 128], [128, 255, 255], [0, 0, 0]]);
        let drawing = WindDrawing::from_png(&drawn).unwrap();
        let close = |position: [f32; 2], [x, z]: [f32; 2]| {
            let found = drawing.at(position);
            assert!((found[0] - x).abs() < 1e-6 && (found[1] - z).abs() < 1e-6, "at {position:?}: {found:?}");
        };
        let half = 128.0 / 255.0;
        close([-0.5, -0.5], [1.0, 0.0]);
        close([0.5, -0.5], [-half, 0.0]);
        close([-0.5, 0.5], [0.0, 1.0]);
        close([0.5, 0.5], [0.0, 0.0]);
        close([0.0, -0.5], [0.5 * (1.0 - half), 0.0]);
        close([-1.0, -1.0], [1.0, 0.0]);
        close([-1.01, 0.0], [0.0, 0.0]);
    }

    #[test]
    fn pictures_that_are_no_wind_drawing_are_rejected() {
        let error = |png: &[u8]| WindDrawing::from_png(png).unwrap_err().to_string();
        assert!(error(b"drawn").starts_with("is not a readable PNG"));
        let good = rgb([2, 2], &[[255, 128, 255]; 4]);
        assert!(error(&good[..good.len() - 20]).starts_with("is not a readable PNG"));
        assert_eq!(
            error(&png([2, 2], png::ColorType::Grayscale, &[0; 4])),
            "is a PNG of kind Grayscale 8 bits; allowed: RGB without alpha, 8 bits"
        );
        assert_eq!(error(&rgb([1, 2], &[[255, 128, 255]; 2])), "is 1 × 2 pixels; allowed: 2 × 2 to 1024 × 1024");
        assert!(error(&rgb([2, 2], &[[0; 3], [128, 128, 9], [0; 3], [0; 3]])).starts_with("has pixel (1, 0) with a strength of 9 in blue"));
        assert!(error(&rgb([2, 2], &[[255, 128, 0]; 4])).starts_with("blows nowhere"));
    }
}
