//! Zhang's prairie on this machine: the platform beside that of the thesis (Table 3), and the cost of its scene (Fig. 22).

use std::time::Instant;

use anyhow::Result;
use prairie::scenes;
use prairie::studio::Act;
use prairie::world::World;
use prairie_client::render::{BlendOrder, FarPlants, Gpu, Quality, RenderOptions};

use prairie::charts::still::Still;
use prairie::charts::views::{Eye, View};
use prairie_charts::machine::{memory_gib, processor, rustc_version};
use prairie_charts::table::markdown;

const SCENE: &str = "prairie-2000";
const VIEW: View =
    View { name: SCENE, scene: SCENE, act: Act::Wind, eye: Eye::Start, shows: "the prairie with a monster", answers: "Zhang, Figure 22" };
/// A size of the time.
const SIZE_PX: [u32; 2] = [640, 480];
/// Timed frames (odd; the median counts) and steps of the world.
const FRAMES: u32 = 9;
const STEPS: u32 = 600;

/// The render options of the thesis, and its plants with today's methods of drawing them.
fn methods() -> [(&'static str, RenderOptions); 2] {
    let thesis = RenderOptions { far_plants: FarPlants::Clumps, blend_order: BlendOrder::Precomputed, ..RenderOptions::default() };
    [("as in the thesis: clumps beyond, in precomputed orders", thesis), ("as the page draws it", RenderOptions::default())]
}

/// Measures frames and steps; returns the page as Markdown.
///
/// # Errors
/// When there is no GPU, or the scene cannot be drawn.
pub fn report(quick: bool) -> Result<String> {
    let gpu = Gpu::headless()?;
    let (frames, shrink, steps) = if quick { (1, 4, 10) } else { (FRAMES, 1, STEPS) };
    let size_px = SIZE_PX.map(|side| side / shrink);
    let mut rows = Vec::new();
    for (name, options) in methods() {
        let mut still = Still::of(&VIEW, size_px)?;
        let mut canvas = still.canvas(&gpu, Quality::Medium);
        canvas.set_options(options);
        let stats = still.draw(&mut canvas).1;
        let secs = still.frame_secs(&mut canvas, frames);
        rows.push(vec![name.to_owned(), stats.blades.to_string(), stats.clumps.to_string(), format!("{:.1}", 1e3 * secs)]);
    }
    let [height, width] = [size_px[1], size_px[0]];
    let step_ms = step_ms(steps)?;
    Ok(format!(
        "# Zhang's prairie, measured\n\n```sh\ncargo run --release -p tests --bin chart -- zhang\n```\n\nThe thesis gives its platform, and of its speed that it is \"real time\".\n\n{}\n\
         Scene `{SCENE}`: {}. Frames of {width} × {height} px at medium quality, median of {frames}.\n\n{}\n\
         A step of the world (wind, grass and a monster) takes {step_ms:.2} ms, mean of {steps} on one thread.\n",
        markdown(&["", "Zhang, Table 3", "here"], &platform(&gpu.adapter_name)),
        setting()?,
        markdown(&["drawn", "plants near the camera", "clumps", "frame (ms)"], &rows),
    ))
}

fn platform(adapter: &str) -> Vec<Vec<String>> {
    let memory = memory_gib().map_or_else(|| "unknown".to_owned(), |gib| format!("{gib:.0} GiB"));
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let rows = [
        ("processor", "Centrino II, 2.13 GHz", format!("{}, {cores} cores", processor())),
        ("memory", "2 GB", memory),
        ("graphics", "Quadro FX Go 1400, 256 MB", adapter.to_owned()),
        ("system", "Windows XP", format!("{} {}", std::env::consts::OS, std::env::consts::ARCH)),
        ("compiler", "Visual C++ 2003", rustc_version().unwrap_or_else(|| "unknown".into())),
        ("graphics interface", "OpenGL 1.1", "WebGPU (wgpu)".to_owned()),
    ];
    rows.map(|(name, theirs, ours)| vec![name.to_owned(), theirs.to_owned(), ours]).to_vec()
}

/// Size of the scene, in the words of the thesis.
fn setting() -> Result<String> {
    let scene = scenes::load(SCENE)?.scene;
    let (plants, [x_m, z_m]) = (&scene.plants, scene.extent_m());
    let [grids_x, grids_z] = [x_m, z_m].map(|extent_m| (extent_m / plants.grid_m).round());
    let [cells_x, cells_y, cells_z] = scene.wind.cells;
    Ok(format!(
        "{grids_x} × {grids_z} grids of {per_side} × {per_side} plants, {backbone} backbone points a blade, a box of wind with {cells_x} × {cells_y} × {cells_z} cells (the thesis: \
         16 × 16 grids, 20 × 20 plants, 4 points, 10 × 10 × 10 cells)",
        per_side = plants.plants_per_side,
        backbone = plants.blade_segments[0] + 1,
    ))
}

/// Mean time of a step of the world (ms).
fn step_ms(steps: u32) -> Result<f64> {
    let loaded = scenes::load(SCENE)?;
    let mut world = World::new(&loaded.scene, loaded.maps())?;
    let begun = Instant::now();
    for _ in 0..steps {
        world.step(&[]);
    }
    Ok(1e3 * begun.elapsed().as_secs_f64() / f64::from(steps))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scene_has_the_setting_of_the_thesis() {
        let setting = setting().unwrap();
        assert!(setting.starts_with("16 × 16 grids of 20 × 20 plants, 4 backbone points"), "{setting}");
    }

    #[test]
    fn the_page_has_both_platforms_and_a_row_for_each_way_of_drawing() {
        let page = report(true).unwrap();
        assert!(page.contains("Quadro FX Go 1400") && page.contains("WebGPU"), "{page}");
        let clumps: Vec<u32> = page
            .lines()
            .filter(|line| line.starts_with("| as "))
            .map(|line| line.split('|').nth(3).unwrap().trim().parse().unwrap())
            .collect();
        assert!(clumps.len() == 2 && clumps[0] > 0 && clumps[1] == 0, "{page}");
    }
}
