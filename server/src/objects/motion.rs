//! Motion of objects in a step, as input to grass and wind.

use glam::{Quat, Vec3};
use prairie_core::scene::VehicleKind;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Position and orientation of a body.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BodyPose {
    /// Centre of the body's box (m).
    pub position_m: [f32; 3],
    /// Unit quaternion (x, y, z, w); the body's own axes are right +X, up +Y, forward −Z.
    pub rotation: [f32; 4],
}

impl BodyPose {
    /// Position on the ground (m).
    pub fn xz(&self) -> [f32; 2] {
        [self.position_m[0], self.position_m[2]]
    }

    /// World position (m) of a point given in the body's axes (m).
    pub fn point_m(&self, local_m: [f32; 3]) -> Vec3 {
        Vec3::from_array(self.position_m) + Quat::from_array(self.rotation) * Vec3::from_array(local_m)
    }
}

/// Motion of an object in one step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Motion {
    /// Kind of the object.
    pub kind: VehicleKind,
    /// Pose before the step.
    pub from: BodyPose,
    /// Pose after the step.
    pub to: BodyPose,
    /// Velocity after the step (m/s), which moves the air. Contact with the grass uses the two poses instead.
    pub velocity_m_per_s: [f32; 3],
    /// Whether the physics has put the object to sleep.
    pub is_at_rest: bool,
}

/// Largest displacement in one step (m). The fastest object moves 9 m in the longest step.
const TRAVEL_LIMIT_M: f32 = 100.0;
/// Tolerance of the squared length of a unit quaternion.
const UNIT_TOLERANCE: f32 = 0.01;

/// Reason why a motion is invalid.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum MotionError {
    /// A value is NaN or infinite.
    #[error("`{field}` of a {} is {value:?}; allowed: finite numbers", .kind.name())]
    NotFinite {
        /// Kind of the object.
        kind: VehicleKind,
        /// Field of the motion, such as `velocity_m_per_s`.
        field: &'static str,
        /// Its value.
        value: Vec<f32>,
    },
    /// A rotation is not a unit quaternion.
    #[error("`{field}` of a {} is {value:?}; allowed: a unit quaternion", .kind.name())]
    NotUnit {
        /// Kind of the object.
        kind: VehicleKind,
        /// Field of the motion.
        field: &'static str,
        /// Its value.
        value: [f32; 4],
    },
    /// The displacement is too large.
    #[error("a {} moves {travel_m:.1} m in one step; allowed: up to {TRAVEL_LIMIT_M} m", .kind.name())]
    TooFar {
        /// Kind of the object.
        kind: VehicleKind,
        /// Displacement (m).
        travel_m: f32,
    },
}

impl Motion {
    /// The same displacement without rotation.
    pub fn without_rotation(&self) -> Self {
        let level = |pose: BodyPose| BodyPose { rotation: Quat::IDENTITY.to_array(), ..pose };
        Self { from: level(self.from), to: level(self.to), ..*self }
    }

    /// Checks the motion.
    ///
    /// # Errors
    /// [`MotionError`] when a value is NaN or infinite, a rotation is not a unit quaternion, or the displacement exceeds 100 m.
    pub fn check(&self) -> Result<(), MotionError> {
        let Self { kind, from, to, velocity_m_per_s, .. } = *self;
        let vectors: [(&str, &[f32]); 5] = [
            ("from.position_m", &from.position_m),
            ("from.rotation", &from.rotation),
            ("to.position_m", &to.position_m),
            ("to.rotation", &to.rotation),
            ("velocity_m_per_s", &velocity_m_per_s),
        ];
        if let Some((field, value)) = vectors.into_iter().find(|(_, value)| !value.iter().all(|v| v.is_finite())) {
            return Err(MotionError::NotFinite { kind, field, value: value.to_vec() });
        }
        for (field, value) in [("from.rotation", from.rotation), ("to.rotation", to.rotation)] {
            if (Quat::from_array(value).length_squared() - 1.0).abs() > UNIT_TOLERANCE {
                return Err(MotionError::NotUnit { kind, field, value });
            }
        }
        let travel_m = Vec3::from_array(from.position_m).distance(Vec3::from_array(to.position_m));
        if travel_m <= TRAVEL_LIMIT_M { Ok(()) } else { Err(MotionError::TooFar { kind, travel_m }) }
    }
}
