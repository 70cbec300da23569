//! `prairie serve`: simulates a scene and serves it to browsers.

use super::announce::announce;
use super::log::LogFormat;
use super::number::whole;
use super::stop_signal::{StopSignal, survive_full_files};
use super::tls::TlsArguments;
use super::world::WorldArguments;
use anyhow::Context as _;
use clap::{Args, ValueEnum, ValueHint};
use prairie::inspect::{EntityRate, Target};
use prairie::net::bind;
use prairie::scenes::SceneError;
use prairie::{Config, Limits, scenes};
use std::ffi::{OsStr, OsString};
use std::net::SocketAddr;

pub(super) const EXAMPLES: &str = "\
Examples:
  prairie serve                              the scene `meadow` on http://127.0.0.1:8080
  prairie serve my/hills.toml                a scene of your own
  prairie serve --addr 127.0.0.1:0           on any free port, which is printed
  prairie serve --addr 0.0.0.0:8443 --tls self
                                             on all addresses of this machine
  prairie serve --tls cert.pem,key.pem       with your own certificate
  prairie serve --allow-origin https://play.example
                                             behind a proxy that serves https://play.example
  prairie serve --rerun save=run.rrd         records the run for the rerun viewer
  prairie serve --world none                 a world that is forgotten when the server stops

Browsers enable WebGPU only on pages from this machine or over https, so other machines need --tls.
With `--tls self` the browser shows a warning: compare the fingerprint with the one printed here.
A scene file is reloaded when you save it or a file that it names; all pages reconnect.
The page has a menu of the built-in scenes (key O), which changes the scene for everyone where --change-scene allows it.
The world is kept: after a stop or a crash it goes on where it was. `prairie replay` plays what was.
The log goes to stderr; RUST_LOG=prairie=debug makes it more detailed.";

/// Scene served if none is given.
const DEFAULT_SCENE: &str = "meadow";

/// Arguments of `prairie serve`.
#[derive(Debug, Args)]
pub(super) struct Serve {
    /// Scene to serve: a built-in scene (`prairie scenes` lists them) or a scene file [default: meadow]
    #[arg(value_name = "SCENE", value_hint = ValueHint::FilePath)]
    scene: Option<OsString>,
    /// The scene as an option, instead of SCENE
    #[arg(id = "scene_flag", long = "scene", env = "PRAIRIE_SCENE", value_name = "NAME|FILE", value_hint = ValueHint::FilePath)]
    scene_flag: Option<OsString>,
    /// Address to listen on; port 0 picks a free port
    #[arg(long, env = "PRAIRIE_ADDR", value_name = "HOST:PORT", default_value = "127.0.0.1:8080", value_parser = address)]
    addr: String,
    /// Open the page in the browser
    #[arg(long, env = "PRAIRIE_OPEN", value_parser = yes_or_no)]
    open: bool,
    #[command(flatten)]
    pub(super) tls: TlsArguments,
    /// Record the run for the rerun viewer: serve it to viewers, save it to a file, or send it to a running viewer
    #[arg(long, env = "PRAIRIE_RERUN", value_name = "serve|save=FILE.rrd|connect=URL")]
    rerun: Option<Target>,
    /// Largest rate of an entity of the recording (1/s of simulated time), 0 to 60, where 0 turns it off; may be repeated. The README lists the entities
    #[arg(long, value_name = "PATH=HZ", requires = "rerun")]
    rerun_rate: Vec<EntityRate>,
    /// Threads of the simulation, 1 to 1024 [default: one per core]
    #[arg(long, env = "PRAIRIE_THREADS", value_name = "N", value_parser = whole(1_u16..=1024))]
    threads: Option<u16>,
    /// Frames per second sent to clients, 1 to 60
    #[arg(long, env = "PRAIRIE_PUBLISH_HZ", value_name = "HZ", default_value_t = 20, value_parser = whole(1_u16..=60))]
    publish_hz: u16,
    /// What a world does in which only the wind moves, once nobody has been there for 10 s: stand still and use no processor time, or go on
    #[arg(long, env = "PRAIRIE_WHEN_EMPTY", value_enum, value_name = "ACT", default_value_t)]
    when_empty: WhenEmpty,
    /// Data rate limit per client (kbit/s), 64 to 1000000; grass near the camera is sent first
    #[arg(long, env = "PRAIRIE_CLIENT_KBIT", value_name = "KBIT", default_value_t = 2000, value_parser = whole(64_u32..=1_000_000))]
    client_kbit: u32,
    /// Maximum number of clients, 1 to 4096
    #[arg(long, env = "PRAIRIE_MAX_CLIENTS", value_name = "N", default_value_t = 64, value_parser = whole(1_u16..=4096))]
    max_clients: u16,
    /// Maximum number of clients with the same IP address (IPv6: the same /64), 1 to 4096
    #[arg(long, env = "PRAIRIE_MAX_PER_ADDRESS", value_name = "N", default_value_t = 32, value_parser = whole(1_u16..=4096))]
    max_per_address: u16,
    #[command(flatten)]
    world: WorldArguments,
    /// Who may change to another built-in scene on the page, for all: everyone, or nobody [default: everyone if only this machine can connect]
    #[arg(long, env = "PRAIRIE_CHANGE_SCENE", value_enum, value_name = "WHO")]
    change_scene: Option<Changers>,
    /// Format of the log on stderr: lines of text, or a JSON object on each line
    #[arg(long, env = "PRAIRIE_LOG_FORMAT", value_enum, value_name = "FORMAT", default_value_t)]
    pub(super) log_format: LogFormat,
    /// Log the errors of the pages, such as a panic of the client or a browser without WebGPU; at most 20 at once and one in 5 s
    #[arg(long, env = "PRAIRIE_REPORT", value_parser = yes_or_no)]
    report: bool,
    /// Environment variables from which options have their values.
    #[arg(skip)]
    pub(super) variables: Vec<String>,
}

