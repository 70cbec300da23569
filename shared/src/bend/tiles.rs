//! Where in a patch something moves: tiles of 8 × 8 cells.
//!
//! A tile is loud if θ or ω exceeds the tolerance in it. Loud tiles and the eight around each are stepped; all others are at rest and
//! cost nothing. A wave crosses at most [`HALO`](super::HALO) cells between two choices, so it never outruns the tiles that step.
//! With no tolerance nothing is lost. With a tolerance τ, what a tile holds when it is put to rest is at most τ in each cell, and so is
//! what a wave leaves behind that would have gone on into a tile at rest; see [`Rest`].

use super::Bend;

/// Side of a tile (cells).
pub const TILE: usize = 8;

/// What counts as at rest.
///
/// A tile in which no |θ| and no |ω| exceeds the tolerance, and none of its neighbours' does, is put to rest. Each time that drops at most
/// τ a cell; with damping these errors decay as the waves do. In 160 random drives θ departed from that of a field with no tolerance by up to
/// 1.0·τ at damping rates from 1 to 12 /s, by up to 1.4·τ below.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rest {
    /// Largest |θ| at rest (rad).
    pub theta_rad: f32,
    /// Largest |ω| at rest (rad/s).
    pub omega_rad_per_s: f32,
}

impl Rest {
    /// Nothing but zero is at rest.
    pub const EXACT: Self = Self { theta_rad: 0.0, omega_rad_per_s: 0.0 };
}

/// Of each tile: how far from rest it is, whether it steps, whether it has changed.
#[derive(Clone, Debug)]
pub(super) struct Tiles {
    /// Tiles along one side.
    count: usize,
    /// Largest |θ| and |ω|² at the newest two times, as bits: those of numbers that are not negative sort as the numbers do, and what is
    /// no number sorts above all. |ω|² is at least 1 bit where ω is not zero.
    peaks: Vec<[u32; 2]>,
    /// Which tiles step, with a ring of those of the neighbours: `(count + 2)²`.
    steps: Vec<bool>,
    /// Which tiles are loud, with a ring likewise.
    loud: Vec<bool>,
    changed: Vec<bool>,
}

const SIGN: u32 = 1 << 31;

/// A value without its sign, as bits that sort as values do.
#[inline(always)]
pub(super) fn size_bits(value: f32) -> u32 {
    value.to_bits() & !SIGN
}

/// |ω|² as bits that sort as values do; zero only where ω is, while the square of a small number vanishes.
#[inline(always)]
pub(super) fn square_bits(x: f32, z: f32) -> u32 {
    size_bits(x * x + z * z).max((size_bits(x) | size_bits(z)).min(1))
}

impl Tiles {
    pub(super) fn new(side: usize) -> Self {
        let count = side / TILE;
        let ringed = (count + 2) * (count + 2);
        Self {
            count,
            peaks: vec![[0; 2]; count * count],
            steps: vec![false; ringed],
            loud: vec![false; ringed],
            changed: vec![true; count * count],
        }
    }

    pub(super) fn count(&self) -> usize {
        self.count
    }

    /// Place in the ringed lists of tile `(x, z)`, −1 and `count` being the neighbours'.
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

    pub(super) fn is_loud(&self, x: i64, z: i64) -> bool {
        self.loud[self.ringed(x, z)]
    }

    pub(super) fn set_loud(&mut self, x: i64, z: i64, loud: bool) {
        let at = self.ringed(x, z);
        self.loud[at] = loud;
    }

    /// Finds the loud tiles among its own, and takes those of the neighbours for quiet.
    pub(super) fn listen(&mut self, rest: Rest) {
        self.loud.fill(false);
        let limits = [rest.theta_rad.to_bits(), (rest.omega_rad_per_s * rest.omega_rad_per_s).to_bits()];
        for z in 0..self.count {
            for x in 0..self.count {
                let [theta, omega2] = self.peaks[z * self.count + x];
                self.loud[(z + 1) * (self.count + 2) + x + 1] = theta > limits[0] || omega2 > limits[1];
            }
        }
    }

    /// Whether tile `(x, z)` or one of the eight around it is loud.
    pub(super) fn hears(&self, x: usize, z: usize) -> bool {
        (0..3).any(|row| {
            let first = (z + row) * (self.count + 2) + x;
            self.loud[first..first + 3].contains(&true)
        })
    }

    /// Notes what a cell was set to.
    pub(super) fn touch(&mut self, i: usize, j: usize, states: [Bend; 2]) {
        let tile = j / TILE * self.count + i / TILE;
        for Bend { theta, omega: [x, z] } in states {
            let [theta_bits, omega2_bits] = &mut self.peaks[tile];
            *theta_bits = (*theta_bits).max(size_bits(theta));
            *omega2_bits = (*omega2_bits).max(square_bits(x, z));
        }
        self.changed[tile] = true;
    }

    /// Notes what a sub-step left in tile `(x, z)`.
    pub(super) fn set_peaks(&mut self, x: usize, z: usize, peaks: [u32; 2]) {
        let tile = z * self.count + x;
        self.peaks[tile] = peaks;
        self.changed[tile] = true;
    }

    /// Whether tile `(x, z)` holds anything but zero.
    pub(super) fn holds(&self, x: usize, z: usize) -> bool {
        self.peaks[z * self.count + x] != [0; 2]
    }

    /// Whether all tiles are at zero.
    pub(super) fn is_still(&self) -> bool {
        self.peaks.iter().all(|peaks| *peaks == [0; 2])
    }

    /// Whether any tile is loud, of its own or of its neighbours.
    pub(super) fn hears_any(&self) -> bool {
        self.loud.contains(&true)
    }

    pub(super) fn theta_max_rad(&self) -> f32 {
        f32::from_bits(self.peaks.iter().map(|peaks| peaks[0]).max().unwrap_or_default())
    }

    pub(super) fn omega_max_rad_per_s(&self) -> f32 {
        f32::from_bits(self.peaks.iter().map(|peaks| peaks[1]).max().unwrap_or_default()).sqrt()
    }

    pub(super) fn changed(&self) -> &[bool] {
        &self.changed
    }

    pub(super) fn forget_changes(&mut self) {
        self.changed.fill(false);
    }

    pub(super) fn memory_bytes(&self) -> usize {
        self.peaks.len() * size_of::<[u32; 2]>() + self.steps.len() + self.loud.len() + self.changed.len()
    }
}
