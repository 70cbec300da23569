//! Exact fields of the published bend field: angles, velocities, and the activity and evictions of patches.

use super::window::Window;
use crate::snapshot::BentPatches;
use prairie_core::grass::StepRecord;
use prairie_core::grid::{PatchIndex, PatchLayout};
use prairie_core::scene::Scene;
use prairie_core::wire::quantise::CodeSteps;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Largest number of cells or patches along one side of a field.
const SIDE_LIMIT: u32 = 512;

/// Fields of the bend field in a window of the world, row by row from the north-west.
///
/// Values are codes times their step, so they are within the errors that the scene's `[stream]` states. Laid grass is part of the codes; the lean in the wind
/// is not.
pub(super) struct BendFields {
    layout: PatchLayout,
    steps: CodeSteps,
    /// Cells that are shown.
    cells: Window,
    /// Patches that are shown.
    patches: Window,
    /// How often each patch was evicted since the start.
    evictions: BTreeMap<PatchIndex, u32>,
}

impl BendFields {
    /// The window about the clients' starting point: the whole world, or at most 512 × 512 cells and 512 × 512 patches of it.
    pub(super) fn new(scene: &Scene) -> Self {
        let layout = PatchLayout::from(&scene.patches);
        let cells = Window::around(scene.camera.at, layout.count.map(|count| count * layout.cells), SIDE_LIMIT);
        let patches = Window::around(scene.camera.at, layout.count, SIDE_LIMIT);
        Self { layout, steps: CodeSteps::from(&scene.stream), cells, patches, evictions: BTreeMap::new() }
    }

    /// Cells that are shown.
    pub(super) fn cells(&self) -> &Window {
        &self.cells
    }

    /// Patches that are shown.
    pub(super) fn patches(&self) -> &Window {
        &self.patches
    }

    /// Bending angle θ of the cells (rad).
    pub(super) fn angle_rad(&self, patches: &BentPatches) -> Vec<f32> {
        self.plane(patches, 0, |code| self.steps.theta_rad(code))
    }

    /// Bending velocity of the cells (rad/s): ωx, then ωz.
    pub(super) fn velocity_rad_per_s(&self, patches: &BentPatches) -> Vec<f32> {
        (1..3).flat_map(|channel| self.plane(patches, channel, |code| self.steps.omega_rad_per_s(code))).collect()
    }

    /// Activity of the patches: sum of θ² + ω² over the cells (rad² and rad²/s² together, as in the metric `bend_activity`).
    pub(super) fn activity(&self, patches: &BentPatches) -> Vec<f32> {
        let mut activity = vec![0.0; self.patches.len()];
        for (&index, patch) in patches {
            if let Some(at) = self.patches.index(self.layout.place(index)) {
                activity[at] = self.activity_of(&patch.codes) as f32;
            }
        }
        activity
    }

    /// Counts the evictions of a step.
    pub(super) fn count_evictions(&mut self, step: &StepRecord) {
        for patch in &step.causes.evicted {
            *self.evictions.entry(*patch).or_default() += 1;
        }
    }

    /// How often each patch was evicted since the start.
    pub(super) fn evictions(&self) -> Vec<f32> {
        let mut counts = vec![0.0; self.patches.len()];
        for (index, count) in &self.evictions {
            if let Some(at) = self.patches.index(self.layout.place(*index)) {
                counts[at] = *count as f32;
            }
        }
        counts
    }

    fn activity_of(&self, codes: &[i16]) -> f64 {
        let plane = (self.layout.cells * self.layout.cells) as usize;
        let square = |value: f32| f64::from(value) * f64::from(value);
        let theta: f64 = codes[..plane].iter().map(|code| square(self.steps.theta_rad(*code))).sum();
        let omega: f64 = codes[plane..3 * plane].iter().map(|code| square(self.steps.omega_rad_per_s(*code))).sum();
        theta + omega
    }

    /// One channel of the cells in the window; cells of patches at rest are 0.
    fn plane(&self, patches: &BentPatches, channel: usize, value: impl Fn(i16) -> f32) -> Vec<f32> {
        let side = self.layout.cells as usize;
        let mut values = vec![0.0; self.cells.len()];
        for (&index, patch) in patches {
            let [x, z] = self.layout.place(index).map(|n| n * self.layout.cells);
            for (row, codes) in (z..).zip(patch.codes[channel * side * side..][..side * side].chunks(side)) {
                for (column, code) in (x..).zip(codes) {
                    if let Some(at) = self.cells.index([column, row]) {
                        values[at] = value(*code);
                    }
                }
            }
        }
        values
    }
}

