//! Explicit Verlet propagation (001 Eqs 2–6).
//!
//! With λ = 1 − exp(−k·dt) and r = c·dt/h a cell becomes
//! `θ⁺ = θ + (1 − λ)·(θ − θ⁻) + r²·(Σ neighbours − 4θ) − κ·dt²·θ`, likewise for both components of ω. When dt changes,
//! θ⁻ is moved first, to keep (θ − θ⁻)/dt.
//!
//! Where the bend slows down, so does the wave (Eq. 4), from c⁻ to c: its motion θ − θ⁻ then is kept by c/c⁻ only. A wave's energy is
//! `(θ'/c)² + |∇θ|²`: were the motion kept whole, each fall of c would add to it, and |ω|, which swings, would drive θ up without end, however short
//! the steps (Hill's equation; 250 000 rad in one of 5000 random draws). [`Damping::Plain`](super::Damping) keeps it whole, as 001 does.
//!
//! A patch does up to [`HALO`] sub-steps while it lies in the cache: its halo then holds as many rings of its neighbours' cells, of which each
//! sub-step uses up one. Its neighbours compute these cells, too, with the same bits.

use super::Coefficients;
use super::patch::{CHANNELS, Ground, HALO, Patch, Planes};
use super::tiles::{TILE, size_bits, square_bits};
use multiversion::multiversion;

/// What a patch does between two exchanges.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pass<'a> {
    /// Coefficients of each kind of grass.
    pub(super) kinds: &'a [Coefficients],
    /// Sub-steps, at most [`HALO`].
    pub(super) substeps: usize,
    /// Length of a sub-step over that of the last one.
    pub(super) ratio: f32,
    /// Rings of the halo that each sub-step advances; none for as many as the later ones need.
    pub(super) rings: Option<usize>,
}

/// A run of cells in a row.
#[derive(Clone, Copy)]
struct Run {
    row: i64,
    from: i64,
    to: i64,
}

/// Advances the tiles of a patch that step. Returns the number of cells stepped.
pub(super) fn advance(patch: &mut Patch, pass: &Pass<'_>) -> u64 {
    let bands = -1..=patch.tiles.count() as i64;
    let (mut cells, mut spans) = (0, vec![]);
    if pass.ratio != 1.0 {
        for band in bands.clone() {
            find_spans(patch, band, HALO as i64, Join::Ghosts, &mut spans);
            for_each_run(patch, band, HALO as i64, &spans, |patch, run| retime(patch, run, pass.ratio));
        }
    }
    for substep in 1..=pass.substeps {
        let rings = pass.rings.unwrap_or(pass.substeps - substep) as i64;
        let is_last = substep == pass.substeps;
        for band in bands.clone() {
            find_spans(patch, band, rings, if is_last { Join::Own } else { Join::Ghosts }, &mut spans);
            if spans.is_empty() {
                continue;
            }
            let mut peaks = is_last.then(Peaks::default);
            for_each_run(patch, band, rings, &spans, |patch, run| {
                cells += (run.to - run.from) as u64;
                advance_run(patch, pass.kinds, run, peaks.as_mut());
            });
            if let Some(peaks) = peaks {
                peaks.tell(patch, band);
            }
        }
        std::mem::swap(&mut patch.now, &mut patch.before);
    }
    cells
}

/// Whether cells of the patch and ghosts go into one span.
#[derive(Clone, Copy, PartialEq)]
enum Join {
    /// Yes.
    Ghosts,
    /// No: only the patch's own are measured.
    Own,
}

/// Cells of a tile along one axis, with so many `rings` of the halo.
fn extent(patch: &Patch, tile: i64, rings: i64) -> [i64; 2] {
    match tile {
        -1 => [-rings, 0],
        tile if tile == patch.tiles.count() as i64 => [patch.side() as i64, patch.side() as i64 + rings],
        tile => [tile * TILE as i64, (tile + 1) * TILE as i64],
    }
}

