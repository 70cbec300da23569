//! Times of the renderer on this machine's graphics card, beside their aims: whole frames and each kind of pass, by picture size and quality, and the
//! simulation of near blades.

use std::time::Instant;

use anyhow::{Context as _, Result};
use prairie::studio::Stage;
use prairie_client::camera::Camera;
use prairie_client::render::{BlendOrder, Gpu, OffscreenRenderer as Canvas, PassSecs, Quality, RenderOptions};

use prairie_charts::table::markdown;

/// Picture sizes (px), and with `quick` a small one.
const SIZES_PX: [[u32; 2]; 2] = [[1920, 1080], [3840, 2160]];
const QUICK_SIZES_PX: [[u32; 2]; 1] = [[320, 180]];
/// Qualities with the aimed frame time at the first size (ms).
const QUALITIES: [(Quality, Option<f64>); 3] =
    [(Quality::Medium, Some(1e3 / 60.0)), (Quality::High, Some(1e3 / 30.0)), (Quality::Ultra, None)];
const DT_SECS: f32 = 1.0 / 60.0;
/// Untimed frames of a case, which fill buffers and let the card raise its clock.
const WARM_UP_FRAMES: usize = 10;
const QUICK_WARM_UP_FRAMES: usize = 1;
/// Timed frames of a case (odd; the median counts).
const FRAMES: usize = 61;
/// Time after which a case has enough frames, however few (s).
const ENOUGH_SECS: f64 = 5.0;
/// The densest near field: 240² blades in each of nine grids.
const DENSE_PER_SIDE: u32 = 48;
/// Longest time for a million near blades to be culled, bent and sorted (ms).
const MILLION_BLADES_MS: f64 = 0.5;

/// Median times of a frame (ms).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Times {
    /// From the first command until the card has finished, without any overlap of frames.
    frame_ms: f64,
    /// By the card's clock.
    passes: PassSecs,
}

/// Measures everything; returns the tables as Markdown.
///
/// # Errors
/// When there is no GPU, or it has no clock.
pub fn report(quick: bool, machine: &str, mut say: impl FnMut(&str)) -> Result<String> {
    let gpu = Gpu::headless()?;
    let sizes_px: &[[u32; 2]] = if quick { &QUICK_SIZES_PX } else { &SIZES_PX };
    let (mut stage, camera) = meadow(|_| {})?;
    let mut rows = Vec::new();
    for (at, size_px) in sizes_px.iter().enumerate() {
        for (quality, longest_ms) in QUALITIES {
            say(&format!("{} × {}, {}", size_px[0], size_px[1], quality.name()));
            let (times, _) = times(&mut stage, &camera, Canvas::new(&gpu, *size_px, quality), quick)?;
            rows.push(frame_row(*size_px, quality, times, longest_ms.filter(|_| at == 0)));
        }
    }
    say("near blades");
    let (mut stage, camera) = meadow(|per_side| *per_side = DENSE_PER_SIDE)?;
    let mut canvas = Canvas::new(&gpu, sizes_px[0], Quality::High);
    canvas.set_options(RenderOptions { blend_order: BlendOrder::Sorted, ..RenderOptions::default() });
    let (near, blades) = times(&mut stage, &camera, canvas, quick)?;
    let header = ["size (px)", "quality", "frame (ms)", "frames/s", "shadows", "cull, bend", "picture", "tone", "aim (ms)", "met"];
    let blade_header = ["near blades in view", "cull, bend, sort (ms)", "per million (ms)", "aim (ms)", "met"];
    Ok(format!(
        "# Renderer on {}\n\n{machine}\n\nScene `meadow` from its start; medians. A frame lasts from its first command until the card has finished, and the next begins only then. Passes by \
         the card's clock (ms). Ultra draws four pixels for each shown, where that is at most 10 million.\n\n{}\nNear blades of the densest field that a scene may have, drawn back to front; the million is \
         found in proportion to those in view, which alone are bent:\n\n{}",
        gpu.adapter_name,
        markdown(&header, &rows),
        markdown(&blade_header, &[blade_row(blades, 1e3 * near.passes.bend)])
    ))
}

/// The meadow at its start, with a changed density of plants, and its first view.
fn meadow(change: impl Fn(&mut u32)) -> Result<(Stage, Camera)> {
    let mut stage = Stage::changed("meadow", |scene| change(&mut scene.plants.plants_per_side))?;
    let camera = Camera::start(&stage.scene().camera, stage.scene().extent_m(), |x, z| stage.ground_m(x, z));
    prairie::studio::play(&mut stage, prairie::studio::Act::Wind, camera.eye_m.to_array())?;
    Ok((stage, camera))
}

