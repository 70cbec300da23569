//! Contact of objects with grass: Chen & Johan, Eqs. (1) and (10)–(12), tracks without holes, recovery, independence of the tick rate.

use glam::Quat;
use prairie::bend::pool::Pool;
use prairie::charts::worlds;
use prairie_core::bend::{Bend, Patch};
use prairie_core::body::{BodyPose, Motion, MotionError};
use prairie_core::grass::bending::{bend_after_rad, bending_speed_rad_per_s, direction, terrain_limit_rad};
use prairie_core::grass::footprint::Footprint;
use prairie_core::grass::wind_drawing::WindDrawings;
use prairie_core::grass::{BendSimulation, Camera};
use prairie_core::scene::{Objects, Scene, VehicleKind};
use prairie_core::terrain::{CoverMap, HeightMap, grey_png};
use prairie_core::wind::WindField;
use prairie_core::wire::TurbulenceState;
use prairie_core::wire::quantise::CodeSteps;
use std::sync::Arc;

const DT_SECS: f32 = 1.0 / 60.0;

fn still_air() -> WindField {
    worlds::still_air(&worlds::scene(1))
}

/// A uniform wind to the east.
fn wind(scene: &Scene, m_per_s: f32) -> WindField {
    let mut wind = worlds::still_air(scene);
    let cells = wind.velocities().len();
    let codes: Vec<_> = (0..3 * cells).map(|at| if at < cells { CodeSteps::default().wind_code(m_per_s) } else { 0 }).collect();
    wind.set(&codes, &TurbulenceState::default());
    wind
}

fn meadow(scene: &Scene) -> BendSimulation {
    let flat = HeightMap::from_heights(2, 2, [1000.0; 2], vec![0.0; 4]);
    let grass = CoverMap::from_png(&grey_png([2; 2], &[255; 4])).expect("a grey PNG");
    BendSimulation::new(scene, Arc::new(flat), &grass, &prairie_vehicles::bodies(&scene.objects), &WindDrawings::new())
}

/// A scene without flattened grass: only the field bends.
fn springy(count: u32) -> Scene {
    let mut scene = worlds::scene(count);
    scene.objects.car.lays_share = 0.0;
    scene
}

/// Motion of a car in a step along `(sin, −cos)` of a heading at a speed.
fn drive(from_m: [f32; 2], heading_rad: f32, speed_m_per_s: f32) -> Motion {
    drive_for(VehicleKind::Car, from_m, heading_rad, speed_m_per_s, DT_SECS)
}

fn drive_for(kind: VehicleKind, from_m: [f32; 2], heading_rad: f32, speed_m_per_s: f32, dt_secs: f32) -> Motion {
    let (sin, cos) = heading_rad.sin_cos();
    let foot_m = Objects::default().half_extents_m(kind)[1];
    let stand = |[x, z]: [f32; 2]| BodyPose { position_m: [x, foot_m, z], rotation: Quat::from_rotation_y(-heading_rad).to_array() };
    let moved = speed_m_per_s * dt_secs;
    let to_m = [from_m[0] + sin * moved, from_m[1] - cos * moved];
    let velocity_m_per_s = [sin * speed_m_per_s, 0.0, -cos * speed_m_per_s];
    Motion { kind, from: stand(from_m), to: stand(to_m), velocity_m_per_s, part_rad: 0.0, is_at_rest: false }
}

#[test]
fn the_bending_speed_follows_eq_12() {
    // A car at 20 m/s that strikes upright grass at 0.3 m; the same grass at 60° has cos² = 1/4.
    assert!((bending_speed_rad_per_s(20.0, 0.0, 0.3) - 66.6667).abs() < 1e-3);
    assert!((bending_speed_rad_per_s(20.0, std::f32::consts::FRAC_PI_3, 0.3) - 16.6667).abs() < 1e-3);
    assert!(bending_speed_rad_per_s(20.0, std::f32::consts::FRAC_PI_2, 0.3).abs() < 1e-9);
}

