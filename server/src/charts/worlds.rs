//! Worlds for tests: small ones made without files, and the largest built-in one.

use crate::scenes::{self, LoadedScene};
use crate::world::{Maps, World};
use anyhow::Result;
use glam::Vec3;
use prairie_client::camera::Camera;
use prairie_client::state::Mirror;
use prairie_core::scene::{Patches, Scene, TerrainMaps};
use prairie_core::terrain::{CoverMap, HeightMap, KindMap, grey_png, grey_png_16};
use prairie_core::wind::WindField;
use prairie_core::wire::ServerMessage;
use std::sync::Arc;

/// A scene of `count × count` patches with the defaults of everything else.
pub fn scene(count: u32) -> Scene {
    let terrain = TerrainMaps { height_map: String::new(), covering_map: String::new(), pixel_m: [2.0; 2], level_m: 0.1, base_m: 0.0 };
    let mut scene = Scene { summary: "A world made by a test".to_owned(), ..Scene::new(terrain) };
    scene.patches.count = [count; 2];
    scene
}

/// Maps sampled every 2 m: terrain height `height_m(x, z)` and covering ID `cover(x, z)`, x and z in metres.
pub fn maps(scene: &Scene, height_m: impl Fn(f32, f32) -> f32, cover: impl Fn(f32, f32) -> u8) -> Maps {
    let [width, depth] = scene.extent_m().map(|extent| (extent / 2.0) as u32 + 1);
    let at = |i: u32| ((i % width) as f32 * 2.0, (i / width) as f32 * 2.0);
    let heights = (0..width * depth).map(|i| height_m(at(i).0, at(i).1)).collect();
    let ids: Vec<u8> = (0..width * depth).map(|i| cover(at(i).0, at(i).1)).collect();
    let height = HeightMap::from_heights(width, depth, [2.0; 2], heights);
    let cover = CoverMap::from_png(&grey_png([width, depth], &ids)).expect("a grey PNG of eight bits");
    Maps { height, cover, drawings: Default::default(), nutrients: None }
}

/// Still air over the grass of `[grass]`.
pub fn still_air(scene: &Scene) -> WindField {
    WindField::still(scene, Arc::new(KindMap::uniform()))
}

/// Flat land, all grass.
pub fn flat(scene: &Scene) -> World {
    World::new(scene, maps(scene, |_, _| 0.0, |_, _| 255)).expect("the default constants make a world")
}

/// Height of rolling hills, 3 m up and down over some 50 m (m).
pub fn hills_m(x: f32, z: f32) -> f32 {
    3.0 * (x * 0.11).sin() * (z * 0.13).cos() + 0.6 * (x * 0.31 + z * 0.27).sin()
}

/// Rolling hills with a tree or a stone here and there.
pub fn hills(scene: &Scene) -> World {
    let cover = |x: f32, z: f32| match (x as u32 * 7919 + z as u32 * 104_729) % 997 {
        0..4 => 253,
        4..8 => 254,
        _ => 255,
    };
    World::new(scene, maps(scene, hills_m, cover)).expect("the default constants make a world")
}

/// A scene with its files, 256 m long: rolling hills, with this ID at each pixel of the covering map, 2 m apart.
///
/// # Errors
/// When a map cannot be decoded.
pub fn loaded_hills(cover: impl Fn(u32) -> u8) -> Result<LoadedScene> {
    const BELOW_M: f32 = 8.0;
    const LEVEL_M: f32 = 0.01;
    let mut scene = scene(16);
    (scene.terrain.level_m, scene.terrain.base_m) = (LEVEL_M, -BELOW_M);
    let pixels = (scene.extent_m()[0] / 2.0) as u32 + 1;
    let at = |i: u32| ((i % pixels) as f32 * 2.0, (i / pixels) as f32 * 2.0);
    let level = |i: u32| ((hills_m(at(i).0, at(i).1) + BELOW_M) / LEVEL_M).round() as u16;
    let height_png = grey_png_16([pixels; 2], &(0..pixels * pixels).map(level).collect::<Vec<_>>());
    let covering_png = grey_png([pixels; 2], &(0..pixels * pixels).map(cover).collect::<Vec<_>>());
    Ok(LoadedScene {
        name: "hills".to_owned(),
        height: HeightMap::from_png(&height_png, &scene.terrain)?,
        cover: CoverMap::from_png(&covering_png)?,
        scene,
        height_png,
        covering_png,
        nutrient_png: vec![],
        nutrients: None,
        drawings: Default::default(),
        models: vec![],
        files: vec![],
        explanation: Default::default(),
    })
}

/// Client mirror of a flat meadow in still air, `side_m` (a multiple of 8) long, and its number of plant sites, 16 per square metre.
///
/// # Errors
/// When the mirror rejects the scene.
pub fn flat_meadow(side_m: u32) -> Result<(Mirror, f64)> {
    flat_land(side_m, 255)
}

/// The same terrain without plants.
///
/// # Errors
/// When the mirror rejects the scene.
pub fn bare_land(side_m: u32) -> Result<Mirror> {
    Ok(flat_land(side_m, 0)?.0)
}

/// Flat terrain with one ID all over the covering map.
fn flat_land(side_m: u32, cover: u8) -> Result<(Mirror, f64)> {
    const PATCH_M: u32 = 8;
    let pixel_m = [PATCH_M as f32; 2];
    let terrain = TerrainMaps { height_map: String::new(), covering_map: String::new(), pixel_m, level_m: 0.0, base_m: 0.0 };
    let patches = Patches { count: [side_m / PATCH_M; 2], cells: 32, cell_m: PATCH_M as f32 / 32.0, ..Patches::default() };
    let scene = Scene { patches, ..Scene::new(terrain) };
    let plants_per_m2 = (f64::from(scene.plants.plants_per_side) / f64::from(scene.plants.grid_m)).powi(2);
    let pixels = side_m / PATCH_M + 1;
    let mut mirror = Mirror::default();
    mirror.apply(ServerMessage::Scene {
        scene: Box::new(scene),
        height_png: grey_png([pixels; 2], &vec![0; (pixels * pixels) as usize]),
        covering_png: grey_png([8; 2], &[cover; 64]),
        nutrient_png: Vec::new(),
        models: Vec::new(),
        shapes: Default::default(),
    })?;
    Ok((mirror, plants_per_m2 * f64::from(side_m).powi(2)))
}

/// Camera at eye height in such a meadow, looking north from the middle of its southern edge.
pub fn on_foot(side_m: u32) -> Camera {
    Camera { eye_m: Vec3::new(side_m as f32 / 2.0, 1.7, side_m as f32), pitch_rad: -0.08, ..Camera::default() }
}

/// The built-in scene `continuum` and its maps, with `cars` self-driving cars at 20 m/s that start about `apart_m` (m) apart.
pub fn continuum(cars: u32, apart_m: f32) -> (Scene, Maps) {
    let loaded = scenes::load("continuum").expect("a built-in scene is sound");
    let (maps, mut scene) = (loaded.maps(), loaded.scene);
    scene.objects.limit = scene.objects.limit.max(cars);
    scene.objects.self_driving = cars;
    scene.objects.self_driving_m_per_s = 20.0;
    scene.objects.self_driving_apart_m = apart_m;
    (scene, maps)
}
