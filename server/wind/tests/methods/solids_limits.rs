//! Walls where their air has no way out, at the faces of the box, and in air without forcing.

use std::cell::RefCell;

use prairie_wind::solids::DragBody;
use prairie_wind::{Advection, Body, Boundary, Canopy, CanopyMotion, Config, Gusts, Profile, Solver, TimeScheme};

const DT_SECS: f64 = 0.05;
const STEPS: usize = 40;

fn still() -> Config {
    Config {
        cells: [32, 16, 16],
        spacing_m: [1.0; 3],
        boundary: [[Boundary::Wrap; 2], [Boundary::NoSlip, Boundary::FreeSlip], [Boundary::Wrap; 2]],
        viscosity_m2_per_s: 0.05,
        mean_wind_m_per_s: [0.0; 3],
        profile: Profile::Uniform,
        relaxation_per_s: 0.0,
        gusts: Gusts { number: 0, ..Gusts::default() },
        ..Config::default()
    }
}

fn cube(centre_m: [f64; 3], velocity_m_per_s: [f64; 3]) -> Body {
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    Body { centre_m, half_extents_m: [2.0; 3], axes, velocity_m_per_s, drag_coefficient: 1.0 }
}

/// Moves bodies through still air, `bodies` as a function of time (s).
fn check_bodies(name: &str, config: &Config, bodies: impl Fn(f64) -> Vec<Body>) {
    let mut air = Solver::<f32>::new(config).unwrap();
    for step in 0..STEPS {
        let now = bodies(step as f64 * DT_SECS);
        air.set_bodies(&now).unwrap();
        let report = air.step(DT_SECS, &[]).unwrap_or_else(|error| panic!("{name}, step {step}: {error}"));
        let state = air.state();
        let largest = |values: &[Vec<f32>; 3]| values.iter().flatten().fold(0.0_f32, |most, value| most.max(value.abs()));
        let (speed, slope) = (largest(&state.velocity), largest(&state.pressure_gradient));
        // Air that gives way goes no faster than twice the bodies, and is brought to that in a step.
        assert!(speed < 20.0 && slope < 20.0 / DT_SECS as f32, "{name}, step {step}: {speed} m/s, {slope} m/s²");
        assert!(report.divergence_rms_rel < 1e-6 && report.substeps <= 4, "{name}, step {step}: {report:?}");
    }
}

#[test]
fn bodies_that_leave_air_no_way_out_move_it_no_faster_than_themselves() {
    let along = |secs: f64| 8.0 + 10.0 * secs;
    for rise in [-0.5, 0.01, 0.5] {
        check_bodies(&format!("on the floor, rising at {rise} m/s"), &still(), |secs| {
            vec![cube([along(secs), 2.0, 8.0], [10.0, rise, 0.0])]
        });
    }
    check_bodies("two in one place", &still(), |_| vec![cube([8.0; 3], [10.0, 0.0, 0.0]), cube([10.5, 8.0, 8.0], [-10.0, 0.0, 0.0])]);
    let closed = Config { boundary: [[Boundary::Outflow, Boundary::NoSlip], [Boundary::NoSlip; 2], [Boundary::Wrap; 2]], ..still() };
    check_bodies("through a closed face", &closed, |secs| vec![cube([20.0 + along(secs), 8.0, 8.0], [10.0, 0.0, 0.0])]);
}

/// Velocity (m/s) in the lowest cell and in the middle of a channel of 16 cells whose floor is a wall, relative to the parabola.
fn channel(bottom: Boundary, has_wall: bool) -> [f64; 2] {
    let config = Config {
        cells: [1, 16, 1],
        boundary: [[Boundary::Wrap; 2], [bottom, Boundary::NoSlip], [Boundary::Wrap; 2]],
        body_force_m_per_s2: [0.1, 0.0, 0.0],
        viscosity_m2_per_s: 1.0,
        ..still()
    };
    let mut air = Solver::<f64>::new(&config).unwrap();
    if has_wall {
        air.set_walls(|[_, y, _]| y, |_| [0.0; 3]).unwrap();
    }
    (0..5_000).for_each(|_| {
        air.step(0.2, &[]).unwrap();
    });
    [0.5, 7.5].map(|y| air.velocity_at([0.5, y, 0.5])[0] / (0.05 * y * (16.0 - y)))
}

