//! The thread that turns each published snapshot into frames for all clients.

use super::clients::{Client, Clients};
use super::encoder::Encoder;
use super::pace::{Common, Pace, SendLimits};
use crate::runner::Published;
use crate::snapshot::Snapshot;
use crate::world::{Command, View};
use bytes::Bytes;
use shared::grid::PatchLayout;
use shared::wire::{self, Peer, Refusal, ServerMessage};
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::thread::JoinHandle;
use std::time::Instant;
use tokio::sync::{mpsc, oneshot, watch};

/// What the streamer counts, for `/healthz`.
#[derive(Debug, Default)]
pub struct Counters {
    /// Grids encoded.
    pub encodings: AtomicU64,
    /// Patches whose frames are kept.
    pub tracks: AtomicU64,
    /// Patches that the clients are known to hold, summed over them.
    pub held: AtomicU64,
    /// Frames handed to sessions.
    pub frames: AtomicU64,
    /// Frames not made because as much as allowed was on its way to the client.
    pub skipped: AtomicU64,
}

/// Serves all clients from each snapshot; knows no sockets and no clock but that of the budgets.
#[derive(Debug)]
pub struct Streamer {
    layout: PatchLayout,
    limits: SendLimits,
    encoder: Encoder,
    paces: BTreeMap<u32, Pace>,
    /// Step of the newest refusal that a client was told of.
    told: BTreeMap<u32, u64>,
    peers: Vec<Peer>,
    roster_version: u64,
    roster: Bytes,
    counters: Arc<Counters>,
}

impl Streamer {
    /// A streamer of a world with this layout that is published `publish_hz` times a second.
    pub fn new(layout: PatchLayout, limits: SendLimits, publish_hz: f32) -> Self {
        Self {
            layout,
            limits,
            encoder: Encoder::new(publish_hz),
            paces: BTreeMap::new(),
            told: BTreeMap::new(),
            peers: Vec::new(),
            roster_version: 0,
            roster: Bytes::new(),
            counters: Arc::default(),
        }
    }

    /// The counters, to be read from anywhere.
    pub fn counters(&self) -> Arc<Counters> {
        self.counters.clone()
    }

    /// Sends one published state to everyone who can take it; returns where they look.
    pub fn publish(&mut self, published: &Published, clients: &[Arc<Client>], now: Instant) -> Vec<View> {
        self.encoder.begin();
        self.forget_absent(clients);
        self.call_the_roll(published, clients);
        let common = Common {
            snapshot: &published.snapshot,
            layout: &self.layout,
            now,
            poses: Encoder::poses(&published.snapshot),
            roster_version: self.roster_version,
            roster: self.roster.clone(),
        };
        for client in clients {
            let refusal = self.refusal(published, client.id);
            let extra = refusal.is_some().then(|| no_vehicle(&published.snapshot));
            let pace = self.paces.entry(client.id).or_insert_with(|| Pace::new(self.limits, now));
            if pace.serve(client, &common, &mut self.encoder, extra) {
                self.told.extend(refusal.map(|tick| (client.id, tick)));
                self.counters.frames.fetch_add(1, Relaxed);
            } else {
                self.counters.skipped.fetch_add(1, Relaxed);
            }
        }
        self.counters.encodings.store(self.encoder.encodings(), Relaxed);
        self.counters.tracks.store(self.encoder.tracks() as u64, Relaxed);
        self.counters.held.store(self.paces.values().map(Pace::held_patches).sum::<usize>() as u64, Relaxed);
        clients.iter().filter_map(|client| client.view()).collect()
    }

    fn forget_absent(&mut self, clients: &[Arc<Client>]) {
        let here = |id: &u32| clients.binary_search_by_key(id, |client| client.id).is_ok();
        self.paces.retain(|id, _| here(id));
        self.told.retain(|id, _| here(id));
    }

    fn call_the_roll(&mut self, published: &Published, clients: &[Arc<Client>]) {
        let object = |id| published.requests.get(&id).and_then(|request| request.object);
        let peers: Vec<Peer> =
            clients.iter().map(|client| Peer { client: client.id, name: client.name(), object: object(client.id) }).collect();
        if peers != self.peers {
            self.roster_version += 1;
            self.roster = wire::encode(&ServerMessage::Roster { peers: peers.clone() }).into();
            self.peers = peers;
        }
    }

    /// Step at which a client's wish for a vehicle was refused, if it has not been told.
    fn refusal(&self, published: &Published, client: u32) -> Option<u64> {
        let request = published.requests.get(&client).filter(|request| request.object.is_none())?;
        (self.told.get(&client) != Some(&request.tick)).then_some(request.tick)
    }
}

/// Why a client gets no vehicle.
fn no_vehicle(snapshot: &Snapshot) -> Bytes {
    let (count, limit) = (snapshot.objects.len(), snapshot.object_limit);
    let reason = if count >= limit as usize {
        format!("there are {count} objects, and the scene allows {limit}; wait until somebody gives a vehicle up")
    } else {
        "there is no free place near where you look from; look elsewhere and ask again".to_owned()
    };
    wire::encode(&ServerMessage::Refused { refusal: Refusal::ObjectLimit, reason }).into()
}

/// The running thread.
#[derive(Debug)]
pub struct Stream {
    thread: JoinHandle<()>,
    /// Closes with the thread, however that ends.
    life: oneshot::Receiver<()>,
}

impl Stream {
    /// Completes when the thread has ended, or is about to.
    pub async fn ended(&mut self) {
        let _ = (&mut self.life).await;
    }

    /// Waits for the thread. False if it had panicked.
    pub fn join(self) -> bool {
        self.thread.join().is_ok()
    }
}

/// Starts the thread. It ends when the world's thread does.
///
/// # Errors
/// When the system gives no thread.
pub fn start(
    mut streamer: Streamer,
    mut published: watch::Receiver<Arc<Published>>,
    clients: Arc<Clients>,
    commands: mpsc::Sender<Command>,
) -> std::io::Result<Stream> {
    let runtime = tokio::runtime::Handle::current();
    let (alive, life) = oneshot::channel();
    let thread = std::thread::Builder::new().name("stream".to_owned()).spawn(move || {
        let _alive: oneshot::Sender<()> = alive;
        while runtime.block_on(published.changed()).is_ok() {
            let newest = published.borrow_and_update().clone();
            let views = streamer.publish(&newest, &clients.all(), Instant::now());
            // A full channel means that the world lags; the next publish brings newer views.
            let _ = commands.try_send(Command::Views(views));
        }
    })?;
    Ok(Stream { thread, life })
}
