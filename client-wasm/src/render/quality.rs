//! How finely the picture is drawn.

use super::detail::Detail;

/// Level of detail of the whole picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quality {
    /// Few wide blades, one sample a pixel: for software rendering.
    Low,
    /// More of them, and farther; four samples, one in software.
    #[default]
    Medium,
    /// All that stand near the eye.
    High,
    /// The same farther off, four pixels for each that is shown.
    Ultra,
    /// Every plant at full detail as far as [`REFERENCE_M`], whatever it costs: what the others are measured against.
    Reference,
}

/// Distance up to which [`Quality::Reference`] draws every plant (m).
pub const REFERENCE_M: f32 = 100.0;

impl Quality {
    /// All levels that a visitor may choose, coarsest first.
    pub const ALL: [Self; 4] = [Self::Low, Self::Medium, Self::High, Self::Ultra];

    /// Name as an address and the page write it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Low => "low",
            Self::Medium => "medium",
            Self::High => "high",
            Self::Ultra => "ultra",
            Self::Reference => "reference",
        }
    }

    /// The level of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|quality| quality.name() == name)
    }

    /// The most detail of plants that it has room for.
    pub(super) fn detail(self) -> Detail {
        if self == Self::Reference { Detail::whole(REFERENCE_M) } else { Detail::at(self.level()) }
    }

    /// The next coarser level; none below the coarsest.
    pub fn lower(self) -> Option<Self> {
        let at = Self::ALL.iter().position(|&quality| quality == self).unwrap_or(Self::ALL.len());
        at.checked_sub(1).map(|below| Self::ALL[below])
    }

    /// Level of detail of its plants, from 0 to 3.
    pub fn level(self) -> f32 {
        match self {
            Self::Low => 0.0,
            Self::Medium => 1.0,
            Self::High => 2.0,
            Self::Ultra | Self::Reference => 3.0,
        }
    }

    /// Segments of a fine blade and of a coarse one, one less than the backbone points of 000 §3.1.1. Where n segments share a turn of θ evenly, a blade of
    /// length L departs from its backbone by θ·L/(8n²), for θ = 1: 0.26 % of it with 7, 1.4 % with 3, 0.13 % with 10.
    pub(super) fn segments(self) -> [u32; 2] {
        match self {
            Self::Low | Self::Medium | Self::High => [7, 3],
            Self::Ultra | Self::Reference => [10, 4],
        }
    }

    /// Least width that a blade is drawn with (px), so that none vanishes between samples.
    pub(super) fn thinnest_px(self) -> f32 {
        if self == Self::Reference { 0.0 } else { 0.9 }
    }

    /// Samples a pixel; a processor that draws takes four times as long for four.
    pub(super) fn samples(self, is_software: bool) -> u32 {
        match self {
            Self::Low => 1,
            Self::Medium if is_software => 1,
            _ => 4,
        }
    }

    /// Pixels that are drawn along either side of one that is shown, in a picture of this size, none of whose sides may be longer than a limit.
    pub fn fineness(self, size_px: [u32; 2], limit_px: u32) -> u32 {
        /// Most pixels that are drawn finely; more of them are fine enough, and these take 0.5 GB.
        const MOST_PX: u64 = 10_000_000;
        let finely_px = size_px.map(|side_px| 2 * u64::from(side_px));
        let fits = finely_px.iter().all(|&side_px| side_px <= u64::from(limit_px)) && finely_px[0] * finely_px[1] <= MOST_PX;
        if self == Self::Ultra && fits { 2 } else { 1 }
    }

    /// Whether trees that are not fine are lit at their vertices: a processor that draws takes long to light each fragment of their sprays, of which most are hidden
    /// or cut away.
    pub(super) fn lights_trees_at_vertices(self, is_software: bool) -> bool {
        is_software && matches!(self, Self::Low | Self::Medium)
    }

    /// Side of the shadow map (px).
    pub(super) fn shadow_px(self) -> u32 {
        match self {
            Self::Low => 512,
            Self::Medium => 1024,
            Self::High | Self::Ultra | Self::Reference => 2048,
        }
    }

    /// Streaks of heavy rain.
    pub(super) fn drops(self) -> u32 {
        match self {
            Self::Low => 4000,
            Self::Medium => 9000,
            Self::High => 18_000,
            Self::Ultra | Self::Reference => 30_000,
        }
    }

    /// Motes that drift about the camera in a scene with dust.
    pub(super) fn motes(self) -> u32 {
        match self {
            Self::Low => 3000,
            Self::Medium => 6000,
            Self::High => 14_000,
            Self::Ultra | Self::Reference => 28_000,
        }
    }

    /// Puffs of haze there, and the side of the square that they are in (m).
    pub(super) fn puffs(self) -> (u32, f32) {
        match self {
            Self::Low => (1024, 130.0),
            Self::Medium => (3072, 200.0),
            Self::High => (4096, 220.0),
            Self::Ultra | Self::Reference => (8192, 280.0),
        }
    }

    /// Room for the plants of underbrush in view, and as much again for their rows (bytes): four times as much as the shipped scenes fill at 960 × 540. Where rows
    /// have none, plants are drawn more coarsely, and at last left out.
    pub(super) fn underbrush_bytes(self) -> u64 {
        match self {
            Self::Low => 16 << 20,
            Self::Medium => 32 << 20,
            Self::High => 64 << 20,
            Self::Ultra | Self::Reference => 128 << 20,
        }
    }

    /// Distance up to which the bend field is wanted (m).
    pub fn bend_radius_m(self) -> f32 {
        match self {
            Self::Low => 96.0,
            Self::Medium => 128.0,
            Self::High => 192.0,
            Self::Ultra | Self::Reference => 256.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ultra_draws_finely_what_is_not_fine_yet() {
        assert_eq!(Quality::Ultra.fineness([1920, 1080], 8192), 2);
        assert_eq!(Quality::Ultra.fineness([3840, 2160], 8192), 1);
        assert_eq!(Quality::Ultra.fineness([1920, 1080], 2048), 1);
        assert_eq!(Quality::Ultra.fineness([u32::MAX; 2], u32::MAX), 1);
        assert_eq!(Quality::High.fineness([640, 360], 8192), 1);
    }
}
