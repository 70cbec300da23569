//! Pictures as PNG and JPEG files.

use anyhow::{Context as _, Result, bail, ensure};
use jpeg_encoder::{ColorType as JpegColor, Encoder as JpegEncoder, SamplingFactor};
use png::{BitDepth, ColorType, Encoder};
use std::borrow::Cow;
use std::fs;
use std::path::Path;

/// JPEG quality: about 130 kB for 960 × 540 pixels of grass.
const JPEG_QUALITY: u8 = 80;

/// Writes a picture of 8-bit RGBA rows from the top as PNG or JPEG, by the ending of the file's name, and creates its folder.
/// The file appears complete or not at all.
///
/// # Errors
/// When the name ends in neither `.png`, `.jpg` nor `.jpeg`, or the file cannot be written.
pub fn write_picture(path: &Path, size_px: [u32; 2], rgba: &[u8]) -> Result<()> {
    let encode = match path.extension().and_then(|ending| ending.to_str()) {
        Some("png") => to_png,
        Some("jpg" | "jpeg") => to_jpeg,
        _ => bail!("{}: the name of a picture must end in .png or .jpg", path.display()),
    };
    let named = || path.display().to_string();
    let encoded = encode(size_px, rgba).with_context(named)?;
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
    }
    let part = path.with_added_extension("part");
    let written = fs::write(&part, encoded).and_then(|()| fs::rename(&part, path));
    if written.is_err() {
        // The error that is reported is the first one.
        let _ = fs::remove_file(&part);
    }
    written.with_context(named)
}

/// Encodes 8-bit RGBA rows as PNG; without alpha if every pixel is opaque.
///
/// # Errors
/// When `rgba` has another length than `size_px` asks for, or a side is 0.
pub fn to_png(size_px: [u32; 2], rgba: &[u8]) -> Result<Vec<u8>> {
    check_length(size_px, rgba)?;
    let is_opaque = rgba.chunks_exact(4).all(|pixel| pixel[3] == u8::MAX);
    let mut encoded = Vec::new();
    let mut encoder = Encoder::new(&mut encoded, size_px[0], size_px[1]);
    encoder.set_color(if is_opaque { ColorType::Rgb } else { ColorType::Rgba });
    encoder.set_depth(BitDepth::Eight);
    let mut writer = encoder.write_header()?;
    let channels = if is_opaque { Cow::Owned(rgb(rgba)) } else { Cow::Borrowed(rgba) };
    writer.write_image_data(&channels)?;
    writer.finish()?;
    Ok(encoded)
}

/// Encodes 8-bit RGBA rows as progressive JPEG, ignoring alpha, with chroma at full resolution so that thin blades and text keep their colours.
///
/// # Errors
/// When `rgba` has another length than `size_px` asks for, or a side is 0 or above 65 535.
pub fn to_jpeg(size_px: [u32; 2], rgba: &[u8]) -> Result<Vec<u8>> {
    check_length(size_px, rgba)?;
    let mut encoded = Vec::new();
    let mut encoder = JpegEncoder::new(&mut encoded, JPEG_QUALITY);
    encoder.set_progressive(true);
    encoder.set_optimized_huffman_tables(true);
    encoder.set_sampling_factor(SamplingFactor::F_1_1);
    encoder.encode(&rgb(rgba), size_px[0].try_into()?, size_px[1].try_into()?, JpegColor::Rgb)?;
    Ok(encoded)
}

fn check_length([width, height]: [u32; 2], rgba: &[u8]) -> Result<()> {
    let expected = 4 * width as usize * height as usize;
    ensure!(
        rgba.len() == expected,
        "{} bytes instead of {expected} for {width} × {height} pixels; was the graphics device lost?",
        rgba.len()
    );
    Ok(())
}

fn rgb(rgba: &[u8]) -> Vec<u8> {
    rgba.chunks_exact(4).flat_map(|pixel| &pixel[..3]).copied().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(width: u32, height: u32) -> Vec<u8> {
        [90, 90, 90, 255].repeat((width * height) as usize)
    }

    #[test]
    fn the_file_name_chooses_the_format_and_nothing_else_stays() -> Result<()> {
        let folder = tempfile::tempdir()?;
        for (name, magic) in [("new/a.png", &b"\x89PNG"[..]), ("new/a.jpg", &[0xff, 0xd8, 0xff]), ("new/a.jpeg", &[0xff, 0xd8, 0xff])] {
            let path = folder.path().join(name);
            write_picture(&path, [16, 16], &grey(16, 16))?;
            assert!(fs::read(&path)?.starts_with(magic), "{name}");
        }
        assert_eq!(fs::read_dir(folder.path().join("new"))?.count(), 3);
        Ok(())
    }

    #[test]
    fn errors_name_the_file_and_leave_nothing() -> Result<()> {
        let folder = tempfile::tempdir()?;
        let refused = |name: &str, rgba: &[u8]| format!("{:#}", write_picture(&folder.path().join(name), [1, 1], rgba).expect_err(name));
        assert!(refused("a.gif", &grey(1, 1)).ends_with("a.gif: the name of a picture must end in .png or .jpg"));
        let short = refused("a.png", &[0; 3]);
        assert!(short.contains("a.png: 3 bytes instead of 4 for 1 × 1 pixels"), "{short}");
        fs::create_dir(folder.path().join("folder.png"))?;
        assert!(refused("folder.png", &grey(1, 1)).contains("folder.png"));
        assert_eq!(fs::read_dir(folder.path())?.count(), 1);
        Ok(())
    }
}
