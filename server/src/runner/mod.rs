//! The simulation thread: owns the world, steps it in real time with the clients' commands, and publishes snapshots. It never waits for a reader.

mod clock;
mod counter_log;
mod recent_drops;

pub use clock::CATCH_UP_STEPS;
pub use recent_drops::RECENT;

use crate::histogram::Histogram;
use crate::journal::Health;
use crate::snapshot::{PatchQuantiser, Snapshot};
use crate::world::{Command, World};
use clock::Clock;
use counter_log::CounterLog;
use prairie_core::grass::BendState;
use prairie_core::wire::ObjectId;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use tokio::sync::{mpsc, watch};

/// Capacity of the command queue.
const COMMAND_CAPACITY: usize = 1024;

/// Longest sleep of an idle world (s).
const IDLE_SLEEP_SECS: f64 = 0.05;

/// Bounds of the histogram of step durations (s).
const STEP_BOUNDS_SECS: [f64; 12] = [0.0005, 0.001, 0.002, 0.004, 0.008, 0.016, 0.032, 0.064, 0.125, 0.25, 0.5, 1.0];

/// Interface of a simulation to the runner: the world, or a stand-in for tests.
pub trait Simulation: Send + 'static {
    /// Advances by one fixed step after carrying out `commands` in order.
    fn step(&mut self, commands: &[Command]);
    /// The state after the newest step. `quantiser` is the same at every call.
    fn publish(&self, quantiser: &mut PatchQuantiser) -> Snapshot;
    /// A copy of the state of the grass after the newest step, from which replicas start; `None` if they cannot follow it.
    fn bend_state(&self) -> Option<BendState> {
        None
    }
    /// The object that a client drives.
    fn object_of(&self, client: u32) -> Option<ObjectId>;
    /// Whether nothing but the wind moves. The runner then does all steps up to the next snapshot at once, which wakes the processor less often.
    fn is_idle(&self) -> bool {
        false
    }
    /// Number of steps before the first one.
    fn tick(&self) -> u64 {
        0
    }
    /// Key for the proofs of clients, which stays the same over restarts; `None` for one that does not.
    fn key(&self) -> Option<[u8; 32]> {
        None
    }
    /// Clients that have left and whose vehicles are kept for their return.
    fn departed(&self) -> Vec<u32> {
        Vec::new()
    }
    /// Lowest client number that was never used.
    fn first_client(&self) -> u32 {
        1
    }
    /// State of the journal's files, for the metrics; `None` without memory.
    fn journal_health(&self) -> Option<Arc<Health>> {
        None
    }
}

impl Simulation for World {
    fn departed(&self) -> Vec<u32> {
        Self::departed(self)
    }

    fn tick(&self) -> u64 {
        Self::tick(self)
    }

    fn step(&mut self, commands: &[Command]) {
        Self::step(self, commands);
    }

    fn publish(&self, quantiser: &mut PatchQuantiser) -> Snapshot {
        Self::publish(self, quantiser)
    }

    fn bend_state(&self) -> Option<BendState> {
        Self::bend_state(self)
    }

    fn object_of(&self, client: u32) -> Option<ObjectId> {
        Self::object_of(self, client)
    }

    fn is_idle(&self) -> bool {
        Self::is_idle(self)
    }
}

/// The newest state, with information from the runner.
#[derive(Clone, Debug)]
pub struct Published {
    /// The world's state.
    pub snapshot: Snapshot,
    /// Outcome of each client's newest request for a vehicle.
    pub requests: BTreeMap<u32, Request>,
    /// Clients that have left and whose vehicles are kept for their return.
    pub departed: Vec<u32>,
    /// Simulated time that was dropped because the machine is too slow (s).
    pub dropped_secs: f64,
    /// The part of it that was dropped within the last minute, [`RECENT`] (s).
    pub dropped_recently_secs: f64,
    /// Durations of all steps so far (s), wall-clock time.
    pub step_secs: Histogram,
    /// State of the grass, if it was [requested](Runner::state_request).
    pub bend_state: Option<Arc<BendState>>,
    /// Time of the publication.
    pub at: Instant,
}

impl Published {
    /// A state without requests and losses, published now.
    pub fn new(snapshot: Snapshot) -> Self {
        Self {
            snapshot,
            requests: BTreeMap::new(),
            departed: Vec::new(),
            dropped_secs: 0.0,
            dropped_recently_secs: 0.0,
            step_secs: Histogram::new(&STEP_BOUNDS_SECS),
            bend_state: None,
            at: Instant::now(),
        }
    }
}

