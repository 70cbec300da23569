//! A bounded queue of log lines in front of the thread that writes them.

use std::io::{self, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering::Relaxed};
use std::sync::mpsc::{Receiver, SyncSender, TryRecvError, channel, sync_channel};
use std::thread;
use std::time::Duration;
use tracing::Dispatch;
use tracing_subscriber::fmt::MakeWriter;

/// Most lines that wait to be written.
const LINES_LIMIT: usize = 4096;

/// Most bytes of these lines.
const BYTES_LIMIT: usize = 4 << 20;

/// Time limit for writing the last lines at the end of the program, in case stderr is not read.
const END_LIMIT: Duration = Duration::from_secs(1);

/// The queue's entrance. Never waits: a line for which there is no room is lost, and counted.
#[derive(Clone)]
pub(super) struct Queue {
    lines: SyncSender<Vec<u8>>,
    state: Arc<State>,
}

#[derive(Default)]
struct State {
    /// Bytes of the waiting lines.
    bytes: AtomicUsize,
    /// Lines lost since they were last reported.
    lost: AtomicU64,
    /// Whether the thread ends after the last line.
    is_ending: AtomicBool,
}

/// Ends the thread when it is dropped, after the waiting lines are written, or after a second.
pub(crate) struct Guard {
    queue: Queue,
    ended: Receiver<()>,
}

impl Queue {
    /// Starts the thread, which writes to `output`. Losses are reported through `losses`, which must write to the same place without this queue.
    ///
    /// # Errors
    /// When the system refuses to start a thread.
    pub(super) fn start(output: impl Write + Send + 'static, losses: Dispatch) -> io::Result<(Self, Guard)> {
        let (sender, lines) = sync_channel(LINES_LIMIT);
        let (ending, ended) = channel();
        let queue = Self { lines: sender, state: Arc::default() };
        let state = queue.state.clone();
        thread::Builder::new().name("log".to_owned()).spawn(move || {
            write_lines(&lines, output, &state, &losses);
            let _ = ending.send(());
        })?;
        Ok((queue.clone(), Guard { queue, ended }))
    }
}

/// Writes lines until the guard is dropped. When the queue is empty, reports the number of lines lost meanwhile.
fn write_lines(lines: &Receiver<Vec<u8>>, mut output: impl Write, state: &State, losses: &Dispatch) {
    loop {
        let line = match lines.try_recv() {
            Ok(line) => line,
            Err(TryRecvError::Disconnected) => return,
            Err(TryRecvError::Empty) => {
                let lost = state.lost.swap(0, Relaxed);
                if lost > 0 {
                    let report = || tracing::warn!(lost, "lines of the log were lost, since stderr was not read fast enough");
                    tracing::dispatcher::with_default(losses, report);
                }
                if state.is_ending.load(Relaxed) {
                    return;
                }
                let Ok(line) = lines.recv() else { return };
                line
            }
        };
        state.bytes.fetch_sub(line.len(), Relaxed);
        // If stderr is closed, nobody can be told.
        let _ = output.write_all(&line);
    }
}

impl Write for Queue {
    fn write(&mut self, line: &[u8]) -> io::Result<usize> {
        let State { bytes, lost, .. } = &*self.state;
        let has_room = bytes.fetch_add(line.len(), Relaxed) + line.len() <= BYTES_LIMIT;
        if !has_room || self.lines.try_send(line.to_vec()).is_err() {
            bytes.fetch_sub(line.len(), Relaxed);
            lost.fetch_add(1, Relaxed);
        }
        Ok(line.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl<'w> MakeWriter<'w> for Queue {
    type Writer = Self;

    fn make_writer(&'w self) -> Self {
        self.clone()
    }
}

impl Drop for Guard {
    fn drop(&mut self) {
        self.queue.state.is_ending.store(true, Relaxed);
        // Wakes the thread, should it wait for a line; a full queue keeps it awake.
        let _ = self.queue.lines.try_send(Vec::new());
        let _ = self.ended.recv_timeout(END_LIMIT);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;
    use tracing_subscriber::layer::SubscriberExt as _;

    /// An output that takes each line only when the test allows it.
    struct Gate {
        open: Receiver<()>,
        written: Written,
    }

    #[derive(Clone, Default)]
    struct Written(Arc<Mutex<Vec<u8>>>);

    impl Write for Written {
        fn write(&mut self, line: &[u8]) -> io::Result<usize> {
            self.0.lock().unwrap().extend_from_slice(line);
            Ok(line.len())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    impl Write for Gate {
        fn write(&mut self, line: &[u8]) -> io::Result<usize> {
            let _ = self.open.recv();
            self.written.write(line)
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    fn gated() -> (Queue, Guard, std::sync::mpsc::Sender<()>, Written) {
        let (opener, open) = channel();
        let written = Written::default();
        let (output, losses) = (written.clone(), written.clone());
        let layer = tracing_subscriber::fmt::layer().without_time().with_target(false).with_ansi(false).with_writer(move || losses.clone());
        let (queue, guard) = Queue::start(Gate { open, written: output }, tracing_subscriber::registry().with(layer).into()).unwrap();
        (queue, guard, opener, written)
    }

    fn text(written: &Written) -> String {
        String::from_utf8(written.0.lock().unwrap().clone()).unwrap()
    }

    #[test]
    fn an_output_that_takes_nothing_delays_nobody_and_the_losses_are_counted_later() {
        let (mut queue, guard, opener, written) = gated();
        let sent = 2 * LINES_LIMIT;
        for _ in 0..sent {
            queue.write_all(b"x\n").unwrap();
        }
        assert_eq!(text(&written), "");
        drop(opener);
        drop(guard);
        let text = text(&written);
        let kept = text.lines().filter(|line| *line == "x").count();
        assert!((LINES_LIMIT..=LINES_LIMIT + 1).contains(&kept), "{kept}");
        let report = format!(" WARN lines of the log were lost, since stderr was not read fast enough lost={}\n", sent - kept);
        assert!(text.ends_with(&report), "{}", &text[text.len().saturating_sub(200)..]);
    }

    #[test]
    fn long_lines_are_bounded_by_their_bytes() {
        let (mut queue, guard, opener, written) = gated();
        let line = vec![b'y'; BYTES_LIMIT / 4];
        for _ in 0..8 {
            queue.write_all(&line).unwrap();
        }
        drop(opener);
        drop(guard);
        let kept = text(&written).matches('y').count() / line.len();
        assert!((4..=5).contains(&kept), "{kept}");
    }
}
