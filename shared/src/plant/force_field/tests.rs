//! What the force field claims.

use super::*;
use crate::scene::{Primitive, PrimitiveKind};
use proptest::prelude::*;

const MESH: Mesh = Mesh { count: [24, 5, 20], spacing_m: [1.0, 0.5, 1.5], corner: [0, 0] };
const LINGERING: Lingering = Lingering { spread_m2_per_s: 0.8, decay_per_s: 3.0 };
const MIDDLE: [usize; 3] = [12, 2, 10];
const DT_SECS: f32 = 1.0 / 60.0;

fn field() -> ForceField {
    ForceField::new(MESH, LINGERING)
}

fn forces(field: &mut ForceField) -> Vec<[f32; 3]> {
    field.sum_up();
    field.forces_pa().collect()
}

fn total(field: &mut ForceField) -> [f64; 3] {
    forces(field).iter().fold([0.0; 3], |sum, force| std::array::from_fn(|axis| sum[axis] + f64::from(force[axis])))
}

/// A tall mesh of small volumes, far from whose sides an impulse has been given.
fn wide(lingering: Lingering) -> ForceField {
    let mut field = ForceField::new(Mesh { count: [41, 41, 41], spacing_m: [0.5, 0.4, 0.6], corner: [0, 0] }, lingering);
    field.strike([20; 3], [60.0, -30.0, 12.0], DT_SECS);
    field
}

/// Sum of the force along X, and its variance in space along each axis (m²).
fn moments(field: &mut ForceField) -> (f64, [f64; 3]) {
    let mesh = *field.mesh();
    let middle_m = mesh.center_m(mesh.count.map(|count| count / 2));
    let forces = forces(field);
    let sum: f64 = forces.iter().map(|force| f64::from(force[0])).sum();
    let variance = |axis: usize| {
        let of = |(volume, force): (_, &[f32; 3])| f64::from(mesh.center_m(volume)[axis] - middle_m[axis]).powi(2) * f64::from(force[0]);
        mesh.volumes().zip(&forces).map(of).sum::<f64>() / sum
    };
    (sum, [0, 1, 2].map(variance))
}

#[test]
fn spreading_keeps_the_sum_and_widens_by_the_diffusivity_whatever_the_step() {
    for steps in [1, 2, 5, 30] {
        let mut field = wide(Lingering { decay_per_s: 1e-6, ..LINGERING });
        let (before, at_first) = moments(&mut field);
        assert!(at_first.iter().all(|variance| variance.abs() < 1e-9));
        (0..steps).for_each(|_| field.step(0.5 / steps as f32));
        let (after, variances) = moments(&mut field);
        assert!((after / before - 1.0).abs() < 1e-5, "{before} becomes {after}");
        for variance in variances {
            assert!((variance - 2.0 * 0.8 * 0.5).abs() < 2e-3, "{variance} m² in {steps} steps");
        }
    }
}

#[test]
fn forces_decay_at_their_rate_whatever_the_step() {
    for steps in [1, 2, 7, 60] {
        let mut field = wide(LINGERING);
        let before = total(&mut field);
        (0..steps).for_each(|_| field.step(0.4 / steps as f32));
        for (after, before) in total(&mut field).into_iter().zip(before) {
            assert!((after / before / (-3.0_f64 * 0.4).exp() - 1.0).abs() < 1e-5, "{before} becomes {after} in {steps} steps");
        }
    }
}

#[test]
fn two_half_steps_are_nearly_one() {
    let after = |steps: usize, step_secs: f32| {
        let mut field = wide(LINGERING);
        // So far that the impulse is no longer in one volume alone.
        field.step(0.2);
        (0..steps).for_each(|_| field.step(step_secs));
        forces(&mut field)
    };
    let difference = |steps: usize| {
        let (one, two) = (after(steps, 0.12 / steps as f32), after(2 * steps, 0.06 / steps as f32));
        let largest = one.iter().flatten().fold(0.0, |largest: f32, force| largest.max(force.abs()));
        one.iter().flatten().zip(two.iter().flatten()).fold(0.0, |worst: f32, (one, two)| worst.max((one - two).abs())) / largest
    };
    let [coarse, fine, finer] = [8, 16, 32].map(difference);
    assert!(coarse < 0.025, "{coarse} of the largest force");
    let orders = [coarse / fine, fine / finer].map(f32::log2);
    assert!(orders.iter().all(|order| (0.85..1.15).contains(order)), "orders {orders:?}");
}

