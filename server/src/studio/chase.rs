//! A camera that follows a vehicle.

use glam::{Quat, Vec3};
use prairie_client::camera::Camera;
use prairie_core::wire::ObjectPose;

/// A camera that looks at a vehicle from a distance behind, above and to the right of it (m), at least 0.3 m above the terrain.
pub fn chase(pose: &ObjectPose, [away_m, above_m, aside_m]: [f32; 3], ground_m: impl Fn(f32, f32) -> f32) -> Camera {
    let rotation = Quat::from_array(pose.rotation);
    let level = |axis: Vec3| (rotation * axis).with_y(0.0).normalize_or(axis);
    let target = Vec3::from(pose.position_m);
    let mut eye_m = target + level(Vec3::Z) * away_m + level(Vec3::X) * aside_m;
    eye_m.y = (target.y + above_m).max(ground_m(eye_m.x, eye_m.z) + 0.3);
    let towards = target - eye_m;
    Camera { eye_m, heading_rad: towards.x.atan2(-towards.z), pitch_rad: (towards.y / towards.length()).asin(), ..Camera::default() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use prairie_core::scene::VehicleKind;

    #[test]
    fn a_chase_looks_at_what_it_chases_and_stays_above_the_land() {
        let pose = ObjectPose {
            id: 1,
            kind: VehicleKind::Car,
            position_m: [10.0, 2.0, 20.0],
            rotation: Quat::from_rotation_y(0.7).to_array(),
            velocity_m_per_s: [0.0; 3],
            part_rad: 0.0,
        };
        for (above_m, ground_m) in [(3.0, 0.0), (1.0, 6.0)] {
            let camera = chase(&pose, [8.0, above_m, 2.0], |_, _| ground_m);
            assert!(camera.eye_m.y >= ground_m + 0.29);
            let clip = camera.projection_from_world(1.6).project_point3(Vec3::from(pose.position_m));
            assert!(clip.x.abs() < 1e-3 && clip.y.abs() < 1e-3, "{clip}");
        }
    }
}
