//! Causes of steps as [differences](Step) from the step before, and back.

use super::Causes;
use crate::body::{BodyPose, Motion, MotionError, PoseCode};
use crate::grid::PatchIndex;
use crate::scene::VehicleKind;
use crate::wire::{Joined, Move, ObjectId, ObjectPose, PatchCheck, PoseChange, RareCauses, Step};
use serde::{Deserialize, Serialize};
use std::f32::consts::TAU;
use thiserror::Error;

/// Largest number of objects.
pub const OBJECT_LIMIT: usize = 1024;
/// Quanta of a moving part's angle in a turn.
const PART_STEPS: f32 = 65_536.0;

/// What is known of a step: its causes, the objects behind its motions, and checksums of patches after it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StepRecord {
    /// Number of the step.
    pub tick: u64,
    /// Tick of the wind frame of the step.
    pub wind_tick: u64,
    /// Causes of the step.
    pub causes: Causes,
    /// Number of the object behind each motion, ascending, and the angle of its moving part (rad).
    pub objects: Vec<(ObjectId, f32)>,
    /// Checksums of patches after the step.
    pub checks: Vec<PatchCheck>,
}

/// An object as of the newest step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Track {
    id: ObjectId,
    kind: VehicleKind,
    pose: PoseCode,
    part: i16,
    /// Change in the newest step.
    change: PoseChange,
    is_at_rest: bool,
}

impl Track {
    fn new(Joined { id, kind, from }: Joined) -> Self {
        Self { id, kind, pose: from, part: 0, change: PoseChange::default(), is_at_rest: false }
    }

    /// Moves on by `change`.
    fn advance(&mut self, change: PoseChange) {
        let PoseChange { position, rotation, part } = change;
        self.pose = PoseCode {
            position: [0, 1, 2].map(|n| self.pose.position[n].wrapping_add(position[n])),
            rotation: [0, 1, 2, 3].map(|n| self.pose.rotation[n].wrapping_add(rotation[n])),
        };
        self.part = self.part.wrapping_add(part);
        self.change = change;
    }

    fn part_rad(&self) -> f32 {
        f32::from(self.part) / PART_STEPS * TAU
    }
}

/// The objects of the newest step, from which the next one is told. Encoder and decoder are equal after each step.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct StepCodec {
    /// Ascending by number.
    tracks: Vec<Track>,
    gusty: Vec<PatchIndex>,
}

/// Reason why a step cannot be decoded.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum DecodeError {
    /// The number of moves is not that of the objects.
    #[error("{found} moves of {objects} objects")]
    Moves {
        /// Number of moves.
        found: usize,
        /// Number of objects.
        objects: usize,
    },
    /// Too many objects, or one that is already there.
    #[error("object {id} joins {objects} others; allowed: up to {OBJECT_LIMIT} objects, each once")]
    Joined {
        /// Number of the object.
        id: ObjectId,
        /// Number of objects before.
        objects: usize,
    },
    /// A motion is invalid.
    #[error(transparent)]
    Motion(#[from] MotionError),
}

impl StepCodec {
    /// Encodes a step that follows the newest one.
    pub fn encode(&mut self, record: &StepRecord) -> Step {
        let Causes { motions, gusty, evicted, dropped } = &record.causes;
        let is_here = |track: &Track| record.objects.binary_search_by_key(&track.id, |object| object.0).is_ok();
        let left = self.tracks.iter().filter(|track| !is_here(track)).map(|track| track.id).collect();
        self.tracks.retain(is_here);
        let objects = record.objects.iter().zip(motions);
        let joined = objects.clone().filter(|((id, _), _)| self.place_of(*id).is_err());
        let joined: Vec<_> = joined.map(|(&(id, _), motion)| Joined { id, kind: motion.kind, from: PoseCode::of(&motion.from) }).collect();
        joined.iter().for_each(|new| self.join(*new));
        let rare = RareCauses {
            left,
            joined,
            gusty: (*gusty != self.gusty).then(|| gusty.clone()),
            evicted: evicted.clone(),
            dropped: dropped.clone(),
            checks: record.checks.clone(),
        };
        self.gusty.clone_from(gusty);
        let moves = self.tracks.iter_mut().zip(objects).map(|(track, (&(_, part_rad), motion))| encode_move(track, motion, part_rad));
        Step { moves: moves.collect(), rare: (rare != RareCauses::default()).then(|| Box::new(rare)) }
    }