#[test]
fn long_steps_are_divided_at_the_limit() {
    let limit_secs = LINGERING.stable_dt_secs(&MESH);
    let by_hand = 0.5 / (2.0 * 0.8 * (1.0 + 4.0 + 1.0 / 2.25));
    assert!((limit_secs - by_hand).abs() < 1e-6);
    let run = |steps: usize, dt_secs: f32| {
        let mut field = field();
        // The checkerboard is what fails first.
        MESH.volumes()
            .for_each(|volume| field.strike(volume, [if volume.iter().sum::<usize>() % 2 == 0 { 1.0 } else { -1.0 }; 3], DT_SECS));
        (0..steps).for_each(|_| field.step(dt_secs));
        forces(&mut field)
    };
    assert!(run(1, 3.999 * limit_secs) == run(4, 3.999 * limit_secs / 4.0));
    let largest = |forces: Vec<[f32; 3]>| forces.into_iter().flatten().fold(0.0, |largest: f32, force| largest.max(force.abs()));
    let [before, after] = [run(0, 0.0), run(10, 1.0)].map(largest);
    assert!(after < 1e-6 * before, "{before} becomes {after}");
    let still = Lingering { spread_m2_per_s: 0.0, ..LINGERING };
    assert_eq!(still.stable_dt_secs(&MESH), f32::INFINITY, "what does not spread has no limit");
}

#[test]
fn an_impulse_is_felt_in_full_whatever_the_step() {
    for dt_secs in [0.002, 1.0 / 60.0, 0.05, 2.0] {
        let mut field = ForceField::new(MESH, Lingering { spread_m2_per_s: 0.0, ..LINGERING });
        field.strike(MIDDLE, [2.0, -1.0, 0.5], dt_secs);
        let mut felt = [0.0; 3];
        for _ in 0..(8.0 / dt_secs) as usize {
            field.sum_up();
            let force = field.force_pa(MIDDLE);
            felt = std::array::from_fn(|axis| felt[axis] + f64::from(force[axis] * dt_secs));
            field.step(dt_secs);
        }
        for (felt, given) in felt.into_iter().zip([2.0, -1.0, 0.5]) {
            assert!((felt - given).abs() < 1e-3 * given.abs(), "{felt} Pa·s of {given} in steps of {dt_secs} s");
        }
    }
}

#[test]
fn force_leaves_by_the_sides_and_the_top_and_not_through_the_ground() {
    let left = |volume: [usize; 3]| {
        let mut field = ForceField::new(MESH, Lingering { decay_per_s: 1e-6, ..LINGERING });
        field.strike(volume, [1.0, 0.0, 0.0], DT_SECS);
        let before = total(&mut field)[0];
        field.step(0.04);
        total(&mut field)[0] / before
    };
    let [inside, ground, side, top] = [MIDDLE, [12, 0, 10], [0, 2, 10], [12, 4, 10]].map(left);
    assert!((inside - 1.0).abs() < 1e-5 && (ground - 1.0).abs() < 1e-5, "{inside} inside, {ground} at the ground");
    assert!(
        (side - (1.0 - 0.8 * 0.04)).abs() < 1e-4 && (top - (1.0 - 0.8 * 0.04 / 0.25)).abs() < 1e-4,
        "{side} at a side, {top} at the top"
    );
}

#[test]
fn solids_pass_nothing_on_and_force_slides_along_them() {
    let mut field = ForceField::new(MESH, Lingering { decay_per_s: 1e-6, ..LINGERING });
    // A wall across the mesh.
    let is_wall = |[x_m, _, _]: [f32; 3]| (x_m - 14.5).abs() < 0.1;
    field.fill(is_wall);
    field.strike([13, 1, 10], [1.0, 2.0, 3.0], DT_SECS);
    field.strike([15, 3, 10], [1.0, 2.0, 3.0], DT_SECS);
    field.drive(|_| [5.0, -1.0, 2.0]);
    field.sum_up();
    for y in 0..5 {
        assert_eq!(field.force_pa([14, y, 3]), [0.0; 3], "within the wall");
        assert_eq!(field.force_pa([13, y, 3]), [0.0, -1.0, 2.0], "before it what points into it is gone");
        assert_eq!(field.force_pa([15, y, 3]), [5.0, -1.0, 2.0], "behind it what points away stays");
    }
    assert_eq!(field.force_pa([3, 0, 3]), [5.0, -1.0, 2.0], "the ground takes nothing away: plants on it feel the rain");
    field.calm();
    // Along Y and Z nothing is lost, and nothing has got through.
    let west =
        |field: &ForceField| MESH.volumes().filter(|volume| volume[0] < 14).map(|volume| f64::from(field.force_pa(volume)[2])).sum::<f64>();
    field.sum_up();
    let before = west(&field);
    field.step(0.03);
    field.sum_up();
    assert!((west(&field) / before - 1.0).abs() < 1e-5);
    assert!(field.force_pa([13, 1, 11])[2] > 0.0 && field.force_pa([14, 1, 10]) == [0.0; 3]);
}

