//! Blend orders: sorting far to near, soft borders, switching between frames.

use super::*;
use crate::render::options::render_options::{BlendOrder, FarPlants, RenderOptions};
use crate::render::options::split::{SideOptions, Split};
use crate::render::plants::blades::Blades;

const SIZE_PX: [u32; 2] = [96, 64];

/// A meadow, and a picture of it whose blades have settled.
fn grown(gpu: &Gpu, quality: Quality) -> (Mirror, OffscreenRenderer) {
    let mut mirror = meadow(4.0);
    let mut picture = OffscreenRenderer::new(gpu, SIZE_PX, quality);
    for _ in 0..3 {
        picture.draw(&mut mirror, &camera(), 1.0, 0.03);
    }
    (mirror, picture)
}

/// A camera off the centre of its grid, not aligned with its sides.
fn camera() -> Camera {
    Camera { eye_m: Vec3::new(33.1, 1.1, 38.7), heading_rad: 0.7, pitch_rad: -0.2, ..Camera::default() }
}

/// The same moment drawn in an order.
fn pixels(mirror: &mut Mirror, picture: &mut OffscreenRenderer, order: BlendOrder) -> Vec<u8> {
    picture.set_options(RenderOptions { blend_order: order, ..RenderOptions::default() });
    picture.draw(mirror, &camera(), 1.0, 0.0);
    picture.rgba()
}

/// Mean absolute difference of two pictures, of 255.
fn apart(a: &[u8], b: &[u8]) -> f64 {
    a.iter().zip(b).map(|(&a, &b)| f64::from(a.abs_diff(b))).sum::<f64>() / a.len() as f64
}

fn blades(picture: &OffscreenRenderer) -> &Blades {
    picture.renderer.scene.as_ref().and_then(|scene| scene.blades.as_ref()).expect("grass")
}

/// Roots (m) of the blades in the order in which they are drawn, and how many of them come before the fine ones.
fn roots_in_order(gpu: &Gpu, picture: &OffscreenRenderer) -> (Vec<Vec3>, usize) {
    let blades = blades(picture);
    let ordered = blades.strip_pipelines.get().ordered().expect("blades in order");
    let spans: Vec<u32> = bytemuck::pod_collect_to_vec(&read(gpu, ordered.spans()));
    let pairs: Vec<[u32; 2]> = bytemuck::pod_collect_to_vec(&read(gpu, ordered.pairs()));
    let listed: Vec<[f32; 4]> = bytemuck::pod_collect_to_vec(&read(gpu, &blades.listed.blades));
    let rows = (blades::BLADE_BYTES / 16) as usize;
    let mut places: Vec<u32> = pairs[..spans[0] as usize].iter().map(|pair| pair[1]).collect();
    let roots = places.iter().map(|&place| Vec3::from_slice(&listed[place as usize * rows][..3])).collect();
    let counters: Vec<u32> = bytemuck::pod_collect_to_vec(&read(gpu, &blades.listed.counters));
    assert_eq!(places.len() as u32, counters[..3].iter().sum::<u32>(), "every blade that is listed is drawn");
    places.sort_unstable();
    places.dedup();
    assert_eq!(places.len() as u32, spans[0], "and once");
    assert_eq!([spans[1], spans[3]], [0, spans[2]]);
    assert_eq!((spans[4], spans[2] + spans[4]), (counters[0], spans[0]));
    (roots, spans[2] as usize)
}

#[test]
fn sorted_blades_are_drawn_far_to_near() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let (mut mirror, mut picture) = grown(&gpu, Quality::Low);
    pixels(&mut mirror, &mut picture, BlendOrder::Sorted);
    let (roots, others) = roots_in_order(&gpu, &picture);
    assert!(others > 500 && roots.len() - others > 50, "{others} and {} fine blades", roots.len() - others);
    let distances: Vec<f32> = roots.iter().map(|root| root.distance(camera().eye_m)).collect();
    // A step of the key is 0.027 % of the distance.
    for (at, pair) in distances.windows(2).enumerate() {
        assert!(pair[0] * 1.0004 > pair[1], "{} m before {} m at {at}", pair[0], pair[1]);
    }
    assert!(distances[0] > 4.0 * distances[distances.len() - 1]);
}

