//! Which of several ways each step of the picture goes.

use shared::light::sun::Sun;

/// How plants that are partly transparent are laid over each other (000 §5.4).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Order {
    /// What is less than half opaque is cut away, and the depth buffer decides: no order is needed.
    #[default]
    Cut,
    /// Opacity becomes a share of a pixel's samples, and the depth buffer decides; as [`Order::Cut`] where a pixel has one sample.
    Coverage,
    /// Blades and clumps in view sorted far to near each frame on the GPU, blended by 000 Eq. (10).
    Sorted,
    /// Blades of the camera's grid sorted, those of the grids about it in one of eight orders made beforehand, grids far to near
    /// (000 §5.4.1 and §5.4.2); blended by Eq. (10).
    Precomputed,
    /// Blended without order, each weighted by its depth (McGuire & Bavoil, J. Comput. Graph. Tech. 2013).
    Weighted,
}

impl Order {
    /// All ways.
    pub const ALL: [Self; 5] = [Self::Cut, Self::Coverage, Self::Sorted, Self::Precomputed, Self::Weighted];

    /// What becomes of it where a pixel has so many samples; with blades listed by turns, which have no order, only their depth decides.
    pub(super) fn at(self, samples: u32, by_turns: bool) -> Self {
        match if self.blends() && by_turns { Self::Coverage } else { self } {
            Self::Coverage if samples == 1 => Self::Cut,
            order => order,
        }
    }

    /// Whether plants are blended over what is opaque.
    pub(super) fn blends(self) -> bool {
        matches!(self, Self::Sorted | Self::Precomputed | Self::Weighted)
    }

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
    /// Nothing but the land, whose colours are those of its grass; single blades reach as far as they can be told apart.
    #[default]
    Land,
    /// Clumps of six rectangles (000 §4).
    Clumps,
    /// Shells (003).
    Shells,
}

impl Far {
    /// All ways.
    pub const ALL: [Self; 3] = [Self::Land, Self::Clumps, Self::Shells];

    /// Name as an address and the page write it.
    pub fn name(self) -> &'static str {
        match self {
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
    /// Where the sun stands; none: where the scene has it.
    pub sun: Option<Sun>,
}

impl Look {
    /// Name of the way that leaves nothing out.
    const UNCULLED: &str = "unculled";

    /// Names of all ways that [`with`](Self::with) knows.
    pub fn ways() -> impl Iterator<Item = &'static str> {
        let (fars, orders) = (Far::ALL.into_iter().map(Far::name), Order::ALL.into_iter().map(Order::name));
        fars.chain(orders).chain([Self::UNCULLED])
    }

    /// This look but for the one way that has this name; none where no way has it.
    pub fn with(self, way: &str) -> Option<Self> {
        let far = Far::from_name(way).map(|far| Self { far, ..self });
        let order = Order::from_name(way).map(|order| Self { order, ..self });
        far.or(order).or((way == Self::UNCULLED).then_some(Self { culls: false, ..self }))
    }
}

impl Default for Look {
    fn default() -> Self {
        Self { order: Order::default(), far: Far::default(), culls: true, sun: None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_way_has_a_name_of_its_own_and_changes_itself_alone() {
        let own = Look { order: Order::Weighted, far: Far::Land, ..Look::default() };
        let names: Vec<_> = Look::ways().collect();
        for (at, name) in names.iter().enumerate() {
            assert!(!names[..at].contains(name), "{name}");
            let look = own.with(name).expect("a way");
            let changed = [look.order != own.order, look.far != own.far, look.culls != own.culls];
            let is_own = own.order.name() == *name || own.far.name() == *name;
            assert_eq!(changed.iter().filter(|&&changed| changed).count(), usize::from(!is_own), "{name}");
        }
        assert_eq!(own.with("Clumps"), None);
    }
}
