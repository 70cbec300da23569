//! What underbrush costs to draw: time of a frame against the number of plants in view, on this machine's Vulkan driver.

use std::fmt::Write as _;
use std::time::Instant;

use anyhow::{Context as _, Result};
use client_wasm::camera::Camera;
use client_wasm::render::{Gpu, Picture, Quality};
use client_wasm::state::Mirror;
use glam::Vec3;
use shared::scene::{Patches, Scene, TerrainMaps, parse_underbrush};
use shared::terrain::grey_png;
use shared::wire::ServerMessage;

use super::super::figure::{Axis, Curve, Drawn, Words, curves_svg};

/// The species that ship, of which tall grass is drawn.
const SPECIES: &str = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../server/scenes/species.toml"));
const SPECIES_NAME: &str = "tall grass";
/// ID that paints it.
const COVER: u8 = 20;
/// A flat world, the same whatever grows there (m).
const EXTENT_M: f32 = 128.0;
const SIZE_PX: [u32; 2] = [960, 540];
const DT_SECS: f32 = 1.0 / 30.0;

/// The world with so many plants, or none, and how many of them the camera sees.
fn meadow(plants: u32, camera: &Camera) -> Result<(Mirror, u32)> {
    let terrain = TerrainMaps { height_map: String::new(), covering_map: String::new(), pixel_m: [8.0; 2], level_m: 0.0, base_m: 0.0 };
    let mut scene = Scene { patches: Patches { count: [8, 8], ..Patches::default() }, ..Scene::new(terrain) };
    scene.plants.height_m = 0.05;
    if plants > 0 {
        let faults = |faults: Vec<_>| anyhow::anyhow!("the species that ship: {faults:?}");
        let mut species = parse_underbrush(SPECIES).map_err(faults)?.into_iter().find(|species| species.name == SPECIES_NAME);
        let own = species.as_mut().with_context(|| format!("no {SPECIES_NAME} among the species that ship"))?;
        (own.cover, own.room_m) = (COVER, 0.05);
        scene.underbrush.extend(species);
        scene.growth.spacing_m = EXTENT_M / (plants as f32).sqrt();
    }
    let mut mirror = Mirror::default();
    mirror.apply(ServerMessage::Scene {
        scene: Box::new(scene),
        height_png: grey_png([17; 2], &[0; 17 * 17]),
        covering_png: grey_png([16; 2], &[if plants > 0 { COVER } else { 255 }; 16 * 16]),
        nutrient_png: Vec::new(),
        models: Vec::new(),
    })?;
    let projection = camera.projection_from_world(SIZE_PX[0] as f32 / SIZE_PX[1] as f32);
    let is_seen = |[x, z]: [f32; 2]| {
        let clip = projection * Vec3::new(x, 0.0, z).extend(1.0);
        clip.w > 0.0 && clip.x.abs() < clip.w && clip.y.abs() < clip.w
    };
    let flora = mirror.land().and_then(|land| land.flora());
    let seen = flora.map_or(0, |flora| flora.grown().plants().iter().filter(|plant| is_seen(flora.standing(plant).at_m)).count());
    Ok((mirror, seen as u32))
}

/// Least time of a frame (s): all that disturbs one makes it longer.
fn frame_secs(gpu: &Gpu, mirror: &mut Mirror, camera: &Camera, frames: u32) -> f64 {
    let mut picture = Picture::new(gpu, SIZE_PX, Quality::Ultra);
    let times = (0..frames).map(|frame| {
        let begun = Instant::now();
        picture.draw(mirror, camera, f64::from(frame) * f64::from(DT_SECS), DT_SECS);
        picture.rgba();
        begun.elapsed().as_secs_f64()
    });
    times.skip(1).fold(f64::INFINITY, f64::min)
}

pub(super) fn draw(quick: bool, caption: &str) -> Result<Drawn> {
    let (counts, frames): (&[u32], _) =
        if quick { (&[100, 300, 1000, 3000, 10_000], 2) } else { (&[250, 800, 2500, 8000, 25_000, 80_000, 262_144], 4) };
    let gpu = Gpu::headless()?;
    let camera = Camera { eye_m: Vec3::new(64.0, 45.0, 158.0), pitch_rad: -0.5, ..Camera::default() };
    let bare_secs = frame_secs(&gpu, &mut meadow(0, &camera)?.0, &camera, frames);
    let mut csv = String::from("plants,plants_in_view,ms_a_frame,ms_without\n");
    let mut points = Vec::new();
    for &plants in counts {
        let (mut mirror, seen) = meadow(plants, &camera)?;
        let secs = frame_secs(&gpu, &mut mirror, &camera, frames);
        writeln!(csv, "{plants},{seen},{:.2},{:.2}", 1e3 * secs, 1e3 * bare_secs)?;
        points.push([f64::from(seen), 1e3 * secs]);
    }
    let last = points[points.len() - 1];
    let said = format!(
        "{} plants in view: {:.0} ms a frame, {:.0} ms without, {:.2} µs a plant ({})",
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
        name: "the same without underbrush".into(),
        points: vec![[least, 1e3 * bare_secs], [most, 1e3 * bare_secs]],
        marked: false,
        joined: true,
    };
    let measured = Curve { name: format!("with {SPECIES_NAME}"), points, marked: true, joined: true };
    let axes = [
        Axis { name: "plants in view", range: [least, most], logarithmic: true },
        Axis { name: "time of a frame (ms)", range: [1e3 * bare_secs / 1.5, top], logarithmic: true },
    ];
    let subtitle = format!("{} × {} px, ultra, least of {} frames; {}", SIZE_PX[0], SIZE_PX[1], frames - 1, gpu.adapter_name);
    let svg = curves_svg(&[measured, bare], axes, Words { title: "What underbrush costs to draw", subtitle: &subtitle, caption })?;
    Ok(Drawn { svg, csv, said })
}
