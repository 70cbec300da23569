//! Who is connected: what sessions and the streamer tell each other about a client.

use crate::world::View;
use bytes::Bytes;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering::Relaxed};
use std::sync::{Arc, Mutex, PoisonError};
use tokio::sync::mpsc;

/// One publish as one client gets it.
#[derive(Clone, Debug, Default)]
pub struct Frame {
    /// Number of the frame, per client, from 1.
    pub number: u32,
    /// Messages in order; the last one ends the frame.
    pub messages: Vec<Bytes>,
}

/// Where a client looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gaze {
    /// Camera position (m).
    pub eye_m: [f32; 3],
    /// Distance up to which the bend field is wanted (m).
    pub radius_m: f32,
}

/// A client that has said hello.
#[derive(Debug)]
pub struct Client {
    /// Number of the client, unique within a run.
    pub id: u32,
    name: Mutex<String>,
    outbox: mpsc::Sender<Frame>,
    gaze: Mutex<Option<Gaze>>,
    handed_out: AtomicU32,
    acknowledged: AtomicU32,
    sent_bytes: AtomicU64,
    sent_bytes_to_all: Arc<AtomicU64>,
}

impl Client {
    /// Name to show to others.
    pub fn name(&self) -> String {
        self.name.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Gives the client another name.
    pub fn rename(&self, name: String) {
        *self.name.lock().unwrap_or_else(PoisonError::into_inner) = name;
    }

    /// Tells where the client looks.
    pub fn look(&self, gaze: Gaze) {
        *self.gaze.lock().unwrap_or_else(PoisonError::into_inner) = Some(gaze);
    }

    /// Where the client looks; none until it has said so.
    pub fn gaze(&self) -> Option<Gaze> {
        *self.gaze.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Its camera, as the world is told of it.
    pub fn view(&self) -> Option<View> {
        self.gaze().map(|gaze| View { client: self.id, eye_m: gaze.eye_m })
    }

    /// Notes an acknowledgement; false if that frame was never sent.
    pub fn acknowledge(&self, frame: u32) -> bool {
        let possible = frame <= self.handed_out.load(Relaxed);
        if possible {
            self.acknowledged.fetch_max(frame, Relaxed);
        }
        possible
    }

    /// Newest frame handed to the session, and newest frame acknowledged.
    pub fn progress(&self) -> (u32, u32) {
        (self.handed_out.load(Relaxed), self.acknowledged.load(Relaxed))
    }

    /// Frames that are on their way: handed to the session and not acknowledged.
    pub fn in_flight(&self) -> u32 {
        let (handed_out, acknowledged) = self.progress();
        handed_out.saturating_sub(acknowledged)
    }

    /// Hands a frame to the session; false if it takes none, being full or gone.
    pub fn hand_out(&self, frame: Frame) -> bool {
        let number = frame.number;
        self.handed_out.store(number, Relaxed);
        let taken = self.outbox.try_send(frame).is_ok();
        if !taken {
            self.handed_out.store(number - 1, Relaxed);
        }
        taken
    }

    /// Counts bytes written to the client's socket.
    pub fn count_sent(&self, bytes: usize) {
        self.sent_bytes.fetch_add(bytes as u64, Relaxed);
        self.sent_bytes_to_all.fetch_add(bytes as u64, Relaxed);
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
    /// A number that no client has had.
    pub fn next_id(&self) -> u32 {
        self.newest_id.fetch_add(1, Relaxed) + 1
    }

    /// Adds a client, which from now on gets frames: at most `outbox_frames` wait for the session at once.
    pub fn join(&self, id: u32, name: String, outbox_frames: usize) -> (Arc<Client>, mpsc::Receiver<Frame>) {
        let (outbox, frames) = mpsc::channel(outbox_frames);
        let client = Arc::new(Client {
            id,
            name: Mutex::new(name),
            outbox,
            gaze: Mutex::default(),
            handed_out: AtomicU32::default(),
            acknowledged: AtomicU32::default(),
            sent_bytes: AtomicU64::default(),
            sent_bytes_to_all: self.sent_bytes.clone(),
        });
        self.lock().insert(id, client.clone());
        (client, frames)
    }

    /// Removes a client.
    pub fn leave(&self, id: u32) {
        self.lock().remove(&id);
    }

    /// Everyone who is here, in the order of coming.
    pub fn all(&self) -> Vec<Arc<Client>> {
        self.lock().values().cloned().collect()
    }

    /// Bytes written so far to the sockets of all clients, those that have left included.
    pub fn sent_bytes(&self) -> u64 {
        self.sent_bytes.load(Relaxed)
    }

    /// Number of clients.
    pub fn count(&self) -> usize {
        self.lock().len()
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, BTreeMap<u32, Arc<Client>>> {
        self.table.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
