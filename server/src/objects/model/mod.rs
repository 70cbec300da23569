//! Models of objects from glTF files.
//!
//! A file may hold anything: how much of it is read, how many parts it has and where its values lie is checked before it is used.

mod assemble;
mod source;
#[cfg(test)]
mod tests;

use glam::Vec3;
use shared::scene::VehicleKind;
use shared::wire::Mesh;
use source::Source;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Largest model file, and most that all buffers of a model hold together (bytes).
pub const FILE_LIMIT: u64 = 32 << 20;

/// Most meshes' primitives that the nodes of a model show.
pub const PART_LIMIT: usize = 65_536;

/// Why a model cannot be used.
#[derive(Debug, Error)]
#[error("model {} {reason}", path.display())]
pub struct ModelError {
    /// The file.
    pub path: PathBuf,
    /// What is wrong with it; reads on after the file's name.
    pub reason: ModelFault,
}

/// What is wrong with a model file.
#[derive(Debug, Error)]
pub enum ModelFault {
    /// The file cannot be read.
    #[error("cannot be read: {0}")]
    Unreadable(String),
    /// The file is no glTF, or says what no glTF may say.
    #[error("is no sound glTF 2.0 file (.glb or .gltf): {0}")]
    NotGltf(String),
    /// A buffer cannot be had.
    #[error("keeps its data in `{uri}`, which {reason}")]
    Buffer {
        /// Where the buffer should be.
        uri: String,
        /// Why it is of no use.
        reason: String,
    },
    /// A node is its own ancestor, or hangs in two places.
    #[error("places node {0} more than once; each node may have one parent, and none may be its own ancestor")]
    NodeTwice(usize),
    /// There is nothing to draw.
    #[error("holds no triangles; at least one mesh of triangles with positions is needed")]
    Empty,
    /// Too much to draw.
    #[error("has more than {limit} {what}; at most {limit} are allowed")]
    TooLarge {
        /// Of what.
        what: &'static str,
        /// How many are allowed.
        limit: usize,
    },
    /// Values of a kind that cannot be what they should be.
    #[error("holds {what} as {found}; allowed: {allowed}")]
    Kind {
        /// Which values.
        what: &'static str,
        /// Shape and type found.
        found: String,
        /// Shapes and types allowed.
        allowed: String,
    },
    /// Values beyond the data, without any, or stored as the differences from others (sparse).
    #[error("holds {0} values that do not lie one after the other within its data")]
    Outside(&'static str),
    /// Numbers that no model should hold.
    #[error("has positions that are not finite numbers, or too far apart to be measured")]
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
/// +Z; ours face −Z. At most [`Mesh::VERTEX_LIMIT`] vertices and [`Mesh::INDEX_LIMIT`] indices.
///
/// # Errors
/// [`ModelError`] names the file and what is wrong with it.
pub fn read(path: &Path, kind: VehicleKind) -> Result<Mesh, ModelError> {
    let source = Source::open(path);
    source
        .and_then(|source| source.mesh())
        .and_then(|mesh| fitted(mesh, kind))
        .map_err(|reason| ModelError { path: path.to_owned(), reason })
}

/// The mesh turned to face −Z, scaled into the kind's box, standing on its floor.
fn fitted(mut mesh: Mesh, kind: VehicleKind) -> Result<Mesh, ModelFault> {
    let turned = |[x, y, z]: [f32; 3]| Vec3::new(-x, y, -z);
    let bounds = |(low, high): (Vec3, Vec3), &position: &[f32; 3]| (low.min(turned(position)), high.max(turned(position)));
    let (low, high) = mesh.positions_m.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), bounds);
    if !(mesh.positions_m.iter().flatten().all(|v| v.is_finite()) && (high - low).is_finite() && (high + low).is_finite()) {
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
