//! Where each scheme is accurate, inaccurate or blows up: speed of a car against steps per second.

use std::fmt::Write as _;

use anyhow::Result;
use plotters::style::RGBColor;
use prairie_core::bend::limits::courant_fraction;
use prairie_core::bend::{Coefficients, Damping, Field, Kinds, Rest, Scheme, Serial, WaveParams};
use prairie_core::grid::PatchLayout;

use super::super::figure::{Axis, Drawn, Map, Panel, Words, map_svg};
use crate::problems::bend::{Striker, cells};

/// Side of a cell (m), as Chen & Johan have it, and height at which the car strikes the grass (m).
const CELL_M: f32 = 0.4572;
const STRIKE_HEIGHT_M: f32 = 0.3;
const SPEEDS_M_PER_S: [f64; 2] = [0.0, 60.0];
const RATES_PER_S: [f64; 2] = [20.0, 120.0];
/// Steps into which each tick of the reference is divided.
const FINER: u32 = 8;
/// Bound of the relative root-mean-square error of θ for an accurate run.
const FINE: f64 = 0.25;
/// |θ| (rad) beyond which a run counts as blown up: many times the largest bend by contact.
const BLOWN_UP_RAD: f32 = 50.0;

const CLASSES: [(&str, RGBColor); 3] = [
    ("fine: within 25 % of steps 8 times as short", RGBColor(0, 158, 115)),
    ("inaccurate", RGBColor(230, 159, 0)),
    ("blown up", RGBColor(136, 34, 85)),
];

/// Parameters in the middle of the ranges of Chen & Johan.
const GRASS: WaveParams = WaveParams {
    c0_m_per_s: 3.0,
    mu_m_per_rad: 0.2,
    c_omega_m_per_s: 3.0,
    theta_damping_per_s: 6.0,
    omega_damping_per_s: 6.0,
    stiffness_per_s2: 0.0,
};

/// A second in which a car crosses the field, pressing once a tick; `None` if it blew up.
fn cross(scheme: Scheme, speed_m_per_s: f32, rate_per_s: f32, steps: u32) -> Option<Field> {
    let layout = PatchLayout { count: [2; 2], cells: 16, cell_m: CELL_M };
    let mut field = Field::new(layout, Kinds::one(GRASS)).with_rest(Rest::EXACT);
    field.wake_all();
    let dt_secs = 1.0 / rate_per_s;
    for tick in 0..rate_per_s as u32 {
        let way_m = speed_m_per_s * dt_secs * tick as f32;
        if way_m < 12.0 {
            let at_m = [way_m - 6.0, 0.7];
            Striker { at_m, velocity_m_per_s: [speed_m_per_s, 0.0], radius_m: 1.0, strike_height_m: STRIKE_HEIGHT_M }
                .press(&mut field, dt_secs);
        }
        for _ in 0..steps {
            let report = field.step(scheme, dt_secs / steps as f32, &Serial).ok()?;
            let theta = field.awake().map(|patch| patch.theta_max_rad()).fold(0.0, f32::max);
            // The report counts patches with NaN only one step later.
            if report.reset_patches > 0 || theta.is_nan() || theta > BLOWN_UP_RAD {
                return None;
            }
        }
    }
    Some(field)
}

/// Fewest steps per second at which the scheme of Chen & Johan is stable, against the speed of the car: the grass that it strikes has the bending velocity v/h.
fn theory() -> Vec<[f64; 2]> {
    let is_stable = |speed_m_per_s: f32, rate_per_s: f32| {
        let coefficients = Coefficients::new(&GRASS, CELL_M, 1.0 / rate_per_s, Damping::Plain);
        courant_fraction(&coefficients, speed_m_per_s / STRIKE_HEIGHT_M) <= 1.0
    };
    let [low, high] = RATES_PER_S.map(|rate| rate as f32);
    let speeds_m_per_s = (0..=120).map(|n| SPEEDS_M_PER_S[1] as f32 * n as f32 / 120.0);
    let limits = speeds_m_per_s.filter_map(|speed| {
        let rate = (0..=400).map(|n| low + (high - low) * n as f32 / 400.0).find(|&rate| is_stable(speed, rate))?;
        Some([speed, rate].map(f64::from))
    });
    limits.collect()
}

