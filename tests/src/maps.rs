//! PNG files of any colour type and depth, valid as maps or not.

use png::{BitDepth, ColorType, Encoder};

/// Encodes a PNG of `size_px` (width, height). Each row of `bytes` starts on a byte boundary; 16-bit values are big-endian.
///
/// # Panics
/// When the number of `bytes` does not match the picture.
pub fn png(color: ColorType, depth: BitDepth, size_px: [u32; 2], bytes: &[u8]) -> Vec<u8> {
    let mut file = Vec::new();
    let mut encoder = Encoder::new(&mut file, size_px[0], size_px[1]);
    encoder.set_color(color);
    encoder.set_depth(depth);
    let mut writer = encoder.write_header().expect("a header fits into memory");
    writer.write_image_data(bytes).expect("as many bytes as the picture holds");
    writer.finish().expect("a picture fits into memory");
    file
}
