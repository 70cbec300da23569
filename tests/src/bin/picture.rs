//! Draws pictures of a synthetic prairie without a window.

use anyhow::{Context, Result};
use clap::Parser;
use client_wasm::camera::Camera;
use client_wasm::render::{Gpu, Picture, Quality};
use std::path::PathBuf;
use std::time::Instant;

/// Draws a prairie to a PNG file, and says how long frames take.
#[derive(Parser)]
struct Arguments {
    /// View as in the page's address: x,y,z,heading,pitch (m, degrees).
    #[arg(long, default_value = "128,14,158,20,-5", allow_hyphen_values = true)]
    view: String,
    /// Metres above the ground in place of the view's y.
    #[arg(long)]
    above: Option<f32>,
    /// Pixels along X and Y.
    #[arg(long, default_value = "960x540")]
    size: String,
    /// low, medium, high or ultra.
    #[arg(long, default_value = "high")]
    quality: String,
    /// Simulated seconds before the picture is taken.
    #[arg(long, default_value_t = 3.0)]
    time: f64,
    /// Frames per simulated second on the way there.
    #[arg(long, default_value_t = 20.0)]
    fps: f64,
    /// File to write.
    #[arg(long)]
    out: PathBuf,
}

fn main() -> Result<()> {
    let arguments = Arguments::parse();
    let (width, height) = arguments.size.split_once('x').context("--size must be WIDTHxHEIGHT")?;
    let size_px = [width.parse()?, height.parse()?];
    let quality = Quality::from_name(&arguments.quality).context("--quality must be low, medium, high or ultra")?;
    let mut mirror = tests::synthetic::mirror();
    let mut camera = Camera::from_hash(&arguments.view).context("--view must be x,y,z,heading,pitch")?;
    if let (Some(above), Some(land)) = (arguments.above, mirror.land()) {
        camera.eye_m.y = land.heights().height_m(camera.eye_m.x, camera.eye_m.z) + above;
    }
    let gpu = Gpu::headless()?;
    let mut picture = Picture::new(&gpu, size_px, quality);
    let frames = (arguments.time * arguments.fps) as u32;
    let dt_secs = 1.0 / arguments.fps;
    picture.draw(&mut mirror, &camera, 0.0, dt_secs as f32);
    let start = Instant::now();
    let mut stats = Default::default();
    for frame in 1..=frames {
        stats = picture.draw(&mut mirror, &camera, f64::from(frame) * dt_secs, dt_secs as f32);
    }
    let frame_ms = start.elapsed().as_secs_f64() * 1e3 / f64::from(frames.max(1));
    println!("{}: {frame_ms:.1} ms a frame, {stats:?}", gpu.adapter_name);
    let [width, height] = size_px;
    tests::picture::Picture { width, height, rgba: picture.rgba() }.save(&arguments.out)
}
