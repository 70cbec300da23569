//! Controller of the detail: it compares the world's estimated errors with what the scene allows and the time of a tick with its budget, and decides what changes.
//!
//! It reads clocks, so its decisions enter the world as commands, which the journal keeps.

use super::load::Load;
use crate::detail::{Decision, Demands, Detail, DetailRange, LEAST_AWAKE, LOAD_LEVELS, Reason};
use crate::snapshot::Diagnostics;
use serde::Serialize;
use std::time::Duration;

/// Factor of the wind's step, divisor of the publications, and fraction of the awake patches at each load level.
const LEVELS: [(u32, u32, f32); LOAD_LEVELS.len()] = [(1, 1, 1.0), (2, 1, 1.0), (2, 2, 1.0), (2, 2, 0.5), (4, 2, 0.5), (4, 2, 0.25)];

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
    /// Place of the wind's interval in the range before anything gives way to the load.
    interval: usize,
    level: usize,
    /// Awake patches when the load first limited them.
    awake_before: Option<u32>,
    load: Load,
    changed: Duration,
    /// Since when a tick takes less than the relieved part of the budget.
    relieved: Option<Duration>,
    /// Whether the last change took a level back.
    has_taken_back: bool,
    hold: Duration,
    /// Estimates seen of the error of the present step and of steps twice as long.
    samples: [u64; 2],
    calm_samples: u32,
}

impl Controller {
    /// A controller of a world in a detail that `newest`, its newest decision, has set.
    pub(super) fn new(demands: Demands, range: DetailRange, newest: Option<Decision>) -> Self {
        let place = |ticks: u32| range.wind_ticks.binary_search(&ticks).ok();
        let own = place(range.own.wind_ticks).unwrap_or(0);
        let level = newest.map_or(0, |newest| usize::from(newest.level).min(LOAD_LEVELS.len() - 1));
        let awake_before = newest.filter(|_| LEVELS[level].2 < 1.0).map(|newest| newest.unloaded.awake_limit);
        Self {
            interval: newest.and_then(|newest| place(newest.unloaded.wind_ticks)).unwrap_or(own),
            demands,
            range,
            level,
            awake_before,
            load: Load::default(),
            changed: Duration::ZERO,
            relieved: None,
            has_taken_back: false,
            hold: HOLD,
            samples: [0; 2],
            calm_samples: 0,
        }
    }

    /// Sets the budget (ms).
    pub(super) fn set_budget(&mut self, server_ms: f32) {
        self.demands.server_ms = server_ms;
    }

    /// Forgets the load, after a pause.
    pub(super) fn forget_load(&mut self) {
        self.load.clear();
        self.relieved = None;
    }

    /// How many publications there are to one that is made.
    pub(super) fn publish_divisor(&self) -> u32 {
        self.detail(self.level).publish_divisor
    }

    /// Looks at the world `now` (time since the start), after a publication: `ticks` since the last one took `busy_ms` each. Returns a change, if there is one.
    pub(super) fn decide(&mut self, now: Duration, tick: u64, ticks: u32, busy_ms: f64, diagnostics: &Diagnostics) -> Option<Decision> {
        self.load.note(now, ticks, busy_ms);
        let before = self.detail(self.level);
        let reason = self.follow_load(now, diagnostics).or_else(|| self.follow_wind(diagnostics))?;
        let detail = self.detail(self.level);
        if detail.wind_ticks != before.wind_ticks {
            self.calm_samples = 0;
        }
        self.load.clear();
        let unloaded = Detail { awake_limit: self.awake_before.unwrap_or(self.range.own.awake_limit), ..self.detail(0) };
        Some(Decision { tick, detail, unloaded, level: self.level as u8, reason })
    }

    /// The detail at a level.
    fn detail(&self, level: usize) -> Detail {
        let (stretch, publish_divisor, share) = LEVELS[level];
        let wanted = self.range.wind_ticks[self.interval] * stretch;
        let wind_ticks = self.range.wind_ticks.iter().copied().filter(|ticks| *ticks <= wanted).max().unwrap_or(wanted);
        let own = self.range.own.awake_limit;
        let limited = self.awake_before.map(|awake| ((awake as f32 * share).ceil() as u32).max(LEAST_AWAKE).min(own));
        Detail {
            wind_ticks,
            awake_limit: limited.filter(|_| share < 1.0).unwrap_or(own),
            publish_divisor: if self.range.may_halve_publications { publish_divisor } else { 1 },
        }
    }

