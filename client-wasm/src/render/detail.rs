//! How much of what grows is drawn: what the presets set, and what a frame budget steers between them.

use super::Far;
use shared::scene::Plants;

/// Detail of plants. What a renderer holds room for follows from its quality; this may change from frame to frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Detail {
    /// Distance up to which every blade stands (m); beyond, their density falls with the square of the distance, so that a patch of the picture shows as
    /// many wherever it is.
    pub(super) full_m: f32,
    /// Distance up to which blades have all their segments (m).
    pub(super) fine_m: f32,
    /// Distance from which on heads of flowers thin out (m), and those left are larger.
    pub(super) heads_m: f32,
    /// Distance at which the last single blades have melted into what stands for far plants (m).
    pub(super) blades_m: f32,
    /// Distance at which clumps or shells have melted into the land (m).
    pub(super) far_m: f32,
    /// Distance at which underbrush has melted into the grass (m).
    pub(super) underbrush_m: f32,
    /// Distance up to which trees are drawn (m).
    pub(super) trees_m: f32,
    /// Factor on the heights in the picture below which underbrush and trees are coarser.
    pub(super) coarser: f32,
}

/// Those of the levels 0, 1, 2, 3.
const LEVELS: [Detail; 4] = [
    Detail { full_m: 2.0, fine_m: 2.0, heads_m: 20.0, blades_m: 55.0, far_m: 60.0, underbrush_m: 45.0, trees_m: 400.0, coarser: 2.0 },
    Detail { full_m: 3.4, fine_m: 3.0, heads_m: 30.0, blades_m: 90.0, far_m: 100.0, underbrush_m: 85.0, trees_m: 800.0, coarser: 1.6 },
    Detail { full_m: 7.3, fine_m: 5.0, heads_m: 40.0, blades_m: 130.0, far_m: 150.0, underbrush_m: 180.0, trees_m: 2000.0, coarser: 1.0 },
    Detail { full_m: 11.0, fine_m: 8.0, heads_m: 60.0, blades_m: 180.0, far_m: 220.0, underbrush_m: 260.0, trees_m: 2000.0, coarser: 0.7 },
];

/// Most plants of a grid near the camera.
pub(super) const PLANTS_LIMIT: f32 = 60_000.0;
/// Blades along one side of a grid over what the scene says, so that they close the sward; all levels draw the same ones near the eye.
const DENSE: f32 = 5.0;

impl Detail {
    /// At a level from 0, that of low quality, to 3, that of ultra; between two of them all numbers grow by equal factors.
    pub(super) fn at(level: f32) -> Self {
        let level = level.clamp(0.0, (LEVELS.len() - 1) as f32);
        let below = (level as usize).min(LEVELS.len() - 2);
        let (a, b, share) = (LEVELS[below], LEVELS[below + 1], level - below as f32);
        let between = |a: f32, b: f32| if a == b { a } else { a * (b / a).powf(share) };
        Self {
            full_m: between(a.full_m, b.full_m),
            fine_m: between(a.fine_m, b.fine_m),
            heads_m: between(a.heads_m, b.heads_m),
            blades_m: between(a.blades_m, b.blades_m),
            far_m: between(a.far_m, b.far_m),
            underbrush_m: between(a.underbrush_m, b.underbrush_m),
            trees_m: between(a.trees_m, b.trees_m),
            coarser: between(a.coarser, b.coarser),
        }
    }

    /// The same where plants grow densely: they thin out nearer, so that no more of them are drawn, but where all are.
    pub(super) fn on(self, plants: &Plants) -> Self {
        /// Plants on a square metre that the levels' distances are for.
        const USUAL_PER_M2: f32 = 410.0;
        let per_m2 = (blades_of_grid(plants.plants_per_side) / plants.grid_m.powi(2) + plants.flowers_per_m2).max(USUAL_PER_M2);
        let nearer = if self.full_m < self.blades_m { (USUAL_PER_M2 / per_m2).sqrt() } else { 1.0 };
        let rarer = if self.heads_m < self.blades_m { plants.flowers_per_m2.max(1.0).sqrt() } else { 1.0 };
        Self { full_m: self.full_m * nearer, fine_m: self.fine_m * nearer, heads_m: self.heads_m / rarer, ..self }
    }

    /// Every plant as far as `reach_m`, with all its segments: what the other levels are measured against.
    pub(super) fn whole(reach_m: f32) -> Self {
        let most = LEVELS[LEVELS.len() - 1];
        Self { full_m: reach_m, fine_m: reach_m, heads_m: reach_m, blades_m: reach_m, far_m: reach_m, underbrush_m: reach_m, ..most }
    }

    /// The same where something else than the land stands for the plants that are far off: single blades end sooner.
    pub(super) fn with(self, far: Far) -> Self {
        let blades_m = if far == Far::Land { self.blades_m } else { self.blades_m * 0.35 };
        Self { blades_m, ..self }
    }
}

/// Blades of a grid near the camera, where the scene has so many along one side.
pub(super) fn blades_of_grid(plants_per_side: u32) -> f32 {
    (plants_per_side as f32 * DENSE).round().powi(2).min(PLANTS_LIMIT)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_are_their_presets_and_grow_between_them() {
        for (level, preset) in LEVELS.iter().enumerate() {
            assert_eq!(Detail::at(level as f32), *preset);
        }
        assert_eq!(Detail::at(-1.0), LEVELS[0]);
        assert_eq!(Detail::at(9.0), LEVELS[3]);
        let reaches: Vec<f32> = (0..=30).map(|tenth| Detail::at(tenth as f32 * 0.1).blades_m).collect();
        assert!(reaches.windows(2).all(|pair| pair[0] < pair[1]), "{reaches:?}");
    }
}
