//! Activity of a patch in tiles of 8 × 8 cells.
//!
//! A tile is active if θ or ω exceeds the tolerance in it. Active tiles and the eight around each are stepped; all others are at rest and cost
//! nothing. A wave crosses at most [`HALO`](super::HALO) cells between two selections, so it never outruns the tiles that step. Without a tolerance
//! nothing is lost. With a tolerance τ, a tile put to rest loses at most τ in each cell, and so does a wave that would have entered a tile at rest;
//! see [`Rest`].

use super::Bend;
use serde::{Deserialize, Serialize};

/// Side of a tile (cells).
pub const TILE: usize = 8;

/// Tolerance within which grass counts as at rest.
///
/// A tile is put to rest when no |θ| and no |ω| in it or in its neighbours exceeds the tolerance. Each time this drops at most τ a cell; with damping
/// these errors decay as the waves do. In 160 random drives θ departed from a field without tolerance by up to 1.0·τ at damping rates from 1 to 12
/// /s, and by up to 1.4·τ below.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rest {
    /// Largest |θ| at rest (rad).
    pub theta_rad: f32,
    /// Largest |ω| at rest (rad/s).
    pub omega_rad_per_s: f32,
}

impl Rest {
    /// Only zero is at rest.
    pub const EXACT: Self = Self { theta_rad: 0.0, omega_rad_per_s: 0.0 };
}

/// Peaks of each tile, whether it steps, and when it last changed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Tiles {
    /// Tiles along one side.
    count: usize,
    /// Largest |θ| and |ω|² at the last two times, as bits, which for non-negative floats sort like the values, with NaN above all. The bits of |ω|²
    /// are at least 1 where ω is not zero.
    peaks: Vec<[u32; 2]>,
    /// Which tiles step, with a ring of the neighbours' tiles: `(count + 2)²`.
    steps: Vec<bool>,
    /// Which tiles are active, with the same ring.
    active: Vec<bool>,
    /// Revision of the field in which each tile last changed.
    changed_in: Vec<u64>,
    /// Revision in progress.
    revision: u64,
    /// Tiles that are pushed in the next step, and so are active however little they move. Empty between steps.
    #[serde(skip)]
    pushed: Vec<usize>,
}

const SIGN: u32 = 1 << 31;

/// Absolute value as bits that sort like the values.
#[inline(always)]
pub(super) fn size_bits(value: f32) -> u32 {
    value.to_bits() & !SIGN
}

/// |ω|² as bits that sort like the values; zero only where ω is zero, even if the square of a small number underflows.
#[inline(always)]
pub(super) fn square_bits(x: f32, z: f32) -> u32 {
    size_bits(x * x + z * z).max((size_bits(x) | size_bits(z)).min(1))
}

impl Tiles {
    pub(super) fn new(side: usize, revision: u64) -> Self {
        let count = side / TILE;
        let ringed = (count + 2) * (count + 2);
        Self {
            count,
            peaks: vec![[0; 2]; count * count],
            steps: vec![false; ringed],
            active: vec![false; ringed],
            changed_in: vec![revision; count * count],
            revision,
            pushed: vec![],
        }
    }

    /// Whether all lists have the lengths for a patch of `side` cells.
    pub(super) fn fits(&self, side: usize) -> bool {
        let own = |tiles: &Self| (tiles.count, tiles.peaks.len(), tiles.steps.len(), tiles.active.len(), tiles.changed_in.len());
        own(self) == own(&Self::new(side, 0))
    }

    pub(super) fn count(&self) -> usize {
        self.count
    }

    /// Index of tile `(x, z)` in the lists with a ring; −1 and `count` are the neighbours' tiles.
    fn ringed(&self, x: i64, z: i64) -> usize {
        (z + 1) as usize * (self.count + 2) + (x + 1) as usize
    }

    pub(super) fn steps(&self, x: i64, z: i64) -> bool {
        self.steps[self.ringed(x, z)]
    }

