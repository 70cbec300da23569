//! Writing pictures to files.

use std::path::Path;

use crate::studio::write_picture;
use anyhow::Result;

use super::{Difference, Picture};

impl Picture {
    /// Writes the picture as PNG or JPEG; see [`write_picture`].
    ///
    /// # Errors
    /// As [`write_picture`].
    pub fn save(&self, path: &Path) -> Result<()> {
        write_picture(path, [self.width, self.height], &self.rgba)
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
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

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