/// Error of a run relative to its reference; `None` if either blew up.
fn error(run: Option<&Field>, reference: Option<&Field>) -> Option<f64> {
    let (run, reference) = (run?, reference?);
    let (mut apart, mut size) = (0.0, 0.0);
    for (cell, [exact, _]) in cells(reference) {
        apart += f64::from(run.cell(cell.map(|n| n as i64)).theta - exact.theta).powi(2);
        size += f64::from(exact.theta).powi(2);
    }
    Some((apart / f64::max(size, 1e-12)).sqrt())
}

pub(super) fn draw(quick: bool, caption: &str) -> Result<Drawn> {
    let [across, up] = if quick { [9, 7] } else { [20, 16] };
    let middle = |[low, high]: [f64; 2], n: usize, count: usize| (low + (high - low) * (n as f64 + 0.5) / count as f64) as f32;
    let schemes = [("Chen & Johan", Scheme::Verlet), ("sub-stepped", Scheme::Substepped), ("implicit", Scheme::Implicit)];
    let mut panels = schemes.map(|(name, _)| Panel { name: name.into(), columns: vec![vec![0; up]; across], outlines: vec![] });
    // The other schemes have no limit: one takes sub-steps, the other is implicit.
    panels[0].outlines = vec![theory()];
    let mut csv = String::from("scheme,speed_m_per_s,steps_per_s,class,error\n");
    let mut counts = [[0; 3]; 3];
    for (i, j) in (0..across).flat_map(|i| (0..up).map(move |j| (i, j))) {
        let (speed, rate) = (middle(SPEEDS_M_PER_S, i, across), middle(RATES_PER_S, j, up));
        let reference = cross(Scheme::Substepped, speed, rate, FINER);
        for (n, (name, scheme)) in schemes.into_iter().enumerate() {
            let error = error(cross(scheme, speed, rate, 1).as_ref(), reference.as_ref());
            let class = error.map_or(2, |error| usize::from(error > FINE));
            panels[n].columns[i][j] = class;
            counts[n][class] += 1;
            writeln!(csv, "{name},{speed},{rate},{},{}", ["fine", "inaccurate", "blown up"][class], error.unwrap_or(f64::NAN))?;
        }
    }
    let mut summary = String::new();
    for ((name, _), [fine, inaccurate, blown_up]) in schemes.into_iter().zip(counts) {
        let fraction = |count: usize| 100.0 * count as f64 / (across * up) as f64;
        writeln!(
            summary,
            "{name}: {:.0} % fine, {:.0} % inaccurate, {:.0} % blown up",
            fraction(fine),
            fraction(inaccurate),
            fraction(blown_up)
        )?;
    }
    let axis = |name, range| Axis { name, range, logarithmic: false };
    let subtitle = format!(
        "a car strikes grass at {STRIKE_HEIGHT_M} m; line: limit in theory; c0 = {} m/s, μ = {} m/rad, damping {} /s, cells of {CELL_M} m",
        GRASS.c0_m_per_s, GRASS.mu_m_per_rad, GRASS.theta_damping_per_s
    );
    let words = Words { title: "Where each scheme fails", subtitle: &subtitle, caption };
    let axes = [axis("speed of the car (m/s)", SPEEDS_M_PER_S), axis("steps per second", RATES_PER_S)];
    let map = Map { panels: panels.into(), classes: &CLASSES, axes };
    let svg = map_svg(&map, words)?;
    Ok(Drawn { map: Some(map), ..Drawn::new(svg, csv, summary) })
}
