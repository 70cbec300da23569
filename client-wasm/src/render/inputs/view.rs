//! Fills the uniforms of a frame from camera, light and scene.

use crate::camera::Camera;
use crate::render::gpu::constants::{SHADE_CELL_M, SHADE_PX};
use crate::render::gpu::uniforms::{CORNER_LIMIT, Corner, Frame, GustWave, Lamp, Lights, SLAB_LIMIT, SPHERE_LIMIT, Slab, Slabs, Sphere};
use crate::render::inputs::cascades;
use crate::render::inputs::daylight::Daylight;
use crate::render::inputs::frame_bindings::SceneTextures;
use crate::render::inputs::lamps::{SpotLight, lamps, lit_sphere};
use crate::render::options::detail::{Detail, blades_per_grid};
use crate::render::options::quality::Quality;
use crate::state::DecodedScene;
use bytemuck::Zeroable;
use glam::{Mat4, Quat, Vec3};
use prairie_core::bend::wind_lean_rad;
use prairie_core::light::shade;
use prairie_core::light::sun::Sun;
use prairie_core::plant::snow_load::{load_share, relative_load};
use prairie_core::plant::tree::statics::TREE_LEAF_AREA_INDEX;
use prairie_core::scene::{Objects, Plants, Scene, VehicleKind, Wind};
use prairie_core::wind;
use prairie_core::wire::ObjectPose;

/// Speed of the clouds relative to the mean wind near the ground.
const CLOUD_SPEED: f64 = 1.6;
/// Radius around the line from the eye to the camera's target within which trees fade (m).
const FADE_M: f32 = 2.2;
/// Rain rate at which the sky is overcast (mm/h).
const OVERCAST_MM_PER_H: f32 = 10.0;

pub(crate) struct View<'a> {
    camera: &'a Camera,
    size_px: [u32; 2],
    quality: Quality,
    detail: Detail,
    time_secs: f64,
    sun: Sun,
    pub(crate) projection_from_world: Mat4,
}

/// Mean wind of a scene, which carries clouds and rain.
struct MeanWind {
    direction: [f32; 2],
    speed_m_per_s: f32,
}

impl MeanWind {
    fn of([x, z]: [f32; 2]) -> Self {
        let speed_m_per_s = x.hypot(z);
        let direction = if speed_m_per_s > 1e-3 { [x / speed_m_per_s, z / speed_m_per_s] } else { [1.0, 0.0] };
        Self { direction, speed_m_per_s }
    }

    fn cloud_offset_m(&self, time_secs: f64) -> [f32; 2] {
        let drift = -(time_secs * CLOUD_SPEED) as f32;
        self.direction.map(|direction| drift * direction * self.speed_m_per_s)
    }
}

impl<'a> View<'a> {
    pub(crate) fn new(camera: &'a Camera, size_px: [u32; 2], quality: Quality, detail: Detail, time_secs: f64, sun: Sun) -> Self {
        let aspect = size_px[0] as f32 / size_px[1] as f32;
        let projection_from_world = camera.projection_from_world(aspect);
        Self { camera, size_px, quality, detail, time_secs, sun, projection_from_world }
    }

