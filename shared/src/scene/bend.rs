//! How the bend field is solved.

use crate::bend::{Edges, Rest, Scheme, Seams};
use serde::{Deserialize, Serialize};

/// The scheme of the bend field, how its patches meet, and what counts as at rest.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct BendField {
    /// How the waves are carried on in time: `verlet`, 001 as it stands, needs grass so slow that one step is stable when an object strikes
    /// it at its fastest; `substepped` takes as many steps as that bound asks for; `implicit` takes one of any length; `modal` is exact in
    /// time, and needs μ = 0, no species and a world that may be awake as a whole. Default `substepped`.
    pub scheme: Scheme,
    /// How patches meet: `exact`, as one big grid would go on; `overlap`, by the loose overlaps of 001. Default `exact`.
    pub seams: Seams,
    /// What lies beyond the edge of the world: `rest`, grass at rest, as a fixed end; `free`, a mirror, as a free end; `wrapped`, the opposite
    /// edge. Default `rest`.
    pub edges: Edges,
    /// Largest bend that counts as at rest (rad). Default 0.01, less than half a code on the wire, allowed 0..=0.1; 0 loses nothing.
    pub rest_theta_rad: f32,
    /// Largest bending speed that counts as at rest (rad/s). Default 0.2, allowed 0..=2.
    pub rest_omega_rad_per_s: f32,
}

impl Default for BendField {
    fn default() -> Self {
        let (scheme, seams, edges) = (Scheme::default(), Seams::default(), Edges::default());
        Self { scheme, seams, edges, rest_theta_rad: 0.01, rest_omega_rad_per_s: 0.2 }
    }
}

impl BendField {
    /// What counts as at rest.
    pub fn rest(&self) -> Rest {
        Rest { theta_rad: self.rest_theta_rad, omega_rad_per_s: self.rest_omega_rad_per_s }
    }
}
