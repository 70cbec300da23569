//! What a frame's uniform block says of the camera, the light and the scene.

use super::Quality;
use super::atlas::Atlas;
use super::detail::{Detail, blades_of_grid};
use super::lamps::{lamps, lit};
use super::sun::Daylight;
use super::uniforms::{Frame, Lamp, Lights, SPHERE_LIMIT};
use crate::camera::Camera;
use crate::state::Land;
use bytemuck::Zeroable;
use glam::{Mat4, Vec3, Vec4};
use shared::light::sun::Sun;
use shared::scene::{Objects, Plants};
use shared::wire::ObjectPose;

/// Distance after which all patterns of `gust_at` in `common.wgsl` repeat (m): 60 × 23.
const GUST_PERIOD_M: f64 = 1380.0;
/// Speed of the gusts' fronts over that of the mean wind.
const GUST_SPEED: f64 = 1.3;
/// Speed of the clouds over that of the mean wind near the ground.
const CLOUD_SPEED: f64 = 1.6;
/// Layers of the shadow map.
pub(super) const SHADOW_LAYERS: u32 = SHADOW_HALF_M.len() as u32;
/// Half the side of the squares that the layers of the shadow map cover (m), and half their depth: a sharp one, and a coarse one.
pub(super) const SHADOW_HALF_M: [f32; 2] = [52.0, 270.0];
const SHADOW_DEPTH_M: [f32; 2] = [160.0, 450.0];

/// Least sine of the elevation from which shadows are thrown.
const LOWEST_SHADOW_UP: f32 = 0.02;

/// Rate of rain at which the sky is overcast (mm/h).
const OVERCAST_MM_PER_H: f32 = 10.0;

pub(super) struct View<'a> {
    camera: &'a Camera,
    size_px: [u32; 2],
    quality: Quality,
    detail: Detail,
    time_secs: f64,
    sun: Sun,
    pub(super) projection_from_world: Mat4,
}

impl<'a> View<'a> {
    pub(super) fn new(camera: &'a Camera, size_px: [u32; 2], quality: Quality, detail: Detail, time_secs: f64, sun: Sun) -> Self {
        let aspect = size_px[0] as f32 / size_px[1] as f32;
        let projection_from_world = camera.projection_from_world(aspect);
        Self { camera, size_px, quality, detail, time_secs, sun, projection_from_world }
    }

    pub(super) fn frame(&self, land: &Land, atlas: &Atlas, daylight: &Daylight, poses: &[ObjectPose]) -> Frame {
        let scene = land.scene();
        let [extent_x, extent_z] = scene.extent_m();
        let [pixel_x, pixel_z] = land.heights().pixel_m();
        let [width, depth] = land.heights().size_px().map(|px| px as f32);
        let eye = self.camera.eye_m;
        let sun = Vec3::from(self.sun.direction());
        let rain_share = rain_share(land);
        let sun_rgb = daylight.sunlight()[0] * (1.0 - 0.75 * rain_share);
        let box_m = scene.wind.box_m();
        let patch_m = if land.tiles().by_patch() { land.layout().patch_m() } else { 0.0 };
        let [wraps_x, _, wraps_z] = scene.wind.faces.wraps().map(u32::from);
        let [mean_x, mean_z] = scene.wind.mean_m_per_s;
        let mean = mean_x.hypot(mean_z);
        let [dir_x, dir_z] = if mean > 1e-3 { [mean_x / mean, mean_z / mean] } else { [1.0, 0.0] };
        let travelled = (self.time_secs * f64::from(mean) * GUST_SPEED).rem_euclid(GUST_PERIOD_M) as f32;
        let drift = -(self.time_secs * CLOUD_SPEED) as f32;
        let plants = &scene.plants;
        let Detail { blades_m, far_m, .. } = self.detail;
        let fades_from = if self.quality == Quality::Reference { 0.999 } else { 0.72 };
        let pixel_rad = self.camera.fov_rad / self.size_px[1] as f32;
        let lamps = lamps(scene, land.heights(), poses, self.sun.elevation_rad, daylight.brightness(), eye);
        let spheres = spheres(&scene.objects, poses, eye);
        let rays = Mat4::from_mat3(glam::Mat3::from_mat4(glam::camera::rh::view::look_to_mat4(Vec3::ZERO, self.camera.forward(), Vec3::Y)));
        let aspect = self.size_px[0] as f32 / self.size_px[1] as f32;
        let world_from_projection = (self.camera.projection_from_view(aspect) * rays).inverse();
        Frame {
            projection_from_world: self.projection_from_world.to_cols_array(),
            world_from_projection: world_from_projection.to_cols_array(),
            shadow_from_world: self.shadow_from_world(0).to_cols_array(),
            eye: [eye.x, eye.y, eye.z, (self.time_secs % 10_000.0) as f32],
            sun: [sun.x, sun.y, sun.z, 0.0],
            sun_color: [sun_rgb.x, sun_rgb.y, sun_rgb.z, scene.light.haze_m * (1.0 - 0.6 * rain_share)],
            world: [extent_x, extent_z, pixel_x, pixel_z],
            maps: [width, depth, atlas.window_m(), atlas.reach_m()],
            wind_box: [box_m[0], box_m[1], box_m[2], patch_m],
            tiling: [land.tiles().seed(), wraps_x, wraps_z, lamps.len() as u32],
            gust: [dir_x, dir_z, mean, travelled],
            past: atlas.past(),
            blade: [plants.flowers_per_m2, plants.height_variation, plants.width_m, 0.0],
            screen: [self.size_px[0] as f32, self.size_px[1] as f32, pixel_rad, rain_share],
            reach: [blades_m * fades_from, blades_m, far_m * 0.6, far_m],
            sward: self.sward(plants),
            clouds: [drift * dir_x * mean, drift * dir_z * mean, 0.0, spheres.len() as f32],
            spheres: std::array::from_fn(|i| spheres.get(i).copied().unwrap_or_default()),
            lights: self.lights(land, daylight, &lamps),
        }
    }

