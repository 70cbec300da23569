//! Grass in the lee of a boulder, near and far.

use super::*;
use crate::render::gpu::constants::CLUMP_PLANTS;
use crate::render::gpu::uniforms::ClumpList;
use crate::render::options::render_options::{FarPlants, RenderOptions};
use crate::render::solids::trees_and_stones;
use prairie_core::scene::PlantCover;
use std::collections::HashMap;

/// A flat meadow in a wind of 8 m/s along X, and the same with a boulder of 6 m, and its position.
fn windy_meadows(cover: PlantCover) -> (Mirror, Mirror, Vec3) {
    let meadow = |covering: &[u8]| {
        let windy = |scene: &mut Scene| {
            (scene.wind.mean_m_per_s, scene.plants.stone_m, scene.plants.cover) = ([8.0, 0.0], 6.0, cover);
        };
        meadow_of(windy, covering)
    };
    let mut covering = [255; 16 * 16];
    let plain = meadow(&covering);
    covering[7 + 16 * 7] = 254;
    let stony = meadow(&covering);
    let at_m = trees_and_stones::placed_models(stony.decoded_scene().expect("a scene")).first().map(|stone| stone.position_m);
    (plain, stony, at_m.expect("a boulder"))
}

/// Places of plants (m), and how far they lean along the wind, by the bits of their places.
type Leans = HashMap<[u32; 2], ([f32; 2], f32)>;

/// Lean of more than `least` plants at places relative to `at_m`, over that of the same ones in the open.
fn fraction_of_lean(stony: &Leans, open: &Leans, at_m: Vec3, least: u32, is_there: fn(f32, f32) -> bool) -> f32 {
    let both = stony.iter().filter_map(|(root, ([x, z], lean))| is_there(x - at_m.x, z - at_m.z).then_some((lean, open.get(root)?.1)));
    let (found, open, count) = both.fold((0.0, 0.0, 0), |sum, (found, open)| (sum.0 + found, sum.1 + open, sum.2 + 1));
    assert!(count > least, "{count} plants");
    found / open
}

/// Lean of the tip of each drawn blade along the wind, by its root, after a second and a half below a camera.
fn leaning(gpu: &Gpu, mirror: &mut Mirror) -> Leans {
    let mut picture = OffscreenRenderer::new(gpu, [400; 2], Quality::Low);
    let camera = Camera { eye_m: Vec3::new(32.0, 8.0, 32.0), pitch_rad: -1.57, fov_rad: 1.9, ..Camera::default() };
    (0..15).for_each(|_| {
        picture.draw(mirror, &camera, 0.0, 0.1);
    });
    let blades = picture.renderer.scene.as_ref().and_then(|scene| scene.blades.as_ref()).expect("grass");
    let counters: Vec<u32> = bytemuck::pod_collect_to_vec(&read(gpu, &blades.listed.counters));
    let rows: Vec<[f32; 28]> = bytemuck::pod_collect_to_vec(&read(gpu, &blades.listed.blades));
    // Root, and tip relative to it, of the fine and the coarse blades.
    let [fine, coarse] = [rows.iter().take(counters[0] as usize), rows[blades.capacities[0] as usize..].iter().take(counters[1] as usize)];
    let lean = |row: &[f32; 28]| ([row[0].to_bits(), row[2].to_bits()], ([row[0], row[2]], row[12].atan2(row[13])));
    fine.chain(coarse).map(lean).collect()
}

#[test]
fn grass_behind_a_boulder_leans_less_than_beside_it() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let (mut plain, mut stony, at_m) = windy_meadows(PlantCover::Blades);
    let [open, stony] = [&mut plain, &mut stony].map(|mirror| leaning(&gpu, mirror));
    let fraction = |is_there: fn(f32, f32) -> bool| fraction_of_lean(&stony, &open, at_m, 30, is_there);
    let behind = fraction(|x, z| (3.5..6.0).contains(&x) && z.abs() < 1.0);
    let beside = fraction(|x, z| x.abs() < 4.0 && (6.0..12.0).contains(&z.abs()));
    println!("{behind} behind, {beside} beside");
    assert!(behind < 0.7 && (0.95..1.05).contains(&beside), "of the lean in the open {behind} behind a boulder, {beside} beside it");
}

