//! Underbrush breaks permanently under objects and in storms, and falls in the direction of the load.

use prairie::charts::worlds;
use prairie::scenes;
use prairie::snapshot::BrokenPlants;
use prairie::world::{Camera, Command, World};
use prairie_client::state::Mirror;
use prairie_core::plant::flora::Flora;
use prairie_core::scene::{Primitive, PrimitiveKind, Scene, VehicleKind, parse_underbrush};
use prairie_core::terrain::{CoverMap, grey_png};
use prairie_core::wire::quantise::{CodeSteps, heading_rad};
use prairie_core::wire::{BrokenPlant, Drive, SERVER_MESSAGE_LIMIT, ServerMessage, decode, encode};
use std::f32::consts::{PI, TAU};

const AHEAD: Drive = Drive { throttle: 1.0, steer: 0.0, lift: 0.0, brake: 0.0 };

/// A scene of `count × count` patches of flat terrain, covered with reeds.
fn reeds(count: u32) -> Scene {
    let species = parse_underbrush(include_str!("../../scenes/plants/reed-and-fern.toml")).expect("valid species");
    let mut reed = species.into_iter().next().expect("the first is the reed");
    (reed.needs, reed.light_need, reed.cover) = ([0.0; 3], 0.0, 0);
    (reed.propagation_points, reed.reach_m) = (400, 3.0);
    let mut scene = worlds::scene(count);
    scene.underbrush = vec![reed];
    scene
}

fn flora(scene: &Scene) -> Flora {
    let cover = CoverMap::from_png(&grey_png([2; 2], &[255; 4])).expect("a grey PNG");
    Flora::new(scene, &cover, None).expect("a scene with underbrush")
}

/// Sites of broken plants, in the order of their breaking.
fn sites(broken: &BrokenPlants) -> Vec<u32> {
    broken.iter().map(|plant| plant.site).collect()
}

/// Direction in which a plant fell, as a unit vector along X and Z.
fn fall(plant: &BrokenPlant) -> [f32; 2] {
    let (sine, cosine) = heading_rad(plant.fall).sin_cos();
    [cosine, sine]
}

fn run(world: &mut World, ticks: u32) {
    (0..ticks).for_each(|_| world.step(&[]));
}

/// Drives a vehicle of client 1 eastward for `ticks` steps; returns its position after each.
fn drive(world: &mut World, kind: VehicleKind, ticks: u32) -> Vec<[f32; 2]> {
    world.step(&[Command::Cameras(vec![Camera { client: 1, eye_m: [30.0, 2.0, 64.0] }])]);
    world.step(&[Command::Spawn { client: 1, kind }, Command::Drive { client: 1, number: 0, drive: AHEAD }]);
    let id = world.object_of(1).expect("there is room");
    let mut place = || {
        world.step(&[]);
        let [x, _, z] = world.snapshot().objects.into_iter().find(|pose| pose.id == id).expect("it has a pose").position_m;
        [x, z]
    };
    (0..ticks).map(|_| place()).collect()
}

#[test]
fn a_car_breaks_reeds_permanently() {
    let scene = reeds(8);
    let (mut world, flora) = (worlds::flat(&scene), flora(&scene));
    let way = drive(&mut world, VehicleKind::Car, 300);
    let all = world.snapshot().broken;
    let broken = sites(&all);
    let from_way_m = |site: u32| {
        let [x, z] = flora.grown().sites.place_m(site);
        way.iter().map(|at| (at[0] - x).hypot(at[1] - z)).fold(f32::INFINITY, f32::min)
    };
    assert!(broken.len() > 20, "{} broken", broken.len());
    for &site in &broken {
        assert!(flora.grown().plant_at(site).is_some(), "a plant grows at site {site}");
        assert!(from_way_m(site) < 2.6, "site {site} lies {} m from the way", from_way_m(site));
    }
    // Below the wheels, where the grass is pressed most, no plant is left.
    let below_wheels = |at: [f32; 2]| {
        let passed = way[30..270].iter().any(|place| (place[0] - at[0]).abs() < 0.5);
        let across_m = (at[1] - way[0][1]).abs();
        passed && (0.72..0.88).contains(&across_m)
    };
    let under: Vec<_> = flora.grown().plants().iter().filter(|plant| below_wheels(flora.grown().sites.place_m(plant.site))).collect();
    let straight = way.iter().all(|at| (at[1] - way[0][1]).abs() < 0.05);
    assert!(straight && under.len() >= 10, "{} reeds below the wheels", under.len());
    assert!(under.iter().all(|plant| broken.contains(&plant.site)), "all of {} below the wheels", under.len());

    let mut sorted = broken.clone();
    sorted.sort_unstable();
    sorted.dedup();
    assert_eq!(sorted.len(), broken.len(), "each breaks once");
    world.step(&[Command::Remove { client: 1 }]);
    run(&mut world, 1200);
    assert_eq!(world.snapshot().broken, all, "nothing heals, and nothing breaks by itself");
    drive(&mut world, VehicleKind::Car, 200);
    assert!(sites(&world.snapshot().broken).starts_with(&broken), "what breaks later comes after");
}

