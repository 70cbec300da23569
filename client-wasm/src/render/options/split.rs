//! Side-by-side comparison of two sets of options.

use crate::render::options::quality::Quality;
use crate::render::options::render_options::RenderOptions;
use std::ops::Range;

/// Options of one side of a comparison.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SideOptions {
    /// Render options.
    pub options: RenderOptions,
    /// Level of detail, as for [`Renderer::set_level`](crate::render::Renderer::set_level).
    pub level: f32,
}

impl SideOptions {
    /// Names that [`with`](Self::with) accepts.
    pub fn names() -> impl Iterator<Item = &'static str> {
        RenderOptions::names().chain(Quality::ALL.map(Quality::name))
    }

    /// A copy of the options with the named one set: a [render option](RenderOptions::names), or a quality, which sets the level; `None` if the name is unknown.
    pub fn with(self, name: &str) -> Option<Self> {
        let level = Quality::from_name(name).map(|quality| Self { level: quality.level(), ..self });
        level.or(self.options.with(name).map(|options| Self { options, ..self }))
    }
}

/// A picture split by a vertical border.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Split {
    /// Options of the left and the right side.
    pub sides: [SideOptions; 2],
    /// Position of the border as a fraction of the width from the left, 0..=1.
    pub border: f32,
}

impl Split {
    /// Columns of each side in a picture `width_px` wide; a side may be empty.
    pub fn columns(&self, width_px: u32) -> [Range<u32>; 2] {
        let border_px = (self.border.clamp(0.0, 1.0) * width_px as f32).round() as u32;
        [0..border_px, border_px..width_px]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_sides_cover_the_picture() {
        let side = SideOptions { options: RenderOptions::default(), level: 0.0 };
        let split = |border| Split { sides: [side; 2], border }.columns(101);
        assert_eq!(split(0.5), [0..51, 51..101]);
        assert_eq!([split(0.0), split(-1.0)], [[0..0, 0..101], [0..0, 0..101]]);
        assert_eq!(split(7.0), [0..101, 101..101]);
    }

    #[test]
    fn option_names_are_unique() {
        let own = SideOptions { options: RenderOptions::default(), level: 0.5 };
        let names: Vec<_> = SideOptions::names().collect();
        for (at, name) in names.iter().enumerate() {
            assert!(!names[..at].contains(name), "{name}");
            let side = own.with(name).expect("a known option");
            assert!(side.options == own.options || side.level == own.level, "{name}");
        }
        assert_eq!(own.with("high"), Some(SideOptions { level: 2.0, ..own }));
        assert_eq!(own.with("auto"), None);
    }
}
