//! The bend field: grass as a 2-D continuum (Chen & Johan, Real-Time Continuum Grass, sections 4 and 5).
//!
//! A cell holds one cluster of grass: its bending angle θ (rad; 0 at rest) and its bending velocity ω = (ωx, ωz)
//! (rad/s), whose direction is the direction in which the cluster leans. Contact sets both ([`Patch::press`]); the
//! damped wave equations (2)–(6) carry them on and let them rise again ([`verlet`]).
//!
//! A [`Field`] is made of patches with one ring of ghost cells. The ghosts are refreshed before every sub-step, so a field
//! of many patches equals one big grid bit for bit. A patch that sleeps holds no memory and counts as at rest.
//!
//! The field holds how grass departs from where the wind alone would hold it, [`wind_lean_rad`]: both leans add up as vectors on the
//! ground. So the wind, which is known at the nodes of a coarse grid, wakes no patch and crosses no wire twice; a gust passes over a
//! track without wiping it out, and grass that rises again rises to where the wind holds it.

mod extremes;
mod field;
mod params;
mod patch;
pub mod verlet;
mod wind;

pub use extremes::Extremes;
pub use field::{Field, Lane, Rim};
pub use params::{Coefficients, WaveParams};
pub use patch::{Bend, CHANNELS, Patch};
pub use wind::wind_lean_rad;
