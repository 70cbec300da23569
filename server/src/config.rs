//! What a run of the server can be told.

use crate::inspect::Target;
use crate::net::Tls;
use crate::scenes::LoadedScene;
use crate::stream::SendLimits;
use std::time::Duration;

/// Everything that a run needs but the socket it listens on.
#[derive(Clone, Debug)]
pub struct Config {
    /// The scene with its maps.
    pub scene: LoadedScene,
    /// Certificate and key for https; none: plain http.
    pub tls: Option<Tls>,
    /// Where the fields are logged for the rerun viewer.
    pub rerun: Option<Target>,
    /// Threads of the simulation; none: one for each core.
    pub threads: Option<usize>,
    /// Snapshots per second (Hz). Default 20.
    pub publish_hz: f32,
    /// Limits on clients and what they send and get.
    pub limits: Limits,
}

impl Config {
    /// A run of `scene` with every default.
    pub fn new(scene: LoadedScene) -> Self {
        Self { scene, tls: None, rerun: None, threads: None, publish_hz: 20.0, limits: Limits::default() }
    }
}

/// Limits on clients.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Most clients at once. Default 64.
    pub clients: usize,
    /// Most connections that are no clients yet: pages being fetched, handshakes, hellos to come. Default 256.
    pub connections: usize,
    /// Time for a TLS handshake, for the headers of a request and for the hello. Default 5 s.
    pub greeting: Duration,
    /// Time after which a connection is closed that has not become a client's: long enough to fetch the page over a slow line. Default 30 s.
    pub page: Duration,
    /// Time that a client may take to read or acknowledge a frame. Default 15 s.
    pub stall: Duration,
    /// Messages per second that a client may send for long, hello, pings and pongs of the WebSocket included; twice as many may come at
    /// once. Default 200.
    pub messages_per_sec: f64,
    /// What is sent to one client.
    pub send: SendLimits,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            clients: 64,
            connections: 256,
            greeting: Duration::from_secs(5),
            page: Duration::from_secs(30),
            stall: Duration::from_secs(15),
            messages_per_sec: 200.0,
            send: SendLimits::default(),
        }
    }
}
