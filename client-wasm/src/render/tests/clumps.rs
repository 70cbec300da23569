//! Clumps: each plant that a clump joins bends at its own foot, the motion grows with distance if asked, and nothing stands in a gap.

use super::*;
use crate::render::gpu::constants::CLUMP_PLANTS;
use crate::render::gpu::uniforms::ClumpList;
use prairie_core::wire::TurbulenceState;
use std::f32::consts::TAU;

/// Plants that a clump joins: the one on its axis, then those at the outer ends of its rectangles.
const PLANTS: usize = CLUMP_PLANTS as usize;
const CAMERA_M: Vec3 = Vec3::new(32.0, 1.7, 78.0);

/// A plant that a shown clump of one segment joins.
#[derive(Clone, Copy)]
struct Joined {
    foot_m: [f32; 2],
    /// Lean (rad, X and Z).
    lean_rad: [f32; 2],
}

/// Draws clumps at low quality from [`CAMERA_M`].
fn draw(gpu: &Gpu, mirror: &mut Mirror, raises_far_wind: bool) -> OffscreenRenderer {
    let mut picture = OffscreenRenderer::new(gpu, [200; 2], Quality::Low);
    picture.set_options(RenderOptions { far_plants: FarPlants::Clumps, raises_far_wind, culls: false, ..RenderOptions::default() });
    let camera = Camera { eye_m: CAMERA_M, ..Camera::default() };
    (0..4).for_each(|_| {
        picture.draw(mirror, &camera, 0.6, 0.1);
    });
    picture
}

/// Feet of the plants of a clump at `axis_m`, as `plant_foot` in WGSL.
fn feet_m([x, z, length_m, random]: [f32; 4]) -> [[f32; 2]; PLANTS] {
    std::array::from_fn(|plant| {
        let (sin, cos) = ((plant as f32 - 1.0) / 6.0 * TAU + random * TAU).sin_cos();
        if plant == 0 { [x, z] } else { [x + cos * length_m, z + sin * length_m] }
    })
}

/// Rows of the clumps of a picture that are shown and have one segment, with the plants that they join.
fn joined(gpu: &Gpu, picture: &OffscreenRenderer) -> Vec<[Joined; PLANTS]> {
    let buffers = &picture.renderer.scene.as_ref().and_then(|scene| scene.billboards.as_ref()).expect("clumps").buffers;
    let list: ClumpList = bytemuck::pod_read_unaligned(&read(gpu, &buffers.list));
    let clumps: Vec<[f32; 4]> = bytemuck::pod_collect_to_vec(&read(gpu, &buffers.clumps));
    let poses: Vec<[f32; 16]> = bytemuck::pod_collect_to_vec(&read(gpu, &buffers.poses));
    let joints: Vec<[f32; 4]> = bytemuck::pod_collect_to_vec(&read(gpu, &buffers.joints));
    let several = list.several as usize;
    let before = several * PLANTS * list.several_segments as usize;
    let single = several..list.count as usize;
    let shown = single.filter(|&number| poses[number][2] > 0.0);
    let lean_rad = |[x, y, z, _]: [f32; 4]| {
        let aside = x.hypot(z);
        [x, z].map(|along| along / aside.max(1e-6) * aside.atan2(y))
    };
    let of_clump = |number: usize| {
        let (feet, first) = (feet_m(clumps[number]), before + (number - several) * PLANTS);
        std::array::from_fn(|plant| Joined { foot_m: feet[plant], lean_rad: lean_rad(joints[first + plant]) })
    };
    shown.map(of_clump).collect()
}

/// Leans (rad) at the feet of all plants of some clumps by the functions that blades and shells use, in a wind of the WGSL expression `wind` at `ground`.
fn leans_rad(gpu: &Gpu, picture: &OffscreenRenderer, clumps: &[[Joined; PLANTS]], wind: &str) -> Vec<[f32; 2]> {
    let body = format!(
        "let ground = vec3<f32>(at.x, ground_height(at.xy), at.y);
        let distance_m = distance(ground, frame.eye_m);
        return vec4<f32>(lean_in(ground, field_level(distance_m), {wind}, at.z), distance_m, 0.0);"
    );
    let bend_rad = picture_bend_rad();
    let feet: Vec<_> = clumps.iter().flatten().map(|plant| [plant.foot_m[0], plant.foot_m[1], bend_rad, 0.0]).collect();
    // An invocation per plant, in one dimension.
    let found: Vec<_> = feet.chunks(30_000).flat_map(|feet| probe_in(gpu, picture, "plants/shells", &body, feet)).collect();
    found.into_iter().map(|[x, z, ..]| [x, z]).collect()
}

