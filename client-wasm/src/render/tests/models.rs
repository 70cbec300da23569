//! Models of the scene's own: in the picture, with their shadow, and without grass beneath them.

use super::*;
use crate::render::solids::trees_and_stones::{PlacedKind, placed_models};
use crate::sight::Sight;
use prairie_core::light::sun::Sun;
use prairie_core::scene::CoverModel;
use prairie_core::terrain::Cover;
use prairie_core::wire::{Mesh, ModelUse};
use std::f32::consts::FRAC_PI_2;

/// Size of the picture.
const PX: [u32; 2] = [240, 160];
/// Middle of the box (m) and its size (m).
const AT_M: Vec3 = Vec3::new(30.0, 2.0, 30.0);
const SIZE_M: [f32; 3] = [6.0, 4.0, 4.0];

/// A red box of that size about the origin.
pub(super) fn red_box() -> Mesh {
    let mut mesh = Mesh::default();
    let half = Vec3::from_array(SIZE_M) * 0.5;
    for axis in 0..3 {
        for side in [-1.0_f32, 1.0] {
            let mut normal = Vec3::ZERO;
            normal[axis] = side;
            let [u, v] = [1, 2].map(|n| {
                let mut edge = Vec3::ZERO;
                edge[(axis + n) % 3] = 1.0;
                edge
            });
            let first = mesh.positions_m.len() as u32;
            for [a, b] in [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]] {
                mesh.positions_m.push(((normal + u * a + v * (b * side)) * half).to_array());
                mesh.normals.push(normal.to_array());
                mesh.rgb.push([230, 5, 5]);
            }
            mesh.indices.extend([0, 1, 2, 0, 2, 3].map(|index| first + index));
        }
    }
    mesh
}

/// A flat meadow of 64 m, with one box or without.
fn field(has_box: bool, heading_rad: f32) -> Mirror {
    let maps = TerrainMaps { height_map: String::new(), covering_map: String::new(), pixel_m: [4.0, 4.0], level_m: 0.0, base_m: 0.0 };
    let mut scene = Scene { patches: Patches { count: [4, 4], ..Patches::default() }, ..Scene::new(maps) };
    (scene.wind.mean_m_per_s, scene.plants.flowers_per_m2, scene.plants.height_m) = ([0.0; 2], 0.0, 0.2);
    let model = CoverModel { size_m: SIZE_M, heading_rad, ..CoverModel::new("box", 9, "") };
    scene.models = if has_box { vec![model] } else { vec![] };
    let mut covering = [255; 16 * 16];
    covering[7 + 16 * 7] = 9;
    let mut mirror = Mirror::default();
    let scene = ServerMessage::Scene {
        scene: Box::new(scene),
        height_png: grey_png([17; 2], &[0; 17 * 17]),
        covering_png: grey_png([16; 2], &if has_box { covering } else { [255; 256] }),
        nutrient_png: Vec::new(),
        models: if has_box { vec![(ModelUse::Cover(0), red_box())] } else { vec![] },
        shapes: Default::default(),
    };
    mirror.apply(scene).expect("a sound scene");
    mirror
}

/// A picture of the field from the south, 16 m from its middle and 6 m high, with the sun low in the west.
fn picture_of(gpu: &Gpu, has_box: bool) -> Vec<u8> {
    let mut picture = OffscreenRenderer::new(gpu, PX, Quality::High);
    picture.set_options(RenderOptions { sun: Some(Sun { heading_rad: -FRAC_PI_2, elevation_rad: 0.5 }), ..RenderOptions::default() });
    let camera = Camera { eye_m: Vec3::new(33.0, 7.0, 48.0), pitch_rad: -0.3, ..Camera::default() };
    let mut mirror = field(has_box, 0.0);
    for _ in 0..4 {
        picture.draw(&mut mirror, &camera, 0.0, 0.0);
    }
    picture.rgba()
}

/// Place of a position (m) in such a picture (px).
fn pixel_of(at_m: Vec3) -> [f32; 2] {
    let camera = Camera { eye_m: Vec3::new(33.0, 7.0, 48.0), pitch_rad: -0.3, ..Camera::default() };
    let at = camera.projection_from_world(PX[0] as f32 / PX[1] as f32).project_point3(at_m);
    [(0.5 + 0.5 * at.x) * PX[0] as f32, (0.5 - 0.5 * at.y) * PX[1] as f32]
}

