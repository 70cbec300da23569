//! The map of the grids shows what the passes have culled.

use super::*;
use std::collections::BTreeSet;

/// Draws a hilly meadow and returns the numbers of grids by class.
fn counts(gpu: &Gpu, mirror: &mut Mirror, options: RenderOptions) -> (OffscreenRenderer, Vec<u32>) {
    let mut picture = OffscreenRenderer::new(gpu, [120, 280], Quality::Low);
    picture.set_options(RenderOptions { shows_grids: true, ..options });
    let camera = Camera { eye_m: Vec3::new(32.0, 2.0, 60.0), ..Camera::default() };
    (0..2).for_each(|_| {
        picture.draw(mirror, &camera, 0.0, 0.1);
    });
    let counts = picture.grid_counts().expect("the map").to_vec();
    (picture, counts)
}

/// A plateau 12 m high and 24 m wide across a meadow: wide enough for a rectangle that all rays to a grid behind it cross.
fn ridge() -> Mirror {
    let heights: Vec<u8> = (0..17 * 17).map(|at| if (4..=10).contains(&(at / 17)) { 255 } else { 0 }).collect();
    meadow_over(&heights, |scene| scene.terrain.level_m = 12.0 / 255.0, &[255; 16 * 16])
}

#[test]
fn the_map_counts_the_grids_that_are_drawn_and_those_that_are_culled() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let mut mirror = ridge();
    let (picture, culled) = counts(&gpu, &mut mirror, RenderOptions::default());
    let (_, all) = counts(&gpu, &mut mirror, RenderOptions { culls: false, ..RenderOptions::default() });
    println!("{culled:?}; without culling {all:?}");
    assert_eq!([all[0], all[6], all[7]], [9, 0, 0], "without culling nothing is culled");
    assert_eq!(culled.iter().sum::<u32>(), all.iter().sum::<u32>(), "every grid within reach has one class");
    assert!(culled[6] > 20 && culled[7] > 2, "neither the view nor the ridge culls: {culled:?}");
    let blades = picture.renderer.scene.as_ref().and_then(|scene| scene.blades.as_ref()).expect("blades");
    let listed = blades.listed_grids(&gpu);
    assert_eq!(culled[1] as usize, listed.len(), "the map shows as many grids of single blades as are listed");
    let near = blades.near_grids().iter().filter(|(_, is_seen)| *is_seen).count();
    assert_eq!(culled[0] as usize, near);
}

#[test]
fn the_map_counts_the_grids_of_clumps() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let mut mirror = meadow(4.0);
    let (picture, counts) = counts(&gpu, &mut mirror, RenderOptions { far_plants: FarPlants::Clumps, ..RenderOptions::default() });
    let scene = picture.renderer.scene.as_ref().expect("a scene");
    let near: BTreeSet<_> = scene.blades.as_ref().expect("blades").near_grids().iter().map(|(grid, _)| *grid).collect();
    let grids = scene.billboards.as_ref().expect("clumps").grids();
    let seen =
        |plants: u32| grids.iter().filter(|clump| clump.is_seen && clump.plants == plants && !near.contains(&clump.grid)).count() as u32;
    println!("{counts:?}");
    assert_eq!(counts[2..5], [3, 5, 9].map(seen));
    assert!(counts[2] > 0 && counts[3] > 0, "{counts:?}");
}

#[test]
fn the_map_covers_its_corner_and_nothing_else() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let [with, without] = [true, false].map(|shows_grids| {
        let mut picture = OffscreenRenderer::new(&gpu, [240; 2], Quality::Low);
        picture.set_options(RenderOptions { shows_grids, ..RenderOptions::default() });
        picture.draw(&mut meadow(4.0), &Camera { eye_m: Vec3::new(32.0, 2.0, 32.0), ..Camera::default() }, 0.0, 0.0);
        picture.rgba()
    });
    let differs = |x: usize, y: usize| with[(y * 240 + x) * 4..][..4] != without[(y * 240 + x) * 4..][..4];
    let inside = (4..104).flat_map(|y| (4..104).map(move |x| (x, y))).filter(|&(x, y)| differs(x, y)).count();
    assert!(inside > 9000, "{inside} pixels of the map");
    let beside = (0..240).flat_map(|y| (110..240).map(move |x| (x, y))).filter(|&(x, y)| differs(x, y)).count();
    // Which of two plants at the same depth is visible depends on the order in which they are listed.
    assert!(beside < 600, "{beside} pixels beside the map changed");
}