/// Bend of the default grass in a wind of 10 m/s (rad).
fn picture_bend_rad() -> f32 {
    Grass::default().wind_bend_rad
}

fn apart([a, b]: [[f32; 2]; 2]) -> f32 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// A meadow whose wind varies along X and in gusts.
fn varied_wind(mirror: &mut Mirror, m_per_s: f32) {
    let cells = mirror.decoded_scene().expect("a scene").scene().wind.cells.map(|n| n as usize);
    let count = cells.iter().product::<usize>();
    let speed = |at: usize| if at < count { m_per_s + 0.3 * (at % 5) as f32 - 0.6 } else { 0.0 };
    let codes: Vec<i16> = (0..3 * count).map(|at| CodeSteps::default().wind_code(speed(at))).collect();
    let turbulence = TurbulenceState { travel_m: [12.3, -4.1], path_m: 5.0, friction_m_per_s: 0.08 * m_per_s };
    let payload = codec::encode(Shape::wind(cells[0], false), &codes, None);
    mirror.apply(ServerMessage::Wind { tick: 1, seq: 1, key: true, turbulence, payload }).expect("a sound wind");
}

#[test]
fn every_plant_of_a_clump_bends_at_its_own_foot() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let mut mirror = meadow(4.0);
    varied_wind(&mut mirror, 4.0);
    stream(&mut mirror, |x_m| 0.25 + 0.2 * (0.7 * x_m).sin(), 0.5);
    let picture = draw(&gpu, &mut mirror, false);
    let clumps = joined(&gpu, &picture);
    let wanted = leans_rad(&gpu, &picture, &clumps, "sheltered_at(ground, 0.0) + gust_at(at.xy)");
    let (mut worst, mut largest) = (0.0_f32, 0.0_f32);
    for (plants, wanted) in clumps.iter().zip(wanted.chunks_exact(PLANTS)) {
        for (plant, &wanted_rad) in plants.iter().zip(wanted) {
            worst = worst.max(apart([plant.lean_rad, wanted_rad]));
            // The joints of the axis at all ends would differ by this.
            largest = largest.max(apart([wanted[0], wanted_rad]));
        }
    }
    println!(
        "{} clumps: leans at the ends apart from those at the plants by {worst} rad; from that of the axis by {largest} rad",
        clumps.len()
    );
    assert!(clumps.len() > 100 && worst < 2e-3, "{} clumps, {worst} rad", clumps.len());
    assert!(largest > 0.05, "one posture for the whole clump would differ by {largest} rad only");
}

#[test]
fn wind_is_raised_in_proportion_to_distance_from_where_clumps_begin() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let mut mirror = meadow(3.0);
    varied_wind(&mut mirror, 3.0);
    let [plain, raised] = [false, true].map(|raises| draw(&gpu, &mut mirror, raises));
    let [mean_x, mean_z] = raised.renderer.scene.as_ref().expect("a scene").textures.wind.ground_mean_m_per_s();
    assert!((mean_x - 3.0).abs() < 0.1 && mean_z.abs() < 0.05, "{mean_x}, {mean_z}");
    let (clumps, unraised) = (joined(&gpu, &raised), joined(&gpu, &plain));
    assert_eq!(clumps.len(), unraised.len());
    // The deviation of the wind from its mean grows as the distance over that at which clumps begin, and not before.
    let wind = format!(
        "(sheltered_at(ground, 0.0) + gust_at(at.xy) - vec2<f32>({mean_x:?}, {mean_z:?})) * max(distance_m / frame.blades_fade_from_m, 1.0)
        + vec2<f32>({mean_x:?}, {mean_z:?})"
    );
    let wanted = leans_rad(&gpu, &raised, &clumps, &wind);
    let (mut worst, mut largest) = (0.0_f32, 0.0_f32);
    for ((plant, plain), wanted) in clumps.iter().flatten().zip(unraised.iter().flatten()).zip(wanted) {
        worst = worst.max(apart([plant.lean_rad, wanted]));
        largest = largest.max(apart([plain.lean_rad, wanted]));
    }
    println!("leans apart from those in the raised wind by {worst} rad; in the wind as it is by {largest} rad");
    assert!(worst < 2e-3 && largest > 0.05, "{worst} rad; {largest} rad");
}

