//! A canopy that moves: energy, equilibrium, swing and checkpoints.

use prairie_wind::{Boundary, Canopy, CanopyMotion, Config, Gusts, Profile, Solver};
use std::f64::consts::TAU;

const MOTION: CanopyMotion = CanopyMotion { frequency_hz: 1.3, damping_ratio: 0.04, mass_kg_per_m2: 0.8 };
const CANOPY: Canopy = Canopy { height_m: 0.9, drag_per_m: 0.7, motion: Some(MOTION) };
const LAYER_M: f64 = 0.2;
const LAYERS: usize = 12;
const AIR_KG_PER_M3: f64 = 1.2;

/// One column of air without friction.
fn column(canopy: Canopy) -> Config {
    Config {
        cells: [1, LAYERS, 1],
        spacing_m: [1.0, LAYER_M as f32, 1.0],
        boundary: [[Boundary::Wrap; 2], [Boundary::FreeSlip; 2], [Boundary::Wrap; 2]],
        viscosity_m2_per_s: 0.0,
        mean_wind_m_per_s: [0.0; 3],
        profile: Profile::Uniform,
        relaxation_per_s: 0.0,
        gusts: Gusts { number: 0, ..Gusts::default() },
        canopy: Some(canopy),
        ..Config::default()
    }
}

/// Middle height over that of the canopy, and part of the layer in the canopy, from the ground.
fn layers() -> impl Iterator<Item = (f64, f64)> {
    let height_m = f64::from(CANOPY.height_m);
    (0..LAYERS).map(move |j| {
        let (low_m, high_m) = (j as f64 * LAYER_M, ((j + 1) as f64 * LAYER_M).min(height_m));
        (0.5 * (low_m + high_m) / height_m, ((height_m - low_m) / LAYER_M).clamp(0.0, 1.0))
    })
}

/// Modal mass (kg/m²): `m/h·∫χ² dy`.
fn modal_mass(motion: CanopyMotion) -> f64 {
    let squares: f64 = layers().map(|(shape, part)| part * shape * shape * LAYER_M).sum();
    f64::from(motion.mass_kg_per_m2) / f64::from(CANOPY.height_m) * squares
}

/// Energy of the air and of the stems (J/m²).
fn energies(air: &Solver<f64>, motion: CanopyMotion) -> [f64; 2] {
    let of_air: f64 =
        [0, 2].map(|axis| air.samples(axis).map(|(_, speed)| 0.5 * AIR_KG_PER_M3 * LAYER_M * speed * speed).sum::<f64>()).iter().sum();
    let [x, z, speed_x, speed_z] = air.state().stems.map(|values| values[0]);
    let rad_per_s = TAU * f64::from(motion.frequency_hz);
    let of_stems = 0.5 * modal_mass(motion) * (speed_x * speed_x + speed_z * speed_z + rad_per_s * rad_per_s * (x * x + z * z));
    [of_air, of_stems]
}

/// Stems lighter than the air between them, and so slow that nothing but the drag holds them.
const LIGHT: CanopyMotion = CanopyMotion { frequency_hz: 0.02, damping_ratio: 0.0, mass_kg_per_m2: 0.05 };

#[test]
fn air_and_stems_exchange_energy_and_gain_none_in_steps_of_any_length() {
    for (motion, dt_secs) in [MOTION, LIGHT].into_iter().flat_map(|motion| [0.001, 0.02, 0.1, 0.7, 5.0].map(|dt_secs| (motion, dt_secs))) {
        let mut air = Solver::<f64>::new(&column(Canopy { motion: Some(motion), ..CANOPY })).unwrap();
        air.set_velocity(|[_, y, _]: [f64; 3]| [6.0 + (7.0 * y).sin(), 0.0, -2.0 * y]);
        let [start, _] = energies(&air, motion);
        let (mut before, mut most) = (start, 0.0_f64);
        for _ in 0..300 {
            air.step(dt_secs, &[]).unwrap();
            let [of_air, of_stems] = energies(&air, motion);
            assert!(of_air + of_stems <= before * (1.0 + 1e-13), "{motion:?}, {dt_secs} s: {} J/m² after {before}", of_air + of_stems);
            (before, most) = (of_air + of_stems, most.max(of_stems));
        }
        // Stems hardly follow in steps of many periods.
        assert!(dt_secs > 0.1 || most > 1e-3 * start, "{motion:?}, {dt_secs} s: the stems get {most} of {start} J/m²");
    }
}

