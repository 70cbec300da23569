use crate::camera::Camera;
use crate::render::gpu::device::Gpu;
use crate::render::gpu::pipeline::{PassFactory, bind_at, storage_rw};
use crate::render::gpu::readback::read;
use crate::render::gpu::shaders::tests::{linked, parsed};
use crate::render::gpu::shaders::{self, Constant};
use crate::render::land_and_sky::terrain_quadtree::GroundTile;
use crate::render::offscreen::OffscreenRenderer;
use crate::render::options::quality::Quality;
use crate::render::options::render_options::{FarPlants, RenderOptions};
use crate::render::plants::blades;
use crate::render::plants::force_field::CameraForceField;
use crate::render::plants::shells::TileLayer;
use crate::render::plants::underbrush::UnderbrushPlant;
use crate::render::solids::limb_passes::BENT_LIMB_BYTES;
use crate::state::Mirror;
use glam::Vec3;
use prairie_core::hash::{hash3, unit};
use prairie_core::lod::Lag;
use prairie_core::plant::blade::{LINKS, Sway};
use prairie_core::plant::underbrush::constraint::Following;
use prairie_core::scene::{BladeIntegrator, Grass, LagWay, Patches, Scene, Species, TerrainMaps, VehicleKind, Wind};
use prairie_core::terrain::grey_png;
use prairie_core::wire::quantise::CodeSteps;
use prairie_core::wire::{ServerMessage, Shape, codec};
use std::fmt::Display;
use wgpu::naga;

mod bare;
mod branches;
mod clumps;
mod constants;
mod cracks;
mod flowers;
mod grid_map;
mod grown_trees;
mod lees;
mod light;
mod models;
mod natural_wind;
mod occlusion;
mod order;
mod plain;
mod resolution;
mod shade;
mod shells;
mod slabs;
mod small;
mod snow;
mod stages;
mod standing;
mod trees;
mod twins;
mod underbrush;
mod wind;