/// Times of a frame, and the number of near plants that it bent.
fn times(stage: &mut Stage, camera: &Camera, mut canvas: Canvas, quick: bool) -> Result<(Times, u32)> {
    let start_secs = stage.mirror.time_secs();
    let mut draw = |frame: usize| -> Result<Times> {
        let begun = Instant::now();
        canvas.draw(&mut stage.mirror, camera, start_secs + frame as f64 * f64::from(DT_SECS), DT_SECS);
        let frame_ms = 1e3 * begun.elapsed().as_secs_f64();
        Ok(Times { frame_ms, passes: canvas.pass_secs().context("the device has no clock")? })
    };
    let warm_up = if quick { QUICK_WARM_UP_FRAMES } else { WARM_UP_FRAMES };
    let begun = Instant::now();
    for frame in 0..warm_up {
        draw(frame)?;
        if begun.elapsed().as_secs_f64() > ENOUGH_SECS {
            break;
        }
    }
    let (begun, mut found) = (Instant::now(), vec![draw(warm_up)?]);
    while found.len() < if quick { 1 } else { FRAMES } && begun.elapsed().as_secs_f64() < ENOUGH_SECS {
        found.push(draw(warm_up + found.len())?);
    }
    let median = |of: fn(&Times) -> f64| {
        let mut values: Vec<f64> = found.iter().map(of).collect();
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    };
    let times = Times {
        frame_ms: median(|times| times.frame_ms),
        passes: PassSecs {
            shadows: median(|times| times.passes.shadows),
            bend: median(|times| times.passes.bend),
            picture: median(|times| times.passes.picture),
            tone: median(|times| times.passes.tone),
        },
    };
    Ok((times, canvas.bent_plants()))
}

fn frame_row(size_px: [u32; 2], quality: Quality, Times { frame_ms, passes }: Times, longest_ms: Option<f64>) -> Vec<String> {
    let PassSecs { shadows, bend, picture, tone } = passes;
    let size = format!("{} × {}", size_px[0], size_px[1]);
    let times = [frame_ms, 1e3 / frame_ms].map(|value| format!("{value:.1}"));
    let passes = [shadows, bend, picture, tone].map(|secs| format!("{:.2}", 1e3 * secs));
    [vec![size, quality.name().to_owned()], times.to_vec(), passes.to_vec(), verdict(frame_ms, longest_ms)].concat()
}

fn blade_row(blades: u32, ms: f64) -> Vec<String> {
    let per_million = 1e6 * ms / f64::from(blades.max(1));
    let shown = [blades.to_string(), format!("{ms:.2}"), format!("{per_million:.2}")];
    [shown.to_vec(), verdict(per_million, Some(MILLION_BLADES_MS))].concat()
}

/// An aim and whether a time meets it.
fn verdict(ms: f64, longest_ms: Option<f64>) -> Vec<String> {
    let shown = |longest_ms: f64| vec![format!("{longest_ms:.1}"), if ms <= longest_ms { "yes" } else { "no" }.to_owned()];
    longest_ms.map_or_else(|| vec![String::new(); 2], shown)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_report_has_every_case_with_times() -> Result<()> {
        let report = report(true, "made-up machine", |_| {})?;
        for quality in ["medium", "high", "ultra"] {
            let row = report.lines().find(|line| line.starts_with("| 320 × 180") && line.contains(quality)).context("a row")?;
            let times: Vec<f64> = row.split('|').filter_map(|cell| cell.trim().parse().ok()).collect();
            // Frame, frames/s and four passes.
            assert!(times.len() >= 6 && times[0] > 0.0 && times[3] > 0.0 && times[4] > 0.0, "{row}");
        }
        assert!(report.contains("made-up machine"));
        Ok(())
    }

    #[test]
    fn aims_are_met_or_missed() {
        assert_eq!(verdict(16.0, Some(1e3 / 60.0)), ["16.7", "yes"]);
        assert_eq!(verdict(17.0, Some(1e3 / 60.0)), ["16.7", "no"]);
        assert_eq!(verdict(17.0, None), ["", ""]);
        assert_eq!(blade_row(500_000, 0.2), ["500000", "0.20", "0.40", "0.5", "yes"]);
        assert_eq!(blade_row(500_000, 0.3)[4], "no");
    }

    #[test]
    fn the_dense_meadow_has_nearly_twice_the_usual_near_blades() -> Result<()> {
        const USUAL_LIMIT: u32 = 230_400;
        let gpu = Gpu::headless()?;
        let (mut stage, camera) = meadow(|per_side| *per_side = DENSE_PER_SIDE)?;
        let stats = Canvas::new(&gpu, QUICK_SIZES_PX[0], Quality::High).draw(&mut stage.mirror, &camera, 0.0, 0.0);
        assert!(stats.blades > USUAL_LIMIT * 17 / 10, "{stats:?}");
        Ok(())
    }
}
