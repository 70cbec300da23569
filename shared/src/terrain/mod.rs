//! The land: heights, what covers it, its normals.

mod cover;
mod height;
mod kinds;

pub use cover::{Cover, CoverMap};
pub use height::HeightMap;
pub use kinds::KindMap;

use thiserror::Error;

/// Why a map could not be read. The caller adds the file's name.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum MapError {
    /// Not a PNG, or a damaged one.
    #[error("is not a readable PNG: {0}")]
    Unreadable(String),
    /// A kind of PNG that holds no single grey channel of 8 (or, for heights, 16) bits.
    #[error("is a PNG of kind {found}; allowed: {allowed}")]
    Kind {
        /// The kind found, such as `Rgba 8 bits`.
        found: String,
        /// The kinds allowed.
        allowed: &'static str,
    },
    /// Sides outside the limits.
    #[error("is {width} × {height} pixels; allowed: 2 × 2 to {limit} × {limit}")]
    Size {
        /// Pixels along X.
        width: u32,
        /// Pixels along Z.
        height: u32,
        /// Largest side.
        limit: u32,
    },
}

/// Largest side of a map in pixels; the smallest limit on textures that WebGPU guarantees.
pub const MAP_LIMIT_PX: u32 = 8192;

/// A grey PNG file of 8 bits a pixel; `levels` row by row from the top left. The same levels give the same bytes.
///
/// # Panics
/// When there is not one level for each pixel, or no pixel.
pub fn grey_png(size_px: [u32; 2], levels: &[u8]) -> Vec<u8> {
    encode_grey(size_px, png::BitDepth::Eight, levels)
}

/// A grey PNG file of 16 bits a pixel, as [`grey_png`].
///
/// # Panics
/// As [`grey_png`].
pub fn grey_png_16(size_px: [u32; 2], levels: &[u16]) -> Vec<u8> {
    let bytes: Vec<u8> = levels.iter().flat_map(|level| level.to_be_bytes()).collect();
    encode_grey(size_px, png::BitDepth::Sixteen, &bytes)
}

fn encode_grey([width, height]: [u32; 2], depth: png::BitDepth, level_bytes: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(depth);
    encoder.set_compression(png::Compression::High);
    let mut writer = encoder.write_header().expect("the picture has a pixel");
    writer.write_image_data(level_bytes).expect("as many levels as pixels");
    writer.finish().expect("memory takes what is written");
    bytes
}

/// A decoded grey PNG.
struct GreyImage {
    width: u32,
    height: u32,
    /// Row-major from the top left; 8-bit values stay 0..=255.
    levels: Vec<u16>,
    bits: u8,
}

fn decode_grey(png_bytes: &[u8], allow_16_bits: bool) -> Result<GreyImage, MapError> {
    let unreadable = |error: png::DecodingError| MapError::Unreadable(error.to_string());
    let mut decoder = png::Decoder::new(std::io::Cursor::new(png_bytes));
    decoder.set_transformations(png::Transformations::IDENTITY);
    let mut reader = decoder.read_info().map_err(unreadable)?;
    let info = reader.info();
    let (width, height) = (info.width, info.height);
    let bits = match (info.color_type, info.bit_depth) {
        (png::ColorType::Grayscale, png::BitDepth::Eight) => 8,
        (png::ColorType::Grayscale, png::BitDepth::Sixteen) if allow_16_bits => 16,
        (colour, depth) => {
            let allowed = if allow_16_bits { "grey without alpha, 8 or 16 bits" } else { "grey without alpha, 8 bits" };
            return Err(MapError::Kind { found: format!("{colour:?} {} bits", depth as u8), allowed });
        }
    };
    if width < 2 || height < 2 || width > MAP_LIMIT_PX || height > MAP_LIMIT_PX {
        return Err(MapError::Size { width, height, limit: MAP_LIMIT_PX });
    }
    let mut bytes = vec![0; width as usize * height as usize * usize::from(bits / 8)];
    reader.next_frame(&mut bytes).map_err(unreadable)?;
    let levels = match bits {
        8 => bytes.into_iter().map(u16::from).collect(),
        _ => bytes.chunks_exact(2).map(|pair| u16::from_be_bytes([pair[0], pair[1]])).collect(),
    };
    Ok(GreyImage { width, height, levels, bits })
}
