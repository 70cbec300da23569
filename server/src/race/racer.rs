//! A client in the race: its running lap, and its times.

use super::course::Course;
use super::driven_motion::DrivenMotion;
use super::ghost::Track;
use crate::checksum::Checksum;
use prairie_core::race::LightColor;
use prairie_core::wire::{Ghost, ObjectId, Standing};
use serde::{Deserialize, Serialize};

/// The times of a client. All are in seconds of simulated time.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Racer {
    object: ObjectId,
    /// Whether the vehicle waits for the start light behind the first gate.
    is_lined_up: bool,
    run: Option<Run>,
    last_secs: Option<f64>,
    best: Option<Lap>,
    race_secs: Option<f64>,
    /// Difference to the best lap at the gate passed last.
    gap_secs: Option<f64>,
}

/// Laps without a break.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Run {
    /// Moment at which the first of them began.
    race_began_secs: f64,
    /// Moment at which the running one began.
    began_secs: f64,
    /// Complete ones.
    laps: u32,
    /// Times from the start of the running one to its gates so far, without the first gate.
    splits_secs: Vec<f64>,
    /// Its track so far.
    track: Track,
    /// Whether it began before the light was green; it does not count then.
    is_false_start: bool,
}

/// A complete lap.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Lap {
    secs: f64,
    splits_secs: Vec<f64>,
}

impl Run {
    fn starting_at(began_secs: f64, is_false_start: bool) -> Self {
        Self { race_began_secs: began_secs, began_secs, laps: 0, splits_secs: Vec::new(), track: Track::default(), is_false_start }
    }
}

impl Racer {
    /// Follows the vehicle through step `tick`. Returns the ghost of a lap that ends in it.
    pub(super) fn advance(&mut self, course: &Course, tick: u64, motion: &DrivenMotion) -> Option<Ghost> {
        if self.object != motion.object {
            self.leave_vehicle();
            self.object = motion.object;
        }
        self.line_up(course, tick, motion);
        let (mut passed, mut ghost) = (0.0, None);
        // A fast vehicle may pass several gates in a step.
        for _ in 0..course.gates.len() {
            let gate = if self.is_lined_up { 0 } else { self.next_gate(course.gates.len()) };
            let share = course.gates[gate].passage(motion.from.xz(), motion.to.xz()).filter(|share| *share > passed);
            let Some(share) = share else { break };
            passed = share;
            let secs = course.secs(tick, share);
            if gate == 0 {
                ghost = self.pass_start(course, tick, secs, motion).or(ghost);
            } else {
                self.pass(secs);
            }
        }
        if let Some(run) = &mut self.run {
            run.track.record(course, tick, motion);
        }
        ghost
    }

    /// Loses the running lap, and keeps all times.
    pub(super) fn leave_vehicle(&mut self) {
        (self.object, self.is_lined_up, self.run, self.gap_secs) = (0, false, None, None);
    }

    pub(super) fn has_a_time(&self) -> bool {
        self.best.is_some()
    }

    /// Whether a lap runs.
    pub(super) fn is_racing(&self) -> bool {
        self.run.is_some()
    }

    pub(super) fn has_begun(&self) -> bool {
        self.run.is_some() || self.has_a_time()
    }

    /// Whether the state is that of a race with this number of gates.
    pub(super) fn fits(&self, gates: usize) -> bool {
        let splits = self.run.iter().map(|run| &run.splits_secs).chain(self.best.iter().map(|lap| &lap.splits_secs));
        let has_bounds = self.run.as_ref().is_none_or(|run| run.track.is_bounded());
        gates > 0
            && has_bounds
            && splits.map(Vec::len).all(|splits| splits < gates)
            && self.best.as_ref().is_none_or(|lap| lap.splits_secs.len() + 1 == gates)
    }

    /// Best race and best lap (s), infinite if there is none.
    pub(super) fn rank_secs(&self) -> [f64; 2] {
        [self.race_secs, self.best.as_ref().map(|lap| lap.secs)].map(|secs| secs.unwrap_or(f64::INFINITY))
    }

