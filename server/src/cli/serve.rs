//! `prairie serve`: simulates a scene and serves it to browsers.

use clap::Args;
use prairie::inspect::Target;
use prairie::net::{Tls, TlsChoice, bind};
use prairie::{Config, Limits, scenes};
use std::net::{IpAddr, SocketAddr};

pub(crate) const EXAMPLES: &str = "\
Examples:
  prairie serve                              the scene `meadow` on http://127.0.0.1:8080
  prairie serve --addr 127.0.0.1:0           on any free port, which is printed
  prairie serve --addr 0.0.0.0:8443 --tls self
                                             on all addresses of this machine
  prairie serve --tls cert.pem,key.pem       with your own certificate
  prairie serve --rerun save=run.rrd         records the run for the rerun viewer

Browsers enable WebGPU only on pages from this machine or over https, so other machines need --tls.
With `--tls self` the browser shows a warning: compare the fingerprint with the one printed here.
A scene file is reloaded when you save it or a file that it names; all pages reconnect.
The log goes to stderr; RUST_LOG=prairie=debug makes it more detailed.";

/// Arguments of `prairie serve`.
#[derive(Debug, Args)]
pub(crate) struct Serve {
    /// Scene to serve: a built-in scene (`prairie scenes` lists them) or a scene file
    #[arg(long, env = "PRAIRIE_SCENE", value_name = "NAME|FILE", default_value = "meadow")]
    scene: String,
    /// Address to listen on; port 0 picks a free port
    #[arg(long, env = "PRAIRIE_ADDR", value_name = "HOST:PORT", default_value = "127.0.0.1:8080")]
    addr: String,
    /// Open the page in the browser
    #[arg(long, env = "PRAIRIE_OPEN")]
    open: bool,
    /// Serve https, with a generated self-signed certificate (`self`) or with two PEM files
    #[arg(long, env = "PRAIRIE_TLS", value_name = "self|CERT,KEY")]
    tls: Option<TlsChoice>,
    /// Record the run for the rerun viewer: serve it to viewers, save it to a file, or send it to a running viewer
    #[arg(long, env = "PRAIRIE_RERUN", value_name = "serve|save=FILE.rrd|connect=URL")]
    rerun: Option<Target>,
    /// Threads of the simulation [default: one per core]
    #[arg(long, env = "PRAIRIE_THREADS", value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Frames per second sent to clients, 1 to 60
    #[arg(long, env = "PRAIRIE_PUBLISH_HZ", value_name = "HZ", default_value_t = 20, value_parser = clap::value_parser!(u16).range(1..=60))]
    publish_hz: u16,
    /// Data rate limit per client (kbit/s), 64 to 1000000; grass near the camera is sent first
    #[arg(long, env = "PRAIRIE_CLIENT_KBIT", value_name = "KBIT", default_value_t = 2000, value_parser = clap::value_parser!(u32).range(64..=1_000_000))]
    client_kbit: u32,
    /// Most clients at once, 1 to 4096
    #[arg(long, env = "PRAIRIE_MAX_CLIENTS", value_name = "N", default_value_t = 64, value_parser = clap::value_parser!(u16).range(1..=4096))]
    max_clients: u16,
}

pub(crate) fn serve(arguments: Serve) -> anyhow::Result<()> {
    anyhow::ensure!(
        arguments.rerun.is_none() || cfg!(feature = "rerun"),
        "--rerun: this binary was built without the recording for rerun; build it with `--features rerun`"
    );
    let scene = scenes::load(&arguments.scene)?;
    tokio::runtime::Builder::new_multi_thread().enable_all().build()?.block_on(async {
        let listener = bind(&arguments.addr).await?;
        let address = listener.local_addr()?;
        let tls = arguments.tls.as_ref().map(|choice| Tls::new(choice, address)).transpose()?;
        let mut limits = Limits { clients: usize::from(arguments.max_clients), ..Limits::default() };
        limits.send.bytes_per_s = f64::from(arguments.client_kbit) * 1000.0 / 8.0;
        let config = Config {
            tls: tls.clone(),
            rerun: arguments.rerun,
            threads: arguments.threads.map(usize::from),
            publish_hz: f32::from(arguments.publish_hz),
            limits,
            ..Config::new(scene)
        };
        let shutdown = async {
            announce(address, tls.as_ref(), arguments.open);
            stop_signal().await;
        };
        Ok(prairie::run_and_reload(config, listener, shutdown).await?)
    })
}

/// Prints the address of the page and the certificate's fingerprint, and opens the browser on request.
fn announce(address: SocketAddr, tls: Option<&Tls>, open: bool) {
    let scheme = if tls.is_some() { "https" } else { "http" };
    let local = match address.ip() {
        ip if !ip.is_unspecified() => address,
        IpAddr::V4(_) => SocketAddr::new(IpAddr::from([127, 0, 0, 1]), address.port()),
        IpAddr::V6(_) => SocketAddr::new(IpAddr::from([0, 0, 0, 0, 0, 0, 0, 1]), address.port()),
    };
    let page = format!("{scheme}://{local}");
    println!("Prairie is at {page}");
    if let Some(ip) = prairie::net::reachable_ip(address).filter(|ip| !ip.is_loopback()) {
        println!("  from other machines: {scheme}://{}", SocketAddr::new(ip, address.port()));
        if tls.is_none() {
            tracing::warn!("browsers enable WebGPU only over https or on this machine; for other machines add --tls self");
        }
    }
    if let Some(tls) = tls {
        println!("  certificate SHA-256: {}", tls.fingerprint());
    }
    if open && let Err(error) = open::that_detached(&page) {
        tracing::warn!(%error, "cannot open a browser");
    }
}

/// Completes on Ctrl-C or SIGTERM.
async fn stop_signal() {
    let interrupt = tokio::signal::ctrl_c();
    #[cfg(unix)]
    {
        let mut terminate =
            tokio::signal::unix::signal(tokio::signal::unix::SignalKind::terminate()).expect("a SIGTERM handler can be installed");
        tokio::select! {
            _ = interrupt => {}
            _ = terminate.recv() => {}
        }
    }
    #[cfg(not(unix))]
    let _ = interrupt.await;
}