impl Published {
    /// Whether a client has a vehicle, connected or not.
    pub fn has_vehicle(&self, client: u32) -> bool {
        self.departed.contains(&client) || self.requests.get(&client).is_some_and(|request| request.object.is_some())
    }
}

/// A client's request for a vehicle, granted or refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Request {
    /// Step that decided it.
    pub tick: u64,
    /// The object, or `None` when the request was refused.
    pub object: Option<ObjectId>,
}

/// Rates and threads of the runner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timing {
    /// Fixed steps per second (Hz).
    pub tick_hz: f32,
    /// Snapshots per second (Hz): one every `tick_hz / publish_hz` steps, rounded, and at least 1.
    pub publish_hz: f32,
    /// Threads of the world, including its own; by default one per core.
    pub threads: Option<usize>,
}

impl Timing {
    /// Steps between snapshots.
    pub fn steps_per_publish(&self) -> u64 {
        (self.tick_hz / self.publish_hz).round().max(1.0) as u64
    }

    /// Resulting snapshots per second (Hz).
    pub fn published_hz(&self) -> f32 {
        self.tick_hz / self.steps_per_publish() as f32
    }
}

/// A running world.
#[derive(Debug)]
pub struct Runner {
    commands: mpsc::Sender<Command>,
    published: watch::Receiver<Arc<Published>>,
    state_request: Arc<AtomicBool>,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Runner {
    /// Starts the thread and publishes the state before the first step.
    ///
    /// # Errors
    /// When the threads cannot be started.
    pub fn start(simulation: impl Simulation, timing: Timing) -> std::io::Result<Self> {
        let (commands, inbox) = mpsc::channel(COMMAND_CAPACITY);
        let mut quantiser = PatchQuantiser::default();
        let first = Published { departed: simulation.departed(), ..Published::new(simulation.publish(&mut quantiser)) };
        let (sender, published) = watch::channel(Arc::new(first));
        let stop = Arc::new(AtomicBool::new(false));
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(timing.threads.unwrap_or(0))
            .thread_name(|index| format!("world-{index}"))
            .build()
            .map_err(std::io::Error::other)?;
        let state_request = Arc::new(AtomicBool::new(false));
        let (stopped, requested) = (stop.clone(), state_request.clone());
        let thread = std::thread::Builder::new().name("world".to_owned()).spawn(move || {
            pool.install(|| Loop::new(simulation, quantiser, timing, inbox, sender).run(&stopped, &requested));
        })?;
        Ok(Self { commands, published, state_request, stop, thread: Some(thread) })
    }

    /// Queue of commands to the world. It is bounded: use `try_send` for commands that may be lost.
    pub fn commands(&self) -> mpsc::Sender<Command> {
        self.commands.clone()
    }

    /// The newest state. The channel closes when the thread ends.
    pub fn published(&self) -> watch::Receiver<Arc<Published>> {
        self.published.clone()
    }

    /// Request for the state of the grass: while it is true, the next publication carries it, and resets this to false.
    pub fn state_request(&self) -> Arc<AtomicBool> {
        self.state_request.clone()
    }

    /// Stops after the present step and waits for the thread. Returns whether it ended without a panic.
    pub fn stop(mut self) -> bool {
        self.stop.store(true, Relaxed);
        self.thread.take().is_none_or(|thread| thread.join().is_ok())
    }
}

impl Drop for Runner {
    fn drop(&mut self) {
        self.stop.store(true, Relaxed);
    }
}

struct Loop<S> {
    simulation: S,
    quantiser: PatchQuantiser,
    inbox: mpsc::Receiver<Command>,
    sender: watch::Sender<Arc<Published>>,
    clock: Clock,
    steps_per_publish: u64,
    tick: u64,
    requests: BTreeMap<u32, Request>,
    step_times: Vec<Duration>,
    step_secs: Histogram,
    start: Instant,
    dropped: CounterLog,
    evicted: CounterLog,
    reset: CounterLog,
}

impl<S: Simulation> Loop<S> {
    fn new(
        simulation: S,
        quantiser: PatchQuantiser,
        timing: Timing,
        inbox: mpsc::Receiver<Command>,
        sender: watch::Sender<Arc<Published>>,
    ) -> Self {
        let before = simulation.publish(&mut PatchQuantiser::default()).diagnostics;
        Self {
            tick: simulation.tick(),
            simulation,
            quantiser,
            inbox,
            sender,
            clock: Clock::new(f64::from(timing.tick_hz)),
            steps_per_publish: timing.steps_per_publish(),
            requests: BTreeMap::new(),
            step_times: Vec::new(),
            step_secs: Histogram::new(&STEP_BOUNDS_SECS),
            start: Instant::now(),
            dropped: CounterLog::default(),
            evicted: CounterLog::from(before.evicted_patches),
            reset: CounterLog::from(before.reset_patches),
        }
    }

