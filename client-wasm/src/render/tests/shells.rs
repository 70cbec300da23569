//! Shells: their sums on the GPU, where they are drawn, and the benefit of slices.

use super::*;
use crate::render::options::render_options::{FarPlants, RenderOptions};
use prairie_core::lod::shells::Tilt;
use prairie_core::scene::PlantCover;

/// A flat lawn of 64 m in a light wind, drawn as shells with this number of slices.
fn lawn(slices: u32) -> Mirror {
    let change = |scene: &mut Scene| {
        scene.wind = Wind { mean_m_per_s: [4.0, 0.0], ..Wind::default() };
        (scene.plants.cover, scene.plants.height_m, scene.shells.slices) = (PlantCover::Shells, 0.25, slices);
    };
    meadow_of(change, &[255; 16 * 16])
}

#[test]
fn layers_are_positioned_as_in_the_core() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let mut mirror = meadow(0.0);
    let mut picture = OffscreenRenderer::new(&gpu, [16, 16], Quality::Low);
    picture.draw(&mut mirror, &Camera::default(), 0.0, 0.0);
    let cases: Vec<[f32; 4]> = (0..500_u32)
        .map(|n| {
            let [a, b, c] = hash3([n, 1, 8]).map(unit);
            let segments = 1 + (b * 64.0) as u32;
            // Calm, full wind and trodden grass are among them.
            let lean_rad = [0.0, std::f32::consts::FRAC_PI_4, 1.5, 1.7 * a][n as usize % 4];
            [lean_rad, (c * (segments + 1) as f32).floor().min(segments as f32), segments as f32, 0.0]
        })
        .collect();
    let body = "let tilt = tilt_of(at.x); return vec4<f32>(layer_place(tilt.x, tilt.y, at.y, at.z), tilt);";
    let found = probe_in(&gpu, &picture, "plants/shells", body, &cases);
    for ([lean_rad, layer, segments, _], found) in cases.into_iter().zip(found) {
        let tilt = Tilt::of_lean(lean_rad);
        let [along_normal, along_wind] = tilt.layer(layer, segments as u32);
        let wanted = [along_normal, along_wind, tilt.root_rad, tilt.intensity];
        assert!(
            wanted.iter().zip(found).all(|(a, b)| (a - b).abs() < 2e-5),
            "{lean_rad} rad, {layer} of {segments}: {found:?} instead of {wanted:?}"
        );
    }
}

#[test]
fn shells_replace_all_plants_or_only_far_ones() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let camera = Camera { eye_m: Vec3::new(32.0, 2.0, 60.0), ..Camera::default() };
    let drawn = |mirror: &mut Mirror, far, shell_layers| {
        let mut picture = OffscreenRenderer::new(&gpu, [32, 16], Quality::Low);
        picture.set_options(RenderOptions { far_plants: far, shell_layers, ..RenderOptions::default() });
        let stats = picture.draw(mirror, &camera, 0.0, 0.0);
        [stats.blades, stats.clumps, stats.shell_layers]
    };
    let [blades, clumps, sheets] = drawn(&mut lawn(4), FarPlants::Clumps, None);
    assert!(blades == 0 && clumps == 0 && sheets > 20, "{blades}, {clumps}, {sheets}");
    let [fewest, fewer, more] = [1, 17, 65].map(|layers| drawn(&mut lawn(4), FarPlants::Clumps, Some(layers))[2]);
    assert!(fewest < fewer && fewer == sheets && 2 * fewer < more, "{fewest}, {fewer}, {more}");
    let [blades, clumps, far_sheets] = drawn(&mut meadow(4.0), FarPlants::Shells, None);
    assert!(blades > 0 && clumps == 0 && far_sheets > 0 && far_sheets < sheets, "{blades}, {clumps}, {far_sheets}");
    let [blades, clumps, sheets] = drawn(&mut meadow(4.0), FarPlants::Clumps, None);
    assert!(blades > 0 && clumps > 0 && sheets == 0, "{blades}, {clumps}, {sheets}");
}

/// Mean difference of the channels of two pictures, 0..=255.
fn difference(a: &[u8], b: &[u8]) -> f64 {
    a.iter().zip(b).map(|(a, b)| f64::from(a.abs_diff(*b))).sum::<f64>() / a.len() as f64
}

#[test]
fn slices_look_like_many_more_layers_at_grazing_angles() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    // In a region with sixteen layers, 10° below the horizontal.
    let camera = Camera { eye_m: Vec3::new(32.0, 1.0, 40.0), pitch_rad: -0.42, ..Camera::default() };
    let drawn = |slices, layers| {
        let mut picture = OffscreenRenderer::new(&gpu, [192, 108], Quality::Low);
        picture.set_options(RenderOptions { shell_layers: Some(layers), ..RenderOptions::default() });
        picture.draw(&mut lawn(slices), &camera, 0.0, 0.0);
        picture.rgba()
    };
    let many = drawn(32, 65);
    let [without, with] = [1, 12].map(|slices| difference(&drawn(slices, 9), &many));
    assert!(with < 0.7 * without, "{with} with slices, {without} without");
}
