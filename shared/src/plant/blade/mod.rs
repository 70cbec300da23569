//! A blade of grass that sways (000 chapter 3): a cantilever of three links between the four control points of its backbone.
//!
//! What moves are the leans of the links, each a vector on the ground (rad) as in the bend field, so that wind, cars and spheres press one and the same
//! blade, and so that its length is exact whatever it does: a control point stands one link's length from the one below, and [`backbone`] draws the curve that they span
//! to the same length.
//!
//! # Accuracy
//! Loads act across the blade however it leans, and springs are linear in the leans. Beside the elastica of a blade with the same first frequency the tip is
//! within 1 % of the length up to a mean lean of 0.25 rad, and within 5 % up to 0.45 rad, under a force at the tip (1 and 1.5·EI/L²) and under even drag
//! (2 and 3.6·EI/L² in all). A small force at the tip moves it 4.4 % too little, small even drag 0.6 % too much. Beyond, a blade leans too far, as the force on
//! it does not fall with its silhouette: at a mean lean of 1 rad by a quarter of its length.
//!
//! # Parts
//! - [`modes`]: natural frequencies of the chain, and how links and wind couple to its modes;
//! - [`propagator`]: three ways to take a mode through time, each with its limit;
//! - [`step`]: one step of a blade; [`abreast`]: the same for many;
//! - [`lean`]: from a lean to a direction and back;
//! - [`contact`]: never below the ground, never inside a sphere;
//! - [`backbone`]: the curve through the control points and the outline about it.
//!
//! The twins on the GPU are `blade.wgsl` and `backbone.wgsl`.

pub mod abreast;
pub mod backbone;
pub mod contact;
pub mod lean;
pub mod modes;
pub mod propagator;
pub mod step;

pub use propagator::Integrator;
pub use step::advance;

/// Links of a blade.
pub const LINKS: usize = 3;

/// A vector on the ground for each link: X and Z. As below, `T` is a number, or an array with that of each of many blades.
pub type Leans<T = f32> = [[T; 2]; LINKS];

/// What a blade is like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blade<T = f32> {
    /// Length (m).
    pub length_m: T,
    /// First natural frequency ω₁ (rad/s), from [`modes::first_frequency_rad_per_s`] or as measured.
    pub frequency_rad_per_s: T,
    /// Damping of each mode as a share of the critical one.
    pub damping_share: T,
    /// Mean lean that the drag of a wind of 1 m/s sustains (rad s²/m²); drag grows with the square of the speed.
    pub lean_per_wind2: T,
}

/// How a blade leans and sways.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sway<T = f32> {
    /// Lean of each link from upright (rad).
    pub lean_rad: Leans<T>,
    /// Its rate of change (rad/s).
    pub rate_rad_per_s: Leans<T>,
}

impl Sway {
    /// At rest in a lean.
    #[inline(always)]
    pub fn at_rest(lean_rad: Leans) -> Self {
        Self { lean_rad, rate_rad_per_s: Leans::default() }
    }

    /// Offsets of the three control points above the root from it (m): X, height, Z.
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