fn module(source: impl Display) -> naga::Module {
    parsed(&source.to_string()).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn every_shader_is_valid_wgsl_without_extensions() {
    for source in shaders::ALL {
        module(source);
    }
}

#[test]
fn storage_structs_have_the_sizes_that_rust_gives_them() {
    let [module, underbrush, shells] = [shaders::BEND, shaders::UNDERBRUSH, shaders::SHELLS].map(self::module);
    let [billboards, dust, objects] = [shaders::BILLBOARDS, shaders::DUST, shaders::OBJECTS].map(self::module);
    for (of, name, bytes) in [
        (&shells, "Turf", crate::render::plants::shells::TURF_BYTES as u32),
        (&module, "Sway", blades::SWAY_BYTES as u32),
        (&module, "Blade", blades::BLADE_BYTES as u32),
        (&shells, "GroundTile", size_of::<GroundTile>() as u32),
        (&shells, "TileLayer", size_of::<TileLayer>() as u32),
        (&billboards, "Clump", 16),
        (&billboards, "ClumpPose", 64),
        (&dust, "DustPlace", 32),
        (&dust, "Sprite", 48),
        (&objects, "Instance", 96),
        (&objects, "TreeLimb", 48),
        (&objects, "BentLimb", BENT_LIMB_BYTES as u32),
        (&objects, "TreeSway", 16),
        (&underbrush, "Row", 32),
        (&underbrush, "Limb", 64),
        (&underbrush, "UnderbrushPlant", size_of::<UnderbrushPlant>() as u32),
        (&underbrush, "ForceResponse", 32),
        (&underbrush, "VisiblePlant", crate::render::plants::underbrush::VISIBLE_PLANT_BYTES as u32),
        (&underbrush, "Border", crate::render::plants::underbrush::ROW_BYTES as u32 / 2),
    ] {
        let (_, found) = of.types.iter().find(|(_, ty)| ty.name.as_deref() == Some(name)).expect("it is there");
        assert!(
            matches!(found.inner, naga::TypeInner::Struct { span, .. } if span == bytes),
            "{name} has not {bytes} bytes: {:?}",
            found.inner
        );
    }
}

/// A flat meadow of 64 m in a wind towards the east.
fn meadow(wind_m_per_s: f32) -> Mirror {
    meadow_in(Wind { mean_m_per_s: [wind_m_per_s, 0.0], ..Wind::default() })
}

fn meadow_in(wind: Wind) -> Mirror {
    meadow_of(|scene| scene.wind = wind, &[255; 16 * 16])
}

/// [`meadow`] with a modified scene, over a covering map of 16 × 16 pixels.
pub(super) fn meadow_of(change: impl FnOnce(&mut Scene), covering: &[u8]) -> Mirror {
    meadow_over(&[0; 17 * 17], change, covering)
}

/// [`meadow_of`] on land whose heights are 17 × 17 pixels.
fn meadow_over(heights: &[u8], change: impl FnOnce(&mut Scene), covering: &[u8]) -> Mirror {
    let maps = TerrainMaps { height_map: String::new(), covering_map: String::new(), pixel_m: [4.0, 4.0], level_m: 0.0, base_m: 0.0 };
    let mut scene = Scene { patches: Patches { count: [4, 4], ..Patches::default() }, ..Scene::new(maps) };
    change(&mut scene);
    let mut mirror = Mirror::default();
    let scene = ServerMessage::Scene {
        scene: Box::new(scene),
        height_png: grey_png([17; 2], heights),
        covering_png: grey_png([16; 2], covering),
        nutrient_png: Vec::new(),
        models: Vec::new(),
        shapes: Default::default(),
    };
    mirror.apply(scene).expect("a sound scene");
    mirror
}

/// Streams a field that leans eastward by `theta_rad` everywhere.
fn stream_lean(mirror: &mut Mirror, theta_rad: f32) {
    stream(mirror, |_| theta_rad, 2.5 * theta_rad);
}

/// Streams a field that leans eastward by `theta_rad` of X (m), at a uniform bending velocity.
fn stream(mirror: &mut Mirror, theta_rad: impl Fn(f32) -> f32, omega_rad_per_s: f32) {
    stream_to(mirror, 0..16, theta_rad, omega_rad_per_s);
}

/// [`stream`] to some patches.
fn stream_to(mirror: &mut Mirror, patches: std::ops::Range<u32>, theta_rad: impl Fn(f32) -> f32, omega_rad_per_s: f32) {
    for patch in patches {
        let west_m = (patch % 4) as f32 * 16.0;
        let thetas = (0..64 * 64).map(|at| CodeSteps::default().theta_code(theta_rad(west_m + ((at % 64) as f32 + 0.5) * 0.25)));
        let plane = |code: i16| std::iter::repeat_n(code, 64 * 64);
        let codes: Vec<i16> = thetas.chain(plane(CodeSteps::default().omega_code(omega_rad_per_s))).chain(plane(0)).collect();
        let payload = codec::encode(Shape::patch(64), &codes, None);
        mirror.apply(ServerMessage::Patch { patch, seq: 1, key: true, payload }).expect("a sound patch");
    }
}

/// Tips of the near blades after a second in a wind, as offsets from their roots relative to the length of the blade.
fn tips(gpu: &Gpu, wind_m_per_s: f32, streamed_rad: Option<f32>) -> Vec<Vec3> {
    let swayed = sways(gpu, &mut meadow(wind_m_per_s), streamed_rad);
    swayed.iter().map(|sway| Vec3::from(sway.points_m(1.0)[LINKS - 1])).collect()
}

/// Sways of the near blades, one second after they stood upright.
fn sways(gpu: &Gpu, mirror: &mut Mirror, streamed_rad: Option<f32>) -> Vec<Sway> {
    sways_after(gpu, mirror, streamed_rad, 30)
}

/// [`sways`] after this number of frames, 1/30 s each.
fn sways_after(gpu: &Gpu, mirror: &mut Mirror, streamed_rad: Option<f32>, frames: u32) -> Vec<Sway> {
    let mut picture = OffscreenRenderer::new(gpu, [16, 16], Quality::Low);
    picture.set_options(RenderOptions { culls: false, ..RenderOptions::default() });
    let camera = Camera { eye_m: Vec3::new(32.0, 2.2, 40.0), pitch_rad: -0.15, ..Camera::default() };
    for frame in 0..frames {
        if let Some(theta_rad) = streamed_rad.filter(|_| frame == 0) {
            stream_lean(mirror, theta_rad);
        }
        picture.draw(mirror, &camera, 0.0, 1.0 / 30.0);
    }
    let bytes = read(gpu, &picture.renderer.scene.as_ref().and_then(|scene| scene.blades.as_ref()).expect("grass").sways);
    let sways: &[[[f32; 4]; LINKS]] = bytemuck::cast_slice(&bytes);
    let sway =
        |links: &[[f32; 4]; LINKS]| Sway { lean_rad: links.map(|[x, z, ..]| [x, z]), rate_rad_per_s: links.map(|[.., x, z]| [x, z]) };
    sways.iter().filter(|links| links.as_flattened().iter().any(|&v| v != 0.0)).map(sway).collect()
}

/// Mean angle of the tips eastward from upright (rad).
fn lean_rad(tips: &[Vec3]) -> f32 {
    tips.iter().map(|tip| tip.x.atan2(tip.y)).sum::<f32>() / tips.len() as f32
}

#[test]
fn near_blades_lean_by_the_sum_of_wind_and_field() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let bend_rad = Grass::default().wind_bend_rad;
    let leans = |wind_m_per_s: f32, streamed_rad: Option<f32>| lean_rad(&tips(&gpu, wind_m_per_s, streamed_rad));
    let still_rad = leans(0.0, None);
    // At 28 m/s grass bends no further than at 10 m/s.
    for (wind_m_per_s, streamed_rad, held_rad) in [(28.0, None, bend_rad), (0.0, Some(0.4), 0.4), (28.0, Some(0.3), bend_rad + 0.3)] {
        let lean_rad = leans(wind_m_per_s, streamed_rad) - still_rad;
        assert!((lean_rad - held_rad).abs() < 0.1 * held_rad, "{lean_rad} rad where {held_rad} rad are held");
    }
}

