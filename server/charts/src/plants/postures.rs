//! Posture tables: error of the tip against look-up time, and against the size of the table.

use std::cell::LazyCell;
use std::f64::consts::PI;
use std::fmt::Write as _;
use std::hint::black_box;
use std::sync::OnceLock;
use std::time::Instant;

use anyhow::Result;
use prairie_core::plant::underbrush::posture::{Nodes, Postures};
use prairie_core::plant::underbrush::rest::{Load, balanced, joints};
use prairie_core::plant::underbrush::strength::fractions;

use super::super::figure::{Axis, Curve, Drawn, Words, curves_svg};
use super::super::summary::time_text;
use super::super::{Outcome, Problem, Run};
use crate::norms::Norms;

const SECTIONS: usize = 8;
const TIP_FRACTION: f64 = 0.5;
/// Nodes along each axis of a table.
const SIZES: [usize; 6] = [5, 9, 17, 33, 65, 129];
/// Number of angles and of loads that are looked up.
const SAMPLES: usize = 60;
/// Repetitions for timing.
const REPEATS: usize = 20;

type Node = [f32; SECTIONS + 1];
type Way = fn(&Postures, f32, f32) -> Node;

const WAYS: [(&str, Way); 2] = [("nearest node", nearest), ("interpolated", interpolated)];

fn nearest(table: &Postures, cosine: f32, load: f32) -> Node {
    let node = table.nearest(cosine, load);
    std::array::from_fn(|n| node[n])
}

fn interpolated(table: &Postures, cosine: f32, load: f32) -> Node {
    let mut node = [0.0; SECTIONS + 1];
    table.interpolated(cosine, load, &mut node);
    node
}

/// An angle and a load to look up, and the tip in balance.
struct Sample {
    unbent_rad: f64,
    load: f64,
    tip: [f64; 2],
}

fn tip(unbent_rad: f64, bends_rad: impl Iterator<Item = f64>) -> [f64; 2] {
    bends_rad.take(SECTIONS).fold([0.0; 2], |[aside, up], bend_rad| {
        let (sine, cosine) = (unbent_rad + bend_rad).sin_cos();
        [aside + sine / SECTIONS as f64, up + cosine / SECTIONS as f64]
    })
}

/// All angles, and loads from 0.1 to 200.
fn samples() -> &'static [Sample] {
    static ALL: OnceLock<Vec<Sample>> = OnceLock::new();
    ALL.get_or_init(|| {
        let joints = joints(SECTIONS, TIP_FRACTION);
        let sample = |n: usize| {
            let [angle, load] = [n / SAMPLES, n % SAMPLES].map(|n| (n as f64 + 0.4) / SAMPLES as f64);
            let (unbent_rad, load) = (PI * angle.powf(1.5), 0.1 * 2000f64.powf(load));
            let mut bends_rad = [0.0; SECTIONS];
            balanced(&joints, Load { spread: load, tip: 0.0 }, unbent_rad, &mut bends_rad);
            Sample { unbent_rad, load, tip: tip(unbent_rad, bends_rad.into_iter()) }
        };
        // In an order that gains nothing from caches.
        (0..SAMPLES * SAMPLES).map(|n| sample(n * 1237 % (SAMPLES * SAMPLES))).collect()
    })
}

fn table(size: usize) -> Postures {
    Postures::new(&joints(SECTIONS, TIP_FRACTION), &fractions(SECTIONS, TIP_FRACTION), Nodes { angles: size, loads: size })
}

pub(super) fn problem(quick: bool) -> Problem {
    let run = |(name, way): (&str, Way), size: usize| {
        let table = LazyCell::new(move || table(size));
        Run { method: name.into(), cells: [size, 1, size], dt_secs: 0.0, solve: Box::new(move || Ok(look_up(&table, way))) }
    };
    let sizes = &SIZES[..SIZES.len() - if quick { 2 } else { 0 }];
    Problem {
        name: "Postures looked up",
        error: "error of the tip (fraction of the length, root mean square)",
        per: "look-up",
        default_method: Some("interpolated"),
        cell_bytes: 0,
        runs: WAYS.into_iter().flat_map(|way| sizes.iter().map(move |&size| run(way, size))).collect(),
    }
}

