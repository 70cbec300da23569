//! Shells: frames per second against the number of layers, beside Bakay 2003, table 4.1.

use std::fmt::Write as _;
use std::time::Instant;

use anyhow::Result;
use glam::Vec3;
use prairie::scenes;
use prairie_client::camera::Camera;
use prairie_client::render::{Gpu, OffscreenRenderer, Quality, RenderOptions};
use prairie_client::state::Mirror;
use prairie_core::wire::ServerMessage;

use super::figure::{Axis, Curve, Drawn, Figure, Words, curves_svg};

/// The figures.
pub const FIGURES: [Figure; 1] = [Figure { name: "layers", title: "Cost of shell layers", draw }];

/// Number of layers including the ground, and frames per second at 640 × 480 and 1024 × 768 (Bakay 2003, table 4.1, GeForce 3).
const TABLE: [(u32, [f64; 2]); 5] = [(1, [293.5, 130.8]), (9, [47.0, 22.8]), (17, [25.6, 12.4]), (33, [13.4, 6.5]), (65, [6.9, 3.3])];
const SIZES_PX: [[u32; 2]; 2] = [[640, 480], [1024, 768]];
/// Shells without slices as in Bakay 2003, and with the slices of the scene between the layers.
const SLICES: [Option<u32>; 2] = [Some(1), None];
const DT_SECS: f32 = 1.0 / 30.0;

/// The scene `shells` with a number of slices, by default its own.
fn knolls(slices: Option<u32>) -> Result<Mirror> {
    let mut loaded = scenes::load("shells")?;
    if let Some(slices) = slices {
        loaded.scene.shells.slices = slices;
    }
    let mut mirror = Mirror::default();
    mirror.apply(ServerMessage::Scene {
        scene: Box::new(loaded.scene),
        height_png: loaded.height_png,
        covering_png: loaded.covering_png,
        nutrient_png: loaded.nutrient_png,
        models: loaded.models,
        shapes: Default::default(),
    })?;
    Ok(mirror)
}

/// Frames per second of the fastest frame, since disturbances only lengthen frames.
fn frames_per_s(picture: &mut OffscreenRenderer, mirror: &mut Mirror, layers: u32, frames: u32) -> f64 {
    let camera = Camera { eye_m: Vec3::new(66.0, 3.5, 60.0), heading_rad: -0.35, pitch_rad: -0.3, ..Camera::default() };
    picture.set_options(RenderOptions { shell_layers: Some(layers), ..RenderOptions::default() });
    let times = (0..frames).map(|frame| {
        let begun = Instant::now();
        picture.draw(mirror, &camera, f64::from(frame) * f64::from(DT_SECS), DT_SECS);
        begun.elapsed().as_secs_f64()
    });
    times.skip(1).fold(f64::INFINITY, f64::min).recip()
}

fn draw(quick: bool, caption: &str) -> Result<Drawn> {
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
            let mut mirror = knolls(slices)?;
            let shown = mirror.decoded_scene().map_or(0, |land| land.scene().shells.slices);
            let mut picture = OffscreenRenderer::new(&gpu, size_px, Quality::Low);
            let mut points = Vec::new();
            for (layers, theirs) in TABLE {
                let found = frames_per_s(&mut picture, &mut mirror, layers, frames);
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
    Ok(Drawn { svg, csv, summary, tables: None })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_layers_take_longer() {
        let drawn = (FIGURES[0].draw)(true, "caption").unwrap();
        assert!(drawn.svg.contains("caption") && drawn.csv.lines().count() == 21);
        let found: Vec<f64> = drawn.csv.lines().skip(1).map(|line| line.split(',').nth(4).unwrap().parse().unwrap()).collect();
        assert!(found.chunks_exact(5).all(|counts| counts[0] > 1.5 * counts[4]), "{found:?}");
    }
}
