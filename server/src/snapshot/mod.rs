//! Published snapshots: the state of the world after a step, quantised for the wire (`prairie_core::wire::quantise`).
//!
//! A snapshot is cheap to keep and to share: unchanged parts are the same `Arc` as in the previous one.

mod broken_plants;

pub use broken_plants::BrokenPlants;
pub use prairie_core::grass::{Audience, BentPatches, PatchCodes, PatchQuantiser};

use crate::detail::Decision;
use prairie_core::grass::StepRecord;
use prairie_core::wire::{AppliedInput, Ghost, ObjectPose, Standing, TurbulenceState};
use std::collections::BTreeMap;
use std::sync::Arc;

/// The state of the world after a step.
#[derive(Clone, Debug, Default)]
pub struct Snapshot {
    /// Number of steps so far.
    pub tick: u64,
    /// Simulated time (s).
    pub time_secs: f64,
    /// Poses of all objects.
    pub objects: Vec<ObjectPose>,
    /// The newest input of each driven vehicle, by its client.
    pub inputs: BTreeMap<u32, AppliedInput>,
    /// Limit of the number of objects.
    pub object_limit: u32,
    /// The wind.
    pub wind: Arc<WindFrame>,
    /// The bend field, where somebody takes it.
    pub patches: Arc<BentPatches>,
    /// The patches that somebody takes.
    pub audience: Audience,
    /// Broken plants of the underbrush, oldest first.
    pub broken: BrokenPlants,
    /// The race, the first in front; at most [`STANDINGS_LIMIT`](prairie_core::wire::STANDINGS_LIMIT).
    pub standings: Vec<Standing>,
    /// The fastest lap of the race.
    pub ghost: Option<Arc<Ghost>>,
    /// The newest steps of the grass, oldest first.
    pub steps: Vec<Arc<StepRecord>>,
    /// The newest decisions about the detail, oldest first.
    pub decisions: Vec<Decision>,
    /// Step diagnostics.
    pub diagnostics: Diagnostics,
}

/// The wind at the cell centres.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WindFrame {
    /// Step of the wind.
    pub tick: u64,
    /// Cells along X, Y and Z.
    pub cells: [u32; 3],
    /// State of the gusts between the cells.
    pub turbulence: TurbulenceState,
    /// Three planes (u, v, w) of wind codes, x fastest, then y, then z. A scene with dust has a fourth plane of dust codes.
    pub codes: Vec<i16>,
}

impl WindFrame {
    /// Number of cells, which is the number of codes in a plane.
    pub fn volume(&self) -> usize {
        self.cells.iter().map(|&n| n as usize).product()
    }

    /// Whether there is a plane of dust codes.
    pub fn has_dust(&self) -> bool {
        self.codes.len() > 3 * self.volume()
    }
}

/// Step diagnostics.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Diagnostics {
    /// Mean duration of the steps since the previous snapshot (s), wall-clock time; set by the runner.
    pub step_secs: f32,
    /// Longest of those steps (s).
    pub step_max_secs: f32,
    /// Relative divergence of the wind after projection: root mean square of the divergence, divided by that of `|u|/h`.
    pub divergence_rms: f32,
    /// Mean kinetic energy of the wind (J/kg).
    pub wind_energy: f64,
    /// Number of wind restarts from the mean wind after a failed step, since the start.
    pub wind_resets: u64,
    /// Sum of θ² + ω² over the bend field (mixed units).
    pub bend_activity: f64,
    /// Awake patches.
    pub awake_patches: u32,
    /// Patches put to sleep because of the limit of awake patches, since the start.
    pub evicted_patches: u64,
    /// Patches put to rest because their grass moved faster than the scheme can follow, or was NaN or infinite, since the start.
    pub reset_patches: u64,
    /// Tiles of 8 × 8 cells with flattened grass.
    pub laid_tiles: u32,
    /// Patches whose flattened grass was dropped because of the limit, since the start.
    pub dropped_tracks: u64,
    /// Motions of objects rejected as invalid (NaN, infinite or out of range), since the start.
    pub rejected_motions: u64,
    /// Sub-steps of the bend field in the newest step.
    pub substeps: u32,
    /// Largest Courant number of a sub-step of the bend field.
    pub courant: f32,
    /// Duration of a step of the wind's solver (s).
    pub wind_step_secs: f32,
    /// Estimated error of the wind that the grass feels, from the solver's time step, over the two seconds of a pilot run (m/s); 0 where nobody watches it.
    pub wind_step_error_m_per_s: f32,
    /// The same of steps twice as long.
    pub wind_doubled_error_m_per_s: f32,
    /// Number of estimates of the first of these errors.
    pub wind_step_samples: u64,
    /// The same of steps twice as long.
    pub wind_doubled_samples: u64,
    /// Estimated error of the bending angle from the time step, over the time in which waves decay (degrees); 0 where nobody watches it.
    pub bend_step_error_deg: f32,
    /// Most awake patches at present.
    pub awake_limit: u32,
    /// How much gives way to the load at present: a place in [`LOAD_LEVELS`](crate::detail::LOAD_LEVELS).
    pub load_level: u32,
    /// Number of decisions about the detail.
    pub decisions: u64,
}
