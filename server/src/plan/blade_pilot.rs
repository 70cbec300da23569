//! Pilot runs of blades: each kind of grass of a scene, low, mean and tall, is let go from its largest bend in the wind of the scene.
//!
//! The reference takes [`REFINEMENT`] exact steps in a step of a picture. The error of the swing is the root mean square distance of the tips over a second, that of
//! a strip the largest distance between it and the curve, for the bends of that second, the largest bend among them.

use prairie_core::plant::blade::backbone::{backbone_m, drawn_out_m};
use prairie_core::plant::blade::deflection::deflection;
use prairie_core::plant::blade::{Blade, LINKS, Leans, Sway, advance};
use prairie_core::scene::{BladeIntegrator, Scene};
use std::f32::consts::TAU;
use std::time::Instant;

/// Duration of a picture (s), in which blades take one step, or as many as their integrator needs.
pub(super) const PICTURE_SECS: f32 = 1.0 / 60.0;
/// Pictures of a run, which lasts a second.
const PICTURES: usize = 60;
/// Steps of the reference in a picture.
const REFINEMENT: usize = 16;
/// Pictures between the bends that are drawn as strips.
const STRIP_PICTURES: usize = 6;
/// Segments of the strip that stands for the curve.
const CURVE_SEGMENTS: u32 = 96;
/// Repetitions of a run for timing.
const REPEATS: usize = 5;

/// Wind over the ground at some places, over time.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Winds {
    /// Time between two winds of a place (s).
    pub(super) dt_secs: f32,
    /// Winds of each place (m/s); none for still air.
    pub(super) of_places: Vec<Vec<[f32; 2]>>,
}

impl Winds {
    /// Wind at a place and time, linear between the known ones.
    fn at(&self, place: usize, secs: f32) -> [f32; 2] {
        let Some(winds) = self.of_places.get(place).filter(|winds| winds.len() > 1) else { return [0.0; 2] };
        let at = (secs / self.dt_secs).clamp(0.0, (winds.len() - 1) as f32);
        let before = (at as usize).min(winds.len() - 2);
        let part = at - before as f32;
        std::array::from_fn(|axis| winds[before][axis] + part * (winds[before + 1][axis] - winds[before][axis]))
    }
}

/// Steps of a run.
#[derive(Clone, Copy)]
struct Steps {
    integrator: BladeIntegrator,
    per_picture: usize,
    /// Whether the wind stays as it is at the end of a picture, as for clients; else each step has its own.
    holds_wind: bool,
}

/// A blade in the wind of a place, with its states at each picture of the reference.
struct Swung {
    blade: Blade,
    place: usize,
    pressed: Sway,
    wanted: Vec<Sway>,
}

/// The blades of a scene, with their reference.
pub(super) struct BladePilot<'a> {
    winds: &'a Winds,
    blades: Vec<Swung>,
}

impl<'a> BladePilot<'a> {
    /// Runs the reference.
    pub(super) fn new(scene: &Scene, winds: &'a Winds) -> Self {
        let mut pilot = Self { winds, blades: Vec::new() };
        for (plants, grass) in scene.kinds_of_plants().iter().zip(scene.kinds()) {
            for grown in [plants.least_grown(), 1.0, plants.most_grown()] {
                let blade = Blade {
                    length_m: plants.height_m * grown,
                    frequency_rad_per_s: TAU * plants.swing_hz / grown,
                    damping_ratio: plants.swing_damping,
                    lean_per_wind2: 0.01 * grass.wind_bend_rad,
                };
                let pressed = Sway::at_rest(deflection(&[[grass.theta_max_rad, 0.0]; LINKS]));
                pilot.blades.extend((0..winds.of_places.len().max(1)).map(|place| Swung { blade, place, pressed, wanted: Vec::new() }));
            }
        }
        let steps = Steps { integrator: BladeIntegrator::Exact, per_picture: REFINEMENT, holds_wind: false };
        let wanted: Vec<_> = pilot.blades.iter().map(|swung| pilot.run(swung, steps)).collect();
        pilot.blades.iter_mut().zip(wanted).for_each(|(swung, wanted)| swung.wanted = wanted);
        pilot
    }

    /// States of a blade at the end of each picture.
    fn run(&self, Swung { blade, place, pressed, .. }: &Swung, Steps { integrator, per_picture, holds_wind }: Steps) -> Vec<Sway> {
        let dt_secs = PICTURE_SECS / per_picture as f32;
        let mut sway = *pressed;
        let picture = |picture: usize| {
            for step in 0..per_picture {
                let pictures = if holds_wind { 1.0 } else { (step as f32 + 0.5) / per_picture as f32 };
                let wind = [self.winds.at(*place, (picture as f32 + pictures) * PICTURE_SECS); LINKS];
                sway = advance(&sway, blade, &Leans::default(), &wind, integrator, dt_secs);
            }
            sway
        };
        (0..PICTURES).map(picture).collect()
    }

