//! The threads that write segments and checkpoints, and their queues.

use super::checkpoint::seal_checkpoint;
use super::error::JournalError;
use super::folder::{Folder, segment_in};
use super::health::Health;
use super::segment::SegmentWriter;
use crate::world::{Command, WorldState};
use std::io;
use std::sync::Arc;
use std::sync::atomic::Ordering::Relaxed;
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::thread::{Builder, JoinHandle};
use std::time::{Duration, Instant};

/// Steps that may wait to be written: several seconds.
const STEP_CAPACITY: usize = 2048;
/// Time between two waits for the disk.
const SYNC_PERIOD: Duration = Duration::from_secs(2);

/// Message to the thread that writes segments.
pub(super) enum Entry {
    /// A generation begins after the step `tick`.
    Begin { generation: u64, tick: u64 },
    /// A step was done with these commands.
    Step { tick: u64, commands: Vec<Command> },
}

/// The running threads. Dropping it writes everything that waits.
pub(super) struct Writer {
    entries: Option<SyncSender<Entry>>,
    states: Option<SyncSender<(u64, WorldState)>>,
    /// States that have been written, whose memory serves for the next.
    written: Receiver<WorldState>,
    threads: Vec<JoinHandle<()>>,
}

impl Writer {
    /// Starts the threads.
    pub(super) fn start(folder: Folder, limit_bytes: u64, health: Arc<Health>) -> Result<Self, JournalError> {
        let (entries, inbox) = sync_channel(STEP_CAPACITY);
        let (states, state_inbox) = sync_channel(1);
        // One state is copied or written at a time; another would only take memory.
        let (returned, written) = sync_channel(1);
        let _ = returned.try_send(WorldState::default());
        let folder = Arc::new(folder);
        let spawn = |name: &str, run: Box<dyn FnOnce() + Send>| Builder::new().name(name.to_owned()).spawn(run);
        let segments = Segments { folder: folder.clone(), health: health.clone(), generation: 0, writer: None, synced: Instant::now() };
        let threads = [
            spawn("journal", Box::new(move || segments.run(&inbox))),
            spawn("checkpoint", Box::new(move || write_checkpoints(&folder, limit_bytes, &health, &state_inbox, &returned))),
        ];
        let threads = threads.into_iter().collect::<io::Result<_>>().map_err(JournalError::Threads)?;
        Ok(Self { entries: Some(entries), states: Some(states), written, threads })
    }

    /// Queues an entry; false if the queue is full.
    pub(super) fn enter(&self, entry: Entry) -> bool {
        self.entries.as_ref().is_some_and(|entries| entries.try_send(entry).is_ok())
    }

    /// Memory for the next state; `None` while the one before is still being written.
    pub(super) fn spare_state(&self) -> Option<WorldState> {
        self.written.try_recv().ok()
    }

    /// Queues the state at the beginning of a generation. Waits only if it does not come from [`spare_state`](Self::spare_state).
    pub(super) fn keep(&self, generation: u64, state: WorldState) {
        if let Some(states) = &self.states {
            // An error means that the thread has panicked, which the log says.
            let _ = states.send((generation, state));
        }
    }
}

impl Drop for Writer {
    fn drop(&mut self) {
        drop((self.entries.take(), self.states.take()));
        self.threads.drain(..).for_each(|thread| drop(thread.join()));
    }
}

/// The thread that writes segments.
struct Segments {
    folder: Arc<Folder>,
    health: Arc<Health>,
    generation: u64,
    writer: Option<SegmentWriter>,
    synced: Instant,
}

impl Segments {
    fn run(mut self, inbox: &Receiver<Entry>) {
        loop {
            let mut batch = match inbox.recv_timeout(SYNC_PERIOD) {
                Ok(entry) => vec![entry],
                Err(RecvTimeoutError::Timeout) => vec![],
                Err(RecvTimeoutError::Disconnected) => break,
            };
            while let Ok(entry) = inbox.try_recv() {
                batch.push(entry);
            }
            self.write(batch);
            if self.synced.elapsed() >= SYNC_PERIOD {
                self.synced = Instant::now();
                self.attempt(|writer| writer.sync().map(|()| 0));
            }
        }
        self.attempt(|writer| writer.sync().map(|()| 0));
    }

    fn write(&mut self, batch: Vec<Entry>) {
        let mut steps = vec![];
        for entry in batch {
            match entry {
                Entry::Step { tick, commands } => steps.push((tick, commands)),
                Entry::Begin { generation, tick } => {
                    self.append(std::mem::take(&mut steps));
                    self.begin(generation, tick);
                }
            }
        }
        self.append(steps);
    }

    fn begin(&mut self, generation: u64, tick: u64) {
        self.attempt(|writer| writer.sync().map(|()| 0));
        self.generation = generation;
        match SegmentWriter::create(&segment_in(self.folder.path(), generation), tick) {
            Ok(writer) => {
                self.writer = Some(writer);
                self.health.broken_generation.store(0, Relaxed);
            }
            Err(error) => self.fail(&error),
        }
    }

    fn append(&mut self, steps: Vec<(u64, Vec<Command>)>) {
        let count = steps.len() as u64;
        if count == 0 {
            return;
        }
        if !self.attempt(|writer| writer.append(steps.into_iter())) {
            self.health.lost_steps.fetch_add(count, Relaxed);
        }
    }

    /// Writes to the present segment; false if there is none, or it fails, which ends it.
    fn attempt(&mut self, write: impl FnOnce(&mut SegmentWriter) -> io::Result<u64>) -> bool {
        match self.writer.as_mut().map(write) {
            None => false,
            Some(Ok(bytes)) => {
                self.health.journal_bytes.fetch_add(bytes, Relaxed);
                true
            }
            Some(Err(error)) => {
                self.fail(&error);
                false
            }
        }
    }

    fn fail(&mut self, error: &io::Error) {
        self.writer = None;
        self.health.broken_generation.store(self.generation, Relaxed);
        self.health.fail("the journal of the world", error);
    }
}

/// Writes checkpoints as they come, and returns the states.
fn write_checkpoints(
    folder: &Folder,
    limit_bytes: u64,
    health: &Health,
    inbox: &Receiver<(u64, WorldState)>,
    returned: &SyncSender<WorldState>,
) {
    for (generation, state) in inbox {
        let begun = Instant::now();
        let tick = state.tick();
        let bytes = seal_checkpoint(&state);
        match folder.write_checkpoint(generation, &bytes).and_then(|()| folder.prune(limit_bytes)) {
            Ok(()) => {
                health.succeed();
                tracing::debug!(generation, tick, bytes = bytes.len(), secs = begun.elapsed().as_secs_f64(), "checkpoint");
            }
            Err(error) => health.fail("a checkpoint of the world", &error),
        }
        // Without room, the last state of a world that ends came after another.
        let _ = returned.try_send(state);
    }
}
