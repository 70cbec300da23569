//! Balls rest, are kicked by vehicles and monsters, roll, come to rest again, and press the grass.

use prairie::charts::worlds;
use prairie::objects::{Environment, Objects};
use prairie::world::{Camera, Command, World};
use prairie_core::scene::Scene;
use prairie_core::scene::VehicleKind::{self, Ball, Car, Helicopter, Monster, Sled};
use prairie_core::wire::{Drive, ObjectPose};
use std::sync::Arc;

const AHEAD: Drive = Drive { throttle: 1.0, steer: 0.0, lift: 0.0, brake: 0.0 };

/// A scene of `count × count` patches with the given number of balls.
fn with_balls(count: u32, balls: u32) -> Scene {
    let mut scene = worlds::scene(count);
    scene.objects.balls = balls;
    scene
}

/// A scene without wind.
fn calm(mut scene: Scene) -> Scene {
    (scene.wind.mean_m_per_s, scene.wind.sources) = ([0.0; 2], 0);
    scene
}

fn balls(world: &mut World) -> Vec<ObjectPose> {
    world.snapshot().objects.into_iter().filter(|pose| pose.kind == Ball).collect()
}

fn speed(pose: &ObjectPose) -> f32 {
    let [x, y, z] = pose.velocity_m_per_s;
    (x * x + y * y + z * z).sqrt()
}

fn distance(a: &ObjectPose, b: &ObjectPose) -> f32 {
    let [x, z] = [0, 2].map(|axis| a.position_m[axis] - b.position_m[axis]);
    x.hypot(z)
}

fn run(world: &mut World, ticks: u32) {
    (0..ticks).for_each(|_| world.step(&[]));
}

/// Drives a vehicle of client 1 at the first ball from about 11 m until the ball moves; returns the speed of the ball (m/s).
fn kick(world: &mut World, kind: VehicleKind) -> f32 {
    run(world, 60);
    let [x, _, z] = balls(world)[0].position_m;
    // The first site to be tried lies 9 m east of the camera, and a vehicle put there faces away from the camera.
    world.step(&[Command::Cameras(vec![Camera { client: 1, eye_m: [x - 20.0, 2.0, z] }])]);
    world.step(&[Command::Spawn { client: 1, kind }, Command::Drive { client: 1, number: 0, drive: AHEAD }]);
    assert!(world.object_of(1).is_some(), "no room for a {}", kind.name());
    let mut fastest = 0.0_f32;
    for _ in 0..600 {
        world.step(&[]);
        let now = speed(&balls(world)[0]);
        if now < fastest && fastest > 0.1 {
            return fastest;
        }
        fastest = now;
    }
    panic!("the {} has not touched the ball in 10 s", kind.name());
}

#[test]
fn balls_start_apart_near_the_first_view_and_stay_at_rest() {
    let mut scene = with_balls(12, 20);
    scene.camera.at = [0.6, 0.4];
    let mut world = worlds::flat(&scene);
    run(&mut world, 60);
    let before = balls(&mut world);
    assert_eq!(before.len(), 20);
    let [width_m, depth_m] = scene.extent_m();
    for (n, ball) in before.iter().enumerate() {
        let [x, y, z] = ball.position_m;
        assert!((x - 0.6 * width_m).hypot(z - 0.4 * depth_m) < 40.0 && (y - 0.5).abs() < 0.02, "{ball:?}");
        assert!(before[..n].iter().all(|other| distance(ball, other) > 2.0), "{ball:?} lies in another");
    }
    run(&mut world, 1800);
    for (before, after) in before.iter().zip(balls(&mut world)) {
        assert!(distance(before, &after) < 0.01 && speed(&after) < 0.01, "{before:?} has become {after:?} in half a minute");
    }
}