#[test]
fn rain_presses_with_its_momentum_on_average() {
    let mesh = Mesh { count: [32, 4, 24], spacing_m: [1.0, 0.5, 1.0], corner: [0, 0] };
    for (rate_mm_per_h, decay_per_s) in [(0.05, 30.0), (4.0, 30.0), (60.0, 4.0)] {
        let rain = Rain { rate_mm_per_h, seed: 9 };
        // By hand: mm/h are kg/m²/h; each kg brings 6.49 N·s.
        assert!((rain.mean_pa() / (rate_mm_per_h / 3600.0 * 6.49) - 1.0).abs() < 1e-5);
        let mut field = ForceField::new(mesh, Lingering { spread_m2_per_s: 0.0, decay_per_s });
        let is_roof = |[x_m, y_m, z_m]: [f32; 3]| x_m < 1.0 && z_m < 1.0 && (0.5..1.0).contains(&y_m);
        field.fill(is_roof);
        let steps = 3000;
        let mut mean = vec![0.0; 32 * 4 * 24];
        for tick in 0..steps + 200 {
            field.step(DT_SECS);
            rain.fall(&mut field, tick, DT_SECS);
            if tick >= 200 {
                let now = forces(&mut field);
                assert!(now.iter().all(|force| force[0] == 0.0 && force[2] == 0.0 && force[1] <= 0.0));
                mean.iter_mut().zip(now).for_each(|(mean, force)| *mean -= f64::from(force[1]) / f64::from(steps));
            }
        }
        let over = mean.iter().sum::<f64>() / (mean.len() as f64 - 3.0) / f64::from(rain.mean_pa());
        assert!((over - 1.0).abs() < 0.02, "{over} of the mean at {rate_mm_per_h} mm/h");
        let column: Vec<_> = (0..4).map(|y| mean[y * 32 * 24]).collect();
        assert!(column[..3] == [0.0; 3] && column[3] > 0.0, "under a roof it is dry, and on it the roof bears the rain: {column:?}");
        if rate_mm_per_h > 1.0 {
            let driest = mean.iter().filter(|&&mean| mean > 0.0).fold(f64::INFINITY, |least, &mean| least.min(mean));
            assert!(driest > 0.6 * f64::from(rain.mean_pa()), "it rains everywhere");
        }
    }
}

