//! The Prairie server: an authoritative world of wind, grass and vehicles, streamed over WebSocket.
//!
//! A run has three parts that never wait for each other: the world's thread ([`runner`]) steps at a fixed rate and publishes
//! the newest [`snapshot`]; the [`stream`] thread encodes what changed, once for all clients; the sessions in [`net`] write it
//! out as fast as each client takes it.

pub mod bend;
pub mod bucket;
mod config;
mod file;
pub mod inspect;
pub mod net;
pub mod objects;
pub mod plants;
mod reload;
pub mod runner;
pub mod scenes;
mod shown;
pub mod snapshot;
pub mod stream;
pub mod weather;
pub mod wind;
pub mod world;

pub use config::{Config, Limits};
pub use reload::run_and_reload;

use inspect::{InspectError, Inspector};
use net::App;
use runner::{Published, Runner, Simulation, Timing};
use shared::grid::PatchLayout;
use shared::wire::{self, ServerMessage};
use std::sync::Arc;
use std::time::{Duration, Instant};
use stream::{Clients, Streamer};
use thiserror::Error;
use tokio::net::TcpListener;
use tokio::sync::{Semaphore, watch};
use tokio::time::timeout;
use world::{World, WorldError};

/// Time that sessions are given to say goodbye when the server stops.
const GOODBYE: Duration = Duration::from_secs(2);

/// Why a run did not start or did not go on.
#[derive(Debug, Error)]
pub enum RunError {
    /// The system gives no threads.
    #[error("cannot start the threads of the simulation: {0}")]
    Threads(#[from] std::io::Error),
    /// The system takes the socket away.
    #[error("cannot go on listening: {0}")]
    Socket(std::io::Error),
    /// The scene's constants make no world together.
    #[error(transparent)]
    World(#[from] WorldError),
    /// The run cannot be recorded as asked.
    #[error(transparent)]
    Inspect(#[from] InspectError),
    /// The world's thread ended by itself, which is a fault of the program.
    #[error("the simulation has stopped unexpectedly; the log says where")]
    WorldStopped,
    /// The thread that serves the clients ended by itself, which is a fault of the program.
    #[error("the stream to the clients has stopped unexpectedly; the log says where")]
    StreamStopped,
}

/// Serves the scene on `listener` until `shutdown` completes; then says goodbye to the clients and ends every thread.
///
/// `shutdown` is first polled once the world is made, the recording open and every thread started, so it may begin by telling
/// where the page is.
///
/// # Errors
/// [`RunError`] when the world cannot be made, or one of the threads fails.
pub async fn run(mut config: Config, listener: TcpListener, shutdown: impl Future<Output = ()>) -> Result<(), RunError> {
    let maps = config.scene.maps();
    // Nothing more grows from them, and they may be large.
    config.scene.nutrients = None;
    let world = World::new(&config.scene.scene, maps)?;
    run_simulation(world, config, listener, shutdown).await
}

/// [`run`] with another simulation in the world's place.
///
/// # Errors
/// As [`run`].
pub async fn run_simulation(
    simulation: impl Simulation,
    config: Config,
    listener: TcpListener,
    shutdown: impl Future<Output = ()>,
) -> Result<(), RunError> {
    let scene = &config.scene.scene;
    let layout = PatchLayout::from(&scene.patches);
    let timing = Timing { tick_hz: scene.tick_hz, publish_hz: config.publish_hz, threads: config.threads };
    let inspector =
        config.rerun.as_ref().map(|target| Inspector::start(target, scene, &config.scene.height, &config.scene.cover)).transpose()?;
    let runner = Runner::start(simulation, timing)?;
    let mut published = runner.published();
    let clients = Arc::new(Clients::default());
    let streamer = Streamer::new(layout, config.limits.send, timing.published_hz());
    let counters = streamer.counters();
    let mut stream = stream::start(streamer, runner.published(), clients.clone(), runner.commands())?;
    let (stop, stopping) = watch::channel(false);
    let Limits { clients: seat_count, connections, .. } = config.limits;
    let (seats, porch) = (Arc::new(Semaphore::new(seat_count)), Arc::new(Semaphore::new(connections)));
    let app = Arc::new(App {
        clients: clients.clone(),
        counters,
        published: runner.published(),
        commands: runner.commands(),
        scene_name: config.scene.name.clone(),
        scene: scene_message(&config),
        limits: config.limits,
        seats: seats.clone(),
        porch: porch.clone(),
        stopping,
        started: Instant::now(),
    });
    let recording = inspector.map(|inspector| tokio::spawn(record(inspector, runner.published(), clients.clone())));
    let world_stopped = async { while published.changed().await.is_ok() {} };
    let outcome = tokio::select! {
        () = net::serve(listener, config.tls.clone(), net::router(app), config.limits) => Ok(()),
        () = world_stopped => Err(RunError::WorldStopped),
        () = stream.ended() => Err(RunError::StreamStopped),
        () = shutdown => Ok(()),
    };
    stop.send_replace(true);
    // Every session holds a permit until its very end.
    let farewells = async { (seats.acquire_many(seat_count as u32).await, porch.acquire_many(connections as u32).await) };
    if timeout(GOODBYE, farewells).await.is_err() {
        tracing::warn!("some clients are left without a goodbye");
    }
    let joined = tokio::task::spawn_blocking(move || (runner.stop(), stream.join())).await;
    if let Some(recording) = recording
        && let Ok(Err(error)) = recording.await
    {
        tracing::warn!(%error, "the recording is incomplete");
    }
    match joined {
        Ok((true, true)) => outcome,
        Ok((true, false)) => Err(RunError::StreamStopped),
        _ => Err(RunError::WorldStopped),
    }
}

/// Shows every published snapshot to the inspector, with what is sent to the clients; closes the recording when the runner ends.
async fn record(inspector: Inspector, mut published: watch::Receiver<Arc<Published>>, clients: Arc<Clients>) -> Result<(), InspectError> {
    tracing::info!(target = inspector.target(), "recording for the rerun viewer");
    let (mut since, mut sent_before) = (Instant::now(), 0);
    while published.changed().await.is_ok() {
        if since.elapsed() >= Duration::from_secs(1) {
            let sent = clients.sent_bytes();
            let bytes_per_sec = (sent - sent_before) as f64 / since.elapsed().as_secs_f64();
            inspector.observe_traffic(clients.count() as u32, bytes_per_sec);
            (since, sent_before) = (Instant::now(), sent);
        }
        let newest = Arc::clone(&published.borrow_and_update());
        inspector.observe(&newest.snapshot);
    }
    tokio::task::spawn_blocking(move || inspector.finish()).await.unwrap_or_else(|panic| Err(InspectError::Sdk(panic.to_string())))
}

fn scene_message(config: &Config) -> bytes::Bytes {
    let loaded = &config.scene;
    let message = ServerMessage::Scene {
        scene: Box::new(loaded.scene.clone()),
        height_png: loaded.height_png.clone(),
        covering_png: loaded.covering_png.clone(),
        nutrient_png: loaded.nutrient_png.clone(),
        models: loaded.models.clone(),
    };
    wire::encode(&message).into()
}
