//! Error of the time step of the wind, estimated by step halving (Hairer et al. 1993, section II.4): now and then a copy of the air takes a step of
//! twice the length, or two of half the length, beside those of the air itself.
//!
//! The difference D of both winds after the same time is half the error of the longer step where its error is of first order, as in a split step; for
//! second order 2·D overestimates it by half. Copies change nothing in the air.

use super::{Weather, WeatherError, initial_air};
use glam::Vec3;
use prairie_core::terrain::HeightMap;
use prairie_wind::{Air, AirState, Jet};

/// Time between two samples (s).
const SAMPLE_SECS: f64 = 1.0;

/// Error of a step over the difference of the wind after it and after two steps of half the length, for a method of first order.
const RICHARDSON: f64 = 2.0;

/// Growth of the error (m/s per s) that stands for steps that fail.
const FAILED_M_PER_S2: f64 = 1e3;

/// Estimated growth of the error of the horizontal wind of the lowest cells, root mean square.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepErrors {
    /// With the present step.
    pub present: StepErrorEstimate,
    /// With steps twice as long.
    pub doubled: StepErrorEstimate,
}

/// Estimate of an error.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepErrorEstimate {
    /// Growth of the error (m/s per s); `None` where nothing is known.
    pub m_per_s2: Option<f64>,
    /// Number of samples so far.
    pub samples: u64,
}

/// What the copy does.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Trial {
    /// Two steps of half the length.
    Halved,
    /// One step of twice the length.
    Doubled,
}

/// Estimator of the error of the time step.
pub(super) struct StepHalving {
    air: Air<f32>,
    copied: AirState<f32>,
    /// The trial to compare after this many steps of the air, and its wind.
    waiting: Option<(Trial, u32, Vec<Vec3>)>,
    last: Trial,
    next_tick: u64,
    errors: StepErrors,
}

impl StepHalving {
    /// An estimator for `weather`; its copy of the air takes as much memory as the air.
    ///
    /// # Errors
    /// As for the weather.
    pub(super) fn new(weather: &Weather, height: &HeightMap) -> Result<Self, WeatherError> {
        Ok(Self {
            air: initial_air(weather.method, &weather.config, &weather.terrain, &weather.solids, height)?,
            copied: AirState::default(),
            waiting: None,
            last: Trial::Doubled,
            next_tick: 0,
            errors: StepErrors::default(),
        })
    }

    pub(super) fn errors(&self) -> StepErrors {
        self.errors
    }

    /// Keeps of the estimates what follows for a step `factor` times as long, with errors of first order.
    pub(super) fn change_step(&mut self, factor: f64) {
        let StepErrors { present, doubled } = &mut self.errors;
        (present.m_per_s2, doubled.m_per_s2) = if factor >= 2.0 {
            (doubled.m_per_s2.map(|rate| 0.5 * factor * rate), None)
        } else {
            (present.m_per_s2.map(|rate| factor * rate), present.m_per_s2.filter(|_| factor == 0.5))
        };
        self.discard();
    }

    /// Discards the sample that waits.
    pub(super) fn discard(&mut self) {
        self.waiting = None;
    }

    /// The air is at rest, where no step errs.
    pub(super) fn rest(&mut self) {
        self.discard();
        (self.errors.present.m_per_s2, self.errors.doubled.m_per_s2) = (Some(0.0), Some(0.0));
    }

    /// Begins a sample where one is due, before a step of the weather's air from `secs` of its intensities on.
    pub(super) fn begin(&mut self, weather: &Weather, tick: u64, secs: f64, jets: &[Jet]) {
        if self.waiting.is_some() || tick < self.next_tick {
            return;
        }
        let ticks_per_sample = (SAMPLE_SECS * weather.ticks_per_step as f64 / weather.step_secs).ceil() as u64;
        self.next_tick = tick + ticks_per_sample;
        self.last = if self.last == Trial::Halved { Trial::Doubled } else { Trial::Halved };
        weather.air.save_into(&mut self.copied);
        let (count, step_secs, steps_of_the_air) = match self.last {
            Trial::Halved => (2, 0.5 * weather.step_secs, 1),
            Trial::Doubled => (1, 2.0 * weather.step_secs, 2),
        };
        match self.wind_after(weather, count, step_secs, secs, jets) {
            Some(velocities) => self.waiting = Some((self.last, steps_of_the_air, velocities)),
            None if self.last == Trial::Doubled => self.note(Trial::Doubled, FAILED_M_PER_S2),
            None => {}
        }
    }

    /// Compares the sample that is complete with a step of the weather's air.
    pub(super) fn end(&mut self, weather: &Weather) {
        let Some((_, left, _)) = &mut self.waiting else { return };
        *left -= 1;
        if *left > 0 {
            return;
        }
        let Some((trial, _, velocities)) = self.waiting.take() else { return };
        let secs = if trial == Trial::Halved { weather.step_secs } else { 2.0 * weather.step_secs };
        let difference_m_per_s = lowest_difference(weather.config.cells, &weather.velocities(), &velocities);
        self.note(trial, RICHARDSON * difference_m_per_s / secs);
    }

