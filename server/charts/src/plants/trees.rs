//! Cost of drawing trees of components: frame time against the number of trees in view, beside meshes that sway as a whole.

use std::fmt::Write as _;
use std::time::Instant;

use anyhow::{Result, ensure};
use glam::Vec3;
use prairie_client::camera::Camera;
use prairie_client::render::{Gpu, OffscreenRenderer, Quality};
use prairie_client::state::Mirror;
use prairie_core::scene::{Patches, Scene, TerrainMaps, TreeShape};
use prairie_core::terrain::grey_png;
use prairie_core::wire::ServerMessage;

use super::super::figure::{Axis, Curve, Drawn, Words, curves_svg};
use super::super::table::markdown;

/// Pixels of 2 m along a side of the covering map.
const COVER_PX: u32 = 128;
/// Covering IDs of bare ground and of trees.
const BARE: u8 = 0;
const TREE: u8 = 253;
/// Size of the picture (px), and of a quick one.
const SIZE_PX: [u32; 2] = [1280, 720];
const QUICK_SIZE_PX: [u32; 2] = [320, 180];
const DT_SECS: f32 = 1.0 / 30.0;
const SHAPES: [(&str, TreeShape); 2] = [("meshes that sway as a whole", TreeShape::Modelled), ("trees of components", TreeShape::Grown)];
/// Largest frame time with the most trees of components, relative to meshes: set before measuring.
const GOAL: f64 = 2.0;
const TITLE: &str = "Cost of drawing trees";

/// Bare flat land with a square wood of `side` × `side` trees.
fn wood(side: u32, tree_shape: TreeShape) -> Result<Mirror> {
    let terrain = TerrainMaps { height_map: String::new(), covering_map: String::new(), pixel_m: [16.0; 2], level_m: 0.0, base_m: 0.0 };
    let mut scene = Scene { patches: Patches { count: [16, 16], ..Patches::default() }, ..Scene::new(terrain) };
    scene.plants.tree_shape = tree_shape;
    let mut covering = vec![BARE; (COVER_PX * COVER_PX) as usize];
    for number in 0..side * side {
        let [x, z] = [number % side, number / side].map(|place| place * COVER_PX / side + COVER_PX / side / 2);
        covering[(z * COVER_PX + x) as usize] = TREE;
    }
    let mut mirror = Mirror::default();
    mirror.apply(ServerMessage::Scene {
        scene: Box::new(scene),
        height_png: grey_png([17; 2], &[0; 17 * 17]),
        covering_png: grey_png([COVER_PX; 2], &covering),
        nutrient_png: Vec::new(),
        models: Vec::new(),
        shapes: Default::default(),
    })?;
    Ok(mirror)
}

/// Shortest frame time (s) and triangles of both shapes, whose frames take turns, so that a disturbance does not affect one alone.
fn frames(gpu: &Gpu, size_px: [u32; 2], side: u32, count: u32) -> Result<[(f64, u64); 2]> {
    let camera = Camera { eye_m: Vec3::new(128.0, 40.0, 330.0), pitch_rad: -0.25, ..Camera::default() };
    let mut drawn = Vec::new();
    for (_, shape) in SHAPES {
        drawn.push((wood(side, shape)?, OffscreenRenderer::new(gpu, size_px, Quality::High)));
    }
    let mut least = [(f64::INFINITY, 0); 2];
    // The first round creates pipelines.
    for frame in 0..=count {
        for ((mirror, picture), least) in drawn.iter_mut().zip(&mut least) {
            let begun = Instant::now();
            let stats = picture.draw(mirror, &camera, f64::from(frame) * f64::from(DT_SECS), DT_SECS);
            picture.rgba();
            let secs = begun.elapsed().as_secs_f64();
            *least = (if frame == 0 { f64::INFINITY } else { least.0.min(secs) }, stats.object_triangles);
        }
    }
    Ok(least)
}

pub(super) fn draw(quick: bool, caption: &str) -> Result<Drawn> {
    let (sides, count): (&[u32], _) = if quick { (&[2, 8], 1) } else { (&[4, 8, 16, 32], 6) };
    let size_px = if quick { QUICK_SIZE_PX } else { SIZE_PX };
    let gpu = Gpu::headless()?;
    let mut csv = String::from("shape,trees,triangles,ms_a_frame\n");
    let mut curves = SHAPES.map(|(name, _)| Curve { name: name.into(), points: Vec::new(), marked: true, joined: true });
    let (mut rows, mut ratio) = (Vec::new(), 0.0);
    for &side in sides {
        let found = frames(&gpu, size_px, side, count)?;
        for (((name, _), (secs, triangles)), curve) in SHAPES.iter().zip(found).zip(&mut curves) {
            ensure!(triangles >= u64::from(4 * side * side), "only {triangles} triangles of {side} × {side} trees");
            writeln!(csv, "{name},{},{triangles},{:.2}", side * side, 1e3 * secs)?;
            curve.points.push([f64::from(side * side), 1e3 * secs]);
            rows.push(vec![(*name).to_owned(), (side * side).to_string(), triangles.to_string(), format!("{:.1}", 1e3 * secs)]);
        }
        ratio = found[1].0 / found[0].0;
    }
    let [least, most] = [curves[0].points[0][0] / 1.3, curves[0].points[sides.len() - 1][0] * 1.3];
    let times = || curves.iter().flat_map(|curve| &curve.points).map(|point| point[1]);
    let range = [times().fold(f64::INFINITY, f64::min) / 1.5, times().fold(0.0, f64::max) * 1.5];
    let axes = [
        Axis { name: "trees in view", range: [least, most], logarithmic: true },
        Axis { name: "frame time (ms)", range, logarithmic: true },
    ];
    let subtitle = format!("{} × {} px, high, least of {count} frames; {}", size_px[0], size_px[1], gpu.adapter_name);
    let goal = if ratio <= GOAL { "reached" } else { "missed" };
    let summary = format!("the most trees take {ratio:.2} of the time of meshes; the goal of {GOAL} is {goal} ({})", gpu.adapter_name);
    let svg = curves_svg(&curves, axes, Words { title: TITLE, subtitle: &subtitle, caption })?;
    let table = markdown(&["shape", "trees", "triangles", "ms a frame"], &rows);
    let tables = format!(
        "# {TITLE}\n\n{subtitle}; {caption}\n\n```sh\ncargo run --release --features charts -- chart blades underbrush force-field --only trees --out tests/results\n```\n\n{table}\n{summary}\n"
    );
    Ok(Drawn { svg, csv, summary: format!("{table}\n{summary}"), tables: Some(tables), map: None })
}
