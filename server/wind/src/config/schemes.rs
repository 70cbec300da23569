//! Time schemes and diffusion schemes.

use crate::advect::Advection;
use crate::named::named_enum;

named_enum! {
    /// How advection, forces, diffusion and pressure are combined in a step.
    TimeScheme {
        /// One after the other (Zhang §2.3.5). With any advection scheme.
        Split = "split",
        /// Advection–reflection: two half steps of advection by the mid-step velocity, with a reflection about the projected velocity between them, and forces and
        /// diffusion in halves before and after (Narain et al. 2019). Three projections. With the semi-Lagrangian family.
        Reflection = "reflection",
        /// Incremental pressure correction: Runge–Kutta 3 with the pressure gradient of the previous step, corrected by one projection at the end
        /// (Van Kan 1986). With conservative advection.
        RungeKutta3 = "runge-kutta-3",
    }
}

impl TimeScheme {
    /// Formal order of accuracy in time.
    pub fn order(self) -> u32 {
        match self {
            Self::Split => 1,
            Self::Reflection | Self::RungeKutta3 => 2,
        }
    }

    /// Whether the scheme can be combined with an advection scheme of the velocity.
    pub fn allows(self, advection: Advection) -> bool {
        match self {
            Self::Split => true,
            Self::Reflection => !advection.uses_fluxes(),
            Self::RungeKutta3 => advection.uses_fluxes(),
        }
    }
}

/// Diffusion scheme of velocity and dust.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Diffusion {
    /// Explicit, with sub-steps where the step exceeds the stability limit (`ν·dt/h² = 1/6` on cubes).
    Explicit,
    /// Backward Euler by a fixed number of Gauss–Seidel sweeps (Zhang §2.3.2). First order in dt, stable at any step.
    GaussSeidel {
        /// Number of sweeps, at least 1; 20 in Zhang.
        sweeps: u32,
    },
    /// Backward Euler, solved exactly by transforms. First order in dt, stable at any step. Requires a box without solid cells.
    Implicit,
    /// Crank–Nicolson, its implicit half solved by transforms; with Runge–Kutta 3, beyond the limit of the explicit scheme, an L-stable scheme. Second order in dt,
    /// stable at any step. Requires a box without solid cells.
    CrankNicolson,
}
