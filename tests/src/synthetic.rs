//! A small world without a server: hills, a covering map, gusts, a bent track, a helicopter's downwash, some objects. It is made of
//! the messages that a server would send, so that the client decodes and applies them as usual.

use crate::maps;
use glam::{Quat, Vec2, Vec3};
use prairie_client::state::Mirror;
use prairie_core::grid::PatchLayout;
use prairie_core::scene::{Objects, Scene, TerrainMaps, VehicleKind};
use prairie_core::terrain::{HeightMap, grey_png};
use prairie_core::wire::quantise::CodeSteps;
use prairie_core::wire::{ObjectPose, ServerMessage, Shape, TurbulenceState, codec};

/// Pixels of both maps along X and Z, and the distance between those of the height map (m).
const MAP_PX: u32 = 257;
const PIXEL_M: f32 = 1.0;
const LEVEL_M: f32 = 0.0004;

/// A mirror that has received the whole world.
///
/// # Panics
/// When the mirror rejects a message; the world is valid by construction.
pub fn mirror() -> Mirror {
    let mut mirror = Mirror::default();
    for message in messages() {
        mirror.apply(message).expect("the synthetic world is sound");
    }
    mirror
}

/// Centre of the car's circular track (m) and its radius (m).
pub const TRACK: ([f32; 2], f32) = ([128.0, 130.0], 22.0);
/// Position of the car on the track (rad, from east towards south).
pub const CAR_RAD: f32 = 0.9;
/// Position of the hovering helicopter (m).
pub const HELICOPTER: [f32; 2] = [100.0, 128.0];
/// Position of the monster (m).
pub const MONSTER: [f32; 2] = [136.0, 141.0];

fn messages() -> Vec<ServerMessage> {
    let scene = scene();
    let levels: Vec<u16> =
        (0..MAP_PX * MAP_PX).map(|i| (height_m((i % MAP_PX) as f32 * PIXEL_M, (i / MAP_PX) as f32 * PIXEL_M) / LEVEL_M) as u16).collect();
    let height_bytes: Vec<u8> = levels.iter().flat_map(|level| level.to_be_bytes()).collect();
    let height_png = maps::png(png::ColorType::Grayscale, png::BitDepth::Sixteen, [MAP_PX; 2], &height_bytes);
    let covering_png = grey_png([256; 2], &covering());
    let heights = HeightMap::from_png(&height_png, &scene.terrain).expect("a height map");
    let layout = PatchLayout::from(&scene.patches);
    let mut messages = vec![
        ServerMessage::Welcome { client: 1, proof: [0; 32], server_version: String::new(), scene_name: String::new() },
        ServerMessage::Scene {
            scene: Box::new(scene.clone()),
            height_png,
            covering_png,
            nutrient_png: Vec::new(),
            models: Vec::new(),
            shapes: Default::default(),
        },
        wind(&scene),
        ServerMessage::Poses { tick: 1, objects: objects(&heights) },
    ];
    messages.extend((0..layout.patches() as u32).filter_map(|patch| patch_message(&layout, patch)));
    messages.push(ServerMessage::FrameEnd { frame: 1, tick: 1, time_secs: 0.0 });
    messages
}

fn scene() -> Scene {
    let terrain =
        TerrainMaps { height_map: String::new(), covering_map: String::new(), pixel_m: [PIXEL_M; 2], level_m: LEVEL_M, base_m: 0.0 };
    Scene { summary: "hills without a server".into(), ..Scene::new(terrain) }
}

fn height_m(x: f32, z: f32) -> f32 {
    let wave = |x: f32, z: f32, length: f32| (x / length).sin() * (z / length + 0.7).cos();
    11.0 + 4.5 * wave(x, z, 31.0) + 1.6 * wave(z + 11.0, x, 13.0) + 0.35 * wave(x + 3.0, z, 4.7)
}

fn covering() -> Vec<u8> {
    let hash = |i: u32| (i.wrapping_mul(2_654_435_761) >> 8) % 10_000;
    (0..256 * 256_u32)
        .map(|i| {
            let (x, z) = ((i % 256) as f32, (i / 256) as f32);
            let woods = (x / 40.0).sin() * (z / 33.0).cos();
            let is_clear = Vec2::new(x - 128.0, z - 130.0).length() < 34.0;
            let path = (z - 196.0 - 14.0 * (x / 37.0).sin()).abs() < 1.6;
            match hash(i) {
                _ if path => 0,
                h if !is_clear && woods > 0.35 && h < 170 => 253,
                h if !is_clear && h < 14 => 253,
                h if h < 28 => 254,
                _ => 255,
            }
        })
        .collect()
}

