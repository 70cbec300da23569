//! A component under its weight: error of its tip against computing time, by number of sections.

use std::hint::black_box;
use std::sync::OnceLock;
use std::time::Instant;

use anyhow::Result;
use prairie_core::plant::underbrush::rest::{Load, balanced, joints, one_pass};

use super::super::{Outcome, Problem, Run};
use crate::norms::Norms;
use prairie_core::plant::underbrush::elastica::heavy_tip;

type Way = fn(&[f64], Load, f64, &mut [f64]);

const WAYS: [(&str, Way); 2] = [("one pass (Endo et al.)", one_pass), ("balance", balanced)];
const SECTIONS: [usize; 6] = [1, 2, 4, 8, 16, 32];

/// Ratio of the rigidity at the tip to that at the foot.
const TIP_FRACTION: f64 = 0.5;
/// Weights over EI/L², and angles of the unbent axis from upright (rad).
const WEIGHTS: [f64; 4] = [1.0, 3.0, 10.0, 30.0];
const UNBENT_RAD: [f64; 3] = [0.3, 1.0, 1.57];

/// Repetitions for timing.
const REPEATS: usize = 50;

fn cases() -> impl Iterator<Item = (f64, f64)> {
    WEIGHTS.into_iter().flat_map(|weight| UNBENT_RAD.map(|unbent_rad| (weight, unbent_rad)))
}

/// Exact tips of the cases, as continuous beams.
fn exact() -> &'static [[f64; 2]] {
    static TIPS: OnceLock<Vec<[f64; 2]>> = OnceLock::new();
    TIPS.get_or_init(|| cases().map(|(weight, unbent_rad)| heavy_tip(TIP_FRACTION, weight, unbent_rad)).collect())
}

pub(super) fn problem(quick: bool) -> Problem {
    let run = |(name, way): (&str, Way), sections: usize| Run {
        method: name.into(),
        cells: [sections, 1, 1],
        dt_secs: 0.0,
        solve: Box::new(move || bend(way, sections)),
    };
    let counts = &SECTIONS[..SECTIONS.len() - usize::from(quick)];
    Problem {
        name: "Sections under their weight",
        error: "error of the tip (fraction of the length, root mean square)",
        per: "shape",
        default_method: Some("balance"),
        cell_bytes: 0,
        runs: WAYS.into_iter().flat_map(|way| counts.iter().map(move |&sections| run(way, sections))).collect(),
    }
}

fn bend(way: Way, sections: usize) -> Result<Outcome> {
    let joints = joints(sections, TIP_FRACTION);
    let mut bends_rad = vec![0.0; sections];
    let begun = Instant::now();
    for _ in 0..REPEATS {
        for (weight, unbent_rad) in cases() {
            way(black_box(&joints), Load { spread: weight, tip: 0.0 }, unbent_rad, &mut bends_rad);
            black_box(&bends_rad);
        }
    }
    let wall = begun.elapsed();
    let errors: Vec<(f64, f64)> = cases()
        .zip(exact())
        .map(|((weight, unbent_rad), wanted)| {
            way(&joints, Load { spread: weight, tip: 0.0 }, unbent_rad, &mut bends_rad);
            let sum = |part: fn(f64) -> f64| bends_rad.iter().map(|bend_rad| part(unbent_rad + bend_rad)).sum::<f64>() / sections as f64;
            ((sum(f64::sin) - wanted[0]).hypot(sum(f64::cos) - wanted[1]), 0.0)
        })
        .collect();
    Ok(Outcome { error: Norms::of(errors), simulated_secs: (REPEATS * exact().len()) as f64, wall })
}