    fn follow_load(&mut self, now: Duration, diagnostics: &Diagnostics) -> Option<Reason> {
        let budget_ms = self.demands.server_ms;
        if let Some(busy_ms) = self.load.mean_ms(now).filter(|busy_ms| *busy_ms > budget_ms) {
            self.relieved = None;
            return self.give_way(now, diagnostics.awake_patches).then_some(Reason::Overload { busy_ms, budget_ms });
        }
        let busy_ms = self.load.long_mean_ms(now)?;
        if busy_ms > RELIEVED * budget_ms {
            self.relieved = None;
            return None;
        }
        let since = *self.relieved.get_or_insert(now);
        if self.level == 0 || now.saturating_sub(since.max(self.changed)) < self.hold {
            return None;
        }
        self.take_back(now);
        Some(Reason::Relief { busy_ms, budget_ms })
    }

    /// Goes to the next level at which something changes, if there is one.
    fn give_way(&mut self, now: Duration, awake_patches: u32) -> bool {
        let (before, awake_before) = (self.detail(self.level), self.awake_before);
        self.awake_before.get_or_insert(awake_patches);
        let Some(next) = (self.level + 1..LEVELS.len()).find(|level| self.detail(*level) != before) else {
            self.awake_before = awake_before;
            return false;
        };
        if LEVELS[next].2 == 1.0 {
            self.awake_before = None;
        }
        // A level that was just taken back is held for longer the next time.
        if std::mem::take(&mut self.has_taken_back) {
            self.hold = if now.saturating_sub(self.changed) < HOLD { (2 * self.hold).min(LONGEST_HOLD) } else { HOLD };
        }
        (self.level, self.changed) = (next, now);
        true
    }

    /// Goes to the level before, at which something changes.
    fn take_back(&mut self, now: Duration) {
        let before = self.detail(self.level);
        self.level = (0..self.level).rev().find(|level| self.detail(*level) != before).unwrap_or(0);
        if LEVELS[self.level].2 == 1.0 {
            self.awake_before = None;
        }
        (self.has_taken_back, self.changed) = (true, now);
    }

    fn follow_wind(&mut self, diagnostics: &Diagnostics) -> Option<Reason> {
        let demand = self.demands.wind.filter(|demand| demand.rms_m_per_s > 0.0)?;
        let seen = [diagnostics.wind_step_samples, diagnostics.wind_doubled_samples];
        let [is_present_new, is_doubled_new] = [0, 1].map(|of| seen[of] != self.samples[of]);
        self.samples = seen;
        // While the load decides about the steps, errors are shown, not followed.
        if self.level > 0 {
            return None;
        }
        let own = self.range.wind_ticks.binary_search(&self.range.own.wind_ticks).unwrap_or(0);
        let is_stretched = self.interval > own;
        let present = diagnostics.wind_step_error_m_per_s / demand.rms_m_per_s;
        // The plan's own step is part of its error.
        let allowed = if is_stretched { demand.allowed() } else { demand.tolerance };
        if is_present_new
            && present > allowed
            && self.interval > 0
            && (is_stretched || self.load.last_mean_ms() <= SPARE * self.demands.server_ms)
        {
            self.interval -= 1;
            return Some(Reason::Stirred { error: present, allowed });
        }
        if !is_doubled_new {
            return None;
        }
        let (doubled, allowed) = (diagnostics.wind_doubled_error_m_per_s / demand.rms_m_per_s, demand.allowed());
        self.calm_samples = if doubled < CALM * allowed { self.calm_samples + 1 } else { 0 };
        if self.calm_samples < CALM_SAMPLES || self.interval + 1 == self.range.wind_ticks.len() {
            return None;
        }
        self.interval += 1;
        Some(Reason::Calm { error: doubled, allowed })
    }

    /// The state for people.
    pub(super) fn report(&self, diagnostics: &Diagnostics) -> ControlReport {
        let Demands { wind, bend_deg, planned_bend_deg, server_ms, .. } = self.demands;
        let wind_error = wind.filter(|wind| wind.rms_m_per_s > 0.0).map(|wind| {
            let estimated = diagnostics.wind_step_error_m_per_s / wind.rms_m_per_s;
            let is_stretched = diagnostics.wind_step_secs > (self.range.own.wind_ticks as f32 + 0.5) * self.range.tick_secs;
            // The planned error has that of the planned step in it.
            if is_stretched { wind.planned.hypot(estimated) } else { wind.planned.max(estimated) }
        });
        ControlReport {
            budget_ms: server_ms,
            busy_ms: self.load.last_mean_ms(),
            wind_error,
            wind_tolerance: wind.map(|wind| wind.tolerance),
            bend_error_deg: planned_bend_deg.max(diagnostics.bend_step_error_deg),
            bend_tolerance_deg: bend_deg,
        }
    }
}

#[cfg(test)]
mod tests;
