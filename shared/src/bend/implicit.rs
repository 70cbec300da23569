//! Newmark's average acceleration (β = ¼) by alternating directions.
//!
//! With δ = θ⁺ − 2θ + θ⁻, r = c·dt/h and A = 1 + k·dt/2 + κ·dt²/4 the step of `θ'' + kθ' + κθ = c²·Lθ` is
//! `A·δ − ¼r²·(Lx + Lz)·δ = r²·Lθ − κ·dt²·θ − k·dt·(θ − θ⁻)`. Factored into `(1 − a·Lx)(1 − a·Lz)·δ` with a = r²/(4A), which
//! changes it by terms of second order, it asks for a tridiagonal system along each row, then along each column (Lees, Alternating
//! direction methods for hyperbolic differential equations, J. SIAM 10, 1962). Stable for any step where c is constant.

use super::halo::Edges;
use super::patch::{CHANNELS, Ground, Patch, Planes};
use super::tridiagonal::{End, LANES, Lanes, Line};
use super::{Crew, Field, Report, WaveParams};
use std::collections::BTreeMap;

/// What a step multiplies with, of one kind of grass; θ first, then ω.
struct Coefficients {
    /// Courant numbers at rest, and of θ for each rad/s of bending speed.
    r: [f32; 2],
    r_mu: f32,
    /// κ·dt².
    restoring: f32,
    /// k·dt.
    damping: [f32; 2],
    /// 1/A.
    inverse_mass: [f32; 2],
}

impl Coefficients {
    fn new(waves: &WaveParams, cell_m: f32, dt_secs: f32) -> Self {
        let courant = dt_secs / cell_m;
        let restoring = waves.stiffness_per_s2 * dt_secs * dt_secs;
        let damping = [waves.theta_damping_per_s, waves.omega_damping_per_s].map(|rate| rate * dt_secs);
        Self {
            r: [waves.c0_m_per_s, waves.c_omega_m_per_s].map(|speed| speed * courant),
            r_mu: waves.mu_m_per_rad * courant,
            restoring,
            damping,
            inverse_mass: damping.map(|damping| 1.0 / (1.0 + 0.5 * damping + 0.25 * restoring)),
        }
    }

    /// Courant number of θ (0) or ω (1) where the grass bends at a speed whose square is `omega2`.
    fn r(&self, set: usize, omega2: f32) -> f32 {
        if set == 0 { self.r[0] + self.r_mu * omega2.sqrt() } else { self.r[1] }
    }
}

/// Advances all patches that anything in or around moves by one step of `dt_secs`.
pub(super) fn step(field: &mut Field, dt_secs: f32, crew: &impl Crew) -> Report {
    let ratio = field.dt_secs.replace(dt_secs).map_or(1.0, |last| dt_secs / last);
    let kinds: Vec<_> = field.kinds.waves().iter().map(|waves| Coefficients::new(waves, field.layout.cell_m, dt_secs)).collect();
    let refused = field.meet(1);
    let mut changes: Vec<Planes> = field.patches.iter().map(|_| Planes::default()).collect();
    let tasks: Vec<_> = field.patches.iter_mut().zip(&mut changes).collect();
    crew.for_each(tasks, |(patch, changes)| *changes = forces(patch, &kinds, ratio));
    for axis in [0, 1] {
        let lines = lines(field, &mut changes, axis);
        crew.for_each(lines, |mut line| line.solve(&kinds, axis));
    }
    let tasks: Vec<_> = field.patches.iter_mut().zip(&changes).collect();
    crew.for_each(tasks, |(patch, changes)| take_on(patch, changes));
    let cells = u64::from(field.layout.cells).pow(2);
    Report { substeps: 1, cell_steps: cells * field.patches.len() as u64, refused, ..Report::default() }
}

fn kind_at(patch: &Patch, at: usize) -> usize {
    match &patch.ground {
        Ground::One(kind) => usize::from(*kind),
        Ground::Map(kinds) => usize::from(kinds[at]),
    }
}

/// Right-hand sides over A, of the patch's own cells, row by row. Moves the earlier state if dt has changed, and where waves slow down, which keep
/// their motion only in part, as in [`verlet`](super::verlet).
fn forces(patch: &mut Patch, kinds: &[Coefficients], ratio: f32) -> Planes {
    let (side, stride) = (patch.side(), patch.stride());
    let mut forces: Planes = std::array::from_fn(|_| Vec::with_capacity(side * side));
    for j in 0..side as i64 {
        let row = patch.at(0, j);
        for at in row..row + side {
            let k = &kinds[kind_at(patch, at)];
            let [_, x, z] = &patch.now;
            let [_, x_before, z_before] = &patch.before;
            let (omega2, omega2_before) = (x[at] * x[at] + z[at] * z[at], x_before[at] * x_before[at] + z_before[at] * z_before[at]);
            for channel in 0..CHANNELS {
                let (set, now, before) = (channel.min(1), &patch.now[channel], &mut patch.before[channel]);
                let r = k.r(set, omega2);
                // `min` drops what is no number: nothing over nothing is 1.
                let kept = (r / k.r(set, omega2_before)).min(1.0);
                before[at] = now[at] - (now[at] - before[at]) * (ratio * kept);
                let laplacian = (now[at - 1] + now[at + 1]) + (now[at - stride] + now[at + stride]) - 4.0 * now[at];
                let force = r * r * laplacian - k.restoring * now[at] - k.damping[set] * (now[at] - before[at]);
                forces[channel].push(force * k.inverse_mass[set]);
            }
        }
    }
    forces
}