#[test]
fn precomputed_orders_draw_no_blade_behind_an_earlier_one() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let (mut mirror, mut picture) = grown(&gpu, Quality::Low);
    pixels(&mut mirror, &mut picture, BlendOrder::Precomputed);
    let (roots, others) = roots_in_order(&gpu, &picture);
    let eye = [camera().eye_m.x, camera().eye_m.z];
    let flat: Vec<[f32; 2]> = roots.iter().map(|root| [root.x - eye[0], root.z - eye[1]]).collect();
    let mut overlapping = 0;
    let mut wrong = 0;
    for span in [&flat[..others], &flat[others..]] {
        for (at, a) in span.iter().enumerate() {
            for b in &span[at + 1..] {
                let [near, far] = [a[0].hypot(a[1]), b[0].hypot(b[1])];
                // Within one blade width of the line of sight to the farther one.
                let passes = (a[0] * b[1] - a[1] * b[0]).abs() / near.max(far);
                if passes < 0.005 && a[0] * b[0] + a[1] * b[1] > 0.0 {
                    overlapping += 1;
                    wrong += u32::from(far > near * 1.003);
                }
            }
        }
    }
    assert!(overlapping > 1000, "{overlapping} pairs");
    assert!(f64::from(wrong) < 0.03 * f64::from(overlapping), "{wrong} of {overlapping} pairs");
}

#[test]
fn blend_orders_may_change_between_frames() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let (mut mirror, mut picture) = grown(&gpu, Quality::High);
    let mut draw = |order| pixels(&mut mirror, &mut picture, order);
    let [cut, coverage, sorted, precomputed, weighted] = BlendOrder::ALL.map(&mut draw);
    assert!(apart(&cut, &draw(BlendOrder::Cut)) < 0.02, "nothing is left of the others");
    assert!(apart(&sorted, &draw(BlendOrder::Sorted)) < 0.02);
    let same = apart(&sorted, &precomputed);
    assert!(same < 0.6, "{same} between sorted and precomputed");
    for (other, least, most) in [(&cut, 0.3, 12.0), (&coverage, 0.1, 12.0), (&weighted, 0.3, 40.0)] {
        let apart = apart(&sorted, other);
        assert!((least..most).contains(&apart), "{apart}");
    }
    picture.renderer.resize([48, 32]);
    picture.renderer.resize(SIZE_PX);
    let again = apart(&weighted, &pixels(&mut mirror, &mut picture, BlendOrder::Weighted));
    // The device lists blades in any order, and the rounding of 16-bit sums depends on it.
    assert!(again < 0.04, "{again} after other sizes");
}

#[test]
fn resources_of_two_orders_side_by_side_are_created_once() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let (mut mirror, mut picture) = grown(&gpu, Quality::Low);
    let ways = [BlendOrder::Precomputed, BlendOrder::Sorted].map(|order| SideOptions {
        options: RenderOptions { blend_order: order, far_plants: FarPlants::Clumps, ..RenderOptions::default() },
        level: 0.0,
    });
    let mut draw = || {
        picture.draw_split(&mut mirror, &camera(), 1.0, 0.0, &Split { sides: ways, border: 0.5 });
        // The pairs that the right side has just been drawn with.
        let pairs = blades(&picture).strip_pipelines.get().ordered().expect("blades in order").pairs().clone();
        (
            pairs,
            picture.renderer.scene.as_ref().and_then(|scene| scene.billboards.as_ref()).expect("clumps").pipelines.get().pipeline.clone(),
        )
    };
    let first = draw();
    assert!(draw() == first, "made anew");
}

#[test]
fn coverage_with_one_sample_equals_cut() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let (mut mirror, mut picture) = grown(&gpu, Quality::Low);
    let [cut, coverage, ..] = BlendOrder::ALL.map(|order| pixels(&mut mirror, &mut picture, order));
    assert!(apart(&cut, &coverage) < 0.02);
}

#[test]
fn strips_cover_pixels_in_proportion_to_their_width() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let mut mirror = meadow(0.0);
    let mut picture = OffscreenRenderer::new(&gpu, [16, 16], Quality::Low);
    picture.draw(&mut mirror, &Camera::default(), 0.0, 0.0);
    let strips: Vec<[f32; 4]> = (0..40).map(|i| [0.05 * i as f32, 0.11 * i as f32 % 1.0, 0.0, 0.0]).collect();
    let body = "var sum = 0.0;
        for (var pixel = -6; pixel <= 6; pixel++) { sum += covered(vec2<f32>(f32(pixel) + at.y, at.x)); }
        return vec4<f32>(sum, covered(vec2<f32>(at.x + 0.5, at.x)), covered(vec2<f32>(0.0, at.x)), 0.0);";
    for ([half_px, ..], [sum, beside, middle, _]) in strips.iter().zip(probe_in(&gpu, &picture, "plants/backbone", body, &strips)) {
        assert!((sum - 2.0 * half_px).abs() < 1e-5, "{sum} of a strip of {} px", 2.0 * half_px);
        assert_eq!((beside, middle), (0.0, (2.0 * half_px).min(1.0)));
    }
}
