//! Reference solutions: exact solutions and published tables.
//!
//! Positions are metres from the lower corner of a box, y up; plane problems are in x–z, except the cavity, whose lid is on top. Velocities are
//! m/s; pressures are those over the density (m²/s²), up to a constant.
//!
//! | problem | tested part |
//! |---|---|
//! | [`TaylorGreen`] | the whole solver in two dimensions, in a periodic box |
//! | [`EthierSteinman`] | the whole solver in three dimensions, with prescribed velocity on every face |
//! | [`Cavity`] | no-slip walls and a moving lid, against three published tables |
//! | [`CouetteStart`], [`OscillatingWall`] | friction at moving walls |
//! | [`SlottedDisc`], [`RotatingGaussian`], [`drifting_hill`] | advection alone: sharp edges, a smooth hill on curved and on straight paths |
//! | [`HeatKernel`] | diffusion alone, in one to three dimensions |
//! | [`plants`] | blades in a recorded gust, components under their weight |
//! | [`bend`] | the bend field: standing modes, pulses, dispersion, energy, strikes, random draws |

pub mod bend;
mod cavity;
#[cfg(test)]
mod differences;
mod ethier_steinman;
mod heat;
mod hill;
pub mod honami;
mod moving_walls;
pub mod plants;
mod rotation;
mod taylor_green;

pub use cavity::{BOTELLA_PEYRET_RE_1000, Cavity, Centreline, GHIA_RE_100, GHIA_RE_1000};
pub use ethier_steinman::EthierSteinman;
pub use heat::HeatKernel;
pub use hill::drifting_hill;
pub use moving_walls::{CouetteStart, OscillatingWall};
pub use rotation::{RotatingGaussian, Rotation, SlottedDisc};
pub use taylor_green::TaylorGreen;
