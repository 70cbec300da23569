//! Automatic quality: a budget of time for a frame steers the level of detail, down at once and up by and by.
//!
//! What a frame costs is taken to grow by a factor e^s with each level. The slope s is learnt from the steps taken; a step aims at `AIM` of the
//! budget, and within `BAND` nothing is changed.

use crate::damped::Damped;

/// Share of the budget that a step aims at.
const AIM: f32 = 0.95;
/// Shares of the budget between which the level stays as it is.
const BAND: [f32; 2] = [0.9, 1.0];
/// Share of the budget above which a level is left at once.
const OVERLOAD: f32 = 1.2;

/// Least time (s) and frames before a level is left for overload, and before it is changed in calm.
const HASTY: (f32, usize) = (0.2, 2);
const CALM: (f32, usize) = (0.8, 8);
/// Frames that may still be of the level before.
const STALE: u32 = 2;

/// Largest steps down and up (levels).
const STEP: [f32; 2] = [1.5, 0.25];
/// Time constants of the way to another level, down and up (s).
const SLIDE_SECS: [f32; 2] = [0.06, 0.2];
/// A level that is as near as this (levels) to its goal has arrived.
const ARRIVED: f32 = 0.01;

/// Slopes that are believed, and the first; the share of a newly seen one that counts.
const SLOPES: [f32; 2] = [0.2, 4.0];
const FIRST_SLOPE: f32 = 1.0;
const SLOPE_SHARE: f32 = 0.5;
/// Least change of level that tells of the slope.
const TELLING_STEP: f32 = 0.05;
/// A step up is shorter than the slope says by this factor, so that it ends below the budget.
const CAUTION: f32 = 1.5;

/// After a climb that went over the budget there is none for so long (s), twice as long each time, at most so long.
const REST_SECS: [f32; 2] = [4.0, 64.0];
/// So long over the budget at the lowest level (s), no level keeps it.
const EXHAUSTED_SECS: f32 = 2.0;
/// Costs that have fallen to this share meanwhile are another view's: it ends the rest.
const RELIEF: f32 = 0.7;

/// What is known of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameTime {
    /// Time that it kept the processor or, where that is more, the graphics device (s).
    pub work_secs: f32,
    /// Time since the frame before (s).
    pub interval_secs: f32,
    /// Whether it had to wait for the device, so that the interval is what a frame costs.
    pub waited: bool,
}

impl FrameTime {
    fn cost_secs(self) -> f32 {
        if self.waited { self.work_secs.max(self.interval_secs) } else { self.work_secs }
    }
}

/// The level of detail, steered.
#[derive(Clone, Debug)]
pub struct Budget {
    budget_secs: f32,
    highest: f32,
    goal: f32,
    shown: Damped,
    /// Frames still to be passed over.
    stale: u32,
    /// Costs of the frames at this level, and the time that they span (s).
    costs_secs: Vec<f32>,
    span_secs: f32,
    slope: f32,
    /// Level and cost (s) when the last step was taken.
    before: Option<(f32, f32)>,
    climbed: bool,
    rest: Rest,
    /// Time over the budget at the lowest level (s).
    exhausted_secs: f32,
}

/// How long there is no climb.
#[derive(Clone, Copy, Debug, Default)]
struct Rest {
    left_secs: f32,
    /// Of the rest before; 0 for none.
    last_secs: f32,
    /// What a frame cost when it began (s); 0 while that is not known.
    cost_secs: f32,
}