#[test]
fn near_blades_lean_with_the_square_of_a_weak_wind() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let leans = [0.0, 2.0, 4.0].map(|wind_m_per_s| lean_rad(&tips(&gpu, wind_m_per_s, None)));
    let ratio = (leans[2] - leans[0]) / (leans[1] - leans[0]);
    assert!((ratio - 4.0).abs() < 0.5, "twice the wind leans {ratio} times as far: {leans:?}");
}

#[test]
fn near_blades_swing_alike_by_verlet_and_exactly() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let swung = |integrator| {
        sways(
            &gpu,
            &mut meadow_of(
                |scene| {
                    (scene.plants.integrator, scene.wind.mean_m_per_s) = (integrator, [8.0, 0.0]);
                },
                &[255; 16 * 16],
            ),
            None,
        )
    };
    let (exact, verlet) = (swung(BladeIntegrator::Exact), swung(BladeIntegrator::Verlet));
    let mut apart_rad = 0.0;
    for (exact, verlet) in exact.iter().zip(&verlet) {
        assert!(verlet.lean_rad.as_flattened().iter().all(|lean| lean.abs() < 2.5), "{verlet:?}");
        assert!(verlet.rate_rad_per_s.as_flattened().iter().all(|rate| rate.abs() < 40.0), "{verlet:?}");
        let [a, b] = [exact, verlet].map(|sway| Vec3::from(sway.points_m(1.0)[LINKS - 1]));
        apart_rad += a.angle_between(b);
    }
    let mean_rad = apart_rad / exact.len() as f32;
    assert!(mean_rad < 0.03, "{mean_rad} rad apart");
}

/// Results, one for each of `places`, of a WGSL function body with the argument `at`, linked with the shared modules.
pub(super) fn probe(gpu: &Gpu, picture: &OffscreenRenderer, body: &str, places: &[[f32; 4]]) -> Vec<[f32; 4]> {
    probe_in(gpu, picture, "", body, places)
}

