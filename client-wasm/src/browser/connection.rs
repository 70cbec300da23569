//! The connection to the server: reconnects when it breaks, and limits the rate of messages.

use super::socket::{Socket, SocketEvent};
use glam::Vec3;
use prairie_core::grid::PatchIndex;
use prairie_core::scene::VehicleKind;
use prairie_core::wire::{self, ClientMessage, Close, Drive, PROOF_BYTES};

/// Minimum interval between two view messages (s).
const VIEW_SECS: f64 = 0.125;
/// Movement (m) that triggers a new view message.
const VIEW_STEP_M: f32 = 0.5;
/// Minimum interval between two drive messages (s).
const DRIVE_SECS: f64 = 1.0 / 30.0;
/// Interval between two pings (s).
const PING_SECS: f64 = 2.0;
/// Back-pressure limit (bytes): with more bytes buffered, messages that a later one replaces are not sent.
const BACK_PRESSURE_BYTES: u32 = 512;
/// Reconnection delay (s): initial and maximum. It doubles with each attempt.
const RETRY_SECS: [f64; 2] = [0.5, 8.0];
/// Averaging period of the receive rate (s).
const RATE_SECS: f64 = 1.0;

/// State of the connection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum ConnectionState {
    /// Connecting for the first time, or reconnecting.
    Connecting {
        /// Failed attempts since the last welcome.
        attempts: u32,
        /// Reason that the server gave for ending the last one, if any.
        reason: Option<Close>,
    },
    /// The server has accepted the client.
    Connected {
        /// Number of this client.
        client: u32,
    },
    /// Closed for a reason that reconnecting cannot solve.
    Closed(Close),
}

/// The page's connection.
pub(super) struct Connection {
    url: String,
    name: String,
    handle: fn(SocketEvent),
    socket: Option<Socket>,
    state: ConnectionState,
    /// Number of this client and its proof, for the next connection.
    proof: Option<(u32, [u8; PROOF_BYTES])>,
    /// Whether the server has kept the number, and with it the vehicle, from the connection before.
    is_back: bool,
    retry_at_secs: f64,
    last_view: Option<(Vec3, f32)>,
    view_at_secs: f64,
    last_drive: Drive,
    drive_at_secs: f64,
    ping: Option<(u32, f64)>,
    ping_at_secs: f64,
    latency_secs: Option<f64>,
    received_bytes: u64,
    rate: Rate,
}

#[derive(Clone, Copy, Debug, Default)]
struct Rate {
    since_secs: f64,
    since_bytes: u64,
    bytes_per_s: f64,
}

impl Connection {
    /// A connection that the first [`tick`](Self::tick) opens. `handle` receives the socket's events and must pass them on to
    /// [`opened`](Self::opened), [`received`](Self::received) and [`closed`](Self::closed).
    pub(super) fn new(url: String, name: String, handle: fn(SocketEvent)) -> Self {
        Self {
            url,
            name,
            handle,
            socket: None,
            state: ConnectionState::Connecting { attempts: 0, reason: None },
            proof: None,
            is_back: false,
            retry_at_secs: 0.0,
            last_view: None,
            view_at_secs: 0.0,
            last_drive: Drive::default(),
            drive_at_secs: 0.0,
            ping: None,
            ping_at_secs: 0.0,
            latency_secs: None,
            received_bytes: 0,
            rate: Rate::default(),
        }
    }

    pub(super) fn state(&self) -> ConnectionState {
        self.state
    }

    /// Number of this client, while connected.
    pub(super) fn client(&self) -> Option<u32> {
        match self.state {
            ConnectionState::Connected { client } => Some(client),
            _ => None,
        }
    }

    /// Whether the server has kept the number, and with it the vehicle, from the connection before.
    pub(super) fn is_back(&self) -> bool {
        self.is_back
    }

    /// Round-trip time of the last ping (s).
    pub(super) fn latency_secs(&self) -> Option<f64> {
        self.latency_secs
    }

    /// Receive rate (bytes/s), over about a second.
    pub(super) fn bytes_per_s(&self) -> f64 {
        self.rate.bytes_per_s
    }

    /// Bytes received since the page was opened.
    pub(super) fn received_bytes(&self) -> u64 {
        self.received_bytes
    }

    /// Opens the socket when a retry is due, sends pings, and measures the receive rate.
    pub(super) fn tick(&mut self, now_secs: f64) {
        if self.socket.is_none() && now_secs >= self.retry_at_secs && !matches!(self.state, ConnectionState::Closed(_)) {
            self.socket = Socket::open(&self.url, self.handle).ok();
            self.retry_at_secs = now_secs + RETRY_SECS[1];
        }
        if self.is_ready() && now_secs >= self.ping_at_secs {
            let nonce = self.ping.map_or(1, |(nonce, _)| nonce.wrapping_add(1));
            self.ping = Some((nonce, now_secs));
            self.ping_at_secs = now_secs + PING_SECS;
            self.send(&ClientMessage::Ping { nonce });
        }
        let elapsed_secs = now_secs - self.rate.since_secs;
        if elapsed_secs >= RATE_SECS {
            let bytes_per_s = (self.received_bytes - self.rate.since_bytes) as f64 / elapsed_secs;
            self.rate = Rate { since_secs: now_secs, since_bytes: self.received_bytes, bytes_per_s };
        }
    }

