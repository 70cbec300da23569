//! Motion of an object as far as its poses on the wire show it.

use glam::Quat;
use prairie_core::body::BodyPose;
use prairie_core::scene::VehicleKind;
use prairie_core::wire::ObjectPose;
use prairie_vehicles::VehicleMotion;

/// Longest time between two poses (s) that still tells the angular velocity.
const TURNING_SECS: f64 = 0.2;
/// Speed (m/s) and change of position (m) and rotation below which an object is at rest.
const REST_M_PER_S: f32 = 0.02;
const REST_CHANGE: f32 = 1e-3;

/// Motion of an object after a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeenMotion {
    /// The step.
    pub tick: u64,
    /// Its kind.
    pub kind: VehicleKind,
    /// Pose, velocity and the angle of its part.
    pub motion: VehicleMotion,
    /// Whether it has not moved since the snapshot before.
    pub is_at_rest: bool,
}

impl SeenMotion {
    /// The motion with the pose of step `tick`, and the pose some time (s) before.
    pub(super) fn new(tick: u64, pose: &ObjectPose, before: Option<(f64, ObjectPose)>) -> Self {
        let ObjectPose { kind, position_m, rotation, velocity_m_per_s, part_rad, .. } = *pose;
        let before = before.filter(|(secs, _)| *secs > 0.0);
        let turning_rad_per_s = before.map_or([0.0; 3], |(secs, before)| {
            let turn = Quat::from_array(rotation) * Quat::from_array(before.rotation).inverse();
            let turn = if turn.w < 0.0 { -turn } else { turn };
            let is_known = secs <= TURNING_SECS;
            if is_known { (turn.normalize().to_scaled_axis() / secs as f32).to_array() } else { [0.0; 3] }
        });
        let is_at_rest = before.is_some_and(|(_, before)| {
            let numbers = |pose: &ObjectPose| pose.position_m.into_iter().chain(pose.rotation);
            let is_still = velocity_m_per_s.iter().all(|speed| speed.abs() < REST_M_PER_S);
            is_still && numbers(pose).zip(numbers(&before)).all(|(now, before)| (now - before).abs() < REST_CHANGE)
        });
        let motion = VehicleMotion { pose: BodyPose { position_m, rotation }, velocity_m_per_s, turning_rad_per_s, part_rad };
        Self { tick, kind, motion, is_at_rest }
    }
}
