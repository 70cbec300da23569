//! Longest stable step of a scene's blades, and the height of the tallest blades.

use super::{Plants, Scene};
use crate::plant::blade::Blade;
use crate::plant::blade::propagator::stable_dt_in_air_secs;
use std::f32::consts::TAU;

/// Largest number of steps that blades may need in 1/60 s.
pub const BLADE_STEPS_LIMIT: u32 = 8;

/// Height of the lowest blades relative to their kind's mean, before random variation, for which the longest step is stable. Blades on exhausted soil
/// or at borders with bare ground can be lower, down to 0.16, and their swing may then be unstable with `euler` and `verlet`.
const LEAST_GROWN: f32 = 0.72 * 0.78;

/// Range of the height of grass relative to its kind's mean, by the nutrients that underbrush leaves in the soil.
pub const GROWTH_BY_SOIL: [f32; 2] = [0.78, 1.22];
/// The same by a random pattern over the meadow.
pub const GROWTH_BY_MEADOW: [f32; 2] = [0.74, 1.20];
/// The same by the cover, which is low at borders with bare ground.
pub const GROWTH_BY_COVER: [f32; 2] = [0.35, 1.0];
/// The same by the tuft that a blade belongs to.
pub const GROWTH_BY_TUFT: [f32; 2] = [0.78, 1.15];

/// Height of the tallest blades relative to their kind's mean, before random variation.
const MOST_GROWN: f32 = GROWTH_BY_SOIL[1] * GROWTH_BY_MEADOW[1] * GROWTH_BY_COVER[1] * GROWTH_BY_TUFT[1];

/// Largest speed of the air past a blade that is considered (m/s): winds up to 10 m/s, plus as much again from its own swing.
const PAST_M_PER_S: f32 = 20.0;

/// Safety factor on the limit: drag, which is part of it, changes within a step.
const MARGIN: f32 = 0.9;

impl Plants {
    /// Height of the lowest blades relative to their kind's mean, apart from those on exhausted soil and at borders with bare ground.
    pub fn least_grown(&self) -> f32 {
        LEAST_GROWN * (1.0 - self.height_variation)
    }

    /// Height of the tallest blades relative to their kind's mean.
    pub fn most_grown(&self) -> f32 {
        MOST_GROWN * (1.0 + self.height_variation)
    }
}

impl Scene {
    /// Longest stable step (s) of every blade's swing with `plants.integrator`; infinite for `exact`.
    pub fn blade_step_secs(&self) -> f32 {
        (0..=self.species.len()).map(|kind| self.kind_step_secs(kind)).fold(f32::INFINITY, f32::min)
    }

    /// The same for one kind of grass; its shortest blades swing fastest.
    pub(super) fn kind_step_secs(&self, kind: usize) -> f32 {
        let (plants, grass) = (self.kinds_of_plants()[kind], self.kinds()[kind]);
        let least = plants.least_grown();
        let lowest = Blade {
            length_m: plants.height_m * least,
            frequency_rad_per_s: TAU * plants.swing_hz / least,
            damping_ratio: plants.swing_damping,
            lean_per_wind2: 0.01 * grass.wind_bend_rad,
        };
        MARGIN * stable_dt_in_air_secs(plants.integrator, &lowest, PAST_M_PER_S)
    }
}
