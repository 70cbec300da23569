//! Terrain: heights, normals and cover.

mod cover;
mod height;
mod kinds;
mod model_boxes;

pub use cover::{Cover, CoverMap};
pub use height::HeightMap;
pub use kinds::KindMap;
pub use model_boxes::{MODEL_BOXES_LIMIT, MODEL_PIXELS_LIMIT, ModelBox, clear_under_models, has_too_many_models, model_boxes};

use thiserror::Error;

/// Reasons why a map could not be read. The caller adds the name of the file.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum MapError {
    /// Not a PNG, or a damaged one.
    #[error("is not a readable PNG: {0}")]
    Unreadable(String),
    /// A PNG that is not one grey channel of 8 (or, for heights, 16) bits.
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

/// Largest side of a map in pixels; the smallest texture limit that WebGPU guarantees.
pub const MAP_LIMIT_PX: u32 = 8192;

/// Encodes a grey PNG of 8 bits a pixel; `levels` are row by row from the top left. The same levels give the same bytes.
///
/// # Panics
/// When there are no pixels, or `levels` has another length.
pub fn grey_png(size_px: [u32; 2], levels: &[u8]) -> Vec<u8> {
    encode_grey(size_px, png::BitDepth::Eight, levels)
}

/// Encodes a grey PNG of 16 bits a pixel, as [`grey_png`].
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
    use png::{BitDepth, ColorType};
    let kinds: &[_] = &[(ColorType::Grayscale, BitDepth::Eight), (ColorType::Grayscale, BitDepth::Sixteen)];
    let (kinds, allowed) =
        if allow_16_bits { (kinds, "grey without alpha, 8 or 16 bits") } else { (&kinds[..1], "grey without alpha, 8 bits") };
    let Decoded { size_px: [width, height], kind: (_, depth), bytes } = decode(png_bytes, kinds, allowed)?;
    let levels = match depth {
        BitDepth::Sixteen => bytes.chunks_exact(2).map(|pair| u16::from_be_bytes([pair[0], pair[1]])).collect(),
        _ => bytes.into_iter().map(u16::from).collect(),
    };
    Ok(GreyImage { width, height, levels, bits: depth as u8 })
}

/// A decoded PNG of 8 or 16 bits a channel.
pub(crate) struct Decoded {
    pub(crate) size_px: [u32; 2],
    pub(crate) kind: (png::ColorType, png::BitDepth),
    /// Pixels row by row from the top left, as in the file.
    pub(crate) bytes: Vec<u8>,
}

/// Decodes a PNG of one of these `kinds`, described by `allowed`, of 8 or 16 bits a channel. Kind and sides are checked before anything is decoded.
pub(crate) fn decode(png_bytes: &[u8], kinds: &[(png::ColorType, png::BitDepth)], allowed: &'static str) -> Result<Decoded, MapError> {
    let unreadable = |error: png::DecodingError| MapError::Unreadable(error.to_string());
    let mut decoder = png::Decoder::new(std::io::Cursor::new(png_bytes));
    decoder.set_transformations(png::Transformations::IDENTITY);
    let info = decoder.read_header_info().map_err(unreadable)?;
    let (width, height, kind) = (info.width, info.height, (info.color_type, info.bit_depth));
    if !kinds.contains(&kind) {
        return Err(MapError::Kind { found: format!("{:?} {} bits", kind.0, kind.1 as u8), allowed });
    }
    if width < 2 || height < 2 || width > MAP_LIMIT_PX || height > MAP_LIMIT_PX {
        return Err(MapError::Size { width, height, limit: MAP_LIMIT_PX });
    }
    let mut reader = decoder.read_info().map_err(unreadable)?;
    let bytes_per_pixel = kind.0.samples() * (kind.1 as usize / 8);
    let mut bytes = vec![0; width as usize * height as usize * bytes_per_pixel];
    reader.next_frame(&mut bytes).map_err(unreadable)?;
    Ok(Decoded { size_px: [width, height], kind, bytes })
}
