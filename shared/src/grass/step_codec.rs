//! Causes of steps as [differences](Move) from the step before, and back.

use super::Causes;
use crate::body::{BodyPose, Motion, MotionError, PoseCode, part_code, part_rad};
use crate::grid::PatchIndex;
use crate::scene::VehicleKind;
use crate::wire::codec::moves::{MoveContext, MoveDecoder, MoveEncoder, MoveModel};
use crate::wire::{Joined, Move, ObjectId, ObjectPose, PatchCheck, PoseChange, RareCauses, StepHead};
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Largest number of objects.
pub const OBJECT_LIMIT: usize = 1024;
/// Largest number of steps in a message.
const STEPS_LIMIT: usize = 4096;

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
    context: MoveContext,
}

impl Track {
    fn new(Joined { id, kind, from }: Joined) -> Self {
        let (change, context) = (PoseChange::default(), MoveContext::default());
        Self { id, kind, pose: from, part: 0, change, is_at_rest: false, context }
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
        part_rad(self.part)
    }
}

/// The objects of the newest step, from which the next one is told. Encoder and decoder are equal after each step.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct StepCodec {
    /// Ascending by number.
    tracks: Vec<Track>,
    gusty: Vec<PatchIndex>,
    model: MoveModel,
}

/// Steps in which something changes, as a [message](crate::wire::ServerMessage::Steps).
#[derive(Clone, Debug, PartialEq)]
pub struct EncodedSteps {
    /// Tick of the first one.
    pub first_tick: u64,
    /// The steps.
    pub heads: Vec<StepHead>,
    /// Coded moves of their objects.
    pub moves: Vec<u8>,
}

/// Decoded causes of a step.
#[derive(Clone, Debug, PartialEq)]
pub struct DecodedStep {
    /// Number of the step.
    pub tick: u64,
    /// Its causes.
    pub causes: Causes,
    /// Checksums of patches after it.
    pub checks: Vec<PatchCheck>,
}

