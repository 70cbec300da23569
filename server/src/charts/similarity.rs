//! Perceptual similarity of two pictures: FLIP, SSIM and texture.
//!
//! FLIP (Andersson et al. 2020) is the difference seen when two pictures are shown alternately: 0 (none) to 1. It
//! weighs colour and edges by the resolution of the eye, so finer noise counts for little. SSIM (Wang et al. 2004) compares mean, contrast and structure of the luma in windows: 1 for equal pictures, about 0 for unrelated ones.

use anyhow::{Result, ensure};
use nv_flip::{DEFAULT_PIXELS_PER_DEGREE, FlipImageFloat, FlipImageRgb8, magma_lut};

use crate::charts::image::Picture;
use crate::charts::texture::Texture;

/// Similarity of a picture to a reference.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Similarity {
    /// Mean FLIP over the pixels, 0 (equal) to 1.
    pub flip_mean: f64,
    /// 99th percentile of FLIP over the pixels.
    pub flip_worst: f64,
    /// Mean SSIM, 1 for equal pictures.
    pub ssim: f64,
    /// Difference of texture.
    pub texture: Texture,
}

impl Similarity {
    /// Compares a picture with its reference.
    ///
    /// # Errors
    /// When the sizes differ, or are too small for SSIM.
    pub fn of(reference: &Picture, seen: &Picture) -> Result<Self> {
        let flip = Flip::of(reference, seen)?;
        Ok(Self {
            flip_mean: flip.mean(),
            flip_worst: flip.exceeded_by(0.01),
            ssim: ssim(reference, seen)?,
            texture: Texture::of(reference, seen)?,
        })
    }
}

/// FLIP of each pixel, on a display of 67 pixels per degree: 0.7 m wide and 3840 pixels across, seen from 0.7 m.
pub struct Flip {
    map: FlipImageFloat,
    /// All values in ascending order.
    sorted: Vec<f32>,
}

impl Flip {
    /// Compares a picture with its reference.
    ///
    /// # Errors
    /// When the sizes differ.
    pub fn of(reference: &Picture, seen: &Picture) -> Result<Self> {
        same_size(reference, seen)?;
        let [reference, seen] = [reference, seen].map(rgb);
        let map = nv_flip::flip(reference, seen, DEFAULT_PIXELS_PER_DEGREE);
        let mut sorted = map.to_vec();
        sorted.sort_by(f32::total_cmp);
        Ok(Self { map, sorted })
    }

    /// Mean of all pixels.
    pub fn mean(&self) -> f64 {
        self.sorted.iter().copied().map(f64::from).sum::<f64>() / self.sorted.len().max(1) as f64
    }

    /// Value exceeded by this fraction (0 to 1) of the pixels.
    pub fn exceeded_by(&self, fraction: f64) -> f64 {
        let rank = ((1.0 - fraction) * self.sorted.len() as f64) as usize;
        self.sorted.get(rank.min(self.sorted.len().saturating_sub(1))).copied().unwrap_or(0.0).into()
    }

    /// The values as a picture in the Magma colour map: black (equal) through purple and orange to pale yellow.
    pub fn heat_map(&self) -> Picture {
        let colors = self.map.apply_color_lut(&magma_lut());
        let rgba = colors.to_vec().chunks_exact(3).flat_map(|rgb| [rgb[0], rgb[1], rgb[2], 255]).collect();
        Picture { width: colors.width(), height: colors.height(), rgba }
    }
}

fn rgb(picture: &Picture) -> FlipImageRgb8 {
    let bytes: Vec<u8> = picture.rgba.chunks_exact(4).flat_map(|rgba| [rgba[0], rgba[1], rgba[2]]).collect();
    FlipImageRgb8::with_data(picture.width, picture.height, &bytes)
}

pub(crate) fn same_size(a: &Picture, b: &Picture) -> Result<()> {
    let is_same = (a.width, a.height) == (b.width, b.height);
    ensure!(is_same, "a picture of {}x{} compared with one of {}x{}", b.width, b.height, a.width, a.height);
    Ok(())
}

/// Side of SSIM's window and standard deviation of its weights (px).
const WINDOW_PX: usize = 11;
const WINDOW_SIGMA_PX: f64 = 1.5;
/// Stabilisers of the quotients: (0.01 · 255)² and (0.03 · 255)².
const C1: f64 = 6.5025;
const C2: f64 = 58.5225;

