//! Motion of objects in a step, as input to grass and wind.

use super::{BodyPose, part_code, part_rad};
use crate::scene::VehicleKind;
use serde::{Deserialize, Serialize};
use thiserror::Error;

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
    /// Angle of the moving part (rad) after the step, as in [`ObjectPose`](crate::wire::ObjectPose): the phase of a walk, by which feet stand in turn.
    pub part_rad: f32,
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
        let level = |pose: BodyPose| BodyPose { rotation: BodyPose::IDENTITY.rotation, ..pose };
        Self { from: level(self.from), to: level(self.to), ..*self }
    }

    /// The same motion between [rounded](BodyPose::rounded) poses, with the rounded angle of the moving part: that by which the grass is pressed.
    pub fn rounded(&self) -> Self {
        Self { from: self.from.rounded(), to: self.to.rounded(), part_rad: part_rad(part_code(self.part_rad)), ..*self }
    }

    /// Checks the motion.
    ///
    /// # Errors
    /// [`MotionError`] when a value is NaN or infinite, a rotation is not a unit quaternion, or the displacement exceeds 100 m.
    pub fn check(&self) -> Result<(), MotionError> {
        let Self { kind, from, to, velocity_m_per_s, part_rad, .. } = *self;
        let vectors: [(&str, &[f32]); 6] = [
            ("from.position_m", &from.position_m),
            ("from.rotation", &from.rotation),
            ("to.position_m", &to.position_m),
            ("to.rotation", &to.rotation),
            ("velocity_m_per_s", &velocity_m_per_s),
            ("part_rad", &[part_rad]),
        ];
        if let Some((field, value)) = vectors.into_iter().find(|(_, value)| !value.iter().all(|v| v.is_finite())) {
            return Err(MotionError::NotFinite { kind, field, value: value.to_vec() });
        }
        for (field, value) in [("from.rotation", from.rotation), ("to.rotation", to.rotation)] {
            let length2: f32 = value.iter().map(|part| part * part).sum();
            if (length2 - 1.0).abs() > UNIT_TOLERANCE {
                return Err(MotionError::NotUnit { kind, field, value });
            }
        }
        let travel_m = (0..3).map(|axis| to.position_m[axis] - from.position_m[axis]).map(|m| m * m).sum::<f32>().sqrt();
        if travel_m <= TRAVEL_LIMIT_M { Ok(()) } else { Err(MotionError::TooFar { kind, travel_m }) }
    }
}