fn wind(scene: &Scene) -> ServerMessage {
    let [nx, ny, nz] = scene.wind.cells.map(|n| n as usize);
    let mut codes = vec![0_i16; nx * ny * nz * 3];
    let (count, steps) = (nx * ny * nz, CodeSteps::from(&scene.stream));
    for i in 0..count {
        let (x, y, z) = (i % nx, i / nx % ny, i / (nx * ny));
        let turn = std::f32::consts::TAU;
        let (fx, fz) = (turn * x as f32 / nx as f32, turn * z as f32 / nz as f32);
        let strength = 0.8 + 0.05 * y as f32 + 0.35 * (3.0 * fx + fz).sin() * (2.0 * fz).cos();
        codes[i] = steps.wind_code(4.2 * strength);
        codes[2 * count + i] = steps.wind_code(2.6 * strength + 0.8 * (2.0 * fx).sin());
    }
    // As in a neutral surface layer under a mean wind of 4.9 m/s at 10 m.
    let turbulence = TurbulenceState { friction_m_per_s: 0.37, ..TurbulenceState::default() };
    ServerMessage::Wind { tick: 1, seq: 1, key: true, turbulence, payload: codec::encode(Shape::wind(nx, false), &codes, None) }
}

fn patch_message(layout: &PatchLayout, patch: u32) -> Option<ServerMessage> {
    let (cells, steps) = (layout.cells as usize, CodeSteps::default());
    let [corner_x, corner_z] = layout.corner_m(patch);
    let mut codes = vec![0_i16; cells * cells * 3];
    for i in 0..cells * cells {
        let x = corner_x + ((i % cells) as f32 + 0.5) * layout.cell_m;
        let z = corner_z + ((i / cells) as f32 + 0.5) * layout.cell_m;
        let (theta, direction) = bend_at(Vec2::new(x, z));
        if theta > 0.01 {
            codes[i] = steps.theta_code(theta);
            codes[cells * cells + i] = steps.omega_code(direction.x * theta * 20.0);
            codes[2 * cells * cells + i] = steps.omega_code(direction.y * theta * 20.0);
        }
    }
    let is_bent = codes.iter().any(|&code| code != 0);
    is_bent.then(|| ServerMessage::Patch { patch, seq: 1, key: true, payload: codec::encode(Shape::patch(cells), &codes, None) })
}

/// Bending angle (rad) and direction: two wheel tracks that recover with age, and an outward downwash.
fn bend_at(p: Vec2) -> (f32, Vec2) {
    let from_centre = p - Vec2::from(TRACK.0);
    let angle = from_centre.y.atan2(from_centre.x);
    let age = (CAR_RAD - angle).rem_euclid(std::f32::consts::TAU) / std::f32::consts::TAU;
    let off = from_centre.length() - TRACK.1;
    let wheel = (1.0 - ((off.abs() - 0.8) / 0.38).powi(2)).max(0.0).sqrt();
    let under = (1.0 - (off / 1.1).powi(4)).max(0.0) * 0.55;
    let track = 1.42 * wheel.max(under) * (-1.6 * age).exp();
    let along = Vec2::new(-angle.sin(), angle.cos());
    let from_wash = p - Vec2::from(HELICOPTER);
    let radius = from_wash.length();
    let wash = 1.25 * (-((radius - 4.5) / 4.5).powi(2)).exp() * (0.85 + 0.15 * (radius * 2.1).sin());
    if track > wash { (track, along) } else { (wash, from_wash.normalize_or_zero()) }
}

fn objects(heights: &HeightMap) -> Vec<ObjectPose> {
    let pose = |id, kind: VehicleKind, [x, z]: [f32; 2], heading: f32, above_m: f32, speed: f32, part_rad| {
        let up = if above_m > 2.0 { Vec3::Y } else { heights.normal(x, z) };
        let rotation = Quat::from_rotation_arc(Vec3::Y, up) * Quat::from_rotation_y(-heading);
        let foot = Vec3::new(x, heights.height_m(x, z), z);
        ObjectPose {
            id,
            kind,
            position_m: (foot + up * (Objects::default().half_extents_m(kind)[1] + above_m)).into(),
            rotation: rotation.into(),
            velocity_m_per_s: (rotation * Vec3::NEG_Z * speed).into(),
            part_rad,
        }
    };
    let car = Vec2::from(TRACK.0) + Vec2::from_angle(CAR_RAD) * TRACK.1;
    let heading = CAR_RAD + std::f32::consts::PI;
    vec![
        pose(1, VehicleKind::Car, car.into(), heading, 0.0, 12.0, 0.25),
        pose(2, VehicleKind::Helicopter, HELICOPTER, 1.2, 5.0, 0.0, 0.8),
        pose(3, VehicleKind::Monster, MONSTER, 2.6, 0.0, 1.5, 0.9),
    ]
}
