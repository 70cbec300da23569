//! Hot reload: restarts the world when a file of its scene changes.

use crate::config::Config;
use crate::escaped::escaped;
use crate::run::{RunError, run};
use crate::scenes::{self, LoadedScene, SceneError};
use std::path::PathBuf;
use std::pin::pin;
use std::time::{Duration, SystemTime};
use tokio::net::TcpListener;

/// Time between two checks of the files.
const POLL_PERIOD: Duration = Duration::from_millis(400);

/// Serves a scene like [`run`], and restarts whenever one of its files changes and the scene is still valid. Clients get a shutdown notice, and
/// reconnect to the new world on the same socket. The faults of an invalid scene are logged, and the old world continues.
///
/// A built-in scene has no files. A recorded scene is not watched, since the recording would restart too.
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
                scene = changed_scene(&config.scene) => changed = Some(scene),
            }
        };
        let socket = listener.try_clone().and_then(TcpListener::from_std).map_err(RunError::Socket)?;
        run(config.clone(), socket, until).await?;
        let Some(scene) = changed else { return Ok(()) };
        tracing::info!(file = escaped(&scene.files[0]), "the scene has changed; restarting the world");
        config.scene = scene;
    }
}

/// Waits until the files have changed and are valid; returns the new scene.
async fn changed_scene(now: &LoadedScene) -> LoadedScene {
    // Empty, so that the first check reloads the scene: the files may have changed since they were read.
    let mut seen = Vec::new();
    loop {
        tokio::time::sleep(POLL_PERIOD).await;
        let newest = stamps(&now.files);
        if newest == seen {
            continue;
        }
        seen = newest;
        match load(now.files[0].clone()).await {
            Ok(scene) if scene != *now => return scene,
            Ok(_) => {}
            Err(error) => tracing::warn!("the changed scene is invalid; the old one continues:\n{error}"),
        }
    }
}

/// Modification time and length of each file; `None` for a missing one.
fn stamps(files: &[PathBuf]) -> Vec<Option<(SystemTime, u64)>> {
    let stamp = |path: &PathBuf| {
        let metadata = std::fs::metadata(path).ok()?;
        Some((metadata.modified().ok()?, metadata.len()))
    };
    files.iter().map(stamp).collect()
}

async fn load(scene: PathBuf) -> Result<LoadedScene, SceneError> {
    let loading = tokio::task::spawn_blocking(move || scenes::load(&scene));
    loading.await.unwrap_or_else(|panic| std::panic::resume_unwind(panic.into_panic()))
}
