//! Trees: extent while swaying, reach of their shadows, and light of their crowns.

use super::*;
use crate::render::solids::bounding_sphere::BoundingSphere;
use crate::render::solids::objects::{DISTANT_TREE_PX, FINE_TREE_PX};
use crate::render::solids::trees_and_stones::{PlacedKind, PlacedModel, TREE_SHAPES, TreeDetail, placed_models, tree};
use glam::Mat4;
use prairie_core::light::sun::Sun;
use std::f32::consts::PI;

#[test]
fn swaying_trees_stay_within_their_bounding_spheres() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let mut picture = OffscreenRenderer::new(&gpu, [16, 16], Quality::Low);
    // Even the lulls between gusts blow with more than 10 m/s.
    picture.draw(&mut meadow(28.0), &Camera::default(), 1.0, 0.0);
    let [size_m, tall_m, sway_rad] = [7.0, 7.4, 0.07];
    let body = format!(
        "let foot = vec4<f32>(at.w, 0.0, 32.0, 1.0);
        let scale = vec2<f32>({size_m:?}, {tall_m:?});
        let placing = mat4x4<f32>(vec4<f32>(scale.x, 0.0, 0.0, 0.0), vec4<f32>(0.0, scale.y, 0.0, 0.0), vec4<f32>(0.0, 0.0, scale.x, 0.0), foot);
        let vertex = Vertex(at.xyz, vec4<f32>(0.0), vec4<f32>(0.0), vec2<f32>(0.5));
        let tree = Instance(placing, vec3<f32>(1.0), {sway_rad:?}, NO_LIMBS, 0u, 0u, 0u);
        return vec4<f32>(placed(vertex, tree, sway_of(tree)), 0.0);"
    );
    for shape in 0..TREE_SHAPES {
        let solids = TreeDetail::ALL.map(|detail| tree(shape, detail));
        let model = BoundingSphere::around_meshes(solids.iter());
        let ball = |x: f32| {
            let position_m = Vec3::new(x, 0.0, 32.0);
            let placing = Mat4::from_translation(position_m) * Mat4::from_scale(Vec3::new(size_m, tall_m, size_m));
            let tint = [1.0, 1.0, 1.0, sway_rad];
            model.placed(&PlacedModel { position_m, shape, kind: PlacedKind::Tree, size_m, world_from_model: placing, tint })
        };
        let vertices = solids.iter().flat_map(|solid| &solid.vertices).enumerate();
        let places: Vec<[f32; 4]> = vertices
            .map(|(number, vertex)| [vertex.position[0], vertex.position[1], vertex.position[2], 20.0 + (number % 24) as f32])
            .collect();
        let mut farthest = 0.0_f32;
        for ([.., x], found) in places.iter().zip(probe_in(&gpu, &picture, "solids/objects", &body, &places)) {
            let ball = ball(*x);
            farthest = farthest.max(Vec3::from_slice(&found[..3]).distance(ball.centre_m) / ball.radius_m);
        }
        assert!((0.7..=1.0).contains(&farthest), "{farthest} of the radius of shape {shape}");
    }
}

