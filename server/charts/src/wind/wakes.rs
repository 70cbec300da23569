//! Fields to look at: vortices behind a cylinder that is immersed in the grid, and a vortex that leaves the box.

use std::fmt::Write as _;

use anyhow::Result;
use plotters::style::RGBColor;
use prairie_wind::{Boundary, Config, Solver};

use super::super::figure::{Axis, Drawn, Map, Panel, Words, map_svg};
use crate::air::{run, still_air};

/// Colours of a velocity component from −1 to 1 of its scale, and that of a solid.
const CLASSES: [(&str, RGBColor); 8] = [
    ("down", RGBColor(33, 76, 140)),
    ("", RGBColor(92, 140, 190)),
    ("", RGBColor(170, 200, 224)),
    ("none", RGBColor(244, 244, 240)),
    ("", RGBColor(240, 196, 164)),
    ("", RGBColor(210, 120, 84)),
    ("up", RGBColor(160, 44, 40)),
    ("solid", RGBColor(70, 70, 70)),
];

/// Class of a value relative to its scale.
fn class(fraction: f64) -> usize {
    ((fraction * 3.5 + 3.5).floor().clamp(0.0, 6.0)) as usize
}

/// A panel of the velocity across the wind on `columns × rows` places over `size_m`, with its values as CSV.
fn panel(
    name: &str,
    air: &Solver<f64>,
    [columns, rows]: [usize; 2],
    [from_m, size_m]: [[f64; 2]; 2],
    scale_m_per_s: f64,
    is_solid: impl Fn([f64; 2]) -> bool,
    csv: &mut String,
) -> Result<Panel> {
    let mut classes = vec![];
    for i in 0..columns {
        let mut column = vec![];
        for j in 0..rows {
            let place =
                [(i, columns, 0), (j, rows, 1)].map(|(n, count, axis)| from_m[axis] + (n as f64 + 0.5) / count as f64 * size_m[axis]);
            let [u, v, _] = air.velocity_at([place[0], place[1], 0.0]);
            writeln!(csv, "{name},{:.3},{:.3},{u:.4},{v:.4}", place[0], place[1])?;
            column.push(if is_solid(place) { CLASSES.len() - 1 } else { class(v / scale_m_per_s) });
        }
        classes.push(column);
    }
    Ok(Panel { name: name.to_owned(), columns: classes, outlines: vec![] })
}

/// Draws the vortices behind a cylinder of 1 m in a stream of 1 m/s at Re = 100.
pub(super) fn draw_cylinder(quick: bool, caption: &str) -> Result<Drawn> {
    let (cells, [length_m, width_m], centre) = (if quick { 4.0 } else { 10.0 }, [20.0, 14.0], [6.03, 7.02]);
    let spacing_m = 1.0 / cells;
    let faces = [[Boundary::Inflow, Boundary::Outflow], [Boundary::Outflow; 2], [Boundary::Wrap; 2]];
    let config = Config {
        viscosity_m2_per_s: 0.01,
        mean_wind_m_per_s: [1.0, 0.0, 0.0],
        ..still_air([(length_m * cells) as usize, (width_m * cells) as usize, 1], [spacing_m; 3], faces)
    };
    let mut air = Solver::<f64>::new(&config)?;
    let distance_m = |[x, y]: [f64; 2]| (x - centre[0]).hypot(y - centre[1]) - 0.5;
    air.set_walls(|[x, y, _]| distance_m([x, y]), |_| [0.0; 3])?;
    // A push beside the middle, without which the flow stays even for long.
    air.set_velocity(|[x, y, _]: [f64; 3]| {
        let apart = (x - centre[0] - 1.0).powi(2) + (y - centre[1]).powi(2);
        [1.0, 0.5 * (-apart).exp(), 0.0]
    });
    let secs = if quick { 10.0 } else { 60.0 };
    run(&mut air, secs, (secs / (0.4 * spacing_m)) as usize);
    let mut csv = String::from("panel,x_m,y_m,u_m_per_s,v_m_per_s\n");
    let (from_m, size_m) = ([4.0, 2.0], [14.0, 10.0]);
    let name = format!("after {secs} s");
    let panels = [panel(&name, &air, [56, 40], [from_m, size_m], 0.6, |place| distance_m(place) <= 0.0, &mut csv)?];
    let axes = [
        Axis { name: "along the wind (diameters)", range: [from_m[0], from_m[0] + size_m[0]], logarithmic: false },
        Axis { name: "across (diameters)", range: [from_m[1], from_m[1] + size_m[1]], logarithmic: false },
    ];
    let subtitle = "velocity across the wind, Re = 100; the cylinder is immersed, ten cells wide";
    let svg =
        map_svg(&Map { panels: panels.into(), classes: &CLASSES, axes }, Words { title: "Vortices behind a cylinder", subtitle, caption })?;
    let [drag, lift, _] = air.wall_force_m4_per_s2().map(|force| 2.0 * force / spacing_m);
    Ok(Drawn { svg, csv, summary: format!("drag coefficient {drag:.3}, lift {lift:.3}\n"), tables: None, map: None })
}

/// Draws a vortex of 3 m core that the wind carries out of a box.
pub(super) fn draw_outflow(quick: bool, caption: &str) -> Result<Drawn> {
    let (rows, [length_m, width_m], wind_m_per_s) = (if quick { 16 } else { 64 }, [64.0, 32.0], 4.0);
    let spacing_m = width_m / rows as f64;
    let faces = [[Boundary::Inflow, Boundary::Outflow], [Boundary::FreeSlip; 2], [Boundary::Wrap; 2]];
    let config = Config { mean_wind_m_per_s: [wind_m_per_s as f32, 0.0, 0.0], ..still_air([2 * rows, rows, 1], [spacing_m; 3], faces) };
    let mut air = Solver::<f64>::new(&config)?;
    let (core_m, speed_m_per_s) = (3.0, 6.0);
    air.set_velocity(|[x, y, _]: [f64; 3]| {
        let [dx, dy] = [x - 48.0, y - 16.0];
        let turn = speed_m_per_s / core_m * (0.5 * (1.0 - (dx * dx + dy * dy) / (core_m * core_m))).exp();
        [wind_m_per_s - turn * dy, turn * dx, 0.0]
    });
    let mut csv = String::from("panel,x_m,y_m,u_m_per_s,v_m_per_s\n");
    let (mut panels, mut left) = (vec![], vec![]);
    for (name, secs) in [("at the start", 0.0), ("after 4 s", 4.0), ("after 9 s", 5.0)] {
        run(&mut air, secs, (secs * 40.0 / spacing_m) as usize);
        panels.push(panel(name, &air, [32, 16], [[0.0; 2], [length_m, width_m]], speed_m_per_s, |_| false, &mut csv)?);
        left.push(air.samples(1).map(|(_, v)| v * v).sum::<f64>());
    }
    let axes = [
        Axis { name: "along the wind (m)", range: [0.0, length_m], logarithmic: false },
        Axis { name: "across (m)", range: [0.0, width_m], logarithmic: false },
    ];
    let subtitle = "velocity across the wind; the open face on the right reflects less than 1 % of the energy";
    let svg = map_svg(&Map { panels, classes: &CLASSES, axes }, Words { title: "A vortex leaves the box", subtitle, caption })?;
    let [_, half, last] = [0, 1, 2].map(|n| left[n] / left[0]);
    Ok(Drawn { svg, csv, summary: format!("of v² {half:.3} are left after 4 s, {last:.1e} after 9 s\n"), tables: None, map: None })
}