/// A scene without wind.
fn calm(mut scene: Scene) -> Scene {
    (scene.wind.mean_m_per_s, scene.wind.sources) = ([0.0; 2], 0);
    scene
}

/// A client mirror of the scene on flat terrain, covered with grass.
fn mirror(scene: &Scene) -> Mirror {
    let pixels = scene.extent_m().map(|extent| (extent / scene.terrain.pixel_m[0]) as u32 + 1);
    let map = |level: u8| grey_png(pixels, &vec![level; (pixels[0] * pixels[1]) as usize]);
    let mut mirror = Mirror::default();
    let scene = ServerMessage::Scene {
        scene: Box::new(scene.clone()),
        height_png: map(0),
        covering_png: map(255),
        nutrient_png: Vec::new(),
        models: Vec::new(),
        shapes: Default::default(),
    };
    mirror.apply(scene).expect("a sound scene");
    mirror
}

#[test]
fn broken_plants_fall_in_the_direction_of_the_car_and_so_they_do_in_the_mirror() {
    let scene = calm(reeds(8));
    let (mut world, flora, still) = (worlds::flat(&scene), flora(&scene), worlds::still_air(&scene));
    drive(&mut world, VehicleKind::Car, 20);
    let (mut known, mut told) = (0, Vec::new());
    let mut mirror = mirror(&scene);
    for _ in 0..240 {
        world.step(&[]);
        let broken = world.snapshot().broken;
        // Plants broken in this step lie in the car's direction of travel or, where the grass leans further than the car's floor presses it, in the
        // direction of that lean.
        for plant in broken.iter().skip(known) {
            let [x, z] = world.bend().lean_rad(flora.grown().sites.place_m(plant.site), &still);
            let off_rad = (heading_rad(plant.fall) - z.atan2(x) + PI).rem_euclid(TAU) - PI;
            let is_ahead = fall(plant)[0] > 0.999;
            assert!(is_ahead || off_rad.abs() <= TAU / 510.0 + 1e-5, "{plant:?} fell {off_rad} rad beside the lean of {x}, {z}");
        }
        let bytes = encode(&ServerMessage::Broken { plants: broken.after(known).to_vec() });
        mirror.apply(decode(&bytes, SERVER_MESSAGE_LIMIT).expect("a whole message")).expect("sites of the scene");
        known = broken.len();
        told = broken.iter().copied().collect();
    }
    assert!(told.len() > 20 && mirror.broken_count() as usize == told.len(), "{} broken", told.len());
    assert!(told.iter().all(|plant| mirror.falls()[plant.site as usize] == plant.fall.get()));
    assert_eq!(mirror.falls().iter().filter(|fall| **fall != 0).count(), told.len());
    // The car drives eastward; its corners push aside the plants they meet.
    assert!(told.iter().all(|plant| fall(plant)[0] > 0.2), "none falls against the way");
    let ahead = told.iter().filter(|plant| fall(plant)[0] > 0.9).count();
    assert!(2 * ahead > told.len(), "{ahead} of {} fall ahead", told.len());
}

#[test]
fn neither_gales_nor_downwash_break_plants() {
    let mut scene = reeds(6);
    // 21 m/s at a height of 10 m.
    scene.wind.mean_m_per_s = [20.0, 7.0];
    scene.grass.wind_bend_rad = 1.5;
    let mut world = worlds::flat(&scene);
    run(&mut world, 300);
    assert!(world.snapshot().broken.is_empty(), "a gale");
    world.step(&[Command::Spawn { client: 1, kind: VehicleKind::Helicopter }]);
    let hover = Drive { lift: 1.0, ..Drive::default() };
    world.step(&[Command::Drive { client: 1, number: 0, drive: hover }]);
    run(&mut world, 90);
    let lifted = world.snapshot().broken;
    world.step(&[Command::Drive { client: 1, number: 0, drive: AHEAD }]);
    run(&mut world, 300);
    assert!(world.bend().field().awake_count() > 0, "the wash bends the grass");
    assert_eq!(world.snapshot().broken, lifted, "a wash");
}

