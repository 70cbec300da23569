//! A client's way to a replica of the grass: from patches, over the parts of a state, to the causes of steps.

use super::clients::Client;
use super::step_log::{EncodedState, Entry, StepLog};
use bytes::Bytes;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Shortest time between two states that one client is sent, whatever it asks for.
const STATE_PAUSE: Duration = Duration::from_secs(5);
/// Longest time without a frame to a client whose replica has nothing to learn.
const HEARTBEAT: Duration = Duration::from_secs(1);

/// A client's progress.
#[derive(Debug, Default)]
enum Progress {
    /// It gets patches.
    #[default]
    Patches,
    /// It gets patches until there is a state to send.
    Waiting,
    /// It gets patches, and parts of a state.
    Receiving {
        state: Arc<EncodedState>,
        /// Number of parts sent.
        sent: usize,
    },
    /// It has a replica, and gets steps.
    Steps {
        /// Number of the next entry of the log.
        next_entry: u64,
    },
}

/// How a client follows the grass.
#[derive(Debug, Default)]
pub struct Following {
    progress: Progress,
    /// Its newest request that was answered.
    request: u32,
    /// Time of the newest state, and of the newest frame of steps.
    state_at: Option<Instant>,
    frame_at: Option<Instant>,
}

impl Following {
    /// Takes in the client's newest request. Returns whether it has just lost its replica, so that it holds no patches.
    pub(super) fn update(&mut self, client: &Client, log: &StepLog, now: Instant) -> bool {
        let (request, is_wanted) = client.replica_request();
        let had_replica = self.has_replica();
        let is_lost = matches!(self.progress, Progress::Steps { next_entry } if log.since(next_entry).is_none());
        let may_start = self.state_at.is_none_or(|at| now.duration_since(at) >= STATE_PAUSE);
        if request != self.request || is_lost {
            self.progress = Progress::Patches;
        }
        if is_wanted && matches!(self.progress, Progress::Patches) && may_start {
            self.progress = Progress::Waiting;
        }
        self.request = request;
        if let (Progress::Waiting, Some(state)) = (&self.progress, log.state()) {
            self.progress = Progress::Receiving { state: state.clone(), sent: 0 };
            self.state_at = Some(now);
        }
        had_replica && !self.has_replica()
    }

    /// Whether the client has a replica.
    pub(super) fn has_replica(&self) -> bool {
        matches!(self.progress, Progress::Steps { .. })
    }

    /// Whether the client waits for a state.
    pub(super) fn wants_state(&self) -> bool {
        matches!(self.progress, Progress::Waiting)
    }

    /// Waits for another state: the client has missed a part of this one.
    pub(super) fn restart(&mut self) {
        if let Progress::Receiving { .. } | Progress::Steps { .. } = self.progress {
            self.progress = Progress::Waiting;
        }
    }

    /// The next parts of the state for which `pay` is true. A state that can no longer be caught up with is given up.
    pub(super) fn parts(&mut self, log: &StepLog, mut pay: impl FnMut(usize) -> bool) -> Vec<Bytes> {
        let Progress::Receiving { state, sent } = &mut self.progress else { return vec![] };
        if log.since(state.next_entry).is_none() {
            self.progress = Progress::Patches;
            return vec![];
        }
        let messages: Vec<Bytes> = state.parts[*sent..].iter().take_while(|part| pay(part.len())).cloned().collect();
        *sent += messages.len();
        messages
    }

    /// After the last part, the wind of the state, and all winds and steps since, so that the replica is complete with this frame whatever frames the client has
    /// missed meanwhile; with the number of the newest wind frame in them.
    pub(super) fn catch_up(&mut self, log: &StepLog) -> Option<(Vec<Bytes>, Option<u32>)> {
        let Progress::Receiving { state, sent } = &self.progress else { return None };
        if *sent < state.parts.len() {
            return None;
        }
        let (since, newest) = messages_of(log.since(state.next_entry)?);
        let (first, wind) = state.wind.clone().unzip();
        let messages = wind.into_iter().chain(since).collect();
        self.progress = Progress::Steps { next_entry: log.next_entry() };
        Some((messages, newest.or(first)))
    }

    /// Messages of the entries that a client with a replica has not got, and the number of the newest wind frame in them; `None` when there is nothing to say.
    pub(super) fn steps(&mut self, log: &StepLog, must_send: bool, now: Instant) -> Option<(Vec<Bytes>, Option<u32>)> {
        let Progress::Steps { next_entry } = self.progress else { return None };
        let is_due = must_send || self.frame_at.is_none_or(|at| now.duration_since(at) >= HEARTBEAT);
        let (messages, wind) = messages_of(log.since(next_entry)?);
        (is_due || !messages.is_empty()).then_some((messages, wind))
    }

    /// Notes that the messages of [`steps`](Self::steps) have been handed out.
    pub(super) fn note_sent(&mut self, log: &StepLog, now: Instant) {
        if let Progress::Steps { next_entry } = &mut self.progress {
            *next_entry = log.next_entry();
        }
        self.frame_at = Some(now);
    }
}

/// Messages of entries, and the number of the newest wind frame in them.
fn messages_of<'a>(entries: impl Iterator<Item = &'a Entry>) -> (Vec<Bytes>, Option<u32>) {
    let (mut messages, mut wind) = (Vec::new(), None);
    for entry in entries {
        if let Some((seq, message)) = &entry.wind {
            messages.push(message.clone());
            wind = Some(*seq);
        }
        messages.extend(entry.steps.clone());
    }
    (messages, wind)
}
