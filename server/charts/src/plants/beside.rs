//! The plants of Endo et al. 2003, §6, beside ours: 200 tufts of grass, and 200 flowers with 1000 leaves, in a picture of 500 × 500 px.

use std::fmt::Write as _;
use std::hint::black_box;
use std::time::Instant;

use anyhow::{Context as _, Result, ensure};
use glam::Vec3;
use prairie_client::camera::Camera;
use prairie_client::render::{Gpu, OffscreenRenderer, Quality};
use prairie_client::state::Mirror;
use prairie_core::plant::underbrush::plan::Plan;
use prairie_core::plant::underbrush::plant::{Forces, LookUp, Stand, posed};
use prairie_core::scene::{Component, ComponentKind, Patches, Scene, TerrainMaps, Underbrush, parse_underbrush};
use prairie_core::terrain::grey_png;
use prairie_core::wire::ServerMessage;

use super::super::figure::{Axis, Curve, Drawn, Words, curves_svg};
use super::super::table::markdown;

/// The built-in species.
const SPECIES: &str = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/species.toml"));
/// Covering ID of the plants.
const COVER: u8 = 20;
/// Side of the flat world (m), and of the square in its middle on which the plants grow.
const EXTENT_M: f32 = 64.0;
const PLOT_M: f32 = 16.0;
const SIZE_PX: u32 = 500;
const QUICK_SIZE_PX: u32 = 320;
const DT_SECS: f32 = 1.0 / 30.0;
/// Frames per second that Endo et al. give for both of their scenes.
const THEIRS_PER_S: [f64; 2] = [10.0, 20.0];
const TITLE: &str = "The plants of Endo et al. beside ours";
const STATEMENT: &str = "Endo et al. 2003, section 6, with a Pentium III at 900 MHz and a graphics card of 64 MB: \"The framerate for rendering, for a resolution 500x500, is between 10 to 20 frames per second\", with \"200 tufts of grass\" and with \"about 200 flowers with 1000 leaves\".";

/// A scene of the comparison.
struct Case {
    name: &'static str,
    species: Underbrush,
    /// Plants to grow.
    plants: u32,
}

/// A flower on the ground with this number of leaves.
fn flower(leaves: u32) -> Underbrush {
    let mut leaf = Component::new("leaf", ComponentKind::Leaf);
    (leaf.count, leaf.length_m, leaf.angle_rad) = (leaves, 0.25, 0.6);
    let mut flower = Component::new("flower", ComponentKind::Flower);
    (flower.length_m, flower.width_m, flower.angle_rad, flower.tip_rgb) = (0.4, 0.07, 0.1, [0.6, 0.1, 0.05]);
    Underbrush::new("flower", vec![flower, leaf])
}

fn cases() -> Result<Vec<Case>> {
    let species = parse_underbrush(SPECIES).map_err(|faults| anyhow::anyhow!("the built-in species: {faults:?}"))?;
    let tuft = species.into_iter().next().context("the first species is a tuft")?;
    Ok(vec![
        Case { name: "200 tufts", species: tuft, plants: 200 },
        Case { name: "200 flowers, 1000 leaves in all", species: flower(5), plants: 200 },
        // A plant has at most 64 components: each flower with its thousand leaves is 32 plants.
        Case { name: "200 flowers, 1000 leaves each", species: flower(31), plants: 6400 },
    ])
}

/// The world with a case, on bare ground.
fn plot(case: &Case) -> Result<Mirror> {
    let terrain = TerrainMaps { height_map: String::new(), covering_map: String::new(), pixel_m: [4.0; 2], level_m: 0.0, base_m: 0.0 };
    let mut scene = Scene { patches: Patches { count: [4, 4], ..Patches::default() }, ..Scene::new(terrain) };
    scene.growth.spacing_m = PLOT_M / (case.plants as f32).sqrt();
    scene.growth.richness = [1.0; 3];
    scene.growth.shade = 0.0;
    scene.underbrush = vec![Underbrush {
        cover: COVER,
        room_m: 0.05,
        needs: [0.0; 3],
        light_need: 0.0,
        uptake: [0.0; 3],
        propagation_points: 4000,
        ..case.species.clone()
    }];
    // Pixels of 2 m.
    let inside = |pixel: u32| (12..20).contains(&pixel);
    let covering: Vec<u8> = (0..32 * 32).map(|at| if inside(at % 32) && inside(at / 32) { COVER } else { 0 }).collect();
    let mut mirror = Mirror::default();
    mirror.apply(ServerMessage::Scene {
        scene: Box::new(scene),
        height_png: grey_png([17; 2], &[0; 17 * 17]),
        covering_png: grey_png([32; 2], &covering),
        nutrient_png: Vec::new(),
        models: Vec::new(),
        shapes: Default::default(),
    })?;
    Ok(mirror)
}

