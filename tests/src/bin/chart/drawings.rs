//! Commands that draw pictures instead of charts.

use std::path::Path;

use anyhow::{Context as _, Result, ensure};
use prairie::charts::views::{VIEWS, View};
use prairie_charts::machine::machine;
use prairie_client::render::{Gpu, Quality};
use tests::chart::plates::{self, PLATES, Plate};
use tests::chart::{gallery, pictures};

use super::progress;

/// Draws the gallery.
pub(super) fn draw_gallery(out: &Path, cache: &Path, size_px: [u32; 2], quality: Quality, views: &[&View]) -> Result<()> {
    let gpu = Gpu::headless()?;
    let bar = progress(views.len());
    let mut plates = Vec::new();
    for view in views {
        bar.set_message(view.name);
        plates.push(gallery::plate(&gpu, view, size_px, quality, out, cache)?);
        bar.inc(1);
    }
    bar.finish_and_clear();
    if views.len() == VIEWS.len() {
        gallery::write(&plates, size_px, quality, &format!("{}; {}", gpu.adapter_name, machine()), out)?;
    }
    println!("{} pictures in {}", plates.len(), out.display());
    Ok(())
}

/// Draws plates, all by default, and the page of all.
pub(super) fn draw_plates(out: &Path, only: &[&Plate]) -> Result<()> {
    let gpu = Gpu::headless()?;
    let plates: Vec<&Plate> = if only.is_empty() { PLATES.iter().collect() } else { only.to_vec() };
    let bar = progress(plates.len());
    for plate in &plates {
        bar.set_message(plate.name);
        plate.draw(&gpu, out)?;
        bar.inc(1);
    }
    bar.finish_and_clear();
    plates::write_page(out)?;
    println!("{} pictures in {}", plates.len(), out.display());
    Ok(())
}

/// Draws the pictures of a document again.
pub(super) fn draw_pictures(of: &Path, only: Option<&str>) -> Result<()> {
    let document = std::fs::read_to_string(of).with_context(|| format!("{} cannot be read", of.display()))?;
    let mut commands = pictures::commands(&document);
    commands.retain(|command| only.is_none_or(|word| pictures::file(command).contains(word)));
    ensure!(!commands.is_empty(), "{} has no line `picture …` that draws a file with this word in its name", of.display());
    let bar = progress(commands.len());
    for command in &commands {
        bar.set_message(pictures::file(command).to_owned());
        pictures::draw(command)?;
        bar.inc(1);
    }
    bar.finish_and_clear();
    println!("{} pictures drawn", commands.len());
    Ok(())
}
