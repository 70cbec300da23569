//! Flow primitives: uniform flow, source, sink, vortex (Wejchert & Haumann 1991) and cyclone (Chen & Johan §5.3).

use super::config::error::{ConfigError, above_zero, at_least_zero, check};
use super::footprint::Footprint;
use super::intensity::{Front, Intensity, Moment};
use super::{Field, Grid, Real, Velocity};

/// Rate (1/s) at which a primitive relaxes the air at its centre to its own velocity.
const RATE_PER_S: f64 = 2.0;
/// Maximum radial speed (m/s) around a source of divergence 1/s and radius 1 m in open air.
const SPEED_OF_SOURCE: f64 = 0.12;
/// Inflow speed along the ground and updraught in the core of a cyclone, relative to its speed.
const INWARDS: f64 = 0.5;
const UPWARDS: f64 = 0.7;

/// The shape of a primitive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// Uniform flow.
    Uniform,
    /// Volume source.
    Source,
    /// Volume sink.
    Sink,
    /// Rotation about a vertical axis, anticlockwise from above.
    Vortex,
    /// Vortex with inflow along the ground and an updraught in its core.
    Cyclone,
}

/// A flow primitive.
#[derive(Clone, Debug, PartialEq)]
pub struct Primitive {
    /// Kind of flow.
    pub shape: Shape,
    /// Centre (m) at the start; on periodic axes its nearest image counts.
    pub position_m: [f32; 3],
    /// Velocity (m/s) along x and z of the centre, −200 to 200. On non-periodic axes the primitive leaves the box.
    pub drift_m_per_s: [f32; 2],
    /// Half-width (m) along each axis, beyond which it has no effect; above 0.
    pub radius_m: f32,
    /// Maximum speed (m/s) of its target velocity; 0 or more. For a source or sink it is reached to within 20 % in open air; near walls the air is faster.
    pub speed_m_per_s: f32,
    /// Direction of uniform flow along x and z; a unit vector.
    pub direction: [f32; 2],
    /// Dust that it releases, relative to a gust source; 0 to 1.
    pub dust: f32,
    /// Factor of speed and dust over time. Below 1 in magnitude it reduces the rate at which the air is driven as well, so that a primitive of intensity 0 leaves the air
    /// alone. Below 0 the flow is reversed: a source takes air in. Dust is released above 0 only.
    pub intensity: Intensity,
    /// Motion of the intensity away from the centre. What the primitive does to the air is delayed with the distance; the pressure passes it on without a delay.
    pub front: Front,
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
        check((0.0..=1.0).contains(&self.dust), format!("{path}.dust"), self.dust, "0 to 1")?;
        self.intensity.validate(&format!("{path}.intensity"))?;
        self.front.validate(&format!("{path}.front"))
    }

    /// Whether it is a volume source or sink.
    pub fn is_source(&self) -> bool {
        matches!(self.shape, Shape::Source | Shape::Sink)
    }

    fn centre_m<R: Real>(&self, time_secs: f64) -> [R; 3] {
        let [x, y, z] = self.position_m.map(f64::from);
        let [drift_x, drift_z] = self.drift_m_per_s.map(f64::from);
        [x + drift_x * time_secs, y, z + drift_z * time_secs].map(R::of)
    }

    /// Target velocity (m/s) at an offset (m) from its centre.
    fn target(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let speed = f64::from(self.speed_m_per_s);
        let core_m = 0.5 * f64::from(self.radius_m);
        let fraction = (x * x + z * z).sqrt() / core_m;
        // Angular speed of a smooth vortex, which is fastest at the edge of the core.
        let spin = 2.0 * speed / (core_m * (1.0 + fraction * fraction));
        match self.shape {
            Shape::Uniform => [f64::from(self.direction[0]) * speed, 0.0, f64::from(self.direction[1]) * speed],
            Shape::Vortex => [spin * z, 0.0, -spin * x],
            Shape::Cyclone => {
                let inwards = if y < 0.0 { INWARDS * spin } else { 0.0 };
                let lift = UPWARDS * speed / (1.0 + fraction * fraction * fraction * fraction);
                [spin * z - inwards * x, lift, -spin * x - inwards * z]
            }
            Shape::Source | Shape::Sink => [0.0; 3],
        }
    }

    /// Divergence (1/s) at the centre of a source.
    fn divergence_per_s(&self) -> f64 {
        f64::from(self.speed_m_per_s) / (SPEED_OF_SOURCE * f64::from(self.radius_m))
    }

    /// Intensity at a time (s), if it is the same everywhere.
    fn even_level(&self, secs: f64) -> Option<f64> {
        (self.intensity.is_steady() || self.front.speed_m_per_s == 0.0).then(|| self.intensity.level(secs))
    }

    /// Intensity at a time (s) and an offset (m) from the centre.
    fn level_at<R: Real>(&self, secs: f64, offset_m: [R; 3]) -> f64 {
        let [x, y, z] = offset_m.map(R::wide);
        self.intensity.level(secs - self.front.delay_secs((x * x + y * y + z * z).sqrt()))
    }

    /// Drives the air by a backward Euler step, which never overshoots, around the primitive's position at `moment`.
    pub fn drive<R: Real>(&self, grid: &Grid<R>, moment: Moment, dt_secs: f64, velocity: &mut Velocity<R>, footprint: &mut Footprint<R>) {
        let even = self.even_level(moment.intensity_secs);
        let gives_air = |level: f64| match self.shape {
            Shape::Source => level >= 0.0,
            Shape::Sink => level <= 0.0,
            _ => false,
        };
        if even.is_some_and(|level| level == 0.0 || gives_air(level)) {
            return;
        }
        let fraction_of = |level: f64| {
            let reach = RATE_PER_S * level.abs().min(1.0) * dt_secs;
            (level, R::of(reach / (1.0 + reach)))
        };
        let even = even.map(fraction_of);
        for (axis, field) in velocity.0.iter_mut().enumerate() {
            footprint.put(grid, field.location, self.centre_m(moment.secs), [R::of(self.radius_m.into()); 3]);
            footprint.for_each(grid, field, |speed, weight, offset_m| {
                let (level, fraction) = even.unwrap_or_else(|| fraction_of(self.level_at(moment.intensity_secs, offset_m)));
                if matches!(self.shape, Shape::Source | Shape::Sink) {
                    // Removed air takes its momentum with it, and given air brings none.
                    if !gives_air(level) {
                        *speed = *speed / (R::one() + weight * R::of(self.divergence_per_s() * level.abs() * dt_secs));
                    }
                    return;
                }
                let target = R::of(self.target(offset_m.map(R::wide))[axis] * level);
                *speed = *speed + weight * fraction * (target - *speed);
            });
        }
    }

    /// Adds the divergence (1/s) of a source or sink to each cell, x fastest.
    pub fn add_volume_source<R: Real>(&self, grid: &Grid<R>, moment: Moment, inflow: &mut [f64], footprint: &mut Footprint<R>) {
        let sign = match self.shape {
            Shape::Source => 1.0,
            Shape::Sink => -1.0,
            _ => return,
        };
        let divergence = sign * self.divergence_per_s();
        let even = self.even_level(moment.intensity_secs);
        footprint.put(grid, super::Location::Centre, self.centre_m(moment.secs), [R::of(self.radius_m.into()); 3]);
        footprint.for_each_index(|[i, j, k], weight, offset_m| {
            let level = even.unwrap_or_else(|| self.level_at(moment.intensity_secs, offset_m));
            inflow[i + grid.cells[0] * (j + grid.cells[1] * k)] += weight.wide() * divergence * level;
        });
    }

    /// Releases dust for a step, at `release_per_s` times [`Primitive::dust`] at the centre.
    pub fn release<R: Real>(
        &self,
        grid: &Grid<R>,
        moment: Moment,
        release_per_s: f64,
        dt_secs: f64,
        dust: &mut Field<R>,
        footprint: &mut Footprint<R>,
    ) {
        let full = f64::from(self.dust) * release_per_s * dt_secs;
        let even = self.even_level(moment.intensity_secs);
        if R::of(full) > R::zero() && even != Some(0.0) {
            footprint.put(grid, dust.location, self.centre_m(moment.secs), [R::of(self.radius_m.into()); 3]);
            footprint.for_each(grid, dust, |density, weight, offset_m| {
                let level = even.unwrap_or_else(|| self.level_at(moment.intensity_secs, offset_m));
                *density = *density + weight * R::of(full * level.max(0.0));
            });
        }
    }
}

#[cfg(test)]
mod tests;
