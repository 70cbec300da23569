//! The shade that grass casts, compared with its twin on the CPU and with rays traced through the drawn blades.

mod rays;

use super::*;
use crate::render::gpu::constants::{SHADE_CELL_M, SHADE_CELLS, SHADE_MAPS, SHADE_PX};
use half::f16;
use prairie_core::light::grass::LEAST_SUN_SINE;
use prairie_core::light::luminance;
use prairie_core::light::shade::{Column, LEAF_TOP, depth_toward_sun, leaf_area_above, stance, sun_on_seen};
use prairie_core::light::sun::Sun;
use rays::Strips;

const SIZE_PX: [u32; 2] = [256, 144];
/// Side of the squares over which the light of the picture is averaged (px): about a cell of the map of the shade, which resolves nothing finer.
const SQUARE_PX: usize = 16;
/// Greatest mean difference of the light from that of traced rays, relative to the mean light.
const BOUND: f64 = 0.05;

/// Where a meadow ends at bare ground, with a track of pressed grass along its border.
fn border() -> Mirror {
    let covering: Vec<u8> = (0..16 * 16).map(|n| if n % 16 < 9 && (5..11).contains(&(n / 16)) { 255 } else { 0 }).collect();
    let mut mirror = meadow_of(|scene| (scene.wind.mean_m_per_s, scene.plants.flowers_per_m2) = ([3.0, 0.0], 0.0), &covering);
    stream(&mut mirror, |x| if (34.3..34.9).contains(&x) { 1.4 } else { 0.0 }, 0.0);
    mirror
}

const CAMERA: Camera = Camera { eye_m: Vec3::new(35.0, 2.4, 34.2), heading_rad: 0.0, pitch_rad: -0.85, fov_rad: 0.8, target_m: None };

fn options(sun: Sun, grass_shadows: bool) -> RenderOptions {
    RenderOptions { sun: Some(sun), grass_shadows, culls: false, ..RenderOptions::default() }
}

/// Luminance of the pixels before tone mapping.
fn light(gpu: &Gpu, picture: &mut OffscreenRenderer, mirror: &mut Mirror, options: RenderOptions) -> Vec<f64> {
    picture.set_options(options);
    picture.draw(mirror, &CAMERA, 0.0, 0.0);
    let [width, height] = SIZE_PX;
    let size = u64::from(width * height) * 8;
    let buffer = gpu.empty_buffer("light", size, wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC);
    let color = picture.renderer.targets.color.texture();
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(width * 8), rows_per_image: Some(height) };
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    encoder.copy_texture_to_buffer(color.as_image_copy(), wgpu::TexelCopyBufferInfo { buffer: &buffer, layout }, color.size());
    gpu.queue.submit([encoder.finish()]);
    let bytes = read(gpu, &buffer);
    let halves: &[[u16; 4]] = bytemuck::cast_slice(&bytes);
    halves.iter().map(|&[r, g, b, _]| f64::from(luminance([r, g, b].map(|half| f16::from_bits(half).to_f32())))).collect()
}

/// The light if the optical depth of the grass were the same everywhere.
fn light_at_depth(gpu: &Gpu, picture: &mut OffscreenRenderer, mirror: &mut Mirror, sun: Sun, depth: f32) -> Vec<f64> {
    let shade = picture.renderer.scene.as_mut().and_then(|scene| scene.shade_map.as_mut()).expect("shadows of grass");
    let texel = [1.0, depth.sqrt(), depth.sqrt(), depth.sqrt()].map(|v| f16::from_f32(v).to_bits());
    gpu.queue.write_buffer(&shade.texels, 0, bytemuck::cast_slice(&vec![texel; (SHADE_MAPS * SHADE_CELLS) as usize]));
    shade.is_given = true;
    let light = light(gpu, picture, mirror, options(sun, true));
    picture.renderer.scene.as_mut().and_then(|scene| scene.shade_map.as_mut()).expect("shadows of grass").is_given = false;
    light
}

/// Means over squares of the picture.
fn averaged(light: &[f64]) -> Vec<f64> {
    let [width, height] = SIZE_PX.map(|px| px as usize);
    let squares = (0..height / SQUARE_PX).flat_map(|z| (0..width / SQUARE_PX).map(move |x| [x * SQUARE_PX, z * SQUARE_PX]));
    let sum = |[x, y]: [usize; 2]| (y..y + SQUARE_PX).map(|row| light[row * width + x..][..SQUARE_PX].iter().sum::<f64>()).sum::<f64>();
    squares.map(|corner| sum(corner) / (SQUARE_PX * SQUARE_PX) as f64).collect()
}

