//! One patch of the field: three channels at two times, with a ring of ghost cells.

use super::Extremes;
use super::extremes::LargestOf;

/// State of one cluster of grass.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bend {
    /// Bending angle (rad), 0 where the wind alone would hold the grass.
    pub theta: f32,
    /// Bending velocity along X and Z (rad/s); its direction is the direction of the bend.
    pub omega: [f32; 2],
}

/// Number of channels: θ, ωx, ωz.
pub const CHANNELS: usize = 3;

/// A square patch of `side × side` cells (a multiple of 8) inside a ring of ghosts; row-major from the north-west, `(side + 2)²` values a
/// channel.
#[derive(Clone, Debug, PartialEq)]
pub struct Patch {
    side: usize,
    /// Channels at the newest time.
    pub(super) now: [Vec<f32>; CHANNELS],
    /// Channels one sub-step earlier; ghosts are unused.
    pub(super) before: [Vec<f32>; CHANNELS],
    /// Sub-step (s) between the two times; none before the first.
    dt_secs: Option<f32>,
}

impl Patch {
    /// A patch at rest.
    pub fn new(side: usize) -> Self {
        let zeros = || vec![0.0; (side + 2) * (side + 2)];
        Self { side, now: std::array::from_fn(|_| zeros()), before: std::array::from_fn(|_| zeros()), dt_secs: None }
    }

    /// Cells along one side.
    pub fn side(&self) -> usize {
        self.side
    }

    /// Distance between rows in the channel slices: `side + 2`.
    pub fn stride(&self) -> usize {
        self.side + 2
    }

    /// Index of cell `(i, j)` in the channel slices.
    pub fn at(&self, i: usize, j: usize) -> usize {
        debug_assert!(i < self.side && j < self.side);
        (j + 1) * self.stride() + i + 1
    }

    /// State of cell `(i, j)`.
    pub fn bend(&self, i: usize, j: usize) -> Bend {
        let at = self.at(i, j);
        Bend { theta: self.now[0][at], omega: [self.now[1][at], self.now[2][at]] }
    }

    /// Sets the state of cell `(i, j)` as contact does (001 Eqs 1 and 12): the values at both times move together, so that
    /// the object, not the integrator's memory, decides how fast the cluster moves while it is touched.
    pub fn press(&mut self, i: usize, j: usize, bend: Bend) {
        let at = self.at(i, j);
        for (channel, value) in [bend.theta, bend.omega[0], bend.omega[1]].into_iter().enumerate() {
            self.now[channel][at] = value;
            self.before[channel][at] = value;
        }
    }

    /// Sets the newest state of cell `(i, j)` alone; with [`remember`](Self::remember) this gives a patch any motion.
    pub fn set(&mut self, i: usize, j: usize, bend: Bend) {
        let at = self.at(i, j);
        for (channel, value) in [bend.theta, bend.omega[0], bend.omega[1]].into_iter().enumerate() {
            self.now[channel][at] = value;
        }
    }

    /// Takes up a sub-step of another length: the earlier state moves along the line through both, so that every rate of change stays.
    pub(super) fn retime(&mut self, dt_secs: f32) {
        let ratio = self.dt_secs.replace(dt_secs).map_or(1.0, |last| dt_secs / last);
        if ratio != 1.0 {
            let pairs = self.now.iter().flatten().zip(self.before.iter_mut().flatten());
            pairs.for_each(|(now, before)| *before = now - (now - *before) * ratio);
        }
    }

    /// Takes the newest state as that of one sub-step earlier, too.
    pub fn remember(&mut self) {
        self.before.clone_from(&self.now);
    }

    /// Channels θ, ωx, ωz with their ghosts.
    pub fn channels(&self) -> [&[f32]; CHANNELS] {
        std::array::from_fn(|channel| self.now[channel].as_slice())
    }

    /// Channels one sub-step earlier; with [`channels`](Self::channels) the whole state of a patch.
    pub fn channels_before(&self) -> [&[f32]; CHANNELS] {
        std::array::from_fn(|channel| self.before[channel].as_slice())
    }

    /// Extremes of the patch's own cells.
    pub fn extremes(&self) -> Extremes {
        let mut largest = LargestOf::default();
        for j in 0..self.side {
            let row = self.at(0, j)..self.at(0, j) + self.side;
            let [theta, x, z] = &self.now;
            largest.add(&theta[row.clone()], &x[row.clone()], &z[row]);
        }
        largest.extremes()
    }
}
