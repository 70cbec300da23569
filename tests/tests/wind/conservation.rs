//! The conservative scheme conserves momentum, dust and, up to the time error, kinetic energy.

use prairie_charts::air::{noise, still_air};
use prairie_charts::orders::{Order, assert_expected};
use prairie_wind::{Boundary, Config, Diffusion, Dust, Real, Solver, TimeScheme};

const WRAP: [[Boundary; 2]; 3] = [[Boundary::Wrap; 2]; 3];

/// Rough, divergence-free, inviscid air in a periodic cube of 16 cells, with a mean wind of 0.3 m/s along x.
fn rough_air<R: Real>(damping: f32, dust: Option<Dust>) -> Solver<R> {
    rough_air_of(&rough_config(damping, dust))
}

fn rough_config(damping: f32, dust: Option<Dust>) -> Config {
    Config { damping, dust, ..still_air([16; 3], [1.0; 3], WRAP) }
}

fn rough_air_of<R: Real>(config: &Config) -> Solver<R> {
    let mut air = Solver::<R>::new(config).expect("settings are allowed");
    air.set_velocity(|position| {
        let [i, j, k] = position.map(|x| (2.0 * x.wide()) as u64);
        let any = |axis: u64| R::of(noise(i + 32 * (j + 32 * (k + 32 * axis))));
        [any(0) + R::of(0.3), any(1), any(2)]
    });
    air
}

/// Mean of u²/2 (m²/s²) on the faces, conserved by central fluxes.
fn energy<R: Real>(air: &Solver<R>) -> f64 {
    (0..3).map(|axis| air.samples(axis).map(|(_, u)| 0.5 * u.wide() * u.wide()).sum::<f64>()).sum::<f64>() / air.grid().len() as f64
}

/// Mean velocity (m/s).
fn momentum<R: Real>(air: &Solver<R>) -> [f64; 3] {
    [0, 1, 2].map(|axis| air.samples(axis).map(|(_, u)| u.wide()).sum::<f64>() / air.grid().len() as f64)
}

/// Air after the pressure has settled, and its time step (s) at a Courant number summed over the axes.
fn settled<R: Real>(mut air: Solver<R>, courant: f64) -> (Solver<R>, f64) {
    let dt_secs = 0.01;
    let fastest_per_s = (0..10).map(|_| air.step(dt_secs, &[]).expect("within the limits").courant / dt_secs).last().unwrap_or(1.0);
    (air, courant / fastest_per_s)
}

/// Time step (s), and the relative energy gain of undamped rough air over a number of steps.
fn gain(courant: f64, steps: usize) -> (f64, f64) {
    let (mut air, dt_secs) = settled(rough_air::<f64>(0.0, None), courant);
    let before = energy(&air);
    (0..steps).for_each(|_| assert!(air.step(dt_secs, &[]).is_ok()));
    (dt_secs, energy(&air) / before - 1.0)
}

#[test]
fn without_damping_energy_changes_only_by_the_time_error() {
    for (courant, bound) in [(0.5, 0.02), (0.25, 0.0015)] {
        let (_, gain) = gain(courant, 1000);
        println!("Courant {courant}: energy changes by {:.4} % in 1000 steps", 100.0 * gain);
        assert!((-bound..0.0).contains(&gain), "Courant {courant}: {gain}");
    }
    let losses = [(0.4, 20), (0.2, 40), (0.1, 80)].map(|(courant, steps)| gain(courant, steps)).map(|(dt_secs, gain)| (dt_secs, -gain));
    assert_expected(&[Order::fit("Rough air", "Conservative RungeKutta3, damping 0", "dt, energy", 3.0, losses.to_vec())]);
}

#[test]
fn with_damping_energy_never_grows() {
    let (mut air, dt_secs) = settled(rough_air::<f64>(1.0, None), 0.5);
    let start = energy(&air);
    let mut before = start;
    for step in 0..1000 {
        air.step(dt_secs, &[]).expect("within the limits");
        let now = energy(&air);
        assert!(now < before, "step {step}: {before} grew to {now}");
        before = now;
    }
    println!("damping 1, Courant 0.5: {:.2} % of the energy are left after 1000 steps", 100.0 * before / start);
}

/// Largest change of the mean velocity over 200 steps, relative to the rms speed.
fn momentum_change<R: Real>(choose: impl Fn(&mut Config)) -> f64 {
    let mut config = rough_config(1.0, None);
    choose(&mut config);
    let (mut air, dt_secs) = settled(rough_air_of::<R>(&config), 0.5);
    let (before, speed) = (momentum(&air), (2.0 * energy(&air)).sqrt());
    (0..200).for_each(|_| assert!(air.step(dt_secs, &[]).is_ok()));
    let after = momentum(&air);
    (0..3).map(|axis| (after[axis] - before[axis]).abs() / speed).fold(0.0, f64::max)
}

#[test]
fn a_periodic_box_conserves_momentum_to_rounding() {
    type Choose = fn(&mut Config);
    let schemes: [(&str, Choose); 4] = [
        ("Runge–Kutta 3", |_| {}),
        ("Runge–Kutta 3, no damping", |config| config.damping = 0.0),
        ("Runge–Kutta 3, Crank–Nicolson", |config| config.diffusion = Diffusion::CrankNicolson),
        ("split, explicit friction", |config| config.time = TimeScheme::Split),
    ];
    for (name, choose) in schemes {
        let thick = |config: &mut Config| {
            config.viscosity_m2_per_s = 0.125;
            choose(config);
        };
        let [single, double] = [momentum_change::<f32>(thick), momentum_change::<f64>(thick)];
        println!("{name}: momentum changes by {single:.1e} in f32, {double:.1e} in f64, of the rms speed");
        assert!(single < 1e-7 && double < 1e-14, "{name}: {single:e} {double:e}");
    }
}

#[test]
fn dust_is_conserved_to_rounding() {
    let settings = Dust { diffusivity_m2_per_s: 0.125, release_per_s: 0.0, settling_per_s: 0.0, ..Dust::default() };
    let (mut air, dt_secs) = settled(rough_air::<f32>(1.0, Some(settings)), 0.5);
    air.set_dust(|[x, y, _]| if x < 8.0 && y < 8.0 { 1.0 } else { 0.0 });
    let amount = |air: &Solver<f32>| air.dust_samples().map(|(_, density)| f64::from(density)).sum::<f64>();
    let before = amount(&air);
    (0..200).for_each(|_| assert!(air.step(dt_secs, &[]).is_ok()));
    let change = amount(&air) / before - 1.0;
    let (least, most) = air.dust_samples().fold((1.0f32, 0.0f32), |(least, most), (_, density)| (least.min(density), most.max(density)));
    println!("dust: {change:.1e} of its amount in 200 steps, densities {least} to {most}");
    assert!(change.abs() < 2e-7 && least >= -1e-6 && most <= 1.0 + 1e-6, "{change:e}, {least} to {most}");
}
