//! Standing waves of the damped wave equation on a rectangle, and of the grid.

use std::f64::consts::PI;

use prairie_core::bend::Edges;

/// A standing wave between the edges of the world: a product of sines or cosines along both axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mode {
    /// Boundary condition at the edges of the world.
    pub edges: Edges,
    /// Number of half waves along each axis; of whole waves between periodic edges.
    pub waves: [u32; 2],
}

impl Mode {
    /// Side of the cells (m) that fill a width: resting grass begins one cell beyond the outermost centres, mirrors are half a cell beyond.
    pub fn cell_m(&self, width_m: f64, cells: usize) -> f64 {
        width_m / if self.edges == Edges::Rest { cells as f64 + 1.0 } else { cells as f64 }
    }

    /// Change of phase from a cell to the next (rad) along each axis.
    pub fn phase_rad(&self, cells: [usize; 2]) -> [f64; 2] {
        std::array::from_fn(|axis| {
            let (n, waves) = (cells[axis] as f64, f64::from(self.waves[axis]));
            match self.edges {
                Edges::Rest => PI * waves / (n + 1.0),
                Edges::Free => PI * waves / n,
                Edges::Wrapped => 2.0 * PI * waves / n,
            }
        })
    }

    /// Its value at a cell, at most 1.
    pub fn shape(&self, cells: [usize; 2], cell: [usize; 2]) -> f64 {
        let phase = self.phase_rad(cells);
        let along = |axis: usize| match self.edges {
            Edges::Rest => (phase[axis] * (cell[axis] as f64 + 1.0)).sin(),
            Edges::Free => (phase[axis] * (cell[axis] as f64 + 0.5)).cos(),
            // Offset from symmetric positions, where the shortest wave would vanish.
            Edges::Wrapped => (phase[axis] * cell[axis] as f64).cos(),
        };
        along(0) * along(1)
    }

    /// Eigenvalues of `−Lx` and `−Lz`, the second differences along each axis: `4·sin²(phase/2)`.
    pub fn differences(&self, cells: [usize; 2]) -> [f64; 2] {
        self.phase_rad(cells).map(|phase| 4.0 * (0.5 * phase).sin().powi(2))
    }

    /// Square of its wave number (1/m²), in the continuum.
    pub fn wave_number2_per_m2(&self, cells: [usize; 2], cell_m: f64) -> f64 {
        self.phase_rad(cells).iter().map(|phase| (phase / cell_m).powi(2)).sum()
    }

    /// Square of the wave number (1/m²) under the five-point stencil.
    pub fn grid_wave_number2_per_m2(&self, cells: [usize; 2], cell_m: f64) -> f64 {
        self.differences(cells).iter().sum::<f64>() / cell_m.powi(2)
    }
}

/// A mode in time: `a'' + k·a' + Ω₀²·a = 0` with `Ω₀² = c²·K² + κ`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Oscillation {
    /// Damping rate k (1/s).
    pub damping_per_s: f64,
    /// Ω₀² (1/s²); more than k²/4.
    pub stiffness_per_s2: f64,
}

impl Oscillation {
    /// Circular frequency (rad/s).
    pub fn frequency_rad_per_s(&self) -> f64 {
        (self.stiffness_per_s2 - 0.25 * self.damping_per_s.powi(2)).sqrt()
    }

    /// `e^(−kt/2)·cos(Ωt)`.
    pub fn at(&self, secs: f64) -> f64 {
        (-0.5 * self.damping_per_s * secs).exp() * (self.frequency_rad_per_s() * secs).cos()
    }

    /// Amplitude after release at rest from 1: `e^(−kt/2)·(cos(Ωt) + k/(2Ω)·sin(Ωt))`, overdamped or not.
    pub fn released(&self, secs: f64) -> f64 {
        let half = 0.5 * self.damping_per_s;
        let square = self.stiffness_per_s2 - half * half;
        let (turn, size) = (square.abs().sqrt() * secs, square.abs().sqrt().max(1e-12));
        let (cos, sin) = if square >= 0.0 { (turn.cos(), turn.sin()) } else { (turn.cosh(), turn.sinh()) };
        (-half * secs).exp() * (cos + half / size * sin)
    }
}
