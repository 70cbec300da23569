//! Models that the covering map places: the same on server and client, in the way of vehicles, and with no plant beneath them.

use anyhow::{Context as _, Result};
use png::{BitDepth, ColorType};
use prairie::charts::worlds;
use prairie::objects::Environment;
use prairie::scenes;
use prairie::studio::Stage;
use prairie::world::{Camera, Command, World};
use prairie_core::body::BodyPose;
use prairie_core::scene::VehicleKind::{self, Ball, Car, Helicopter, Monster, Sled, Walker};
use prairie_core::scene::{CoverModel, Scene};
use prairie_core::terrain::{Cover, ModelBox, model_boxes};
use prairie_core::wire::{Drive, ModelUse};
use prairie_vehicles::{LoneVehicle, VehicleMotion};
use std::path::Path;
use std::sync::Arc;
use tests::maps;

/// Place of the house (m), and half of its width, height and depth (m).
const HOUSE_M: [f32; 2] = [65.0, 65.0];
const HALF_M: [f32; 3] = [4.0, 2.5, 3.0];

/// A scene of 128 m with a house that faces north; `has_house` is false for the controls.
fn scene(has_house: bool) -> Scene {
    let house = CoverModel { size_m: HALF_M.map(|half_m| 2.0 * half_m), ..CoverModel::new("house", 9, "") };
    Scene { models: if has_house { vec![house] } else { vec![] }, ..worlds::scene(8) }
}

/// ID 9 in the pixel of the house alone.
fn cover(x: f32, z: f32) -> u8 {
    if [x, z] == HOUSE_M.map(|m| m - 1.0) { 9 } else { 255 }
}

fn environment(scene: &Scene) -> Environment {
    // The covering map has a pixel more than the world is long, so that its pixels are 1.97 m apart.
    let maps = worlds::maps(scene, |_, _| 0.0, cover);
    Environment { height: Arc::new(maps.height), cover: Arc::new(maps.cover), extent_m: scene.extent_m() }
}

fn house(scene: &Scene) -> ModelBox {
    model_boxes(scene, &environment(scene).cover)[0]
}

/// Southernmost position of a vehicle that drives at the house from the north for 6 s (m from the middle of the house, negative in the north), and its
/// depth in the box at the most (m).
fn driven_at_the_house(kind: VehicleKind, has_house: bool) -> [f32; 2] {
    let (scene, own) = (scene(has_house), house(&scene(true)));
    let mut vehicle = LoneVehicle::new(&scene, environment(&scene), kind);
    let half_m = scene.objects.half_extents_m(kind);
    vehicle.place([own.at_m[0], half_m[1] + 0.05, own.at_m[1] - 20.0], std::f32::consts::PI);
    let lift = match kind {
        Helicopter => 0.02,
        // It runs.
        Walker => -1.0,
        _ => 0.0,
    };
    let drive = Drive { throttle: if kind == Walker { 1.0 } else { 0.6 }, lift, ..Drive::default() };
    let (mut southernmost_m, mut deepest_m) = (f32::MIN, 0.0_f32);
    for _ in 0..360 {
        vehicle.step(drive, |_| [0.0; 3]);
        let [x, y, z] = vehicle.motion().pose.position_m;
        southernmost_m = southernmost_m.max(z - own.at_m[1]);
        if y < 2.0 * HALF_M[1] {
            // The middle of a vehicle keeps its distance from the box.
            let nearest_m = half_m[0].min(half_m[2]);
            deepest_m = deepest_m.max(nearest_m - own.squared_distance_m2([x, z]).sqrt());
        }
    }
    [southernmost_m, deepest_m]
}

#[test]
fn every_vehicle_stops_at_the_wall_of_a_house() {
    for kind in [Car, Monster, Helicopter, Sled, Ball, Walker] {
        let [stopped_m, deepest_m] = driven_at_the_house(kind, true);
        let [through_m, _] = driven_at_the_house(kind, false);
        println!("{}: {stopped_m:.2} m with the house, {deepest_m:.2} m deep; {through_m:.2} m without", kind.name());
        assert!(stopped_m < -HALF_M[2] && deepest_m < 0.15, "{} is at {stopped_m} m, {deepest_m} m deep", kind.name());
        assert!(through_m > HALF_M[2], "without the house a {} is at {through_m} m", kind.name());
    }
}