/// Area of a quadrilateral in such a picture (px).
fn area_px(corners_m: [Vec3; 4]) -> f64 {
    let corners = corners_m.map(pixel_of);
    let twice: f32 = (0..4).map(|n| corners[n][0] * corners[(n + 1) % 4][1] - corners[(n + 1) % 4][0] * corners[n][1]).sum();
    f64::from(0.5 * twice.abs())
}

/// Mean luminance of 7 × 7 pixels about a position on the ground (m) in such a picture.
fn light_at(rgba: &[u8], at_m: Vec3) -> f64 {
    let [x, y] = pixel_of(at_m).map(|px| px as u32);
    let pixels = (y - 3..=y + 3).flat_map(|y| (x - 3..=x + 3).map(move |x| 4 * (y * PX[0] + x) as usize));
    pixels.map(|at| 0.2126 * f64::from(rgba[at]) + 0.7152 * f64::from(rgba[at + 1]) + 0.0722 * f64::from(rgba[at + 2])).sum::<f64>() / 49.0
}

#[test]
fn a_model_is_drawn_and_casts_its_shadow_on_the_grass() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let [with, without] = [true, false].map(|has_box| picture_of(&gpu, has_box));
    let red = |rgba: &[u8]| rgba.chunks_exact(4).filter(|px| f32::from(px[0]) > 1.8 * f32::from(px[1].max(px[2]))).count();
    println!("{} red pixels with the box, {} without", red(&with), red(&without));
    // At least the southern face above the grass, and at most that and as much again of the roof and the shaded side.
    let face_px = area_px([[27.0, 0.2], [33.0, 0.2], [33.0, 4.0], [27.0, 4.0]].map(|[x, y]| Vec3::new(x, y, 32.0)));
    let seen_px = red(&with) as f64;
    assert!((0.9..2.0).contains(&(seen_px / face_px)) && red(&without) == 0, "{seen_px} of {face_px}, and {} without", red(&without));
    let ratio = |x_m: f32| light_at(&with, Vec3::new(x_m, 0.0, 30.0)) / light_at(&without, Vec3::new(x_m, 0.0, 30.0));
    let [west, east, beyond] = [24.0, 36.0, 43.0].map(ratio);
    println!("light with the box over that without it: {west:.2} towards the sun, {east:.2} in the shadow, {beyond:.2} beyond it");
    assert!(east < 0.75, "3 m east of the wall the light is {east} of that without the box");
    assert!((west - 1.0).abs() < 0.08 && (beyond - 1.0).abs() < 0.08, "out of the shadow it is {west} and {beyond}");
}

#[test]
fn a_model_is_placed_in_its_box_and_grows_no_grass() {
    for heading_rad in [0.0, 0.6, -2.0] {
        let mirror = field(true, heading_rad);
        let decoded = mirror.decoded_scene().expect("a scene");
        let placed = placed_models(decoded);
        assert!(placed.len() == 1 && placed[0].kind == PlacedKind::Own && placed[0].position_m == AT_M, "{placed:?}");
        let front = placed[0].world_from_model.transform_vector3(Vec3::NEG_Z);
        assert!((front - Vec3::new(heading_rad.sin(), 0.0, -heading_rad.cos())).length() < 1e-4, "{front} at {heading_rad}");
        assert_eq!(decoded.cover().at(30.0, 30.0, [64.0; 2]), Cover::Free(9));
        assert_eq!(decoded.cover().at(27.5, 30.0, [64.0; 2]), Cover::Gap);
        assert_eq!(decoded.cover().at(20.0, 30.0, [64.0; 2]), Cover::Grass);
    }
}

#[test]
fn the_camera_stays_before_a_model() {
    let sight = |heading_rad: f32| Sight::new(field(true, heading_rad).decoded_scene().expect("a scene"));
    let clear_m = |sight: &Sight, direction: Vec3| 12.0 * sight.clear_fraction(AT_M - 12.0 * direction, AT_M);
    // Before the ellipsoid of 1.2 times the box: 2.6 m from its middle across, 3.8 m along.
    let facing_north = sight(0.0);
    let [across, along] = [Vec3::Z, Vec3::X].map(|direction| clear_m(&facing_north, direction));
    assert!((across - 9.4).abs() < 0.1 && (along - 8.2).abs() < 0.1, "{across} m and {along} m");
    let facing_east = sight(FRAC_PI_2);
    assert!((clear_m(&facing_east, Vec3::X) - across).abs() < 0.01 && (clear_m(&facing_east, Vec3::Z) - along).abs() < 0.01);
    assert_eq!(facing_north.clear_fraction(Vec3::new(30.0, 2.0, 50.0), Vec3::new(50.0, 2.0, 50.0)), 1.0, "past it");
}
