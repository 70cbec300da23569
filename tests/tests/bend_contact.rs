//! What objects and air do to the grass: Eqs (1), (10)–(12) of 001, tracks without holes, recovery, the wash of a helicopter.

use glam::Quat;
use server::bend::air::{GroundWind, Wash};
use server::bend::contact::{bending_speed_rad_per_s, direction, terrain_limit_rad};
use server::bend::footprint::Footprint;
use server::bend::{Meadow, View};
use server::objects::{Motion, Stand};
use shared::bend::Field;
use shared::grid::PatchLayout;
use shared::scene::{Scene, VehicleKind};
use shared::terrain::HeightMap;
use shared::wire::quantise::{THETA_FULL_RAD, theta_code, theta_rad};
use std::sync::Arc;
use tests::worlds;

const DT_SECS: f32 = 1.0 / 60.0;

fn still_air() -> GroundWind {
    GroundWind::still(&worlds::scene(1))
}

/// Wind that blows east everywhere.
fn wind(scene: &Scene, m_per_s: f32) -> GroundWind {
    let mut wind = GroundWind::still(scene);
    wind.blow(1, std::iter::repeat([m_per_s, 0.0]));
    wind
}

fn meadow(scene: &Scene) -> Meadow {
    let flat = HeightMap::from_heights(2, 2, [1000.0; 2], vec![0.0; 4]);
    Meadow::new(scene, Arc::new(flat))
}

/// A step of a car that heads along `(sin, cos)` of a heading at a speed.
fn drive(from_m: [f32; 2], heading_rad: f32, speed_m_per_s: f32) -> Motion {
    let (sin, cos) = heading_rad.sin_cos();
    let stand = |[x, z]: [f32; 2]| Stand { position_m: [x, 0.7, z], rotation: Quat::from_rotation_y(-heading_rad).to_array() };
    let moved = speed_m_per_s * DT_SECS;
    let to_m = [from_m[0] + sin * moved, from_m[1] - cos * moved];
    let velocity_m_per_s = [sin * speed_m_per_s, 0.0, -cos * speed_m_per_s];
    Motion { kind: VehicleKind::Car, from: stand(from_m), to: stand(to_m), velocity_m_per_s }
}

#[test]
fn the_bending_speed_is_that_of_eq_12() {
    // A car at 20 m/s that strikes upright grass at 0.3 m; the same grass at 60° has cos² = 1/4.
    assert!((bending_speed_rad_per_s(20.0, 0.0, 0.3) - 66.6667).abs() < 1e-3);
    assert!((bending_speed_rad_per_s(20.0, std::f32::consts::FRAC_PI_3, 0.3) - 16.6667).abs() < 1e-3);
    assert!(bending_speed_rad_per_s(20.0, std::f32::consts::FRAC_PI_2, 0.3).abs() < 1e-9);
}

