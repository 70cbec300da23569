//! Selection of the plants that are bent: those in view, and those that return into view.

use super::wind::blow_gusts;
use super::*;

/// Rates of the near plants (rad/s, all links), 0 where there was none.
fn rates(gpu: &Gpu, picture: &OffscreenRenderer) -> Vec<f32> {
    let bytes = read(gpu, &picture.renderer.scene.as_ref().and_then(|scene| scene.blades.as_ref()).expect("grass").sways);
    let sways: &[[[f32; 4]; LINKS]] = bytemuck::cast_slice(&bytes);
    sways.iter().map(|links| links.iter().map(|[.., x, z]| x.hypot(*z)).sum()).collect()
}

#[test]
fn plants_that_return_into_view_start_at_rest_and_others_keep_moving() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let mut mirror = meadow(6.0);
    blow_gusts(&mut mirror, 6.0);
    let mut picture = OffscreenRenderer::new(&gpu, [64, 36], Quality::Low);
    let ahead = Camera { eye_m: Vec3::new(32.0, 1.6, 32.0), pitch_rad: -0.4, ..Camera::default() };
    let aside = Camera { heading_rad: 0.5, ..ahead };
    for frame in 0..30 {
        picture.draw(&mut mirror, &ahead, f64::from(frame) / 30.0, 1.0 / 30.0);
    }
    let moving = rates(&gpu, &picture);
    // Looking aside without time passing changes nothing; looking aside for two frames does.
    picture.draw(&mut mirror, &aside, 1.0, 0.0);
    picture.draw(&mut mirror, &ahead, 1.0, 0.0);
    let seen = |rates: &[f32]| moving.iter().zip(rates).filter(|(moving, _)| **moving > 1e-4).map(|(a, b)| [*a, *b]).collect::<Vec<_>>();
    assert!(seen(&rates(&gpu, &picture)).iter().all(|[before, after]| before == after));
    for _ in 0..2 {
        picture.draw(&mut mirror, &aside, 1.0, 1.0 / 30.0);
    }
    picture.draw(&mut mirror, &ahead, 1.0, 0.0);
    let back = seen(&rates(&gpu, &picture));
    let anew = back.iter().filter(|[_, after]| *after == 0.0).count();
    assert!(back.len() - anew > 200 && anew > 200, "{anew} of {} stand still", back.len());
}

#[test]
fn plants_out_of_view_are_not_bent() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let camera = Camera { eye_m: Vec3::new(32.0, 1.6, 32.0), pitch_rad: -0.4, fov_rad: 0.6, ..Camera::default() };
    let standing = |culls: bool| {
        let mut picture = OffscreenRenderer::new(&gpu, [64, 36], Quality::Low);
        picture.set_options(RenderOptions { culls, ..RenderOptions::default() });
        picture.draw(&mut meadow(0.0), &camera, 0.0, 0.0);
        let counts: Vec<u32> = bytemuck::pod_collect_to_vec(&read(
            &gpu,
            picture.renderer.scene.as_ref().and_then(|scene| scene.blades.as_ref()).expect("grass").in_view(),
        ));
        [counts[0], counts[1]]
    };
    let ([near, far], [every_near, every_far]) = (standing(true), standing(false));
    assert!(near > 300 && far > 300, "{near} near and {far} others in view");
    assert!(2 * near < every_near && 3 * far < every_far, "{near} of {every_near} near, {far} of {every_far} others");
}

#[test]
fn plants_stay_on_the_ground_as_the_camera_moves() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let heights: Vec<u8> = (0..17 * 17).map(|n| (hash3([n, 5, 3])[0] % 5) as u8).collect();
    let mut mirror = meadow_over(&heights, |scene| scene.terrain.level_m = 1.0, &[255; 16 * 16]);
    let grid_m = mirror.decoded_scene().expect("land").scene().plants.grid_m;
    let mut gone = OffscreenRenderer::new(&gpu, [96, 54], Quality::Low);
    let mut pictures = Vec::new();
    // The initial position, one grid on, across a corner, far away, and back.
    for [x, z] in [[0.0, 0.0], [1.0, 0.0], [2.0, 1.0], [-2.0, -1.0], [0.0, 0.0]] {
        let eye_m = Vec3::new(32.0 + x * grid_m, 5.5, 32.0 + z * grid_m);
        let camera = Camera { eye_m, pitch_rad: -0.4, ..Camera::default() };
        gone.draw(&mut mirror, &camera, 0.0, 0.0);
        let mut fresh = OffscreenRenderer::new(&gpu, [96, 54], Quality::Low);
        fresh.draw(&mut mirror, &camera, 0.0, 0.0);
        assert!(gone.rgba() == fresh.rgba(), "another picture at {eye_m}");
        pictures.push(fresh.rgba());
    }
    assert!(pictures[0] == pictures[4] && pictures[0] != pictures[1], "the eye has moved");
}

#[test]
fn near_blades_part_before_they_fill_the_picture() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let mut picture = OffscreenRenderer::new(&gpu, [16, 16], Quality::Low);
    picture.draw(&mut meadow(0.0), &Camera::default(), 0.0, 0.0);
    // Blades of 1 cm.
    let distances_m = [0.0, 0.01, 0.05, 0.1, 0.15, 0.2, 1.0, 10.0];
    let found = probe_in(
        &gpu,
        &picture,
        "plants/backbone",
        "return vec4<f32>(width_at(at.x, at.y), 0.0, 0.0, 0.0);",
        &distances_m.map(|distance_m| [0.01, distance_m, 0.0, 0.0]),
    );
    for ([width_m, ..], distance_m) in found.into_iter().zip(distances_m) {
        let wanted = (0.12 * distance_m).min(0.01);
        assert!((width_m - wanted).abs() < 1e-6, "{width_m} m instead of {wanted} m at {distance_m} m");
    }
}
