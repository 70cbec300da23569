//! Writing pictures to files.

use std::borrow::Cow;
use std::fs::{self, File};
use std::io::{BufWriter, Write as _};
use std::path::Path;

use anyhow::{Context as _, Result, bail};
use jpeg_encoder::{ColorType as JpegColor, Encoder as JpegEncoder, SamplingFactor};
use png::{BitDepth, ColorType, Encoder};

use super::{Difference, Picture};

/// JPEG quality of the pictures that documents show: about 130 kB for 960 × 540 pixels of grass.
const JPEG_QUALITY: u8 = 80;

impl Picture {
    /// Writes the picture as PNG or JPEG, by the ending of the file's name, and creates its directory.
    /// A PNG of opaque pixels is stored without alpha; a JPEG ignores alpha.
    ///
    /// # Errors
    /// When the name ends in neither `.png`, `.jpg` nor `.jpeg`, or the file cannot be written.
    pub fn save(&self, path: &Path) -> Result<()> {
        let encoded = match path.extension().and_then(|ending| ending.to_str()) {
            Some("png") => self.to_png(),
            Some("jpg" | "jpeg") => self.to_jpeg(),
            _ => bail!("{}: a picture's name must end in .png or .jpg", path.display()),
        };
        let encoded = encoded.with_context(|| path.display().to_string())?;
        if let Some(dir) = path.parent() {
            fs::create_dir_all(dir).with_context(|| dir.display().to_string())?;
        }
        let mut file = BufWriter::new(File::create(path).with_context(|| path.display().to_string())?);
        file.write_all(&encoded).and_then(|()| file.flush()).with_context(|| path.display().to_string())
    }

    /// Writes the picture to `path` unless the PNG stored there already looks the same; returns whether it was written.
    ///
    /// "The same" means a difference within [`Difference::INVISIBLE`], over the whole picture and in each of `parts`
    /// (left, top, width, height in px), so that small changes of a detail count as well.
    ///
    /// # Errors
    /// When the file cannot be written. An absent or unreadable file, or one of another size, is replaced.
    pub fn save_if_visibly_changed(&self, path: &Path, parts: &[[u32; 4]]) -> Result<bool> {
        let looks_the_same = Self::load(path).is_ok_and(|stored| {
            let mut differences = std::iter::once(self.difference(&stored))
                .chain(parts.iter().map(|part| self.cropped(*part).difference(&stored.cropped(*part))));
            (stored.width, stored.height) == (self.width, self.height)
                && differences.all(|difference| difference.is_ok_and(|difference| difference.is_within(Difference::INVISIBLE)))
        });
        if !looks_the_same {
            self.save(path)?;
        }
        Ok(!looks_the_same)
    }

    fn to_png(&self) -> Result<Vec<u8>> {
        let is_opaque = self.rgba.chunks_exact(4).all(|pixel| pixel[3] == u8::MAX);
        let mut encoded = Vec::new();
        let mut encoder = Encoder::new(&mut encoded, self.width, self.height);
        encoder.set_color(if is_opaque { ColorType::Rgb } else { ColorType::Rgba });
        encoder.set_depth(BitDepth::Eight);
        let mut writer = encoder.write_header()?;
        let channels = if is_opaque { Cow::Owned(self.rgb()) } else { Cow::Borrowed(&self.rgba) };
        writer.write_image_data(&channels)?;
        writer.finish()?;
        Ok(encoded)
    }

    /// Progressive, with chroma at full resolution so that thin blades and text keep their colours.
    fn to_jpeg(&self) -> Result<Vec<u8>> {
        let mut encoded = Vec::new();
        let mut encoder = JpegEncoder::new(&mut encoded, JPEG_QUALITY);
        encoder.set_progressive(true);
        encoder.set_optimized_huffman_tables(true);
        encoder.set_sampling_factor(SamplingFactor::F_1_1);
        encoder.encode(&self.rgb(), self.width.try_into()?, self.height.try_into()?, JpegColor::Rgb)?;
        Ok(encoded)
    }

    fn rgb(&self) -> Vec<u8> {
        self.rgba.chunks_exact(4).flat_map(|pixel| &pixel[..3]).copied().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(width: u32, height: u32, level: u8) -> Picture {
        Picture { width, height, rgba: [level, level, level, 255].repeat((width * height) as usize) }
    }

    #[test]
    fn a_saved_png_is_read_back_unchanged() -> Result<()> {
        let dir = tempfile::tempdir()?;
        let path = dir.path().join("new/gradient.png");
        let translucent = Picture { width: 3, height: 2, rgba: (0..24).map(|byte| byte * 10).collect() };
        let opaque = Picture { width: 1, height: 2, rgba: vec![1, 2, 3, 255, 4, 5, 6, 255] };
        for picture in [translucent, opaque] {
            picture.save(&path)?;
            assert_eq!(Picture::load(&path)?, picture);
        }
        Ok(())
    }

    #[test]
    fn the_file_name_chooses_the_format() -> Result<()> {
        let dir = tempfile::tempdir()?;
        for (name, magic) in [("a.png", &b"\x89PNG"[..]), ("a.jpg", &[0xff, 0xd8, 0xff]), ("a.jpeg", &[0xff, 0xd8, 0xff])] {
            let path = dir.path().join(name);
            grey(16, 16, 90).save(&path)?;
            assert!(fs::read(&path)?.starts_with(magic), "{name}");
        }
        let error = grey(1, 1, 0).save(&dir.path().join("a.gif")).expect_err("GIF is not supported").to_string();
        assert!(error.ends_with("a.gif: a picture's name must end in .png or .jpg"), "{error}");
        Ok(())
    }

    #[test]
    fn a_stored_picture_is_rewritten_only_when_the_change_is_visible() -> Result<()> {
        let dir = tempfile::tempdir()?;
        let path = dir.path().join("golden.png");
        let stored = grey(100, 100, 100);
        assert!(stored.save_if_visibly_changed(&path, &[])?, "an absent file is written");
        let bytes = fs::read(&path)?;
        // One level in every third pixel, and ten pixels visibly: `changed` is at its bound.
        let mut nearly = stored.clone();
        nearly.rgba.chunks_exact_mut(4).step_by(3).for_each(|pixel| pixel[1] += 1);
        nearly.rgba[..40].chunks_exact_mut(4).for_each(|pixel| pixel[0] += Difference::VISIBLE + 1);
        assert!(!nearly.save_if_visibly_changed(&path, &[])?);
        assert_eq!(fs::read(&path)?, bytes, "an invisible change leaves the file alone");

        assert!(nearly.save_if_visibly_changed(&path, &[[0, 0, 20, 20]])?, "the change is visible in this part");
        assert_eq!(Picture::load(&path)?, nearly);
        assert!(grey(100, 100, 101).save_if_visibly_changed(&path, &[])?, "every pixel is brighter");
        assert!(grey(50, 200, 101).save_if_visibly_changed(&path, &[])?, "another size");
        fs::write(&path, b"not a picture")?;
        assert!(stored.save_if_visibly_changed(&path, &[])?, "an unreadable file is replaced");
        Ok(())
    }
}
