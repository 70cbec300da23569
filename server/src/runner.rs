//! The thread that owns the world: keeps time, feeds it commands, publishes the newest snapshot. It waits for nobody.

use crate::snapshot::Snapshot;
use crate::world::{Command, World};
use shared::wire::ObjectId;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use tokio::sync::{mpsc, watch};

/// Commands that may wait for the next step.
const COMMAND_CAPACITY: usize = 1024;

/// Most steps that are caught up at once; time beyond them is dropped.
pub const CATCH_UP_STEPS: u64 = 6;

/// Steps over which the making of a snapshot is spread: a patch is shown as it was at most one step fewer before.
pub const SNAPSHOT_STEPS: u64 = 3;

/// Longest time that an idle world sleeps (s).
const NAP_SECS: f64 = 0.05;

/// Least time between two log lines about the same count.
const LOG_EVERY: Duration = Duration::from_secs(10);

/// What the runner runs: the world, or a test's stand-in.
pub trait Simulation: Send + 'static {
    /// Advances by one fixed step after carrying out `commands` in order.
    fn step(&mut self, commands: &[Command]);
    /// After a step without a snapshot: gets one of so many parts of the next one ready, so that no step takes much longer than others.
    fn prepare(&mut self, _part: [u64; 2]) {}
    /// The state after the newest step.
    fn snapshot(&mut self) -> Snapshot;
    /// The object that a client drives.
    fn object_of(&self, client: u32) -> Option<ObjectId>;
    /// Whether nothing but the wind moves. Then the steps up to the next snapshot are done at once, for fewer of them wake the processor.
    fn is_idle(&self) -> bool {
        false
    }
}

impl Simulation for World {
    fn step(&mut self, commands: &[Command]) {
        Self::step(self, commands);
    }

    fn prepare(&mut self, part: [u64; 2]) {
        Self::prepare(self, part);
    }

    fn snapshot(&mut self) -> Snapshot {
        Self::snapshot(self)
    }

    fn object_of(&self, client: u32) -> Option<ObjectId> {
        Self::object_of(self, client)
    }

    fn is_idle(&self) -> bool {
        Self::is_idle(self)
    }
}

/// The newest state, with what the runner adds.
#[derive(Clone, Debug, Default)]
pub struct Published {
    /// The world's state.
    pub snapshot: Snapshot,
    /// What became of each client's newest wish for a vehicle.
    pub requests: BTreeMap<u32, Request>,
    /// Simulated time that was left out because the machine was too slow (s).
    pub dropped_secs: f64,
}

/// A client's wish for a vehicle, carried out or refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Request {
    /// Step after which it was decided.
    pub tick: u64,
    /// The object; none: refused.
    pub object: Option<ObjectId>,
}

/// How the runner keeps time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timing {
    /// Fixed steps per second (Hz).
    pub tick_hz: f32,
    /// Snapshots per second (Hz); every `tick_hz / publish_hz` steps, rounded, at least each step.
    pub publish_hz: f32,
    /// Threads of the world, its own included; none: one for each core.
    pub threads: Option<usize>,
}

impl Timing {
    /// Steps from one snapshot to the next.
    pub fn steps_per_publish(&self) -> u64 {
        (self.tick_hz / self.publish_hz).round().max(1.0) as u64
    }

    /// Snapshots per second that result (Hz).
    pub fn published_hz(&self) -> f32 {
        self.tick_hz / self.steps_per_publish() as f32
    }
}

