//! Trails of the objects.

use super::palette::Rgb;
use prairie_core::scene::VehicleKind;
use prairie_core::wire::{ObjectId, ObjectPose};
use prairie_vehicles::trail_rgb;
use std::collections::{BTreeMap, VecDeque};

/// Largest number of points in a trail: 6 s in a file, 9 s live.
const TRAIL_LIMIT: usize = 60;

/// Minimum distance between points of a trail (m).
const TRAIL_STEP_M: f32 = 0.2;

/// The most recent positions of every object.
#[derive(Default)]
pub(super) struct Trails {
    points_m: BTreeMap<ObjectId, (VehicleKind, VecDeque<[f32; 3]>)>,
}

impl Trails {
    /// Appends new poses; the trail of an object that is gone is removed.
    pub(super) fn update(&mut self, objects: &[ObjectPose]) {
        self.points_m.retain(|id, _| objects.iter().any(|object| object.id == *id));
        for object in objects {
            let (_, points_m) = self.points_m.entry(object.id).or_insert((object.kind, VecDeque::new()));
            let moved2_m2 = points_m.back().map_or(f32::INFINITY, |last| (0..3).map(|i| (last[i] - object.position_m[i]).powi(2)).sum());
            if moved2_m2 >= TRAIL_STEP_M * TRAIL_STEP_M {
                points_m.push_back(object.position_m);
            }
            if points_m.len() > TRAIL_LIMIT {
                points_m.pop_front();
            }
        }
    }

    /// The trails, oldest point first (m), with their colours.
    pub(super) fn strips(&self) -> (Vec<Vec<[f32; 3]>>, Vec<Rgb>) {
        self.points_m.values().map(|(kind, points_m)| (points_m.iter().copied().collect(), trail_rgb(*kind))).unzip()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn car(id: ObjectId, x: f32) -> ObjectPose {
        let still = [0.0; 3];
        ObjectPose {
            id,
            kind: VehicleKind::Car,
            position_m: [x, 0.0, 0.0],
            rotation: [0.0, 0.0, 0.0, 1.0],
            velocity_m_per_s: still,
            part_rad: 0.0,
        }
    }

    #[test]
    fn a_trail_follows_its_object_and_disappears_with_it() {
        let mut trails = Trails::default();
        for step in 0..1000 {
            trails.update(&[car(1, step as f32), car(2, 5.0)]);
        }
        let (strips, colours) = trails.strips();
        assert_eq!((strips[0].len(), strips[1].len(), colours.len()), (TRAIL_LIMIT, 1, 2));
        assert_eq!(strips[0].last(), Some(&[999.0, 0.0, 0.0]));
        trails.update(&[car(2, 6.0)]);
        assert_eq!(trails.strips().0, [vec![[5.0, 0.0, 0.0], [6.0, 0.0, 0.0]]]);
    }
}
