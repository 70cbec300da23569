//! Where transport by fluxes fails: Courant number against diffusion number, measured on noise, beside the limit in theory.

use std::fmt::Write as _;

use anyhow::Result;
use plotters::style::RGBColor;

use super::super::figure::{Axis, Drawn, Map, Panel, Words, map_svg};
use crate::limits::Transport;

const CELLS: usize = 16;
const COURANT: [f64; 2] = [0.0, 2.4];
const DIFFUSION: [f64; 2] = [0.0, 0.8];
const CLASSES: [(&str, RGBColor); 2] = [("noise decays", RGBColor(0, 158, 115)), ("noise grows", RGBColor(136, 34, 85))];

/// Air of 1 m/s along a line of cells of 1 m, so that a step of a second has a Courant number of 1.
fn transport(courant: f64, diffusion: f64, damping: f64) -> Transport {
    let diffusivity_m2_per_s = diffusion / courant;
    Transport { cells: [CELLS, 1, 1], spacing_m: [1.0; 3], air_m_per_s: [1.0, 0.0, 0.0], diffusivity_m2_per_s, damping }
}

/// Smallest and largest diffusion number without amplification at a Courant number, over the wave numbers of the line; `None` if every number amplifies. Beyond
/// the limit of advection alone some diffusion is needed.
fn theory(courant: f64, damping: f64) -> Option<[f64; 2]> {
    let is_stable = |diffusion| transport(courant, diffusion, damping).amplification(courant, CELLS) <= 1.0 + 1e-12;
    let steps = 800;
    let mut stable = (0..=steps).map(|n| DIFFUSION[1] * f64::from(n) / f64::from(steps)).filter(|&diffusion| is_stable(diffusion));
    let smallest = stable.next()?;
    Some([smallest, stable.next_back().unwrap_or(smallest)])
}

pub(super) fn draw(quick: bool, caption: &str) -> Result<Drawn> {
    let [across, up] = if quick { [12, 8] } else { [48, 32] };
    let middle = |[low, high]: [f64; 2], n: usize, count: usize| low + (high - low) * (n as f64 + 0.5) / count as f64;
    let mut csv = String::from("damping,courant,diffusion_number,class\n");
    let (mut summary, mut panels) = (String::new(), vec![]);
    for (name, damping) in [("damping 0", 0.0), ("damping 1 (default)", 1.0)] {
        let mut columns = vec![vec![0; up]; across];
        let mut agreeing = 0;
        for (i, j) in (0..across).flat_map(|i| (0..up).map(move |j| (i, j))) {
            let [courant, diffusion] = [middle(COURANT, i, across), middle(DIFFUSION, j, up)];
            let is_stable = transport(courant, diffusion, damping).holds(courant);
            columns[i][j] = usize::from(!is_stable);
            agreeing += usize::from(is_stable == (transport(courant, diffusion, damping).amplification(courant, CELLS) <= 1.0 + 1e-12));
            writeln!(csv, "{damping},{courant},{diffusion},{}", CLASSES[usize::from(!is_stable)].0)?;
        }
        writeln!(summary, "{name}: measured as in theory at {agreeing} of {} places", across * up)?;
        let limits: Vec<_> = (1..=240)
            .map(|n| COURANT[1] * f64::from(n) / 240.0)
            .map_while(|courant| theory(courant, damping).map(|[smallest, largest]| (courant, smallest, largest)))
            .collect();
        // Along the largest numbers, and back along the smallest where they are above 0.
        let forth = limits.iter().map(|&(courant, _, largest)| [courant, largest]);
        let back = limits.iter().rev().filter(|(_, smallest, _)| *smallest > 0.0).map(|&(courant, smallest, _)| [courant, smallest]);
        let outline = forth.chain(back).collect();
        panels.push(Panel { name: name.into(), columns, outlines: vec![outline] });
    }
    let axis = |name, range| Axis { name, range, logarithmic: false };
    let axes = [axis("Courant number", COURANT), axis("diffusion number", DIFFUSION)];
    let map = Map { panels, classes: &CLASSES, axes };
    let subtitle = "Runge–Kutta 3 with fluxes, 16 cells, 400 steps on noise; the line is the limit in theory";
    let svg = map_svg(&map, Words { title: "Where transport by fluxes fails", subtitle, caption })?;
    Ok(Drawn { map: Some(map), ..Drawn::new(svg, csv, summary) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_grows_beyond_the_limit_in_theory_and_not_within_it() {
        for damping in [0.0, 1.0] {
            for courant in [0.3, 0.9, 1.5] {
                let [_, limit] = theory(courant, damping).unwrap();
                assert!(limit > 0.0 && transport(courant, 0.97 * limit, damping).holds(courant), "{courant}, {damping}: {limit}");
                assert!(!transport(courant, 1.05 * limit, damping).holds(courant), "{courant}, {damping}: {limit}");
            }
        }
        let [smallest, _] = theory(2.1, 0.0).unwrap();
        assert!(smallest > 0.05 && transport(2.1, 1.1 * smallest, 0.0).holds(2.1), "{smallest}");
        assert!(!transport(2.1, 0.9 * smallest, 0.0).holds(2.1), "{smallest}");
    }
}