    pub(super) fn set_steps(&mut self, x: i64, z: i64, steps: bool) {
        let at = self.ringed(x, z);
        self.steps[at] = steps;
    }

    pub(super) fn is_active(&self, x: i64, z: i64) -> bool {
        self.active[self.ringed(x, z)]
    }

    pub(super) fn set_active(&mut self, x: i64, z: i64, active: bool) {
        let at = self.ringed(x, z);
        self.active[at] = active;
    }

    /// Finds the active tiles of the patch; marks the neighbours' tiles as inactive.
    pub(super) fn find_active(&mut self, rest: Rest) {
        self.active.fill(false);
        let limits = [rest.theta_rad.to_bits(), (rest.omega_rad_per_s * rest.omega_rad_per_s).to_bits()];
        for z in 0..self.count {
            for x in 0..self.count {
                let [theta, omega2] = self.peaks[z * self.count + x];
                self.active[(z + 1) * (self.count + 2) + x + 1] = theta > limits[0] || omega2 > limits[1];
            }
        }
        for &tile in &self.pushed {
            let (x, z) = (tile % self.count, tile / self.count);
            self.active[(z + 1) * (self.count + 2) + x + 1] = true;
        }
    }

    /// Makes tile `(x, z)` active in the next step: small pushes add up only in a tile that isn't put to rest between them.
    pub(super) fn push(&mut self, x: usize, z: usize) {
        self.pushed.push(z * self.count + x);
    }

    /// Whether tile `(x, z)` or one of the eight around it is active.
    pub(super) fn is_near_active(&self, x: usize, z: usize) -> bool {
        (0..3).any(|row| {
            let first = (z + row) * (self.count + 2) + x;
            self.active[first..first + 3].contains(&true)
        })
    }

    /// Records the values that a cell was set to.
    pub(super) fn touch(&mut self, i: usize, j: usize, states: [Bend; 2]) {
        let tile = j / TILE * self.count + i / TILE;
        for Bend { theta, omega: [x, z] } in states {
            let [theta_bits, omega2_bits] = &mut self.peaks[tile];
            *theta_bits = (*theta_bits).max(size_bits(theta));
            *omega2_bits = (*omega2_bits).max(square_bits(x, z));
        }
        self.changed_in[tile] = self.revision;
    }

    /// Records the peaks of tile `(x, z)` after a sub-step.
    pub(super) fn set_peaks(&mut self, x: usize, z: usize, peaks: [u32; 2]) {
        let tile = z * self.count + x;
        self.peaks[tile] = peaks;
        self.changed_in[tile] = self.revision;
    }

    /// Whether tile `(x, z)` holds a value other than zero.
    pub(super) fn holds(&self, x: usize, z: usize) -> bool {
        self.peaks[z * self.count + x] != [0; 2]
    }

    /// Whether all tiles are at zero.
    pub(super) fn is_still(&self) -> bool {
        self.peaks.iter().all(|peaks| *peaks == [0; 2])
    }

    /// Whether any tile of the patch or of its ring is active.
    pub(super) fn any_active(&self) -> bool {
        self.active.contains(&true)
    }

    pub(super) fn theta_max_rad(&self) -> f32 {
        f32::from_bits(self.peaks.iter().map(|peaks| peaks[0]).max().unwrap_or_default())
    }

    pub(super) fn omega_max_rad_per_s(&self) -> f32 {
        f32::from_bits(self.peaks.iter().map(|peaks| peaks[1]).max().unwrap_or_default()).sqrt()
    }

    pub(super) fn changed_in(&self) -> &[u64] {
        &self.changed_in
    }

    /// Sets the revision at the end of a step, after which no tile is pushed.
    pub(super) fn set_revision(&mut self, revision: u64) {
        self.revision = revision;
        self.pushed.clear();
    }

    pub(super) fn memory_bytes(&self) -> usize {
        self.peaks.len() * size_of::<[u32; 2]>() + self.steps.len() + self.active.len() + self.changed_in.len() * size_of::<u64>()
    }
}
