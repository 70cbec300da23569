//! Shadow cache: shadow cascades are reused over several frames, since they hardly change between frames.

use crate::render::gpu::uniforms::Frame;
use crate::render::inputs::cascades::{CASCADE_HALF_M, SHADOW_CASCADES};
use crate::render::inputs::frustum::CascadeVolume;
use glam::Vec3;
use prairie_core::light::sun::Sun;
use prairie_core::wire::ObjectPose;

const CASCADES: usize = SHADOW_CASCADES as usize;
/// Refresh period of each cascade (frames in which time advances), and its phase (frame within the period): cascades take turns.
/// The shadows of swaying trees move in steps of this period.
const PERIOD_FRAMES: [u32; CASCADES] = [2, 4];
const PHASE: [u32; CASCADES] = [0, 3];
/// Maximum age of a cascade (s), as frames may be rare.
const MAX_AGE_SECS: f64 = 0.5;
/// Camera movement that invalidates a cascade, relative to half its side.
const MAX_CAMERA_SHIFT: f32 = 0.03;
/// Rotation of the camera, or movement of the sun, that invalidates a cascade (rad).
const MAX_TURN_RAD: f32 = 0.02;
/// Relative change of the maximum distance of trees that invalidates a cascade; the level of detail changes gradually.
const MAX_TREES_CHANGE: f32 = 0.05;
/// Object movement (m) and rotation (rad), of the whole or of a part, that invalidates a cascade: any in the sharp one; in the coarse one half a texel, and
/// no rotation, which would not be visible.
const MAX_OBJECT_SHIFT_M: [f32; CASCADES] = [0.0, 0.25];
const MAX_OBJECT_TURN_RAD: [f32; CASCADES] = [0.0, f32::INFINITY];

/// State that the cached drawing of each cascade was made for.
#[derive(Default)]
pub(crate) struct ShadowCache {
    cascades: [Option<Drawn>; CASCADES],
    /// Frames so far in which time advanced.
    frames: u32,
}

struct Drawn {
    shadow_from_world: [f32; 16],
    seen: ShadowView,
    casters: Vec<ObjectPose>,
}

/// View that cascades are drawn for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ShadowView {
    pub(crate) eye_m: Vec3,
    pub(crate) heading_rad: f32,
    pub(crate) sun: Sun,
    /// Maximum distance of trees (m).
    pub(crate) trees_m: f32,
    /// Whether models that cast no shadow into a cascade are culled.
    pub(crate) culls: bool,
    pub(crate) time_secs: f64,
}

impl ShadowView {
    fn is_like(&self, other: &Self, cascade: usize) -> bool {
        let sun_turn_rad = Vec3::from(self.sun.direction()).distance(Vec3::from(other.sun.direction()));
        self.eye_m.distance(other.eye_m) <= MAX_CAMERA_SHIFT * CASCADE_HALF_M[cascade]
            && (self.heading_rad - other.heading_rad).abs() <= MAX_TURN_RAD
            && sun_turn_rad <= MAX_TURN_RAD
            && (self.trees_m / other.trees_m - 1.0).abs() <= MAX_TREES_CHANGE
            && self.culls == other.culls
            && (self.time_secs - other.time_secs).abs() <= MAX_AGE_SECS
    }
}

impl ShadowCache {
    /// Returns which cascades must be redrawn, with the projections of `frame`. Those of the others are replaced by the projections of their cached drawings.
    /// `reach_m` is the maximum distance of an object's parts from its position.
    pub(crate) fn update(
        &mut self,
        frame: &mut Frame,
        seen: ShadowView,
        poses: &[ObjectPose],
        reach_m: impl Fn(&ObjectPose) -> f32,
        dt_secs: f32,
    ) -> [bool; CASCADES] {
        self.frames = self.frames.wrapping_add(u32::from(dt_secs > 0.0));
        let projections = [&mut frame.shadow_from_world, &mut frame.lights.far_shadow_from_world];
        let mut due = [false; CASCADES];
        for (cascade, ((due, projection), kept)) in due.iter_mut().zip(projections).zip(&mut self.cascades).enumerate() {
            let beam = CascadeVolume::new(projection);
            let casters: Vec<ObjectPose> =
                poses.iter().filter(|pose| beam.meets_sphere(pose.position_m.into(), reach_m(pose))).copied().collect();
            let is_periodic = dt_secs > 0.0 && self.frames % PERIOD_FRAMES[cascade] == PHASE[cascade];
            let is_valid = |drawn: &&Drawn| drawn.seen.is_like(&seen, cascade) && are_alike(&drawn.casters, &casters, cascade);
            match kept.as_ref().filter(is_valid).filter(|_| !is_periodic) {
                Some(drawn) => *projection = drawn.shadow_from_world,
                None => {
                    *kept = Some(Drawn { shadow_from_world: *projection, seen, casters });
                    *due = true;
                }
            }
        }
        due
    }
}

