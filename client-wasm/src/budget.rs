//! Automatic quality: a controller that keeps the frame time within a budget by changing a level, quickly downwards and slowly upwards. The level is a height on
//! the [ladder](crate::ladder) of detail and resolution.
//!
//! The cost of a frame is modelled as growing by a factor e^s per level. The slope s is learnt from the steps taken. A step aims at `TARGET` of the
//! budget; within `DEAD_BAND` the level is left alone.

use crate::damped::Damped;

/// Fraction of the budget that a step aims at.
const TARGET: f32 = 0.95;
/// Dead band: fractions of the budget between which the level is left alone.
const DEAD_BAND: [f32; 2] = [0.9, 1.0];
/// Fraction of the budget above which the level is lowered at once.
const OVERLOAD: f32 = 1.2;

/// Minimum time (s) and number of frames to measure before reacting to overload, and before any other change.
const OVERLOAD_WINDOW: (f32, usize) = (0.2, 2);
const STEADY_WINDOW: (f32, usize) = (0.8, 8);
/// Frames ignored after a change, since their times may belong to the previous level.
const STALE_FRAMES: u32 = 2;

/// Maximum steps down and up (levels).
const MAX_STEP: [f32; 2] = [1.5, 0.25];
/// Time constants of the transition to another level, down and up (s).
const TRANSITION_SECS: [f32; 2] = [0.06, 0.2];
/// Distance to the goal (levels) below which a transition is over.
const TRANSITION_END: f32 = 0.01;

/// Range of plausible slopes, initial slope, and smoothing factor of a newly measured slope.
const SLOPE_RANGE: [f32; 2] = [0.2, 4.0];
const INITIAL_SLOPE: f32 = 1.0;
const SLOPE_SMOOTHING: f32 = 0.5;
/// Minimum change of level from which a slope is measured.
const MIN_SLOPE_STEP: f32 = 0.05;
/// Divisor of steps up, so that they end below the budget.
const STEP_UP_CAUTION: f32 = 1.5;

/// Back-off after a step up that exceeded the budget (s): initial and maximum. It doubles each time.
const BACK_OFF_SECS: [f32; 2] = [4.0, 64.0];
/// Time over budget at the lowest level (s) after which no level can keep the budget.
const EXHAUSTED_SECS: f32 = 2.0;
/// Fraction of the budget below which the highest level leaves much of it unused, and the time (s) after which that is certain.
const AMPLE: f32 = 0.5;
const AMPLE_SECS: f32 = 2.0;
/// Fraction to which costs must fall to end a back-off early: the view has changed.
const RELIEF: f32 = 0.7;

/// Measured times of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameTime {
    /// Busy time of the frame (s): the longer of its CPU time and its GPU time.
    pub work_secs: f32,
    /// Time since the previous frame (s).
    pub interval_secs: f32,
    /// Whether the frame had to wait for the GPU. Its cost is then the interval.
    pub waited: bool,
}

impl FrameTime {
    fn cost_secs(self) -> f32 {
        if self.waited { self.work_secs.max(self.interval_secs) } else { self.work_secs }
    }
}

/// Controller of the level.
#[derive(Clone, Debug)]
pub struct FrameBudget {
    budget_secs: f32,
    highest: f32,
    goal: f32,
    shown: Damped,
    /// Number of frames still to be ignored.
    stale: u32,
    /// Costs of the frames at this level, and the total time they span (s).
    costs_secs: Vec<f32>,
    span_secs: f32,
    slope: f32,
    /// Level and cost (s) before the last step.
    before: Option<(f32, f32)>,
    /// Whether the last step was upwards and its cost is not known yet.
    stepped_up: bool,
    back_off: BackOff,
    /// Time over the budget at the lowest level (s).
    exhausted_secs: f32,
    /// Time far below the budget at the highest level (s).
    ample_secs: f32,
}

/// Time without steps up.
#[derive(Clone, Copy, Debug, Default)]
struct BackOff {
    left_secs: f32,
    /// Duration of the previous back-off; 0 if there was none.
    last_secs: f32,
    /// Cost of a frame when it began (s); 0 while unknown.
    cost_secs: f32,
}

