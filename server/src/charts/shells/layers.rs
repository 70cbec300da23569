//! Shells: frames per second against the number of layers, beside Bakay 2003, table 4.1.

use std::fmt::Write as _;

use anyhow::Result;
use prairie_client::render::{Gpu, OffscreenRenderer, Quality, RenderOptions};

use super::{frame_secs, knolls};
use prairie_charts::figure::{Axis, Curve, Drawn, Words, curves_svg};

/// Number of layers including the ground, and frames per second at 640 × 480 and 1024 × 768 (Bakay 2003, table 4.1, GeForce 3).
const TABLE: [(u32, [f64; 2]); 5] = [(1, [293.5, 130.8]), (9, [47.0, 22.8]), (17, [25.6, 12.4]), (33, [13.4, 6.5]), (65, [6.9, 3.3])];
const SIZES_PX: [[u32; 2]; 2] = [[640, 480], [1024, 768]];
/// Shells without slices as in Bakay 2003, and with the slices of the scene between the layers.
const SLICES: [Option<u32>; 2] = [Some(1), None];

pub(super) fn draw(quick: bool, caption: &str) -> Result<Drawn> {
    let (frames, shrink) = if quick { (2, 4) } else { (4, 1) };
    let gpu = Gpu::headless()?;
    let mut csv = String::from("width_px,height_px,slices,layers,frames_per_s,frames_per_s_of_bakay\n");
    let mut curves = Vec::new();
    let mut summary = String::new();
    for (n, size_px) in SIZES_PX.into_iter().enumerate() {
        let of_bakay = TABLE.iter().map(|(layers, theirs)| [f64::from(*layers), theirs[n]]).collect();
        let [width, height] = size_px;
        curves.push(Curve { name: format!("Bakay, {width} × {height}"), points: of_bakay, marked: true, joined: true });
        let size_px = size_px.map(|side| side / shrink);
        let [width, height] = size_px;
        for slices in SLICES {
            let mut mirror = knolls(|scene| scene.shells.slices = slices.unwrap_or(scene.shells.slices))?;
            let shown = mirror.decoded_scene().map_or(0, |land| land.scene().shells.slices);
            let mut picture = OffscreenRenderer::new(&gpu, size_px, Quality::Low);
            let mut points = Vec::new();
            for (layers, theirs) in TABLE {
                picture.set_options(RenderOptions { shell_layers: Some(layers), ..RenderOptions::default() });
                let times = (0..frames).map(|frame| frame_secs(&mut picture, &mut mirror, frame));
                // The first frame fills buffers; disturbances only lengthen the others.
                let found = times.skip(1).fold(f64::INFINITY, f64::min).recip();
                writeln!(csv, "{width},{height},{shown},{layers},{found:.2},{}", theirs[n])?;
                writeln!(
                    summary,
                    "{width} × {height}, {layers} layers, slices up to {shown}: {found:.1} frames/s, Bakay 2003 {}",
                    theirs[n]
                )?;
                points.push([f64::from(layers), found]);
            }
            curves.push(Curve { name: format!("{shown} slices, {width} × {height}"), points, marked: true, joined: true });
        }
    }
    let values = curves.iter().flat_map(|curve| &curve.points).map(|point| point[1]);
    let range = [values.clone().fold(f64::INFINITY, f64::min) / 1.3, values.fold(0.0, f64::max) * 1.3];
    let axes = [
        Axis { name: "layers, including the ground", range: [0.8, 80.0], logarithmic: true },
        Axis { name: "frames per second", range, logarithmic: true },
    ];
    let subtitle =
        format!("scene shells, low quality, fastest of {} frames; {}; Bakay 2003: GeForce 3, table 4.1", frames - 1, gpu.adapter_name);
    let svg = curves_svg(&curves, axes, Words { title: "Cost of shell layers", subtitle: &subtitle, caption })?;
    Ok(Drawn::new(svg, csv, summary))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_layers_take_longer() {
        let drawn = draw(true, "caption").unwrap();
        assert!(drawn.svg.contains("caption") && drawn.csv.lines().count() == 21);
        let found: Vec<f64> = drawn.csv.lines().skip(1).map(|line| line.split(',').nth(4).unwrap().parse().unwrap()).collect();
        assert!(found.chunks_exact(5).all(|counts| counts[0] > 1.5 * counts[4]), "{found:?}");
    }
}
