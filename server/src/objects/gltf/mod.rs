//! Models of vehicles and of the covering map from glTF files.
//!
//! Files are not trusted: sizes, counts and offsets are checked before use.

mod assemble;
mod fit;
mod source;
#[cfg(test)]
mod tests;

pub use fit::stretched;

use fit::fitted;
use prairie_core::scene::MODEL_SIDE_M;
use prairie_core::wire::Mesh;
use source::Source;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Largest model file, and largest total size of a model's buffers (bytes).
pub const FILE_LIMIT: u64 = 32 << 20;

/// Largest number of mesh primitives that the nodes of a model refer to.
pub const PART_LIMIT: usize = 65_536;

/// Error in a model file.
#[derive(Debug, Error)]
#[error("model {} {reason}", path.display())]
pub struct ModelError {
    /// The file.
    pub path: PathBuf,
    /// Problem; continues the sentence after the file's name.
    pub reason: ModelFault,
}

/// Problem of a model file.
#[derive(Debug, Error)]
pub enum ModelFault {
    /// The file cannot be read.
    #[error("cannot be read: {0}")]
    Unreadable(String),
    /// The file is not valid glTF.
    #[error("is not a valid glTF 2.0 file (.glb or .gltf): {0}")]
    NotGltf(String),
    /// A buffer cannot be read.
    #[error("keeps its data in `{uri}`, which {reason}")]
    Buffer {
        /// Location of the buffer.
        uri: String,
        /// Problem of the buffer.
        reason: String,
    },
    /// A node is its own ancestor, or has two parents.
    #[error("places node {0} more than once; each node may have one parent, and none may be its own ancestor")]
    NodeTwice(usize),
    /// The model has no triangles.
    #[error("holds no triangles; at least one mesh of triangles with positions is needed")]
    Empty,
    /// The model is too large.
    #[error("has more than {limit} {what}; at most {limit} are allowed")]
    TooLarge {
        /// Counted items.
        what: &'static str,
        /// Allowed number.
        limit: usize,
    },
    /// Values of the wrong type.
    #[error("holds {what} as {found}; allowed: {allowed}")]
    Kind {
        /// Role of the values.
        what: &'static str,
        /// Shape and type in the file.
        found: String,
        /// Allowed shapes and types.
        allowed: String,
    },
    /// Values outside the data, missing, or sparse.
    #[error("holds {0} values that do not lie one after the other within its data")]
    Outside(&'static str),
    /// Positions that are NaN, infinite or too far apart.
    #[error("has positions that are not finite numbers, or too far apart to be measured")]
    NotFinite,
    /// All positions are equal.
    #[error("has no extent: all its positions are the same")]
    NoExtent,
    /// A side of the box is out of range.
    #[error("is {:.2} m × {:.2} m × {:.2} m large at this `size_m`; allowed: {} to {} m each", .0[0], .0[1], .0[2], MODEL_SIDE_M[0], MODEL_SIDE_M[1])]
    Size([f32; 3]),
    /// An index out of range.
    #[error("refers to vertex {index} of a mesh that has {vertices}")]
    Index {
        /// The index.
        index: u32,
        /// Number of vertices.
        vertices: usize,
    },
}

/// A model.
#[derive(Clone, Debug)]
pub struct Model {
    /// Its mesh.
    pub mesh: Mesh,
    /// Files beside the model that hold its buffers.
    pub buffer_files: Vec<PathBuf>,
}

/// Reads a `.glb` or `.gltf` file as a vehicle's model.
///
/// The mesh consists of the triangles of all meshes of the default scene, normals (computed from the faces where the file has none), and base colours of
/// materials times vertex colours. It is scaled uniformly to fit the box with these half extents (m) and put on its floor. glTF models face +Z; the
/// result faces −Z. At most [`Mesh::VERTEX_LIMIT`] vertices and [`Mesh::INDEX_LIMIT`] indices.
///
/// # Errors
/// [`ModelError`] names the file and its problem.
pub fn read(path: &Path, half_extents_m: [f32; 3]) -> Result<Model, ModelError> {
    let model = |source: Source| {
        let mesh = fitted(source.mesh()?, half_extents_m)?;
        Ok(Model { mesh, buffer_files: source.buffer_files })
    };
    Source::open(path).and_then(model).map_err(|reason| ModelError { path: path.to_owned(), reason })
}

/// Reads a `.glb` or `.gltf` file as [`read`] does, but as a model of the covering map, [`stretched`] to a box; returns the box (m), too.
///
/// # Errors
/// [`ModelError`] names the file and its problem.
pub fn read_stretched(path: &Path, size_m: [f32; 3]) -> Result<(Model, [f32; 3]), ModelError> {
    let model = |source: Source| {
        let (mesh, size_m) = stretched(source.mesh()?, size_m)?;
        Ok((Model { mesh, buffer_files: source.buffer_files }, size_m))
    };
    Source::open(path).and_then(model).map_err(|reason| ModelError { path: path.to_owned(), reason })
}
