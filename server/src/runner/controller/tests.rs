use super::*;
use crate::detail::WindDemand;

/// A world whose ticks take a time that follows from its detail (ms).
struct Plant {
    controller: Controller,
    detail: Detail,
    own: Detail,
    now: Duration,
    tick: u32,
    decisions: Vec<(Duration, Decision)>,
    /// Mean time a tick of the wind, of publications and of all awake patches (ms).
    costs_ms: [f64; 3],
    diagnostics: Diagnostics,
}

const AWAKE: u32 = 400;

impl Plant {
    fn new(server_ms: f32, wind: Option<WindDemand>) -> Self {
        let own = Detail { wind_ticks: 2, awake_limit: 4096, publish_divisor: 1 };
        let range = DetailRange { wind_ticks: vec![1, 2, 4, 8, 16], own, tick_secs: 1.0 / 60.0, may_halve_publications: true };
        let demands = Demands { wind, server_ms, ..Demands::default() };
        Self {
            controller: Controller::new(demands, range, None),
            detail: own,
            own,
            now: Duration::ZERO,
            tick: 0,
            decisions: vec![],
            costs_ms: [0.3, 0.2, 0.5],
            diagnostics: Diagnostics { awake_patches: AWAKE, ..Diagnostics::default() },
        }
    }

    /// Mean time of a tick (ms).
    fn mean_ms(&self) -> f64 {
        let [wind, publications, grass] = self.costs_ms;
        let Detail { wind_ticks, awake_limit, publish_divisor } = self.detail;
        wind * f64::from(self.own.wind_ticks) / f64::from(wind_ticks)
            + publications / f64::from(publish_divisor)
            + grass * f64::from(awake_limit.min(AWAKE)) / f64::from(AWAKE)
    }

    /// Mean time of the ticks of a publication (ms): steps of the wind come in single ticks, and once a second an estimate of its error.
    fn busy_ms(&self, ticks: u32) -> f64 {
        let [wind, publications, grass] = self.costs_ms;
        let step_ms = wind * f64::from(self.own.wind_ticks);
        let wind_steps = (self.tick + 1..=self.tick + ticks).filter(|tick| tick.is_multiple_of(self.detail.wind_ticks)).count() as f64;
        let estimates = (self.tick + 1..=self.tick + ticks).filter(|tick| tick.is_multiple_of(60)).count() as f64;
        let grass_ms = grass * f64::from(self.detail.awake_limit.min(AWAKE)) / f64::from(AWAKE);
        (step_ms * (wind_steps + estimates) + 3.0 * publications) / f64::from(ticks) + grass_ms
    }

    /// Runs for a time; twenty publications a second at most.
    fn run(&mut self, secs: f64) {
        let until = self.now + Duration::from_secs_f64(secs);
        while self.now < until {
            let ticks = 3 * self.detail.publish_divisor;
            let busy_ms = self.busy_ms(ticks);
            self.tick += ticks;
            self.now += Duration::from_secs_f64(f64::from(ticks) / 60.0);
            self.diagnostics.awake_patches = AWAKE.min(self.detail.awake_limit);
            self.diagnostics.wind_step_secs = self.detail.wind_ticks as f32 / 60.0;
            if let Some(decision) = self.controller.decide(self.now, self.tick.into(), ticks, busy_ms, &self.diagnostics) {
                self.detail = decision.detail;
                self.decisions.push((self.now, decision));
            }
        }
    }

    fn levels(&self) -> Vec<u8> {
        self.decisions.iter().map(|(_, decision)| decision.level).collect()
    }
}

#[test]
fn half_the_budget_is_kept_within_two_seconds() {
    for costs_ms in [[0.3, 0.2, 0.5], [0.6, 0.2, 0.2], [0.1, 0.2, 0.7]] {
        let mut plant = Plant { costs_ms, ..Plant::new(1.15, None) };
        plant.run(10.0);
        assert_eq!(plant.decisions, [], "nothing changes within the budget");
        plant.controller.set_budget(0.575);
        plant.run(2.0);
        assert!(plant.mean_ms() <= 0.575, "{costs_ms:?}: {} ms, {:?}", plant.mean_ms(), plant.detail);
        assert!(plant.levels().is_sorted() && !plant.levels().is_empty(), "{:?}", plant.levels());
        let settled = plant.levels();
        plant.run(4.0);
        assert_eq!(plant.levels(), settled, "the level is kept");
        // Without the controller the same world needs twice the budget.
        plant.detail = plant.own;
        assert!(plant.mean_ms() > 0.95, "{costs_ms:?}");
    }
}

