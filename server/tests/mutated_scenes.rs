//! Whatever a scene file, a map or a model contains: it is loaded, or refused with a message of bounded length. Nothing panics.

#[path = "mutated_scenes/mutate.rs"]
mod mutate;

use mutate::{Edit, edits};
use prairie::objects::gltf::{self, Model};
use prairie::scenes::{self, LoadedScene};
use prairie::world::World;
use prairie_core::grass::wind_drawing::WindDrawing;
use prairie_core::plant::growth::NutrientMap;
use prairie_core::scene::{Objects, Scene, VehicleKind, parse};
use prairie_core::terrain::{CoverMap, HeightMap, grey_png, grey_png_16};
use proptest::prelude::*;
use serde_json::{Value, json};
use std::path::Path;

/// Longest message about one fault (bytes): a value that it repeats, and what is allowed.
const MESSAGE_LIMIT: usize = 5000;

/// A model that uses every part of the reader: two nodes, a transform, normals, colours, indices and a material.
fn model() -> Value {
    let floats = [0.0_f32, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let mut bytes: Vec<u8> = floats.iter().chain(&floats).flat_map(|v| v.to_le_bytes()).collect();
    bytes.extend([255_u8; 12]);
    bytes.extend([0_u16, 1, 2, 0].iter().flat_map(|i| i.to_le_bytes()));
    let uri = format!("data:application/octet-stream;base64,{}", data_encoding::BASE64.encode(&bytes));
    json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0, "children": [1] }, { "mesh": 0, "translation": [1, 0, 0], "scale": [1, -1, 1] }],
        "meshes": [{ "primitives": [{
            "attributes": { "POSITION": 0, "NORMAL": 1, "COLOR_0": 2 }, "indices": 3, "material": 0, "mode": 4
        }] }],
        "materials": [{ "pbrMetallicRoughness": { "baseColorFactor": [1.0, 0.0, 0.0, 1.0] } }],
        "buffers": [{ "byteLength": bytes.len(), "uri": uri }],
        "bufferViews": [
            { "buffer": 0, "byteLength": 36, "byteStride": 12 },
            { "buffer": 0, "byteOffset": 36, "byteLength": 36 },
            { "buffer": 0, "byteOffset": 72, "byteLength": 12 },
            { "buffer": 0, "byteOffset": 84, "byteLength": 8 }
        ],
        "accessors": [
            { "bufferView": 0, "byteOffset": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [2, 1, 0] },
            { "bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC3" },
            { "bufferView": 2, "componentType": 5121, "count": 3, "type": "VEC4", "normalized": true },
            { "bufferView": 3, "componentType": 5123, "count": 3, "type": "SCALAR" }
        ]
    })
}

/// A binary glTF file with this JSON, its lengths as they should be.
fn binary(json: &[u8]) -> Vec<u8> {
    let [whole, part] = [json.len() + 20, json.len()].map(|length| (length as u32).to_le_bytes());
    [b"glTF".as_slice(), &2_u32.to_le_bytes(), &whole, &part, b"JSON", json].concat()
}

fn read_model(bytes: &[u8]) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("model.glb");
    std::fs::write(&path, bytes).unwrap();
    match gltf::read(&path, Objects::default().half_extents_m(VehicleKind::Car)) {
        Ok(Model { mesh, .. }) => {
            assert!(mesh.positions_m.iter().chain(&mesh.normals).flatten().all(|v| v.is_finite()));
            assert!(mesh.indices.iter().all(|&index| (index as usize) < mesh.positions_m.len()));
        }
        Err(error) => assert!(error.reason.to_string().len() < MESSAGE_LIMIT, "{error}"),
    }
    match gltf::read_stretched(&path, [0.0, 3.0, 0.0]) {
        Ok((Model { mesh, .. }, size_m)) => {
            assert!(mesh.positions_m.iter().chain(&mesh.normals).flatten().all(|v| v.is_finite()));
            let reach = |axis: usize| mesh.positions_m.iter().map(|at| at[axis].abs()).fold(0.0, f32::max);
            assert!((0..3).all(|axis| reach(axis) <= 0.501 * size_m[axis]), "{size_m:?}");
        }
        Err(error) => assert!(error.reason.to_string().len() < MESSAGE_LIMIT, "{error}"),
    }
}

/// Every PNG is decoded as each kind of map.
fn read_map(png: &[u8]) {
    let Scene { terrain, .. } = small_scene();
    let results = [
        HeightMap::from_png(png, &terrain).map(|_| ()).map_err(|error| error.to_string()),
        CoverMap::from_png(png).map(|_| ()).map_err(|error| error.to_string()),
        NutrientMap::from_png(png).map(|_| ()).map_err(|error| error.to_string()),
        WindDrawing::from_png(png).map(|_| ()).map_err(|error| error.to_string()),
    ];
    for message in results.into_iter().filter_map(Result::err) {
        assert!(message.len() < MESSAGE_LIMIT, "{message}");
    }
}

fn colour_png(colour: png::ColorType, levels: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 8, 8);
    encoder.set_color(colour);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(levels).unwrap();
    drop(writer);
    bytes
}

/// Maps of every kind that some field takes, and one that none takes.
fn maps() -> [Vec<u8>; 4] {
    let levels: Vec<u8> = (0..=255).collect();
    [
        grey_png([16; 2], &levels),
        grey_png_16([8; 2], &[40_000; 64]),
        colour_png(png::ColorType::Rgb, &levels[64..]),
        colour_png(png::ColorType::Rgba, &levels),
    ]
}

/// A small world with something in every section.
const SCENE: &str = include_str!("mutated_scenes/scene.toml");

fn small_scene() -> Scene {
    parse(SCENE).unwrap_or_else(|faults| panic!("{faults:?}"))
}