    /// The racer as clients see it, in a race with this number of gates.
    pub(super) fn standing(&self, client: u32, gates: usize) -> Standing {
        let short = |secs: Option<f64>| secs.map(|secs| secs as f32);
        Standing {
            client,
            next_gate: self.next_gate(gates) as u8,
            laps: self.run.as_ref().map_or(0, |run| run.laps as u8),
            began_secs: self.run.as_ref().map(|run| run.began_secs),
            is_false_start: self.run.as_ref().is_some_and(|run| run.is_false_start),
            last_secs: short(self.last_secs),
            best_secs: short(self.best.as_ref().map(|lap| lap.secs)),
            race_secs: short(self.race_secs),
            gap_secs: short(self.gap_secs),
        }
    }

    pub(super) fn hash(&self, sum: &mut Checksum) {
        let bits = |secs: f64| [secs.to_bits() as u32, (secs.to_bits() >> 32) as u32];
        sum.add([self.object, u32::from(self.is_lined_up)]);
        for secs in [self.last_secs, self.race_secs, self.gap_secs] {
            sum.add(secs.map_or([u32::MAX; 2], bits));
        }
        if let Some(Lap { secs, splits_secs }) = &self.best {
            sum.add([*secs].iter().chain(splits_secs).copied().flat_map(bits));
        }
        if let Some(Run { race_began_secs, began_secs, laps, splits_secs, track, is_false_start }) = &self.run {
            sum.add([*laps, u32::from(*is_false_start)]);
            sum.add(track.words());
            sum.add([*race_began_secs, *began_secs].iter().chain(splits_secs).copied().flat_map(bits));
        }
    }

    /// Number of the gate that counts next: the first one if no lap runs.
    fn next_gate(&self, gates: usize) -> usize {
        self.run.as_ref().map_or(0, |run| (run.splits_secs.len() + 1) % gates.max(1))
    }

    /// Notes whether the vehicle waits for the light: it has to stand behind the first gate while the light is amber.
    fn line_up(&mut self, course: &Course, tick: u64, motion: &DrivenMotion) {
        let Some(light) = course.light else { return };
        self.is_lined_up = course.is_on_grid(motion)
            && match light.color(tick) {
                LightColor::Red => false,
                LightColor::Amber => self.is_lined_up || course.is_waiting(motion),
                LightColor::Green => self.is_lined_up,
            };
    }

    /// Passes the first gate at `secs`: by the light, at the end of a lap, or at the first crossing.
    fn pass_start(&mut self, course: &Course, tick: u64, secs: f64, motion: &DrivenMotion) -> Option<Ghost> {
        if std::mem::take(&mut self.is_lined_up) {
            let green_secs = course.green_secs(tick, secs);
            self.run = Some(Run::starting_at(green_secs.unwrap_or(secs), green_secs.is_none()));
            self.gap_secs = None;
            return None;
        }
        let Some(mut run) = self.run.take().filter(|run| !run.is_false_start) else {
            self.run = Some(Run::starting_at(secs, false));
            self.gap_secs = None;
            return None;
        };
        let track = std::mem::take(&mut run.track);
        let ghost = track.into_ghost(course, motion, run.began_secs, secs - run.began_secs);
        self.run = Some(self.finish_lap(run, course.laps, secs));
        ghost
    }

    /// Ends a lap, and begins the next one.
    fn finish_lap(&mut self, run: Run, laps_in_race: u32, secs: f64) -> Run {
        let lap = Lap { secs: secs - run.began_secs, splits_secs: run.splits_secs };
        self.last_secs = Some(lap.secs);
        self.gap_secs = self.best.as_ref().map(|best| lap.secs - best.secs);
        if self.best.as_ref().is_none_or(|best| lap.secs < best.secs) {
            self.best = Some(lap);
        }
        if run.laps + 1 < laps_in_race {
            return Run { began_secs: secs, laps: run.laps + 1, splits_secs: Vec::new(), ..run };
        }
        let race_secs = secs - run.race_began_secs;
        self.race_secs = Some(self.race_secs.map_or(race_secs, |best| best.min(race_secs)));
        Run::starting_at(secs, false)
    }

    /// Passes a gate between start and finish.
    fn pass(&mut self, secs: f64) {
        let Some(run) = &mut self.run else { return };
        let split_secs = secs - run.began_secs;
        let best = self.best.as_ref().and_then(|best| best.splits_secs.get(run.splits_secs.len()));
        self.gap_secs = best.map(|best| split_secs - best);
        run.splits_secs.push(split_secs);
    }
}
