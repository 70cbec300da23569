//! How finely the picture is drawn.

/// Level of detail of the whole picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quality {
    /// 9 thousand simulated blades, one sample a pixel: for software rendering.
    Low,
    /// 37 thousand, four samples.
    #[default]
    Medium,
    /// 100 thousand.
    High,
    /// 230 thousand.
    Ultra,
}

impl Quality {
    /// All levels, coarsest first.
    pub const ALL: [Self; 4] = [Self::Low, Self::Medium, Self::High, Self::Ultra];

    /// Name as an address and the page write it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Low => "low",
            Self::Medium => "medium",
            Self::High => "high",
            Self::Ultra => "ultra",
        }
    }

    /// The level of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|quality| quality.name() == name)
    }

    /// Blades along one side of a near grid of a scene that has `plants_per_side`: as many at low quality, up to five times as many at the others; nine
    /// such grids are simulated.
    pub fn blades_per_side(self, plants_per_side: u32) -> u32 {
        (plants_per_side as f32 * self.blades_factor()).round() as u32
    }

    fn blades_factor(self) -> f32 {
        match self {
            Self::Low => 1.0,
            Self::Medium => 2.0,
            Self::High => 3.3,
            Self::Ultra => 5.0,
        }
    }

    /// Factor on the width of blades, so that fewer still close the sward.
    pub(super) fn width_factor(self) -> f32 {
        (Self::High.blades_factor() / self.blades_factor()).max(1.0).powf(0.9)
    }

    /// Segments of a fine blade and of a coarse one, one less than the backbone points of 000 §3.1.1. Where n segments share a turn of θ evenly, a blade of
    /// length L departs from its backbone by θ·L/(8n²), for θ = 1: 0.26 % of it with 7, 1.4 % with 3, 0.13 % with 10.
    pub(super) fn segments(self) -> [u32; 2] {
        match self {
            Self::Low | Self::Medium | Self::High => [7, 3],
            Self::Ultra => [10, 4],
        }
    }

    /// Rings of grids beyond the nine whose plants are drawn singly.
    pub(super) fn rings(self) -> i32 {
        match self {
            Self::Low => 1,
            Self::Medium => 2,
            Self::High => 4,
            Self::Ultra => 6,
        }
    }

    /// Samples a pixel.
    pub(super) fn samples(self) -> u32 {
        if self == Self::Low { 1 } else { 4 }
    }

    /// Side of the shadow map (px).
    pub(super) fn shadow_px(self) -> u32 {
        match self {
            Self::Low => 512,
            Self::Medium => 1024,
            Self::High | Self::Ultra => 2048,
        }
    }

    /// Layers of the shadow map: a sharp one near by, and a coarse one far off.
    pub(super) fn shadow_layers(self) -> u32 {
        if self == Self::Low { 1 } else { 2 }
    }

    /// Distance at which billboards have melted into the ground (m).
    pub(super) fn billboard_reach_m(self) -> f32 {
        match self {
            Self::Low => 60.0,
            Self::Medium => 100.0,
            Self::High => 150.0,
            Self::Ultra => 220.0,
        }
    }

    /// Streaks of heavy rain.
    pub(super) fn drops(self) -> u32 {
        match self {
            Self::Low => 4000,
            Self::Medium => 9000,
            Self::High => 18_000,
            Self::Ultra => 30_000,
        }
    }

    /// Distance at which underbrush has melted into the grass (m).
    pub(super) fn underbrush_reach_m(self) -> f32 {
        match self {
            Self::Low => 45.0,
            Self::Medium => 110.0,
            Self::High => 180.0,
            Self::Ultra => 260.0,
        }
    }

    /// Motes that drift about the camera in a scene with dust.
    pub(super) fn motes(self) -> u32 {
        match self {
            Self::Low => 3000,
            Self::Medium => 6000,
            Self::High => 14_000,
            Self::Ultra => 28_000,
        }
    }

    /// Puffs of haze there, and the side of the square that they are in (m).
    pub(super) fn puffs(self) -> (u32, f32) {
        match self {
            Self::Low => (1024, 130.0),
            Self::Medium => (3072, 200.0),
            Self::High => (4096, 220.0),
            Self::Ultra => (8192, 280.0),
        }
    }

    /// Distance up to which the bend field is wanted (m).
    pub fn bend_radius_m(self) -> f32 {
        match self {
            Self::Low => 96.0,
            Self::Medium => 128.0,
            Self::High => 192.0,
            Self::Ultra => 256.0,
        }
    }

    /// Distance up to which trees are drawn (m).
    pub(super) fn tree_reach_m(self) -> f32 {
        match self {
            Self::Low => 400.0,
            Self::Medium => 800.0,
            Self::High | Self::Ultra => 2000.0,
        }
    }
}
