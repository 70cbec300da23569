//! Which of several ways each step of the picture goes.

/// How plants that are partly transparent are laid over each other (000 §5.4).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Order {
    /// What is less than half opaque is cut away, and the depth buffer decides: no order is needed.
    #[default]
    Cut,
    /// Opacity becomes a share of a pixel's samples, and the depth buffer decides; as [`Order::Cut`] where a pixel has one sample.
    Coverage,
    /// All plants in view sorted far to near each frame on the GPU, blended by 000 Eq. (10).
    Sorted,
    /// The plants of the camera's grid sorted, those of the grids about it in one of eight orders made beforehand, grids far to near
    /// (000 §5.4.1 and §5.4.2); blended by Eq. (10).
    Precomputed,
    /// Blended without order, each weighted by its depth (McGuire & Bavoil, J. Comput. Graph. Tech. 2013).
    Weighted,
}

impl Order {
    /// All ways.
    pub const ALL: [Self; 5] = [Self::Cut, Self::Coverage, Self::Sorted, Self::Precomputed, Self::Weighted];

    /// Name as an address and the page write it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Cut => "cut",
            Self::Coverage => "coverage",
            Self::Sorted => "sorted",
            Self::Precomputed => "precomputed",
            Self::Weighted => "weighted",
        }
    }

    /// The way of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|order| order.name() == name)
    }
}

/// What stands for the plants beyond those that are drawn singly.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Far {
    /// Single blades as far as they can be told apart, fewer and wider the farther they are.
    Blades,
    /// Clumps of six rectangles (000 §4).
    #[default]
    Clumps,
    /// Shells (003).
    Shells,
    /// The land's own colours.
    Land,
}

impl Far {
    /// All ways.
    pub const ALL: [Self; 4] = [Self::Blades, Self::Clumps, Self::Shells, Self::Land];

    /// Name as an address and the page write it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Blades => "blades",
            Self::Clumps => "clumps",
            Self::Shells => "shells",
            Self::Land => "land",
        }
    }

    /// The way of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|far| far.name() == name)
    }
}

/// How a frame is drawn; may change from frame to frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    /// How plants are laid over each other.
    pub order: Order,
    /// What stands for far plants.
    pub far: Far,
    /// Whether what the view's edges or the land hide is left out; the picture is the same without.
    pub culls: bool,
    /// Layers of shells near the camera, the ground among them, 1..=65; the scene's if none.
    pub shell_layers: Option<u32>,
}

impl Default for Look {
    fn default() -> Self {
        Self { order: Order::default(), far: Far::default(), culls: true, shell_layers: None }
    }
}