#[test]
fn the_bend_follows_eqs_1_and_12_at_any_step_length() {
    // tan θ = s·t/h: 20 m/s for 1/60 s at 0.3 m is 1.1111, an angle of 48.01°.
    assert!((bend_after_rad(0.0, 20.0, 0.3, DT_SECS) - 0.837_98).abs() < 1e-5);
    assert!((bend_after_rad(std::f32::consts::FRAC_PI_4, 3.0, 0.3, 0.1) - 2.0_f32.atan()).abs() < 1e-6);
    let mut steps = 0.2;
    (0..1000).for_each(|_| steps = bend_after_rad(steps, 12.0, 0.4, 1e-4));
    assert!((steps - bend_after_rad(0.2, 12.0, 0.4, 0.1)).abs() < 1e-4);
    // Euler's steps with Eq. (12) come to the same as they shrink.
    let mut euler = 0.2_f64;
    for _ in 0..100_000 {
        euler += 12.0 * euler.cos().powi(2) / 0.4 * 1e-6;
    }
    assert!((euler as f32 - bend_after_rad(0.2, 12.0, 0.4, 0.1)).abs() < 1e-4);
}

#[test]
fn directions_match_fig_7() {
    let hull = Footprint::around(vec![[0.0, 0.0], [4.0, 0.0], [4.0, 8.0], [0.0, 8.0]]);
    let at = |x: f32, z: f32| direction([0.0, -1.0], [x, z], &hull.sides(), 1.0);
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let close = |found: [f32; 2], wanted: [f32; 2]| (0..2).all(|axis| (found[axis] - wanted[axis]).abs() < 1e-6);
    assert!(close(at(2.0, 4.0), [0.0, -1.0]), "the middle goes ahead");
    assert!(close(at(3.5, 4.0), [half, -half]), "the right side goes right and ahead");
    assert!(close(at(0.5, 4.0), [-half, -half]), "the left side goes left and ahead");
    assert!(close(at(2.0, 0.5), [0.0, -1.0]), "the front goes ahead");
    assert!(close(at(3.5, 0.5), [half, -half]), "the corner in front goes with its side");
    assert!(close(at(2.0, 7.5), [0.0, -1.0]), "the rear has no shape vector");
    assert!(close(at(0.5, 7.5), [-half, -half]), "the corner at the rear goes with its side");
}

#[test]
fn grass_bends_less_uphill() {
    let limit = |slope: f32| terrain_limit_rad(1.45, [slope, 0.0], [1.0, 0.0]);
    assert_eq!(limit(0.0), 1.45);
    assert!((limit(1.0) - (1.45 - std::f32::consts::FRAC_PI_4)).abs() < 1e-6);
    assert_eq!(limit(-1.0), std::f32::consts::FRAC_PI_2);
    assert_eq!(limit(1e9), 0.0);
}

#[test]
fn a_fast_car_leaves_no_holes_in_its_track() {
    for heading_rad in [0.0, 0.4, std::f32::consts::FRAC_PI_4, 1.2, 2.9] {
        let scene = springy(6);
        let mut meadow = meadow(&scene);
        let (mut at, (sin, cos)) = ([48.0 - 30.0 * f32::sin(heading_rad), 48.0 + 30.0 * f32::cos(heading_rad)], f32::sin_cos(heading_rad));
        let start = at;
        for _ in 0..50 {
            let motion = drive(at, heading_rad, 60.0);
            meadow.step(DT_SECS, &[motion], &[], &still_air(), &Pool);
            at = motion.to.xz();
        }
        // Along both wheels and the middle, from where the whole car has passed, every 5 cm.
        for across in [-0.8, 0.0, 0.8] {
            for along in (0..900).map(|n| 3.0 + 0.05 * n as f32) {
                let x = start[0] + sin * along + cos * across;
                let z = start[1] - cos * along + sin * across;
                let theta = meadow.field().bend_at(x, z).theta;
                assert!(theta > 0.3, "hole at {along:.2} m along, {across} m across at heading {heading_rad}: θ = {theta}");
            }
        }
    }
}

