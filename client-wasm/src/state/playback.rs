//! Interpolation between the server's snapshots. Objects are drawn a little late, so that a next snapshot to move towards is usually there.

use super::error::{MirrorError, range};
use crate::damped::wrap_angle;
use glam::{Quat, Vec3};
use prairie_core::wire::ObjectPose;
use std::collections::VecDeque;

/// Interpolation delay (s). Two lost or late snapshots of a 30 Hz stream stay invisible.
const DELAY_SECS: f64 = 0.1;

/// Maximum extrapolation time (s): how long objects continue at their last velocity without a new snapshot.
const EXTRAPOLATION_SECS: f64 = 0.15;

/// Clock error (s) above which the clock offset is set at once instead of being smoothed.
const CLOCK_JUMP_SECS: f64 = 0.5;

/// Smoothing factor of the measured clock offset.
const CLOCK_SMOOTHING: f64 = 0.08;

/// Minimum displacement (m), in excess of the velocity's, that counts as a teleport and is not interpolated.
const TELEPORT_M: f32 = 4.0;

const SNAPSHOT_LIMIT: usize = 32;

/// Maximum number of objects in a pose frame.
pub const OBJECT_LIMIT: usize = 1024;

#[derive(Debug)]
struct TimedPoses {
    time_secs: f64,
    objects: Vec<ObjectPose>,
}

/// The latest snapshots and the playback clock.
#[derive(Debug, Default)]
pub(super) struct Playback {
    snapshots: VecDeque<TimedPoses>,
    clock_secs: f64,
    /// Client clock minus server clock (s).
    clock_offset_secs: Option<f64>,
}

impl Playback {
    /// Stores the poses of simulated time `time_secs`. A time before the newest snapshot means that the world was restarted: all stored snapshots are
    /// dropped.
    pub(super) fn push(&mut self, time_secs: f64, objects: Vec<ObjectPose>) -> Result<(), MirrorError> {
        if objects.len() > OBJECT_LIMIT {
            return Err(range("number of objects", objects.len(), format!("at most {OBJECT_LIMIT}")));
        }
        if let Some(pose) = objects.iter().find(|pose| !is_valid(pose)) {
            return Err(range("pose", format!("{pose:?}"), "finite numbers within 1e6 and a unit quaternion"));
        }
        match self.snapshots.back_mut() {
            Some(newest) if time_secs == newest.time_secs => {
                newest.objects = objects;
                return Ok(());
            }
            Some(newest) if time_secs < newest.time_secs => self.snapshots.clear(),
            _ => {}
        }
        let measured = self.clock_secs - time_secs;
        self.clock_offset_secs = Some(match self.clock_offset_secs {
            Some(offset) if (measured - offset).abs() < CLOCK_JUMP_SECS => offset + CLOCK_SMOOTHING * (measured - offset),
            _ => measured,
        });
        self.snapshots.push_back(TimedPoses { time_secs, objects });
        if self.snapshots.len() > SNAPSHOT_LIMIT {
            self.snapshots.pop_front();
        }
        Ok(())
    }

    /// Advances the client's clock by `dt_secs`.
    pub(super) fn advance(&mut self, dt_secs: f64) {
        self.clock_secs += dt_secs;
    }

    /// Sets the time of playback to `time_secs`.
    pub(super) fn show_at(&mut self, time_secs: f64) {
        (self.clock_secs, self.clock_offset_secs) = (time_secs + DELAY_SECS, Some(0.0));
    }

    /// Simulated time of playback (s); `None` before the first snapshot.
    pub(super) fn time_secs(&self) -> Option<f64> {
        Some(self.clock_secs - self.clock_offset_secs? - DELAY_SECS)
    }

    /// Newest received poses.
    pub(super) fn newest(&self) -> &[ObjectPose] {
        self.snapshots.back().map_or(&[], |newest| &newest.objects)
    }

    /// Poses at the playback time: cubic Hermite interpolation of position and velocity, and spherical interpolation of rotation.
    pub(super) fn interpolated(&self) -> Vec<ObjectPose> {
        let (Some(time_secs), Some(newest), Some(oldest)) = (self.time_secs(), self.snapshots.back(), self.snapshots.front()) else {
            return Vec::new();
        };
        if time_secs <= oldest.time_secs {
            return oldest.objects.clone();
        }
        let next = self.snapshots.partition_point(|snapshot| snapshot.time_secs <= time_secs);
        let last = &self.snapshots[next - 1];
        match self.snapshots.get(next) {
            Some(following) => between(last, following, time_secs),
            None => extrapolate(newest, (time_secs - newest.time_secs).min(EXTRAPOLATION_SECS) as f32),
        }
    }
}

fn is_valid(pose: &ObjectPose) -> bool {
    let numbers = pose.position_m.iter().chain(&pose.velocity_m_per_s).chain([&pose.part_rad]);
    let unit = Quat::from_array(pose.rotation).length_squared();
    numbers.into_iter().all(|value| value.abs() <= 1e6) && (0.9..=1.1).contains(&unit)
}

fn extrapolate(snapshot: &TimedPoses, secs: f32) -> Vec<ObjectPose> {
    let moved = |pose: &ObjectPose| {
        let position = Vec3::from(pose.position_m) + Vec3::from(pose.velocity_m_per_s) * secs;
        ObjectPose { position_m: position.into(), ..*pose }
    };
    snapshot.objects.iter().map(moved).collect()
}

fn between(last: &TimedPoses, next: &TimedPoses, time_secs: f64) -> Vec<ObjectPose> {
    let span_secs = (next.time_secs - last.time_secs) as f32;
    let fraction = (time_secs - last.time_secs) as f32 / span_secs;
    let pose_at = |from: &ObjectPose| match next.objects.iter().find(|to| to.id == from.id) {
        Some(to) => blend(from, to, fraction, span_secs),
        None => *from,
    };
    last.objects.iter().map(pose_at).collect()
}

