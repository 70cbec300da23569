use super::*;
use prairie_core::scene::{Objects, VehicleKind};
use prairie_core::wire::ModelUse;
use serde_json::{Value, json};

/// One triangle of 2 × 1 m, red, with its buffer inside: positions in the first 36 bytes, then three indices.
fn triangle(indices: [u16; 3]) -> Value {
    let mut bytes: Vec<u8> =
        [[0.0_f32, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0]].iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
    bytes.extend(indices.iter().flat_map(|i| i.to_le_bytes()));
    json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1, "material": 0 }] }],
        "materials": [{ "pbrMetallicRoughness": { "baseColorFactor": [1.0, 0.0, 0.0, 1.0] } }],
        "buffers": [{ "byteLength": 42, "uri": format!("data:application/octet-stream;base64,{}", base64(&bytes)) }],
        "bufferViews": [{ "buffer": 0, "byteLength": 36 }, { "buffer": 0, "byteOffset": 36, "byteLength": 6 }],
        "accessors": [
            { "bufferView": 0, "componentType": F32, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [2, 1, 0] },
            { "bufferView": 1, "componentType": U16, "count": 3, "type": "SCALAR" },
        ],
    })
}

const U8: u32 = 5121;
const U16: u32 = 5123;
const F32: u32 = 5126;

fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let digit = |value: u32| char::from(DIGITS[(value & 63) as usize]);
    let triple = |b: &[u8]| {
        let value = u32::from(b[0]) << 16 | u32::from(b[1]) << 8 | u32::from(b[2]);
        [digit(value >> 18), digit(value >> 12), digit(value >> 6), digit(value)]
    };
    bytes.chunks_exact(3).flat_map(triple).collect()
}

fn half_extents_m(kind: VehicleKind) -> [f32; 3] {
    Objects::default().half_extents_m(kind)
}

fn read_bytes(bytes: &[u8], kind: VehicleKind) -> Result<Mesh, ModelError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("model.gltf");
    std::fs::write(&path, bytes).unwrap();
    read(&path, half_extents_m(kind)).map(|model| model.mesh)
}

/// Error message for the triangle after `spoil`.
fn fault_of(spoil: impl FnOnce(&mut Value)) -> String {
    let mut gltf = triangle([0, 1, 2]);
    spoil(&mut gltf);
    read_bytes(gltf.to_string().as_bytes(), VehicleKind::Car).expect_err("a spoilt file").reason.to_string()
}

#[test]
fn a_model_fits_its_box_and_stands_on_the_floor() {
    let mesh = read_bytes(triangle([0, 1, 2]).to_string().as_bytes(), VehicleKind::Car).expect("a sound file");
    let [x, y, _] = half_extents_m(VehicleKind::Car);
    let xs = mesh.positions_m.iter().map(|p| p[0]);
    let ys = mesh.positions_m.iter().map(|p| p[1]);
    assert!((xs.clone().fold(f32::MIN, f32::max) - 1.9 / 2.0).abs() < 1e-5 && (xs.fold(f32::MAX, f32::min) + x).abs() < 1e-5);
    assert!((ys.fold(f32::MAX, f32::min) + y).abs() < 1e-5);
    assert_eq!(mesh.rgb, [[255, 0, 0]; 3]);
    assert_eq!(mesh.normals, [[0.0, 0.0, -1.0]; 3], "anticlockwise about +Z in the file, turned to −Z");
}

#[test]
fn errors_name_the_file_and_its_buffers() {
    let missing = read(Path::new("no/such/model.glb"), half_extents_m(VehicleKind::Car)).expect_err("there is no such file");
    assert!(missing.to_string().starts_with("model no/such/model.glb cannot be read: No such file"), "{missing}");
    let buffer = |uri: &'static str| fault_of(|gltf| gltf["buffers"][0]["uri"] = json!(uri));
    assert!(buffer("my%20car.bin").starts_with("keeps its data in `my%20car.bin`, which cannot be read: No such file"));
    assert!(buffer("%ff.bin").starts_with("keeps its data in `%ff.bin`, which is not a file name"));
    assert!(buffer("http://elsewhere.example/car.bin").contains("which is elsewhere; allowed: a path relative to the model"));
    assert!(buffer("data:application/octet-stream;base64,?").starts_with("keeps its data in `data:…`, which is not base64"));
}

