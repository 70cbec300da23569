//! A world that begins anew when its scene's files change, so that a species or a map is edited and looked at.

use crate::scenes::{self, LoadedScene, SceneError};
use crate::{Config, RunError, run};
use std::path::PathBuf;
use std::pin::pin;
use std::time::{Duration, SystemTime};
use tokio::net::TcpListener;

/// Time between two looks at the files.
const LOOK_EVERY: Duration = Duration::from_millis(400);

/// Serves a scene as [`run`] does, and anew whenever one of its files has changed and it is sound. Clients are told that the server stops, and find the new
/// world on the same socket. What is wrong with a scene that is not sound goes to the log, and the old world goes on.
///
/// A built-in scene has no files; a recording would begin anew, too, so a scene that is recorded is not looked at.
///
/// # Errors
/// As [`run`].
pub async fn run_and_reload(mut config: Config, listener: TcpListener, shutdown: impl Future<Output = ()>) -> Result<(), RunError> {
    if config.scene.files.is_empty() || config.rerun.is_some() {
        return run(config, listener, shutdown).await;
    }
    let listener = listener.into_std().map_err(RunError::Socket)?;
    let mut shutdown = pin!(shutdown);
    loop {
        let mut changed = None;
        let until = async {
            tokio::select! {
                () = shutdown.as_mut() => {}
                scene = next(&config.scene) => changed = Some(scene),
            }
        };
        let socket = listener.try_clone().and_then(TcpListener::from_std).map_err(RunError::Socket)?;
        run(config.clone(), socket, until).await?;
        let Some(scene) = changed else { return Ok(()) };
        tracing::info!(file = %scene.files[0].display(), "the scene has changed: the world begins anew");
        config.scene = scene;
    }
}

/// The scene once its files make another one that is sound.
async fn next(now: &LoadedScene) -> LoadedScene {
    // The first look reads them again, for they may have changed since they were read.
    let mut seen = Vec::new();
    loop {
        tokio::time::sleep(LOOK_EVERY).await;
        let newest = looks(&now.files);
        if newest == seen {
            continue;
        }
        seen = newest;
        match load(now.files[0].clone()).await {
            Ok(scene) if scene != *now => return scene,
            Ok(_) => {}
            Err(error) => tracing::warn!("the scene has changed, and the old one goes on:\n{error}"),
        }
    }
}

/// What tells a file from its older self; none for one that is missing.
fn looks(files: &[PathBuf]) -> Vec<Option<(SystemTime, u64)>> {
    let look = |path: &PathBuf| {
        let metadata = std::fs::metadata(path).ok()?;
        Some((metadata.modified().ok()?, metadata.len()))
    };
    files.iter().map(look).collect()
}

async fn load(scene: PathBuf) -> Result<LoadedScene, SceneError> {
    let loading = tokio::task::spawn_blocking(move || scenes::load(&scene.to_string_lossy()));
    loading.await.unwrap_or_else(|panic| std::panic::resume_unwind(panic.into_panic()))
}
