//! The lee of a tree, from the wind of a scene and the lean of its grass.

use std::fmt::Write as _;

use crate::weather::Weather;
use anyhow::{Context as _, Result, ensure};
use plotters::style::RGBColor;
use prairie_core::bend::{Field, Kinds};
use prairie_core::grid::PatchLayout;
use prairie_core::scene::{Patches, Scene, WindBoundary, WindFaces};
use prairie_core::terrain::Cover;

use crate::charts::worlds;
use prairie_charts::figure::{Axis, Drawn, Map, Panel, Words, map_svg};

/// Height of the tree (m), and the diameter of its crown relative to it, as the wind has it.
const TREE_M: f32 = 12.0;
const CROWN_DIAMETER: f32 = 0.35;
const CROWN_DRAG_PER_M: f32 = 0.3;
const WIND_M_PER_S: f32 = 10.0;
/// Extent of the air (m), and about where the tree stands (m, X and Z).
const BOX_M: [f32; 3] = [128.0, 24.0, 96.0];
const TREE_AT_M: [f32; 2] = [32.0, 48.0];
/// Heights of the wind that is drawn (m): in the middle of the crown, and just above the grass.
const HEIGHTS_M: [f32; 2] = [7.0, 1.0];
/// Drawn places from the tree, along and across the wind (m).
const FROM_M: [f64; 2] = [-16.0, -32.0];
const SIZE_M: f64 = 64.0;

/// Colours of a value relative to that without the tree, and the bounds between them.
const CLASSES: [(&str, RGBColor); 9] = [
    ("below 0.5", RGBColor(33, 76, 140)),
    ("to 0.7", RGBColor(92, 140, 190)),
    ("to 0.8", RGBColor(134, 172, 208)),
    ("to 0.9", RGBColor(178, 204, 226)),
    ("to 0.95", RGBColor(214, 228, 240)),
    ("to 1.05", RGBColor(243, 243, 239)),
    ("to 1.15", RGBColor(248, 224, 200)),
    ("to 1.3", RGBColor(232, 164, 120)),
    ("above 1.3", RGBColor(180, 76, 52)),
];
const BOUNDS: [f64; 8] = [0.5, 0.7, 0.8, 0.9, 0.95, 1.05, 1.15, 1.3];

fn class(relative: f64) -> usize {
    BOUNDS.iter().filter(|bound| relative >= **bound).count()
}

/// Level grass with a tree in an even wind along X that enters on one side and leaves on the other.
fn scene(cell_m: f32, crown_drag_per_m: f32) -> Scene {
    let mut scene = worlds::scene(8);
    scene.patches = Patches { count: [8, 6], ..scene.patches };
    scene.plants.tree_m = TREE_M;
    let wind = &mut scene.wind;
    (wind.spacing_m, wind.cells) = ([cell_m, 2.0, cell_m], [(BOX_M[0] / cell_m) as u32, 12, (BOX_M[2] / cell_m) as u32]);
    wind.faces = WindFaces { west: WindBoundary::Inflow, east: WindBoundary::Outflow, ..WindFaces::default() };
    (wind.mean_m_per_s, wind.sources, wind.turbulence) = ([WIND_M_PER_S, 0.0], 0, 0.0);
    wind.crown_drag_per_m = crown_drag_per_m;
    // Finer codes than by default, whose steps would show where the air at the ground is slow.
    scene.stream.wind_error_m_per_s = 0.01;
    scene
}

/// The wind of the scene after some time, and the place of the tree (m).
fn blown(scene: &Scene, secs: f32) -> Result<(Weather, [f32; 2])> {
    let is_tree = |x: f32, z: f32| [x, z] == TREE_AT_M;
    let maps = worlds::maps(scene, |_, _| 0.0, |x, z| if is_tree(x, z) { 253 } else { 255 });
    let at_m = maps.cover.places_m(Cover::Tree, scene.extent_m()).next().context("no tree")?;
    let mut weather = Weather::new(scene, &maps.height, &maps.cover)?;
    let grass = Field::new(PatchLayout::from(&scene.patches), Kinds::one(scene.grass.waves));
    (1..=(secs * scene.tick_hz) as u64).for_each(|tick| weather.step(tick, &[], &maps.height, &grass));
    ensure!(weather.resets() == 0, "the wind started anew");
    Ok((weather, at_m))
}

