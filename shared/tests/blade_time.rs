//! Time integration of a whole blade: order of the error of each integrator, and its longest stable step.

use prairie_core::plant::blade::modes::{AMPLITUDES, FREQUENCIES, MODES};
use prairie_core::plant::blade::propagator::stable_dt_secs;
use prairie_core::plant::blade::{Blade, Integrator, LINKS, Leans, Sway, advance};

const CALM: Leans = [[0.0; 2]; LINKS];

/// The shape under a force at the tip, which contains all modes.
const START: [f64; LINKS] = [0.5, 7.0 / 6.0, 1.5];

fn blade(frequency_rad_per_s: f32, damping_ratio: f32) -> Blade {
    Blade { length_m: 0.8, frequency_rad_per_s, damping_ratio, lean_per_wind2: 0.0 }
}

/// Lean and rate of each link along one axis, released from [`START`] at time 0, in closed form.
fn exact(blade: &Blade, secs: f64) -> [[f64; 2]; LINKS] {
    let mut links = [[0.0; 2]; LINKS];
    for m in 0..LINKS {
        let amplitude: f64 = (0..LINKS).map(|link| f64::from(AMPLITUDES[m][link]) * START[link]).sum();
        let omega = f64::from(blade.frequency_rad_per_s * FREQUENCIES[m]);
        let gamma = f64::from(blade.damping_ratio) * omega;
        let swing = (omega * omega - gamma * gamma).sqrt();
        let (decay, cosine, sine) = ((-gamma * secs).exp(), (swing * secs).cos(), (swing * secs).sin() / swing);
        for (link, fraction) in links.iter_mut().zip(MODES[m]) {
            link[0] += f64::from(fraction) * amplitude * decay * (cosine + gamma * sine);
            link[1] -= f64::from(fraction) * amplitude * decay * omega * omega * sine;
        }
    }
    links
}

/// Largest error of a lean after `secs` in this many steps, with the rates of `secs_before` the start.
fn error(blade: &Blade, integrator: Integrator, secs: f64, steps: u32, steps_before: f64) -> f64 {
    let dt_secs = secs / f64::from(steps);
    let (start, before) = (exact(blade, 0.0), exact(blade, -steps_before * dt_secs));
    let lean_rad = start.map(|[lean, _]| [lean as f32, 0.0]);
    // The rate at the start is the mean rate over the step before it, if there is one.
    let rate_rad_per_s = [0, 1, 2].map(|link| {
        let led = (start[link][0] - before[link][0]) / (steps_before * dt_secs);
        [if steps_before > 0.0 { led } else { start[link][1] } as f32, 0.0]
    });
    let mut sway = Sway { lean_rad, rate_rad_per_s };
    for _ in 0..steps {
        sway = advance(&sway, blade, &CALM, &CALM, integrator, dt_secs as f32);
    }
    exact(blade, secs).iter().zip(sway.lean_rad).map(|(wanted, found)| (wanted[0] - f64::from(found[0])).abs()).fold(0.0, f64::max)
}

/// Slope of the line through the logarithms of steps and errors, as the time step falls.
fn order(errors: &[(u32, f64)]) -> f64 {
    let logs: Vec<[f64; 2]> = errors.iter().map(|&(steps, error)| [-f64::from(steps).ln(), error.ln()]).collect();
    let mean = |axis: usize| logs.iter().map(|at| at[axis]).sum::<f64>() / logs.len() as f64;
    let [x, y] = [mean(0), mean(1)];
    logs.iter().map(|at| (at[0] - x) * (at[1] - y)).sum::<f64>() / logs.iter().map(|at| (at[0] - x).powi(2)).sum::<f64>()
}

#[test]
fn each_integrator_has_its_order_and_the_exact_one_no_error() {
    let [undamped, damped] = [0.0, 0.1].map(|damping_ratio| blade(8.0, damping_ratio));
    let fitted = |blade: &Blade, integrator, steps: [u32; 4], before| {
        let errors = steps.map(|steps| (steps, error(blade, integrator, 0.4, steps, before)));
        (order(&errors), errors)
    };
    for (name, (found, errors), wanted) in [
        ("Euler", fitted(&damped, Integrator::Euler, [800, 1600, 3200, 6400], 0.0), 1.0),
        ("Verlet, given the step before", fitted(&undamped, Integrator::Verlet, [120, 240, 480, 960], 1.0), 2.0),
        // A start from rest does not know its previous step, and the damping is of the rate half a step ago.
        ("Verlet, from rest", fitted(&undamped, Integrator::Verlet, [480, 960, 1920, 3840], 0.0), 1.0),
        ("Verlet, damped", fitted(&damped, Integrator::Verlet, [120, 240, 480, 960], 1.0), 1.0),
    ] {
        assert!((found - wanted).abs() < 0.15, "{name}: order {found} of {errors:?}");
    }
    for blade in [undamped, damped] {
        // The highest mode turns by up to 2.5 rad a step; then by 7.5.
        for (steps, bound) in [(18, 2e-5), (24, 1e-5), (48, 2e-6), (240, 2e-6), (960, 3e-6), (6, 2e-3)] {
            let error = error(&blade, Integrator::Exact, 0.4, steps, 0.0);
            assert!(error < bound, "{error} in {steps} steps");
        }
    }
}

