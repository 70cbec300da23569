//! Solids in the air: walls at any angle to the cells, bodies that move, and drag of those that the cells do not resolve.
//!
//! Walls are an immersed boundary for the direct pressure solver; a [`DragBody`] takes momentum out of the air over its volume; a [`Body`] becomes the one or the
//! other by its size.

mod body;
pub(crate) mod drag;
mod setting;
#[cfg(test)]
mod tests;
mod walls;

pub use body::Body;
pub use drag::DragBody;

pub(crate) use drag::Drag;
pub(crate) use walls::Walls;

use crate::Real;
use crate::pressure::immersed::Iteration;

/// Walls with the work arrays of the projection around them.
pub(crate) struct Immersed<R> {
    pub(crate) walls: Walls<R>,
    pub(crate) iteration: Iteration,
    /// Duration (s) of the newest sub-step; 0 before the first.
    pub(crate) step_secs: f64,
}

impl<R: Real> Immersed<R> {
    fn new(cells: usize) -> Self {
        Self { walls: Walls::default(), iteration: Iteration::new(cells), step_secs: 0.0 }
    }

    /// Memory of the walls and of the work arrays (bytes).
    pub(crate) fn memory_bytes(&self) -> usize {
        self.walls.memory_bytes() + self.iteration.memory_bytes()
    }
}
