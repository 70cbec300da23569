//! The picture: similarity to a reference that draws every plant, culling, and popping.

mod automatic;
mod culling;
mod occlusion;
mod pipeline_statistics;
mod popping;
mod similarity;

use std::path::Path;

use anyhow::{Context as _, Result, bail, ensure};
use prairie::charts::image::Picture;
use prairie::charts::still::Still;
use prairie::charts::views::View;
use prairie_client::render::Gpu;

/// Size of most pictures (px).
const SIZE_PX: [u32; 2] = [320, 180];

/// Negative control: ensures that a check has refused its input, with these words in its message.
fn ensure_refused(checked: Result<()>, words: &str) -> Result<()> {
    let Err(refusal) = checked else { bail!("accepted, although it is wrong: {words}") };
    println!("refused: {refusal:#}");
    ensure!(refusal.to_string().contains(words), "refused for another reason than {words}: {refusal:#}");
    Ok(())
}

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
