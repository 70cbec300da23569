//! Reference solutions of the bend field.
//!
//! | problem | tested property |
//! |---|---|
//! | [`Mode`] | a standing wave between any edges: orders, frequency and decay |
//! | [`Recurrence`] | the exact recurrence of a mode under a scheme |
//! | [`Pulse`] | a round pulse that spreads, in the continuum |
//! | [`Energy`] | the discrete energy, conserved without damping |
//! | [`OneGrid`] | the explicit scheme on one grid, straight from its formula: patches and tiles must equal it |
//! | [`Striker`] | round objects that strike the grass (Chen & Johan, Eqs. 1 and 10–12) |
//! | [`Draw`] | random grass and objects from the ranges of Chen & Johan |

mod draw;
mod energy;
mod mode;
mod one_grid;
mod pulse;
mod recurrence;
mod striker;
mod threads;

pub use draw::{Course, Draw};
pub use energy::Energy;
pub use mode::{Mode, Oscillation};
pub use one_grid::{OneGrid, Real};
pub use pulse::Pulse;
pub use recurrence::{Recurrence, Steps};
pub use striker::Striker;
pub use threads::Threads;

use prairie_core::bend::{Bend, CHANNELS, Field, WaveParams};

/// The same speed (m/s), damping rate (1/s) and stiffness (1/s²) for θ and ω, and no μ: all three channels then obey one equation.
pub fn alike(speed_m_per_s: f32, damping_per_s: f32, stiffness_per_s2: f32) -> WaveParams {
    WaveParams {
        c0_m_per_s: speed_m_per_s,
        mu_m_per_rad: 0.0,
        c_omega_m_per_s: speed_m_per_s,
        theta_damping_per_s: damping_per_s,
        omega_damping_per_s: damping_per_s,
        stiffness_per_s2,
    }
}

/// A state with one value in all three channels, each multiplied by its own factor.
pub fn in_all_channels(value: f64) -> Bend {
    let [theta, x, z] = FACTORS.map(|factor| (factor * value) as f32);
    Bend { theta, omega: [x, z] }
}

/// Factors of [`in_all_channels`].
pub const FACTORS: [f64; CHANNELS] = [1.0, 0.6, -1.7];

/// θ, ωx, ωz of a state.
pub fn channels(bend: Bend) -> [f32; CHANNELS] {
    [bend.theta, bend.omega[0], bend.omega[1]]
}

/// Cells of a field along X and Z.
pub fn size(field: &Field) -> [usize; 2] {
    field.layout().count.map(|count| count as usize * field.layout().cells as usize)
}

/// Every cell of the awake patches: its indices in the world, its state, and its state one sub-step earlier.
pub fn cells(field: &Field) -> impl Iterator<Item = ([usize; 2], [Bend; 2])> {
    field.awake().flat_map(|patch| {
        let side = patch.side();
        let corner = field.layout().place(patch.index()).map(|n| n as usize * side);
        (0..side * side).map(move |n| {
            let (i, j) = (n % side, n / side);
            ([corner[0] + i, corner[1] + j], [patch.bend(i, j), patch.bend_before(i, j)])
        })
    })
}

/// Largest |θ| of a field (rad), and its largest difference from another's: cells of one may sleep in the other.
pub fn largest_difference(a: &Field, b: &Field) -> [f32; 2] {
    let one_way = |from: &Field, to: &Field| {
        cells(from).fold([0.0f32; 2], |[most, apart], (cell, [now, _])| {
            let other = to.cell(cell.map(|n| n as i64));
            [most.max(now.theta.abs()), apart.max((now.theta - other.theta).abs())]
        })
    };
    let ([most, there], [_, back]) = (one_way(a, b), one_way(b, a));
    [most, there.max(back)]
}

/// Sets every cell of the world from its indices: the state now and `dt_secs` ago, in all channels.
pub fn start(field: &mut Field, dt_secs: f64, value: impl Fn([usize; 2]) -> [f64; 2]) {
    let cell_m = field.layout().cell_m;
    field.start(dt_secs as f32, |at_m| value(at_m.map(|m| (m / cell_m) as usize)).map(in_all_channels));
}
