//! A run for the rerun viewer: the fields, the objects and the scalars that tell health.
//!
//! The simulation never waits for a viewer. [`Inspector::observe`] only puts a snapshot into a short queue; a thread of its
//! own empties it. When a viewer is slow or frozen the SDK's calls block that thread, the queue fills, and frames are
//! dropped; how many is itself logged. This folder alone knows rerun, and only with the cargo feature `rerun`.

#![cfg_attr(not(feature = "rerun"), allow(dead_code, reason = "only rerun draws what is gathered here"))]

mod arrows;
#[cfg(feature = "rerun")]
mod blueprint;
mod ground;
mod palette;
#[cfg(feature = "rerun")]
mod recording;
mod target;
mod trails;

pub use target::{Target, TargetError};

use crate::snapshot::Snapshot;
use shared::scene::Scene;
use shared::terrain::{CoverMap, HeightMap};
use std::net::SocketAddr;
use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, channel, sync_channel};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use thiserror::Error;

/// Snapshots that wait for the logger at most; further ones are dropped.
const QUEUE_LIMIT: usize = 4;

/// Simulated time between frames for a viewer that looks on (s).
const LIVE_PERIOD_SECS: f64 = 0.15;

/// Simulated time between frames in a file (s).
const FILE_PERIOD_SECS: f64 = 0.1;

/// How long a live recording may take to finish: a frozen viewer would hold it for ever.
const LIVE_FINISH: Duration = Duration::from_secs(3);

/// How long a file may take to be written to its end.
const FILE_FINISH: Duration = Duration::from_secs(10);

/// Why a run can't be recorded.
#[derive(Debug, Error)]
pub enum InspectError {
    /// The address to serve at is taken, or not this machine's.
    #[error("can't serve the recording at {addr}: {reason}; choose another port with serve=PORT")]
    Address {
        /// The address asked for.
        addr: SocketAddr,
        /// The system's reason.
        reason: std::io::Error,
    },
    /// The file can't be written.
    #[error("can't write the recording to {}: {reason}", path.display())]
    File {
        /// The file asked for.
        path: PathBuf,
        /// The system's reason.
        reason: std::io::Error,
    },
    /// No viewer answers.
    #[error("no viewer answers at {url}: {reason}; start one with `rerun` first")]
    NoViewer {
        /// The address asked for.
        url: String,
        /// The system's reason.
        reason: std::io::Error,
    },
    /// The SDK refused.
    #[error("rerun: {0}")]
    Sdk(String),
    /// The logger had not finished in time, as behind a frozen viewer; the end of the recording may be missing.
    #[error("the recording {target} was not finished within {} s; its end may be missing", waited.as_secs())]
    Unfinished {
        /// Where it goes.
        target: String,
        /// How long it was waited for.
        waited: Duration,
    },
    /// This program was built without the feature `rerun`.
    #[error("this program was built without rerun; build it with the cargo feature `rerun`")]
    NotBuilt,
}

/// What travels to the clients.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Traffic {
    clients: u32,
    bytes_per_s: f64,
}

/// One frame of a recording.
struct Frame {
    snapshot: Snapshot,
    traffic: Traffic,
    /// Frames dropped so far.
    dropped: u64,
}

/// What a logger thread writes to. Calls may block.
trait Sink: Send + 'static {
    fn write(&mut self, frame: &Frame) -> Result<(), InspectError>;
    fn finish(self) -> Result<(), InspectError>;
}

/// Records a run to one [`Target`], from a thread of its own.
///
/// Dropping it ends the recording without waiting for it; [`finish`](Self::finish) waits.
pub struct Inspector {
    target: String,
    intake: Mutex<Intake>,
    finished: Mutex<Receiver<Result<(), InspectError>>>,
    finish_limit: Duration,
    period_secs: f64,
    dropped: AtomicU64,
}

/// What decides on the next frame.
struct Intake {
    /// None once the recording is being finished.
    queue: Option<SyncSender<Frame>>,
    last_secs: Option<f64>,
    traffic: Traffic,
}