    /// Root mean square error of the tips with an integrator that takes `steps` in a picture, relative to the length.
    pub(super) fn swing_error(&self, integrator: BladeIntegrator, steps: u32) -> f64 {
        let [mut sum, mut count] = [0.0; 2];
        let steps = Steps { integrator, per_picture: steps as usize, holds_wind: true };
        for swung in &self.blades {
            for (own, wanted) in self.run(swung, steps).iter().zip(&swung.wanted) {
                let [own, wanted] = [own, wanted].map(|sway| sway.points_m(1.0)[LINKS - 1]);
                sum += (0..3).map(|axis| f64::from(own[axis] - wanted[axis]).powi(2)).sum::<f64>();
                count += 1.0;
            }
        }
        (sum / count).sqrt()
    }

    /// Largest distance of a strip of `segments` from the curve, relative to the length.
    pub(super) fn strip_error(&self, segments: u32) -> f64 {
        let bends = self.blades.iter().flat_map(|swung| std::iter::once(&swung.pressed).chain(swung.wanted.iter().step_by(STRIP_PICTURES)));
        bends.map(|sway| strip_error(sway, segments)).fold(0.0, f64::max)
    }
}

/// Largest distance of a strip of `segments` from the curve of a bent blade, relative to the length.
fn strip_error(sway: &Sway, segments: u32) -> f64 {
    let points_m = sway.points_m(1.0);
    let strip = |segments: u32| -> Vec<[f64; 3]> {
        let drawn_m = drawn_out_m(&points_m, 1.0, segments);
        (0..=segments).map(|n| backbone_m(&drawn_m, n as f32 / segments as f32).map(f64::from)).collect()
    };
    let (coarse, fine) = (strip(segments), strip(CURVE_SEGMENTS));
    let nearest = |point: &[f64; 3]| coarse.windows(2).map(|ends| distance(point, ends)).fold(f64::INFINITY, f64::min);
    fine.iter().map(nearest).fold(0.0, f64::max)
}

/// Distance of a point from the line between two others.
fn distance(point: &[f64; 3], ends: &[[f64; 3]]) -> f64 {
    let [along, aside]: [[f64; 3]; 2] = [&ends[1], point].map(|of| std::array::from_fn(|axis| of[axis] - ends[0][axis]));
    let dot = |a: &[f64; 3], b: &[f64; 3]| (0..3).map(|axis| a[axis] * b[axis]).sum::<f64>();
    let part = (dot(&along, &aside) / dot(&along, &along).max(1e-12)).clamp(0.0, 1.0);
    (0..3).map(|axis| (aside[axis] - part * along[axis]).powi(2)).sum::<f64>().sqrt()
}

/// Time of a step of a blade by an integrator (ns).
pub(super) fn ns_per_step(integrator: BladeIntegrator) -> f64 {
    let loaded = crate::scenes::load("meadow").expect("a built-in scene");
    let winds = Winds { dt_secs: 1.0, of_places: vec![vec![[4.0, 1.0], [7.0, -2.0]]; 64] };
    let pilot = BladePilot::new(&loaded.scene, &winds);
    let time = |_| {
        let start = Instant::now();
        for swung in &pilot.blades {
            std::hint::black_box(pilot.run(swung, Steps { integrator, per_picture: 1, holds_wind: true }));
        }
        start.elapsed().as_secs_f64() * 1e9 / (pilot.blades.len() * PICTURES) as f64
    };
    (0..REPEATS).map(time).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A strip of n segments that share a turn θ departs from its arc by θ/(8n²) of the length, of second order.
    #[test]
    fn strips_near_their_curve_by_the_second_order() {
        let bent = Sway::at_rest([[0.2, 0.0], [0.6, 0.0], [1.0, 0.0]]);
        let errors = [3, 6, 12].map(|segments| strip_error(&bent, segments));
        for pair in errors.windows(2) {
            let order = (pair[0] / pair[1]).log2();
            assert!((1.7..2.3).contains(&order), "{errors:?}");
        }
        let arc = 1.2 / (8.0 * 36.0);
        assert!((errors[1] / arc - 1.0).abs() < 0.5, "{errors:?}, {arc}");
        let upright = Sway::at_rest(Leans::default());
        assert!(strip_error(&upright, 1) < 1e-6);
    }

    #[test]
    fn winds_are_linear_between_the_known_ones_and_still_without_any() {
        let winds = Winds { dt_secs: 0.5, of_places: vec![vec![[0.0, 2.0], [4.0, 2.0], [4.0, 0.0]]] };
        assert_eq!([0.0, 0.25, 0.75, 9.0].map(|secs| winds.at(0, secs)), [[0.0, 2.0], [2.0, 2.0], [4.0, 1.0], [4.0, 0.0]]);
        assert_eq!(Winds::default().at(0, 0.3), [0.0; 2]);
    }
}
