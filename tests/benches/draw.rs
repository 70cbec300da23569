//! Frame times in software rendering by quality, representation of distant plants, and number of plants in the scene.
//!
//! First a table of medians, each also relative to low quality over bare terrain; then the same views under criterion.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use prairie::charts::still::{Still, frame_secs};
use prairie::charts::views::View;
use prairie::charts::worlds::{flat_meadow, on_foot};
use prairie_client::render::{FarPlants, Gpu, OffscreenRenderer as Canvas, Quality, RenderOptions};
use std::time::Duration;

const SIZES_PX: [[u32; 2]; 2] = [[640, 360], [960, 540]];
const VIEW: &str = "walking-storm";
/// Number of frames per median.
const FRAMES: u32 = 7;
const DT_SECS: f32 = 1.0 / 30.0;
/// Sides of worlds (m) with 16 plant sites per square metre: 1 k, 100 k and 10 M.
const SIDES_M: [u32; 3] = [8, 80, 800];

fn gpu() -> Gpu {
    Gpu::headless().expect("a Vulkan driver such as Mesa's lavapipe")
}

fn still(size_px: [u32; 2]) -> Still {
    View::find(VIEW).and_then(|view| Still::of(view, size_px)).expect("a built-in view can be played")
}

fn look(far: FarPlants) -> RenderOptions {
    RenderOptions { far_plants: far, ..RenderOptions::default() }
}

fn ratios(_: &mut Criterion) {
    let gpu = gpu();
    for size_px in SIZES_PX {
        println!("\n| {VIEW}, {} × {} px | median ms | × low, land |\n|---|---:|---:|", size_px[0], size_px[1]);
        let mut still = still(size_px);
        let mut least_ms = None;
        for quality in Quality::ALL {
            let mut canvas = still.canvas(&gpu, quality);
            for far in FarPlants::ALL {
                canvas.set_options(look(far));
                let ms = 1e3 * still.frame_secs(&mut canvas, FRAMES);
                let ratio = ms / *least_ms.get_or_insert(ms);
                println!("| {}, {} | {ms:.1} | {ratio:.2} |", quality.name(), far.name());
            }
        }
    }
    println!("\n| places for plants, {} × {} px | low ms | medium ms | high ms |\n|---:|---:|---:|---:|", SIZES_PX[0][0], SIZES_PX[0][1]);
    for side_m in SIDES_M {
        let (mut mirror, plants) = flat_meadow(side_m).expect("a client takes a flat meadow");
        let ms = [Quality::Low, Quality::Medium, Quality::High]
            .map(|quality| 1e3 * frame_secs(&mut Canvas::new(&gpu, SIZES_PX[0], quality), &mut mirror, &on_foot(side_m), FRAMES));
        println!("| {plants:.0} | {:.1} | {:.1} | {:.1} |", ms[0], ms[1], ms[2]);
    }
}

fn frames(criterion: &mut Criterion) {
    let gpu = gpu();
    for size_px in SIZES_PX {
        let mut group = criterion.benchmark_group(format!("frame {}x{}", size_px[0], size_px[1]));
        let mut still = still(size_px);
        for quality in [Quality::Low, Quality::Medium, Quality::High] {
            let mut canvas = still.canvas(&gpu, quality);
            for far in FarPlants::ALL {
                canvas.set_options(look(far));
                let mut time_secs = 0.0;
                group.bench_function(BenchmarkId::new(quality.name(), far.name()), |bench| {
                    bench.iter(|| {
                        time_secs += f64::from(DT_SECS);
                        canvas.draw(&mut still.stage.mirror, &still.camera, time_secs, DT_SECS)
                    });
                });
            }
        }
        group.finish();
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(10).warm_up_time(Duration::from_secs(1)).measurement_time(Duration::from_secs(5));
    targets = ratios, frames
}
criterion_main!(benches);
