use super::shaders;
use super::uniforms::{Frame, Plants};
use super::{Gpu, Picture, Quality};
use crate::camera::Camera;
use crate::state::Mirror;
use glam::Vec3;
use shared::scene::{Grass, Patches, Scene, TerrainMaps, Wind};
use shared::terrain::grey_png;
use shared::wire::quantise::{omega_code, theta_code};
use shared::wire::{ServerMessage, codec};
use wgpu::naga;

fn module(source: &str) -> naga::Module {
    let text = shaders::whole(source);
    let module = naga::front::wgsl::parse_str(&text).unwrap_or_else(|error| panic!("{}", error.emit_to_string(&text)));
    let mut validator = naga::valid::Validator::new(naga::valid::ValidationFlags::all(), naga::valid::Capabilities::empty());
    if let Err(error) = validator.validate(&module) {
        panic!("{}", error.emit_to_string(&text));
    }
    module
}

#[test]
fn every_shader_is_valid_wgsl_without_extensions() {
    for source in [
        shaders::BEND,
        shaders::BLADES,
        shaders::FLOWERS,
        shaders::BILLBOARDS,
        shaders::TERRAIN,
        shaders::OBJECTS,
        shaders::SKY,
        shaders::TONE,
    ] {
        module(source);
    }
}

fn assert_twins(module: &naga::Module, name: &str, layout: &[(&str, usize)], size: usize) {
    let (_, twin) = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some(name)).expect("the twin is there");
    let naga::TypeInner::Struct { members, span } = &twin.inner else { panic!("{name} is no struct") };
    let found: Vec<_> = members.iter().map(|member| (member.name.as_deref().unwrap_or_default(), member.offset as usize)).collect();
    assert_eq!(found, layout, "{name}");
    assert_eq!(*span as usize, size, "{name}");
}

#[test]
fn uniform_blocks_lie_as_their_twins() {
    let module = module(shaders::BEND);
    assert_twins(&module, "Frame", Frame::LAYOUT, size_of::<Frame>());
    assert_twins(&module, "Plants", Plants::LAYOUT, size_of::<Plants>());
}

/// A flat meadow of 64 m in a wind towards the east.
fn meadow(wind_m_per_s: f32) -> Mirror {
    let maps = TerrainMaps { height_map: String::new(), covering_map: String::new(), pixel_m: [4.0, 4.0], level_m: 0.0, base_m: 0.0 };
    let scene = Scene {
        summary: String::new(),
        seed: 1,
        tick_hz: 60.0,
        patches: Patches { count: [4, 4], ..Patches::default() },
        terrain: maps,
        wind: Wind { mean_m_per_s: [wind_m_per_s, 0.0], ..Wind::default() },
        grass: Default::default(),
        plants: Default::default(),
        objects: Default::default(),
        camera: Default::default(),
        light: Default::default(),
    };
    let mut mirror = Mirror::default();
    let scene = ServerMessage::Scene {
        scene: Box::new(scene),
        height_png: grey_png([17; 2], &[0; 17 * 17]),
        covering_png: grey_png([16; 2], &[255; 16 * 16]),
        models: Vec::new(),
    };
    mirror.apply(scene).expect("a sound scene");
    mirror
}

/// Streams a field that leans eastward by `theta_rad` everywhere.
fn stream_lean(mirror: &mut Mirror, theta_rad: f32) {
    let plane = |code: i8| std::iter::repeat_n(code, 64 * 64);
    let codes: Vec<i8> = plane(theta_code(theta_rad)).chain(plane(omega_code(2.5 * theta_rad))).chain(plane(0)).collect();
    for patch in 0..16 {
        let payload = codec::encode(64, &codes, None);
        mirror.apply(ServerMessage::Patch { patch, seq: 1, key: true, payload }).expect("a sound patch");
    }
}

/// Tips of the near blades after a second in a wind, as offsets from their roots (m).
fn tips(gpu: &Gpu, wind_m_per_s: f32, streamed_rad: Option<f32>) -> Vec<Vec3> {
    let mut mirror = meadow(wind_m_per_s);
    let mut picture = Picture::new(gpu, [16, 16], Quality::Low);
    let camera = Camera { eye_m: Vec3::new(32.0, 2.2, 40.0), pitch_rad: -0.15, ..Camera::default() };
    for frame in 0..30 {
        if let Some(theta_rad) = streamed_rad.filter(|_| frame == 0) {
            stream_lean(&mut mirror, theta_rad);
        }
        picture.draw(&mut mirror, &camera, 0.0, 1.0 / 30.0);
    }
    let postures = &picture.renderer.scene.as_ref().expect("a scene").blades.postures;
    let read = gpu.empty_buffer("read", postures.size(), wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST);
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    encoder.copy_buffer_to_buffer(postures, 0, &read, 0, postures.size());
    gpu.queue.submit([encoder.finish()]);
    read.slice(..).map_async(wgpu::MapMode::Read, |_| {});
    gpu.device.poll(wgpu::PollType::wait_indefinitely()).expect("the device is there");
    let bytes = read.slice(..).get_mapped_range().expect("the buffer is mapped");
    let points: &[[[f32; 4]; 6]] = bytemuck::cast_slice(&bytes);
    points.iter().map(|[_, _, tip, ..]| Vec3::new(tip[0], tip[1], tip[2])).collect()
}

/// Mean angle of the tips eastward from upright (rad).
fn lean_rad(tips: &[Vec3]) -> f32 {
    tips.iter().map(|tip| tip.x.atan2(tip.y)).sum::<f32>() / tips.len() as f32
}

#[test]
fn near_blades_lean_by_what_the_wind_and_the_field_hold_together() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let bend_rad = Grass::default().wind_bend_rad;
    let leans = |wind_m_per_s: f32, streamed_rad: Option<f32>| lean_rad(&tips(&gpu, wind_m_per_s, streamed_rad));
    let still_rad = leans(0.0, None);
    // At 28 m/s even the lulls between gusts blow with more than the 10 m/s at which grass bends no further.
    for (wind_m_per_s, streamed_rad, held_rad) in [(28.0, None, bend_rad), (0.0, Some(0.4), 0.4), (28.0, Some(0.3), bend_rad + 0.3)] {
        let lean_rad = leans(wind_m_per_s, streamed_rad) - still_rad;
        assert!((lean_rad - held_rad).abs() < 0.1 * held_rad, "{lean_rad} rad where {held_rad} rad are held");
    }
}

#[test]
fn near_blades_lean_with_the_square_of_a_weak_wind() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let leans = [0.0, 2.0, 4.0].map(|wind_m_per_s| lean_rad(&tips(&gpu, wind_m_per_s, None)));
    let ratio = (leans[2] - leans[0]) / (leans[1] - leans[0]);
    assert!((ratio - 4.0).abs() < 0.5, "twice the wind leans {ratio} times as far: {leans:?}");
}
