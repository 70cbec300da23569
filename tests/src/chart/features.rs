//! What parts of a scene cost: a step of the world, its causes on the wire, and a frame, with and without each of them.

use std::time::Instant;

use anyhow::Result;
use prairie::studio::{Act, Stage, chase};
use prairie_client::camera::Camera;
use prairie_client::render::{Gpu, OffscreenRenderer, Quality};
use prairie_core::grass::StepCodec;
use prairie_core::scene::{Scene, Snow, TreeShape};
use prairie_core::wire::{self, Drive, ServerMessage};

use prairie::charts::still::frame_secs;
use prairie_charts::machine::machine;
use prairie_charts::table::markdown;

const SCENE: &str = "snow";
/// Steps between two messages with causes.
const STEPS_PER_FRAME: u64 = 3;
/// Position of the camera behind, above and to the right of a vehicle (m).
const BEHIND_M: [f32; 3] = [7.0, 2.2, 0.0];

/// Time for which nobody is watched in a round (s).
const IDLE_SECS: f32 = 5.0;

/// A scene with one part more than another.
struct Case {
    name: &'static str,
    change: fn(&mut Scene),
    act: Act,
}

const CASES: [Case; 12] = [
    Case { name: "nobody, still air", change: still, act: Act::Wind },
    Case { name: "nobody", change: |_| {}, act: Act::Wind },
    Case { name: "nobody, dust", change: |scene| scene.wind.dust.release_per_s = 1.0, act: Act::Wind },
    Case { name: "nobody, rain", change: |scene| scene.rain.rate_mm_per_h = 20.0, act: Act::Wind },
    Case { name: "a car", change: |_| {}, act: Act::Track },
    Case { name: "a walker", change: |_| {}, act: Act::Hike },
    Case { name: "a monster", change: |_| {}, act: Act::Walk },
    Case { name: "nobody, on snow", change: lies, act: Act::Wind },
    Case { name: "a car on snow", change: lies, act: Act::Track },
    Case { name: "a walker on snow", change: lies, act: Act::Hike },
    Case { name: "a car on snow, in snowfall", change: falls, act: Act::Track },
    Case { name: "a car, trees of components", change: |scene| scene.plants.tree_shape = TreeShape::Grown, act: Act::Track },
];

fn still(scene: &mut Scene) {
    (scene.wind.mean_m_per_s, scene.wind.sources, scene.wind.turbulence) = ([0.0; 2], 0, 0.0);
}

fn lies(scene: &mut Scene) {
    scene.snow = Snow { depth_m: 0.2, density_kg_m3: 120.0, fall_m_per_h: 0.0, ..scene.snow };
}

fn falls(scene: &mut Scene) {
    scene.snow = Snow { depth_m: 0.2, density_kg_m3: 120.0, fall_m_per_h: 0.2, ..scene.snow };
}

/// Cost of a case.
struct Cost {
    /// Mean and largest time of a step (ms), and causes of the steps (kbit/s).
    step_ms: [f64; 2],
    causes_kbit_per_s: f64,
    /// Median frame time (ms).
    frame_ms: f64,
    /// Touched patches, those with bent or flattened grass or disturbed snow.
    patches: usize,
}

