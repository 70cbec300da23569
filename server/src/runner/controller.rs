//! Controller of the detail: it compares the world's estimated errors with what the scene allows and the time of a tick with its budget, and decides what changes.
//!
//! It reads clocks, so its decisions enter the world as commands, which the journal keeps.

use crate::detail::{Decision, Demands, Detail, DetailRange, LADDER, Reason};
use crate::snapshot::Diagnostics;
use serde::Serialize;
use std::time::Duration;

/// Factor of the wind's step, divisor of the publications, and fraction of the awake patches at each level.
const LEVELS: [(u32, u32, f32); LADDER.len()] = [(1, 1, 1.0), (2, 1, 1.0), (2, 2, 1.0), (2, 2, 0.5), (4, 2, 0.5), (4, 2, 0.25)];

/// Time constant of the mean time of a tick (s).
const MEAN_SECS: f64 = 0.15;
/// Time between two levels down (s): the effect of one is measured before the next.
const SETTLE: Duration = Duration::from_millis(300);
/// Time below [`RELIEVED`] before a level is taken back, at first, and at most after it had to be given up again.
const HOLD: Duration = Duration::from_secs(5);
const LONGEST_HOLD: Duration = Duration::from_secs(80);
/// Fraction of the budget below which a level is taken back.
const RELIEVED: f32 = 0.6;
/// Fraction of the allowed error of the wind below which its steps are doubled, and estimates in a row that must be so small.
const CALM: f32 = 0.5;
const CALM_SAMPLES: u32 = 2;
/// Fraction of the budget up to which a stirred wind may be stepped more often than the plan has it.
const SPARE: f32 = 0.5;
/// Fewest patches to which the awake ones are limited.
const LEAST_AWAKE: u32 = 16;

/// State of the controller, for people.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ControlReport {
    /// Budget of a tick (ms).
    pub budget_ms: f32,
    /// Mean time of a tick, with its share of the publications (ms).
    pub busy_ms: f32,
    /// Expected error of the wind at present, as a fraction; `None` where the scene demands none.
    pub wind_error: Option<f32>,
    /// Its tolerance.
    pub wind_tolerance: Option<f32>,
    /// Expected error of the bending angle at present (degrees).
    pub bend_error_deg: f32,
    /// Its tolerance.
    pub bend_tolerance_deg: Option<f32>,
}

/// The controller.
pub(super) struct Controller {
    demands: Demands,
    range: DetailRange,
    /// Place of the wind's interval in the range before anything gives way to load.
    interval: usize,
    level: usize,
    /// Awake patches when the load first limited them.
    awake_before: Option<u32>,
    busy_ms: Option<f64>,
    observed: Duration,
    changed: Duration,
    /// Since when a tick takes less than the relieved part of the budget.
    relieved: Option<Duration>,
    hold: Duration,
    samples: u64,
    calm_samples: u32,
}

impl Controller {
    /// A controller of a world in a detail that `newest`, its newest decision, has set.
    pub(super) fn new(demands: Demands, range: DetailRange, newest: Option<Decision>) -> Self {
        let own = range.wind_ticks.binary_search(&range.own.wind_ticks).unwrap_or(0);
        let mut controller = Self {
            demands,
            range,
            interval: own,
            level: 0,
            awake_before: None,
            busy_ms: None,
            observed: Duration::ZERO,
            changed: Duration::ZERO,
            relieved: None,
            hold: HOLD,
            samples: 0,
            calm_samples: 0,
        };
        if let Some(Decision { detail, level, .. }) = newest {
            controller.level = usize::from(level).min(LADDER.len() - 1);
            let (stretch, _, share) = LEVELS[controller.level];
            let unloaded = controller.range.wind_ticks.binary_search(&(detail.wind_ticks / stretch));
            controller.interval = unloaded.unwrap_or(own);
            controller.awake_before = (share < 1.0).then(|| (detail.awake_limit as f32 / share) as u32);
        }
        controller
    }

    /// Sets the budget (ms).
    pub(super) fn set_budget(&mut self, server_ms: f32) {
        self.demands.server_ms = server_ms;
    }

    /// How many publications there are to one that is made.
    pub(super) fn publish_divisor(&self) -> u32 {
        LEVELS[self.level].1
    }

    /// Looks at the world `now` (time since the start), after a publication: ticks took `busy_ms` each since the last one. Returns a change, if there is one.
    pub(super) fn decide(&mut self, now: Duration, tick: u64, busy_ms: f64, diagnostics: &Diagnostics) -> Option<Decision> {
        let weight = 1.0 - (-now.saturating_sub(self.observed).as_secs_f64() / MEAN_SECS).exp();
        self.observed = now;
        self.busy_ms = Some(self.busy_ms.map_or(busy_ms, |mean| mean + weight * (busy_ms - mean)));
        let before = self.detail();
        let reason = self.follow_load(now, diagnostics).or_else(|| self.follow_wind(diagnostics))?;
        let detail = self.detail();
        if detail.wind_ticks != before.wind_ticks {
            self.calm_samples = 0;
        }
        Some(Decision { tick, detail, level: self.level as u8, reason })
    }

