//! Objects as the grass meets them: the prisms that touch it, their footprints and their moving corners.

use glam::Vec3;
use prairie_core::body::{Body, Motion, Prism};
use prairie_core::scene::Scene;
use prairie_core::terrain::HeightMap;

/// Height of drawn footprints above the terrain (m), so that it does not hide them.
const ABOVE_M: f32 = 0.05;

/// Closed or open lines (m).
pub(super) type Strips = Vec<Vec<[f32; 3]>>;

/// Shapes of all kinds of objects in contact with the grass.
pub(super) struct Outlines {
    /// By kind, in the order of [`VehicleKind::ALL`](prairie_core::scene::VehicleKind::ALL): whether its rotation has no effect on the grass, and its prisms.
    kinds: Vec<(bool, Vec<Prism>)>,
    /// Clearance below which a prism is in the grass (m).
    grass_m: f32,
    dt_secs: f32,
}

/// Footprints and moving corners of one step.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Contacts {
    /// Floors on the terrain, closed (m).
    pub(super) footprints_m: Strips,
    /// Corners of the floors after the step (m).
    pub(super) corners_m: Vec<[f32; 3]>,
    /// Velocities of these corners in the step (m/s).
    pub(super) velocities_m_per_s: Vec<[f32; 3]>,
}

impl Outlines {
    /// The shapes of a scene's objects.
    pub(super) fn new(scene: &Scene) -> Self {
        let shape = |body: Body| (body.is_round, body.prisms);
        let kinds = prairie_vehicles::bodies(&scene.objects).into_iter().map(shape).collect();
        Self { kinds, grass_m: scene.plants.height_m, dt_secs: scene.dt_secs() }
    }

    /// Edges of all prisms after a step (m): floor, roof and uprights.
    pub(super) fn edges(&self, motions: &[Motion]) -> Strips {
        motions.iter().flat_map(|motion| self.prisms(motion)).flat_map(|(motion, prism)| edges(prism, &motion)).collect()
    }

    /// Footprints of the prisms that are less above the terrain than the scene's grass is high. Feet of walkers count while they are near the ground.
    pub(super) fn contacts(&self, motions: &[Motion], heights: &HeightMap) -> Contacts {
        let mut contacts = Contacts::default();
        for (motion, prism) in motions.iter().flat_map(|motion| self.prisms(motion)) {
            let foot_m = prism.foot_m(&motion.to);
            if prism.lowest_m(&motion.to) - heights.height_m(foot_m[0], foot_m[1]) >= self.grass_m {
                continue;
            }
            let floor = |pose| -> Vec<_> { prism.corners(pose, [prism.span_m[0]; 2]).step_by(2).collect() };
            let (before_m, after_m) = (floor(&motion.from), floor(&motion.to));
            let on_ground = |corner: &[f32; 3]| [corner[0], heights.height_m(corner[0], corner[2]) + ABOVE_M, corner[2]];
            contacts.footprints_m.push(closed(after_m.iter().map(on_ground).collect()));
            for (before, after) in before_m.iter().zip(&after_m) {
                let moved = Vec3::from_array(*after) - Vec3::from_array(*before);
                contacts.velocities_m_per_s.push((moved / self.dt_secs).to_array());
            }
            contacts.corners_m.extend(after_m);
        }
        contacts
    }

    /// Prisms of an object with its motion as the grass takes it.
    fn prisms(&self, motion: &Motion) -> impl Iterator<Item = (Motion, &Prism)> {
        let (is_round, prisms) = &self.kinds[motion.kind as usize];
        let motion = if *is_round { motion.without_rotation() } else { *motion };
        prisms.iter().map(move |prism| (motion, prism))
    }
}

/// Floor, roof and uprights of a prism after a step (m).
fn edges(prism: &Prism, motion: &Motion) -> Strips {
    let corners: Vec<_> = prism.corners(&motion.to, prism.span_m).collect();
    let level = |first: usize| closed(corners[first..].iter().step_by(2).copied().collect());
    let mut strips = vec![level(0), level(1)];
    strips.extend(corners.chunks_exact(2).map(<[[f32; 3]]>::to_vec));
    strips
}

