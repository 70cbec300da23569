//! Plain land looks the same as with everything that land may have.

use super::cracks::ragged_land;
use super::*;
use crate::render::Renderer;

const SIZE_PX: [u32; 2] = [160, 120];
const VIEWS: u32 = 18;

/// Two kinds of grass side by side, with a bare spot, a tree and a stone.
fn land() -> Mirror {
    let mut covering: Vec<u8> = (0..128 * 128).map(|at| if at % 128 < 61 { 7 } else { 9 }).collect();
    for (x, z) in (0..5).flat_map(|z| (0..5).map(move |x| (x, z))) {
        covering[(79 + z) * 128 + 33 + x] = 0;
    }
    (covering[20 * 128 + 100], covering[70 * 128 + 95]) = (253, 254);
    ragged_land(
        |scene| {
            let kind = |name: &str, cover, tip_rgb, bend_rad| {
                let grass = Grass { wind_bend_rad: bend_rad, ..scene.grass };
                Species { tip_rgb, ..Species::new(name, cover, &grass, &scene.plants) }
            };
            scene.species = vec![kind("green", 7, [0.1, 0.5, 0.05], 0.2), kind("red", 9, [0.6, 0.1, 0.05], 1.0)];
        },
        &covering,
    )
}

#[test]
fn plain_land_looks_as_with_soil_and_kinds() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let mut mirror = land();
    let mut picture = OffscreenRenderer::new(&gpu, SIZE_PX, Quality::Low);
    (picture.renderer, _) = Renderer::with_land(&gpu, wgpu::TextureFormat::Rgba8UnormSrgb, SIZE_PX, Quality::Low, &mirror);
    let mut draw = |number: u32, is_plain: bool| {
        let [x, z, heading, down] = [0, 1, 2, 3].map(|axis| unit(hash3([number, axis, 4])[0]));
        let [x, z] = [x, z].map(|fraction| 4.0 + 120.0 * fraction);
        let ground_m = mirror.ground_m(x, z);
        let camera =
            Camera { eye_m: Vec3::new(x, ground_m + 1.5, z), heading_rad: 6.2 * heading, pitch_rad: -0.9 * down, ..Camera::default() };
        if !is_plain {
            picture.renderer.scene.as_mut().expect("land").terrain.plain.kinds.fill(None);
        }
        picture.draw(&mut mirror, &camera, 0.0, 0.0);
        let tiles = picture.renderer.scene.as_ref().expect("land").terrain.ranges.clone().map(|range| range.len());
        (picture.rgba(), tiles)
    };
    let plain: Vec<_> = (0..VIEWS).map(|number| draw(number, true)).collect();
    let mixed: Vec<_> = (0..VIEWS).map(|number| draw(number, false)).collect();
    let (mut plain_tiles, mut mixed_tiles) = (0, 0);
    for (number, ((plain, tiles), (mixed, none))) in plain.iter().zip(&mixed).enumerate() {
        assert_eq!(none[0], 0);
        (plain_tiles, mixed_tiles) = (plain_tiles + tiles[0], mixed_tiles + tiles[1]);
        let most = plain.iter().zip(mixed).map(|(a, b)| a.abs_diff(*b)).max().unwrap_or_default();
        assert!(most <= 2, "view {number}: channels differ by up to {most} of 255");
    }
    println!("{plain_tiles} plain and {mixed_tiles} mixed tiles");
    assert!(plain_tiles > 50 && mixed_tiles > 50, "{plain_tiles} plain and {mixed_tiles} mixed tiles");
}
