//! Lamps in a frame: the scene's own, and the headlights of cars when it is dark.

use super::uniforms::{LAMP_LIMIT, Lamp};
use glam::{Quat, Vec3, Vec4};
use shared::light::lamp::reach_m;
use shared::scene::{Scene, VehicleKind};
use shared::terrain::HeightMap;
use shared::wire::ObjectPose;
use std::f32::consts::PI;

/// Elevation of the sun below which cars drive with their lamps on (rad).
const LAMPS_ON_RAD: f32 = 0.052;
/// Where headlights are in a car's body (m, on either side), as the model has them.
const HEADLIGHT_M: Vec3 = Vec3::new(0.62, 0.02, -2.2);
/// Luminous intensity in the middle of a dipped beam (cd), how far it looks down (rad), and cosines between which its cone ends.
const HEADLIGHT_CD: f32 = 9000.0;
const HEADLIGHT_DOWN_RAD: f32 = 0.05;
const HEADLIGHT_CONE: [f32; 2] = [0.88, 0.985];
const HEADLIGHT_RGB: Vec3 = Vec3::new(1.0, 0.90, 0.74);
/// Brightness of the picture at which a lamp's light ends.
const LEAST: f32 = 0.004;

/// Centre and radius (m) of a sphere about all that lamps reach; its radius is below zero where there are none.
pub(super) fn lit(lamps: &[Lamp]) -> [f32; 4] {
    let places = || lamps.iter().map(|lamp| Vec4::from(lamp.place));
    let centre = places().map(Vec4::truncate).sum::<Vec3>() / lamps.len().max(1) as f32;
    let radius_m = places().map(|place| place.truncate().distance(centre) + place.w).fold(-1.0, f32::max);
    centre.extend(radius_m).to_array()
}

/// The lamps nearest to the eye whose light is seen at a brightness of the picture for each cd/m².
pub(super) fn lamps(scene: &Scene, heights: &HeightMap, poses: &[ObjectPose], sun_up_rad: f32, brightness: f32, eye_m: Vec3) -> Vec<Lamp> {
    let lit = |place_m: Vec3, rgb: Vec3, candela: f32, attenuation: [f32; 3]| {
        let reach_m = reach_m(candela, attenuation, LEAST * PI / brightness);
        let [c, l, q] = attenuation;
        Lamp {
            place: place_m.extend(reach_m).to_array(),
            // All around: no cosine is as small.
            rgb: (rgb * (candela * brightness / PI)).extend(-3.0).to_array(),
            aim: Vec4::new(0.0, -1.0, 0.0, -2.0).to_array(),
            attenuation: [c, l, q, 0.0],
        }
    };
    let standing = scene.lights.iter().map(|lamp| {
        let [x, above, z] = lamp.at_m;
        lit(Vec3::new(x, heights.height_m(x, z) + above, z), Vec3::from(lamp.rgb), lamp.candela, lamp.attenuation)
    });
    let is_dark = sun_up_rad < LAMPS_ON_RAD;
    let cars = poses.iter().filter(|pose| is_dark && pose.kind == VehicleKind::Car);
    let driven = cars.flat_map(|pose| {
        let turn = Quat::from_array(pose.rotation);
        let aim = turn * (Quat::from_rotation_x(-HEADLIGHT_DOWN_RAD) * Vec3::NEG_Z);
        [-1.0, 1.0].map(|side| {
            let place_m = Vec3::from(pose.position_m) + turn * (HEADLIGHT_M * Vec3::new(side, 1.0, 1.0));
            let mut lamp = lit(place_m, HEADLIGHT_RGB, HEADLIGHT_CD, [0.0, 0.0, 1.0]);
            lamp.rgb[3] = HEADLIGHT_CONE[0];
            lamp.aim = aim.extend(HEADLIGHT_CONE[1]).to_array();
            lamp
        })
    });
    let away_m = |lamp: &Lamp| Vec4::from(lamp.place).truncate().distance(eye_m) - lamp.place[3];
    let mut lamps: Vec<Lamp> = standing.chain(driven).filter(|lamp| lamp.place[3] > 0.5).collect();
    lamps.sort_by(|a, b| away_m(a).total_cmp(&away_m(b)));
    lamps.truncate(LAMP_LIMIT);
    lamps
}