/// [`probe`] with values of overrides.
fn probe_with(gpu: &Gpu, picture: &OffscreenRenderer, constants: &[Constant], body: &str, places: &[[f32; 4]]) -> Vec<[f32; 4]> {
    compute(gpu, picture, &probing("", body), constants, places, places.len() as u32)
}

/// [`probe`] with the declarations of a file, such as `plants/bend`.
pub(super) fn probe_in(gpu: &Gpu, picture: &OffscreenRenderer, file: &str, body: &str, places: &[[f32; 4]]) -> Vec<[f32; 4]> {
    compute(gpu, picture, &probing(file, body), &[], places, places.len() as u32)
}

/// WGSL of a `probe` of a function body with the argument `at`, linked with the declarations that it uses from a file.
fn probing(file: &str, body: &str) -> String {
    let source = format!(
        "@group(1) @binding(0) var<storage, read_write> probes: array<vec4<f32>>;
        fn found(at: vec4<f32>) -> vec4<f32> {{ {body} }}
        @compute @workgroup_size(1) fn probe(@builtin(global_invocation_id) id: vec3<u32>) {{ probes[id.x] = found(probes[id.x]); }}"
    );
    linked(file, &source)
}

/// Output of `invocations` of `probe` in a WGSL source, with values of its overrides, over a storage buffer of `inputs`.
fn compute(
    gpu: &Gpu,
    picture: &OffscreenRenderer,
    source: &str,
    constants: &[Constant],
    inputs: &[[f32; 4]],
    invocations: u32,
) -> Vec<[f32; 4]> {
    let renderer = &picture.renderer;
    let factory = PassFactory {
        gpu: gpu.clone(),
        frame_layout: renderer.bindings.layout.clone(),
        pyramid: renderer.bindings.pyramid.clone(),
        samples: 1,
        has_kinds: true,
        soft_shadows: true,
        has_snow: false,
    };
    let layout = factory.layout("probes", &[&[storage_rw(0)][..], &CameraForceField::layout()].concat());
    let scene = renderer.scene.as_ref().expect("a scene");
    let pipeline = factory.compute("probe", &gpu.shader("probe", source, constants), "probe", &layout);
    let probes = gpu.buffer("probes", bytemuck::cast_slice(inputs), wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC);
    let group = bind_at(gpu, "probes", &layout, [(0, probes.as_entire_binding())].into_iter().chain(scene.force_field.resources()));
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    {
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &scene.textures.group, &[]);
        pass.set_bind_group(1, &group, &[]);
        pass.dispatch_workgroups(invocations, 1, 1);
    }
    gpu.queue.submit([encoder.finish()]);
    bytemuck::cast_slice(&read(gpu, &probes)).to_vec()
}

/// Lean eastward (rad) of a segment that lags by `at.y` seconds at `at.xz`.
const TRAILING: &str = "return vec4<f32>(trailing_lean(at.xz, 0.0, bend_at(at.xz, 0.0, 0), kinds.list[0], at.y), 0.0, 0.0);";

#[test]
fn segments_that_look_upwind_find_what_their_twin_finds() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let mut mirror = meadow_of(
        |scene| (scene.grass.waves.c0_m_per_s, scene.grass.waves.mu_m_per_rad, scene.grass.recovery_lag_share) = (6.0, 0.5, 0.3),
        &[255; 16 * 16],
    );
    // Bends that fall and rise towards the east, slowly enough for 8-bit codes.
    let theta_rad = |x_m: f32| 0.5 + 0.4 * (x_m * 0.3).sin();
    let steps = CodeSteps::default();
    let omega = steps.omega_rad_per_s(steps.omega_code(1.2));
    stream(&mut mirror, theta_rad, omega);
    let mut picture = OffscreenRenderer::new(&gpu, [16, 16], Quality::Low);
    picture.draw(&mut mirror, &Camera { eye_m: Vec3::new(32.0, 2.0, 32.0), ..Camera::default() }, 0.0, 0.0);
    let lag = Lag::from(&mirror.decoded_scene().expect("a scene").scene().grass);
    let places: Vec<_> = (0..60).map(|n| [15.0 + 0.5 * n as f32, [0.0, 0.06, 0.12][n % 3], 20.0, 0.0]).collect();
    for (at, found) in places.iter().zip(probe(&gpu, &picture, TRAILING, &places)) {
        let wanted = lag.lean_rad(at[1], |secs| [theta_rad(at[0] + lag.reached_m([omega, 0.0], secs)[0]), 0.0]);
        assert!((found[0] - wanted[0]).abs() < 0.02 && found[1].abs() < 1e-6, "{found:?} instead of {wanted:?} at {at:?}");
    }
}

