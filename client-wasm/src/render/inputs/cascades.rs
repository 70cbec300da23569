//! Shadow cascades: squares ahead of the camera as the sun sees them, a sharp one and a coarse one.

use crate::camera::Camera;
use glam::{Mat4, Vec3, Vec4};
use prairie_core::light::sun::Sun;

/// Number of cascades, the layers of the shadow map.
pub(crate) const SHADOW_CASCADES: u32 = CASCADE_HALF_M.len() as u32;
/// Half the side of the square that each cascade covers (m), and half its depth.
pub(crate) const CASCADE_HALF_M: [f32; 2] = [52.0, 270.0];
const CASCADE_HALF_DEPTH_M: [f32; 2] = [160.0, 450.0];
/// Minimum sine of the sun's elevation for which shadows are drawn.
const LOWEST_SHADOW_UP: f32 = 0.02;

/// Side of a texel of a cascade (m), where the shadow map is `shadow_px` wide.
pub(crate) fn texel_m(cascade: usize, shadow_px: u32) -> f32 {
    2.0 * CASCADE_HALF_M[cascade] / shadow_px as f32
}

/// Depth of a cascade along the sun's rays (m).
pub(crate) fn depth_m(cascade: usize) -> f32 {
    2.0 * CASCADE_HALF_DEPTH_M[cascade]
}

/// Projection of a cascade. It moves in whole texels, so that shadows do not shimmer.
pub(crate) fn shadow_from_world(camera: &Camera, sun: Sun, shadow_px: u32, cascade: usize) -> Mat4 {
    let (half_m, half_depth_m) = (CASCADE_HALF_M[cascade], CASCADE_HALF_DEPTH_M[cascade]);
    let mut sun = Vec3::from(sun.direction());
    sun.y = sun.y.max(LOWEST_SHADOW_UP);
    let ahead = Vec3::new(camera.heading_rad.sin(), 0.0, -camera.heading_rad.cos());
    let centre = camera.eye_m + ahead * (half_m * 0.6);
    let up = if sun.y > 0.99 { Vec3::X } else { Vec3::Y };
    let light_from_world = glam::camera::rh::view::look_to_mat4(Vec3::ZERO, -sun.normalize(), up);
    let texel = texel_m(cascade, shadow_px);
    let at = light_from_world.transform_point3(centre);
    let snapped = Vec3::new((at.x / texel).round() * texel, (at.y / texel).round() * texel, at.z);
    let scale = Vec3::new(1.0 / half_m, 1.0 / half_m, -0.5 / half_depth_m);
    let clip_from_light = Mat4::from_cols(
        Vec4::new(scale.x, 0.0, 0.0, 0.0),
        Vec4::new(0.0, scale.y, 0.0, 0.0),
        Vec4::new(0.0, 0.0, scale.z, 0.0),
        Vec4::new(-snapped.x * scale.x, -snapped.y * scale.y, 0.5 - snapped.z * scale.z, 1.0),
    );
    clip_from_light * light_from_world
}