#[test]
fn a_track_recovers_within_its_time_constant() {
    let mut scene = springy(3);
    // Spreading waves would hide the recovery to be measured.
    scene.grass.waves.c0_m_per_s = 0.0;
    scene.grass.waves.mu_m_per_rad = 0.0;
    let mut meadow = meadow(&scene);
    let car = drive([24.0, 24.0], 0.0, 0.0);
    for _ in 0..600 {
        meadow.step(DT_SECS, &[car], &[], &still_air(), &Pool);
    }
    let pressed = meadow.field().bend_at(24.0, 24.0).theta;
    assert!(pressed > 1.0, "a standing car keeps the grass below it pressed: θ = {pressed}");
    assert!(meadow.field().bend_at(24.8, 24.0).theta > pressed, "wheels press harder than the body");
    let mut secs = 0.0;
    while meadow.field().bend_at(24.0, 24.0).theta > 0.1 * pressed {
        meadow.step(DT_SECS, &[], &[], &still_air(), &Pool);
        secs += DT_SECS;
        assert!(secs < 60.0, "the track does not rise");
    }
    // The slow root of s² + k·s + κ.
    let (k, kappa) = (scene.grass.waves.theta_damping_per_s, scene.grass.waves.stiffness_per_s2);
    let slow_per_s = 0.5 * (k - (k * k - 4.0 * kappa).sqrt());
    let expected = std::f32::consts::LN_10 / slow_per_s;
    assert!((secs / expected - 1.0).abs() < 0.05, "rose to a tenth in {secs} s, expected {expected} s");
    let mut last_rad = 0.0;
    for _ in 0..3600 {
        last_rad = meadow.field().awake().map(Patch::theta_max_rad).reduce(f32::max).unwrap_or(last_rad);
        meadow.step(DT_SECS, &[], &[], &still_air(), &Pool);
    }
    assert_eq!(meadow.field().awake_count(), 0, "grass at rest sleeps");
    assert_eq!(CodeSteps::default().theta_code(last_rad), 0, "the last patch that fell asleep was bent by {last_rad} rad, which is seen");
}

/// Position (m) of a car on heading [`CROSSING_RAD`] at 20 m/s after `secs`.
fn crossing_m(secs: f64) -> [f32; 2] {
    let (sin, cos) = CROSSING_RAD.sin_cos();
    let way_m = (20.0 * secs) as f32;
    [14.1 + sin * way_m, 38.3 - cos * way_m]
}

const CROSSING_RAD: f32 = 0.7;

/// Grass after such a car has driven 24 m in steps of `1/hz`: θ (rad) of every cell, and its distance behind the car's middle (m).
fn crossed(scene: &Scene, hz: u32) -> Vec<(f32, f32)> {
    let mut meadow = meadow(scene);
    let (ticks, dt_secs) = (hz * 6 / 5, 1.0 / hz as f32);
    for tick in 0..ticks {
        let [from, to] = [tick, tick + 1].map(|tick| crossing_m(f64::from(tick) / f64::from(hz)));
        let motion = drive_for(VehicleKind::Car, from, CROSSING_RAD, 20.0, dt_secs);
        let to = BodyPose { position_m: [to[0], motion.to.position_m[1], to[1]], ..motion.to };
        meadow.step(dt_secs, &[Motion { to, ..motion }], &[], &still_air(), &Pool);
    }
    let ([x_m, z_m], (sin, cos)) = (crossing_m(1.2), CROSSING_RAD.sin_cos());
    let cell = |n: i32| (n as f32 + 0.5) * 0.25;
    let cells = (0..192 * 192).map(|n| [cell(n % 192), cell(n / 192)]);
    cells.map(|[x, z]| (meadow.field().bend_at(x, z).theta, cos * (z - z_m) - sin * (x - x_m))).collect()
}

/// Largest difference of θ (rad) between two fields, on the track that the car has left, and anywhere.
fn differences_rad(a: &[(f32, f32)], b: &[(f32, f32)]) -> [f32; 2] {
    let largest = |on: fn(f32) -> bool| a.iter().zip(b).filter(|(a, _)| on(a.1)).map(|(a, b)| (a.0 - b.0).abs()).fold(0.0, f32::max);
    [largest(|behind_m| (3.0..21.0).contains(&behind_m)), largest(|_| true)]
}

