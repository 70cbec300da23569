//! Tests of the force field.

use super::*;
use proptest::prelude::*;

const MESH: VolumeMesh = VolumeMesh { count: [24, 5, 20], spacing_m: [1.0, 0.5, 1.5], corner: [0, 0] };
const LINGERING: Lingering = Lingering { spread_m2_per_s: 0.8, decay_per_s: 3.0 };
const MIDDLE: [usize; 3] = [12, 2, 10];
const DT_SECS: f32 = 1.0 / 60.0;

fn field() -> ForceField {
    ForceField::new(MESH, LINGERING)
}

/// All volumes, in the order of the forces.
fn volumes(mesh: &VolumeMesh) -> impl Iterator<Item = [usize; 3]> + use<> {
    let [width, layers, rows] = mesh.count;
    (0..layers).flat_map(move |y| (0..rows).flat_map(move |z| (0..width).map(move |x| [x, y, z])))
}

/// Remainder of impulses.
fn forces(field: &ForceField) -> Vec<[f32; 3]> {
    field.forces().map(|force| force.lasting_pa).collect()
}

/// The part of the wind's force that arrives.
fn winds(field: &ForceField) -> Vec<[f32; 3]> {
    field.forces().map(|force| force.wind_pa).collect()
}

fn total(field: &ForceField) -> [f64; 3] {
    forces(field).iter().fold([0.0; 3], |sum, force| std::array::from_fn(|axis| sum[axis] + f64::from(force[axis])))
}

/// A tall mesh of small volumes with an impulse far from the sides.
fn wide(lingering: Lingering) -> ForceField {
    let mut field = ForceField::new(VolumeMesh { count: [41, 41, 41], spacing_m: [0.5, 0.4, 0.6], corner: [0, 0] }, lingering);
    field.strike([([20; 3], [60.0, -30.0, 12.0])], DT_SECS);
    field
}

/// Sum of the force along X, and its variance in space along each axis (m²).
fn moments(field: &ForceField) -> (f64, [f64; 3]) {
    let mesh = *field.mesh();
    let middle_m = mesh.center_m(mesh.count.map(|count| count / 2));
    let forces = forces(field);
    let sum: f64 = forces.iter().map(|force| f64::from(force[0])).sum();
    let variance = |axis: usize| {
        let of = |(volume, force): (_, &[f32; 3])| f64::from(mesh.center_m(volume)[axis] - middle_m[axis]).powi(2) * f64::from(force[0]);
        volumes(&mesh).zip(&forces).map(of).sum::<f64>() / sum
    };
    (sum, [0, 1, 2].map(variance))
}

#[test]
fn spreading_keeps_the_sum_and_widens_by_the_diffusivity_whatever_the_step() {
    for steps in [1, 2, 5, 30] {
        let mut field = wide(Lingering { decay_per_s: 1e-6, ..LINGERING });
        let (before, at_first) = moments(&field);
        assert!(at_first.iter().all(|variance| variance.abs() < 1e-9));
        (0..steps).for_each(|_| field.step(0.5 / steps as f32));
        let (after, variances) = moments(&field);
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
        let before = total(&field);
        (0..steps).for_each(|_| field.step(0.4 / steps as f32));
        for (after, before) in total(&field).into_iter().zip(before) {
            assert!((after / before / (-3.0_f64 * 0.4).exp() - 1.0).abs() < 1e-5, "{before} becomes {after} in {steps} steps");
        }
    }
}

#[test]
fn lingering_forces_vanish_in_the_end() {
    let mut field = wide(LINGERING);
    (0..20).for_each(|_| field.step(1.0));
    assert!(forces(&field).iter().flatten().all(|force| *force == 0.0 || force.abs() > f32::MIN_POSITIVE), "and never subnormal");
    (0..20).for_each(|_| field.step(1.0));
    assert!(forces(&field).iter().all(|force| *force == [0.0; 3]));
}

