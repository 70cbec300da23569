//! Transfer between a grid and the next coarser one: restriction of residuals, prolongation of corrections.

use super::super::Real;
use super::super::parallel::{for_each_chunk, for_each_chunk_pair};
use super::coloured::{Coloured, Layout};
use super::kernels;
use std::ops::Range;

/// Interpolation weights of children towards the neighbours of their parent, along a coarsened axis.
#[derive(Clone, Debug)]
pub(super) struct Lean<R> {
    pub(super) axis: usize,
    /// Weight of the lower and of the upper child of each coarse cell, by its linear index; 0 where no face is open.
    pub(super) fraction: [Vec<R>; 2],
}

/// Linear interpolation between the centres of coarse cells (prolongation), and its transpose (restriction).
///
/// A cell takes its parent's value e and adds, for each coarsened axis separately, `fraction (e_neighbour − e)` for the parent's neighbour on its side
/// (after Wesseling, SIAM J. Sci. Stat. Comput. 9, 1988). The fraction is the distance between the centres of cell and parent over that between the two
/// coarse centres, 1/4 on a regular grid, times the open fraction of the face between them; a neighbour beyond an open edge of the box has value 0.
#[derive(Clone, Debug)]
pub(super) struct Transfer<R> {
    fine: Layout,
    coarse: Layout,
    leans: Vec<Lean<R>>,
    /// Coarse values by linear index.
    natural: Vec<R>,
    /// For each coarse plane: the part that stays with the children's parent, then the parts for its lower and upper neighbours along each coarsened
    /// axis.
    parts: Vec<R>,
}

/// Cells of a row of a plane, by linear index within the plane.
fn row(layout: &Layout, y: usize) -> Range<usize> {
    layout.linear([1, y, 0])..layout.linear([1 + layout.cells[0], y, 0])
}

impl<R: Real> Transfer<R> {
    /// Creates the transfer between two layouts; cells are halved along the axes of `leans`.
    pub(super) fn new(fine: Layout, coarse: Layout, leans: Vec<Lean<R>>) -> Self {
        let len = coarse.padded_len();
        let parts = vec![R::zero(); (1 + 2 * leans.len()) * len];
        Self { fine, coarse, leans, natural: vec![R::zero(); len], parts }
    }

    /// Restricts a residual of the fine grid, 0 in ghosts, to a right-hand side on the coarse one.
    pub(super) fn restrict(&mut self, r: &Coloured<R>, b: &mut Coloured<R>) {
        self.part_residuals(r);
        self.sum_parts();
        let (natural, plane_len) = (&self.natural[..], self.coarse.stride[2]);
        let (red, black) = b.split_at_mut(1);
        for_each_chunk_pair(&mut red[0], plane_len, &mut black[0], plane_len, |chunk, red, black| {
            kernels::deal(&natural[2 * plane_len * chunk..][..2 * plane_len], red, black);
        });
    }

    /// Sums the residuals of each parent's children into the part that stays with the parent and those for its neighbours.
    fn part_residuals(&mut self, r: &Coloured<R>) {
        let Self { fine, coarse, leans, parts, .. } = self;
        let (fine, coarse, leans) = (*fine, *coarse, &leans[..]);
        let ([_, ny, nz], plane_len) = (coarse.cells, coarse.stride[2]);
        let row = |y: usize| row(&coarse, y);
        let halved = |axis: usize| leans.iter().any(|lean| lean.axis == axis);
        let children = |i: usize, axis: usize| if halved(axis) { 2 * i - 1..(2 * i).min(fine.cells[axis]) + 1 } else { i..i + 1 };

        for_each_chunk(parts, (1 + 2 * leans.len()) * plane_len, |z, parts| {
            if !(1..=nz).contains(&z) {
                return;
            }
            let (kept, leant) = parts.split_at_mut(plane_len);
            for y in 1..=ny {
                let kept = &mut kept[row(y)];
                kept.fill(R::zero());
                leant.chunks_mut(plane_len).for_each(|leant| leant[row(y)].fill(R::zero()));
                for (fine_z, fine_y) in children(z, 2).flat_map(|fine_z| children(y, 1).map(move |fine_y| (fine_z, fine_y))) {
                    let [odd, even] = alternate(&fine, r, fine_y, fine_z);
                    gather(kept, odd, even, halved(0));
                    for (lean, leant) in leans.iter().zip(leant.chunks_mut(2 * plane_len)) {
                        let (down, up) = leant.split_at_mut(plane_len);
                        match lean.axis {
                            0 => {
                                kernels::add(&mut down[row(y)], odd);
                                kernels::add(&mut up[row(y)], even);
                            }
                            axis => {
                                let lower = [fine_y, fine_z][axis - 1] % 2 == 1;
                                gather(&mut if lower { down } else { up }[row(y)], odd, even, halved(0));
                            }
                        }
                    }
                }
                let start = coarse.linear([1, y, z]);
                let fractions = leans.iter().flat_map(|lean| &lean.fraction);
                for (fraction, leant) in fractions.zip(leant.chunks_mut(plane_len)) {
                    kernels::take_fraction(kept, &mut leant[row(y)], &fraction[start..]);
                }
            }
        });
    }

