//! Error of the loose overlap of Chen & Johan against the wave speed.

use std::fmt::Write as _;

use anyhow::Result;
use prairie_core::bend::{Field, Kinds, Scheme, Seams, Serial, WaveParams};
use prairie_core::grid::PatchLayout;

use super::super::figure::{Axis, Curve, Drawn, Words, curves_svg};
use crate::problems::bend::{Striker, largest_difference};

const DT_SECS: f32 = 1.0 / 60.0;
const DAMPING_PER_S: [f32; 3] = [1.0, 6.0, 30.0];

/// Largest difference of θ (rad), at any time while a car crosses a border between patches, between exact seams and overlaps.
fn error_rad(c0_m_per_s: f32, damping_per_s: f32) -> Result<f32> {
    let grass = WaveParams {
        c0_m_per_s,
        mu_m_per_rad: 0.0,
        c_omega_m_per_s: c0_m_per_s,
        theta_damping_per_s: damping_per_s,
        omega_damping_per_s: damping_per_s,
        stiffness_per_s2: 1.2,
    };
    let layout = PatchLayout { count: [3; 2], cells: 32, cell_m: 0.4572 };
    let mut fields = [Seams::Exact, Seams::Overlap].map(|seams| Field::new(layout, Kinds::one(grass)).with_seams(seams));
    fields.iter_mut().for_each(Field::wake_all);
    let mut largest = 0.0f32;
    for step in 0..120 {
        let secs = step as f32 * DT_SECS;
        let car =
            Striker { at_m: [-8.0 + 12.0 * secs, 3.0 + 3.0 * secs], velocity_m_per_s: [12.0, 3.0], radius_m: 1.0, strike_height_m: 0.4 };
        for field in &mut fields {
            if step < 90 {
                car.press(field, DT_SECS);
            }
            field.step(Scheme::Substepped, DT_SECS, &Serial)?;
        }
        largest = largest.max(largest_difference(&fields[0], &fields[1])[1]);
    }
    Ok(largest)
}

pub(super) fn draw(quick: bool, caption: &str) -> Result<Drawn> {
    let count = if quick { 5 } else { 11 };
    let speeds = (0..count).map(|n| 0.5 * 20.0f64.powf(f64::from(n) / f64::from(count - 1)));
    let mut csv = String::from("damping_per_s,lambda_at_60_hz,c_m_per_s,error_rad\n");
    let mut curves = vec![];
    for damping_per_s in DAMPING_PER_S {
        let lambda = 1.0 - (-damping_per_s * DT_SECS).exp();
        let mut curve = Curve { name: format!("{damping_per_s} /s (λ = {lambda:.2})"), points: vec![], marked: true, joined: true };
        for speed in speeds.clone() {
            let error = f64::from(error_rad(speed as f32, damping_per_s)?);
            writeln!(csv, "{damping_per_s},{lambda},{speed},{error:e}")?;
            curve.points.push([speed, error.max(1e-9)]);
        }
        curves.push(curve);
    }
    let errors = || curves.iter().flat_map(|curve| &curve.points).map(|point| point[1]);
    let [least, most] = [errors().fold(f64::INFINITY, f64::min), errors().fold(0.0, f64::max)];
    let summary = format!("the overlap is off by {least:.1e} to {most:.2} rad, of at most π/2 = 1.57");
    let axes = [
        Axis { name: "wave speed c (m/s)", range: [0.45, 11.0], logarithmic: true },
        Axis { name: "largest error of θ (rad)", range: [least / 1.5, most * 1.5], logarithmic: true },
    ];
    let words = Words {
        title: "Error of the loose overlap",
        subtitle: "a car at 12 m/s across a border between patches; against exact seams, by damping rate",
        caption,
    };
    let svg = curves_svg(&curves, axes, words)?;
    Ok(Drawn::new(svg, csv, summary))
}
