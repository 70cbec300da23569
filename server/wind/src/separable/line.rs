//! Transform of eight lines along one axis into the modes of its discrete Laplacian, and back.
//!
//! Every basis, except nodes with a Neumann edge and centres next to walls, costs one complex Fourier transform of two real lines, which are permuted on input and separated by symmetry on output. Cosines:
//! Makhoul, "A fast cosine transform in one and two dimensions", IEEE Trans. ASSP 28 (1980); the quarter-wave ones follow in the same way from
//! frequencies shifted by one half; sines between nodes: Press et al. 2007, §12.4.

use std::f64::consts::PI;

use multiversion::multiversion;

use super::basis::{Basis, Edge};
use super::fft::{Fft, root};
use super::lanes::{LINES, Pair};
use super::walls;

#[derive(Clone, Copy, PartialEq)]
pub(super) enum Way {
    ToModes,
    Back,
}

/// The planned transform of lines along one axis.
pub(super) struct Line {
    pub(super) len: usize,
    fft: Fft,
    kind: Kind,
    /// Eigenvalue (1/m²) of −∂² for each mode, in the order of the transform.
    pub(super) eigenvalues: Vec<f64>,
    /// Factor by which a transform to modes and back scales the values.
    pub(super) gain: f64,
}

enum Kind {
    /// One unknown: already its own mode.
    Single,
    /// Mode k is the cosine of k waves, mode len − k the corresponding sine.
    Fourier,
    /// DCT-II, or DST-II by changing the sign of odd entries.
    Half { turns: Vec<[f64; 2]>, odd_sign: f64 },
    /// DCT-IV, or DST-IV if `flipped`, with the twiddle factors that shift frequencies by one half.
    Quarter { shifts: Vec<[f64; 2]>, turns: Vec<[f64; 2]>, flipped: bool },
    /// DST-I, with sin(πj/(len + 1)).
    Nodes { sines: Vec<f64> },
    /// Cosines about the node on a Neumann edge, or the modes between walls, as matrices in row order.
    Matrix { to_modes: Vec<f64>, back: Vec<f64> },
}

impl Line {
    pub(super) fn new(basis: Basis, len: usize, spacing_m: f64) -> Self {
        // Halved, because [`Pair::apart`] gives twice the amplitudes.
        let half_root = |k: usize, n: usize| root(k, n).map(|part| 0.5 * part);
        let n = len as f64;
        let (kind, gain, fft_len) = match basis {
            _ if len == 1 => (Kind::Single, 1.0, 1),
            Basis::Wrap => (Kind::Fourier, 2.0 * n, len),
            Basis::Nodes([Edge::Dirichlet, Edge::Dirichlet]) => {
                let sines = (0..=len).map(|j| (PI * j as f64 / (n + 1.0)).sin()).collect();
                (Kind::Nodes { sines }, 2.0 * (n + 1.0), len + 1)
            }
            Basis::Nodes(edges) => {
                let [to_modes, back] = matrices(edges, len);
                (Kind::Matrix { to_modes, back }, 1.0, 1)
            }
            Basis::Walls(walls) => {
                let [to_modes, back] = walls::matrices(walls, len);
                (Kind::Matrix { to_modes, back }, 1.0, 1)
            }
            Basis::Centres([first, last]) if first == last => {
                let odd_sign = if first == Edge::Neumann { 1.0 } else { -1.0 };
                (Kind::Half { turns: (0..=len / 2).map(|k| half_root(k, 4 * len)).collect(), odd_sign }, n, len)
            }
            Basis::Centres([first, _]) => {
                let flipped = first == Edge::Dirichlet;
                let sign = if flipped { 1.0 } else { -1.0 };
                let shift = |j: usize| root(j, 2 * len).map(|part| if j < len.div_ceil(2) { part } else { sign * part });
                let turns = (0..len.div_ceil(2)).map(|k| half_root(2 * k + 1, 8 * len)).collect();
                (Kind::Quarter { shifts: (0..len).map(shift).collect(), turns, flipped }, 0.5 * n, len)
            }
        };
        Self { len, fft: Fft::new(fft_len), kind, eigenvalues: eigenvalues(basis, len, spacing_m), gain }
    }

    /// Number of complex scratch values for [`transform`].
    pub(super) fn scratch_len(&self) -> usize {
        2 * (self.len + 1)
    }
}

