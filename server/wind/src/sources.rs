//! Gusts: random sources of momentum (Zhang §2.3.1).
//!
//! The sources are a function of settings and time alone, so a checkpoint does not contain them. Source `n` is reborn elsewhere after each life; the
//! sources have different phases.

use super::config::{Config, Gusts};
use super::footprint::Footprint;
use super::profile::MeanWind;
use super::{Field, Grid, Real, Velocity};
use rand_xoshiro::SplitMix64;
use rand_xoshiro::rand_core::{Rng, SeedableRng};

/// A source at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Source {
    /// Centre (m), not wrapped into the box.
    pub position_m: [f64; 3],
    /// The acceleration of the air at its centre (m/s²).
    pub push_m_per_s2: [f64; 3],
    /// Strength relative to its peak.
    pub level: f64,
}

/// Envelope of a gust over its life: a linear rise from 0 to 1 at `attack`, then a parabolic decay to 0 (Bakay §3.2).
pub fn envelope(age: f64, attack: f64) -> f64 {
    if age < attack {
        age / attack
    } else {
        let left = (1.0 - age) / (1.0 - attack);
        left * left
    }
}

/// Integral of [`envelope`] over a unit life.
pub fn envelope_area(attack: f64) -> f64 {
    attack / 2.0 + (1.0 - attack) / 3.0
}

/// The sources alive at a time (s) since the start.
pub fn sources_at<R: Real>(config: &Config, grid: &Grid<R>, mean: &MeanWind, time_secs: f64) -> impl Iterator<Item = Source> {
    let Gusts { number, strength_m_per_s, life_secs, attack, .. } = config.gusts;
    let (life, attack) = (f64::from(life_secs), f64::from(attack));
    let peak = f64::from(strength_m_per_s) / (life * envelope_area(attack));
    (0..number).map(move |n| {
        let lives = time_secs / life + Random::new([config.seed, n as u64, u64::MAX]).unit();
        let age = lives.fract();
        let mut random = Random::new([config.seed, n as u64, lives as u64]);
        let birth: [f64; 3] = std::array::from_fn(|axis| random.unit() * grid.extent_m(axis).wide());
        let drift = mean.at(birth[1]).map(|speed| speed * age * life);
        let level = envelope(age, attack);
        let [x, z] = random.in_disc();
        Source {
            position_m: [birth[0] + drift[0], birth[1], birth[2] + drift[2]],
            push_m_per_s2: [x * peak * level, 0.0, z * peak * level],
            level,
        }
    })
}

/// Accelerations (m/s²) of faces by all sources, computed once for both halves of a step.
#[derive(Clone, Debug)]
pub struct Pushes<R> {
    /// Index in memory and acceleration along x and z; a face may appear more than once.
    on: [(usize, Vec<(usize, R)>); 2],
}

impl<R: Real> Pushes<R> {
    /// No accelerations, with memory for those of all sources.
    pub fn new(grid: &Grid<R>, gusts: &Gusts) -> Self {
        let faces: usize = (0..3).map(|axis| Footprint::largest(grid, axis, gusts.radius_m[axis].into())).product();
        Self { on: [0, 2].map(|axis| (axis, Vec::with_capacity(gusts.number * faces))) }
    }

    /// Memory (bytes).
    pub fn memory_bytes(&self) -> usize {
        self.on.iter().map(|(_, on)| on.capacity() * size_of::<(usize, R)>()).sum()
    }

    /// Computes the accelerations of `sources`.
    pub fn set(
        &mut self,
        grid: &Grid<R>,
        gusts: &Gusts,
        sources: impl Iterator<Item = Source>,
        velocity: &Velocity<R>,
        footprint: &mut Footprint<R>,
    ) {
        self.on.iter_mut().for_each(|(_, on)| on.clear());
        for source in sources {
            for (axis, on) in &mut self.on {
                let push = R::of(source.push_m_per_s2[*axis]);
                if push != R::zero() {
                    footprint.put(grid, velocity.0[*axis].location, source.position_m.map(R::of), gusts.radius_m.map(|r| R::of(r.into())));
                    footprint.for_each_index(|index, weight, _| on.push((grid.at(index), weight * push)));
                }
            }
        }
    }

