//! Hot reload: restarts the world when a file of its scene changes, or a page chooses another scene.

use crate::config::Config;
use crate::escaped::escaped;
use crate::journal::{self, JournaledWorld};
use crate::run::{RunError, run_simulation, run_with_menu};
use crate::scene_menu::{SceneMenu, requested_scene};
use crate::scenes::{self, LoadedScene, SceneError};
use crate::world::World;
use std::path::PathBuf;
use std::pin::pin;
use std::time::{Duration, SystemTime};
use tokio::net::TcpListener;
use tokio::task::JoinError;

/// Time between two checks of the files.
const POLL_PERIOD: Duration = Duration::from_millis(400);

/// Number of checks between attempts to load an invalid scene. It may depend on a file that is not watched because the old scene does not name it.
const POLLS_PER_RETRY: u32 = 5;

/// Serves a scene like [`run`](crate::run()), beginning with its `world`, and restarts whenever one of its files changes and the scene is still valid,
/// or a page that [may do so](Config::pages_change_scene) asks for another scene.
/// Clients get a shutdown notice, and reconnect to the new world on the same socket. The new world is built while the old one runs. The faults of an invalid scene are logged, and the old
/// world continues; so it does after a panic while a scene is loaded or a world built.
///
/// A built-in scene has no files. A recorded scene is neither watched nor changed, since the recording would restart too.
///
/// # Errors
/// As [`run_simulation`].
pub async fn run_and_reload(
    world: impl Into<JournaledWorld>,
    mut config: Config,
    listener: TcpListener,
    shutdown: impl Future<Output = ()>,
) -> Result<(), RunError> {
    let mut world = world.into();
    if config.rerun.is_some() {
        config.scene.nutrients = None;
        return run_simulation(world, config, listener, shutdown).await;
    }
    let (menu, mut requests) = SceneMenu::new(&config.scene, config.pages_change_scene);
    let listener = listener.into_std().map_err(RunError::Socket)?;
    let mut shutdown = pin!(shutdown);
    loop {
        let mut next = None;
        let until = async {
            tokio::select! {
                () = shutdown.as_mut() => {}
                (scene, new) = changed_scene(&config.scene, scenes::load), if !config.scene.files.is_empty() => next = Some((scene, Next::Edited(Box::new(new)))),
                (scene, opened) = requested_scene(&config.scene, config.world.as_ref(), &mut requests) => next = Some((scene, Next::Chosen(Box::new(opened)))),
            }
        };
        let socket = listener.try_clone().and_then(TcpListener::from_std).map_err(RunError::Socket)?;
        run_with_menu(world, running(&config), menu.clone(), socket, until).await?;
        let Some((scene, new)) = next else { return Ok(()) };
        config.scene = scene;
        let name = escaped(&config.scene.name);
        world = match new {
            Next::Edited(new) => {
                tracing::info!(file = name, "the scene has changed; restarting the world");
                reopened(&config, *new).await?
            }
            Next::Chosen(opened) => {
                tracing::info!(scene = name, "a page has chosen another scene");
                *opened
            }
        };
    }
}

/// The world that follows, and what brought it.
enum Next {
    /// A new world of the scene, whose files were edited.
    Edited(Box<World>),
    /// The world of the scene that a page has chosen, as it was kept.
    Chosen(Box<JournaledWorld>),
}

/// The configuration of a run whose world exists: the nutrients are only needed to grow the plants, and possibly large.
fn running(config: &Config) -> Config {
    let mut running = config.clone();
    if running.scene.files.is_empty() {
        running.scene.nutrients = None;
    }
    running
}

/// The world that is kept of the changed scene, or else the new one.
async fn reopened(config: &Config, new: World) -> Result<JournaledWorld, RunError> {
    let (folder, scene) = (config.world.clone(), config.scene.clone());
    if folder.is_none() {
        return Ok(new.into());
    }
    let opening = tokio::task::spawn_blocking(move || {
        let mut new = Some(new);
        let opened = journal::open_or(folder.as_ref(), &scene, || Ok(new.take().expect("asked for once")));
        opened.or_else(|error| match new.take() {
            Some(new) => {
                tracing::error!("{error}; the world of the changed scene is not kept");
                Ok(JournaledWorld::from(new))
            }
            None => Err(error),
        })
    });
    match opening.await {
        Ok(opened) => Ok(opened?),
        Err(_) => Err(RunError::WorldStopped),
    }
}

/// Waits until the files have changed and are valid; returns the new scene and its world.
async fn changed_scene<Load>(now: &LoadedScene, load: Load) -> (LoadedScene, World)
where
    Load: Fn(PathBuf) -> Result<LoadedScene, SceneError> + Copy + Send + 'static,
{
    // Empty, so that the first check reloads the scene: the files may have changed since they were read.
    let mut seen = Vec::new();
    let mut fault = None;
    let mut polls = 0_u32;
    loop {
        tokio::time::sleep(POLL_PERIOD).await;
        polls = polls.wrapping_add(1);
        let newest = stamps(&now.files);
        let retries = fault.is_some() && polls.is_multiple_of(POLLS_PER_RETRY);
        if newest == seen && !retries {
            continue;
        }
        seen = newest;
        let path = now.files[0].clone();
        match tokio::task::spawn_blocking(move || load(path)).await {
            Ok(Ok(scene)) if scene != *now => {
                fault = None;
                if let Some(new) = with_world(scene).await {
                    return new;
                }
            }
            Ok(Ok(_)) => {
                if fault.take().is_some() {
                    tracing::info!(file = escaped(&now.files[0]), "the scene is valid again");
                }
            }
            Ok(Err(error)) => {
                let newest_fault = Some(error.to_string());
                if fault != newest_fault {
                    tracing::warn!("the changed scene is invalid; the old one continues:\n{error}");
                    fault = newest_fault;
                }
            }
            Err(error) => {
                fault = None;
                log_panic(error, "loaded");
            }
        }
    }
}

