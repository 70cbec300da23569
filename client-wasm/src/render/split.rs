//! Two ways of drawing in one picture, side by side.

use super::{FrameStats, Look, Quality, Renderer};
use crate::camera::Camera;
use crate::state::Mirror;
use std::ops::Range;

/// A way of drawing: a look and a level of detail.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Way {
    /// Which of several ways each step goes.
    pub look: Look,
    /// Level of detail, as for [`Renderer::set_level`].
    pub level: f32,
}

impl Way {
    /// All names that [`with`](Self::with) knows.
    pub fn names() -> impl Iterator<Item = &'static str> {
        Look::ways().chain(Quality::ALL.map(Quality::name))
    }

    /// This way but for what has this name: one of [the looks' ways](Look::ways), or a quality, which gives its level; none where nothing has it.
    pub fn with(self, name: &str) -> Option<Self> {
        let level = Quality::from_name(name).map(|quality| Self { level: quality.level(), ..self });
        level.or(self.look.with(name).map(|look| Self { look, ..self }))
    }
}

/// What is left and what is right of an upright border.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Split {
    /// How the left part is drawn, and the right one.
    pub ways: [Way; 2],
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
    /// [`draw`](Self::draw) in one way to the left of a border and in another to its right. Both show the same moment: time goes on in the one with more
    /// detail, which has all the plants of the other. A part without columns costs nothing.
    pub fn draw_split(
        &mut self,
        mirror: &mut Mirror,
        camera: &Camera,
        time_secs: f64,
        dt_secs: f32,
        target: &wgpu::TextureView,
        split: &Split,
    ) -> FrameStats {
        let (look, detail) = (self.look, self.detail);
        let mut stats = FrameStats::default();
        let parts = split.ways.into_iter().zip(split.columns(self.size_px[0]));
        let mut parts: Vec<_> = parts.filter(|(_, columns)| !columns.is_empty()).collect();
        parts.sort_by(|(a, _), (b, _)| b.level.total_cmp(&a.level));
        for (drawn, (way, columns)) in parts.into_iter().enumerate() {
            self.set_look(way.look);
            self.set_level(way.level);
            let part = Part { columns, keeps: drawn > 0 };
            stats = self.draw_part(mirror, camera, time_secs, if drawn > 0 { 0.0 } else { dt_secs }, target, &part);
        }
        (self.look, self.detail) = (look, detail);
        stats
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_parts_are_the_whole() {
        let way = Way { look: Look::default(), level: 0.0 };
        let split = |at| Split { ways: [way; 2], at }.columns(101);
        assert_eq!(split(0.5), [0..51, 51..101]);
        assert_eq!([split(0.0), split(-1.0)], [[0..0, 0..101], [0..0, 0..101]]);
        assert_eq!(split(7.0), [0..101, 101..101]);
    }

    #[test]
    fn ways_are_named_once() {
        let own = Way { look: Look::default(), level: 0.5 };
        let names: Vec<_> = Way::names().collect();
        for (at, name) in names.iter().enumerate() {
            assert!(!names[..at].contains(name), "{name}");
            let way = own.with(name).expect("a way");
            assert!(way.look == own.look || way.level == own.level, "{name}");
        }
        assert_eq!(own.with("high"), Some(Way { level: 2.0, ..own }));
        assert_eq!(own.with("auto"), None);
    }
}