/// Eigenvalues of the three-point −∂²: `(2/h)²·sin²(θ/2)` for waves that advance by θ per unknown.
fn eigenvalues(basis: Basis, len: usize, spacing_m: f64) -> Vec<f64> {
    let n = len as f64;
    let of_waves = |half_angle: &dyn Fn(f64) -> f64| (0..len).map(|k| (2.0 / spacing_m * half_angle(k as f64).sin()).powi(2)).collect();
    match basis {
        Basis::Wrap => of_waves(&|k| PI * k / n),
        Basis::Nodes(edges) => of_waves(&|k| 0.5 * node_angle(edges, k, n)),
        Basis::Centres([Edge::Neumann, Edge::Neumann]) => of_waves(&|k| 0.5 * PI * k / n),
        Basis::Centres([Edge::Dirichlet, Edge::Dirichlet]) => of_waves(&|k| 0.5 * PI * (n - k) / n),
        Basis::Centres(_) => of_waves(&|k| 0.5 * PI * (k + 0.5) / n),
        Basis::Walls(walls) => walls::eigenvalues(walls, len).into_iter().map(|eigenvalue| eigenvalue / (spacing_m * spacing_m)).collect(),
    }
}

/// Angle θ by which mode `k` of `n` nodes advances per node.
fn node_angle(edges: [Edge; 2], k: f64, n: f64) -> f64 {
    match edges {
        [Edge::Dirichlet, Edge::Dirichlet] => PI * (k + 1.0) / (n + 1.0),
        [Edge::Neumann, Edge::Neumann] => PI * k / (n - 1.0),
        _ => PI * (k + 0.5) / n,
    }
}

/// Transforms of nodes with a Neumann edge, to modes and back. The modes are cosines about that edge; they are orthogonal if the node on a Neumann edge, to
/// which half a cell belongs, counts half.
fn matrices(edges: [Edge; 2], len: usize) -> [Vec<f64>; 2] {
    let n = len as f64;
    let is_neumann = edges.map(|edge| edge == Edge::Neumann);
    let from_edge = |j: usize| if is_neumann[0] { j as f64 } else { n - 1.0 - j as f64 };
    let mode = |j: usize, k: usize| (node_angle(edges, k as f64, n) * from_edge(j)).cos();
    let weight = |j: usize| if (is_neumann[0] && j == 0) || (is_neumann[1] && j + 1 == len) { 0.5 } else { 1.0 };
    let square = |k: usize| (0..len).map(|j| weight(j) * mode(j, k).powi(2)).sum::<f64>();
    let to_modes = (0..len).flat_map(|k| {
        let square = square(k);
        (0..len).map(move |j| weight(j) * mode(j, k) / square)
    });
    let back = (0..len).flat_map(|j| (0..len).map(move |k| mode(j, k)));
    [to_modes.collect(), back.collect()]
}

/// Transforms [`LINES`] lines in place: entry j of line l is `slab[j·stride + l]`.
#[multiversion(targets("x86_64+avx2"))]
pub(super) fn transform(line: &Line, way: Way, slab: &mut [f64], stride: usize, scratch: &mut [Pair]) {
    match &line.kind {
        Kind::Single => {}
        Kind::Fourier => fourier(line, way, slab, stride, scratch),
        Kind::Half { turns, odd_sign } => half(line, way, turns, *odd_sign, slab, stride, scratch),
        Kind::Quarter { shifts, turns, flipped } => quarter(line, shifts, turns, *flipped, slab, stride, scratch),
        Kind::Nodes { sines } => nodes(line, sines, slab, stride, scratch),
        Kind::Matrix { to_modes, back } => multiply(if way == Way::ToModes { to_modes } else { back }, line.len, slab, stride, scratch),
    }
}

#[inline(always)]
fn fourier(line: &Line, way: Way, slab: &mut [f64], stride: usize, scratch: &mut [Pair]) {
    let n = line.len;
    let (values, spare) = buffers(scratch, n);
    match way {
        Way::ToModes => {
            values.iter_mut().enumerate().for_each(|(j, value)| *value = load(slab, stride, j));
            let (values, _) = line.fft.transform(values, spare);
            store(slab, stride, 0, values[0] * 2.0);
            for k in 1..n.div_ceil(2) {
                let (even, odd) = values[k].apart(values[n - k]);
                store(slab, stride, k, even);
                store(slab, stride, n - k, odd);
            }
            if n.is_multiple_of(2) {
                store(slab, stride, n / 2, values[n / 2] * 2.0);
            }
        }
        Way::Back => {
            values[0] = load(slab, stride, 0).swapped();
            for k in 1..n.div_ceil(2) {
                let (even, odd) = (load(slab, stride, k), load(slab, stride, n - k));
                values[k] = even.plus_i(odd).swapped();
                values[n - k] = even.minus_i(odd).swapped();
            }
            if n.is_multiple_of(2) {
                values[n / 2] = load(slab, stride, n / 2).swapped();
            }
            let (values, _) = line.fft.transform(values, spare);
            values.iter().enumerate().for_each(|(j, value)| store(slab, stride, j, value.swapped()));
        }
    }
}

