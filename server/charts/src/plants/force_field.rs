//! The remainder of an impulse in the force field: error of its pressure against computing time, by size of the volumes.

use std::time::Instant;

use prairie_core::plant::force_field::{ForceField, Lingering, VolumeMesh};

use super::super::{Outcome, Problem, Run};
use crate::norms::Norms;

/// Extent of the mesh (m); the impulse is far from all sides but the ground.
const BOX_M: [f64; 3] = [16.0, 12.0, 16.0];
const CENTER_M: [f64; 3] = [8.0, 1.5, 8.0];
/// Standard deviation of the first remainder (m), and its largest pressure (Pa).
const WIDTH_M: f64 = 1.2;
const PRESSURE_PA: f64 = 20.0;
/// Spread and decay as in the page, and the time after which pressures are compared (s).
const LINGERING: Lingering = Lingering { spread_m2_per_s: 2.0, decay_per_s: 3.5 };
const END_SECS: f64 = 0.5;

/// Steps of a frame, and one step to the end; either is divided as stability requires.
const METHODS: [(&str, usize); 2] = [("steps of 1/60 s", 30), ("one step", 1)];
const SPACINGS_M: [f64; 4] = [2.0, 1.0, 0.5, 0.25];

/// Pressure (Pa) of a Gaussian that spreads and decays over ground through which nothing passes.
fn exact_pa(at_m: [f64; 3], secs: f64) -> f64 {
    let Lingering { spread_m2_per_s, decay_per_s } = LINGERING;
    let variance_m2 = WIDTH_M * WIDTH_M + 2.0 * f64::from(spread_m2_per_s) * secs;
    let gaussian = |height_m: f64| {
        let [x_m, _, z_m] = [0, 1, 2].map(|axis| at_m[axis] - CENTER_M[axis]);
        (-(x_m * x_m + (at_m[1] - height_m).powi(2) + z_m * z_m) / (2.0 * variance_m2)).exp()
    };
    let spread = (WIDTH_M * WIDTH_M / variance_m2).powf(1.5);
    PRESSURE_PA * (-f64::from(decay_per_s) * secs).exp() * spread * (gaussian(CENTER_M[1]) + gaussian(-CENTER_M[1]))
}

pub(super) fn problem(quick: bool) -> Problem {
    let spacings_m = &SPACINGS_M[..SPACINGS_M.len() - usize::from(quick)];
    let run = |(name, steps): (&str, usize), spacing_m: f64| Run {
        method: name.into(),
        cells: BOX_M.map(|side_m| (side_m / spacing_m) as usize),
        dt_secs: END_SECS / steps as f64,
        solve: Box::new(move || Ok(spread(spacing_m, steps))),
    };
    Problem {
        name: "Remainder of an impulse",
        error: "rms error of the pressure (Pa)",
        per: "simulated second",
        default_method: Some(METHODS[0].0),
        cell_bytes: 12,
        runs: METHODS.into_iter().flat_map(|method| spacings_m.iter().map(move |&spacing_m| run(method, spacing_m))).collect(),
    }
}

fn spread(spacing_m: f64, steps: usize) -> Outcome {
    let count = BOX_M.map(|side_m| (side_m / spacing_m) as usize);
    let mesh = VolumeMesh { count, spacing_m: [spacing_m as f32; 3], corner: [0; 2] };
    let volumes = || (0..count[0]).flat_map(move |x| (0..count[1]).flat_map(move |y| (0..count[2]).map(move |z| [x, y, z])));
    let center_m = |volume| mesh.center_m(volume).map(f64::from);
    let mut field = ForceField::new(mesh, LINGERING);
    // An impulse adds its whole pressure in a step that is short beside the decay.
    let dt_secs = 1e-4;
    field.strike(volumes().map(|volume| (volume, [exact_pa(center_m(volume), 0.0) as f32 / LINGERING.decay_per_s, 0.0, 0.0])), dt_secs);
    let begun = Instant::now();
    for _ in 0..steps {
        field.step((END_SECS / steps as f64) as f32);
    }
    let wall = begun.elapsed();
    let pairs = volumes().map(|volume| (f64::from(field.force(volume).lasting_pa[0]), exact_pa(center_m(volume), END_SECS)));
    Outcome { error: Norms::of(pairs), simulated_secs: END_SECS, wall }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::norms::fitted_order;

    #[test]
    fn pressures_converge_with_second_order() {
        let errors = SPACINGS_M[..3].iter().map(|&spacing_m| (spacing_m, spread(spacing_m, METHODS[0].1).error.l2)).collect::<Vec<_>>();
        let order = fitted_order(&errors);
        assert!((1.7..2.5).contains(&order), "order {order:.2}: {errors:?}");
    }
}