/// Wind (m/s) along X that moves shells at places relative to `at_m`, after a second and a half.
fn wind_on_shells(gpu: &Gpu, mirror: &mut Mirror, at_m: Vec3, places: &[[f32; 2]]) -> Vec<f32> {
    let mut picture = OffscreenRenderer::new(gpu, [64; 2], Quality::Low);
    let camera = Camera { eye_m: Vec3::new(32.0, 8.0, 32.0), pitch_rad: -1.57, ..Camera::default() };
    (0..15).for_each(|_| {
        picture.draw(mirror, &camera, 0.0, 0.1);
    });
    let cases: Vec<_> = places.iter().map(|[x, z]| [at_m.x + x, 0.0, at_m.z + z, 0.0]).collect();
    let found = probe_in(gpu, &picture, "plants/shells", "return vec4<f32>(wind_held(at.xyz), 0.0, 0.0);", &cases);
    found.into_iter().map(|[along, ..]| along).collect()
}

#[test]
fn shells_feel_the_lee_of_a_boulder() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let (mut plain, mut stony, at_m) = windy_meadows(PlantCover::Shells);
    let places = [[4.5, 0.0], [0.0, 9.0]];
    let [open, stony] = [&mut plain, &mut stony].map(|mirror| wind_on_shells(&gpu, mirror, at_m, &places));
    let [behind, beside] = [0, 1].map(|n| stony[n] / open[n]);
    assert!(behind < 0.8 && (0.95..1.05).contains(&beside), "of the wind in the open {behind} behind a boulder, {beside} beside it");
}

/// Displacement of the tops of clumps along the wind over their height, by their roots, after a second and a half.
fn leaning_clumps(gpu: &Gpu, mirror: &mut Mirror) -> Leans {
    let mut picture = OffscreenRenderer::new(gpu, [200; 2], Quality::Low);
    picture.set_options(RenderOptions { far_plants: FarPlants::Clumps, culls: false, ..RenderOptions::default() });
    let camera = Camera { eye_m: Vec3::new(32.0, 1.7, 78.0), ..Camera::default() };
    (0..15).for_each(|_| {
        picture.draw(mirror, &camera, 0.0, 0.1);
    });
    let billboards = picture.renderer.scene.as_ref().and_then(|scene| scene.billboards.as_ref()).expect("clumps");
    let list: ClumpList = bytemuck::pod_read_unaligned(&read(gpu, &billboards.buffers.list));
    let clumps: Vec<[f32; 4]> = bytemuck::pod_collect_to_vec(&read(gpu, &billboards.buffers.clumps));
    let poses: Vec<[f32; 16]> = bytemuck::pod_collect_to_vec(&read(gpu, &billboards.buffers.poses));
    let joints: Vec<[f32; 4]> = bytemuck::pod_collect_to_vec(&read(gpu, &billboards.buffers.joints));
    // The top of the lowest segment of the plant on the axis: its displacement along the wind, and its height.
    let lowest = |number: u32| {
        let (segments, single) = (list.several_segments, number.saturating_sub(list.several));
        joints[((number.min(list.several) * segments + single) * CLUMP_PLANTS) as usize]
    };
    let shown = (0..list.count).zip(clumps).zip(poses).filter(|(_, pose)| pose[2] > 0.0);
    let lean = |number: u32| lowest(number)[0].atan2(lowest(number)[1]);
    shown.map(|((number, [x, z, ..]), _)| ([x.to_bits(), z.to_bits()], ([x, z], lean(number)))).collect()
}

#[test]
fn clumps_feel_the_lee_of_a_boulder() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let (mut plain, mut stony, at_m) = windy_meadows(PlantCover::Blades);
    let [open, stony] = [&mut plain, &mut stony].map(|mirror| leaning_clumps(&gpu, mirror));
    let fraction = |is_there: fn(f32, f32) -> bool| fraction_of_lean(&stony, &open, at_m, 3, is_there);
    let behind = fraction(|x, z| (3.0..10.0).contains(&x) && z.abs() < 2.5);
    let beside = fraction(|x, z| x.abs() < 5.0 && (6.0..14.0).contains(&z.abs()));
    println!("{behind} behind, {beside} beside");
    assert!(behind < 0.9 && (0.95..1.05).contains(&beside), "of the lean in the open {behind} behind a boulder, {beside} beside it");
}
