//! Render options: the methods used for the steps of a frame.

use prairie_core::light::sun::Sun;

/// Transparency order: how partly transparent plants are drawn over each other (Zhang, section 5.4).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BlendOrder {
    /// Alpha test: fragments less than half opaque are discarded and the depth buffer decides. No order is needed.
    #[default]
    Cut,
    /// Alpha to coverage: opacity becomes a fraction of a pixel's samples and the depth buffer decides. Like [`BlendOrder::Cut`] with one sample per pixel.
    Coverage,
    /// Blades and clumps in view are sorted far to near on the GPU in each frame and blended by Zhang, Eq. (10).
    Sorted,
    /// Blades of the camera's grid are sorted, those of other grids follow one of eight precomputed orders, and grids go from far to near
    /// (Zhang, sections 5.4.1 and 5.4.2); blended by Eq. (10).
    Precomputed,
    /// Weighted blended order-independent transparency (McGuire & Bavoil 2013).
    Weighted,
}

impl BlendOrder {
    /// All orders.
    pub const ALL: [Self; 5] = [Self::Cut, Self::Coverage, Self::Sorted, Self::Precomputed, Self::Weighted];

    /// The order used instead if this one is not supported: plants listed in batches cannot be ordered, and coverage needs several samples per
    /// pixel.
    pub(crate) fn supported(self, samples: u32, in_batches: bool) -> Self {
        match if self.blends() && in_batches { Self::Coverage } else { self } {
            Self::Coverage if samples == 1 => Self::Cut,
            order => order,
        }
    }

    /// Whether plants are blended over the opaque picture.
    pub(crate) fn blends(self) -> bool {
        matches!(self, Self::Sorted | Self::Precomputed | Self::Weighted)
    }

    /// Name in addresses, on the page and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Cut => "cut",
            Self::Coverage => "coverage",
            Self::Sorted => "sorted",
            Self::Precomputed => "precomputed",
            Self::Weighted => "weighted",
        }
    }

    /// The order of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|order| order.name() == name)
    }
}

/// Representation of plants beyond the single blades.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FarPlants {
    /// Only the ground, in the colours of its grass. Single blades are drawn up to the distance at which they become indistinguishable.
    #[default]
    Land,
    /// Clumps of six rectangles (Zhang, chapter 4).
    Clumps,
    /// Shells (Bakay).
    Shells,
}

impl FarPlants {
    /// All methods.
    pub const ALL: [Self; 3] = [Self::Land, Self::Clumps, Self::Shells];

    /// Name in addresses, on the page and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Clumps => "clumps",
            Self::Shells => "shells",
            Self::Land => "land",
        }
    }

    /// The method of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|far_plants| far_plants.name() == name)
    }
}

/// When plants and solids behind trees, stones and other solids are culled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Occlusion {
    /// Never.
    Never,
    /// Where solids cover so much of the picture that it is worthwhile.
    #[default]
    Adaptive,
    /// In all frames.
    Always,
}

/// Options of a frame; may change from frame to frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RenderOptions {
    /// Transparency order.
    pub blend_order: BlendOrder,
    /// Representation of far plants.
    pub far_plants: FarPlants,
    /// Whether the motion of clumps grows in proportion to their distance, so that far ones still move visibly (Zhang, section 4.2): the deviation of the wind
    /// from its mean over the ground is multiplied by the distance over that at which clumps begin. Off by default; it shows more wind than there is.
    pub raises_far_wind: bool,
    /// Whether a map of the grass grids around the camera is drawn over the picture (Zhang, Figs 12 to 14): which are culled, and the level of detail of the
    /// others. Only in scenes of single blades.
    pub shows_grids: bool,
    /// Whether things outside the view or behind hills are culled; the picture is the same without.
    pub culls: bool,
    /// When things behind trees, stones and other solids are culled, too, if [`culls`](Self::culls) is set; the picture is the same without.
    pub occlusion: Occlusion,
    /// Whether grass casts shadows on grass and ground; without them it is shaded by the height above the ground alone.
    pub grass_shadows: bool,
    /// Position of the sun; `None`: the scene's.
    pub sun: Option<Sun>,
    /// Shell layers near the camera, including the ground, 1..=65; `None`: the scene's.
    pub shell_layers: Option<u32>,
}

impl RenderOptions {
    /// Name of the option that turns culling off.
    const UNCULLED: &str = "unculled";
    /// Name of the option that turns culling behind solids off, and of the one that tests for it in all frames.
    const UNOCCLUDED: &str = "unoccluded";
    const OCCLUDED: &str = "occluded";
    /// Name of the option that raises the wind with distance.
    const RAISED: &str = "raised";
    /// Name of the option that shows the map of the grids.
    const GRIDS: &str = "grids";
    /// Name of the option that lets grass cast no shadows.
    const UNSHADOWED: &str = "unshadowed";

    /// Names of all options that [`with`](Self::with) accepts.
    pub fn names() -> impl Iterator<Item = &'static str> {
        let (far_plants, orders) = (FarPlants::ALL.into_iter().map(FarPlants::name), BlendOrder::ALL.into_iter().map(BlendOrder::name));
        far_plants.chain(orders).chain([Self::UNCULLED, Self::UNOCCLUDED, Self::OCCLUDED, Self::RAISED, Self::GRIDS, Self::UNSHADOWED])
    }

    /// A copy of the options with the named one set; `None` if the name is unknown.
    pub fn with(self, name: &str) -> Option<Self> {
        let far_plants = FarPlants::from_name(name).map(|far_plants| Self { far_plants, ..self });
        let order = BlendOrder::from_name(name).map(|blend_order| Self { blend_order, ..self });
        let switched = || match name {
            Self::UNCULLED => Some(Self { culls: false, ..self }),
            Self::UNOCCLUDED => Some(Self { occlusion: Occlusion::Never, ..self }),
            Self::OCCLUDED => Some(Self { occlusion: Occlusion::Always, ..self }),
            Self::RAISED => Some(Self { raises_far_wind: true, ..self }),
            Self::GRIDS => Some(Self { shows_grids: true, ..self }),
            Self::UNSHADOWED => Some(Self { grass_shadows: false, ..self }),
            _ => None,
        };
        far_plants.or(order).or_else(switched)
    }
}

impl Default for RenderOptions {
    fn default() -> Self {
        Self {
            blend_order: BlendOrder::default(),
            far_plants: FarPlants::default(),
            raises_far_wind: false,
            shows_grids: false,
            culls: true,
            occlusion: Occlusion::default(),
            grass_shadows: true,
            sun: None,
            shell_layers: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn option_names_are_unique_and_each_sets_one_option() {
        let own = RenderOptions { blend_order: BlendOrder::Weighted, far_plants: FarPlants::Land, ..RenderOptions::default() };
        let names: Vec<_> = RenderOptions::names().collect();
        for (at, name) in names.iter().enumerate() {
            assert!(!names[..at].contains(name), "{name}");
            let options = own.with(name).expect("a known option");
            let changed = [
                options.blend_order != own.blend_order,
                options.far_plants != own.far_plants,
                options.culls != own.culls,
                options.occlusion != own.occlusion,
                options.raises_far_wind != own.raises_far_wind,
                options.shows_grids != own.shows_grids,
                options.grass_shadows != own.grass_shadows,
            ];
            let is_own = own.blend_order.name() == *name || own.far_plants.name() == *name;
            assert_eq!(changed.iter().filter(|&&changed| changed).count(), usize::from(!is_own), "{name}");
        }
        assert_eq!(own.with("Clumps"), None);
    }
}
