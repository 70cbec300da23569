//! The patch of grass that repeats where no camera is near: it depends on the step alone, and is moved by the gusts of the grass near cameras.

use prairie_core::bend::{Edges, Scheme, Serial, WaveParams};
use prairie_core::grass::wind_drawing::WindDrawings;
use prairie_core::grass::{BendSimulation, Camera, RepeatedPatch};
use prairie_core::scene::{NaturalWind, Patches, Scene, TerrainMaps};
use prairie_core::terrain::{CoverMap, HeightMap, KindMap, grey_png};
use prairie_core::wind::WindField;
use std::sync::Arc;

const DT_SECS: f32 = 1.0 / 30.0;
const ALL: u32 = u32::MAX;
const WIND: NaturalWind = NaturalWind { strength_rad_per_s2: 1.5, scale_m: 16.0, drift_m_per_s: [4.0, 1.5], reach_m: 200.0 };

/// 8 × 8 patches of 16 m of flat grassland without edges, as large as the period of gusts of 16 m.
fn scene(natural_wind: NaturalWind, waves: WaveParams) -> Scene {
    let terrain = TerrainMaps { height_map: String::new(), covering_map: String::new(), pixel_m: [128.0; 2], level_m: 0.1, base_m: 0.0 };
    let mut scene = Scene { natural_wind, seed: 5, tick_hz: 30.0, ..Scene::new(terrain) };
    scene.patches = Patches { count: [8; 2], cells: 32, cell_m: 0.5, ..Patches::default() };
    scene.bend.edges = Edges::Wrapped;
    scene.grass.waves = waves;
    scene
}

fn patch(natural_wind: NaturalWind, waves: WaveParams) -> Option<RepeatedPatch> {
    RepeatedPatch::new(&scene(natural_wind, waves))
}

/// Leans of the cells along X and Z (rad), row by row.
fn leans_rad(patch: &RepeatedPatch) -> Vec<[f32; 2]> {
    let (_, patch) = patch.shown().expect("grass at the wanted time");
    let side = patch.side();
    (0..side * side).map(|n| patch.bend(n % side, n / side).lean_rad()).collect()
}

fn at(tick: u64, waves: WaveParams) -> Vec<[f32; 2]> {
    let mut patch = patch(WIND, waves).expect("gusts");
    assert!(patch.advance_to(tick, ALL));
    leans_rad(&patch)
}

/// Part of `a` and `b` that is common: their correlation, and the ratio of their root mean squares.
fn likeness(a: &[[f32; 2]], b: &[[f32; 2]]) -> (f32, f32) {
    let product = |a: &[[f32; 2]], b: &[[f32; 2]]| a.iter().zip(b).map(|(a, b)| f64::from(a[0] * b[0] + a[1] * b[1])).sum::<f64>();
    let (aa, bb) = (product(a, a), product(b, b));
    ((product(a, b) / (aa * bb).sqrt()) as f32, (aa / bb).sqrt() as f32)
}

#[test]
fn the_grass_depends_on_the_step_alone() {
    // Fast waves need several sub-steps in a step.
    for waves in [WaveParams::default(), WaveParams { c0_m_per_s: 40.0, stiffness_per_s2: 3.0, ..WaveParams::default() }] {
        let mut patch = patch(WIND, waves).expect("gusts");
        // Windows are six time constants long: of 4.8 s, and of 1.8 s.
        let window = (6.0 * patch.recovery_secs() / DT_SECS).round() as u64;
        assert!((300..900).contains(&window), "{window} steps");
        // At the start, step by step from a window into the next, a window farther, far on, and back again.
        for tick in [0, window - 2, window - 1, window, window + 1, 2 * window, 40 * window, window / 3] {
            assert!(patch.advance_to(tick, ALL));
            assert!(leans_rad(&patch) == at(tick, waves), "after {tick} steps of {waves:?}");
        }
        assert!(at(360, waves) != at(361, waves));
    }
}

#[test]
fn any_step_and_any_grass_of_a_scene_can_be_shown() {
    let shown = |scene: &Scene, tick: u64| {
        let mut patch = RepeatedPatch::new(scene).expect("gusts");
        assert!(patch.advance_to(tick, ALL));
        let leans = leans_rad(&patch);
        assert!(leans.iter().flatten().all(|lean| lean.abs() < 3.2), "{:?}", scene.grass.waves);
        leans.iter().flatten().fold(0.0_f32, |most, lean| most.max(lean.abs()))
    };
    let stiff = WaveParams { theta_damping_per_s: 200.0, stiffness_per_s2: 4000.0, omega_damping_per_s: 200.0, ..WaveParams::default() };
    let mut scene = scene(NaturalWind { drift_m_per_s: [40.0, -40.0], ..WIND }, WaveParams::default());
    for tick in [1 << 32, 1 << 53, u64::MAX] {
        assert!(shown(&scene, tick) > 0.05, "after {tick} steps");
    }
    // Verlet's scheme would be unstable in steps of 1/30 s; it is not in those of the world. A push holds 5 mrad, and more in long steps of damped grass.
    scene = Scene { tick_hz: 240.0, natural_wind: NaturalWind { strength_rad_per_s2: 20.0, ..WIND }, ..scene };
    scene.bend.scheme = Scheme::Verlet;
    scene.grass.waves = stiff;
    let most = shown(&scene, 2400);
    assert!(most > 1e-3 && most < 0.05, "{most} rad");
}