impl FrameBudget {
    /// A controller that keeps frames within `budget_secs` (> 0) with levels 0..=`highest`, starting at `level`.
    pub fn new(budget_secs: f32, level: f32, highest: f32) -> Self {
        let level = level.clamp(0.0, highest);
        Self {
            budget_secs,
            highest,
            goal: level,
            shown: Damped::at(level),
            stale: 0,
            costs_secs: Vec::new(),
            span_secs: 0.0,
            slope: INITIAL_SLOPE,
            before: None,
            stepped_up: false,
            back_off: BackOff::default(),
            exhausted_secs: 0.0,
            ample_secs: 0.0,
        }
    }

    /// Frame time budget (s).
    pub fn budget_secs(&self) -> f32 {
        self.budget_secs
    }

    /// Level for the next frame.
    pub fn level(&self) -> f32 {
        self.shown.value.clamp(0.0, self.highest)
    }

    /// Level that the shown one moves to.
    pub fn goal(&self) -> f32 {
        self.goal
    }

    /// Whether even the lowest level exceeds the budget.
    pub fn is_exhausted(&self) -> bool {
        self.exhausted_secs >= EXHAUSTED_SECS
    }

    /// Whether even the highest level leaves half of the budget unused.
    pub fn is_ample(&self) -> bool {
        self.ample_secs >= AMPLE_SECS
    }

    /// Records a frame and adjusts the level.
    pub fn record(&mut self, frame: FrameTime) {
        let dt_secs = frame.interval_secs.clamp(0.0, 1.0);
        self.back_off.left_secs -= dt_secs;
        if (self.shown.value - self.goal).abs() > TRANSITION_END {
            self.shown.follow(self.goal, TRANSITION_SECS[usize::from(self.goal > self.shown.value)], dt_secs);
            return;
        }
        self.shown = Damped::at(self.goal);
        if self.stale > 0 {
            self.stale -= 1;
            return;
        }
        self.costs_secs.push(frame.cost_secs());
        self.span_secs += dt_secs;
        let has = |(secs, frames): (f32, usize)| self.span_secs >= secs && self.costs_secs.len() >= frames;
        let least_secs = self.costs_secs.iter().copied().fold(f32::INFINITY, f32::min);
        if has(OVERLOAD_WINDOW) && least_secs > OVERLOAD * self.budget_secs || has(STEADY_WINDOW) {
            self.decide();
        }
    }

    /// Changes the level if the median cost at this level is outside the dead band.
    fn decide(&mut self) {
        let cost_secs = median(&mut self.costs_secs).max(1e-5);
        self.costs_secs.clear();
        let span_secs = std::mem::take(&mut self.span_secs);
        self.learn(cost_secs);
        let fraction = cost_secs / self.budget_secs;
        let is_over = fraction > DEAD_BAND[1] && self.goal <= 0.0;
        self.exhausted_secs = if is_over { self.exhausted_secs + span_secs } else { 0.0 };
        let is_ample = fraction < AMPLE && self.goal >= self.highest;
        self.ample_secs = if is_ample { self.ample_secs + span_secs } else { 0.0 };
        if self.back_off.cost_secs == 0.0 {
            self.back_off.cost_secs = cost_secs;
        }
        let step = (TARGET / fraction).ln() / self.slope;
        if fraction > DEAD_BAND[1] {
            if std::mem::take(&mut self.stepped_up) {
                let secs = (2.0 * self.back_off.last_secs).clamp(BACK_OFF_SECS[0], BACK_OFF_SECS[1]);
                self.back_off = BackOff { left_secs: secs, last_secs: secs, cost_secs: 0.0 };
            }
            self.step_to(self.goal + step.max(-MAX_STEP[0]), cost_secs);
        } else if fraction < DEAD_BAND[0] {
            if self.back_off.left_secs <= 0.0 || cost_secs < RELIEF * self.back_off.cost_secs {
                self.stepped_up = true;
                self.step_to(self.goal + (step / STEP_UP_CAUTION).min(MAX_STEP[1]), cost_secs);
            }
        } else {
            (self.stepped_up, self.back_off.last_secs) = (false, 0.0);
        }
    }

    fn step_to(&mut self, goal: f32, cost_secs: f32) {
        self.before = Some((self.goal, cost_secs));
        self.goal = goal.clamp(0.0, self.highest);
        self.stale = STALE_FRAMES;
    }