    /// The present detail.
    fn detail(&self) -> Detail {
        let (stretch, publish_divisor, share) = LEVELS[self.level];
        let wanted = self.range.wind_ticks[self.interval] * stretch;
        let wind_ticks = self.range.wind_ticks.iter().copied().filter(|ticks| *ticks <= wanted).max().unwrap_or(wanted);
        let own = self.range.own.awake_limit;
        let limited = self.awake_before.map(|awake| ((awake as f32 * share).ceil() as u32).max(LEAST_AWAKE).min(own));
        Detail { wind_ticks, awake_limit: limited.filter(|_| share < 1.0).unwrap_or(own), publish_divisor }
    }

    fn follow_load(&mut self, now: Duration, diagnostics: &Diagnostics) -> Option<Reason> {
        let (busy_ms, budget_ms) = (self.busy_ms? as f32, self.demands.server_ms);
        if busy_ms > RELIEVED * budget_ms {
            self.relieved = None;
        }
        if busy_ms > budget_ms {
            if self.level + 1 == LADDER.len() || now.saturating_sub(self.changed) < SETTLE {
                return None;
            }
            // A level that was just taken back is held for longer the next time.
            self.hold = if now.saturating_sub(self.changed) < HOLD { (2 * self.hold).min(LONGEST_HOLD) } else { HOLD };
            self.level += 1;
            if LEVELS[self.level].2 < 1.0 {
                self.awake_before.get_or_insert(diagnostics.awake_patches);
            }
            self.changed = now;
            return Some(Reason::Overload { busy_ms, budget_ms });
        }
        let since = if busy_ms <= RELIEVED * budget_ms { *self.relieved.get_or_insert(now) } else { return None };
        if self.level == 0 || now.saturating_sub(since.max(self.changed)) < self.hold {
            return None;
        }
        self.level -= 1;
        if LEVELS[self.level].2 == 1.0 {
            self.awake_before = None;
        }
        self.changed = now;
        Some(Reason::Relief { busy_ms, budget_ms })
    }

    fn follow_wind(&mut self, diagnostics: &Diagnostics) -> Option<Reason> {
        let demand = self.demands.wind?;
        // While the load decides about the steps, errors are shown, not followed.
        if diagnostics.error_samples == self.samples || self.level > 0 || demand.rms_m_per_s <= 0.0 {
            return None;
        }
        self.samples = diagnostics.error_samples;
        let own = self.range.wind_ticks.binary_search(&self.range.own.wind_ticks).unwrap_or(0);
        let relative = |m_per_s: f32| m_per_s / demand.rms_m_per_s;
        let (present, doubled) = (relative(diagnostics.wind_step_error_m_per_s), relative(diagnostics.wind_doubled_error_m_per_s));
        let is_stretched = self.interval > own;
        // The plan's own step is part of its error.
        let allowed = if is_stretched { demand.allowed() } else { demand.tolerance };
        if present > allowed && self.interval > 0 && (is_stretched || self.busy_ms? as f32 <= SPARE * self.demands.server_ms) {
            self.interval -= 1;
            return Some(Reason::Stirred { error: present, allowed });
        }
        let is_calm = diagnostics.wind_doubled_error_m_per_s > 0.0 && doubled < CALM * demand.allowed();
        self.calm_samples = if is_calm { self.calm_samples + 1 } else { 0 };
        if self.calm_samples < CALM_SAMPLES || self.interval + 1 == self.range.wind_ticks.len() {
            return None;
        }
        self.interval += 1;
        Some(Reason::Calm { error: doubled, allowed: demand.allowed() })
    }

    /// The state for people.
    pub(super) fn report(&self, diagnostics: &Diagnostics) -> ControlReport {
        let Demands { wind, bend_deg, planned_bend_deg, server_ms } = self.demands;
        let wind_error = wind.filter(|wind| wind.rms_m_per_s > 0.0).map(|wind| {
            // Steps as planned have no error beyond the planned one.
            let is_planned = diagnostics.wind_step_secs < (self.range.own.wind_ticks as f32 + 0.5) * self.range.tick_secs;
            let added = if is_planned { 0.0 } else { diagnostics.wind_step_error_m_per_s / wind.rms_m_per_s };
            wind.planned.hypot(added)
        });
        ControlReport {
            budget_ms: server_ms,
            busy_ms: self.busy_ms.unwrap_or_default() as f32,
            wind_error,
            wind_tolerance: wind.map(|wind| wind.tolerance),
            bend_error_deg: planned_bend_deg.max(diagnostics.bend_step_error_deg),
            bend_tolerance_deg: bend_deg,
        }
    }
}

#[cfg(test)]
mod tests;