/// Reason why a step cannot be decoded.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum DecodeError {
    /// Too many steps.
    #[error("more than {STEPS_LIMIT} steps in one message")]
    Steps,
    /// The moves end too early or too late.
    #[error("the length of the moves does not match the objects and steps")]
    Length,
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
    /// Encodes the next steps; `None` when nothing changes in them.
    pub fn encode<'a>(&mut self, records: impl IntoIterator<Item = &'a StepRecord>) -> Option<EncodedSteps> {
        let (mut first_tick, mut last_tick, mut heads, mut encoder) = (0, 0, vec![], MoveEncoder::default());
        for record in records {
            let (rare, moves) = self.changes(record);
            if rare.is_none() && moves.iter().all(|step| *step == Move::Same) {
                continue;
            }
            let quiet_before = if heads.is_empty() { 0 } else { (record.tick - last_tick - 1) as u16 };
            first_tick = if heads.is_empty() { record.tick } else { first_tick };
            last_tick = record.tick;
            heads.push(StepHead { quiet_before, rare });
            for (track, step) in self.tracks.iter_mut().zip(moves) {
                self.model.encode(&mut encoder, &mut track.context, step);
            }
        }
        (!heads.is_empty()).then(|| EncodedSteps { first_tick, heads, moves: encoder.finish() })
    }

    /// Decodes the next steps, from `first_tick` on.
    ///
    /// # Errors
    /// [`DecodeError`] when a step contradicts the objects, or a motion is invalid. The codec can then not be used on.
    pub fn decode(&mut self, steps: EncodedSteps, dt_secs: f32) -> Result<Vec<DecodedStep>, DecodeError> {
        let EncodedSteps { first_tick, heads, moves } = steps;
        let (mut decoder, mut tick, mut decoded) = (MoveDecoder::new(&moves), first_tick, vec![]);
        for StepHead { quiet_before, rare } in heads {
            if decoded.len() + usize::from(quiet_before) >= STEPS_LIMIT {
                return Err(DecodeError::Steps);
            }
            for _ in 0..quiet_before {
                decoded.push(DecodedStep { tick, causes: self.quiet(dt_secs), checks: vec![] });
                tick += 1;
            }
            let RareCauses { left, joined, gusty, evicted, dropped, checks } = rare.map(|rare| *rare).unwrap_or_default();
            self.tracks.retain(|track| !left.contains(&track.id));
            for new in joined {
                let objects = self.tracks.len();
                if objects >= OBJECT_LIMIT || self.place_of(new.id).is_ok() {
                    return Err(DecodeError::Joined { id: new.id, objects });
                }
                self.join(new);
            }
            self.gusty = gusty.unwrap_or(std::mem::take(&mut self.gusty));
            let model = &mut self.model;
            let decode = |track: &mut Track| {
                let step = model.decode(&mut decoder, &mut track.context);
                decode_move(track, step, dt_secs)
            };
            let motions = self.tracks.iter_mut().map(decode).collect::<Result<_, _>>()?;
            let causes = Causes { motions, gusty: self.gusty.clone(), evicted, dropped };
            decoded.push(DecodedStep { tick, causes, checks });
            tick += 1;
        }
        if decoder.is_finished() { Ok(decoded) } else { Err(DecodeError::Length) }
    }

    /// Causes of a next step in which nothing changes: objects stay, and nothing rare happens.
    pub fn quiet(&mut self, dt_secs: f32) -> Causes {
        let stay = |track: &mut Track| {
            track.change = PoseChange::default();
            track.motion(track.pose, dt_secs)
        };
        Causes { motions: self.tracks.iter_mut().map(stay).collect(), gusty: self.gusty.clone(), ..Causes::default() }
    }

    /// The rare causes of the next step, and the move of each object after those that leave and join.
    fn changes(&mut self, record: &StepRecord) -> (Option<Box<RareCauses>>, Vec<Move>) {
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
        ((rare != RareCauses::default()).then(|| Box::new(rare)), moves.collect())
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
    /// The motion of the newest step, from the pose before it.
    fn motion(&self, from: PoseCode, dt_secs: f32) -> Motion {
        let velocity_m_per_s = self.velocity_m_per_s(dt_secs);
        Motion {
            kind: self.kind,
            from: from.pose(),
            to: self.pose.pose(),
            velocity_m_per_s,
            part_rad: self.part_rad(),
            is_at_rest: self.is_at_rest,
        }
    }

    fn velocity_m_per_s(&self, dt_secs: f32) -> [f32; 3] {
        self.change.position.map(|quanta| quanta as f32 * crate::body::POSITION_QUANTUM_M / dt_secs)
    }
}

