//! Pressure on underbrush, and its trembling in the rain.

use super::*;
use crate::render::plants::obstacles::{StaticObstacles, of_pose};
use crate::render::plants::underbrush;
use crate::render::solids::trees_and_stones;
use prairie_core::plant::force_field::{VolumeMesh, sheltered};
use prairie_core::scene::{Component, ComponentKind, Underbrush};
use prairie_core::wire::ObjectPose;
use std::collections::HashMap;
use std::f32::consts::FRAC_PI_2;

#[test]
fn leaves_dip_under_raindrops() {
    const SOURCE: &str = "
        @group(1) @binding(0) var<storage, read_write> cases: array<vec4<f32>>;
        @compute @workgroup_size(1) fn probe(@builtin(global_invocation_id) id: vec3<u32>) {
            let input = cases[id.x];
            cases[id.x] = vec4<f32>(dip_m(input.x, input.y, input.z, vec2<u32>(id.x % 256u, 3u), input.w), bow(input.w / 100.0), 0.0, 0.0);
        }";
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let mut mirror = meadow(0.0);
    let mut picture = OffscreenRenderer::new(&gpu, [16, 16], Quality::Low);
    picture.draw(&mut mirror, &Camera::default(), 0.0, 0.0);
    let source = linked("plants/ribbons", SOURCE);
    let dips = |per_s: f32, times: &[f32]| {
        let inputs: Vec<_> = times.iter().flat_map(|&secs| [[0.2, 0.1, per_s, secs]; 256]).collect();
        compute(&gpu, &picture, &source, &[], &inputs, inputs.len() as u32).into_iter().map(|found| f64::from(found[0])).collect::<Vec<_>>()
    };
    // Campbell's theorem for n drops per span, each t·e^(−t) from its strike on with (3s² − s³)/2 of its force: mean n·⅜, variance n·(33/140)·¼.
    let unit_m = 0.2 * 0.1;
    for per_s in [0.5, 4.0, 60.0_f32] {
        let found = dips(per_s, &(0..100).map(|i| 7.0 + 1.13 * i as f32).collect::<Vec<_>>());
        let n = f64::from(per_s) * 0.1;
        let mean = found.iter().sum::<f64>() / found.len() as f64 / unit_m;
        let deviation = (found.iter().map(|dip| (dip / unit_m - mean).powi(2)).sum::<f64>() / found.len() as f64).sqrt();
        let wanted = (n * 33.0 / 140.0 / 4.0).sqrt();
        assert!((mean / (0.375 * n) - 1.0).abs() < 0.05, "{mean} on average of {n} drops");
        assert!((0.8..1.02).contains(&(deviation / wanted)), "{deviation} instead of {wanted} for {n} drops");
    }
    // The effect of a single drop starts at once, peaks after its time constant, and decays without oscillation.
    let times: Vec<f32> = (0..200).map(|i| 50.0 + 0.01 * i as f32).collect();
    let rare = dips(0.05, &times);
    let series = (0..256).map(|plant| rare.iter().skip(plant).step_by(256).copied().collect::<Vec<_>>());
    let single = series.filter(|dips| dips[0] < 1e-6 && dips[199] < 1e-6 && dips.iter().any(|&dip| dip > 2e-3)).take(20);
    let mut count = 0;
    for dips in single {
        let (at, most) = dips.iter().copied().enumerate().fold((0, 0.0), |most, now| if now.1 > most.1 { now } else { most });
        assert!(most < 2.0 * unit_m / std::f64::consts::E);
        let before = dips[..at].iter().rposition(|&dip| dip == 0.0).expect("it begins at rest");
        assert!((6..=40).contains(&(at - before)), "{} ms to its farthest", 10 * (at - before));
        count += 1;
    }
    assert!(count > 5, "{count} single strikes");
}

