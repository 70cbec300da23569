//! Longest stable time step of a blade against its stiffness.

use std::fmt::Write as _;

use anyhow::{Result, ensure};
use prairie_core::plant::blade::modes::{FREQUENCIES, first_frequency_rad_per_s};
use prairie_core::plant::blade::propagator::stable_dt_secs;
use prairie_core::plant::blade::{Blade, Integrator, LINKS, Leans, Sway, advance};

use super::super::figure::{Axis, Curve, Drawn, Words, curves_svg};

/// Length of the blade (m) and its mass per length (kg/m): 0.96 g.
const LENGTH_M: f32 = 0.8;
const MASS_KG_PER_M: f32 = 0.0012;
/// Range of rigidities (N·m²), from hair to cane.
const RIGIDITIES_N_M2: [f32; 2] = [1e-6, 1.0];
/// Interval of the bisection (s), independent of theory, and its tolerance.
const STEPS_SECS: [f32; 2] = [1e-6, 100.0];
const CLOSE: f32 = 1.005;

/// Integrator, damping ratio, and theoretical limit; ω is that of the highest mode.
const CASES: [(Integrator, f32, &str); 5] = [
    (Integrator::Verlet, 0.0, "Verlet, ζ = 0: 2/ω"),
    (Integrator::Verlet, 0.1, "Verlet, ζ = 0.1: 2(√(1 + ζ²) − ζ)/ω"),
    (Integrator::Verlet, 0.5, "Verlet, ζ = 0.5"),
    (Integrator::Euler, 0.5, "Euler, ζ = 0.5: 2ζ/ω"),
    (Integrator::Euler, 0.1, "Euler, ζ = 0.1"),
];

fn frequency_rad_per_s(rigidity_n_m2: f32) -> f32 {
    first_frequency_rad_per_s(rigidity_n_m2, MASS_KG_PER_M, LENGTH_M)
}

/// Whether the deflection of a blade, excited in all modes, stays below a hundred times its initial value.
fn holds(integrator: Integrator, frequency_rad_per_s: f32, damping_ratio: f32, dt_secs: f32) -> bool {
    let blade = Blade { length_m: LENGTH_M, frequency_rad_per_s, damping_ratio, lean_per_wind2: 0.0 };
    // Half a percent beyond its limit Euler grows by 0.01·ζ² per step; enough steps for a factor of e⁶.
    let steps = (600.0 / (damping_ratio * damping_ratio)).clamp(2e4, 1e5) as u32;
    let calm = Leans::default();
    let mut sway = Sway::at_rest([[0.01, 0.0], [-0.01, 0.01], [0.01, -0.01]]);
    (0..steps).all(|step| {
        sway = advance(&sway, &blade, &calm, &calm, integrator, dt_secs);
        step % 64 != 0 || sway.lean_rad.as_flattened().iter().all(|lean_rad| lean_rad.abs() < 1.0)
    })
}

/// The longest stable step (s) that holds.
fn measured_secs(integrator: Integrator, frequency_rad_per_s: f32, damping_ratio: f32) -> Result<f32> {
    let [mut low, mut high] = STEPS_SECS;
    let holds = |dt_secs| holds(integrator, frequency_rad_per_s, damping_ratio, dt_secs);
    ensure!(holds(low) && !holds(high), "{integrator:?} has no limit between {low} and {high} s");
    while high / low > CLOSE {
        let middle = (low * high).sqrt();
        if holds(middle) { low = middle } else { high = middle }
    }
    Ok(low)
}

