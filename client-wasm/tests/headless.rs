//! Frames drawn without a window, on any Vulkan adapter, show a prairie: sky above, grass below, and a track where the bend field is not zero.

use glam::Vec3;
use prairie_client::camera::Camera;
use prairie_client::redraw::RedrawTracker;
use prairie_client::render::{Gpu, OffscreenRenderer, Quality};
use prairie_client::state::Mirror;
use prairie_core::scene::{Patches, Scene, TerrainMaps, Wind, WindDust};
use prairie_core::terrain::grey_png;
use prairie_core::wire::quantise::CodeSteps;
use prairie_core::wire::{ServerMessage, Shape, TurbulenceState, codec};

const SIZE_PX: [u32; 2] = [192, 108];

/// ID of a tree in a covering map.
const TREE: u8 = 253;

/// Frame interval (s).
const DT_SECS: f32 = 0.1;

/// A flat meadow of 64 m × 64 m, covered with `cover` everywhere.
fn meadow(cover: u8) -> Mirror {
    meadow_in(cover, Wind::default())
}

fn meadow_in(cover: u8, wind: Wind) -> Mirror {
    meadow_of(&[cover; 16 * 16], wind)
}

fn meadow_of(covering: &[u8], wind: Wind) -> Mirror {
    meadow_with(covering, |scene| scene.wind = wind)
}

fn meadow_with(covering: &[u8], change: impl FnOnce(&mut Scene)) -> Mirror {
    let maps = TerrainMaps { height_map: String::new(), covering_map: String::new(), pixel_m: [4.0, 4.0], level_m: 0.0, base_m: 0.0 };
    let mut scene = Scene { patches: Patches { count: [4, 4], ..Patches::default() }, ..Scene::new(maps) };
    change(&mut scene);
    let mut mirror = Mirror::default();
    let scene = ServerMessage::Scene {
        scene: Box::new(scene),
        height_png: grey_png([17; 2], &[0; 17 * 17]),
        covering_png: grey_png([16; 2], covering),
        nutrient_png: Vec::new(),
        models: Vec::new(),
        shapes: Default::default(),
    };
    mirror.apply(scene).expect("a valid scene");
    mirror
}

fn camera() -> Camera {
    Camera { eye_m: Vec3::new(32.0, 2.2, 40.0), pitch_rad: -0.15, ..Camera::default() }
}

fn draw(gpu: &Gpu, mirror: &mut Mirror) -> Vec<u8> {
    let mut picture = OffscreenRenderer::new(gpu, SIZE_PX, Quality::Low);
    for frame in 0..3 {
        let stats = picture.draw(mirror, &camera(), f64::from(frame) / 30.0, 1.0 / 30.0);
        // The visible part of nine grids of 160 × 160 blades and 38 flowers, thinned out beyond 2 m.
        assert!((30_000..230_742).contains(&stats.blades) && stats.ground_vertices > 0, "{stats:?}");
    }
    picture.rgba()
}

/// Mean RGB of the rows `from..to`.
fn mean(rgba: &[u8], from: u32, to: u32) -> [f32; 3] {
    let row = SIZE_PX[0] as usize * 4;
    let rows = &rgba[from as usize * row..to as usize * row];
    let count = (rows.len() / 4) as f32;
    std::array::from_fn(|channel| rows.chunks_exact(4).map(|pixel| f32::from(pixel[channel])).sum::<f32>() / count)
}

fn difference(a: &[u8], b: &[u8]) -> f32 {
    a.iter().zip(b).map(|(a, b)| f32::from(a.abs_diff(*b))).sum::<f32>() / a.len() as f32
}

#[test]
fn a_frame_shows_sky_grass_and_track() {
    let gpu = Gpu::headless().expect("a Vulkan adapter; the package mesa-vulkan-drivers contains a software one");
    let grass = draw(&gpu, &mut meadow(255));
    let [sky_red, _, sky_blue] = mean(&grass, 0, 15);
    assert!(sky_blue > sky_red + 5.0 && sky_blue > 120.0, "sky {sky_red} {sky_blue}");
    let [red, green, blue] = mean(&grass, 60, 108);
    assert!(green > red && green > blue + 20.0 && green > 30.0, "grass {red} {green} {blue}");

    let bare = draw(&gpu, &mut meadow(0));
    let [red, green, _] = mean(&bare, 60, 108);
    assert!(red > green, "bare soil {red} {green}");

    let again = draw(&gpu, &mut meadow(255));
    assert!(difference(&grass, &again) < 0.5, "drawing the same frames again gives the same picture");

    let mut trodden = meadow(255);
    let plane = |code: i16| std::iter::repeat_n(code, 64 * 64);
    let steps = CodeSteps::default();
    let codes: Vec<i16> = plane(steps.theta_code(1.4)).chain(plane(steps.omega_code(30.0))).chain(plane(0)).collect();
    for patch in 0..16 {
        let payload = codec::encode(Shape::patch(64), &codes, None);
        trodden.apply(ServerMessage::Patch { patch, seq: 1, key: true, payload }).expect("a valid patch");
    }
    let trodden = draw(&gpu, &mut trodden);
    assert!(difference(&grass, &trodden) > 6.0, "trodden grass looks different: {}", difference(&grass, &trodden));
}