#[test]
fn a_wall_on_a_face_of_the_box_slows_the_air_once() {
    let plain = channel(Boundary::NoSlip, false);
    assert_eq!(channel(Boundary::NoSlip, true), plain, "the face has its own friction");
    let [lowest, middle] = channel(Boundary::FreeSlip, true);
    assert!(
        (lowest - 1.0).abs() < 0.05 && (middle - 1.0).abs() < 0.02,
        "above a face without friction {lowest} and {middle} of the parabola"
    );
    let [lowest, _] = channel(Boundary::FreeSlip, false);
    assert!(lowest > 10.0, "without the wall {lowest}");
}

/// Numbers from a seed (SplitMix64).
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((bits ^ (bits >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn scale(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.unit())
    }

    fn of<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[(self.unit() * choices.len() as f64) as usize]
    }
}

/// A box without forcing, the duration of a step (s) and the radii and centres (m) of three spheres in it.
fn unforced(random: &mut Random) -> (Config, f64, [[f64; 4]; 3]) {
    let cells = [0; 3].map(|_| if random.unit() < 0.2 { 1 } else { 4 + (9.0 * random.unit()) as usize });
    let spacing_m = random.scale(0.1, 10.0);
    let face = |random: &mut Random| random.of(&[Boundary::FreeSlip, Boundary::NoSlip, Boundary::Outflow]);
    let boundary = [0; 3].map(|_| if random.unit() < 0.33 { [Boundary::Wrap; 2] } else { [face(random), face(random)] });
    let (frequency_hz, mass_kg_per_m2) = (random.scale(0.1, 20.0) as f32, random.scale(0.01, 10.0) as f32);
    let motion = Some(CanopyMotion { frequency_hz, damping_ratio: 0.0, mass_kg_per_m2 }).filter(|_| random.unit() < 0.5);
    let height_m = (spacing_m * random.scale(0.3, 6.0)) as f32;
    let canopy = Canopy { height_m, drag_per_m: random.scale(1e-2, 10.0) as f32, motion };
    let config = Config {
        cells,
        spacing_m: [spacing_m as f32; 3],
        boundary,
        advection: Advection::Conservative,
        time: random.of(&[TimeScheme::RungeKutta3, TimeScheme::RungeKutta3, TimeScheme::Split]),
        damping: random.of(&[0.0, 1.0]),
        viscosity_m2_per_s: if random.unit() < 0.25 { 0.0 } else { random.scale(1e-4, 1e2) as f32 },
        canopy: (random.unit() < 0.5).then_some(canopy),
        ..still()
    };
    let spheres = [0; 3].map(|_| {
        let centre_m = cells.map(|n| random.unit() * n as f64 * spacing_m);
        [centre_m[0], centre_m[1], centre_m[2], spacing_m * random.scale(0.5, 4.0)]
    });
    (config, random.scale(0.003, 3.0) * spacing_m, spheres)
}

/// Distance (m) of a point from a sphere, its centre and radius.
fn beyond(position_m: [f64; 3], [x, y, z, radius_m]: [f64; 4]) -> f64 {
    [x, y, z].iter().zip(position_m).map(|(centre, at)| (at - centre) * (at - centre)).sum::<f64>().sqrt() - radius_m
}

/// Energy of the air (m⁵/s²), with half of that on the faces of the box.
fn energy(air: &Solver<f64>) -> f64 {
    let extent_m = [0, 1, 2].map(|axis| air.grid().extent_m(axis));
    let of = |axis: usize| {
        let is_edge = move |at_m: f64| !air.grid().wraps(axis) && (at_m < 1e-9 * extent_m[axis] || at_m > (1.0 - 1e-9) * extent_m[axis]);
        air.samples(axis).map(move |(at_m, speed)| speed * speed * if is_edge(at_m[axis]) { 0.5 } else { 1.0 }).sum::<f64>()
    };
    [0, 1, 2].map(of).iter().sum()
}

