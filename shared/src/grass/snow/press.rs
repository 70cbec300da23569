//! Objects that press the snow, and the rims of what they push aside.

use super::SnowField;
use super::column::{Column, quanta_of};
use crate::grass::footprint::Run;
use crate::grass::swept_footprint::{Leg, SweptFootprint};
use crate::grid::PatchLayout;
use std::collections::BTreeSet;

/// Neighbours of a cell that share a side.
const SIDES: [[i64; 2]; 4] = [[-1, 0], [1, 0], [0, -1], [0, 1]];

/// Visits per cell around an object after which what is left of its pile stays until it is pressed again.
const VISITS: usize = 128;
/// Excess above the angle of repose that slides: 1 mm.
const LEAST_EXCESS: i64 = 1000;

/// Cells below an object.
pub(super) struct Below(Vec<Run>);

impl Below {
    /// The cells that an object sweeps over in a leg.
    pub(super) fn of(leg: &Leg, layout: &PatchLayout) -> Self {
        let mut runs: Vec<Run> = leg.cover().runs(layout).into_iter().collect();
        runs.sort_unstable_by_key(|run| (run.row, run.from));
        Self(runs)
    }

    fn cells(&self) -> impl Iterator<Item = [i64; 2]> {
        self.0.iter().flat_map(|run| (run.from..run.to).map(|column| [column, run.row]))
    }

    /// The runs of a row, from west to east.
    fn row(&self, row: i64) -> &[Run] {
        let from = self.0.partition_point(|run| run.row < row);
        let count = self.0[from..].partition_point(|run| run.row == row);
        &self.0[from..from + count]
    }

    fn contains(&self, [column, row]: [i64; 2]) -> bool {
        self.row(row).iter().any(|run| (run.from..run.to).contains(&column))
    }

    /// The cells of a row from `from` to before `to` that are not below the object.
    fn outside(&self, row: i64, from: i64, to: i64) -> Vec<[i64; 2]> {
        let mut outside = Vec::new();
        let mut next = from;
        for run in self.row(row) {
            outside.extend((next..run.from.min(to)).map(|column| [column, row]));
            next = next.max(run.to);
        }
        outside.extend((next..to).map(|column| [column, row]));
        outside
    }

    /// The cells around, row by row.
    fn ring(&self) -> Vec<[i64; 2]> {
        let around = |run: &Run| [-1, 0, 1].map(|beside| self.outside(run.row + beside, run.from - 1, run.to + 1));
        let mut ring: Vec<_> = self.0.iter().flat_map(around).flatten().collect();
        ring.sort_unstable_by_key(|[column, row]| (*row, *column));
        ring.dedup();
        ring
    }
}

impl SnowField {
    /// Presses the snow below an object that sweeps over an area at `clearance_m` above the ground. What it pushes aside is spread over the cells around it, and
    /// slumps from there where it is steeper than the angle of repose.
    pub fn press(&mut self, swept: &SweptFootprint, clearance_m: f32) {
        let clearance = quanta_of(clearance_m).max(0);
        for leg in swept.legs() {
            let below = Below::of(&leg, &self.layout);
            let aside = self.compact(&below, clearance);
            if aside.mass > 0 {
                self.push(&below, aside);
            }
        }
    }

    /// Compacts the columns below an object. Returns what is pushed aside.
    pub(super) fn compact(&mut self, below: &Below, clearance: i64) -> Column {
        let mut aside = Column::default();
        for cell in below.cells() {
            let column = self.column(cell);
            let (stays, pushed) = self.yielding.pressed(column, clearance);
            if stays != column {
                self.set(cell, stays);
                aside = aside.plus(pushed);
            }
        }
        aside
    }

    /// Spreads snow evenly over the cells around an object: those that are not pressed hard, unless all are.
    fn push(&mut self, below: &Below, aside: Column) {
        let mut ring = below.ring();
        ring.retain(|cell| self.place(*cell).is_some());
        let is_loose = |cell: &[i64; 2]| !self.yielding.is_packed(self.column(*cell));
        if ring.iter().any(is_loose) {
            ring.retain(is_loose);
        }
        if ring.is_empty() {
            // No cell is around an object that covers the world.
            ring.extend(below.cells().take(1));
        }
        let count = ring.len() as i64;
        for (cell, n) in ring.iter().zip(0..) {
            let part = |whole: i64| whole / count + i64::from(n < whole % count);
            self.set(*cell, self.column(*cell).plus(Column { mass: part(aside.mass), depth: part(aside.depth) }));
        }
        self.slump(below, ring);
    }

    /// Lets snow slide from cells that are steeper than the angle of repose, and from those onto which it slides, until all are at rest or each has been visited
    /// [`VISITS`] times on average.
    fn slump(&mut self, below: &Below, cells: Vec<[i64; 2]>) {
        let mut visits = VISITS * cells.len();
        let mut unsettled = BTreeSet::from_iter(cells);
        while let Some(cell) = unsettled.pop_first().filter(|_| visits > 0) {
            visits -= 1;
            if let Some(lower) = self.slide(below, cell) {
                // Both have changed, and those beside a lower column may slide now.
                unsettled.extend([lower, cell]);
                unsettled.extend(SIDES.map(|[x, z]| [cell[0] + x, cell[1] + z]));
            }
        }
    }

    /// Lets the top of a column that is steeper than the angle of repose slide onto its lowest neighbour, but not below an object: half of what is too much.
    /// Returns that neighbour.
    fn slide(&mut self, below: &Below, cell: [i64; 2]) -> Option<[i64; 2]> {
        let column = self.column(cell);
        let neighbours = SIDES.map(|[x, z]| [cell[0] + x, cell[1] + z]);
        let free = neighbours.into_iter().filter(|at| self.place(*at).is_some() && !below.contains(*at));
        let lowest = free.min_by_key(|at| self.column(*at).depth)?;
        let excess = column.depth - self.column(lowest).depth - self.repose;
        if excess < LEAST_EXCESS {
            return None;
        }
        let slides = column.top(excess / 2);
        self.set(cell, column.minus(slides));
        self.set(lowest, self.column(lowest).plus(slides));
        Some(lowest)
    }
}