#[test]
fn a_ball_pushes_ahead_outwards_and_draws_behind() {
    let ball = Ball { at_m: [12.0, 1.0, 15.0], radius_m: 1.2, velocity_m_per_s: [8.0, 0.0, 0.0] };
    let full_pa = 0.5 * 1.2 * 64.0;
    let [front, rear, waist, inside] =
        [[1.2001, 0.0, 0.0], [-1.2001, 0.0, 0.0], [0.0, 0.0, 1.2001], [0.3, 0.2, 0.0]].map(|at| ball.force_pa(at));
    assert!([front, rear, inside].iter().all(|force| (force[0] / full_pa - 1.0).abs() < 1e-3), "{front:?} {rear:?} {inside:?}");
    assert!((waist[0] / full_pa + 0.25).abs() < 1e-3, "half the speed, back: {waist:?}");
    let [south, north] = [[1.0, 0.0, 1.0], [1.0, 0.0, -1.0]].map(|at| ball.force_pa(at));
    assert!(south[2] > 1.0 && north[2] < -1.0 && south[0] > 0.0, "{south:?}, {north:?}");
    // One that stays where it is makes the field as strong as its own force.
    let mut field = ForceField::new(MESH, Lingering { spread_m2_per_s: 0.0, ..LINGERING });
    for _ in 0..600 {
        field.step(DT_SECS);
        ball.push(&mut field, DT_SECS);
    }
    field.sum_up();
    for volume in MESH.volumes() {
        let offset_m: [f32; 3] = std::array::from_fn(|axis| MESH.center_m(volume)[axis] - ball.at_m[axis]);
        let is_near = offset_m.iter().map(|d| d * d).sum::<f32>().sqrt() <= 3.0 * 1.2;
        for (is, asked) in field.force_pa(volume).into_iter().zip(ball.force_pa(offset_m)) {
            assert!(
                if is_near { (is - asked).abs() < 1e-3 * full_pa } else { is == 0.0 && asked.abs() < 2e-3 * full_pa },
                "{is} for {asked}"
            );
        }
    }
    // A small one is seen wherever it is among the volumes.
    let seen = |at_m: [f32; 3]| {
        let mut field = field_of_marble(at_m);
        let force = total(&mut field);
        force[0]
    };
    let all: Vec<_> = (0..10).map(|i| seen([12.0 + 0.1 * i as f32, 1.0, 15.0 + 0.13 * i as f32])).collect();
    let [least, most] = [f64::min, f64::max].map(|pick| all.iter().copied().fold(all[0], pick));
    assert!(least > 0.0 && most < 6.0 * least, "{all:?}");
}

fn field_of_marble(at_m: [f32; 3]) -> ForceField {
    let mut field = field();
    Ball { at_m, radius_m: 0.2, velocity_m_per_s: [8.0, 0.0, 0.0] }.push(&mut field, DT_SECS);
    field
}

#[test]
fn primitives_push_as_their_flow_goes() {
    let at = [10.0, 2.0, 10.0];
    let of = |kind, offset: [f32; 3]| {
        let primitive = Primitive { radius_m: 8.0, speed_m_per_s: 10.0, ..Primitive::new(kind, at) };
        primitive_pa(&primitive, std::array::from_fn(|axis| at[axis] + offset[axis]))
    };
    let full_pa = 60.0;
    assert_eq!(of(PrimitiveKind::Uniform, [0.0; 3]), [0.0, 0.0, -full_pa], "north");
    let weight = (1.0_f32 - 0.25).powi(2);
    let near = |force: [f32; 3], asked: [f32; 3]| {
        assert!(force.iter().zip(asked).all(|(force, asked)| (force - asked).abs() < 1e-3), "{force:?} for {asked:?}")
    };
    near(of(PrimitiveKind::Source, [4.0, 0.0, 0.0]), [full_pa * weight, 0.0, 0.0]);
    near(of(PrimitiveKind::Sink, [0.0, 4.0, 0.0]), [0.0, -full_pa * weight, 0.0]);
    near(of(PrimitiveKind::Vortex, [4.0, 0.0, 0.0]), [0.0, 0.0, -full_pa * weight]);
    let [low, heart] = [of(PrimitiveKind::Cyclone, [4.0, -1.0, 0.0]), of(PrimitiveKind::Cyclone, [0.0; 3])];
    assert!(low[0] < 0.0 && low[2] < 0.0 && heart[1] > 0.0);
    let kinds = [PrimitiveKind::Uniform, PrimitiveKind::Source, PrimitiveKind::Sink, PrimitiveKind::Vortex, PrimitiveKind::Cyclone];
    for kind in kinds {
        for i in 0..1000 {
            let offset = [(i % 10) as f32 - 4.5, (i / 10 % 10) as f32 - 4.5, (i / 100) as f32 - 4.5].map(|d| d * 2.0);
            let force = of(kind, offset);
            let size = force.iter().map(|f| f * f).sum::<f32>().sqrt();
            assert!(size <= full_pa * 1.0001 && (size == 0.0 || offset.iter().all(|d| d.abs() < 8.0)), "{kind:?}: {size} at {offset:?}");
        }
    }
}

