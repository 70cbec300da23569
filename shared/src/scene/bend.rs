//! Numerical method of the bend field: the section `[bend]`.

use super::words;
use crate::bend::{Edges, GroundContact, Rest, Scheme, Seams};
use serde::{Deserialize, Serialize};

words! {
    /// How an object sets the bending velocity of the grass that it touches (Chen & Johan, §5.2 and §6).
    #[derive(Default)]
    ObjectContact {
        /// Each cell for the time that it is within the object, with the velocity at its place: the same bend for any length of the step.
        #[default]
        Exact = "exact",
        /// Velocities at the corners of the swept area, interpolated inside, for the whole step.
        Interpolated = "interpolated",
    }
}

/// Scheme of the bend field, coupling of its patches, boundary condition and rest tolerance.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct BendField {
    /// Time-integration scheme: `verlet`, as published by Chen & Johan, needs grass so slow that one step is stable when the fastest object strikes
    /// it; `substepped` takes as many steps as stability requires; `implicit` takes one of any length; `modal` is exact in time, and needs μ = 0, no
    /// species, a world that may be awake as a whole, and a build with the feature `modal`. Default `substepped`.
    pub scheme: Scheme,
    /// Coupling of patches: `exact`, the same result as one big grid; `overlap`, the loose overlaps of Chen & Johan. Default `exact`.
    pub seams: Seams,
    /// Boundary condition at the edge of the world: `rest`, grass at rest, a fixed end; `free`, a mirror, a free end; `wrapped`, periodic. Default
    /// `rest`.
    pub edges: Edges,
    /// Largest bend that counts as at rest (rad). Default 0.01, less than half a code on the wire, allowed 0..=0.1; 0 is lossless.
    pub rest_theta_rad: f32,
    /// Largest bending velocity that counts as at rest (rad/s). Default 0.2, allowed 0..=2.
    pub rest_omega_rad_per_s: f32,
    /// Contact of bent grass with the ground: `inelastic`, the bend stops at a right angle and loses its motion there; `none`, the wave equations alone,
    /// whose waves add up to more. Default `inelastic`.
    pub ground_contact: GroundContact,
    /// How objects bend the grass that they touch: `exact`, each cell for the time that it is within the object; `interpolated`, as published by Chen & Johan
    /// (2010, §6), by velocities that are found at the corners of the swept area only and interpolated inside. Default `exact`.
    pub object_contact: ObjectContact,
}

impl Default for BendField {
    fn default() -> Self {
        let (scheme, seams, edges) = (Scheme::default(), Seams::default(), Edges::default());
        let (ground_contact, object_contact) = (GroundContact::default(), ObjectContact::default());
        Self { scheme, seams, edges, rest_theta_rad: 0.01, rest_omega_rad_per_s: 0.2, ground_contact, object_contact }
    }
}

impl BendField {
    /// Tolerance within which grass counts as at rest.
    pub fn rest(&self) -> Rest {
        Rest { theta_rad: self.rest_theta_rad, omega_rad_per_s: self.rest_omega_rad_per_s }
    }
}
