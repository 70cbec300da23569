//! When the layers of the shadow map are drawn anew: what they show hardly changes from one frame to the next.

use super::Sun;
use super::cull::Beam;
use super::uniforms::Frame;
use super::view::{SHADOW_HALF_M, SHADOW_LAYERS};
use glam::Vec3;
use shared::wire::ObjectPose;

const LAYERS: usize = SHADOW_LAYERS as usize;
/// Frames that a drawing of each layer serves, in which time passes, and which of them is the one that it is drawn in: layers take turns. Trees sway in it that
/// much more coarsely.
const FRAMES: [u32; LAYERS] = [2, 4];
const TURN: [u32; LAYERS] = [0, 3];
/// Longest time that a drawing serves (s), for frames are drawn as seldom as one likes.
const LONGEST_SECS: f64 = 0.5;
/// Way of the eye after which a layer is drawn for another place, over half its side.
const WAY: f32 = 0.03;
/// Turn of the eye, or of the sun, after which it is (rad).
const TURN_RAD: f32 = 0.02;
/// Share by which the distance changes up to which trees are drawn, after which it is: the level of detail glides.
const TREES: f32 = 0.05;
/// Way of an object after which it is (m), and turn of it or of a part of it: any in the sharp layer; half a texel of the coarse one, in which none shows.
const MOVED_M: [f32; LAYERS] = [0.0, 0.25];
const TURNED_RAD: [f32; LAYERS] = [0.0, f32::INFINITY];

/// What the newest drawing of each layer was made for.
#[derive(Default)]
pub(super) struct KeptShadows {
    layers: [Option<Drawn>; LAYERS],
    /// Frames so far in which time passed.
    frames: u32,
}

struct Drawn {
    shadow_from_world: [f32; 16],
    seen: Seen,
    casters: Vec<ObjectPose>,
}

/// What layers are drawn for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Seen {
    pub(super) eye_m: Vec3,
    pub(super) heading_rad: f32,
    pub(super) sun: Sun,
    /// Distance up to which trees are drawn (m).
    pub(super) trees_m: f32,
    /// Whether what throws no shadow into a layer is left out.
    pub(super) culls: bool,
    pub(super) time_secs: f64,
}

impl Seen {
    fn is_like(&self, other: &Self, layer: usize) -> bool {
        let sun_turn_rad = Vec3::from(self.sun.direction()).distance(Vec3::from(other.sun.direction()));
        self.eye_m.distance(other.eye_m) <= WAY * SHADOW_HALF_M[layer]
            && (self.heading_rad - other.heading_rad).abs() <= TURN_RAD
            && sun_turn_rad <= TURN_RAD
            && (self.trees_m / other.trees_m - 1.0).abs() <= TREES
            && self.culls == other.culls
            && (self.time_secs - other.time_secs).abs() <= LONGEST_SECS
    }
}

