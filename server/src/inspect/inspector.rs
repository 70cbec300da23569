//! The recorder of a run: a bounded queue in front of a logger thread.

use super::error::InspectError;
use super::rates::{EntityRate, frame_secs};
#[cfg(feature = "rerun")]
use super::recording::Recording;
use super::sink::{Frame, Sink};
use super::target::Target;
use crate::metrics::RecordingStats;
use crate::snapshot::Snapshot;
use prairie_core::scene::Scene;
use prairie_core::terrain::{CoverMap, HeightMap};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, channel, sync_channel};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, SystemTime, UNIX_EPOCH};

/// Capacity of the queue in front of the logger (frames); when it is full, frames are dropped.
const QUEUE_LIMIT: usize = 4;

/// Simulated time between frames for a live viewer (s).
const LIVE_PERIOD_SECS: f64 = 0.15;

/// Simulated time between frames in a file (s).
const FILE_PERIOD_SECS: f64 = 0.1;

/// Time limit for finishing a live recording, since a frozen viewer would block it forever.
const LIVE_FINISH: Duration = Duration::from_secs(3);

/// Time limit for finishing a file.
const FILE_FINISH: Duration = Duration::from_secs(10);

/// Records a run to one [`Target`] from a thread of its own.
///
/// Dropping it ends the recording without waiting; [`finish`](Self::finish) waits.
pub struct Inspector {
    target: String,
    intake: Mutex<Intake>,
    finished: Mutex<Receiver<Result<(), InspectError>>>,
    finish_limit: Duration,
    period_secs: f64,
    dropped: AtomicU64,
}

/// State for the next frame.
struct Intake {
    /// `None` while the recording is being closed.
    queue: Option<SyncSender<Frame>>,
    last_secs: Option<f64>,
    clients: u32,
    sent_bytes_per_s: f64,
}

impl Inspector {
    /// Opens the target, logs the static data (terrain, colours, layout) and starts the logger thread. Entities have their default rates, except for those
    /// in `rates`; of several for one entity the last counts.
    ///
    /// # Errors
    /// [`InspectError`] when the address is in use, the file cannot be created, or no viewer listens.
    pub fn start(
        target: &Target,
        rates: &[EntityRate],
        scene: &Scene,
        heights: &HeightMap,
        cover: &CoverMap,
    ) -> Result<Self, InspectError> {
        let (period_secs, finish_limit) = match target {
            Target::Save(_) => (FILE_PERIOD_SECS, FILE_FINISH),
            Target::Serve(_) | Target::Connect(_) => (LIVE_PERIOD_SECS, LIVE_FINISH),
        };
        let period_secs = frame_secs(period_secs, rates);
        #[cfg(feature = "rerun")]
        {
            let recording = Recording::open(target, rates, scene, heights, cover)?;
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
                tracing::warn!(%error, "the recording stops here; the run continues without it");
            }
            let _ = finishing.send(written.and_then(|()| sink.finish()));
        });
        Self {
            target,
            intake: Mutex::new(Intake { queue: Some(queue), last_secs: None, clients: 0, sent_bytes_per_s: 0.0 }),
            finished: Mutex::new(finished),
            finish_limit,
            period_secs,
            dropped: AtomicU64::new(0),
        }
    }

    /// Destination of the recording; for `serve`, the URL for viewers.
    pub fn target(&self) -> &str {
        &self.target
    }

    /// Records a snapshot if the last recorded one is old enough. Never waits: when the logger is behind, the snapshot is dropped
    /// and counted.
    pub fn observe(&self, snapshot: &Snapshot) {
        let mut intake = self.intake();
        let age_secs = intake.last_secs.map_or(f64::INFINITY, |last| (snapshot.time_secs - last).abs());
        if age_secs < self.period_secs - 1e-6 {
            return;
        }
        intake.last_secs = Some(snapshot.time_secs);
        let Intake { clients, sent_bytes_per_s, .. } = *intake;
        let stats = RecordingStats { clients, sent_bytes_per_s, dropped_log_frames: self.dropped() };
        let wall_secs = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0.0, |since| since.as_secs_f64());
        let frame = Frame { snapshot: snapshot.clone(), stats, wall_secs };
        if intake.queue.as_ref().is_none_or(|queue| queue.try_send(frame).is_err()) {
            self.dropped.fetch_add(1, Ordering::Relaxed);
        }
    }

    /// Sets the number of clients and the rate of the bytes sent to all of them (bytes/s), for the frames that follow.
    pub fn observe_traffic(&self, clients: u32, sent_bytes_per_s: f64) {
        let mut intake = self.intake();
        (intake.clients, intake.sent_bytes_per_s) = (clients, sent_bytes_per_s);
    }

    /// Number of frames dropped so far because the logger was behind or had ended.
    pub fn dropped(&self) -> u64 {
        self.dropped.load(Ordering::Relaxed)
    }

    /// Writes the queued frames and closes the recording; waits at most 3 s for a viewer and 10 s for a file. Snapshots observed
    /// afterwards are dropped.
    ///
    /// # Errors
    /// The error that ended the logger, or [`InspectError::Unfinished`] when it is still busy.
    pub fn finish(&self) -> Result<(), InspectError> {
        self.intake().queue = None;
        let finished = self.finished.lock().unwrap_or_else(PoisonError::into_inner);
        match finished.recv_timeout(self.finish_limit) {
            Ok(result) => result,
            Err(RecvTimeoutError::Timeout) => Err(InspectError::Unfinished { target: self.target.clone(), waited: self.finish_limit }),
            Err(RecvTimeoutError::Disconnected) => Err(InspectError::Sdk("the logger thread ended early".to_owned())),
        }
    }

    fn intake(&self) -> MutexGuard<'_, Intake> {
        self.intake.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Writes each frame only when the test allows it, like a viewer that has stopped reading.
    struct Gate {
        open: Receiver<()>,
        written: std::sync::mpsc::Sender<(u64, RecordingStats)>,
    }

    impl Sink for Gate {
        fn write(&mut self, frame: &Frame) -> Result<(), InspectError> {
            let _ = self.open.recv();
            let _ = self.written.send((frame.snapshot.tick, frame.stats));
            Ok(())
        }

        fn finish(self) -> Result<(), InspectError> {
            Ok(())
        }
    }

    fn gated(finish_limit: Duration) -> (Inspector, std::sync::mpsc::Sender<()>, Receiver<(u64, RecordingStats)>) {
        let (opener, open) = channel();
        let (written, writes) = channel();
        (Inspector::with_sink("gate".to_owned(), Gate { open, written }, 0.1, finish_limit), opener, writes)
    }

    fn snapshot(tick: u64) -> Snapshot {
        Snapshot { tick, time_secs: tick as f64 / 60.0, ..Snapshot::default() }
    }

    #[test]
    fn a_frozen_viewer_costs_frames_and_no_time() {
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
    fn the_recording_contains_the_number_of_dropped_frames() {
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
        let first = RecordingStats { clients: 3, sent_bytes_per_s: 1e5, dropped_log_frames: 0 };
        assert_eq!(writes_of_accepted[0], (0, first));
        assert_eq!(writes.recv().unwrap().1.dropped_log_frames, dropped);
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

    /// The log of the test.
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
    fn a_failed_logger_is_reported_and_does_no_harm() {
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
        let logged = String::from_utf8(log.0.lock().unwrap().clone()).unwrap();
        assert!(logged.contains("WARN") && logged.contains("the recording stops here") && logged.contains("gone"), "{logged}");
    }
}
