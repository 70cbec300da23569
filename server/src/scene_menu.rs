//! Requests of pages for another scene, which the running server changes to.

use crate::escaped::escaped;
use crate::journal::{self, JournaledWorld, WorldFolder};
use crate::scenes::{self, LoadedScene, SceneDescription};
use std::path::PathBuf;
use std::sync::Arc;
use thiserror::Error;
use tokio::sync::{Semaphore, mpsc, oneshot};

/// The scenes that pages can ask for, and the way to ask.
#[derive(Clone, Debug)]
pub(crate) struct SceneMenu {
    /// The scene file with which the server was started, if it was one.
    own: Option<OwnScene>,
    /// `None` where pages may not change the scene.
    requests: Option<mpsc::Sender<SceneRequest>>,
    /// Held from a request to its answer.
    turn: Arc<Semaphore>,
}

/// A scene file in the menu.
#[derive(Clone, Debug)]
struct OwnScene {
    description: SceneDescription,
    path: PathBuf,
}

/// A request for a scene. The page gets the answer when the scene's world is ready, and before the running one ends.
#[derive(Debug)]
pub(crate) struct SceneRequest {
    scene: PathBuf,
    answer: oneshot::Sender<Result<(), String>>,
}

/// Reasons why the scene is not changed.
#[derive(Debug, Error)]
pub(crate) enum ChangeError {
    /// Pages may not change the scene.
    #[error("pages may not change the scene of this server; `--change-scene everyone` at its start lets them")]
    NotAllowed,
    /// The menu has no such scene.
    #[error("`name` is \"{name}\"; allowed: {}", .known.join(", "))]
    Unknown {
        /// The start of the requested name.
        name: String,
        /// Names in the menu.
        known: Vec<String>,
    },
    /// Another change is under way.
    #[error("the scene is already being changed; try again in a few seconds")]
    Busy,
    /// The server stops before the change.
    #[error("the server is stopping")]
    Stopping,
    /// The scene cannot be loaded or its world cannot be opened.
    #[error("the scene cannot be started: {0}")]
    Failed(String),
}

impl SceneMenu {
    /// A menu for a server that begins with a scene, and the requests from it. Without `is_open`, every request is refused.
    pub(crate) fn new(first: &LoadedScene, is_open: bool) -> (Self, mpsc::Receiver<SceneRequest>) {
        let own =
            first.files.first().map(|path| OwnScene { description: SceneDescription::of(&first.name, &first.scene), path: path.clone() });
        let (sender, requests) = mpsc::channel(1);
        (Self { own, requests: is_open.then_some(sender), turn: Arc::new(Semaphore::new(1)) }, requests)
    }

    /// Whether pages may change the scene.
    pub(crate) fn is_open(&self) -> bool {
        self.requests.is_some()
    }

    /// Descriptions of the scenes: the server's own file first, then the built-in ones of other names.
    pub(crate) fn scenes(&self) -> impl Iterator<Item = &SceneDescription> {
        let own = self.own.iter().map(|own| &own.description);
        let is_other = |scene: &&SceneDescription| self.own.as_ref().is_none_or(|own| own.description.name != scene.name);
        own.chain(scenes::catalogue().iter().filter(is_other))
    }

    /// Asks for a scene by its name, and waits until its world is ready.
    ///
    /// # Errors
    /// [`ChangeError`].
    pub(crate) async fn change(&self, name: &str) -> Result<(), ChangeError> {
        let requests = self.requests.as_ref().ok_or(ChangeError::NotAllowed)?;
        let scene = match &self.own {
            Some(own) if own.description.name == name => own.path.clone(),
            _ if scenes::catalogue().iter().any(|scene| scene.name == name) => PathBuf::from(name),
            _ => {
                let known = self.scenes().map(|scene| scene.name.clone()).collect();
                return Err(ChangeError::Unknown { name: name.chars().take(64).collect::<String>().escape_debug().to_string(), known });
            }
        };
        let (answer, answered) = oneshot::channel();
        let _turn = self.turn.try_acquire().map_err(|_| ChangeError::Busy)?;
        requests.send(SceneRequest { scene, answer }).await.map_err(|_| ChangeError::Stopping)?;
        answered.await.map_err(|_| ChangeError::Stopping)?.map_err(ChangeError::Failed)
    }
}

