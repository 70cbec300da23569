use super::{meadow_of, probe};
use crate::camera::Camera;
use crate::render::gpu::device::Gpu;
use crate::render::offscreen::OffscreenRenderer;
use crate::render::options::quality::Quality;
use crate::render::options::render_options::RenderOptions;
use glam::Vec3;
use prairie_core::light::air::haze_phase;
use prairie_core::light::sky::{Air, NIGHT_CD_PER_M2};
use prairie_core::light::sun::Sun;
use prairie_core::light::{grass, lamp};
use prairie_core::scene::Lamp;

const CAMERA: Camera = Camera { eye_m: Vec3::new(32.0, 2.2, 40.0), heading_rad: 0.0, pitch_rad: -0.15, fov_rad: 1.0, target_m: None };

fn drawn(gpu: &Gpu, sun: Sun, lamps: Vec<Lamp>) -> OffscreenRenderer {
    let mut picture = OffscreenRenderer::new(gpu, [32, 32], Quality::Low);
    picture.set_options(RenderOptions { sun: Some(sun), ..RenderOptions::default() });
    picture.draw(&mut meadow_of(|scene| scene.lights = lamps, &[255; 256]), &CAMERA, 0.0, 0.0);
    picture
}

const NOON: Sun = Sun { heading_rad: 0.7, elevation_rad: 0.9 };

#[test]
fn formulas_of_grass_and_lamps_equal_their_cpu_twins() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let picture = drawn(&gpu, NOON, Vec::new());
    let places: Vec<[f32; 4]> =
        (0..40).map(|n| n as f32 / 39.0).map(|fraction| [fraction, 2.0 * fraction - 1.0, 0.05 + fraction, 40.0 * fraction]).collect();
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

/// The sky's table as the shaders sample it: correct to 2 %, given half precision and filtering with 8 bits.
#[test]
fn the_sky_equals_its_cpu_twin() {
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
        let found = probe(&gpu, &picture, "return vec4<f32>(sky_color(at.xyz), frame.lights.night_rgb.r);", &directions);
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
    // Three metres below the lamp; and at 45°: half by the inverse square of the distance, times the cosine.
    assert!(below[0] > 0.0 && (below[1] / below[0] - 0.5).abs() < 1e-3, "{below:?}");
    assert!((beside[0] / below[0] - 0.5 * 0.5_f32.sqrt()).abs() < 1e-3, "{beside:?} beside {below:?}");
    assert_eq!(far[0], 0.0);
}