    /// Decodes the causes of the step that follows the newest one.
    ///
    /// # Errors
    /// [`DecodeError`] when the step contradicts the objects, or a motion is invalid.
    pub fn decode(&mut self, step: Step, dt_secs: f32) -> Result<(Causes, Vec<PatchCheck>), DecodeError> {
        let RareCauses { left, joined, gusty, evicted, dropped, checks } = step.rare.map(|rare| *rare).unwrap_or_default();
        self.tracks.retain(|track| !left.contains(&track.id));
        for new in joined {
            let objects = self.tracks.len();
            if objects >= OBJECT_LIMIT || self.place_of(new.id).is_ok() {
                return Err(DecodeError::Joined { id: new.id, objects });
            }
            self.join(new);
        }
        if step.moves.len() != self.tracks.len() {
            return Err(DecodeError::Moves { found: step.moves.len(), objects: self.tracks.len() });
        }
        if let Some(gusty) = gusty {
            self.gusty = gusty;
        }
        let moves = self.tracks.iter_mut().zip(step.moves);
        let motions = moves.map(|(track, step)| decode_move(track, step, dt_secs)).collect::<Result<_, _>>()?;
        Ok((Causes { motions, gusty: self.gusty.clone(), evicted, dropped }, checks))
    }

    /// Place of an object among the tracks; the place for it if it is missing.
    fn place_of(&self, id: ObjectId) -> Result<usize, usize> {
        self.tracks.binary_search_by_key(&id, |track| track.id)
    }

    fn join(&mut self, new: Joined) {
        if let Err(place) = self.place_of(new.id) {
            self.tracks.insert(place, Track::new(new));
        }
    }

    /// The step in which nothing changes: objects stay, and nothing rare happens.
    pub fn quiet(&self) -> Step {
        Step { moves: vec![Move::Same; self.tracks.len()], rare: None }
    }

    /// Poses of all objects after the newest step of `dt_secs`, ascending by number.
    pub fn objects(&self, dt_secs: f32) -> impl Iterator<Item = ObjectPose> {
        self.tracks.iter().map(move |track| {
            let BodyPose { position_m, rotation } = track.pose.pose();
            let velocity_m_per_s = track.velocity_m_per_s(dt_secs);
            ObjectPose { id: track.id, kind: track.kind, position_m, rotation, velocity_m_per_s, part_rad: track.part_rad() }
        })
    }
}

impl Track {
    fn velocity_m_per_s(&self, dt_secs: f32) -> [f32; 3] {
        self.change.position.map(|quanta| quanta as f32 * crate::body::POSITION_QUANTUM_M / dt_secs)
    }
}

impl Step {
    /// Whether nothing changes, as in [`StepCodec::quiet`].
    pub fn is_quiet(&self) -> bool {
        self.rare.is_none() && self.moves.iter().all(|step| *step == Move::Same)
    }
}

fn encode_move(track: &mut Track, motion: &Motion, part_rad: f32) -> Move {
    let pose = PoseCode::of(&motion.to);
    let part = (part_rad / TAU * PART_STEPS).round() as i64 as i16;
    let change = PoseChange {
        position: [0, 1, 2].map(|n| pose.position[n].wrapping_sub(track.pose.position[n])),
        rotation: [0, 1, 2, 3].map(|n| pose.rotation[n].wrapping_sub(track.pose.rotation[n])),
        part: part.wrapping_sub(track.part),
    };
    let before = track.change;
    let was_at_rest = std::mem::replace(&mut track.is_at_rest, motion.is_at_rest);
    track.advance(change);
    if change == PoseChange::default() {
        return if was_at_rest == motion.is_at_rest { Move::Same } else { Move::Rest(motion.is_at_rest) };
    }
    let second = PoseChange {
        position: [0, 1, 2].map(|n| change.position[n].wrapping_sub(before.position[n])),
        rotation: [0, 1, 2, 3].map(|n| change.rotation[n].wrapping_sub(before.rotation[n])),
        part: change.part.wrapping_sub(before.part),
    };
    if motion.is_at_rest { Move::MovedAtRest(second) } else { Move::Moved(second) }
}