#[test]
fn air_without_forcing_gains_no_energy_from_walls_drag_and_grass() {
    for seed in 0..100 {
        let mut random = Random(seed);
        let (config, dt_secs, spheres) = unforced(&mut random);
        let mut air = Solver::<f64>::new(&config).unwrap();
        let random = RefCell::new(random);
        air.set_velocity(|_| [0; 3].map(|_| 2.0 * random.borrow_mut().unit() - 1.0));
        air.set_walls(|at_m| spheres.map(|sphere| beyond(at_m, sphere)).into_iter().fold(f64::INFINITY, f64::min), |_| [0.0; 3]).unwrap();
        let [x, y, z, radius_m] = spheres[0];
        let crown =
            DragBody { centre_m: [x, y, z], half_extents_m: [radius_m; 3], velocity_m_per_s: [0.0; 3], drag_m2: [radius_m * radius_m; 3] };
        air.set_drag(&[crown][..(seed % 2) as usize]).unwrap();
        let start = energy(&air);
        for step in 0..150 {
            // Viscosity may ask for more sub-steps than are allowed.
            let Ok(_) = air.step(dt_secs, &[]) else { break };
            assert!(energy(&air) <= start * 1.001, "seed {seed}, step {step}: {} of {start}, {config:?}", energy(&air));
        }
    }
}

/// Spheres of which one covers part of an outflow: the pressure that a wall bears there changes from step to step as fast as the air moves.
#[test]
fn walls_over_an_outflow_let_no_energy_in() {
    let config = Config {
        cells: [1, 11, 11],
        spacing_m: [4.688_848_5, 9.377_697, 4.688_848_5],
        boundary: [[Boundary::NoSlip; 2], [Boundary::FreeSlip; 2], [Boundary::Outflow, Boundary::NoSlip]],
        viscosity_m2_per_s: 0.001_250_127_4,
        damping: 0.0,
        ..still()
    };
    let spheres = [
        [0.201_381_432_841_963_64, 47.774_757_626_759_424, 4.037_285_669_445_275, 7.459_640_463_412_464],
        [3.620_925_660_500_59, 98.690_588_158_660_89, 38.179_696_821_394_16, 4.880_935_997_831_245],
        [4.317_537_282_908_336, 1.336_458_476_665_744_8, 34.765_662_601_714_92, 4.699_666_358_256_731],
    ];
    for dt_secs in [0.151_453_876_500_324_88, 0.302_907_753_000_649_76, 0.605_815_506_001_299_5] {
        let mut air = Solver::<f64>::new(&config).unwrap();
        let random = RefCell::new(Random(853));
        air.set_velocity(|_| [0; 3].map(|_| 20.6 * (2.0 * random.borrow_mut().unit() - 1.0)));
        air.set_walls(|at_m| spheres.map(|sphere| beyond(at_m, sphere)).into_iter().fold(f64::INFINITY, f64::min), |_| [0.0; 3]).unwrap();
        let start = energy(&air);
        for step in 0..600 {
            air.step(dt_secs, &[]).unwrap();
            assert!(energy(&air) <= start, "steps of {dt_secs} s, step {step}: {} of {start}", energy(&air));
        }
    }
}

#[test]
fn bodies_with_numbers_that_are_not_allowed_are_rejected() {
    let mut air = Solver::<f32>::new(&still()).unwrap();
    let sound = cube([8.0; 3], [1.0, 0.0, 0.0]);
    let wrong = [
        Body { centre_m: [f64::NAN, 8.0, 8.0], ..sound },
        Body { half_extents_m: [2.0, 0.0, 2.0], ..sound },
        Body { velocity_m_per_s: [f64::INFINITY, 0.0, 0.0], ..sound },
        Body { axes: [[f64::NAN; 3]; 3], ..sound },
        Body { drag_coefficient: -1.0, ..sound },
    ];
    for body in wrong {
        let error = air.set_bodies(&[sound, body]).unwrap_err().to_string();
        assert!(error.contains("body 1"), "{error}");
    }
    let error = air.set_drag(&[DragBody { drag_m2: [-1.0; 3], ..sound.drag() }]).unwrap_err().to_string();
    assert!(error.contains("body 0"), "{error}");
    // A body far larger than the box is cut at its faces.
    air.set_drag(&[DragBody { half_extents_m: [1e9; 3], ..sound.drag() }]).unwrap();
    air.step(DT_SECS, &[]).unwrap();
}
