//! Culling volumes: the view frustum (Zhang, section 5.3) and those of the shadow cascades. Compute passes cull single plants.

use glam::{Mat4, Vec3, Vec4, Vec4Swizzles};

/// Four sides of the view and the plane through the eye. There is no far plane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frustum {
    planes: [Vec4; 5],
}

impl Frustum {
    /// Contains everything.
    pub(crate) const ALL: Self = Self { planes: [Vec4::ZERO; 5] };

    /// Frustum of a projection with normal or reversed depth, which is not used.
    pub(crate) fn new(projection_from_world: &Mat4) -> Self {
        let rows = projection_from_world.transpose();
        let [x, y, w] = [rows.x_axis, rows.y_axis, rows.w_axis];
        Self { planes: [w + x, w - x, w + y, w - y, w] }
    }

    /// Whether a box may be visible. Conservative: never false for a visible box.
    pub(crate) fn sees_box(&self, low_m: Vec3, high_m: Vec3) -> bool {
        self.planes.iter().all(|plane| {
            let farthest = Vec3::select(plane.xyz().cmpge(Vec3::ZERO), high_m, low_m);
            plane.xyz().dot(farthest) + plane.w >= 0.0
        })
    }
}

/// Volume of a shadow cascade: a box of parallel rays.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CascadeVolume {
    clip_from_world: Mat4,
    /// Length of a metre in clip space along each of its axes.
    per_m: Vec3,
}

impl CascadeVolume {
    /// Volume of a parallel projection in column-major order.
    pub(crate) fn new(clip_from_world: &[f32; 16]) -> Self {
        let clip_from_world = Mat4::from_cols_array(clip_from_world);
        let rows = clip_from_world.transpose();
        let per_m = [rows.x_axis, rows.y_axis, rows.z_axis].map(|row| row.xyz().length());
        Self { clip_from_world, per_m: per_m.into() }
    }

    /// Whether a sphere may reach into the volume. Conservative: never false for one that does.
    pub(crate) fn meets_sphere(&self, centre_m: Vec3, radius_m: f32) -> bool {
        let from_centre = self.clip_from_world.transform_point3(centre_m) - Vec3::new(0.0, 0.0, 0.5);
        (from_centre.abs() - radius_m * self.per_m).cmple(Vec3::new(1.0, 1.0, 0.5)).all()
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
    fn boxes_behind_and_beside_the_camera_are_culled() {
        let (frustum, _) = frustum(&Camera { eye_m: Vec3::ZERO, ..Camera::default() });
        let sees = |x: f32, z: f32| frustum.sees_box(Vec3::new(x - 1.0, -1.0, z - 1.0), Vec3::new(x + 1.0, 1.0, z + 1.0));
        assert!(sees(0.0, -20.0) && sees(10.0, -20.0));
        assert!(!sees(0.0, 20.0) && !sees(40.0, -20.0) && !sees(-40.0, -20.0));
    }

    #[test]
    fn about_a_fifth_of_the_grids_remains() {
        let camera = Camera { fov_rad: 0.72, ..Camera::default() };
        let (frustum, _) = frustum(&camera);
        let seen = (-8..8)
            .flat_map(|x| (-8..8).map(move |z| Vec3::new(x as f32 * 8.0, 0.0, z as f32 * 8.0)))
            .filter(|&low| frustum.sees_box(low, low + Vec3::new(8.0, 1.0, 8.0)))
            .count();
        assert!((40..90).contains(&seen), "{seen} of 256");
    }

    /// Projection of a cascade 104 m wide and 320 m deep.
    fn cascade(elevation_rad: f32) -> Mat4 {
        let toward = Vec3::new(0.6 * elevation_rad.cos(), elevation_rad.sin(), -0.8 * elevation_rad.cos());
        let light_from_world = glam::camera::rh::view::look_to_mat4(Vec3::ZERO, -toward, Vec3::Y);
        Mat4::from_translation(Vec3::new(0.0, 0.0, 0.5))
            * Mat4::from_scale(Vec3::new(1.0 / 52.0, 1.0 / 52.0, -1.0 / 320.0))
            * light_from_world
    }

    #[test]
    fn distant_models_towards_a_low_sun_are_in_the_cascade() {
        let volume = CascadeVolume::new(&cascade(0.15).to_cols_array());
        let meets = |along_m: f32, aside_m: f32| {
            let at_m = along_m * Vec3::new(0.6, 0.0, -0.8) + aside_m * Vec3::new(0.8, 0.0, 0.6);
            volume.meets_sphere(at_m + 8.0 * Vec3::Y, 8.0)
        };
        assert!(meets(0.0, 0.0) && meets(140.0, 0.0) && meets(-140.0, 50.0) && meets(140.0, -59.0));
        assert!(!meets(0.0, 62.0) && !meets(180.0, 0.0) && !meets(100.0, -62.0));
    }

    proptest! {
        #[test]
        fn no_sphere_that_reaches_into_a_cascade_is_culled(
            elevation in 0.02_f32..1.5, middle in proptest::array::uniform3(-300.0_f32..300.0), radius in 0.1_f32..40.0,
            towards in proptest::array::uniform3(-1.0_f32..1.0),
        ) {
            let (matrix, middle) = (cascade(elevation), Vec3::from(middle));
            let at = matrix.transform_point3(middle + Vec3::from(towards).clamp_length_max(1.0) * radius);
            if at.x.abs() < 1.0 && at.y.abs() < 1.0 && (0.0..1.0).contains(&at.z) {
                prop_assert!(CascadeVolume::new(&matrix.to_cols_array()).meets_sphere(middle, radius));
            }
        }

        #[test]
        fn no_box_with_a_visible_point_is_culled(
            heading in 0.0_f32..6.2, pitch in -1.4_f32..1.4,
            low in proptest::array::uniform3(-50.0_f32..50.0), size in proptest::array::uniform3(0.0_f32..20.0),
            fraction in proptest::array::uniform3(0.0_f32..1.0),
        ) {
            let camera = Camera { heading_rad: heading, pitch_rad: pitch, ..Camera::default() };
            let (frustum, matrix) = frustum(&camera);
            let (low, size) = (Vec3::from(low), Vec3::from(size));
            let clip = matrix * (low + size * Vec3::from(fraction)).extend(1.0);
            if clip.w > 0.0 && clip.x.abs() < clip.w && clip.y.abs() < clip.w {
                prop_assert!(frustum.sees_box(low, low + size));
            }
        }
    }
}