/// The wind at each of the heights (m/s) and the lean of the grass (rad) at a place (m).
fn values(weather: &Weather, [x, z]: [f32; 2]) -> [f64; 3] {
    let [crown, grass] = HEIGHTS_M.map(|above_m| {
        let [u, _, w] = weather.field().wind_at([x, above_m, z]);
        u.hypot(w)
    });
    let [along, across] = weather.field().lean_at([x, z]);
    [crown, grass, along.hypot(across)].map(f64::from)
}

/// Draws wind and lean of the grass around a tree from above, relative to those without it.
pub(super) fn draw_lee(quick: bool, caption: &str) -> Result<Drawn> {
    let (cell_m, secs, places) = if quick { (4.0, 2.0, 16) } else { (1.0, 40.0, 60) };
    let [(air, tree_m), (open, _)] = {
        let [with, without] = [CROWN_DRAG_PER_M, 0.0].map(|drag| blown(&scene(cell_m, drag), secs));
        [with?, without?]
    };
    let mut csv = String::from("x_m,z_m,wind_7_m,wind_1_m,lean,open_wind_7_m_per_s,open_wind_1_m_per_s,open_lean_rad\n");
    let mut columns = [const { vec![] }; 3];
    let place_m = |n: usize, axis: usize| FROM_M[axis] + (n as f64 + 0.5) / places as f64 * SIZE_M;
    let mut least = [f64::INFINITY; 3];
    for i in 0..places {
        columns.iter_mut().for_each(|column| column.push(vec![]));
        for j in 0..places {
            let [x, z] = [place_m(i, 0), place_m(j, 1)];
            let at_m = [x as f32 + tree_m[0], z as f32 + tree_m[1]];
            let (found, free) = (values(&air, at_m), values(&open, at_m));
            let relative: [f64; 3] = std::array::from_fn(|n| found[n] / free[n]);
            writeln!(
                csv,
                "{x:.2},{z:.2},{:.3},{:.3},{:.3},{:.3},{:.3},{:.4}",
                relative[0], relative[1], relative[2], free[0], free[1], free[2]
            )?;
            for (n, column) in columns.iter_mut().enumerate() {
                least[n] = least[n].min(relative[n]);
                column[i].push(class(relative[n]));
            }
        }
    }
    let free = values(&open, tree_m);
    let names = [
        format!("wind at {} m (open: {:.1} m/s)", HEIGHTS_M[0], free[0]),
        format!("wind at {} m (open: {:.1} m/s)", HEIGHTS_M[1], free[1]),
        format!("lean of the grass (open: {:.2} rad)", free[2]),
    ];
    let radius_m = 0.5 * f64::from(CROWN_DIAMETER * TREE_M);
    let crown: Vec<_> =
        (0..=48).map(|n| f64::from(n) / 48.0 * std::f64::consts::TAU).map(|rad| [radius_m * rad.cos(), radius_m * rad.sin()]).collect();
    let panels: Vec<_> =
        names.into_iter().zip(columns).map(|(name, columns)| Panel { name, columns, outlines: vec![crown.clone()] }).collect();
    let axes = [
        Axis { name: "along the wind (m)", range: [FROM_M[0], FROM_M[0] + SIZE_M], logarithmic: false },
        Axis { name: "across (m)", range: [FROM_M[1], FROM_M[1] + SIZE_M], logarithmic: false },
    ];
    let subtitle =
        "seen from above, relative to the same place without the tree, which is 12 m high; its crown (circle) has a drag of 0.3 /m";
    let svg = map_svg(&Map { panels, classes: &CLASSES, axes }, Words { title: "The lee of a tree", subtitle, caption })?;
    let summary =
        format!("least wind {:.2} at 7 m and {:.2} at 1 m, least lean {:.2} of those without the tree\n", least[0], least[1], least[2]);
    Ok(Drawn::new(svg, csv, summary))
}