#[test]
fn in_a_gust_every_integrator_is_of_first_order() {
    // The drag of a step is that at its start.
    let blade = Blade { lean_per_wind2: 0.004, ..blade(8.0, 0.1) };
    let run = |integrator, steps: u32| {
        let dt_secs = 1.0 / steps as f32;
        (0..steps).fold(Sway::default(), |sway, step| {
            let secs = f64::from(step) / f64::from(steps);
            let gust = [4.0 + 3.0 * (7.0 * secs).sin(), 2.0 * (5.0 * secs).cos()].map(|speed| speed as f32);
            advance(&sway, &blade, &CALM, &[gust; LINKS], integrator, dt_secs)
        })
    };
    let finest = run(Integrator::Exact, 1 << 15);
    let apart =
        |sway: Sway| (0..LINKS).map(|link| f64::from((sway.lean_rad[link][0] - finest.lean_rad[link][0]).abs())).fold(0.0, f64::max);
    for (integrator, steps) in
        [(Integrator::Euler, [1000, 2000, 4000]), (Integrator::Verlet, [120, 240, 480]), (Integrator::Exact, [60, 120, 240])]
    {
        let errors = steps.map(|steps| (steps, apart(run(integrator, steps))));
        let found = order(&errors);
        assert!((found - 1.0).abs() < 0.25, "{integrator:?}: order {found} of {errors:?}");
    }
}

/// Whether a blade bent in all of its modes stays within a hundred times that for this many steps.
fn holds(blade: &Blade, wind: &Leans, integrator: Integrator, dt_secs: f32, steps: u32) -> bool {
    let mut sway = Sway::at_rest([[0.01, 0.0], [-0.01, 0.01], [0.01, -0.01]]);
    for step in 0..steps {
        sway = advance(&sway, blade, &CALM, wind, integrator, dt_secs);
        if step % 64 == 0 && !sway.lean_rad.as_flattened().iter().all(|lean| lean.abs() < 1.0) {
            return false;
        }
    }
    true
}

#[test]
fn blades_fail_at_the_limit_of_their_integrator_whatever_their_stiffness() {
    for integrator in [Integrator::Euler, Integrator::Verlet] {
        for frequency_rad_per_s in [1.0, 9.74, 120.0] {
            for damping_ratio in [0.1, 0.3, 0.8] {
                let blade = blade(frequency_rad_per_s, damping_ratio);
                let limit = stable_dt_secs(integrator, frequency_rad_per_s, damping_ratio);
                let (mut low, mut high) = (0.5 * limit, 2.0 * limit);
                assert!(holds(&blade, &CALM, integrator, low, 40_000) && !holds(&blade, &CALM, integrator, high, 40_000));
                while high / low > 1.002 {
                    let middle = 0.5 * (low + high);
                    if holds(&blade, &CALM, integrator, middle, 40_000) { low = middle } else { high = middle }
                }
                let fraction = low / limit;
                assert!(
                    (0.99..1.02).contains(&fraction),
                    "{integrator:?}, {frequency_rad_per_s} rad/s, {damping_ratio}: {fraction} of the limit"
                );
            }
        }
    }
}

#[test]
fn the_exact_integrator_is_stable_for_every_step() {
    for frequency_rad_per_s in [1.0, 9.74, 120.0, 5000.0] {
        for damping_ratio in [0.0, 0.005, 0.1, 1.0, 5.0] {
            for dt_secs in [1e-3, 1.0 / 60.0, 0.5, 100.0] {
                let blade = blade(frequency_rad_per_s, damping_ratio);
                assert!(
                    holds(&blade, &CALM, Integrator::Exact, dt_secs, 2000),
                    "{frequency_rad_per_s} rad/s, {damping_ratio}, {dt_secs} s"
                );
            }
        }
    }
}
