//! The picture: similarity to a reference that draws every plant, culling, and popping.

mod automatic;
mod culling;
mod pipeline_statistics;
mod popping;
mod similarity;

use std::path::Path;

use anyhow::{Context as _, Result};
use prairie_client::render::Gpu;
use tests::picture::Picture;
use tests::still::Still;
use tests::views::View;

/// Size of most pictures (px).
const SIZE_PX: [u32; 2] = [320, 180];

fn gpu() -> Result<Gpu> {
    Gpu::headless().context("no Vulkan driver: install mesa-vulkan-drivers")
}

/// A view and its reference, which is cached for all tests of a build.
fn view(gpu: &Gpu, name: &str, size_px: [u32; 2]) -> Result<(Still, Picture)> {
    let view = View::find(name)?;
    let mut still = Still::of(view, size_px)?;
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("reference-{name}-{}.png", size_px[0]));
    let reference = still.kept_reference(gpu, &path)?;
    Ok((still, reference))
}
