//! Winds of simple shape: uniform, source, sink, vortex (Wejchert & Haumann, SIGGRAPH 1991), and the cyclone (001 §5.3), superposed.

use super::config::{ConfigError, above_zero, at_least_zero, check};
use super::footprint::Footprint;
use super::{Field, Grid, Real, Velocity};

/// Rate (1/s) at which a primitive drives the air at its centre towards its own velocity.
const RATE_PER_SEC: f64 = 2.0;
/// Greatest radial speed around a source of divergence 1/s and radius 1 m in open air.
const SPEED_OF_SOURCE: f64 = 0.12;
/// Share of a cyclone's speed that blows inwards along the ground, and upwards in its middle.
const INWARDS: f64 = 0.5;
const UPWARDS: f64 = 0.7;

/// The shape of a primitive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// Air driven one way.
    Uniform,
    /// Air comes into being and blows outwards.
    Source,
    /// Air flows inwards and is gone.
    Sink,
    /// Air circles about a vertical axis, against the clock seen from above.
    Vortex,
    /// A vortex that draws air in along the ground and lifts it in its middle.
    Cyclone,
}

/// A wind of simple shape somewhere in the box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Primitive {
    /// What it does.
    pub shape: Shape,
    /// Its centre (m) at the start; wrapped axes take its nearest image.
    pub position_m: [f32; 3],
    /// Velocity (m/s) along x and z at which it travels, −200 to 200. On axes that do not wrap it leaves the box.
    pub drift_m_per_s: [f32; 2],
    /// Distance (m) along each axis from which on it does nothing; above 0.
    pub radius_m: f32,
    /// Greatest speed (m/s) of the air it aims at; 0 or more. That of a source or sink is reached within a fifth in open air; where walls hem it in, air blows faster.
    pub speed_m_per_s: f32,
    /// Direction along x and z that a uniform wind blows in; of length 1.
    pub direction: [f32; 2],
    /// Share of the dust that a gust source releases; 0 to 1.
    pub dust: f32,
}

impl Primitive {
    pub(super) fn validate(&self, path: &str) -> Result<(), ConfigError> {
        for axis in 0..3 {
            let at = self.position_m[axis];
            check(at.abs() <= 1.0e6, format!("{path}.position_m[{axis}]"), at, "-1e6 to 1e6")?;
        }
        for (index, speed) in self.drift_m_per_s.into_iter().enumerate() {
            check(speed.abs() <= 200.0, format!("{path}.drift_m_per_s[{index}]"), speed, "-200 to 200")?;
        }
        above_zero(&format!("{path}.radius_m"), self.radius_m)?;
        at_least_zero(&format!("{path}.speed_m_per_s"), self.speed_m_per_s)?;
        check(self.speed_m_per_s <= 200.0, format!("{path}.speed_m_per_s"), self.speed_m_per_s, "0 to 200")?;
        let [x, z] = self.direction.map(f64::from);
        let unit = (x * x + z * z - 1.0).abs() < 1e-3 || self.shape != Shape::Uniform;
        check(unit, format!("{path}.direction"), format!("{:?}", self.direction), "a vector of length 1")?;
        check((0.0..=1.0).contains(&self.dust), format!("{path}.dust"), self.dust, "0 to 1")
    }

    /// True for what adds or removes air.
    pub fn is_source(&self) -> bool {
        matches!(self.shape, Shape::Source | Shape::Sink)
    }

    fn centre_m<R: Real>(&self, time_secs: f64) -> [R; 3] {
        let [x, y, z] = self.position_m.map(f64::from);
        let [drift_x, drift_z] = self.drift_m_per_s.map(f64::from);
        [x + drift_x * time_secs, y, z + drift_z * time_secs].map(R::of)
    }

    /// The velocity (m/s) it aims at, at an offset (m) from its centre.
    fn target(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let speed = f64::from(self.speed_m_per_s);
        let core_m = 0.5 * f64::from(self.radius_m);
        let share = (x * x + z * z).sqrt() / core_m;
        // Speed over distance of a smooth vortex: fastest at the core's rim.
        let spin = 2.0 * speed / (core_m * (1.0 + share * share));
        match self.shape {
            Shape::Uniform => [f64::from(self.direction[0]) * speed, 0.0, f64::from(self.direction[1]) * speed],
            Shape::Vortex => [spin * z, 0.0, -spin * x],
            Shape::Cyclone => {
                let inwards = if y < 0.0 { INWARDS * spin } else { 0.0 };
                let lift = UPWARDS * speed / (1.0 + share * share * share * share);
                [spin * z - inwards * x, lift, -spin * x - inwards * z]
            }
            Shape::Source | Shape::Sink => [0.0; 3],
        }
    }

    /// Share of its volume that a cell at the centre of a source blows out in a second.
    fn divergence_per_sec(&self) -> f64 {
        f64::from(self.speed_m_per_s) / (SPEED_OF_SOURCE * f64::from(self.radius_m))
    }

    /// Drives the air for a step of backward Euler, which never overshoots, about the place it has at `time_secs`.
    pub fn drive<R: Real>(&self, grid: &Grid<R>, time_secs: f64, dt_secs: f64, velocity: &mut Velocity<R>, footprint: &mut Footprint<R>) {
        if self.shape == Shape::Source {
            return;
        }
        let share = R::of(RATE_PER_SEC * dt_secs / (1.0 + RATE_PER_SEC * dt_secs));
        let gone = R::of(self.divergence_per_sec() * dt_secs);
        for (axis, field) in velocity.0.iter_mut().enumerate() {
            footprint.put(grid, field.place, self.centre_m(time_secs), [R::of(self.radius_m.into()); 3]);
            footprint.for_each(grid, field, |speed, weight, offset_m| {
                if self.shape == Shape::Sink {
                    // Air that goes takes its momentum with it.
                    *speed = *speed / (R::one() + weight * gone);
                    return;
                }
                let target = R::of(self.target(offset_m.map(R::wide))[axis]);
                *speed = *speed + weight * share * (target - *speed);
            });
        }
    }

    /// Adds what a source blows out of each cell (1/s; one number per cell, x fastest).
    pub fn blow<R: Real>(&self, grid: &Grid<R>, time_secs: f64, inflow: &mut [f64], footprint: &mut Footprint<R>) {
        let sign = match self.shape {
            Shape::Source => 1.0,
            Shape::Sink => -1.0,
            _ => return,
        };
        let divergence = sign * self.divergence_per_sec();
        footprint.put(grid, super::Place::Centre, self.centre_m(time_secs), [R::of(self.radius_m.into()); 3]);
        footprint.for_each_index(|[i, j, k], weight| inflow[i + grid.cells[0] * (j + grid.cells[1] * k)] += weight.wide() * divergence);
    }

    /// Releases dust for a step, `release_per_sec` at the centre.
    pub fn release<R: Real>(
        &self,
        grid: &Grid<R>,
        time_secs: f64,
        release_per_sec: f64,
        dt_secs: f64,
        dust: &mut Field<R>,
        footprint: &mut Footprint<R>,
    ) {
        let gain = R::of(f64::from(self.dust) * release_per_sec * dt_secs);
        if gain > R::zero() {
            footprint.put(grid, dust.place, self.centre_m(time_secs), [R::of(self.radius_m.into()); 3]);
            footprint.for_each(grid, dust, |density, weight, _| *density = *density + weight * gain);
        }
    }
}
