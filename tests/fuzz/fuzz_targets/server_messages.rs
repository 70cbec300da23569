//! Messages from a server, applied to the client's mirror after a small valid scene.
//!
//! Input: messages, each after its length in two bytes, lowest first.

#![no_main]

use libfuzzer_sys::fuzz_target;
use prairie_client::state::Mirror;
use prairie_core::body::{Body, Prism};
use prairie_core::scene::{Patches, Scene, TerrainMaps, VehicleKind, Wind};
use prairie_core::terrain::grey_png;
use prairie_core::wire::{SERVER_MESSAGE_LIMIT, ServerMessage, Shapes, decode};

/// Places at which the fields are sampled: within the small scene, and outside (m, X and Z).
const PLACES_M: [[f32; 2]; 2] = [[3.3, 2.1], [-7.0, 1e4]];

/// A lawn of 3 × 2 patches of 8 × 8 cells under a wind of 4 × 2 × 4 cells.
fn scene() -> ServerMessage {
    let maps = TerrainMaps { height_map: String::new(), covering_map: String::new(), pixel_m: [1.0, 1.0], level_m: 0.1, base_m: 0.0 };
    let scene = Scene {
        patches: Patches { count: [3, 2], cells: 8, ..Patches::default() },
        wind: Wind { cells: [4, 2, 4], ..Wind::default() },
        ..Scene::new(maps)
    };
    let map = grey_png([4; 2], &[255; 16]);
    let prism = Prism::cuboid([0.0; 3], [0.5, 0.5, 1.0]);
    let body = Body { prisms: vec![Prism { bears_weight: true, ..prism }], is_round: false, has_downwash: true, stride_m: 0.0 };
    ServerMessage::Scene {
        scene: Box::new(scene),
        height_png: map.clone(),
        covering_png: map,
        nutrient_png: Vec::new(),
        models: Vec::new(),
        shapes: Shapes { bodies: vec![body; VehicleKind::ALL.len()], drawings: Vec::new() },
    }
}

/// The messages of an input.
fn messages(mut bytes: &[u8]) -> impl Iterator<Item = &[u8]> {
    std::iter::from_fn(move || {
        let (length, rest) = bytes.split_first_chunk()?;
        let (message, rest) = rest.split_at(rest.len().min(u16::from_le_bytes(*length).into()));
        bytes = rest;
        Some(message)
    })
}

/// Whether a message is no scene, or one that is decoded within milliseconds: large ones are valid, but would take most of the time.
fn is_quick(message: &ServerMessage) -> bool {
    let ServerMessage::Scene { scene, .. } = message else { return true };
    let area_m2 = scene.extent_m()[0] * scene.extent_m()[1];
    scene.patches.count.iter().all(|&count| count <= 16)
        && scene.wind.cells.iter().all(|&cells| cells <= 16)
        && (area_m2.is_nan() || area_m2 <= 1e5)
}

/// Asks for everything that the renderer asks for in a frame.
fn read(mirror: &mut Mirror) {
    mirror.advance(1.0 / 60.0);
    for pose in mirror.objects() {
        assert!(pose.position_m.iter().chain(&pose.rotation).all(|value| value.is_finite()), "{pose:?}");
    }
    for patch in mirror.take_dirty_patches() {
        let _ = mirror.patch(patch).map(|codes| codes.planes());
    }
    for [x_m, z_m] in PLACES_M {
        let wind = mirror.wind_field().map_or([0.0; 3], |field| field.wind_at([x_m, 1.0, z_m]));
        let scalars = [mirror.ground_m(x_m, z_m), mirror.theta_at(x_m, z_m)];
        let leans = [mirror.lean_at(x_m, z_m), mirror.field_lean_at(x_m, z_m)].concat();
        let mut values = wind.iter().chain(&scalars).chain(&leans);
        assert!(values.all(|value| value.is_finite()), "at ({x_m}, {z_m}) m: wind {wind:?}, ground and angle {scalars:?}, leans {leans:?}");
    }
    let shown_secs = mirror.shown_secs();
    let _ = (mirror.shown_wind(shown_secs), mirror.is_calm(), mirror.falls().len(), mirror.peers().len());
}

fuzz_target!(|bytes: &[u8]| {
    let mut mirror = Mirror::default();
    mirror.apply(scene()).expect("the scene is valid");
    for message in messages(bytes) {
        if let Ok(message) = decode::<ServerMessage>(message, SERVER_MESSAGE_LIMIT)
            && is_quick(&message)
        {
            let _ = mirror.apply(message);
            read(&mut mirror);
        }
    }
});
