//! Recordings: a state and the commands of the steps after it, read from a folder; and their player.

use super::checkpoint::open_checkpoint;
use super::error::{Fault, JournalError};
use super::folder::{checkpoint_in, generations, segment_in};
use super::segment::Segment;
use crate::escaped::escaped;
use crate::scenes::LoadedScene;
use crate::world::{Command, World, WorldState};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// The steps after a state.
#[derive(Debug, Default)]
pub struct Recording {
    /// Number of the step after which the recording begins.
    pub start: u64,
    /// Number of the last step.
    pub end: u64,
    /// Commands by step.
    pub commands: BTreeMap<u64, Vec<Command>>,
    /// Newest generation that is part of it.
    pub(super) newest: u64,
    /// Generations that do not follow it.
    pub(super) unusable: Vec<u64>,
    /// Faults found, with the names of the files.
    pub faults: Vec<String>,
}

fn fault(path: &Path, fault: &Fault) -> String {
    format!("{}: {fault}", escaped(path))
}

impl Recording {
    /// The steps from the generation `first` on, which begins after the step `start`, as far as the segments follow each other.
    fn read(path: &Path, first: u64, start: u64, generations: &BTreeSet<u64>) -> Self {
        let mut recording = Self { start, end: start, newest: first, ..Self::default() };
        let mut follows = true;
        for &generation in generations.range(first..) {
            let segment_path = segment_in(path, generation);
            if !follows {
                recording.unusable.push(generation);
                continue;
            }
            match Segment::read(&segment_path) {
                Ok(segment) if segment.start == recording.end => {
                    recording.newest = generation;
                    recording.end = segment.reached;
                    recording.commands.extend(segment.steps.into_iter().map(|step| (segment.start + step.after, step.commands)));
                    if let Some(found) = &segment.fault {
                        recording.faults.push(format!("{}; the steps after {} are lost", fault(&segment_path, found), segment.reached));
                    }
                }
                Ok(segment) => {
                    let (begins, end) = (segment.start, recording.end);
                    recording.faults.push(format!("{}: begins after step {begins}, not {end}", escaped(&segment_path)));
                    follows = false;
                    recording.unusable.push(generation);
                }
                // The process may have ended before it began the segment.
                Err(Fault::Unreadable(error)) if error.kind() == std::io::ErrorKind::NotFound => {}
                // A segment that cannot be read at all may have been the last one: the next must then begin where the recording ends.
                Err(found) => recording.faults.push(fault(&segment_path, &found)),
            }
        }
        recording
    }
}

/// A world that carries out a recording.
pub struct Player {
    /// The world at the present step.
    pub world: World,
    /// What it carries out.
    pub recording: Recording,
}

impl Player {
    /// The newest state in `path` that is valid, of at most the step `from`, and the steps after it; `None` without a valid state, when the faults go to the
    /// log.
    ///
    /// # Errors
    /// When the folder cannot be read.
    pub fn open(path: &Path, scene: &LoadedScene, from: u64) -> Result<Option<Self>, JournalError> {
        let generations = generations(path)?;
        let mut faults = vec![];
        for &generation in generations.iter().rev() {
            let file = checkpoint_in(path, generation);
            if !file.is_file() {
                continue;
            }
            match restore(&file, scene, from) {
                Ok(Some(world)) => {
                    let mut recording = Recording::read(path, generation, world.tick(), &generations);
                    recording.faults.splice(..0, faults);
                    return Ok(Some(Self { world, recording }));
                }
                Ok(None) => {}
                Err(found) => faults.push(fault(&file, &found)),
            }
        }
        faults.iter().for_each(|fault| tracing::warn!("{fault}"));
        Ok(None)
    }

    /// The oldest valid state in `path`, and the steps after it. Faults go to the log if there is none.
    ///
    /// # Errors
    /// When the folder cannot be read.
    pub fn open_oldest(path: &Path, scene: &LoadedScene) -> Result<Option<Self>, JournalError> {
        let generations = generations(path)?;
        let mut faults = vec![];
        for &generation in &generations {
            let file = checkpoint_in(path, generation);
            match restore(&file, scene, u64::MAX) {
                Ok(Some(world)) => {
                    let mut recording = Recording::read(path, generation, world.tick(), &generations);
                    recording.faults.splice(..0, faults);
                    return Ok(Some(Self { world, recording }));
                }
                Err(found) if file.is_file() => faults.push(fault(&file, &found)),
                _ => {}
            }
        }
        faults.iter().for_each(|fault| tracing::warn!("{fault}"));
        Ok(None)
    }

    /// Does the next step; false at the end.
    pub fn step(&mut self) -> bool {
        let next = self.world.tick() + 1;
        let goes_on = next <= self.recording.end;
        if goes_on {
            self.world.step(self.recording.commands.get(&next).map_or(&[], Vec::as_slice));
        }
        goes_on
    }

    /// Does all steps up to `tick` or the end.
    pub fn advance(&mut self, tick: u64) {
        while self.world.tick() < tick && self.step() {}
    }
}

/// The world of a checkpoint, unless it is later than the step `latest`.
fn restore(file: &Path, scene: &LoadedScene, latest: u64) -> Result<Option<World>, Fault> {
    let state: WorldState = open_checkpoint(&std::fs::read(file)?)?;
    if state.tick() > latest {
        return Ok(None);
    }
    Ok(Some(World::restore(&scene.scene, scene.maps(), state)?))
}