/// Plants drawn, and time (s) of the fastest of `frames` frames.
fn frame(gpu: &Gpu, size_px: u32, mirror: &mut Mirror, frames: u32) -> (u32, f64) {
    let mut picture = OffscreenRenderer::new(gpu, [size_px; 2], Quality::Ultra);
    let camera = Camera { eye_m: Vec3::new(0.5 * EXTENT_M, 4.0, 0.5 * (EXTENT_M + PLOT_M) + 8.0), pitch_rad: -0.3, ..Camera::default() };
    let times = (0..=frames).map(|frame| {
        let begun = Instant::now();
        picture.draw(mirror, &camera, f64::from(frame) * f64::from(DT_SECS), DT_SECS);
        picture.rgba();
        begun.elapsed().as_secs_f64()
    });
    let least_secs = times.skip(1).fold(f64::INFINITY, f64::min);
    (picture.drawn_underbrush(), least_secs)
}

/// Postures per second that one core looks up, and components of a plant.
fn postures(species: &Underbrush, repeats: u32) -> (f64, usize) {
    let plan = Plan::new(species, species.posture_nodes());
    let placed = plan.placed(1);
    let begun = Instant::now();
    for n in 0..repeats {
        let stand = Stand { size: 1.0, heading_rad: n as f32, lean_rad: [0.0; 2] };
        let pressure_pa = Vec3::new(0.01 * n as f32, 0.0, 3.0);
        let forces = Forces { per_mass_m_per_s2: Vec3::NEG_Y * prairie_core::GRAVITY_M_PER_S2 as f32, pressure_pa };
        black_box(posed(&plan, &placed, stand, forces, LookUp::Interpolated, 0));
    }
    (f64::from(repeats) * placed.len() as f64 / begun.elapsed().as_secs_f64(), placed.len())
}

pub(super) fn draw(quick: bool, caption: &str) -> Result<Drawn> {
    let (size_px, frames, repeats) = if quick { (QUICK_SIZE_PX, 1, 20) } else { (SIZE_PX, 8, 2000) };
    let gpu = Gpu::headless()?;
    let mut csv = String::from("plants,drawn,components,frames_per_s,ms_a_frame,postures_per_s_and_core\n");
    let (mut rows, mut points) = (Vec::new(), Vec::new());
    for case in cases()? {
        let (drawn, secs) = frame(&gpu, size_px, &mut plot(&case)?, frames);
        ensure!(drawn > case.plants / 2, "{drawn} of {} plants are drawn", case.plants);
        let (postures_per_s, components) = postures(&case.species, repeats);
        let all = drawn as usize * components;
        writeln!(csv, "\"{}\",{drawn},{all},{:.2},{:.2},{postures_per_s:.0}", case.name, secs.recip(), 1e3 * secs)?;
        let theirs = if case.plants == 200 { "10 to 20" } else { "" };
        let cells = [format!("{drawn}"), format!("{all}"), theirs.to_owned(), format!("{:.1}", secs.recip()), format!("{:.1}", 1e3 * secs)];
        rows.push([vec![case.name.to_owned()], cells.to_vec(), vec![format!("{:.2}", 1e-6 * postures_per_s)]].concat());
        points.push([all as f64, secs.recip()]);
    }
    let heads =
        ["plants", "drawn", "components", "frames/s, Endo et al.", "frames/s, ours", "ms a frame", "million postures/s on one core"];
    let table = markdown(&heads, &rows);
    let most = points.iter().map(|point| point[1]).fold(THEIRS_PER_S[1], f64::max);
    let ends = [points[0][0] / 1.5, points[points.len() - 1][0] * 1.5];
    let mut curves = vec![Curve { name: "ours".into(), points, marked: true, joined: true }];
    for (per_s, name) in THEIRS_PER_S.into_iter().zip(["Endo et al.: 10 to 20 on a Pentium III", ""]) {
        curves.push(Curve { name: name.into(), points: ends.map(|components| [components, per_s]).to_vec(), marked: false, joined: true });
    }
    let axes = [
        Axis { name: "components drawn", range: ends, logarithmic: true },
        Axis { name: "frames per second", range: [0.0, 1.2 * most], logarithmic: false },
    ];
    let subtitle = format!("{size_px} × {size_px} px, ultra, fastest of {frames} frames; {}", gpu.adapter_name);
    let svg = curves_svg(&curves, axes, Words { title: TITLE, subtitle: &subtitle, caption })?;
    let tables = format!(
        "# {TITLE}\n\n{subtitle}; {caption}\n\n```sh\ncargo run --release --features charts -- chart blades underbrush force-field --only beside --out tests/results\n```\n\n\
         {STATEMENT} Here a processor draws in software, with shadows, sky and haze; \"with 1000 leaves\" may mean all flowers together or each of them.\n\n{table}"
    );
    Ok(Drawn { svg, csv, summary: format!("{table}\n{STATEMENT}"), tables: Some(tables), map: None })
}