impl KeptShadows {
    /// Which layers are to be drawn for a frame by its own projections; those of the others become what their kept drawings were made by. `reach_m` is how far
    /// an object reaches from where it is.
    pub(super) fn follow(
        &mut self,
        frame: &mut Frame,
        seen: Seen,
        poses: &[ObjectPose],
        reach_m: impl Fn(&ObjectPose) -> f32,
        dt_secs: f32,
    ) -> [bool; LAYERS] {
        self.frames = self.frames.wrapping_add(u32::from(dt_secs > 0.0));
        let projections = [&mut frame.shadow_from_world, &mut frame.lights.far_shadow_from_world];
        let mut due = [false; LAYERS];
        for (layer, ((due, projection), kept)) in due.iter_mut().zip(projections).zip(&mut self.layers).enumerate() {
            let beam = Beam::new(projection);
            let casters: Vec<ObjectPose> =
                poses.iter().filter(|pose| beam.meets_ball(pose.position_m.into(), reach_m(pose))).copied().collect();
            let is_its_turn = dt_secs > 0.0 && self.frames % FRAMES[layer] == TURN[layer];
            let serves = |drawn: &&Drawn| drawn.seen.is_like(&seen, layer) && stand_alike(&drawn.casters, &casters, layer);
            match kept.as_ref().filter(serves).filter(|_| !is_its_turn) {
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

/// Whether the same objects stand where others do, as far as a layer shows.
fn stand_alike(a: &[ObjectPose], b: &[ObjectPose], layer: usize) -> bool {
    let is_alike = |a: &ObjectPose, b: &ObjectPose| {
        let turned_rad =
            a.rotation.iter().zip(b.rotation).map(|(a, b)| 2.0 * (a - b).abs()).fold((a.part_rad - b.part_rad).abs(), f32::max);
        (a.id, a.kind) == (b.id, b.kind)
            && Vec3::from(a.position_m).distance(b.position_m.into()) <= MOVED_M[layer]
            && turned_rad <= TURNED_RAD[layer]
    };
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| is_alike(a, b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use bytemuck::Zeroable;
    use glam::Mat4;
    use shared::scene::VehicleKind;

    fn seen() -> Seen {
        let sun = Sun { heading_rad: 1.0, elevation_rad: 0.5 };
        Seen { eye_m: Vec3::ZERO, heading_rad: 0.0, sun, trees_m: 400.0, culls: true, time_secs: 1.0 }
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

    /// A frame whose layers show 52 m and 270 m about the origin, with a mark.
    fn frame(mark: f32) -> Frame {
        let layer = |half_m: f32| {
            let mut projection = Mat4::from_scale(Vec3::new(1.0 / half_m, 1.0 / half_m, 0.001)).to_cols_array();
            projection[14] = 0.5;
            projection[12] = mark;
            projection
        };
        let mut frame = Frame::zeroed();
        (frame.shadow_from_world, frame.lights.far_shadow_from_world) = (layer(52.0), layer(270.0));
        frame
    }

    fn follow(shadows: &mut KeptShadows, seen: Seen, poses: &[ObjectPose], dt_secs: f32) -> [bool; 2] {
        shadows.follow(&mut frame(0.0), seen, poses, |_| 3.0, dt_secs)
    }

    #[test]
    fn layers_take_turns_and_serve_frames_in_which_no_time_passes() {
        let mut shadows = KeptShadows::default();
        assert_eq!(follow(&mut shadows, seen(), &[], 0.0), [true, true]);
        // A look aside does not change whose turn it is.
        let heading_rad = |frame| if frame < 11 { 0.0 } else { 0.5 };
        let mut drawn: Vec<[bool; 2]> =
            (0..20).map(|frame| follow(&mut shadows, Seen { heading_rad: heading_rad(frame), ..seen() }, &[], 0.02)).collect();
        assert_eq!(drawn[11], [true, true]);
        drawn.remove(11);
        assert!(drawn.iter().all(|due| *due != [true, true]));
        let mut shadows = KeptShadows::default();
        assert_eq!(follow(&mut shadows, seen(), &[], 0.0), [true, true]);
        let drawn: Vec<[bool; 2]> = (0..8).map(|_| follow(&mut shadows, seen(), &[], 0.02)).collect();
        assert_eq!(drawn.iter().map(|due| due[0]).collect::<Vec<_>>(), [false, true, false, true, false, true, false, true]);
        assert_eq!(drawn.iter().map(|due| due[1]).collect::<Vec<_>>(), [false, false, true, false, false, false, true, false]);
        let mut shadows = KeptShadows::default();
        assert_eq!(follow(&mut shadows, seen(), &[], 0.0), [true, true]);
        assert!((0..9).all(|_| follow(&mut shadows, seen(), &[], 0.0) == [false, false]));
        assert_eq!(follow(&mut shadows, Seen { time_secs: 1.6, ..seen() }, &[], 0.0), [true, true]);
    }

    #[test]
    fn a_layer_is_drawn_for_another_view_and_kept_with_its_projection_for_nearly_the_same() {
        let another = [
            (Seen { eye_m: Vec3::X * 9.0, ..seen() }, [true, true]),
            (Seen { eye_m: Vec3::X * 4.0, ..seen() }, [true, false]),
            (Seen { heading_rad: 0.1, ..seen() }, [true, true]),
            (Seen { sun: Sun { heading_rad: 1.0, elevation_rad: 0.6 }, ..seen() }, [true, true]),
            (Seen { trees_m: 800.0, ..seen() }, [true, true]),
            (Seen { trees_m: 404.0, ..seen() }, [false, false]),
            (Seen { culls: false, ..seen() }, [true, true]),
            (Seen { eye_m: Vec3::X, ..seen() }, [false, false]),
        ];
        for (then, due) in another {
            let mut shadows = KeptShadows::default();
            assert_eq!(follow(&mut shadows, seen(), &[], 0.0), [true, true]);
            let mut now = frame(0.25);
            assert_eq!(shadows.follow(&mut now, then, &[], |_| 3.0, 0.0), due, "{then:?}");
            let marks = [now.shadow_from_world[12], now.lights.far_shadow_from_world[12]];
            assert_eq!(marks, due.map(|due| if due { 0.25 } else { 0.0 }), "{then:?}");
        }
    }

    #[test]
    fn what_moves_is_drawn_where_a_layer_shows_it() {
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
            let mut shadows = KeptShadows::default();
            follow(&mut shadows, seen(), &before, 0.0);
            assert_eq!(follow(&mut shadows, seen(), &after, 0.0), due, "{before:?} {after:?}");
        }
    }
}