#[test]
fn invalid_gltf_is_rejected() {
    let fault_of = |bytes: &[u8]| read_bytes(bytes, VehicleKind::Monster).expect_err("no glTF").reason.to_string();
    assert_eq!(fault_of(b"no glTF at all"), "is not a valid glTF 2.0 file (.glb or .gltf): expected ident at line 1 column 2");
    assert_eq!(fault_of(b"glTF\x02\0\0\0"), "is not a valid glTF 2.0 file (.glb or .gltf): it ends too early");
    let mut gltf = triangle([0, 1, 2]);
    gltf["nodes"][0]["mesh"] = json!(7);
    assert!(
        fault_of(gltf.to_string().as_bytes()).contains("nodes[0].mesh is wrong (Index out of bounds)"),
        "{}",
        fault_of(gltf.to_string().as_bytes())
    );
}

#[test]
fn an_accessor_of_positions_that_does_not_exist_is_rejected() {
    let fault = |index: u32| fault_of(move |gltf| gltf["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = json!(index));
    let told = "is not a valid glTF 2.0 file (.glb or .gltf): meshes[0].primitives[0].attributes.POSITION is ";
    assert_eq!(fault(2), format!("{told}2, and there are 2 accessors, numbered from 0"));
    assert_eq!(fault(u32::MAX), format!("{told}4294967295, and there are 2 accessors, numbered from 0"));
}

#[test]
fn a_binary_file_shorter_than_its_header_is_rejected() {
    let told = |length: u32| {
        let bytes = [b"glTF".as_slice(), &2_u32.to_le_bytes(), &length.to_le_bytes(), &[0; 8]].concat();
        read_bytes(&bytes, VehicleKind::Car).expect_err("no glTF").reason.to_string()
    };
    assert_eq!(told(11), "is not a valid glTF 2.0 file (.glb or .gltf): its header states a length of 11 bytes; allowed: at least 12");
    assert_eq!(told(40), "is not a valid glTF 2.0 file (.glb or .gltf): it ends too early");
}

#[test]
fn messages_do_not_repeat_long_values() {
    let long = "x".repeat(100_000);
    let uri = long.clone();
    let buffer = fault_of(move |gltf| gltf["buffers"][0]["uri"] = json!(uri));
    assert!(buffer.len() < 2000 && buffer.contains("x…x") && buffer.contains("which cannot be read: "), "{buffer}");
    let value = fault_of(move |gltf| gltf["meshes"] = json!(long));
    assert!(value.len() < 2000 && value.contains("is not a valid glTF"), "{value}");
}

#[test]
fn nodes_with_two_parents_or_in_a_cycle_are_rejected() {
    let twice = |node: usize| format!("places node {node} more than once; each node may have one parent, and none may be its own ancestor");
    assert_eq!(fault_of(|gltf| gltf["nodes"][0]["children"] = json!([0])), twice(0));
    assert_eq!(fault_of(|gltf| gltf["nodes"] = json!([{ "children": [1] }, { "children": [0] }])), twice(0));
    assert_eq!(fault_of(|gltf| gltf["scenes"][0]["nodes"] = json!([0, 0])), twice(0));
    // Without the check, 2⁴⁰ ways lead to the last node.
    let doubled = |gltf: &mut Value| {
        let chain: Vec<_> = (1..=40).map(|next| json!({ "children": [next, next] })).chain([json!({})]).collect();
        gltf["nodes"] = json!(chain);
    };
    assert_eq!(fault_of(doubled), twice(40));
}

#[test]
fn a_deep_chain_of_nodes_is_read() {
    let mut gltf = triangle([0, 1, 2]);
    let deep = 100_000;
    let chain: Vec<_> = (1..=deep).map(|next| json!({ "children": [next] })).chain([json!({ "mesh": 0 })]).collect();
    gltf["nodes"] = json!(chain);
    assert_eq!(read_bytes(gltf.to_string().as_bytes(), VehicleKind::Car).unwrap().indices, [0, 1, 2]);
}

#[test]
fn values_of_wrong_types_are_rejected() {
    let accessor = |at: usize, data_type: u32, shape: &'static str| {
        fault_of(move |gltf| {
            gltf["accessors"][at]["componentType"] = json!(data_type);
            gltf["accessors"][at]["type"] = json!(shape);
        })
    };
    assert_eq!(accessor(0, U8, "SCALAR"), "holds POSITION as Scalar of U8; allowed: Vec3 of F32");
    assert_eq!(accessor(0, F32, "VEC2"), "holds POSITION as Vec2 of F32; allowed: Vec3 of F32");
    assert_eq!(accessor(1, F32, "SCALAR"), "holds indices as Scalar of F32; allowed: Scalar of U8 or U16 or U32");
    let attribute = |name: &'static str| fault_of(move |gltf| gltf["meshes"][0]["primitives"][0]["attributes"][name] = json!(1));
    assert_eq!(attribute("NORMAL"), "holds NORMAL as Scalar of U16; allowed: Vec3 of F32");
    assert_eq!(attribute("COLOR_0"), "holds COLOR_0 as Scalar of U16; allowed: Vec3 or Vec4 of F32 or U8 or U16");
}

#[test]
fn values_outside_the_data_are_rejected() {
    let outside = "holds POSITION values that do not lie one after the other within its data";
    assert_eq!(fault_of(|gltf| gltf["accessors"][0]["count"] = json!(4)), outside);
    assert_eq!(fault_of(|gltf| gltf["accessors"][0]["count"] = json!(0)), outside);
    assert_eq!(fault_of(|gltf| gltf["accessors"][0]["byteOffset"] = json!(4)), outside);
    assert_eq!(fault_of(|gltf| gltf["accessors"][0]["byteOffset"] = json!(u64::MAX)), outside);
    assert_eq!(fault_of(|gltf| gltf["bufferViews"][0]["byteStride"] = json!(4)), outside);
    assert_eq!(fault_of(|gltf| gltf["bufferViews"][0]["byteOffset"] = json!(42)), outside);
    let short = fault_of(|gltf| gltf["buffers"][0]["byteLength"] = json!(100));
    assert_eq!(short, "is not a valid glTF 2.0 file (.glb or .gltf): buffer 0 is stated to have 100 bytes and has 42");
    let mut beyond = triangle([0, 1, 9]);
    let fault_of = |gltf: &Value| read_bytes(gltf.to_string().as_bytes(), VehicleKind::Car).expect_err("three vertices").reason.to_string();
    assert_eq!(fault_of(&beyond), "refers to vertex 9 of a mesh that has 3");
    beyond["meshes"][0]["primitives"][0]["mode"] = json!(0);
    assert!(fault_of(&beyond).starts_with("holds no triangles"));
}

#[test]
fn positions_that_are_infinite_or_too_far_apart_are_rejected() {
    let far = |scale: f32| fault_of(|gltf| gltf["nodes"][0]["scale"] = json!([scale, scale, scale]));
    assert!(far(2e38).starts_with("has positions that are not finite numbers, or too far apart"), "{}", far(2e38));
    let at = |x: f32| json!({ "mesh": 0, "translation": [x, 0.0, 0.0] });
    let apart = fault_of(|gltf| {
        gltf["scenes"][0]["nodes"] = json!([0, 1]);
        gltf["nodes"] = json!([at(-3e38), at(3e38)]);
    });
    assert!(apart.starts_with("has positions that are not finite numbers, or too far apart"), "{apart}");
}

/// Sides of the box (m) that the triangle of 2 × 1 m is stretched to, and its highest position.
fn stretched_to(size_m: [f32; 3]) -> Result<([f32; 3], [f32; 3]), String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("model.gltf");
    std::fs::write(&path, triangle([0, 1, 2]).to_string()).unwrap();
    let (Model { mesh, .. }, sides_m) = read_stretched(&path, size_m).map_err(|error| error.reason.to_string())?;
    let highest = mesh.positions_m.iter().fold([f32::MIN; 3], |high, at| std::array::from_fn(|axis| high[axis].max(at[axis])));
    Ok((sides_m, highest))
}

