//! The steady lid-driven cavity agrees with Ghia, Ghia & Shin.
//!
//! Their tables have an error of their own (see [`GHIA_RE_1000`]), which is part of the differences here.

use prairie_charts::air::{still_air, velocity_difference};
use prairie_charts::problems::{Cavity, GHIA_RE_100, GHIA_RE_1000};
use prairie_wind::{Boundary, Config, Solver};

/// Side of the box (m), and the speed of its lid (m/s): the unit of time is a second.
const SIDE_M: f64 = 16.0;
/// Change per second, relative to the lid's speed, below which the flow counts as steady.
const STEADY_PER_S: f64 = 1e-4;

/// The steady flow on `cells` × `cells`, started from `guess`.
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
    // The longest step that the method takes without sub-steps if the air is as fast as the lid along both axes.
    let per_s = cells as f64 / 1.73 * 1.5 + 8.0 / 2.51 * (cells * cells) as f64 / reynolds;
    let dt_secs = 0.8 / per_s;
    let steps_per_s = dt_secs.recip().ceil() as usize;
    let mut before = Solver::new(&config).expect("settings are allowed");
    for second in 1..200 {
        before.restore(&air.state()).expect("the same grid");
        for _ in 0..steps_per_s {
            air.step((steps_per_s as f64).recip(), &[]).expect("within the limits");
        }
        if velocity_difference(&air, &before).linf < STEADY_PER_S * SIDE_M {
            println!("Re {reynolds}, {cells}²: steady after {second} s of {steps_per_s} steps");
            return air;
        }
    }
    panic!("Re {reynolds}, {cells}²: not steady");
}

/// Root-mean-square differences from the table, relative to the lid's speed: of u on the vertical centreline, of v on the horizontal one.
fn differences(table: &Cavity, finest: usize) -> [f64; 2] {
    let air = [1, 2, 4]
        .iter()
        .rev()
        .fold(None, |guess: Option<Solver<f32>>, coarser| Some(steady(table.reynolds, finest / coarser, guess.as_ref())));
    let at = |[x, y]: [f64; 2]| {
        air.as_ref()
            .map_or([0.0; 3], |air| air.velocity_at([x, y, 0.5].map(|fraction| (fraction * SIDE_M) as f32)))
            .map(|u| f64::from(u) / SIDE_M)
    };
    let norms = table.compare(|y| at([0.5, y])[0], |x| at([x, 0.5])[1]);
    println!("Re {}, {finest}²: u {:.3?}, v {:.3?}", table.reynolds, norms[0], norms[1]);
    norms.map(|norms| norms.l2)
}
#[test]
fn the_cavity_at_reynolds_100_is_within_1_percent_of_ghia() {
    let found = differences(&GHIA_RE_100, 128);
    assert!(found.iter().all(|&rms| rms <= 0.01), "{found:?}");
}

#[test]
fn the_cavity_at_reynolds_1000_is_within_1_percent_of_ghia() {
    let found = differences(&GHIA_RE_1000, 128);
    assert!(found.iter().all(|&rms| rms <= 0.01), "{found:?}");
}
