//! View-frustum culling of boxes (000 section 5.3): grids here, single plants in the compute passes.

use glam::{Mat4, Vec3, Vec4, Vec4Swizzles};

/// The four sides of the view and the plane through the eye; there is no far plane.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frustum {
    planes: [Vec4; 5],
}

impl Frustum {
    /// Sees everything.
    pub(super) const ALL: Self = Self { planes: [Vec4::ZERO; 5] };

    /// Frustum of a projection with reversed or ordinary depth; depth itself is not used.
    pub(super) fn new(projection_from_world: &Mat4) -> Self {
        let rows = projection_from_world.transpose();
        let [x, y, w] = [rows.x_axis, rows.y_axis, rows.w_axis];
        Self { planes: [w + x, w - x, w + y, w - y, w] }
    }

    /// Whether any part of a box may be seen; never false for one that is.
    pub(super) fn sees_box(&self, low_m: Vec3, high_m: Vec3) -> bool {
        self.planes.iter().all(|plane| {
            let farthest = Vec3::select(plane.xyz().cmpge(Vec3::ZERO), high_m, low_m);
            plane.xyz().dot(farthest) + plane.w >= 0.0
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Camera;
    use proptest::prelude::*;

    fn frustum(camera: &Camera) -> (Frustum, Mat4) {
        let matrix = camera.projection_from_world(1.5);
        (Frustum::new(&matrix), matrix)
    }

    #[test]
    fn boxes_behind_and_beside_are_not_seen() {
        let (frustum, _) = frustum(&Camera { eye_m: Vec3::ZERO, ..Camera::default() });
        let sees = |x: f32, z: f32| frustum.sees_box(Vec3::new(x - 1.0, -1.0, z - 1.0), Vec3::new(x + 1.0, 1.0, z + 1.0));
        assert!(sees(0.0, -20.0) && sees(10.0, -20.0));
        assert!(!sees(0.0, 20.0) && !sees(40.0, -20.0) && !sees(-40.0, -20.0));
    }

    #[test]
    fn about_a_fifth_of_the_grids_is_left() {
        let camera = Camera { fov_rad: 0.72, ..Camera::default() };
        let (frustum, _) = frustum(&camera);
        let seen = (-8..8)
            .flat_map(|x| (-8..8).map(move |z| Vec3::new(x as f32 * 8.0, 0.0, z as f32 * 8.0)))
            .filter(|&low| frustum.sees_box(low, low + Vec3::new(8.0, 1.0, 8.0)))
            .count();
        assert!((40..90).contains(&seen), "{seen} of 256");
    }

    proptest! {
        #[test]
        fn no_box_with_a_visible_point_is_culled(
            heading in 0.0_f32..6.2, pitch in -1.4_f32..1.4,
            low in proptest::array::uniform3(-50.0_f32..50.0), size in proptest::array::uniform3(0.0_f32..20.0),
            share in proptest::array::uniform3(0.0_f32..1.0),
        ) {
            let camera = Camera { heading_rad: heading, pitch_rad: pitch, ..Camera::default() };
            let (frustum, matrix) = frustum(&camera);
            let (low, size) = (Vec3::from(low), Vec3::from(size));
            let clip = matrix * (low + size * Vec3::from(share)).extend(1.0);
            if clip.w > 0.0 && clip.x.abs() < clip.w && clip.y.abs() < clip.w {
                prop_assert!(frustum.sees_box(low, low + size));
            }
        }
    }
}
