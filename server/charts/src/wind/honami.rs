//! Waves over grass: frequency against the wind, and a field of waves.

use std::fmt::Write as _;

use anyhow::Result;
use plotters::style::RGBColor;

use super::super::figure::{Axis, Curve, Drawn, Map, Panel, Words, curves_svg, map_svg};
use crate::problems::honami::{ALFALFA, Meadow, rigid, simulation, stability};

/// Winds (m/s) of the frequencies.
const WINDS_M_PER_S: [f64; 9] = [2.0, 3.0, 4.0, 4.5, 5.0, 5.5, 6.0, 7.0, 8.0];
/// Nodes and cells per height of the canopy.
const NODES: usize = 12;
const CELLS: usize = 12;

const HZ: f64 = 1.0 / std::f64::consts::TAU;

/// Draws the frequency of the most amplified wave against the wind, in theory and in the solver.
pub(super) fn draw_lock_in(quick: bool, caption: &str) -> Result<Drawn> {
    let winds = WINDS_M_PER_S.iter().step_by(if quick { 4 } else { 1 });
    let own_hz = f64::from(ALFALFA.motion.map_or(0.0, |motion| motion.frequency_hz));
    let mut csv = String::from("wind_m_per_s,grass,k_per_m,theory_hz,solver_hz,theory_growth_per_s,solver_growth_per_s\n");
    let (mut summary, mut curves) = (String::new(), vec![]);
    for (name, meadow) in [("grass that sways", ALFALFA), ("rigid grass", rigid(ALFALFA))] {
        let [mut theory, mut found] = [(true, false), (false, true)].map(|(joined, marked)| Curve {
            name: if joined { format!("{name}: theory") } else { format!("{name}: solver") },
            points: vec![],
            marked,
            joined,
        });
        for wind_m_per_s in winds.clone() {
            let meadow = Meadow { wind_m_per_s: *wind_m_per_s, ..meadow };
            let wave = stability::most_amplified(&meadow, NODES);
            let solved = simulation::wave(&meadow, wave.k_per_m, if quick { 6 } else { CELLS });
            let [theory_hz, solver_hz] = [wave, solved].map(|wave| wave.frequency_rad_per_s * HZ);
            let [theory_growth, solver_growth] = [wave, solved].map(|wave| wave.growth_per_s);
            writeln!(csv, "{wind_m_per_s},{name},{},{theory_hz},{solver_hz},{theory_growth},{solver_growth}", wave.k_per_m)?;
            writeln!(summary, "{wind_m_per_s} m/s, {name}: {theory_hz:.3} Hz in theory, {solver_hz:.3} Hz")?;
            theory.points.push([*wind_m_per_s, theory_hz]);
            found.points.push([*wind_m_per_s, solver_hz]);
        }
        curves.extend([theory, found]);
    }
    let own = WINDS_M_PER_S.map(|wind_m_per_s| [wind_m_per_s, own_hz]).to_vec();
    curves.push(Curve { name: "the grass alone".into(), points: own, marked: false, joined: true });
    let axes = [
        Axis { name: "wind (m/s)", range: [1.5, 8.5], logarithmic: false },
        Axis { name: "frequency of the most amplified wave (Hz)", range: [0.0, 2.0], logarithmic: false },
    ];
    let subtitle = "0.7 m high, 1.05 Hz, as alfalfa; rigid grass waves the faster the stronger the wind (Py, de Langre & Moulia 2006)";
    let words = Words { title: "Waves over grass are drawn to its own frequency", subtitle, caption };
    Ok(Drawn { svg: curves_svg(&curves, axes, words)?, csv, summary, tables: None, map: None })
}

/// Colours of the displacement, from far behind its mean to far ahead of it.
const CLASSES: [(&str, RGBColor); 5] = [
    ("upright", RGBColor(52, 84, 40)),
    ("", RGBColor(98, 134, 62)),
    ("mean", RGBColor(150, 178, 88)),
    ("", RGBColor(202, 214, 134)),
    ("bent", RGBColor(244, 240, 190)),
];

/// Draws the displacement of the grass by place and time, in a wind near the frequency of the grass.
pub(super) fn draw_field(quick: bool, caption: &str) -> Result<Drawn> {
    let field = simulation::field(&ALFALFA, if quick { 4 } else { 8 });
    let values = || field.displacement_m.iter().flatten();
    let mean = values().sum::<f64>() / values().count() as f64;
    let deviation = (values().map(|value| (value - mean).powi(2)).sum::<f64>() / values().count() as f64).sqrt();
    let class = |value: f64| ((value - mean) / deviation / 0.8 + 2.5).clamp(0.0, 4.0) as usize;
    let mut csv = String::from("time_secs,x_m,displacement_m\n");
    for (n, row) in field.displacement_m.iter().enumerate() {
        for (i, value) in row.iter().enumerate() {
            writeln!(csv, "{:.3},{:.3},{value:.5}", n as f64 * field.interval_secs, i as f64 * field.spacing_m)?;
        }
    }
    let places = field.displacement_m[0].len();
    let columns = (0..places).map(|i| field.displacement_m.iter().map(|row| class(row[i])).collect()).collect();
    let [width_m, secs] = [places as f64 * field.spacing_m, field.displacement_m.len() as f64 * field.interval_secs];
    let axes = [
        Axis { name: "along the wind (m)", range: [0.0, width_m], logarithmic: false },
        Axis { name: "time (s)", range: [0.0, secs], logarithmic: false },
    ];
    let subtitle = "waves travel to the right; their slope is their speed";
    let panels = [Panel { name: format!("{} m/s", ALFALFA.wind_m_per_s), columns, outlines: vec![] }];
    let svg = map_svg(&Map { panels: panels.into(), classes: &CLASSES, axes }, Words { title: "Waves over a field", subtitle, caption })?;
    let summary = format!("displacement {mean:.3} m on average, {deviation:.3} m root mean square about it\n");
    Ok(Drawn::new(svg, csv, summary))
}
