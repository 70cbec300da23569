//! Transform of a plane along both axes, eight lines at a time.

use std::array::from_fn;

use super::lanes::{LINES, Pair};
use super::line::{Line, Way, transform};

/// Work arrays: [`LINES`] lines side by side, and scratch for transforming them.
#[derive(Clone)]
pub(super) struct Lines {
    slab: Vec<f64>,
    scratch: Vec<Pair>,
}

impl Lines {
    pub(super) fn new(x: &Line, y: &Line) -> Self {
        Self { slab: vec![0.0; LINES * x.len.max(y.len)], scratch: vec![Pair::default(); x.scratch_len().max(y.scratch_len())] }
    }
}

/// Transforms a plane, x fastest, along y and x. The result is in bands of [`LINES`] modes along y, which vary faster than the modes along x.
pub(super) fn to_modes(x: &Line, y: &Line, plane: &mut [f64], lines: &mut Lines) {
    along_y(y, Way::ToModes, x.len, plane, lines);
    let slab = &mut lines.slab[..LINES * x.len];
    for band in plane.chunks_mut(LINES * x.len) {
        transpose(band, slab);
        transform(x, Way::ToModes, slab, LINES, &mut lines.scratch);
        let width = band.len() / x.len;
        copy(width, slab, LINES, band, width);
    }
}

/// Inverts [`to_modes`] except for the gains.
pub(super) fn from_modes(x: &Line, y: &Line, plane: &mut [f64], lines: &mut Lines) {
    let slab = &mut lines.slab[..LINES * x.len];
    for band in plane.chunks_mut(LINES * x.len) {
        let width = band.len() / x.len;
        copy_beside_zeros(width, band, width, slab);
        transform(x, Way::Back, slab, LINES, &mut lines.scratch);
        transpose_back(slab, band);
    }
    along_y(y, Way::Back, x.len, plane, lines);
}

fn along_y(y: &Line, way: Way, nx: usize, plane: &mut [f64], lines: &mut Lines) {
    let whole = nx - nx % LINES;
    for first in (0..whole).step_by(LINES) {
        transform(y, way, &mut plane[first..], nx, &mut lines.scratch);
    }
    if whole < nx {
        let (slab, rest) = (&mut lines.slab[..LINES * y.len], &mut plane[whole..]);
        copy_beside_zeros(nx - whole, rest, nx, slab);
        transform(y, way, slab, LINES, &mut lines.scratch);
        copy(nx - whole, slab, LINES, rest, nx);
    }
}

/// Copies the first `width` values of each row; rows start a stride apart.
fn copy(width: usize, from: &[f64], from_stride: usize, to: &mut [f64], to_stride: usize) {
    if width == from_stride && width == to_stride {
        to.copy_from_slice(from);
        return;
    }
    for (from, to) in from.chunks(from_stride).zip(to.chunks_mut(to_stride)) {
        to[..width].copy_from_slice(&from[..width]);
    }
}

/// Copies `width` lines into a slab and sets its other lines to 0: lines are transformed in pairs, so a line's partner must not be left-over data.
fn copy_beside_zeros(width: usize, from: &[f64], from_stride: usize, slab: &mut [f64]) {
    if width < LINES {
        slab.fill(0.0);
    }
    copy(width, from, from_stride, slab, LINES);
}

/// Transposes up to [`LINES`] rows into lines of a slab; its other lines are 0.
fn transpose(rows: &[f64], slab: &mut [f64]) {
    let (entries, _) = slab.as_chunks_mut::<LINES>();
    let len = entries.len();
    if rows.len() == LINES * len {
        let rows: [&[f64]; LINES] = from_fn(|l| &rows[l * len..][..len]);
        entries.iter_mut().enumerate().for_each(|(j, entry)| *entry = rows.map(|row| row[j]));
    } else {
        entries.fill([0.0; LINES]);
        for (l, row) in rows.chunks_exact(len).enumerate() {
            entries.iter_mut().zip(row).for_each(|(entry, &value)| entry[l] = value);
        }
    }
}

/// Transposes the first lines of a slab back into the given rows.
fn transpose_back(slab: &[f64], rows: &mut [f64]) {
    let (entries, _) = slab.as_chunks::<LINES>();
    for (l, row) in rows.chunks_exact_mut(entries.len()).enumerate() {
        row.iter_mut().zip(entries).for_each(|(value, entry)| *value = entry[l]);
    }
}
