//! Two ways of drawing in one picture, side by side.

use super::{FrameStats, Look, Renderer};
use crate::camera::Camera;
use crate::state::Mirror;
use std::ops::Range;

/// What is left and what is right of an upright border.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Split {
    /// How the left part is drawn, and the right one.
    pub looks: [Look; 2],
    /// Where the border is, as a share of the width from the left, 0..=1.
    pub at: f32,
}

impl Split {
    /// Columns of a picture `width_px` wide that each part has; one of them may be empty.
    pub fn columns(&self, width_px: u32) -> [Range<u32>; 2] {
        let border_px = (self.at.clamp(0.0, 1.0) * width_px as f32).round() as u32;
        [0..border_px, border_px..width_px]
    }
}

/// The part of the target that a frame is brought to.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Part {
    /// Columns (px).
    pub(super) columns: Range<u32>,
    /// Whether the rest of the target stays as it is; else it becomes black.
    pub(super) keeps: bool,
}

impl Renderer {
    /// [`draw`](Self::draw) with one look to the left of a border and another to its right. Both show the same moment: only the first that
    /// is drawn lets time go on. A part without columns costs nothing.
    pub fn draw_split(
        &mut self,
        mirror: &mut Mirror,
        camera: &Camera,
        time_secs: f64,
        dt_secs: f32,
        target: &wgpu::TextureView,
        split: &Split,
    ) -> FrameStats {
        let own = self.look();
        let mut stats = FrameStats::default();
        let parts = split.looks.into_iter().zip(split.columns(self.size_px()[0])).filter(|(_, columns)| !columns.is_empty());
        for (drawn, (look, columns)) in parts.enumerate() {
            self.set_look(look);
            let part = Part { columns, keeps: drawn > 0 };
            stats = self.draw_part(mirror, camera, time_secs, if drawn > 0 { 0.0 } else { dt_secs }, target, &part);
        }
        self.set_look(own);
        stats
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_parts_are_the_whole() {
        let split = |at| Split { looks: [Look::default(); 2], at }.columns(101);
        assert_eq!(split(0.5), [0..51, 51..101]);
        assert_eq!([split(0.0), split(-1.0)], [[0..0, 0..101], [0..0, 0..101]]);
        assert_eq!(split(7.0), [0..101, 101..101]);
    }
}
