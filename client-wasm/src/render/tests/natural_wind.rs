//! Grass in the natural wind: the repeated patch where no camera is near.

use super::*;
use prairie_core::grass::RepeatedPatch;
use prairie_core::scene::NaturalWind;

/// Step of the world that is shown.
const TICK: u64 = 300;
const LEAN: &str = "return vec4<f32>(lean_of_field(at.xz, at.y), 0.0, 0.0);";

/// The four patches around the middle, within 16 m to 48 m.
const MIDDLE: [std::ops::Range<u32>; 2] = [5..7, 9..11];

/// 64 m of grass in gusts of 8 m; cameras in the middle reach the four [patches](MIDDLE) around it, of which none has been sent.
fn breezy_meadow() -> Mirror {
    let natural_wind = NaturalWind { strength_rad_per_s2: 2.0, scale_m: 8.0, drift_m_per_s: [4.0, 1.5], reach_m: 13.0 };
    let mut mirror = meadow_of(|scene| scene.natural_wind = natural_wind, &[255; 16 * 16]);
    mirror.apply(ServerMessage::FrameEnd { frame: 1, tick: TICK, time_secs: 5.0 }).expect("a sound frame");
    mirror.show_newest();
    mirror
}

/// Lean of the repeated patch at a place (rad): bilinear between the centres of its cells.
fn repeated_lean_rad(repeated: &RepeatedPatch, [x_m, z_m]: [f32; 2]) -> [f32; 2] {
    let (_, patch) = repeated.shown().expect("grass to show");
    let side = RepeatedPatch::cells() as i64;
    let [x, z] = [x_m, z_m].map(|m| m / repeated.period_m() * side as f32 - 0.5);
    let cell = |i: f32, j: f32| patch.bend((i as i64).rem_euclid(side) as usize, (j as i64).rem_euclid(side) as usize).lean_rad();
    let (i, j) = (x.floor(), z.floor());
    let mix = |a: [f32; 2], b: [f32; 2], t: f32| [0, 1].map(|axis| a[axis] + (b[axis] - a[axis]) * t);
    mix(mix(cell(i, j), cell(i + 1.0, j), x - i), mix(cell(i, j + 1.0), cell(i + 1.0, j + 1.0), x - i), z - j)
}

#[test]
fn far_grass_leans_as_the_repeated_patch_and_near_grass_by_itself() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let mut mirror = breezy_meadow();
    let mut picture = OffscreenRenderer::new(&gpu, [16; 2], Quality::Low);
    let camera = Camera { eye_m: Vec3::new(32.0, 2.0, 32.0), ..Camera::default() };
    MIDDLE.into_iter().for_each(|patches| stream_to(&mut mirror, patches, |_| 0.5, 1.0));
    // The weights follow the cameras by the time constant of the grass, 4.8 s: after 40 s they have arrived.
    (0..20).for_each(|_| {
        picture.draw(&mut mirror, &camera, 5.0, 2.0);
    });
    // Beyond the patches around those that are pushed, and far outside the land and the atlas.
    let far: Vec<_> = (0..60).map(|n| [-3.3 - 11.7 * n as f32, 0.0, 90.5 + 7.1 * (n % 9) as f32, 0.0]).collect();
    let repeated = mirror.repeated_patch().expect("natural wind");
    let mut largest = 0.0_f32;
    for (at, found) in far.iter().zip(probe(&gpu, &picture, LEAN, &far)) {
        let wanted = repeated_lean_rad(repeated, [at[0], at[2]]);
        largest = largest.max(wanted[0].hypot(wanted[1]));
        // The texture holds half floats and mixes them by steps of 1/256.
        assert!((0..2).all(|axis| (found[axis] - wanted[axis]).abs() < 3e-3), "{found:?} instead of {wanted:?} at {at:?}");
    }
    assert!(largest > 0.2, "the grass leans by up to {largest} rad");
    let near: Vec<_> = (0..30).map(|n| [17.0 + n as f32, 0.0, 20.0 + 0.7 * n as f32, 0.0]).collect();
    for (at, [x, z, ..]) in near.iter().zip(probe(&gpu, &picture, LEAN, &near)) {
        assert!((x - 0.5).abs() < 0.01 && z.abs() < 1e-3, "grass near the camera at {at:?} leans by {x}, {z} instead of 0.5");
    }
    // From corner to corner of a patch in between, the weight falls from 1 to 0.
    let between: Vec<_> = [1.0, 4.0, 8.0, 12.0, 15.0].map(|x| [x, 0.0, 32.0, 0.0]).to_vec();
    for (at, [x, ..]) in between.iter().zip(probe(&gpu, &picture, LEAN, &between)) {
        let wanted = repeated_lean_rad(repeated, [at[0], at[2]])[0] * (1.0 - at[0] / 16.0);
        assert!((x - wanted).abs() < 4e-3, "{x} instead of {wanted} at {at:?}");
    }
}