/// A species that grows wherever it can.
pub(super) fn grasses() -> Vec<Underbrush> {
    let leaf = Component { count: 6, sections: 3, length_m: 1.2, stiffness_n_m2: 0.1, ..Component::new("leaf", ComponentKind::Leaf) };
    vec![Underbrush { room_m: 0.3, needs: [0.0; 3], uptake: [0.0; 3], light_need: 0.0, ..Underbrush::new("grass", vec![leaf]) }]
}

#[test]
fn underbrush_ends_at_the_distance_of_its_level_of_detail() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let mut mirror = meadow_of(|scene| scene.underbrush = grasses(), &[255; 16 * 16]);
    let camera = Camera { eye_m: Vec3::new(32.0, 1.6, 64.0), ..Camera::default() };
    let mut picture = OffscreenRenderer::new(&gpu, [256, 144], Quality::Medium);
    let [near, whole] = [0.0, 1.0].map(|level| {
        picture.set_level(level);
        picture.draw(&mut mirror, &camera, 0.0, 0.0);
        picture.drawn_underbrush()
    });
    assert!(near > 100 && 10 * near < 9 * whole, "{near} within 45 m, {whole} within 64 m");
}

#[test]
fn plants_behind_the_camera_are_drawn_without_culling() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let mut mirror = meadow_of(|scene| scene.underbrush = grasses(), &[255; 16 * 16]);
    let camera = Camera { eye_m: Vec3::new(32.0, 1.6, 32.0), ..Camera::default() };
    let mut picture = OffscreenRenderer::new(&gpu, [256, 144], Quality::Low);
    let [seen, all] = [true, false].map(|culls| {
        picture.set_options(RenderOptions { culls, ..RenderOptions::default() });
        picture.draw(&mut mirror, &camera, 0.0, 0.0);
        picture.drawn_underbrush()
    });
    assert!(seen > 100 && 2 * seen < all, "{seen} in view of {all}");
}

/// Position of each plant (m) and pressure on it (Pa), by its site, after a second and a half below a camera.
fn felt(picture: &mut OffscreenRenderer, gpu: &Gpu, mirror: &mut Mirror) -> HashMap<u32, ([f32; 2], [f32; 2])> {
    let camera = Camera { eye_m: Vec3::new(32.0, 16.0, 32.0), pitch_rad: -1.57, fov_rad: 1.9, ..Camera::default() };
    (0..15).for_each(|_| {
        picture.draw(mirror, &camera, 0.0, 0.1);
    });
    let decoded = mirror.decoded_scene().expect("a scene");
    let (grown, _) = underbrush::tiles(decoded, decoded.flora().expect("underbrush"));
    let bytes = read(gpu, &picture.renderer.scene.as_ref().and_then(|scene| scene.underbrush.as_ref()).expect("underbrush").seen.responses);
    let responses: &[[f32; 8]] = bytemuck::cast_slice(&bytes);
    grown.iter().zip(responses).map(|(plant, response)| (plant.site, (plant.at_m, [response[0], response[1]]))).collect()
}

#[test]
fn plants_behind_a_boulder_are_sheltered_from_the_wind() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let run = |is_stony: bool| {
        let mut covering = [255; 16 * 16];
        if is_stony {
            covering[7 + 16 * 7] = 254;
        }
        let windy = |scene: &mut Scene| {
            (scene.wind.mean_m_per_s, scene.plants.stone_m, scene.underbrush) = ([8.0, 0.0], 6.0, grasses());
        };
        let mut mirror = meadow_of(windy, &covering);
        let decoded = mirror.decoded_scene().expect("a scene");
        let stone = trees_and_stones::placed_models(decoded).first().map(|stone| (stone.position_m, stone.size_m));
        (felt(&mut OffscreenRenderer::new(&gpu, [400; 2], Quality::Low), &gpu, &mut mirror), stone)
    };
    let ((open, _), (stony, stone)) = (run(false), run(true));
    let (at_m, size_m) = stone.expect("a boulder");
    let fraction = |is_there: fn(f32, f32) -> bool| {
        let both = stony.iter().filter_map(|(site, (plant_m, felt))| {
            let [x, z] = [plant_m[0] - at_m.x, plant_m[1] - at_m.z];
            (is_there(x, z)).then_some((felt[0], open.get(site)?.1[0])).filter(|(_, open)| *open > 0.01)
        });
        let (felt, open, count) = both.fold((0.0, 0.0, 0), |sum, (felt, open)| (sum.0 + felt, sum.1 + open, sum.2 + 1));
        assert!(count > 10, "{count} plants");
        felt / open
    };
    let behind = fraction(|x, z| (2.5..6.0).contains(&x) && z.abs() < 1.0);
    let farther = fraction(|x, z| (12.0..18.0).contains(&x) && z.abs() < 1.0);
    let beside = fraction(|x, z| x.abs() < 6.0 && (6.0..12.0).contains(&z.abs()));
    assert!(
        behind < 0.6 && farther > behind && farther < 0.97 && beside > 0.97,
        "of the wind {behind} behind a boulder of {size_m} m, {farther} farther behind, {beside} beside"
    );
}

