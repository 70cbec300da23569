//! Where objects were and are, for the grass and the wind.

use glam::{Quat, Vec3};
use shared::scene::VehicleKind;

/// Position and orientation of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stand {
    /// Centre of the body's box (m).
    pub position_m: [f32; 3],
    /// Unit quaternion (x, y, z, w); the body's own axes are right +X, up +Y, forward −Z.
    pub rotation: [f32; 4],
}

impl Stand {
    /// Position on the ground (m).
    pub fn xz(&self) -> [f32; 2] {
        [self.position_m[0], self.position_m[2]]
    }

    /// World position (m) of a point given in the body's axes (m).
    pub fn point_m(&self, local_m: [f32; 3]) -> Vec3 {
        Vec3::from_array(self.position_m) + Quat::from_array(self.rotation) * Vec3::from_array(local_m)
    }
}

/// What an object did in one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// What it is.
    pub kind: VehicleKind,
    /// Before the step.
    pub from: Stand,
    /// After it.
    pub to: Stand,
    /// Velocity after it (m/s).
    pub velocity_m_per_s: [f32; 3],
}
