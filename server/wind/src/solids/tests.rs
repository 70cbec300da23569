use crate::pressure::{Effort, IterativeMethod};
use crate::{
    Advection, Air, Body, Boundary, Config, Diffusion, DragBody, Gusts, Method, Pressure, Profile, Real, SolidError, Solver, TimeScheme,
};

/// Air of 1 m/s along x and no forcing.
fn steady(cells: [usize; 3], x: [Boundary; 2], y: [Boundary; 2]) -> Config {
    Config {
        cells,
        spacing_m: [1.0; 3],
        boundary: [x, y, [Boundary::Wrap; 2]],
        viscosity_m2_per_s: 0.05,
        mean_wind_m_per_s: [1.0, 0.0, 0.0],
        profile: Profile::Uniform,
        relaxation_per_s: 0.0,
        gusts: Gusts { number: 0, ..Gusts::default() },
        ..Config::default()
    }
}

const UPRIGHT: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

fn cube(centre_m: [f64; 3], half_m: f64, velocity_m_per_s: [f64; 3]) -> Body {
    Body { centre_m, half_extents_m: [half_m; 3], axes: UPRIGHT, velocity_m_per_s, drag_coefficient: 1.0 }
}

/// Flux (m³/s) through each cross-section along x.
fn fluxes<R: Real>(air: &Solver<R>) -> Vec<f64> {
    let mut fluxes = vec![0.0; air.grid().cells[0] + usize::from(!air.grid().wraps(0))];
    let planes = fluxes.len();
    air.samples(0).enumerate().for_each(|(n, (_, speed))| fluxes[n % planes] += speed.wide());
    fluxes
}

#[test]
fn a_wall_with_a_gap_keeps_the_flux_of_the_channel_to_rounding() {
    let config = steady([40, 16, 1], [Boundary::Inflow, Boundary::Outflow], [Boundary::NoSlip; 2]);
    let mut air = Solver::<f64>::new(&config).unwrap();
    let inflow = fluxes(&air)[0];
    air.set_walls(|[x, y, _]| (x - 14.3).abs().max(6.4 - y) - 1.2, |_| [0.0; 3]).unwrap();
    for _ in 0..100 {
        let report = air.step(0.1, &[]).unwrap();
        assert!(report.divergence_rms_rel < 1e-13, "{report:?}");
        let most = fluxes(&air).iter().map(|flux| (flux / inflow - 1.0).abs()).fold(0.0, f64::max);
        assert!(most < 1e-12, "{most}");
    }
    let through = |y: f64| air.velocity_at([14.3, y, 0.5])[0];
    assert!(through(2.6) > 1.5 && through(11.0).abs() < 1e-3, "{} in the gap, {} in the wall", through(2.6), through(11.0));
}

#[test]
fn nothing_passes_a_wall_that_closes_a_periodic_channel() {
    let force = 0.1;
    let config = Config {
        mean_wind_m_per_s: [0.0; 3],
        body_force_m_per_s2: [force, 0.0, 0.0],
        ..steady([32, 8, 8], [Boundary::Wrap; 2], [Boundary::FreeSlip; 2])
    };
    let mut air = Solver::<f64>::new(&config).unwrap();
    air.set_walls(|[x, _, _]| (x - 9.7).abs() - 1.1, |_| [0.0; 3]).unwrap();
    for n in 1..=50 {
        air.step(0.1, &[]).unwrap();
        let leak = fluxes(&air)[0] / 64.0;
        let free = f64::from(config.body_force_m_per_s2[0]) * 0.1 * f64::from(n);
        assert!(leak.abs() < 1e-4 * free, "{leak} m/s after step {n}, {free} m/s without the wall");
    }
    // The wall bears the force on all the air: 0.1 m/s² on 32·8·8 m³.
    let [borne, ..] = air.wall_force_m4_per_s2();
    assert!((borne / (f64::from(force) * 2048.0) - 1.0).abs() < 1e-3, "{borne}");
}

#[test]
fn a_body_that_moves_through_still_air_feels_the_force_of_the_wind_on_one_at_rest() {
    let mean_force = |wind: f32, speed: f64| {
        let config = Config { mean_wind_m_per_s: [wind, 0.0, 0.0], ..steady([48, 24, 24], [Boundary::Wrap; 2], [Boundary::FreeSlip; 2]) };
        let mut air = Solver::<f32>::new(&config).unwrap();
        let (mut sum, mut count) = (0.0, 0.0);
        for n in 1..=160 {
            let x = 24.0 + speed * 0.1 * f64::from(n);
            air.set_bodies(&[cube([x, 12.2, 12.3], 3.1, [speed, 0.0, 0.0])]).unwrap();
            air.step(0.1, &[]).unwrap();
            if n > 60 {
                sum += air.wall_force_m4_per_s2()[0];
                count += 1.0;
            }
        }
        sum / count
    };
    let [at_rest, moving] = [mean_force(1.0, 0.0), mean_force(0.0, -1.0)];
    println!("force at rest {at_rest:.3}, moving {moving:.3} m⁴/s²");
    assert!(at_rest > 10.0 && (moving / at_rest - 1.0).abs() < 0.1, "{at_rest} at rest, {moving} moving");
}