impl Inspector {
    /// Opens the target, logs what stays as it is (land, colours, first view) and starts the logger thread.
    ///
    /// # Errors
    /// [`InspectError`] when the address is taken, the file can't be made, or no viewer answers.
    pub fn start(target: &Target, scene: &Scene, heights: &HeightMap, cover: &CoverMap) -> Result<Self, InspectError> {
        let (period_secs, finish_limit) = match target {
            Target::Save(_) => (FILE_PERIOD_SECS, FILE_FINISH),
            Target::Serve(_) | Target::Connect(_) => (LIVE_PERIOD_SECS, LIVE_FINISH),
        };
        #[cfg(feature = "rerun")]
        {
            let recording = recording::Recording::open(target, scene, heights, cover)?;
            Ok(Self::with_sink(recording.address(), recording, period_secs, finish_limit))
        }
        #[cfg(not(feature = "rerun"))]
        {
            let _ = (scene, heights, cover, period_secs, finish_limit);
            Err(InspectError::NotBuilt)
        }
    }

    fn with_sink(target: String, mut sink: impl Sink, period_secs: f64, finish_limit: Duration) -> Self {
        let (queue, frames) = sync_channel::<Frame>(QUEUE_LIMIT);
        let (finishing, finished) = channel();
        std::thread::spawn(move || {
            let written = frames.iter().try_for_each(|frame| sink.write(&frame));
            if let Err(error) = &written {
                tracing::warn!(%error, "the recording ends here; the run goes on without it");
            }
            let _ = finishing.send(written.and_then(|()| sink.finish()));
        });
        Self {
            target,
            intake: Mutex::new(Intake { queue: Some(queue), last_secs: None, traffic: Traffic::default() }),
            finished: Mutex::new(finished),
            finish_limit,
            period_secs,
            dropped: AtomicU64::new(0),
        }
    }

    /// Where the recording goes; for `serve`, what a viewer connects to.
    pub fn target(&self) -> &str {
        &self.target
    }

    /// Takes a snapshot into the recording if the last one taken is old enough. Never waits: when the logger is behind, the
    /// snapshot is dropped and counted.
    pub fn observe(&self, snapshot: &Snapshot) {
        let mut intake = self.intake();
        let age_secs = intake.last_secs.map_or(f64::INFINITY, |last| (snapshot.time_secs - last).abs());
        if age_secs < self.period_secs - 1e-6 {
            return;
        }
        intake.last_secs = Some(snapshot.time_secs);
        let frame = Frame { snapshot: snapshot.clone(), traffic: intake.traffic, dropped: self.dropped() };
        if intake.queue.as_ref().is_none_or(|queue| queue.try_send(frame).is_err()) {
            self.dropped.fetch_add(1, Ordering::Relaxed);
        }
    }

    /// Takes what travels to the clients into the frames that follow: their number, and the bytes sent to all of them in a
    /// second.
    pub fn observe_traffic(&self, clients: u32, bytes_per_s: f64) {
        self.intake().traffic = Traffic { clients, bytes_per_s };
    }

    /// Frames dropped so far because the logger was behind or had ended.
    pub fn dropped(&self) -> u64 {
        self.dropped.load(Ordering::Relaxed)
    }

    /// Writes what is queued and closes the recording; waits 3 s for a viewer, 10 s for a file, and not longer. Snapshots
    /// observed afterwards are dropped.
    ///
    /// # Errors
    /// What the logger failed with, or [`InspectError::Unfinished`] when it is still busy.
    pub fn finish(&self) -> Result<(), InspectError> {
        self.intake().queue = None;
        let finished = self.finished.lock().unwrap_or_else(PoisonError::into_inner);
        match finished.recv_timeout(self.finish_limit) {
            Ok(result) => result,
            Err(RecvTimeoutError::Timeout) => Err(InspectError::Unfinished { target: self.target.clone(), waited: self.finish_limit }),
            Err(RecvTimeoutError::Disconnected) => Err(InspectError::Sdk("the logger thread has ended before".to_owned())),
        }
    }

    fn intake(&self) -> MutexGuard<'_, Intake> {
        self.intake.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Writes each frame only when the test allows it, as behind a viewer that has stopped reading.
    struct Gate {
        open: Receiver<()>,
        written: std::sync::mpsc::Sender<(u64, u64, Traffic)>,
    }

