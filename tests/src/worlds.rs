//! Worlds to test with: small ones, made without files, and the largest that ships.

use server::scenes;
use server::world::{Maps, World};
use shared::scene::{Scene, TerrainMaps};
use shared::terrain::{CoverMap, HeightMap, grey_png};

/// A scene of `count × count` patches with the defaults of everything else.
pub fn scene(count: u32) -> Scene {
    let terrain = TerrainMaps { height_map: String::new(), covering_map: String::new(), pixel_m: [2.0; 2], level_m: 0.1, base_m: 0.0 };
    let mut scene = Scene { summary: "A world made by a test".to_owned(), ..Scene::new(terrain) };
    scene.patches.count = [count; 2];
    scene
}

/// Land whose height is `height_m` of (x, z) in metres, known every 2 m, and whose covering ID is `cover` of the same.
pub fn maps(scene: &Scene, height_m: impl Fn(f32, f32) -> f32, cover: impl Fn(f32, f32) -> u8) -> Maps {
    let [width, depth] = scene.extent_m().map(|extent| (extent / 2.0) as u32 + 1);
    let at = |i: u32| ((i % width) as f32 * 2.0, (i / width) as f32 * 2.0);
    let heights = (0..width * depth).map(|i| height_m(at(i).0, at(i).1)).collect();
    let ids: Vec<u8> = (0..width * depth).map(|i| cover(at(i).0, at(i).1)).collect();
    let height = HeightMap::from_heights(width, depth, [2.0; 2], heights);
    let cover = CoverMap::from_png(&grey_png([width, depth], &ids)).expect("a grey PNG of eight bits");
    Maps { height, cover, drawings: Default::default(), nutrients: None }
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

/// The built-in scene `continuum` with `cars` that drive themselves at 20 m/s and start about `apart_m` from each other, and its maps.
pub fn continuum(cars: u32, apart_m: f32) -> (Scene, Maps) {
    let loaded = scenes::load("continuum").expect("a built-in scene is sound");
    let (maps, mut scene) = (loaded.maps(), loaded.scene);
    scene.objects.limit = scene.objects.limit.max(cars);
    scene.objects.self_driving = cars;
    scene.objects.self_driving_m_per_s = 20.0;
    scene.objects.self_driving_apart_m = apart_m;
    (scene, maps)
}
