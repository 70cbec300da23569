//! What a run of the server can be told.

use crate::net::Tls;
use crate::scenes::LoadedScene;
use crate::stream::SendLimits;
use std::path::PathBuf;
use std::str::FromStr;
use std::time::Duration;

/// Everything that a run needs but the socket it listens on.
#[derive(Debug)]
pub struct Config {
    /// The scene with its maps.
    pub scene: LoadedScene,
    /// Certificate and key for https; none: plain http.
    pub tls: Option<Tls>,
    /// Where the fields are logged for the rerun viewer.
    pub rerun: Option<RerunSink>,
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
    /// Time that a client may take to read or acknowledge a frame. Default 15 s.
    pub stall: Duration,
    /// Messages per second that a client may send for long; twice as many may come at once. Default 200.
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
            stall: Duration::from_secs(15),
            messages_per_sec: 200.0,
            send: SendLimits::default(),
        }
    }
}

/// Where the fields are logged for the rerun viewer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RerunSink {
    /// Serve to viewers that connect.
    Serve,
    /// Write a recording.
    Save(PathBuf),
    /// Connect to a viewer at this URL.
    Connect(String),
}

impl FromStr for RerunSink {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.split_once('=') {
            None if text == "serve" => Ok(Self::Serve),
            Some(("save", file)) if !file.is_empty() => Ok(Self::Save(file.into())),
            Some(("connect", url)) if !url.is_empty() => Ok(Self::Connect(url.to_owned())),
            _ => Err("expected `serve`, `save=FILE.rrd` or `connect=URL`".to_owned()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rerun_sinks_are_read() {
        assert_eq!("serve".parse(), Ok(RerunSink::Serve));
        assert_eq!("save=a=b.rrd".parse(), Ok(RerunSink::Save("a=b.rrd".into())));
        assert_eq!("connect=rerun+http://127.0.0.1:9876/proxy".parse(), Ok(RerunSink::Connect("rerun+http://127.0.0.1:9876/proxy".into())));
        for wrong in ["", "serve=", "save", "save=", "connect=", "view"] {
            assert!(wrong.parse::<RerunSink>().is_err(), "{wrong}");
        }
    }
}
