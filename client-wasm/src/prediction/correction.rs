//! Correction of a prediction: the difference from the picture before fades.

use glam::{Quat, Vec3};
use prairie_core::wire::ObjectPose;

/// Time constant with which a difference fades (s).
const FADE_SECS: f32 = 0.1;
/// Greatest speed with which it fades (m/s).
const FADE_M_PER_S: f32 = 4.0;
/// Distance (m) beyond which the vehicle was put elsewhere, and the picture follows at once.
const SNAP_M: f32 = 4.0;

/// What is added to a pose so that the picture goes on from the one before.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Correction {
    offset_m: Vec3,
    turn: Quat,
}

impl Correction {
    /// The correction by which `pose` looks like `before`.
    pub(super) fn between(before: &ObjectPose, pose: &ObjectPose) -> Self {
        let mut correction = Self::default();
        correction.add(before, pose);
        correction
    }

    /// Adds the difference of two poses at the same moment: the one that would have been shown, and the one that is corrected.
    pub(super) fn add(&mut self, before: &ObjectPose, pose: &ObjectPose) {
        self.offset_m += Vec3::from(before.position_m) - Vec3::from(pose.position_m);
        self.turn = (self.turn * Quat::from_array(before.rotation) * Quat::from_array(pose.rotation).inverse()).normalize();
        let is_near = self.offset_m.length() <= SNAP_M && self.turn.is_finite();
        if !is_near {
            *self = Self::default();
        }
    }

    /// Fades for `dt_secs`.
    pub(super) fn decay(&mut self, dt_secs: f32) {
        let keep = (-dt_secs / FADE_SECS).exp();
        let distance_m = self.offset_m.length();
        let left_m = (distance_m * keep).max(distance_m - FADE_M_PER_S * dt_secs);
        self.offset_m = if distance_m > 0.0 { self.offset_m * (left_m / distance_m) } else { Vec3::ZERO };
        self.turn = Quat::IDENTITY.slerp(self.turn, keep).normalize();
    }

    /// The corrected pose.
    pub(super) fn applied(&self, pose: &ObjectPose) -> ObjectPose {
        ObjectPose {
            position_m: (Vec3::from(pose.position_m) + self.offset_m).into(),
            rotation: (self.turn * Quat::from_array(pose.rotation)).normalize().to_array(),
            ..*pose
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use prairie_core::scene::VehicleKind;

    fn pose(x_m: f32, turn_rad: f32) -> ObjectPose {
        let rotation = Quat::from_rotation_y(turn_rad).to_array();
        ObjectPose { id: 1, kind: VehicleKind::Car, position_m: [x_m, 0.0, 0.0], rotation, velocity_m_per_s: [0.0; 3], part_rad: 0.0 }
    }

    #[test]
    fn a_difference_fades_without_a_jump() {
        let mut correction = Correction::between(&pose(1.0, 0.5), &pose(0.0, 0.1));
        let mut before = correction.applied(&pose(0.0, 0.1));
        assert!(
            (before.position_m[0] - 1.0).abs() < 1e-6 && Quat::from_array(before.rotation).angle_between(Quat::from_rotation_y(0.5)) < 1e-3
        );
        for _ in 0..60 {
            correction.decay(1.0 / 60.0);
            let now = correction.applied(&pose(0.0, 0.1));
            let step_m = before.position_m[0] - now.position_m[0];
            assert!((0.0..=FADE_M_PER_S / 60.0 + 1e-5).contains(&step_m), "{step_m} m");
            before = now;
        }
        assert!(before.position_m[0] < 0.01, "{before:?}");
        assert!(Quat::from_array(before.rotation).angle_between(Quat::from_rotation_y(0.1)) < 1e-3);
    }

    #[test]
    fn a_vehicle_put_elsewhere_is_shown_there_at_once() {
        let correction = Correction::between(&pose(50.0, 0.0), &pose(0.0, 0.0));
        assert_eq!(correction.applied(&pose(0.0, 0.0)).position_m, [0.0; 3]);
    }
}
