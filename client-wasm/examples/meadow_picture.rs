//! Draws a picture of a small meadow without a window and without a server: builds a scene in code, applies the same messages that a server would send to a
//! [`Mirror`], and saves a frame as PNG.
//!
//! ```sh
//! cargo run --release -p prairie-client --example meadow_picture -- meadow.png
//! ```

use glam::{Quat, Vec3};
use prairie_client::camera::Camera;
use prairie_client::render::{Gpu, OffscreenRenderer, Quality};
use prairie_client::state::Mirror;
use prairie_core::scene::{Light, Patches, Plants, Scene, TerrainMaps, VehicleKind};
use prairie_core::terrain::grey_png;
use prairie_core::wire::quantise::CodeSteps;
use prairie_core::wire::{ObjectPose, ServerMessage, Shape, TurbulenceState, codec};
use std::error::Error;
use std::path::{Path, PathBuf};

const SIZE_PX: [u32; 2] = [960, 540];
/// Side of the world (m): 8 × 8 patches of 64 × 64 cells of 0.25 m.
const WORLD_M: f32 = 128.0;
const PATCHES: u32 = 8;
const CELLS: u32 = 64;
const CELL_M: f32 = 0.25;
/// Elevation of one grey level of the height map (m).
const LEVEL_M: f32 = 0.05;
/// Covering IDs of the map, as in a scene's covering map.
const GAP: u8 = 0;
const TREE: u8 = 253;
const STONE: u8 = 254;
const GRASS: u8 = 255;
/// Position of the car (m, X and Z).
const CAR_M: [f32; 2] = [60.0, 70.0];

/// Elevation of the ground (m): a shallow valley with a ridge in the north.
fn elevation_m(x_m: f32, z_m: f32) -> f32 {
    let ridge_m = 9.0 * (-((z_m - 12.0) / 26.0).powi(2)).exp();
    ridge_m + 1.2 * (x_m / 17.0).sin() * (z_m / 23.0).cos() + 2.0
}

/// Distance of a point to the right of the car's path, and the path's direction (X, Z) there.
fn path(x_m: f32, z_m: f32) -> (f32, [f32; 2]) {
    let bend = (z_m - CAR_M[1]) / 22.0;
    let slope = 2.0 * 7.0 * bend / 22.0;
    let length = slope.hypot(1.0);
    ((x_m - CAR_M[0] - 7.0 * bend * bend) / length, [-slope / length, -1.0 / length])
}

/// Covering ID of a point: grass, a few trees on the ridge, some stones, and bare ground on a footpath.
fn cover(x_m: f32, z_m: f32) -> u8 {
    let trees = [[30.0, 34.0], [38.0, 26.0], [44.5, 31.0], [81.0, 30.0], [90.0, 37.0], [99.0, 28.0], [22.0, 52.0], [108.0, 55.0]];
    let stones = [[51.0, 76.0], [53.0, 78.0], [70.0, 74.0]];
    // The pixel whose north-west corner is the point.
    let is_at = |points: &[[f32; 2]]| points.iter().any(|[x, z]| (x_m - x - 0.25).abs() < 0.1 && (z_m - z - 0.25).abs() < 0.1);
    let footpath_m = (x_m - 80.0 - 6.0 * (z_m / 15.0).sin()).abs();
    match () {
        () if is_at(&trees) => TREE,
        () if is_at(&stones) => STONE,
        () if footpath_m < 0.6 => GAP,
        () => GRASS,
    }
}

fn map(side_px: u32, pixel_m: f32, offset_px: f32, level: impl Fn(f32, f32) -> u8) -> Vec<u8> {
    let at_m = |index: u32| (index as f32 + offset_px) * pixel_m;
    let levels: Vec<u8> = (0..side_px * side_px).map(|pixel| level(at_m(pixel % side_px), at_m(pixel / side_px))).collect();
    grey_png([side_px; 2], &levels)
}

fn scene() -> ServerMessage {
    let maps = TerrainMaps { height_map: String::new(), covering_map: String::new(), pixel_m: [2.0; 2], level_m: LEVEL_M, base_m: 0.0 };
    let scene = Scene {
        patches: Patches { count: [PATCHES; 2], cells: CELLS, cell_m: CELL_M, ..Patches::default() },
        plants: Plants { flowers_per_m2: 4.0, height_m: 0.6, ..Plants::default() },
        light: Light { sun_heading_rad: 4.9, sun_elevation_rad: 0.32, ..Light::default() },
        ..Scene::new(maps)
    };
    ServerMessage::Scene {
        scene: Box::new(scene),
        height_png: map(65, 2.0, 0.0, |x_m, z_m| (elevation_m(x_m, z_m) / LEVEL_M) as u8),
        covering_png: map(256, 0.5, 0.5, cover),
        nutrient_png: Vec::new(),
        models: Vec::new(),
        shapes: Default::default(),
    }
}

