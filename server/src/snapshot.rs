//! What the world shows of itself after a step, already quantised for the wire (`shared::wire::quantise`).
//!
//! A snapshot is cheap to hold and to share: whatever did not change since the one before is the same `Arc`.

use crate::plants::BrokenPlants;
use shared::grid::PatchIndex;
use shared::wire::ObjectPose;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The bend field by patch; one that is missing is at rest.
pub type BentPatches = BTreeMap<PatchIndex, Arc<PatchCodes>>;

/// The state of the world after a step.
#[derive(Clone, Debug, Default)]
pub struct Snapshot {
    /// Number of the step, from 0 before the first.
    pub tick: u64,
    /// Simulated time (s).
    pub time_secs: f64,
    /// Every object.
    pub objects: Vec<ObjectPose>,
    /// Most objects at once.
    pub object_limit: u32,
    /// The wind.
    pub wind: Arc<WindFrame>,
    /// The bend field.
    pub patches: Arc<BentPatches>,
    /// Broken plants of the underbrush: those of a snapshot before, and newer ones after them.
    pub broken: BrokenPlants,
    /// The scalars that tell how the world fares.
    pub health: Health,
}

/// The wind at the cells' centres.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct WindFrame {
    /// Step that it belongs to.
    pub tick: u64,
    /// Cells along X, Y and Z.
    pub cells: [u32; 3],
    /// Three planes (u, v, w) of wind codes, x fastest, then y, then z; a fourth of dust codes in a scene with dust.
    pub codes: Vec<i8>,
}

impl WindFrame {
    /// Number of cells, and so of codes in a plane.
    pub fn volume(&self) -> usize {
        self.cells.iter().map(|&n| n as usize).product()
    }

    /// Whether there is a plane of dust.
    pub fn has_dust(&self) -> bool {
        self.codes.len() > 3 * self.volume()
    }
}

/// The bend field of one patch.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PatchCodes {
    /// Step at which the codes last changed.
    pub tick: u64,
    /// Three planes (θ, ωx, ωz) of `cells × cells` codes, row by row from the north-west.
    pub codes: Vec<i8>,
}

/// How the world fares.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Health {
    /// Mean duration of the steps since the snapshot before (s), by the wall clock; filled in by the runner.
    pub step_secs: f32,
    /// Longest of those steps (s).
    pub step_max_secs: f32,
    /// Root mean square of the wind's divergence after the projection, over that of `|u|/h`.
    pub divergence_rms: f32,
    /// Mean kinetic energy of the wind (J/kg).
    pub wind_energy: f64,
    /// Times since the start that the wind was lost and began anew from its mean.
    pub wind_resets: u64,
    /// Sum of θ² + ω² over the bend field (mixed units).
    pub bend_energy: f64,
    /// Patches that are awake.
    pub awake_patches: u32,
    /// Patches let go since the start because the limit of awake ones was reached.
    pub evicted_patches: u64,
    /// Patches put to rest since the start because their grass moved faster than the scheme can follow, or was no number.
    pub broken_patches: u64,
    /// Tiles of 8 × 8 cells in which objects have laid grass.
    pub laid_tiles: u32,
    /// Patches whose laid grass was let go since the start because there was too much.
    pub dropped_tracks: u64,
    /// Motions of objects refused since the start because they were none.
    pub refused_motions: u64,
    /// Sub-steps of the bend field in the newest step.
    pub substeps: u32,
    /// Largest Courant number of a sub-step of the bend field.
    pub courant: f32,
}