fn encode_move(track: &mut Track, motion: &Motion, part_rad: f32) -> Move {
    let pose = PoseCode::of(&motion.to);
    let part = part_code(part_rad);
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
    let (from, before) = (track.pose, track.change);
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
    let motion = track.motion(from, dt_secs);
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
            let (kind, part_rad) = (VehicleKind::Car, to.position_m[0]);
            Motion { kind, from: *from, to: *to, velocity_m_per_s: [0.0; 3], part_rad, is_at_rest: *is_at_rest }.rounded()
        };
        let causes = Causes { motions: objects.iter().map(motion).collect(), gusty: vec![tick as u32 / 10], ..Causes::default() };
        StepRecord {
            tick,
            wind_tick: 0,
            causes,
            objects: objects.iter().map(|object| (object.0, object.1[1].position_m[0])).collect(),
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
        // A long stop, at rest, and a short one in which nothing at all changes.
        let moving = |tick: u64| match tick {
            100..150 => 100,
            202..208 => 202,
            _ => tick,
        };
        let objects: Vec<_> =
            objects.map(|id| (id, [pose(id, moving(tick)), pose(id, moving(tick + 1))], (110..150).contains(&tick))).collect();
        record(tick, &objects)
    }

    #[test]
    fn causes_come_back_with_the_same_bits() {
        let (mut encoder, mut decoder) = (StepCodec::default(), StepCodec::default());
        let records: Vec<_> = (1..=321).map(drive).collect();
        let (mut next_tick, mut bytes) = (1, 0);
        for records in records.chunks(3) {
            let Some(steps) = encoder.encode(records) else { continue };
            bytes += steps.moves.len();
            let (first_tick, count) = (steps.first_tick, steps.heads.iter().map(|head| 1 + u64::from(head.quiet_before)).sum::<u64>());
            for _ in next_tick..first_tick {
                decoder.quiet(DT_SECS);
            }
            for (found, record) in decoder.decode(steps, DT_SECS).unwrap().iter().zip(&records[(first_tick - records[0].tick) as usize..]) {
                assert_eq!((found.tick, &found.causes.gusty), (record.tick, &record.causes.gusty));
                assert_eq!(found.causes.motions.len(), record.causes.motions.len());
                for (found, wanted) in found.causes.motions.iter().zip(&record.causes.motions) {
                    assert_eq!(
                        (found.from, found.to, found.part_rad, found.is_at_rest),
                        (wanted.from, wanted.to, wanted.part_rad, wanted.is_at_rest),
                        "step {}",
                        record.tick
                    );
                }
            }
            next_tick = first_tick + count;
            let ids: Vec<_> = decoder.objects(DT_SECS).map(|object| object.id).collect();
            assert_eq!(ids, records[(next_tick - 1 - records[0].tick) as usize].objects.iter().map(|object| object.0).collect::<Vec<_>>());
        }
        assert!(next_tick > 300 && bytes < 320 * 4 * 6, "{bytes} bytes up to step {next_tick}");
    }

    #[test]
    fn steps_in_which_nothing_changes_are_not_encoded() {
        let mut codec = StepCodec::default();
        let stands = |tick| {
            let record = record(tick, &[(7, [pose(7, 9); 2], true)]);
            StepRecord { causes: Causes { gusty: vec![], ..record.causes }, objects: vec![(7, 0.5)], ..record }
        };
        assert!(codec.encode([&stands(1), &stands(2)]).is_some_and(|steps| steps.heads.len() == 1), "an object joins");
        let mut quiet = codec.clone();
        assert_eq!(codec.encode([&stands(3), &stands(4)]), None);
        quiet.quiet(DT_SECS);
        assert_eq!(codec, quiet);
        let gust = StepRecord { causes: Causes { gusty: vec![3], ..stands(9).causes }, ..stands(9) };
        let heads = codec.encode([&stands(5), &gust, &stands(10), &StepRecord { tick: 12, ..stands(12) }]).unwrap().heads;
        assert_eq!(heads.iter().map(|head| head.quiet_before).collect::<Vec<_>>(), [0, 0], "the gust begins and ends");
    }

    #[test]
    fn steps_that_contradict_the_objects_are_rejected() {
        let error = |heads: Vec<StepHead>, moves: Vec<u8>| {
            StepCodec::default().decode(EncodedSteps { first_tick: 1, heads, moves }, DT_SECS).unwrap_err().to_string()
        };
        let joins =
            |joined: Vec<Joined>| vec![StepHead { quiet_before: 0, rare: Some(Box::new(RareCauses { joined, ..RareCauses::default() })) }];
        let ball = Joined { id: 3, kind: VehicleKind::Ball, from: PoseCode::default() };
        assert!(error(joins(vec![ball; 2]), vec![]).starts_with("object 3 joins 1 others"));
        assert_eq!(error(vec![StepHead::default()], vec![1, 2, 3]), "the length of the moves does not match the objects and steps");
        assert_eq!(error(vec![StepHead { quiet_before: u16::MAX, rare: None }], vec![]), "more than 4096 steps in one message");
        let mut encoder = MoveEncoder::default();
        let far = PoseChange { position: [i32::MAX, 0, 0], ..PoseChange::default() };
        MoveModel::default().encode(&mut encoder, &mut MoveContext::default(), Move::Moved(far));
        assert!(error(joins(vec![ball]), encoder.finish()).starts_with("a ball moves 262144.0 m in one step"));
    }

    proptest! {
        #[test]
        fn any_steps_are_decoded_or_rejected(first_tick in any::<u64>(), heads in proptest::collection::vec(any::<u8>(), 0..100), moves in proptest::collection::vec(any::<u8>(), 0..50)) {
            if let Ok(heads) = postcard::from_bytes(&heads) {
                let _ = StepCodec::default().decode(EncodedSteps { first_tick: first_tick / 2, heads, moves }, DT_SECS);
            }
        }
    }
}