/// The track is the same to rounding. At the start, two parts of the car cover the same grass, one after the other in each step; there, and where
/// waves have moved the bend, the difference is of the order of the step.
#[test]
fn a_crossing_leaves_the_same_bend_at_any_tick_rate() {
    let mut still = springy(3);
    // Contact alone: nothing spreads and nothing rises.
    (still.grass.waves.c0_m_per_s, still.grass.waves.mu_m_per_rad, still.grass.waves.c_omega_m_per_s) = (0.0, 0.0, 0.0);
    (still.grass.waves.stiffness_per_s2, still.grass.waves.omega_damping_per_s) = (0.0, 0.0);
    let contact = [20, 60, 120].map(|hz| crossed(&still, hz));
    assert!(contact[0].iter().filter(|(theta, _)| *theta > 1.0).count() > 500, "the car leaves a track");
    for (n, hz, bound_rad) in [(0, 20, 0.15), (1, 60, 0.05)] {
        let [track_rad, all_rad] = differences_rad(&contact[n], &contact[2]);
        assert!(track_rad < 1e-4 && all_rad < bound_rad, "contact alone at {hz} Hz and at 120 Hz: {track_rad} and {all_rad} rad apart");
    }
    let whole = [20, 60, 120].map(|hz| crossed(&springy(3), hz));
    for (n, hz, [track_bound_rad, bound_rad]) in [(0, 20, [0.2, 0.4]), (1, 60, [0.06, 0.1])] {
        let [track_rad, all_rad] = differences_rad(&whole[n], &whole[2]);
        assert!(
            track_rad < track_bound_rad && all_rad < bound_rad,
            "with waves at {hz} Hz and at 120 Hz: {track_rad} and {all_rad} rad apart"
        );
    }
}

#[test]
fn grass_inside_a_concave_object_stays_upright() {
    let mut scene = worlds::scene(3);
    // Contact alone: nothing spreads.
    (scene.grass.waves.c0_m_per_s, scene.grass.waves.mu_m_per_rad) = (0.0, 0.0);
    let mut meadow = meadow(&scene);
    for _ in 0..300 {
        meadow.step(DT_SECS, &[drive_for(VehicleKind::Sled, [24.0, 24.0], 0.4, 0.0, DT_SECS)], &[], &still_air(), &Pool);
    }
    let (sin, cos) = 0.4_f32.sin_cos();
    // Right and back of its middle.
    let pressed_rad = |right: f32, back: f32| {
        let at = [24.0 + cos * right - sin * back, 24.0 + sin * right + cos * back];
        let Bend { theta, .. } = meadow.field().bend_at(at[0], at[1]);
        theta
    };
    for [right, back] in [[-1.6, -2.0], [-1.6, 0.0], [1.6, 0.0], [1.6, -2.0], [0.0, 2.1], [-1.6, 2.1]] {
        assert!(pressed_rad(right, back) > 0.2, "under the frame at {right}, {back}: {}", pressed_rad(right, back));
    }
    for [right, back] in [[0.0, -2.0], [0.0, -0.5], [0.0, 0.9], [0.5, -1.0]] {
        assert!(pressed_rad(right, back) == 0.0, "inside the U at {right}, {back}: {}", pressed_rad(right, back));
    }
}

#[test]
fn invalid_motions_are_rejected_and_touch_nothing() {
    let scene = worlds::scene(4);
    let (mut told, mut spared) = (meadow(&scene), meadow(&scene));
    let sound = drive([20.0, 30.0], 0.3, 12.0);
    let far = drive_for(VehicleKind::Car, [20.0, 30.0], 0.3, 4000.0, 0.05);
    let broken: [(Motion, &str); 5] = [
        (
            Motion { velocity_m_per_s: [f32::NAN, 0.0, 1.0], ..sound },
            "`velocity_m_per_s` of a car is [NaN, 0.0, 1.0]; allowed: finite numbers",
        ),
        (Motion { from: BodyPose { position_m: [f32::INFINITY, 0.0, 0.0], ..sound.from }, ..sound }, "`from.position_m` of a car is [inf"),
        (Motion { to: BodyPose { rotation: [f32::NAN; 4], ..sound.to }, ..sound }, "`to.rotation` of a car is [NaN"),
        (
            Motion { to: BodyPose { rotation: [0.0; 4], ..sound.to }, ..sound },
            "`to.rotation` of a car is [0.0, 0.0, 0.0, 0.0]; allowed: a unit quaternion",
        ),
        (far, "a car moves 200.0 m in one step; allowed: up to 100 m"),
    ];
    for (motion, expected) in broken {
        told.step(DT_SECS, &[motion, sound], &[], &still_air(), &Pool);
        spared.step(DT_SECS, &[sound], &[], &still_air(), &Pool);
        let reasons: Vec<_> = told.rejected().iter().map(MotionError::to_string).collect();
        assert!(reasons.len() == 1 && reasons[0].starts_with(expected), "{reasons:?}");
    }
    assert_eq!((told.rejected_count(), spared.rejected_count()), (5, 0));
    assert!(
        told.field() == spared.field() && told.flattened().words().eq(spared.flattened().words()),
        "the sound motion was felt, the others not"
    );
    let mut alone = meadow(&scene);
    alone.step(DT_SECS, &[far], &[], &still_air(), &Pool);
    assert_eq!((alone.field().awake_count(), alone.flattened().tiles()), (0, 0));
}

