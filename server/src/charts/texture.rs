//! How alike the texture of two pictures is, wherever its single blades are.
//!
//! FLIP and SSIM compare pixel by pixel, so grass whose blades stand elsewhere differs from the reference although no viewer could say which is which. Here
//! the luma of square tiles is compared by what a viewer sees of it: its mean, its standard deviation, and its histogram of oriented gradients (Dalal & Triggs
//! 2005, §6.2 and 6.3: central differences, nine unsigned orientations, weighted by magnitude).

use anyhow::Result;
use serde::Serialize;

use crate::charts::image::Picture;
use crate::charts::similarity::{luma, same_size};

/// Side of a tile (px); tiles at the right and lower edges may be smaller.
const TILE_PX: usize = 32;
/// Unsigned orientations of gradients, 20° each.
const ORIENTATIONS: usize = 9;

/// Difference of the texture of a picture from a reference; 0 for equal pictures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Texture {
    /// Mean over the tiles of the absolute difference of mean luma, 0 to 1.
    pub brightness: f64,
    /// Mean over the tiles of the absolute difference of the standard deviations of luma, 0 to 0.5.
    pub contrast: f64,
    /// Distance of the gradient histograms, 0 to 1 (no gradient in common): the sum of absolute differences over all tiles and orientations, divided by the
    /// sum of both (Bray & Curtis 1957), so that tiles without edges, such as clear sky, count for nothing.
    pub gradients: f64,
}

impl Texture {
    /// Compares a picture with its reference.
    ///
    /// # Errors
    /// When the sizes differ.
    pub fn of(reference: &Picture, seen: &Picture) -> Result<Self> {
        same_size(reference, seen)?;
        let [reference, seen] = [reference, seen].map(tiles);
        let pairs = || reference.iter().zip(&seen);
        let mean = |of: fn(&Tile) -> f64| pairs().map(|(a, b)| (of(a) - of(b)).abs()).sum::<f64>() / reference.len().max(1) as f64;
        let bins = || pairs().flat_map(|(a, b)| a.gradients.iter().zip(b.gradients));
        let total: f64 = bins().map(|(a, b)| a + b).sum();
        let apart: f64 = bins().map(|(a, b)| (a - b).abs()).sum();
        Ok(Self {
            brightness: mean(|tile| tile.mean),
            contrast: mean(|tile| tile.deviation),
            gradients: if total > 0.0 { apart / total } else { 0.0 },
        })
    }

    /// Whether no part exceeds that of `bounds`.
    pub fn is_within(&self, bounds: &Self) -> bool {
        self.brightness <= bounds.brightness && self.contrast <= bounds.contrast && self.gradients <= bounds.gradients
    }
}

/// What is compared of a tile; luma of 0 to 1.
struct Tile {
    mean: f64,
    deviation: f64,
    /// Sum of the magnitudes in each range of orientation.
    gradients: [f64; ORIENTATIONS],
}

/// Tiles of a picture, row by row.
fn tiles(picture: &Picture) -> Vec<Tile> {
    let luma: Vec<f64> = luma(picture).into_iter().map(|level| level / 255.0).collect();
    let [width, height] = [picture.width, picture.height].map(|side| side as usize);
    let starts = (0..height).step_by(TILE_PX).flat_map(|top| (0..width).step_by(TILE_PX).map(move |left| [left, top]));
    starts.map(|[left, top]| tile(&luma, [width, height], [left, top])).collect()
}