#[test]
fn the_way_there_may_be_taken_in_parts() {
    let mut patch = patch(WIND, WaveParams::default()).expect("gusts");
    let mut calls = 1;
    while !patch.advance_to(1500, 100) {
        assert!(patch.shown().is_none(), "nothing is shown on the way");
        calls += 1;
    }
    // Between one window of 870 steps and two.
    assert!((9..=17).contains(&calls), "{calls} calls");
    assert!(leans_rad(&patch) == at(1500, WaveParams::default()));
    assert!(!patch.advance_to(1560, 30) && patch.shown().is_none());
    assert!(patch.advance_to(1560, 30) && leans_rad(&patch) == at(1560, WaveParams::default()));
}

/// Bounds set before measuring: what a viewer takes for the same gusts. The controls are the same grass 4 s later, and 0.2 s earlier and later.
#[test]
fn it_moves_as_the_grass_near_cameras_does() {
    [30.0, 60.0].into_iter().for_each(moves_as_near_grass);
}

fn moves_as_near_grass(tick_hz: f32) {
    let waves = WaveParams { mu_m_per_rad: 0.0, ..WaveParams::default() };
    let scene = Scene { tick_hz, ..scene(WIND, waves) };
    let ticks = |secs: f32| (secs * tick_hz).round() as u64;
    let height = Arc::new(HeightMap::from_heights(2, 2, [128.0; 2], vec![0.0; 4]));
    let cover = CoverMap::from_png(&grey_png([2; 2], &[255; 4])).expect("a grey PNG");
    let still = WindField::still(&scene, Arc::new(KindMap::uniform()));
    let mut near = BendSimulation::new(&scene, height, &cover, &[], &WindDrawings::new());
    let mut repeated = RepeatedPatch::new(&scene).expect("gusts");
    let camera = Camera { client: 0, eye_m: [64.0, 2.0, 64.0] };
    for _ in 0..ticks(40.0) {
        near.step(1.0 / tick_hz, &[], &[camera], &still, &Serial);
    }
    assert_eq!(near.field().awake_count(), 64, "all grass is pushed");
    // Centres of the repeated cells of 2 m lie on corners of the cells of 0.5 m.
    assert_eq!((repeated.period_m(), RepeatedPatch::cells()), (128.0, 64));
    let corners = |x: i64, z: i64| [[0, 0], [1, 0], [0, 1], [1, 1]].map(|[dx, dz]| near.field().cell([4 * x + 1 + dx, 4 * z + 1 + dz]));
    let mean = |x, z| corners(x, z).iter().fold([0.0; 2], |sum, bend| [0, 1].map(|axis| sum[axis] + 0.25 * bend.lean_rad()[axis]));
    let near: Vec<_> = (0..64 * 64).map(|n| mean(n % 64, n / 64)).collect();
    let mut compare = |tick: u64| {
        assert!(repeated.advance_to(tick, ALL));
        likeness(&leans_rad(&repeated), &near)
    };
    let [(same, strength), (earlier, _), (soon, _), (later, _)] = [40.0, 39.8, 40.2, 44.0].map(|secs| compare(ticks(secs)));
    println!(
        "{tick_hz} Hz: correlation {same:.5}, strength {strength:.3}; 0.2 s earlier and later {earlier:.5}, {soon:.5}; 4 s later {later:.3}"
    );
    assert!(same > 0.98 && (strength - 1.0).abs() < 0.05, "correlation {same}, strength {strength}");
    assert!(later < 0.95, "correlation {later} with the grass 4 s later");
    assert!(earlier < same && soon < same, "correlations of {earlier}, {same} and {soon}: another time fits better");
}

#[test]
fn grass_without_gusts_or_without_recovery_has_none() {
    let waves = WaveParams::default();
    assert!(patch(NaturalWind { strength_rad_per_s2: 0.0, ..WIND }, waves).is_none());
    assert!(patch(WIND, WaveParams { stiffness_per_s2: 0.0, ..waves }).is_none());
    // Six times 20.2 s, and 19.8 s.
    assert!(patch(WIND, WaveParams { stiffness_per_s2: 0.297, ..waves }).is_none());
    assert!(patch(WIND, WaveParams { stiffness_per_s2: 0.305, ..waves }).is_some());
}
