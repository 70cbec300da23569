//! A chromedriver process and its Chromium, which end together.

use std::env;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::time::Duration;

use anyhow::{Context as _, Result, bail};
use rustix::process::{Pid, Signal, kill_process_group};
use tempfile::TempDir;
use tokio::process::{Child, Command};
use tokio::time::{Instant, sleep};

const INSTALL: &str = "The browser tests drive a real Chromium through WebDriver. Install both programs: \
    on Debian `apt-get install chromium chromium-driver`, on Ubuntu `snap install chromium`, elsewhere Chrome or Chromium with the \
    chromedriver of the same version, both on the PATH.";

const START_LIMIT: Duration = Duration::from_secs(60);

/// Chromedriver listens on one port for IPv6 and IPv4; another program may have taken the second one, which it does not try again by itself.
const PORT_TAKEN: &str = "port not available";
const ATTEMPTS: u32 = 5;

/// A running chromedriver in a process group of its own. Dropping it ends the whole group, browsers included, and removes its files.
#[derive(Debug)]
pub struct Chromedriver {
    process: Child,
    group: Pid,
    files: TempDir,
    /// Its address, such as `http://127.0.0.1:34765`.
    pub url: String,
}

impl Chromedriver {
    /// Starts chromedriver on a free port.
    ///
    /// # Errors
    /// When chromedriver is not installed (the message says what to install), or reports no port within a minute.
    pub async fn start() -> Result<Self> {
        let mut attempt = 1;
        loop {
            match Self::start_once().await {
                Err(error) if attempt < ATTEMPTS && error.to_string().contains(PORT_TAKEN) => attempt += 1,
                outcome => return outcome,
            }
        }
    }

    async fn start_once() -> Result<Self> {
        let files = tempfile::Builder::new().prefix("prairie-browser-").tempdir().context("no directory for the browser's profile")?;
        let log = File::create(files.path().join(LOG))?;
        let program = on_path(&["chromedriver"]).context(INSTALL)?;
        let mut process = Command::new(&program)
            .args(["--port=0", "--enable-chrome-logs"])
            .env("TMPDIR", files.path())
            .stdin(Stdio::null())
            .stdout(log.try_clone()?)
            .stderr(log)
            .process_group(0)
            .spawn()
            .with_context(|| format!("{} did not start", program.display()))?;
        let group = process.id().and_then(|id| Pid::from_raw(id.cast_signed())).context("chromedriver ended at once")?;
        let port = port_from(&mut process, &files.path().join(LOG)).await?;
        Ok(Self { process, group, files, url: format!("http://127.0.0.1:{port}") })
    }

    /// The directory for the browser's profile.
    #[must_use]
    pub fn profile(&self) -> PathBuf {
        self.files.path().join("profile")
    }

    /// Processor time that chromedriver and its browser have used so far (s), of the processes that are still running. Linux only: 0 elsewhere.
    #[must_use]
    pub fn cpu_secs(&self) -> f64 {
        let processes = fs::read_dir("/proc").into_iter().flatten().flatten();
        let stats = processes.filter_map(|process| fs::read_to_string(process.path().join("stat")).ok());
        stats.filter_map(|stat| cpu_ticks(&stat, self.group.as_raw_nonzero().get())).sum::<u64>() as f64 / TICKS_PER_SEC
    }

    /// Processor time that the main threads of pages have used so far (s), without those of workers, of the graphics process and of the browser itself. Linux
    /// only: 0 elsewhere.
    #[must_use]
    pub fn page_cpu_secs(&self) -> f64 {
        let processes = fs::read_dir("/proc").into_iter().flatten().flatten();
        let nanos = processes.filter_map(|process| {
            let read = |file: &str| fs::read_to_string(process.path().join(file)).ok();
            cpu_ticks(&read("stat")?, self.group.as_raw_nonzero().get())?;
            read("cmdline")?.contains("--type=renderer").then_some(())?;
            let thread = Path::new("task").join(process.file_name()).join("schedstat");
            read(thread.to_str()?)?.split_whitespace().next()?.parse::<u64>().ok()
        });
        nanos.sum::<u64>() as f64 / 1e9
    }

    /// Output of chromedriver and Chromium so far, including the console of the page.
    #[must_use]
    pub fn log(&self) -> String {
        read_log(&self.files.path().join(LOG))
    }
}

impl Drop for Chromedriver {
    fn drop(&mut self) {
        // The only possible failure is an empty group, which is the desired result.
        let _ = kill_process_group(self.group, Signal::KILL);
        let _ = self.process.try_wait();
    }
}

/// Path of Chromium or Chrome.
///
/// # Errors
/// When none is on the `PATH`; the message says what to install.
pub fn chromium() -> Result<PathBuf> {
    on_path(&["chromium", "chromium-browser", "google-chrome", "chrome"]).context(INSTALL)
}

const LOG: &str = "log";

/// Unit of processor times in `/proc` on Linux.
const TICKS_PER_SEC: f64 = 100.0;

/// Processor time in user and kernel mode of a process, from its line in `/proc`; `None` if it belongs to another process group.
fn cpu_ticks(stat: &str, group: i32) -> Option<u64> {
    // The name, in parentheses, may have spaces: state, parent and group follow it, then eight more before the times.
    let fields: Vec<&str> = stat.rsplit_once(')')?.1.split_whitespace().collect();
    let is_ours = fields.get(2)?.parse() == Ok(group);
    let ticks = |at: usize| fields.get(at)?.parse::<u64>().ok();
    Some(ticks(11)? + ticks(12)?).filter(|_| is_ours)
}

fn on_path(names: &[&str]) -> Option<PathBuf> {
    let path = env::var_os("PATH")?;
    let dirs: Vec<PathBuf> = env::split_paths(&path).collect();
    names.iter().flat_map(|name| dirs.iter().map(move |dir| dir.join(name))).find(|program| program.is_file())
}

async fn port_from(process: &mut Child, log: &Path) -> Result<u16> {
    let deadline = Instant::now() + START_LIMIT;
    while Instant::now() < deadline {
        let printed = read_log(log);
        if let Some((_, rest)) = printed.split_once("started successfully on port ")
            && let Some((port, _)) = rest.split_once('.')
        {
            return port.parse().with_context(|| format!("chromedriver named the port {port:?}"));
        }
        if let Some(status) = process.try_wait()? {
            bail!("chromedriver ended with {status}:\n{printed}");
        }
        sleep(Duration::from_millis(20)).await;
    }
    bail!("chromedriver named no port within {START_LIMIT:?}:\n{}", read_log(log))
}

fn read_log(log: &Path) -> String {
    fs::read(log).map(|bytes| String::from_utf8_lossy(&bytes).into_owned()).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn processor_time_is_that_of_a_group() {
        let stat = "4711 (Web (GPU) 1) S 4700 4690 4690 0 -1 4194560 1 2 3 4 150 25 7 8 20 0 12 0 99";
        assert_eq!(cpu_ticks(stat, 4690), Some(175));
        assert_eq!(cpu_ticks(stat, 4700), None);
        assert_eq!(cpu_ticks("4711 (cut", 4690), None);
    }
}
