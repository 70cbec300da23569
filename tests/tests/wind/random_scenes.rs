//! Random valid scenes: the wind rejects them with a named error or stays finite, and gains no energy without forcing.

use prairie_wind::{Advection, Boundary, Diffusion, Location, Pressure, Real, Solver, StepError};
use tests::random_winds::RandomWind;

const WINDS: u64 = 2000;
const STEPS: usize = 4;

/// Relative growth of kinetic energy attributed to rounding.
const ENERGY_TOLERANCE: f64 = 1e-3;
/// Largest growth of kinetic energy where the pressure iteration is too short to remove the divergence: advection by a divergent flow can add energy.
const COMPRESSED_GROWTH: f64 = 2.0;
/// Residual of the pressure above which the flow counts as divergent.
const COMPRESSED: f64 = 0.01;
/// Rounding of dust in single precision.
const DUST_TOLERANCE: f32 = 1e-4;

enum Outcome {
    Refused,
    Stepped,
}

/// Twice the kinetic energy (per volume of a cell). Faces on the box's surface have half a cell.
fn energy<R: Real>(solver: &Solver<R>) -> f64 {
    let grid = solver.grid();
    let of_component = |axis: usize| {
        let n = grid.shape(Location::Face(axis));
        let values = solver.velocity().0[axis].values(grid).enumerate();
        let on_surface = move |at: usize| {
            let index = [at % n[0], at / n[0] % n[1], at / (n[0] * n[1])][axis];
            !grid.wraps(axis) && (index == 0 || index + 1 == n[axis])
        };
        values.map(|(at, speed)| speed.wide() * speed.wide() * if on_surface(at) { 0.5 } else { 1.0 }).sum::<f64>()
    };
    (0..3).map(of_component).sum()
}

/// Steps a wind.
///
/// # Errors
/// A violated property.
fn run<R: Real>(wind: &RandomWind) -> Result<Outcome, String> {
    let Ok(mut solver) = wind.solver::<R>() else { return Ok(Outcome::Refused) };
    let (start, config) = (energy(&solver), &wind.config);
    let open = config.boundary.iter().flatten().any(|&face| face == Boundary::Outflow);
    let mut compressed = false;
    for step in 0..STEPS {
        let report = match solver.step(wind.dt_secs, &wind.jets) {
            Ok(report) => report,
            Err(StepError::TooLong { .. }) => return Ok(Outcome::Refused),
            Err(error) => return Err(format!("step {step}: {error}")),
        };
        let now = energy(&solver);
        let finite =
            [report.courant, report.divergence_rms_rel, report.kinetic_energy_m2_per_s2, now].iter().all(|number| number.is_finite());
        if !finite {
            return Err(format!("step {step}: {report:?}"));
        }
        compressed |= report.pressure_residual > COMPRESSED;
        let most = start * if compressed { COMPRESSED_GROWTH } else { 1.0 + ENERGY_TOLERANCE };
        // Through an outflow face air may enter, with any energy.
        if !wind.is_driven() && !open && now > most {
            return Err(format!("step {step}: energy {now:e}, at the start {start:e}; {report:?}"));
        }
        let [low, high] = dust_range(&solver);
        if !(low.is_finite() && high.is_finite()) {
            return Err(format!("step {step}: dust from {low} to {high}"));
        }
        // Crank–Nicolson makes new extrema next to edges; fluxes do where air is compressed.
        let fluxes = config.dust.is_some_and(|dust| dust.advection == Advection::Conservative) && config.pressure != Pressure::Direct;
        let bounded = config.diffusion != Diffusion::CrankNicolson && !fluxes && !wind.is_driven();
        if bounded && (low < -DUST_TOLERANCE || high > 1.0 + DUST_TOLERANCE) {
            return Err(format!("step {step}: dust from {low} to {high}"));
        }
    }
    Ok(Outcome::Stepped)
}

fn dust_range<R: Real>(solver: &Solver<R>) -> [f32; 2] {
    let dust = solver.dust().into_iter().flatten();
    dust.fold([0.0; 2], |[low, high], density| if density.is_nan() { [density; 2] } else { [density.min(low), density.max(high)] })
}

#[test]
fn two_thousand_random_winds_are_rejected_or_stay_finite() {
    let (mut refused, mut failed) = (0, Vec::new());
    for seed in 0..WINDS {
        let wind = RandomWind::new(seed);
        assert_eq!(wind.config.validate(), Ok(()), "only valid winds are drawn");
        let outcome = if seed % 2 == 0 { run::<f32>(&wind) } else { run::<f64>(&wind) };
        match outcome {
            Ok(Outcome::Refused) => refused += 1,
            Ok(Outcome::Stepped) => {}
            Err(why) => failed.push(format!("wind {seed}: {why}\n{wind:?}")),
        }
    }
    println!("{refused} of {WINDS} refused");
    assert!(failed.is_empty(), "{} fail:\n{}", failed.len(), failed.join("\n"));
    assert!(refused < WINDS / 4, "{refused} refused: too few tell anything");
}
