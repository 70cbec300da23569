//! No popping: changes between frames of a flight, beyond those of the camera motion.

use std::ops::Range;

use anyhow::{Context as _, Result, ensure};
use prairie::charts::image::Picture;
use prairie::charts::similarity::Flip;
use prairie::charts::still::Still;
use prairie::charts::views::View;
use prairie_client::render::{Gpu, OffscreenRenderer as Canvas, Quality, RenderOptions};

use crate::{ensure_refused, gpu};

/// Number of frames of a flight, and distance between two of them (m).
#[derive(Clone, Copy)]
struct Flight {
    frames: u32,
    step_m: f32,
}

const SIZE_PX: [u32; 2] = [192, 108];
/// Bound of mean FLIP between consecutive frames due to the level of detail alone.
const FLIP_LIMIT: f64 = 0.02;

fn still() -> Result<Still> {
    Still::of(View::find("walking-storm")?, SIZE_PX)
}

/// FLIP between consecutive frames of a straight flight at eye level, at a fixed time; `draw` gets the number of the frame.
fn changes(still: &mut Still, flight: Flight, mut draw: impl FnMut(&mut Still, u32) -> Picture) -> Result<Vec<f64>> {
    let start = still.camera;
    let ahead = start.forward().with_y(0.0).normalize();
    let mut frames = Vec::new();
    for frame in 0..flight.frames {
        let mut eye_m = start.eye_m + ahead * (frame as f32 * flight.step_m);
        eye_m.y = still.stage.ground_m(eye_m.x, eye_m.z) + 1.7;
        still.camera.eye_m = eye_m;
        frames.push(draw(still, frame));
    }
    still.camera = start;
    flips(frames)
}

/// The changes of a flight with every plant at full detail, which are those of the camera motion.
fn changes_of_reference(gpu: &Gpu, still: &mut Still, flight: Flight) -> Result<Vec<f64>> {
    let mut canvas = Canvas::new(gpu, SIZE_PX, Quality::Reference);
    changes(still, flight, |still, _| still.draw(&mut canvas).0)
}

/// FLIP between consecutive pictures.
fn flips(pictures: impl IntoIterator<Item = Picture>) -> Result<Vec<f64>> {
    let mut pictures = pictures.into_iter();
    let mut before = pictures.next().context("no picture")?;
    let mut found = Vec::new();
    for picture in pictures {
        found.push(Flip::of(&before, &picture)?.mean());
        before = picture;
    }
    Ok(found)
}

/// Place and value of the largest change.
fn largest(changes: &[f64]) -> (usize, f64) {
    changes.iter().copied().enumerate().max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or_default()
}

/// Checks the changes of a flight against [`FLIP_LIMIT`]. The camera motion changes the picture by itself; any change beyond that of the same flight at full
/// detail is due to the level of detail.
fn check_flight(name: &str, by_both: &[f64], by_flight: &[f64]) -> Result<()> {
    let by_detail: Vec<f64> = by_both.iter().zip(by_flight).map(|(both, flight)| both - flight).collect();
    let (at, most) = largest(&by_detail);
    println!("{name}: at most {most:.4} by detail alone, from frame {at}; {:.4} by the flight", by_flight[at]);
    ensure!(most < FLIP_LIMIT, "{name}: {most:.4} from frame {at} on, {FLIP_LIMIT} is allowed");
    Ok(())
}

fn compare(flight: Flight) -> Result<()> {
    let (gpu, mut still) = (gpu()?, still()?);
    let by_flight = changes_of_reference(&gpu, &mut still, flight)?;
    for quality in [Quality::Low, Quality::Medium] {
        let mut canvas = still.canvas(&gpu, quality);
        canvas.set_options(RenderOptions::default());
        let by_both = changes(&mut still, flight, |still, _| still.draw(&mut canvas).0)?;
        check_flight(quality.name(), &by_both, &by_flight)?;
    }
    ensure_jumps_are_refused(&gpu, &mut still, flight, &by_flight)
}

/// Negative control of [`FLIP_LIMIT`]: the level of detail jumps from frame to frame, within the range of automatic quality.
fn ensure_jumps_are_refused(gpu: &Gpu, still: &mut Still, flight: Flight, by_flight: &[f64]) -> Result<()> {
    let mut canvas = still.canvas(gpu, Quality::High);
    let by_both = changes(still, flight, |still, frame| {
        canvas.set_level([0.0, 1.5][frame as usize % 2]);
        still.draw(&mut canvas).0
    })?;
    ensure_refused(check_flight("jumping", &by_both, by_flight), "is allowed")
}

#[test]
fn level_of_detail_alone_changes_little_between_frames() -> Result<()> {
    compare(Flight { frames: 2, step_m: 0.25 })
}

#[test]
#[ignore = "many minutes: cargo nextest run --release -p tests --test picture --run-ignored only ten_metres --no-capture"]
fn level_of_detail_alone_changes_little_over_ten_metres() -> Result<()> {
    compare(Flight { frames: 41, step_m: 0.25 })
}

/// As a car drives at 36 km/h, in ten frames a second.
#[test]
#[ignore = "an hour: cargo nextest run --release -p tests --test picture --run-ignored only hundred_metres --no-capture"]
fn level_of_detail_alone_changes_little_over_a_hundred_metres() -> Result<()> {
    compare(Flight { frames: 101, step_m: 1.0 })
}

/// Steps of the level of detail between low and high, as automatic quality makes them, and the bound of mean FLIP for each.
const LEVELS: Range<u32> = 0..100;
const LEVEL_STEP: f32 = 0.02;
const STEP_FLIP_LIMIT: f64 = 0.02;

/// Checks the changes between pictures whose levels of detail differ by a step, against [`STEP_FLIP_LIMIT`].
fn check_steps(steps: &[f64], level_step: f32) -> Result<()> {
    let (at, most) = largest(steps);
    let mean = steps.iter().sum::<f64>() / steps.len() as f64;
    println!("at most {most:.4} from level {:.2}, {mean:.4} on the average", at as f32 * level_step);
    ensure!(most < STEP_FLIP_LIMIT, "{most:.4} from level {:.2}, {STEP_FLIP_LIMIT} is allowed", at as f32 * level_step);
    Ok(())
}

/// FLIP between pictures with levels of detail from 0 on. Camera and time are fixed: only the level of detail changes.
fn changes_by_level(levels: Range<u32>, level_step: f32) -> Result<Vec<f64>> {
    let (gpu, mut still) = (gpu()?, still()?);
    let mut canvas = still.canvas(&gpu, Quality::Ultra);
    flips(levels.map(|step| {
        canvas.set_level(step as f32 * level_step);
        still.draw(&mut canvas).0
    }))
}

#[test]
fn small_steps_of_the_level_of_detail_change_the_picture_little() -> Result<()> {
    check_steps(&changes_by_level(LEVELS, LEVEL_STEP)?, LEVEL_STEP)
}

/// Negative control of [`STEP_FLIP_LIMIT`]: a step ten times as large.
#[test]
fn a_large_step_of_the_level_of_detail_is_noticed() -> Result<()> {
    ensure_refused(check_steps(&changes_by_level(0..2, 10.0 * LEVEL_STEP)?, 10.0 * LEVEL_STEP), "is allowed")
}
