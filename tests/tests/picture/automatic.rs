//! Similarity at every level of detail that automatic quality may choose, from low to ultra.
//!
//! The level within a frame budget depends on the machine (see `chart picture`); these tests bound the error at any level.

use anyhow::{Result, ensure};
use prairie::charts::image::Picture;
use prairie::charts::similarity::Similarity;
use prairie::charts::still::Still;
use prairie_client::ladder::LEAST_RESOLUTION;
use prairie_client::render::{Gpu, Quality};

use crate::{SIZE_PX, ensure_refused, gpu, view};

/// Bounds of mean FLIP on a view, 10 % above the measured values. The aim of 0.06 is missed at low: at so few pixels most of a picture of grass shows single
/// blades, and beyond a few metres not all of them are drawn.
struct Bounds {
    view: &'static str,
    /// At the least resolution and level.
    lowest_rung: f64,
    /// At each of the levels.
    levels: [f64; 2],
}

const BOUNDS: [Bounds; 3] = [
    Bounds { view: "walking-calm", lowest_rung: 0.235, levels: [0.241, 0.138] },
    Bounds { view: "walking-storm", lowest_rung: 0.195, levels: [0.145, 0.054] },
    Bounds { view: "hill-calm", lowest_rung: 0.146, levels: [0.124, 0.113] },
];
/// Range of levels for automatic quality.
const LEVELS: [f32; 2] = [0.0, 1.5];

/// Checks a picture against a bound of mean FLIP to its reference.
fn check(name: &str, reference: &Picture, picture: &Picture, flip_limit: f64) -> Result<()> {
    let similarity = Similarity::of(reference, picture)?;
    println!("{name}: {similarity:?}");
    ensure!(similarity.flip_mean <= flip_limit, "{name}: {similarity:?}, mean FLIP up to {flip_limit} is allowed");
    Ok(())
}

/// All failed checks as one error.
fn joined(checks: Vec<Result<()>>) -> Result<()> {
    let failures: Vec<_> = checks.into_iter().filter_map(Result::err).map(|failure| failure.to_string()).collect();
    ensure!(failures.is_empty(), "too far from the reference\n{}", failures.join("\n"));
    Ok(())
}

/// The picture at the least resolution and level of detail.
fn lowest_rung(gpu: &Gpu, still: &mut Still) -> Picture {
    let mut canvas = still.canvas(gpu, Quality::Low);
    canvas.set_resolution(LEAST_RESOLUTION);
    still.draw(&mut canvas).0
}

/// Checks the lowest rung and each level as a still shows them now.
fn check_levels(gpu: &Gpu, bounds: &Bounds, still: &mut Still, reference: &Picture) -> [Result<()>; 3] {
    let name = bounds.view;
    let lowest = check(&format!("{name}, lowest rung"), reference, &lowest_rung(gpu, still), bounds.lowest_rung);
    let mut canvas = still.canvas(gpu, Quality::Ultra);
    let [least, most] = [0, 1].map(|n| {
        canvas.set_level(LEVELS[n]);
        check(&format!("{name}, level {}", LEVELS[n]), reference, &still.draw(&mut canvas).0, bounds.levels[n])
    });
    [lowest, least, most]
}

#[test]
fn every_view_is_similar_to_the_reference_at_every_level_of_detail() -> Result<()> {
    let gpu = gpu()?;
    let mut checks = Vec::new();
    for bounds in &BOUNDS {
        let (mut still, reference) = view(&gpu, bounds.view, SIZE_PX)?;
        checks.extend(check_levels(&gpu, bounds, &mut still, &reference));
    }
    joined(checks)
}

/// Negative control of all [`BOUNDS`]: the camera is turned by a tenth of a radian.
#[test]
fn turned_views_differ_from_the_reference_at_every_level_of_detail() -> Result<()> {
    let gpu = gpu()?;
    for bounds in &BOUNDS {
        let (mut still, reference) = view(&gpu, bounds.view, SIZE_PX)?;
        still.camera.turn(0.1, 0.0);
        check_levels(&gpu, bounds, &mut still, &reference).into_iter().try_for_each(|checked| ensure_refused(checked, "is allowed"))?;
    }
    Ok(())
}

/// Negative control of [`BOUNDS`]: in a storm the wind has moved grass and shadows for three seconds.
#[test]
fn later_views_differ_from_the_reference_at_every_level_of_detail() -> Result<()> {
    let gpu = gpu()?;
    let bounds = &BOUNDS[1];
    let (mut still, reference) = view(&gpu, bounds.view, SIZE_PX)?;
    still.stage.run(3.0);
    still.stage.show()?;
    check_levels(&gpu, bounds, &mut still, &reference).into_iter().try_for_each(|checked| ensure_refused(checked, "is allowed"))
}

/// Negative control of the bounds at the highest level: on foot, the lowest level does not meet them.
#[test]
fn the_lowest_level_of_detail_is_no_high_one() -> Result<()> {
    let gpu = gpu()?;
    for Bounds { view: name, levels, .. } in &BOUNDS[..2] {
        let (mut still, reference) = view(&gpu, name, SIZE_PX)?;
        let mut canvas = still.canvas(&gpu, Quality::Ultra);
        canvas.set_level(LEVELS[0]);
        ensure_refused(check(name, &reference, &still.draw(&mut canvas).0, levels[1]), "is allowed")?;
    }
    Ok(())
}

/// Bounds of mean FLIP due to the level of detail of ultra and of high alone, with 16 samples per pixel in both pictures, 10 % above the measured values. Ultra
/// on foot meets the aim of 0.06.
const DETAIL_LIMITS: [(&str, f64, f64); 3] = [("walking-calm", 0.06, 0.10), ("walking-storm", 0.027, 0.07), ("hill-calm", 0.095, 0.106)];

fn check_detail(gpu: &Gpu, still: &mut Still, reference: &Picture, quality: Quality, flip_limit: f64) -> Result<()> {
    check(&format!("detail of {}", quality.name()), reference, &still.draw_finely(gpu, quality), flip_limit)
}

#[test]
fn level_of_detail_alone_changes_little() -> Result<()> {
    let gpu = gpu()?;
    let mut checks = Vec::new();
    for (name, ultra, high) in DETAIL_LIMITS {
        println!("{name}");
        let (mut still, reference) = view(&gpu, name, SIZE_PX)?;
        for (quality, flip_limit) in [(Quality::Ultra, ultra), (Quality::High, high)] {
            checks.push(check_detail(&gpu, &mut still, &reference, quality, flip_limit));
        }
    }
    joined(checks)
}

/// Negative control of [`DETAIL_LIMITS`]: the detail of low meets none of them.
#[test]
fn low_detail_alone_changes_much() -> Result<()> {
    let gpu = gpu()?;
    for (name, ultra, high) in DETAIL_LIMITS {
        let (mut still, reference) = view(&gpu, name, SIZE_PX)?;
        for flip_limit in [ultra, high] {
            ensure_refused(check_detail(&gpu, &mut still, &reference, Quality::Low, flip_limit), "is allowed")?;
        }
    }
    Ok(())
}