/// A cyclone that travels eastward along z = 64 m, without any other wind.
fn cyclone(scene: Scene) -> Scene {
    let mut scene = calm(scene);
    (scene.wind.cells, scene.wind.spacing_m) = ([32, 8, 32], [4.0, 2.0, 4.0]);
    let whirl = Primitive::new(PrimitiveKind::Cyclone, [10.0, 6.0, 64.0]);
    scene.wind.primitives = vec![Primitive { radius_m: 26.0, speed_m_per_s: 40.0, drift_m_per_s: [6.0, 0.0], ..whirl }];
    scene
}

#[test]
fn a_moving_cyclone_leaves_a_trail_of_broken_reeds() {
    let scene = cyclone(reeds(8));
    let (mut world, flora) = (worlds::flat(&scene), flora(&scene));
    let places = |broken: &[BrokenPlant]| broken.iter().map(|plant| flora.grown().sites.place_m(plant.site)).collect::<Vec<_>>();
    let mean = |of: fn(&[f32; 2]) -> f32, all: &[[f32; 2]]| all.iter().map(of).sum::<f32>() / all.len() as f32;
    // The wind has blown for 6 s when the world starts: 46 m to 66 m, then on to 86 m.
    run(&mut world, 200);
    let first = world.snapshot().broken;
    run(&mut world, 200);
    let all: Vec<BrokenPlant> = world.snapshot().broken.iter().copied().collect();
    let (early, late) = all.split_at(first.len());
    assert!(early.len() > 300 && late.len() > 300, "{} and {} of {} broken", early.len(), late.len(), flora.grown().plants().len());
    for [x, z] in places(&all) {
        let beside_m = (z - 64.0).hypot(x - x.clamp(46.0, 86.0));
        assert!(beside_m < 26.0, "one broke at {x} m, {z} m");
    }
    let [from_m, to_m] = [early, late].map(|broken| mean(|at| at[0], &places(broken)));
    assert!(to_m > from_m + 15.0, "broken about {from_m} m first, then about {to_m} m");
    // The cyclone turns anticlockwise seen from above: eastward in the south.
    let eastward = |south: f32| {
        let there = all.iter().zip(places(&all)).filter(|(_, at)| south * (at[1] - 64.0) > 4.0);
        let falls: Vec<f32> = there.map(|(plant, _)| fall(plant)[0]).collect();
        falls.iter().sum::<f32>() / falls.len() as f32
    };
    assert!(eastward(1.0) > 0.3 && eastward(-1.0) < -0.3, "{} in the south, {} in the north", eastward(1.0), eastward(-1.0));
}

#[test]
fn plants_without_a_strength_never_break_and_a_ball_breaks_weak_ones() {
    let mut scene = reeds(8);
    scene.underbrush[0].components.iter_mut().for_each(|component| component.strength_n_m = 0.0);
    let mut world = worlds::flat(&scene);
    drive(&mut world, VehicleKind::Car, 300);
    assert!(world.snapshot().broken.is_empty());
    let stalk = &mut scene.underbrush[0].components[0];
    stalk.strength_n_m = 0.5 * stalk.stiffness_n_m2 / stalk.length_m;
    let mut world = worlds::flat(&scene);
    drive(&mut world, VehicleKind::Ball, 300);
    assert!(!world.snapshot().broken.is_empty());
}

#[test]
fn the_same_plants_break_on_any_number_of_threads() {
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can be started");
        pool.install(|| {
            let mut scene = reeds(8);
            (scene.objects.self_driving, scene.objects.balls) = (4, 3);
            let mut world = worlds::hills(&scene);
            run(&mut world, 400);
            (world.snapshot().broken, world.checksum())
        })
    };
    let once = run(1);
    assert!(once.0.len() > 20, "{} broken", once.0.len());
    assert!(once == run(1) && once == run(2));
}

#[test]
fn the_wind_of_the_underbrush_scene_breaks_nothing() {
    let mut loaded = scenes::load("underbrush").expect("a built-in scene is sound");
    // Balls lie on plants.
    loaded.scene.objects.balls = 0;
    let mut world = World::new(&loaded.scene, loaded.maps()).expect("a world");
    run(&mut world, 1200);
    assert!(world.snapshot().broken.is_empty());
    // Far below the 16 m/s that break the first poppy.
    let wind = world.snapshot().wind;
    let [nx, ny, _] = wind.cells.map(|n| n as usize);
    let lowest = |at: &usize| (at / nx).is_multiple_of(ny);
    let component = |at: usize| CodeSteps::default().wind_m_per_s(wind.codes[at]);
    let speed = |at: usize| component(at).hypot(component(2 * wind.volume() + at));
    let strongest_m_per_s = (0..wind.volume()).filter(lowest).map(speed).fold(0.0, f32::max);
    assert!(strongest_m_per_s > 1.0 && 1.5 * strongest_m_per_s < 15.0, "{strongest_m_per_s} m/s");
}
