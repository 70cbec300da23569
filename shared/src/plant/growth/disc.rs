//! Discs in the lattice: the squares that a disc about a site may touch.

use super::sites::STEPS;

/// Disc about a site: everything nearer than its radius. Its rows contain all sites within, wherever sites are in their squares.
#[derive(Clone, Debug)]
pub(super) struct Disc {
    radius2: i64,
    /// Number of columns to either side, indexed by rows from the centre.
    half_widths: Vec<i64>,
}

impl Disc {
    /// A disc with a radius in steps.
    pub(super) fn new(radius_steps: f64) -> Self {
        let radius2 = square_steps(radius_steps);
        // Sites this many squares apart are at least this far from each other.
        let nearest = |squares: i64| (squares * STEPS - (STEPS - 1)).max(0);
        let holds = |columns: i64, rows: i64| nearest(columns) * nearest(columns) + nearest(rows) * nearest(rows) < radius2;
        let mut half_width = 0;
        while holds(half_width + 1, 0) {
            half_width += 1;
        }
        let mut half_widths = vec![];
        while holds(0, half_widths.len() as i64) {
            while !holds(half_width, half_widths.len() as i64) {
                half_width -= 1;
            }
            half_widths.push(half_width);
        }
        Self { radius2, half_widths }
    }

    /// Smallest squared distance (steps²) that is outside.
    pub(super) fn radius2(&self) -> i64 {
        self.radius2
    }

    /// Number of rows to the north and to the south.
    pub(super) fn rows(&self) -> i64 {
        self.half_widths.len() as i64 - 1
    }

    /// Number of columns to the west and to the east, `row` rows from the centre.
    pub(super) fn half_width(&self, row: i64) -> i64 {
        self.half_widths[row.unsigned_abs() as usize]
    }
}

/// Smallest integer that is at least `steps`; above zero.
pub(super) fn square_steps(steps: f64) -> i64 {
    ((steps * steps).ceil() as i64).max(1)
}
