//! One way of drawing on one view at one quality.

use anyhow::Result;
use client_wasm::render::{Gpu, Quality};
use serde::Serialize;

use super::Method;
use crate::likeness::Likeness;
use crate::picture::Picture;
use crate::still::Still;

/// What one way of drawing costs, and how near it comes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Shot {
    /// The view, as in [`View::name`](crate::views::View::name).
    pub view: String,
    /// The way, as in [`Method::name`].
    pub method: String,
    /// The quality's name.
    pub quality: String,
    /// Level of detail of that quality, from 0.
    pub level: f64,
    /// Median time of a frame (ms).
    pub ms: f64,
    /// Mean FLIP.
    pub flip: f64,
    /// FLIP that one pixel in a hundred exceeds.
    pub flip_worst: f64,
    /// Mean SSIM.
    pub ssim: f64,
    /// Near plants whose posture was simulated.
    pub blades: u32,
    /// Clumps of far plants.
    pub clumps: u32,
}

/// What is measured on each view.
#[derive(Clone, Debug)]
pub struct ViewShots {
    /// The ways.
    pub methods: Vec<Method>,
    /// The qualities that each is drawn at, coarsest first.
    pub qualities: Vec<Quality>,
    /// Frames that a time is the median of; an odd number.
    pub frames: u32,
}

/// Measures all ways on a view whose reference is known; says each before it begins.
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
            canvas.set_look(method.look());
            let (picture, stats) = still.draw(&mut canvas);
            let likeness = Likeness::of(reference, &picture)?;
            let ms = 1e3 * still.frame_secs(&mut canvas, wanted.frames);
            found.push(Shot {
                view: name.to_owned(),
                method: method.name(),
                quality: quality.name().to_owned(),
                level: quality.level().into(),
                ms,
                flip: likeness.flip_mean,
                flip_worst: likeness.flip_worst,
                ssim: likeness.ssim,
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
    Shot { view, method, quality, level: level.into(), ms, flip, flip_worst: 2.0 * flip, ssim: 1.0 - flip, blades: 7, clumps: 3 }
}
