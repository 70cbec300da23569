//! Time of frames with and without occlusion culling.

use std::fs;

use anyhow::{Context as _, Result};
use glam::Vec3;
use prairie::charts::still::Still;
use prairie::charts::views::{View, over};
use prairie::charts::worlds::{hills_m, loaded_hills};
use prairie::studio::Act;
use prairie_client::camera::Camera;
use prairie_client::render::{Gpu, Occlusion, OffscreenRenderer as Canvas, Quality, RenderOptions};
use prairie_client::state::Mirror;

use crate::gpu;

const SIZE_PX: [u32; 2] = [640, 360];
/// Frames in turns, after the first two.
const FRAMES: usize = 10;
const DT_SECS: f32 = 1.0 / 30.0;

/// A scene and a camera.
struct Place {
    name: &'static str,
    mirror: Mirror,
    camera: Camera,
}

impl Place {
    fn of(name: &'static str, scene: &'static str, at_m: [f32; 2], height_m: f32, heading_deg: f32) -> Result<Self> {
        let view = View { name, scene, act: Act::Wind, eye: over(at_m, height_m, heading_deg, -3.0), shows: "", answers: "" };
        let still = Still::of(&view, SIZE_PX)?;
        Ok(Self { name, mirror: still.stage.mirror, camera: still.camera })
    }

    /// Hills of 256 m with a wood of a tree on a fifth of the pixels, in the northern half; from before or within it.
    fn wood(name: &'static str, z: f32) -> Result<Self> {
        let is_tree = |at: u32| at / 129 < 64 && at.wrapping_mul(2_654_435_761) >> 24 < 51;
        let mut mirror = Mirror::default();
        mirror.apply(loaded_hills(|at| if is_tree(at) { 253 } else { 255 })?.message())?;
        let camera = Camera { eye_m: Vec3::new(121.0, hills_m(121.0, z) + 1.7, z), ..Camera::default() };
        Ok(Self { name, mirror, camera })
    }

    fn all() -> Result<Vec<Self>> {
        Ok(vec![
            Self::of("open meadow", "meadow", [124.0, 197.0], 1.7, 20.0)?,
            Self::of("behind a hill", "meadow", [124.0, 197.0], 0.3, 200.0)?,
            Self::of("before a house", "homestead", [52.5, 52.0], 1.7, 0.0)?,
            Self::of("yard of the homestead", "homestead", [69.0, 110.0], 1.7, -20.0)?,
            Self::wood("before a wood", 140.0)?,
            Self::wood("in a wood", 100.0)?,
        ])
    }
}

/// CPU time of all threads of this process so far (s).
fn cpu_secs() -> Result<f64> {
    let mut nanos = 0_u64;
    for task in fs::read_dir("/proc/self/task")? {
        let text = fs::read_to_string(task?.path().join("schedstat")).unwrap_or_default();
        nanos += text.split(' ').next().and_then(|first| first.parse::<u64>().ok()).unwrap_or(0);
    }
    Ok(nanos as f64 * 1e-9)
}

fn median(mut secs: Vec<f64>) -> f64 {
    secs.sort_by(f64::total_cmp);
    secs[secs.len() / 2]
}

/// Prints, for each variant, the CPU time of a frame, plants bent, solids in view, solids drawn, and their triangles.
fn measure(gpu: &Gpu, place: &mut Place, quality: Quality) -> Result<()> {
    let variants = [Occlusion::Never, Occlusion::Adaptive, Occlusion::Always];
    let mut canvases = variants.map(|occlusion| {
        let mut canvas = Canvas::new(gpu, SIZE_PX, quality);
        canvas.set_options(RenderOptions { occlusion, ..RenderOptions::default() });
        canvas
    });
    let mut secs = [const { Vec::new() }; 3];
    for frame in 0..FRAMES + 2 {
        for (canvas, secs) in canvases.iter_mut().zip(&mut secs) {
            let begun = cpu_secs()?;
            let time_secs = place.mirror.time_secs() + frame as f64 * f64::from(DT_SECS);
            canvas.draw(&mut place.mirror, &place.camera, time_secs, DT_SECS);
            if frame >= 2 {
                secs.push(cpu_secs()? - begun);
            }
        }
    }
    let without = median(secs[0].clone());
    for ((variant, canvas), secs) in variants.iter().zip(&canvases).zip(secs) {
        let ([solids, drawn, triangles], time) = (canvas.drawn_solids(), median(secs));
        println!(
            "| {}, {} | {variant:?} | {:.1} | {:.3} | {} | {solids} | {drawn} | {triangles} | {} |",
            place.name,
            quality.name(),
            1e3 * time,
            time / without,
            canvas.bent_plants(),
            canvas.drawn_underbrush()
        );
    }
    Ok(())
}

#[test]
#[ignore = "a measurement: cargo nextest run --release -p tests --test picture --run-ignored only the_time_of_frames_with_occlusion --no-capture"]
fn the_time_of_frames_with_occlusion() -> Result<()> {
    let gpu = gpu()?;
    println!("| place, quality | occlusion | CPU ms | ratio | plants bent | solids in view | drawn | their triangles | underbrush |");
    for mut place in Place::all()? {
        for quality in [Quality::Low, Quality::Medium] {
            measure(&gpu, &mut place, quality).context(place.name)?;
        }
    }
    Ok(())
}
