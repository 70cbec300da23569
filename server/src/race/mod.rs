//! The race: laps of the clients' vehicles through the scene's gates.
//!
//! A gate is passed when the straight path of a vehicle in one step crosses the line between its posts in its direction, and the moment is that of the crossing:
//! the same motions give the same times, to the last bit.

mod course;
mod driven_motion;
mod ghost;
mod racer;
#[cfg(test)]
mod tests;

pub use driven_motion::DrivenMotion;

use crate::checksum::Checksum;
use course::Course;
use prairie_core::scene::Scene;
use prairie_core::wire::{Ghost, STANDINGS_LIMIT, Standing};
use racer::Racer;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// The race of a scene, and those who take part.
pub struct Race {
    course: Option<Course>,
    state: RaceState,
    /// The ghost of the state, to be shared.
    ghost: Option<Arc<Ghost>>,
}

/// A copy of the state of a [`Race`].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RaceState {
    racers: BTreeMap<u32, Racer>,
    /// The fastest lap.
    ghost: Option<Ghost>,
}

impl Race {
    /// The race of a scene, in which nobody takes part yet.
    pub fn new(scene: &Scene) -> Self {
        Self { course: Course::new(scene), state: RaceState::default(), ghost: None }
    }

    /// Follows the driven vehicles through step `tick`. Who has no vehicle, or another one, loses the running lap.
    pub fn step(&mut self, tick: u64, driven: impl Iterator<Item = DrivenMotion>) {
        let Some(course) = &self.course else { return };
        let RaceState { racers, ghost: fastest } = &mut self.state;
        let mut driving = BTreeSet::new();
        for motion in driven {
            let ghost = racers.entry(motion.client).or_default().advance(course, tick, &motion);
            if let Some(ghost) = ghost.filter(|ghost| fastest.as_ref().is_none_or(|fastest| ghost.lap_secs < fastest.lap_secs)) {
                self.ghost = Some(Arc::new(ghost.clone()));
                *fastest = Some(ghost);
            }
            driving.insert(motion.client);
        }
        racers.retain(|client, racer| {
            let drives = driving.contains(client);
            if !drives {
                racer.leave_vehicle();
            }
            drives || racer.has_a_time()
        });
    }

    /// Forgets a client whose number nobody has any more.
    pub fn forget(&mut self, client: u32) {
        self.state.racers.remove(&client);
    }

    /// Clients that have a time or drive, ascending.
    pub fn clients(&self) -> impl Iterator<Item = u32> {
        self.state.racers.keys().copied()
    }

    /// The fastest lap of all, also of clients that are gone.
    pub fn ghost(&self) -> Option<Arc<Ghost>> {
        self.ghost.clone()
    }

    /// Those who have begun a lap: first by their best race, then by their best lap, then by their number. Of more than [`STANDINGS_LIMIT`], those on foot
    /// are left out first, the slowest before the others.
    pub fn standings(&self) -> Vec<Standing> {
        let mut order: Vec<_> = self.state.racers.iter().filter(|(_, racer)| racer.has_begun()).collect();
        let by_rank = |one: &Racer, other: &Racer| {
            let [one, other] = [one, other].map(Racer::rank_secs);
            one[0].total_cmp(&other[0]).then(one[1].total_cmp(&other[1]))
        };
        if order.len() > STANDINGS_LIMIT {
            order.sort_by(|(_, one), (_, other)| other.is_racing().cmp(&one.is_racing()).then(by_rank(one, other)));
            order.truncate(STANDINGS_LIMIT);
        }
        order.sort_by(|(_, one), (_, other)| by_rank(one, other));
        let gates = self.course.as_ref().map_or(0, |course| course.gates.len());
        order.into_iter().map(|(client, racer)| racer.standing(*client, gates)).collect()
    }

    /// A copy of the state.
    pub fn state(&self) -> &RaceState {
        &self.state
    }

    /// Restores a copy of the state; false if it is that of another scene.
    pub fn restore(&mut self, state: RaceState) -> bool {
        let gates = self.course.as_ref().map_or(0, |course| course.gates.len());
        let fits = state.racers.values().all(|racer| racer.fits(gates)) && state.ghost.as_ref().is_none_or(|ghost| ghost.is_valid());
        if fits {
            self.ghost = state.ghost.clone().map(Arc::new);
            self.state = state;
        }
        fits
    }

    /// Adds all times to a checksum.
    pub(crate) fn hash(&self, sum: &mut Checksum) {
        for (client, racer) in &self.state.racers {
            sum.add([*client]);
            racer.hash(sum);
        }
        if let Some(ghost) = &self.state.ghost {
            sum.add([ghost.client, ghost.lap_secs.to_bits(), ghost.first_secs.to_bits()]);
            sum.add(ghost::words(&ghost.poses));
        }
    }
}
