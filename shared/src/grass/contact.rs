//! Contact of moving objects with the grass.

use super::bending::{HELD_RAD_PER_S, bend_after_rad, bending_speed_rad_per_s, direction};
use super::corner_contact::CornerVelocities;
use super::grass_state::CellState;
use super::stroke::{Pressed, Stroke};
use super::swept_footprint::{Leg, SweptFootprint};
use super::vector::{length, unit};
use crate::bend::Bend;
use crate::grid::PatchLayout;
use crate::scene::ObjectContact;

/// Speed below which an object counts as standing still (m/s).
pub const STANDSTILL_M_PER_S: f32 = 0.05;
/// Sinking speed of the grass below the weight of an object at rest (m/s).
pub(super) const SETTLING_M_PER_S: f32 = 0.3;

/// One contact of an object with the grass in a step.
pub struct Contact {
    /// Area that is touched, and for how long.
    pub swept: SweptFootprint,
    /// Height above the ground at which the object pushes the grass (m), h of Chen & Johan, Eq. (12).
    pub strike_height_m: f32,
    /// Bend at which the grass slips below the object (rad).
    pub slip_bend_rad: f32,
    /// Whether grass bends sideways along the rims (Chen & Johan, Eq. 10).
    pub parts_grass: bool,
    /// Speed at which the grass sinks below the object's weight, however slowly it moves (m/s).
    pub settling_m_per_s: f32,
    /// Fraction of the bend that remains as flattened grass, 0..=1.
    pub flattened_fraction: f32,
    /// Whether the object is at rest. Its whole bend then counts as flattened grass, and its patches may sleep.
    pub is_at_rest: bool,
    /// How the velocity of each cell is found. Below an object at rest it is exact.
    pub method: ObjectContact,
}

impl Contact {
    /// The strokes of a step of `dt_secs`, one for each leg.
    pub fn strokes<'a>(&'a self, layout: &'a PatchLayout, dt_secs: f32) -> impl Iterator<Item = Stroke<'a>> {
        self.swept.legs().map(move |leg| {
            let area = leg.cover();
            match self.method {
                ObjectContact::Interpolated if !self.is_at_rest => Stroke::new(&area, layout, false, self.interpolated_rule(&leg, dt_secs)),
                _ => Stroke::new(&area, layout, self.is_at_rest, self.rule(leg, layout.cell_m, dt_secs)),
            }
        })
    }

    /// How grass yields to one leg by the velocities at the corners of its area: Eq. (12) for the whole leg, in one step.
    fn interpolated_rule<'a>(
        &'a self,
        leg: &Leg<'a>,
        dt_secs: f32,
    ) -> impl Fn([f32; 2], &mut CellState) -> Option<Pressed> + Send + Sync + use<'a> {
        let leg_secs = leg.fraction * dt_secs;
        let velocities = CornerVelocities::new(self, leg, leg_secs);
        move |at_m, cell| {
            let velocity = velocities.at(at_m)?;
            let (speed, direction) = (length(velocity), unit(velocity)?);
            let terrain_rad = cell.limit_rad(direction);
            let (theta, limit) = (cell.bend().theta, terrain_rad.min(self.slip_bend_rad));
            let omega = bending_speed_rad_per_s(speed, theta, self.strike_height_m);
            let theta = if theta >= limit { theta.min(terrain_rad) } else { limit.min(theta + omega * leg_secs) };
            let held = omega.max(HELD_RAD_PER_S);
            Some(Pressed { bend: Bend { theta, omega: direction.map(|d| d * held) }, flattened_fraction: self.flattened_fraction })
        }
    }

    /// How grass yields to one leg.
    fn rule<'a>(
        &'a self,
        leg: Leg<'a>,
        rim_m: f32,
        dt_secs: f32,
    ) -> impl Fn([f32; 2], &mut CellState) -> Option<Pressed> + Send + Sync + 'a {
        let (middle_m, leg_secs) = (leg.middle_m(), leg.fraction * dt_secs);
        move |at_m, cell| {
            let rims = if self.parts_grass { leg.rims() } else { &[] };
            let passage = leg.passage(at_m)?;
            let bend = cell.bend();
            let velocity = passage.moves_m.map(|m| m / leg_secs);
            let moves = if length(velocity) > STANDSTILL_M_PER_S { unit(velocity) } else { None };
            let direction = match moves {
                Some(moves) => leg.to_world(direction(leg.to_local(moves), passage.local_m, rims, rim_m)),
                None => unit(bend.omega).unwrap_or_else(|| {
                    let out = [passage.local_m[0] - middle_m[0], passage.local_m[1] - middle_m[1]];
                    unit(out).map_or([1.0, 0.0], |out| leg.to_world(out))
                }),
            };
            let along = (velocity[0] * direction[0] + velocity[1] * direction[1]).max(self.settling_m_per_s);
            let terrain_rad = cell.limit_rad(direction);
            let limit = terrain_rad.min(self.slip_bend_rad);
            let theta = if bend.theta >= limit {
                bend.theta.min(terrain_rad)
            } else if self.is_at_rest {
                limit
            } else {
                limit.min(bend_after_rad(bend.theta, along, self.strike_height_m, passage.fraction * leg_secs))
            };
            let held = bending_speed_rad_per_s(along, theta, self.strike_height_m).max(HELD_RAD_PER_S);
            Some(Pressed { bend: Bend { theta, omega: direction.map(|d| d * held) }, flattened_fraction: self.flattened_fraction })
        }
    }
}