#[test]
fn segments_that_look_back_find_what_was_streamed() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let mut mirror = meadow_of(|scene| (scene.plants.lag, scene.grass.lag_secs) = (LagWay::History, 0.2), &[255; 16 * 16]);
    let mut picture = OffscreenRenderer::new(&gpu, [16, 16], Quality::Low);
    let camera = Camera { eye_m: Vec3::new(32.0, 2.0, 32.0), ..Camera::default() };
    let mut stay = |mirror: &mut Mirror, secs: f32, lag_secs: f32| {
        (0..(secs / 0.02).round() as u32).for_each(|_| {
            picture.draw(mirror, &camera, 0.0, 0.02);
        });
        probe(&gpu, &picture, TRAILING, &[[30.0, lag_secs, 30.0, 0.0]])[0][0]
    };
    let near = |found: f32, wanted: f32| assert!((found - wanted).abs() < 0.02, "{found} instead of {wanted}");
    stream_lean(&mut mirror, 0.3);
    near(stay(&mut mirror, 0.5, 0.2), 0.3);
    // The tip responds to a new bend after its lag.
    stream_lean(&mut mirror, 0.8);
    near(stay(&mut mirror, 0.04, 0.0), 0.8);
    near(stay(&mut mirror, 0.06, 0.2), 0.3);
    near(stay(&mut mirror, 0.30, 0.2), 0.8);
    // It recovers with 0.4 of that lag.
    stream_lean(&mut mirror, 0.1);
    near(stay(&mut mirror, 0.02, 0.2), 0.8);
    near(stay(&mut mirror, 0.18, 0.2), 0.1);
}

#[test]
fn places_have_the_kind_of_their_map() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    // Kind 1 in the west, kind 2 in the east.
    let covering: Vec<u8> = (0..256).map(|at| if at % 16 < 8 { 7 } else { 9 }).collect();
    let species = |scene: &mut Scene| {
        let kind =
            |name: &str, cover, bend_rad| Species::new(name, cover, &Grass { wind_bend_rad: bend_rad, ..scene.grass }, &scene.plants);
        scene.species = vec![kind("stiff", 7, 0.2), kind("soft", 9, 1.0)];
    };
    let mut mirror = meadow_of(species, &covering);
    let mut picture = OffscreenRenderer::new(&gpu, [16, 16], Quality::Low);
    picture.draw(&mut mirror, &Camera::default(), 0.0, 0.0);
    let places: Vec<_> = (0..64).map(|n| [n as f32 + 0.5, 0.0, 31.7, 0.0]).collect();
    let body =
        "let kind = kind_at(at.xz); return vec4<f32>(f32(kind), kinds.list[kind].wind_bend_rad, kinds_blended(at.xz).wind_bend_rad, 0.0);";
    for (at, [kind, bend_rad, blended_rad, _]) in places.iter().zip(probe(&gpu, &picture, body, &places)) {
        assert_eq!(bend_rad, [0.5, 0.2, 1.0][kind as usize]);
        assert!((0.2 - 1e-6..=1.0 + 1e-6).contains(&blended_rad));
        // Borders are ragged, over less than two pixels of 4 m.
        if (at[0] - 32.0).abs() > 8.0 {
            assert_eq!(kind, if at[0] < 32.0 { 1.0 } else { 2.0 }, "at {at:?}");
            assert!((blended_rad - bend_rad).abs() < 1e-6, "at {at:?}");
        }
    }
}