fn tile(luma: &[f64], [width, height]: [usize; 2], [left, top]: [usize; 2]) -> Tile {
    let [right, bottom] = [width.min(left + TILE_PX), height.min(top + TILE_PX)];
    let pixels = || (top..bottom).flat_map(move |y| (left..right).map(move |x| [x, y]));
    let at = |x: usize, y: usize| luma[y * width + x];
    let count = ((right - left) * (bottom - top)) as f64;
    let mean = pixels().map(|[x, y]| at(x, y)).sum::<f64>() / count;
    let variance = pixels().map(|[x, y]| (at(x, y) - mean).powi(2)).sum::<f64>() / count;
    let mut gradients = [0.0; ORIENTATIONS];
    // Neighbours beyond the picture equal its edge.
    for [x, y] in pixels() {
        let across = at((x + 1).min(width - 1), y) - at(x.saturating_sub(1), y);
        let along = at(x, (y + 1).min(height - 1)) - at(x, y.saturating_sub(1));
        let turn = along.atan2(across).rem_euclid(std::f64::consts::PI) / std::f64::consts::PI;
        gradients[(turn * ORIENTATIONS as f64) as usize % ORIENTATIONS] += across.hypot(along);
    }
    Tile { mean, deviation: variance.sqrt(), gradients }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::charts::similarity::Flip;
    use prairie_core::hash::hash3;

    const SIZE_PX: [u32; 2] = [96, 64];

    /// A grey picture of these levels.
    fn picture(level: impl Fn(u32, u32) -> f64) -> Picture {
        let [width, height] = SIZE_PX;
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let rgba = pixels.flat_map(|(x, y)| [level(x, y).round() as u8; 3].into_iter().chain([255])).collect();
        Picture { width, height, rgba }
    }

    /// Upright stripes of random levels: blades that stand elsewhere for every seed.
    fn blades(seed: u32) -> Picture {
        picture(|x, y| 60.0 + 120.0 * f64::from(hash3([x / 2, y / 4, seed])[0]) / f64::from(u32::MAX))
    }

    #[test]
    fn even_pictures_differ_in_brightness_alone() -> Result<()> {
        let found = Texture::of(&picture(|_, _| 40.0), &picture(|_, _| 91.0))?;
        assert!((found.brightness - 0.2).abs() < 1e-12 && found.contrast < 1e-12, "{found:?}");
        assert_eq!(found.gradients, 0.0);
        Ok(())
    }

    #[test]
    fn stripes_have_the_values_of_the_closed_form() -> Result<()> {
        // Period 4: central differences are 102 or 0 levels, so that half of the pixels have a gradient.
        let upright = picture(|x, _| if x % 4 < 2 { 51.0 } else { 153.0 });
        let lying = picture(|_, y| if y % 4 < 2 { 51.0 } else { 153.0 });
        let faint = picture(|x, _| if x % 4 < 2 { 51.0 } else { 102.0 });
        let turned = Texture::of(&upright, &lying)?;
        assert!(turned.brightness < 1e-12 && turned.contrast < 1e-12, "{turned:?}");
        assert!((turned.gradients - 1.0).abs() < 1e-12, "no orientation in common: {turned:?}");
        let fainter = Texture::of(&upright, &faint)?;
        let exact = Texture { brightness: 0.1, contrast: 0.1, gradients: 1.0 / 3.0 };
        let is_exact = (fainter.brightness - exact.brightness).abs() < 1e-12
            && (fainter.contrast - exact.contrast).abs() < 1e-12
            && (fainter.gradients - exact.gradients).abs() < 1e-12;
        assert!(is_exact, "{fainter:?}, {exact:?} is right");
        Ok(())
    }

    /// What FLIP cannot tell apart: blades that stand elsewhere, and no blades at all.
    #[test]
    fn other_blades_have_the_same_texture_and_blurred_ones_do_not() -> Result<()> {
        let reference = blades(1);
        let elsewhere = blades(2);
        let blurred = picture(|_, _| 120.0);
        let flips = [Flip::of(&reference, &elsewhere)?.mean(), Flip::of(&reference, &blurred)?.mean()];
        assert!(flips[0] > flips[1], "{flips:?}");
        let [other, none] = [Texture::of(&reference, &elsewhere)?, Texture::of(&reference, &blurred)?];
        assert!(none.gradients > 0.99 && none.contrast > 0.1, "{none:?}");
        assert!(other.gradients < 0.15 && other.contrast < 0.03 && other.brightness < 0.03, "{other:?}");
        Ok(())
    }

    #[test]
    fn equal_pictures_have_no_difference() -> Result<()> {
        assert_eq!(Texture::of(&blades(1), &blades(1))?, Texture::default());
        Ok(())
    }

    #[test]
    fn pictures_of_different_sizes_are_rejected() {
        let small = Picture { width: 1, height: 1, rgba: vec![0; 4] };
        assert!(Texture::of(&blades(1), &small).is_err_and(|error| error.to_string().contains("1x1 compared with one of 96x64")));
    }

    #[test]
    fn bounds_hold_for_each_part() {
        let bounds = Texture { brightness: 0.1, contrast: 0.2, gradients: 0.3 };
        assert!(bounds.is_within(&bounds));
        let over = [Texture { brightness: 0.11, ..bounds }, Texture { contrast: 0.21, ..bounds }, Texture { gradients: 0.31, ..bounds }];
        assert!(over.iter().all(|texture| !texture.is_within(&bounds)));
    }
}
