//! Cost of drawing underbrush: frame time against the number of drawn plants, on this machine's Vulkan driver.

use std::fmt::Write as _;
use std::time::Instant;

use anyhow::{Result, ensure};
use glam::Vec3;
use prairie_client::camera::Camera;
use prairie_client::render::{Gpu, OffscreenRenderer, Quality};
use prairie_client::state::Mirror;
use prairie_core::scene::{Patches, Scene, TerrainMaps, parse_underbrush};
use prairie_core::terrain::grey_png;
use prairie_core::wire::ServerMessage;

use super::super::figure::{Axis, Curve, Drawn, Words, curves_svg};

/// The built-in species, all drawn in a mixture.
const SPECIES: &str = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/species.toml"));
/// Covering ID of the first species; the others follow.
const COVER: u8 = 20;
/// Pixels along a side of the covering map; each pixel has another species.
const COVER_PX: u32 = 64;
/// Side of the flat world (m).
const EXTENT_M: f32 = 128.0;
/// Size of the picture (px), and of a quick one.
const SIZE_PX: [u32; 2] = [1280, 720];
const QUICK_SIZE_PX: [u32; 2] = [480, 270];
const DT_SECS: f32 = 1.0 / 30.0;
/// Aim of the number of plants in the fullest picture.
const AIM_DRAWN: u32 = 200_000;

/// The world with this number of plant sites, possibly 0.
fn meadow(places: u32) -> Result<Mirror> {
    let terrain = TerrainMaps { height_map: String::new(), covering_map: String::new(), pixel_m: [8.0; 2], level_m: 0.0, base_m: 0.0 };
    let mut scene = Scene { patches: Patches { count: [8, 8], ..Patches::default() }, ..Scene::new(terrain) };
    scene.plants.height_m = 0.05;
    let mut covering = vec![255; (COVER_PX * COVER_PX) as usize];
    if places > 0 {
        scene.underbrush = parse_underbrush(SPECIES).map_err(|faults| anyhow::anyhow!("the built-in species: {faults:?}"))?;
        scene.growth.spacing_m = EXTENT_M / (places as f32).sqrt();
        for (species, cover) in scene.underbrush.iter_mut().zip(COVER..) {
            (species.cover, species.room_m) = (cover, 0.05);
        }
        let kinds = scene.underbrush.len() as u32;
        for (pixel, cover) in (0..).zip(&mut covering) {
            // Shifted by three columns per row, so that neighbours differ in both directions.
            *cover = COVER + ((pixel % COVER_PX + 3 * (pixel / COVER_PX)) % kinds) as u8;
        }
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

/// Shortest frame time (s), since disturbances only lengthen it, and the number of drawn plants.
fn frame(gpu: &Gpu, size_px: [u32; 2], mirror: &mut Mirror, camera: &Camera, frames: u32) -> (f64, u32) {
    let mut picture = OffscreenRenderer::new(gpu, size_px, Quality::Ultra);
    let times = (0..frames).map(|frame| {
        let begun = Instant::now();
        picture.draw(mirror, camera, f64::from(frame) * f64::from(DT_SECS), DT_SECS);
        picture.rgba();
        begun.elapsed().as_secs_f64()
    });
    let least_secs = times.skip(1).fold(f64::INFINITY, f64::min);
    (least_secs, picture.drawn_underbrush())
}

pub(super) fn draw(quick: bool, caption: &str) -> Result<Drawn> {
    let (counts, frames): (&[u32], _) =
        if quick { (&[100, 300, 1000, 3000, 10_000], 2) } else { (&[250, 800, 2500, 8000, 25_000, 80_000, 250_000, 500_000], 4) };
    let size_px = if quick { QUICK_SIZE_PX } else { SIZE_PX };
    let gpu = Gpu::headless()?;
    let camera = Camera { eye_m: Vec3::new(64.0, 30.0, 150.0), pitch_rad: -0.4, ..Camera::default() };
    let (bare_secs, _) = frame(&gpu, size_px, &mut meadow(0)?, &camera, frames);
    let mut csv = String::from("plants_in_scene,plants_drawn,ms_a_frame,ms_without\n");
    let mut points = Vec::new();
    for &places in counts {
        let mut mirror = meadow(places)?;
        let (secs, drawn) = frame(&gpu, size_px, &mut mirror, &camera, frames);
        let grown = mirror.decoded_scene().and_then(|land| land.flora()).map_or(0, |flora| flora.grown().plants().len());
        ensure!(drawn > 0 && drawn as usize <= grown, "{drawn} of {grown} plants are drawn");
        writeln!(csv, "{grown},{drawn},{:.2},{:.2}", 1e3 * secs, 1e3 * bare_secs)?;
        points.push([f64::from(drawn), 1e3 * secs]);
    }
    let most_drawn = points.iter().map(|point| point[0]).fold(0.0, f64::max);
    let most_grown = csv.lines().filter_map(|line| line.split(',').next()?.parse().ok()).fold(0, u32::max);
    let outcome = if most_drawn >= f64::from(AIM_DRAWN) { "met" } else { "missed: the memory that ultra has for their rows holds no more" };
    let last = points[points.len() - 1];
    let aim = if quick { String::new() } else { format!("; aim {AIM_DRAWN}, {outcome}") };
    let summary = format!(
        "{} of {most_grown} plants drawn{aim}. {:.0} ms a frame, {:.0} ms without, {:.2} µs a plant ({})",
        last[0],
        last[1],
        1e3 * bare_secs,
        1e3 * (last[1] - 1e3 * bare_secs) / last[0],
        gpu.adapter_name
    );
    let range = |of: fn(f64) -> f64, axis: usize| {
        let values = points.iter().map(|point| of(point[axis]));
        [values.clone().fold(f64::INFINITY, f64::min), values.fold(0.0, f64::max)]
    };
    let [least, most] = [range(|v| v / 1.3, 0)[0], range(|v| v * 1.3, 0)[1]];
    let top = range(|v| v * 1.5, 1)[1];
    let bare = Curve {
        name: "without underbrush".into(),
        points: vec![[least, 1e3 * bare_secs], [most, 1e3 * bare_secs]],
        marked: false,
        joined: true,
    };
    let measured = Curve { name: "with all built-in species".into(), points, marked: true, joined: true };
    let axes = [
        Axis { name: "plants drawn", range: [least, most], logarithmic: true },
        Axis { name: "frame time (ms)", range: [1e3 * bare_secs / 1.5, top], logarithmic: true },
    ];
    let subtitle = format!("{} × {} px, ultra, least of {} frames; {}", size_px[0], size_px[1], frames - 1, gpu.adapter_name);
    let svg = curves_svg(&[measured, bare], axes, Words { title: "Cost of drawing underbrush", subtitle: &subtitle, caption })?;
    Ok(Drawn::new(svg, csv, summary))
}
