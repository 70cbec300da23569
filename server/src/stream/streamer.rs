//! The streaming thread: turns each published snapshot into frames for all clients.

use super::announcement::{ANNOUNCEMENTS, Announced, Announcement};
use super::client_state::{ClientState, Publication, SendLimits};
use super::clients::{Client, Clients, Difference};
use super::encoder::Encoder;
use super::step_log::StepLog;
use crate::histogram::Histogram;
use crate::log_limit::LogLimit;
use crate::runner::{Attendance, Published};
use crate::snapshot::{Audience, Snapshot};
use crate::world::{Camera, Command};
use bytes::Bytes;
use prairie_core::grid::PatchLayout;
use prairie_core::wire::{self, Ghost, ObjectPose, Peer, Refusal, ServerMessage, Standing};
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use tokio::sync::{mpsc, oneshot, watch};

/// Shortest time between two states of the grass, each for all clients that wait: copying and compressing one takes tens of milliseconds.
const STATE_PERIOD: Duration = Duration::from_secs(2);

/// Bounds of the histogram of frame sizes (bytes).
const FRAME_BOUNDS_BYTES: [f64; 9] = [64.0, 256.0, 1024.0, 4096.0, 8192.0, 16_384.0, 32_768.0, 65_536.0, 262_144.0];

/// Counters of the streamer, for `/healthz` and `/metrics`.
#[derive(Debug)]
pub struct Counters {
    /// Publications handled.
    pub publications: AtomicU64,
    /// Number of grids encoded.
    pub encodings: AtomicU64,
    /// Patches whose frames are cached.
    pub cached_patches: AtomicU64,
    /// Patches that clients hold, summed over the clients.
    pub held_patches: AtomicU64,
    /// Frames handed to sessions.
    pub frames: AtomicU64,
    /// Clients that have a replica of the grass.
    pub replicas: AtomicU64,
    /// Replicas so far that differed from the grass.
    pub differences: AtomicU64,
    /// Frames skipped because the client had too many unacknowledged.
    pub skipped_frames: AtomicU64,
    frame_bytes: Mutex<Histogram>,
}

impl Default for Counters {
    fn default() -> Self {
        Self {
            publications: AtomicU64::default(),
            encodings: AtomicU64::default(),
            cached_patches: AtomicU64::default(),
            held_patches: AtomicU64::default(),
            frames: AtomicU64::default(),
            skipped_frames: AtomicU64::default(),
            replicas: AtomicU64::default(),
            differences: AtomicU64::default(),
            frame_bytes: Mutex::new(Histogram::new(&FRAME_BOUNDS_BYTES)),
        }
    }
}

impl Counters {
    /// Bytes of each frame handed to a session.
    pub fn frame_bytes(&self) -> Histogram {
        self.lock().clone()
    }

    fn lock(&self) -> MutexGuard<'_, Histogram> {
        self.frame_bytes.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Sends each snapshot to all clients. It uses no sockets, and no clock except for the budgets.
#[derive(Debug)]
pub struct Streamer {
    layout: PatchLayout,
    limits: SendLimits,
    encoder: Encoder,
    states: BTreeMap<u32, ClientState>,
    /// Step of the newest refusal sent to each client.
    notified: BTreeMap<u32, u64>,
    roster: Announcement<Vec<Peer>>,
    race: Announcement<Vec<Standing>>,
    ghost: Announcement<Option<Arc<Ghost>>>,
    counters: Arc<Counters>,
    steps: StepLog,
    /// The newest poses, and how often they have changed.
    poses: (Vec<ObjectPose>, u64),
    /// Set to request the state of the grass with the next publication.
    state_request: Arc<AtomicBool>,
    /// Time of the newest request.
    requested_at: Option<Instant>,
    difference_warning: LogLimit,
}

impl Streamer {
    /// A streamer for a world with this layout that is published `publish_hz` times per second.
    pub fn new(layout: PatchLayout, limits: SendLimits, publish_hz: f32) -> Self {
        Self {
            layout,
            limits,
            encoder: Encoder::new(publish_hz),
            states: BTreeMap::new(),
            notified: BTreeMap::new(),
            roster: Announcement::default(),
            race: Announcement::default(),
            ghost: Announcement::default(),
            counters: Arc::default(),
            steps: StepLog::new(publish_hz, limits.bytes_per_s),
            poses: (Vec::new(), 0),
            state_request: Arc::default(),
            requested_at: None,
            difference_warning: LogLimit::default(),
        }
    }

