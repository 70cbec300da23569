//! Level of detail of plants.

use crate::camera::NEAR_M;
use crate::render::options::render_options::FarPlants;
use prairie_core::scene::Plants;

/// Distances that control how many plants are drawn and how finely. They may change from frame to frame; the buffers are sized for those of the
/// renderer's quality.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Detail {
    /// Maximum distance at which every blade is drawn (m). Beyond, density falls with the square of the distance, so that blades per area of the picture stay
    /// constant.
    pub(crate) full_m: f32,
    /// Maximum distance of blades with all their segments (m).
    pub(crate) fine_m: f32,
    /// Distance from which flower heads thin out (m); the remaining ones are larger.
    pub(crate) heads_m: f32,
    /// Distance at which single blades have faded out (m).
    pub(crate) blades_m: f32,
    /// Distance at which clumps or shells have faded into the ground (m).
    pub(crate) far_m: f32,
    /// Distance at which underbrush has faded into the grass (m).
    pub(crate) underbrush_m: f32,
    /// Maximum distance of trees (m).
    pub(crate) trees_m: f32,
    /// Factor on the heights on screen below which underbrush and trees are drawn coarsely.
    pub(crate) coarser: f32,
}

/// Maximum number of plants of a grid near the camera.
pub(crate) const PLANTS_LIMIT: f32 = 60_000.0;

impl Detail {
    /// Geometric interpolation from `self` (fraction 0) to `other` (fraction 1).
    pub(super) fn interpolated(self, other: Self, fraction: f32) -> Self {
        let between = |a: f32, b: f32| if a == b { a } else { a * (b / a).powf(fraction) };
        Self {
            full_m: between(self.full_m, other.full_m),
            fine_m: between(self.fine_m, other.fine_m),
            heads_m: between(self.heads_m, other.heads_m),
            blades_m: between(self.blades_m, other.blades_m),
            far_m: between(self.far_m, other.far_m),
            underbrush_m: between(self.underbrush_m, other.underbrush_m),
            trees_m: between(self.trees_m, other.trees_m),
            coarser: between(self.coarser, other.coarser),
        }
    }

    /// This detail, with shorter distances where plants grow densely, so that the number drawn stays the same. The reference draws every plant and is
    /// unchanged.
    pub(crate) fn on(self, plants: &Plants) -> Self {
        /// Plant density (1/m²) for which the distances of the presets are tuned.
        const USUAL_PER_M2: f32 = 410.0;
        let per_m2 = (blades_per_grid(plants) / plants.grid_m.powi(2) + plants.flowers_per_m2).max(USUAL_PER_M2);
        let nearer = if self.full_m < self.blades_m { (USUAL_PER_M2 / per_m2).sqrt() } else { 1.0 };
        let rarer = if self.heads_m < self.blades_m { plants.flowers_per_m2.max(1.0).sqrt() } else { 1.0 };
        Self { full_m: self.full_m * nearer, fine_m: self.fine_m * nearer, heads_m: self.heads_m / rarer, ..self }
    }

    /// This detail for a method of drawing far plants: single blades end sooner where clumps or shells take over.
    pub(crate) fn with(self, far_plants: FarPlants) -> Self {
        let blades_m = if far_plants == FarPlants::Land { self.blades_m } else { self.blades_m * 0.35 };
        Self { blades_m, ..self }
    }

    /// This detail while no blades are drawn: everywhere the land has the far look of its grass.
    pub(crate) fn without_blades(self) -> Self {
        Self { blades_m: 0.5 * NEAR_M, ..self }
    }
}

/// Blades of a grid near the camera, the same at all levels.
pub(crate) fn blades_per_grid(plants: &Plants) -> f32 {
    (plants.plants_per_side as f32 * plants.near_ratio).round().powi(2).min(PLANTS_LIMIT)
}
