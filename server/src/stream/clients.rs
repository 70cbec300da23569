//! The connected clients: state shared between the sessions and the streamer.

use crate::world::Camera;
use bytes::Bytes;
use prairie_core::grid::PatchIndex;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering::Relaxed};
use std::sync::{Arc, Mutex, PoisonError};
use tokio::sync::{Notify, mpsc};

/// One publication, as sent to one client.
#[derive(Clone, Debug, Default)]
pub struct Frame {
    /// Number of the frame for this client, from 1.
    pub number: u32,
    /// Messages in order; the last one ends the frame.
    pub messages: Vec<Bytes>,
}

/// Area around a client's camera in which grass is streamed to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AreaOfInterest {
    /// Camera position (m).
    pub eye_m: [f32; 3],
    /// Radius of the area (m).
    pub radius_m: f32,
}

/// Difference between a client's replica and the server's grass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Difference {
    /// Tick after which they differ.
    pub tick: u64,
    /// A patch that differs.
    pub patch: PatchIndex,
}

/// Numbers of frames, per client.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Progress {
    /// Newest frame handed to the session.
    pub handed_out: u32,
    /// Newest frame written to the socket completely.
    pub written: u32,
    /// Newest acknowledged frame.
    pub acknowledged: u32,
}

/// A connected client, after its hello.
#[derive(Debug)]
pub struct Client {
    /// Number of the client, unique within a run.
    pub id: u32,
    name: Mutex<String>,
    outbox: mpsc::Sender<Frame>,
    area: Mutex<Option<AreaOfInterest>>,
    handed_out: AtomicU32,
    written: AtomicU32,
    acknowledged: AtomicU32,
    sent_bytes: AtomicU64,
    replaced: Notify,
    /// Twice the number of its requests, plus 1 if the newest is for a replica of the grass.
    replica_request: AtomicU32,
    difference: Mutex<Option<Difference>>,
    sent_bytes_to_all: Arc<AtomicU64>,
}