    /// Requests states of the grass, for replicas, by setting `request`.
    pub fn requesting_states_by(self, request: Arc<AtomicBool>) -> Self {
        Self { state_request: request, ..self }
    }

    /// The counters, readable from any thread.
    pub fn counters(&self) -> Arc<Counters> {
        self.counters.clone()
    }

    /// Sends one published state to every client that is ready for it; returns the clients' cameras.
    pub fn publish(&mut self, published: &Published, clients: &[Arc<Client>], now: Instant) -> Vec<Camera> {
        self.encoder.begin();
        self.remove_departed(clients);
        let snapshot = &published.snapshot;
        self.steps.extend(&snapshot.steps, snapshot.wind.tick, self.encoder.next_wind(snapshot));
        if let Some(state) = &published.bend_state {
            self.steps.set_state(state, self.encoder.wind(snapshot, None));
        }
        let announced = self.announced(published, clients, now);
        if self.poses.0 != snapshot.objects {
            self.poses.0.clone_from(&snapshot.objects);
            self.poses.1 += 1;
        }
        let publication = Publication {
            snapshot: &published.snapshot,
            layout: &self.layout,
            now,
            poses: Encoder::poses(&published.snapshot),
            poses_version: self.poses.1,
            announced,
            steps: &self.steps,
        };
        for client in clients {
            let refusal = self.refusal(published, client.id);
            let extra = refusal.is_some().then(|| no_vehicle(&published.snapshot));
            let state = self.states.entry(client.id).or_insert_with(|| ClientState::new(self.limits, now));
            if let Some(Difference { tick, patch }) = client.take_difference() {
                self.counters.differences.fetch_add(1, Relaxed);
                if self.difference_warning.due().is_some() {
                    tracing::warn!(client = client.id, tick, patch, "the replica of a client differs; it gets the state again");
                }
            }
            if let Some(bytes) = state.send_frame(client, &publication, &mut self.encoder, extra) {
                if bytes == 0 {
                    continue;
                }
                self.counters.lock().observe(bytes as f64);
                self.notified.extend(refusal.map(|tick| (client.id, tick)));
                self.counters.frames.fetch_add(1, Relaxed);
            } else {
                self.counters.skipped_frames.fetch_add(1, Relaxed);
            }
        }
        let may_request = self.requested_at.is_none_or(|at| now.duration_since(at) >= STATE_PERIOD);
        if may_request && self.states.values().any(ClientState::wants_state) {
            self.state_request.store(true, Relaxed);
            self.requested_at = Some(now);
        }
        self.counters.replicas.store(self.states.values().filter(|state| state.has_replica()).count() as u64, Relaxed);
        self.counters.publications.fetch_add(1, Relaxed);
        self.counters.encodings.store(self.encoder.encodings(), Relaxed);
        self.counters.cached_patches.store(self.encoder.cached_patches() as u64, Relaxed);
        self.counters.held_patches.store(self.states.values().map(ClientState::held_patches).sum::<usize>() as u64, Relaxed);
        clients.iter().filter_map(|client| client.camera()).collect()
    }

    /// The patches that any client takes.
    pub fn audience(&self) -> Audience {
        Audience::of(self.states.values().flat_map(ClientState::taken).copied(), &self.layout)
    }

    fn remove_departed(&mut self, clients: &[Arc<Client>]) {
        let is_connected = |id: &u32| clients.binary_search_by_key(id, |client| client.id).is_ok();
        self.states.retain(|id, _| is_connected(id));
        self.notified.retain(|id, _| is_connected(id));
    }