#[test]
fn a_distant_tree_towards_a_low_sun_casts_its_shadow_near_the_camera() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let wide = |scene: &mut Scene| {
        (scene.patches.count, scene.terrain.pixel_m) = ([16, 16], [16.0; 2]);
        (scene.plants.tree_m, scene.wind.mean_m_per_s) = (40.0, [0.0; 2]);
    };
    let mut covering = [255; 16 * 16];
    // A tree within 3 m of (136, 88) m.
    covering[8 + 16 * 5] = 253;
    let mut mirror = meadow_of(wide, &covering);
    let camera = Camera { eye_m: Vec3::new(136.0, 2.0, 200.0), heading_rad: PI, ..Camera::default() };
    let places: Vec<_> = (0..81).map(|n| [132.0 + (n % 9) as f32, 0.5, 192.0 + 2.0 * (n / 9) as f32, 0.0]).collect();
    // The sun in the north, behind the tree, and in the south; with penumbras and without.
    let cases = [(0.0, true), (PI, true), (0.0, false), (PI, false)];
    let [darkest, lightest, hard_darkest, hard_lightest] = cases.map(|(heading_rad, soft)| {
        let mut picture = OffscreenRenderer::new(&gpu, [16, 16], Quality::Low);
        picture.set_options(RenderOptions { sun: Some(Sun { heading_rad, elevation_rad: 0.2 }), ..RenderOptions::default() });
        picture.draw(&mut mirror, &camera, 0.0, 0.0);
        let light = probe_with(&gpu, &picture, &[("soft_shadows", soft)], "return vec4<f32>(sun_visible(at.xyz));", &places);
        light.iter().map(|light| light[0]).fold(1.0, f32::min)
    });
    assert!(darkest < 0.3 && lightest == 1.0, "{darkest} behind the tree, {lightest} before it");
    assert!(hard_darkest < 0.3 && hard_lightest == 1.0, "without penumbras: {hard_darkest} behind the tree, {hard_lightest} before it");
}

/// Greatest change of the light of a tree where it becomes fine (fraction).
const LIGHT_STEP: f64 = 0.05;
/// The same where it is no longer distant: the 5 % that are the aim are missed there.
const DISTANT_LIGHT_STEP: f64 = 0.12;

/// Mean luminance about the middle of a crown, with what is seen between its leaves, from three places beside each other.
fn light_of_crown(picture: &mut OffscreenRenderer, mirror: &mut Mirror, tree: &PlacedModel, from_foot_m: f32) -> f64 {
    let [red, green, blue] = rgb_of_crown(picture, mirror, tree, from_foot_m);
    0.2126 * red + 0.7152 * green + 0.0722 * blue
}

/// Mean linear colour in the middle of a crown, over three headings.
fn rgb_of_crown(picture: &mut OffscreenRenderer, mirror: &mut Mirror, tree: &PlacedModel, from_foot_m: f32) -> [f64; 3] {
    let middle_m = tree.position_m + Vec3::Y * 0.6 * tree.size_m;
    let distance_m = (from_foot_m * from_foot_m - (middle_m.y - tree.position_m.y).powi(2)).sqrt();
    let half_px = (0.25 * tree.size_m / distance_m / (0.5 * Camera::default().fov_rad).tan() * 0.5 * APPROACH_PX[1] as f32) as u32;
    let [left, top] = APPROACH_PX.map(|side| side / 2 - half_px);
    let linear = |level: u8| (f64::from(level) / 255.0).powf(2.2);
    let mut sums = [0.0; 3];
    for heading_rad in [-0.1, 0.0, 0.1_f32] {
        let eye_m = middle_m + distance_m * Vec3::new(-heading_rad.sin(), 0.0, heading_rad.cos());
        let camera = Camera { eye_m, heading_rad, ..Camera::default() };
        // The force field of the wind about the camera settles in the first frame.
        for _ in 0..2 {
            picture.draw(mirror, &camera, 0.0, 0.0);
        }
        let rgba = picture.rgba();
        let pixels = (top..top + 2 * half_px).flat_map(|y| (left..left + 2 * half_px).map(move |x| 4 * (y * APPROACH_PX[0] + x) as usize));
        for at in pixels {
            sums = std::array::from_fn(|channel| sums[channel] + linear(rgba[at + channel]));
        }
    }
    sums.map(|sum| sum / f64::from(12 * half_px * half_px))
}

const APPROACH_PX: [u32; 2] = [400, 360];

/// A wide meadow with one tree, under snow of that depth (m).
fn lone_tree(snow_m: f32) -> (Mirror, PlacedModel) {
    let wide = |scene: &mut Scene| {
        (scene.patches.count, scene.terrain.pixel_m) = ([16, 16], [16.0; 2]);
        (scene.wind.mean_m_per_s, scene.snow.depth_m) = ([0.0; 2], snow_m);
        // Only the tree matters, and a meadow takes most of the time.
        scene.plants.plants_per_side = 2;
    };
    let mut covering = [255; 16 * 16];
    covering[8 + 16 * 5] = 253;
    let mirror = meadow_of(wide, &covering);
    let tree = placed_models(mirror.decoded_scene().expect("a scene"))[0];
    (mirror, tree)
}

