use super::{meadow_of, probe};
use crate::camera::Camera;
use crate::render::{Gpu, Look, Picture, Quality, Sun};
use glam::Vec3;
use shared::light::air::haze_phase;
use shared::light::sky::{Air, NIGHT_CD_PER_M2};
use shared::light::{grass, lamp};
use shared::scene::Lamp;

const CAMERA: Camera = Camera { eye_m: Vec3::new(32.0, 2.2, 40.0), heading_rad: 0.0, pitch_rad: -0.15, fov_rad: 1.0 };

fn drawn(gpu: &Gpu, sun: Sun, lamps: Vec<Lamp>) -> Picture {
    let mut picture = Picture::new(gpu, [32, 32], Quality::Low);
    picture.set_look(Look { sun: Some(sun), ..Look::default() });
    picture.draw(&mut meadow_of(|scene| scene.lights = lamps, &[255; 256]), &CAMERA, 0.0, 0.0);
    picture
}

const NOON: Sun = Sun { heading_rad: 0.7, elevation_rad: 0.9 };

#[test]
fn formulas_of_grass_and_lamps_are_as_their_twins() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let picture = drawn(&gpu, NOON, Vec::new());
    let places: Vec<[f32; 4]> =
        (0..40).map(|n| n as f32 / 39.0).map(|share| [share, 2.0 * share - 1.0, 0.05 + share, 40.0 * share]).collect();
    let body = "return vec4<f32>(nearest_normal(at.y), self_shadow(at.x, 0.3), sun_through_leaves(2.5, at.x, at.z), attenuation(vec3<f32>(0.2, 0.1, 0.7), at.w));";
    for (at, found) in places.iter().zip(probe(&gpu, &picture, body, &places)) {
        let wanted = [
            grass::diffuse(at[1]),
            grass::self_shadow(at[0], 0.3),
            grass::sun_through_leaves(2.5, at[0], at[2]),
            lamp::attenuation([0.2, 0.1, 0.7], at[3]),
        ];
        assert!(wanted.iter().zip(found).all(|(a, b)| (a - b).abs() < 1e-4 * a.max(1.0)), "{found:?} instead of {wanted:?} at {at:?}");
        let phase = probe(&gpu, &picture, "return vec4<f32>(haze_phase(at.y));", &[*at])[0][0];
        assert!((phase / haze_phase(at[1]) - 1.0).abs() < 1e-3, "{phase} at {at:?}");
    }
}

/// The sky's table as the shaders read it: within the 2 % of halves and of filtering by 8 bits.
#[test]
fn the_sky_is_as_its_twin() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    for elevation_rad in [0.9, 0.1, -0.05] {
        let sky = Air::new().sky(elevation_rad);
        let sun = Sun { heading_rad: 0.7, elevation_rad };
        let picture = drawn(&gpu, sun, Vec::new());
        let directions: Vec<[f32; 4]> = (0..60)
            .map(|n| {
                let (up, heading) = (n as f32 / 60.0, n as f32 * 1.1);
                let level = (1.0 - up * up).sqrt();
                [heading.sin() * level, up, -heading.cos() * level, heading]
            })
            .collect();
        let found = probe(&gpu, &picture, "return vec4<f32>(sky_color(at.xyz), frame.lights.night.r);", &directions);
        for (at, found) in directions.iter().zip(found) {
            let brightness = found[3] / NIGHT_CD_PER_M2[0];
            let wanted = sky.luminance(at[1], (at[3] - sun.heading_rad).cos()).map(|light| light * brightness);
            assert!(wanted.iter().zip(found).all(|(a, b)| (a - b).abs() < 0.02 * a + 1e-3), "{found:?} instead of {wanted:?} at {at:?}");
        }
    }
}

#[test]
fn a_lamp_lights_the_dark_where_it_reaches() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let dark = Sun { heading_rad: 0.7, elevation_rad: -0.4 };
    let picture = drawn(&gpu, dark, vec![Lamp { rgb: [1.0, 0.5, 0.25], ..Lamp::new([32.0, 3.0, 32.0]) }]);
    let places = [[32.0, 0.0, 32.0, 0.0], [32.0, 0.0, 35.0, 0.0], [5000.0, 0.0, 32.0, 0.0]];
    let [below, beside, far]: [[f32; 4]; 3] =
        probe(&gpu, &picture, "return vec4<f32>(lamps_on(at.xyz, vec3<f32>(0.0, 1.0, 0.0), 0.0), 0.0);", &places)
            .try_into()
            .expect("as many as asked for");
    // Three metres below; and aslant, half the square of the distance and the cosine of 45°.
    assert!(below[0] > 0.0 && (below[1] / below[0] - 0.5).abs() < 1e-3, "{below:?}");
    assert!((beside[0] / below[0] - 0.5 * 0.5_f32.sqrt()).abs() < 1e-3, "{beside:?} beside {below:?}");
    assert_eq!(far[0], 0.0);
}