#[test]
fn a_body_within_a_cell_takes_its_drag_and_none_at_the_speed_of_the_wind() {
    let config = Config { viscosity_m2_per_s: 0.0, ..steady([16, 8, 8], [Boundary::Wrap; 2], [Boundary::FreeSlip; 2]) };
    let momentum_lost = |velocity_m_per_s: [f64; 3], half_m: f64| {
        let mut air = Solver::<f64>::new(&config).unwrap();
        air.set_bodies(&[Body { drag_coefficient: 0.8, ..cube([7.3, 3.9, 4.4], half_m, velocity_m_per_s) }]).unwrap();
        let before: f64 = fluxes(&air).iter().sum();
        air.step(1e-4, &[]).unwrap();
        (before - fluxes(&air).iter().sum::<f64>()) / 1e-4
    };
    for half_m in [0.2, 1.2] {
        let wanted = 0.5 * 0.8 * 4.0 * half_m * half_m;
        let [held, towed] = [[0.0; 3], [3.0, 0.0, 0.0]].map(|velocity| momentum_lost(velocity, half_m));
        assert!((held / wanted - 1.0).abs() < 1e-3, "{held}, not {wanted}");
        assert!((towed / (-4.0 * wanted) - 1.0).abs() < 1e-3, "towed at three times the wind: {towed}, not −4·{wanted}");
        assert!(momentum_lost([1.0, 0.0, 0.0], half_m).abs() < 1e-9 * wanted);
    }
}

/// A windy box with land, a crown and two bodies, one of which is a wall, after some steps on a number of threads.
fn scenery(threads: usize, interrupt: bool) -> Vec<u32> {
    let config = Config { cells: [48, 16, 48], spacing_m: [2.0; 3], ..Config::default() };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let fresh = || {
        let mut air = Air::<f32>::new(Method::Staggered, &config).unwrap();
        air.set_walls(|[x, y, _]| y - 6.0 * (-(x - 40.0) * (x - 40.0) / 200.0).exp() - 0.3, |_| [0.0; 3]).unwrap();
        let crown = DragBody { centre_m: [20.0, 6.0, 20.0], half_extents_m: [4.0; 3], velocity_m_per_s: [0.0; 3], drag_m2: [40.0; 3] };
        air.set_drag(&[crown, DragBody { centre_m: [23.0, 6.0, 20.0], ..crown }]).unwrap();
        air
    };
    pool.install(|| {
        let mut air = fresh();
        for n in 0..12 {
            if interrupt && n == 6 {
                let state = air.state();
                air = fresh();
                air.restore(&state).unwrap();
            }
            let x = f64::from(n);
            air.set_bodies(&[cube([60.0 + x, 14.0, 30.0], 4.0, [10.0, 0.0, 0.0]), cube([x, 3.0, 40.0], 0.7, [10.0, 0.0, 0.0])]).unwrap();
            air.step(0.1, &[]).unwrap();
        }
        air.cell_velocities().flat_map(|velocity| velocity.to_array().map(f32::to_bits)).collect()
    })
}

#[test]
fn solids_give_the_same_bits_on_any_number_of_threads_and_after_a_restart() {
    let once = scenery(1, false);
    assert!(once == scenery(2, false) && once == scenery(2, true));
}

#[test]
fn air_without_solids_keeps_its_bits() {
    let run = |clear: bool| {
        let mut air = Solver::<f32>::new(&Config::default()).unwrap();
        if clear {
            air.set_walls(|_| 1.0, |_| [0.0; 3]).unwrap();
            air.set_drag(&[]).unwrap();
            air.set_bodies(&[]).unwrap();
        }
        (0..5).for_each(|_| _ = air.step(0.05, &[]).unwrap());
        air.state()
    };
    assert_eq!(run(true), run(false));
}

#[test]
fn walls_are_refused_where_the_schemes_do_not_allow_them() {
    let effort = Effort { tolerance: 1e-3, sweeps: 10 };
    let cases = [
        (Config { pressure: Pressure::Iterative(IterativeMethod::Multigrid, effort), ..Config::default() }, SolidError::Iterative),
        (Config { diffusion: Diffusion::Implicit, ..Config::default() }, SolidError::Diffusion),
        (Config { advection: Advection::MacCormack, time: TimeScheme::Reflection, ..Config::default() }, SolidError::Reflection),
    ];
    for (config, error) in cases {
        let mut air = Solver::<f32>::new(&config).unwrap();
        assert_eq!(air.set_walls(|_| -1.0, |_| [0.0; 3]), Err(error));
        // There a large body slows the air like a small one.
        air.set_bodies(&[cube([128.0, 8.0, 128.0], 40.0, [0.0; 3])]).unwrap();
        air.step(0.05, &[]).unwrap();
    }
}