pub(super) fn draw(quick: bool, caption: &str) -> Result<Drawn> {
    let places = if quick { 3 } else { 7 };
    let [softest, stiffest] = RIGIDITIES_N_M2;
    let rigidity = |n: f32| softest * (stiffest / softest).powf(n);
    let mut csv = String::from("integrator,damping_share,rigidity_n_m2,highest_rad_per_s,theory_secs,measured_secs\n");
    let (mut summary, mut curves) = (String::new(), vec![]);
    for (integrator, fraction, formula) in CASES {
        let theory_secs = |rigidity_n_m2: f32| stable_dt_secs(integrator, frequency_rad_per_s(rigidity_n_m2), fraction);
        let line = [softest, stiffest].map(|rigidity_n_m2| [rigidity_n_m2, theory_secs(rigidity_n_m2)].map(f64::from));
        curves.push(Curve { name: formula.into(), points: line.to_vec(), marked: false, joined: true });
        let mut found = Curve { name: "measured".into(), points: vec![], marked: true, joined: false };
        let (mut least, mut most) = (f32::INFINITY, 0.0_f32);
        for rigidity_n_m2 in (0..places).map(|n| rigidity(n as f32 / (places - 1) as f32)) {
            let (frequency_rad_per_s, theory) = (frequency_rad_per_s(rigidity_n_m2), theory_secs(rigidity_n_m2));
            let measured = measured_secs(integrator, frequency_rad_per_s, fraction)?;
            (least, most) = (least.min(measured / theory), most.max(measured / theory));
            let highest_rad_per_s = frequency_rad_per_s * FREQUENCIES[LINKS - 1];
            writeln!(csv, "{integrator:?},{fraction},{rigidity_n_m2:e},{highest_rad_per_s},{theory},{measured}")?;
            found.points.push([rigidity_n_m2, measured].map(f64::from));
        }
        writeln!(summary, "{integrator:?}, ζ = {fraction}: fails at {least:.3} to {most:.3} of its limit")?;
        curves.push(found);
    }
    let holds_all = RIGIDITIES_N_M2.map(frequency_rad_per_s).into_iter().all(|frequency_rad_per_s| {
        let highest_rad_per_s = frequency_rad_per_s * FREQUENCIES[LINKS - 1];
        let cases = [0.0, 0.1, 0.5].into_iter().flat_map(|fraction| [1.0, 100.0, 1e5].map(|step| (fraction, step / highest_rad_per_s)));
        cases.into_iter().all(|(fraction, dt_secs)| holds(Integrator::Exact, frequency_rad_per_s, fraction, dt_secs))
    });
    writeln!(summary, "exact: {} at ω·dt of 1, 100 and 100 000", if holds_all { "holds" } else { "fails" })?;
    let steps = curves.iter().flat_map(|curve| curve.points.iter().map(|point| point[1]));
    let [shortest, longest] = [steps.clone().fold(f64::INFINITY, f64::min) / 1.5, steps.fold(0.0, f64::max) * 1.5];
    let axes = [
        Axis { name: "flexural rigidity EI (N·m²)", range: RIGIDITIES_N_M2.map(f64::from), logarithmic: true },
        Axis { name: "longest stable step (s)", range: [shortest, longest], logarithmic: true },
    ];
    let words = Words {
        title: "Longest stable time step of a blade",
        subtitle: "0.8 m, 1.2 g/m; an integrator is stable below its line (theory); the exact one is stable everywhere",
        caption,
    };
    let svg = curves_svg(&curves, axes, words)?;
    Ok(Drawn::new(svg, csv, summary))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blades_of_any_stiffness_become_unstable_at_the_theoretical_limit() {
        for rigidity_n_m2 in RIGIDITIES_N_M2 {
            let frequency_rad_per_s = frequency_rad_per_s(rigidity_n_m2);
            let highest_rad_per_s = frequency_rad_per_s * FREQUENCIES[LINKS - 1];
            for (integrator, fraction, formula) in CASES {
                let limit = match integrator {
                    Integrator::Verlet => 2.0 * ((1.0 + fraction * fraction).sqrt() - fraction),
                    _ => 2.0 * fraction,
                } / highest_rad_per_s;
                let found = measured_secs(integrator, frequency_rad_per_s, fraction).unwrap() / limit;
                assert!((0.99..1.01).contains(&found), "{formula}, {rigidity_n_m2} N·m²: {found} of the limit");
            }
        }
    }
}
