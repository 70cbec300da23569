//! The force field (004 §4.1): a mesh of volumes over the land, and the force that plants feel in each.
//!
//! A force is a dynamic pressure q (Pa) with a direction: a plant of silhouette A feels the force A·q. Each step the field is
//! ```text
//! q = driven + r        then, beside solids, without what points into them
//! ```
//! - `driven` is what drives it now: the wind, ½ρ|u|u, and forces of simple shape. It is summed anew for each step and does not spread; the wind's own solver
//!   has spread it already.
//! - `r` is what lingers of impulses: drops of rain, things that rush through. It spreads to the six neighbouring volumes and decays,
//!   ```text
//!   ∂r/∂t = κ·∇²r − k·r
//!   ```
//!   An impulse j (Pa·s) adds j·(1 − e^(−k·dt))/dt to r. So Σ r·dt = j in the end, whatever dt is: an impulse is felt in full, over about 1/k seconds, and one
//!   that goes on makes r equal to its own pressure. Where dt is long, k·dt ≫ 1, it is felt within the step.
//!
//! All of it is linear in its sources up to the solids, so forces superpose.
//!
//! Heights are above the land, so the mesh follows it with its lowest layer on the ground. Force leaves the mesh through its sides and its top; through
//! the ground and through solids it does not go. The field is the client's alone: nobody else needs the same bits, though the same calls give them.

mod field;
mod kernel;
mod sources;
#[cfg(test)]
mod tests;

pub use field::{ForceField, Lingering, Mesh};
pub use sources::{AIR_KG_PER_M3, Ball, DROP_KG, DROP_M_PER_S, LOTS, Rain, dynamic_pressure_pa, primitive_pa};