/// Mean difference of two pictures' light relative to the mean of the second.
fn difference(light: &[f64], reference: &[f64]) -> f64 {
    let [a, b] = [light, reference].map(averaged);
    a.iter().zip(&b).map(|(a, b)| (a - b).abs()).sum::<f64>() / b.iter().sum::<f64>()
}

#[test]
fn shade_of_grass_is_that_of_rays_traced_through_the_drawn_blades() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let mut mirror = border();
    let mut picture = OffscreenRenderer::new(&gpu, SIZE_PX, Quality::Medium);
    let mut strips = None;
    for (heading_rad, elevation_rad) in [(1.2, 0.25), (-2.0, 0.9)] {
        let sun = Sun { heading_rad, elevation_rad };
        let shaded = light(&gpu, &mut picture, &mut mirror, options(sun, true));
        let by_height = light(&gpu, &mut picture, &mut mirror, options(sun, false));
        let lit = light_at_depth(&gpu, &mut picture, &mut mirror, sun, 0.0);
        let dark = light_at_depth(&gpu, &mut picture, &mut mirror, sun, 400.0);
        let strips = strips.get_or_insert_with(|| Strips::drawn(&gpu, &picture, CAMERA.eye_m));
        let visible = strips.sun_visible(&CAMERA, SIZE_PX, Vec3::from(sun.direction()));
        let traced: Vec<_> = lit.iter().zip(&dark).zip(&visible).map(|((lit, dark), &sees)| if sees { *lit } else { *dark }).collect();
        let [shaded, by_height, lit] = [shaded, by_height, lit].map(|light| difference(&light, &traced));
        let sunny = visible.iter().filter(|&&sees| sees).count() as f64 / visible.len() as f64;
        println!(
            "sun at {elevation_rad} rad, {sunny:.3} of the picture in it: {shaded:.4} with shadows, {by_height:.4} by height alone, {lit:.4} without any"
        );
        assert!(shaded < BOUND, "{shaded} with the sun at {elevation_rad} rad");
        assert!(by_height > BOUND && lit > BOUND, "the bound tells nothing: {by_height} by height alone, {lit} without any shade");
    }
}

#[test]
fn formulas_of_the_shade_equal_their_cpu_twins() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let mut picture = OffscreenRenderer::new(&gpu, [16, 16], Quality::Low);
    let places: Vec<_> =
        (0..64u32).map(|n| hash3([n, 4, 2]).map(unit)).map(|[a, b, c]| [2.6 * a - 1.3, 2.6 * b - 1.3, 1.5 * c, 0.0]).collect();
    let body = "return vec4<f32>(stance(at.xy, at.z), leaf_area_above(at.z), 0.0);";
    let depths =
        [[0.3, 0.5, 4.0], [0.6, 4.0, 0.1], [1.5, 0.0, 3.0], [8.0, 4.0, 9.0], [25.0, 15.0, 1.0]].map(|[eye, x, y]| [eye, x, y, 0.0]);
    let body_of_seen = "return vec4<f32>(sun_on_seen(at.x, at.yz), height_below(leaf_area_above(0.4)), 0.0);";
    for elevation_rad in [-0.2, 0.3, 1.2] {
        let sun = Sun { heading_rad: 0.7, elevation_rad };
        picture.set_options(options(sun, true));
        picture.draw(&mut meadow(0.0), &Camera::default(), 0.0, 0.0);
        for (&[x, z, droop, _], found) in places.iter().zip(probe(&gpu, &picture, body, &places)) {
            let [height, depth] = stance([x, z], droop, sun.direction());
            for (found, wanted) in found.iter().zip([height, depth, leaf_area_above(droop)]) {
                assert!((found - wanted).abs() < 2e-4 * wanted.max(1.0), "{found} instead of {wanted} at {x}, {z}, {droop}");
            }
        }
        for (&[eye, x, y, _], found) in depths.iter().zip(probe(&gpu, &picture, body_of_seen, &depths)) {
            let wanted = [sun_on_seen(eye, x)[0], sun_on_seen(eye, y)[1], 0.4];
            assert!(wanted.iter().zip(found).all(|(a, b)| (a - b).abs() < 2e-4), "{found:?} instead of {wanted:?} at {eye}, {x}, {y}");
        }
    }
}

#[test]
fn rays_through_the_sward_equal_their_cpu_twins() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let sun = Sun { heading_rad: 1.2, elevation_rad: 0.3 };
    let mut mirror = border();
    let mut picture = OffscreenRenderer::new(&gpu, [16, 16], Quality::Low);
    picture.set_options(options(sun, true));
    picture.draw(&mut mirror, &CAMERA, 0.0, 0.0);
    // Cells on both sides of the track and of the border, and in the coarse map beyond the fine one.
    rays_equal_their_twins(&gpu, &picture, sun, 0, |n| [68 + n % 30, 74 + n / 6]);
    rays_equal_their_twins(&gpu, &picture, sun, 1, |n| [46 + n % 15, 80 + n / 4]);
}

