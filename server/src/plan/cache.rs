//! Plans that were made before, in the user's cache folder.

use super::Plan;
use super::fronts::Fronts;
use crate::file::{read as read_file, write_atomically};
use crate::scenes::OpenScene;
use data_encoding::HEXLOWER;
use ring::digest::{Context, SHA256};
use serde::{Deserialize, Serialize};
use std::io;
use std::path::{Path, PathBuf};

/// Raised when errors or costs are measured otherwise.
const VERSION: u32 = 1;
/// Largest file (bytes).
const FILE_LIMIT: u64 = 1 << 20;

/// A plan in a file beside the copy of its scene file, so that a kept world has the same settings wherever it is played again.
#[derive(Serialize, Deserialize)]
struct Kept {
    /// [`key`] without times.
    scene: String,
    plan: Plan,
}

/// Hash of everything that a plan depends on: scene, maps, stated fields, and with `fronts` the program and its times. Without them it is that of a plan which is kept
/// as data, and holds in later versions with the same fields of a scene.
pub(super) fn key(scene: &OpenScene, fronts: Option<&Fronts>) -> String {
    let mut hash = Context::new(&SHA256);
    let OpenScene { loaded, stated } = scene;
    let texts = [
        loaded.scene.to_toml(),
        stated.join(" "),
        fronts.map_or_else(String::new, |fronts| {
            format!("{VERSION} {} {}", env!("CARGO_PKG_VERSION"), serde_json::to_string(fronts).unwrap_or_default())
        }),
    ];
    for part in texts.iter().map(String::as_bytes).chain([loaded.height_png.as_slice(), &loaded.covering_png]) {
        hash.update(&(part.len() as u64).to_le_bytes());
        hash.update(part);
    }
    HEXLOWER.encode(&hash.finish().as_ref()[..16])
}

fn path(key: &str) -> Option<PathBuf> {
    directories::ProjectDirs::from("", "", "prairie").map(|folders| folders.cache_dir().join("plans").join(format!("{key}.json")))
}

/// The plan that is kept under a key; `None` if there is none that can be read.
pub(super) fn read(key: &str) -> Option<Plan> {
    serde_json::from_slice(&read_file(&path(key)?, FILE_LIMIT).ok()?).ok()
}

/// Keeps a plan. A failure costs no more than the time to plan again.
pub(super) fn write(key: &str, plan: &Plan) {
    let Some(path) = path(key) else { return };
    let written = || {
        std::fs::create_dir_all(path.parent().unwrap_or(&path))?;
        write_atomically(&path, &serde_json::to_vec(plan)?)
    };
    if let Err(error) = written() {
        tracing::warn!("the plan is not kept in {}: {error}", path.display());
    }
}

fn beside(scene_file: &Path) -> PathBuf {
    scene_file.with_extension("plan.json")
}

/// The plan that is kept beside the scene's file; `None` if there is none, or one of another scene or version.
pub(super) fn read_beside(scene: &OpenScene) -> Option<Plan> {
    let bytes = read_file(&beside(scene.loaded.files.first()?), FILE_LIMIT).ok()?;
    let kept: Kept = serde_json::from_slice(&bytes).ok()?;
    (kept.scene == key(scene, None)).then_some(kept.plan)
}

/// Keeps a plan beside a copy of the scene's file.
///
/// # Errors
/// When it cannot be written.
pub(super) fn write_beside(scene: &OpenScene, plan: Plan, scene_file: &Path) -> io::Result<()> {
    write_atomically(&beside(scene_file), &serde_json::to_vec(&Kept { scene: key(scene, None), plan })?)
}