#[test]
fn a_model_of_the_covering_map_is_stretched_to_its_size() {
    assert_eq!(stretched_to([0.0; 3]), Ok(([2.0, 1.0, 0.05], [1.0, 0.5, 0.0])));
    assert_eq!(stretched_to([0.0, 4.0, 0.0]), Ok(([8.0, 4.0, 0.05], [4.0, 2.0, 0.0])));
    assert_eq!(stretched_to([3.0, 4.0, 0.0]), Ok(([3.0, 4.0, 0.05], [1.5, 2.0, 0.0])));
    assert_eq!(stretched_to([0.0, 0.0, 1.0]), Ok(([2.0, 1.0, 1.0], [1.0, 0.5, 0.0])), "a flat model has no depth to scale");
    assert_eq!(
        stretched_to([0.0, 16.0, 0.0]),
        Err("is 32.00 m × 16.00 m × 0.05 m large at this `size_m`; allowed: 0.05 to 30 m each".to_owned())
    );
    assert!(stretched_to([0.0, 0.01, 0.0]).unwrap_err().starts_with("is 0.02 m × 0.01 m × 0.05 m large"));
    let equal = Mesh { positions_m: vec![[1.0; 3]; 3], normals: vec![[0.0, 1.0, 0.0]; 3], rgb: vec![[9; 3]; 3], indices: vec![0, 1, 2] };
    let reason = |mesh: &Mesh| stretched(mesh.clone(), [0.0; 3]).expect_err("a spoilt mesh").to_string();
    assert_eq!(reason(&equal), "has no extent: all its positions are the same");
    let with_nan = Mesh { positions_m: vec![[0.0; 3], [1.0; 3], [0.0, f32::NAN, 0.0]], ..equal.clone() };
    assert!(reason(&with_nan).starts_with("has positions that are not finite numbers"));
    let many = Mesh::COVER_VERTEX_LIMIT + 1;
    let many = Mesh { positions_m: vec![[1.0; 3]; many], normals: vec![[0.0; 3]; many], rgb: vec![[0; 3]; many], ..equal };
    assert_eq!(reason(&many), "has more than 8192 vertices; at most 8192 are allowed");
}

