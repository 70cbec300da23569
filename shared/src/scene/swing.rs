//! How short the steps of a scene's blades must be, and how tall blades grow.

use super::check::Misfits;
use super::{Plants, Scene};
use crate::plant::blade::Blade;
use crate::plant::blade::propagator::stable_dt_in_air_secs;
use std::f32::consts::TAU;

/// Most steps that blades may need in 1/60 s.
pub const BLADE_STEPS_LIMIT: u32 = 8;

/// Height of the lowest blades over their kind's mean, before the random share of each: how little the meadow and a tuft let grow; twin of `plant_at` in
/// `bend.wgsl`.
const LEAST_GROWN: f32 = 0.72 * 0.78;

/// Height of the tallest blades over their kind's mean, before the random share of each: most that the soil, the meadow and a tuft let grow; twin of `fed` in
/// `common.wgsl` and of `plant_at` in `bend.wgsl`.
const MOST_GROWN: f32 = 1.22 * 1.20 * 1.15;

/// Fastest air past a blade that counts (m/s): of winds up to 10 m/s, and as much of its own swing.
const PAST_M_PER_S: f32 = 20.0;

/// Steps over the limit: drag, which is part of it, changes within a step.
const MARGIN: f32 = 0.9;

impl Plants {
    /// Height of the tallest blades over their kind's mean.
    pub fn most_grown(&self) -> f32 {
        MOST_GROWN * (1.0 + self.height_variation)
    }
}

impl Scene {
    /// Longest step (s) that the swing of every blade bears by `plants.integrator`; infinite for `exact`.
    pub fn blade_step_secs(&self) -> f32 {
        (0..=self.species.len()).map(|kind| self.kind_step_secs(kind)).fold(f32::INFINITY, f32::min)
    }

    /// The same for one kind of grass; its lowest blades are the fastest.
    fn kind_step_secs(&self, kind: usize) -> f32 {
        let (plants, grass) = (self.kinds_of_plants()[kind], self.kinds()[kind]);
        let least = LEAST_GROWN * (1.0 - plants.height_variation);
        let lowest = Blade {
            length_m: plants.height_m * least,
            frequency_rad_per_s: TAU * plants.swing_hz / least,
            damping_share: plants.swing_damping,
            lean_per_wind2: 0.01 * grass.wind_bend_rad,
        };
        MARGIN * stable_dt_in_air_secs(plants.integrator, &lowest, PAST_M_PER_S)
    }
}

/// Refuses blades that would need too many steps.
pub(super) fn check(scene: &Scene, misfits: &mut Misfits) {
    for kind in 0..=scene.species.len() {
        let steps = (1.0 / 60.0 / scene.kind_step_secs(kind)).ceil();
        if steps <= BLADE_STEPS_LIMIT as f32 {
            continue;
        }
        let (swing_hz, whose) = match kind.checked_sub(1) {
            None => ("plants.swing_hz".to_owned(), String::new()),
            Some(i) => (format!("species[{i}].swing_hz"), format!(" of \"{}\"", scene.species[i].name)),
        };
        let message = format!(
            "is \"{}\", for which the shortest blades{whose} take {steps} steps in 1/60 s; allowed: {BLADE_STEPS_LIMIT}, by a lower `{swing_hz}`, other damping \
             or less variation of heights, or \"exact\"",
            scene.plants.integrator.word()
        );
        misfits.note(&["plants.integrator", &swing_hz, "plants.swing_damping", "plants.height_variation"], message);
    }
}
