//! Newmark's average acceleration (β = ¼) by alternating directions.
//!
//! With δ = θ⁺ − 2θ + θ⁻, r = c·dt/h and A = 1 + k·dt/2 + κ·dt²/4 the step of `θ'' + kθ' + κθ = c²·Lθ` is `A·δ − ¼r²·(Lx + Lz)·δ = r²·Lθ − κ·dt²·θ −
//! k·dt·(θ − θ⁻)`. The left-hand side over A is factored into `(1 − a·Lx)(1 − a·Lz)·δ` with a = r²/(4A), with a splitting error of second order, and
//! solved as a tridiagonal system along each row, then along each column (Lees 1962). Stable for any step where c is constant.
//!
//! Where a wave slows down by Eq. (4), from c⁻ to c, its motion θ − θ⁻ is scaled by c/c⁻. A wave's energy is `(θ'/c)² + |∇θ|²`; without that limit each fall of c
//! would add to it. It loses energy, and as it compares two successive speeds, the order in time is 1. Momentum kept as in [`verlet`](super::verlet) would have
//! an energy without the splitting only: `(1 − a·Lx)(1 − a·Lz)` isn't symmetric where a varies.

use super::ground;
use super::halo::Edges;
use super::patch::{CHANNELS, Patch, Planes};
use super::tridiagonal::{End, LANES, Lanes, Line};
use super::verlet::for_each_kind;
use super::{Executor, Field, Report, WaveParams};
use std::collections::BTreeMap;

/// Coefficients of a step for one kind of grass; θ first, then ω.
struct Coefficients {
    /// Courant numbers at rest, and the increase of θ's per rad/s of bending velocity.
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
}

/// Unknowns of a step for a patch's own cells, row by row.
#[derive(Default)]
struct Work {
    /// `a = r²/(4A)`, of θ and of ω.
    weights: [Vec<f32>; 2],
    /// Right-hand sides over A; then δ.
    changes: Planes,
}

/// Advances all awake patches by one step of `dt_secs`.
pub(super) fn step(field: &mut Field, dt_secs: f32, executor: &impl Executor) -> Report {
    let ratio = field.dt_secs.replace(dt_secs).map_or(1.0, |last| dt_secs / last);
    let kinds: Vec<_> = field.kinds.waves().iter().map(|waves| Coefficients::new(waves, field.layout.cell_m, dt_secs)).collect();
    let refused = field.exchange(1, executor);
    let mut works: Vec<Work> = field.patches.iter().map(|_| Work::default()).collect();
    let mut tasks: Vec<_> = field.patches.iter_mut().zip(&mut works).collect();
    executor.for_each(&mut tasks, |(patch, work)| **work = begin(patch, &kinds, ratio));
    for axis in [0, 1] {
        let mut lines = lines(field, &mut works, axis);
        executor.for_each(&mut lines, |line| line.solve(axis));
    }
    let limit_rad = field.ground_contact.limit_rad();
    let mut tasks: Vec<_> = field.patches.iter_mut().zip(&works).collect();
    executor.for_each(&mut tasks, |(patch, work)| take_on(patch, &work.changes, limit_rad));
    let cells = u64::from(field.layout.cells).pow(2);
    Report { substeps: 1, cell_steps: cells * field.patches.len() as u64, refused, ..Report::default() }
}