#[test]
fn models_that_are_too_large_are_rejected() {
    // Three bytes of indices and one position, drawn many times.
    let shown = |indices: usize, nodes: usize| {
        fault_of(move |gltf| {
            gltf["buffers"][0] = json!({ "byteLength": indices + 36, "uri": format!("data:;base64,{}", "AAAA".repeat(indices / 3 + 12)) });
            gltf["bufferViews"][1] = json!({ "buffer": 0, "byteOffset": 36, "byteLength": indices });
            gltf["accessors"][1] = json!({ "bufferView": 1, "componentType": U8, "count": indices, "type": "SCALAR" });
            gltf["nodes"] = json!(vec![json!({ "mesh": 0 }); nodes]);
            gltf["scenes"][0]["nodes"] = json!((0..nodes).collect::<Vec<_>>());
        })
    };
    assert_eq!(shown(3, 21_846), "has more than 65536 vertices; at most 65536 are allowed");
    assert_eq!(shown(Mesh::INDEX_LIMIT / 3 * 3, 2), "has more than 1048576 indices; at most 1048576 are allowed");
    let points = fault_of(|gltf| {
        let point = json!({ "attributes": { "POSITION": 0 }, "mode": 0 });
        gltf["meshes"][0]["primitives"] = json!(vec![point; PART_LIMIT + 1]);
    });
    assert_eq!(points, "has more than 65536 parts; at most 65536 are allowed");
    let huge = read_bytes(&vec![b' '; FILE_LIMIT as usize + 1], VehicleKind::Car).expect_err("a large file").reason.to_string();
    assert_eq!(huge, "cannot be read: it is larger than 32 MiB");
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("half.bin"), vec![0; FILE_LIMIT as usize / 2 + 1]).unwrap();
    let mut gltf = triangle([0, 1, 2]);
    gltf["buffers"] = json!(vec![json!({ "byteLength": 42, "uri": "half.bin" }); 2]);
    std::fs::write(folder.path().join("model.gltf"), gltf.to_string()).unwrap();
    let buffers = read(&folder.path().join("model.gltf"), half_extents_m(VehicleKind::Car)).expect_err("large buffers").reason.to_string();
    assert_eq!(buffers, "has more than 33554432 bytes in its buffers; at most 33554432 are allowed");
}

#[test]
fn the_largest_models_and_three_maps_fit_into_a_message() {
    let of = |vertices: usize, indices: usize| Mesh {
        positions_m: vec![[f32::MAX; 3]; vertices],
        normals: vec![[f32::MAX; 3]; vertices],
        rgb: vec![[255; 3]; vertices],
        indices: vec![vertices as u32 - 1; indices],
    };
    let mesh = of(Mesh::VERTEX_LIMIT, Mesh::INDEX_LIMIT);
    let scene = crate::scenes::load("meadow").unwrap().scene;
    let map = vec![0; crate::scenes::MAP_LIMIT as usize];
    let placed =
        (0..prairie_core::scene::MODELS_LIMIT as u8).map(|i| (ModelUse::Cover(i), of(Mesh::COVER_VERTEX_LIMIT, Mesh::COVER_INDEX_LIMIT)));
    let vehicles = [(ModelUse::Vehicle(VehicleKind::Car), mesh.clone()), (ModelUse::Vehicle(VehicleKind::Monster), mesh)];
    let models = vehicles.into_iter().chain(placed).collect();
    let message = prairie_core::wire::ServerMessage::Scene {
        scene: Box::new(scene),
        height_png: map.clone(),
        covering_png: map.clone(),
        nutrient_png: map,
        models,
        shapes: Default::default(),
    };
    assert!(prairie_core::wire::encode(&message).len() <= prairie_core::wire::SERVER_MESSAGE_LIMIT);
}
