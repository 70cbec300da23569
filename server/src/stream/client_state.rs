//! The streamer's state of one client: the frames known to the client, its byte budget, and the frames in flight.

use super::announcement::{ANNOUNCEMENTS, Announced};
use super::area::{PATCH_LIMIT, patches_near};
use super::clients::{AreaOfInterest, Client, Frame};
use super::encoder::Encoder;
use super::following::Following;
use super::step_log::StepLog;
use crate::snapshot::Snapshot;
use crate::token_bucket::TokenBucket;
use bytes::Bytes;
use prairie_core::grid::{PatchIndex, PatchLayout};
use prairie_core::wire::{self, AppliedInput, PATCH_MEMORY, ServerMessage};
use std::collections::HashMap;
use std::time::{Duration, Instant};

/// Time between frames that say nothing new, which keep the client's clock: longer than what its clock takes for the interval of the publications.
const QUIET_PERIOD: Duration = Duration::from_millis(480);

/// Time without wind after which no more is expected.
const CALM_AFTER: Duration = Duration::from_secs(1);

/// Limits on the data sent to one client.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SendLimits {
    /// Largest number of unacknowledged frames in flight. Default 4: at 20 frames per second, a client with a round trip of 200 ms still
    /// gets all of them.
    pub in_flight: u32,
    /// Mean data rate (bytes/s); bursts of one second are allowed. Default 250 000.
    pub bytes_per_s: f64,
}

impl Default for SendLimits {
    fn default() -> Self {
        Self { in_flight: 4, bytes_per_s: 250_000.0 }
    }
}

impl SendLimits {
    /// These limits with at most so much data (kbit/s), if there is such a limit.
    pub fn within_kbit_per_s(self, kbit_per_s: Option<f32>) -> Self {
        let limit = kbit_per_s.map_or(f64::INFINITY, |kbit_per_s| 125.0 * f64::from(kbit_per_s));
        Self { bytes_per_s: self.bytes_per_s.min(limit), ..self }
    }
}

/// A publication: the data that the frames of all clients share.
#[derive(Debug)]
pub struct Publication<'a> {
    /// The published state.
    pub snapshot: &'a Snapshot,
    /// Layout of the patches.
    pub layout: &'a PatchLayout,
    /// Time of the publication, for the budgets.
    pub now: Instant,
    /// The encoded poses message.
    pub poses: Bytes,
    /// Version of the poses: another one when any has changed.
    pub poses_version: u64,
    /// Messages that all clients get when they change: roster, race, and ghost.
    pub announced: [Announced; ANNOUNCEMENTS],
    /// The newest steps.
    pub steps: &'a StepLog,
}

const _: () = assert!(PATCH_LIMIT <= PATCH_MEMORY, "a client can hold its whole area of interest");

/// The frame of a patch that a client holds.
#[derive(Clone, Copy, Debug)]
struct Held {
    seq: u32,
    /// Number of the patch message that contained it, per client.
    message: u64,
}

/// The streamer's state of one client.
#[derive(Debug)]
pub struct ClientState {
    limits: SendLimits,
    budget: TokenBucket,
    frame: u32,
    /// The patches sent last, at most [`PATCH_MEMORY`]: the client certainly holds these.
    held: HashMap<PatchIndex, Held>,
    following: Following,
    patch_messages: u64,
    held_wind: Option<u32>,
    /// Version of the poses that were sent last, and when.
    sent_poses: Option<(u64, Instant)>,
    /// When wind was sent last.
    sent_wind: Option<Instant>,
    /// Version of each announcement that was sent.
    held_announced: [u64; ANNOUNCEMENTS],
    /// The newest input of the client's vehicle that was reported.
    reported: Option<AppliedInput>,
    /// Number of broken plants sent, in the order of breaking.
    sent_broken: usize,
    area: Option<AreaOfInterest>,
    /// The patches of `area`, nearest first.
    wanted: Vec<PatchIndex>,
}

impl ClientState {
    /// The state of a client that holds nothing yet.
    pub fn new(limits: SendLimits, now: Instant) -> Self {
        Self {
            limits,
            budget: TokenBucket::new(limits.bytes_per_s, limits.bytes_per_s, now),
            frame: 0,
            held: HashMap::new(),
            following: Following::default(),
            patch_messages: 0,
            held_wind: None,
            sent_poses: None,
            sent_wind: None,
            held_announced: [0; ANNOUNCEMENTS],
            reported: None,
            sent_broken: 0,
            area: None,
            wanted: Vec::new(),
        }
    }

