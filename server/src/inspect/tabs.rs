//! Tabs of the initial layout, with the entities that each view shows.

use super::entities::Entity;
use super::plots::{PLOTS, Plot};

/// A tab: views side by side, and a grid of smaller ones below them.
pub(super) struct Tab {
    pub(super) name: &'static str,
    pub(super) large: &'static [View],
    pub(super) small: &'static [View],
}

/// A view.
pub(super) enum View {
    /// Entities in space.
    Space { title: &'static str, entities: &'static [Entity] },
    /// Images and marks on them, from above or from the side.
    Image { title: &'static str, entities: &'static [Entity] },
    /// A slice of a tensor.
    Slice { title: &'static str, entity: Entity, slice: Slice },
    /// A plot, by its folder.
    Plot(&'static str),
    /// All plots.
    Plots,
    /// Lines of text.
    Text { title: &'static str, entity: Entity },
}

/// Plane of a tensor that a view shows at first.
pub(super) struct Slice {
    /// Dimensions along the width and the height of the view.
    pub(super) across: [u32; 2],
    /// Index along each other dimension.
    pub(super) at: &'static [(u32, u64)],
}

/// Level slice of a volume of one number.
const LEVEL: Slice = Slice { across: [2, 0], at: &[(1, 0)] };
/// Level slice through the lowest cells of the first component of a volume of vectors.
const LEVEL_OF_X: Slice = Slice { across: [3, 1], at: &[(0, 0), (2, 0)] };
/// The same of the second component.
const LEVEL_OF_Y: Slice = Slice { across: [3, 1], at: &[(0, 1), (2, 0)] };
/// First component of a level field of vectors.
const FIRST: Slice = Slice { across: [2, 1], at: &[(0, 0)] };

const BEND_MAP: View =
    View::Image { title: "Bending angle, from above", entities: &[Entity::MapBend, Entity::MapScale, Entity::MapObjects] };

/// Every tab, in order.
pub(super) const TABS: &[Tab] = &[
    Tab {
        name: "Overview",
        large: &[
            View::Space {
                title: "Wind and grass",
                entities: &[Entity::World, Entity::Ground, Entity::WindArrows, Entity::Objects, Entity::Trails],
            },
            BEND_MAP,
        ],
        small: &[
            View::Plot("step"),
            View::Plot("awake"),
            View::Plot("population"),
            View::Plot("sent"),
            View::Plot("losses"),
            View::Text { title: "Decisions about the detail", entity: Entity::Decisions },
        ],
    },
    Tab {
        name: "Wind",
        large: &[
            View::Space {
                title: "Streamlines from the ground",
                entities: &[Entity::World, Entity::Ground, Entity::WindArrows, Entity::Streamlines],
            },
            View::Image { title: "Speed in the lowest cells (m/s)", entities: &[Entity::WindGround] },
        ],
        small: &[
            View::Image { title: "Speed in the section along X (m/s)", entities: &[Entity::WindSection] },
            View::Slice { title: "Wind along X (m/s)", entity: Entity::WindVelocity, slice: LEVEL_OF_X },
            View::Slice { title: "Vorticity about Y (1/s)", entity: Entity::WindVorticity, slice: LEVEL_OF_Y },
            View::Slice { title: "Divergence (1/s)", entity: Entity::WindDivergence, slice: LEVEL },
            View::Slice { title: "Unresolved gusts along X (m/s)", entity: Entity::WindGusts, slice: FIRST },
            View::Slice { title: "Dust", entity: Entity::WindDust, slice: LEVEL },
            View::Plot("divergence"),
            View::Plot("wind_energy"),
            View::Plot("wind_step"),
            View::Plot("step_errors"),
        ],
    },
    Tab {
        name: "Bend",
        large: &[BEND_MAP, View::Image { title: "Bending angle of the bend field (rad)", entities: &[Entity::BendAngle] }],
        small: &[
            View::Slice { title: "Bending velocity along X (rad/s)", entity: Entity::BendVelocity, slice: FIRST },
            View::Image { title: "Activity of the patches", entities: &[Entity::BendActivity] },
            View::Image { title: "Evictions of the patches", entities: &[Entity::BendEvictions] },
            View::Plot("bend_activity"),
            View::Plot("awake"),
            View::Plot("stability"),
        ],
    },
    Tab {
        name: "Contact",
        large: &[View::Space {
            title: "Objects as the grass meets them",
            entities: &[
                Entity::World,
                Entity::Ground,
                Entity::Objects,
                Entity::Outlines,
                Entity::Footprints,
                Entity::Velocities,
                Entity::Contacts,
                Entity::Trails,
            ],
        }],
        small: &[BEND_MAP, View::Plot("population"), View::Plot("damage"), View::Text { title: "Events", entity: Entity::Events }],
    },
    Tab {
        name: "Plants",
        large: &[
            View::Image { title: "Covering map", entities: &[Entity::LandCover] },
            View::Image { title: "Height of the land (m)", entities: &[Entity::LandHeight] },
        ],
        small: &[View::Plot("damage"), View::Plot("bend_activity")],
    },
    Tab {
        name: "Health",
        large: &[
            View::Text { title: "Decisions about the detail", entity: Entity::Decisions },
            View::Text { title: "Events", entity: Entity::Events },
        ],
        small: &[View::Plots],
    },
];

/// The plot with a folder.
pub(super) fn plot(folder: &str) -> Option<&'static Plot> {
    PLOTS.iter().find(|plot| plot.folder == folder)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inspect::entities::ENTITIES;

    fn views() -> impl Iterator<Item = &'static View> {
        TABS.iter().flat_map(|tab| tab.large.iter().chain(tab.small))
    }

    #[test]
    fn every_entity_is_in_a_tab() {
        let shown = |entity: Entity| {
            views().any(|view| match view {
                View::Space { entities, .. } | View::Image { entities, .. } => entities.contains(&entity),
                View::Slice { entity: other, .. } | View::Text { entity: other, .. } => *other == entity,
                View::Plots => entity == Entity::Metrics,
                View::Plot(_) => false,
            })
        };
        let names_only = [Entity::Map, Entity::Land];
        for row in ENTITIES.iter().filter(|row| !names_only.contains(&row.entity)) {
            assert!(shown(row.entity), "{} is in no tab", row.path);
        }
    }

    #[test]
    fn views_fit_the_archetypes_of_their_entities() {
        for view in views() {
            let (entities, allowed): (&[Entity], &[&str]) = match view {
                View::Space { entities, .. } => (entities, &["ViewCoordinates", "Mesh3D", "Arrows3D", "Boxes3D", "LineStrips3D"]),
                View::Image { entities, .. } => (entities, &["DepthImage", "SegmentationImage", "LineStrips2D", "Points2D"]),
                View::Slice { entity, .. } => (std::slice::from_ref(entity), &["Tensor"]),
                View::Text { entity, .. } => (std::slice::from_ref(entity), &["TextLog"]),
                View::Plot(folder) => {
                    assert!(plot(folder).is_some(), "there is no plot `{folder}`");
                    (&[], &[])
                }
                View::Plots => (&[], &[]),
            };
            for entity in entities {
                assert!(allowed.contains(&entity.row().archetype), "{} in a view for {allowed:?}", entity.path());
            }
        }
    }

    #[test]
    fn the_readme_names_every_tab() {
        for tab in TABS {
            assert!(
                include_str!("../../README.md").contains(&format!("| {} |", tab.name)),
                "server/README.md must describe the tab {}",
                tab.name
            );
        }
    }
}
