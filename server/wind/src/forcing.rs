//! Jets: helicopter downwash and wakes of moving objects.

use glam::Vec3;

use super::footprint::Footprint;
use super::{Grid, Real, Velocity};

/// A region of air driven towards a velocity: the downwash of a rotor, the wake of a car.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jet {
    /// Centre (m) in the box; on periodic axes its image inside the box.
    pub position_m: Vec3,
    /// Radius (m) beyond which the jet has no effect, above 0. One narrower than a cell is widened to it, with reduced strength.
    pub radius_m: f32,
    /// Velocity (m/s) the air is driven towards: (0, −10, 0) under a light helicopter, the velocity of a car in its wake.
    pub velocity_m_per_s: Vec3,
    /// Relaxation rate (1/s) to that velocity at the centre, 0 or more; at 2, 63 % in half a second.
    pub rate_per_s: f32,
}

impl Jet {
    /// Whether all numbers are finite, the radius is positive and the rate not negative.
    pub fn is_valid(&self) -> bool {
        let finite = self.position_m.is_finite() && self.velocity_m_per_s.is_finite();
        finite && self.radius_m > 0.0 && self.radius_m.is_finite() && self.rate_per_s >= 0.0 && self.rate_per_s.is_finite()
    }
}

/// Applies a jet by a backward Euler step, which never overshoots: `u += w·(v − u)·rate·dt / (1 + rate·dt)`, w the weight of the footprint.
pub fn drive<R: Real>(grid: &Grid<R>, jet: &Jet, dt_secs: f64, velocity: &mut Velocity<R>, footprint: &mut Footprint<R>) {
    let reach = f64::from(jet.rate_per_s) * dt_secs;
    let fraction = R::of(reach / (1.0 + reach));
    let centre = jet.position_m.to_array().map(|x| R::of(x.into()));
    let radius = [R::of(jet.radius_m.into()); 3];
    for (field, target) in velocity.0.iter_mut().zip(jet.velocity_m_per_s.to_array()) {
        let target = R::of(target.into());
        footprint.put(grid, field.location, centre, radius);
        footprint.for_each(grid, field, |speed, weight, _| *speed = *speed + weight * fraction * (target - *speed));
    }
}