/// A running world.
#[derive(Debug)]
pub struct Runner {
    commands: mpsc::Sender<Command>,
    published: watch::Receiver<Arc<Published>>,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Runner {
    /// Starts the thread; the state before the first step is published at once.
    ///
    /// # Errors
    /// When the system gives no threads.
    pub fn start(mut simulation: impl Simulation, timing: Timing) -> std::io::Result<Self> {
        let (commands, inbox) = mpsc::channel(COMMAND_CAPACITY);
        let (sender, published) = watch::channel(Arc::new(Published { snapshot: simulation.snapshot(), ..Published::default() }));
        let stop = Arc::new(AtomicBool::new(false));
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(timing.threads.unwrap_or(0))
            .thread_name(|index| format!("world-{index}"))
            .build()
            .map_err(std::io::Error::other)?;
        let stopped = stop.clone();
        let thread = std::thread::Builder::new().name("world".to_owned()).spawn(move || {
            pool.install(|| Loop::new(simulation, timing, inbox, sender).run(&stopped));
        })?;
        Ok(Self { commands, published, stop, thread: Some(thread) })
    }

    /// Where commands go; bounded, so use `try_send` for what may be lost.
    pub fn commands(&self) -> mpsc::Sender<Command> {
        self.commands.clone()
    }

    /// Where the newest state comes from; it closes when the thread ends.
    pub fn published(&self) -> watch::Receiver<Arc<Published>> {
        self.published.clone()
    }

    /// Stops after the step under way and waits for the thread. False if it had panicked.
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
    inbox: mpsc::Receiver<Command>,
    sender: watch::Sender<Arc<Published>>,
    clock: Clock,
    steps_per_publish: u64,
    tick: u64,
    requests: BTreeMap<u32, Request>,
    step_times: Vec<Duration>,
    dropped: Rising,
    evicted: Rising,
    broken: Rising,
}

impl<S: Simulation> Loop<S> {
    fn new(simulation: S, timing: Timing, inbox: mpsc::Receiver<Command>, sender: watch::Sender<Arc<Published>>) -> Self {
        Self {
            simulation,
            inbox,
            sender,
            clock: Clock::new(f64::from(timing.tick_hz)),
            steps_per_publish: timing.steps_per_publish(),
            tick: 0,
            requests: BTreeMap::new(),
            step_times: Vec::new(),
            dropped: Rising::default(),
            evicted: Rising::default(),
            broken: Rising::default(),
        }
    }

    fn run(mut self, stop: &AtomicBool) {
        let start = Instant::now();
        while !stop.load(Relaxed) {
            for _ in 0..self.clock.due(start.elapsed()) {
                self.step();
            }
            if self.dropped.news(self.clock.dropped).is_some() {
                tracing::warn!(dropped_secs = self.clock.dropped_secs(), "the world is slower than real time; simulated time is left out");
            }
            std::thread::sleep(self.clock.until(self.steps_at_once(), start.elapsed()));
        }
    }

    /// Steps that may fall due before the next of them is done.
    fn steps_at_once(&self) -> u64 {
        if !self.simulation.is_idle() {
            return 1;
        }
        let in_a_nap = (NAP_SECS * self.clock.tick_hz) as u64;
        let to_publish = self.steps_per_publish - self.tick % self.steps_per_publish;
        to_publish.min(in_a_nap).clamp(1, CATCH_UP_STEPS / 2)
    }

    /// Steps until a snapshot is due; none when it is due now.
    fn steps_to_publish(&self) -> u64 {
        (self.steps_per_publish - self.tick % self.steps_per_publish) % self.steps_per_publish
    }

    fn step(&mut self) {
        let commands: Vec<Command> = std::iter::from_fn(|| self.inbox.try_recv().ok()).collect();
        let begun = Instant::now();
        self.simulation.step(&commands);
        self.step_times.push(begun.elapsed());
        self.tick += 1;
        self.settle(&commands);
        let parts = self.steps_per_publish.min(SNAPSHOT_STEPS);
        match self.steps_to_publish() {
            0 => self.publish(),
            left if left < parts => self.simulation.prepare([parts - left, parts]),
            _ => {}
        }
    }

    /// Notes what became of the wishes for vehicles.
    fn settle(&mut self, commands: &[Command]) {
        for command in commands {
            match *command {
                Command::Spawn { client, .. } => {
                    let object = self.simulation.object_of(client);
                    self.requests.insert(client, Request { tick: self.tick, object });
                }
                Command::Remove { client } => {
                    self.requests.remove(&client);
                }
                Command::Drive { .. } | Command::Views(_) | Command::View(_) => {}
            }
        }
    }

