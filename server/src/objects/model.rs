//! Models of objects from glTF files.

use glam::{Mat3, Mat4, Vec3};
use shared::scene::VehicleKind;
use shared::wire::Mesh;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Most vertices of a model.
pub const VERTEX_LIMIT: usize = 65_536;

/// Why a model cannot be used.
#[derive(Debug, Error)]
#[error("model {}: {reason}", path.display())]
pub struct ModelError {
    /// The file.
    pub path: PathBuf,
    /// What is wrong with it.
    pub reason: ModelFault,
}

/// What is wrong with a model file.
#[derive(Debug, Error)]
pub enum ModelFault {
    /// The file or one it refers to cannot be read, or is no glTF.
    #[error("cannot be read as glTF: {0}")]
    Unreadable(#[from] gltf::Error),
    /// There is nothing to draw.
    #[error("holds no triangles; at least one mesh of triangles with positions is needed")]
    Empty,
    /// Too much to draw.
    #[error("has more than {VERTEX_LIMIT} vertices; at most {VERTEX_LIMIT} are allowed")]
    TooLarge,
    /// A number that no file should hold.
    #[error("has a position that is not a finite number")]
    NotFinite,
    /// An index beyond the vertices.
    #[error("refers to vertex {index} of a mesh that has {vertices}")]
    Index {
        /// The index found.
        index: u32,
        /// Vertices there are.
        vertices: usize,
    },
}

/// Reads a `.glb` or `.gltf` file as the model of `kind`: triangles of all meshes of the default scene in their places, normals (made
/// from the faces where the file has none), and the base colours of materials times the colours of vertices. The model is moved and
/// scaled, by the same factor along all axes, to fill the kind's box as far as it fits; it stands on the box's floor. glTF models face
/// +Z; ours face −Z.
///
/// # Errors
/// [`ModelError`] names the file and what is wrong with it.
pub fn read(path: &Path, kind: VehicleKind) -> Result<Mesh, ModelError> {
    load(path).and_then(|mesh| fitted(mesh, kind)).map_err(|reason| ModelError { path: path.to_owned(), reason })
}

fn load(path: &Path) -> Result<Mesh, ModelFault> {
    let gltf = gltf::Gltf::open(path)?;
    let base = path.parent().unwrap_or(Path::new("."));
    let buffers = gltf::import_buffers(&gltf.document, Some(base), gltf.blob)?;
    let scene = gltf.document.default_scene().or_else(|| gltf.document.scenes().next()).ok_or(ModelFault::Empty)?;
    let mut mesh = Mesh::default();
    let mut pending: Vec<_> = scene.nodes().map(|node| (node, Mat4::IDENTITY)).collect();
    while let Some((node, parent)) = pending.pop() {
        let place = parent * Mat4::from_cols_array_2d(&node.transform().matrix());
        for primitive in node.mesh().into_iter().flat_map(|mesh| mesh.primitives()) {
            if primitive.mode() == gltf::mesh::Mode::Triangles {
                append(&mut mesh, &primitive, &buffers, place)?;
            }
        }
        pending.extend(node.children().map(|child| (child, place)));
    }
    if mesh.indices.is_empty() { Err(ModelFault::Empty) } else { Ok(mesh) }
}

fn append(mesh: &mut Mesh, primitive: &gltf::Primitive<'_>, buffers: &[gltf::buffer::Data], place: Mat4) -> Result<(), ModelFault> {
    let reader = primitive.reader(|buffer| buffers.get(buffer.index()).map(|data| data.0.as_slice()));
    let Some(positions) = reader.read_positions() else { return Ok(()) };
    let positions: Vec<_> = positions.map(|position| place.transform_point3(Vec3::from_array(position))).collect();
    if mesh.positions_m.len() + positions.len() > VERTEX_LIMIT {
        return Err(ModelFault::TooLarge);
    }
    let vertices = positions.len();
    let indices: Vec<u32> = match reader.read_indices() {
        Some(indices) => indices.into_u32().collect(),
        None => (0..vertices as u32).collect(),
    };
    if let Some(&index) = indices.iter().find(|&&index| index as usize >= vertices) {
        return Err(ModelFault::Index { index, vertices });
    }
    let triangles = || indices.chunks_exact(3).map(|triangle| [triangle[0], triangle[1], triangle[2]]);
    // A mirrored mesh is turned inside out by its transform.
    let mirrored = place.determinant() < 0.0;

    let normals: Vec<Vec3> = match reader.read_normals() {
        Some(normals) => {
            let turn = Mat3::from_mat4(place).inverse().transpose();
            normals.map(|normal| (turn * Vec3::from_array(normal)).normalize_or(Vec3::Y)).collect()
        }
        None => face_normals(&positions, triangles(), mirrored),
    };
    let [r, g, b, _] = primitive.material().pbr_metallic_roughness().base_color_factor();
    let base = Vec3::new(r, g, b);
    let mut tints = reader.read_colors(0).map(|colours| colours.into_rgb_f32());
    let colour = |tint: [f32; 3]| (base * Vec3::from_array(tint)).to_array().map(|c| (c * 255.0 + 0.5).clamp(0.0, 255.0) as u8);

    let first = mesh.positions_m.len() as u32;
    mesh.indices.extend(triangles().flat_map(|[a, b, c]| if mirrored { [a, c, b] } else { [a, b, c] }).map(|index| first + index));
    for (vertex, position) in positions.into_iter().enumerate() {
        mesh.positions_m.push(position.to_array());
        mesh.normals.push(normals.get(vertex).copied().unwrap_or(Vec3::Y).to_array());
        mesh.rgb.push(colour(tints.as_mut().and_then(Iterator::next).unwrap_or([1.0; 3])));
    }
    Ok(())
}

fn face_normals(positions: &[Vec3], triangles: impl Iterator<Item = [u32; 3]>, mirrored: bool) -> Vec<Vec3> {
    let mut normals = vec![Vec3::ZERO; positions.len()];
    let side = if mirrored { -1.0 } else { 1.0 };
    for triangle in triangles {
        let [a, b, c] = triangle.map(|index| positions[index as usize]);
        let area = (b - a).cross(c - a) * side;
        triangle.iter().for_each(|&index| normals[index as usize] += area);
    }
    normals.into_iter().map(|normal| normal.normalize_or(Vec3::Y)).collect()
}

/// The mesh turned to face −Z, scaled into the kind's box, standing on its floor.
fn fitted(mut mesh: Mesh, kind: VehicleKind) -> Result<Mesh, ModelFault> {
    let turned = |[x, y, z]: [f32; 3]| Vec3::new(-x, y, -z);
    let bounds = |(low, high): (Vec3, Vec3), &position: &[f32; 3]| (low.min(turned(position)), high.max(turned(position)));
    let (low, high) = mesh.positions_m.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), bounds);
    if !mesh.positions_m.iter().flatten().all(|v| v.is_finite()) {
        return Err(ModelFault::NotFinite);
    }
    let half = Vec3::from_array(kind.half_extents_m());
    let scale = (2.0 * half / (high - low).max(Vec3::splat(1e-6))).min_element();
    let foot = Vec3::new(0.5 * (low.x + high.x), low.y, 0.5 * (low.z + high.z));
    for position in &mut mesh.positions_m {
        *position = ((turned(*position) - foot) * scale - Vec3::Y * half.y).to_array();
    }
    for normal in &mut mesh.normals {
        *normal = turned(*normal).to_array();
    }
    Ok(mesh)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A quarter of a box's floor: one triangle of 2 × 1 m, red, as a text glTF with its buffer inside.
    fn triangle(indices: [u16; 3]) -> String {
        let mut bytes: Vec<u8> =
            [[0.0_f32, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0]].iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
        bytes.extend(indices.iter().flat_map(|i| i.to_le_bytes()));
        let data = base64(&bytes);
        format!(
            r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],
            "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1,"material":0}}]}}],
            "materials":[{{"pbrMetallicRoughness":{{"baseColorFactor":[1.0,0.0,0.0,1.0]}}}}],
            "buffers":[{{"byteLength":42,"uri":"data:application/octet-stream;base64,{data}"}}],
            "bufferViews":[{{"buffer":0,"byteLength":36}},{{"buffer":0,"byteOffset":36,"byteLength":6}}],
            "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[2,1,0]}},
            {{"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}}]}}"#
        )
    }

    fn base64(bytes: &[u8]) -> String {
        const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        let digit = |value: u32| char::from(DIGITS[(value & 63) as usize]);
        let triple = |b: &[u8]| {
            let value = u32::from(b[0]) << 16 | u32::from(b[1]) << 8 | u32::from(b[2]);
            [digit(value >> 18), digit(value >> 12), digit(value >> 6), digit(value)]
        };
        bytes.chunks_exact(3).flat_map(triple).collect()
    }

    fn written(name: &str, text: &str) -> PathBuf {
        let path = std::env::temp_dir().join(format!("prairie-{}-{name}", std::process::id()));
        std::fs::write(&path, text).expect("the temporary folder can be written to");
        path
    }

    #[test]
    fn a_model_fills_its_box_and_stands_on_the_floor() {
        let path = written("triangle.gltf", &triangle([0, 1, 2]));
        let mesh = read(&path, VehicleKind::Car).expect("a sound file");
        std::fs::remove_file(path).expect("it was just written");
        let [x, y, _] = VehicleKind::Car.half_extents_m();
        let xs = mesh.positions_m.iter().map(|p| p[0]);
        let ys = mesh.positions_m.iter().map(|p| p[1]);
        assert!((xs.clone().fold(f32::MIN, f32::max) - 1.9 / 2.0).abs() < 1e-5 && (xs.fold(f32::MAX, f32::min) + x).abs() < 1e-5);
        assert!((ys.fold(f32::MAX, f32::min) + y).abs() < 1e-5);
        assert_eq!(mesh.rgb, [[255, 0, 0]; 3]);
        assert_eq!(mesh.normals, [[0.0, 0.0, -1.0]; 3], "anticlockwise about +Z in the file, turned to −Z");
    }

    #[test]
    fn faults_name_the_file() {
        let missing = read(Path::new("no/such/model.glb"), VehicleKind::Car).expect_err("there is no such file");
        assert!(missing.to_string().contains("no/such/model.glb"), "{missing}");
        let path = written("index.gltf", &triangle([0, 1, 9]));
        let index = read(&path, VehicleKind::Monster).expect_err("there are three vertices");
        std::fs::remove_file(&path).expect("it was just written");
        assert!(index.to_string().contains("vertex 9"), "{index}");
        let path = written("text.gltf", "no glTF at all");
        let text = read(&path, VehicleKind::Monster).expect_err("not JSON");
        std::fs::remove_file(path).expect("it was just written");
        assert!(text.to_string().contains("cannot be read as glTF"), "{text}");
    }
}
