//! Force on a plant in a passing gust: the dynamic constraint with its velocity term, and without it, as in Endo et al. 2003, Eq. (5).

use std::fmt::Write as _;

use anyhow::Result;
use prairie_core::plant::underbrush::constraint::Following;

use super::super::figure::{Axis, Curve, Drawn, Words, curves_svg};

/// Time constant τ (s); the default of a species.
const SETTLE_SECS: f32 = 0.25;
/// Start and end of the gust, and end of the run (s).
const GUST_SECS: [f32; 2] = [0.5, 1.3];
const END_SECS: f32 = 5.0;

type Way = fn(&Following, [f32; 3], f32, f32) -> Following;

fn gust_at(secs: f32) -> f32 {
    if (GUST_SECS[0]..GUST_SECS[1]).contains(&secs) { 1.0 } else { 0.0 }
}

pub(super) fn draw(quick: bool, caption: &str) -> Result<Drawn> {
    let steps: usize = if quick { 100 } else { 1000 };
    let dt_secs = END_SECS / steps as f32;
    let (mut csv, mut summary) = (String::from("way,secs,force\n"), String::new());
    let corners = [[0.0, 0.0], [GUST_SECS[0], 0.0], [GUST_SECS[0], 1.0], [GUST_SECS[1], 1.0], [GUST_SECS[1], 0.0], [END_SECS, 0.0]];
    let mut curves =
        vec![Curve { name: "the gust".into(), points: corners.map(|at| at.map(f64::from)).to_vec(), marked: false, joined: true }];
    let ways: [(&str, Way); 2] =
        [("without the velocity term (Endo et al., Eq. 5)", Following::swung), ("closed form, critically damped", Following::followed)];
    for (name, way) in ways {
        let mut plant = Following::default();
        let mut curve = Curve { name: name.into(), points: vec![[0.0, 0.0]], marked: false, joined: true };
        for step in 1..=steps {
            // The force at mid-step, so that no step uses one that is over at its end.
            plant = way(&plant, [gust_at((step as f32 - 0.5) * dt_secs), 0.0, 0.0], SETTLE_SECS, dt_secs);
            let secs = f64::from(step as f32 * dt_secs);
            curve.points.push([secs, plant.value[0].into()]);
            writeln!(csv, "{name},{secs:.4},{:.6}", plant.value[0])?;
        }
        let values = || curve.points.iter().map(|point| point[1]);
        let late =
            curve.points.iter().filter(|point| point[0] > f64::from(GUST_SECS[1]) + 1.5).map(|point| point[1].abs()).fold(0.0, f64::max);
        let [least, most] = [values().fold(0.0, f64::min), values().fold(0.0, f64::max)];
        writeln!(summary, "{name}: between {least:.2} and {most:.2} of the gust; from 1.5 s after its end up to {late:.3}")?;
        curves.push(curve);
    }
    let axes = [
        Axis { name: "time (s)", range: [0.0, END_SECS.into()], logarithmic: false },
        Axis { name: "force on the plant (relative to the gust's)", range: [-2.2, 2.2], logarithmic: false },
    ];
    let subtitle = format!("a gust from {} to {} s, with a time constant τ of {SETTLE_SECS} s", GUST_SECS[0], GUST_SECS[1]);
    let svg = curves_svg(&curves, axes, Words { title: "The dynamic constraint", subtitle: &subtitle, caption })?;
    Ok(Drawn::new(svg, csv, summary))
}
