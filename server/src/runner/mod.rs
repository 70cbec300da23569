//! The simulation thread: owns the world, steps it in real time with the clients' commands, and publishes snapshots. It never waits for a reader.

mod attendance;
mod clock;
mod controller;
mod counter_log;
mod load;
mod published;
mod recent_drops;
mod simulation;
mod step_loop;

pub use attendance::Attendance;
pub use clock::CATCH_UP_STEPS;
pub use controller::ControlReport;
pub use published::{Published, Request};
pub use recent_drops::RECENT;
pub use simulation::Simulation;

use crate::detail::Demands;
use crate::snapshot::{Audience, PatchQuantiser};
use crate::world::Command;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::thread::JoinHandle;
use std::time::Duration;
use step_loop::{Intake, Loop};
use tokio::sync::{mpsc, watch};

/// Capacity of the command queue.
const COMMAND_CAPACITY: usize = 1024;

/// Rates and threads of the runner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timing {
    /// Fixed steps per second (Hz).
    pub tick_hz: f32,
    /// Snapshots per second (Hz): one every `tick_hz / publish_hz` steps, rounded, and at least 1.
    pub publish_hz: f32,
    /// Threads of the world, including its own; by default one per core.
    pub threads: Option<usize>,
    /// Time without anybody after which a world [at rest](Simulation::is_at_rest) pauses; `None` if it never does.
    pub pause_after: Option<Duration>,
    /// Errors and time that the detail of the world follows; `None` if the detail stays as it is.
    pub demands: Option<Demands>,
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
    audience: watch::Sender<Audience>,
    state_request: Arc<AtomicBool>,
    attendance: Arc<Attendance>,
    budget_ms: watch::Sender<Option<f32>>,
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
        let attendance = Arc::<Attendance>::default();
        let (audience, taken) = watch::channel(Audience::default());
        let (budget_ms, set_budget_ms) = watch::channel(None);
        let (stopped, requested, attended) = (stop.clone(), state_request.clone(), attendance.clone());
        let thread = std::thread::Builder::new().name("world".to_owned()).spawn(move || {
            pool.install(|| {
                Loop::new(simulation, quantiser, timing, Intake { inbox, audience: taken, budget_ms: set_budget_ms }, sender)
                    .run(&stopped, &requested, &attended)
            });
        })?;
        Ok(Self { commands, published, audience, state_request, attendance, budget_ms, stop, thread: Some(thread) })
    }

    /// Queue of commands to the world. It is bounded: use `try_send` for commands that may be lost.
    pub fn commands(&self) -> mpsc::Sender<Command> {
        self.commands.clone()
    }

    /// The newest state. The channel closes when the thread ends.
    pub fn published(&self) -> watch::Receiver<Arc<Published>> {
        self.published.clone()
    }

    /// The patches that publications contain, all until something else is sent.
    pub fn audience(&self) -> watch::Sender<Audience> {
        self.audience.clone()
    }

    /// Request for the state of the grass: while it is true, the next publication carries it, and resets this to false.
    pub fn state_request(&self) -> Arc<AtomicBool> {
        self.state_request.clone()
    }

    /// Whether anybody needs the world to run, which keeps it from [pausing](Timing::pause_after).
    pub fn attendance(&self) -> Arc<Attendance> {
        self.attendance.clone()
    }

    /// The time of a tick on the server (ms) that replaces the scene's budget. No effect without [demands](Timing::demands).
    pub fn budget_ms(&self) -> watch::Sender<Option<f32>> {
        self.budget_ms.clone()
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn publish_rates_divide_the_step_rate() {
        let timing = |tick_hz, publish_hz| Timing { tick_hz, publish_hz, threads: None, pause_after: None, demands: None };
        assert_eq!(timing(60.0, 20.0).steps_per_publish(), 3);
        assert_eq!(timing(60.0, 25.0).published_hz(), 30.0);
        assert_eq!(timing(10.0, 60.0).steps_per_publish(), 1);
    }
}
