//! Signals that stop the server: Ctrl-C, and on Unix SIGTERM and SIGHUP; and one that does not.

use std::io;
use std::sync::{
    Arc,
    atomic::{AtomicBool, Ordering::Relaxed},
};

/// Flag set by a stop signal, for work outside an async runtime. From then on, writes beyond the allowed size of a file fail instead of ending the program.
///
/// # Errors
/// When the system refuses the handlers or the thread that waits for them.
pub(super) fn stop_flag() -> io::Result<Arc<AtomicBool>> {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
    let mut signal = runtime.block_on(async {
        survive_full_files();
        StopSignal::install()
    })?;
    let flag = Arc::new(AtomicBool::new(false));
    let set = Arc::clone(&flag);
    std::thread::Builder::new().name("signals".to_owned()).spawn(move || {
        runtime.block_on(signal.received());
        set.store(true, Relaxed);
    })?;
    Ok(flag)
}

/// Lets a write beyond the allowed size of a file fail instead of ending the program.
pub(super) fn survive_full_files() {
    #[cfg(target_os = "linux")]
    {
        use tokio::signal::unix::{SignalKind, signal};
        /// The number of SIGXFSZ on most machines.
        const SIGXFSZ: i32 = 25;
        // The handler stays when the stream of signals is dropped. Where it cannot be installed, such a write ends the program as before.
        drop(signal(SignalKind::from_raw(SIGXFSZ)));
    }
}

/// Installed signal handlers.
#[cfg(unix)]
pub(super) struct StopSignal {
    interrupt: tokio::signal::unix::Signal,
    terminate: tokio::signal::unix::Signal,
    /// `None` where SIGHUP was ignored when the program started, as `nohup` does.
    hangup: Option<tokio::signal::unix::Signal>,
}

#[cfg(unix)]
impl StopSignal {
    /// Installs the handlers. A signal that comes from now on is not lost.
    ///
    /// # Errors
    /// When the system refuses.
    pub(super) fn install() -> io::Result<Self> {
        use tokio::signal::unix::{SignalKind, signal};
        let hangup = (!is_ignored(SignalKind::hangup())).then(|| signal(SignalKind::hangup())).transpose()?;
        Ok(Self { interrupt: signal(SignalKind::interrupt())?, terminate: signal(SignalKind::terminate())?, hangup })
    }

    /// Completes when a signal has come, and logs it.
    pub(super) async fn received(&mut self) {
        let hangup = async {
            match &mut self.hangup {
                Some(hangup) => hangup.recv().await,
                None => std::future::pending().await,
            }
        };
        let signal = tokio::select! {
            _ = self.interrupt.recv() => "SIGINT",
            _ = self.terminate.recv() => "SIGTERM",
            _ = hangup => "SIGHUP",
        };
        tracing::info!(signal, "stopping");
    }
}

/// Whether the program was started with a signal ignored; false where the system does not tell.
#[cfg(unix)]
fn is_ignored(signal: tokio::signal::unix::SignalKind) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0);
    mask >> (signal.as_raw_value() - 1) & 1 == 1
}

/// Installed signal handlers.
#[cfg(not(unix))]
pub(super) struct StopSignal;

#[cfg(not(unix))]
impl StopSignal {
    /// Prepares to wait for Ctrl-C.
    ///
    /// # Errors
    /// Never.
    pub(super) fn install() -> io::Result<Self> {
        Ok(Self)
    }

    /// Completes on Ctrl-C, and logs it.
    pub(super) async fn received(&mut self) {
        let _ = tokio::signal::ctrl_c().await;
        tracing::info!("stopping");
    }
}