    /// Sums the parts that reach each coarse cell.
    fn sum_parts(&mut self) {
        let Self { coarse, leans, natural, parts, .. } = self;
        let (coarse, leans, parts) = (*coarse, &leans[..], &parts[..]);
        let ([nx, ny, nz], plane_len) = (coarse.cells, coarse.stride[2]);
        let each_plane = (1 + 2 * leans.len()) * plane_len;
        let part = |part: usize, y: usize, z: usize| &parts[z * each_plane + part * plane_len..][row(&coarse, y)];
        for_each_chunk(natural, plane_len, |z, natural| {
            for y in (1..=ny).filter(|_| (1..=nz).contains(&z)) {
                let b = &mut natural[row(&coarse, y)];
                b.copy_from_slice(part(0, y, z));
                for (slot, lean) in leans.iter().enumerate() {
                    let (down, up) = (1 + 2 * slot, 2 + 2 * slot);
                    if lean.axis == 0 {
                        let (down, up) = (part(down, y, z), part(up, y, z));
                        kernels::add(&mut b[..nx - 1], &down[1..]);
                        kernels::add(&mut b[1..], up);
                        if coarse.wraps[0] {
                            b[0] = b[0] + up[nx - 1];
                            b[nx - 1] = b[nx - 1] + down[0];
                        }
                        continue;
                    }
                    let [above, below] = [true, false].map(|up| neighbour(&coarse, lean.axis, [y, z], up));
                    above.into_iter().for_each(|[y, z]| kernels::add(b, part(down, y, z)));
                    below.into_iter().for_each(|[y, z]| kernels::add(b, part(up, y, z)));
                }
            }
        });
    }

    /// Prolongs a correction of the coarse grid, with its ghosts refreshed, and adds it to the values of the fine one.
    pub(super) fn prolong(&mut self, e: &Coloured<R>, p: &mut Coloured<R>) {
        let Self { fine, coarse, leans, natural, .. } = self;
        let (fine, coarse, leans) = (*fine, *coarse, &leans[..]);
        let coarse_len = coarse.chunk_len();
        for_each_chunk(natural, 2 * coarse_len, |chunk, natural| {
            kernels::interleave(natural, &e[0][coarse_len * chunk..], &e[1][coarse_len * chunk..]);
        });

        let natural = &natural[..];
        let parent = |i: usize, axis: usize| if leans.iter().any(|lean| lean.axis == axis) { i.div_ceil(2) } else { i };
        let (fine_len, nx, halved) = (fine.chunk_len(), coarse.cells[0], leans.iter().any(|lean| lean.axis == 0));
        let [red, black] = p;
        for_each_chunk_pair(red, fine_len, black, fine_len, |chunk, red, black| {
            for (z, y) in fine.planes(chunk).flat_map(|z| (1..=fine.cells[1]).map(move |y| (z, y))) {
                let start = fine.linear([1, y, z]) - 2 * fine_len * chunk;
                let (first, second) = if start % 2 == 0 { (&mut *red, &mut *black) } else { (&mut *black, &mut *red) };
                let (odd, even) = (&mut first[start / 2..], &mut second[start.div_ceil(2)..]);
                let l = coarse.linear([1, parent(y, 1), parent(z, 2)]);
                let e = &natural[l..][..nx];
                scatter(odd, even, e, halved);
                for lean in leans {
                    let stride = coarse.stride[lean.axis];
                    let (below, above) = (&natural[l - stride..][..nx], &natural[l + stride..][..nx]);
                    let [down, up] = lean.fraction.each_ref().map(|fraction| &fraction[l..][..nx]);
                    match lean.axis {
                        0 => {
                            kernels::lean(&mut odd[..nx], down, below, e);
                            kernels::lean(&mut even[..nx], up, above, e);
                        }
                        axis => {
                            let lower = [y, z][axis - 1] % 2 == 1;
                            let (fraction, x) = if lower { (down, below) } else { (up, above) };
                            scatter_lean(odd, even, [fraction, x, e], halved);
                        }
                    }
                }
            }
        });
    }
}

/// Cells 1, 3, 5, … of a row and cells 2, 4, 6, …
fn alternate<'a, R>(layout: &Layout, field: &'a Coloured<R>, y: usize, z: usize) -> [&'a [R]; 2] {
    let start = layout.linear([1, y, z]);
    [start, start + 1].map(|l| &field[l % 2][l / 2..])
}

/// Adds a row of children to their parents, in pairs if `halved`.
fn gather<R: Real>(parents: &mut [R], odd: &[R], even: &[R], halved: bool) {
    if halved {
        kernels::add(parents, odd);
        kernels::add(parents, even);
    } else {
        kernels::add_alternate(parents, odd, even);
    }
}

/// Adds a row of parents to their children.
fn scatter<R: Real>(odd: &mut [R], even: &mut [R], parents: &[R], halved: bool) {
    if halved {
        kernels::add(&mut odd[..parents.len()], parents);
        kernels::add(&mut even[..parents.len()], parents);
    } else {
        kernels::add_to_alternate(odd, even, parents);
    }
}

/// Interpolates a row of children from their parents `e` towards `x`.
fn scatter_lean<R: Real>(odd: &mut [R], even: &mut [R], [fraction, x, e]: [&[R]; 3], halved: bool) {
    if halved {
        kernels::lean(&mut odd[..e.len()], fraction, x, e);
        kernels::lean(&mut even[..e.len()], fraction, x, e);
    } else {
        kernels::lean_alternate(odd, even, [fraction, x, e]);
    }
}

/// The row next to row `[y, z]` along axis 1 or 2, if there is one.
fn neighbour(layout: &Layout, axis: usize, mut row: [usize; 2], up: bool) -> Option<[usize; 2]> {
    let (n, at) = (layout.cells[axis], &mut row[axis - 1]);
    let end = if up { n } else { 1 };
    if *at == end && !layout.wraps[axis] {
        return None;
    }
    *at = if up { *at % n + 1 } else { (*at + n - 2) % n + 1 };
    Some(row)
}