#[test]
fn every_vehicle_kicks_a_ball_which_comes_to_rest_again() {
    for kind in [Car, Monster, Sled, Ball] {
        let mut world = worlds::flat(&with_balls(16, 1));
        run(&mut world, 60);
        let start = balls(&mut world)[0];
        let kicked = kick(&mut world, kind);
        let own = world.object_of(1).expect("it drives");
        let pusher = *world.snapshot().objects.iter().find(|pose| pose.id == own).expect("it has a pose");
        assert!(kicked > speed(&pusher) && kicked > 3.0, "a {} at {} m/s gives the ball {kicked} m/s", kind.name(), speed(&pusher));
        world.step(&[Command::Remove { client: 1 }]);
        run(&mut world, 1800);
        let end = balls(&mut world)[0];
        // Contact with another ball gives it backspin, which soon stops it.
        let least_m = if kind == Ball { 0.5 } else { 3.0 };
        assert!(distance(&start, &end) > least_m, "a {} sends it {} m far", kind.name(), distance(&start, &end));
        assert!(speed(&end) < 0.01 && (end.position_m[1] - 0.5).abs() < 0.05, "{end:?}");
        let turned = glam::Quat::from_array(start.rotation).angle_between(glam::Quat::from_array(end.rotation));
        assert!(turned > 0.01, "it rolls");
    }
}

#[test]
fn balls_of_every_size_are_kicked_by_cars_and_monsters() {
    for (radius_m, kind) in [0.1, 0.2, 1.0, 3.0].into_iter().flat_map(|radius_m| [Car, Monster].map(|kind| (radius_m, kind))) {
        let mut scene = with_balls(16, 1);
        scene.objects.ball_radius_m = radius_m;
        let mut world = worlds::flat(&scene);
        let kicked = kick(&mut world, kind);
        assert!(kicked > 1.0, "a {} gives a ball of {radius_m} m {kicked} m/s", kind.name());
    }
}

#[test]
fn a_ball_rolls_downhill_without_slipping_and_rests_on_a_gentle_slope() {
    let on_a_slope = |slope: f32| {
        let scene = calm(with_balls(16, 1));
        let mut world = World::new(&scene, worlds::maps(&scene, |x, _| slope * x, |_, _| 255)).expect("a sound scene");
        let start = balls(&mut world)[0];
        run(&mut world, 240);
        (start, balls(&mut world)[0])
    };
    let (start, end) = on_a_slope(0.25);
    assert!(start.position_m[0] - end.position_m[0] > 4.0 && (start.position_m[2] - end.position_m[2]).abs() < 0.5, "{end:?}");
    assert!((0.5..1.2).contains(&(end.position_m[1] - 0.25 * end.position_m[0] + 0.3)), "on the land: {end:?}");
    let (start, end) = on_a_slope(0.04);
    assert!(distance(&start, &end) < 0.1, "grass holds it: {start:?}, {end:?}");
}

#[test]
fn a_client_rolls_and_steers_a_ball() {
    let mut world = worlds::flat(&worlds::scene(24));
    world.step(&[Command::Spawn { client: 1, kind: Ball }]);
    let mut drive = |drive: Drive, ticks: u32| {
        world.step(&[Command::Drive { client: 1, number: 0, drive }]);
        run(&mut world, ticks);
        balls(&mut world)[0]
    };
    let start = drive(Drive::default(), 60);
    let rolling = drive(AHEAD, 180);
    assert!(speed(&rolling) > 5.0 && distance(&start, &rolling) > 8.0, "after 3 s: {rolling:?}");
    let [x, _, z] = rolling.velocity_m_per_s;
    let along = [rolling.part_rad.sin(), -rolling.part_rad.cos()];
    assert!(x * along[0] + z * along[1] > 0.95 * speed(&rolling), "where its driver looks");
    let turned = drive(Drive { steer: 0.5, ..AHEAD }, 90);
    let [after_x, _, after_z] = turned.velocity_m_per_s;
    assert!(x * after_z - z * after_x > 0.0, "right is from −Z to +X");
    let stopped = drive(Drive { brake: 1.0, ..Drive::default() }, 240);
    assert!(speed(&stopped) < 0.05, "{stopped:?}");
}

