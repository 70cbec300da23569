//! Redraw tracking: a frame that would equal the previous one is not drawn.

use crate::camera::Camera;
use crate::state::Mirror;
use crate::vehicle::profile;
use prairie_core::scene::Scene;
use prairie_core::wire::ObjectPose;
use std::f32::consts::TAU;

/// Number of time constants after which a decaying motion counts as over; it is then below 1/1000.
const TIME_CONSTANTS: f32 = 7.0;
/// Shortest time constant assumed: that of the force field around plants, and of plants without a settling time of their own (s).
const SHORTEST_TAU_SECS: f32 = 1.0;
/// Maximum settling time (s).
const MAX_SETTLE_SECS: f32 = 60.0;
/// Maximum time by which one frame advances the blades (s).
const MAX_STEP_SECS: f32 = 0.1;

/// Smallest change of a position (m), a quaternion component or an angle (rad) that counts as motion.
const MOTION_THRESHOLD: f32 = 1e-4;

/// Detects changes of the picture. `V` holds everything a frame depends on besides world and camera, such as size and quality.
#[derive(Clone, Debug)]
pub struct RedrawTracker<V> {
    drawn: Option<Drawn<V>>,
    /// Time since the last change (s).
    settled_secs: f32,
}

impl<V> Default for RedrawTracker<V> {
    fn default() -> Self {
        Self { drawn: None, settled_secs: 0.0 }
    }
}

/// State of the last frame drawn.
#[derive(Clone, Debug)]
struct Drawn<V> {
    camera: Camera,
    view: V,
    scene_number: u32,
    broken: u32,
    poses: Vec<ObjectPose>,
}

impl<V: PartialEq> Drawn<V> {
    fn is_like(&self, other: &Self) -> bool {
        let same = (self.camera, self.scene_number, self.broken) == (other.camera, other.scene_number, other.broken);
        let poses = || self.poses.len() == other.poses.len() && self.poses.iter().zip(&other.poses).all(|(a, b)| is_at_rest(a, b));
        same && self.view == other.view && poses()
    }
}

impl<V: PartialEq> RedrawTracker<V> {
    /// Whether the frame after `dt_secs` may differ from the previous one.
    pub fn needs_frame(&mut self, mirror: &Mirror, camera: &Camera, view: V, dt_secs: f32) -> bool {
        let Some(decoded) = mirror.decoded_scene() else { return true };
        let poses: Vec<ObjectPose> = mirror.objects().collect();
        let parts_move = poses.iter().any(|pose| profile(pose.kind).moves_at_rest);
        let now = Drawn { camera: *camera, view, scene_number: mirror.scene_number(), broken: mirror.broken_count(), poses };
        let is_like = self.drawn.as_ref().is_some_and(|drawn| drawn.is_like(&now));
        if parts_move || !mirror.is_calm() || mirror.has_dirty_patches() || !is_like {
            (self.drawn, self.settled_secs) = (Some(now), 0.0);
            return true;
        }
        let is_moving = self.settled_secs < settle_secs(decoded.scene());
        self.settled_secs += dt_secs.min(MAX_STEP_SECS);
        is_moving
    }

    /// Forces the next frame to be drawn.
    pub fn invalidate(&mut self) {
        self.drawn = None;
    }
}

/// Whether an object has the same pose within [`MOTION_THRESHOLD`].
fn is_at_rest(a: &ObjectPose, b: &ObjectPose) -> bool {
    let numbers = |pose: &ObjectPose| {
        let ([x, y, z], [qx, qy, qz, qw]) = (pose.position_m, pose.rotation);
        [x, y, z, qx, qy, qz, qw, pose.part_rad]
    };
    (a.id, a.kind) == (b.id, b.kind) && numbers(a).iter().zip(numbers(b)).all(|(a, b)| (a - b).abs() < MOTION_THRESHOLD)
}

/// Settling time of undisturbed plants (s): that of the slowest blades, underbrush or force field.
fn settle_secs(scene: &Scene) -> f32 {
    let (plants, damping) = (&scene.plants, scene.plants.swing_damping);
    let slowest_hz = scene.kinds_of_plants().iter().map(|plants| plants.swing_hz).fold(f32::INFINITY, f32::min);
    // Taller blades swing more slowly.
    let omega = TAU * slowest_hz / plants.most_grown();
    // Lower bound of the decay rate of the slower solution of x'' + 2ζω·x' + ω²·x = 0.
    let rate_per_s = omega * if damping < 1.0 { damping } else { 0.5 / damping };
    let underbrush_secs = scene.underbrush.iter().map(|species| species.settle_secs).fold(SHORTEST_TAU_SECS, f32::max);
    let lag_secs = scene.kinds().iter().map(|grass| grass.lag_secs).fold(0.0, f32::max);
    (TIME_CONSTANTS * underbrush_secs.max(1.0 / rate_per_s) + 2.0 * lag_secs).min(MAX_SETTLE_SECS)
}

#[cfg(test)]
mod tests {
    use super::*;
    use prairie_core::scene::{TerrainMaps, VehicleKind, Wind, WindDust};
    use prairie_core::terrain::grey_png;
    use prairie_core::wire::{ServerMessage, Shape, TurbulenceState, codec};

    const DT_SECS: f32 = 1.0 / 30.0;

    fn meadow(change: impl FnOnce(&mut Scene)) -> Mirror {
        let maps = TerrainMaps { height_map: String::new(), covering_map: String::new(), pixel_m: [4.0; 2], level_m: 0.1, base_m: 0.0 };
        let mut scene = Scene { wind: Wind { cells: [4, 2, 4], mean_m_per_s: [0.0; 2], ..Wind::default() }, ..Scene::new(maps) };
        change(&mut scene);
        let map = grey_png([4; 2], &[255; 16]);
        let mut mirror = Mirror::default();
        let (height_png, covering_png) = (map.clone(), map);
        let scene = ServerMessage::Scene {
            scene: Box::new(scene),
            height_png,
            covering_png,
            nutrient_png: Vec::new(),
            models: Vec::new(),
            shapes: Default::default(),
        };
        mirror.apply(scene).expect("a valid scene");
        mirror
    }