/// Spans of columns of the tiles that step in a band of tiles; bands −1 and `count` lie in the halo.
fn find_spans(patch: &Patch, band: i64, rings: i64, join: Join, spans: &mut Vec<[i64; 2]>) {
    let count = patch.tiles.count() as i64;
    spans.clear();
    if rings == 0 && !(0..count).contains(&band) {
        return;
    }
    for tile in (-1..=count).filter(|&tile| patch.tiles.steps(tile, band)) {
        let [from, to] = extent(patch, tile, rings);
        let joins = join == Join::Ghosts || (1..count).contains(&tile);
        match spans.last_mut() {
            Some(last) if last[1] == from && joins => last[1] = to,
            _ if from < to => spans.push([from, to]),
            _ => {}
        }
    }
}

fn for_each_run(patch: &mut Patch, band: i64, rings: i64, spans: &[[i64; 2]], mut act: impl FnMut(&mut Patch, Run)) {
    let [first, last] = extent(patch, band, rings);
    for row in first..last {
        for &[from, to] in spans {
            act(patch, Run { row, from, to });
        }
    }
}

/// Moves the earlier state along the line through both, so that every rate of change stays.
fn retime(patch: &mut Patch, run: Run, ratio: f32) {
    let (from, to) = (patch.at(run.from, run.row), patch.at(run.to - 1, run.row) + 1);
    for (now, before) in patch.now.iter().zip(&mut patch.before) {
        let pairs = now[from..to].iter().zip(&mut before[from..to]);
        pairs.for_each(|(now, before)| *before = now - (now - *before) * ratio);
    }
}

/// Largest |θ| and |ω|² in each column of a band, as bits.
struct Peaks {
    theta: [u32; SIDE_LIMIT],
    omega2: [u32; SIDE_LIMIT],
}

/// Most cells along a side.
pub(super) const SIDE_LIMIT: usize = 256;

impl Default for Peaks {
    fn default() -> Self {
        Self { theta: [0; SIDE_LIMIT], omega2: [0; SIDE_LIMIT] }
    }
}

impl Peaks {
    fn tell(&self, patch: &mut Patch, band: i64) {
        let count = patch.tiles.count();
        if !(0..count as i64).contains(&band) {
            return;
        }
        for tile in (0..count).filter(|&tile| patch.tiles.steps(tile as i64, band)).collect::<Vec<_>>() {
            let largest = |columns: &[u32]| columns[tile * TILE..][..TILE].iter().copied().max().unwrap_or_default();
            patch.tiles.set_peaks(tile, band as usize, [largest(&self.theta), largest(&self.omega2)]);
        }
    }
}

fn advance_run(patch: &mut Patch, kinds: &[Coefficients], run: Run, mut peaks: Option<&mut Peaks>) {
    let (side, stride) = (patch.side(), patch.stride());
    let (first, last) = (patch.at(run.from, run.row), patch.at(run.to - 1, run.row) + 1);
    let start = first as i64 - run.from;
    let (now, before, ground) = (&patch.now, &mut patch.before, &patch.ground);
    for_each_kind(ground, first, last, |kind, from, to| {
        let k = &kinds[usize::from(kind)];
        let row = stencils(now, from, to, stride);
        let [theta, x, z] = before.each_mut().map(|plane| &mut plane[from..to]);
        let own = [from, to].map(|at| (at as i64 - start).clamp(0, side as i64) as usize);
        match peaks.as_deref_mut() {
            // Ghosts have no peaks: their own patch tells them.
            Some(peaks) if own[1] - own[0] == to - from => {
                let (theta_peaks, omega_peaks) = (&mut peaks.theta[own[0]..own[1]], &mut peaks.omega2[own[0]..own[1]]);
                let advance = if k.r_mu == 0.0 { advance_and_measure::<false> } else { advance_and_measure::<true> };
                advance(&row, theta, x, z, k, theta_peaks, omega_peaks);
            }
            _ if k.r_mu == 0.0 => advance_row::<false>(&row, theta, x, z, k),
            _ => advance_row::<true>(&row, theta, x, z, k),
        }
    });
}

/// Splits cells `first..last` of the planes into runs of one kind.
pub(super) fn for_each_kind(ground: &Ground, first: usize, last: usize, mut act: impl FnMut(u8, usize, usize)) {
    match ground {
        Ground::One(kind) => act(*kind, first, last),
        Ground::Map(kinds) => {
            let mut from = first;
            for run in kinds[first..last].chunk_by(|a, b| a == b) {
                act(run[0], from, from + run.len());
                from += run.len();
            }
        }
    }
}