    /// Wind above the ground after steps of the copied air (m/s); `None` where one fails.
    fn wind_after(&mut self, weather: &Weather, count: u32, step_secs: f64, secs: f64, jets: &[Jet]) -> Option<Vec<Vec3>> {
        self.air.restore(&self.copied).ok()?;
        self.air.set_bodies(&weather.bodies).ok()?;
        for step in 0..count {
            self.air.set_intensity_secs(secs + f64::from(step) * step_secs);
            self.air.step(step_secs, jets).ok()?;
        }
        Some(weather.terrain.above_ground(self.air.cell_velocities().collect(), Vec3::lerp))
    }

    fn note(&mut self, trial: Trial, m_per_s2: f64) {
        let estimate = match trial {
            Trial::Halved => &mut self.errors.present,
            Trial::Doubled => &mut self.errors.doubled,
        };
        *estimate = StepErrorEstimate { m_per_s2: Some(m_per_s2.min(FAILED_M_PER_S2)), samples: estimate.samples + 1 };
    }
}

/// Root mean square difference of the horizontal wind in the lowest layer of cells, x fastest, then y, then z (m/s).
fn lowest_difference([nx, ny, nz]: [usize; 3], one: &[Vec3], other: &[Vec3]) -> f64 {
    let lowest = (0..nz).flat_map(|k| (0..nx).map(move |i| i + nx * ny * k));
    let squares = lowest.map(|at| {
        let [u, w] = [one[at].x - other[at].x, one[at].z - other[at].z].map(f64::from);
        u * u + w * w
    });
    (squares.sum::<f64>() / (nx * nz) as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use prairie_core::random::SplitMix64;
    use prairie_core::scene::{WindAdvection, WindTime};

    /// A wind of random strength, gusts, schemes and step, after a random time.
    fn random_weather(random: &mut SplitMix64) -> Weather {
        let loaded = crate::scenes::load("meadow").unwrap();
        let mut scene = loaded.scene.clone();
        let mut between = |low: f64, high: f64| low + (high - low) * random.unit();
        let wind = &mut scene.wind;
        (wind.cells, wind.spacing_m) = ([16, 8, 16], [16.0, 4.0, 16.0]);
        wind.dust.release_per_s = 0.0;
        wind.mean_m_per_s = [between(-12.0, 12.0) as f32, between(-12.0, 12.0) as f32];
        (wind.sources, wind.source_m_per_s) = (between(1.0, 20.0) as u32, between(0.5, 6.0) as f32);
        wind.step_secs = between(0.02, 0.2) as f32;
        let pairs: Vec<_> = WindAdvection::ALL
            .iter()
            .flat_map(|advection| WindTime::ALL.iter().map(move |time| (*advection, *time)))
            .filter(|(advection, time)| time.allows(*advection))
            .collect();
        (wind.advection, wind.time) = pairs[between(0.0, pairs.len() as f64) as usize];
        scene.seed = between(0.0, 1e6) as u64;
        let steps = between(4.0, 20.0) as usize;
        Weather::after(&scene, &loaded.height, &loaded.cover, (steps, 0.1)).unwrap()
    }

    #[test]
    fn the_estimate_is_within_a_factor_of_three_in_950_of_1000_random_states() {
        let (mut random, height) = (SplitMix64::new(3), crate::scenes::load("meadow").unwrap().height);
        let mut ratios = Vec::new();
        for _ in 0..1000 {
            let weather = random_weather(&mut random);
            let mut halving = StepHalving::new(&weather, &height).unwrap();
            weather.air.save_into(&mut halving.copied);
            let mut after = |count: u32| halving.wind_after(&weather, count, weather.step_secs / f64::from(count), 0.0, &[]).unwrap();
            let [whole, halves, reference] = [1, 2, 16].map(&mut after);
            let apart = |one, other| lowest_difference(weather.config.cells, one, other);
            ratios.push((RICHARDSON * apart(&whole, &halves) / apart(&whole, &reference), weather.config.advection, weather.config.time));
        }
        let within = |factor: f64| ratios.iter().filter(|(ratio, ..)| (1.0 / factor..=factor).contains(ratio)).count();
        let outside: Vec<_> = ratios.iter().filter(|(ratio, ..)| !(1.0 / 3.0..=3.0).contains(ratio)).take(20).collect();
        println!("{} within a factor 3, {} within 1.2; outside: {outside:?}", within(3.0), within(1.2));
        assert!(within(3.0) >= 950, "{}", within(3.0));
        // Control: estimates of a tenth of the difference.
        let tenths = ratios.iter().filter(|(ratio, ..)| (1.0 / 3.0..=3.0).contains(&(0.1 * ratio))).count();
        assert!(tenths < 950, "{tenths} tenths of the estimates are as good");
    }
}
