//! One run of the server: from opening the recording to the shutdown notices.

use crate::config::{Config, Limits};
use crate::inspect::{InspectError, Inspector};
use crate::journal::{self, JournalError};
use crate::net::{self, Access, Admission, App, FieldSampler, PageErrors, Proofs, SessionLog};
use crate::runner::{Attendance, Published, Runner, Simulation, Timing};
use crate::scene_menu::SceneMenu;
use crate::stream::{self, Clients, Counters, Stream, Streamer};
use prairie_core::grid::PatchLayout;
use prairie_core::wire;
use std::sync::Arc;
use std::time::{Duration, Instant};
use thiserror::Error;
use tokio::net::TcpListener;
use tokio::sync::{Semaphore, watch};
use tokio::task::JoinHandle;
use tokio::time::timeout;

/// Time limit for the shutdown notices to all clients.
const SHUTDOWN_TIMEOUT: Duration = Duration::from_secs(2);

/// Reasons why a run did not start, or ended early.
#[derive(Debug, Error)]
pub enum RunError {
    /// The system refused to start a thread.
    #[error("cannot start the threads of the simulation: {0}")]
    Threads(#[from] std::io::Error),
    /// The listening socket failed.
    #[error("the listening socket failed: {0}")]
    Socket(std::io::Error),
    /// The scene's constants contradict each other, or the folder of the world cannot be used.
    #[error(transparent)]
    World(#[from] JournalError),
    /// The recording cannot be opened.
    #[error(transparent)]
    Inspect(#[from] InspectError),
    /// The run ended, but its recording is incomplete, for example because the disk is full.
    #[error("the recording is incomplete: {0}")]
    Incomplete(InspectError),
    /// The world's thread panicked, which is a bug.
    #[error("the simulation stopped unexpectedly; the log says where")]
    WorldStopped,
    /// The streaming thread panicked, which is a bug.
    #[error("the stream to the clients stopped unexpectedly; the log says where")]
    StreamStopped,
}

/// Serves the scene, in the world that is kept or a new one, on `listener` until `shutdown` completes; then notifies the clients and joins every thread.
///
/// `shutdown` is first polled after the world is built, the recording opened and every thread started, so it may begin by printing
/// the address of the page.
///
/// # Errors
/// [`RunError`] when the world cannot be built, or one of the threads fails.
pub async fn run(mut config: Config, listener: TcpListener, shutdown: impl Future<Output = ()>) -> Result<(), RunError> {
    let world = journal::open(config.world.as_ref(), &config.scene)?;
    // Only needed to grow the plants, and possibly large.
    config.scene.nutrients = None;
    run_simulation(world, config, listener, shutdown).await
}

/// [`run`] with another simulation instead of the world.
///
/// # Errors
/// As [`run`].
pub async fn run_simulation(
    simulation: impl Simulation,
    config: Config,
    listener: TcpListener,
    shutdown: impl Future<Output = ()>,
) -> Result<(), RunError> {
    let (menu, _) = SceneMenu::new(&config.scene, false);
    run_with_menu(simulation, config, menu, listener, shutdown).await
}

/// [`run_simulation`] with a menu of scenes for the pages.
pub(crate) async fn run_with_menu(
    simulation: impl Simulation,
    config: Config,
    scene_menu: SceneMenu,
    listener: TcpListener,
    shutdown: impl Future<Output = ()>,
) -> Result<(), RunError> {
    let (scene, timing) = (&config.scene.scene, timing(&config));
    let open = |target| Inspector::start(target, &config.rerun_rates, scene, &config.scene.height, &config.scene.cover);
    let inspector = config.rerun.as_ref().map(open).transpose()?;
    let (proofs, clients) = (Proofs::new(simulation.key()), Arc::new(Clients::starting_at(simulation.first_client())));
    let journal = simulation.journal_health().unwrap_or_default();
    let runner = Runner::start(simulation, timing)?;
    let mut published = runner.published();
    let (mut stream, counters) = start_stream(&config, &runner, clients.clone())?;
    let (stop, stopping) = watch::channel(false);
    let Limits { clients: client_limit, pending: pending_limit, .. } = config.limits;
    let (client_slots, pending_slots) = (Arc::new(Semaphore::new(client_limit)), Arc::new(Semaphore::new(pending_limit)));
    let admission = Arc::new(Admission::new(config.limits.clients_per_address));
    let app = Arc::new(App {
        clients: clients.clone(),
        counters,
        published: runner.published(),
        commands: runner.commands(),
        attendance: runner.attendance(),
        budget_ms: runner.budget_ms(),
        proofs,
        scene_name: config.scene.name.clone(),
        explanation: Arc::clone(&config.scene.explanation),
        scene_menu,
        scene: wire::encode(&config.scene.message()).into(),
        limits: config.limits,
        journal,
        fields: FieldSampler::new(&config.scene),
        tick_hz: timing.tick_hz,
        access: Access::new(&config.allow_origins, &config.allow_hosts, config.tls.clone()),
        admission: admission.clone(),
        page_errors: config.logs_page_errors.then(|| PageErrors::new(Instant::now())),
        client_slots: client_slots.clone(),
        pending_slots: pending_slots.clone(),
        session_log: SessionLog::default(),
        stopping,
        started: Instant::now(),
    });
    let recording = inspector.map(|inspector| tokio::spawn(record(inspector, runner.published(), clients.clone(), runner.attendance())));
    let world_stopped = async { while published.changed().await.is_ok() {} };
    let outcome = tokio::select! {
        () = net::serve(listener, config.tls.clone(), net::router(app), config.limits, admission) => Ok(()),
        () = world_stopped => Err(RunError::WorldStopped),
        () = stream.ended() => Err(RunError::StreamStopped),
        () = shutdown => Ok(()),
    };
    stop.send_replace(true);
    wait_for_sessions(&client_slots, &pending_slots, config.limits).await;
    let joined = tokio::task::spawn_blocking(move || (runner.stop(), stream.join())).await;
    let recorded = outcome_of(recording).await;
    end_of_run(outcome, joined.unwrap_or_default(), recorded)
}

/// The outcome of a run, whose world and stream have ended without a panic or with one.
fn end_of_run(outcome: Result<(), RunError>, ended_well: (bool, bool), recorded: Result<(), InspectError>) -> Result<(), RunError> {
    match ended_well {
        (true, true) => outcome.and(recorded.map_err(RunError::Incomplete)),
        (true, false) => Err(RunError::StreamStopped),
        (false, _) => Err(RunError::WorldStopped),
    }
}

/// Rates and threads of the runner.
fn timing(config: &Config) -> Timing {
    let Config { publish_hz, threads, pause_after, .. } = *config;
    Timing { tick_hz: config.scene.scene.tick_hz, publish_hz, threads, pause_after, demands: config.scene.explanation.demands }
}

/// Starts the stream to the clients, which are the only audience of the grass unless there is a recording, which shows all patches.
fn start_stream(config: &Config, runner: &Runner, clients: Arc<Clients>) -> std::io::Result<(Stream, Arc<Counters>)> {
    let layout = PatchLayout::from(&config.scene.scene.patches);
    let of_scene = config.scene.explanation.demands.and_then(|demands| demands.kbit_per_s);
    let send = config.limits.send.within_kbit_per_s(of_scene);
    let streamer = Streamer::new(layout, send, timing(config).published_hz()).requesting_states_by(runner.state_request());
    let counters = streamer.counters();
    let audience = config.rerun.is_none().then(|| runner.audience());
    let stream = stream::start(streamer, runner.published(), clients, runner.commands(), runner.attendance(), audience)?;
    Ok((stream, counters))
}

/// Waits for a recording to end, if there is one.
async fn outcome_of(recording: Option<JoinHandle<Result<(), InspectError>>>) -> Result<(), InspectError> {
    match recording {
        Some(recording) => recording.await.unwrap_or_else(|panic| Err(InspectError::Sdk(panic.to_string()))),
        None => Ok(()),
    }
}

/// Waits for all sessions to end, within the time limit. Each holds a client's or a pending slot until then.
async fn wait_for_sessions(client_slots: &Semaphore, pending_slots: &Semaphore, limits: Limits) {
    let ended = async { (client_slots.acquire_many(limits.clients as u32).await, pending_slots.acquire_many(limits.pending as u32).await) };
    if timeout(SHUTDOWN_TIMEOUT, ended).await.is_err() {
        tracing::warn!("some clients were disconnected without a shutdown notice");
    }
}

/// Passes every published snapshot and the traffic to the inspector; closes the recording when the runner ends.
async fn record(
    inspector: Inspector,
    mut published: watch::Receiver<Arc<Published>>,
    clients: Arc<Clients>,
    attendance: Arc<Attendance>,
) -> Result<(), InspectError> {
    tracing::info!(to = inspector.target(), "recording for the rerun viewer");
    let (mut since, mut sent_before) = (Instant::now(), 0);
    while published.changed().await.is_ok() {
        attendance.note();
        if since.elapsed() >= Duration::from_secs(1) {
            let sent = clients.sent_bytes();
            let sent_bytes_per_s = (sent - sent_before) as f64 / since.elapsed().as_secs_f64();
            inspector.observe_traffic(clients.count() as u32, sent_bytes_per_s);
            (since, sent_before) = (Instant::now(), sent);
        }
        let newest = Arc::clone(&published.borrow_and_update());
        inspector.observe(&newest.snapshot);
    }
    tokio::task::spawn_blocking(move || inspector.finish()).await.unwrap_or_else(|panic| Err(InspectError::Sdk(panic.to_string())))
}