/// Steering of a car at a position towards the middle of the house.
fn towards(own: &ModelBox, position_m: [f32; 3], rotation: [f32; 4]) -> f32 {
    let [_, y, _, w] = rotation;
    let wanted = (own.at_m[0] - position_m[0]).atan2(position_m[2] - own.at_m[1]);
    let off = -2.0 * y.atan2(w) - wanted;
    let off = (off + std::f32::consts::PI).rem_euclid(std::f32::consts::TAU) - std::f32::consts::PI;
    (-2.0 * off).clamp(-1.0, 1.0)
}

#[test]
fn a_prediction_hits_the_wall_as_the_server_does() -> Result<()> {
    let scene = scene(true);
    let own = house(&scene);
    let mut world = World::new(&scene, worlds::maps(&scene, |_, _| 0.0, cover))?;
    let view = Camera { client: 1, eye_m: [own.at_m[0], 2.0, own.at_m[1] - 30.0] };
    world.step(&[Command::Cameras(vec![view])]);
    world.step(&[Command::Spawn { client: 1, kind: Car }]);
    let mut lone = LoneVehicle::new(&scene, environment(&scene), Car);
    let [mut nearest_m, mut nearest_predicted_m] = [f32::MAX; 2];
    for tick in 0..1200_u32 {
        let pose = *world.snapshot().objects.first().context("a car")?;
        // Goes on from the server's motion every quarter of a second.
        if tick % 15 == 0 {
            let pose_now = BodyPose { position_m: pose.position_m, rotation: pose.rotation };
            lone.assume(&VehicleMotion { pose: pose_now, velocity_m_per_s: pose.velocity_m_per_s, ..lone.motion() });
        }
        let drive = Drive { throttle: 0.5, steer: towards(&own, pose.position_m, pose.rotation), ..Drive::default() };
        world.step(&[Command::Drive { client: 1, number: 0, drive }]);
        lone.step(drive, |_| [0.0; 3]);
        let distance_m = |[x, _, z]: [f32; 3]| own.squared_distance_m2([x, z]).sqrt();
        nearest_m = nearest_m.min(distance_m(world.snapshot().objects[0].position_m));
        nearest_predicted_m = nearest_predicted_m.min(distance_m(lone.motion().pose.position_m));
    }
    println!("the middle of the car comes to {nearest_m:.2} m from the house, of the predicted one to {nearest_predicted_m:.2} m");
    // Half its width, up to half its length.
    assert!((0.85..2.4).contains(&nearest_m), "{nearest_m} m from the wall");
    assert!((0.8..2.4).contains(&nearest_predicted_m), "predicted {nearest_predicted_m} m from the wall");
    Ok(())
}

/// One triangle 2 m wide and 1 m high, as a glTF file with its data inside.
const TRIANGLE: &str = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"buffers":[{"byteLength":36,
"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAAAAQAAAAAAAAAAAAAAAAAAAgD8AAAAA"}],
"bufferViews":[{"buffer":0,"byteLength":36}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[2,1,0]}]}"#;

/// A folder with a scene of 128 m on hills, with houses, rocks and a model of its own, among underbrush.
fn farm(folder: &Path) -> Result<String> {
    let text = "summary = 's'\nseed = 7\nunderbrush_file = 'species.toml'\npatches = { count = [8, 8] }\n[terrain]\nheight_map = 'h.png'\n\
        covering_map = 'c.png'\npixel_m = [2, 2]\nlevel_m = 0.1\n\
        [[models]]\nname = 'house'\ncover = 9\nmodel = 'house'\nheading_variation_rad = 3\n\
        [[models]]\nname = 'rock'\ncover = 10\nmodel = 'rock'\nsize_m = [0, 2, 0]\nsize_variation = 0.4\nheading_variation_rad = 3.1\napart_m = 5\n\
        [[models]]\nname = 'sign'\ncover = 11\nmodel = 'sign.gltf'\nsize_m = [0, 3, 0]\n";
    let heights: Vec<u8> = (0..65 * 65).map(|i| ((i % 65) as f32 * 0.4).sin().mul_add(20.0, 40.0) as u8).collect();
    // A pixel is half a metre wide.
    let id = |i: usize| match [i % 256, i / 256] {
        [40 | 120 | 200, 50 | 150 | 220] => 9,
        [_, 100] => 10,
        [x, 200] if x % 50 == 7 => 11,
        _ => 255,
    };
    let path = folder.join("s.toml");
    std::fs::write(&path, text)?;
    std::fs::write(folder.join("species.toml"), include_str!("../../../server/scenes/species.toml"))?;
    std::fs::write(folder.join("sign.gltf"), TRIANGLE)?;
    std::fs::write(folder.join("h.png"), maps::png(ColorType::Grayscale, BitDepth::Eight, [65; 2], &heights))?;
    std::fs::write(
        folder.join("c.png"),
        maps::png(ColorType::Grayscale, BitDepth::Eight, [256; 2], &(0..256 * 256).map(id).collect::<Vec<_>>()),
    )?;
    Ok(path.to_str().context("a path in UTF-8")?.to_owned())
}

