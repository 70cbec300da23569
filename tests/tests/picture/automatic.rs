//! Similarity at every level of detail that automatic quality may choose, from low to ultra.
//!
//! The level within a frame budget depends on the machine (see `chart picture`); these tests bound the error at any level.

use anyhow::{Result, ensure};
use prairie_client::ladder::LEAST_RESOLUTION;
use prairie_client::render::Quality;
use tests::similarity::Similarity;

use crate::{SIZE_PX, gpu, view};

/// Compared views, and the bound of mean FLIP at any level: 10 % above the measured value. The aim of 0.06 is missed: at so few pixels most of a
/// picture of grass shows single blades, and beyond a few metres not all of them are drawn.
const VIEWS: [(&str, f64); 3] = [("walking-calm", 0.25), ("walking-storm", 0.175), ("hill-calm", 0.13)];
/// Range of levels for automatic quality.
const LEVELS: [f32; 2] = [0.0, 1.5];
/// Least resolution, and bounds of mean FLIP there on the same views: half more than at the full resolution, for a quarter of the pixels.
const LEAST: [f64; 3] = [0.375, 0.26, 0.195];

#[test]
fn every_view_is_similar_to_the_reference_at_every_level_of_detail() -> Result<()> {
    let gpu = gpu()?;
    let mut failures = Vec::new();
    for ((name, flip_limit), least_limit) in VIEWS.into_iter().zip(LEAST) {
        let (mut still, reference) = view(&gpu, name, SIZE_PX)?;
        let mut least = still.canvas(&gpu, Quality::Low);
        least.set_resolution(LEAST_RESOLUTION);
        let similarity = Similarity::of(&reference, &still.draw(&mut least).0)?;
        println!("{name}, lowest rung: {similarity:?}");
        if similarity.flip_mean > least_limit {
            failures.push(format!("{name}, lowest rung: {similarity:?}, mean FLIP up to {least_limit} is allowed"));
        }
        let mut canvas = still.canvas(&gpu, Quality::Ultra);
        for level in LEVELS {
            canvas.set_level(level);
            let similarity = Similarity::of(&reference, &still.draw(&mut canvas).0)?;
            println!("{name}, level {level}: {similarity:?}");
            if similarity.flip_mean > flip_limit {
                failures.push(format!("{name}, level {level}: {similarity:?}, mean FLIP up to {flip_limit} is allowed"));
            }
        }
    }
    ensure!(failures.is_empty(), "too far from the reference\n{}", failures.join("\n"));
    Ok(())
}

/// Bounds of mean FLIP due to the level of detail of ultra and of high alone, with 16 samples per pixel in both pictures: ultra on foot meets the aim of 0.06;
/// the others are 10 % above the measured value.
const DETAIL_LIMITS: [(&str, f64, f64); 3] = [("walking-calm", 0.06, 0.10), ("walking-storm", 0.06, 0.07), ("hill-calm", 0.10, 0.115)];

#[test]
fn level_of_detail_alone_changes_little() -> Result<()> {
    let gpu = gpu()?;
    let mut failures = Vec::new();
    for (name, ultra, high) in DETAIL_LIMITS {
        let (mut still, reference) = view(&gpu, name, SIZE_PX)?;
        for (quality, flip_limit) in [(Quality::Ultra, ultra), (Quality::High, high)] {
            let similarity = Similarity::of(&reference, &still.draw_finely(&gpu, quality))?;
            println!("{name}, {}: {similarity:?}", quality.name());
            if similarity.flip_mean > flip_limit {
                failures.push(format!("{name}, {}: {similarity:?}, mean FLIP up to {flip_limit} is allowed", quality.name()));
            }
        }
    }
    ensure!(failures.is_empty(), "too far from the reference\n{}", failures.join("\n"));
    Ok(())
}
