//! What a solver can be saved to, what a step tells, and why either can fail.

use super::Jet;

/// Most parts a step is cut into; see [`StepError::TooLong`].
pub const MAX_SUBSTEPS: u32 = 256;

/// What a step did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepReport {
    /// Sum over the axes of the largest `|u|·dt/h`, over the whole step.
    pub courant: f64,
    /// Root mean square of the divergence over that of `|u|/h`; rounding keeps it near 1e-7 in f32 with a direct pressure.
    pub divergence_rms_rel: f64,
    /// Mean of `|u|²/2` (m²/s²).
    pub kinetic_energy_m2_per_s2: f64,
    /// Parts the step was cut into, at least 1.
    pub substeps: u32,
    /// Residual of the last pressure solve relative to its right-hand side; 0 for the direct one.
    pub pressure_residual: f64,
    /// Sweeps of the last pressure solve; 0 for the direct one.
    pub pressure_sweeps: u32,
}

/// Why a step could not be taken.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StepError {
    /// The step is no positive, finite time. Nothing was changed.
    #[error("wind: dt_secs is {dt_secs}; allowed: above 0, finite")]
    BadTimeStep {
        /// The step asked for.
        dt_secs: f64,
    },
    /// A jet with a number out of range. Nothing was changed.
    #[error("wind: jets[{index}] is {jet:?}; allowed: finite numbers, radius_m above 0, rate_per_sec 0 or more")]
    BadJet {
        /// Its place in the list.
        index: usize,
        /// The jet.
        jet: Jet,
    },
    /// The step is too long for the stability limit of its method. The air is as it was before the step, or before the part of it that was too long.
    #[error(
        "wind: {what} over dt_secs = {dt_secs} needs {needed:.0} substeps of at most {stable_dt_secs} s; allowed: {MAX_SUBSTEPS}. Take a shorter step, larger cells or a smaller value"
    )]
    TooLong {
        /// The limit, and the setting or flow that asks for it.
        what: &'static str,
        /// The step asked for.
        dt_secs: f64,
        /// Substeps it would take.
        needed: f64,
        /// Longest stable substep.
        stable_dt_secs: f64,
    },
    /// The velocity stopped being a number. The state is lost: [`Solver::restore`](super::Solver::restore) an earlier one.
    #[error("wind: velocity is not finite after the step at {time_secs} s, first in cell {cell:?}")]
    NotFinite {
        /// The first such cell along x, then y, then z.
        cell: [usize; 3],
        /// Time (s) before the step.
        time_secs: f64,
    },
}

/// All that a solver with the same settings needs to go on with the same bits.
#[derive(Clone, Debug, PartialEq)]
pub struct State<R> {
    /// Time since the start (s).
    pub time_secs: f64,
    /// Velocity components on their faces (m/s), without ghosts.
    pub velocity: [Vec<R>; 3],
    /// Gradient of the pressure over density (m/s²) on the same faces.
    pub pull: [Vec<R>; 3],
    /// Dust at the centres of cells; empty without dust.
    pub dust: Vec<R>,
}

/// A state that does not fit the solver's grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("wind: state has {found} values of {what}; this grid has {expected}")]
pub struct StateError {
    /// The field in question.
    pub what: &'static str,
    /// Values in the state.
    pub found: usize,
    /// Values in the solver.
    pub expected: usize,
}

impl StateError {
    pub(super) fn check(what: &'static str, found: usize, expected: usize) -> Result<(), Self> {
        if found == expected { Ok(()) } else { Err(Self { what, found, expected }) }
    }
}

/// Why cells cannot be made solid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SolidError {
    /// The method of 000 knows no solid cells.
    #[error("wind: the method is StableFluids; allowed with solid cells: Staggered")]
    Method,
    /// The pressure is solved by transforms.
    #[error("wind: pressure is Direct; allowed with solid cells: Multigrid, ConjugateGradients, Sor, GaussSeidel or Jacobi")]
    Pressure,
    /// Friction is solved by transforms.
    #[error("wind: diffusion is solved by transforms; allowed with solid cells: Explicit or GaussSeidel")]
    Diffusion,
    /// Nothing is left to the air.
    #[error("wind: every cell would be solid; allowed: at least one cell of air")]
    Full,
}
