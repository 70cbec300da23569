//! Cost of the bend field against the number of moving cars.

use std::f32::consts::TAU;
use std::fmt::Write as _;
use std::time::Instant;

use anyhow::Result;
use prairie_core::bend::{Field, Kinds, Rest, Scheme, Serial};
use prairie_core::grid::PatchLayout;
use prairie_core::scene::Grass;

use super::super::figure::{Axis, Curve, Drawn, Words, curves_svg};
use crate::problems::bend::Striker;

const DT_SECS: f32 = 1.0 / 60.0;
const SPEED_M_PER_S: f32 = 20.0;
const CIRCLE_M: f32 = 20.0;
/// Circles along one side of the world, around corners where four patches meet.
const SIDE: u32 = 16;

/// Cars on separate circles: the shortest time of a step (s) once their tracks have full length, since disturbances only lengthen it, and the mean number of
/// stepped cells.
fn cost(cars: u32, [before, timed]: [u32; 2]) -> Result<[f64; 2]> {
    let layout = PatchLayout { count: [SIDE + 1; 2], cells: 120, cell_m: 0.4572 };
    let grass = Grass::default().waves;
    let mut field = Field::new(layout, Kinds::one(grass)).with_rest(Rest { theta_rad: 0.01, omega_rad_per_s: 0.2 });
    let half_m = layout.extent_m()[0] / 2.0;
    let (mut secs, mut cells) = (f64::INFINITY, 0);
    for step in 0..before + timed {
        for car in 0..cars {
            // Spread over the whole world, whatever their number.
            let corner = (car * (SIDE * SIDE / cars)) % (SIDE * SIDE);
            let center_m = [corner % SIDE, corner / SIDE].map(|n| (n + 1) as f32 * layout.patch_m() - half_m);
            let (sin, cos) = (step as f32 * DT_SECS * SPEED_M_PER_S / CIRCLE_M + car as f32 * TAU / 7.0).sin_cos();
            let striker = Striker {
                at_m: [center_m[0] + CIRCLE_M * cos, center_m[1] + CIRCLE_M * sin],
                velocity_m_per_s: [-SPEED_M_PER_S * sin, SPEED_M_PER_S * cos],
                radius_m: 1.0,
                strike_height_m: 0.3,
            };
            striker.press(&mut field, DT_SECS);
        }
        let begun = Instant::now();
        let report = field.step(Scheme::Substepped, DT_SECS, &Serial)?;
        if step >= before {
            secs = secs.min(begun.elapsed().as_secs_f64());
            cells += report.cell_steps;
        }
    }
    Ok([secs, cells as f64 / f64::from(timed)])
}

/// Least-squares line through points: its value at 0, its slope, and the coefficient of determination R².
fn fit(points: &[[f64; 2]]) -> [f64; 3] {
    let n = points.len() as f64;
    let mean = |axis: usize| points.iter().map(|point| point[axis]).sum::<f64>() / n;
    let [x, y] = [mean(0), mean(1)];
    let sum = |of: &dyn Fn(&[f64; 2]) -> f64| points.iter().map(of).sum::<f64>();
    let slope = sum(&|p| (p[0] - x) * (p[1] - y)) / sum(&|p| (p[0] - x).powi(2));
    let at_zero = y - slope * x;
    let left = sum(&|p| (p[1] - at_zero - slope * p[0]).powi(2)) / sum(&|p| (p[1] - y).powi(2));
    [at_zero, slope, 1.0 - left]
}

pub(super) fn draw(quick: bool, caption: &str) -> Result<Drawn> {
    let (counts, steps): (&[u32], _) =
        if quick { (&[1, 4, 16, 64], [60, 15]) } else { (&[1, 2, 4, 8, 16, 32, 64, 96, 128, 192, 256], [180, 60]) };
    let mut csv = String::from("cars,ms_a_step,cells_stepped\n");
    let mut points = vec![];
    for &cars in counts {
        let [secs, cells] = cost(cars, steps)?;
        writeln!(csv, "{cars},{:e},{cells:e}", 1e3 * secs)?;
        points.push([f64::from(cars), 1e3 * secs]);
    }
    let [at_zero, slope, explained] = fit(&points);
    let most = [counts[counts.len() - 1].into(), points.iter().map(|point| point[1]).fold(0.0, f64::max)];
    let line = Curve {
        name: format!("{:.1} µs + {:.1} µs a car, R² = {explained:.4}", 1e3 * at_zero, 1e3 * slope),
        points: [0.0, most[0]].map(|cars| [cars, (at_zero + slope * cars).max(0.0)]).to_vec(),
        marked: false,
        joined: true,
    };
    let summary = format!("a step of the bend field takes {}", line.name);
    let measured = Curve { name: "measured".into(), points, marked: true, joined: true };
    let axis = |name, most: f64| Axis { name, range: [0.0, 1.05 * most], logarithmic: false };
    let words = Words {
        title: "Cost of moving cars",
        subtitle: "bend field alone, one thread, least of 60 steps; each car circles at 20 m/s; sub-stepped, 60 steps per second",
        caption,
    };
    let svg = curves_svg(&[measured, line], [axis("moving cars", most[0]), axis("time of a step (ms)", most[1])], words)?;
    Ok(Drawn::new(svg, csv, summary))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_straight_line_is_found_again() {
        let [at_zero, slope, explained] = fit(&[[1.0, 5.0], [2.0, 7.0], [4.0, 11.0]]);
        assert!((at_zero - 3.0).abs() < 1e-12 && (slope - 2.0).abs() < 1e-12 && (explained - 1.0).abs() < 1e-12);
        let [_, _, explained] = fit(&[[0.0, 0.0], [1.0, 1.0], [2.0, 0.0]]);
        assert!(explained.abs() < 1e-12);
    }
}
