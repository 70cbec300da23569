//! Time-integration schemes, and the report of a step.

use crate::scene::words;
use serde::{Deserialize, Serialize};
use thiserror::Error;

words! {
    /// Time-integration scheme of the wave equations (Chen & Johan Eqs 2–3).
    #[derive(Default)]
    Scheme {
        /// Chen & Johan Eqs (5)–(6) in one step of any length: explicit, first order in time with damping, unstable beyond
        /// [`courant_limit`](super::limits::courant_limit).
        Verlet = "verlet",
        /// Explicit as well, in as many equal sub-steps as the limit requires, with exact damping and with momentum kept where the speed varies: second
        /// order.
        #[default]
        Substepped = "substepped",
        /// Newmark's average acceleration (β = ¼) by alternating directions (Lees 1962): one step of any length, second order and stable for any step
        /// where the speed is constant; first order where it varies.
        Implicit = "implicit",
        /// Exact in time for each mode of the whole grid, with the same finite differences in space as the others. Needs one constant speed (μ = 0,
        /// one kind of grass), every patch awake, and the feature `modal`.
        Modal = "modal",
    }
}

/// Statistics of a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// Number of sub-steps.
    pub substeps: u32,
    /// Largest Courant number of a sub-step relative to its limit: an explicit scheme is stable up to 1.
    pub courant_fraction: f32,
    /// Cells stepped, times sub-steps, without ghosts.
    pub cell_steps: u64,
    /// Patches put to rest because they held a NaN or infinite value.
    pub reset_patches: u32,
    /// Number of patches that a wave reached, but that stayed asleep because of the limit on awake patches.
    pub refused: u32,
}

/// Reasons why a field cannot be stepped; it is then unchanged.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum StepError {
    /// The time step is not a positive finite number.
    #[error("a step of {dt_secs} s; allowed: a finite number above 0")]
    NoStep {
        /// The requested step (s).
        dt_secs: f32,
    },
    /// Too many sub-steps.
    #[error("grass that bends at {omega_rad_per_s} rad/s needs more than {allowed} sub-steps in {dt_secs} s")]
    TooFast {
        /// Largest bending velocity (rad/s).
        omega_rad_per_s: f32,
        /// Largest allowed number of sub-steps.
        allowed: u32,
        /// The requested step (s).
        dt_secs: f32,
    },
    /// The modal scheme with a variable speed.
    #[error(
        "the modal scheme needs one constant speed of θ; here are {kinds} kinds of grass and μ up to {mu_m_per_rad} m/rad; allowed: 1 and 0"
    )]
    SpeedVaries {
        /// Kinds of grass.
        kinds: usize,
        /// Largest μ (m/rad).
        mu_m_per_rad: f32,
    },
    /// The modal scheme in a build without it.
    #[error("the modal scheme is not in this build; allowed: another scheme, or a build of prairie-core with the feature `modal`")]
    Unavailable,
    /// The modal scheme on part of the grid.
    #[error("the modal scheme needs the whole grid; {awake} of {patches} patches are awake, with {seams} seams")]
    NotWhole {
        /// Number of awake patches.
        awake: usize,
        /// Number of patches in the world.
        patches: usize,
        /// Name of the seams.
        seams: &'static str,
    },
}
