//! Bare ground, seen from afar.

use super::cracks::ragged_land;
use super::*;

/// Pixels of 1 m that are bare, within half a pixel of a line across the map.
fn strip() -> Vec<u8> {
    let is_bare = |x: usize, z: usize| (z as f32 - (20.0 + 0.4 * x as f32)).abs() < 0.54;
    (0..128 * 128).map(|at| if is_bare(at % 128, at / 128) { 0 } else { 255 }).collect()
}

/// Grass cover in the middle of the strip, averaged over `span_m`: least and largest.
fn cover_along(span_m: f32) -> [f32; 2] {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let mut picture = OffscreenRenderer::new(&gpu, [16, 16], Quality::Low);
    picture.draw(&mut ragged_land(|_| {}, &strip()), &Camera::default(), 0.0, 0.0);
    let places: Vec<_> = (0..400).map(|n| 10.0 + 0.25 * n as f32).map(|x| [x, 20.3 + 0.4 * x, span_m, 0.0]).collect();
    let found = probe_in(&gpu, &picture, "land_and_sky/ground", "return vec4<f32>(grass_fraction_over(at.xy, at.z));", &places);
    found.iter().fold([1.0, 0.0], |[least, largest], [value, ..]| [value.min(least), value.max(largest)])
}

#[test]
fn a_narrow_strip_is_whole_from_afar() {
    for span_m in [4.0, 8.0] {
        let [least, largest] = cover_along(span_m);
        assert!(largest - least < 0.25 && largest < 0.98, "{least} to {largest} over {span_m} m");
    }
    // A point of its ragged border is grass or soil, which breaks it into dashes where a pixel shows only points.
    let [least, largest] = cover_along(0.0);
    assert!(least < 0.1 && largest > 0.9, "{least} to {largest}");
}