/// A polygon that ends at its first corner.
fn closed(mut corners_m: Vec<[f32; 3]>) -> Vec<[f32; 3]> {
    corners_m.extend(corners_m.first().copied());
    corners_m
}

#[cfg(test)]
mod tests {
    use super::*;
    use prairie_core::body::BodyPose;
    use prairie_core::scene::{Objects, VehicleKind};

    fn outlines(objects: Objects) -> Outlines {
        let mut scene = crate::scenes::load("meadow").unwrap().scene;
        scene.objects = objects;
        Outlines::new(&scene)
    }

    fn motion(kind: VehicleKind, from_m: [f32; 3], to_m: [f32; 3]) -> Motion {
        let pose = |position_m| BodyPose { position_m, ..BodyPose::IDENTITY };
        let (from, to, velocity_m_per_s) = (pose(from_m), pose(to_m), [0.0; 3]);
        Motion { kind, from, to, velocity_m_per_s, part_rad: 0.0, is_at_rest: false }
    }

    fn flat() -> HeightMap {
        HeightMap::from_heights(2, 2, [256.0, 256.0], vec![3.0; 4])
    }

    #[test]
    fn a_sled_has_the_outline_of_the_scene() {
        let sled_outline_m = vec![[-2.0, -1.0], [1.0, -1.0], [0.0, 4.0]];
        let found = outlines(Objects { sled_outline_m, ..Objects::default() });
        let sled = motion(VehicleKind::Sled, [50.0, 3.25, 60.0], [50.0, 3.25, 60.0]);
        let edges = found.edges(&[sled]);
        assert_eq!((edges.len(), edges[0].len(), edges[2].len()), (5, 4, 2), "floor, roof and three uprights");
        for corner in [[48.0, 3.0, 59.0], [51.0, 3.0, 59.0], [50.0, 3.0, 64.0]] {
            assert!(edges[0].contains(&corner), "{corner:?} in {:?}", edges[0]);
        }
        assert!(edges[1].iter().all(|corner| corner[1] == 3.5));
    }

    #[test]
    fn corners_move_with_the_body() {
        let outlines = outlines(Objects::default());
        let car = motion(VehicleKind::Car, [50.0, 3.7, 60.0], [50.5, 3.7, 60.0]);
        let contacts = outlines.contacts(&[car], &flat());
        assert!(!contacts.corners_m.is_empty() && contacts.corners_m.len() == contacts.velocities_m_per_s.len());
        assert!(contacts.velocities_m_per_s.iter().all(|v| (v[0] - 30.0).abs() < 1e-3 && v[1] == 0.0 && v[2] == 0.0), "{contacts:?}");
        let on_ground = |strip: &Vec<[f32; 3]>| strip.iter().all(|at| (at[1] - 3.05).abs() < 1e-5) && strip.first() == strip.last();
        assert!(contacts.footprints_m.iter().all(on_ground));
    }

    #[test]
    fn corners_of_a_turning_body_move_at_right_angles_to_their_radius() {
        let outlines = outlines(Objects::default());
        let mut sled = motion(VehicleKind::Sled, [50.0, 3.25, 60.0], [50.0, 3.25, 60.0]);
        let half_rad = 0.5_f32 / 60.0 * 0.5;
        sled.to.rotation = [0.0, half_rad.sin(), 0.0, half_rad.cos()];
        let contacts = outlines.contacts(&[sled], &flat());
        for (corner, velocity) in contacts.corners_m.iter().zip(&contacts.velocities_m_per_s) {
            let radius_m = (corner[0] - 50.0).hypot(corner[2] - 60.0);
            let speed_m_per_s = velocity[0].hypot(velocity[2]);
            assert!((speed_m_per_s - 0.5 * radius_m).abs() < 0.01, "{speed_m_per_s} m/s at {radius_m} m");
        }
    }

    #[test]
    fn objects_above_the_grass_touch_nothing() {
        let outlines = outlines(Objects::default());
        let high = motion(VehicleKind::Car, [50.0, 20.0, 60.0], [50.5, 20.0, 60.0]);
        assert_eq!(outlines.contacts(&[high], &flat()), Contacts::default());
        assert!(!outlines.edges(&[high]).is_empty());
    }
}