    /// Sends the newest state to a client; returns the bytes of the frame, 0 if there is nothing to say, or `None` if too many frames
    /// are in flight. Poses are always sent, the same ones twice a second; broken plants, wind, patches (nearest first) and the parts of a replica's state as far as the budget allows, the
    /// rest with a later frame. A client with a replica gets all steps instead of poses and patches. `extra` is a message for this client alone.
    pub fn send_frame(
        &mut self,
        client: &Client,
        publication: &Publication<'_>,
        encoder: &mut Encoder,
        extra: Option<Bytes>,
    ) -> Option<usize> {
        if self.following.update(client, publication.steps, publication.now) {
            self.held.clear();
        }
        if client.in_flight() >= self.limits.in_flight {
            return None;
        }
        let snapshot = publication.snapshot;
        self.budget.fill(publication.now);
        self.set_area(client.area_of_interest(), publication.layout);
        let has_replica = self.following.has_replica();
        let mut messages: Vec<Bytes> = if has_replica { vec![] } else { vec![publication.poses.clone()] };
        messages.extend(extra);
        let applied = snapshot.inputs.get(&client.id).copied();
        messages.extend(applied.filter(|_| applied != self.reported).map(|input| wire::encode(&ServerMessage::Applied(input)).into()));
        let newer = publication.announced.iter().zip(self.held_announced).filter(|(announced, held)| announced.version != *held);
        messages.extend(newer.map(|(announced, _)| announced.message.clone()));
        self.budget.charge(messages.iter().map(Bytes::len).sum::<usize>() as f64);
        let broken = encoder.broken(snapshot, self.sent_broken);
        let broken = broken.filter(|(_, message)| self.budget.try_overdraw(message.len() as f64));
        messages.extend(broken.iter().map(|(_, message)| message.clone()));
        let (grass, wind, patches) = if has_replica {
            let Some((steps, wind)) = self.following.steps(publication.steps, !messages.is_empty(), publication.now) else {
                return Some(0);
            };
            self.budget.charge(steps.iter().map(Bytes::len).sum::<usize>() as f64);
            (steps, wind, vec![])
        } else {
            self.patches(publication, encoder)
        };
        messages.extend(grass);
        if !has_replica && messages.len() == 1 && self.is_quiet(publication) {
            return Some(0);
        }
        let number = self.frame + 1;
        let end = ServerMessage::FrameEnd { frame: number, tick: snapshot.tick, time_secs: snapshot.time_secs };
        let end: Bytes = wire::encode(&end).into();
        self.budget.charge(end.len() as f64);
        messages.push(end);
        let bytes = messages.iter().map(Bytes::len).sum();
        if !client.hand_out(Frame { number, messages }) {
            if !has_replica {
                self.following.restart();
            }
            return None;
        }
        self.reported = applied;
        self.sent_broken = broken.map_or(self.sent_broken, |(count, _)| count);
        self.note_sent(publication, number, wind);
        self.hold(patches);
        Some(bytes)
    }

    /// Notes what every frame carries, and the number of its wind.
    fn note_sent(&mut self, publication: &Publication<'_>, number: u32, wind: Option<u32>) {
        self.following.note_sent(publication.steps, publication.now);
        self.frame = number;
        self.sent_poses = Some((publication.poses_version, publication.now));
        self.held_announced = publication.announced.each_ref().map(|announced| announced.version);
        self.sent_wind = if wind.is_some() { Some(publication.now) } else { self.sent_wind };
        self.held_wind = wind.or(self.held_wind);
    }

    /// Whether the poses are those that were sent last, a moment ago, and no wind blows: with wind, frames come so often that the client would take the time
    /// between them for that of the publications, and show vehicles so much later.
    fn is_quiet(&self, publication: &Publication<'_>) -> bool {
        let is_recent = |at: Instant| publication.now.duration_since(at) < QUIET_PERIOD;
        let is_calm = self.sent_wind.is_none_or(|at| publication.now.duration_since(at) > CALM_AFTER);
        is_calm && self.sent_poses.is_some_and(|(version, at)| version == publication.poses_version && is_recent(at))
    }

    /// Messages of patches, wind and the parts of a replica's state, as far as the budget allows; the number of the wind frame, and the patches sent.
    fn patches(&mut self, publication: &Publication<'_>, encoder: &mut Encoder) -> (Vec<Bytes>, Option<u32>, Vec<(PatchIndex, u32)>) {
        let snapshot = publication.snapshot;
        let newer = encoder.wind(snapshot, self.held_wind);
        let wind = newer.filter(|(_, message)| self.budget.try_overdraw(message.len() as f64));
        let (mut messages, mut patches) = (Vec::new(), Vec::new());
        for &patch in self.wanted.iter().filter(|patch| snapshot.audience.takes(**patch)) {
            let held = self.held.get(&patch).map(|held| held.seq);
            let Some((seq, message)) = encoder.patch(snapshot, patch, held) else { continue };
            if !self.budget.try_overdraw(message.len() as f64) {
                break;
            }
            messages.push(message);
            patches.push((patch, seq));
        }
        messages.extend(wind.iter().map(|(_, message)| message.clone()));
        let mut wind = wind.map(|(seq, _)| seq);
        messages.extend(self.following.parts(publication.steps, |bytes| self.budget.try_overdraw(bytes as f64)));
        if let Some((steps, newest)) = self.following.catch_up(publication.steps) {
            self.budget.charge(steps.iter().map(Bytes::len).sum::<usize>() as f64);
            messages.extend(steps);
            wind = newest.or(wind);
        }
        (messages, wind, patches)
    }

    /// Whether the client waits for a state of the grass.
    pub fn wants_state(&self) -> bool {
        self.following.wants_state()
    }

    /// Whether the client has a replica of the grass.
    pub fn has_replica(&self) -> bool {
        self.following.has_replica()
    }

    /// Patches that the client takes, none with a replica.
    pub fn taken(&self) -> &[PatchIndex] {
        if self.has_replica() { &[] } else { &self.wanted }
    }

    /// Number of patches that the client certainly holds.
    pub fn held_patches(&self) -> usize {
        self.held.len()
    }

    fn hold(&mut self, sent: Vec<(PatchIndex, u32)>) {
        for (patch, seq) in sent {
            self.patch_messages += 1;
            self.held.insert(patch, Held { seq, message: self.patch_messages });
        }
        if let Some(surplus) = self.held.len().checked_sub(PATCH_MEMORY + 1) {
            let mut messages: Vec<u64> = self.held.values().map(|held| held.message).collect();
            let newest_forgotten = *messages.select_nth_unstable(surplus).1;
            self.held.retain(|_, held| held.message > newest_forgotten);
        }
    }

    fn set_area(&mut self, area: Option<AreaOfInterest>, layout: &PatchLayout) {
        if area != self.area {
            self.area = area;
            self.wanted = area.map_or_else(Vec::new, |area| patches_near(layout, [area.eye_m[0], area.eye_m[2]], area.radius_m));
        }
    }
}