fn decode_move(track: &mut Track, step: Move, dt_secs: f32) -> Result<Motion, MotionError> {
    let from = track.pose.pose();
    let before = track.change;
    let change = match step {
        Move::Same | Move::Rest(_) => PoseChange::default(),
        Move::Moved(second) | Move::MovedAtRest(second) => PoseChange {
            position: [0, 1, 2].map(|n| before.position[n].wrapping_add(second.position[n])),
            rotation: [0, 1, 2, 3].map(|n| before.rotation[n].wrapping_add(second.rotation[n])),
            part: before.part.wrapping_add(second.part),
        },
    };
    track.is_at_rest = match step {
        Move::Same => track.is_at_rest,
        Move::Rest(is_at_rest) => is_at_rest,
        Move::Moved(_) => false,
        Move::MovedAtRest(_) => true,
    };
    track.advance(change);
    let velocity_m_per_s = track.velocity_m_per_s(dt_secs);
    let motion = Motion { kind: track.kind, from, to: track.pose.pose(), velocity_m_per_s, is_at_rest: track.is_at_rest };
    motion.check()?;
    Ok(motion)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const DT_SECS: f32 = 1.0 / 60.0;

    /// A step in which object `id` of each pair moves between two poses.
    fn record(tick: u64, objects: &[(ObjectId, [BodyPose; 2], bool)]) -> StepRecord {
        let motion = |(_, [from, to], is_at_rest): &(_, [BodyPose; 2], _)| {
            Motion { kind: VehicleKind::Car, from: *from, to: *to, velocity_m_per_s: [0.0; 3], is_at_rest: *is_at_rest }.rounded()
        };
        let causes = Causes { motions: objects.iter().map(motion).collect(), gusty: vec![tick as u32 / 10], ..Causes::default() };
        StepRecord {
            tick,
            wind_tick: 0,
            causes,
            objects: objects.iter().map(|object| (object.0, tick as f32 * 0.1)).collect(),
            checks: vec![],
        }
    }

    fn pose(id: ObjectId, tick: u64) -> BodyPose {
        let t = tick as f32 * DT_SECS;
        let turn = 0.3 * t * id as f32;
        BodyPose { position_m: [10.0 + 12.0 * t, 1.0, id as f32 * 5.0 + t * t], rotation: [0.0, turn.sin(), 0.0, turn.cos()] }
    }

    /// Objects that join, stand, move and leave.
    fn drive(tick: u64) -> StepRecord {
        let objects = (1..=4).filter(|id| tick >= u64::from(*id) * 20 && tick < 300 - u64::from(*id) * 30 || *id == 2 && tick > 290);
        let moving = |tick: u64| if (100..150).contains(&tick) { 100 } else { tick };
        let objects: Vec<_> =
            objects.map(|id| (id, [pose(id, moving(tick)), pose(id, moving(tick + 1))], (110..150).contains(&tick))).collect();
        record(tick, &objects)
    }

    #[test]
    fn causes_come_back_with_the_same_bits() {
        let (mut encoder, mut decoder) = (StepCodec::default(), StepCodec::default());
        let mut bytes = 0;
        for tick in 0..320 {
            let record = drive(tick);
            let step = encoder.encode(&record);
            bytes += postcard::to_allocvec(&step).unwrap().len();
            let (causes, _) = decoder.decode(step, DT_SECS).unwrap();
            for (found, wanted) in causes.motions.iter().zip(&record.causes.motions) {
                assert_eq!((found.from, found.to, found.is_at_rest), (wanted.from, wanted.to, wanted.is_at_rest), "step {tick}");
            }
            assert_eq!(causes.motions.len(), record.causes.motions.len());
            assert_eq!(causes.gusty, record.causes.gusty);
            assert_eq!(encoder, decoder);
            let ids: Vec<_> = decoder.objects(DT_SECS).map(|object| object.id).collect();
            assert_eq!(ids, record.objects.iter().map(|object| object.0).collect::<Vec<_>>());
        }
        assert!(bytes < 320 * 4 * 16, "{bytes} bytes");
    }

    #[test]
    fn steps_in_which_nothing_happens_are_quiet() {
        let mut codec = StepCodec::default();
        let stands = |tick| StepRecord {
            causes: Causes { gusty: vec![], ..record(tick, &[(7, [pose(7, 9); 2], true)]).causes },
            ..record(0, &[(7, [pose(7, 9); 2], true)])
        };
        assert!(!codec.encode(&stands(0)).is_quiet(), "an object joins");
        codec.encode(&stands(1));
        assert!(codec.encode(&stands(2)).is_quiet());
        assert_eq!(codec.encode(&stands(3)), codec.quiet());
    }

    #[test]
    fn steps_that_contradict_the_objects_are_rejected() {
        let mut codec = StepCodec::default();
        let error = |step: Step, codec: &mut StepCodec| codec.decode(step, DT_SECS).unwrap_err().to_string();
        assert_eq!(error(Step { moves: vec![Move::Same], rare: None }, &mut codec), "1 moves of 0 objects");
        let joined = Joined { id: 3, kind: VehicleKind::Ball, from: PoseCode::default() };
        let twice = RareCauses { joined: vec![joined; 2], ..RareCauses::default() };
        assert!(error(Step { moves: vec![], rare: Some(Box::new(twice)) }, &mut codec).starts_with("object 3 joins 1 others"));
        let far = Move::Moved(PoseChange { position: [i32::MAX, 0, 0], ..PoseChange::default() });
        assert!(error(Step { moves: vec![far], rare: None }, &mut codec).starts_with("a ball moves 262144.0 m in one step"));
    }

    proptest! {
        #[test]
        fn any_step_is_decoded_or_rejected(bytes in proptest::collection::vec(any::<u8>(), 0..100)) {
            if let Ok(step) = postcard::from_bytes::<Step>(&bytes) {
                let _ = StepCodec::default().decode(step, DT_SECS);
            }
        }
    }
}
