//! Lamps of a frame: those of the scene, and headlights when it is dark.

use crate::render::gpu::uniforms::{LAMP_LIMIT, Lamp};
use glam::Vec3;
use prairie_core::light::lamp::reach_m;
use prairie_core::scene::Scene;
use prairie_core::terrain::HeightMap;
use std::f32::consts::PI;

/// Elevation of the sun below which headlights are on (rad).
const HEADLIGHTS_ON_RAD: f32 = 0.052;
/// Brightness in the picture at which a lamp's light ends.
const MIN_BRIGHTNESS: f32 = 0.004;

/// A lamp that shines in a cone.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SpotLight {
    pub(crate) position_m: Vec3,
    /// Unit vector along the cone's axis.
    pub(crate) direction: Vec3,
    pub(crate) rgb: Vec3,
    /// Luminous intensity on the axis (cd).
    pub(crate) candela: f32,
    /// Cosines of the outer angle (end of the light cone) and of the inner angle (full light within it).
    pub(crate) cone_cosines: [f32; 2],
}

/// Centre and radius (m) of a sphere around everything that the lamps reach. The radius is negative without lamps.
pub(crate) fn lit_sphere(lamps: &[Lamp]) -> (Vec3, f32) {
    let centre_m = lamps.iter().map(|lamp| Vec3::from(lamp.position_m)).sum::<Vec3>() / lamps.len().max(1) as f32;
    let radius_m = lamps.iter().map(|lamp| Vec3::from(lamp.position_m).distance(centre_m) + lamp.reach_m).fold(-1.0, f32::max);
    (centre_m, radius_m)
}

/// Lamps nearest to the eye, of the scene and, in the dark, of vehicles. `brightness` is that of the picture per cd/m².
pub(crate) fn lamps(
    scene: &Scene,
    heights: &HeightMap,
    headlights: &[SpotLight],
    sun_elevation_rad: f32,
    brightness: f32,
    eye_m: Vec3,
) -> Vec<Lamp> {
    let lamp = |position_m: Vec3, rgb: Vec3, candela: f32, attenuation: [f32; 3]| Lamp {
        position_m: position_m.to_array(),
        reach_m: reach_m(candela, attenuation, MIN_BRIGHTNESS * PI / brightness),
        rgb: (rgb * (candela * brightness / PI)).to_array(),
        // Shines in all directions: no cosine is as small as these limits.
        edge_cosine: -3.0,
        direction: [0.0, -1.0, 0.0],
        full_cosine: -2.0,
        attenuation,
        _pad: [0; 4],
    };
    let of_scene = scene.lights.iter().map(|light| {
        let [x, above, z] = light.at_m;
        lamp(Vec3::new(x, heights.height_m(x, z) + above, z), Vec3::from(light.rgb), light.candela, light.attenuation)
    });
    let is_dark = sun_elevation_rad < HEADLIGHTS_ON_RAD;
    let of_vehicles = headlights.iter().filter(|_| is_dark).map(|light| {
        let mut lamp = lamp(light.position_m, light.rgb, light.candela, [0.0, 0.0, 1.0]);
        [lamp.edge_cosine, lamp.full_cosine] = light.cone_cosines;
        lamp.direction = light.direction.to_array();
        lamp
    });
    let distance_m = |lamp: &Lamp| Vec3::from(lamp.position_m).distance(eye_m) - lamp.reach_m;
    let mut lamps: Vec<Lamp> = of_scene.chain(of_vehicles).filter(|lamp| lamp.reach_m > 0.5).collect();
    lamps.sort_by(|a, b| distance_m(a).total_cmp(&distance_m(b)));
    lamps.truncate(LAMP_LIMIT);
    lamps
}
