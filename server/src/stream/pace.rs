//! How one client is served: what it holds, how much may be under way, what it may cost.

use super::clients::{Client, Frame, Gaze};
use super::encoder::Encoder;
use super::interest::{PATCH_LIMIT, interest};
use crate::bucket::Bucket;
use crate::snapshot::Snapshot;
use bytes::Bytes;
use shared::grid::{PatchIndex, PatchLayout};
use shared::wire::{self, PATCH_MEMORY, ServerMessage};
use std::collections::HashMap;
use std::time::Instant;

/// Limits on what is sent to one client.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SendLimits {
    /// Most frames that are on their way without an acknowledgement. Default 4: with 20 frames a second a client 200 ms away still gets all
    /// of them.
    pub in_flight: u32,
    /// Mean rate of the frames (bytes/s); bursts of one second are allowed. Default 250 000.
    pub bytes_per_sec: f64,
}

impl Default for SendLimits {
    fn default() -> Self {
        Self { in_flight: 4, bytes_per_sec: 250_000.0 }
    }
}

/// What every frame of a publish has in common.
#[derive(Debug)]
pub struct Common<'a> {
    /// The state to show.
    pub snapshot: &'a Snapshot,
    /// The grid of patches.
    pub layout: &'a PatchLayout,
    /// Time of the publish, for the budgets.
    pub now: Instant,
    /// The poses.
    pub poses: Bytes,
    /// Version of the roster.
    pub roster_version: u64,
    /// The roster.
    pub roster: Bytes,
}

const _: () = assert!(PATCH_LIMIT <= PATCH_MEMORY, "a client holds at least all that it wants");

/// What a client holds of a patch.
#[derive(Clone, Copy, Debug)]
struct Held {
    seq: u32,
    /// Number of the message that brought it, per client.
    message: u64,
}

/// The streamer's memory of one client.
#[derive(Debug)]
pub struct Pace {
    limits: SendLimits,
    budget: Bucket,
    frame: u32,
    /// The patches that it was sent last, at most [`PATCH_MEMORY`]: these it holds for certain.
    held: HashMap<PatchIndex, Held>,
    patch_messages: u64,
    held_wind: Option<u32>,
    held_roster: u64,
    /// How many of the broken plants it was told of, in the order of their breaking.
    told_broken: usize,
    gaze: Option<Gaze>,
    wanted: Vec<PatchIndex>,
}

impl Pace {
    /// A client that holds nothing yet.
    pub fn new(limits: SendLimits, now: Instant) -> Self {
        Self {
            limits,
            budget: Bucket::new(limits.bytes_per_sec, limits.bytes_per_sec, now),
            frame: 0,
            held: HashMap::new(),
            patch_messages: 0,
            held_wind: None,
            held_roster: 0,
            told_broken: 0,
            gaze: None,
            wanted: Vec::new(),
        }
    }

    /// Sends the newest state to a client, unless as much as allowed is on its way already; then it gets a newer state later.
    /// Poses always go; broken plants, wind and patches, nearest first, as far as the budget lasts, the rest with a later frame. `extra` is for this client alone.
    pub fn serve(&mut self, client: &Client, common: &Common<'_>, encoder: &mut Encoder, extra: Option<Bytes>) -> bool {
        if client.in_flight() >= self.limits.in_flight {
            return false;
        }
        let snapshot = common.snapshot;
        self.budget.fill(common.now);
        self.want(client.gaze(), common.layout);
        let mut messages = vec![common.poses.clone()];
        messages.extend(extra);
        if self.held_roster != common.roster_version {
            messages.push(common.roster.clone());
        }
        self.budget.charge(messages.iter().map(Bytes::len).sum::<usize>() as f64);
        let broken = encoder.broken(snapshot, self.told_broken);
        let broken = broken.filter(|(_, message)| self.budget.try_overdraw(message.len() as f64));
        messages.extend(broken.iter().map(|(_, message)| message.clone()));
        let wind = encoder.wind(snapshot, self.held_wind).filter(|(_, message)| self.budget.try_overdraw(message.len() as f64));
        let mut patches = Vec::new();
        for &patch in &self.wanted {
            let held = self.held.get(&patch).map(|held| held.seq);
            let Some((seq, message)) = encoder.patch(snapshot, patch, held) else { continue };
            if !self.budget.try_overdraw(message.len() as f64) {
                break;
            }
            messages.push(message);
            patches.push((patch, seq));
        }
        messages.extend(wind.iter().map(|(_, message)| message.clone()));
        let number = self.frame + 1;
        let end = ServerMessage::FrameEnd { frame: number, tick: snapshot.tick, time_secs: snapshot.time_secs };
        let end: Bytes = wire::encode(&end).into();
        self.budget.charge(end.len() as f64);
        messages.push(end);
        if !client.hand_out(Frame { number, messages }) {
            return false;
        }
        self.frame = number;
        self.held_roster = common.roster_version;
        self.told_broken = broken.map_or(self.told_broken, |(known, _)| known);
        self.held_wind = wind.map(|(seq, _)| seq).or(self.held_wind);
        self.hold(patches);
        true
    }

    /// Patches that the client is known to hold.
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

    fn want(&mut self, gaze: Option<Gaze>, layout: &PatchLayout) {
        if gaze != self.gaze {
            self.gaze = gaze;
            self.wanted = gaze.map_or_else(Vec::new, |gaze| interest(layout, [gaze.eye_m[0], gaze.eye_m[2]], gaze.radius_m));
        }
    }
}
