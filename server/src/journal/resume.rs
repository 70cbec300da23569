//! Resumption: the world as it was when the last process ended, or a new one.

use super::error::JournalError;
use super::folder::{Folder, generations};
use super::journaled::JournaledWorld;
use super::player::Player;
use super::{WorldFolder, folder};
use crate::escaped::escaped;
use crate::scenes::LoadedScene;
use crate::world::World;
use std::time::Instant;

/// The world of `scene` that `config` keeps, at the step that it had reached; a new one if there is none. Without a folder, a world without memory.
///
/// # Errors
/// [`JournalError`] when the folder is in use or cannot be written, or the scene's constants contradict each other.
pub fn open(config: Option<&WorldFolder>, scene: &LoadedScene) -> Result<JournaledWorld, JournalError> {
    open_or(config, scene, || World::new(&scene.scene, scene.maps()))
}

/// [`open`] with another way to make a new world.
pub(crate) fn open_or(
    config: Option<&WorldFolder>,
    scene: &LoadedScene,
    new: impl FnOnce() -> Result<World, crate::settings_error::SettingsError>,
) -> Result<JournaledWorld, JournalError> {
    let Some(config) = config else { return Ok(JournaledWorld::from(new()?)) };
    let begun = Instant::now();
    let folder = Folder::open(&config.path, scene)?;
    let newest = generations(folder.path())?.last().copied().unwrap_or(0);
    let Some(mut player) = Player::open(folder.path(), scene, u64::MAX)? else {
        say_that_it_is_new(config, &folder, newest);
        folder.set_aside(1..=newest)?;
        let world = new()?;
        return JournaledWorld::new(world, folder, config.limit_bytes, newest + 1);
    };
    player.recording.faults.iter().for_each(|fault| tracing::warn!("{fault}"));
    let checkpoint = player.world.tick();
    player.advance(u64::MAX);
    let tick = player.world.tick();
    let secs = begun.elapsed().as_secs_f64();
    tracing::info!(folder = escaped(folder.path()), checkpoint, tick, secs, "resumed the world");
    folder.set_aside(player.recording.unusable.iter().copied())?;
    JournaledWorld::new(player.world, folder, config.limit_bytes, newest + 1)
}

/// Logs that a new world begins, and why, if there was another.
fn say_that_it_is_new(config: &WorldFolder, folder: &Folder, newest: u64) {
    let name = escaped(folder.path());
    if newest > 0 {
        tracing::warn!(folder = name, "no checkpoint of the world is valid; beginning anew, and keeping the files");
        return;
    }
    let others = folder::others(&config.path, folder.path());
    match others.last() {
        Some(other) => {
            tracing::info!(folder = name, kept = escaped(other), "the scene has changed; beginning a new world, and keeping the old one")
        }
        None => tracing::info!(folder = name, "beginning a new world"),
    }
}
