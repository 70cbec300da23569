//! The schemes that carry the waves on, and what a step reports.

use crate::scene::words;
use serde::{Deserialize, Serialize};
use thiserror::Error;

words! {
    /// How the waves (001 Eqs 2–3) are carried on in time.
    #[derive(Default)]
    Scheme {
        /// 001 Eqs (5)–(6), one step however long: explicit, first order in time where damped, and beyond
        /// [`courant_limit`](super::limits::courant_limit) it blows up.
        Verlet = "verlet",
        /// The same in as many equal sub-steps as the limit asks for, the damping integrated exactly: second order.
        #[default]
        Substepped = "substepped",
        /// Newmark's average acceleration (β = ¼) by alternating directions (Lees 1962): one step however long, second order, stable for any
        /// step where the speed is constant.
        Implicit = "implicit",
        /// Each mode of the whole grid by its exact solution (in time; in space the same differences as the others). Needs one constant speed
        /// (μ = 0, one kind of grass) and every patch awake.
        Modal = "modal",
    }
}

impl Scheme {
    /// All schemes.
    pub const ALL: [Self; 4] = [Self::Verlet, Self::Substepped, Self::Implicit, Self::Modal];
}

/// What a step took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Report {
    /// Number of sub-steps.
    pub substeps: u32,
    /// Largest Courant number of a sub-step, over its limit: an explicit scheme is stable up to 1.
    pub courant_share: f32,
    /// Cells stepped, times sub-steps; ghosts do not count.
    pub cell_steps: u64,
    /// Patches put to rest because a value in them was no number.
    pub broken: u32,
    /// Patches that energy reached and that stayed asleep, because as many as allowed are awake.
    pub refused: u32,
}

/// Why a field cannot be stepped; it is as it was.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum StepError {
    /// The time step is no length.
    #[error("a step of {dt_secs} s; allowed: a finite number above 0")]
    NoStep {
        /// The step asked for (s).
        dt_secs: f32,
    },
    /// Too many sub-steps.
    #[error("grass that bends at {omega_rad_per_s} rad/s needs more than {allowed} sub-steps in {dt_secs} s")]
    TooFast {
        /// Largest bending speed (rad/s).
        omega_rad_per_s: f32,
        /// Sub-steps allowed.
        allowed: u32,
        /// The step asked for (s).
        dt_secs: f32,
    },
    /// The modal scheme where the speed is not constant.
    #[error(
        "the modal scheme needs one constant speed of θ; here are {kinds} kinds of grass and μ up to {mu_m_per_rad} m/rad; allowed: 1 and 0"
    )]
    SpeedVaries {
        /// Kinds of grass.
        kinds: usize,
        /// Largest μ (m/rad).
        mu_m_per_rad: f32,
    },
    /// The modal scheme on a part of the grid.
    #[error("the modal scheme needs the whole grid; {awake} of {patches} patches are awake, with {seams} seams")]
    NotWhole {
        /// Patches awake.
        awake: usize,
        /// Patches that there are.
        patches: usize,
        /// Name of the seams.
        seams: &'static str,
    },
}
