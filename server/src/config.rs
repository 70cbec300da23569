//! Configuration of a run.

use crate::inspect::{EntityRate, Target};
use crate::journal::WorldFolder;
use crate::net::{HostName, Origin, Tls};
use crate::scenes::LoadedScene;
use crate::stream::SendLimits;
use std::time::Duration;

/// Configuration of a run: everything except the listening socket.
#[derive(Clone, Debug)]
pub struct Config {
    /// The scene with its maps.
    pub scene: LoadedScene,
    /// Certificate and key for https; `None` for plain http.
    pub tls: Option<Tls>,
    /// Origins of pages that may open the WebSocket, besides those of this server; their hosts are allowed, too. Default none.
    pub allow_origins: Vec<Origin>,
    /// Host names that requests may name, besides those of this machine and its certificate. Default none.
    pub allow_hosts: Vec<HostName>,
    /// Destination of the recording for the rerun viewer; `None` for no recording.
    pub rerun: Option<Target>,
    /// Rates of the recording's entities that differ from the defaults. Default none.
    pub rerun_rates: Vec<EntityRate>,
    /// Threads of the simulation; `None` for one per core.
    pub threads: Option<usize>,
    /// Snapshots per second (Hz). Default 20.
    pub publish_hz: f32,
    /// Time without a client, a recording or a request for the fields after which a world pauses in which only the wind moves; `None` if it never pauses.
    /// Default 10 s.
    pub pause_after: Option<Duration>,
    /// Whether errors that pages report are logged; otherwise they are discarded. Default false.
    pub logs_page_errors: bool,
    /// Whether pages may change to another built-in scene, which starts its own world for everyone. Default false.
    pub pages_change_scene: bool,
    /// Where the world is kept between runs; `None` for a world without memory. Default none.
    pub world: Option<WorldFolder>,
    /// Limits on clients and their traffic.
    pub limits: Limits,
}

impl Config {
    /// The default configuration for `scene`.
    pub fn new(scene: LoadedScene) -> Self {
        Self {
            scene,
            tls: None,
            allow_origins: Vec::new(),
            allow_hosts: Vec::new(),
            rerun: None,
            rerun_rates: Vec::new(),
            threads: None,
            publish_hz: 20.0,
            pause_after: Some(Duration::from_secs(10)),
            logs_page_errors: false,
            pages_change_scene: false,
            world: None,
            limits: Limits::default(),
        }
    }
}

/// Limits on clients.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Largest number of clients at once. Default 64.
    pub clients: usize,
    /// Largest number of clients with the same address: an IPv4 address, or the /64 of an IPv6 address. Connections that are not clients may be eight times
    /// as many. Default 32: a class behind one router, and half of all places, so that no address can take them all.
    pub clients_per_address: usize,
    /// Largest number of connections that are not clients: page requests, handshakes, WebSockets before their hello. Default 512, so that one address
    /// with the default of clients cannot take all places.
    pub pending: usize,
    /// Time limit for each of TLS handshake, request headers and hello. Default 5 s.
    pub handshake_timeout: Duration,
    /// Time limit for a connection that does not become a client. A response that is under way is sent for up to 5 min more. Default 30 s.
    pub http_timeout: Duration,
    /// Time limit for a client that accepts no byte of a message, or, once `load_timeout` has passed, acknowledges no frame. Default 15 s.
    pub stall_timeout: Duration,
    /// Time from the last byte of the scene in which a client builds the scene and compiles its shaders, and may acknowledge no frame. Default 120 s: without
    /// a graphics card this takes 10 s, several times that on a busy machine.
    pub load_timeout: Duration,
    /// Sustained rate of a client's messages (1/s), including hello and WebSocket pings and pongs; bursts of twice this number are
    /// allowed. A client that sends more is closed. Default 200.
    pub messages_per_s: f64,
    /// Sustained rate of the bytes that a connection sends (bytes/s), TLS, HTTP and the headers of WebSocket frames included; bursts of four times this
    /// number are allowed. A connection that sends more is closed. Default 32 768, at least three times what `messages_per_s` messages of the page take.
    pub bytes_per_s: f64,
    /// Rate limit of view messages (1/s). Beyond it a newer one replaces the one that waits; likewise for choices and names. Default 30.
    pub views_per_s: f64,
    /// Rate limit of vehicle choices (1/s). Default 2.
    pub choices_per_s: f64,
    /// Rate limit of new names (1/s). Default 0.5.
    pub renames_per_s: f64,
    /// Pings that are answered (1/s). Default 5.
    pub pings_per_s: f64,
    /// Limits on the data sent to one client.
    pub send: SendLimits,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            clients: 64,
            clients_per_address: 32,
            pending: 512,
            handshake_timeout: Duration::from_secs(5),
            http_timeout: Duration::from_secs(30),
            stall_timeout: Duration::from_secs(15),
            load_timeout: Duration::from_secs(120),
            messages_per_s: 200.0,
            bytes_per_s: 32_768.0,
            views_per_s: 30.0,
            choices_per_s: 2.0,
            renames_per_s: 0.5,
            pings_per_s: 5.0,
            send: SendLimits::default(),
        }
    }
}