    fn run(mut self, stop: &AtomicBool, state_request: &AtomicBool) {
        while !stop.load(Relaxed) {
            for _ in 0..self.clock.due(self.start.elapsed()) {
                self.step(state_request);
            }
            if self.dropped.increase(self.clock.dropped).is_some() {
                tracing::warn!(dropped_secs = self.clock.dropped_secs(), "the world is slower than real time; simulated time is dropped");
            }
            std::thread::sleep(self.clock.until(self.steps_at_once(), self.start.elapsed()));
        }
    }

    /// Number of steps to do at once after the next sleep.
    fn steps_at_once(&self) -> u64 {
        if !self.simulation.is_idle() {
            return 1;
        }
        let in_a_sleep = (IDLE_SLEEP_SECS * self.clock.tick_hz) as u64;
        let to_publish = self.steps_per_publish - self.tick % self.steps_per_publish;
        to_publish.min(in_a_sleep).clamp(1, CATCH_UP_STEPS / 2)
    }

    /// Steps until the next snapshot, 0 when it is due now.
    fn steps_to_publish(&self) -> u64 {
        (self.steps_per_publish - self.tick % self.steps_per_publish) % self.steps_per_publish
    }

    fn step(&mut self, state_request: &AtomicBool) {
        let commands: Vec<Command> = std::iter::from_fn(|| self.inbox.try_recv().ok()).collect();
        let begun = Instant::now();
        self.simulation.step(&commands);
        let duration = begun.elapsed();
        self.step_times.push(duration);
        self.step_secs.observe(duration.as_secs_f64());
        self.tick += 1;
        self.note_requests(&commands);
        if self.steps_to_publish() == 0 {
            self.publish(state_request.swap(false, Relaxed));
        }
    }

    /// Notes the outcome of requests for vehicles.
    fn note_requests(&mut self, commands: &[Command]) {
        for command in commands {
            match *command {
                Command::Spawn { client, .. } => {
                    let object = self.simulation.object_of(client);
                    self.requests.insert(client, Request { tick: self.tick, object });
                }
                Command::Remove { client } | Command::Leave { client } => {
                    self.requests.remove(&client);
                }
                Command::Return { client } => {
                    let object = self.simulation.object_of(client);
                    self.requests.extend(object.map(|object| (client, Request { tick: self.tick, object: Some(object) })));
                }
                Command::Drive { .. } | Command::Cameras(_) | Command::Join { .. } => {}
            }
        }
    }

    fn publish(&mut self, with_bend_state: bool) {
        let mut snapshot = self.simulation.publish(&mut self.quantiser);
        let total: Duration = self.step_times.iter().sum();
        snapshot.diagnostics.step_secs = total.as_secs_f32() / self.step_times.len() as f32;
        snapshot.diagnostics.step_max_secs = self.step_times.iter().max().map_or(0.0, Duration::as_secs_f32);
        self.step_times.clear();
        let resets = snapshot.diagnostics.wind_resets;
        if resets > self.sender.borrow().snapshot.diagnostics.wind_resets {
            tracing::warn!(resets, "the wind solver failed and restarted from the mean wind");
        }
        if let Some(patches) = self.evicted.increase(snapshot.diagnostics.evicted_patches) {
            let awake = snapshot.diagnostics.awake_patches;
            tracing::warn!(patches, awake, "patches far from all cameras were put to sleep: `patches.awake_limit` is reached");
        }
        if let Some(patches) = self.reset.increase(snapshot.diagnostics.reset_patches) {
            tracing::warn!(patches, "grass moved faster than the scheme can follow, or was NaN or infinite, and was put to rest");
        }
        let published = Published {
            requests: self.requests.clone(),
            departed: self.simulation.departed(),
            dropped_secs: self.clock.dropped_secs(),
            dropped_recently_secs: self.clock.dropped_recently_secs(self.start.elapsed()),
            step_secs: self.step_secs.clone(),
            bend_state: with_bend_state.then(|| self.simulation.bend_state()).flatten().map(Arc::new),
            ..Published::new(snapshot)
        };
        self.sender.send_replace(Arc::new(published));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn publish_rates_divide_the_step_rate() {
        let timing = |tick_hz, publish_hz| Timing { tick_hz, publish_hz, threads: None };
        assert_eq!(timing(60.0, 20.0).steps_per_publish(), 3);
        assert_eq!(timing(60.0, 25.0).published_hz(), 30.0);
        assert_eq!(timing(10.0, 60.0).steps_per_publish(), 1);
    }
}
