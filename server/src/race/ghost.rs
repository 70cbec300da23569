//! Tracks of laps, of which the fastest becomes the ghost that others race against.

use super::course::Course;
use super::driven_motion::DrivenMotion;
use prairie_core::body::PoseCode;
use prairie_core::wire::{GHOST_LIMIT, Ghost};
use serde::{Deserialize, Serialize};

/// Poses of a vehicle during a lap, at equal distances in time.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Track {
    /// Step of the first pose.
    first_tick: u64,
    poses: Vec<PoseCode>,
    /// Whether the lap took longer than a ghost may.
    is_cut: bool,
}

impl Track {
    /// Adds the pose after step `tick`, if it is one of those that the course records.
    pub(super) fn record(&mut self, course: &Course, tick: u64, motion: &DrivenMotion) {
        if !tick.is_multiple_of(course.track_period) {
            return;
        }
        if self.poses.is_empty() {
            self.first_tick = tick;
        }
        self.is_cut |= self.poses.len() == GHOST_LIMIT;
        if !self.is_cut {
            self.poses.push(PoseCode::of(&motion.to));
        }
    }

    /// The ghost of a complete lap from `began_secs` on that took `lap_secs`; `None` if its track is incomplete.
    pub(super) fn into_ghost(self, course: &Course, motion: &DrivenMotion, began_secs: f64, lap_secs: f64) -> Option<Ghost> {
        let is_complete = !self.is_cut && !self.poses.is_empty();
        is_complete.then(|| Ghost {
            client: motion.client,
            kind: motion.kind,
            lap_secs: lap_secs as f32,
            first_secs: (course.secs(self.first_tick, 1.0) - began_secs) as f32,
            period_secs: (course.secs(course.track_period, 1.0)) as f32,
            poses: self.poses,
        })
    }

    /// Whether it is one that [`record`](Self::record) may have made.
    pub(super) fn is_bounded(&self) -> bool {
        self.poses.len() <= GHOST_LIMIT
    }

    /// The poses as words of a checksum.
    pub(super) fn words(&self) -> impl Iterator<Item = u32> {
        words(&self.poses)
    }
}

/// Poses as words of a checksum.
pub(super) fn words(poses: &[PoseCode]) -> impl Iterator<Item = u32> {
    poses.iter().flat_map(|pose| pose.position.into_iter().chain(pose.rotation.map(i32::from)).map(|code| code as u32))
}
