//! Interpolation between the server's snapshots. Objects are drawn a little late, so that a next snapshot to move towards is usually there.

use super::error::{MirrorError, range};
use super::playback_clock::PlaybackClock;
use crate::damped::wrap_angle;
use glam::{Quat, Vec3};
use prairie_core::wire::{ObjectId, ObjectPose};
use std::collections::VecDeque;

/// Maximum extrapolation time (s): how long objects continue at their last velocity without a new snapshot.
const EXTRAPOLATION_SECS: f64 = 0.15;

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

/// A pose, with the time of its snapshot (s).
type TimedPose = (f64, ObjectPose);

/// The latest snapshots and the playback clock.
#[derive(Debug, Default)]
pub(super) struct Playback {
    snapshots: VecDeque<TimedPoses>,
    clock: PlaybackClock,
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
            Some(newest) if time_secs < newest.time_secs => {
                self.snapshots.clear();
                self.clock.restart();
            }
            _ => {}
        }
        self.clock.receive(time_secs, self.snapshots.back().map(|newest| time_secs - newest.time_secs));
        self.snapshots.push_back(TimedPoses { time_secs, objects });
        if self.snapshots.len() > SNAPSHOT_LIMIT {
            self.snapshots.pop_front();
        }
        Ok(())
    }

    /// Advances the client's clock by `dt_secs`.
    pub(super) fn advance(&mut self, dt_secs: f64) {
        self.clock.advance(dt_secs);
    }

    /// Sets the time of playback to `time_secs`.
    pub(super) fn show_at(&mut self, time_secs: f64) {
        self.clock.show_at(time_secs);
    }

    /// The clock.
    pub(super) fn clock(&self) -> &PlaybackClock {
        &self.clock
    }

    /// Newest pose of an object, and the one of the snapshot before, with their times (s).
    pub(super) fn newest_two(&self, id: ObjectId) -> Option<(TimedPose, Option<TimedPose>)> {
        let mut newest = self.snapshots.iter().rev().map(|snapshot| {
            let pose = snapshot.objects.iter().find(|pose| pose.id == id);
            pose.map(|pose| (snapshot.time_secs, *pose))
        });
        Some((newest.next()??, newest.next().flatten()))
    }

    /// Time of the newest received poses (s).
    pub(super) fn newest_secs(&self) -> Option<f64> {
        Some(self.snapshots.back()?.time_secs)
    }

    /// Newest received poses.
    pub(super) fn newest(&self) -> &[ObjectPose] {
        self.snapshots.back().map_or(&[], |newest| &newest.objects)
    }

    /// Poses at the playback time: cubic Hermite interpolation of position and velocity, and spherical interpolation of rotation.
    pub(super) fn interpolated(&self) -> Vec<ObjectPose> {
        let (Some(time_secs), Some(newest), Some(oldest)) = (self.clock.time_secs(), self.snapshots.back(), self.snapshots.front()) else {
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

    const INTERVAL_SECS: f64 = 0.05;
    /// A picture: the client's clock (s), the time of playback (s), the position (m), and whether it is extrapolated.
    type Shown = (f64, f64, f64, bool);
    /// Interval between two pictures (s).
    const PICTURE_SECS: f64 = 0.01;

    /// A playback of snapshots of a car that starts at 0 and moves by `place` (m at a time in s) and `speed` (m/s), 20 a second, of which each is `late_secs` late; it
    /// is shown up to `until_secs`. For each picture: the client's clock (s), the time of playback (s), the position (m), and whether it is extrapolated.
    fn shown(
        place: impl Fn(f64) -> f64,
        speed: impl Fn(f64) -> f64,
        late_secs: impl Fn(u32) -> f64,
        until_secs: f64,
    ) -> (Playback, Vec<Shown>) {
        let (mut playback, mut pictures, mut next) = (Playback::default(), Vec::new(), 0);
        let mut arrived_secs = 0.0_f64;
        for picture in 0..(until_secs / PICTURE_SECS) as u32 {
            let clock_secs = f64::from(picture) * PICTURE_SECS;
            // In order, as on a socket.
            while arrived_secs.max(f64::from(next) * INTERVAL_SECS + late_secs(next)) <= clock_secs + 1e-9 {
                let time_secs = f64::from(next) * INTERVAL_SECS;
                arrived_secs = arrived_secs.max(time_secs + late_secs(next));
                playback.advance(arrived_secs.max(playback.clock.now_secs()) - playback.clock.now_secs());
                playback.push(time_secs, vec![pose(place(time_secs) as f32, speed(time_secs) as f32)]).expect("a valid pose");
                next += 1;
            }
            playback.advance(clock_secs - playback.clock.now_secs());
            let (Some(time_secs), Some(newest)) = (playback.clock.time_secs(), playback.snapshots.back()) else { continue };
            let newest_secs = newest.time_secs;
            let at_m = f64::from(playback.interpolated()[0].position_m[0]);
            pictures.push((clock_secs, time_secs, at_m, time_secs > newest_secs));
        }
        (playback, pictures)
    }

    fn steady(late_secs: impl Fn(u32) -> f64, until_secs: f64) -> (Playback, Vec<Shown>) {
        shown(|t| 10.0 * t, |_| 10.0, late_secs, until_secs)
    }

    /// A pseudo-random number from 0 to 1.
    fn noise(n: u32) -> f64 {
        f64::from(n.wrapping_mul(2_654_435_769) >> 8) / f64::from(1 << 24)
    }

    #[test]
    fn a_steady_stream_is_shown_one_interval_late() {
        let (playback, pictures) = steady(|_| 0.03, 10.0);
        assert!((playback.clock.delay_secs() - 0.055).abs() < 1e-6, "{}", playback.clock.delay_secs());
        let (clock_secs, time_secs, ..) = pictures[pictures.len() - 1];
        assert!((clock_secs - 0.03 - time_secs - 0.055).abs() < 1e-6, "{time_secs} s at {clock_secs} s");
        assert!(pictures.iter().all(|picture| !picture.3), "extrapolated");
    }

    #[test]
    fn jitter_lengthens_the_delay_until_motion_is_even_and_its_end_shortens_it() {
        let jitter = |n: u32| if (100..500).contains(&n) { 0.08 * noise(n) } else { 0.0 };
        let (playback, pictures) = steady(jitter, 40.0);
        let between = |from: f64, to: f64| pictures.iter().filter(move |picture| (from..to).contains(&picture.0));
        let delay_secs = |(clock_secs, time_secs, ..): &Shown| clock_secs - time_secs;
        let longest_secs = between(15.0, 25.0).map(delay_secs).fold(0.0, f64::max);
        assert!((0.11..0.145).contains(&longest_secs), "{longest_secs} s behind");
        let extrapolated = between(10.0, 25.0).filter(|picture| picture.3).count();
        assert_eq!(extrapolated, 0, "of {}", between(10.0, 25.0).count());
        let steps: Vec<_> = pictures.windows(2).filter(|pair| pair[0].0 > 1.0).map(|pair| pair[1].2 - pair[0].2).collect();
        let even_m = 10.0 * PICTURE_SECS;
        let (slowest, fastest) = steps.iter().fold((f64::INFINITY, 0.0_f64), |(low, high), step| (low.min(*step), high.max(*step)));
        assert!(slowest > 0.94 * even_m && fastest < 1.06 * even_m, "{slowest} to {fastest} m a picture instead of {even_m}");
        assert!((playback.clock.delay_secs() - 0.055).abs() < 1e-6 && delay_secs(&pictures[pictures.len() - 1]) < 0.06);
    }

    #[test]
    fn playback_follows_a_clock_that_was_set_at_once_and_waits_out_a_stall() {
        // The server drops 2 s: later for good.
        let (_, pictures) = steady(|n| if n < 100 { 0.0 } else { 2.0 }, 12.0);
        let (clock_secs, time_secs, ..) = pictures[pictures.len() - 1];
        assert!((clock_secs - 2.0 - time_secs - 0.055).abs() < 0.01, "{time_secs} s at {clock_secs} s");
        // One second without a snapshot: then all arrive at once.
        let (_, pictures) = steady(|n| (6.0 - f64::from(n) * INTERVAL_SECS).clamp(0.0, 1.0) * f64::from(u8::from(n >= 100)), 12.0);
        assert!(pictures.windows(2).all(|pair| pair[1].1 > pair[0].1), "playback never jumps back");
    }

    #[test]
    fn constant_acceleration_is_reproduced_exactly() {
        let place = |t: f64| 1.5 * t * t;
        let (_, pictures) = shown(place, |t| 3.0 * t, |_| 0.0, 2.0);
        for (_, time_secs, at_m, _) in pictures.iter().filter(|picture| picture.1 > 0.0) {
            assert!((at_m - place(*time_secs)).abs() < 1e-5, "at {time_secs}");
        }
    }

    #[test]
    fn without_snapshots_an_object_is_extrapolated_and_then_stops() {
        let (mut playback, pictures) = steady(|_| 0.0, 1.0);
        let newest_m = 10.0 * playback.snapshots.back().expect("a snapshot").time_secs;
        playback.advance(0.1);
        let time_secs = playback.clock.time_secs().expect("a snapshot");
        let coasted_m = f64::from(playback.interpolated()[0].position_m[0]);
        assert!(coasted_m > newest_m && (coasted_m - 10.0 * time_secs).abs() < 1e-4, "{coasted_m} m after {} pictures", pictures.len());
        playback.advance(50.0);
        let stopped = playback.interpolated();
        playback.advance(10.0);
        assert_eq!(playback.interpolated(), stopped);
    }

    #[test]
    fn a_teleported_object_is_not_interpolated() {
        let (playback, pictures) = shown(|t| if t < 1.0 { 0.0 } else { 50.0 }, |_| 1.0, |_| 0.0, 2.0);
        assert!(pictures.iter().all(|picture| picture.2 < 1.0 || picture.2 > 49.0) && playback.newest()[0].position_m[0] == 50.0);
    }

    #[test]
    fn a_restarted_world_discards_old_snapshots() {
        let (mut playback, _) = steady(|_| 0.0, 1.0);
        playback.advance(8.0);
        playback.push(0.0, vec![pose(-4.0, 0.0)]).expect("a valid pose");
        assert_eq!(playback.interpolated()[0].position_m[0], -4.0);
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
