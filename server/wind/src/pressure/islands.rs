//! Islands: air that solids cut off from the rest of its line or plane of strongly coupled cells.
//!
//! Coupling across stretched cells is weak. An island in a plane of strong coupling is then connected to the rest of the air by weak links alone:
//! relaxation smooths the pressure in it but hardly changes its mean, and neither can the coarse grid, whose cells merge the island with its
//! surroundings.

use super::super::Real;
use super::coloured::{Coloured, at, set};
use super::operator::Operator;

/// Couplings this many times weaker than the strongest don't connect cells to a line or plane.
const WEAK: f64 = 4.0;
/// Fraction of the strongest coupling along an axis below which a face counts as closed.
const SHUT: f64 = 0.1;

/// Groups of cells that receive a common pressure offset, so that the residuals of each group sum to zero.
#[derive(Clone, Debug, Default)]
pub(super) struct Islands {
    /// Linear indices of the cells of all islands, one island after the other.
    cells: Vec<u32>,
    /// A cell, its neighbour outside the island and their coupling; a neighbour equal to the cell itself means pressure 0 (an open edge).
    links: Vec<(u32, u32, f32)>,
    islands: Vec<Island>,
}

#[derive(Clone, Copy, Debug)]
struct Island {
    /// End indices of its cells and links.
    cells: usize,
    links: usize,
    /// 1 / sum of the couplings of its links.
    inverse: f32,
}

impl Islands {
    /// Finds the islands of every line and plane whose coupling is stronger than the coupling across it.
    pub(super) fn new(operator: &Operator<f64>, outlets: &[Coloured<f64>; 3]) -> Self {
        let strongest = operator.lower.each_ref().map(|lower| lower.iter().flatten().copied().fold(0.0, f64::max));
        let mut axes: Vec<usize> = (0..3).filter(|&axis| strongest[axis] > 0.0).collect();
        axes.sort_by(|&a, &b| strongest[b].total_cmp(&strongest[a]));
        let mut islands = Self::default();
        for strong in 1..axes.len() {
            if strongest[axes[strong - 1]] >= WEAK * strongest[axes[strong]] {
                islands.add(operator, outlets, &axes[..strong], strongest);
            }
        }
        islands
    }

    /// Whether there is no island.
    pub(super) fn is_empty(&self) -> bool {
        self.islands.is_empty()
    }

    /// Adds the islands of the lines or planes along the axes `strong`: all connected groups but the largest in each.
    fn add(&mut self, operator: &Operator<f64>, outlets: &[Coloured<f64>; 3], strong: &[usize], strongest: [f64; 3]) {
        let (labels, groups) = groups(operator, strong, strongest);
        for group in &groups {
            let first = self.links.len();
            for &l in group {
                for (axis, outlets) in outlets.iter().enumerate() {
                    let outside = neighbours(operator, l as usize, axis)
                        .into_iter()
                        .filter(|&(neighbour, c)| c > 0.0 && labels[neighbour] != labels[l as usize]);
                    self.links.extend(outside.map(|(neighbour, c)| (l, neighbour as u32, c as f32)));
                    let outlet = at(outlets, l as usize) as f32;
                    self.links.extend((outlet > 0.0).then_some((l, l, outlet)));
                }
            }
            let sum: f32 = self.links[first..].iter().map(|link| link.2).sum();
            if sum > 0.0 {
                self.cells.extend(group);
                self.islands.push(Island { cells: self.cells.len(), links: self.links.len(), inverse: 1.0 / sum });
            }
        }
    }

    /// Shifts island after island, in order if `forth`, otherwise in reverse.
    pub(super) fn shift<R: Real>(&self, p: &mut Coloured<R>, b: &Coloured<R>, forth: bool) {
        for step in 0..self.islands.len() {
            let number = if forth { step } else { self.islands.len() - 1 - step };
            let island = self.islands[number];
            let (first_cell, first_link) =
                number.checked_sub(1).map_or((0, 0), |before| (self.islands[before].cells, self.islands[before].links));
            let cells = &self.cells[first_cell..island.cells];
            let mut sum: R = cells.iter().fold(R::zero(), |sum, &l| sum + at(b, l as usize));
            for &(cell, neighbour, coupling) in &self.links[first_link..island.links] {
                let outside = if neighbour == cell { R::zero() } else { at(p, neighbour as usize) };
                sum = sum + R::of(coupling.into()) * (outside - at(p, cell as usize));
            }
            let shift = sum * R::of(island.inverse.into());
            for &l in cells {
                let value = at(p, l as usize) + shift;
                set(p, l as usize, value);
            }
        }
    }
}

/// Number of the group of each cell, and the connected groups along the axes `strong` except the largest of each line or plane. Cells of the largest
/// groups have a number, too.
fn groups(operator: &Operator<f64>, strong: &[usize], strongest: [f64; 3]) -> (Vec<u32>, Vec<Vec<u32>>) {
    let layout = operator.layout;
    let mut labels = vec![0u32; layout.padded_len()];
    let mut groups: Vec<Vec<u32>> = vec![];
    let mut largest = vec![0usize; layout.padded_len()];
    // The line or plane of a cell, identified by its first cell.
    let slice = |mut cell: [usize; 3]| {
        strong.iter().for_each(|&axis| cell[axis] = 1);
        layout.linear(cell)
    };
    for cell in layout.coordinates() {
        let seed = layout.linear(cell);
        if labels[seed] > 0 || at(&operator.diagonal, seed) == 0.0 {
            continue;
        }
        let label = groups.len() as u32 + 1;
        let mut group = vec![seed as u32];
        labels[seed] = label;
        let mut next = 0;
        while let Some(&l) = group.get(next) {
            next += 1;
            for (axis, (neighbour, coupling)) in
                strong.iter().flat_map(|&axis| neighbours(operator, l as usize, axis).map(|link| (axis, link)))
            {
                if coupling > SHUT * strongest[axis] && labels[neighbour] == 0 {
                    labels[neighbour] = label;
                    group.push(neighbour as u32);
                }
            }
        }
        let slice = slice(cell);
        if largest[slice] == 0 || groups[largest[slice] - 1].len() < group.len() {
            largest[slice] = label as usize;
        }
        groups.push(group);
    }
    largest.iter().filter(|&&label| label > 0).for_each(|&label| groups[label - 1].clear());
    groups.retain(|group| !group.is_empty());
    (labels, groups)
}

/// The neighbours of a cell along an axis, across the edges of a periodic box, with their couplings.
fn neighbours(operator: &Operator<f64>, l: usize, axis: usize) -> [(usize, f64); 2] {
    let layout = operator.layout;
    let (n, i) = (layout.cells[axis], coordinate(&layout.stride, l, axis));
    let (stride, across) = (layout.stride[axis], layout.stride[axis] * (n - 1));
    let below = if i > 1 { l - stride } else { l + across };
    let above = if i < n { l + stride } else { l - across };
    [(below, at(&operator.lower[axis], l)), (above, at(&operator.lower[axis], l + stride))]
}

/// Padded coordinate of a linear index along an axis.
fn coordinate(stride: &[usize; 3], l: usize, axis: usize) -> usize {
    match axis {
        0 => l % stride[1],
        1 => l % stride[2] / stride[1],
        _ => l / stride[2],
    }
}
