//! Plants close up: curves against their twin in the core, mean colour of veins, and blending in.

use super::*;
use crate::render::gpu::constants::{CLOSE_PX, CURVE_PARTS, FULLY_CLOSE, PARALLEL, PINNATE, STREAKED, TANGENT_DEPARTURE};
use crate::render::tests::probe_in;
use prairie_core::plant::underbrush::spline::point;

fn small_meadow(gpu: &Gpu) -> OffscreenRenderer {
    meadow(gpu, &[]).0
}

#[test]
fn curves_are_those_of_the_core() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let picture = small_meadow(&gpu);
    // Sections that turn by up to 2 rad, from three angles.
    const BODY: &str = "
        let before = vec3<f32>(sin(at.x), cos(at.x), 0.2 * at.x);
        let section = vec3<f32>(sin(at.y), cos(at.y), 0.0);
        let after = vec3<f32>(sin(at.z), cos(at.z), -0.1 * at.z);
        return vec4<f32>(on_curve(before, section, after, u32(at.w), fract(at.w), 0.8, TANGENT_DEPARTURE), 0.0);";
    let cases: Vec<[f32; 4]> = (0..400)
        .map(|n| {
            let [a, b, c] = random(n, 41).map(|lot| 2.0 * lot - 1.0);
            [a, b, c, (n % 4) as f32 + 0.999 * random(n, 42)[0]]
        })
        .collect();
    let found = probe_in(&gpu, &picture, "plants/near_leaf", BODY, &cases);
    let mut bounded = 0;
    for (case, found) in cases.iter().zip(found) {
        let [a, b, c, w] = *case;
        let ends = w as u32;
        let before = Some(Vec3::new(a.sin(), a.cos(), 0.2 * a)).filter(|_| ends & 1 == 0);
        let after = Some(Vec3::new(c.sin(), c.cos(), -0.1 * c)).filter(|_| ends & 2 == 0);
        let section = Vec3::new(b.sin(), b.cos(), 0.0);
        let wanted = point(before, section, after, w.fract(), 0.8);
        let found = Vec3::from_slice(&found);
        assert!(found.distance(wanted) < 1e-5, "{found} instead of {wanted} at {case:?}");
        bounded += u32::from(before.is_some_and(|before| 0.5 * before.distance(section) > TANGENT_DEPARTURE));
    }
    assert!(bounded > 40, "{bounded} sharp turns");
}

/// Departure of the mean of a factor on the colour of a leaf from that of a leaf without veins: the largest of channels, kinds and sizes of pixels. `factor`
/// is WGSL of `close`, `across`, `along`, `pixel` and `sun`.
fn mean_off(gpu: &Gpu, picture: &OffscreenRenderer, factor: &str) -> f32 {
    const SIDE: u32 = 48;
    let body = format!(
        "let close = u32(at.w) & 0xffu; let sun = vec2<f32>(0.8, -0.6); let across = at.x; let along = at.y; let pixel = vec2<f32>(2.0, 1.0) * at.z;
        return vec4<f32>({factor}, 0.0);"
    );
    let mut most = 0.0_f32;
    for (kind, count) in [(PINNATE, 4), (PINNATE, 9), (PARALLEL, 2), (PARALLEL, 7), (STREAKED, 3)] {
        for px in [1e-4, 0.01, 0.04] {
            let close = (kind << 2) | (count << 4);
            let place = |n: u32| [(n % SIDE) as f32, (n / SIDE) as f32].map(|at| (at + 0.5) / SIDE as f32);
            let places: Vec<_> = (0..SIDE * SIDE).map(place).map(|[x, y]| [2.0 * x - 1.0, y, px, close as f32]).collect();
            let sums =
                probe_in(gpu, picture, "plants/near_leaf", &body, &places).iter().fold(Vec3::ZERO, |sum, rgb| sum + Vec3::from_slice(rgb));
            // Without veins a leaf is folded: one half lighter, the rib darker, 0.18 · 0.125 in the mean.
            let plain = if kind == STREAKED { 1.0 } else { 1.0 - 0.18 * 0.125 };
            most = most.max((sums / (SIDE * SIDE) as f32 / plain - Vec3::ONE).abs().max_element());
        }
    }
    most
}

#[test]
fn veins_leave_the_mean_colour_as_it_is() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let picture = small_meadow(&gpu);
    let off = mean_off(&gpu, &picture, "veined(close, across, along, pixel, sun)");
    assert!(off < 0.01, "{off}");
    // Veins that only lighten would not.
    let lighter = mean_off(&gpu, &picture, "max(veined(close, across, along, pixel, sun), vec3<f32>(FOLD_MEAN))");
    assert!(lighter > 0.02, "{lighter}");
}

#[test]
fn veins_vanish_before_pixels_are_too_large_for_them() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let picture = small_meadow(&gpu);
    let body = "return vec4<f32>(vein_profile(at.x, at.y), 0.0, 0.0, 0.0);";
    let most = |per_px: f32| {
        let places: Vec<_> = (0..200).map(|n| [n as f32 / 200.0, per_px, 0.0, 0.0]).collect();
        let found = probe_in(&gpu, &picture, "plants/near_leaf", body, &places);
        let change = found.windows(2).map(|pair| (pair[1][0] - pair[0][0]).abs()).fold(0.0, f32::max) * 200.0 * per_px;
        (found.iter().map(|vein| vein[0].abs()).fold(0.0, f32::max), change)
    };
    assert!((0.75..1.0).contains(&most(0.001).0), "{:?} close up", most(0.001));
    assert_eq!(most(0.5).0, 0.0);
    // From pixel to pixel, veins never change by more than their height.
    for per_px in [0.02, 0.05, 0.1, 0.2, 0.3, 0.4] {
        assert!(most(per_px).1 < 1.0, "{:?} at {per_px}", most(per_px));
    }
}