#[test]
fn the_mesh_moves_in_whole_volumes_and_keeps_what_stays_in() {
    let mut field = field();
    MESH.volumes().enumerate().for_each(|(i, volume)| field.strike(volume, [i as f32, 1.0, -(i as f32)], DT_SECS));
    field.fill(|[x_m, _, z_m]| x_m < 4.0 && z_m < 4.0);
    let before = forces(&mut field);
    let about = MESH.about([14.3, 11.0]);
    assert_eq!(about.corner, [2, -3]);
    field.move_to(about.corner);
    field.sum_up();
    for (volume, force) in MESH.volumes().zip(before) {
        let [x, y, z] = volume;
        if let (Some(x), true) = (x.checked_sub(2), z + 3 < 20) {
            assert_eq!(about.center_m([x, y, z + 3]), MESH.center_m(volume));
            // Beside the new border there may be what was solid and is now outside.
            if x > 0 {
                assert_eq!(field.force_pa([x, y, z + 3]), force, "at {volume:?}");
            }
        }
    }
    assert!((0..5).all(|y| field.force_pa([23, y, 10]) == [0.0; 3] && field.force_pa([5, y, 1]) == [0.0; 3]), "new ones hold nothing");
    field.calm();
    field.drive(|_| [3.0, 0.0, 0.0]);
    field.sum_up();
    assert_eq!(field.force_pa([23, 2, 10]), [3.0, 0.0, 0.0], "they start with what drives them");
    field.move_to([900, 900]);
    field.calm();
    assert!(forces(&mut field).iter().all(|force| *force == [0.0; 3]));
}

#[test]
fn between_the_centres_the_force_is_linear() {
    let mut field = field();
    field.drive(|[x_m, y_m, z_m]| [x_m, 2.0 * y_m - z_m, 5.0]);
    field.sum_up();
    for at_m in [[3.3, 1.1, 7.7], [12.0, 0.25, 20.0], [0.5, 2.25, 0.75]] {
        let [x, y, z] = field.at(at_m);
        assert!((x - at_m[0]).abs() < 1e-4 && (y - 2.0 * at_m[1] + at_m[2]).abs() < 1e-4 && (z - 5.0).abs() < 1e-4, "at {at_m:?}");
    }
    assert_eq!(field.at([-50.0, -9.0, -50.0]), field.force_pa([0; 3]), "beyond the mesh the outermost holds");
    assert_eq!(field.at([500.0, 90.0, 500.0]), field.force_pa([23, 4, 19]));
}

#[test]
fn the_same_calls_give_the_same_bits() {
    let run = |seed: u64| {
        let mut field = field();
        let rain = Rain { rate_mm_per_h: 20.0, seed };
        for tick in 0..40 {
            let at_m = [2.0 + 0.3 * tick as f32, 0.5, 14.0];
            field.step(DT_SECS);
            field.calm();
            field.drive(|[x_m, _, z_m]| dynamic_pressure_pa([x_m * 0.2, 0.0, z_m * 0.1]));
            rain.fall(&mut field, tick, DT_SECS);
            Ball { at_m, radius_m: 0.5, velocity_m_per_s: [18.0, 0.0, 0.0] }.push(&mut field, DT_SECS);
        }
        forces(&mut field)
    };
    assert!(run(1) == run(1));
    assert!(run(1) != run(2));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn sources_superpose(
        wind in prop::array::uniform3(-9.0_f32..9.0),
        at_m in (2.0_f32..20.0, 0.2_f32..2.0, 3.0_f32..25.0),
        speed in -15.0_f32..15.0,
        rate_mm_per_h in 0.0_f32..100.0,
        parts in 0_u32..16,
    ) {
        let ball = Ball { at_m: at_m.into(), radius_m: 0.7, velocity_m_per_s: [speed, 0.0, 3.0] };
        let vortex = Primitive::new(PrimitiveKind::Vortex, [10.0, 1.0, 14.0]);
        let run = |parts: u32| {
            let mut field = field();
            for tick in 0..3 {
                field.step(DT_SECS);
                field.calm();
                if parts & 1 > 0 { field.drive(|_| dynamic_pressure_pa(wind)); }
                if parts & 2 > 0 { field.drive(|at_m| primitive_pa(&vortex, at_m)); }
                if parts & 4 > 0 { Rain { rate_mm_per_h, seed: 3 }.fall(&mut field, tick, DT_SECS); }
                if parts & 8 > 0 { ball.push(&mut field, DT_SECS); }
            }
            forces(&mut field)
        };
        let (all, some, others) = (run(15), run(parts), run(15 - parts));
        for ((all, some), others) in all.iter().flatten().zip(some.iter().flatten()).zip(others.iter().flatten()) {
            prop_assert!((all - some - others).abs() <= 1e-5 * (1.0 + some.abs() + others.abs()));
        }
    }
}