#[test]
fn what_arrives_of_the_wind_is_that_of_the_cpu_twin() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let mut picture = OffscreenRenderer::new(&gpu, [16, 16], Quality::Low);
    picture.draw(&mut meadow_of(|_| (), &[255; 16 * 16]), &Camera::default(), 0.0, 0.0);
    let cases: Vec<[f32; 4]> = (0..300)
        .map(|n| {
            let ([a, b, _], [c, d, _]) = (hash3([n, 1, 5]).map(unit), hash3([n, 2, 5]).map(unit));
            [20.0 * a - 10.0, 20.0 * b - 10.0, if n % 7 == 0 { 0.0 } else { c }, d]
        })
        .chain([[0.0; 4], [0.0, 0.0, 1.0, 1.0], [3.0, -4.0, 1.0, 1.0]])
        .collect();
    let found = probe_in(&gpu, &picture, "plants/force_field", "return vec4<f32>(sheltered(at.xy, at.zw), 0.0, 0.0);", &cases);
    for ([x, z, east, south], found) in cases.into_iter().zip(found) {
        let wanted = sheltered([x, z], [east, south]);
        assert!((0..2).all(|i| (wanted[i] - found[i]).abs() < 1e-5 * x.hypot(z).max(1.0)), "{found:?} instead of {wanted:?}");
    }
    assert_eq!(sheltered([3.0, -4.0], [1.0; 2]), [3.0, -4.0]);
}

#[test]
fn passing_objects_push_plants_in_still_air() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let mut mirror = meadow_of(|scene| (scene.wind.mean_m_per_s, scene.underbrush) = ([0.0; 2], grasses()), &[255; 16 * 16]);
    let car = ObjectPose {
        id: 1,
        kind: VehicleKind::Car,
        position_m: [33.0, 0.9, 33.0],
        rotation: [0.0, 0.0, 0.0, 1.0],
        velocity_m_per_s: [0.0, 0.0, -12.0],
        part_rad: 0.0,
    };
    mirror.apply(ServerMessage::Poses { tick: 1, objects: vec![car] }).expect("a sound pose");
    let mut picture = OffscreenRenderer::new(&gpu, [128; 2], Quality::Low);
    let felt = felt(&mut picture, &gpu, &mut mirror);
    let field = &picture.renderer.scene.as_ref().expect("a scene").force_field.field;
    let [west, _, north] = field.mesh().center_m([0; 3]);
    let (mut compared, mut strongest) = (0, 0.0_f32);
    for ([x, z], [east_pa, south_pa]) in felt.values().copied() {
        let at = [(x - west) / 2.0, (z - north) / 2.0];
        let of = |y: usize, axis: usize| {
            let [(i, u), (k, v)] = at.map(|at| (at as usize, at.fract()));
            let force = |i: usize, k: usize| field.force([i, y, k]).lasting_pa[axis];
            let mix = |a: f32, b: f32, fraction: f32| a + (b - a) * fraction;
            mix(mix(force(i, k), force(i + 1, k), u), mix(force(i, k + 1), force(i + 1, k + 1), u), v)
        };
        // Plants are not seen where they have thinned out.
        if (x - 33.0).abs() < 8.0 && (z - 33.0).abs() < 8.0 && [east_pa, south_pa] != [0.0; 2] {
            // Half their height is between the centres of the two lowest layers.
            for (axis, felt_pa) in [(0, east_pa), (2, south_pa)] {
                let [one, other] = [of(0, axis), of(1, axis)];
                let (low, high) = (one.min(other) - 0.1 * one.abs(), one.max(other) + 0.1 * one.abs());
                assert!((low - 0.05..high + 0.05).contains(&felt_pa), "{felt_pa} Pa at ({x}, {z}), in a field of {one} to {other}");
            }
            compared += 1;
            strongest = strongest.max(south_pa.abs());
        }
    }
    assert!(compared > 50 && strongest > 10.0, "{compared} plants feel up to {strongest} Pa");
}