/// A steady wind towards the south-east.
fn wind(cells: [u32; 3]) -> ServerMessage {
    let volume = cells.iter().product::<u32>() as usize;
    let codes: Vec<i16> =
        [4.0, 0.0, 2.5].into_iter().flat_map(|m_per_s| std::iter::repeat_n(CodeSteps::default().wind_code(m_per_s), volume)).collect();
    ServerMessage::Wind {
        tick: 0,
        seq: 1,
        key: true,
        turbulence: TurbulenceState::default(),
        payload: codec::encode(Shape::wind(cells[0] as usize, false), &codes, None),
    }
}

/// Bend field of one patch: grass lies flat in the two tracks behind the car.
fn tracks(patch: u32) -> ServerMessage {
    let corner_m = [patch % PATCHES, patch / PATCHES].map(|index| (index * CELLS) as f32 * CELL_M);
    let steps = CodeSteps::default();
    let cells = (0..CELLS * CELLS).map(|cell| {
        let [x_m, z_m] = [0, 1].map(|axis| corner_m[axis] + ([cell % CELLS, cell / CELLS][axis] as f32 + 0.5) * CELL_M);
        let (aside_m, direction) = path(x_m, z_m);
        let lies_flat = z_m > CAR_M[1] && (aside_m.abs() - 0.85).abs() < 0.35;
        if lies_flat {
            [steps.theta_code(1.5), steps.omega_code(20.0 * direction[0]), steps.omega_code(20.0 * direction[1])]
        } else {
            [0; 3]
        }
    });
    let cells: Vec<[i16; 3]> = cells.collect();
    let codes: Vec<i16> = (0..3).flat_map(|plane| cells.iter().map(move |cell| cell[plane])).collect();
    ServerMessage::Patch { patch, seq: 1, key: true, payload: codec::encode(Shape::patch(CELLS as usize), &codes, None) }
}

fn car() -> ServerMessage {
    let [x_m, z_m] = CAR_M;
    let slope = (elevation_m(x_m, z_m - 1.5) - elevation_m(x_m, z_m + 1.5)) / 3.0;
    let pose = ObjectPose {
        id: 1,
        kind: VehicleKind::Car,
        position_m: [x_m, elevation_m(x_m, z_m) + 0.75, z_m],
        rotation: Quat::from_rotation_x(slope.atan()).to_array(),
        velocity_m_per_s: [0.0; 3],
        part_rad: 0.15,
    };
    ServerMessage::Poses { tick: 0, objects: vec![pose] }
}

fn save(path: &Path, rgba: &[u8]) -> Result<(), Box<dyn Error>> {
    let mut encoder = png::Encoder::new(std::fs::File::create(path)?, SIZE_PX[0], SIZE_PX[1]);
    encoder.set_color(png::ColorType::Rgba);
    encoder.write_header()?.write_image_data(rgba)?;
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).map_or_else(|| PathBuf::from("meadow.png"), PathBuf::from);
    let mut mirror = Mirror::default();
    mirror.apply(scene())?;
    let cells = mirror.decoded_scene().map(|decoded| decoded.scene().wind.cells).unwrap_or_default();
    for message in (0..PATCHES * PATCHES).map(tracks).chain([wind(cells), car()]) {
        mirror.apply(message)?;
    }
    let [x_m, z_m] = [CAR_M[0] + 4.0, CAR_M[1] + 12.0];
    let camera =
        Camera { eye_m: Vec3::new(x_m, elevation_m(x_m, z_m) + 3.6, z_m), heading_rad: -0.2, pitch_rad: -0.2, ..Camera::default() };
    let gpu = Gpu::headless()?;
    let mut renderer = OffscreenRenderer::new(&gpu, SIZE_PX, Quality::High);
    // The blades need some frames to lean into the wind.
    for frame in 0..20 {
        renderer.draw(&mut mirror, &camera, f64::from(frame) / 15.0, 1.0 / 15.0);
    }
    save(&path, &renderer.rgba())?;
    println!("{} shows a meadow of {WORLD_M} m × {WORLD_M} m in {} × {} px", path.display(), SIZE_PX[0], SIZE_PX[1]);
    Ok(())
}
