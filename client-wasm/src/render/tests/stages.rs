//! Loading a scene in stages.

use super::underbrush::grasses;
use super::*;
use crate::render::{Renderer, Stage};

const SIZE_PX: [u32; 2] = [96, 64];
const QUALITY: Quality = Quality::Low;

/// A rainy meadow with underbrush and a row of trees.
fn garden() -> Mirror {
    let mut covering = [255; 16 * 16];
    covering[16 * 4..16 * 5].fill(253);
    meadow_of(|scene| (scene.rain.rate_mm_per_h, scene.underbrush) = (30.0, grasses()), &covering)
}

/// The picture at a moment, with every plant at rest.
fn pixels(picture: &mut OffscreenRenderer, mirror: &mut Mirror) -> Vec<u8> {
    let camera = Camera { eye_m: Vec3::new(32.0, 1.6, 44.0), pitch_rad: -0.1, ..Camera::default() };
    picture.draw(mirror, &camera, 1.0, 0.0);
    picture.rgba()
}

/// Fraction of the channels of two pictures that differ by more than 2 %.
fn changed(a: &[u8], b: &[u8]) -> f64 {
    a.iter().zip(b).filter(|(a, b)| a.abs_diff(**b) > 5).count() as f64 / a.len() as f64
}

#[test]
fn each_stage_adds_to_the_picture_and_the_last_completes_it() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let mut mirror = garden();
    let mut picture = OffscreenRenderer::new(&gpu, SIZE_PX, QUALITY);
    let whole = pixels(&mut picture, &mut mirror);

    let (land, verdict) = Renderer::with_land(&gpu, wgpu::TextureFormat::Rgba8UnormSrgb, SIZE_PX, QUALITY, &mirror);
    pollster::block_on(verdict).expect("land and sky fit");
    picture.renderer = land;
    let mut pictures = vec![pixels(&mut picture, &mut mirror)];
    let mut stages = vec![Stage::Land];
    while let Some((next, verdict)) = picture.renderer.create_next_stage(&mirror) {
        pollster::block_on(verdict).expect("it fits");
        picture.renderer.add(next);
        pictures.push(pixels(&mut picture, &mut mirror));
        stages.extend(picture.renderer.stage(&mirror).map(|(stage, _)| stage));
    }
    assert_eq!(stages, Stage::ALL);
    for (stage, pair) in stages[1..].iter().zip(pictures.windows(2)) {
        let changed = changed(&pair[0], &pair[1]);
        println!("{stage:?} changes {changed:.3} of the picture");
        assert!(changed > 0.002, "{stage:?} changes {changed} of the picture");
    }
    // The device lists plants in any order, and the rounding depends on it.
    let apart = changed(&whole, &pictures[pictures.len() - 1]);
    assert!(apart < 0.002, "{apart} of the picture differs from one that is loaded at once");
}

#[test]
fn a_dry_scene_without_underbrush_has_no_stages_for_them() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let mirror = meadow(4.0);
    let (mut renderer, _verdict) = Renderer::with_land(&gpu, wgpu::TextureFormat::Rgba8UnormSrgb, SIZE_PX, QUALITY, &mirror);
    let mut stages = 1;
    while let Some((next, _verdict)) = renderer.create_next_stage(&mirror) {
        renderer.add(next);
        stages += 1;
    }
    assert_eq!((stages, renderer.stage(&mirror)), (3, Some((Stage::Solids, true))));
}