#[test]
fn obstacles_near_the_mesh_are_included() {
    let covering: Vec<u8> = (0..256).map(|at| if at % 5 == 0 { 253 } else { 254 }).collect();
    let mirror = meadow_of(|scene| (scene.plants.stone_m, scene.plants.tree_m) = (0.9, 8.0), &covering);
    let decoded = mirror.decoded_scene().expect("a scene");
    let placed = trees_and_stones::placed_models(decoded);
    let still = StaticObstacles::new(decoded, &placed);
    let mesh = VolumeMesh { count: [8, 4, 6], spacing_m: [2.0, 0.75, 2.0], corner: [8, 10] };
    let near: Vec<_> = still.near(mesh).collect();
    let is_inside = |x: f32, z: f32| (16.0..32.0).contains(&x) && (20.0..32.0).contains(&z);
    for model in placed.iter().filter(|model| is_inside(model.position_m.x, model.position_m.z)) {
        let own = near.iter().filter(|obstacle| [obstacle.at_m[0], obstacle.at_m[2]] == [model.position_m.x, model.position_m.z]);
        let own: Vec<_> = own.collect();
        if model.is_tree() {
            let [trunk, crown] = own[..] else { panic!("{} parts of a tree", own.len()) };
            let (trunk, crown) = if trunk.stops > crown.stops { (trunk, crown) } else { (crown, trunk) };
            assert!(trunk.stops == 1.0 && trunk.half_m[0] < 0.4 && crown.stops < 0.5 && crown.half_m[0] > 1.0);
            assert!((trunk.at_m[1] + trunk.half_m[1]) < crown.at_m[1], "the crown is above");
        } else {
            assert_eq!(own.len(), 1);
            assert!(own[0].at_m[1] < 0.0 && own[0].at_m[1] + own[0].half_m[1] > 0.0, "a stone sits in the ground");
        }
    }
    assert!(near.iter().all(|obstacle| (8.0..40.0).contains(&obstacle.at_m[0]) && (12.0..40.0).contains(&obstacle.at_m[2])));
    // The obstacle of a car turns with the car.
    let car = |turn_rad: f32| ObjectPose {
        id: 1,
        kind: VehicleKind::Car,
        position_m: [33.0, 0.9, 33.0],
        rotation: glam::Quat::from_rotation_y(turn_rad).to_array(),
        velocity_m_per_s: [0.0; 3],
        part_rad: 0.0,
    };
    for (turn_rad, along) in [(0.0, [1.0, 0.0]), (FRAC_PI_2, [0.0, -1.0])] {
        let obstacle = of_pose(decoded, &car(turn_rad));
        assert!(obstacle.along.iter().zip(along).all(|(found, wanted)| (found - wanted).abs() < 1e-5), "{obstacle:?}");
        assert_eq!(
            (obstacle.at_m, obstacle.half_m),
            ([33.0, 0.9, 33.0], prairie_core::scene::Objects::default().half_extents_m(VehicleKind::Car))
        );
    }
}
