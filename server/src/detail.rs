//! Detail of a running world, which follows its errors and its load: how often the wind is stepped, and how much of the grass is simulated.
//!
//! The runner's controller decides. Its decisions reach the world as [commands](crate::world::Command::Adapt), so that a replay repeats them.

use serde::{Deserialize, Serialize};
use std::collections::VecDeque;
use std::fmt;

/// Fewest patches to which the awake ones are limited.
pub(crate) const LEAST_AWAKE: u32 = 64;

/// Number of the newest decisions that are shown.
const SHOWN: usize = 16;

/// What gives way while a tick takes longer than its budget, in this order; each level keeps what those before it gave up.
pub const LOAD_LEVELS: [&str; 6] = [
    "nothing",
    "the wind is stepped half as often",
    "every other publication is left out",
    "half of the awake patches sleep, the farthest from all cameras",
    "the wind is stepped a quarter as often",
    "three quarters of the awake patches sleep",
];

/// Detail in which a world is simulated and published.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Detail {
    /// Ticks per step of the wind's solver.
    pub wind_ticks: u32,
    /// Most awake patches; the farthest from all cameras sleep.
    pub awake_limit: u32,
    /// Publications that are left out, as the number of which one remains.
    pub publish_divisor: u32,
}

/// What a world can be adapted to.
#[derive(Clone, Debug, PartialEq)]
pub struct DetailRange {
    /// Allowed ticks per step of the wind's solver, ascending.
    pub wind_ticks: Vec<u32>,
    /// Detail of the scene's own settings.
    pub own: Detail,
    /// Duration of a tick (s).
    pub tick_secs: f32,
    /// Whether every other publication may be left out.
    pub may_halve_publications: bool,
}

/// Reason for another detail.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Reason {
    /// Steps twice as long would have changed the wind by this little.
    Calm {
        /// Estimated error of steps twice as long (fraction of the scene's wind).
        error: f32,
        /// Allowed error.
        allowed: f32,
    },
    /// The steps have become too long for the wind.
    Stirred {
        /// Estimated error of the present steps (fraction of the scene's wind).
        error: f32,
        /// Allowed error.
        allowed: f32,
    },
    /// A tick takes longer than the budget.
    Overload {
        /// Mean time of a tick (ms).
        busy_ms: f32,
        /// Budget (ms).
        budget_ms: f32,
    },
    /// A tick takes much less than the budget, and has for some seconds.
    Relief {
        /// Mean time of a tick (ms).
        busy_ms: f32,
        /// Budget (ms).
        budget_ms: f32,
    },
}

/// A change of detail.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Decision {
    /// Number of steps before it.
    pub tick: u64,
    /// The new detail.
    pub detail: Detail,
    /// The detail if nothing gave way to the load. Its limit of awake patches is their number before the load limited them.
    pub unloaded: Detail,
    /// How much gives way to the load: a place in [`LOAD_LEVELS`].
    pub level: u8,
    /// Reason.
    pub reason: Reason,
}

impl Decision {
    /// What gives way to the load, in words.
    pub fn gives_way(&self) -> Vec<String> {
        let Self { detail, unloaded, .. } = self;
        let mut given_up = Vec::new();
        if detail.wind_ticks > unloaded.wind_ticks {
            given_up.push(format!("the wind is stepped every {} ticks instead of {}", detail.wind_ticks, unloaded.wind_ticks));
        }
        if detail.publish_divisor > unloaded.publish_divisor {
            given_up.push("every other publication is left out".to_owned());
        }
        if self.level > 0 && detail.awake_limit < unloaded.awake_limit.max(LEAST_AWAKE + 1) {
            given_up.push(format!("all but {} patches sleep, the farthest from all cameras", detail.awake_limit));
        }
        given_up
    }
}

impl fmt::Display for Detail {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { wind_ticks, awake_limit, publish_divisor } = self;
        write!(f, "wind stepped every {wind_ticks} ticks, at most {awake_limit} patches awake")?;
        if *publish_divisor > 1 {
            write!(f, ", one publication of {publish_divisor} made")?;
        }
        Ok(())
    }
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let percent = |fraction: f32| 100.0 * fraction;
        match *self {
            Self::Calm { error, allowed } => {
                write!(f, "calm: steps twice as long err by {:.3} %, allowed {:.3} %", percent(error), percent(allowed))
            }
            Self::Stirred { error, allowed } => {
                write!(f, "stirred: steps err by {:.3} %, allowed {:.3} %", percent(error), percent(allowed))
            }
            Self::Overload { busy_ms, budget_ms } => write!(f, "overload: {busy_ms:.3} ms a tick, budget {budget_ms:.3} ms"),
            Self::Relief { busy_ms, budget_ms } => write!(f, "relief: {busy_ms:.3} ms a tick, budget {budget_ms:.3} ms"),
        }
    }
}

/// What a scene demands of its run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Demands {
    /// Errors of the wind.
    pub wind: Option<WindDemand>,
    /// Tolerance of the bending angle (degrees).
    pub bend_deg: Option<f32>,
    /// Error of the bending angle that the plan expects (degrees).
    pub planned_bend_deg: f32,
    /// Time of a tick on the server (ms).
    pub server_ms: f32,
    /// Mean data to each client (kbit/s); `None` where only the server limits it.
    pub kbit_per_s: Option<f32>,
}

/// Errors of the wind as fractions of its root mean square.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct WindDemand {
    /// Tolerance.
    pub tolerance: f32,
    /// Error that the plan expects.
    pub planned: f32,
    /// Root mean square of the wind in the plan's pilot run (m/s).
    pub rms_m_per_s: f32,
}

impl WindDemand {
    /// Error that longer steps than planned may add: independent errors add up as squares.
    pub(crate) fn allowed(&self) -> f32 {
        (self.tolerance.powi(2) - self.planned.powi(2)).max(0.0).sqrt()
    }
}

/// The decisions about the detail of a world.
#[derive(Clone, Debug, Default)]
pub(crate) struct Decisions {
    /// The newest decisions, oldest first.
    newest: VecDeque<Decision>,
    count: u64,
}

impl Decisions {
    /// The decisions before the newest `newest`, of which there were `count`, are not known.
    pub(crate) fn restored(newest: Option<Decision>, count: u64) -> Self {
        Self { newest: newest.into_iter().collect(), count }
    }

    pub(crate) fn note(&mut self, decision: Decision) {
        if self.newest.len() == SHOWN {
            self.newest.pop_front();
        }
        self.newest.push_back(decision);
        self.count += 1;
    }

    /// The newest decision.
    pub(crate) fn newest(&self) -> Option<Decision> {
        self.newest.back().copied()
    }

    /// The newest decisions, oldest first.
    pub(crate) fn shown(&self) -> Vec<Decision> {
        self.newest.iter().copied().collect()
    }

    /// Number of decisions so far.
    pub(crate) fn count(&self) -> u64 {
        self.count
    }
}