/// Mean SSIM of the luma over all windows within the pictures.
///
/// # Errors
/// When the sizes differ or are below 11 × 11.
pub fn ssim(a: &Picture, b: &Picture) -> Result<f64> {
    same_size(a, b)?;
    let size = [a.width, a.height].map(|side| side as usize);
    ensure!(size.iter().all(|side| *side >= WINDOW_PX), "SSIM of {}x{}: at least {WINDOW_PX}x{WINDOW_PX} is allowed", a.width, a.height);
    let [a, b] = [a, b].map(luma);
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).collect::<Vec<_>>();
    let moments = [&a, &b, &product(&a, &a), &product(&b, &b), &product(&a, &b)].map(|values| windowed(values, size));
    let [mean_a, mean_b, square_a, square_b, mixed] = &moments;
    let quotients = (0..mean_a.len()).map(|n| {
        let (mean_a, mean_b) = (mean_a[n], mean_b[n]);
        let (variance_a, variance_b) = (square_a[n] - mean_a * mean_a, square_b[n] - mean_b * mean_b);
        let covariance = mixed[n] - mean_a * mean_b;
        (2.0 * mean_a * mean_b + C1) * (2.0 * covariance + C2) / ((mean_a * mean_a + mean_b * mean_b + C1) * (variance_a + variance_b + C2))
    });
    Ok(quotients.sum::<f64>() / mean_a.len() as f64)
}

/// Luma of ITU-R BT.601, 0 to 255.
pub(crate) fn luma(picture: &Picture) -> Vec<f64> {
    let of = |rgba: &[u8]| 0.299 * f64::from(rgba[0]) + 0.587 * f64::from(rgba[1]) + 0.114 * f64::from(rgba[2]);
    picture.rgba.chunks_exact(4).map(of).collect()
}

