//! One small wind box that serves every patch (Zhang §5.1). Each patch shows the whole box, shifted by a random number of cells, so that patches do not sway in
//! unison.
//!
//! Around the border of two patches their winds are blended linearly over a band one wind cell wide.

use crate::grid::PatchLayout;
use crate::hash::{folded, hash3};
use crate::scene::{Scene, WindTiling};

/// A position in the wind's box and its weight in a blend.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tap {
    /// X and Z (m); the box repeats along both.
    pub at_m: [f32; 2],
    /// Weight, 0..=1.
    pub weight: f32,
}

/// Mapping from the world to positions in the wind's box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WindTiles {
    /// `None` where world and box coordinates are the same.
    patches: Option<PatchOffsets>,
}

/// Offsets of the wind's box in the patches.
#[derive(Clone, Copy, Debug, PartialEq)]
struct PatchOffsets {
    seed: u32,
    patch_m: f32,
    cells: [u32; 2],
    spacing_m: [f32; 2],
}

impl WindTiles {
    /// The mapping of `scene`.
    pub fn new(scene: &Scene) -> Self {
        let ([nx, _, nz], [dx, _, dz]) = (scene.wind.cells, scene.wind.spacing_m);
        let patch_m = PatchLayout::from(&scene.patches).patch_m();
        let patches = PatchOffsets { seed: folded(scene.seed), patch_m, cells: [nx, nz], spacing_m: [dx, dz] };
        Self { patches: (scene.wind.tiling == WindTiling::Patch).then_some(patches) }
    }

    /// Whether each patch shows the box with an offset of its own.
    pub fn by_patch(&self) -> bool {
        self.patches.is_some()
    }

    /// Positions in the box to sample for a position in the world (m, X and Z), each a whole number of cells away from it. One inside a patch, two or four
    /// in the band where patches meet; the others have a weight of 0. The weights sum to 1.
    ///
    /// Its twin on the GPU is `air_at` in `inputs/wind.wgsl`.
    pub fn taps(&self, at_m: [f32; 2]) -> [Tap; 4] {
        let Some(patches) = &self.patches else { return [Tap { at_m, weight: 1.0 }, Tap::default(), Tap::default(), Tap::default()] };
        let [(x, east), (z, south)] = [0, 1].map(|axis| patches.between(axis, at_m[axis]));
        let tap = |dx: i32, dz: i32, weight: f32| {
            let cells = patches.offset_cells([x.wrapping_add(dx), z.wrapping_add(dz)]);
            Tap { at_m: [0, 1].map(|axis| at_m[axis] + cells[axis] as f32 * patches.spacing_m[axis]), weight }
        };
        let [west, north] = [1.0 - east, 1.0 - south];
        [tap(0, 0, west * north), tap(1, 0, east * north), tap(0, 1, west * south), tap(1, 1, east * south)]
    }

    /// Weighted sum of `sample` over the [taps](Self::taps).
    pub fn blend<const N: usize>(&self, at_m: [f32; 2], sample: impl Fn([f32; 2]) -> [f32; N]) -> [f32; N] {
        self.taps(at_m).into_iter().filter(|tap| tap.weight > 0.0).fold([0.0; N], |sum, tap| {
            let value = sample(tap.at_m);
            std::array::from_fn(|i| sum[i] + value[i] * tap.weight)
        })
    }

    /// Seed for the GPU twin; 0 without patches.
    pub fn seed(&self) -> u32 {
        self.patches.map_or(0, |patches| patches.seed)
    }
}

impl PatchOffsets {
    /// The lower of the two nearest patches along an axis, and the weight of the upper one.
    fn between(&self, axis: usize, at_m: f32) -> (i32, f32) {
        let at = at_m / self.patch_m - 0.5;
        let low = at.floor();
        let past_border_m = (at - low - 0.5) * self.patch_m;
        (low as i32, (past_border_m / self.spacing_m[axis] + 0.5).clamp(0.0, 1.0))
    }

    fn offset_cells(&self, patch: [i32; 2]) -> [u32; 2] {
        offset_cells(self.seed, patch, self.cells)
    }
}

/// Offset (cells along X and Z) of the box in patch `(x, z)`. Integer arithmetic only, so that CPU and GPU agree exactly.
///
/// Its twin on the GPU is `offset_cells` in `inputs/wind.wgsl`.
pub fn offset_cells(seed: u32, [x, z]: [i32; 2], cells: [u32; 2]) -> [u32; 2] {
    let [a, b, _] = hash3([x as u32, z as u32, seed]);
    [(a >> 8) % cells[0], (b >> 8) % cells[1]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::HashSet;

    const PATCHES: PatchOffsets = PatchOffsets { seed: 7, patch_m: 16.0, cells: [8, 4], spacing_m: [2.0, 4.0] };
    const TILES: WindTiles = WindTiles { patches: Some(PATCHES) };

    #[test]
    fn patches_use_every_possible_offset() {
        let moves: HashSet<_> = (0..400).map(|n| PATCHES.offset_cells([n % 20, n / 20])).collect();
        assert_eq!(moves.len(), 8 * 4);
        assert!(moves.iter().all(|[x, z]| *x < 8 && *z < 4));
        let [one, other] = [7, 8].map(|seed| (0..50).map(|x| offset_cells(seed, [x, 3], [8, 4])).collect::<Vec<_>>());
        assert_ne!(one, other, "another seed gives other offsets");
    }

    #[test]
    fn inside_a_patch_there_is_one_tap() {
        let [x, z] = PATCHES.offset_cells([3, -2]);
        let moved = [3.5 * 16.0 + x as f32 * 2.0, -1.5 * 16.0 + z as f32 * 4.0];
        let taps = TILES.taps([3.5 * 16.0, -1.5 * 16.0]);
        let counting: Vec<_> = taps.iter().filter(|tap| tap.weight > 0.0).collect();
        assert_eq!(counting, [&Tap { at_m: moved, weight: 1.0 }]);
        let unshifted = WindTiles { patches: None }.taps([5.0, 6.0]);
        assert_eq!(unshifted[0], Tap { at_m: [5.0, 6.0], weight: 1.0 });
        assert!(unshifted[1..].iter().all(|tap| tap.weight == 0.0));
    }

    /// A smooth wind in the box of 16 m × 16 m.
    fn wind([x_m, z_m]: [f32; 2]) -> [f32; 1] {
        let turn = std::f32::consts::TAU / 16.0;
        [(x_m * turn).sin() + (z_m * turn).cos()]
    }

    proptest! {
        #[test]
        fn weights_sum_to_one_and_the_wind_is_continuous(x_m in -100.0_f32..100.0, z_m in -100.0_f32..100.0) {
            let weights: f32 = TILES.taps([x_m, z_m]).iter().map(|tap| tap.weight).sum();
            prop_assert!((weights - 1.0).abs() < 1e-6);
            // Over a centimetre the wind itself changes by 0.004 along an axis; the transition from one patch to the next, over 2 m, by 0.02.
            let at = |x_m, z_m| TILES.blend([x_m, z_m], wind)[0];
            let step = (at(x_m + 0.01, z_m) - at(x_m, z_m)).abs().max((at(x_m, z_m + 0.01) - at(x_m, z_m)).abs());
            prop_assert!(step < 0.03, "a jump of {step} at {x_m} m, {z_m} m");
        }
    }
}
