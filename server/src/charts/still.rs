//! A frozen moment of a scene: drawn with any render options, timed, and drawn as a reference with every plant.

use std::path::Path;
use std::time::Instant;

use anyhow::{Context as _, Result};
use prairie_client::camera::Camera;
use prairie_client::render::{BlendOrder, FrameStats, Gpu, OffscreenRenderer as Canvas, Quality, RenderOptions};
use prairie_client::state::Mirror;

use crate::charts::image::Picture;
use crate::charts::views::View;
use crate::studio::Stage;

const DT_SECS: f32 = 1.0 / 30.0;
/// Supersampling factor of the reference along each side.
const SUPERSAMPLED: u32 = 2;

/// A stage and its camera; every picture shows the same moment.
pub struct Still {
    /// The scene at its moment.
    pub stage: Stage,
    /// The camera.
    pub camera: Camera,
    /// Width and height of its pictures (px).
    pub size_px: [u32; 2],
}

impl Still {
    /// A view after its act.
    ///
    /// # Errors
    /// When the scene is invalid or the act fails.
    pub fn of(view: &View, size_px: [u32; 2]) -> Result<Self> {
        let (stage, camera) = view.play()?;
        Ok(Self { stage, camera, size_px })
    }

    /// A renderer of the size of its pictures.
    pub fn canvas(&self, gpu: &Gpu, quality: Quality) -> Canvas {
        Canvas::new(gpu, self.size_px, quality)
    }

    /// Draws the moment on a canvas; returns the picture and the frame statistics.
    pub fn draw(&mut self, canvas: &mut Canvas) -> (Picture, FrameStats) {
        self.draw_sized(canvas, self.size_px)
    }

    fn draw_sized(&mut self, canvas: &mut Canvas, [width, height]: [u32; 2]) -> (Picture, FrameStats) {
        let time_secs = self.stage.mirror.time_secs();
        let stats = canvas.draw(&mut self.stage.mirror, &self.camera, time_secs, 0.0);
        (Picture { width, height, rgba: canvas.rgba() }, stats)
    }

    /// Median time of a frame (s); see [`frame_secs`].
    pub fn frame_secs(&mut self, canvas: &mut Canvas, frames: u32) -> f64 {
        frame_secs(canvas, &mut self.stage.mirror, &self.camera, frames)
    }

    /// Draws every plant at full detail in exact order. Only culling leaves plants out, which changes no pixel (test `culling`).
    pub fn reference(&mut self, gpu: &Gpu) -> Picture {
        self.draw_finely(gpu, Quality::Reference)
    }

    /// Draws at twice the size, or at a quality with its own supersampling, and averages in linear light. Two such pictures differ only in their level
    /// of detail.
    pub fn draw_finely(&mut self, gpu: &Gpu, quality: Quality) -> Picture {
        let finer = SUPERSAMPLED / quality.supersampling(self.size_px, gpu.side_limit_px());
        let size_px = self.size_px.map(|side| side * finer);
        let mut canvas = Canvas::new(gpu, size_px, quality);
        canvas.set_options(RenderOptions { blend_order: BlendOrder::Cut, ..RenderOptions::default() });
        self.draw_sized(&mut canvas, size_px).0.averaged(finer)
    }

    /// The reference, cached in a file; drawn again when the file is absent or older than this program.
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
        picture.save(path).context("the reference cannot be written")?;
        Ok(picture)
    }
}

/// Median frame time (s) while clouds, wind and plants move: of an odd number of `frames`, after one warm-up frame.
pub fn frame_secs(canvas: &mut Canvas, mirror: &mut Mirror, camera: &Camera, frames: u32) -> f64 {
    let mut times: Vec<f64> = (0..=frames)
        .map(|frame| {
            let begun = Instant::now();
            let time_secs = mirror.time_secs() + f64::from(frame) * f64::from(DT_SECS);
            canvas.draw(mirror, camera, time_secs, DT_SECS);
            begun.elapsed().as_secs_f64()
        })
        .skip(1)
        .collect();
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}