#[test]
fn petals_stand_at_065_of_the_height_of_the_blade_whose_place_they_take() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let mut picture = OffscreenRenderer::new(&gpu, [16, 16], Quality::Low);
    let mut mirror = meadow(0.0);
    picture.draw(&mut mirror, &Camera::default(), 0.0, 0.0);
    let body = "let grid = vec2<i32>(at.xy);
        let place = 8.0 * at.xy + 8.0 * random3(grid, u32(at.z)).xy;
        let blade = plant_at(grid, u32(at.z), place, false);
        let flower = plant_at(grid, u32(at.z), place, true);
        return vec4<f32>(blade.height_m, flower.height_m, blade.frequency_rad_per_s, flower.frequency_rad_per_s);";
    let places: Vec<_> = (0..4000).map(|n| [(n % 8) as f32, (n / 8 % 8) as f32, (n / 64) as f32, 0.0]).collect();
    let found = probe_in(&gpu, &picture, "plants/bend", body, &places);
    let plants = mirror.decoded_scene().expect("a scene").scene().plants;
    for [blade_m, flower_m, blade_rad_per_s, flower_rad_per_s] in &found {
        assert!((0.5999..0.7001).contains(&(flower_m / blade_m)), "{flower_m} m over {blade_m} m");
        assert!((flower_rad_per_s / blade_rad_per_s - 0.55_f32.sqrt()).abs() < 1e-4, "heavier, so slower");
        assert!(*blade_m < plants.height_m * plants.most_grown(), "{blade_m} m");
        // As in `Scene::blade_step_secs`.
        let least_m = plants.height_m * (1.0 - plants.height_variation) * 0.72 * 0.78;
        assert!(
            *blade_m > least_m
                && (blade_rad_per_s * blade_m / plants.height_m / plants.swing_hz / std::f32::consts::TAU - 1.0).abs() < 1e-4
        );
    }
    let mean = |of: usize| found.iter().map(|found| found[of]).sum::<f32>() / found.len() as f32;
    assert!((mean(1) / mean(0) - 0.65).abs() < 0.005, "{} m over {} m", mean(1), mean(0));
}

#[test]
fn as_many_flowers_stand_as_the_scene_says_and_all_are_listed() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let camera = Camera { eye_m: Vec3::new(32.0, 1.0, 32.0), ..Camera::default() };
    for (flowers_per_m2, far) in [(0.6, FarPlants::Land), (8.0, FarPlants::Land), (50.0, FarPlants::Land), (50.0, FarPlants::Clumps)] {
        let mut mirror = meadow_of(|scene| scene.plants.flowers_per_m2 = flowers_per_m2, &[255; 16 * 16]);
        // Tall enough for every head to be visible.
        let mut picture = OffscreenRenderer::new(&gpu, [16, 2048], Quality::Low);
        picture.set_options(RenderOptions { culls: false, far_plants: far, ..RenderOptions::default() });
        picture.draw(&mut mirror, &camera, 0.0, 0.0);
        let blades = &picture.renderer.scene.as_ref().and_then(|scene| scene.blades.as_ref()).expect("grass");
        let bytes = read(&gpu, &blades.listed.counters);
        let &[fine, coarse, single, near_heads, far_heads] = bytemuck::cast_slice::<u8, u32>(&bytes) else { panic!("five lists") };
        let heads = near_heads + far_heads;
        let [fine_limit, others_limit, heads_limit] = blades.capacities;
        assert!(fine <= fine_limit && coarse + single <= others_limit && heads <= heads_limit, "{bytes:?} of {:?}", blades.capacities);
        // All those within the distance of full density, and some of those beyond.
        let near_m2 = std::f32::consts::PI * 4.0;
        assert!(heads as f32 > flowers_per_m2 * near_m2 * 1.1, "{heads} heads");

        let of_grid = 1024 + (flowers_per_m2 * 64.0).round() as u32;
        let lot = blades::flower_probability(flowers_per_m2 * 64.0, of_grid);
        let power = blades::FLOWER_POWER;
        let body = format!("return vec4<f32>(select(0.0, 1.0, is_flower(vec2<i32>(at.xy), u32(at.z), {lot:?}, {power:?})));");
        let places: Vec<_> = (0..of_grid * 15).map(|n| [(n / of_grid) as f32, 3.0, (n % of_grid) as f32, 0.0]).collect();
        let found = probe_in(&gpu, &picture, "plants/bend", &body, &places);
        let flowers = found.iter().map(|found| found[0]).sum::<f32>() / (15.0 * 64.0);
        assert!((flowers / flowers_per_m2 - 1.0).abs() < 0.03 + 4.0 / (flowers_per_m2 * 960.0).sqrt(), "{flowers} of {flowers_per_m2}");
    }
}

