//! Snow on the land: its surface, and its weight on plants.

use super::*;
use prairie_core::plant::snow_load::laden_mass;
use prairie_core::scene::Snow;
use prairie_core::wire::quantise::snow_code;

/// A still meadow in snow.
fn snowy_meadow(depth_m: f32) -> Mirror {
    meadow_of(|scene| scene.snow = Snow { depth_m, ..Snow::default() }, &[255; 16 * 16])
}

/// Streams snow whose depth differs by `difference_m` of X and Z (m) to all patches.
fn stream_snow(mirror: &mut Mirror, difference_m: impl Fn(f32, f32) -> f32) {
    for patch in 0..16 {
        let [west_m, north_m] = [patch % 4, patch / 4].map(|n| n as f32 * 16.0);
        let center_m = |corner_m: f32, n: usize| corner_m + (n as f32 + 0.5) * 0.25;
        let of = |at: usize| difference_m(center_m(west_m, at % 64), center_m(north_m, at / 64));
        let snow = (0..64 * 64).map(|at| snow_code((of(at) * 1e6) as i64));
        let codes: Vec<i16> = std::iter::repeat_n(0, 3 * 64 * 64).chain(snow).collect();
        let payload = codec::encode(Shape::snowy_patch(64), &codes, None);
        mirror.apply(ServerMessage::Patch { patch, seq: 1, key: true, payload }).expect("a sound patch");
    }
}

#[test]
fn the_shader_finds_the_streamed_depth_and_the_mass_of_laden_plants_of_its_twin() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let mut mirror = snowy_meadow(0.2);
    stream_snow(&mut mirror, |x_m, _| 0.01 * (x_m - 32.0));
    let mut picture = OffscreenRenderer::new(&gpu, [16, 16], Quality::Low);
    picture.draw(&mut mirror, &Camera { eye_m: Vec3::new(32.0, 2.0, 32.0), ..Camera::default() }, 0.0, 0.0);
    let body = "let found = snow_difference(at.xz, 0.0);
        return vec4<f32>(found, laden_mass(found), frame.snow_load, frame.snow_m);";
    let places: Vec<_> = (0..40).map(|n| [4.0 + 1.4 * n as f32, 0.0, 20.0, 0.0]).collect();
    for (at, [difference_m, mass, load, depth_m]) in places.iter().zip(probe(&gpu, &picture, body, &places)) {
        assert!((difference_m - 0.01 * (at[0] - 32.0)).abs() < 0.0025, "{difference_m} m at {at:?}");
        assert!((mass - laden_mass(load, depth_m, difference_m)).abs() < 1e-5, "{mass} at {at:?}");
        assert!((load - 1.5).abs() < 1e-4 && depth_m == 0.2, "leaves are full: {load}");
    }
}

#[test]
fn snow_weighs_blades_down_in_proportion_to_their_mass() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let [bare, laden] = [0.0, 0.2].map(|depth_m| sways_after(&gpu, &mut snowy_meadow(depth_m), None, 2));
    assert!(bare.len() > 100 && bare.len() == laden.len());
    // The lowest links, which lean little, so that no limit of the lean counts.
    let lean = |sways: &[Sway]| sways.iter().map(|sway| Vec3::new(sway.lean_rad[0][0], 0.0, sway.lean_rad[0][1]).length()).sum::<f32>();
    let ratio = lean(&laden) / lean(&bare);
    assert!((ratio - 2.5).abs() < 0.1, "blades droop {ratio} times as far");
}

/// Pixels of the land, seen from above.
fn picture_of(gpu: &Gpu, mirror: &mut Mirror) -> Vec<u8> {
    let mut picture = OffscreenRenderer::new(gpu, [96, 64], Quality::Low);
    let camera = Camera { eye_m: Vec3::new(32.0, 4.0, 40.0), pitch_rad: -0.7, ..Camera::default() };
    picture.draw(mirror, &camera, 0.0, 0.0);
    picture.rgba()
}

/// Mean of green of some columns of a picture of 96 columns.
fn green(rgba: &[u8], columns: std::ops::Range<usize>) -> f32 {
    let pixels = rgba.chunks_exact(4).enumerate().filter(|(at, _)| columns.contains(&(at % 96)));
    let (sum, count) = pixels.fold((0.0, 0.0), |(sum, count), (_, pixel)| (sum + f32::from(pixel[1]), count + 1.0));
    sum / count
}

#[test]
fn deep_snow_is_white_and_shows_a_rut() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    // Deep enough to cover all blades.
    let white = picture_of(&gpu, &mut snowy_meadow(1.8));
    let greyness = white.chunks_exact(4).map(|pixel| f32::from(pixel[0]) - f32::from(pixel[2])).sum::<f32>() / (96.0 * 64.0);
    assert!(green(&white, 0..96) > 120.0 && greyness.abs() < 40.0, "{} and {greyness}", green(&white, 0..96));
    let mut trodden = snowy_meadow(1.8);
    stream_snow(&mut trodden, |x_m, _| if (31.5..32.5).contains(&x_m) { -0.5 } else { 0.0 });
    let rut = picture_of(&gpu, &mut trodden);
    let contrast = |rgba: &[u8]| {
        let rows: Vec<_> = (40..56).map(|column| green(rgba, column..column + 1)).collect();
        rows.iter().copied().fold(f32::MIN, f32::max) - rows.iter().copied().fold(f32::MAX, f32::min)
    };
    assert!(contrast(&rut) > contrast(&white) + 15.0, "contrast {} in place of {}", contrast(&rut), contrast(&white));
}
