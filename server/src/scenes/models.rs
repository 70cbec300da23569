//! Models that a scene file names.

use shared::scene::VehicleKind;
use shared::wire::Mesh;
use std::path::Path;

/// Reads the model of a vehicle from a glTF file.
pub(super) fn load(path: &Path, _kind: VehicleKind) -> Result<Mesh, String> {
    let (_document, _buffers, _images) = gltf::import(path).map_err(|error| format!("cannot be read as glTF: {error}"))?;
    Err("is not drawn yet".to_owned())
}
