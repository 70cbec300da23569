//! Pictures that are rendered with fewer pixels and enlarged.

use super::underbrush::grasses;
use super::*;

const SIZE_PX: [u32; 2] = [240, 136];

/// Mean difference of the channels of two pictures, the second moved by whole pixels, away from the borders.
fn difference(a: &[u8], b: &[u8], moved: [i32; 2]) -> f64 {
    let [width, height] = SIZE_PX.map(|side| side as i32);
    let at = |x: i32, y: i32| (4 * (y * width + x)) as usize;
    let places = (2..height - 2).flat_map(|y| (2..width - 2).map(move |x| (x, y)));
    let differences = places.flat_map(|(x, y)| {
        let (here, there) = (at(x, y), at(x + moved[0], y + moved[1]));
        (0..3).map(move |channel| f64::from(a[here + channel].abs_diff(b[there + channel])))
    });
    differences.sum::<f64>() / f64::from((width - 4) * (height - 4) * 3)
}

#[test]
fn an_enlarged_picture_is_in_place() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    // Low has one sample per pixel, high several.
    for quality in [Quality::Low, Quality::High] {
        let mut mirror = meadow_of(|scene| scene.underbrush = grasses(), &[255; 16 * 16]);
        let mut picture = OffscreenRenderer::new(&gpu, SIZE_PX, quality);
        let camera = Camera { eye_m: Vec3::new(32.0, 3.0, 60.0), pitch_rad: -0.15, ..Camera::default() };
        let mut drawn = |resolution: f32| {
            picture.set_resolution(resolution);
            picture.draw(&mut mirror, &camera, 1.0, 0.0);
            (picture.rgba(), picture.renderer.targets.size_px)
        };
        let (whole, size_px) = drawn(1.0);
        assert_eq!(size_px, SIZE_PX);
        for (resolution, rendered_px) in [(0.75, [180, 102]), (0.5, [120, 68])] {
            let (enlarged, size_px) = drawn(resolution);
            assert_eq!(size_px, rendered_px);
            let in_place = difference(&whole, &enlarged, [0, 0]);
            println!("{quality:?} at {resolution}: {in_place:.2} of 255");
            assert!(in_place > 0.5, "{quality:?} at {resolution}: the pictures differ by {in_place} of 255 only");
            for moved in [[1, 0], [-1, 0], [0, 1], [0, -1]] {
                let aside = difference(&whole, &enlarged, moved);
                assert!(aside > in_place, "{quality:?} at {resolution}: {in_place}, but {aside} when moved by {moved:?} px");
            }
        }
        assert!(drawn(1.0).0 == whole, "{quality:?}: the whole picture has changed");
    }
}

#[test]
fn edges_between_pixels_follow_the_flatter_diagonal() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let mut picture = OffscreenRenderer::new(&gpu, [16, 9], Quality::Low);
    picture.draw(&mut meadow(0.0), &Camera::default(), 0.0, 0.0);
    let grey = |values: [f32; 4]| {
        let [nw, ne, sw, se] = values.map(|value| format!("vec3<f32>({value:?})"));
        let places = [[0.5, 0.5, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [1.0, 1.0, 0.0, 0.0]];
        let body = format!("return vec4<f32>(between({nw}, {ne}, {sw}, {se}, at.xy), 0.0);");
        probe(&gpu, &picture, &body, &places).into_iter().map(|found| found[0]).collect::<Vec<f32>>()
    };
    for corners in [[0.1, 0.2, 0.4, 0.7], [0.9, 0.0, 0.3, 0.8]] {
        assert_eq!(grey(corners)[1..], corners, "pixels keep their colours");
    }
    // A bright line along either diagonal stays bright, and a dark one dark.
    assert_eq!([grey([1.0, 0.0, 0.2, 1.0])[0], grey([0.0, 1.0, 1.0, 0.2])[0]], [1.0; 2]);
    assert_eq!([grey([0.0, 1.0, 0.8, 0.0])[0], grey([1.0, 0.0, 0.0, 0.8])[0]], [0.0; 2]);
}