    pub(crate) fn frame(
        &self,
        decoded: &DecodedScene,
        textures: &SceneTextures,
        daylight: &Daylight,
        poses: &[ObjectPose],
        headlights: &[SpotLight],
    ) -> Frame {
        let (scene, eye, overcast) = (decoded.scene(), self.camera.eye_m, overcast(decoded));
        let (mean_wind, [past_ages_secs @ .., youngest_past]) = (MeanWind::of(scene.wind.mean_m_per_s), textures.atlas.past());
        let lamps = lamps(scene, decoded.heights(), headlights, self.sun.elevation_rad, daylight.brightness(), eye);
        let (gusts, spheres) = (textures.wind.gusts(), spheres(&scene.objects, poses, eye));
        Frame {
            projection_from_world: self.projection_from_world.to_cols_array(),
            shadow_from_world: self.shadow_from_world(0).to_cols_array(),
            eye_m: eye.to_array(),
            time_secs: (self.time_secs % 10_000.0) as f32,
            toward_sun: self.sun.direction(),
            overcast,
            sun_rgb: (daylight.sunlight()[0] * (1.0 - 0.92 * overcast)).to_array(),
            haze_distance_m: scene.light.haze_m * (1.0 - 0.6 * overcast),
            world_extent_m: scene.extent_m(),
            height_spacing_m: decoded.heights().pixel_m(),
            heights_px: decoded.heights().size_px().map(|px| px as f32),
            bend_window_m: textures.atlas.window_m(),
            bend_reach_m: textures.atlas.reach_m(),
            wind_box_m: scene.wind.box_m(),
            wind_patch_m: if decoded.tiles().by_patch() { decoded.layout().patch_m() } else { 0.0 },
            wind_repeats: wind_repeats(&scene.wind),
            patch_seed: decoded.tiles().seed(),
            lamp_count: lamps.len() as u32,
            wind_direction: mean_wind.direction,
            mean_wind_m_per_s: mean_wind.speed_m_per_s,
            gust_count: gusts.waves().len() as u32,
            past_ages_secs,
            youngest_past,
            screen_px: self.size_px.map(|px| px as f32),
            pixel_rad: self.camera.fov_rad / self.size_px[1] as f32,
            flowers_per_m2: scene.plants.flowers_per_m2,
            height_variation: scene.plants.height_variation,
            blade_width_m: scene.plants.width_m,
            leaf_area: leaf_area(&scene.plants),
            full_density_m: self.detail.full_m,
            blades_fade_from_m: self.detail.blades_m * if self.quality == Quality::Reference { 0.999 } else { 0.72 },
            blades_end_m: self.detail.blades_m,
            far_fade_from_m: self.detail.far_m * 0.6,
            far_end_m: self.detail.far_m,
            cloud_offset_m: mean_wind.cloud_offset_m(self.time_secs),
            sphere_count: spheres.len() as u32,
            repeated_per_m: textures.repeated.per_m(),
            target_m: self.camera.target_m.unwrap_or_default().to_array(),
            fade_m: if self.camera.target_m.is_some() { FADE_M } else { 0.0 },
            slabs: slabs(&scene.objects, poses, eye),
            spheres: std::array::from_fn(|i| spheres.get(i).copied().unwrap_or_else(Sphere::zeroed)),
            gusts: std::array::from_fn(|i| gusts.waves().get(i).map_or_else(GustWave::zeroed, GustWave::from)),
            lights: self.lights(decoded, daylight, &lamps),
            ..self.shade_and_snow(scene)
        }
    }

    /// Uniforms of the shade of grass, which casts none yet, and of snow.
    fn shade_and_snow(&self, scene: &Scene) -> Frame {
        let (eye, snow_load) = (self.camera.eye_m, relative_load(&scene.snow, leaf_area(&scene.plants)));
        Frame {
            shade_corner_m: shade_corner_m([eye.x, eye.z], SHADE_CELL_M[0]),
            shade_far_corner_m: shade_corner_m([eye.x, eye.z], SHADE_CELL_M[1]),
            shade_strength: 0.0,
            shade_top_m: scene.plants.most_grown() * scene.tallest_m(),
            shade_extinction: even_depth(scene, 1.0 + snow_load, self.sun),
            snow_m: scene.snow.depth_m,
            snow_load,
            crown_snow: load_share(&scene.snow, TREE_LEAF_AREA_INDEX),
            ..Frame::zeroed()
        }
    }

    fn shadow_from_world(&self, cascade: usize) -> Mat4 {
        cascades::shadow_from_world(self.camera, self.sun, self.quality.shadow_px(), cascade)
    }

    /// Uniforms of sky and lamps.
    fn lights(&self, decoded: &DecodedScene, daylight: &Daylight, lamps: &[Lamp]) -> Lights {
        let scene = decoded.scene();
        let light = &scene.light;
        let overcast = overcast(decoded);
        let [_, cloud_sun] = daylight.sunlight();
        // Rain clouds transmit a fifth of the daylight, nearly all of it diffuse.
        let [mean, up, toward_sun] = daylight.ambient();
        let (night, star_brightness) = daylight.night();
        let texel_m = |cascade| cascades::texel_m(cascade, self.quality.shadow_px());
        let (lit_centre_m, lit_radius_m) = lit_sphere(lamps);
        let (sin, cos) = self.sun.heading_rad.sin_cos();
        Lights {
            far_shadow_from_world: self.shadow_from_world(1).to_cols_array(),
            mean_rgb: (mean * (1.0 + 0.6 * overcast)).to_array(),
            star_brightness,
            up_rgb: (up * (1.0 + 0.6 * overcast)).to_array(),
            mist_per_m: if light.mist_m > 0.0 { 1.0 / light.mist_m } else { 0.0 },
            toward_sun_rgb: (toward_sun * (1.0 - overcast)).to_array(),
            mist_height_m: light.mist_height_m,
            night_rgb: night.to_array(),
            mist_ground_m: decoded.heights().range_m()[0],
            cloud_sun_rgb: cloud_sun.to_array(),
            _pad: [0; 4],
            sun_heading: [sin, -cos],
            near_texel_m: texel_m(0),
            near_depth_m: cascades::depth_m(0),
            far_texel_m: texel_m(1),
            far_depth_m: cascades::depth_m(1),
            _pad_2: [0; 8],
            lit_centre_m: lit_centre_m.to_array(),
            lit_radius_m,
            lamps: std::array::from_fn(|i| lamps.get(i).copied().unwrap_or_else(Lamp::zeroed)),
        }
    }
}

