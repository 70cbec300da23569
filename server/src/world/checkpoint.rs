//! Copies of a world's state, from which it continues bit for bit.

use super::departed::Departed;
use super::{Camera, Maps, World};
use crate::bend::pool::Pool;
use crate::detail::{Decision, Decisions};
use crate::objects::{ObjectsError, ObjectsState};
use crate::race::RaceState;
use crate::settings_error::SettingsError;
use crate::snapshot::BrokenPlants;
use crate::weather::{Weather, WeatherRestoreError, WeatherState};
use prairie_core::bend::StateError;
use prairie_core::grass::BendState;
use prairie_core::scene::Scene;
use serde::{Deserialize, Serialize};

/// A copy of the whole state of a [`World`]; the scene and its maps are not part of it. Taking it costs a copy of the memory that the state occupies, encoding
/// it several times that.
#[derive(Default, Serialize, Deserialize)]
pub struct WorldState {
    tick: u64,
    newest_client: u32,
    departed: Departed,
    cameras: Vec<Camera>,
    objects: ObjectsState,
    race: RaceState,
    weather: WeatherState,
    bend: BendState,
    broken: BrokenPlants,
    /// The newest decision about the detail, and the number of decisions.
    decisions: (Option<Decision>, u64),
}

/// Reason why a world cannot be restored.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RestoreError {
    /// The bytes are not a state.
    #[error("it cannot be decoded: {0}")]
    Encoding(#[from] postcard::Error),
    /// The scene's settings contradict each other.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// The wind does not fit the scene.
    #[error(transparent)]
    Weather(#[from] WeatherRestoreError),
    /// The bend field does not fit the scene.
    #[error(transparent)]
    Bend(#[from] StateError),
    /// The objects contradict each other.
    #[error(transparent)]
    Objects(#[from] ObjectsError),
    /// A plant is broken that the scene does not have.
    #[error("a broken plant has no site in the scene")]
    Plants,
    /// The laps are those of a race with other gates.
    #[error("the laps do not fit the gates of the scene")]
    Race,
}

impl WorldState {
    /// Number of steps that the world has done.
    pub fn tick(&self) -> u64 {
        self.tick
    }

    /// The state as bytes.
    pub fn encode(&self) -> Vec<u8> {
        postcard::to_allocvec(self).expect("the state is plain data")
    }

    /// The state from [`encode`](Self::encode).
    ///
    /// # Errors
    /// When the bytes are not a state.
    pub fn decode(bytes: &[u8]) -> Result<Self, RestoreError> {
        Ok(postcard::from_bytes(bytes)?)
    }
}

impl World {
    /// A copy of the whole state.
    pub fn save(&self) -> WorldState {
        let mut state = WorldState::default();
        self.save_into(&mut state);
        state
    }

    /// Copies the whole state into `state`, whose memory is used again but for the objects: fresh memory costs several times the copy.
    pub fn save_into(&self, state: &mut WorldState) {
        (state.tick, state.newest_client) = (self.tick, self.newest_client);
        state.departed.clone_from(&self.departed);
        state.cameras.clone_from(&self.cameras);
        state.objects = self.objects.state();
        state.race.clone_from(self.race.state());
        let (weather, bend) = (&self.weather, &self.bend);
        rayon::join(|| weather.save_into(&mut state.weather), || bend.save_into(&mut state.bend, &Pool));
        state.broken.clone_from(self.plants.broken());
        state.decisions = (self.decisions.newest(), self.decisions.count());
    }

    /// The world of a scene in a state that it had before. It continues with the same bits as the original, on any number of threads.
    ///
    /// # Errors
    /// [`RestoreError`] when the state is that of another scene.
    pub fn restore(scene: &Scene, maps: Maps, state: WorldState) -> Result<Self, RestoreError> {
        let weather = Weather::restored(scene, &maps.height, &maps.cover, &state.weather)?;
        let mut world = Self::with_weather(scene, maps, weather)?;
        (world.tick, world.newest_client) = (state.tick, state.newest_client);
        (world.departed, world.cameras) = (state.departed, state.cameras);
        world.objects.restore(state.objects)?;
        world.bend.restore(state.bend)?;
        if !world.race.restore(state.race) {
            return Err(RestoreError::Race);
        }
        if !world.plants.restore(state.broken) {
            return Err(RestoreError::Plants);
        }
        let (newest, count) = state.decisions;
        if let Some(decision) = newest {
            world.bend.limit_awake(decision.detail.awake_limit);
        }
        world.decisions = Decisions::restored(newest, count);
        Ok(world)
    }
}
