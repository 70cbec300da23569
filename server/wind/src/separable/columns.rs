//! Tridiagonal systems along an axis, [`WIDTH`] columns at a time.
//!
//! Elimination without pivoting (Thomas) for `A = λ + D`, D the second difference: each diagonal entry is λ plus 1 for each neighbour. The recurrence
//! carries the excess of a pivot over 1, a sum of terms of one sign: no digits cancel, however close to singular the system is.

use multiversion::multiversion;

use super::basis::{Basis, Edge};
use super::walls;

/// Columns solved at once: two cache lines of each plane.
pub(super) const WIDTH: usize = 16;

/// One value of each column.
pub(super) type Row = [f64; WIDTH];

/// Copies the values at `offset` in each plane, and those next to it, into the rows of a block, times `scale`.
pub(super) fn gather(planes: &[f64], plane_len: usize, offset: usize, scale: f64, rows: &mut [Row]) {
    for (row, plane) in rows.iter_mut().zip(planes.chunks_exact(plane_len)) {
        let values = &plane[offset..];
        match values.first_chunk::<WIDTH>() {
            Some(values) => row.iter_mut().zip(values).for_each(|(slot, value)| *slot = value * scale),
            None => row.iter_mut().zip(values).for_each(|(slot, value)| *slot = value * scale),
        }
    }
}

/// Copies the rows of a block back to `offset` in each plane.
pub(super) fn scatter(rows: &[Row], planes: &mut [f64], plane_len: usize, offset: usize) {
    for (row, plane) in rows.iter().zip(planes.chunks_exact_mut(plane_len)) {
        let target = &mut plane[offset..];
        match target.first_chunk_mut::<WIDTH>() {
            Some(values) => *values = *row,
            None => target.iter_mut().zip(row).for_each(|(value, slot)| *value = *slot),
        }
    }
}

/// Solves `(λ + D)·φ = f` in place for each column of `rows`, with the column's `lambda` and the ends of `basis`; `scratch` is twice as long as
/// `rows`. If λ = 0 makes the system singular, `f` must have mean 0, and the last value of φ is 0.
#[multiversion(targets("x86_64+avx2"))]
pub(super) fn solve(basis: Basis, lambda: &Row, rows: &mut [Row], scratch: &mut [Row]) {
    let (inverse_pivots, response) = scratch.split_at_mut(rows.len());
    match basis {
        Basis::Wrap => bordered(lambda, rows, inverse_pivots, response),
        Basis::Nodes(edges) => {
            // Half of the equation at a node on a Neumann edge, so that the matrix is symmetric.
            let ends = edges.map(|edge| if edge == Edge::Neumann { lambda.map(|lambda| -0.5 * lambda) } else { [1.0; WIDTH] });
            weigh(rows, edges.map(|edge| edge == Edge::Neumann), 0.5);
            factor(lambda, ends, inverse_pivots);
            substitute(inverse_pivots, rows);
        }
        Basis::Centres(edges) => {
            factor(lambda, edges.map(|edge| [if edge == Edge::Neumann { 0.0 } else { 2.0 }; WIDTH]), inverse_pivots);
            substitute(inverse_pivots, rows);
        }
        Basis::Walls(walls) => {
            // Three quarters of the equation next to a wall, for the same reason.
            let end = |is_wall: bool| if is_wall { lambda.map(|lambda| 2.0 - (1.0 - walls::WEIGHT) * lambda) } else { [0.0; WIDTH] };
            weigh(rows, walls, walls::WEIGHT);
            factor(lambda, walls.map(end), inverse_pivots);
            substitute(inverse_pivots, rows);
        }
    }
}

/// Multiplies the right-hand sides of the first and the last equation, where `weighed`, by a weight.
#[inline(always)]
fn weigh(rows: &mut [Row], weighed: [bool; 2], weight: f64) {
    let last = rows.len() - 1;
    for (at, _) in [0, last].into_iter().zip(weighed).filter(|(_, weighed)| *weighed) {
        rows[at].iter_mut().for_each(|value| *value *= weight);
    }
}

/// Solves a periodic system, bordered by its last unknown; the others lie between two nodes. Their response to the value 1 at both nodes is `1 − w`,
/// where `(λ + D)·w = λ`; so the pivot of the last unknown is again a sum of terms of one sign.
#[inline(always)]
fn bordered(lambda: &Row, rows: &mut [Row], inverse_pivots: &mut [Row], response: &mut [Row]) {
    let Some((last, rest)) = rows.split_last_mut() else { return };
    let (inverse_pivots, response) = (&mut inverse_pivots[..rest.len()], &mut response[..rest.len()]);
    response.fill(*lambda);
    factor(lambda, [[1.0; WIDTH]; 2], inverse_pivots);
    substitute(inverse_pivots, rest);
    substitute(inverse_pivots, response);
    let mut pivot = *lambda;
    if let (Some(left), Some(right), Some(w)) = (rest.last(), rest.first(), response.first()) {
        for l in 0..WIDTH {
            last[l] += left[l] + right[l];
            pivot[l] += 2.0 * w[l];
        }
    }
    for l in 0..WIDTH {
        last[l] *= inverse_or_zero(pivot[l]);
    }
    for (row, w) in rest.iter_mut().zip(response) {
        for l in 0..WIDTH {
            row[l] += last[l] * (1.0 - w[l]);
        }
    }
}

/// Forward elimination of the matrix; `ends` is added to the diagonals of the first and the last unknown for their missing neighbours.
#[inline(always)]
fn factor(lambda: &Row, ends: [Row; 2], inverse_pivots: &mut [Row]) {
    let Some((last, rest)) = inverse_pivots.split_last_mut() else { return };
    let mut excess: Row = std::array::from_fn(|l| lambda[l] + ends[0][l]);
    for inverse_pivot in rest {
        for l in 0..WIDTH {
            inverse_pivot[l] = 1.0 / (1.0 + excess[l]);
            excess[l] = lambda[l] + excess[l] * inverse_pivot[l];
        }
    }
    *last = std::array::from_fn(|l| inverse_or_zero(excess[l] + ends[1][l]));
}

#[inline(always)]
fn substitute(inverse_pivots: &[Row], rows: &mut [Row]) {
    let mut carried = [0.0; WIDTH];
    for (row, inverse_pivot) in rows.iter_mut().zip(inverse_pivots) {
        for l in 0..WIDTH {
            carried[l] = (row[l] + carried[l]) * inverse_pivot[l];
        }
        *row = carried;
    }
    let mut below = [0.0; WIDTH];
    for (row, inverse_pivot) in rows.iter_mut().zip(inverse_pivots).rev() {
        for l in 0..WIDTH {
            below[l] = row[l] + inverse_pivot[l] * below[l];
        }
        *row = below;
    }
}

#[inline(always)]
fn inverse_or_zero(x: f64) -> f64 {
    if x == 0.0 { 0.0 } else { 1.0 / x }
}