/// Builds the world of a scene; logs why that fails.
async fn with_world(scene: LoadedScene) -> Option<(LoadedScene, World)> {
    let build = move || World::new(&scene.scene, scene.maps()).map(|world| (scene, world));
    match tokio::task::spawn_blocking(build).await {
        Ok(Ok(new)) => Some(new),
        Ok(Err(error)) => {
            tracing::warn!("the changed scene is invalid; the old one continues: {error}");
            None
        }
        Err(error) => {
            log_panic(error, "built");
            None
        }
    }
}

fn log_panic(error: JoinError, done: &str) {
    let Ok(payload) = error.try_into_panic() else { return };
    let text = payload.downcast_ref::<&str>().copied().or_else(|| payload.downcast_ref::<String>().map(String::as_str));
    tracing::error!("the changed scene cannot be {done} because of a bug in Prairie ({}); the old one continues", text.unwrap_or("panic"));
}

/// Modification time and length of each file; `None` for a missing one.
fn stamps(files: &[PathBuf]) -> Vec<Option<(SystemTime, u64)>> {
    let stamp = |path: &PathBuf| {
        let metadata = std::fs::metadata(path).ok()?;
        Some((metadata.modified().ok()?, metadata.len()))
    };
    files.iter().map(stamp).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicU32, Ordering};

    static LOADS: AtomicU32 = AtomicU32::new(0);

    /// Panics at first, and then loads another scene.
    fn load_with_a_bug(_: PathBuf) -> Result<LoadedScene, SceneError> {
        match LOADS.fetch_add(1, Ordering::SeqCst) {
            0 => panic!("index out of bounds"),
            _ => scenes::load("blades"),
        }
    }

    #[tokio::test]
    async fn a_panic_while_a_scene_is_loaded_ends_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("scene.toml");
        let now = LoadedScene { files: vec![file.clone()], ..scenes::load("shells").unwrap() };
        let edit = async {
            while LOADS.load(Ordering::SeqCst) == 0 {
                tokio::task::yield_now().await;
            }
            std::fs::write(&file, "changed").unwrap();
        };
        let (changed, ()) = tokio::join!(changed_scene(&now, load_with_a_bug), edit);
        assert_eq!((changed.0.name.as_str(), LOADS.load(Ordering::SeqCst)), ("blades", 2));
    }

    static FAULTY_LOADS: AtomicU32 = AtomicU32::new(0);

    /// Fails at first, as if a file that the scene newly names were missing, and then loads another scene.
    fn load_with_a_fault(_: PathBuf) -> Result<LoadedScene, SceneError> {
        match FAULTY_LOADS.fetch_add(1, Ordering::SeqCst) {
            0 => scenes::load("no-such-scene"),
            _ => scenes::load("blades"),
        }
    }

    #[tokio::test]
    async fn an_invalid_scene_is_tried_again_although_no_watched_file_changes() {
        let now = LoadedScene { files: vec!["scene.toml".into()], ..scenes::load("shells").unwrap() };
        let (changed, _) = changed_scene(&now, load_with_a_fault).await;
        assert_eq!((changed.name.as_str(), FAULTY_LOADS.load(Ordering::SeqCst)), ("blades", 2));
    }

    /// Fails at first, and then loads the scene that the test serves.
    fn load_a_mended_scene(path: PathBuf) -> Result<LoadedScene, SceneError> {
        static LOADS: AtomicU32 = AtomicU32::new(0);
        match LOADS.fetch_add(1, Ordering::SeqCst) {
            0 => scenes::load("no-such-scene"),
            _ => Ok(LoadedScene { files: vec![path], ..scenes::load("shells").unwrap() }),
        }
    }

    #[tokio::test]
    async fn the_log_says_when_a_fault_is_mended() {
        let log = tempfile::NamedTempFile::new().unwrap();
        let subscriber = tracing_subscriber::fmt().with_ansi(false).with_writer(log.reopen().map(std::sync::Arc::new).unwrap()).finish();
        let _log = tracing::subscriber::set_default(subscriber);
        let now = LoadedScene { files: vec!["scene.toml".into()], ..scenes::load("shells").unwrap() };
        let mended = async {
            loop {
                let text = std::fs::read_to_string(log.path()).unwrap();
                if text.contains("the scene is valid again") {
                    break text;
                }
                tokio::time::sleep(POLL_PERIOD).await;
            }
        };
        tokio::select! {
            _ = changed_scene(&now, load_a_mended_scene) => panic!("the scene has not changed"),
            text = mended => assert!(text.contains("the changed scene is invalid") && text.contains("file=\"scene.toml\""), "{text}"),
        }
    }
}
