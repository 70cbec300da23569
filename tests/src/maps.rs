//! PNG files of every kind, sound maps or not.

use png::{BitDepth, ColorType, Encoder};

/// A PNG file of `size_px` (width, height); each row of `bytes` begins with a whole byte, values of 16 bits with the higher one.
///
/// # Panics
/// When `bytes` are more or fewer than the picture holds.
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
