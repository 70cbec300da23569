//! Stand-in.
#![allow(missing_docs)]
use shared::scene::{Scene, VehicleKind};
use shared::terrain::{CoverMap, HeightMap};
use shared::wire::Mesh;
#[derive(Clone, Debug)]
pub struct LoadedScene {
    pub scene: Scene,
    pub height_png: Vec<u8>,
    pub covering_png: Vec<u8>,
    pub height: HeightMap,
    pub cover: CoverMap,
    pub models: Vec<(VehicleKind, Mesh)>,
}
#[derive(Debug, thiserror::Error)]
#[error("stand-in")]
pub struct SceneError;
pub fn load(_: &str) -> Result<LoadedScene, SceneError> {
    Err(SceneError)
}
pub fn list() -> Vec<(String, String)> {
    Vec::new()
}