    impl Sink for Gate {
        fn write(&mut self, frame: &Frame) -> Result<(), InspectError> {
            let _ = self.open.recv();
            let _ = self.written.send((frame.snapshot.tick, frame.dropped, frame.traffic));
            Ok(())
        }

        fn finish(self) -> Result<(), InspectError> {
            Ok(())
        }
    }

    fn gated(finish_limit: Duration) -> (Inspector, std::sync::mpsc::Sender<()>, Receiver<(u64, u64, Traffic)>) {
        let (opener, open) = channel();
        let (written, writes) = channel();
        (Inspector::with_sink("gate".to_owned(), Gate { open, written }, 0.1, finish_limit), opener, writes)
    }

    fn snapshot(tick: u64) -> Snapshot {
        Snapshot { tick, time_secs: tick as f64 / 60.0, ..Snapshot::default() }
    }

    #[test]
    fn a_viewer_that_never_reads_costs_frames_and_no_time() {
        let (inspector, opener, writes) = gated(Duration::from_millis(1));
        for frame in 0..100 {
            inspector.observe(&snapshot(6 * frame));
        }
        let held = QUEUE_LIMIT as u64 + 1;
        assert!((100 - held..=100 - held + 1).contains(&inspector.dropped()), "{} dropped", inspector.dropped());
        assert!(writes.try_recv().is_err());
        assert!(matches!(inspector.finish(), Err(InspectError::Unfinished { .. })));
        drop(opener);
    }

    #[test]
    fn the_count_of_dropped_frames_is_in_the_recording() {
        let (inspector, opener, writes) = gated(Duration::from_secs(60));
        inspector.observe_traffic(3, 1e5);
        for frame in 0..20 {
            inspector.observe(&snapshot(6 * frame));
        }
        let dropped = inspector.dropped();
        let accepted = 20 - dropped;
        (0..accepted).for_each(|_| opener.send(()).unwrap());
        let writes_of_accepted: Vec<_> = (0..accepted).map(|_| writes.recv().unwrap()).collect();
        inspector.observe(&snapshot(600));
        opener.send(()).unwrap();
        assert_eq!(writes_of_accepted[0], (0, 0, Traffic { clients: 3, bytes_per_s: 1e5 }));
        assert_eq!(writes.recv().unwrap().1, dropped);
        drop(opener);
        inspector.finish().unwrap();
    }

    #[test]
    fn snapshots_are_thinned_by_simulated_time() {
        let (inspector, opener, writes) = gated(Duration::from_secs(60));
        for tick in [0, 1, 5, 6, 7, 12, 3] {
            inspector.observe(&snapshot(tick));
            let _ = opener.send(());
        }
        drop(opener);
        inspector.finish().unwrap();
        drop(inspector);
        assert_eq!(writes.iter().map(|(tick, ..)| tick).collect::<Vec<_>>(), [0, 6, 12, 3]);
    }

    /// What is logged while the test runs.
    #[derive(Clone, Default)]
    struct Log(std::sync::Arc<Mutex<Vec<u8>>>);

    impl std::io::Write for Log {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            self.0.lock().unwrap().extend_from_slice(bytes);
            Ok(bytes.len())
        }

        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn a_logger_that_has_failed_is_told_of_and_is_no_harm() {
        struct Broken;
        impl Sink for Broken {
            fn write(&mut self, _: &Frame) -> Result<(), InspectError> {
                Err(InspectError::Sdk("gone".to_owned()))
            }
            fn finish(self) -> Result<(), InspectError> {
                Ok(())
            }
        }
        let log = Log::default();
        let writer = log.clone();
        tracing_subscriber::fmt().with_writer(move || writer.clone()).init();
        let inspector = Inspector::with_sink("broken".to_owned(), Broken, 0.0, Duration::from_secs(60));
        while inspector.dropped() == 0 {
            inspector.observe(&snapshot(0));
        }
        assert_eq!(inspector.finish().unwrap_err().to_string(), "rerun: gone");
        let told = String::from_utf8(log.0.lock().unwrap().clone()).unwrap();
        assert!(told.contains("WARN") && told.contains("the recording ends here") && told.contains("gone"), "{told}");
    }
}
