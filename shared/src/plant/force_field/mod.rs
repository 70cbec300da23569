//! Force field (Endo et al. 2003, §4.1): a mesh of volumes over the land, and the force on plants in each. Blades of grass feel its lees, underbrush the
//! rest of it as well.
//!
//! A force is a dynamic pressure q (Pa) with a direction: a plant of silhouette A feels the force A·q. Each step the field is
//! ```text
//! q = s·w + r
//! ```
//! - `w` is the force of the wind, ½ρ|u|u. Flow primitives (Wejchert & Haumann 1991), gusts, and the wakes and washes of objects are part of the
//!   simulated wind, widened to a cell where they are smaller, so they are not added here again.
//! - `s` is the fraction of it that arrives. An [`Obstacle`] stops the wind through it. Its lee is advected from volume to volume with the wind, and
//!   is filled by mixing from the sides and above; l = 1 − s obeys n·∇l = ℓ·∇²l, n the wind's direction, at any speed. In front of it, the force that
//!   points into it vanishes.
//! - `r` is the remainder of impulses of fast objects. It spreads to the six neighbouring volumes, as far as both are open, and decays,
//!   ```text
//!   ∂r/∂t = κ·∇²r − k·r
//!   ```
//! An impulse j (Pa·s) adds j·(1 − e^(−k·dt))/dt to r, so that Σ r·dt = j in the end for any dt: an impulse is felt in full, over about 1/k seconds,
//! and a continuous one makes r equal to its own pressure. If k·dt ≫ 1, it is felt within the step.
//!
//! Forces superpose. Rain is not included: at 50 mm/h it exerts 0.09 Pa, a fortieth of a wind of 2.5 m/s, and its drops strike leaf by leaf
//! ([`drops`](super::underbrush::drops)).
//!
//! Heights are above the land, so the mesh follows the terrain with its lowest layer on the ground. Force leaves the mesh through its sides and its
//! top, but not through the ground. Only the client uses the field, so it need not be reproducible bit for bit.

mod field;
mod kernel;
mod obstacle;
mod sources;
#[cfg(test)]
mod tests;

pub use field::{Force, ForceField, Lingering, VolumeMesh};
pub use obstacle::Obstacle;
pub use sources::{AIR_KG_PER_M3, Ball, dynamic_pressure_pa, sheltered};