#[test]
fn dust_is_drawn_only_where_it_is() {
    let gpu = Gpu::headless().expect("a Vulkan adapter; the package mesa-vulkan-drivers contains a software one");
    let wind = Wind { dust: WindDust { release_per_s: 1.0, ..WindDust::default() }, ..Wind::default() };
    // Still air over 32 × 8 × 32 cells of 8 m, with dust west of `edge_m`. Interpolation and the width of puffs extend it by some 12 m.
    let picture = |edge_m: f32| {
        let mut mirror = meadow_in(255, wind.clone());
        let mut codes = vec![0; 3 * 8192];
        codes.extend((0..8192).map(|at| if (at % 32) as f32 * 8.0 < edge_m { CodeSteps::default().dust_code(4.0) } else { 0 }));
        let payload = codec::encode(Shape::wind(32, true), &codes, None);
        mirror
            .apply(ServerMessage::Wind { tick: 1, seq: 1, key: true, turbulence: TurbulenceState::default(), payload })
            .expect("a valid wind frame");
        draw(&gpu, &mut mirror)
    };
    let (clear, dusty) = (picture(0.0), picture(16.0));
    let differing = |columns: std::ops::Range<usize>| {
        let pixels = clear.chunks_exact(4).zip(dusty.chunks_exact(4)).enumerate();
        let inside = pixels.filter(|(at, _)| columns.contains(&(at % SIZE_PX[0] as usize)));
        let (differing, all) = inside.fold((0, 0), |(n, all), (_, (a, b))| (n + usize::from(a != b), all + 1));
        differing as f32 / all as f32
    };
    // The camera looks north from x = 32 m.
    let middle = SIZE_PX[0] as usize / 2;
    assert!(differing(0..middle / 2) > 0.3, "dust in the west: {}", differing(0..middle / 2));
    assert_eq!(differing(middle..2 * middle), 0.0, "no dust in the east");
}

/// Pictures of two seconds after dust everywhere has gone at once, and of air that was always clear.
#[test]
fn dust_that_has_gone_leaves_nothing_behind() {
    let gpu = Gpu::headless().expect("a Vulkan adapter; the package mesa-vulkan-drivers contains a software one");
    let wind = Wind { dust: WindDust { release_per_s: 1.0, ..WindDust::default() }, ..Wind::default() };
    let blow = |mirror: &mut Mirror, seq: u32, concentration: f32| {
        let mut codes = vec![0; 3 * 8192];
        codes.resize(4 * 8192, CodeSteps::default().dust_code(concentration));
        let payload = codec::encode(Shape::wind(32, true), &codes, None);
        let (tick, turbulence) = (u64::from(15 * seq), TurbulenceState::default());
        mirror.apply(ServerMessage::Wind { tick, seq, key: true, turbulence, payload }).expect("a valid wind frame");
    };
    let pictures = |concentration: f32| {
        let (mut mirror, mut picture) = (meadow_in(255, wind.clone()), OffscreenRenderer::new(&gpu, SIZE_PX, Quality::Low));
        let mut draw = |mirror: &mut Mirror, frames: std::ops::Range<u32>| {
            for frame in frames {
                picture.draw(mirror, &camera(), f64::from(frame) * 0.1, 0.1);
            }
            picture.rgba()
        };
        blow(&mut mirror, 1, concentration);
        let before = draw(&mut mirror, 0..10);
        (2..6).for_each(|seq| blow(&mut mirror, seq, 0.0));
        [before, draw(&mut mirror, 10..30)]
    };
    let ([clear, still_clear], [dusty, cleared]) = (pictures(0.0), pictures(4.0));
    assert!(difference(&clear, &dusty) > 5.0, "dust is seen: {}", difference(&clear, &dusty));
    assert!(cleared == still_clear, "{} of 255 differ", difference(&cleared, &still_clear));
}

#[test]
fn a_skipped_frame_would_equal_the_previous_one() {
    let gpu = Gpu::headless().expect("a Vulkan adapter; the package mesa-vulkan-drivers contains a software one");
    let mut covering = [255; 16 * 16];
    // A visible tree.
    covering[5 * 16 + 8] = TREE;
    let mut mirror = meadow_with(&covering, |scene| {
        scene.wind.mean_m_per_s = [0.0; 2];
        (scene.plants.plants_per_side, scene.plants.swing_damping) = (12, 0.5);
    });
    let (mut picture, mut redraw) = (OffscreenRenderer::new(&gpu, [64, 36], Quality::Low), RedrawTracker::default());
    let mut time_secs = 0.0;
    while redraw.needs_frame(&mirror, &camera(), (), DT_SECS) {
        picture.draw(&mut mirror, &camera(), time_secs, DT_SECS);
        time_secs += f64::from(DT_SECS);
    }
    assert!(time_secs > 2.0, "blades need time to settle: {time_secs} s");
    let rest = picture.rgba();
    picture.draw(&mut mirror, &camera(), time_secs + 37.0, DT_SECS);
    let changed = rest.iter().zip(picture.rgba()).filter(|(a, b)| a.abs_diff(*b) > 2).count();
    assert!(changed * 10_000 < rest.len(), "{changed} of {} values changed at rest", rest.len());
}
