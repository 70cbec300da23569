//! Point lights on shells: frames per second with none, one and three, beside Bakay 2003, §4.1.

use std::fmt::Write as _;

use anyhow::Result;
use prairie_client::render::{Gpu, OffscreenRenderer, Quality};
use prairie_client::state::Mirror;
use prairie_core::scene::Lamp;

use super::{frame_secs, knolls};
use prairie_charts::figure::{Axis, Curve, Drawn, Words, curves_svg};
use prairie_charts::table::markdown;

/// Lamps that are measured; Bakay has three.
const COUNTS: [usize; 3] = [0, 1, 3];
/// X, height above the ground and Z of the lamps (m), all in view.
const PLACES_M: [[f32; 3]; 3] = [[65.0, 2.0, 54.0], [60.0, 2.5, 46.0], [70.0, 3.0, 40.0]];
/// Luminous intensity (cd) and attenuation with which each lamp reaches the whole view, so that every fragment pays for it.
const CANDELA: f32 = 1500.0;
const ATTENUATION: [f32; 3] = [100.0, 0.0, 1.0];
const SIZES_PX: [[u32; 2]; 2] = [[640, 480], [1024, 768]];
const TITLE: &str = "Cost of point lights on shells";
const STATEMENT: &str = "Bakay 2003, section 4.1, of a GeForce 3 that lights vertices: \"No perceptible change was noticed when the lighting code for 3 point lights was added to the vertex shader.\"";

/// The knolls at dusk with a number of lamps.
fn lit_knolls(count: usize) -> Result<Mirror> {
    knolls(|scene| {
        scene.light.sun_elevation_rad = -0.08;
        scene.lights =
            PLACES_M[..count].iter().map(|&at_m| Lamp { candela: CANDELA, attenuation: ATTENUATION, ..Lamp::new(at_m) }).collect();
    })
}

/// Time (s) of the fastest of `frames` frames by number of lamps. All counts take turns, so that a disturbance does not affect one alone.
fn fastest_secs(gpu: &Gpu, size_px: [u32; 2], frames: u32) -> Result<[f64; COUNTS.len()]> {
    let mut lit = Vec::new();
    for count in COUNTS {
        lit.push((lit_knolls(count)?, OffscreenRenderer::new(gpu, size_px, Quality::Low)));
    }
    let mut fastest = [f64::INFINITY; COUNTS.len()];
    // The first round fills buffers.
    for frame in 0..=frames {
        for ((mirror, picture), fastest) in lit.iter_mut().zip(&mut fastest) {
            let secs = frame_secs(picture, mirror, frame);
            *fastest = if frame == 0 { f64::INFINITY } else { fastest.min(secs) };
        }
    }
    Ok(fastest)
}

pub(super) fn draw(quick: bool, caption: &str) -> Result<Drawn> {
    let (frames, shrink) = if quick { (1, 4) } else { (8, 1) };
    let gpu = Gpu::headless()?;
    let mut csv = String::from("width_px,height_px,lamps,frames_per_s,time_over_none\n");
    let (mut curves, mut rows) = (Vec::new(), Vec::new());
    for size_px in SIZES_PX {
        let [width, height] = size_px.map(|side| side / shrink);
        let secs = fastest_secs(&gpu, [width, height], frames)?;
        let points = COUNTS.iter().zip(secs).map(|(count, secs)| [*count as f64, secs.recip()]).collect();
        curves.push(Curve { name: format!("{width} × {height}"), points, marked: true, joined: true });
        for (count, found) in COUNTS.into_iter().zip(secs) {
            let [rate, ratio] = [found.recip(), found / secs[0]];
            writeln!(csv, "{width},{height},{count},{rate:.2},{ratio:.3}")?;
            rows.push(vec![format!("{width} × {height}"), count.to_string(), format!("{rate:.2}"), format!("{ratio:.2}")]);
        }
    }
    let table = markdown(&["picture (px)", "lamps", "frames/s", "time over none"], &rows);
    let subtitle = format!("scene shells at dusk, 17 layers, low quality, fastest of {frames} frames; {}", gpu.adapter_name);
    let most = curves.iter().flat_map(|curve| &curve.points).map(|point| point[1]).fold(0.0, f64::max);
    let axes = [
        Axis { name: "point lights, each of which reaches the whole view", range: [-0.2, 3.2], logarithmic: false },
        Axis { name: "frames per second", range: [0.0, most * 1.2], logarithmic: false },
    ];
    let svg = curves_svg(&curves, axes, Words { title: TITLE, subtitle: &subtitle, caption })?;
    let tables = format!(
        "# {TITLE}\n\n{subtitle}; {caption}\n\n```sh\ncargo run --release --features charts -- chart shells --only lamps --out tests/results\n```\n\n\
         {STATEMENT} Here each fragment is lit, by a processor that draws in software; each lamp reaches the whole view.\n\n{table}"
    );
    Ok(Drawn { svg, csv, summary: format!("{table}\n{STATEMENT}"), tables: Some(tables), map: None })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_size_has_a_row_for_each_number_of_lamps() {
        let drawn = draw(true, "caption").unwrap();
        assert!(drawn.svg.contains("caption") && drawn.csv.lines().count() == 1 + SIZES_PX.len() * COUNTS.len());
        let counts: Vec<&str> = drawn.csv.lines().skip(1).map(|line| line.split(',').nth(2).unwrap()).collect();
        assert_eq!(counts, ["0", "1", "3", "0", "1", "3"]);
        let tables = drawn.tables.unwrap();
        assert!(tables.contains("Bakay 2003, section 4.1") && tables.contains("caption") && tables.lines().count() > 10, "{tables}");
    }

    #[test]
    fn each_lamp_lights_the_whole_view() {
        let gpu = Gpu::headless().unwrap();
        let shown = COUNTS.map(|count| {
            let mut picture = OffscreenRenderer::new(&gpu, [64, 48], Quality::Low);
            frame_secs(&mut picture, &mut lit_knolls(count).unwrap(), 0);
            picture.rgba()
        });
        // The lower three quarters are land.
        let land = |rgba: &[u8]| rgba[64 * 12 * 4..].iter().map(|level| u32::from(*level)).collect::<Vec<_>>();
        let sums = |rgba: &[u8]| land(rgba).chunks_exact(4).map(|px| px[0] + px[1] + px[2]).collect::<Vec<_>>();
        for pair in shown.windows(2) {
            let [less, more] = [sums(&pair[0]), sums(&pair[1])];
            let brighter = less.iter().zip(&more).filter(|(less, more)| more > less).count() as f64 / less.len() as f64;
            assert!(brighter > 0.95, "brighter in {brighter} of the land");
        }
    }
}