fn take_on(patch: &mut Patch, changes: &Planes) {
    let side = patch.side();
    for j in 0..side {
        let row = patch.at(0, j as i64);
        for (channel, changes) in changes.iter().enumerate() {
            let now = &patch.now[channel][row..row + side];
            let before = &mut patch.before[channel][row..row + side];
            for ((now, before), change) in now.iter().zip(before).zip(&changes[j * side..]) {
                *before = 2.0 * now - *before + change;
            }
        }
    }
    std::mem::swap(&mut patch.now, &mut patch.before);
    patch.measure();
}

/// Awake patches side by side along an axis.
struct Lined<'a> {
    patches: Vec<(&'a Patch, &'a mut Planes)>,
    ends: [End; 2],
}

/// The awake patches in lines along an axis; a line ends where a patch sleeps.
fn lines<'a>(field: &'a Field, changes: &'a mut [Planes], axis: usize) -> Vec<Lined<'a>> {
    let mut rows: BTreeMap<u32, Vec<(u32, &Patch, &mut Planes)>> = BTreeMap::new();
    for (patch, changes) in field.patches.iter().zip(changes) {
        let place = field.layout.place(patch.index());
        rows.entry(place[1 - axis]).or_default().push((place[axis], patch, changes));
    }
    let count = field.layout.count[axis];
    let mut lines = vec![];
    for mut row in rows.into_values() {
        if field.edges == Edges::Wrapped && row.len() < count as usize {
            // Begins behind a patch that sleeps, so that no line goes on across the seam of the world.
            let first = row.iter().enumerate().position(|(slot, item)| item.0 != slot as u32).unwrap_or(0);
            row.rotate_left(first);
        }
        let is_ring = field.edges == Edges::Wrapped && row.len() == count as usize;
        let end = |place: u32, edge: u32| match (field.edges, is_ring) {
            (_, true) => End::Joined,
            (Edges::Free, _) if place == edge => End::Free,
            _ => End::Rest,
        };
        let mut last = None;
        for (place, patch, changes) in row {
            let goes_on = last.is_some_and(|last: u32| (last + 1) % count == place && (last + 1 < count || field.edges == Edges::Wrapped));
            if !goes_on {
                lines.push(Lined { patches: vec![], ends: [end(place, 0), End::Rest] });
            }
            if let Some(line) = lines.last_mut() {
                line.patches.push((patch, changes));
                line.ends[1] = end(place, count - 1);
            }
            last = Some(place);
        }
    }
    lines
}

impl Lined<'_> {
    fn solve(&mut self, kinds: &[Coefficients], axis: usize) {
        let side = self.patches[0].0.side();
        let mut line = Line::new(side * self.patches.len(), self.ends);
        for first in (0..side).step_by(LANES) {
            for set in 0..2 {
                let channels = if set == 0 { 0..1 } else { 1..CHANNELS };
                line.weights.clear();
                for (patch, _) in &self.patches {
                    line.weights.extend((0..side).map(|along| weights(patch, kinds, set, axis, along, first)));
                }
                line.factorise();
                for channel in channels {
                    line.values.clear();
                    for (_, changes) in &self.patches {
                        line.values.extend((0..side).map(|along| gather(&changes[channel], side, axis, along, first)));
                    }
                    line.solve();
                    for ((_, changes), solved) in self.patches.iter_mut().zip(line.values.chunks_exact(side)) {
                        for (along, lanes) in solved.iter().enumerate() {
                            scatter(&mut changes[channel], side, axis, along, first, lanes);
                        }
                    }
                }
            }
        }
    }
}

/// Places of eight cells abreast, `along` the line from the first.
fn abreast(side: usize, axis: usize, along: usize, first: usize) -> [usize; LANES] {
    std::array::from_fn(|lane| if axis == 0 { (first + lane) * side + along } else { along * side + first + lane })
}

fn gather(plane: &[f32], side: usize, axis: usize, along: usize, first: usize) -> Lanes {
    abreast(side, axis, along, first).map(|at| plane[at])
}

fn scatter(plane: &mut [f32], side: usize, axis: usize, along: usize, first: usize, lanes: &Lanes) {
    abreast(side, axis, along, first).into_iter().zip(lanes).for_each(|(at, value)| plane[at] = *value);
}

/// `a = r²/(4A)` of eight cells abreast.
fn weights(patch: &Patch, kinds: &[Coefficients], set: usize, axis: usize, along: usize, first: usize) -> Lanes {
    std::array::from_fn(|lane| {
        let [i, j] = if axis == 0 { [along, first + lane] } else { [first + lane, along] };
        let at = patch.at(i as i64, j as i64);
        let k = &kinds[kind_at(patch, at)];
        let [_, x, z] = &patch.now;
        0.25 * k.r(set, x[at] * x[at] + z[at] * z[at]).powi(2) * k.inverse_mass[set]
    })
}