/// Computes weights and right-hand sides. Adjusts the earlier state if dt has changed, and reduces the motion of waves that slow down.
fn begin(patch: &mut Patch, kinds: &[Coefficients], ratio: f32) -> Work {
    let (side, stride) = (patch.side(), patch.stride());
    let plane = || vec![0.0; side * side];
    let mut work = Work { weights: [plane(), plane()], changes: std::array::from_fn(|_| plane()) };
    for j in 0..side {
        let row = patch.at(0, j as i64);
        let own = |at: usize| j * side + at - row;
        for_each_kind(&patch.ground, row, row + side, |kind, from, to| {
            let (k, cells) = (&kinds[usize::from(kind)], own(from)..own(from) + to - from);
            let [theta_weights, omega_weights] = work.weights.each_mut().map(|plane| &mut plane[cells.clone()]);
            let [theta, x, z] = patch.now.each_ref().map(|plane| &plane[from..to]);
            let [theta_before, x_before, z_before] = patch.before.each_mut().map(|plane| &mut plane[from..to]);
            let courant = |x: f32, z: f32| k.r[0] + k.r_mu * (x * x + z * z).sqrt();
            for i in 0..theta.len() {
                let r = courant(x[i], z[i]);
                theta_weights[i] = 0.25 * r * r * k.inverse_mass[0];
                if k.r_mu != 0.0 {
                    // `min` drops NaN: 0/0 counts as 1.
                    let kept = (r / courant(x_before[i], z_before[i])).min(1.0);
                    theta_before[i] = theta[i] - (theta[i] - theta_before[i]) * kept;
                }
            }
            omega_weights.fill(0.25 * k.r[1] * k.r[1] * k.inverse_mass[1]);
            for channel in 0..CHANNELS {
                let set = channel.min(1);
                let plane = &patch.now[channel];
                let (now, before) = (&plane[from..to], &mut patch.before[channel][from..to]);
                let (west, east) = (&plane[from - 1..to - 1], &plane[from + 1..to + 1]);
                let (north, south) = (&plane[from - stride..to - stride], &plane[from + stride..to + stride]);
                let (weights, changes) = (&work.weights[set][cells.clone()], &mut work.changes[channel][cells.clone()]);
                let (restoring, damping) = (k.restoring * k.inverse_mass[set], k.damping[set] * k.inverse_mass[set]);
                for i in 0..now.len() {
                    before[i] = now[i] - (now[i] - before[i]) * ratio;
                    let laplacian = (west[i] + east[i]) + (north[i] + south[i]) - 4.0 * now[i];
                    changes[i] = 4.0 * weights[i] * laplacian - restoring * now[i] - damping * (now[i] - before[i]);
                }
            }
        });
    }
    work
}

fn take_on(patch: &mut Patch, changes: &Planes, limit_rad: f32) {
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
    ground::stop(patch, limit_rad);
    patch.measure();
}

/// Awake patches in a row along an axis.
struct Lined<'a> {
    side: usize,
    patches: Vec<&'a mut Work>,
    ends: [End; 2],
}

/// The awake patches grouped into lines along an axis; a line ends where a patch sleeps.
fn lines<'a>(field: &Field, works: &'a mut [Work], axis: usize) -> Vec<Lined<'a>> {
    let mut rows: BTreeMap<u32, Vec<(u32, &mut Work)>> = BTreeMap::new();
    for (patch, work) in field.patches.iter().zip(works) {
        let place = field.layout.place(patch.index());
        rows.entry(place[1 - axis]).or_default().push((place[axis], work));
    }
    let count = field.layout.count[axis];
    let mut lines = vec![];
    for mut row in rows.into_values() {
        if field.edges == Edges::Wrapped && row.len() < count as usize {
            // Starts after a sleeping patch, so that no line crosses the periodic edge of the world.
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
        for (place, work) in row {
            let goes_on = last.is_some_and(|last: u32| (last + 1) % count == place && (last + 1 < count || field.edges == Edges::Wrapped));
            if !goes_on {
                lines.push(Lined { side: field.layout.cells as usize, patches: vec![], ends: [end(place, 0), End::Rest] });
            }
            if let Some(line) = lines.last_mut() {
                line.patches.push(work);
                line.ends[1] = end(place, count - 1);
            }
            last = Some(place);
        }
    }
    lines
}

impl Lined<'_> {
    fn solve(&mut self, axis: usize) {
        let side = self.side;
        let mut line = Line::new(side * self.patches.len(), self.ends);
        for first in (0..side).step_by(LANES) {
            for (set, channels) in [0..1, 1..CHANNELS].into_iter().enumerate() {
                line.weights.clear();
                for work in &self.patches {
                    line.weights.extend((0..side).map(|along| gather(&work.weights[set], side, axis, along, first)));
                }
                line.factorise();
                for channel in channels {
                    line.values.clear();
                    for work in &self.patches {
                        line.values.extend((0..side).map(|along| gather(&work.changes[channel], side, axis, along, first)));
                    }
                    line.solve();
                    for (work, solved) in self.patches.iter_mut().zip(line.values.chunks_exact(side)) {
                        for (along, lanes) in solved.iter().enumerate() {
                            scatter(&mut work.changes[channel], side, axis, along, first, lanes);
                        }
                    }
                }
            }
        }
    }
}

/// Indices of eight neighbouring cells, `along` cells from the start of their lines.
fn abreast(side: usize, axis: usize, along: usize, first: usize) -> [usize; LANES] {
    std::array::from_fn(|lane| if axis == 0 { (first + lane) * side + along } else { along * side + first + lane })
}

fn gather(plane: &[f32], side: usize, axis: usize, along: usize, first: usize) -> Lanes {
    abreast(side, axis, along, first).map(|at| plane[at])
}

fn scatter(plane: &mut [f32], side: usize, axis: usize, along: usize, first: usize, lanes: &Lanes) {
    abreast(side, axis, along, first).into_iter().zip(lanes).for_each(|(at, value)| plane[at] = *value);
}