fn look_up(table: &Postures, way: Way) -> Outcome {
    let asked: Vec<[f32; 2]> = samples().iter().map(|sample| [sample.unbent_rad.cos() as f32, sample.load as f32]).collect();
    let begun = Instant::now();
    for _ in 0..REPEATS {
        for &[cosine, load] in &asked {
            black_box(way(table, cosine, load));
        }
    }
    let wall = begun.elapsed();
    let errors = samples().iter().zip(&asked).map(|(sample, &[cosine, load])| {
        let found = tip(sample.unbent_rad, way(table, cosine, load).into_iter().map(f64::from));
        ((found[0] - sample.tip[0]).hypot(found[1] - sample.tip[1]), 0.0)
    });
    Outcome { error: Norms::of(errors), simulated_secs: (REPEATS * asked.len()) as f64, wall }
}

pub(super) fn draw(quick: bool, caption: &str) -> Result<Drawn> {
    let sizes = &SIZES[..SIZES.len() - if quick { 2 } else { 0 }];
    let mut csv = String::from("look_up,nodes,bytes,error_rms,error_max,look_up_secs\n");
    let (mut summary, mut curves) = (String::new(), vec![]);
    for (name, way) in WAYS {
        let mut curve = Curve { name: name.into(), points: vec![], marked: true, joined: true };
        let mut times = vec![];
        for &size in sizes {
            let table = table(size);
            let bytes = size_of_val(table.values());
            let outcomes = [(); 5].map(|()| look_up(&table, way));
            let secs = outcomes.iter().map(|outcome| outcome.wall.as_secs_f64() / outcome.simulated_secs).fold(f64::INFINITY, f64::min);
            let Norms { l2, linf, .. } = outcomes[0].error;
            writeln!(csv, "{name},{},{bytes},{l2:e},{linf:e},{secs:e}", size * size)?;
            curve.points.push([bytes as f64, l2]);
            times.push(secs);
        }
        let [least, most] = [times.iter().copied().fold(f64::INFINITY, f64::min), times.iter().copied().fold(0.0, f64::max)];
        writeln!(summary, "{name}: {} to {} a look-up, from the smallest table to the largest", time_text(least), time_text(most))?;
        curves.push(curve);
    }
    let joints = joints(SECTIONS, TIP_FRACTION);
    let (mut bends_rad, begun) = ([0.0; SECTIONS], Instant::now());
    for sample in samples() {
        balanced(&joints, Load { spread: sample.load, tip: 0.0 }, sample.unbent_rad, &mut bends_rad);
        black_box(&bends_rad);
    }
    writeln!(summary, "the balance itself: {}", time_text(begun.elapsed().as_secs_f64() / samples().len() as f64))?;
    let errors = || curves.iter().flat_map(|curve| &curve.points).map(|point| point[1]);
    let [least, most] = [errors().fold(f64::INFINITY, f64::min), errors().fold(0.0, f64::max)];
    let bytes = |size: usize| (size * size * (SECTIONS + 1) * size_of::<f32>()) as f64;
    let axes = [
        Axis { name: "size of the table (bytes)", range: [0.7 * bytes(sizes[0]), 1.4 * bytes(sizes[sizes.len() - 1])], logarithmic: true },
        Axis { name: "error of the tip (fraction of the length)", range: [least / 1.5, most * 1.5], logarithmic: true },
    ];
    let words = Words {
        title: "Cost of a posture table",
        subtitle: "root mean square over all angles and loads of 0.1 to 200 EI/L², against the balance of eight sections",
        caption,
    };
    let svg = curves_svg(&curves, axes, words)?;
    Ok(Drawn::new(svg, csv, summary))
}
