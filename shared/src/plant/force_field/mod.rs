//! The force field (004 §4.1): a mesh of volumes over the land, and the force that plants feel in each.
//!
//! A force is a dynamic pressure q (Pa) with a direction: a plant of silhouette A feels the force A·q. Each step the field is
//! ```text
//! q = s·w + r
//! ```
//! - `w` is the wind's, ½ρ|u|u. Flow primitives (Wejchert & Haumann 1991), gusts, and the wakes and washes of objects are in it: the wind's solver drives its
//!   air with each of them, widened to a cell where they are smaller, so that nothing here adds them again.
//! - `s` is the share of it that arrives. An [`Obstacle`] stops what would go through it. Behind it the lee is carried from volume to volume with the wind, and
//!   fills up again by what mixes in from beside and above; l = 1 − s obeys n·∇l = ℓ·∇²l, n the wind's direction, at any speed alike. Before it, what points
//!   into it is gone.
//! - `r` is what lingers of impulses, of things that rush through. It spreads to the six neighbouring volumes, as far as both are open, and decays,
//!   ```text
//!   ∂r/∂t = κ·∇²r − k·r
//!   ```
//!   An impulse j (Pa·s) adds j·(1 − e^(−k·dt))/dt to r. So Σ r·dt = j in the end, whatever dt is: an impulse is felt in full, over about 1/k seconds, and one
//!   that goes on makes r equal to its own pressure. Where dt is long, k·dt ≫ 1, it is felt within the step.
//!
//! Forces superpose. Rain is not among them: at 50 mm/h it weighs 0.09 Pa, a fortieth of a wind of 2.5 m/s, and its drops strike leaf by leaf
//! ([`drops`](super::underbrush::drops)).
//!
//! Heights are above the land, so the mesh follows it with its lowest layer on the ground. Force leaves the mesh through its sides and its top; through
//! the ground it does not go. The field is the client's alone: nobody else needs the same bits, though the same calls give them.

mod field;
mod kernel;
mod obstacle;
mod sources;
#[cfg(test)]
mod tests;

pub use field::{Force, ForceField, Lingering, Mesh};
pub use obstacle::Obstacle;
pub use sources::{AIR_KG_PER_M3, Ball, dynamic_pressure_pa};
