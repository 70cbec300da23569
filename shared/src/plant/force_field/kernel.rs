//! The innermost loops: how a step spreads what lingers, and sums up the forces.

use multiversion::multiversion;

/// Rows of the mesh in planes with a ring of one volume around it.
#[derive(Clone, Copy)]
pub(super) struct Rows {
    /// Place of the first volume, volumes in a row, and rows along z and y.
    pub(super) first: usize,
    pub(super) width: usize,
    pub(super) count: [usize; 2],
    /// Distance between rows along z and along y.
    pub(super) strides: [usize; 2],
}

impl Rows {
    fn starts(self) -> impl Iterator<Item = usize> {
        let Self { first, count: [rows, layers], strides: [row, layer], .. } = self;
        (0..layers).flat_map(move |y| (0..rows).map(move |z| first + y * layer + z * row))
    }
}

/// A row of a plane and the rows around it, all of one length.
#[derive(Clone, Copy)]
struct Stencil<'a> {
    center: &'a [f32],
    sides: [&'a [f32]; 6],
}

impl<'a> Stencil<'a> {
    #[inline(always)]
    fn new(plane: &'a [f32], at: usize, width: usize, [row, layer]: [usize; 2]) -> Self {
        let slice = |first: usize| &plane[first..][..width];
        let sides = [slice(at - 1), slice(at + 1), slice(at - layer), slice(at + layer), slice(at - row), slice(at + row)];
        Self { center: slice(at), sides }
    }
}

/// One sub-step: each volume exchanges the share `shares` (x, y, z) of the difference with its neighbours where both are `open`; `keep` of all is left.
// Slices that are arguments of their own are known not to overlap.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
pub(super) fn spread(now: &[f32], next: &mut [f32], open: &[f32], rows: Rows, shares: [f32; 3], keep: f32) {
    let [x, y, z] = shares;
    for at in rows.starts() {
        let (r, open) = (Stencil::new(now, at, rows.width, rows.strides), Stencil::new(open, at, rows.width, rows.strides));
        let next = &mut next[at..][..rows.width];
        for (i, next) in next.iter_mut().enumerate() {
            let flow = |side: usize| open.sides[side][i] * (r.sides[side][i] - r.center[i]);
            let gain = x * (flow(0) + flow(1)) + y * (flow(2) + flow(3)) + z * (flow(4) + flow(5));
            *next = keep * (r.center[i] + open.center[i] * gain);
        }
    }
}

/// Forces along one axis, with `stride` between neighbours: none in solids, and none that points into a solid beside.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
pub(super) fn sum(driven: &[f32], lingering: &[f32], open: &[f32], force: &mut [f32], rows: Rows, stride: usize) {
    for at in rows.starts() {
        let (driven, lingering, center) = (&driven[at..][..rows.width], &lingering[at..][..rows.width], &open[at..][..rows.width]);
        let (before, after) = (&open[at - stride..][..rows.width], &open[at + stride..][..rows.width]);
        let force = &mut force[at..][..rows.width];
        for i in 0..rows.width {
            let q = driven[i] + lingering[i];
            force[i] = center[i] * (q.max(0.0) * after[i] + q.min(0.0) * before[i]);
        }
    }
}