#[test]
fn the_last_blades_shrink_away_where_nothing_stands_for_them() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let camera = Camera { eye_m: Vec3::new(32.0, 1.0, 32.0), ..Camera::default() };
    // Mean length of blades near their maximum distance, relative to those halfway.
    let left = |far: FarPlants, reach_m: f32| {
        let mut mirror = meadow_of(|scene| scene.plants.flowers_per_m2 = 0.0, &[255; 16 * 16]);
        let mut picture = OffscreenRenderer::new(&gpu, [64, 2048], Quality::Low);
        picture.set_options(RenderOptions { culls: false, far_plants: far, ..RenderOptions::default() });
        picture.draw(&mut mirror, &camera, 0.0, 0.0);
        let blades = &picture.renderer.scene.as_ref().and_then(|scene| scene.blades.as_ref()).expect("grass");
        let listed: Vec<[f32; 28]> = bytemuck::pod_collect_to_vec(&read(&gpu, &blades.listed.blades));
        let mean_m = |from: f32, to: f32| {
            let lengths_m = listed.iter().filter_map(|blade| {
                let away = Vec3::from_slice(blade).distance(camera.eye_m) / reach_m;
                let tip = Vec3::new(blade[12], blade[13], blade[14]);
                (tip != Vec3::ZERO && (from..to).contains(&away)).then(|| tip.length())
            });
            let (sum, count) = lengths_m.fold((0.0, 0), |(sum, count), length_m| (sum + length_m, count + 1));
            assert!(count > 50, "{count} blades from {from} to {to} of {reach_m} m, {far:?}");
            sum / count as f32
        };
        mean_m(0.95, 1.0) / mean_m(0.5, 0.7)
    };
    let (shrunk, faded) = (left(FarPlants::Land, 55.0), left(FarPlants::Clumps, 55.0 * 0.35));
    assert!(shrunk < 0.3 && faded > 0.8, "{shrunk} and {faded}");
}

#[test]
fn every_quality_has_room_for_the_same_plants_near_by_and_draws_them_in_one_turn() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let lawn = |scene: &mut Scene| (scene.plants.grid_m, scene.plants.plants_per_side, scene.plants.flowers_per_m2) = (4.0, 20, 0.0);
    let mut mirror = meadow_of(lawn, &[255; 16 * 16]);
    for quality in Quality::ALL {
        let mut picture = OffscreenRenderer::new(&gpu, [16, 16], quality);
        picture.set_options(RenderOptions { culls: false, ..RenderOptions::default() });
        picture.draw(&mut mirror, &Camera::default(), 0.0, 0.0);
        let blades = &picture.renderer.scene.as_ref().and_then(|scene| scene.blades.as_ref()).expect("grass");
        assert_eq!(blades.sways.size(), 9 * (5 * 20) * (5 * 20) * blades::SWAY_BYTES, "{quality:?}");
        assert!(!blades.by_batches(), "{quality:?}");
    }
    // The scene's own defaults, too.
    let mut picture = OffscreenRenderer::new(&gpu, [16, 16], Quality::Ultra);
    picture.draw(&mut meadow(0.0), &Camera::default(), 0.0, 0.0);
    assert!(!picture.renderer.scene.as_ref().and_then(|scene| scene.blades.as_ref()).expect("grass").by_batches());
}

