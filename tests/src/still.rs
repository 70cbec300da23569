//! A stage at a standstill: drawn in any way, timed, and as it would look with every plant drawn.

use std::path::Path;
use std::time::Instant;

use anyhow::{Context as _, Result};
use client_wasm::camera::Camera;
use client_wasm::render::{FrameStats, Gpu, Look, Order, Picture as Canvas, Quality};
use client_wasm::state::Mirror;

use crate::picture::Picture;
use crate::stage::Stage;
use crate::views::View;

/// Time that clouds and gusts stand at (s).
const TIME_SECS: f64 = 5.0;
const DT_SECS: f32 = 1.0 / 30.0;
/// Pixels along one side of the reference that make one of a picture.
const SUPERSAMPLED: u32 = 2;

/// A stage and the camera that looks at it; every picture shows the same moment.
pub struct Still {
    /// What is shown.
    pub stage: Stage,
    /// From where.
    pub camera: Camera,
    /// Width and height of its pictures (px).
    pub size_px: [u32; 2],
}

impl Still {
    /// A view after its act.
    ///
    /// # Errors
    /// When its scene is faulty or its act fails.
    pub fn of(view: &View, size_px: [u32; 2]) -> Result<Self> {
        let (stage, camera) = view.play()?;
        Ok(Self { stage, camera, size_px })
    }

    /// What its pictures are drawn on.
    pub fn canvas(&self, gpu: &Gpu, quality: Quality) -> Canvas {
        Canvas::new(gpu, self.size_px, quality)
    }

    /// A picture of the moment on a canvas of its own, and what was drawn.
    pub fn draw(&mut self, canvas: &mut Canvas) -> (Picture, FrameStats) {
        self.draw_sized(canvas, self.size_px)
    }

    fn draw_sized(&mut self, canvas: &mut Canvas, [width, height]: [u32; 2]) -> (Picture, FrameStats) {
        let stats = canvas.draw(&mut self.stage.mirror, &self.camera, TIME_SECS, 0.0);
        (Picture { width, height, rgba: canvas.rgba() }, stats)
    }

    /// Median time of a frame (s); see [`frame_secs`].
    pub fn frame_secs(&mut self, canvas: &mut Canvas, frames: u32) -> f64 {
        frame_secs(canvas, &mut self.stage.mirror, &self.camera, frames)
    }

    /// The moment with every plant at full detail in exact order. What the view cannot show is culled, which the test `culling` holds to change no pixel.
    pub fn reference(&mut self, gpu: &Gpu) -> Picture {
        self.draw_finely(gpu, Quality::Reference)
    }

    /// The moment drawn at twice the size, or by a quality that does so itself, pixels averaged in linear light. Between two such pictures nothing differs but their detail.
    pub fn draw_finely(&mut self, gpu: &Gpu, quality: Quality) -> Picture {
        let finer = SUPERSAMPLED / quality.fineness(self.size_px, gpu.side_limit_px());
        let size_px = self.size_px.map(|side| side * finer);
        let mut canvas = Canvas::new(gpu, size_px, quality);
        canvas.set_look(Look { order: Order::Cut, ..Look::default() });
        averaged(&self.draw_sized(&mut canvas, size_px).0, finer)
    }

    /// The reference as a file keeps it; drawn anew where there is none, or one from before this program was built.
    ///
    /// # Errors
    /// When the file cannot be read or written.
    pub fn kept_reference(&mut self, gpu: &Gpu, path: &Path) -> Result<Picture> {
        let built = std::env::current_exe()?.metadata()?.modified()?;
        let kept = path.metadata().and_then(|file| file.modified()).is_ok_and(|kept| kept > built);
        if kept {
            return Picture::load(path);
        }
        let picture = self.reference(gpu);
        picture.save(path).context("the reference cannot be kept")?;
        Ok(picture)
    }
}

/// Median time of a frame (s) while clouds, wind and plants go on: of an odd number of `frames`, after one that fills buffers.
pub fn frame_secs(canvas: &mut Canvas, mirror: &mut Mirror, camera: &Camera, frames: u32) -> f64 {
    let mut times: Vec<f64> = (0..=frames)
        .map(|frame| {
            let begun = Instant::now();
            canvas.draw(mirror, camera, TIME_SECS + f64::from(frame) * f64::from(DT_SECS), DT_SECS);
            begun.elapsed().as_secs_f64()
        })
        .skip(1)
        .collect();
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

/// A smaller picture, each pixel the mean of so many along each side, in linear light.
fn averaged(picture: &Picture, times: u32) -> Picture {
    let linear: Vec<f32> = (0..=255_u8).map(linear_of).collect();
    let [width, height] = [picture.width / times, picture.height / times];
    let mean = |x: u32, y: u32, channel: usize| {
        let places = (0..times * times).map(|n| picture.pixel(x * times + n % times, y * times + n / times)[channel]);
        level_of(places.map(|level| linear[usize::from(level)]).sum::<f32>() / (times * times) as f32)
    };
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| [x, y]));
    Picture { width, height, rgba: pixels.flat_map(|[x, y]| [mean(x, y, 0), mean(x, y, 1), mean(x, y, 2), 255]).collect() }
}

/// Linear light, 0 to 1, of an sRGB level (IEC 61966-2-1).
fn linear_of(level: u8) -> f32 {
    let level = f32::from(level) / 255.0;
    if level <= 0.04045 { level / 12.92 } else { ((level + 0.055) / 1.055).powf(2.4) }
}

/// Its inverse.
fn level_of(linear: f32) -> u8 {
    let level = if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 };
    (255.0 * level).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_survive_linear_light() {
        assert!((0..=255).all(|level| level_of(linear_of(level)) == level));
    }

    #[test]
    fn pixels_are_averaged_as_light() {
        let rgba = [[0, 255, 40, 255], [255, 255, 40, 255], [255, 0, 40, 255], [0, 0, 40, 255]].concat();
        let one = averaged(&Picture { width: 2, height: 2, rgba }, 2);
        // Half of the light of white is level 188.
        assert_eq!((one.width, one.height, one.rgba), (1, 1, vec![188, 188, 40, 255]));
    }
}
