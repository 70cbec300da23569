//! Shells: frames a second against the number of layers, beside table 4.1 of 003.

use std::fmt::Write as _;
use std::time::Instant;

use anyhow::Result;
use client_wasm::camera::Camera;
use client_wasm::render::{Gpu, Look, Picture, Quality};
use client_wasm::state::Mirror;
use glam::Vec3;
use server::scenes;
use shared::wire::ServerMessage;

use super::figure::{Axis, Curve, Drawn, Figure, Words, curves_svg};

/// The figures.
pub const FIGURES: [Figure; 1] = [Figure { name: "layers", title: "What layers of shells cost", draw }];

/// Layers of table 4.1, the ground among them, and 003's frames a second at 640 × 480 and 1024 × 768 (GeForce 3).
const TABLE: [(u32, [f64; 2]); 5] = [(1, [293.5, 130.8]), (9, [47.0, 22.8]), (17, [25.6, 12.4]), (33, [13.4, 6.5]), (65, [6.9, 3.3])];
const SIZES_PX: [[u32; 2]; 2] = [[640, 480], [1024, 768]];
/// The shells as 003 has them, and with slices between the layers as the scene asks for.
const SLICES: [Option<u32>; 2] = [Some(1), None];
const DT_SECS: f32 = 1.0 / 30.0;

/// The scene `shells` with so many slices, or its own number of them.
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
    })?;
    Ok(mirror)
}

/// Frames a second: of the fastest frame, as all that disturbs one makes it longer.
fn frames_per_s(gpu: &Gpu, size_px: [u32; 2], mirror: &mut Mirror, layers: u32, frames: u32) -> f64 {
    let camera = Camera { eye_m: Vec3::new(66.0, 3.5, 60.0), heading_rad: -0.35, pitch_rad: -0.3, ..Camera::default() };
    let mut picture = Picture::new(gpu, size_px, Quality::Low);
    picture.set_look(Look { shell_layers: Some(layers), ..Look::default() });
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
    let mut csv = String::from("width_px,height_px,slices,layers,frames_per_s,frames_per_s_of_003\n");
    let mut curves = Vec::new();
    let mut said = String::new();
    for (n, size_px) in SIZES_PX.into_iter().enumerate() {
        let of_003 = TABLE.iter().map(|(layers, theirs)| [f64::from(*layers), theirs[n]]).collect();
        let [width, height] = size_px;
        curves.push(Curve { name: format!("003, {width} × {height}"), points: of_003, marked: true, joined: true });
        let size_px = size_px.map(|side| side / shrink);
        let [width, height] = size_px;
        for slices in SLICES {
            let mut mirror = knolls(slices)?;
            let shown = mirror.land().map_or(0, |land| land.scene().shells.slices);
            let mut points = Vec::new();
            for (layers, theirs) in TABLE {
                let found = frames_per_s(&gpu, size_px, &mut mirror, layers, frames);
                writeln!(csv, "{width},{height},{shown},{layers},{found:.2},{}", theirs[n])?;
                writeln!(said, "{width} × {height}, {layers} layers, slices up to {shown}: {found:.1} frames/s, 003 {}", theirs[n])?;
                points.push([f64::from(layers), found]);
            }
            curves.push(Curve { name: format!("{shown} slices, {width} × {height}"), points, marked: true, joined: true });
        }
    }
    let values = curves.iter().flat_map(|curve| &curve.points).map(|point| point[1]);
    let range = [values.clone().fold(f64::INFINITY, f64::min) / 1.3, values.fold(0.0, f64::max) * 1.3];
    let axes = [
        Axis { name: "layers, the ground among them", range: [0.8, 80.0], logarithmic: true },
        Axis { name: "frames a second", range, logarithmic: true },
    ];
    let subtitle = format!("scene shells, low quality, fastest of {} frames; {}; 003: GeForce 3, table 4.1", frames - 1, gpu.adapter_name);
    let svg = curves_svg(&curves, axes, Words { title: "What layers of shells cost", subtitle: &subtitle, caption })?;
    Ok(Drawn { svg, csv, said, tables: None })
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
