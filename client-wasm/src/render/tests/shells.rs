//! Shells: their sums on the GPU, extrusion and stiffness, where they are drawn, and the benefit of slices.

use super::*;
use crate::render::options::render_options::{FarPlants, RenderOptions};
use prairie_core::lod::shells::Tilt;
use prairie_core::scene::{PlantCover, ShellExtrusion};

/// A flat lawn of 64 m in a light wind, drawn as shells with this number of slices.
fn lawn(slices: u32) -> Mirror {
    let change = |scene: &mut Scene| {
        scene.wind = Wind { mean_m_per_s: [4.0, 0.0], ..Wind::default() };
        (scene.plants.cover, scene.plants.height_m, scene.shells.slices) = (PlantCover::Shells, 0.25, slices);
    };
    meadow_of(change, &[255; 16 * 16])
}

/// The lawn on land that rises by 100 m per 64 m towards the east where `is_steep`, else on flat land, with an extrusion and a stiffness profile.
fn slope(is_steep: bool, extrusion: ShellExtrusion, stiffness_profile: f32) -> Mirror {
    let heights: Vec<u8> = (0..17 * 17).map(|n| if is_steep { 4 * (n % 17) as u8 } else { 0 }).collect();
    let change = |scene: &mut Scene| {
        scene.wind = Wind { mean_m_per_s: [4.0, 3.0], ..Wind::default() };
        (scene.plants.cover, scene.plants.height_m, scene.terrain.level_m) = (PlantCover::Shells, 0.25, 1.5625);
        (scene.shells.extrusion, scene.shells.stiffness_profile) = (extrusion, stiffness_profile);
    };
    meadow_over(&heights, change, &[255; 16 * 16])
}

/// Differences of positions of layers from those in the core, and of those with the profile 0 from them, over leans, layers and segments.
fn differences_from_core(gpu: &Gpu, stiffness_profile: f32) -> [f32; 2] {
    let mut mirror = meadow(0.0);
    let mut picture = OffscreenRenderer::new(gpu, [16, 16], Quality::Low);
    picture.draw(&mut mirror, &Camera::default(), 0.0, 0.0);
    let cases: Vec<[f32; 4]> = (0..500_u32)
        .map(|n| {
            let [a, b, c] = hash3([n, 1, 8]).map(unit);
            let segments = 1 + (b * 64.0) as u32;
            // Calm, full wind and trodden grass are among them.
            let lean_rad = [0.0, std::f32::consts::FRAC_PI_4, 1.5, 1.7 * a][n as usize % 4];
            [lean_rad, (c * (segments + 1) as f32).floor().min(segments as f32), segments as f32, stiffness_profile]
        })
        .collect();
    let body = "let tilt = tilt_of(at.x); return vec4<f32>(layer_place(tilt.x, tilt.y, at.w, at.y, at.z), tilt);";
    let constants = [("has_profile", stiffness_profile != 0.0)];
    let found = compute(gpu, &picture, &probing("plants/shells", body), &constants, &cases, cases.len() as u32);
    let wanted = |[lean_rad, layer, segments, _]: [f32; 4], stiffness_profile| {
        let tilt = Tilt { stiffness_profile, ..Tilt::of_lean(lean_rad) };
        let [along_axis, along_wind] = tilt.layer(layer as u32, segments as u32);
        [along_axis, along_wind, tilt.root_rad, tilt.intensity]
    };
    let worst = |profile: f32| {
        let pairs = cases.iter().zip(&found).flat_map(|(case, found)| wanted(*case, profile).into_iter().zip(*found));
        pairs.map(|(wanted, found)| (wanted - found).abs()).fold(0.0, f32::max)
    };
    [worst(stiffness_profile), worst(0.0)]
}

#[test]
fn layers_are_positioned_as_in_the_core() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let [worst, _] = differences_from_core(&gpu, 0.0);
    assert!(worst < 2e-5, "{worst}");
    for stiffness_profile in [-0.9, -0.5, 1.0, 4.0] {
        let [worst, from_constant] = differences_from_core(&gpu, stiffness_profile);
        assert!(worst < 1e-4 && from_constant > 0.1, "profile {stiffness_profile}: {worst}, and {from_constant} from a constant increment");
    }
}

#[test]
fn blades_stand_along_the_normal_or_upright_with_the_wind_across() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let mut picture = OffscreenRenderer::new(&gpu, [16, 16], Quality::Low);
    picture.draw(&mut meadow(0.0), &Camera::default(), 0.0, 0.0);
    let normals = [Vec3::Y, Vec3::new(-0.6, 0.8, 0.0), Vec3::new(0.3, 0.6, 0.5).normalize()];
    let cases: Vec<_> = normals.iter().flat_map(|n| [[0.4, 0.0], [-0.2, 0.7], [0.0, -1.2]].map(|[x, z]| [n.x, n.z, x, z])).collect();
    for is_upright in [false, true] {
        let [axes, winds] = ["axis", "wind_across(axis, at.zw)"].map(|result| {
            let normal = "vec3<f32>(at.x, sqrt(1.0 - dot(at.xy, at.xy)), at.y)";
            let body = format!("let axis = upright_axis({normal}, {}u); return vec4<f32>({result}, 0.0);", u32::from(is_upright));
            probe_in(&gpu, &picture, "plants/shells", &body, &cases)
        });
        for ((&[x, z, east, south], axis), wind) in cases.iter().zip(axes).zip(winds) {
            let [axis, wind] = [axis, wind].map(|found| Vec3::from_slice(&found[..3]));
            let wanted = if is_upright { Vec3::Y } else { Vec3::new(x, (1.0 - x * x - z * z).sqrt(), z) };
            assert!(axis.distance(wanted) < 1e-5, "{axis} instead of {wanted}");
            assert!(axis.dot(wind).abs() < 1e-5 && (wind.length() - 1.0).abs() < 1e-5, "{wind} across {axis}");
            assert!(wind.x * east + wind.z * south > 0.0, "{wind} for a lean towards {east}, {south}");
            assert!(!is_upright || wind.y == 0.0, "{wind} with upright blades");
        }
    }
}