fn blend(from: &ObjectPose, to: &ObjectPose, s: f32, span_secs: f32) -> ObjectPose {
    let (p0, p1) = (Vec3::from(from.position_m), Vec3::from(to.position_m));
    let (m0, m1) = (Vec3::from(from.velocity_m_per_s) * span_secs, Vec3::from(to.velocity_m_per_s) * span_secs);
    if p0.distance(p1) > m0.length().max(m1.length()) + TELEPORT_M {
        return *to;
    }
    let (s2, s3) = (s * s, s * s * s);
    let position = (2.0 * s3 - 3.0 * s2 + 1.0) * p0 + (s3 - 2.0 * s2 + s) * m0 + (3.0 * s2 - 2.0 * s3) * p1 + (s3 - s2) * m1;
    let velocity = Vec3::from(from.velocity_m_per_s).lerp(Vec3::from(to.velocity_m_per_s), s);
    ObjectPose {
        position_m: position.into(),
        rotation: Quat::from_array(from.rotation).slerp(Quat::from_array(to.rotation), s).normalize().to_array(),
        velocity_m_per_s: velocity.into(),
        part_rad: from.part_rad + wrap_angle(to.part_rad - from.part_rad) * s,
        ..*to
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use prairie_core::scene::VehicleKind;

    fn pose(x_m: f32, speed_m_per_s: f32) -> ObjectPose {
        ObjectPose {
            id: 7,
            kind: VehicleKind::Car,
            position_m: [x_m, 0.0, 0.0],
            rotation: [0.0, 0.0, 0.0, 1.0],
            velocity_m_per_s: [speed_m_per_s, 0.0, 0.0],
            part_rad: 0.0,
        }
    }

    impl Playback {
        fn interpolated_at(&mut self, clock_secs: f64) -> Vec<ObjectPose> {
            self.clock_secs = clock_secs;
            self.interpolated()
        }

        fn push_at(&mut self, clock_secs: f64, time_secs: f64, pose: ObjectPose) {
            self.clock_secs = clock_secs;
            self.push(time_secs, vec![pose]).expect("a valid pose");
        }
    }

    /// Snapshots at 20 Hz of a car that accelerates at 3 m/s², arriving without delay.
    fn accelerating() -> (Playback, impl Fn(f64) -> f64) {
        let place = |t: f64| 1.5 * t * t;
        let mut playback = Playback::default();
        for i in 0..20 {
            let t = f64::from(i) * 0.05;
            playback.push_at(t, t, pose(place(t) as f32, 3.0 * t as f32));
        }
        (playback, place)
    }

    #[test]
    fn constant_acceleration_is_reproduced_exactly() {
        let (mut playback, place) = accelerating();
        for i in 0..80 {
            let clock = 0.12 + f64::from(i) * 0.011;
            let shown = playback.interpolated_at(clock)[0].position_m[0];
            assert!((f64::from(shown) - place(clock - DELAY_SECS)).abs() < 1e-5, "at {clock}");
        }
    }

    #[test]
    fn without_snapshots_an_object_is_extrapolated_and_then_stops() {
        let (mut playback, place) = accelerating();
        let newest = 0.95;
        let coasted = playback.interpolated_at(newest + DELAY_SECS + 0.1)[0].position_m[0];
        assert!((f64::from(coasted) - (place(newest) + 3.0 * newest * 0.1)).abs() < 1e-5);
        assert_eq!(playback.interpolated_at(50.0), playback.interpolated_at(60.0));
    }

    #[test]
    fn a_teleported_object_is_not_interpolated() {
        let mut playback = Playback::default();
        playback.push_at(0.0, 0.0, pose(0.0, 1.0));
        playback.push_at(0.1, 0.1, pose(50.0, 1.0));
        assert_eq!(playback.interpolated_at(0.15)[0].position_m[0], 50.0);
    }

    #[test]
    fn a_restarted_world_discards_old_snapshots() {
        let (mut playback, _) = accelerating();
        playback.push_at(9.0, 0.0, pose(-4.0, 0.0));
        assert_eq!(playback.interpolated_at(9.0)[0].position_m[0], -4.0);
    }

    #[test]
    fn network_jitter_does_not_make_motion_uneven() {
        let mut playback = Playback::default();
        let (mut last, mut slowest, mut fastest) = (None, f32::INFINITY, 0.0_f32);
        for i in 0..200_u32 {
            let t = f64::from(i) * 0.05;
            let late = if i % 3 == 0 { 0.03 } else { 0.0 };
            playback.push_at(t + late, t, pose(10.0 * t as f32, 10.0));
            let shown = playback.interpolated_at(t + 0.04)[0].position_m[0];
            if let (Some(before), true) = (last.replace(shown), i > 60) {
                slowest = slowest.min(shown - before);
                fastest = fastest.max(shown - before);
            }
        }
        assert!(slowest > 0.45 && fastest < 0.55, "{slowest} to {fastest} m a snapshot instead of 0.5");
    }

    #[test]
    fn invalid_poses_are_rejected() {
        let mut playback = Playback::default();
        for invalid in [pose(f32::NAN, 0.0), pose(2e6, 0.0), ObjectPose { rotation: [0.0; 4], ..pose(0.0, 0.0) }] {
            assert!(playback.push(0.0, vec![invalid]).is_err(), "{invalid:?}");
        }
        assert!(playback.push(0.0, vec![pose(0.0, 0.0); OBJECT_LIMIT + 1]).is_err());
        assert!(playback.newest().is_empty());
    }
}