#[test]
fn a_rolling_ball_presses_the_grass_by_its_depth() {
    let pressed = |radius_m: f32| {
        let mut scene = worlds::scene(8);
        scene.objects.ball_radius_m = radius_m;
        let mut world = worlds::flat(&scene);
        world.step(&[Command::Spawn { client: 1, kind: Ball }, Command::Drive { client: 1, number: 0, drive: AHEAD }]);
        run(&mut world, 90);
        let [x, _, z] = balls(&mut world)[0].position_m;
        let field = world.bend().field();
        let cells = (-160..160).flat_map(|j| (-160..160).map(move |i| [i, j].map(|n| n as f32 * 0.05)));
        let bent = |[dx, dz]: [f32; 2]| field.bend_at(x + dx, z + dz).theta;
        // Just below the ball, and the area of bent ground within 0.8 m.
        let area_m2 = cells.filter(|&[dx, dz]| dx.hypot(dz) < 0.8 && bent([dx, dz]) > 0.5).count() as f32 * 0.05 * 0.05;
        let behind = world.bend().flattened().tiles();
        (bent([0.0, 0.0]), area_m2, behind)
    };
    let (small, large) = (pressed(0.15), pressed(0.8));
    assert!(small.0 > 0.8 && large.0 > 0.8, "{small:?}, {large:?}");
    assert!(large.1 > 1.5 * small.1, "bent by a small ball: {} m², by a large one: {} m²", small.1, large.1);
    assert!(small.2 > 0 && large.2 > 0, "a track stays");
}

#[test]
fn balls_count_among_the_objects() {
    let mut scene = with_balls(16, 5);
    scene.objects.limit = 6;
    let mut world = worlds::flat(&scene);
    world.step(&[Command::Spawn { client: 1, kind: Helicopter }, Command::Spawn { client: 2, kind: Car }]);
    assert!(world.object_of(1).is_some() && world.object_of(2).is_none());
    assert_eq!(world.snapshot().objects.len(), 6);
}

/// Velocity after each step (m/s) of a single ball on flat grass in a uniform wind.
fn blown(radius_m: f32, wind_m_per_s: [f32; 2], ticks: u32) -> Vec<[f32; 2]> {
    let mut scene = with_balls(24, 1);
    (scene.objects.ball_radius_m, scene.camera.at) = (radius_m, [0.2, 0.2]);
    let maps = worlds::maps(&scene, |_, _| 0.0, |_, _| 255);
    let environment = Environment { height: Arc::new(maps.height), cover: Arc::new(maps.cover), extent_m: scene.extent_m() };
    let mut objects = Objects::new(&scene, environment);
    let [east, south] = wind_m_per_s;
    // First it drops 5 cm.
    (0..240).for_each(|_| objects.step(scene.dt_secs(), |_| [0.0; 3]));
    let mut step = || {
        objects.step(scene.dt_secs(), |_| [east, 0.0, south]);
        let [x, _, z] = objects.poses()[0].velocity_m_per_s;
        [x, z]
    };
    (0..ticks).map(|_| step()).collect()
}

/// Ratio of the mass of a ball to its drag in a wind of 1 m/s (m): 8 kg/m³, at least 1 kg, drag coefficient 0.47.
fn drag_length_m(radius_m: f32) -> f32 {
    let mass_kg = (8.0 * 4.0 / 3.0 * std::f32::consts::PI * radius_m.powi(3)).max(1.0);
    mass_kg / (0.5 * 1.2 * 0.47 * std::f32::consts::PI * radius_m * radius_m)
}

