//! A swaying blade of grass (Zhang chapter 3): a cantilever of three links between the four control points of its backbone.
//!
//! The state is the lean of each link, a vector on the ground (rad) as in the bend field. So wind, cars and spheres all act on the same blade, and
//! its length is exact: a control point is always one link's length from the one below, and [`backbone`] draws the curve through them with the same
//! length.
//!
//! # Accuracy
//! Loads act across the blade at any lean, and springs are linear in the leans. Compared with the elastica of a blade with the same first frequency,
//! the tip is within 1 % of the length up to a mean lean of 0.25 rad, and within 5 % up to 0.45 rad, under a force at the tip (1 and 1.5·EI/L²) and
//! under uniform drag (2 and 3.6·EI/L² in total). A small force at the tip moves it 4.4 % too little, small uniform drag 0.6 % too much. Beyond that
//! a blade leans too far, as the force does not decrease with its silhouette: at a mean lean of 1 rad by a quarter of its length.
//!
//! # Parts
//! - [`modes`]: natural frequencies of the chain, and the coupling of links and wind to its modes;
//! - [`propagator`]: three time integrators of a mode, each with its stability limit;
//! - [`step`]: one step of a blade;
//! - [`lean`]: conversion between lean and direction;
//! - [`contact`]: contact with the ground and with spheres;
//! - [`backbone`]: the curve through the control points and the outline about it.
//!
//! The twins on the GPU are `blade.wgsl` and `backbone.wgsl`.

pub mod backbone;
pub mod contact;
pub mod lean;
pub mod modes;
pub mod propagator;
pub mod step;

pub use propagator::Integrator;
pub use step::advance;

/// Number of links of a blade.
pub const LINKS: usize = 3;

/// A vector on the ground for each link: X and Z.
pub type Leans = [[f32; 2]; LINKS];

/// Mechanical properties of a blade.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blade {
    /// Length (m).
    pub length_m: f32,
    /// First natural frequency ω₁ (rad/s), from [`modes::first_frequency_rad_per_s`] or measured.
    pub frequency_rad_per_s: f32,
    /// Damping ratio of each mode (1 is critical damping).
    pub damping_ratio: f32,
    /// Mean lean that the drag of a wind of 1 m/s sustains (rad s²/m²); drag is proportional to the square of the speed.
    pub lean_per_wind2: f32,
}

/// State of a blade.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sway {
    /// Lean of each link from upright (rad).
    pub lean_rad: Leans,
    /// Its rate of change (rad/s).
    pub rate_rad_per_s: Leans,
}

impl Sway {
    /// A state at rest with a lean.
    #[inline(always)]
    pub fn at_rest(lean_rad: Leans) -> Self {
        Self { lean_rad, rate_rad_per_s: Leans::default() }
    }

    /// Positions of the three control points above the root relative to it (m): X, height, Z.
    #[inline(always)]
    pub fn points_m(&self, length_m: f32) -> [[f32; 3]; LINKS] {
        let link_m = length_m * (1.0 / LINKS as f32);
        let (mut at, mut points_m) = ([0.0; 3], [[0.0; 3]; LINKS]);
        for (point_m, lean_rad) in points_m.iter_mut().zip(&self.lean_rad) {
            let along = lean::direction(*lean_rad);
            for axis in 0..3 {
                at[axis] += link_m * along[axis];
            }
            *point_m = at;
        }
        points_m
    }
}