#[test]
fn the_repeated_patch_gives_way_as_slowly_as_grass_rises() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let mut mirror = breezy_meadow();
    let mut picture = OffscreenRenderer::new(&gpu, [16; 2], Quality::Low);
    let camera = Camera { eye_m: Vec3::new(32.0, 2.0, 32.0), ..Camera::default() };
    let recovery_secs = mirror.repeated_patch().expect("natural wind").recovery_secs();
    assert!((4.0..6.0).contains(&recovery_secs), "{recovery_secs} s");
    let at = [40.0, 0.0, 32.0, 0.0];
    // Patches at rest that have been sent.
    let mut lean_after = |dt_secs: f32, are_sent: bool| {
        for patches in MIDDLE.into_iter().filter(|_| are_sent) {
            stream_to(&mut mirror, patches, |_| 0.0, 0.0);
        }
        picture.draw(&mut mirror, &camera, 5.0, dt_secs);
        probe(&gpu, &picture, LEAN, &[at])[0][0]
    };
    let full = lean_after(0.0, false);
    let wanted = repeated_lean_rad(breezy_meadow().repeated_patch().expect("natural wind"), [at[0], at[2]])[0];
    assert!((full - wanted).abs() < 3e-3 && full.abs() > 0.05, "{full} instead of {wanted}, while the pushed grass has not been sent");
    let later = lean_after(recovery_secs, true);
    assert!((later / full - (-1.0_f32).exp()).abs() < 0.01, "{later} of {full} after a time constant");
}

/// In patches of 256 cells the window has few of them: four along each side, with five corners.
#[test]
fn grass_at_one_border_of_the_window_is_not_that_at_the_other() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let natural_wind = NaturalWind { strength_rad_per_s2: 2.0, scale_m: 8.0, drift_m_per_s: [4.0, 1.5], reach_m: 500.0 };
    let change = |scene: &mut Scene| {
        scene.natural_wind = natural_wind;
        scene.patches = Patches { count: [1, 1], cells: 256, cell_m: 0.25, ..Patches::default() };
    };
    let mut mirror = meadow_of(change, &[255; 16 * 16]);
    mirror.apply(ServerMessage::FrameEnd { frame: 1, tick: TICK, time_secs: 5.0 }).expect("a sound frame");
    mirror.show_newest();
    let codes = [vec![0; 256 * 256], vec![1; 256 * 256], vec![0; 256 * 256]].concat();
    let payload = codec::encode(Shape::patch(256), &codes, None);
    mirror.apply(ServerMessage::Patch { patch: 0, seq: 1, key: true, payload }).expect("a sound patch");
    let mut picture = OffscreenRenderer::new(&gpu, [16; 2], Quality::Low);
    // The window goes from 0 m to 256 m along X: the one patch of the land, which is pushed, is at its western border.
    let camera = Camera { eye_m: Vec3::new(158.0, 2.0, 32.0), ..Camera::default() };
    picture.draw(&mut mirror, &camera, 5.0, 0.0);
    let repeated = mirror.repeated_patch().expect("natural wind");
    // Where the bend field counts in full, up to 51 m from the eye.
    let east: Vec<_> = (0..8).map(|n| [194.0 + 2.0 * n as f32, 0.0, 20.0, 0.0]).collect();
    let mut largest = 0.0_f32;
    for (at, found) in east.iter().zip(probe(&gpu, &picture, LEAN, &east)) {
        let wanted = repeated_lean_rad(repeated, [at[0], at[2]]);
        largest = largest.max(wanted[0].abs());
        assert!((found[0] - wanted[0]).abs() < 3e-3, "{found:?} instead of {wanted:?} at {at:?}");
    }
    assert!(largest > 0.05, "the grass leans by up to {largest} rad");
}

#[test]
fn coarse_levels_of_the_repeated_patch_are_means() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let mut mirror = breezy_meadow();
    let mut picture = OffscreenRenderer::new(&gpu, [16; 2], Quality::Low);
    picture.draw(&mut mirror, &Camera::default(), 5.0, 0.0);
    let repeated = mirror.repeated_patch().expect("natural wind");
    let (_, patch) = repeated.shown().expect("grass to show");
    let side = patch.side();
    let mean = (0..side * side).map(|n| patch.bend(n % side, n / side).lean_rad()[0]).sum::<f32>() / (side * side) as f32;
    // 64 cells of 1 m are one texel at level 8 of the atlas, whose texels are 0.25 m at level 0.
    let [coarsest, fine]: [[f32; 4]; 2] =
        probe(&gpu, &picture, LEAN, &[[-300.0, 8.0, 5.0, 0.0], [-300.0, 2.0, 5.0, 0.0]]).try_into().expect("two leans");
    assert!((coarsest[0] - mean).abs() < 2e-3, "{} instead of the mean, {mean}", coarsest[0]);
    let wanted = repeated_lean_rad(repeated, [-300.0, 5.0])[0];
    assert!((fine[0] - wanted).abs() < 3e-3 && (wanted - mean).abs() > 0.01, "{} instead of {wanted} at the finest level", fine[0]);
}

#[test]
fn a_scene_without_natural_wind_has_no_repeated_patch() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let mut mirror = meadow_of(|_| {}, &[255; 16 * 16]);
    mirror.show_newest();
    let mut picture = OffscreenRenderer::new(&gpu, [16; 2], Quality::Low);
    picture.draw(&mut mirror, &Camera::default(), 5.0, 0.0);
    assert!(mirror.repeated_patch().is_none());
    assert_eq!(probe(&gpu, &picture, LEAN, &[[-300.0, 0.0, 5.0, 0.0], [8.0, 0.0, 8.0, 0.0]]), [[0.0; 4]; 2]);
}
