//! Random valid scenes: the wind rejects them with a named error or stays finite, and gains no energy without forcing.

use prairie_charts::random_winds::RandomWind;
use prairie_wind::{Advection, Boundary, Diffusion, Location, Pressure, Real, Solver, StepError, TimeScheme};
use std::collections::BTreeMap;

/// Winds of both tests together; `PRAIRIE_WINDS` sets another number.
const WINDS: u64 = 2000;
/// Steps of winds with forcing, and of those without, whose energy is checked in every step.
const STEPS: [usize; 2] = [4, 200];

/// Relative growth of kinetic energy attributed to rounding.
const ENERGY_TOLERANCE: f64 = 1e-3;
/// Largest growth of kinetic energy where traced air may enter the box: nothing but its speed is bounded then.
const TRACED_GROWTH: f64 = 2.0;
/// Largest growth of kinetic energy in the first steps where air may enter the box and an iteration ends early: transport by a divergent flow adds energy, and so does
/// a pressure that is kept although friction was not solved. Later only numbers must be finite.
const UNFINISHED_GROWTH: f64 = 1.5;
/// Residual of the pressure above which the flow counts as divergent.
const COMPRESSED: f64 = 0.01;
/// Rounding of dust in single precision.
const DUST_TOLERANCE: f32 = 1e-4;

enum Outcome {
    Refused,
    /// What is known of its energy, and the largest after a step, relative to the start.
    Stepped(Energy, f64),
}

/// What is known about the kinetic energy of air without forcing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Energy {
    /// It never grows in a box without open faces.
    Closed,
    /// It never grows in conservative transport through open faces, by an argument (without damping; `prairie_wind::boundary`) where pressure and friction are solved.
    Solved,
    /// Traced air enters through open faces.
    Traced,
    /// Air enters through open faces, and an iteration ends early.
    Unfinished,
    /// A forcing adds energy.
    Driven,
    /// There is none.
    Still,
}

impl Energy {
    fn of(wind: &RandomWind, start: f64, is_compressed: bool) -> Self {
        let config = &wind.config;
        let open = config.boundary.iter().flatten().any(|&face| face == Boundary::Outflow);
        let has_sweeps = matches!(config.diffusion, Diffusion::GaussSeidel { .. }) && config.time == TimeScheme::RungeKutta3;
        if wind.is_driven() {
            Self::Driven
        } else if start == 0.0 {
            Self::Still
        } else if !open {
            Self::Closed
        } else if is_compressed || has_sweeps {
            Self::Unfinished
        } else if config.advection.uses_fluxes() {
            Self::Solved
        } else {
            Self::Traced
        }
    }

    /// Largest energy after a step, relative to the start.
    fn limit(self, step: usize) -> f64 {
        match self {
            Self::Closed | Self::Solved => 1.0 + ENERGY_TOLERANCE,
            Self::Traced => TRACED_GROWTH,
            Self::Unfinished if step < STEPS[0] => UNFINISHED_GROWTH,
            Self::Unfinished | Self::Driven => f64::INFINITY,
            Self::Still => 0.0,
        }
    }
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
    let (mut class, mut is_compressed, mut largest) = (Energy::of(wind, start, false), false, 0.0_f64);
    for step in 0..STEPS[usize::from(class != Energy::Driven)] {
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
        is_compressed |= report.pressure_residual > COMPRESSED;
        class = Energy::of(wind, start, is_compressed);
        largest = largest.max(now / start);
        if class != Energy::Driven && now > start * class.limit(step).min(f64::MAX) {
            return Err(format!("step {step}: energy {now:e}, at the start {start:e}, {class:?}; {report:?}"));
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
    Ok(Outcome::Stepped(class, largest))
}

fn dust_range<R: Real>(solver: &Solver<R>) -> [f32; 2] {
    let dust = solver.dust().into_iter().flatten();
    dust.fold([0.0; 2], |[low, high], density| if density.is_nan() { [density; 2] } else { [density.min(low), density.max(high)] })
}

/// Runs every second wind, beginning with number `first`, in one precision.
fn check<R: Real>(first: u64) {
    let winds = std::env::var("PRAIRIE_WINDS").map_or(WINDS, |number| number.parse().expect("PRAIRIE_WINDS is a number of winds"));
    let (mut refused, mut failed, mut checked) = (0, Vec::new(), BTreeMap::new());
    for seed in (first..winds).step_by(2) {
        let wind = RandomWind::new(seed);
        assert_eq!(wind.config.validate(), Ok(()), "only valid winds are drawn");
        match run::<R>(&wind) {
            Ok(Outcome::Refused) => refused += 1,
            Ok(Outcome::Stepped(class, growth)) => {
                let (count, grown, largest) = checked.entry(class).or_insert((0, 0, 0.0_f64));
                *count += 1;
                *grown += u64::from(growth > 1.0 + ENERGY_TOLERANCE);
                *largest = largest.max(growth);
            }
            Err(why) => failed.push(format!("wind {seed}: {why}\n{wind:?}")),
        }
    }
    println!("{refused} are refused. Of the others:");
    for (class, (count, grown, largest)) in &checked {
        if matches!(class, Energy::Driven | Energy::Still) {
            println!("{class:?}: {count}");
        } else {
            println!("{class:?}: {count}, of which {grown} gained energy; at most {largest:.5} of the start");
        }
    }
    assert!(failed.is_empty(), "{} fail:\n{}", failed.len(), failed.join("\n"));
    assert!(refused < winds / 8, "{refused} refused: too few tell anything");
    for (class, least) in [(Energy::Closed, 80), (Energy::Solved, 20), (Energy::Traced, 80)] {
        assert!(checked.get(&class).is_some_and(|(count, ..)| *count > least), "few are {class:?}: {checked:?}");
    }
}

#[test]
fn a_thousand_random_winds_in_single_precision_are_rejected_or_stay_finite() {
    check::<f32>(0);
}

#[test]
fn a_thousand_random_winds_in_double_precision_are_rejected_or_stay_finite() {
    check::<f64>(1);
}