impl Budget {
    /// Keeps frames within `budget_secs` (above 0) by a level within 0..=`highest`, beginning at `level`.
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
            slope: FIRST_SLOPE,
            before: None,
            climbed: false,
            rest: Rest::default(),
            exhausted_secs: 0.0,
        }
    }

    /// Time that a frame may take (s).
    pub fn budget_secs(&self) -> f32 {
        self.budget_secs
    }

    /// Level of detail for the next frame.
    pub fn level(&self) -> f32 {
        self.shown.value.clamp(0.0, self.highest)
    }

    /// Whether not even the lowest level keeps the budget.
    pub fn is_exhausted(&self) -> bool {
        self.exhausted_secs >= EXHAUSTED_SECS
    }

    /// Takes in what a frame took.
    pub fn drew(&mut self, frame: FrameTime) {
        let dt_secs = frame.interval_secs.clamp(0.0, 1.0);
        self.rest.left_secs -= dt_secs;
        if (self.shown.value - self.goal).abs() > ARRIVED {
            self.shown.follow(self.goal, SLIDE_SECS[usize::from(self.goal > self.shown.value)], dt_secs);
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
        if has(HASTY) && least_secs > OVERLOAD * self.budget_secs || has(CALM) {
            self.decide();
        }
    }

    /// Steps to another level if the frames at this one ask for it.
    fn decide(&mut self) {
        let cost_secs = median(&mut self.costs_secs).max(1e-5);
        self.costs_secs.clear();
        let span_secs = std::mem::take(&mut self.span_secs);
        self.learn(cost_secs);
        let share = cost_secs / self.budget_secs;
        let is_over = share > BAND[1] && self.goal <= 0.0;
        self.exhausted_secs = if is_over { self.exhausted_secs + span_secs } else { 0.0 };
        if self.rest.cost_secs == 0.0 {
            self.rest.cost_secs = cost_secs;
        }
        let way = (AIM / share).ln() / self.slope;
        if share > BAND[1] {
            if std::mem::take(&mut self.climbed) {
                let secs = (2.0 * self.rest.last_secs).clamp(REST_SECS[0], REST_SECS[1]);
                self.rest = Rest { left_secs: secs, last_secs: secs, cost_secs: 0.0 };
            }
            self.step_to(self.goal + way.max(-STEP[0]), cost_secs);
        } else if share < BAND[0] {
            if self.rest.left_secs <= 0.0 || cost_secs < RELIEF * self.rest.cost_secs {
                self.climbed = true;
                self.step_to(self.goal + (way / CAUTION).min(STEP[1]), cost_secs);
            }
        } else {
            (self.climbed, self.rest.last_secs) = (false, 0.0);
        }
    }

    fn step_to(&mut self, goal: f32, cost_secs: f32) {
        self.before = Some((self.goal, cost_secs));
        self.goal = goal.clamp(0.0, self.highest);
        self.stale = STALE;
    }

    /// Learns how the cost grows with the level from the step that led to this cost.
    fn learn(&mut self, cost_secs: f32) {
        let Some((level, before_secs)) = self.before.take() else { return };
        let step = self.goal - level;
        if step.abs() >= TELLING_STEP {
            let slope = (cost_secs / before_secs).ln() / step;
            self.slope += SLOPE_SHARE * (slope.clamp(SLOPES[0], SLOPES[1]) - self.slope);
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
    use shared::hash::hash3;

    /// A device that draws level 0 in `least_secs` and each level more e^`slope` as long, some frames more or less by `noise`.
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

        /// Lets frames be drawn for so long; gives the time and level of each.
        fn draw(self, budget: &mut Budget, secs: f32) -> Vec<(f32, f32)> {
            let (mut time_secs, mut frames, mut pipeline) = (0.0, Vec::new(), [budget.level(); 2]);
            while time_secs < secs {
                // Times that are told are those of frames asked for a while ago.
                let [level, next] = pipeline;
                pipeline = [next, budget.level()];
                let [lot, ..] = hash3([7, frames.len() as u32, 3]).map(|bits| bits as f32 / u32::MAX as f32);
                let work_secs = self.cost_secs(level) * (1.0 + self.noise * (2.0 * lot - 1.0));
                let interval_secs = (work_secs / self.refresh_secs).ceil() * self.refresh_secs;
                time_secs += interval_secs;
                budget.drew(FrameTime { work_secs, interval_secs, waited: false });
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
    fn every_device_ends_within_a_tenth_of_the_budget_and_stays() {
        for budget_secs in [BUDGET_SECS, 0.1] {
            for slope in [0.3, 0.7, 1.0, 1.5, 2.5] {
                for begin in [0.0, 1.5, 3.0] {
                    for wanted in [0.4, 1.3, 2.6] {
                        let device = Device { slope, ..DEVICE };
                        let device = Device { least_secs: 0.95 * budget_secs / device.cost_secs(wanted) * device.least_secs, ..device };
                        // Slower ones than a frame a second need more time than there is here.
                        let mut budget = Budget::new(budget_secs, device.level_of(1.0).min(begin), 3.0);
                        device.draw(&mut budget, 40.0);
                        let frames = device.draw(&mut budget, 40.0);
                        let share = device.cost_secs(budget.level()) / budget_secs;
                        assert!((0.9..=1.0).contains(&share), "{share} of {budget_secs} s, slope {slope}, from {begin} to {wanted}");
                        assert!(spread(&frames) < 0.05, "{} of {budget_secs} s, slope {slope}, from {begin}", spread(&frames));
                    }
                }
            }
        }
    }

    #[test]
    fn a_fast_device_ends_at_the_highest_level_and_a_slow_one_at_the_lowest() {
        let mut budget = Budget::new(BUDGET_SECS, 1.5, 2.0);
        Device { least_secs: 0.001, ..DEVICE }.draw(&mut budget, 30.0);
        assert!(budget.level() == 2.0 && !budget.is_exhausted());
        Device { least_secs: 0.012, ..DEVICE }.draw(&mut budget, 30.0);
        assert!(!budget.is_exhausted());
        Device { least_secs: 0.2, ..DEVICE }.draw(&mut budget, 10.0);
        assert!(budget.level() == 0.0 && budget.is_exhausted());
        Device { least_secs: 0.012, ..DEVICE }.draw(&mut budget, 10.0);
        assert!(!budget.is_exhausted());
    }

    #[test]
    fn overload_is_answered_within_two_seconds_and_relief_slowly() {
        for (slope, refresh_secs, budget_secs) in [(0.7, 1.0 / 60.0, BUDGET_SECS), (1.0, 1.0 / 144.0, BUDGET_SECS), (1.4, 1.0 / 60.0, 0.1)]
        {
            let calm = Device { slope, refresh_secs, least_secs: 0.95 * budget_secs / (2.5 * slope).exp(), ..DEVICE };
            let mut budget = Budget::new(budget_secs, 2.5, 3.0);
            calm.draw(&mut budget, 10.0);
            let loaded = Device { least_secs: 3.0 * calm.least_secs, ..calm };
            loaded.draw(&mut budget, 2.0);
            let share = loaded.cost_secs(budget.level()) / budget_secs;
            assert!(share < 1.2, "{share} of the budget two seconds after the load, slope {slope}");
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
    fn noise_moves_the_level_little() {
        for (budget_secs, noise) in [(BUDGET_SECS, 0.1), (BUDGET_SECS, 0.4), (0.1, 0.1), (0.1, 0.3)] {
            let device = Device { noise, least_secs: 0.95 * budget_secs / (1.5_f32).exp(), ..DEVICE };
            let mut budget = Budget::new(budget_secs, 0.0, 3.0);
            device.draw(&mut budget, 30.0);
            let frames = device.draw(&mut budget, 120.0);
            assert!(spread(&frames) < 0.1 + noise, "{} of a level by {noise} noise", spread(&frames));
            assert!(turns(&frames) < 60, "{} turns in two minutes", turns(&frames));
        }
    }

    #[test]
    fn a_cost_that_jumps_is_not_climbed_again_and_again() {
        // Above level 1 everything costs four times as much.
        let mut budget = Budget::new(BUDGET_SECS, 0.5, 3.0);
        let mut ups = 0;
        let mut was_up = false;
        for _ in 0..60 * 300 {
            let work_secs = if budget.level() > 1.0 { 0.028 } else { 0.007 };
            budget.drew(FrameTime { work_secs, interval_secs: 1.0 / 60.0, waited: false });
            let is_up = budget.level() > 1.0;
            ups += usize::from(is_up && !was_up);
            was_up = is_up;
        }
        assert!((1..=10).contains(&ups), "{ups} climbs in five minutes");
    }

    #[test]
    fn one_slow_frame_changes_nothing() {
        let device = Device { least_secs: 0.95 * BUDGET_SECS / (1.5_f32).exp(), ..DEVICE };
        let mut budget = Budget::new(BUDGET_SECS, 1.5, 3.0);
        device.draw(&mut budget, 5.0);
        let level = budget.level();
        budget.drew(FrameTime { work_secs: 0.4, interval_secs: 0.4, waited: true });
        let frames = device.draw(&mut budget, 3.0);
        assert!(spread(&frames) < 0.02 && (budget.level() - level).abs() < 0.02);
    }

    #[test]
    fn a_frame_that_waited_costs_its_interval() {
        let mut budget = Budget::new(BUDGET_SECS, 2.0, 3.0);
        for _ in 0..60 {
            budget.drew(FrameTime { work_secs: 0.01, interval_secs: 0.05, waited: true });
        }
        assert!(budget.level() < 1.0, "{}", budget.level());
    }
}
