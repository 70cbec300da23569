//! The lid-driven cavity comes to rest where Ghia, Ghia & Shin found it.
//!
//! Their tables have an error of their own (see [`GHIA_RE_1000`]), which is part of what is found here.

use server::wind::{Boundary, Config, Solver};
use tests::air::{still_air, velocity_difference};
use tests::problems::{Cavity, GHIA_RE_100, GHIA_RE_1000};

/// Side of the box (m), and the speed of its lid (m/s): the unit of time is a second.
const SIDE_M: f64 = 16.0;
/// Change per second, as a share of the lid's speed, at which the flow counts as steady.
const STEADY_PER_SEC: f64 = 1e-4;

/// The flow at rest on `cells` × `cells`, begun from `guess`.
fn steady(reynolds: f64, cells: usize, guess: Option<&Solver<f32>>) -> Solver<f32> {
    let spacing_m = SIDE_M / cells as f64;
    let lid = Boundary::Lid { velocity_m_per_s: [SIDE_M as f32, 0.0, 0.0] };
    let config = Config {
        viscosity_m2_per_s: (SIDE_M * SIDE_M / reynolds) as f32,
        ..still_air(
            [cells, cells, 1],
            [spacing_m, spacing_m, SIDE_M],
            [[Boundary::NoSlip; 2], [Boundary::NoSlip, lid], [Boundary::Wrap; 2]],
        )
    };
    let mut air = Solver::new(&config).expect("settings are allowed");
    air.set_velocity(|position| guess.map_or([0.0; 3], |air| air.velocity_at(position)));
    // Steps as long as the method takes in one piece where air is as fast as the lid along both axes.
    let per_sec = cells as f64 / 1.73 * 1.5 + 8.0 / 2.51 * (cells * cells) as f64 / reynolds;
    let dt_secs = 0.8 / per_sec;
    let steps_per_sec = dt_secs.recip().ceil() as usize;
    let mut before = Solver::new(&config).expect("settings are allowed");
    for second in 1..200 {
        before.restore(&air.state()).expect("the same grid");
        for _ in 0..steps_per_sec {
            air.step((steps_per_sec as f64).recip(), &[]).expect("within the limits");
        }
        if velocity_difference(&air, &before).linf < STEADY_PER_SEC * SIDE_M {
            println!("Re {reynolds}, {cells}²: steady after {second} s of {steps_per_sec} steps");
            return air;
        }
    }
    panic!("Re {reynolds}, {cells}²: not steady");
}

/// Root mean square, as a share of the lid's speed, of the differences from the table: of u on the vertical centreline, of v on the horizontal one.
fn differences(table: &Cavity, finest: usize) -> [f64; 2] {
    let air = [1, 2, 4]
        .iter()
        .rev()
        .fold(None, |guess: Option<Solver<f32>>, coarser| Some(steady(table.reynolds, finest / coarser, guess.as_ref())));
    let at = |[x, y]: [f64; 2]| {
        air.as_ref()
            .map_or([0.0; 3], |air| air.velocity_at([x, y, 0.5].map(|share| (share * SIDE_M) as f32)))
            .map(|u| f64::from(u) / SIDE_M)
    };
    let norms = table.compare(|y| at([0.5, y])[0], |x| at([x, 0.5])[1]);
    println!("Re {}, {finest}²: u {:.3?}, v {:.3?}", table.reynolds, norms[0], norms[1]);
    norms.map(|norms| norms.l2)
}
#[test]
fn at_reynolds_100_it_is_within_a_hundredth_of_ghias() {
    let found = differences(&GHIA_RE_100, 128);
    assert!(found.iter().all(|&rms| rms <= 0.01), "{found:?}");
}

#[test]
fn at_reynolds_1000_it_is_within_a_hundredth_of_ghias() {
    let found = differences(&GHIA_RE_1000, 128);
    assert!(found.iter().all(|&rms| rms <= 0.01), "{found:?}");
}
