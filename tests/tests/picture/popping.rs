//! No popping: changes between frames of a flight, beyond those of the camera motion.

use anyhow::{Result, ensure};
use prairie_client::render::{OffscreenRenderer as Canvas, Quality, RenderOptions};
use tests::similarity::Flip;
use tests::still::Still;
use tests::views::View;

use crate::gpu;

/// Number of frames of a flight, and distance between two of them (m).
#[derive(Clone, Copy)]
struct Flight {
    frames: u32,
    step_m: f32,
}

const SIZE_PX: [u32; 2] = [192, 108];
/// Bound of mean FLIP between consecutive frames due to the level of detail alone.
const FLIP_LIMIT: f64 = 0.02;

/// FLIP between consecutive frames of a straight flight at eye level, at a fixed time.
fn changes(still: &mut Still, canvas: &mut Canvas, flight: Flight) -> Result<Vec<f64>> {
    let start = still.camera;
    let ahead = start.forward().with_y(0.0).normalize();
    let mut frames = Vec::new();
    for frame in 0..flight.frames {
        let mut eye_m = start.eye_m + ahead * (frame as f32 * flight.step_m);
        eye_m.y = still.stage.ground_m(eye_m.x, eye_m.z) + 1.7;
        still.camera.eye_m = eye_m;
        frames.push(still.draw(canvas).0);
    }
    still.camera = start;
    frames.windows(2).map(|pair| Ok(Flip::of(&pair[0], &pair[1])?.mean())).collect()
}

/// The camera motion changes the picture by itself. The same flight with every plant at full detail shows that part; any further change is due to the level of
/// detail.
fn compare(flight: Flight) -> Result<()> {
    let gpu = gpu()?;
    let mut still = Still::of(View::find("walking-storm")?, SIZE_PX)?;
    let by_flight = changes(&mut still, &mut Canvas::new(&gpu, SIZE_PX, Quality::Reference), flight)?;
    for quality in [Quality::Low, Quality::Medium] {
        let mut canvas = still.canvas(&gpu, quality);
        canvas.set_options(RenderOptions::default());
        let by_both = changes(&mut still, &mut canvas, flight)?;
        let by_detail: Vec<f64> = by_both.iter().zip(&by_flight).map(|(both, flight)| both - flight).collect();
        let (at, most) = by_detail.iter().copied().enumerate().max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or_default();
        println!("{}: at most {most:.4} by detail alone, from frame {at}; {:.4} by the flight", quality.name(), by_flight[at]);
        ensure!(most < FLIP_LIMIT, "{}: {most:.4} from frame {at} on, {FLIP_LIMIT} is allowed", quality.name());
    }
    Ok(())
}

#[test]
fn level_of_detail_alone_changes_little_between_frames() -> Result<()> {
    compare(Flight { frames: 4, step_m: 0.25 })
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

/// Bound of mean FLIP for a step of the level of detail, between low and high, as automatic quality makes it.
const LEVELS: std::ops::Range<u32> = 0..100;
const LEVEL_STEP: f32 = 0.02;
const STEP_FLIP_LIMIT: f64 = 0.05;

/// Camera and time are fixed: only the level of detail changes.
#[test]
fn small_steps_of_the_level_of_detail_change_the_picture_little() -> Result<()> {
    let gpu = gpu()?;
    let mut still = Still::of(View::find("walking-storm")?, SIZE_PX)?;
    let mut canvas = still.canvas(&gpu, Quality::Ultra);
    let mut pictures = LEVELS.map(|step| {
        canvas.set_level(step as f32 * LEVEL_STEP);
        still.draw(&mut canvas).0
    });
    let mut before = pictures.next().expect("there are levels");
    let mut steps = Vec::new();
    for picture in pictures {
        steps.push(Flip::of(&before, &picture)?.mean());
        before = picture;
    }
    let (at, most) = steps.iter().copied().enumerate().max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or_default();
    let mean = steps.iter().sum::<f64>() / steps.len() as f64;
    println!("at most {most:.4} from level {:.2}, {mean:.4} on the average", at as f32 * LEVEL_STEP);
    ensure!(most < STEP_FLIP_LIMIT, "{most:.4} from level {:.2}, {STEP_FLIP_LIMIT} is allowed", at as f32 * LEVEL_STEP);
    Ok(())
}