#[test]
fn trees_sway_by_their_height_and_keep_their_length() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let body = "let height = at.x;
        let foot = vec4<f32>(32.0, 0.0, 32.0, 1.0);
        let scaled = mat4x4<f32>(vec4<f32>(height, 0.0, 0.0, 0.0), vec4<f32>(0.0, height, 0.0, 0.0), vec4<f32>(0.0, 0.0, height, 0.0), foot);
        let tree = Instance(scaled, vec3<f32>(0.0), at.z, NO_LIMBS, 0u, 0u, 0u);
        let vertex = Vertex(vec3<f32>(0.0, at.y, 0.0), vec4<f32>(0.0), vec4<f32>(0.0), vec2<f32>(0.0));
        return vec4<f32>((placed(vertex, tree, sway_of(tree)) - foot.xyz) / height, 0.0);";
    let sway_rad = 0.07;
    let tops = [0.0, 1.5].map(|grass_bend_rad| {
        let mut mirror = meadow_of(
            |scene| {
                // More than 10 m/s near the ground, too.
                (scene.wind.mean_m_per_s, scene.grass.wind_bend_rad) = ([28.0, 0.0], grass_bend_rad);
            },
            &[255; 16 * 16],
        );
        let mut picture = OffscreenRenderer::new(&gpu, [16, 16], Quality::Low);
        picture.draw(&mut mirror, &Camera::default(), 0.0, 0.0);
        [2.0, 7.0, 60.0].map(|height_m| {
            let trunk: Vec<_> = (0..=64).map(|i| [height_m, i as f32 / 64.0, sway_rad, 0.0]).collect();
            let found: Vec<_> =
                probe_in(&gpu, &picture, "solids/objects", body, &trunk).iter().map(|at| Vec3::from_slice(&at[..3])).collect();
            let length: f32 = found.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
            assert!((length - 1.0).abs() < 2e-4, "{length} of the height of {height_m} m");
            assert!(found.iter().zip(&trunk).all(|(at, [_, up, ..])| at.y <= *up + 1e-6 && at.x >= -1e-6));
            found[64]
        })
    });
    for (top, other) in tops[0].iter().zip(tops[1]) {
        assert!(top.distance(other) < 1e-6, "the grass's own bend does not move trees");
        let aside = top.x.hypot(top.z);
        assert!((0.4 * sway_rad - 1e-4..sway_rad + 1e-4).contains(&aside), "{aside} of the height");
    }
}

#[test]
fn underbrush_follows_the_force_as_its_twin_does() {
    const SOURCE: &str = "
        @group(1) @binding(0) var<storage, read_write> cases: array<vec4<f32>>;
        @compute @workgroup_size(1) fn probe(@builtin(global_invocation_id) id: vec3<u32>) {
            let goal = cases[id.x * 2u + 1u];
            let state = cases[id.x * 2u];
            let next = followed(ForceResponse(state.xy, state.zw, 0u), goal.xy, goal.z, goal.w);
            cases[id.x * 2u] = vec4<f32>(next.pressure_pa, next.rate_pa_per_s);
        }";
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let mut mirror = meadow(0.0);
    let mut picture = OffscreenRenderer::new(&gpu, [16, 16], Quality::Low);
    picture.draw(&mut mirror, &Camera::default(), 0.0, 0.0);
    let inputs: Vec<[f32; 4]> = (0..400_u32)
        .map(|n| {
            let [a, b, c] = hash3([n, 3, 5]).map(unit);
            let [d, ..] = hash3([n, 4, 5]).map(unit);
            if n % 2 == 0 { [a * 50.0, b * 50.0 - 25.0, c * 90.0, d * 90.0 - 45.0] } else { [a * 60.0, b * 60.0, 0.1 + c, d] }
        })
        .collect();
    let found = compute(&gpu, &picture, &linked("plants/underbrush", SOURCE), &[], &inputs, 200);
    for (input, found) in inputs.chunks_exact(2).zip(found.chunks_exact(2)) {
        let ([x, z, dx, dz], [goal_x, goal_z, settle_secs, dt_secs]) = (input[0], input[1]);
        let twin = Following { value: [x, 0.0, z], rate_per_s: [dx, 0.0, dz] }.followed([goal_x, 0.0, goal_z], settle_secs, dt_secs);
        let wanted = [twin.value[0], twin.value[2], twin.rate_per_s[0], twin.rate_per_s[2]];
        assert!(wanted.iter().zip(found[0]).all(|(a, b)| (a - b).abs() < 2e-3), "{:?} instead of {wanted:?}", found[0]);
    }
}