#[test]
fn server_and_client_have_the_same_boxes_and_no_plant_beneath_them() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let path = farm(folder.path())?;
    let loaded = scenes::load(&path)?;
    let stage = Stage::load(&path)?;
    let client = stage.mirror.decoded_scene().context("a scene")?;
    let boxes = model_boxes(&loaded.scene, &loaded.cover);
    assert_eq!(model_boxes(client.scene(), client.cover()), boxes);
    assert_eq!(client.cover(), &loaded.cover);
    let count = |model: usize| boxes.iter().filter(|own| own.model == model).count();
    // Rocks keep 5 m from each other along their line of 128 m.
    assert_eq!([count(0), count(1), count(2)], [9, 26, 5]);
    let sides = loaded.scene.models.iter().map(|model| model.size_m).collect::<Vec<_>>();
    assert!(sides[1][1] == 2.0 && sides[2] == [6.0, 3.0, 0.05], "{sides:?}");
    assert_eq!(loaded.models.iter().map(|(used, _)| *used).collect::<Vec<_>>(), [0, 1, 2].map(ModelUse::Cover));
    assert!(loaded.files.iter().any(|file| file.ends_with("sign.gltf")), "a change of the file reloads the scene: {:?}", loaded.files);

    // Under no box is there grass, and it is there beyond.
    let (scene, extent_m) = (&loaded.scene, loaded.scene.extent_m());
    let is_grass = |at: [f32; 2]| scene.is_grass(loaded.cover.at(at[0], at[1], extent_m));
    let points = || (0..512 * 512).map(|i| [(i % 512) as f32 * 0.25, (i / 512) as f32 * 0.25]);
    let nearest_m2 = |at: [f32; 2]| boxes.iter().map(|own| own.squared_distance_m2(at)).fold(f32::MAX, f32::min);
    let under: Vec<_> = points().filter(|&at| nearest_m2(at) == 0.0).collect();
    assert!(under.len() > 9000 && under.iter().all(|&at| !is_grass(at)), "{} points", under.len());
    assert!(
        points()
            .filter(|&at| nearest_m2(at) > 1.0)
            .all(|at| is_grass(at) || matches!(loaded.cover.at(at[0], at[1], extent_m), Cover::Free(10)))
    );
    // Nor is there underbrush, on either side; without the models there is.
    let flora = stage.world.flora().context("underbrush")?;
    assert!(flora == client.flora().context("underbrush")?);
    let beneath = |flora: &prairie_core::plant::flora::Flora| {
        flora.grown().plants().iter().filter(|plant| nearest_m2(flora.instance(plant).at_m) == 0.0).count()
    };
    let bare = prairie_core::terrain::CoverMap::from_png(&prairie_core::terrain::grey_png([8; 2], &[255; 64]))?;
    let without = prairie_core::plant::flora::Flora::new(&Scene { models: vec![], ..scene.clone() }, &bare, None).context("underbrush")?;
    assert_eq!(beneath(flora), 0);
    assert!(beneath(&without) > 100, "{} plants", beneath(&without));
    Ok(())
}

#[test]
fn a_world_with_models_has_the_same_bits_each_time() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let loaded = scenes::load(farm(folder.path())?)?;
    let run = || -> Result<u64> {
        let mut scene = loaded.scene.clone();
        (scene.objects.self_driving, scene.objects.balls) = (6, 6);
        let mut world = World::new(&scene, loaded.maps())?;
        (0..300).for_each(|_| world.step(&[]));
        Ok(world.checksum())
    };
    assert_eq!(run()?, run()?);
    Ok(())
}
