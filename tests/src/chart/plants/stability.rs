//! The longest steps that a blade bears, against its damping.

use std::fmt::Write as _;

use anyhow::Result;
use shared::plant::blade::modes::FREQUENCIES;
use shared::plant::blade::propagator::stable_dt_secs;
use shared::plant::blade::{Blade, Integrator, LINKS, Leans, Sway, advance};

use super::super::figure::{Axis, Curve, Drawn, Words, curves_svg};

/// Lowest frequency of the blade (rad/s); the chart is in units of the highest.
const FREQUENCY_RAD_PER_S: f32 = 10.0;
/// How closely the limit is looked for.
const CLOSE: f32 = 1.005;

/// Whether a blade that is bent in all of its modes stays within a hundred times that.
fn holds(integrator: Integrator, damping_share: f32, dt_secs: f32) -> bool {
    let blade = Blade { length_m: 0.8, frequency_rad_per_s: FREQUENCY_RAD_PER_S, damping_share, lean_per_wind2: 0.0 };
    // Half a hundredth beyond its limit Euler grows by 0.01·ζ² a step; enough of them for e⁶.
    let steps = (600.0 / (damping_share * damping_share)).clamp(2e4, 3e6) as u32;
    let calm = Leans::default();
    let mut sway = Sway::at_rest([[0.01, 0.0], [-0.01, 0.01], [0.01, -0.01]]);
    (0..steps).all(|step| {
        sway = advance(&sway, &blade, &calm, &calm, integrator, dt_secs);
        step % 64 != 0 || sway.lean_rad.as_flattened().iter().all(|lean_rad| lean_rad.abs() < 1.0)
    })
}

/// The longest step (s) that holds, between half and twice the limit in theory.
fn measured_secs(integrator: Integrator, damping_share: f32, limit_secs: f32) -> f32 {
    let (mut low, mut high) = (0.5 * limit_secs, 2.0 * limit_secs);
    while high / low > CLOSE {
        let middle = (low * high).sqrt();
        if holds(integrator, damping_share, middle) { low = middle } else { high = middle }
    }
    low
}

pub(super) fn draw(quick: bool, caption: &str) -> Result<Drawn> {
    let (fewest, dampings) = if quick { (0.1_f32, 4) } else { (0.02, 10) };
    let highest_rad_per_s = FREQUENCY_RAD_PER_S * FREQUENCIES[LINKS - 1];
    let damping = |n: f32| fewest * (1.0 / fewest).powf(n);
    let (mut csv, mut said) = (String::from("integrator,damping_share,theory_rad,measured_rad\n"), String::new());
    let mut curves = vec![];
    for (integrator, name, formula) in
        [(Integrator::Verlet, "Verlet (000 Eq. 7)", "Verlet: 2(√(1 + ζ²) − ζ)"), (Integrator::Euler, "Euler (000 Eq. 6)", "Euler: 2ζ")]
    {
        let theory_secs = |share: f32| stable_dt_secs(integrator, FREQUENCY_RAD_PER_S, share);
        let line = (0..=60).map(|n| damping(n as f32 / 60.0)).map(|share| [share, theory_secs(share) * highest_rad_per_s].map(f64::from));
        curves.push(Curve { name: format!("{formula}, theory"), points: line.collect(), marked: false, joined: true });
        let mut found = Curve { name: format!("{name}, measured"), points: vec![], marked: true, joined: false };
        let (mut least, mut most) = (f32::INFINITY, 0.0_f32);
        for share in (0..dampings).map(|n| damping(n as f32 / (dampings - 1) as f32)) {
            let (theory, measured) = (theory_secs(share), measured_secs(integrator, share, theory_secs(share)));
            (least, most) = (least.min(measured / theory), most.max(measured / theory));
            writeln!(csv, "{integrator:?},{share},{},{}", theory * highest_rad_per_s, measured * highest_rad_per_s)?;
            found.points.push([share, measured * highest_rad_per_s].map(f64::from));
        }
        writeln!(said, "{name}: fails at {least:.3} to {most:.3} of its limit")?;
        curves.push(found);
    }
    let holds_all = [0.0, 0.02, 1.0]
        .into_iter()
        .all(|share| [1.0, 100.0, 1e5].into_iter().all(|step| holds(Integrator::Exact, share, step / highest_rad_per_s)));
    writeln!(said, "exact: {} at ω·dt of 1, 100 and 100 000", if holds_all { "holds" } else { "fails" })?;
    let axes = [
        Axis { name: "damping ζ, as a share of the critical one", range: [0.9 * f64::from(fewest), 1.1], logarithmic: true },
        Axis { name: "longest step ω·dt of the highest mode (rad)", range: [1.6 * f64::from(fewest), 3.0], logarithmic: true },
    ];
    let words = Words {
        title: "How long steps of a blade may be",
        subtitle: "below its line an integrator is stable; the exact one is so everywhere",
        caption,
    };
    let svg = curves_svg(&curves, axes, words)?;
    Ok(Drawn { svg, csv, said })
}