/// Whether two lists have the same objects at the same positions, within the tolerance of a cascade.
fn are_alike(a: &[ObjectPose], b: &[ObjectPose], cascade: usize) -> bool {
    let is_alike = |a: &ObjectPose, b: &ObjectPose| {
        let turned_rad =
            a.rotation.iter().zip(b.rotation).map(|(a, b)| 2.0 * (a - b).abs()).fold((a.part_rad - b.part_rad).abs(), f32::max);
        (a.id, a.kind) == (b.id, b.kind)
            && Vec3::from(a.position_m).distance(b.position_m.into()) <= MAX_OBJECT_SHIFT_M[cascade]
            && turned_rad <= MAX_OBJECT_TURN_RAD[cascade]
    };
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| is_alike(a, b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use bytemuck::Zeroable;
    use glam::Mat4;
    use prairie_core::scene::VehicleKind;

    fn seen() -> ShadowView {
        let sun = Sun { heading_rad: 1.0, elevation_rad: 0.5 };
        ShadowView { eye_m: Vec3::ZERO, heading_rad: 0.0, sun, trees_m: 400.0, culls: true, time_secs: 1.0 }
    }

    fn car(x_m: f32) -> ObjectPose {
        ObjectPose {
            id: 1,
            kind: VehicleKind::Car,
            position_m: [x_m, 0.0, 0.0],
            rotation: [0.0, 0.0, 0.0, 1.0],
            velocity_m_per_s: [0.0; 3],
            part_rad: 0.0,
        }
    }

    /// A frame whose cascades cover 52 m and 270 m around the origin, with a mark in their projections.
    fn frame(mark: f32) -> Frame {
        let cascade = |half_m: f32| {
            let mut projection = Mat4::from_scale(Vec3::new(1.0 / half_m, 1.0 / half_m, 0.001)).to_cols_array();
            projection[14] = 0.5;
            projection[12] = mark;
            projection
        };
        let mut frame = Frame::zeroed();
        (frame.shadow_from_world, frame.lights.far_shadow_from_world) = (cascade(52.0), cascade(270.0));
        frame
    }

    fn update(shadows: &mut ShadowCache, seen: ShadowView, poses: &[ObjectPose], dt_secs: f32) -> [bool; 2] {
        shadows.update(&mut frame(0.0), seen, poses, |_| 3.0, dt_secs)
    }

    #[test]
    fn cascades_take_turns_and_stay_valid_while_time_stands_still() {
        let mut shadows = ShadowCache::default();
        assert_eq!(update(&mut shadows, seen(), &[], 0.0), [true, true]);
        // A rotation of the camera does not change the phase.
        let heading_rad = |frame| if frame < 11 { 0.0 } else { 0.5 };
        let mut drawn: Vec<[bool; 2]> =
            (0..20).map(|frame| update(&mut shadows, ShadowView { heading_rad: heading_rad(frame), ..seen() }, &[], 0.02)).collect();
        assert_eq!(drawn[11], [true, true]);
        drawn.remove(11);
        assert!(drawn.iter().all(|due| *due != [true, true]));
        let mut shadows = ShadowCache::default();
        assert_eq!(update(&mut shadows, seen(), &[], 0.0), [true, true]);
        let drawn: Vec<[bool; 2]> = (0..8).map(|_| update(&mut shadows, seen(), &[], 0.02)).collect();
        assert_eq!(drawn.iter().map(|due| due[0]).collect::<Vec<_>>(), [false, true, false, true, false, true, false, true]);
        assert_eq!(drawn.iter().map(|due| due[1]).collect::<Vec<_>>(), [false, false, true, false, false, false, true, false]);
        let mut shadows = ShadowCache::default();
        assert_eq!(update(&mut shadows, seen(), &[], 0.0), [true, true]);
        assert!((0..9).all(|_| update(&mut shadows, seen(), &[], 0.0) == [false, false]));
        assert_eq!(update(&mut shadows, ShadowView { time_secs: 1.6, ..seen() }, &[], 0.0), [true, true]);
    }

    #[test]
    fn a_cascade_is_redrawn_for_another_view_and_reused_for_a_similar_one() {
        let another = [
            (ShadowView { eye_m: Vec3::X * 9.0, ..seen() }, [true, true]),
            (ShadowView { eye_m: Vec3::X * 4.0, ..seen() }, [true, false]),
            (ShadowView { heading_rad: 0.1, ..seen() }, [true, true]),
            (ShadowView { sun: Sun { heading_rad: 1.0, elevation_rad: 0.6 }, ..seen() }, [true, true]),
            (ShadowView { trees_m: 800.0, ..seen() }, [true, true]),
            (ShadowView { trees_m: 404.0, ..seen() }, [false, false]),
            (ShadowView { culls: false, ..seen() }, [true, true]),
            (ShadowView { eye_m: Vec3::X, ..seen() }, [false, false]),
        ];
        for (then, due) in another {
            let mut shadows = ShadowCache::default();
            assert_eq!(update(&mut shadows, seen(), &[], 0.0), [true, true]);
            let mut now = frame(0.25);
            assert_eq!(shadows.update(&mut now, then, &[], |_| 3.0, 0.0), due, "{then:?}");
            let marks = [now.shadow_from_world[12], now.lights.far_shadow_from_world[12]];
            assert_eq!(marks, due.map(|due| if due { 0.25 } else { 0.0 }), "{then:?}");
        }
    }

    #[test]
    fn moving_objects_invalidate_the_cascades_that_show_them() {
        let turned = ObjectPose { rotation: [0.0, 0.6, 0.0, 0.8], ..car(1.0) };
        let moves = [
            (vec![car(1.0)], vec![car(1.1)], [true, false]),
            (vec![car(1.0)], vec![car(1.5)], [true, true]),
            (vec![car(1.0)], vec![turned], [true, false]),
            (vec![car(1.0)], vec![], [true, true]),
            (vec![car(100.0)], vec![car(101.0)], [false, true]),
            (vec![car(900.0)], vec![car(800.0)], [false, false]),
            (vec![car(1.0)], vec![ObjectPose { velocity_m_per_s: [1.0; 3], ..car(1.0) }], [false, false]),
        ];
        for (before, after, due) in moves {
            let mut shadows = ShadowCache::default();
            update(&mut shadows, seen(), &before, 0.0);
            assert_eq!(update(&mut shadows, seen(), &after, 0.0), due, "{before:?} {after:?}");
        }
    }
}
