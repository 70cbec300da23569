//! Boxes of air for the tests of the wind.

use server::wind::{Boundary, Config, Gusts, Profile, Real, Solver};

use crate::norms::Norms;

/// Settings of still air in a box, with nothing that drives it: default methods, no friction.
pub fn still_air(cells: [usize; 3], spacing_m: [f64; 3], boundary: [[Boundary; 2]; 3]) -> Config {
    Config {
        cells,
        spacing_m: spacing_m.map(|h| h as f32),
        boundary,
        viscosity_m2_per_s: 0.0,
        mean_wind_m_per_s: [0.0; 3],
        profile: Profile::Uniform,
        relaxation_per_sec: 0.0,
        gusts: Gusts { number: 0, ..Gusts::default() },
        ..Config::default()
    }
}

/// Takes `steps` steps to `secs` (s).
///
/// # Panics
/// If a step fails.
pub fn run<R: Real>(air: &mut Solver<R>, secs: f64, steps: usize) {
    for _ in 0..steps {
        air.step(secs / steps as f64, &[]).expect("within the limits of the method");
    }
}

/// Norms of the differences (m/s) between the velocity and `exact` of position (m), over all components but those across axes of one cell.
pub fn velocity_error<R: Real>(air: &Solver<R>, exact: impl Fn([f64; 3]) -> [f64; 3]) -> Norms {
    let (cells, exact) = (air.grid().cells, &exact);
    let moving = (0..3).filter(|&axis| cells[axis] > 1);
    Norms::of(moving.flat_map(|axis| air.samples(axis).map(move |(position, found)| (found.wide(), exact(position.map(R::wide))[axis]))))
}

/// Norms of the differences (m/s) between the velocities of two solvers with the same grid.
pub fn velocity_difference<R: Real>(air: &Solver<R>, other: &Solver<R>) -> Norms {
    let pairs = |axis: usize| air.samples(axis).zip(other.samples(axis)).map(|((_, a), (_, b))| (a.wide(), b.wide()));
    Norms::of((0..3).filter(|&axis| air.grid().cells[axis] > 1).flat_map(pairs))
}

/// A number from −1 to 1 that looks random (SplitMix64): the same for the same `n`.
pub fn noise(n: u64) -> f64 {
    let mut bits = n.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    (bits ^ (bits >> 31)) as f64 / 2.0f64.powi(63) - 1.0
}
