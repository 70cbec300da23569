//! Devices with low limits, and split pictures.

use super::{meadow_of, module};
use crate::camera::Camera;
use crate::render::Renderer;
use crate::render::gpu::device::Gpu;
use crate::render::gpu::error::GpuError;
use crate::render::gpu::limits::{fit_within_px, needed};
use crate::render::gpu::shaders;
use crate::render::offscreen::OffscreenRenderer;
use crate::render::options::quality::Quality;
use crate::render::options::render_options::RenderOptions;
use crate::render::options::split::{SideOptions, Split};
use crate::state::Mirror;
use glam::Vec3;
use prairie_core::scene::Scene;

fn device(allowed: &wgpu::Limits) -> Result<Gpu, GpuError> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default())).expect("a Vulkan adapter");
    pollster::block_on(Gpu::within(&adapter, allowed))
}

fn meadow(change: impl FnOnce(&mut Scene)) -> Mirror {
    meadow_of(change, &[255; 16 * 16])
}

fn fits(gpu: &Gpu, quality: Quality, mirror: &Mirror) -> Result<(), GpuError> {
    let (mut renderer, verdict) = Renderer::with_land(gpu, wgpu::TextureFormat::Rgba8UnormSrgb, [64, 36], quality, mirror);
    pollster::block_on(verdict)?;
    while let Some((next, verdict)) = renderer.create_next_stage(mirror) {
        pollster::block_on(verdict)?;
        renderer.add(next);
    }
    Ok(())
}

fn camera() -> Camera {
    Camera { eye_m: Vec3::new(32.0, 2.2, 40.0), pitch_rad: -0.15, ..Camera::default() }
}

#[test]
fn a_device_with_low_limits_draws_smaller_and_coarser() {
    let gpu = device(&needed()).expect("no more is needed");
    let mut mirror = meadow(|_| {});
    let finest = Quality::ALL.into_iter().rev().find(|&quality| fits(&gpu, quality, &mirror) == Ok(()));
    let quality = finest.expect("the coarsest picture fits into what is needed");
    assert_ne!(quality, Quality::Ultra);

    let size_px = fit_within_px([96, 4096], gpu.side_limit_px());
    assert_eq!(size_px, [48, 2048]);
    let mut picture = OffscreenRenderer::new(&gpu, size_px, quality);
    picture.draw(&mut mirror, &camera(), 0.0, 0.0);
    let rgba = picture.rgba();
    let sum = |row: usize, channel: usize| rgba[row * 48 * 4..][..48 * 4].chunks_exact(4).map(|px| u32::from(px[channel])).sum::<u32>();
    assert!(sum(99, 2) > sum(99, 0) && sum(1900, 1) > 2 * sum(1900, 2), "neither sky above nor grass below");
}

#[test]
fn scenes_that_fit_at_no_quality_are_rejected_with_the_limit() {
    let few = wgpu::Limits { max_storage_buffers_per_shader_stage: 4, ..wgpu::Limits::default() };
    let error = device(&few).expect_err("bend alone needs more");
    assert_eq!(error.to_string(), "the graphics adapter allows max_storage_buffers_per_shader_stage up to 4; Prairie needs 8");

    let gpu = device(&needed()).expect("no more is needed");
    let crowded = meadow(|scene| scene.plants.plants_per_side = 256);
    let error = fits(&gpu, Quality::Low, &crowded).expect_err("nine times 65536 blades are more than the buffers hold");
    let said = error.to_string();
    let numbers = said.split(|c: char| !c.is_ascii_digit()).filter_map(|digits| digits.parse::<u64>().ok());
    assert!(said.starts_with("the GPU cannot hold the scene in low quality: "), "{said}");
    assert!(
        numbers.clone().any(|number| number == 16 << 20) && numbers.max() > Some(16 << 20),
        "neither the limit nor what is needed: {said}"
    );
}

#[test]
fn shaders_stay_within_the_minimum_limits() {
    let most = needed().max_compute_invocations_per_workgroup;
    for source in [shaders::BEND, shaders::BILLBOARDS, shaders::UNDERBRUSH, shaders::DUST] {
        for entry in module(source).entry_points {
            assert!(entry.workgroup_size.iter().product::<u32>() <= most, "{}", entry.name);
        }
    }
}

#[test]
fn a_split_picture_equals_its_sides_drawn_alone() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let mut mirror = meadow(|_| {});
    let own = SideOptions { options: RenderOptions::default(), level: 0.0 };
    let ways = ["low", "medium"].map(|name| own.with("land").and_then(|way| way.with(name)).expect("a way"));
    let [low, medium] = ways.map(|way| {
        let mut picture = OffscreenRenderer::new(&gpu, SPLIT_PX, Quality::Medium);
        picture.set_options(way.options);
        picture.renderer.set_level(way.level);
        picture.draw(&mut mirror, &camera(), 1.0, 0.0);
        picture.rgba()
    });
    let apart = differing(&low, &medium, 0..SPLIT_PX[0]);
    assert!(apart > 0.2, "the ways hardly differ: {apart}");
    for at in [0.0, 0.25, 1.0] {
        let split = Split { sides: ways, border: at };
        let mut picture = OffscreenRenderer::new(&gpu, SPLIT_PX, Quality::Medium);
        picture.draw_split(&mut mirror, &camera(), 1.0, 0.0, &split);
        let rgba = picture.rgba();
        let [left, right] = split.columns(SPLIT_PX[0]);
        // Which of two plants at the same depth is visible depends on the order in which they are listed.
        for (whole, columns) in [(&low, left), (&medium, right)] {
            let apart = differing(&rgba, whole, columns.clone());
            assert!(apart < 0.02, "{apart} of columns {columns:?} at {at}");
        }
        assert_eq!(picture.renderer.options(), RenderOptions::default());
    }
}

const SPLIT_PX: [u32; 2] = [96, 54];

/// Fraction of the pixels in some columns that differ between two pictures.
fn differing(a: &[u8], b: &[u8], columns: std::ops::Range<u32>) -> f32 {
    let pixels = a.chunks_exact(4).zip(b.chunks_exact(4)).enumerate();
    let inside = pixels.filter(|(at, _)| columns.contains(&(*at as u32 % SPLIT_PX[0])));
    let (differing, all) = inside.fold((0, 0), |(differing, all), (_, (a, b))| (differing + u32::from(a != b), all + 1));
    differing as f32 / all.max(1) as f32
}