impl From<&wind::turbulence::GustWave> for GustWave {
    fn from(&wind::turbulence::GustWave { per_m, phase, strength }: &wind::turbulence::GustWave) -> Self {
        Self { per_m, phase, strength }
    }
}

/// Corner of a map of the shade around the eye (m): a multiple of its cells, so that it does not flicker as the eye moves.
fn shade_corner_m(eye_m: [f32; 2], cell_m: f32) -> [f32; 2] {
    eye_m.map(|m| ((m / cell_m).floor() - 0.5 * SHADE_PX as f32) * cell_m)
}

/// Optical depth towards the sun of grass of the first kind in the mean wind, of a mass relative to its own.
fn even_depth(scene: &Scene, laden_mass: f32, sun: Sun) -> f32 {
    let lean_rad = wind_lean_rad(scene.wind.mean_m_per_s, scene.grass.wind_bend_rad);
    let [_, depth] = shade::stance(lean_rad, laden_mass, sun.direction());
    leaf_area(&scene.plants) * depth
}

/// 1 if the wind domain repeats along X, and along Z.
fn wind_repeats(wind: &Wind) -> [u32; 2] {
    let [x, _, z] = wind.faces.wraps().map(u32::from);
    [x, z]
}

/// Leaf area index of blades of mean height at full density.
fn leaf_area(plants: &Plants) -> f32 {
    /// Area of a blade relative to its height times the width of its root.
    const LEAF_FRACTION: f32 = 0.65;
    let per_m2 = blades_per_grid(plants) / plants.grid_m.powi(2);
    per_m2 * LEAF_FRACTION * plants.height_m * plants.width_m
}

/// Overcast fraction of the sky, 0..1.
fn overcast(decoded: &DecodedScene) -> f32 {
    (decoded.scene().rain.rate_mm_per_h / OVERCAST_MM_PER_H).min(1.0)
}

/// Interaction spheres of the objects (Zhang, section 6.2), nearest first.
fn spheres(objects: &Objects, poses: &[ObjectPose], eye: Vec3) -> Vec<Sphere> {
    let mut spheres: Vec<(f32, Sphere)> = poses
        .iter()
        .filter_map(|pose| {
            let [x, y, z] = pose.position_m;
            let [above_m, radius_m] = objects.interaction_sphere_m(pose.kind)?;
            Some((Vec3::from(pose.position_m).distance(eye), Sphere { centre_m: [x, y + above_m, z], radius_m }))
        })
        .collect();
    spheres.sort_by(|a, b| a.0.total_cmp(&b.0));
    spheres.truncate(SPHERE_LIMIT);
    spheres.into_iter().map(|(_, sphere)| sphere).collect()
}

/// Slabs of the objects with a flat underside, nearest first, and their outline.
fn slabs(objects: &Objects, poses: &[ObjectPose], eye: Vec3) -> Slabs {
    let slab = |pose: &ObjectPose| {
        let (outline_m, half_height_m) = objects.underside_m(pose.kind)?;
        let corner_m2 = outline_m.iter().map(|[x, z]| x * x + z * z).fold(0.0, f32::max);
        let rotation = Quat::from_array(pose.rotation).normalize();
        Some(Slab {
            centre_m: pose.position_m,
            half_height_m,
            right: (rotation * Vec3::X).to_array(),
            reach_m: (corner_m2 + half_height_m * half_height_m).sqrt(),
            back: (rotation * Vec3::Z).to_array(),
            _pad: [0; 4],
        })
    };
    let mut slabs: Vec<Slab> = poses.iter().filter_map(slab).collect();
    slabs.sort_by(|a, b| Vec3::from(a.centre_m).distance(eye).total_cmp(&Vec3::from(b.centre_m).distance(eye)));
    slabs.truncate(SLAB_LIMIT);
    let outline_m = objects.underside_m(VehicleKind::Sled).map_or(&[][..], |(outline_m, _)| outline_m);
    Slabs {
        list: std::array::from_fn(|i| slabs.get(i).copied().unwrap_or_else(Slab::zeroed)),
        outline: std::array::from_fn(|i| Corner { at_m: outline_m.get(i).copied().unwrap_or_default(), _pad: [0; 8] }),
        count: slabs.len() as u32,
        corner_count: outline_m.len().min(CORNER_LIMIT) as u32,
        _pad: [0; 8],
    }
}