#[inline(always)]
fn half(line: &Line, way: Way, turns: &[[f64; 2]], odd_sign: f64, slab: &mut [f64], stride: usize, scratch: &mut [Pair]) {
    let n = line.len;
    let (values, spare) = buffers(scratch, n);
    match way {
        Way::ToModes => {
            for m in 0..n / 2 {
                values[m] = load(slab, stride, 2 * m);
                values[n - 1 - m] = load(slab, stride, 2 * m + 1) * odd_sign;
            }
            if n % 2 == 1 {
                values[n / 2] = load(slab, stride, n - 1);
            }
            let (values, _) = line.fft.transform(values, spare);
            store(slab, stride, 0, values[0]);
            for k in 1..=n / 2 {
                let [cos, minus_sin] = turns[k];
                let (even, odd) = values[k].apart(values[n - k]);
                store(slab, stride, n - k, even * -minus_sin - odd * cos);
                store(slab, stride, k, even * cos - odd * minus_sin);
            }
        }
        Way::Back => {
            values[0] = load(slab, stride, 0).swapped();
            for k in 1..=n / 2 {
                let [cos, minus_sin] = turns[k].map(|part| 2.0 * part);
                let (a, b) = (load(slab, stride, k), load(slab, stride, n - k));
                let (even, odd) = (a * cos - b * minus_sin, a * -minus_sin - b * cos);
                values[n - k] = even.minus_i(odd).swapped();
                values[k] = even.plus_i(odd).swapped();
            }
            let (values, _) = line.fft.transform(values, spare);
            for m in 0..n / 2 {
                store(slab, stride, 2 * m, values[m].swapped());
                store(slab, stride, 2 * m + 1, values[n - 1 - m].swapped() * odd_sign);
            }
            if n % 2 == 1 {
                store(slab, stride, n - 1, values[n / 2].swapped());
            }
        }
    }
}

/// Its own inverse.
#[inline(always)]
fn quarter(line: &Line, shifts: &[[f64; 2]], turns: &[[f64; 2]], flipped: bool, slab: &mut [f64], stride: usize, scratch: &mut [Pair]) {
    let n = line.len;
    let (values, spare) = buffers(scratch, n);
    for m in 0..n / 2 {
        values[m] = load(slab, stride, 2 * m).turned(shifts[m]);
        values[n - 1 - m] = load(slab, stride, 2 * m + 1).turned(shifts[n - 1 - m]);
    }
    if n % 2 == 1 {
        values[n / 2] = load(slab, stride, n - 1).turned(shifts[n / 2]);
    }
    let (values, _) = line.fft.transform(values, spare);
    for (k, &[cos, minus_sin]) in turns.iter().enumerate() {
        let (even, odd) = values[k].apart(values[n - 1 - k]);
        let (a, b) = (even * cos - odd * minus_sin, even * -minus_sin - odd * cos);
        let (a, b) = if flipped { (b, a) } else { (a, b) };
        store(slab, stride, k, a);
        store(slab, stride, n - 1 - k, b);
    }
}

/// Its own inverse. Even modes come from the sines of the transform, odd ones from sums of its cosines.
#[inline(always)]
fn nodes(line: &Line, sines: &[f64], slab: &mut [f64], stride: usize, scratch: &mut [Pair]) {
    let n = line.len;
    let (values, spare) = buffers(scratch, n + 1);
    values[0] = Pair::default();
    for j in 1..=n.div_ceil(2) {
        let (a, b) = (load(slab, stride, j - 1), load(slab, stride, n - j));
        let (even, odd) = ((a + b) * sines[j], (a - b) * 0.5);
        values[j] = even + odd;
        values[n + 1 - j] = even - odd;
    }
    let (values, _) = line.fft.transform(values, spare);
    let mut sum = values[0];
    store(slab, stride, 0, sum);
    for k in 1..=n / 2 {
        let (even, odd) = values[k].apart(values[n + 1 - k]);
        store(slab, stride, 2 * k - 1, odd * -1.0);
        if 2 * k < n {
            sum = sum + even;
            store(slab, stride, 2 * k, sum);
        }
    }
}

#[inline(always)]
fn multiply(matrix: &[f64], n: usize, slab: &mut [f64], stride: usize, scratch: &mut [Pair]) {
    let values = &mut scratch[..n];
    values.iter_mut().enumerate().for_each(|(j, value)| *value = load(slab, stride, j));
    for (k, row) in matrix.chunks_exact(n).enumerate() {
        let sum = values.iter().zip(row).fold(Pair::default(), |sum, (&value, &factor)| sum + value * factor);
        store(slab, stride, k, sum);
    }
}

#[inline(always)]
fn buffers(scratch: &mut [Pair], len: usize) -> (&mut [Pair], &mut [Pair]) {
    scratch[..2 * len].split_at_mut(len)
}

#[inline(always)]
fn load(slab: &[f64], stride: usize, j: usize) -> Pair {
    Pair::load(&slab[j * stride..][..LINES])
}

#[inline(always)]
fn store(slab: &mut [f64], stride: usize, j: usize, value: Pair) {
    value.store(&mut slab[j * stride..][..LINES]);
}