    /// Handles an opened socket: sends the hello, with the proof of the connection before.
    pub(super) fn opened(&self) {
        let name = self.name.clone();
        self.send(&match self.proof {
            Some((client, proof)) => ClientMessage::Return { name, client, proof },
            None => ClientMessage::Hello { name },
        });
    }

    /// Counts the bytes of a received message.
    pub(super) fn received(&mut self, bytes: usize) {
        self.received_bytes += bytes as u64;
    }

    /// Handles the server's welcome.
    pub(super) fn welcomed(&mut self, client: u32, proof: [u8; PROOF_BYTES]) {
        self.is_back = self.proof.is_some_and(|(before, _)| before == client);
        self.proof = Some((client, proof));
        self.state = ConnectionState::Connected { client };
        self.last_view = None;
        self.view_at_secs = f64::NEG_INFINITY;
        self.last_drive = Drive::default();
        self.ping_at_secs = 0.0;
    }

    /// Handles a closed socket: schedules a reconnection, or gives up if the close code rules that out.
    pub(super) fn closed(&mut self, code: u16, now_secs: f64) {
        let attempts = match self.state {
            ConnectionState::Connecting { attempts, .. } => attempts + 1,
            _ => 1,
        };
        self.state = match Close::from_code(code) {
            Some(close @ (Close::Version | Close::BadMessage)) => ConnectionState::Closed(close),
            reason => ConnectionState::Connecting { attempts, reason },
        };
        let [first_secs, longest_secs] = RETRY_SECS;
        let wait_secs = match Close::from_code(code) {
            Some(Close::RateLimit) => longest_secs,
            _ => (first_secs * f64::from(1 << (attempts - 1).min(8))).min(longest_secs),
        };
        // Jitter spreads the reconnections of many clients of one server.
        self.retry_at_secs = now_secs + wait_secs * (0.75 + 0.5 * js_sys::Math::random());
        self.socket = None;
        self.latency_secs = None;
    }

    /// Closes permanently.
    pub(super) fn end(&mut self, close: Close) {
        self.state = ConnectionState::Closed(close);
        self.socket = None;
    }

    /// Changes the user's name. A disconnected server receives it with the next hello.
    pub(super) fn rename(&mut self, name: String) {
        if self.name != name {
            self.name.clone_from(&name);
            self.send(&ClientMessage::Rename { name });
        }
    }

    pub(super) fn acknowledge(&self, frame: u32) {
        self.send(&ClientMessage::Ack { frame });
    }

    pub(super) fn choose(&mut self, vehicle: Option<VehicleKind>) {
        self.last_drive = Drive::default();
        self.send(&ClientMessage::Choose { vehicle });
    }

    /// Handles the response to a ping.
    pub(super) fn ponged(&mut self, nonce: u32, now_secs: f64) {
        if let Some((sent, at_secs)) = self.ping
            && sent == nonce
        {
            self.latency_secs = Some(now_secs - at_secs);
        }
    }

    /// Sends the camera position if it has moved, at a limited rate.
    pub(super) fn send_view(&mut self, eye_m: Vec3, radius_m: f32, now_secs: f64) {
        let moved = self.last_view.is_none_or(|(eye, radius)| eye.distance(eye_m) > VIEW_STEP_M || radius != radius_m);
        if self.is_ready() && moved && now_secs - self.view_at_secs >= VIEW_SECS {
            self.last_view = Some((eye_m, radius_m));
            self.view_at_secs = now_secs;
            self.send(&ClientMessage::View { eye_m: eye_m.into(), radius_m });
        }
    }

    /// Asks for a replica of the grass, or for patches.
    pub(super) fn replicate(&self, wanted: bool) {
        self.send(&ClientMessage::Replicate { wanted });
    }

    /// Reports that the replica differs from the server's grass.
    pub(super) fn report_difference(&self, tick: u64, patch: PatchIndex) {
        self.send(&ClientMessage::Differs { tick, patch });
    }

    /// Whether an input differs from the one sent last.
    pub(super) fn is_new_drive(&self, drive: Drive) -> bool {
        drive != self.last_drive
    }

    /// Whether an input may be sent now, at a limited rate.
    pub(super) fn may_drive(&self, now_secs: f64) -> bool {
        self.is_ready() && now_secs - self.drive_at_secs >= DRIVE_SECS
    }

    /// Sends an input with its number.
    pub(super) fn drive(&mut self, number: u32, drive: Drive, now_secs: f64) {
        (self.last_drive, self.drive_at_secs) = (drive, now_secs);
        self.send(&ClientMessage::Drive { number, drive });
    }

    /// Whether the client is connected and the socket is below the back-pressure limit.
    fn is_ready(&self) -> bool {
        self.client().is_some() && self.socket.as_ref().is_some_and(|socket| socket.buffered_bytes() < BACK_PRESSURE_BYTES)
    }

    fn send(&self, message: &ClientMessage) {
        if let Some(socket) = &self.socket {
            socket.send(&wire::encode(message));
        }
    }
}