/// Steps that follow the last one seen, of the newest ones in a snapshot.
pub(super) fn new_steps(steps: &[Arc<StepRecord>], seen_tick: Option<u64>) -> &[Arc<StepRecord>] {
    let first = seen_tick.map_or(steps.len(), |seen| steps.partition_point(|step| step.tick <= seen));
    &steps[first..]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::snapshot::PatchCodes;
    use prairie_core::grass::Causes;

    const SIDE: usize = 8;

    fn scene(count: [u32; 2]) -> Scene {
        let mut scene = crate::scenes::load("meadow").unwrap().scene;
        (scene.patches.count, scene.patches.cells, scene.camera.at) = (count, SIDE as u32, [1.0, 0.0]);
        scene
    }

    fn patches(index: PatchIndex, code: impl Fn(usize) -> i16) -> BentPatches {
        BentPatches::from([(index, Arc::new(PatchCodes { tick: 1, codes: (0..3 * SIDE * SIDE).map(code).collect() }))])
    }

    #[test]
    fn cells_have_the_values_of_their_codes() {
        let fields = BendFields::new(&scene([3, 2]));
        let steps = CodeSteps::from(&scene([3, 2]).stream);
        // Patch 4 is the second of the southern row.
        let bent = patches(4, |at| at as i16 - 70);
        let (angle, velocity, activity) = (fields.angle_rad(&bent), fields.velocity_rad_per_s(&bent), fields.activity(&bent));
        assert_eq!((angle.len(), velocity.len(), activity.len()), (6 * 64, 12 * 64, 6));
        let cell = |i: usize, j: usize| (SIDE + j) * 3 * SIDE + SIDE + i;
        for (i, j) in [(0, 0), (7, 0), (3, 5), (7, 7)] {
            let code = |channel: usize| (channel * 64 + j * SIDE + i) as i16 - 70;
            assert_eq!(angle[cell(i, j)], steps.theta_rad(code(0)));
            assert_eq!(velocity[cell(i, j)], steps.omega_rad_per_s(code(1)));
            assert_eq!(velocity[6 * 64 + cell(i, j)], steps.omega_rad_per_s(code(2)));
        }
        assert_eq!(angle.iter().filter(|angle| **angle != 0.0).count(), 64);
        let squares: f32 = angle.iter().chain(&velocity).map(|value| value * value).sum();
        assert!((activity[4] - squares).abs() < 1e-4 * squares && activity.iter().filter(|sum| **sum != 0.0).count() == 1);
    }

    #[test]
    fn a_large_world_is_shown_about_the_start() {
        let fields = BendFields::new(&scene([100, 70]));
        assert_eq!((fields.cells().size(), fields.cells().first()), ([512, 512], [288, 0]));
        let angle = fields.angle_rad(&patches(99, |_| 1));
        assert_eq!(angle.iter().position(|angle| *angle != 0.0), Some(512 - SIDE));
        assert!(fields.angle_rad(&patches(0, |_| 1)).iter().all(|angle| *angle == 0.0), "beyond the window");
        assert_eq!(fields.patches().size(), [100, 70]);
    }

    #[test]
    fn evictions_are_counted_in_every_step_once() {
        let step = |tick: u64, evicted: &[PatchIndex]| {
            Arc::new(StepRecord {
                tick,
                wind_tick: 0,
                causes: Causes { evicted: evicted.to_vec(), ..Causes::default() },
                objects: vec![],
                checks: vec![],
            })
        };
        let steps = [step(3, &[0]), step(4, &[1, 5]), step(5, &[5])];
        let mut fields = BendFields::new(&scene([3, 2]));
        assert!(new_steps(&steps, None).is_empty(), "evictions from before the recording");
        new_steps(&steps, Some(3)).iter().for_each(|step| fields.count_evictions(step));
        assert_eq!(fields.evictions(), [0.0, 1.0, 0.0, 0.0, 0.0, 2.0]);
        assert!(new_steps(&steps, Some(5)).is_empty());
    }
}
