//! One patch of the field: three channels at two times, with a ring of ghost cells.

/// State of one cluster of grass.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bend {
    /// Bending angle (rad), 0 upright.
    pub theta: f32,
    /// Bending velocity along X and Z (rad/s); its direction is the direction of the bend.
    pub omega: [f32; 2],
}

/// Number of channels: θ, ωx, ωz.
pub(super) const CHANNELS: usize = 3;

/// A square patch of `side × side` cells inside a ring of ghosts; row-major from the north-west, `(side + 2)²` values a
/// channel.
#[derive(Clone, Debug, PartialEq)]
pub struct Patch {
    side: usize,
    /// Channels at the newest time.
    pub(super) now: [Vec<f32>; CHANNELS],
    /// Channels one sub-step earlier; ghosts are unused.
    pub(super) before: [Vec<f32>; CHANNELS],
}

impl Patch {
    /// A patch at rest.
    pub fn new(side: usize) -> Self {
        let zeros = || vec![0.0; (side + 2) * (side + 2)];
        Self { side, now: std::array::from_fn(|_| zeros()), before: std::array::from_fn(|_| zeros()) }
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

    /// Adds to the state of cell `(i, j)` at both times, as [`press`](Self::press) does.
    pub fn nudge(&mut self, i: usize, j: usize, by: Bend) {
        let at = self.at(i, j);
        for (channel, value) in [by.theta, by.omega[0], by.omega[1]].into_iter().enumerate() {
            self.now[channel][at] += value;
            self.before[channel][at] += value;
        }
    }

    /// Channels θ, ωx, ωz with their ghosts.
    pub fn channels(&self) -> [&[f32]; CHANNELS] {
        std::array::from_fn(|channel| self.now[channel].as_slice())
    }

    /// Channels one sub-step earlier; with [`channels`](Self::channels) the whole state of a patch.
    pub fn channels_before(&self) -> [&[f32]; CHANNELS] {
        std::array::from_fn(|channel| self.before[channel].as_slice())
    }

    /// Largest |θ| (rad) and largest |ω| (rad/s) of the patch's own cells; infinite or NaN values come through as such.
    pub fn extremes(&self) -> (f32, f32) {
        let stride = self.stride();
        let (mut theta, mut omega2) = (0.0_f32, 0.0_f32);
        for j in 1..=self.side {
            let row = j * stride + 1..j * stride + 1 + self.side;
            for &value in &self.now[0][row.clone()] {
                theta = nan_max(theta, value.abs());
            }
            for (x, z) in self.now[1][row.clone()].iter().zip(&self.now[2][row]) {
                omega2 = nan_max(omega2, x * x + z * z);
            }
        }
        (theta, omega2.sqrt())
    }

    /// Sum of θ² + ω² over the patch's cells (mixed units; a measure of how far from rest it is).
    pub fn activity(&self) -> f64 {
        let stride = self.stride();
        let mut sum = 0.0;
        for channel in &self.now {
            for j in 1..=self.side {
                let row = &channel[j * stride + 1..j * stride + 1 + self.side];
                sum += f64::from(row.iter().map(|v| v * v).sum::<f32>());
            }
        }
        sum
    }
}

fn nan_max(a: f32, b: f32) -> f32 {
    if b > a || b.is_nan() { b } else { a }
}