#[test]
fn what_gives_way_comes_in_the_stated_order_and_comes_back_in_reverse() {
    let mut plant = Plant::new(0.01, None);
    plant.run(3.0);
    assert_eq!(plant.levels(), [1, 2, 3, 4, 5], "all gives way, and no more");
    let details: Vec<_> = plant.decisions.iter().map(|(_, decision)| decision.detail).collect();
    let detail = |wind_ticks, awake_limit, publish_divisor| Detail { wind_ticks, awake_limit, publish_divisor };
    let awake = plant.own.awake_limit;
    assert_eq!(details, [detail(4, awake, 1), detail(4, awake, 2), detail(4, 200, 2), detail(8, 200, 2), detail(8, 100, 2)]);
    plant.controller.set_budget(10.0);
    plant.run(60.0);
    assert_eq!(plant.levels()[5..], [4, 3, 2, 1, 0]);
    assert_eq!(plant.detail, plant.own);
}

#[test]
fn a_level_that_was_needed_is_kept_for_longer_each_time() {
    // Below 0.6 of the budget with the first level, above it without.
    let mut plant = Plant { costs_ms: [1.0, 0.0, 0.0], ..Plant::new(0.95, None) };
    plant.run(600.0);
    let changes = plant.decisions.len();
    assert!((4..40).contains(&changes), "{changes} changes in ten minutes");
    let times: Vec<_> = plant.decisions.iter().filter(|(_, decision)| decision.level == 0).map(|(now, _)| now.as_secs_f64()).collect();
    let waits: Vec<_> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    assert!(waits[0] < 15.0 && waits.iter().any(|wait| *wait > 60.0), "{waits:?}");
}

#[test]
fn calm_wind_is_stepped_rarely_and_stirred_wind_often() {
    let wind = WindDemand { tolerance: 0.05, planned: 0.04, rms_m_per_s: 5.0 };
    assert!((wind.allowed() - 0.03).abs() < 1e-6);
    let mut plant = Plant::new(2.5, Some(wind));
    // The error of a step is proportional to its length, and to how much the wind changes.
    let blow = |plant: &mut Plant, per_tick: f32, secs: u32| {
        for _ in 0..secs {
            let present = per_tick * plant.detail.wind_ticks as f32 * wind.rms_m_per_s;
            (plant.diagnostics.wind_step_error_m_per_s, plant.diagnostics.wind_doubled_error_m_per_s) = (present, 2.0 * present);
            plant.diagnostics.wind_step_samples += 1;
            plant.diagnostics.wind_doubled_samples += 1;
            plant.run(1.0);
        }
        plant.detail.wind_ticks
    };
    assert_eq!(blow(&mut plant, 0.005, 10), 2, "2 % with steps twice as long is more than half of 3 %");
    assert_eq!(blow(&mut plant, 0.001, 20), 8, "1.6 % with 16 ticks");
    let control = plant.controller.report(&plant.diagnostics);
    assert!((control.wind_error.unwrap() - f32::hypot(0.04, 0.008)).abs() < 1e-4, "{control:?}");
    assert_eq!(blow(&mut plant, 0.01, 10), 2, "the scene's own step at most errs as planned");
    assert_eq!(blow(&mut plant, 0.03, 10), 1, "6 % is more than the scene allows");
    assert!(plant.decisions.iter().all(|(_, decision)| decision.level == 0));
    // The load decides first.
    plant.controller.set_budget(0.5);
    plant.run(2.0);
    assert!(plant.detail.wind_ticks > 1, "{:?}", plant.detail);
}

#[test]
fn a_controller_goes_on_where_the_world_is() {
    let mut plant = Plant::new(0.01, None);
    plant.run(3.0);
    let newest = plant.decisions.last().map(|(_, decision)| *decision);
    let range = DetailRange { wind_ticks: vec![1, 2, 4, 8, 16], own: plant.own, tick_secs: 1.0 / 60.0, may_halve_publications: true };
    let resumed = Controller::new(Demands { server_ms: 10.0, ..Demands::default() }, range, newest);
    assert_eq!(resumed.detail(resumed.level), plant.detail);
    assert_eq!((resumed.detail(0).wind_ticks, resumed.awake_before), (2, Some(AWAKE)), "what comes back is known");
}
