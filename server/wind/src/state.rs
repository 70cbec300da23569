//! Checkpoints, step reports and errors.

use super::Jet;

/// Maximum number of sub-steps of a step; see [`StepError::TooLong`].
pub const MAX_SUBSTEPS: u32 = 256;

/// Diagnostics of a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepReport {
    /// Courant number of the whole step: the sum over the axes of `max|u|·dt/h`.
    pub courant: f64,
    /// Relative divergence (dimensionless): rms of `∇·u` over the rms of `|u|/h`, h the smallest spacing. About 1e-7 with a direct pressure solver in f32.
    pub divergence_rms_rel: f64,
    /// Mean kinetic energy per mass, `|u|²/2` (m²/s²).
    pub kinetic_energy_m2_per_s2: f64,
    /// Number of sub-steps, at least 1.
    pub substeps: u32,
    /// Residual of the last pressure solve relative to its right-hand side; 0 for the direct solver, and around its walls the slip relative to the speed of the air.
    pub pressure_residual: f64,
    /// Sweeps of the last pressure solve; 0 for the direct solver, and iterations around its walls.
    pub pressure_sweeps: u32,
}

/// Why a step could not be taken.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StepError {
    /// The time step is not positive and finite. Nothing was changed.
    #[error("wind: dt_secs is {dt_secs}; allowed: above 0, finite")]
    BadTimeStep {
        /// The requested step (s).
        dt_secs: f64,
    },
    /// A jet with a number out of range. Nothing was changed.
    #[error("wind: jets[{index}] is {jet:?}; allowed: finite numbers, radius_m above 0, rate_per_s 0 or more")]
    BadJet {
        /// Index in the list.
        index: usize,
        /// The jet.
        jet: Jet,
    },
    /// The step exceeds the stability limit of a scheme. The state is restored to that before the step, or before the sub-step that was too long.
    #[error(
        "wind: {what} over dt_secs = {dt_secs} needs {needed:.0} sub-steps of at most {stable_dt_secs} s; allowed: {MAX_SUBSTEPS}. Take a shorter step, larger cells or a smaller value"
    )]
    TooLong {
        /// The limit, or the setting that causes it.
        what: &'static str,
        /// The requested step (s).
        dt_secs: f64,
        /// Number of sub-steps needed.
        needed: f64,
        /// Longest stable sub-step (s).
        stable_dt_secs: f64,
    },
    /// The velocity became NaN or infinite. The state is lost; restore an earlier one by [`Solver::restore`](super::Solver::restore).
    #[error("wind: velocity is not finite after the step at {time_secs} s, first in cell {cell:?}")]
    NotFinite {
        /// The first such cell along x, then y, then z.
        cell: [usize; 3],
        /// Time (s) before the step.
        time_secs: f64,
    },
}

/// A checkpoint. A solver with the same settings continues from it bit for bit.
#[derive(Clone, Debug, PartialEq)]
pub struct State<R> {
    /// Time since the start (s).
    pub time_secs: f64,
    /// Velocity components on their faces (m/s), without ghosts.
    pub velocity: [Vec<R>; 3],
    /// Gradient of the pressure over density (m/s²) on the same faces.
    pub pressure_gradient: [Vec<R>; 3],
    /// Concentration of dust at cell centres; empty without dust.
    pub dust: Vec<R>,
    /// Displacement of the tops of the grass (m) along x and z, and their velocity (m/s) along x and z: those along x in the columns of faces across x, those along z in
    /// the columns of faces across z, `cells[0] + 1` in a row along x, `cells[2] + 1` rows. Empty if the canopy does not move.
    pub stems: [Vec<R>; 4],
}

/// A checkpoint of another grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("wind: state has {found} values of {what}; this grid has {expected}")]
pub struct StateError {
    /// The field.
    pub what: &'static str,
    /// Number of values in the checkpoint.
    pub found: usize,
    /// Number of values in the solver.
    pub expected: usize,
}

impl StateError {
    pub(super) fn check(what: &'static str, found: usize, expected: usize) -> Result<(), Self> {
        if found == expected { Ok(()) } else { Err(Self { what, found, expected }) }
    }
}

/// Reason why solids cannot be set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SolidError {
    /// [`StableFluids`](super::StableFluids) has no solid cells.
    #[error("wind: the method is StableFluids; allowed with solid cells: Staggered")]
    Method,
    /// The pressure solver uses transforms.
    #[error("wind: pressure is Direct; allowed with solid cells: Multigrid, ConjugateGradients, Sor, GaussSeidel or Jacobi")]
    Pressure,
    /// The pressure solver iterates.
    #[error("wind: pressure is iterative; allowed with immersed walls: Direct")]
    Iterative,
    /// The time scheme reflects the velocity about its projection.
    #[error("wind: time is Reflection; allowed with immersed walls: Split or RungeKutta3")]
    Reflection,
    /// The diffusion scheme uses transforms.
    #[error("wind: diffusion is solved by transforms; allowed with solid cells: Explicit or GaussSeidel")]
    Diffusion,
    /// A body has a number that is not allowed.
    #[error(
        "wind: body {index} has a number that is not finite or below 0, or no width; allowed: finite centre, velocity and axes, half extents above 0 (from 0 for drag bodies), drag from 0"
    )]
    Body {
        /// Its index in the list.
        index: usize,
    },
    /// Every cell would be solid.
    #[error("wind: every cell would be solid; allowed: at least one cell of air")]
    Full,
}