    fn blow(mirror: &mut Mirror, seq: u32, codes: &[i16]) {
        let payload = codec::encode(Shape::wind(4, codes.len() > 96), codes, None);
        mirror
            .apply(ServerMessage::Wind { tick: 1, seq, key: true, turbulence: TurbulenceState::default(), payload })
            .expect("a valid wind frame");
    }

    fn bend(mirror: &mut Mirror, seq: u32, code: i16) {
        let cells = mirror.decoded_scene().expect("a scene").layout().cells as usize;
        let payload = codec::encode(Shape::patch(cells), &vec![code; 3 * cells * cells], None);
        mirror.apply(ServerMessage::Patch { patch: 0, seq, key: true, payload }).expect("a valid patch");
    }

    fn place(mirror: &mut Mirror, tick: u64, kind: VehicleKind, x_m: f32) {
        let (position_m, rotation) = ([x_m, 1.0, 8.0], [0.0, 0.0, 0.0, 1.0]);
        let object = ObjectPose { id: 3, kind, position_m, rotation, velocity_m_per_s: [0.0; 3], part_rad: 0.0 };
        mirror.apply(ServerMessage::Poses { tick, objects: vec![object] }).expect("valid poses");
    }

    /// Number of frames needed within `secs`. A needed frame takes the changed patches, as drawing does.
    fn needed(tracker: &mut RedrawTracker<u32>, mirror: &mut Mirror, secs: f32) -> u32 {
        let camera = Camera::default();
        let mut frame = |mirror: &mut Mirror| {
            mirror.advance(f64::from(DT_SECS));
            let is_needed = tracker.needs_frame(mirror, &camera, 0, DT_SECS);
            if is_needed {
                mirror.take_dirty_patches();
            }
            u32::from(is_needed)
        };
        (0..(secs / DT_SECS) as u32).map(|_| frame(mirror)).sum()
    }

    #[test]
    fn a_calm_meadow_stops_redrawing_until_something_changes() {
        let mut mirror = meadow(|_| {});
        let mut tracker = RedrawTracker::default();
        let settle_secs = settle_secs(mirror.decoded_scene().expect("a scene").scene());
        let frames = needed(&mut tracker, &mut mirror, 60.0);
        assert!(settle_secs < 30.0 && (frames as f32 * DT_SECS - settle_secs).abs() < 0.2, "{frames} frames to settle in {settle_secs} s");
        assert_eq!(needed(&mut tracker, &mut mirror, 10.0), 0);

        bend(&mut mirror, 1, 5);
        assert_eq!(needed(&mut tracker, &mut mirror, 60.0), frames, "after a changed patch");
        blow(&mut mirror, 1, &[0; 96]);
        assert_eq!(needed(&mut tracker, &mut mirror, 10.0), 0, "after a wind frame without wind");
        assert!(tracker.needs_frame(&mirror, &Camera { pitch_rad: 0.1, ..Camera::default() }, 0, DT_SECS), "after a turn of the camera");
        needed(&mut tracker, &mut mirror, 60.0);
        assert!(tracker.needs_frame(&mirror, &Camera::default(), 1, DT_SECS), "after a change of render options");
        needed(&mut tracker, &mut mirror, 60.0);
        tracker.invalidate();
        assert!(tracker.needs_frame(&mirror, &Camera::default(), 0, DT_SECS));
    }

    #[test]
    fn moving_air_always_needs_frames() {
        let one = |at: usize, count: usize| (0..count).map(|i| i16::from(i == at)).collect::<Vec<i16>>();
        for (cause, mut mirror, wind) in [
            ("mean wind", meadow(|scene| scene.wind.mean_m_per_s = [0.0, -2.0]), vec![0; 96]),
            ("natural wind", meadow(|scene| scene.natural_wind.strength_rad_per_s2 = 1.0), vec![0; 96]),
            ("rain", meadow(|scene| scene.rain.rate_mm_per_h = 5.0), vec![0; 96]),
            ("wind in one cell", meadow(|_| {}), one(50, 96)),
            ("dust", meadow(|scene| scene.wind.dust = WindDust { release_per_s: 1.0, ..WindDust::default() }), one(100, 128)),
        ] {
            blow(&mut mirror, 1, &wind);
            assert_eq!(needed(&mut RedrawTracker::default(), &mut mirror, 70.0), 70 * 30, "{cause}");
        }
    }

    #[test]
    fn objects_need_frames_only_while_they_move() {
        let mut mirror = meadow(|_| {});
        let mut tracker = RedrawTracker::default();
        let settled = needed(&mut tracker, &mut mirror, 60.0);
        place(&mut mirror, 60, VehicleKind::Car, 8.0);
        assert!(needed(&mut tracker, &mut mirror, 60.0) >= settled);
        place(&mut mirror, 120, VehicleKind::Car, 8.000_01);
        assert_eq!(needed(&mut tracker, &mut mirror, 5.0), 0, "a car that jitters below the threshold");
        place(&mut mirror, 180, VehicleKind::Car, 8.01);
        assert!(needed(&mut tracker, &mut mirror, 60.0) >= settled, "a car that has moved");
        place(&mut mirror, 240, VehicleKind::Helicopter, 8.01);
        assert_eq!(needed(&mut tracker, &mut mirror, 70.0), 70 * 30, "a rotor that turns");
    }
}