fn under_sun(gpu: &Gpu, quality: Quality, heading_rad: f32, elevation_rad: f32) -> OffscreenRenderer {
    let mut picture = OffscreenRenderer::new(gpu, APPROACH_PX, quality);
    picture.set_options(RenderOptions { sun: Some(Sun { heading_rad, elevation_rad }), ..RenderOptions::default() });
    picture
}

/// Light of the crown just before and after the tree takes more than that height (pixels).
fn light_around(picture: &mut OffscreenRenderer, mirror: &mut Mirror, tree: &PlacedModel, quality: Quality, tall_px: f32) -> [f64; 2] {
    let finer_m = tree.size_m * APPROACH_PX[1] as f32 / (tall_px * Camera::default().fov_rad * quality.detail().coarser);
    [1.01, 0.99].map(|part| light_of_crown(picture, mirror, tree, part * finer_m))
}

/// Approaches a tree past each of its levels of detail, with the sun before and behind the camera.
#[test]
fn a_tree_keeps_its_light_where_it_becomes_finer() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let (mut mirror, tree) = lone_tree(0.0);
    // Control: the measure tells a sun 0.2 rad lower.
    let [light, lower] = [0.6, 0.4]
        .map(|elevation_rad| light_of_crown(&mut under_sun(&gpu, Quality::Low, PI, elevation_rad), &mut mirror, &tree, 3.0 * tree.size_m));
    assert!((lower / light - 1.0).abs() > LIGHT_STEP, "a lower sun: {light} and {lower}");
    let mut failures = Vec::new();
    for quality in [Quality::Low, Quality::Medium, Quality::High] {
        for heading_rad in [PI, 0.0] {
            let mut picture = under_sun(&gpu, quality, heading_rad, 0.6);
            for (tall_px, bound) in [(DISTANT_TREE_PX, DISTANT_LIGHT_STEP), (FINE_TREE_PX, LIGHT_STEP)] {
                let [before, after] = light_around(&mut picture, &mut mirror, &tree, quality, tall_px);
                let change = after / before - 1.0;
                println!("{quality:?}, sun at {heading_rad:.1}, {tall_px} px: {:.1} %; {before:.3} {after:.3}", 100.0 * change);
                if change.abs() > bound {
                    failures.push(format!("{quality:?}, sun at {heading_rad}, {tall_px} px: {change}"));
                }
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn a_crown_under_snow_is_white_and_keeps_its_light_where_it_becomes_finer() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    // Blue beside green: 1 in white.
    let blue_of = |picture: &mut OffscreenRenderer, mirror: &mut Mirror, tree: &PlacedModel| {
        let [_, green, blue] = rgb_of_crown(picture, mirror, tree, 3.0 * tree.size_m);
        blue / green
    };
    let [bare, white] = [0.0, 0.2].map(|snow_m| {
        let (mut mirror, tree) = lone_tree(snow_m);
        blue_of(&mut under_sun(&gpu, Quality::Low, PI, 0.6), &mut mirror, &tree)
    });
    assert!(1.0 - white < 0.5 * (1.0 - bare), "blue beside green: {bare} bare, {white} under snow");

    let (mut mirror, tree) = lone_tree(0.2);
    let mut picture = under_sun(&gpu, Quality::Medium, PI, 0.6);
    let [afar, near] = light_around(&mut picture, &mut mirror, &tree, Quality::Medium, DISTANT_TREE_PX);
    println!("blue beside green: {bare} bare, {white} under snow; light of the crown {afar}, then {near}");
    assert!((near / afar - 1.0).abs() < DISTANT_LIGHT_STEP, "{afar}, then {near}");
}