/// Waits for a request for another scene than the running one, and opens its world, kept in `folder`, while that one runs.
pub(crate) async fn requested_scene(
    running: &LoadedScene,
    folder: Option<&WorldFolder>,
    requests: &mut mpsc::Receiver<SceneRequest>,
) -> (LoadedScene, JournaledWorld) {
    while let Some(SceneRequest { scene, answer }) = requests.recv().await {
        let is_running = running.files.first().map_or_else(|| scene.as_os_str() == running.name.as_str(), |file| *file == scene);
        // A page that has gone gets no answer, and the scene changes all the same.
        if is_running {
            let _ = answer.send(Ok(()));
            continue;
        }
        let name = escaped(&scene);
        let folder = folder.cloned();
        let opening = tokio::task::spawn_blocking(move || open(scene, folder.as_ref()));
        match opening.await.unwrap_or_else(|_| Err("a bug in Prairie, which the log describes".to_owned())) {
            Ok(opened) => {
                let _ = answer.send(Ok(()));
                return opened;
            }
            Err(reason) => {
                tracing::warn!(scene = name, "the scene that a page asks for cannot be started; the old one continues: {reason}");
                let _ = answer.send(Err(reason));
            }
        }
    }
    std::future::pending().await
}

fn open(scene: PathBuf, folder: Option<&WorldFolder>) -> Result<(LoadedScene, JournaledWorld), String> {
    let scene = scenes::load(scene).map_err(|error| error.to_string())?;
    let world = journal::open(folder, &scene).map_err(|error| error.to_string())?;
    Ok((scene, world))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn only_scenes_of_the_menu_are_asked_for_and_one_at_a_time() {
        let (menu, mut requests) = SceneMenu::new(&scenes::load("shells").unwrap(), true);
        let unknown = menu.change("../strom\n").await.unwrap_err().to_string();
        assert!(unknown.starts_with("`name` is \"../strom\\n\"; allowed: meadow, jacksboro, "), "{unknown}");
        let answered = async {
            let request = requests.recv().await.unwrap();
            assert_eq!(request.scene.as_os_str(), "blades");
            // The scene is being opened.
            assert!(matches!(menu.change("storm").await, Err(ChangeError::Busy)));
            let _ = request.answer.send(Err("the disk is full".to_owned()));
        };
        let (first, ()) = tokio::join!(menu.change("blades"), answered);
        assert_eq!(first.unwrap_err().to_string(), "the scene cannot be started: the disk is full");
        drop(requests);
        assert!(matches!(menu.change("storm").await, Err(ChangeError::Stopping)), "the turn has ended");
    }

    #[tokio::test]
    async fn a_closed_menu_lists_scenes_and_refuses_to_change() {
        let (menu, _requests) = SceneMenu::new(&scenes::load("shells").unwrap(), false);
        assert!(!menu.is_open() && menu.scenes().count() == scenes::list().count());
        assert!(matches!(menu.change("blades").await, Err(ChangeError::NotAllowed)));
    }

    #[tokio::test]
    async fn a_scene_file_of_ones_own_can_be_returned_to() {
        let folder = tempfile::tempdir().unwrap();
        let file = scenes::create(&folder.path().join("hill"), None).unwrap().remove(0);
        let own = scenes::load(&file).unwrap();
        let (menu, mut requests) = SceneMenu::new(&own, true);
        assert_eq!(menu.scenes().next().unwrap().name, own.name);
        let namesake = LoadedScene { name: "shells".to_owned(), ..own.clone() };
        assert_eq!(SceneMenu::new(&namesake, true).0.scenes().filter(|scene| scene.name == "shells").count(), 1);
        let running = scenes::load("shells").unwrap();
        let (changed, (scene, _)) = tokio::join!(menu.change(&own.name), requested_scene(&running, None, &mut requests));
        assert!(changed.is_ok() && scene.files[0] == file);
    }

    #[tokio::test]
    async fn the_running_scene_is_not_started_again() {
        let running = scenes::load("shells").unwrap();
        let (menu, mut requests) = SceneMenu::new(&running, true);
        tokio::select! {
            changed = menu.change("shells") => assert!(changed.is_ok()),
            _ = requested_scene(&running, None, &mut requests) => panic!("it starts again"),
        }
    }
}
