//! Winds drawn by hand: a picture tells the direction and the strength of the air (001 Fig. 9b).

use std::collections::BTreeMap;
use std::io::Cursor;
use std::sync::Arc;
use thiserror::Error;

/// Drawings by the names that a scene gives them.
pub type Drawings = BTreeMap<String, Arc<Drawing>>;

/// Largest side of a drawing in pixels.
pub const SIDE_LIMIT_PX: u32 = 1024;

/// Level of red and green that stands for no direction.
const NONE: i16 = 128;

/// Which way, and how strongly, air blows over a square.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawing {
    size_px: [usize; 2],
    /// Directions along X and Z as long as the air is strong, 0 to 1, row by row from the north.
    blows: Vec<[f32; 2]>,
}

/// Why a picture is no drawing of a wind. The caller adds the file's name.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum DrawingError {
    /// Not a PNG, or a damaged one.
    #[error("is not a readable PNG: {0}")]
    Unreadable(String),
    /// A PNG of another kind.
    #[error("is a PNG of kind {0}; allowed: RGB without alpha, 8 bits")]
    Kind(String),
    /// Sides outside the limits.
    #[error("is {width} × {height} pixels; allowed: 2 × 2 to {SIDE_LIMIT_PX} × {SIDE_LIMIT_PX}")]
    Size {
        /// Pixels along X.
        width: u32,
        /// Pixels along Z.
        height: u32,
    },
    /// A pixel that blows nowhere.
    #[error(
        "has pixel ({column}, {row}) with a strength of {blue} in blue and no direction, 128 in red and in green; allowed: a direction wherever \
         blue is not 0"
    )]
    Aimless {
        /// Column from the west, from 0.
        column: usize,
        /// Row from the north, from 0.
        row: usize,
        /// The strength found.
        blue: u8,
    },
    /// No wind anywhere.
    #[error("blows nowhere: blue is 0 in all pixels; allowed: a strength of 1 to 255 in some")]
    Calm,
}

impl Drawing {
    /// Reads a PNG of RGB with 8 bits: red tells the direction from west to east and green from north to south, with 128 for none; blue
    /// tells the strength.
    ///
    /// # Errors
    /// [`DrawingError`]: no such PNG, its sides are out of range, a pixel is strong and blows nowhere, or none is strong.
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

        let blow = |(at, rgb): (usize, &[u8])| {
            let [x, z] = [rgb[0], rgb[1]].map(|level| f32::from(i16::from(level) - NONE));
            match (rgb[2], x.hypot(z)) {
                (0, _) => Ok([0.0; 2]),
                (blue, 0.0) => Err(DrawingError::Aimless { column: at % width, row: at / width, blue }),
                (blue, length) => Ok([x, z].map(|d| d / length * f32::from(blue) / 255.0)),
            }
        };
        let blows = bytes.chunks_exact(3).enumerate().map(blow).collect::<Result<Vec<_>, _>>()?;
        if blows.iter().all(|blow| *blow == [0.0; 2]) {
            return Err(DrawingError::Calm);
        }
        Ok(Self { size_px: [width, height], blows })
    }

    /// The direction at a place of the square, −1 to 1 from west to east and from north to south, as long as the air is strong there:
    /// bilinear between pixels, none outside.
    pub fn at(&self, place: [f32; 2]) -> [f32; 2] {
        if !place.iter().all(|share| (-1.0..=1.0).contains(share)) {
            return [0.0; 2];
        }
        let [(west, east, across), (north, south, down)] = [0, 1].map(|axis| {
            let last = self.size_px[axis] - 1;
            let at = (0.5 * (place[axis] + 1.0) * self.size_px[axis] as f32 - 0.5).clamp(0.0, last as f32);
            (at as usize, (at as usize + 1).min(last), at.fract())
        });
        let mix = |a: [f32; 2], b: [f32; 2], share: f32| [a[0] + (b[0] - a[0]) * share, a[1] + (b[1] - a[1]) * share];
        let row = |z: usize| mix(self.blows[z * self.size_px[0] + west], self.blows[z * self.size_px[0] + east], across);
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
    fn a_drawing_comes_back() {
        // East at full strength, west at half, south at full, and nothing.
        let drawn = rgb([2, 2], &[[255, 128, 255], [1, 128, 128], [128, 255, 255], [0, 0, 0]]);
        let drawing = Drawing::from_png(&drawn).unwrap();
        let close = |place: [f32; 2], [x, z]: [f32; 2]| {
            let found = drawing.at(place);
            assert!((found[0] - x).abs() < 1e-6 && (found[1] - z).abs() < 1e-6, "at {place:?}: {found:?}");
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
    fn what_is_no_drawing_is_told() {
        let told = |png: &[u8]| Drawing::from_png(png).unwrap_err().to_string();
        assert!(told(b"drawn").starts_with("is not a readable PNG"));
        let good = rgb([2, 2], &[[255, 128, 255]; 4]);
        assert!(told(&good[..good.len() - 20]).starts_with("is not a readable PNG"));
        assert_eq!(
            told(&png([2, 2], png::ColorType::Grayscale, &[0; 4])),
            "is a PNG of kind Grayscale 8 bits; allowed: RGB without alpha, 8 bits"
        );
        assert_eq!(told(&rgb([1, 2], &[[255, 128, 255]; 2])), "is 1 × 2 pixels; allowed: 2 × 2 to 1024 × 1024");
        assert!(told(&rgb([2, 2], &[[0; 3], [128, 128, 9], [0; 3], [0; 3]])).starts_with("has pixel (1, 0) with a strength of 9 in blue"));
        assert!(told(&rgb([2, 2], &[[255, 128, 0]; 4])).starts_with("blows nowhere"));
    }
}