#[test]
fn a_ball_reaches_the_speed_at_which_wind_and_grass_drag_balance() {
    for (radius_m, wind_m_per_s) in [(0.5, 12.0), (0.3, 9.0), (1.0, 20.0)] {
        let speeds = blown(radius_m, [0.6 * wind_m_per_s, 0.8 * wind_m_per_s], 900);
        // A rolling ball has the inertia of 7/5 of its mass. With u its speed below the wind's, u' = 0.8 − k·u², so that u = c·coth(√(0.8·k)·t + arcoth(U/c)).
        let k_per_m = 1.0 / (1.4 * drag_length_m(radius_m));
        let slowest = (0.8 / k_per_m).sqrt();
        let start = 0.5 * ((wind_m_per_s + slowest) / (wind_m_per_s - slowest)).ln();
        for (tick, [x, z]) in speeds.iter().enumerate().skip(30) {
            let secs = (tick + 1) as f32 / 60.0;
            let wanted = wind_m_per_s - slowest / ((0.8 * k_per_m).sqrt() * secs + start).tanh();
            let found = 0.6 * x + 0.8 * z;
            assert!(
                (found - wanted).abs() < 0.005 * wind_m_per_s,
                "r = {radius_m} m, {wind_m_per_s} m/s: {found} m/s instead of {wanted} after {secs} s"
            );
            assert!((0.8 * x - 0.6 * z).abs() < 0.005 * wind_m_per_s, "downwind");
        }
        let [x, z] = speeds[899];
        let end = wind_m_per_s - slowest;
        assert!((x.hypot(z) / end - 1.0).abs() < 0.02, "r = {radius_m} m: {} m/s in the end instead of {end}", x.hypot(z));
    }
}

#[test]
fn a_resting_ball_stays_in_a_breeze_and_rolls_in_a_gale() {
    for radius_m in [0.2, 0.5, 1.0] {
        // Rolling resistance of the grass: 0.8 m/s².
        let holds_m_per_s = (0.8 * 1.4 * drag_length_m(radius_m)).sqrt();
        let fastest =
            |wind_m_per_s: f32| blown(radius_m, [wind_m_per_s, 0.0], 600).into_iter().map(|[x, z]| x.hypot(z)).fold(0.0, f32::max);
        let (still, rolling) = (fastest(0.95 * holds_m_per_s), fastest(1.1 * holds_m_per_s));
        assert!(still < 0.01, "r = {radius_m} m in {} m/s goes at {still} m/s", 0.95 * holds_m_per_s);
        assert!(rolling > 0.2, "r = {radius_m} m in {} m/s goes at {rolling} m/s", 1.1 * holds_m_per_s);
    }
}

#[test]
fn grass_under_a_resting_ball_stays_pressed_while_its_patch_sleeps() {
    let scene = calm(with_balls(8, 1));
    let mut world = worlds::flat(&scene);
    let lean_rad = |world: &World, [x, z]: [f32; 2]| {
        let [x, z] = world.bend().lean_rad([x, z], &worlds::still_air(&scene));
        x.hypot(z)
    };
    run(&mut world, 900);
    let [x, _, z] = balls(&mut world)[0].position_m;
    let below = [[0.0, 0.0], [0.25, 0.0], [0.0, -0.25]].map(|[dx, dz]| [x + dx, z + dz]);
    let pressed_rad = below.map(|at_m| lean_rad(&world, at_m));
    assert_eq!(world.bend().field().awake_count(), 0);
    assert!(pressed_rad.iter().all(|&rad| rad > 0.8), "{pressed_rad:?}");
    // Two time constants of flattened grass.
    run(&mut world, 7200);
    assert_eq!(world.bend().field().awake_count(), 0);
    let later_rad = below.map(|at_m| lean_rad(&world, at_m));
    assert!(pressed_rad.iter().zip(later_rad).all(|(before, after)| (before - after).abs() < 0.15), "{pressed_rad:?}, then {later_rad:?}");
    kick(&mut world, Car);
    assert!(world.bend().field().awake_count() > 0);
    world.step(&[Command::Remove { client: 1 }]);
    run(&mut world, 7200);
    assert!(below.iter().all(|&at_m| lean_rad(&world, at_m) < 0.35), "where it lay the grass rises");
}