#[test]
fn wind_wakes_no_patch_and_erases_no_track() {
    let mut scene = springy(4);
    scene.grass.waves.mu_m_per_rad = 0.0;
    let track = |wind: &WindField| {
        let mut meadow = meadow(&scene);
        for _ in 0..60 {
            meadow.step(DT_SECS, &[], &[], wind, &Pool);
        }
        assert_eq!(meadow.field().awake_count(), 0);
        let car = drive([32.0, 32.0], std::f32::consts::FRAC_PI_2, 0.0);
        for _ in 0..300 {
            meadow.step(DT_SECS, &[car], &[], wind, &Pool);
        }
        // The bends of the field and of the wind add up to the angle pressed by the wheel, in any wind.
        let field = meadow.field().bend_at(32.0, 32.8);
        let along = field.omega.map(|omega| omega / (field.omega[0] * field.omega[0] + field.omega[1] * field.omega[1]).sqrt());
        let [lean_x, lean_z] = wind.lean_at([32.0, 32.8]);
        let [x, z] = [along[0] * field.theta + lean_x, along[1] * field.theta + lean_z];
        let pressed = (x * x + z * z).sqrt();
        for _ in 0..120 {
            meadow.step(DT_SECS, &[], &[], wind, &Pool);
        }
        (pressed, meadow.field().bend_at(32.0, 32.8).theta / field.theta)
    };
    let (calm, windy) = (track(&wind(&scene, 0.0)), track(&wind(&scene, 8.0)));
    assert!(calm.0 > 1.0 && (calm.0 - windy.0).abs() < 0.05, "pressed by {} rad in calm air and {} in wind", calm.0, windy.0);
    assert!(calm.1 > 0.45 && (calm.1 - windy.1).abs() < 0.1, "after two seconds {} and {} of the track is left", calm.1, windy.1);
}

#[test]
fn the_limit_of_awake_patches_holds_and_the_farthest_sleep_first() {
    let mut scene = springy(12);
    scene.patches.awake_limit = 9;
    let mut meadow = meadow(&scene);
    let mut at = [20.0, 20.0];
    for _ in 0..400 {
        let motion = drive(at, 2.0, 25.0);
        let view = Camera { client: 0, eye_m: [at[0], 2.0, at[1]] };
        meadow.step(DT_SECS, &[motion], &[view], &still_air(), &Pool);
        assert!(meadow.field().awake_count() <= 9);
        at = motion.to.xz();
    }
    assert!(meadow.evicted() > 0);
    assert_eq!(meadow.field().bend_at(20.5, 20.0).theta, 0.0, "the start of the track, far from the camera, is let go");
    assert!(meadow.field().bend_at(at[0], at[1]).theta > 0.0, "its end is kept");
}

#[test]
fn the_wire_format_holds_grass_pressed_against_the_strongest_wind() {
    let mut scene = springy(4);
    scene.grass.wind_bend_rad = 1.5;
    let mut meadow = meadow(&scene);
    let (wind, mut at) = (wind(&scene, 20.0), [50.0, 32.0]);
    for _ in 0..60 {
        let motion = drive(at, -std::f32::consts::FRAC_PI_2, 15.0);
        meadow.step(DT_SECS, &[motion], &[], &wind, &Pool);
        at = motion.to.xz();
    }
    let largest_rad = meadow.field().awake().map(Patch::theta_max_rad).fold(0.0, f32::max);
    assert!(largest_rad > 2.5, "grass pressed westward departs by {largest_rad} rad from where the wind holds it");
    let steps = CodeSteps::default();
    let error_rad = (steps.theta_rad(steps.theta_code(largest_rad)) - largest_rad).abs();
    assert!(error_rad <= 0.5 * steps.theta_rad * 1.0001, "{largest_rad} rad come back {error_rad} rad off");
}
