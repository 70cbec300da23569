//! Whether a frame would differ from the last one: at rest, none is drawn.

use crate::camera::Camera;
use crate::state::Mirror;
use shared::scene::{Scene, VehicleKind};
use shared::wire::ObjectPose;
use std::f32::consts::TAU;

/// Time constants after which a motion that dies away is no longer seen: it is down to 1/1000.
const TIME_CONSTANTS: f32 = 7.0;
/// Time constant of what lingers in the force field about plants, and of plants that follow as fast as they can (s).
const LINGERING_SECS: f32 = 1.0;
/// Longest that plants are watched coming to rest (s).
const LONGEST_SECS: f32 = 60.0;
/// Longest time that a frame lets blades swing for (s).
const LONGEST_STEP_SECS: f32 = 0.1;

/// Least change of a place (m), of a quaternion's part and of an angle (rad) that counts as motion.
const LEAST_MOTION: f32 = 1e-4;

/// Watches what a picture shows. `H` is how it is drawn: size, quality and whatever else a frame depends on.
#[derive(Clone, Debug)]
pub struct Stillness<H> {
    seen: Option<Seen<H>>,
    /// Time drawn since the last change (s).
    settled_secs: f32,
}

impl<H> Default for Stillness<H> {
    fn default() -> Self {
        Self { seen: None, settled_secs: 0.0 }
    }
}

#[derive(Clone, Debug)]
struct Seen<H> {
    camera: Camera,
    how: H,
    scene_number: u32,
    broken: u32,
    poses: Vec<ObjectPose>,
}

impl<H: PartialEq> Seen<H> {
    fn is_like(&self, other: &Self) -> bool {
        let same = (self.camera, self.scene_number, self.broken) == (other.camera, other.scene_number, other.broken);
        let poses = || self.poses.len() == other.poses.len() && self.poses.iter().zip(&other.poses).all(|(a, b)| rests(a, b));
        same && self.how == other.how && poses()
    }
}

impl<H: PartialEq> Stillness<H> {
    /// Whether the frame after `dt_secs` may differ from the one before.
    pub fn needs_frame(&mut self, mirror: &Mirror, camera: &Camera, how: H, dt_secs: f32) -> bool {
        let Some(land) = mirror.land() else { return true };
        let poses: Vec<ObjectPose> = mirror.objects().collect();
        // A rotor turns whatever its helicopter does.
        let flies = poses.iter().any(|pose| pose.kind == VehicleKind::Helicopter);
        let now = Seen { camera: *camera, how, scene_number: mirror.scene_number(), broken: mirror.broken_count(), poses };
        let is_like = self.seen.as_ref().is_some_and(|seen| seen.is_like(&now));
        if flies || !mirror.is_calm() || mirror.has_dirty_patches() || !is_like {
            (self.seen, self.settled_secs) = (Some(now), 0.0);
            return true;
        }
        let is_moving = self.settled_secs < settle_secs(land.scene());
        self.settled_secs += dt_secs.min(LONGEST_STEP_SECS);
        is_moving
    }

    /// The next frame is needed, whatever it shows.
    pub fn wake(&mut self) {
        self.seen = None;
    }
}

/// Whether an object stands where it stood.
fn rests(a: &ObjectPose, b: &ObjectPose) -> bool {
    let numbers = |pose: &ObjectPose| {
        let ([x, y, z], [qx, qy, qz, qw]) = (pose.position_m, pose.rotation);
        [x, y, z, qx, qy, qz, qw, pose.part_rad]
    };
    (a.id, a.kind) == (b.id, b.kind) && numbers(a).iter().zip(numbers(b)).all(|(a, b)| (a - b).abs() < LEAST_MOTION)
}