/// Pictures of the slope with two settings.
fn pictures_of(gpu: &Gpu, is_steep: bool, settings: [(ShellExtrusion, f32); 2]) -> [Vec<u8>; 2] {
    settings.map(|(extrusion, stiffness_profile)| {
        let mut picture = OffscreenRenderer::new(gpu, [96, 54], Quality::Low);
        let ground_m = if is_steep { 50.0 } else { 0.0 };
        let camera = Camera { eye_m: Vec3::new(32.0, ground_m + 1.5, 32.0), pitch_rad: -0.5, ..Camera::default() };
        picture.draw(&mut slope(is_steep, extrusion, stiffness_profile), &camera, 0.0, 0.0);
        picture.rgba()
    })
}

#[test]
fn upright_shells_differ_on_slopes_alone() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let both = [(ShellExtrusion::Normal, 0.0), (ShellExtrusion::Up, 0.0)];
    let [along_normal, upright] = pictures_of(&gpu, true, both);
    let differs = difference(&along_normal, &upright);
    assert!(differs > 3.0, "by {differs} on a slope");
    let [along_normal, upright] = pictures_of(&gpu, false, both);
    assert!(along_normal == upright, "by {} on flat land", difference(&along_normal, &upright));
}

#[test]
fn the_profile_of_the_stiffness_shows() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let [constant, stiff] = pictures_of(&gpu, false, [(ShellExtrusion::Normal, 0.0), (ShellExtrusion::Normal, 4.0)]);
    let [again, floppy] = pictures_of(&gpu, false, [(ShellExtrusion::Normal, 0.0), (ShellExtrusion::Normal, -0.9)]);
    assert!(constant == again);
    let [by_stiff, by_floppy] = [stiff, floppy].map(|picture| difference(&constant, &picture));
    assert!(by_stiff > 1.0 && by_floppy > 1.0, "by {by_stiff} if stiff, by {by_floppy} if floppy");
}

#[test]
fn shells_replace_all_plants_or_only_far_ones() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let camera = Camera { eye_m: Vec3::new(32.0, 2.0, 60.0), ..Camera::default() };
    let drawn = |mirror: &mut Mirror, far, shell_layers| {
        let mut picture = OffscreenRenderer::new(&gpu, [32, 16], Quality::Low);
        picture.set_options(RenderOptions { far_plants: far, shell_layers, ..RenderOptions::default() });
        let stats = picture.draw(mirror, &camera, 0.0, 0.0);
        [stats.blades, stats.clumps, stats.shell_layers]
    };
    let [blades, clumps, sheets] = drawn(&mut lawn(4), FarPlants::Clumps, None);
    assert!(blades == 0 && clumps == 0 && sheets > 20, "{blades}, {clumps}, {sheets}");
    let [fewest, fewer, more] = [1, 17, 65].map(|layers| drawn(&mut lawn(4), FarPlants::Clumps, Some(layers))[2]);
    assert!(fewest < fewer && fewer == sheets && 2 * fewer < more, "{fewest}, {fewer}, {more}");
    let [blades, clumps, far_sheets] = drawn(&mut meadow(4.0), FarPlants::Shells, None);
    assert!(blades > 0 && clumps == 0 && far_sheets > 0 && far_sheets < sheets, "{blades}, {clumps}, {far_sheets}");
    let [blades, clumps, sheets] = drawn(&mut meadow(4.0), FarPlants::Clumps, None);
    assert!(blades > 0 && clumps > 0 && sheets == 0, "{blades}, {clumps}, {sheets}");
}

/// Mean difference of the channels of two pictures, 0..=255.
fn difference(a: &[u8], b: &[u8]) -> f64 {
    a.iter().zip(b).map(|(a, b)| f64::from(a.abs_diff(*b))).sum::<f64>() / a.len() as f64
}

#[test]
fn slices_look_like_many_more_layers_at_grazing_angles() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    // In a region with sixteen layers, 10° below the horizontal.
    let camera = Camera { eye_m: Vec3::new(32.0, 1.0, 40.0), pitch_rad: -0.42, ..Camera::default() };
    let drawn = |slices, layers| {
        let mut picture = OffscreenRenderer::new(&gpu, [192, 108], Quality::Low);
        picture.set_options(RenderOptions { shell_layers: Some(layers), ..RenderOptions::default() });
        picture.draw(&mut lawn(slices), &camera, 0.0, 0.0);
        picture.rgba()
    };
    let many = drawn(32, 65);
    let [without, with] = [1, 12].map(|slices| difference(&drawn(slices, 9), &many));
    assert!(with < 0.7 * without, "{with} with slices, {without} without");
}
