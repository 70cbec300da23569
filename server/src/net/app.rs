//! State shared by all requests and sessions.

use super::admission::Admission;
use super::field_sampler::FieldSampler;
use super::origin::Access;
use super::page_errors::PageErrors;
use super::proofs::Proofs;
use crate::config::Limits;
use crate::journal::Health;
use crate::log_limit::LogLimit;
use crate::metrics::ServerStats;
use crate::runner::{Attendance, Published};
use crate::scene_menu::SceneMenu;
use crate::scenes::Explanation;
use crate::stream::{Clients, Counters};
use crate::world::Command;
use bytes::Bytes;
use std::sync::Arc;
use std::sync::atomic::Ordering::Relaxed;
use std::time::Instant;
use tokio::sync::{Semaphore, mpsc, watch};

/// Most log messages of one kind about sessions in ten seconds.
const SESSION_LINES: u32 = 50;

/// Rate limits of the log messages about sessions, so that a client that reconnects all the time cannot fill the log.
#[derive(Debug)]
pub(crate) struct SessionLog {
    pub(crate) joined: LogLimit,
    pub(crate) left: LogLimit,
    pub(crate) closed: LogLimit,
}

impl Default for SessionLog {
    fn default() -> Self {
        let [joined, left, closed] = [SESSION_LINES; 3].map(LogLimit::of);
        Self { joined, left, closed }
    }
}

/// State shared by all requests and sessions.
#[derive(Debug)]
pub(crate) struct App {
    pub(crate) clients: Arc<Clients>,
    pub(crate) counters: Arc<Counters>,
    pub(crate) published: watch::Receiver<Arc<Published>>,
    pub(crate) commands: mpsc::Sender<Command>,
    pub(crate) attendance: Arc<Attendance>,
    /// Budget of a tick, in place of the scene's (ms).
    pub(crate) budget_ms: watch::Sender<Option<f32>>,
    pub(crate) proofs: Proofs,
    pub(crate) scene_name: String,
    /// What the scene models, by which methods, and what is planned.
    pub(crate) explanation: Arc<Explanation>,
    pub(crate) scene_menu: SceneMenu,
    /// The encoded scene message, the same for all clients.
    pub(crate) scene: Bytes,
    pub(crate) limits: Limits,
    /// State of the journal's files; that of an unused journal without memory.
    pub(crate) journal: Arc<Health>,
    /// Sampler of the fields, for the HTTP API.
    pub(crate) fields: FieldSampler,
    /// Steps of the world per second (Hz).
    pub(crate) tick_hz: f32,
    /// Hosts and origins that requests may name.
    pub(crate) access: Access,
    /// Limits per remote address.
    pub(crate) admission: Arc<Admission>,
    /// Gate of the errors that pages report; `None` if they are discarded.
    pub(crate) page_errors: Option<PageErrors>,
    /// One permit per additional client.
    pub(crate) client_slots: Arc<Semaphore>,
    /// One permit per additional WebSocket before its hello.
    pub(crate) pending_slots: Arc<Semaphore>,
    /// Rate limits of the sessions' log messages.
    pub(crate) session_log: SessionLog,
    /// True as soon as the server stops.
    pub(crate) stopping: watch::Receiver<bool>,
    pub(crate) started: Instant,
}

impl App {
    /// The server's own metrics.
    pub(crate) fn stats(&self, published: &Published) -> ServerStats {
        ServerStats {
            clients: self.clients.count() as u32,
            uptime_secs: self.started.elapsed().as_secs_f64(),
            dropped_secs: published.dropped_secs,
            sent_bytes: self.clients.sent_bytes(),
            encodings: self.counters.encodings.load(Relaxed),
            cached_patches: self.counters.cached_patches.load(Relaxed),
            held_patches: self.counters.held_patches.load(Relaxed),
            frames: self.counters.frames.load(Relaxed),
            replicas: self.counters.replicas.load(Relaxed),
            differences: self.counters.differences.load(Relaxed),
            skipped_frames: self.counters.skipped_frames.load(Relaxed),
            rejected_connections: self.admission.rejected_connections.load(Relaxed),
            rate_limited_connections: self.admission.rate_limited_connections.load(Relaxed),
            journal: self.journal.stats(),
            step_secs: published.step_secs.clone(),
            frame_bytes: self.counters.frame_bytes(),
        }
    }
}
