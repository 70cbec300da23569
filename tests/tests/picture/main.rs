//! The picture: how near each way of drawing comes to every plant drawn, and what may not be seen to change.

mod automatic;
mod culling;
mod likeness;
mod pops;
mod work;

use std::path::Path;

use anyhow::{Context as _, Result};
use client_wasm::render::Gpu;
use tests::picture::Picture;
use tests::still::Still;
use tests::views::View;

/// Size of most pictures (px).
const SIZE_PX: [u32; 2] = [320, 180];

fn gpu() -> Result<Gpu> {
    Gpu::headless().context("no Vulkan driver: install mesa-vulkan-drivers")
}

/// A view and its reference, which tests of one build share.
fn view(gpu: &Gpu, name: &str, size_px: [u32; 2]) -> Result<(Still, Picture)> {
    let view = View::find(name)?;
    let mut still = Still::of(view, size_px)?;
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("reference-{name}-{}.png", size_px[0]));
    let reference = still.kept_reference(gpu, &path)?;
    Ok((still, reference))
}
