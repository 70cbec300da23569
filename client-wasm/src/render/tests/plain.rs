//! Plain land looks the same as with everything that land may have.

use super::cracks::ragged_land;
use super::*;
use crate::render::Renderer;
use crate::render::land_and_sky::terrain::{CLASSES, Terrain, TileClass};

const SIZE_PX: [u32; 2] = [160, 120];
const VIEWS: u32 = 18;

/// Two kinds of grass side by side, or only one, with a bare spot, a tree and a stone.
fn land(has_kinds: bool) -> Mirror {
    let grass = |at: usize| {
        if !has_kinds {
            255
        } else if at % 128 < 61 {
            7
        } else {
            9
        }
    };
    let mut covering: Vec<u8> = (0..128 * 128).map(grass).collect();
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
            if has_kinds {
                scene.species = vec![kind("green", 7, [0.1, 0.5, 0.05], 0.2), kind("red", 9, [0.6, 0.1, 0.05], 1.0)];
            }
        },
        &covering,
    )
}

/// A picture of the land from a random place.
fn draw(picture: &mut OffscreenRenderer, mirror: &mut Mirror, number: u32) -> Vec<u8> {
    let [x, z, heading, down] = [0, 1, 2, 3].map(|axis| unit(hash3([number, axis, 4])[0]));
    let side_m = mirror.decoded_scene().expect("a scene").scene().extent_m()[0];
    let [x, z] = [x, z].map(|fraction| side_m * (0.03 + 0.94 * fraction));
    let eye_m = Vec3::new(x, mirror.ground_m(x, z) + 1.5, z);
    let camera = Camera { eye_m, heading_rad: 6.2 * heading, pitch_rad: -0.9 * down, ..Camera::default() };
    picture.draw(mirror, &camera, 0.0, 0.0);
    picture.rgba()
}

fn terrain(picture: &mut OffscreenRenderer) -> &mut Terrain {
    &mut picture.renderer.scene.as_mut().expect("land").terrain
}

/// Instances of each class of the last picture.
fn instances(picture: &mut OffscreenRenderer) -> [usize; CLASSES.len()] {
    let runs = &terrain(picture).runs;
    CLASSES.map(|class| runs.iter().filter(|run| run.class == class).map(|run| run.tiles.len()).sum())
}

fn of_land(gpu: &Gpu, mirror: &Mirror) -> OffscreenRenderer {
    let mut picture = OffscreenRenderer::new(gpu, SIZE_PX, Quality::Low);
    (picture.renderer, _) = Renderer::with_land(gpu, wgpu::TextureFormat::Rgba8UnormSrgb, SIZE_PX, Quality::Low, mirror);
    picture
}

#[test]
fn plain_land_looks_as_with_soil_and_kinds() {
    let [still, beyond, _, mixed, _] = plain_looks_as_mixed(&mut land(true));
    assert!(still > 50 && mixed > 50 && beyond == 0);
}

#[test]
fn plain_land_of_one_kind_goes_on_beyond_the_map() {
    let [still, beyond, bent, ..] = plain_looks_as_mixed(&mut land(false));
    assert!(still > 50 && beyond > 50 && bent == 0);
}

#[test]
fn plain_land_is_bent_where_its_patches_are() {
    let mut mirror = meadow(0.0);
    let mut picture = of_land(&Gpu::headless().expect("a Vulkan adapter"), &mirror);
    let upright: Vec<_> = (0..VIEWS).map(|number| draw(&mut picture, &mut mirror, number)).collect();
    stream_to(&mut mirror, 5..7, |_| 1.2, 0.5);
    let [still, _, bent, ..] = plain_looks_as_mixed(&mut mirror);
    assert!(still > 50 && bent > 50);
    let is_changed = |(number, before): (u32, &Vec<u8>)| difference(before, &draw(&mut picture, &mut mirror, number)) > MOST;
    assert!((0..VIEWS).zip(&upright).any(is_changed), "the bend is not visible");
}

/// Greatest difference of a channel between plain and mixed land (levels of 255).
const MOST: u8 = 2;

fn difference(a: &[u8], b: &[u8]) -> u8 {
    a.iter().zip(b).map(|(a, b)| a.abs_diff(*b)).max().unwrap_or_default()
}

/// Compares pictures of land with those where none of it is plain. Returns the instances of each class in the former.
fn plain_looks_as_mixed(mirror: &mut Mirror) -> [usize; CLASSES.len()] {
    let mut picture = of_land(&Gpu::headless().expect("a Vulkan adapter"), mirror);
    let plain: Vec<_> = (0..VIEWS).map(|number| (draw(&mut picture, mirror, number), instances(&mut picture))).collect();
    terrain(&mut picture).plain.kinds.fill(None);
    for (number, (plain, _)) in (0..VIEWS).zip(&plain) {
        let most = difference(plain, &draw(&mut picture, mirror, number));
        assert_eq!(instances(&mut picture)[..TileClass::Mixed as usize], [0; 3]);
        assert!(most <= MOST, "view {number}: channels differ by up to {most} of 255");
    }
    let counts = plain.iter().fold([0; CLASSES.len()], |sum, (_, counts)| std::array::from_fn(|class| sum[class] + counts[class]));
    println!("tiles and blocks of {CLASSES:?}: {counts:?}");
    counts
}