    /// Applies the accelerations for `dt_secs` (s).
    pub fn apply(&self, dt_secs: f64, velocity: &mut Velocity<R>) {
        let dt = R::of(dt_secs);
        for (axis, on) in &self.on {
            let data = &mut velocity.0[*axis].data;
            on.iter().for_each(|&(at, push)| data[at] = data[at] + dt * push);
        }
    }
}

/// Releases dust at a source for a step, at `release_per_s` times its strength.
pub fn release<R: Real>(
    grid: &Grid<R>,
    gusts: &Gusts,
    source: &Source,
    release_per_s: f64,
    dt_secs: f64,
    dust: &mut Field<R>,
    footprint: &mut Footprint<R>,
) {
    let gain = R::of(source.level * release_per_s * dt_secs);
    footprint.put(grid, dust.location, source.position_m.map(R::of), gusts.radius_m.map(|r| R::of(r.into())));
    footprint.for_each(grid, dust, |density, weight, _| *density = *density + weight * gain);
}

/// SplitMix64 generator seeded from a key (Steele et al. 2014).
struct Random(SplitMix64);

impl Random {
    fn new(key: [u64; 3]) -> Self {
        Self(SplitMix64::seed_from_u64(key.into_iter().fold(0, |bits, part| SplitMix64::seed_from_u64(bits ^ part).next_u64())))
    }

    /// Uniform in [0, 1).
    fn unit(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Uniform in the disc of radius 1.
    fn in_disc(&mut self) -> [f64; 2] {
        loop {
            let point = [2.0 * self.unit() - 1.0, 2.0 * self.unit() - 1.0];
            if point[0] * point[0] + point[1] * point[1] <= 1.0 {
                return point;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn envelope_has_the_stated_area() {
        let attack = 0.15;
        let n = 100_000;
        let area: f64 = (0..n).map(|i| envelope((i as f64 + 0.5) / n as f64, attack)).sum::<f64>() / n as f64;
        assert!((area - envelope_area(attack)).abs() < 1e-6);
        assert_eq!(envelope(attack, attack), 1.0);
        assert!(envelope(attack / 2.0, attack) >= 0.5 && envelope(0.9, attack) < 0.02);
    }

    #[test]
    fn sources_depend_on_seed_and_time_only() {
        let config = Config::default();
        let (grid, mean) = (config.grid::<f32>(), MeanWind::new(&config));
        let at = |config: &Config, time| sources_at(config, &grid, &mean, time).collect::<Vec<_>>();
        assert_eq!(at(&config, 12.5), at(&config, 12.5));
        assert_ne!(at(&config, 12.5), at(&Config { seed: 2, ..config.clone() }, 12.5));
        assert_eq!(at(&config, 0.0).len(), config.gusts.number);
    }

    #[test]
    fn a_source_delivers_its_strength_over_its_life() {
        let config = Config { gusts: Gusts { number: 1, ..Gusts::default() }, ..Config::default() };
        let (grid, mean) = (config.grid::<f32>(), MeanWind::new(&config));
        let life = f64::from(config.gusts.life_secs);
        let start = life * (1.0 - Random::new([config.seed, 0, u64::MAX]).unit());
        let n = 10_000;
        let dt = life / n as f64;
        let gained = (0..n).fold([0.0; 2], |sum: [f64; 2], i| {
            let source = sources_at(&config, &grid, &mean, start + (i as f64 + 0.5) * dt).next().unwrap();
            [sum[0] + source.push_m_per_s2[0] * dt, sum[1] + source.push_m_per_s2[2] * dt]
        });
        let speed = (gained[0] * gained[0] + gained[1] * gained[1]).sqrt();
        let mut random = Random::new([config.seed, 0, 1]);
        for _ in 0..3 {
            random.unit();
        }
        let [x, z] = random.in_disc();
        assert!((speed - f64::from(config.gusts.strength_m_per_s) * (x * x + z * z).sqrt()).abs() < 1e-3, "{speed}");
    }
}
