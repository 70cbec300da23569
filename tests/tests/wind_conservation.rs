//! What the conservative scheme keeps: momentum, dust, and, but for the error in time, kinetic energy.

use server::wind::{Boundary, Config, Dust, Real, Solver};
use tests::air::{noise, still_air};
use tests::orders::Order;

const WRAP: [[Boundary; 2]; 3] = [[Boundary::Wrap; 2]; 3];

/// Rough air without divergence or friction in a cube of 16 cells that wraps, over a mean wind of 0.3 m/s along x.
fn rough_air<R: Real>(damping: f32, dust: Option<Dust>) -> Solver<R> {
    let config = Config { damping, dust, ..still_air([16; 3], [1.0; 3], WRAP) };
    let mut air = Solver::<R>::new(&config).expect("settings are allowed");
    air.set_velocity(|position| {
        let [i, j, k] = position.map(|x| (2.0 * x.wide()) as u64);
        let any = |axis: u64| R::of(noise(i + 32 * (j + 32 * (k + 32 * axis))));
        [any(0) + R::of(0.3), any(1), any(2)]
    });
    air
}

/// Mean of u²/2 (m²/s²) on the faces: what central fluxes keep.
fn energy<R: Real>(air: &Solver<R>) -> f64 {
    (0..3).map(|axis| air.samples(axis).map(|(_, u)| 0.5 * u.wide() * u.wide()).sum::<f64>()).sum::<f64>() / air.grid().len() as f64
}

/// Mean velocity (m/s).
fn momentum<R: Real>(air: &Solver<R>) -> [f64; 3] {
    [0, 1, 2].map(|axis| air.samples(axis).map(|(_, u)| u.wide()).sum::<f64>() / air.grid().len() as f64)
}

/// Time step (s) of a Courant number, summed over the axes, in the air at the start.
fn dt_secs<R: Real>(air: &mut Solver<R>, courant: f64) -> f64 {
    let probe = 1e-9;
    courant * probe / air.step(probe, &[]).expect("a short step").courant
}

fn drift_after(courant: f64, steps: usize) -> (f64, f64) {
    let mut air = rough_air::<f64>(0.0, None);
    let dt_secs = dt_secs(&mut air, courant);
    let before = energy(&air);
    for _ in 0..steps {
        air.step(dt_secs, &[]).expect("within the limits");
    }
    (dt_secs, energy(&air) / before - 1.0)
}

#[test]
fn energy_drift() {
    for courant in [0.5,0.25] { println!("{courant} {:?}", drift_after(courant, 1000)); }
    let errors = [(0.4, 25), (0.2,50),(0.1,100),(0.05,200)].map(|(c,n)| { let (dt, drift) = drift_after(c,n); println!("{c} {drift:e}"); (dt, drift.abs()) });
    println!("{}", Order::fit("Rough air", "Conservative RungeKutta3, damping 0", "energy, dt", 3.0, errors.to_vec()));
}