    /// What stands near by and how it is drawn, as the ground under it has to know.
    fn sward(&self, plants: &Plants) -> [f32; 4] {
        /// Area of a blade over its height and the width of its root.
        const LEAF_SHARE: f32 = 0.65;
        let per_m2 = blades_of_grid(plants.plants_per_side) / plants.grid_m.powi(2);
        [per_m2 * LEAF_SHARE * plants.height_m * plants.width_m, self.detail.full_m, plants.width_m, 0.0]
    }

    /// Light of sky and lamps.
    fn lights(&self, land: &Land, daylight: &Daylight, lamps: &[Lamp]) -> Lights {
        let scene = land.scene();
        let light = &scene.light;
        let rain_share = rain_share(land);
        let [_, cloud_sun] = daylight.sunlight();
        // Rain clouds let through a fifth of the day, all of it from the sky.
        let [mean, up, toward_sun] = daylight.ambient();
        let (night, stars) = daylight.night();
        let texel_m = |layer: usize| 2.0 * SHADOW_HALF_M[layer] / self.quality.shadow_px() as f32;
        let wide = |rgb: Vec3, last: f32| rgb.extend(last).to_array();
        let (sin, cos) = self.sun.heading_rad.sin_cos();
        Lights {
            far_shadow_from_world: self.shadow_from_world(1).to_cols_array(),
            mean: wide(mean * (1.0 + 0.6 * rain_share), 0.0),
            up: wide(up * (1.0 + 0.6 * rain_share), 0.0),
            toward_sun: wide(toward_sun * (1.0 - rain_share), 0.0),
            night: wide(night, stars),
            cloud_sun: wide(cloud_sun, 0.0),
            heading: [sin, -cos, 0.0, 0.0],
            lit: lit(lamps),
            mist: [if light.mist_m > 0.0 { 1.0 / light.mist_m } else { 0.0 }, light.mist_height_m, land.heights().range_m()[0], 0.0],
            shadow: [texel_m(0), 2.0 * SHADOW_DEPTH_M[0], texel_m(1), 2.0 * SHADOW_DEPTH_M[1]],
            lamps: std::array::from_fn(|i| lamps.get(i).copied().unwrap_or_else(Lamp::zeroed)),
        }
    }

    /// A square about what lies ahead, as the sun sees it, for a layer of the shadow map; moves in whole texels, so that shadows do not crawl.
    fn shadow_from_world(&self, layer: usize) -> Mat4 {
        let (half_m, depth_m) = (SHADOW_HALF_M[layer], SHADOW_DEPTH_M[layer]);
        let mut sun = Vec3::from(self.sun.direction());
        sun.y = sun.y.max(LOWEST_SHADOW_UP);
        let ahead = Vec3::new(self.camera.heading_rad.sin(), 0.0, -self.camera.heading_rad.cos());
        let centre = self.camera.eye_m + ahead * (half_m * 0.6);
        let up = if sun.y > 0.99 { Vec3::X } else { Vec3::Y };
        let light_from_world = glam::camera::rh::view::look_to_mat4(Vec3::ZERO, -sun.normalize(), up);
        let texel = 2.0 * half_m / self.quality.shadow_px() as f32;
        let at = light_from_world.transform_point3(centre);
        let snapped = Vec3::new((at.x / texel).round() * texel, (at.y / texel).round() * texel, at.z);
        let scale = Vec3::new(1.0 / half_m, 1.0 / half_m, -0.5 / depth_m);
        let clip_from_light = Mat4::from_cols(
            Vec4::new(scale.x, 0.0, 0.0, 0.0),
            Vec4::new(0.0, scale.y, 0.0, 0.0),
            Vec4::new(0.0, 0.0, scale.z, 0.0),
            Vec4::new(-snapped.x * scale.x, -snapped.y * scale.y, 0.5 - snapped.z * scale.z, 1.0),
        );
        clip_from_light * light_from_world
    }
}

/// How overcast the sky is, 0..1.
fn rain_share(land: &Land) -> f32 {
    (land.scene().rain.rate_mm_per_h / OVERCAST_MM_PER_H).min(1.0)
}

/// Interaction spheres of the objects (000 section 6.2), nearest first: centre and radius.
fn spheres(objects: &Objects, poses: &[ObjectPose], eye: Vec3) -> Vec<[f32; 4]> {
    let mut spheres: Vec<(f32, [f32; 4])> = poses
        .iter()
        .filter_map(|pose| {
            let [x, y, z] = pose.position_m;
            let [above_m, radius_m] = objects.interaction_sphere_m(pose.kind)?;
            Some((Vec3::from(pose.position_m).distance(eye), [x, y + above_m, z, radius_m]))
        })
        .collect();
    spheres.sort_by(|a, b| a.0.total_cmp(&b.0));
    spheres.truncate(SPHERE_LIMIT);
    spheres.into_iter().map(|(_, sphere)| sphere).collect()
}
