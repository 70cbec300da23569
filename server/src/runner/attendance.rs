//! Attendance: whether anybody has lately needed the world to run.

use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Times at which somebody last needed the world to run: a client, a recording, or a request for the fields.
#[derive(Debug)]
pub struct Attendance {
    newest: Mutex<Instant>,
    /// The newest request for the bend of any place.
    bend_asked: Mutex<Option<Instant>>,
}

/// Time after a request for the bend in which all patches are published, for the next requests.
const BEND_KEPT: Duration = Duration::from_secs(10);

impl Default for Attendance {
    /// Somebody is there now.
    fn default() -> Self {
        Self { newest: Mutex::new(Instant::now()), bend_asked: Mutex::default() }
    }
}

impl Attendance {
    /// Notes that somebody is there now.
    pub fn note(&self) {
        *self.newest.lock().unwrap_or_else(PoisonError::into_inner) = Instant::now();
    }

    /// Notes a request for the bend of any place.
    pub fn ask_for_bend(&self) {
        self.note();
        *self.bend_asked.lock().unwrap_or_else(PoisonError::into_inner) = Some(Instant::now());
    }

    /// Whether the bend of any place was asked for in the last 10 s.
    pub fn wants_bend(&self) -> bool {
        self.bend_asked.lock().unwrap_or_else(PoisonError::into_inner).is_some_and(|at| at.elapsed() < BEND_KEPT)
    }

    /// Time since somebody was there.
    pub fn absent_for(&self) -> Duration {
        self.newest.lock().unwrap_or_else(PoisonError::into_inner).elapsed()
    }
}
