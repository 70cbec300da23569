//! A recording as a simulation that people can watch.

use super::error::JournalError;
use super::folder::find;
use super::player::Player;
use super::source::SceneSource;
use crate::runner::Simulation;
use crate::scenes::LoadedScene;
use crate::snapshot::{PatchQuantiser, Snapshot};
use crate::world::Command;
use prairie_core::grass::BendState;
use prairie_core::wire::ObjectId;
use std::path::Path;

/// A player in real time, or faster or slower. Viewers cannot change anything; at its end the world stands still.
pub struct Replay {
    player: Player,
    speed: f64,
    /// Steps that are due, as a fraction.
    due: f64,
    says_end: bool,
}

impl Replay {
    /// Plays `speed` steps for each one that the clock asks for.
    pub fn new(player: Player, speed: f64) -> Self {
        Self { player, speed, due: 0.0, says_end: true }
    }
}

impl Simulation for Replay {
    fn step(&mut self, _commands: &[Command]) {
        self.due += self.speed;
        while self.due >= 1.0 {
            self.due -= 1.0;
            if !self.player.step() && std::mem::take(&mut self.says_end) {
                tracing::info!(tick = self.player.world.tick(), "the end of the recording");
            }
        }
    }

    fn bend_state(&self) -> Option<BendState> {
        self.player.world.bend_state()
    }

    fn publish(&self, quantiser: &mut PatchQuantiser) -> Snapshot {
        self.player.world.publish(quantiser)
    }

    fn object_of(&self, _client: u32) -> Option<ObjectId> {
        None
    }

    fn tick(&self) -> u64 {
        self.player.world.tick()
    }

    fn first_client(&self) -> u32 {
        // Not the number of anyone in the recording, whose camera would be taken for a viewer's.
        self.player.world.newest_client().saturating_add(1 << 20)
    }
}

/// The scene and the recording of the world in `path`, or in its only sub-folder with a world: from the simulated time `from_secs`, or from the oldest state that
/// is kept. A running server may go on writing to it. The scene is the one kept in the folder, or the original.
///
/// # Errors
/// [`JournalError`] when there is no valid recording, or no file of the scene is as it was.
pub fn recorded(path: &Path, from_secs: Option<f64>) -> Result<(LoadedScene, Player), JournalError> {
    let folder = find(path)?;
    let no_world = |reason: String| JournalError::NoWorld { path: folder.clone(), reason };
    let scene = SceneSource::read(&folder)?.load(&folder).map_err(no_world)?;
    let player = match from_secs {
        None => Player::open_oldest(&folder, &scene)?,
        Some(secs) => {
            let tick = (secs.max(0.0) / f64::from(scene.scene.dt_secs())).round() as u64;
            let mut player = Player::open(&folder, &scene, tick)?;
            player.iter_mut().for_each(|player| player.advance(tick));
            player
        }
    };
    let missing = || match from_secs {
        Some(secs) => format!("no valid checkpoint is as old as {secs} s"),
        None => "no checkpoint is valid".to_owned(),
    };
    Ok((scene, player.ok_or_else(|| no_world(missing()))?))
}
