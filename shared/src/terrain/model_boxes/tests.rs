use super::*;
use crate::scene::parse;
use crate::terrain::grey_png;
use std::f32::consts::FRAC_PI_4;

const MAPS: &str = "summary = 's'\n[terrain]\nheight_map = 'h.png'\ncovering_map = 'c.png'\npixel_m = [2, 2]\nlevel_m = 0.1\n";

/// A scene of 256 m with one model of 8 m × 4 m × 2 m and ID 9.
fn scene(more: &str) -> Scene {
    let model = "[[models]]\nname = 'barn'\ncover = 9\nmodel = 'house'\nsize_m = [8, 4, 2]\n";
    parse(&format!("{MAPS}{model}{more}")).unwrap()
}

/// A map of 128 × 128 pixels of grass, 2 m each, with the ID 9 at these.
fn cover(pixels: &[[usize; 2]]) -> CoverMap {
    let mut ids = vec![255; 128 * 128];
    pixels.iter().for_each(|[x, z]| ids[z * 128 + x] = 9);
    CoverMap::from_png(&grey_png([128; 2], &ids)).unwrap()
}

fn bare_pixels(cover: &CoverMap) -> Vec<[usize; 2]> {
    let bare = cover.ids().iter().enumerate().filter(|(_, id)| **id == 0);
    bare.map(|(i, _)| [i % 128, i / 128]).collect()
}

#[test]
fn grass_is_cleared_where_a_box_touches_it_and_nowhere_else() {
    // The middle is at (41, 61) m: X from 37 to 45, Z from 60 to 62.
    let mut map = cover(&[[20, 30]]);
    clear_under_models(&scene(""), &mut map);
    assert_eq!(bare_pixels(&map), [[18, 30], [19, 30], [21, 30], [22, 30]]);
    // Turned by 45°, its corners reach as far as 3.54 m along either axis, but not both ways.
    let turned = scene(&format!("heading_rad = {FRAC_PI_4}"));
    let mut map = cover(&[[20, 30]]);
    clear_under_models(&turned, &mut map);
    let bare = bare_pixels(&map);
    assert!(bare.contains(&[21, 31]) && bare.contains(&[19, 29]) && !bare.contains(&[22, 28]) && !bare.contains(&[18, 32]), "{bare:?}");
    // Clearing again changes nothing, for the boxes follow from the IDs of the models alone.
    let once = map.clone();
    assert_eq!(model_boxes(&turned, &once), model_boxes(&turned, &cover(&[[20, 30]])));
    clear_under_models(&turned, &mut map);
    assert_eq!(map, once);
    // Without models the same map stays as it is.
    let mut plain = cover(&[[20, 30]]);
    clear_under_models(&parse(MAPS).unwrap(), &mut plain);
    assert_eq!(plain, cover(&[[20, 30]]));
}

#[test]
fn boxes_at_the_edge_of_the_world_are_cut_off() {
    let mut map = cover(&[[0, 0], [127, 127]]);
    clear_under_models(&scene(""), &mut map);
    assert_eq!(bare_pixels(&map), [[1, 0], [2, 0], [125, 127], [126, 127]]);
}

#[test]
fn sizes_and_headings_vary_within_their_ranges_with_the_place_and_the_seed() {
    let pixels: Vec<_> = (0..100).map(|n| [3 + n % 10 * 12, 3 + n / 10 * 12]).collect();
    let varied = "heading_rad = 1\nheading_variation_rad = 0.5\nsize_variation = 0.25\n";
    let of = |seed: u64| model_boxes(&Scene { seed, ..scene(varied) }, &cover(&pixels));
    let boxes = of(1);
    assert_eq!(boxes, of(1));
    assert_ne!(boxes, of(2));
    let headings: Vec<f32> = boxes.iter().map(|own| own.along[1].atan2(own.along[0])).collect();
    let range = |values: &[f32]| values.iter().fold([f32::MAX, f32::MIN], |[low, high], v| [low.min(*v), high.max(*v)]);
    let [least, most] = range(&headings);
    assert!((0.5..0.6).contains(&least) && (1.4..=1.5).contains(&most), "headings from {least} to {most}");
    let [small, large] = range(&boxes.iter().map(|own| own.scale).collect::<Vec<_>>());
    assert!((0.75..0.8).contains(&small) && (1.2..=1.25).contains(&large), "sizes from {small} to {large}");
    assert!(boxes.iter().all(|own| own.half_m == [4.0, 2.0, 1.0].map(|half| half * own.scale)));
    // Without variation all are equal but for their places.
    let even = model_boxes(&scene(""), &cover(&pixels));
    assert!(even.iter().all(|own| own.along == [1.0, 0.0] && own.scale == 1.0) && even.len() == 100);
}

#[test]
fn models_keep_their_distance_and_the_first_pixel_counts() {
    let row: Vec<_> = (10..30).map(|x| [x, 40]).collect();
    let of = |more: &str| model_boxes(&scene(more), &cover(&row)).iter().map(|own| own.at_m[0]).collect::<Vec<_>>();
    assert_eq!(of("").len(), 20);
    assert_eq!(of("apart_m = 8"), [21.0, 29.0, 37.0, 45.0, 53.0]);
    assert_eq!(of("apart_m = 8.1"), [21.0, 31.0, 41.0, 51.0]);
}

#[test]
fn a_map_full_of_models_places_no_more_than_the_limit() {
    let all: Vec<_> = (0..128 * 128).map(|n| [n % 128, n / 128]).collect();
    assert_eq!(model_boxes(&scene(""), &cover(&all)).len(), MODEL_BOXES_LIMIT);
    assert!(has_too_many_models(&scene(""), &cover(&all)));
    assert!(!has_too_many_models(&scene(""), &cover(&all[..MODEL_BOXES_LIMIT])));
    assert!(!has_too_many_models(&scene("apart_m = 8"), &cover(&all)));
}

#[test]
fn distances_and_floors_follow_the_turned_box() {
    let own = model_boxes(&scene("heading_rad = 1.5707964"), &cover(&[[20, 30]]))[0];
    // It faces east, so that its width lies along Z.
    let distance = |x: f32, z: f32| own.squared_distance_m2([41.0 + x, 61.0 + z]).sqrt();
    assert!(distance(0.9, 3.9) == 0.0 && (distance(3.0, 0.0) - 2.0).abs() < 1e-4 && (distance(4.0, 8.0) - 5.0).abs() < 1e-4);
    assert_eq!(own.floor_m(|_, _| 7.0), 7.0);
    let down_to_the_south = own.floor_m(|_, z| -z);
    assert!((down_to_the_south + 65.0).abs() < 1e-3, "{down_to_the_south}");
    for heading_rad in [-3.0_f32, -1.2, 0.0, 0.7, 1.5707964, 3.1] {
        let own = model_boxes(&scene(&format!("heading_rad = {heading_rad}")), &cover(&[[20, 30]]))[0];
        let right = glam::Quat::from_array(own.rotation()) * glam::Vec3::X;
        assert!((right.x - own.along[0]).abs() < 1e-4 && (right.z - own.along[1]).abs() < 1e-4, "{heading_rad}: {right}");
        assert!((heading_rad.sin() - own.along[1]).abs() < 1e-4, "the front faces from north towards east");
    }
}
