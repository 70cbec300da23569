//! The loop of the simulation thread: steps in real time, publications, and pauses.

use super::clock::{CATCH_UP_STEPS, Clock};
use super::controller::Controller;
use super::counter_log::CounterLog;
use super::published::step_histogram;
use super::{Attendance, Published, Request, Simulation, Timing};
use crate::detail::DetailRange;
use crate::histogram::Histogram;
use crate::snapshot::{Audience, Diagnostics, PatchQuantiser};
use crate::world::Command;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::time::{Duration, Instant};
use tokio::sync::{mpsc, watch};

/// Longest sleep of an idle world (s).
const IDLE_SLEEP_SECS: f64 = 0.05;

/// Longest sleep of a paused world, in which it notices that somebody came.
const PAUSED_SLEEP: Duration = Duration::from_millis(100);

/// Time between the publications of a paused world, which show that it is not stuck.
const PAUSED_PUBLISH: Duration = Duration::from_secs(1);

/// Fewest publications a second that remain when every other one is left out: clients take longer gaps for pauses.
const LEAST_PUBLISH_HZ: f32 = 8.0;

/// What the loop receives from outside.
pub(super) struct Intake {
    pub(super) inbox: mpsc::Receiver<Command>,
    pub(super) audience: watch::Receiver<Audience>,
    pub(super) budget_ms: watch::Receiver<Option<f32>>,
}

/// The world with its clock and its channels.
pub(super) struct Loop<S> {
    simulation: S,
    quantiser: PatchQuantiser,
    intake: Intake,
    /// Commands that came during a pause, and decisions about the detail.
    waiting: Vec<Command>,
    controller: Option<Controller>,
    /// Time of the steps and publications since the last decision.
    busy: Duration,
    sender: watch::Sender<Arc<Published>>,
    clock: Clock,
    steps_per_publish: u64,
    pause_after: Option<Duration>,
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
    pub(super) fn new(
        mut simulation: S,
        quantiser: PatchQuantiser,
        timing: Timing,
        intake: Intake,
        sender: watch::Sender<Arc<Published>>,
    ) -> Self {
        let published = simulation.publish(&mut PatchQuantiser::default());
        let (before, newest) = (published.diagnostics, published.decisions.last().copied());
        let may_halve_publications = timing.published_hz() >= LEAST_PUBLISH_HZ * 2.0;
        let range = simulation.detail_range().map(|range| DetailRange { may_halve_publications, ..range });
        let controller = timing.demands.zip(range);
        if controller.as_ref().is_some_and(|(demands, _)| demands.wind.is_some() || demands.bend_deg.is_some()) {
            simulation.watch_errors();
        }
        Self {
            tick: simulation.tick(),
            simulation,
            quantiser,
            intake,
            waiting: Vec::new(),
            controller: controller.map(|(demands, range)| Controller::new(demands, range, newest)),
            busy: Duration::ZERO,
            sender,
            clock: Clock::new(f64::from(timing.tick_hz)),
            steps_per_publish: timing.steps_per_publish(),
            pause_after: timing.pause_after,
            requests: BTreeMap::new(),
            step_times: Vec::new(),
            step_secs: step_histogram(),
            start: Instant::now(),
            dropped: CounterLog::default(),
            evicted: CounterLog::from(before.evicted_patches),
            reset: CounterLog::from(before.reset_patches),
        }
    }

    pub(super) fn run(mut self, stop: &AtomicBool, state_request: &AtomicBool, attendance: &Attendance) {
        while !stop.load(Relaxed) {
            if self.is_unattended(attendance) && self.simulation.is_at_rest() {
                self.pause(stop, attendance);
            }
            for _ in 0..self.clock.due(self.start.elapsed()) {
                self.step(state_request);
            }
            if self.dropped.increase(self.clock.dropped).is_some() {
                tracing::warn!(dropped_secs = self.clock.dropped_secs(), "the world is slower than real time; simulated time is dropped");
            }
            std::thread::sleep(self.clock.until(self.steps_at_once(), self.start.elapsed()));
        }
    }

    fn is_unattended(&self, attendance: &Attendance) -> bool {
        self.pause_after.is_some_and(|after| attendance.absent_for() >= after)
    }

    /// Waits, without a step, until somebody comes. The time of the world stands still.
    fn pause(&mut self, stop: &AtomicBool, attendance: &Attendance) {
        tracing::info!(tick = self.tick, "nobody is here and only the wind moves: the world pauses");
        let mut published_at: Option<Instant> = None;
        while !stop.load(Relaxed) && self.is_unattended(attendance) && self.waiting.is_empty() {
            if published_at.is_none_or(|at| at.elapsed() >= PAUSED_PUBLISH) {
                let state = self.simulation.publish(&mut self.quantiser);
                self.send(Published { is_paused: true, ..Published::new(state) });
                published_at = Some(Instant::now());
            }
            std::thread::sleep(PAUSED_SLEEP);
            self.receive();
        }
        self.clock.skip(self.start.elapsed());
        if let Some(controller) = &mut self.controller {
            controller.forget_load();
        }
        tracing::info!(tick = self.tick, "the world goes on");
    }

