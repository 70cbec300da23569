//! A measurement: one method on one view at one quality.

use anyhow::Result;
use prairie_client::render::{Gpu, Quality};
use serde::Serialize;

use super::Method;
use crate::charts::image::Picture;
use crate::charts::similarity::Similarity;
use crate::charts::still::Still;
use crate::charts::texture::Texture;

/// Cost and similarity of one method on one view at one quality.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Shot {
    /// The view, as in [`View::name`](crate::charts::views::View::name).
    pub view: String,
    /// The method, as in [`Method::name`].
    pub method: String,
    /// The quality's name.
    pub quality: String,
    /// Level of detail of that quality, from 0.
    pub level: f64,
    /// Median frame time (ms).
    pub ms: f64,
    /// Mean FLIP.
    pub flip: f64,
    /// 99th percentile of FLIP over the pixels.
    pub flip_worst: f64,
    /// Mean SSIM.
    pub ssim: f64,
    /// Difference of texture.
    pub texture: Texture,
    /// Simulated near plants.
    pub blades: u32,
    /// Drawn clumps of distant plants.
    pub clumps: u32,
}

/// Measurements to take on each view.
#[derive(Clone, Debug)]
pub struct ViewShots {
    /// The methods.
    pub methods: Vec<Method>,
    /// The qualities, coarsest first.
    pub qualities: Vec<Quality>,
    /// Number of timed frames (odd); the median counts.
    pub frames: u32,
}

/// Measures all methods on a view against its reference; calls back before each.
///
/// # Errors
/// When the reference has another size.
pub fn shots(
    gpu: &Gpu,
    name: &str,
    still: &mut Still,
    reference: &Picture,
    wanted: &ViewShots,
    mut say: impl FnMut(&str),
) -> Result<Vec<Shot>> {
    let mut found = Vec::new();
    for &quality in &wanted.qualities {
        let mut canvas = still.canvas(gpu, quality);
        for method in &wanted.methods {
            say(&format!("{name}, {}, {}", method.name(), quality.name()));
            canvas.set_options(method.look());
            let (picture, stats) = still.draw(&mut canvas);
            let similarity = Similarity::of(reference, &picture)?;
            let ms = 1e3 * still.frame_secs(&mut canvas, wanted.frames);
            found.push(Shot {
                view: name.to_owned(),
                method: method.name(),
                quality: quality.name().to_owned(),
                level: quality.level().into(),
                ms,
                flip: similarity.flip_mean,
                flip_worst: similarity.flip_worst,
                ssim: similarity.ssim,
                texture: similarity.texture,
                blades: stats.blades,
                clumps: stats.clumps,
            });
        }
    }
    Ok(found)
}

#[cfg(test)]
pub(super) fn made_up(view: &str, method: &str, level: u32, ms: f64, flip: f64) -> Shot {
    let quality = Quality::ALL[level as usize].name().to_owned();
    let (view, method) = (view.to_owned(), method.to_owned());
    let texture = Texture { brightness: 0.1 * flip, contrast: 0.2 * flip, gradients: 3.0 * flip };
    Shot { view, method, quality, level: level.into(), ms, flip, flip_worst: 2.0 * flip, ssim: 1.0 - flip, texture, blades: 7, clumps: 3 }
}