/// Cells of a channel with those around them.
#[derive(Clone, Copy)]
struct Stencil<'a> {
    /// From the western neighbour of the first to the eastern one of the last.
    middle: &'a [f32],
    north: &'a [f32],
    south: &'a [f32],
}

type Row<'a> = [Stencil<'a>; CHANNELS];

#[inline(always)]
fn stencils(now: &Planes, from: usize, to: usize, stride: usize) -> Row<'_> {
    now.each_ref().map(|plane| Stencil {
        middle: &plane[from - 1..to + 1],
        north: &plane[from - stride..to - stride],
        south: &plane[from + stride..to + stride],
    })
}

impl<'a> Stencil<'a> {
    #[inline(always)]
    fn cut(&self, count: usize) -> Self {
        Self { middle: &self.middle[..count + 2], north: &self.north[..count], south: &self.south[..count] }
    }

    #[inline(always)]
    fn center(&self, i: usize) -> f32 {
        self.middle[i + 1]
    }

    #[inline(always)]
    fn laplacian(&self, i: usize) -> f32 {
        (self.middle[i] + self.middle[i + 2]) + (self.north[i] + self.south[i]) - 4.0 * self.middle[i + 1]
    }
}

/// What a cell of θ, ωx, ωz becomes, where the speed of θ `VARIES` with the bend or not.
#[inline(always)]
fn next_cell<const VARIES: bool>(row: &[Stencil; CHANNELS], i: usize, before: [f32; CHANNELS], k: &Coefficients) -> [f32; CHANNELS] {
    let [theta, x, z] = row;
    let (mut r, mut theta_memory) = (k.r0, 1.0 - k.lambda_theta);
    if VARIES {
        let courant = |x: f32, z: f32| k.r0 + k.r_mu * (x * x + z * z).sqrt();
        r = courant(x.center(i), z.center(i));
        // `min` drops what is no number: nothing over nothing is 1.
        theta_memory *= (r / courant(before[1], before[2])).min(1.0).max(k.kept_at_least);
    }
    let theta_keep = 1.0 + theta_memory - k.restoring[0];
    let (keep, memory) = (2.0 - k.lambda_omega - k.restoring[1], 1.0 - k.lambda_omega);
    [
        theta_keep * theta.center(i) - theta_memory * before[0] + r * r * theta.laplacian(i),
        keep * x.center(i) - memory * before[1] + k.r2_omega * x.laplacian(i),
        keep * z.center(i) - memory * before[2] + k.r2_omega * z.laplacian(i),
    ]
}

// Kept apart from the loops over rows: inlined into them, the compiler loses sight of which slices cannot overlap.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
fn advance_row<const VARIES: bool>(row: &[Stencil; CHANNELS], theta: &mut [f32], x: &mut [f32], z: &mut [f32], k: &Coefficients) {
    let count = theta.len();
    let row = row.map(|stencil| stencil.cut(count));
    let (x, z, k) = (&mut x[..count], &mut z[..count], *k);
    for i in 0..count {
        [theta[i], x[i], z[i]] = next_cell::<VARIES>(&row, i, [theta[i], x[i], z[i]], &k);
    }
}

#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
fn advance_and_measure<const VARIES: bool>(
    row: &[Stencil; CHANNELS],
    theta: &mut [f32],
    x: &mut [f32],
    z: &mut [f32],
    k: &Coefficients,
    theta_peaks: &mut [u32],
    omega2_peaks: &mut [u32],
) {
    let count = theta.len();
    let row = row.map(|stencil| stencil.cut(count));
    let (x, z, k) = (&mut x[..count], &mut z[..count], *k);
    let (theta_peaks, omega2_peaks) = (&mut theta_peaks[..count], &mut omega2_peaks[..count]);
    for i in 0..count {
        let next = next_cell::<VARIES>(&row, i, [theta[i], x[i], z[i]], &k);
        [theta[i], x[i], z[i]] = next;
        theta_peaks[i] = theta_peaks[i].max(size_bits(next[0])).max(size_bits(row[0].center(i)));
        let omega2 = square_bits(row[1].center(i), row[2].center(i));
        omega2_peaks[i] = omega2_peaks[i].max(omega2).max(square_bits(next[1], next[2]));
    }
}
