//! Boxes of air for the tests of the wind.

use prairie_core::random::SplitMix64;
use prairie_wind::{Boundary, Config, Gusts, Profile, Real, Solver};

use crate::norms::Norms;

/// Configuration of still air in a box: default methods, no viscosity, no forcing.
pub fn still_air(cells: [usize; 3], spacing_m: [f64; 3], boundary: [[Boundary; 2]; 3]) -> Config {
    Config {
        cells,
        spacing_m: spacing_m.map(|h| h as f32),
        boundary,
        viscosity_m2_per_s: 0.0,
        mean_wind_m_per_s: [0.0; 3],
        profile: Profile::Uniform,
        relaxation_per_s: 0.0,
        gusts: Gusts { number: 0, ..Gusts::default() },
        ..Config::default()
    }
}

/// Integrates `secs` (s) in `steps` equal steps.
///
/// # Panics
/// If a step fails.
pub fn run<R: Real>(air: &mut Solver<R>, secs: f64, steps: usize) {
    for _ in 0..steps {
        air.step(secs / steps as f64, &[]).expect("within the limits of the method");
    }
}

/// Norms of the velocity error (m/s) against `exact`, a function of position (m). Axes with a single cell are left out.
pub fn velocity_error<R: Real>(air: &Solver<R>, exact: impl Fn([f64; 3]) -> [f64; 3]) -> Norms {
    let (cells, exact) = (air.grid().cells, &exact);
    let moving = (0..3).filter(|&axis| cells[axis] > 1);
    Norms::of(moving.flat_map(|axis| air.samples(axis).map(move |(position, found)| (found.wide(), exact(position.map(R::wide))[axis]))))
}

/// Norms of the velocity difference (m/s) between two solvers on the same grid.
pub fn velocity_difference<R: Real>(air: &Solver<R>, other: &Solver<R>) -> Norms {
    let pairs = |axis: usize| air.samples(axis).zip(other.samples(axis)).map(|((_, a), (_, b))| (a.wide(), b.wide()));
    Norms::of((0..3).filter(|&axis| air.grid().cells[axis] > 1).flat_map(pairs))
}

/// Pseudorandom number from −1 to 1 (SplitMix64), a function of `n`.
pub fn noise(n: u64) -> f64 {
    SplitMix64::nth(n) as f64 / 2.0f64.powi(63) - 1.0
}
