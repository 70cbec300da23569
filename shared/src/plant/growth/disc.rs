//! Which squares a disc about a site may touch.

use super::sites::STEPS;

/// A disc about a site: what is nearer than its radius. However the sites lie in their squares, those within are in its rows.
#[derive(Clone, Debug)]
pub(super) struct Disc {
    radius2: i64,
    /// Columns to either side, by the rows away from the middle.
    half_widths: Vec<i64>,
}

impl Disc {
    /// A disc of `radius_steps`.
    pub(super) fn new(radius_steps: f64) -> Self {
        let radius2 = square_steps(radius_steps);
        // Sites so many squares apart are at least so far from each other.
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

    /// Least square of a distance (steps²) that is outside.
    pub(super) fn radius2(&self) -> i64 {
        self.radius2
    }

    /// Rows to the north and to the south.
    pub(super) fn rows(&self) -> i64 {
        self.half_widths.len() as i64 - 1
    }

    /// Columns to the west and to the east, `row` rows away from the middle.
    pub(super) fn half_width(&self, row: i64) -> i64 {
        self.half_widths[row.unsigned_abs() as usize]
    }
}

/// Least whole square that is not nearer than `steps`; above zero.
pub(super) fn square_steps(steps: f64) -> i64 {
    ((steps * steps).ceil() as i64).max(1)
}