#[test]
fn two_half_steps_are_nearly_one() {
    let after = |steps: usize, step_secs: f32| {
        let mut field = wide(LINGERING);
        // Long enough for the impulse to leave its volume.
        field.step(0.2);
        (0..steps).for_each(|_| field.step(step_secs));
        forces(&field)
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
        // The checkerboard is the first mode to fail.
        field.strike(volumes(&MESH).map(|volume| (volume, [if volume.iter().sum::<usize>() % 2 == 0 { 1.0 } else { -1.0 }; 3])), DT_SECS);
        (0..steps).for_each(|_| field.step(dt_secs));
        forces(&field)
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
        field.strike([(MIDDLE, [2.0, -1.0, 0.5])], dt_secs);
        let mut felt = [0.0; 3];
        for _ in 0..(8.0 / dt_secs) as usize {
            let force = field.force(MIDDLE).lasting_pa;
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
        field.strike([(volume, [1.0, 0.0, 0.0])], DT_SECS);
        let before = total(&field)[0];
        field.step(0.04);
        total(&field)[0] / before
    };
    let [inside, ground, side, top] = [MIDDLE, [12, 0, 10], [0, 2, 10], [12, 4, 10]].map(left);
    assert!((inside - 1.0).abs() < 1e-5 && (ground - 1.0).abs() < 1e-5, "{inside} inside, {ground} at the ground");
    assert!(
        (side - (1.0 - 0.8 * 0.04)).abs() < 1e-4 && (top - (1.0 - 0.8 * 0.04 / 0.25)).abs() < 1e-4,
        "{side} at a side, {top} at the top"
    );
}

/// A wall across the mesh, `2·half_m` thick along X, which extends far beyond its sides and top.
fn wall(x_m: f32, half_m: f32) -> Obstacle {
    Obstacle { at_m: [x_m, 0.0, 15.0], half_m: [half_m, 100.0, 100.0], along: [1.0, 0.0], stops: 1.0 }
}

#[test]
fn impulses_spread_as_far_as_volumes_are_open() {
    let mut field = ForceField::new(MESH, Lingering { decay_per_s: 1e-6, ..LINGERING });
    field.obstruct([wall(14.5, 0.5)]);
    field.strike([([13, 1, 10], [1.0, 2.0, 3.0])], DT_SECS);
    let before = total(&field);
    field.step(0.03);
    assert!(total(&field).iter().zip(before).all(|(after, before)| (after / before - 1.0).abs() < 1e-5), "a wall takes nothing away");
    let is_west = |volume: &[usize; 3]| volume[0] < 14;
    assert!(
        volumes(&MESH).filter(|volume| !is_west(volume)).all(|volume| field.force(volume).lasting_pa == [0.0; 3]),
        "nor lets it through"
    );
    assert!(field.force([13, 1, 11]).lasting_pa[2] > 0.0);
    // A half-open wall lets half through, and a second one half of that.
    let given = |stops: f32, walls: &[f32]| {
        let mut field = ForceField::new(MESH, Lingering { decay_per_s: 1e-6, ..LINGERING });
        field.stand(walls.iter().map(|&x_m| Obstacle { stops, ..wall(x_m, 0.5) }));
        field.strike([([13, 1, 10], [1.0; 3])], DT_SECS);
        field.step(0.03);
        field.force([14, 1, 10]).lasting_pa[0]
    };
    let [all, half, quarter] = [given(0.5, &[]), given(0.5, &[14.5]), given(0.5, &[13.5, 14.5])];
    assert!((half / all - 0.5).abs() < 1e-5 && (quarter / all - 0.25).abs() < 1e-5, "{all}, {half}, {quarter}");
}

/// A field in which a wind (Pa) has blown until all lees are steady.
fn blown(mesh: VolumeMesh, wind_pa: [f32; 3], obstacles: &[Obstacle]) -> ForceField {
    let mut field = ForceField::new(mesh, LINGERING);
    field.obstruct(obstacles.iter().copied());
    field.blow(|_| wind_pa);
    (0..4 * mesh.count[0]).for_each(|_| field.shelter());
    field
}

#[test]
fn solids_shelter_what_is_before_and_behind_them() {
    let field = blown(MESH, [5.0, -1.0, 2.0], &[wall(14.5, 0.5)]);
    let wind = |x: usize| field.force([x, 2, 10]).wind_pa;
    assert!(wind(14).iter().all(|wind| wind.abs() < 1e-5), "within: {:?}", wind(14));
    assert_eq!(wind(3), [5.0, -1.0, 2.0], "far before it the wind blows in full");
    let before = wind(13);
    assert!(before[0] == 0.0 && (before[2] - 2.0).abs() < 0.2 && (before[1] + 1.0).abs() < 0.1, "close before it, along it: {before:?}");
    let behind: Vec<_> = (15..24).map(|x| wind(x)[0] / 5.0).collect();
    assert!(behind[0] < 0.2 && behind.is_sorted(), "{behind:?}");
    assert!(field.force([3, 0, 3]).wind_pa[1] == -1.0, "the ground takes nothing away");
    for (x, wind_pa) in [3, 13, 16].map(|x| (x, wind(x))) {
        let arriving = field.force([x, 2, 10]).arriving;
        assert!(
            (0..3).all(|axis| (arriving[axis] * [5.0, -1.0, 2.0][axis] - wind_pa[axis]).abs() < 1e-6),
            "{arriving:?} of the wind at {x}"
        );
    }
    let calm = blown(MESH, [0.0; 3], &[wall(14.5, 0.5)]);
    assert!(winds(&calm).iter().all(|wind| *wind == [0.0; 3]));
    let turned = blown(MESH, [-5.0, -1.0, 2.0], &[wall(14.5, 0.5)]);
    let [east, west] = [20, 13].map(|x| turned.force([x, 2, 10]).wind_pa[0] / -5.0);
    assert!(east > 0.95 && west < 0.2, "the lee is where the wind goes: {east} in the east, {west} in the west");
}

#[test]
fn a_lee_fills_up_by_what_mixes_in_from_above() {
    let mesh = VolumeMesh { count: [120, 8, 5], spacing_m: [0.5, 0.4, 40.0], corner: [0, 0] };
    for wind_pa in [0.5, 40.0] {
        let field = blown(
            mesh,
            [wind_pa, 0.0, 0.0],
            &[Obstacle { at_m: [3.0, 0.0, 100.0], half_m: [0.5, 90.0, 900.0], along: [1.0, 0.0], stops: 1.0 }],
        );
        let lee = |x: usize| f64::from(1.0 - field.force([x, 0, 2]).wind_pa[0] / wind_pa);
        assert!(lee(8) > 0.99, "{} behind the wall", lee(8));
        // By hand: far behind, n·∇l = ℓ·∇²l below open air at a height H leaves the slowest mode, cos(πy/2H)·e^(−ℓ(π/2H)²x).
        let height_m = 0.4 * 8.5;
        let wanted_per_m = f64::from(kernel::MIXING_M) * (std::f64::consts::PI / (2.0 * height_m)).powi(2);
        let found_per_m = (lee(60) / lee(110)).ln() / 25.0;
        assert!((found_per_m / wanted_per_m - 1.0).abs() < 0.05, "{found_per_m} instead of {wanted_per_m} per metre at {wind_pa} Pa");
    }
}

#[test]
fn an_obstacle_takes_its_silhouette_from_the_wind_wherever_it_is() {
    // Loss of wind over the whole section behind the obstacle, in square metres.
    let mesh = VolumeMesh { count: [12, 12, 12], spacing_m: [2.0, 0.75, 2.0], corner: [0, 0] };
    let taken_m2 = |obstacle: Obstacle| {
        let field = blown(mesh, [4.0, 0.0, 0.0], &[obstacle]);
        let lost = |y: usize, z: usize| f64::from(1.0 - field.force([9, y, z]).wind_pa[0] / 4.0) * 1.5;
        (0..12).flat_map(|y| (0..12).map(move |z| (y, z))).map(|(y, z)| lost(y, z)).sum::<f64>()
    };
    // Wider ones take more: they stop the wind in each of the several volumes that they overlap.
    for (radius_m, allowed) in [(0.15, 0.98..1.02), (0.5, 0.93..1.02), (1.0, 0.84..1.02), (3.0, 1.1..1.4)] {
        let silhouette_m2 = std::f64::consts::PI * f64::from(radius_m) * f64::from(radius_m);
        for i in 0..12 {
            let ball = Obstacle::round([12.0 + 0.17 * i as f32, 3.0 + 0.06 * i as f32, 12.0 + 0.31 * i as f32], [radius_m; 3]);
            let taken = taken_m2(ball) / silhouette_m2;
            assert!(allowed.contains(&taken), "{taken} of the silhouette of {ball:?}");
        }
    }
    let along = [0.0, 0.3, 0.8, 1.57_f32].map(|turn_rad| {
        let (sine, cosine) = turn_rad.sin_cos();
        taken_m2(Obstacle { at_m: [12.5, 3.0, 11.6], half_m: [3.0, 0.75, 1.0], along: [cosine, sine], stops: 1.0 })
    });
    assert!(along.is_sorted() && along[0] < 1.9 * 3.0 && along[3] > 0.8 * 9.0, "{along:?} m², instead of 3 head on and 9 broadside");
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
    // In steady state without spread the field is as strong as the ball's own force.
    let mut field = ForceField::new(MESH, Lingering { spread_m2_per_s: 0.0, ..LINGERING });
    for _ in 0..600 {
        field.step(DT_SECS);
        ball.push(&mut field, DT_SECS);
    }
    for volume in volumes(&MESH) {
        let offset_m: [f32; 3] = std::array::from_fn(|axis| MESH.center_m(volume)[axis] - ball.at_m[axis]);
        let is_near = offset_m.iter().map(|d| d * d).sum::<f32>().sqrt() <= 3.0 * 1.2;
        for (is, asked) in field.force(volume).lasting_pa.into_iter().zip(ball.force_pa(offset_m)) {
            assert!(
                if is_near { (is - asked).abs() < 1e-3 * full_pa } else { is == 0.0 && asked.abs() < 2e-3 * full_pa },
                "{is} for {asked}"
            );
        }
    }
    // A small one is seen wherever it is among the volumes.
    let seen = |at_m: [f32; 3]| total(&field_of_marble(at_m))[0];
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
fn the_mesh_moves_in_whole_volumes_and_keeps_what_stays_in() {
    let mut field = blown(MESH, [5.0, 0.0, 1.0], &[wall(14.5, 0.5)]);
    field.strike(volumes(&MESH).enumerate().map(|(i, volume)| (volume, [i as f32, 1.0, -(i as f32)])), DT_SECS);
    let before = field.clone();
    let about = MESH.about([14.3, 11.0]);
    assert_eq!(about.corner, [2, -3]);
    field.move_to(about.corner);
    field.obstruct([wall(14.5, 0.5)]);
    field.blow(|_| [5.0, 0.0, 1.0]);
    field.shelter();
    for volume in volumes(&MESH) {
        let [x, y, z] = volume;
        if let (Some(x), true) = (x.checked_sub(2), z + 3 < 20) {
            assert_eq!(about.center_m([x, y, z + 3]), MESH.center_m(volume));
            let (now, then) = (field.force([x, y, z + 3]), before.force(volume));
            assert_eq!(now.lasting_pa, then.lasting_pa, "at {volume:?}");
            assert!(
                now.wind_pa.iter().zip(then.wind_pa).all(|(now, then)| (now - then).abs() < 0.2),
                "{now:?} after {then:?} at {volume:?}"
            );
        }
    }
    let new = |volume: [usize; 3]| field.force(volume).lasting_pa == [0.0; 3];
    assert!((0..5).all(|y| new([23, y, 10]) && new([5, y, 1])), "new ones hold nothing");
    field.move_to([900, 900]);
    field.stand([]);
    field.shelter();
    assert!(forces(&field).iter().all(|force| *force == [0.0; 3]) && winds(&field).iter().all(|wind| *wind == [5.0, 0.0, 1.0]));
}

#[test]
fn the_same_calls_give_the_same_bits() {
    let run = |stops: f32| {
        let mut field = field();
        for tick in 0..40 {
            let at_m = [2.0 + 0.3 * tick as f32, 0.5, 14.0];
            field.step(DT_SECS);
            field.obstruct([Obstacle { stops, ..Obstacle::round(at_m, [0.5; 3]) }]);
            field.blow(|[x_m, _, z_m]| dynamic_pressure_pa([x_m * 0.2, 0.0, z_m * 0.1]));
            Ball { at_m, radius_m: 0.5, velocity_m_per_s: [18.0, 0.0, 0.0] }.push(&mut field, DT_SECS);
            field.shelter();
        }
        field
    };
    assert!(run(1.0) == run(1.0));
    assert!(run(1.0) != run(0.5));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn sources_superpose(
        at_m in (2.0_f32..20.0, 0.2_f32..2.0, 3.0_f32..25.0),
        speed in -15.0_f32..15.0,
        impulse in prop::array::uniform3(-9.0_f32..9.0),
        parts in 0_u32..4,
    ) {
        let ball = Ball { at_m: at_m.into(), radius_m: 0.7, velocity_m_per_s: [speed, 0.0, 3.0] };
        let run = |parts: u32| {
            let mut field = field();
            field.stand([wall(14.5, 0.3)]);
            for _ in 0..3 {
                field.step(DT_SECS);
                if parts & 1 > 0 { field.strike([(MIDDLE, impulse)], DT_SECS); }
                if parts & 2 > 0 { ball.push(&mut field, DT_SECS); }
            }
            forces(&field)
        };
        let (all, some, others) = (run(3), run(parts), run(3 - parts));
        for ((all, some), others) in all.iter().flatten().zip(some.iter().flatten()).zip(others.iter().flatten()) {
            prop_assert!((all - some - others).abs() <= 1e-5 * (1.0 + some.abs() + others.abs()));
        }
    }
}