    /// Updates the slope from the step that led to this cost.
    fn learn(&mut self, cost_secs: f32) {
        let Some((level, before_secs)) = self.before.take() else { return };
        let step = self.goal - level;
        if step.abs() >= MIN_SLOPE_STEP {
            let slope = (cost_secs / before_secs).ln() / step;
            self.slope += SLOPE_SMOOTHING * (slope.clamp(SLOPE_RANGE[0], SLOPE_RANGE[1]) - self.slope);
        }
    }
}

fn median(values: &mut [f32]) -> f32 {
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f32::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;
    use prairie_core::hash::hash3;

    /// Simulated device: level 0 takes `least_secs`, each further level e^`slope` times as long, with relative noise `noise`.
    #[derive(Clone, Copy)]
    struct Device {
        least_secs: f32,
        slope: f32,
        noise: f32,
        refresh_secs: f32,
    }

    const DEVICE: Device = Device { least_secs: 0.004, slope: 1.0, noise: 0.0, refresh_secs: 1.0 / 60.0 };
    const BUDGET_SECS: f32 = 1.0 / 60.0;

    impl Device {
        fn cost_secs(self, level: f32) -> f32 {
            self.least_secs * (self.slope * level).exp()
        }

        fn level_of(self, cost_secs: f32) -> f32 {
            (cost_secs / self.least_secs).ln() / self.slope
        }

        /// Simulates `secs` of frames and returns the time and level of each.
        fn draw(self, budget: &mut FrameBudget, secs: f32) -> Vec<(f32, f32)> {
            let (mut time_secs, mut frames, mut pipeline) = (0.0, Vec::new(), [budget.level(); 2]);
            while time_secs < secs {
                // Measured times belong to frames requested earlier.
                let [level, next] = pipeline;
                pipeline = [next, budget.level()];
                let [lot, ..] = hash3([7, frames.len() as u32, 3]).map(|bits| bits as f32 / u32::MAX as f32);
                let work_secs = self.cost_secs(level) * (1.0 + self.noise * (2.0 * lot - 1.0));
                let interval_secs = (work_secs / self.refresh_secs).ceil() * self.refresh_secs;
                time_secs += interval_secs;
                budget.record(FrameTime { work_secs, interval_secs, waited: false });
                frames.push((time_secs, budget.level()));
            }
            frames
        }
    }

    fn turns(frames: &[(f32, f32)]) -> usize {
        let ways = frames.windows(2).map(|pair| pair[1].1 - pair[0].1).filter(|way| way.abs() > 1e-4).map(f32::signum);
        let ways: Vec<f32> = ways.collect();
        ways.windows(2).filter(|pair| pair[0] != pair[1]).count()
    }

    fn spread(frames: &[(f32, f32)]) -> f32 {
        let levels = frames.iter().map(|frame| frame.1);
        levels.clone().fold(f32::MIN, f32::max) - levels.fold(f32::MAX, f32::min)
    }

    #[test]
    fn every_device_settles_within_a_tenth_of_the_budget() {
        for budget_secs in [BUDGET_SECS, 0.1] {
            for slope in [0.3, 0.7, 1.0, 1.5, 2.5] {
                for begin in [0.0, 1.5, 3.0] {
                    for wanted in [0.4, 1.3, 2.6] {
                        let device = Device { slope, ..DEVICE };
                        let device = Device { least_secs: 0.95 * budget_secs / device.cost_secs(wanted) * device.least_secs, ..device };
                        // Slower ones than a frame a second need more time than there is here.
                        let mut budget = FrameBudget::new(budget_secs, device.level_of(1.0).min(begin), 3.0);
                        device.draw(&mut budget, 40.0);
                        let frames = device.draw(&mut budget, 40.0);
                        let fraction = device.cost_secs(budget.level()) / budget_secs;
                        assert!((0.9..=1.0).contains(&fraction), "{fraction} of {budget_secs} s, slope {slope}, from {begin} to {wanted}");
                        assert!(spread(&frames) < 0.05, "{} of {budget_secs} s, slope {slope}, from {begin}", spread(&frames));
                    }
                }
            }
        }
    }

    #[test]
    fn a_fast_device_reaches_the_highest_level_and_a_slow_one_the_lowest() {
        let mut budget = FrameBudget::new(BUDGET_SECS, 1.5, 2.0);
        Device { least_secs: 0.001, ..DEVICE }.draw(&mut budget, 30.0);
        assert!(budget.level() == 2.0 && budget.is_ample() && !budget.is_exhausted());
        Device { least_secs: 0.012, ..DEVICE }.draw(&mut budget, 30.0);
        assert!(!budget.is_exhausted() && !budget.is_ample());
        Device { least_secs: 0.2, ..DEVICE }.draw(&mut budget, 10.0);
        assert!(budget.level() == 0.0 && budget.is_exhausted());
        Device { least_secs: 0.012, ..DEVICE }.draw(&mut budget, 10.0);
        assert!(!budget.is_exhausted());
    }

    #[test]
    fn overload_is_resolved_within_two_seconds_and_relief_is_used_slowly() {
        for (slope, refresh_secs, budget_secs) in [(0.7, 1.0 / 60.0, BUDGET_SECS), (1.0, 1.0 / 144.0, BUDGET_SECS), (1.4, 1.0 / 60.0, 0.1)]
        {
            let calm = Device { slope, refresh_secs, least_secs: 0.95 * budget_secs / (2.5 * slope).exp(), ..DEVICE };
            let mut budget = FrameBudget::new(budget_secs, 2.5, 3.0);
            calm.draw(&mut budget, 10.0);
            let loaded = Device { least_secs: 3.0 * calm.least_secs, ..calm };
            loaded.draw(&mut budget, 2.0);
            let fraction = loaded.cost_secs(budget.level()) / budget_secs;
            assert!(fraction < 1.2, "{fraction} of the budget two seconds after the load, slope {slope}");
            loaded.draw(&mut budget, 20.0);
            let low = budget.level();
            let frames = calm.draw(&mut budget, 2.0);
            assert!(budget.level() > low && budget.level() < low + 1.0, "from {low} to {}", budget.level());
            assert_eq!(turns(&frames), 0);
            calm.draw(&mut budget, 40.0);
            assert!(budget.level() > calm.level_of(0.9 * budget_secs) - 0.01);
        }
    }

    #[test]
    fn noisy_frame_times_barely_change_the_level() {
        for (budget_secs, noise) in [(BUDGET_SECS, 0.1), (BUDGET_SECS, 0.4), (0.1, 0.1), (0.1, 0.3)] {
            let device = Device { noise, least_secs: 0.95 * budget_secs / (1.5_f32).exp(), ..DEVICE };
            let mut budget = FrameBudget::new(budget_secs, 0.0, 3.0);
            device.draw(&mut budget, 30.0);
            let frames = device.draw(&mut budget, 120.0);
            assert!(spread(&frames) < 0.1 + noise, "{} of a level by {noise} noise", spread(&frames));
            assert!(turns(&frames) < 60, "{} turns in two minutes", turns(&frames));
        }
    }

    #[test]
    fn a_cost_jump_is_not_retried_over_and_over() {
        // Above level 1 everything costs four times as much.
        let mut budget = FrameBudget::new(BUDGET_SECS, 0.5, 3.0);
        let mut ups = 0;
        let mut was_up = false;
        for _ in 0..60 * 300 {
            let work_secs = if budget.level() > 1.0 { 0.028 } else { 0.007 };
            budget.record(FrameTime { work_secs, interval_secs: 1.0 / 60.0, waited: false });
            let is_up = budget.level() > 1.0;
            ups += usize::from(is_up && !was_up);
            was_up = is_up;
        }
        assert!((1..=10).contains(&ups), "{ups} climbs in five minutes");
    }

    #[test]
    fn a_single_slow_frame_changes_nothing() {
        let device = Device { least_secs: 0.95 * BUDGET_SECS / (1.5_f32).exp(), ..DEVICE };
        let mut budget = FrameBudget::new(BUDGET_SECS, 1.5, 3.0);
        device.draw(&mut budget, 5.0);
        let level = budget.level();
        budget.record(FrameTime { work_secs: 0.4, interval_secs: 0.4, waited: true });
        let frames = device.draw(&mut budget, 3.0);
        assert!(spread(&frames) < 0.02 && (budget.level() - level).abs() < 0.02);
    }

    #[test]
    fn the_cost_of_a_waiting_frame_is_its_interval() {
        let mut budget = FrameBudget::new(BUDGET_SECS, 2.0, 3.0);
        for _ in 0..60 {
            budget.record(FrameTime { work_secs: 0.01, interval_secs: 0.05, waited: true });
        }
        assert!(budget.level() < 1.0, "{}", budget.level());
    }
}
