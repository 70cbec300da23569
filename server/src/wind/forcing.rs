//! Forces from outside: helicopter downwash, wakes of moving objects.

use glam::Vec3;

use super::footprint::Footprint;
use super::{Grid, Real, Velocity};

/// A body of air driven towards a velocity: the wash under a rotor, the air dragged along behind a car.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jet {
    /// Centre (m) in the box; positions beyond a wrapped face act on their image inside.
    pub position_m: Vec3,
    /// Radius (m) beyond which the jet does nothing, above 0. One narrower than a cell acts on a cell, more weakly.
    pub radius_m: f32,
    /// Velocity (m/s) the air is driven towards: (0, −10, 0) under a light helicopter, the velocity of a car in its wake.
    pub velocity_m_per_s: Vec3,
    /// How fast the air at the centre takes that velocity on (1/s), 0 or more; 2 reaches 63 % in half a second.
    pub rate_per_sec: f32,
}

impl Jet {
    /// True if every number is finite, the radius positive and the rate not negative.
    pub fn is_valid(&self) -> bool {
        let finite = self.position_m.is_finite() && self.velocity_m_per_s.is_finite();
        finite && self.radius_m > 0.0 && self.radius_m.is_finite() && self.rate_per_sec >= 0.0 && self.rate_per_sec.is_finite()
    }
}

/// Drives the air in a jet for a step of backward Euler, which never overshoots: `u += w·(v − u)·rate·dt / (1 + rate·dt)`, with w the weight of the footprint.
pub fn drive<R: Real>(grid: &Grid<R>, jet: &Jet, dt_secs: f64, velocity: &mut Velocity<R>, footprint: &mut Footprint<R>) {
    let reach = f64::from(jet.rate_per_sec) * dt_secs;
    let share = R::of(reach / (1.0 + reach));
    let centre = jet.position_m.to_array().map(|x| R::of(x.into()));
    let radius = [R::of(jet.radius_m.into()); 3];
    for (field, target) in velocity.0.iter_mut().zip(jet.velocity_m_per_s.to_array()) {
        let target = R::of(target.into());
        footprint.put(grid, field.place, centre, radius);
        footprint.for_each(grid, field, |speed, weight, _| *speed = *speed + weight * share * (target - *speed));
    }
}