/// Displacement (m) of stems in a steady wind over that at which its drag and their stiffness balance, less one.
fn imbalance(dt_secs: f64) -> f64 {
    let mut air = Solver::<f64>::new(&Config { relaxation_per_s: 3.0, mean_wind_m_per_s: [4.0, 0.0, 0.0], ..column(CANOPY) }).unwrap();
    (0..(40.0 / dt_secs) as usize).for_each(|_| {
        air.step(dt_secs, &[]).unwrap();
    });
    let wind: Vec<f64> = air.samples(0).map(|(_, speed)| speed).collect();
    let push = |((shape, part), speed): ((f64, f64), &f64)| part * shape * speed * speed;
    let pushed = AIR_KG_PER_M3 * f64::from(CANOPY.drag_per_m) * LAYER_M * layers().zip(&wind).map(push).sum::<f64>();
    let expected_m = pushed / (modal_mass(MOTION) * (TAU * f64::from(MOTION.frequency_hz)).powi(2));
    let [found_m, aside_m] = air.canopy_displacements_m().expect("a canopy that moves").next().unwrap();
    assert!(expected_m > 0.01 && aside_m == 0.0, "{expected_m} {aside_m}");
    found_m / expected_m - 1.0
}

#[test]
fn a_steady_wind_holds_stems_where_drag_and_stiffness_balance() {
    // The drag is that at the end of its own part of a step, before the wind relaxes: first order.
    let errors = [0.02, 0.01, 0.005].map(imbalance);
    assert!(errors[2].abs() < 0.005, "{errors:?}");
    assert!(errors.windows(2).all(|pair| (pair[0] / pair[1] - 2.0).abs() < 0.1), "{errors:?}");
}

#[test]
fn stems_without_drag_swing_at_their_frequency_and_decay_with_second_order() {
    let (rad_per_s, ratio) = (TAU * f64::from(MOTION.frequency_hz), f64::from(MOTION.damping_ratio));
    let secs = 4.0;
    let exact_m = |secs: f64| {
        let damped = rad_per_s * (1.0 - ratio * ratio).sqrt();
        0.1 * (-ratio * rad_per_s * secs).exp() * ((damped * secs).cos() + ratio * rad_per_s / damped * (damped * secs).sin())
    };
    let error_m = |steps: usize| {
        let mut air = Solver::<f64>::new(&column(Canopy { drag_per_m: 0.0, ..CANOPY })).unwrap();
        let mut state = air.state();
        state.stems[0].fill(0.1);
        air.restore(&state).unwrap();
        (0..steps).for_each(|_| {
            air.step(secs / steps as f64, &[]).unwrap();
        });
        (air.canopy_displacements_m().unwrap().next().unwrap()[0] - exact_m(secs)).abs()
    };
    let errors = [200, 400, 800].map(error_m);
    let orders = [errors[0] / errors[1], errors[1] / errors[2]].map(f64::log2);
    assert!(orders.iter().all(|order| (order - 2.0).abs() < 0.1), "orders {orders:?}, errors {errors:?} m");
}

#[test]
fn a_restored_canopy_goes_on_with_the_same_bits() {
    let config = Config { cells: [8, 6, 7], spacing_m: [0.5, 0.3, 0.5], ..column(CANOPY) };
    let config =
        Config { mean_wind_m_per_s: [3.0, 0.0, 1.0], relaxation_per_s: 0.5, gusts: Gusts { number: 6, ..Gusts::default() }, ..config };
    let start = || Solver::<f32>::new(&config).unwrap();
    let run = |air: &mut Solver<f32>, steps: usize| {
        for _ in 0..steps {
            air.step(0.05, &[]).unwrap();
        }
    };
    let (mut whole, mut copy) = (start(), start());
    run(&mut whole, 40);
    copy.restore(&whole.state()).unwrap();
    run(&mut whole, 20);
    run(&mut copy, 20);
    assert_eq!(whole.state(), copy.state());
    assert!(whole.state().stems[0].iter().any(|place| *place != 0.0));
    let rigid = Solver::<f32>::new(&Config { canopy: Some(Canopy { motion: None, ..CANOPY }), ..config.clone() }).unwrap();
    let error = copy.restore(&rigid.state()).unwrap_err().to_string();
    assert!(error.contains("stems"), "a state without stems is rejected: {error}");
}

#[test]
fn motions_that_are_not_allowed_are_rejected() {
    for (motion, field) in [
        (CanopyMotion { frequency_hz: 0.0, ..MOTION }, "canopy.motion.frequency_hz"),
        (CanopyMotion { damping_ratio: -0.1, ..MOTION }, "canopy.motion.damping_ratio"),
        (CanopyMotion { mass_kg_per_m2: f32::NAN, ..MOTION }, "canopy.motion.mass_kg_per_m2"),
    ] {
        let error = Solver::<f32>::new(&column(Canopy { motion: Some(motion), ..CANOPY })).err().expect("rejected");
        assert_eq!(error.field, field);
    }
}