/// Covering map, 16 × 16 pixels of 4 m, with grass west of 32 m and a gap east of it: none from 34 m on, half a pixel beyond.
fn half_bare() -> Vec<u8> {
    (0..16 * 16).map(|at| if at % 16 < 8 { 255 } else { 0 }).collect()
}

const GAP_FROM_M: f32 = 34.0;

#[test]
fn no_fragment_of_a_clump_stands_in_a_gap() {
    const SIDE_PX: u32 = 240;
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    // Blue grass in calm air, in clumps so long that they reach far across the border.
    let calm = |scene: &mut Scene| {
        scene.wind.mean_m_per_s = [0.0; 2];
        (scene.plants.root_rgb, scene.plants.tip_rgb) = ([0.02, 0.02, 0.9], [0.02, 0.02, 0.9]);
        (scene.plants.plants_per_side, scene.plants.flowers_per_m2) = (8, 0.0);
    };
    let mut mirror = meadow_of(calm, &half_bare());
    // The plane of the border is the vertical line through the middle of the picture.
    let camera = Camera { eye_m: Vec3::new(GAP_FROM_M, 2.5, 78.0), fov_rad: 0.8, ..Camera::default() };
    let mut picture = OffscreenRenderer::new(&gpu, [SIDE_PX; 2], Quality::Low);
    picture.set_options(RenderOptions { far_plants: FarPlants::Clumps, ..RenderOptions::default() });
    (0..3).for_each(|_| {
        picture.draw(&mut mirror, &camera, 0.0, 0.1);
    });
    let buffers = &picture.renderer.scene.as_ref().and_then(|scene| scene.billboards.as_ref()).expect("clumps").buffers;
    let clumps: Vec<[f32; 4]> = bytemuck::pod_collect_to_vec(&read(&gpu, &buffers.clumps));
    let poses: Vec<[f32; 16]> = bytemuck::pod_collect_to_vec(&read(&gpu, &buffers.poses));
    let crossing = |(clump, pose): (&[f32; 4], &[f32; 16])| {
        let east_m = feet_m(*clump).into_iter().map(|[x, _]| x).fold(f32::MIN, f32::max);
        pose[2] > 0.5 && clump[0] < GAP_FROM_M && east_m > GAP_FROM_M + 1.0
    };
    let count = clumps.iter().zip(&poses).filter(|row| crossing(*row)).count();
    assert!(count > 3, "{count} clumps reach 1 m into the gap");
    // Rows that show land farther than 16 m from the eye, where single blades have ended.
    let focal_px = 0.5 * SIDE_PX as f32 / (0.5 * camera.fov_rad).tan();
    let rows = SIDE_PX / 2..(0.5 * SIDE_PX as f32 + (2.5 - 1.0) / 20.0 * focal_px) as u32;
    let rgba = picture.rgba();
    let blue = |columns: std::ops::Range<u32>| {
        let pixels = rows.clone().flat_map(|row| columns.clone().map(move |column| (row * SIDE_PX + column) as usize * 4));
        pixels.filter(|&at| rgba[at + 2] > rgba[at] + 40).count()
    };
    let (grass, gap) = (blue(0..SIDE_PX / 2), blue(SIDE_PX / 2 + 2..SIDE_PX));
    println!("{count} clumps cross the border; {grass} pixels of grass west of it, {gap} east of it");
    assert!(grass > 500 && gap == 0, "{grass} pixels of grass west of the border, {gap} east of it");
}