/// What an empty world does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
enum WhenEmpty {
    /// It pauses until somebody comes.
    #[default]
    Pause,
    /// It runs.
    Run,
}

/// Who may change the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Changers {
    /// Everyone who has the page.
    Everyone,
    /// Nobody: the page shows the scenes and their commands.
    Nobody,
}

impl Serve {
    /// Whether pages may change the scene: by default where all of them are on this machine. Allowed origins and hosts are those of a proxy, whose visitors
    /// are elsewhere.
    fn pages_change_scene(&self, address: SocketAddr) -> bool {
        let is_private = address.ip().is_loopback() && self.tls.allow_origin.is_empty() && self.tls.allow_host.is_empty();
        self.change_scene.map_or(is_private, |who| who == Changers::Everyone)
    }

    /// Whether the scene is given as a word.
    pub(super) fn has_word(&self) -> bool {
        self.scene.is_some()
    }

    /// Whether an option has its value from its environment variable.
    fn is_from(&self, variable: &str) -> bool {
        self.variables.iter().any(|used| used == variable)
    }

    /// The scene: the word or `--scene`, which `usage` does not allow together, else `PRAIRIE_SCENE`, else the default.
    fn scene(&self) -> &OsStr {
        self.scene.as_deref().or(self.scene_flag.as_deref()).unwrap_or(DEFAULT_SCENE.as_ref())
    }

    pub(super) fn run(self) -> anyhow::Result<()> {
        anyhow::ensure!(
            self.rerun.is_none() || cfg!(feature = "rerun"),
            "--rerun: this binary was built without the recording for rerun; build it with `--features rerun`"
        );
        let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().build()?;
        let outcome = runtime.block_on(self.run_until_stopped());
        // A scene that is still being loaded, or a world that is being built, is abandoned.
        runtime.shutdown_background();
        outcome
    }

    /// An error about the scene, with the environment variable if the scene comes from there.
    fn scene_error(&self, error: SceneError) -> anyhow::Error {
        let error = anyhow::Error::from(error);
        if !self.has_word() && self.is_from("PRAIRIE_SCENE") { error.context("PRAIRIE_SCENE") } else { error }
    }

    async fn run_until_stopped(self) -> anyhow::Result<()> {
        // Before anything that takes time: a signal then ends the program in order, not at once.
        let mut stop = StopSignal::install()?;
        survive_full_files();
        let scene = self.scene().to_owned();
        let loading = tokio::task::spawn_blocking(move || scenes::load(&scene));
        let scene = tokio::select! {
            loaded = loading => loaded?.map_err(|error| self.scene_error(error))?,
            () = stop.received() => return Ok(()),
        };
        let listener = bind(&self.addr).await.context(if self.is_from("PRAIRIE_ADDR") { "PRAIRIE_ADDR" } else { "--addr" })?;
        let address = listener.local_addr()?;
        let tls = self.tls.open(address)?;
        let mut limits =
            Limits { clients: usize::from(self.max_clients), clients_per_address: usize::from(self.max_per_address), ..Limits::default() };
        limits.send.bytes_per_s = f64::from(self.client_kbit) * 1000.0 / 8.0;
        let folder = self.world.folder();
        let arguments = self.world.clone();
        let building = tokio::task::spawn_blocking(move || arguments.open(&scene).map(|world| (scene, world)));
        let (scene, world) = tokio::select! {
            built = building => built??,
            () = stop.received() => return Ok(()),
        };
        let usual = Config::new(scene);
        let pages_change_scene = self.pages_change_scene(address);
        let config = Config {
            pause_after: usual.pause_after.filter(|_| self.when_empty == WhenEmpty::Pause),
            tls: tls.clone(),
            allow_origins: self.tls.allow_origin,
            allow_hosts: self.tls.allow_host,
            rerun: self.rerun,
            rerun_rates: self.rerun_rate,
            threads: self.threads.map(usize::from),
            publish_hz: f32::from(self.publish_hz),
            logs_page_errors: self.report,
            pages_change_scene,
            world: folder,
            limits,
            ..usual
        };
        let shutdown = async {
            announce(address, tls.as_ref(), self.open);
            stop.received().await;
        };
        Ok(prairie::run_and_reload(world, config, listener, shutdown).await?)
    }
}

/// Parser of an address to listen on. Whether its host exists and belongs to this machine is known only when the server listens.
pub(super) fn address(text: &str) -> Result<String, String> {
    match text.rsplit_once(':') {
        Some((host, port)) if !host.is_empty() && port.parse::<u16>().is_ok() => Ok(text.to_owned()),
        _ => Err("expected HOST:PORT, such as 127.0.0.1:8080 or 0.0.0.0:8080, with a port from 0 to 65535".to_owned()),
    }
}

/// Parser of a switch in an environment variable.
fn yes_or_no(text: &str) -> Result<bool, String> {
    match text.to_ascii_lowercase().as_str() {
        "true" | "yes" | "on" | "1" => Ok(true),
        "false" | "no" | "off" | "0" => Ok(false),
        _ => Err("allowed: true, yes, on or 1, and false, no, off or 0".to_owned()),
    }
}