/// Weighted mean in each window within the picture, row by row.
fn windowed(values: &[f64], [width, height]: [usize; 2]) -> Vec<f64> {
    let weights: [f64; WINDOW_PX] = std::array::from_fn(|n| {
        let offset_px = n as f64 - (WINDOW_PX / 2) as f64;
        (-0.5 * (offset_px / WINDOW_SIGMA_PX).powi(2)).exp()
    });
    let total: f64 = weights.iter().sum();
    let mean = |values: &mut dyn Iterator<Item = f64>| values.zip(weights).map(|(value, weight)| value * weight).sum::<f64>() / total;
    let columns = width + 1 - WINDOW_PX;
    let rows = values.chunks_exact(width);
    let across: Vec<f64> = rows.flat_map(|row| row.windows(WINDOW_PX)).map(|window| mean(&mut window.iter().copied())).collect();
    let starts = (0..height + 1 - WINDOW_PX).flat_map(|row| (0..columns).map(move |column| row * columns + column));
    starts.map(|start| mean(&mut across[start..].iter().step_by(columns).copied())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use prairie_core::hash::hash3;

    fn filled(rgb: [u8; 3]) -> Picture {
        let [red, green, blue] = rgb;
        Picture { width: 48, height: 32, rgba: [red, green, blue, 255].repeat(48 * 32) }
    }

    /// Grey with noise of this amplitude.
    fn noisy(amplitude: f64) -> Picture {
        let mut picture = filled([128; 3]);
        for (n, pixel) in (0..).zip(picture.rgba.chunks_exact_mut(4)) {
            let fraction = f64::from(hash3([n, 7, 1])[0]) / f64::from(u32::MAX);
            pixel[..3].fill((128.0 + amplitude * (2.0 * fraction - 1.0)).round() as u8);
        }
        picture
    }

    /// L*, a*, b* of an sRGB colour under D65.
    fn lab(rgb: [u8; 3]) -> [f64; 3] {
        let linear = rgb.map(|level| {
            let level = f64::from(level) / 255.0;
            if level <= 0.04045 { level / 12.92 } else { ((level + 0.055) / 1.055).powf(2.4) }
        });
        let xyz = [[0.412_456, 0.357_576, 0.180_437], [0.212_673, 0.715_152, 0.072_175], [0.019_334, 0.119_192, 0.950_304]].map(
            |row: [f64; 3]| {
                let [of_white, of_color] =
                    [[1.0; 3], linear].map(|color| row.iter().zip(color).map(|(fraction, light)| fraction * light).sum::<f64>());
                let t: f64 = of_color / of_white;
                if t > 0.008_856 { t.cbrt() } else { 7.787 * t + 16.0 / 116.0 }
            },
        );
        [116.0 * xyz[1] - 16.0, 500.0 * (xyz[0] - xyz[1]), 200.0 * (xyz[1] - xyz[2])]
    }

    /// FLIP of two uniform pictures, which no filter changes: the HyAB distance of Hunt-adjusted colours, raised to a power and remapped as in §4.1.3.
    fn flip_of_colors(a: [u8; 3], b: [u8; 3]) -> f64 {
        let raised = |a: [u8; 3], b: [u8; 3]| {
            let [[la, aa, ba], [lb, ab, bb]] = [a, b].map(lab).map(|[l, a, b]| [l, 0.01 * l * a, 0.01 * l * b]);
            ((la - lb).abs() + (aa - ab).hypot(ba - bb)).powf(0.7)
        };
        let most = raised([0, 255, 0], [0, 0, 255]);
        let (error, knee) = (raised(a, b), 0.4 * most);
        if error < knee { error / knee * 0.95 } else { 0.95 + (error - knee) / (most - knee) * 0.05 }
    }

    #[test]
    fn even_pictures_have_the_flip_of_the_closed_form() -> Result<()> {
        let colors = [[0; 3], [255; 3], [100; 3], [110; 3], [0, 255, 0], [0, 0, 255], [40, 70, 20], [90, 100, 30]];
        for (a, b) in colors.iter().flat_map(|a| colors.iter().map(move |b| (*a, *b))) {
            let (flip, exact) = (Flip::of(&filled(a), &filled(b))?, flip_of_colors(a, b));
            let found = [flip.mean(), flip.exceeded_by(0.01)];
            assert!(found.iter().all(|found| (found - exact).abs() < 0.002), "{a:?} and {b:?}: {found:?}, {exact} is right");
        }
        // Value of the closed form for black against white.
        assert!((flip_of_colors([0; 3], [255; 3]) - 0.9674).abs() < 1e-4);
        Ok(())
    }

    #[test]
    fn even_pictures_have_the_ssim_of_the_closed_form() -> Result<()> {
        for (a, b) in [(0, 255), (100, 110), (7, 7), (200, 20)] {
            let (mean_a, mean_b) = (f64::from(a), f64::from(b));
            let exact = (2.0 * mean_a * mean_b + C1) / (mean_a * mean_a + mean_b * mean_b + C1);
            let found = ssim(&filled([a; 3]), &filled([b; 3]))?;
            assert!((found - exact).abs() < 1e-9, "{a} and {b}: {found}, {exact} is right");
        }
        Ok(())
    }

    #[test]
    fn equal_pictures_have_no_difference() -> Result<()> {
        let picture = noisy(100.0);
        let alike = Similarity::of(&picture, &picture)?;
        assert_eq!((alike.flip_mean, alike.flip_worst), (0.0, 0.0));
        assert!((alike.ssim - 1.0).abs() < 1e-12);
        assert!(Flip::of(&picture, &picture)?.heat_map().rgba.chunks_exact(4).all(|pixel| pixel[..3].iter().all(|level| *level < 8)));
        Ok(())
    }

    #[test]
    fn similarity_falls_with_noise() -> Result<()> {
        let even = filled([128; 3]);
        let steps: Vec<_> =
            [0.0, 4.0, 16.0, 48.0, 96.0].iter().map(|&noise| Similarity::of(&even, &noisy(noise))).collect::<Result<_>>()?;
        for pair in steps.windows(2) {
            let is_worse = pair[1].flip_mean > pair[0].flip_mean && pair[1].flip_worst > pair[0].flip_worst && pair[1].ssim < pair[0].ssim;
            assert!(is_worse, "{pair:?}");
        }
        assert!(steps.iter().all(|similarity| similarity.flip_worst >= similarity.flip_mean));
        Ok(())
    }

    #[test]
    fn an_inverted_picture_has_a_negative_ssim() -> Result<()> {
        let picture = noisy(60.0);
        let inverse = picture.rgba.chunks_exact(4).flat_map(|pixel| [255 - pixel[0], 255 - pixel[1], 255 - pixel[2], 255]).collect();
        let found = ssim(&picture, &Picture { rgba: inverse, ..picture.clone() })?;
        assert!((-1.0..-0.9).contains(&found), "{found}");
        Ok(())
    }

    #[test]
    fn pictures_of_different_or_too_small_sizes_are_rejected() {
        let narrow = Picture { width: 32, ..filled([0; 3]) };
        assert!(
            Similarity::of(&filled([0; 3]), &narrow).is_err_and(|error| error.to_string().contains("32x32 compared with one of 48x32"))
        );
        let small = Picture { width: 10, height: 10, rgba: vec![0; 400] };
        assert!(ssim(&small, &small).is_err_and(|error| error.to_string() == "SSIM of 10x10: at least 11x11 is allowed"));
    }
}
