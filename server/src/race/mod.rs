//! The race: laps of the clients' vehicles through the scene's gates.
//!
//! A gate is passed when the straight way of a vehicle in one step crosses the line between its posts in its direction, and the moment is that of the crossing:
//! the same motions give the same times, to the last bit.

mod course;
mod driven_motion;
mod racer;
#[cfg(test)]
mod tests;

pub use driven_motion::DrivenMotion;

use crate::checksum::Checksum;
use course::Course;
use prairie_core::scene::Scene;
use prairie_core::wire::{STANDINGS_LIMIT, Standing};
use racer::Racer;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// The race of a scene, and those who take part.
pub struct Race {
    course: Option<Course>,
    racers: RaceState,
}

/// A copy of the state of a [`Race`].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RaceState(BTreeMap<u32, Racer>);

impl Race {
    /// The race of a scene, in which nobody takes part yet.
    pub fn new(scene: &Scene) -> Self {
        Self { course: Course::new(scene), racers: RaceState::default() }
    }

    /// Follows the driven vehicles through step `tick`. Who has no vehicle, or another one, loses the running lap.
    pub fn step(&mut self, tick: u64, driven: impl Iterator<Item = DrivenMotion>) {
        let (Some(course), RaceState(racers)) = (&self.course, &mut self.racers) else { return };
        let mut driving = BTreeSet::new();
        for motion in driven {
            racers.entry(motion.client).or_default().advance(course, tick, &motion);
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
        self.racers.0.remove(&client);
    }

    /// Clients that have a time or drive, ascending.
    pub fn clients(&self) -> impl Iterator<Item = u32> {
        self.racers.0.keys().copied()
    }

    /// Those who have begun a lap: first by their best race, then by their best lap, then by their number. At most [`STANDINGS_LIMIT`].
    pub fn standings(&self) -> Vec<Standing> {
        let mut order: Vec<_> = self.racers.0.iter().filter(|(_, racer)| racer.has_begun()).collect();
        order.sort_by(|(_, one), (_, other)| {
            let [one, other] = [one, other].map(|racer| racer.rank_secs());
            one[0].total_cmp(&other[0]).then(one[1].total_cmp(&other[1]))
        });
        let gates = self.course.as_ref().map_or(0, |course| course.gates.len());
        order.into_iter().take(STANDINGS_LIMIT).map(|(client, racer)| racer.standing(*client, gates)).collect()
    }

    /// A copy of the state.
    pub fn state(&self) -> &RaceState {
        &self.racers
    }

    /// Restores a copy of the state; false if it is that of another scene.
    pub fn restore(&mut self, state: RaceState) -> bool {
        let gates = self.course.as_ref().map_or(0, |course| course.gates.len());
        let fits = state.0.values().all(|racer| racer.fits(gates));
        if fits {
            self.racers = state;
        }
        fits
    }

    /// Adds all times to a checksum.
    pub(crate) fn hash(&self, sum: &mut Checksum) {
        for (client, racer) in &self.racers.0 {
            sum.add([*client]);
            racer.hash(sum);
        }
    }
}