    /// Takes the commands that have come, except for empty lists of cameras.
    fn receive(&mut self) {
        while let Ok(command) = self.intake.inbox.try_recv() {
            if command != Command::Cameras(Vec::new()) {
                self.waiting.push(command);
            }
        }
    }

    /// Number of steps to do at once after the next sleep.
    fn steps_at_once(&self) -> u64 {
        if !self.simulation.is_idle() {
            return 1;
        }
        let (in_a_sleep, per_publish) = ((IDLE_SLEEP_SECS * self.clock.tick_hz) as u64, self.steps_per_publish());
        let to_publish = per_publish - self.tick % per_publish;
        to_publish.min(in_a_sleep).clamp(1, CATCH_UP_STEPS / 2)
    }

    /// Steps until the next snapshot, 0 when it is due now.
    fn steps_to_publish(&self) -> u64 {
        let per_publish = self.steps_per_publish();
        (per_publish - self.tick % per_publish) % per_publish
    }

    fn steps_per_publish(&self) -> u64 {
        self.steps_per_publish * self.controller.as_ref().map_or(1, |controller| controller.publish_divisor().into())
    }

    fn step(&mut self, state_request: &AtomicBool) {
        let mut commands = std::mem::take(&mut self.waiting);
        commands.extend(std::iter::from_fn(|| self.intake.inbox.try_recv().ok()));
        let begun = Instant::now();
        self.simulation.step(&commands);
        let duration = begun.elapsed();
        self.step_times.push(duration);
        self.busy += duration;
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
                Command::Drive { .. } | Command::Cameras(_) | Command::Join { .. } | Command::Adapt(_) => {}
            }
        }
    }

    fn publish(&mut self, with_bend_state: bool) {
        let begun = Instant::now();
        self.quantiser.set_audience(self.intake.audience.borrow().clone());
        let mut snapshot = self.simulation.publish(&mut self.quantiser);
        let total: Duration = self.step_times.iter().sum();
        snapshot.diagnostics.step_secs = total.as_secs_f32() / self.step_times.len() as f32;
        snapshot.diagnostics.step_max_secs = self.step_times.iter().max().map_or(0.0, Duration::as_secs_f32);
        let steps = std::mem::take(&mut self.step_times).len();
        let resets = snapshot.diagnostics.wind_resets;
        if resets > self.sender.borrow().snapshot.diagnostics.wind_resets {
            tracing::warn!(resets, "the wind solver failed and restarted from the mean wind");
        }
        if let Some(patches) = self.evicted.increase(snapshot.diagnostics.evicted_patches)
            && snapshot.diagnostics.load_level == 0
        {
            let awake = snapshot.diagnostics.awake_patches;
            tracing::warn!(patches, awake, "patches far from all cameras were put to sleep: `patches.awake_limit` is reached");
        }
        if let Some(patches) = self.reset.increase(snapshot.diagnostics.reset_patches) {
            tracing::warn!(patches, "grass moved faster than the scheme can follow, or was NaN or infinite, and was put to rest");
        }
        let bend_state = with_bend_state.then(|| self.simulation.bend_state()).flatten().map(Arc::new);
        self.busy += begun.elapsed();
        self.adapt(steps, &snapshot.diagnostics);
        self.send(Published { bend_state, ..Published::new(snapshot) });
    }

    /// Adapts the detail of the world, which took so many steps since the last time.
    fn adapt(&mut self, steps: usize, diagnostics: &Diagnostics) {
        let busy_ms = std::mem::take(&mut self.busy).as_secs_f64() * 1e3 / steps as f64;
        let Some(controller) = &mut self.controller else { return };
        if let Some(budget_ms) = *self.intake.budget_ms.borrow() {
            controller.set_budget(budget_ms);
        }
        if let Some(decision) = controller.decide(self.start.elapsed(), self.tick, steps as u32, busy_ms, diagnostics) {
            tracing::info!(tick = self.tick, "{}: {}", decision.reason, decision.detail);
            self.waiting.push(Command::Adapt(decision));
        }
    }

    /// Publishes a state, with the information from the runner.
    fn send(&mut self, state: Published) {
        let published = Published {
            requests: self.requests.clone(),
            departed: self.simulation.departed(),
            dropped_secs: self.clock.dropped_secs(),
            dropped_recently_secs: self.clock.dropped_recently_secs(self.start.elapsed()),
            step_secs: self.step_secs.clone(),
            control: self.controller.as_ref().map(|controller| controller.report(&state.snapshot.diagnostics)),
            ..state
        };
        self.sender.send_replace(Arc::new(published));
    }
}