impl Case {
    fn measure(&self, gpu: &Gpu, size_px: [u32; 2], [rounds, frames]: [u32; 2]) -> Result<Cost> {
        let mut stage = Stage::changed(SCENE, |scene| {
            (scene.objects.self_driving, scene.snow.depth_m) = (0, 0.0);
            (self.change)(scene);
        })?;
        let scene = stage.scene().clone();
        let start = Camera::start(&scene.camera, scene.extent_m(), |x, z| stage.ground_m(x, z));
        self.act.begin(&mut stage, start.eye_m.to_array());
        let (mut codec, mut bytes, mut steps, mut sum_ms, mut most_ms) = (StepCodec::default(), 0, 0_u64, 0.0, 0.0_f64);
        let script: Vec<_> = if self.act.script().is_empty() { vec![(IDLE_SECS, Drive::default())] } else { self.act.script().to_vec() };
        for &(secs, drive) in script.iter().cycle().take(script.len() * rounds as usize) {
            if self.act.vehicle().is_some() {
                stage.drive(1, drive);
            }
            for _ in 0..(secs * scene.tick_hz).round() as u64 {
                let begun = Instant::now();
                stage.world.step(&[]);
                let ms = 1e3 * begun.elapsed().as_secs_f64();
                (sum_ms, most_ms, steps) = (sum_ms + ms, most_ms.max(ms), steps + 1);
                let tick = stage.world.tick();
                if tick.is_multiple_of(STEPS_PER_FRAME) {
                    let records = stage.world.snapshot().steps;
                    let new = records.iter().filter(|record| record.tick > tick - STEPS_PER_FRAME).map(|record| &**record);
                    let message = codec.encode(new).map(|steps| ServerMessage::Steps {
                        first_tick: steps.first_tick,
                        steps: steps.heads,
                        moves: steps.moves,
                    });
                    bytes += message.map_or(0, |message| wire::encode(&message).len());
                }
            }
        }
        let objects = stage.show()?;
        let camera = match self.act.pose(&stage, &objects)? {
            Some(pose) => chase(&pose, BEHIND_M, |x, z| stage.ground_m(x, z)),
            None => start,
        };
        let mut canvas = OffscreenRenderer::new(gpu, size_px, Quality::Medium);
        let frame_ms = 1e3 * frame_secs(&mut canvas, &mut stage.mirror, &camera, frames);
        let secs = steps as f64 / f64::from(scene.tick_hz);
        Ok(Cost {
            step_ms: [sum_ms / steps as f64, most_ms],
            causes_kbit_per_s: 8e-3 * bytes as f64 / secs,
            frame_ms,
            patches: stage.world.snapshot().patches.len(),
        })
    }
}

/// Measures all cases; returns the page as Markdown.
///
/// # Errors
/// When there is no GPU, or a scene cannot be played.
pub fn report(quick: bool, mut progress: impl FnMut(&str)) -> Result<String> {
    let gpu = Gpu::headless()?;
    let (size_px, counts) = if quick { ([160, 90], [1, 1]) } else { ([640, 360], [4, 15]) };
    let mut rows = Vec::new();
    for case in &CASES {
        progress(case.name);
        let cost = case.measure(&gpu, size_px, counts)?;
        let [mean, most] = cost.step_ms.map(|ms| format!("{ms:.2}"));
        let rest = [format!("{:.2}", cost.causes_kbit_per_s), cost.patches.to_string(), format!("{:.0}", cost.frame_ms)];
        rows.push([vec![case.name.to_owned(), mean, most], rest.to_vec()].concat());
    }
    let header = ["in the valley meadow", "step (ms)", "longest step (ms)", "causes (kbit/s)", "touched patches", "frame (ms)"];
    Ok(format!(
        "# What parts of a scene cost\n\n```sh\ncargo run --release -p tests --bin chart -- features\n```\n\n\
         The land of `{SCENE}`, without snow unless it is named; {}. Steps of the world on one thread, with wind and 60 a second; causes are what a page with a replica of the grass \
         receives of a vehicle, beside its pose. Frames of {} × {} px at medium quality, median of {}, on {}: behind the vehicle where the drive ends, which differs between vehicles.\n\n{}",
        machine(),
        size_px[0],
        size_px[1],
        counts[1],
        gpu.adapter_name,
        markdown(&header, &rows)
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_case_changes_what_it_names() {
        let snow = |case: &Case| {
            let stage = Stage::changed(SCENE, |scene| {
                scene.snow.depth_m = 0.0;
                (case.change)(scene);
            });
            stage.unwrap().scene().snow.lies()
        };
        for case in &CASES {
            assert_eq!(snow(case), case.name.contains("snow"), "{}", case.name);
            assert_eq!(case.act.vehicle().is_some(), !case.name.contains("nobody"), "{}", case.name);
        }
    }
}
