//! Shells: their sums on the GPU, what is drawn where, and what slices are worth.

use super::super::look::{Far, Look};
use super::*;
use shared::lod::shells::Tilt;
use shared::scene::PlantCover;

/// A flat lawn of 64 m in a light wind, as shells of so many slices.
fn lawn(slices: u32) -> Mirror {
    let change = |scene: &mut Scene| {
        scene.wind = Wind { mean_m_per_s: [4.0, 0.0], ..Wind::default() };
        (scene.plants.cover, scene.plants.height_m, scene.shells.slices) = (PlantCover::Shells, 0.25, slices);
    };
    meadow_of(change, &[255; 16 * 16])
}

#[test]
fn layers_lie_where_their_twin_has_them() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let mut mirror = meadow(0.0);
    let mut picture = Picture::new(&gpu, [16, 16], Quality::Low);
    picture.draw(&mut mirror, &Camera::default(), 0.0, 0.0);
    let source = shaders::SHELLS.replace("@group(1) @binding(0) var<storage, read>", "@group(1) @binding(20) var<storage, read>");
    let cases: Vec<[f32; 4]> = (0..500_u32)
        .map(|n| {
            let [a, b, c] = hash3([n, 1, 8]).map(|v| (v >> 8) as f32 / 16_777_216.0);
            let segments = 1 + (b * 64.0) as u32;
            // Calm, full wind and trodden grass are among them.
            let lean_rad = [0.0, std::f32::consts::FRAC_PI_4, 1.5, 1.7 * a][n as usize % 4];
            [lean_rad, (c * (segments + 1) as f32).floor().min(segments as f32), segments as f32, 0.0]
        })
        .collect();
    let body = "let tilt = tilt_of(at.x); return vec4<f32>(layer_place(tilt.x, tilt.y, at.y, at.z), tilt);";
    let found = probe_in(&gpu, &picture, &source, body, &cases);
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
fn shells_stand_for_all_plants_or_for_those_far_away() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let camera = Camera { eye_m: Vec3::new(32.0, 2.0, 60.0), ..Camera::default() };
    let drawn = |mirror: &mut Mirror, far, shell_layers| {
        let mut picture = Picture::new(&gpu, [32, 16], Quality::Low);
        picture.set_look(Look { far, shell_layers, ..Look::default() });
        let stats = picture.draw(mirror, &camera, 0.0, 0.0);
        [stats.blades, stats.clumps, stats.sheets]
    };
    let [blades, clumps, sheets] = drawn(&mut lawn(4), Far::Clumps, None);
    assert!(blades == 0 && clumps == 0 && sheets > 20, "{blades}, {clumps}, {sheets}");
    let [fewest, fewer, more] = [1, 17, 65].map(|layers| drawn(&mut lawn(4), Far::Clumps, Some(layers))[2]);
    assert!(fewest < fewer && fewer == sheets && 2 * fewer < more, "{fewest}, {fewer}, {more}");
    let [blades, clumps, far_sheets] = drawn(&mut meadow(4.0), Far::Shells, None);
    assert!(blades > 0 && clumps == 0 && far_sheets > 0 && far_sheets < sheets, "{blades}, {clumps}, {far_sheets}");
    let [blades, clumps, sheets] = drawn(&mut meadow(4.0), Far::Clumps, None);
    assert!(blades > 0 && clumps > 0 && sheets == 0, "{blades}, {clumps}, {sheets}");
}

/// Mean difference of the channels of two pictures, 0..=255.
fn difference(a: &[u8], b: &[u8]) -> f64 {
    a.iter().zip(b).map(|(a, b)| f64::from(a.abs_diff(*b))).sum::<f64>() / a.len() as f64
}

#[test]
fn slices_show_at_a_flat_view_what_many_more_layers_would() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    // Where sixteen layers are drawn, 10° below the level.
    let camera = Camera { eye_m: Vec3::new(32.0, 1.0, 40.0), pitch_rad: -0.42, ..Camera::default() };
    let drawn = |slices, layers| {
        let mut picture = Picture::new(&gpu, [192, 108], Quality::Low);
        picture.set_look(Look { shell_layers: Some(layers), ..Look::default() });
        picture.draw(&mut lawn(slices), &camera, 0.0, 0.0);
        picture.rgba()
    };
    let many = drawn(32, 65);
    let [without, with] = [1, 12].map(|slices| difference(&drawn(slices, 9), &many));
    assert!(with < 0.7 * without, "{with} with slices, {without} without");
}