impl Client {
    /// Display name.
    pub fn name(&self) -> String {
        self.name.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Changes the display name.
    pub fn rename(&self, name: String) {
        *self.name.lock().unwrap_or_else(PoisonError::into_inner) = name;
    }

    /// Sets the area of interest.
    pub fn set_area_of_interest(&self, area: AreaOfInterest) {
        *self.area.lock().unwrap_or_else(PoisonError::into_inner) = Some(area);
    }

    /// The area of interest; `None` before the first view message.
    pub fn area_of_interest(&self) -> Option<AreaOfInterest> {
        *self.area.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The camera, as a view for the world.
    pub fn camera(&self) -> Option<Camera> {
        self.area_of_interest().map(|area| Camera { client: self.id, eye_m: area.eye_m })
    }

    /// Records an acknowledgement; false if that frame was never sent.
    pub fn acknowledge(&self, frame: u32) -> bool {
        let was_sent = frame <= self.handed_out.load(Relaxed);
        if was_sent {
            self.acknowledged.fetch_max(frame, Relaxed);
        }
        was_sent
    }

    /// Notes that a frame has been written to the socket.
    pub fn note_written(&self, frame: u32) {
        self.written.store(frame, Relaxed);
    }

    /// The newest frames.
    pub fn progress(&self) -> Progress {
        Progress {
            handed_out: self.handed_out.load(Relaxed),
            written: self.written.load(Relaxed),
            acknowledged: self.acknowledged.load(Relaxed),
        }
    }

    /// Number of frames in flight: handed to the session and not acknowledged.
    pub fn in_flight(&self) -> u32 {
        self.handed_out.load(Relaxed).saturating_sub(self.acknowledged.load(Relaxed))
    }

    /// Hands a frame to the session; false if the session is busy or gone.
    pub fn hand_out(&self, frame: Frame) -> bool {
        let number = frame.number;
        self.handed_out.store(number, Relaxed);
        let taken = self.outbox.try_send(frame).is_ok();
        if !taken {
            self.handed_out.store(number - 1, Relaxed);
        }
        taken
    }

    /// Requests a replica of the grass, from its state on, or none.
    pub fn request_replica(&self, wanted: bool) {
        let next = |request: u32| Some((request & !1).wrapping_add(2) | u32::from(wanted));
        let _ = self.replica_request.fetch_update(Relaxed, Relaxed, next);
    }

    /// The newest request: a value that differs from those before, and whether it is for a replica.
    pub fn replica_request(&self) -> (u32, bool) {
        let request = self.replica_request.load(Relaxed);
        (request, request & 1 == 1)
    }

    /// Reports that the client's replica differs from the server's grass.
    pub fn report_difference(&self, difference: Difference) {
        *self.difference.lock().unwrap_or_else(PoisonError::into_inner) = Some(difference);
    }

    /// The newest difference that was reported since the last call.
    pub fn take_difference(&self) -> Option<Difference> {
        self.difference.lock().unwrap_or_else(PoisonError::into_inner).take()
    }

    /// Counts bytes written to the client's socket.
    pub fn count_sent(&self, bytes: usize) {
        self.sent_bytes.fetch_add(bytes as u64, Relaxed);
        self.sent_bytes_to_all.fetch_add(bytes as u64, Relaxed);
    }

    /// Completes when the client is back on another connection.
    pub async fn replaced(&self) {
        self.replaced.notified().await;
    }

    /// Bytes written to the client's socket so far.
    pub fn sent_bytes(&self) -> u64 {
        self.sent_bytes.load(Relaxed)
    }
}

/// All clients, by number.
#[derive(Debug, Default)]
pub struct Clients {
    table: Mutex<BTreeMap<u32, Arc<Client>>>,
    newest_id: AtomicU32,
    sent_bytes: Arc<AtomicU64>,
}

impl Clients {
    /// An unused client number.
    pub fn next_id(&self) -> u32 {
        self.newest_id.fetch_add(1, Relaxed) + 1
    }

    /// Numbers from `first` on; call it before the first client joins.
    pub fn starting_at(first: u32) -> Self {
        Self { newest_id: AtomicU32::new(first.saturating_sub(1)), ..Self::default() }
    }

    /// Adds a client, in place of any with its number, which gets frames from now on; at most `outbox_frames` of them are queued for its session.
    pub fn join(&self, id: u32, name: String, outbox_frames: usize) -> (Arc<Client>, mpsc::Receiver<Frame>) {
        let (outbox, frames) = mpsc::channel(outbox_frames);
        let client = Arc::new(Client {
            id,
            name: Mutex::new(name),
            outbox,
            area: Mutex::default(),
            handed_out: AtomicU32::default(),
            written: AtomicU32::default(),
            acknowledged: AtomicU32::default(),
            sent_bytes: AtomicU64::default(),
            replaced: Notify::new(),
            replica_request: AtomicU32::default(),
            sent_bytes_to_all: self.sent_bytes.clone(),
            difference: Mutex::default(),
        });
        if let Some(before) = self.lock().insert(id, client.clone()) {
            before.replaced.notify_one();
        }
        (client, frames)
    }

    /// Removes a client; false if another with its number is in its place.
    pub fn leave(&self, client: &Arc<Client>) -> bool {
        let mut table = self.lock();
        let is_present = table.get(&client.id).is_some_and(|present| Arc::ptr_eq(present, client));
        if is_present {
            table.remove(&client.id);
        }
        is_present
    }

    /// All clients, in the order of joining.
    pub fn all(&self) -> Vec<Arc<Client>> {
        self.lock().values().cloned().collect()
    }

    /// Bytes written so far to the sockets of all clients, including those that have left.
    pub fn sent_bytes(&self) -> u64 {
        self.sent_bytes.load(Relaxed)
    }

    /// Cameras of all clients, for the world.
    pub fn cameras(&self) -> Vec<Camera> {
        self.lock().values().filter_map(|client| client.camera()).collect()
    }

    /// Number of clients.
    pub fn count(&self) -> usize {
        self.lock().len()
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, BTreeMap<u32, Arc<Client>>> {
        self.table.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