/// Compares the depths of a map with those of rays through its columns, in 60 cells at three heights.
fn rays_equal_their_twins(gpu: &Gpu, picture: &OffscreenRenderer, sun: Sun, map: usize, cell: impl Fn(usize) -> [usize; 2]) {
    let (cell_m, side) = (SHADE_CELL_M[map], SHADE_PX as usize);
    let corner = [CAMERA.eye_m.x, CAMERA.eye_m.z].map(|m| ((m / cell_m).floor() - 0.5 * SHADE_PX as f32) * cell_m);
    let place = |cell: [usize; 2]| [0, 1].map(|axis| corner[axis] + (cell[axis] as f32 + 0.5) * cell_m);
    let places: Vec<_> = (0..side * side).map(|n| place([n % side, n / side])).map(|[x, z]| [x, z, map as f32, 0.0]).collect();
    let body =
        "let column = column_at(at.xy, u32(at.z)); return vec4<f32>(column.ground_m, column.height_m, column.depth, frame.shade_top_m);";
    let columns = probe_in(gpu, picture, "land_and_sky/shade_map", body, &places);
    let column = |x: i32, z: i32| {
        let [x, z] = [x, z].map(|n| n.clamp(0, side as i32 - 1) as usize);
        let [ground_m, height_m, depth, _] = columns[z * side + x];
        Column { ground_m, height_m, depth }
    };
    let cases: Vec<_> = (0..60).map(|n| (cell(n), 0.5 * (n % 3) as f32 * LEAF_TOP)).collect();
    let body = "return vec4<f32>(mapped_depth(shade_at(at.xy), at.z), 0.0, 0.0, 0.0);";
    let places: Vec<_> = cases.iter().map(|&(cell, height)| (place(cell), height)).map(|([x, z], height)| [x, z, height, 0.0]).collect();
    let [toward_x, _, toward_z] = sun.direction();
    let level = toward_x.hypot(toward_z);
    let mut deepest = 0.0_f32;
    for ((cell, height), [found, ..]) in cases.into_iter().zip(probe(gpu, picture, body, &places)) {
        let [x, z] = cell.map(|n| n as f32 + 0.5);
        let own = column(cell[0] as i32, cell[1] as i32);
        let away = |m: f32| [x + toward_x / level * (m / cell_m), z + toward_z / level * (m / cell_m)].map(|v| v as i32);
        let toward = |m: f32| column(away(m)[0], away(m)[1]);
        let wanted =
            depth_toward_sun(toward, own.ground_m + height * own.height_m, columns[0][3], sun.elevation_rad.sin().max(LEAST_SUN_SINE));
        assert!((found - wanted).abs() < 0.01 * wanted.max(1.0), "{found} instead of {wanted} at {cell:?} of map {map}, {height}");
        deepest = deepest.max(wanted);
    }
    assert!(deepest > 2.0, "{deepest} at most");
}

/// Median time of a frame with shadows of grass relative to one without, drawn in turns.
#[test]
#[ignore = "measures time; cargo nextest run --release -p prairie-client --run-ignored only -E 'test(shadows_of_grass_take)' --no-capture"]
fn shadows_of_grass_take_at_most_fifteen_percent_of_a_frame() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let mut mirror = meadow(5.0);
    let mut picture = OffscreenRenderer::new(&gpu, [640, 360], Quality::Medium);
    let camera = Camera { eye_m: Vec3::new(32.0, 1.8, 50.0), pitch_rad: -0.15, ..Camera::default() };
    let mut secs = [Vec::new(), Vec::new()];
    for frame in 0..32 {
        let shadows = frame % 2 == 1;
        picture.set_options(RenderOptions { grass_shadows: shadows, ..RenderOptions::default() });
        let start = std::time::Instant::now();
        picture.draw(&mut mirror, &camera, f64::from(frame / 2) / 30.0, 1.0 / 60.0);
        secs[usize::from(shadows)].push(start.elapsed().as_secs_f64());
    }
    let [without, with] = secs.map(|mut secs| {
        secs.drain(..2);
        secs.sort_by(f64::total_cmp);
        secs[secs.len() / 2]
    });
    println!("{with:.4} s with shadows of grass, {without:.4} s without: {:.3}", with / without);
    assert!(with < 1.15 * without, "{with} s with shadows of grass, {without} s without");
}
