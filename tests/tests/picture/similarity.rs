//! All render options against the reference, at medium quality.

use anyhow::{Result, ensure};
use prairie_client::render::Quality;
use tests::chart::picture::METHODS;
use tests::similarity::{Flip, Similarity};

use crate::{SIZE_PX, gpu, view};

/// Bounds of mean FLIP and SSIM from the hill.
const HILL_BOUNDS: [f64; 2] = [0.14, 0.49];

/// Checks that all render options keep to an upper bound of mean FLIP and a lower bound of SSIM.
fn compare(name: &str, [most_flip, least_ssim]: [f64; 2]) -> Result<()> {
    let gpu = gpu()?;
    let (mut still, reference) = view(&gpu, name, SIZE_PX)?;
    let mut canvas = still.canvas(&gpu, Quality::Medium);
    let mut failures = Vec::new();
    for method in METHODS {
        canvas.set_options(method.look());
        let (picture, _) = still.draw(&mut canvas);
        let similarity = Similarity::of(&reference, &picture)?;
        println!("{name}, {}: {similarity:?}", method.name());
        if similarity.flip_mean > most_flip || similarity.ssim < least_ssim {
            let seen = std::env::temp_dir().join(format!("prairie-{name}-{}-{}.png", method.far.name(), method.order.name()));
            picture.save(&seen)?;
            Flip::of(&reference, &picture)?.heat_map().save(&seen.with_extension("flip.png"))?;
            failures.push(format!(
                "{}: {similarity:?}, FLIP up to {most_flip} and SSIM from {least_ssim} are allowed; see {}",
                method.name(),
                seen.display()
            ));
        }
    }
    ensure!(failures.is_empty(), "{name}\n{}", failures.join("\n"));
    Ok(())
}

#[test]
fn on_foot_all_render_options_are_similar_to_the_reference() -> Result<()> {
    compare("walking-calm", [0.25, 0.37])
}

#[test]
fn in_a_storm_all_render_options_are_similar_to_the_reference() -> Result<()> {
    compare("walking-storm", [0.22, 0.55])
}

#[test]
fn from_a_hill_all_render_options_are_similar_to_the_reference() -> Result<()> {
    compare("hill-calm", HILL_BOUNDS)
}

/// Negative control of the bounds above.
#[test]
fn another_view_differs_from_the_reference() -> Result<()> {
    let gpu = gpu()?;
    let (mut still, reference) = view(&gpu, "hill-calm", SIZE_PX)?;
    still.camera.turn(0.3, 0.0);
    let mut canvas = still.canvas(&gpu, Quality::Medium);
    let similarity = Similarity::of(&reference, &still.draw(&mut canvas).0)?;
    let [most_flip, least_ssim] = HILL_BOUNDS;
    ensure!(similarity.flip_mean > most_flip && similarity.ssim < least_ssim, "{similarity:?}");
    Ok(())
}