/// Greatest displacement (px) of the curve of a component from its sections, in a plant of that height (px).
fn displacement_px(one: &Posed, px_per_m: f32) -> f32 {
    let ends: Vec<Vec3> = std::iter::once(one.foot_m).chain(one.sections().iter().map(|section| section.end_m)).collect();
    let section = |at: usize| ends.get(at + 1).map(|&end| end - ends[at]);
    let off = |at: usize| {
        let (own, before) = (ends[at + 1] - ends[at], at.checked_sub(1).and_then(section));
        let of_part = |part: u32| {
            let fraction = part as f32 / CURVE_PARTS as f32;
            (point(before, own, section(at + 1), fraction, 1.0) - own * fraction).length()
        };
        (1..CURVE_PARTS).map(of_part).fold(0.0, f32::max)
    };
    (0..ends.len() - 1).map(off).fold(0.0, f32::max) * px_per_m
}

#[test]
fn curves_appear_without_a_jump_and_stay_fine() {
    let mut all = Vec::new();
    for species in species() {
        let plan = Plan::new(&species, Nodes::default());
        let tall_m = flora::height_m(&species).max(0.5 * flora::reach_m(&species));
        for case in (0..40).map(|n| Case { variant: n % VARIANTS, ..Case::new(n) }) {
            let posed = case.posed(&plan, LookUp::Interpolated);
            let px = |tall_px: f32| {
                let px_per_m = tall_px / (tall_m * case.stand.size);
                posed.iter().map(|one| displacement_px(one, px_per_m)).fold(0.0, f32::max)
            };
            all.push([px(CLOSE_PX * FULLY_CLOSE), px(2000.0)]);
        }
    }
    let most_px = all.iter().map(|px| px[0]).fold(0.0, f32::max);
    // Closeness grows by at most 1.5 over the range, 0.5 of the height: in one frame in which a plant grows by 1 %, by 0.03 to 0.045.
    let largest_step = 0.045 * most_px;
    assert!((0.5..12.0).contains(&most_px), "{most_px} px of displacement");
    assert!(largest_step < 0.5, "{largest_step} px in a frame");
    // Parts of the curve are straight again: of a parabola, they depart by 1/16 as much.
    let mut parts: Vec<f32> = all.iter().map(|px| px[1] / (CURVE_PARTS * CURVE_PARTS) as f32).collect();
    parts.sort_by(f32::total_cmp);
    let [median, worst] = [parts[parts.len() / 2], parts[parts.len() - 1]];
    println!("displaced by {most_px} px, steps of {largest_step} px; at 2000 px, parts are {median} (median) to {worst} px off");
    assert!(parts[parts.len() * 9 / 10] < 0.5 && worst < 0.6, "{median} to {worst} px at 2000 px");
}

/// Pictures of a plant close up at high quality: in straight sections without veins, and as it is drawn. `away` is the distance of the eye aside, and its
/// height, relative to the size of the plant.
fn pictures(gpu: &Gpu, name: &str, away: [f32; 2], size_px: [u32; 2]) -> Option<[Vec<u8>; 2]> {
    let mut mirror = meadow_of(
        |scene: &mut Scene| {
            scene.wind.mean_m_per_s = [0.0; 2];
            scene.growth.richness = [1.0; 3];
            scene.plants.height_m = 0.05;
            scene.underbrush = species().into_iter().filter(|species| species.name == name).collect();
        },
        &[21; 256],
    );
    let flora = mirror.decoded_scene().and_then(DecodedScene::flora)?;
    let middle = |at_m: [f32; 2]| (at_m[0] - 32.0).hypot(at_m[1] - 32.0);
    let instances = flora.grown().plants().iter().map(|plant| flora.instance(plant));
    let plant = instances.min_by(|a, b| middle(a.at_m).total_cmp(&middle(b.at_m)))?;
    let tall_m = height_m(&flora.species()[plant.species]).max(0.5 * flora::reach_m(&flora.species()[plant.species])) * plant.size;
    let [aside_m, above_m] = away.map(|part| part * tall_m);
    let eye_m = Vec3::new(plant.at_m[0], above_m, plant.at_m[1] + aside_m);
    let camera = Camera { eye_m, heading_rad: 0.0, pitch_rad: (0.05 * tall_m - above_m).atan2(aside_m), ..Camera::default() };
    let mut picture = OffscreenRenderer::new(gpu, size_px, Quality::High);
    picture.draw(&mut mirror, &camera, 2.0, 0.0);
    Some([NEVER_PX, CLOSE_PX].map(|close_px| {
        let brush = picture.renderer.scene.as_mut().and_then(|scene| scene.underbrush.as_mut());
        brush.expect("underbrush").close_px = close_px;
        picture.draw(&mut mirror, &camera, 2.0, 0.0);
        picture.rgba()
    }))
}

#[test]
fn close_ups_change_plants_but_not_their_mean_colour() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let [straight, close] = pictures(&gpu, "poppy", [0.15, 0.45], [160, 160]).expect("poppies");
    let pixels = straight.chunks_exact(4).zip(close.chunks_exact(4));
    let changed = pixels.filter(|(a, b)| (0..3).any(|i| a[i].abs_diff(b[i]) > 4)).count();
    assert!(changed > 160 * 160 / 50, "{changed} pixels differ");
    let mean = |rgba: &[u8], i: usize| rgba.chunks_exact(4).map(|px| f32::from(px[i])).sum::<f32>() / (160.0 * 160.0);
    for channel in 0..3 {
        let [before, after] = [mean(&straight, channel), mean(&close, channel)];
        assert!((after / before - 1.0).abs() < 0.01, "{before} to {after} of channel {channel}");
    }
}
