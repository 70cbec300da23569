//! Strokes: areas of grass that one cause presses in a step, and the rule by which each cell yields.

use super::footprint::{Footprint, Run};
use super::grass_state::CellState;
use crate::bend::Bend;
use crate::grid::PatchLayout;

/// Bend of pressed grass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pressed {
    /// The total bend.
    pub bend: Bend,
    /// Fraction of it that remains as flattened grass, 0..=1.
    pub flattened_fraction: f32,
}

/// Rule by which a cell yields, from its centre (m) and its state; `None` where it does not.
type Rule<'a> = Box<dyn Fn([f32; 2], &mut CellState) -> Option<Pressed> + Send + Sync + 'a>;

/// An area of grass that one cause presses in a step.
pub struct Stroke<'a> {
    /// Cells of the area, row by row.
    pub(super) runs: Vec<Run>,
    /// Whether the cause is an object at rest. All of the bend below it counts as flattened grass, in sleeping patches as well. It is rewritten whenever it
    /// has recovered by 1.4°.
    pub(super) is_at_rest: bool,
    pub(super) rule: Rule<'a>,
}

impl<'a> Stroke<'a> {
    /// The cells of `layout` within `area`, pressed by a rule.
    pub(super) fn new(
        area: &Footprint,
        layout: &PatchLayout,
        is_at_rest: bool,
        rule: impl Fn([f32; 2], &mut CellState) -> Option<Pressed> + Send + Sync + 'a,
    ) -> Self {
        Self { runs: area.runs(layout), is_at_rest, rule: Box::new(rule) }
    }
}
