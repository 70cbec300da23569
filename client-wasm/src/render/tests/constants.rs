//! Values of overrides: shaders without the features that a scene does not use give the same results.

use super::*;
use crate::render::gpu::shaders::with_constants;

/// Positions all over the map, including its edge.
fn places() -> Vec<[f32; 4]> {
    let [x, z] = [0_u32, 1].map(|axis| move |n: u32| 64.0 * unit(hash3([n, axis, 4])[0]));
    let inside = (0..200).map(|n| [x(n), 0.0, z(n), 0.0]);
    inside.chain([[0.0, 0.0, 0.0, 0.0], [64.0, 0.0, 64.0, 0.0], [64.0, 0.0, 30.0, 0.0]]).collect()
}

#[test]
fn land_of_one_kind_needs_neither_the_code_for_kinds_nor_that_beyond_the_map() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let heights: Vec<u8> = (0..17 * 17).map(|n| (hash3([n, 7, 2])[0] % 9) as u8).collect();
    let mut mirror = meadow_over(&heights, |scene| scene.terrain.level_m = 1.0, &[255; 16 * 16]);
    let mut picture = OffscreenRenderer::new(&gpu, [16, 9], Quality::Low);
    picture.draw(&mut mirror, &Camera::default(), 0.0, 0.0);
    for body in [
        "return vec4<f32>(ground_normal(at.xz), ground_height(at.xz));",
        "let kind = kinds_blended(at.xz); return vec4<f32>(f32(kind_at(at.xz)), kind.height_m, kind.wind_bend_rad, kind.width);",
    ] {
        let [whole, reduced] =
            [true, false].map(|value| probe_with(&gpu, &picture, &[("has_kinds", value), ("reaches_beyond", value)], body, &places()));
        assert!(whole.iter().any(|found| *found != whole[0]) || body.contains("kind"), "the land has hills");
        for (place, (whole, reduced)) in places().iter().zip(whole.iter().zip(&reduced)) {
            let off = whole.iter().zip(reduced).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
            assert!(off < 1e-5, "{body} at {place:?}: {whole:?} and {reduced:?}");
        }
    }
}

#[test]
fn values_take_the_place_of_overrides() {
    let text = "override a: bool = true;\noverride b: bool = false;\nfn f() -> bool { return a && b; }";
    let with = with_constants(text.to_string(), &[("b", true)]);
    assert_eq!(with, "override a: bool = true;\nconst b: bool = true;\nfn f() -> bool { return a && b; }");
    let unknown = std::panic::catch_unwind(|| with_constants(text.to_string(), &[("c", true)]));
    assert!(unknown.is_err(), "a value of no override would be lost");
}