    /// The newest roster, race and ghost.
    fn announced(&mut self, published: &Published, clients: &[Arc<Client>], now: Instant) -> [Announced; ANNOUNCEMENTS] {
        let object = |id| published.requests.get(&id).and_then(|request| request.object);
        let peer = |client: &Arc<Client>| Peer { client: client.id, name: client.name(), object: object(client.id) };
        let peers = || clients.iter().map(peer).collect();
        let bytes_per_s = self.limits.bytes_per_s;
        let roster = self.roster.update(bytes_per_s, now, peers, |peers: &Vec<Peer>| ServerMessage::Roster { peers: peers.clone() });
        let standings = || published.snapshot.standings.clone();
        let race =
            self.race.update(bytes_per_s, now, standings, |standings: &Vec<Standing>| ServerMessage::Race { standings: standings.clone() });
        let ghost = |ghost: &Option<Arc<Ghost>>| ServerMessage::Ghost { ghost: ghost.as_deref().cloned() };
        let ghost = self.ghost.update(bytes_per_s, now, || published.snapshot.ghost.clone(), ghost);
        [roster, race, ghost]
    }

    /// Step at which a client's request for a vehicle was refused, if the client has not been notified.
    fn refusal(&self, published: &Published, client: u32) -> Option<u64> {
        let request = published.requests.get(&client).filter(|request| request.object.is_none())?;
        (self.notified.get(&client) != Some(&request.tick)).then_some(request.tick)
    }
}

/// The message that tells a client why it gets no vehicle.
fn no_vehicle(snapshot: &Snapshot) -> Bytes {
    let (count, limit) = (snapshot.objects.len(), snapshot.object_limit);
    let reason = if count >= limit as usize {
        format!("the scene has {count} objects and allows {limit}; wait until another client gives up a vehicle")
    } else {
        "there is no free space near your camera; move it and try again".to_owned()
    };
    wire::encode(&ServerMessage::Refused { refusal: Refusal::ObjectLimit, reason }).into()
}

/// The running streaming thread.
#[derive(Debug)]
pub struct Stream {
    thread: JoinHandle<()>,
    /// Closes when the thread ends, even by a panic.
    alive: oneshot::Receiver<()>,
}

impl Stream {
    /// Completes when the thread has ended, or is about to.
    pub async fn ended(&mut self) {
        let _ = (&mut self.alive).await;
    }

    /// Waits for the thread; false if it panicked.
    pub fn join(self) -> bool {
        self.thread.join().is_ok()
    }
}

/// Starts the thread. It ends when the world's thread does. Its clients are the `audience` of the grass, unless somebody else takes all patches.
///
/// # Errors
/// When the system cannot start a thread.
pub fn start(
    mut streamer: Streamer,
    mut published: watch::Receiver<Arc<Published>>,
    clients: Arc<Clients>,
    commands: mpsc::Sender<Command>,
    attendance: Arc<Attendance>,
    audience: Option<watch::Sender<Audience>>,
) -> std::io::Result<Stream> {
    let runtime = tokio::runtime::Handle::current();
    let (guard, alive) = oneshot::channel();
    let thread = std::thread::Builder::new().name("stream".to_owned()).spawn(move || {
        let _guard: oneshot::Sender<()> = guard;
        while runtime.block_on(published.changed()).is_ok() {
            let newest = published.borrow_and_update().clone();
            let clients = clients.all();
            if !clients.is_empty() {
                attendance.note();
            }
            let cameras = streamer.publish(&newest, &clients, Instant::now());
            if let Some(audience) = &audience {
                let newest = if attendance.wants_bend() { Audience::default() } else { streamer.audience() };
                audience.send_if_modified(|audience| std::mem::replace(audience, newest.clone()) != newest);
            }
            // A full channel means that the world lags; the next publication brings newer cameras.
            let _ = commands.try_send(Command::Cameras(cameras));
        }
    })?;
    Ok(Stream { thread, alive })
}
