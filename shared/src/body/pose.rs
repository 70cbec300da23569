//! Pose of a body, and its code on the wire.

use serde::{Deserialize, Serialize};
use std::f32::consts::TAU;

/// Quantum of a position on the wire (m).
pub const POSITION_QUANTUM_M: f32 = 1.0 / 8192.0;
/// Code of 1 for the components of a rotation.
pub const ROTATION_FULL: f32 = i16::MAX as f32;

/// Quanta of a moving part's angle in a turn.
const PART_STEPS: f32 = 65_536.0;

/// Code of the angle of a moving part (rad).
pub fn part_code(part_rad: f32) -> i16 {
    (part_rad / TAU * PART_STEPS).round() as i64 as i16
}

/// Angle (rad) of the code of a moving part, −π..π.
pub fn part_rad(code: i16) -> f32 {
    f32::from(code) / PART_STEPS * TAU
}

/// Position and orientation of a body.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BodyPose {
    /// Centre of the body's box (m).
    pub position_m: [f32; 3],
    /// Unit quaternion (x, y, z, w); the body's own axes are right +X, up +Y, forward −Z.
    pub rotation: [f32; 4],
}

impl BodyPose {
    /// Without rotation at the origin.
    pub const IDENTITY: Self = Self { position_m: [0.0; 3], rotation: [0.0, 0.0, 0.0, 1.0] };

    /// Position on the ground (m).
    pub fn xz(&self) -> [f32; 2] {
        [self.position_m[0], self.position_m[2]]
    }

    /// World position (m) of a point given in the body's axes (m).
    pub fn point_m(&self, local_m: [f32; 3]) -> [f32; 3] {
        let [x, y, z, w] = self.rotation;
        let cross = |a: [f32; 3], b: [f32; 3]| [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
        let axis = [x, y, z];
        // v + 2w·(q × v) + 2·q × (q × v).
        let once = cross(axis, local_m).map(|c| 2.0 * c);
        let twice = cross(axis, once);
        [0, 1, 2].map(|n| self.position_m[n] + (local_m[n] + w * once[n] + twice[n]))
    }

    /// The pose rounded to its [code](PoseCode).
    pub fn rounded(&self) -> Self {
        PoseCode::of(self).pose()
    }
}

/// Code of a pose: positions within half a [quantum](POSITION_QUANTUM_M) on each axis up to 2 km from the origin (beyond it, within the spacing of `f32`),
/// rotations within 1e-4 rad.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PoseCode {
    /// Position in quanta.
    pub position: [i32; 3],
    /// Quaternion (x, y, z, w), 32767 for 1.
    pub rotation: [i16; 4],
}

impl PoseCode {
    /// The code of a pose.
    pub fn of(pose: &BodyPose) -> Self {
        Self {
            position: pose.position_m.map(|m| (m / POSITION_QUANTUM_M).round() as i32),
            rotation: pose.rotation.map(|part| (part * ROTATION_FULL).round() as i16),
        }
    }

    /// The pose of the code; its own code is the same again, so its quaternion is not normalised: lengths that it turns are within 1e-4. A code without a
    /// rotation gives none.
    pub fn pose(&self) -> BodyPose {
        let has_rotation = self.rotation.iter().any(|part| part.unsigned_abs() > 1 << 13);
        BodyPose {
            position_m: self.position.map(|quanta| quanta as f32 * POSITION_QUANTUM_M),
            rotation: if has_rotation { self.rotation.map(|part| f32::from(part) / ROTATION_FULL) } else { BodyPose::IDENTITY.rotation },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{Quat, Vec3};
    use proptest::prelude::*;

    fn rotation() -> impl Strategy<Value = Quat> {
        (proptest::array::uniform3(-1.0_f32..1.0), 0.0_f32..6.3)
            .prop_map(|(axis, turn)| Quat::from_axis_angle(Vec3::from_array(axis).try_normalize().unwrap_or(Vec3::Y), turn))
    }

    proptest! {
        #[test]
        fn a_code_is_within_its_bounds(at in proptest::array::uniform3(-1500.0_f32..1500.0), rotation in rotation()) {
            let pose = BodyPose { position_m: at, rotation: rotation.to_array() };
            let rounded = pose.rounded();
            for (found, wanted) in rounded.position_m.iter().zip(at) {
                prop_assert!((found - wanted).abs() <= 0.5 * POSITION_QUANTUM_M);
            }
            let local = Vec3::new(1.0, -2.0, 2.0);
            let found = Vec3::from_array(BodyPose { position_m: [0.0; 3], ..rounded }.point_m(local.to_array()));
            prop_assert!(found.distance(rotation * local) <= 3.0 * 2e-4, "{found} instead of {}", rotation * local);
            prop_assert_eq!(rounded.rounded(), rounded, "a rounded pose stays as it is");
        }

        #[test]
        fn points_turn_with_the_body(at in proptest::array::uniform3(-10.0_f32..10.0), local in proptest::array::uniform3(-3.0_f32..3.0), rotation in rotation()) {
            let found = BodyPose { position_m: at, rotation: rotation.to_array() }.point_m(local);
            let wanted = Vec3::from_array(at) + rotation * Vec3::from_array(local);
            prop_assert!(Vec3::from_array(found).distance(wanted) < 1e-5);
        }
    }

    #[test]
    fn a_code_without_a_rotation_is_not_turned() {
        assert_eq!(PoseCode::default().pose(), BodyPose::IDENTITY);
    }
}