/// How long plants swing on when nothing moves them any more (s): the slowest of the blades, of the underbrush, and of what they feel.
fn settle_secs(scene: &Scene) -> f32 {
    let (plants, damping) = (&scene.plants, scene.plants.swing_damping);
    let slowest_hz = scene.kinds_of_plants().iter().map(|plants| plants.swing_hz).fold(f32::INFINITY, f32::min);
    // The taller, the slower.
    let omega = TAU * slowest_hz / plants.most_grown();
    // Rate at which the slower solution of x'' + 2ζω·x' + ω²·x = 0 falls, or less.
    let rate_per_s = omega * if damping < 1.0 { damping } else { 0.5 / damping };
    let underbrush_secs = scene.underbrush.iter().map(|species| species.settle_secs).fold(LINGERING_SECS, f32::max);
    let lag_secs = scene.kinds().iter().map(|grass| grass.lag_secs).fold(0.0, f32::max);
    (TIME_CONSTANTS * underbrush_secs.max(1.0 / rate_per_s) + 2.0 * lag_secs).min(LONGEST_SECS)
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::scene::{TerrainMaps, Wind, WindDust};
    use shared::terrain::grey_png;
    use shared::wire::{ServerMessage, Shape, codec};

    const DT_SECS: f32 = 1.0 / 30.0;

    fn meadow(change: impl FnOnce(&mut Scene)) -> Mirror {
        let maps = TerrainMaps { height_map: String::new(), covering_map: String::new(), pixel_m: [4.0; 2], level_m: 0.1, base_m: 0.0 };
        let mut scene = Scene { wind: Wind { cells: [4, 2, 4], mean_m_per_s: [0.0; 2], ..Wind::default() }, ..Scene::new(maps) };
        change(&mut scene);
        let map = grey_png([4; 2], &[255; 16]);
        let mut mirror = Mirror::default();
        let (height_png, covering_png) = (map.clone(), map);
        let scene = ServerMessage::Scene { scene: Box::new(scene), height_png, covering_png, nutrient_png: Vec::new(), models: Vec::new() };
        mirror.apply(scene).expect("a sound scene");
        mirror
    }

    fn blow(mirror: &mut Mirror, seq: u32, codes: &[i8]) {
        let payload = codec::encode(Shape::wind(4, codes.len() > 96), codes, None);
        mirror.apply(ServerMessage::Wind { tick: 1, seq, key: true, payload }).expect("a sound wind");
    }

    fn bend(mirror: &mut Mirror, seq: u32, code: i8) {
        let cells = mirror.land().expect("a scene").layout().cells as usize;
        let payload = codec::encode(Shape::patch(cells), &vec![code; 3 * cells * cells], None);
        mirror.apply(ServerMessage::Patch { patch: 0, seq, key: true, payload }).expect("a sound patch");
    }

    fn place(mirror: &mut Mirror, tick: u64, kind: VehicleKind, x_m: f32) {
        let (position_m, rotation) = ([x_m, 1.0, 8.0], [0.0, 0.0, 0.0, 1.0]);
        let object = ObjectPose { id: 3, kind, position_m, rotation, velocity_m_per_s: [0.0; 3], part_rad: 0.0 };
        mirror.apply(ServerMessage::Poses { tick, objects: vec![object] }).expect("sound poses");
    }

    /// Frames that are needed of those of so many seconds; each takes the patches that have changed, as a drawn one does.
    fn needed(stillness: &mut Stillness<u32>, mirror: &mut Mirror, secs: f32) -> u32 {
        let camera = Camera::default();
        let mut frame = |mirror: &mut Mirror| {
            mirror.advance(f64::from(DT_SECS));
            let is_needed = stillness.needs_frame(mirror, &camera, 0, DT_SECS);
            if is_needed {
                mirror.take_dirty_patches();
            }
            u32::from(is_needed)
        };
        (0..(secs / DT_SECS) as u32).map(|_| frame(mirror)).sum()
    }

    #[test]
    fn a_calm_meadow_comes_to_rest_and_anything_new_wakes_it() {
        let mut mirror = meadow(|_| {});
        let mut stillness = Stillness::default();
        let settle_secs = settle_secs(mirror.land().expect("a scene").scene());
        let frames = needed(&mut stillness, &mut mirror, 60.0);
        assert!(settle_secs < 30.0 && (frames as f32 * DT_SECS - settle_secs).abs() < 0.2, "{frames} frames to settle in {settle_secs} s");
        assert_eq!(needed(&mut stillness, &mut mirror, 10.0), 0);

        bend(&mut mirror, 1, 5);
        assert_eq!(needed(&mut stillness, &mut mirror, 60.0), frames, "a patch that bends");
        blow(&mut mirror, 1, &[0; 96]);
        assert_eq!(needed(&mut stillness, &mut mirror, 10.0), 0, "wind that is none");
        assert!(stillness.needs_frame(&mirror, &Camera { pitch_rad: 0.1, ..Camera::default() }, 0, DT_SECS), "a camera that turns");
        needed(&mut stillness, &mut mirror, 60.0);
        assert!(stillness.needs_frame(&mirror, &Camera::default(), 1, DT_SECS), "another way of drawing");
        needed(&mut stillness, &mut mirror, 60.0);
        stillness.wake();
        assert!(stillness.needs_frame(&mirror, &Camera::default(), 0, DT_SECS));
    }

    #[test]
    fn what_moves_is_drawn() {
        let one = |at: usize, count: usize| (0..count).map(|i| i8::from(i == at)).collect::<Vec<i8>>();
        for (what, mut mirror, wind) in [
            ("mean wind", meadow(|scene| scene.wind.mean_m_per_s = [0.0, -2.0]), vec![0; 96]),
            ("rain", meadow(|scene| scene.rain.rate_mm_per_h = 5.0), vec![0; 96]),
            ("a breeze in one cell", meadow(|_| {}), one(50, 96)),
            ("dust", meadow(|scene| scene.wind.dust = WindDust { release_per_s: 1.0, ..WindDust::default() }), one(100, 128)),
        ] {
            blow(&mut mirror, 1, &wind);
            assert_eq!(needed(&mut Stillness::default(), &mut mirror, 70.0), 70 * 30, "{what}");
        }
    }

    #[test]
    fn objects_wake_it_only_while_they_move() {
        let mut mirror = meadow(|_| {});
        let mut stillness = Stillness::default();
        let settled = needed(&mut stillness, &mut mirror, 60.0);
        place(&mut mirror, 60, VehicleKind::Car, 8.0);
        assert!(needed(&mut stillness, &mut mirror, 60.0) >= settled);
        place(&mut mirror, 120, VehicleKind::Car, 8.000_01);
        assert_eq!(needed(&mut stillness, &mut mirror, 5.0), 0, "a car that trembles by less than is seen");
        place(&mut mirror, 180, VehicleKind::Car, 8.01);
        assert!(needed(&mut stillness, &mut mirror, 60.0) >= settled, "a car that has moved");
        place(&mut mirror, 240, VehicleKind::Helicopter, 8.01);
        assert_eq!(needed(&mut stillness, &mut mirror, 70.0), 70 * 30, "a rotor that turns");
    }
}
