//! Walls.

use super::{Grid, Real, Velocity};

/// Sets the velocity through every wall to 0.
pub fn close_walls<R: Real>(grid: &Grid<R>, velocity: &mut Velocity<R>) {
    for (axis, field) in velocity.0.iter_mut().enumerate() {
        if grid.wraps(axis) {
            continue;
        }
        let stride: usize = field.shape[..axis].iter().product();
        let span = stride * field.shape[axis];
        for block in field.data.chunks_mut(span) {
            block[..stride].fill(R::zero());
            block[span - stride..].fill(R::zero());
        }
    }
}
