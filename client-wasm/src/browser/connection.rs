//! The connection to the server: opened again whenever it breaks, and never spoken to more often than needed.

use super::socket::{Socket, SocketEvent};
use glam::Vec3;
use shared::scene::VehicleKind;
use shared::wire::{self, ClientMessage, Close, Drive};

/// Shortest time between two views (s).
const VIEW_SECS: f64 = 0.125;
/// Distance (m) that makes a new view worth sending.
const VIEW_STEP_M: f32 = 0.5;
/// Shortest time between two drives (s).
const DRIVE_SECS: f64 = 1.0 / 30.0;
/// Time between two pings (s).
const PING_SECS: f64 = 2.0;
/// Bytes waiting to be sent from which on nothing is added that a later message makes up for: a line that stalls would let it all go at once.
const CLOGGED_BYTES: u32 = 512;
/// First and longest wait before the socket is opened again (s).
const RETRY_SECS: [f64; 2] = [0.5, 8.0];
/// Time over which the rate of arriving bytes is measured (s).
const RATE_SECS: f64 = 1.0;

/// How it stands with the server.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Standing {
    /// The socket is opening for the first time, or again; so many attempts have failed.
    Away {
        /// Attempts since the last welcome.
        attempts: u32,
        /// Why the last one ended, if the server said so.
        why: Option<Close>,
    },
    /// The server has answered the hello with this number.
    Here {
        /// The client's number.
        client: u32,
    },
    /// The server closed the connection in a way that trying again will not mend.
    Over(Close),
}

/// The one connection of a page.
pub(super) struct Connection {
    url: String,
    name: String,
    hear: fn(SocketEvent),
    socket: Option<Socket>,
    standing: Standing,
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
    /// A connection to be opened by the first [`tick`](Self::tick); `hear` gets the socket's events and hands them back to
    /// [`opened`](Self::opened), [`received`](Self::received) and [`closed`](Self::closed).
    pub(super) fn new(url: String, name: String, hear: fn(SocketEvent)) -> Self {
        Self {
            url,
            name,
            hear,
            socket: None,
            standing: Standing::Away { attempts: 0, why: None },
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

    pub(super) fn standing(&self) -> Standing {
        self.standing
    }

    /// The client's own number, while the server is there.
    pub(super) fn client(&self) -> Option<u32> {
        match self.standing {
            Standing::Here { client } => Some(client),
            _ => None,
        }
    }

    /// Time from a ping to its pong (s).
    pub(super) fn latency_secs(&self) -> Option<f64> {
        self.latency_secs
    }

    /// Bytes that arrive per second, over the last second or so.
    pub(super) fn bytes_per_s(&self) -> f64 {
        self.rate.bytes_per_s
    }

    /// Bytes that have arrived since the page was opened.
    pub(super) fn received_bytes(&self) -> u64 {
        self.received_bytes
    }

    /// Opens the socket when it is time to, pings, and measures.
    pub(super) fn tick(&mut self, now_secs: f64) {
        if self.socket.is_none() && now_secs >= self.retry_at_secs && !matches!(self.standing, Standing::Over(_)) {
            self.socket = Socket::open(&self.url, self.hear).ok();
            self.retry_at_secs = now_secs + RETRY_SECS[1];
        }
        if self.is_open() && now_secs >= self.ping_at_secs {
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

    /// The socket is open: says hello.
    pub(super) fn opened(&self) {
        self.send(&ClientMessage::Hello { name: self.name.clone() });
    }

    /// Counts a message's bytes.
    pub(super) fn received(&mut self, bytes: usize) {
        self.received_bytes += bytes as u64;
    }

    /// The server has taken the client in.
    pub(super) fn welcomed(&mut self, client: u32) {
        self.standing = Standing::Here { client };
        self.last_view = None;
        self.view_at_secs = f64::NEG_INFINITY;
        self.last_drive = Drive::default();
        self.ping_at_secs = 0.0;
    }

    /// The socket is closed: waits before the next attempt, or gives up where the code says that it is no use.
    pub(super) fn closed(&mut self, code: u16, now_secs: f64) {
        let attempts = match self.standing {
            Standing::Away { attempts, .. } => attempts + 1,
            _ => 1,
        };
        self.standing = match Close::from_code(code) {
            Some(close @ (Close::Version | Close::BadMessage)) => Standing::Over(close),
            why => Standing::Away { attempts, why },
        };
        let [first_secs, longest_secs] = RETRY_SECS;
        let wait_secs = match Close::from_code(code) {
            Some(Close::RateLimit) => longest_secs,
            _ => (first_secs * f64::from(1 << (attempts - 1).min(8))).min(longest_secs),
        };
        // Pages that lost the same server come back one after the other.
        self.retry_at_secs = now_secs + wait_secs * (0.75 + 0.5 * js_sys::Math::random());
        self.socket = None;
        self.latency_secs = None;
    }

    /// Closes for good.
    pub(super) fn end(&mut self, close: Close) {
        self.standing = Standing::Over(close);
        self.socket = None;
    }

    /// Takes another name; a server that is away learns it by the next hello.
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

    /// Takes the answer to the newest ping.
    pub(super) fn ponged(&mut self, nonce: u32, now_secs: f64) {
        if let Some((asked, at_secs)) = self.ping
            && asked == nonce
        {
            self.latency_secs = Some(now_secs - at_secs);
        }
    }

    /// Tells where the camera is, when it has moved and not too often.
    pub(super) fn look_from(&mut self, eye_m: Vec3, radius_m: f32, now_secs: f64) {
        let moved = self.last_view.is_none_or(|(eye, radius)| eye.distance(eye_m) > VIEW_STEP_M || radius != radius_m);
        if self.is_open() && moved && now_secs - self.view_at_secs >= VIEW_SECS {
            self.last_view = Some((eye_m, radius_m));
            self.view_at_secs = now_secs;
            self.send(&ClientMessage::View { eye_m: eye_m.into(), radius_m });
        }
    }

    /// Tells what the hands do, when it has changed and not too often.
    pub(super) fn drive(&mut self, drive: Drive, now_secs: f64) {
        if self.is_open() && drive != self.last_drive && now_secs - self.drive_at_secs >= DRIVE_SECS {
            self.last_drive = drive;
            self.drive_at_secs = now_secs;
            self.send(&ClientMessage::Drive(drive));
        }
    }

    /// Whether the server is there and the line takes more.
    fn is_open(&self) -> bool {
        self.client().is_some() && self.socket.as_ref().is_some_and(|socket| socket.waiting_bytes() < CLOGGED_BYTES)
    }

    fn send(&self, message: &ClientMessage) {
        if let Some(socket) = &self.socket {
            socket.send(&wire::encode(message));
        }
    }
}