    fn publish(&mut self) {
        let mut snapshot = self.simulation.snapshot();
        let total: Duration = self.step_times.iter().sum();
        snapshot.health.step_secs = total.as_secs_f32() / self.step_times.len() as f32;
        snapshot.health.step_max_secs = self.step_times.iter().max().map_or(0.0, Duration::as_secs_f32);
        self.step_times.clear();
        let resets = snapshot.health.wind_resets;
        if resets > self.sender.borrow().snapshot.health.wind_resets {
            tracing::warn!(resets, "the wind was lost and has begun anew from its mean");
        }
        if let Some(patches) = self.evicted.news(snapshot.health.evicted_patches) {
            let awake = snapshot.health.awake_patches;
            tracing::warn!(
                patches,
                awake,
                "grass was put to rest far from all cameras, for as many patches are awake as `patches.awake_limit` allows"
            );
        }
        if let Some(patches) = self.broken.news(snapshot.health.broken_patches) {
            tracing::warn!(patches, "grass moved faster than the scheme can follow, or was no number, and was put to rest");
        }
        let published = Published { snapshot, requests: self.requests.clone(), dropped_secs: self.clock.dropped_secs() };
        self.sender.send_replace(Arc::new(published));
    }
}

/// A count that only rises, as it was when it was last told.
#[derive(Default)]
struct Rising {
    told: u64,
    told_at: Option<Instant>,
}

impl Rising {
    /// By how much the count has risen, if it has and it was not told of lately.
    fn news(&mut self, count: u64) -> Option<u64> {
        if count <= self.told || self.told_at.is_some_and(|at| at.elapsed() <= LOG_EVERY) {
            return None;
        }
        self.told_at = Some(Instant::now());
        Some(count - std::mem::replace(&mut self.told, count))
    }
}

/// Counts the fixed steps that have fallen due.
struct Clock {
    tick_hz: f64,
    /// Steps done or dropped.
    accounted: u64,
    /// Steps dropped.
    dropped: u64,
}

impl Clock {
    fn new(tick_hz: f64) -> Self {
        Self { tick_hz, accounted: 0, dropped: 0 }
    }

    /// Steps to do now, at most [`CATCH_UP_STEPS`]; more than that are dropped.
    fn due(&mut self, elapsed: Duration) -> u64 {
        let fallen_due = (elapsed.as_secs_f64() * self.tick_hz) as u64 - self.accounted;
        let steps = fallen_due.min(CATCH_UP_STEPS);
        self.dropped += fallen_due - steps;
        self.accounted += fallen_due;
        steps
    }

    /// Time until so many steps are due.
    fn until(&self, steps: u64, elapsed: Duration) -> Duration {
        let next_secs = (self.accounted + steps) as f64 / self.tick_hz;
        Duration::from_secs_f64((next_secs - elapsed.as_secs_f64()).max(0.0))
    }

    fn dropped_secs(&self) -> f64 {
        self.dropped as f64 / self.tick_hz
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_on_time_clock_drops_nothing() {
        let mut clock = Clock::new(60.0);
        let steps: u64 = (1..=1000).map(|ms| clock.due(Duration::from_millis(ms * 10))).sum();
        assert_eq!((steps, clock.dropped), (600, 0));
        let wait = clock.until(1, Duration::from_secs(10));
        assert!(wait <= Duration::from_secs_f64(1.0 / 60.0) && wait > Duration::from_millis(16));
        assert_eq!(clock.until(3, Duration::from_millis(10_020)), Duration::from_millis(30));
    }

    #[test]
    fn a_long_pause_is_dropped_not_caught_up() {
        let mut clock = Clock::new(60.0);
        assert_eq!(clock.due(Duration::from_secs(10)), CATCH_UP_STEPS);
        assert_eq!(clock.dropped, 600 - CATCH_UP_STEPS);
        assert_eq!(clock.due(Duration::from_secs(10)), 0);
        assert_eq!(clock.due(Duration::from_secs(11)) + clock.due(Duration::from_secs_f64(11.017)), CATCH_UP_STEPS + 1);
    }

    #[test]
    fn a_rising_count_is_told_once_in_a_while() {
        let mut count = Rising::default();
        assert_eq!([0, 3, 5].map(|now| count.news(now)), [None, Some(3), None]);
        count.told_at = None;
        assert_eq!([3, 6].map(|now| count.news(now)), [None, Some(3)]);
    }

    #[test]
    fn publish_rates_divide_the_step_rate() {
        let timing = |tick_hz, publish_hz| Timing { tick_hz, publish_hz, threads: None };
        assert_eq!(timing(60.0, 20.0).steps_per_publish(), 3);
        assert_eq!(timing(60.0, 25.0).published_hz(), 30.0);
        assert_eq!(timing(10.0, 60.0).steps_per_publish(), 1);
    }
}
