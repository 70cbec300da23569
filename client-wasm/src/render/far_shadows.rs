//! When the coarse layer of the shadow map is drawn anew: it covers so much land that what it shows hardly changes from one frame to the next.

use super::Sun;
use glam::Vec3;
use shared::wire::ObjectPose;

/// Frames that a drawing serves, in which time passes: trees sway in it that much more coarsely.
const FRAMES: u32 = 4;
/// Way of the eye after which it is drawn for another place (m), of the 270 m that it reaches.
const WAY_M: f32 = 8.0;
/// Turn of the eye, or of the sun, after which it is (rad).
const TURN_RAD: f32 = 0.02;

/// What the newest drawing was made for.
#[derive(Default)]
pub(super) struct FarShadows {
    drawn: Option<Drawn>,
}

struct Drawn {
    shadow_from_world: [f32; 16],
    seen: Seen,
    poses: Vec<ObjectPose>,
    frames: u32,
}

/// What the layer is drawn for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Seen {
    pub(super) eye_m: Vec3,
    pub(super) heading_rad: f32,
    pub(super) sun: Sun,
}

impl Seen {
    fn is_like(&self, other: &Self) -> bool {
        let sun_turn_rad = Vec3::from(self.sun.direction()).distance(Vec3::from(other.sun.direction()));
        self.eye_m.distance(other.eye_m) <= WAY_M && (self.heading_rad - other.heading_rad).abs() <= TURN_RAD && sun_turn_rad <= TURN_RAD
    }
}

impl FarShadows {
    /// Whether the layer is to be drawn with this projection; if not, it becomes that of the drawing that is kept.
    pub(super) fn follow(&mut self, shadow_from_world: &mut [f32; 16], seen: Seen, poses: &[ObjectPose], dt_secs: f32) -> bool {
        if let Some(drawn) = &mut self.drawn {
            drawn.frames += u32::from(dt_secs > 0.0);
            if drawn.frames < FRAMES && drawn.seen.is_like(&seen) && drawn.poses == poses {
                *shadow_from_world = drawn.shadow_from_world;
                return false;
            }
        }
        self.drawn = Some(Drawn { shadow_from_world: *shadow_from_world, seen, poses: poses.to_vec(), frames: 0 });
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::scene::VehicleKind;

    fn seen() -> Seen {
        Seen { eye_m: Vec3::ZERO, heading_rad: 0.0, sun: Sun { heading_rad: 1.0, elevation_rad: 0.5 } }
    }

    #[test]
    fn a_drawing_serves_some_frames_and_those_in_which_no_time_passes() {
        let mut shadows = FarShadows::default();
        let drawn: Vec<bool> = (0..9).map(|_| shadows.follow(&mut [0.0; 16], seen(), &[], 0.02)).collect();
        assert_eq!(drawn, [true, false, false, false, true, false, false, false, true]);
        assert!((0..9).all(|_| !shadows.follow(&mut [0.0; 16], seen(), &[], 0.0)));
    }

    #[test]
    fn what_moves_is_drawn_where_it_is_and_what_hardly_does_by_the_kept_projection() {
        let elsewhere = [
            Seen { eye_m: Vec3::X * 9.0, ..seen() },
            Seen { heading_rad: 0.1, ..seen() },
            Seen { sun: Sun { heading_rad: 1.0, elevation_rad: 0.6 }, ..seen() },
        ];
        let pose = ObjectPose {
            id: 1,
            kind: VehicleKind::Car,
            position_m: [0.0; 3],
            rotation: [0.0, 0.0, 0.0, 1.0],
            velocity_m_per_s: [0.0; 3],
            part_rad: 0.0,
        };
        let driven = ObjectPose { position_m: [1.0, 0.0, 0.0], ..pose };
        for (moved, pose_then) in elsewhere.map(|moved| (moved, pose)).into_iter().chain([(seen(), driven)]) {
            let mut shadows = FarShadows::default();
            assert!(shadows.follow(&mut [1.0; 16], seen(), &[pose], 0.0));
            let mut kept = [2.0; 16];
            assert!(!shadows.follow(&mut kept, Seen { eye_m: Vec3::X, ..seen() }, &[pose], 0.0));
            assert_eq!(kept, [1.0; 16]);
            let mut fitting = [3.0; 16];
            assert!(shadows.follow(&mut fitting, moved, &[pose_then], 0.0), "{moved:?}");
            assert_eq!(fitting, [3.0; 16]);
        }
    }
}
