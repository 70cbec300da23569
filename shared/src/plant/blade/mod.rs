//! A swaying blade of grass (Zhang chapter 3): a cantilever of three links between the four control points of its backbone.
//!
//! The state is the lean of each link, a vector on the ground (rad) as in the bend field. So wind, cars and spheres all act on the same blade, and
//! its length is exact: a control point is always one link's length from the one below, and [`backbone`] draws the curve through them with the same
//! length.
//!
//! # Accuracy
//! An even wind holds the mean lean of the bend field. Under the drag that this takes, and other loads in proportion, the tip is within 1 % of the
//! length of the elastica's up to a mean lean of 1.2 rad, and small deflections of the tip are exact ([`mod@deflection`]). Springs are linear in the
//! leans, and the inertia is that of the upright chain: at large leans the frequencies lack the shift of a real blade.
//!
//! # Parts
//! - [`mod@deflection`]: equilibrium under drag;
//! - [`modes`]: natural frequencies of the chain, and the coupling of links and drag to its modes;
//! - [`propagator`]: three time integrators of a mode, each with its stability limit;
//! - [`step`]: one step of a blade;
//! - [`lean`]: conversion between lean and direction;
//! - [`contact`]: contact with the ground and with spheres;
//! - [`backbone`]: the curve through the control points and the outline about it.
//!
//! The twins on the GPU are `blade.wgsl` and `backbone.wgsl`.

pub mod backbone;
pub mod contact;
pub mod deflection;
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