/// Writes a scene into `folder`, with the files that it names.
fn write_scene(folder: &Path, text: &[u8]) {
    std::fs::write(folder.join("scene.toml"), text).unwrap();
    std::fs::write(folder.join("height.png"), grey_png([20; 2], &[7; 400])).unwrap();
    std::fs::write(folder.join("covering.png"), grey_png([8; 2], &[255, 0, 1, 2, 253, 254, 255, 3].repeat(8))).unwrap();
    std::fs::write(folder.join("wind.png"), colour_png(png::ColorType::Rgb, &[200; 192])).unwrap();
    std::fs::write(folder.join("model.gltf"), model().to_string()).unwrap();
}

/// Whether the world of a scene is built and stepped in a moment.
fn is_small(LoadedScene { scene, .. }: &LoadedScene) -> bool {
    let cells = scene.wind.cells.iter().product::<u32>();
    let [nx, nz] = scene.patches.count;
    let [sites_x, sites_z] = scene.growth.sites(scene.extent_m());
    cells <= 512 && nx * nz * scene.patches.cells.pow(2) <= 1 << 16 && sites_x * sites_z <= 10_000 && scene.objects.self_driving <= 8
}

fn load_and_step(text: &[u8]) {
    let folder = tempfile::tempdir().unwrap();
    write_scene(folder.path(), text);
    match scenes::load(folder.path().join("scene.toml")) {
        Ok(loaded) if is_small(&loaded) => {
            if let Ok(mut world) = World::new(&loaded.scene, loaded.maps()) {
                (0..3).for_each(|_| world.step(&[]));
                world.snapshot();
            }
        }
        Ok(_) => {}
        Err(scenes::SceneError::Faulty(faulty)) => {
            assert!(faulty.faults.iter().all(|fault| fault.to_string().len() < MESSAGE_LIMIT), "{faulty}");
        }
        Err(error) => assert!(error.to_string().len() < MESSAGE_LIMIT, "{error}"),
    }
}

proptest! {
    #[test]
    fn mutated_models_are_read_or_refused(edits in edits(), bytes in prop::collection::vec((0_usize..100, any::<u8>()), 0..3), in_binary: bool) {
        let mut model = model();
        edits.iter().for_each(|edit| mutate::json(&mut model, edit));
        let text = model.to_string().into_bytes();
        let mut file = if in_binary { binary(&text) } else { text };
        for (at, byte) in bytes {
            let at = at % file.len();
            file[at] = byte;
        }
        read_model(&file);
    }

    #[test]
    fn mutated_maps_are_decoded_or_refused(map in 0_usize..4, edits in edits()) {
        let mut png = maps()[map].clone();
        edits.iter().for_each(|edit| mutate::png(&mut png, edit));
        read_map(&png);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn mutated_scenes_are_run_or_refused(edits in edits()) {
        let mut text = SCENE.as_bytes().to_vec();
        edits.iter().for_each(|edit| mutate::lines(&mut text, edit));
        load_and_step(&text);
    }
}

/// Deep enough to overflow the stack of a recursion without a limit.
#[test]
fn deep_nesting_is_refused() {
    const DEPTH: usize = 250_000;
    let texts = [
        "a.".repeat(DEPTH) + "a = 1\n",
        format!("[{}a]\n", "a.".repeat(DEPTH)),
        format!("a = {}\n", "[".repeat(DEPTH)),
        format!("a = {}\n", "{ a = ".repeat(DEPTH / 4)),
    ];
    for text in texts {
        assert!(parse(&format!("{text}{SCENE}")).is_err(), "{}", &text[..20]);
    }
    read_model(format!("{{ \"extras\": {}", "[".repeat(DEPTH)).as_bytes());
}

#[test]
fn a_buffer_beside_a_model_is_a_file_of_the_scene() {
    let folder = tempfile::tempdir().unwrap();
    write_scene(folder.path(), SCENE.as_bytes());
    let mut model = model();
    let uri = model["buffers"][0]["uri"].take();
    let digits = uri.as_str().and_then(|uri| uri.split_once(";base64,")).expect("data").1;
    std::fs::write(folder.path().join("model.bin"), data_encoding::BASE64.decode(digits.as_bytes()).unwrap()).unwrap();
    model["buffers"][0]["uri"] = "model.bin".into();
    std::fs::write(folder.path().join("model.gltf"), model.to_string()).unwrap();
    let loaded = scenes::load(folder.path().join("scene.toml")).unwrap_or_else(|error| panic!("{error}"));
    for name in ["model.gltf", "model.bin"] {
        assert!(loaded.files.contains(&folder.path().join(name)), "{name} is not among {:?}", loaded.files);
    }
}

#[test]
fn the_unchanged_files_are_valid() {
    let folder = tempfile::tempdir().unwrap();
    write_scene(folder.path(), SCENE.as_bytes());
    let loaded = scenes::load(folder.path().join("scene.toml")).unwrap_or_else(|error| panic!("{error}"));
    assert!(is_small(&loaded) && loaded.models.len() == 2 && loaded.drawings.len() == 1);
    let path = folder.path().join("model.glb");
    for bytes in [model().to_string().into_bytes(), binary(model().to_string().as_bytes())] {
        std::fs::write(&path, bytes).unwrap();
        assert_eq!(gltf::read(&path, [1.0; 3]).unwrap_or_else(|error| panic!("{error}")).mesh.indices.len(), 6);
    }
    for (png, kind) in maps().iter().zip(0..) {
        let mut mended = png.clone();
        mutate::png(&mut mended, &Edit { at: 0, action: u8::MAX, value: 0 });
        assert_eq!(*png, mended, "the checksums of map {kind}");
    }
}
