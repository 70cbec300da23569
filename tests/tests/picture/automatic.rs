//! What automatic quality may choose: any level of detail between that of low quality and that of ultra.
//!
//! Which level a budget buys depends on the machine; `chart picture` says it. Here it is held that the picture is good enough at whatever level is bought.

use anyhow::{Result, ensure};
use client_wasm::render::Quality;
use tests::likeness::Likeness;

use crate::{SIZE_PX, gpu, view};

/// Views that are compared.
const VIEWS: [&str; 3] = ["walking-calm", "walking-storm", "hill-calm"];
/// Largest mean FLIP of a picture whose quality is automatic.
const FLIP_LIMIT: f64 = 0.06;
/// Levels between which automatic quality chooses, by tests of a few.
const LEVELS: [f32; 3] = [0.0, 0.5, 1.5];

#[test]
fn every_view_is_near_the_reference_at_every_level() -> Result<()> {
    let gpu = gpu()?;
    let mut failures = Vec::new();
    for name in VIEWS {
        let (mut still, reference) = view(&gpu, name, SIZE_PX)?;
        let mut canvas = still.canvas(&gpu, Quality::Ultra);
        for level in LEVELS {
            canvas.set_level(level);
            let likeness = Likeness::of(&reference, &still.draw(&mut canvas).0)?;
            println!("{}, level {level}: {likeness:?}", name);
            if likeness.flip_mean > FLIP_LIMIT {
                failures.push(format!("{}, level {level}: {likeness:?}", name));
            }
        }
    }
    ensure!(failures.is_empty(), "mean FLIP up to {FLIP_LIMIT} is allowed\n{}", failures.join("\n"));
    Ok(())
}
