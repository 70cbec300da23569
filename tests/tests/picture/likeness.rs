//! Every way of drawing against the reference, at medium quality.

use anyhow::{Result, ensure};
use client_wasm::render::Quality;
use tests::chart::picture::METHODS;
use tests::likeness::{Flip, Likeness};

use crate::{SIZE_PX, gpu, view};

/// Largest mean FLIP and least SSIM from the hill.
const HILL_BOUNDS: [f64; 2] = [0.14, 0.49];

/// Holds every way of drawing to a largest mean FLIP and a least SSIM.
fn compare(name: &str, [most_flip, least_ssim]: [f64; 2]) -> Result<()> {
    let gpu = gpu()?;
    let (mut still, reference) = view(&gpu, name, SIZE_PX)?;
    let mut canvas = still.canvas(&gpu, Quality::Medium);
    let mut failures = Vec::new();
    for method in METHODS {
        canvas.set_look(method.look());
        let (picture, _) = still.draw(&mut canvas);
        let likeness = Likeness::of(&reference, &picture)?;
        println!("{name}, {}: {likeness:?}", method.name());
        if likeness.flip_mean > most_flip || likeness.ssim < least_ssim {
            let seen = std::env::temp_dir().join(format!("prairie-{name}-{}-{}.png", method.far.name(), method.order.name()));
            picture.save(&seen)?;
            Flip::of(&reference, &picture)?.heat_map().save(&seen.with_extension("flip.png"))?;
            failures.push(format!(
                "{}: {likeness:?}, FLIP up to {most_flip} and SSIM from {least_ssim} are allowed; see {}",
                method.name(),
                seen.display()
            ));
        }
    }
    ensure!(failures.is_empty(), "{name}\n{}", failures.join("\n"));
    Ok(())
}

#[test]
fn on_foot_every_way_is_near_the_reference() -> Result<()> {
    compare("walking-calm", [0.25, 0.37])
}

#[test]
fn in_a_storm_every_way_is_near_the_reference() -> Result<()> {
    compare("walking-storm", [0.22, 0.55])
}

#[test]
fn from_a_hill_every_way_is_near_the_reference() -> Result<()> {
    compare("hill-calm", HILL_BOUNDS)
}

/// Otherwise the bounds above would say nothing.
#[test]
fn another_view_is_far_from_the_reference() -> Result<()> {
    let gpu = gpu()?;
    let (mut still, reference) = view(&gpu, "hill-calm", SIZE_PX)?;
    still.camera.turn(0.3, 0.0);
    let mut canvas = still.canvas(&gpu, Quality::Medium);
    let likeness = Likeness::of(&reference, &still.draw(&mut canvas).0)?;
    let [most_flip, least_ssim] = HILL_BOUNDS;
    ensure!(likeness.flip_mean > most_flip && likeness.ssim < least_ssim, "{likeness:?}");
    Ok(())
}