#[test]
fn directions_are_those_of_fig_7() {
    let hull = Footprint::around(vec![[0.0, 0.0], [4.0, 0.0], [4.0, 8.0], [0.0, 8.0]]);
    let at = |x: f32, z: f32| direction([0.0, -1.0], [x, z], &hull.sides(), 1.0);
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let close = |found: [f32; 2], wanted: [f32; 2]| (0..2).all(|axis| (found[axis] - wanted[axis]).abs() < 1e-6);
    assert!(close(at(2.0, 4.0), [0.0, -1.0]), "the middle goes ahead");
    assert!(close(at(3.5, 4.0), [half, -half]), "the right side goes right and ahead");
    assert!(close(at(0.5, 4.0), [-half, -half]), "the left side goes left and ahead");
    assert!(close(at(2.0, 0.5), [0.0, -1.0]), "the front goes ahead");
    assert!(close(at(2.0, 7.5), [0.0, -1.0]), "the rear has no shape vector");
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
fn a_fast_car_leaves_no_hole_in_its_track() {
    for heading_rad in [0.0, 0.4, std::f32::consts::FRAC_PI_4, 1.2, 2.9] {
        let scene = worlds::scene(6);
        let mut meadow = meadow(&scene);
        let (mut at, (sin, cos)) = ([48.0 - 30.0 * f32::sin(heading_rad), 48.0 + 30.0 * f32::cos(heading_rad)], f32::sin_cos(heading_rad));
        let start = at;
        for _ in 0..50 {
            let motion = drive(at, heading_rad, 60.0);
            meadow.step(DT_SECS, &[motion], &[], &still_air());
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
fn a_track_rises_again_within_its_time_constant() {
    let mut scene = worlds::scene(3);
    // Bends that spread would hide the rise that is measured.
    scene.grass.c0_m_per_s = 0.0;
    scene.grass.mu_m_per_rad = 0.0;
    let mut meadow = meadow(&scene);
    let car = drive([24.0, 24.0], 0.0, 0.0);
    for _ in 0..600 {
        meadow.step(DT_SECS, &[car], &[], &still_air());
    }
    let pressed = meadow.field().bend_at(24.0, 24.0).theta;
    assert!(pressed > 1.0, "a standing car keeps the grass below it pressed: θ = {pressed}");
    assert!(meadow.field().bend_at(24.8, 24.0).theta > pressed, "wheels press harder than the body");
    let mut secs = 0.0;
    while meadow.field().bend_at(24.0, 24.0).theta > 0.1 * pressed {
        meadow.step(DT_SECS, &[], &[], &still_air());
        secs += DT_SECS;
        assert!(secs < 60.0, "the track does not rise");
    }
    // The slow root of s² + k·s + κ.
    let (k, kappa) = (scene.grass.theta_damping_per_s, scene.grass.stiffness_per_s2);
    let slow_per_s = 0.5 * (k - (k * k - 4.0 * kappa).sqrt());
    let expected = std::f32::consts::LN_10 / slow_per_s;
    assert!((secs / expected - 1.0).abs() < 0.05, "rose to a tenth in {secs} s, expected {expected} s");
    let mut last_rad = 0.0;
    for _ in 0..3600 {
        last_rad = meadow.field().awake().map(|(_, patch)| patch.extremes().theta_rad).reduce(f32::max).unwrap_or(last_rad);
        meadow.step(DT_SECS, &[], &[], &still_air());
    }
    assert_eq!(meadow.field().awake_count(), 0, "grass at rest sleeps");
    assert_eq!(theta_code(last_rad), 0, "the last patch that fell asleep was bent by {last_rad} rad, which is seen");
}

#[test]
fn the_wash_is_weaker_and_smaller_the_higher_the_helicopter() {
    let bent = |height_m: f32| {
        let mut field = Field::new(PatchLayout { count: [2, 2], cells: 64, cell_m: 0.25 });
        (0..4).for_each(|index| {
            field.wake(index);
        });
        let wash = Wash::below([16.0, 16.0], height_m);
        for _ in 0..120 {
            wash.map(|wash| wash.press(&mut field, &still_air(), DT_SECS));
        }
        let cells = field.awake().map(|(_, patch)| patch.channels()[0].iter().filter(|theta| **theta > 0.02).count()).sum::<usize>();
        let largest = field.awake().map(|(_, patch)| patch.extremes().theta_rad).fold(0.0, f32::max);
        let east = field.bend_at(20.0, 16.1);
        assert!(wash.is_none() || (east.omega[0] > 0.0 && east.omega[0] > 5.0 * east.omega[1].abs()), "outward: {east:?}");
        (cells, largest)
    };
    let steps = [0.0, 5.0, 12.0, 20.0].map(bent);
    for pair in steps.windows(2) {
        assert!(pair[1].0 < pair[0].0 && pair[1].1 < pair[0].1, "{steps:?}");
    }
    assert_eq!(bent(40.0), (0, 0.0));
}

#[test]
fn wind_wakes_no_patch_and_wipes_no_track_out() {
    let mut scene = worlds::scene(4);
    scene.grass.mu_m_per_rad = 0.0;
    let track = |wind: &GroundWind| {
        let mut meadow = meadow(&scene);
        for _ in 0..60 {
            meadow.step(DT_SECS, &[], &[], wind);
        }
        assert_eq!(meadow.field().awake_count(), 0);
        let car = drive([32.0, 32.0], std::f32::consts::FRAC_PI_2, 0.0);
        for _ in 0..300 {
            meadow.step(DT_SECS, &[car], &[], wind);
        }
        // What the field holds and what the wind does add up to how far the wheel presses, in any wind.
        let field = meadow.field().bend_at(32.0, 32.8);
        let along = field.omega.map(|omega| omega / (field.omega[0] * field.omega[0] + field.omega[1] * field.omega[1]).sqrt());
        let [lean_x, lean_z] = wind.lean_rad([32.0, 32.8]);
        let [x, z] = [along[0] * field.theta + lean_x, along[1] * field.theta + lean_z];
        let pressed = (x * x + z * z).sqrt();
        for _ in 0..120 {
            meadow.step(DT_SECS, &[], &[], wind);
        }
        (pressed, meadow.field().bend_at(32.0, 32.8).theta / field.theta)
    };
    let (calm, windy) = (track(&wind(&scene, 0.0)), track(&wind(&scene, 8.0)));
    assert!(calm.0 > 1.0 && (calm.0 - windy.0).abs() < 0.05, "pressed by {} rad in calm air and {} in wind", calm.0, windy.0);
    assert!(calm.1 > 0.45 && (calm.1 - windy.1).abs() < 0.1, "after two seconds {} and {} of the track is left", calm.1, windy.1);
}

#[test]
fn no_more_patches_are_awake_than_allowed_and_the_farthest_go_first() {
    let mut scene = worlds::scene(12);
    scene.patches.awake_limit = 9;
    let mut meadow = meadow(&scene);
    let mut at = [20.0, 20.0];
    for _ in 0..400 {
        let motion = drive(at, 2.0, 25.0);
        let view = View { client: 0, eye_m: [at[0], 2.0, at[1]] };
        meadow.step(DT_SECS, &[motion], &[view], &still_air());
        assert!(meadow.field().awake_count() <= 9);
        at = motion.to.xz();
    }
    assert!(meadow.evicted() > 0);
    assert_eq!(meadow.field().bend_at(20.5, 20.0).theta, 0.0, "the start of the track, far from the camera, is let go");
    assert!(meadow.field().bend_at(at[0], at[1]).theta > 0.0, "its end is kept");
}

#[test]
fn the_wire_has_room_for_grass_that_lies_against_the_strongest_wind() {
    let mut scene = worlds::scene(4);
    scene.grass.wind_bend_rad = 1.5;
    let mut meadow = meadow(&scene);
    let (wind, mut at) = (wind(&scene, 20.0), [50.0, 32.0]);
    for _ in 0..60 {
        let motion = drive(at, -std::f32::consts::FRAC_PI_2, 15.0);
        meadow.step(DT_SECS, &[motion], &[], &wind);
        at = motion.to.xz();
    }
    let largest_rad = meadow.field().awake().map(|(_, patch)| patch.extremes().theta_rad).fold(0.0, f32::max);
    assert!(largest_rad > 2.5, "grass pressed westward departs by {largest_rad} rad from where the wind holds it");
    let error_rad = (theta_rad(theta_code(largest_rad)) - largest_rad).abs();
    assert!(error_rad <= THETA_FULL_RAD / 254.0 * 1.0001, "{largest_rad} rad come back {error_rad} rad off");
}
