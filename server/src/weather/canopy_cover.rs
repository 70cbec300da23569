//! Canopy cover: fraction of each column of wind cells that upright grass fills.

use prairie_core::bend::Field;
use prairie_core::scene::Scene;
use prairie_core::terrain::{CoverMap, KindMap};

/// Samples of the covering map along each side of a column of wind cells.
const SAMPLES: usize = 8;
/// Distance between sampled cells of the bend field along x and z (cells).
const STRIDE: usize = 4;

/// Canopy cover of each column of wind cells, weighted by height: grass half as tall as the tallest has the weight ½.
pub(super) struct CanopyCover {
    columns: [usize; 2],
    spacing_m: [f32; 2],
    /// Fraction covered by grass, x fastest.
    covered: Vec<f32>,
    /// Sum of the upright fractions of sampled cells, and the number of samples.
    upright: Vec<(f32, f32)>,
}

impl CanopyCover {
    /// Cover of a scene's grass, whose tallest kind has height `tallest_m`.
    pub(super) fn new(scene: &Scene, cover: &CoverMap, tallest_m: f32) -> Self {
        let ([nx, _, nz], [hx, _, hz]) = (scene.wind.cells.map(|n| n as usize), scene.wind.spacing_m);
        let (extent_m, plants, kinds) = (scene.extent_m(), scene.kinds_of_plants(), KindMap::new(scene, cover));
        let covered = (0..nx * nz).map(|column| {
            let [x, z] = [(column % nx) as f32 * hx, (column / nx) as f32 * hz];
            let samples =
                (0..SAMPLES * SAMPLES).map(|n| [(n % SAMPLES) as f32, (n / SAMPLES) as f32].map(|at| (at + 0.5) / SAMPLES as f32));
            // A box smaller than the world repeats. Its cover is that of the first repetition.
            let heights = samples.map(|[u, v]| {
                let [x, z] = [(x + u * hx) % extent_m[0], (z + v * hz) % extent_m[1]];
                let is_grass = scene.is_grass(cover.at(x, z, extent_m));
                if is_grass { plants[usize::from(kinds.at(x, z))].height_m / tallest_m } else { 0.0 }
            });
            heights.sum::<f32>() / (SAMPLES * SAMPLES) as f32
        });
        Self { columns: [nx, nz], spacing_m: [hx, hz], covered: covered.collect(), upright: vec![(0.0, 0.0); nx * nz] }
    }

    /// The cover of each column, x fastest, where no object has bent the grass.
    pub(super) fn at_rest(&self) -> impl Iterator<Item = f32> + '_ {
        self.covered.iter().copied()
    }

    /// The cover of each column, x fastest, reduced where objects have bent the grass. Grass that leans with the wind counts as upright.
    ///
    /// A plant bent by θ has the relative height cos θ, here `1 − θ²/2`, which is 0 from 81° on.
    pub(super) fn fractions(&mut self, field: &Field) -> impl Iterator<Item = f32> + '_ {
        let (layout, cell_m) = (field.layout(), field.layout().cell_m);
        self.upright.fill((0.0, 0.0));
        for patch in field.awake() {
            let corner_m = layout.corner_m(patch.index());
            for j in (STRIDE / 2..patch.side()).step_by(STRIDE) {
                for i in (STRIDE / 2..patch.side()).step_by(STRIDE) {
                    let at_m = [corner_m[0] + i as f32 * cell_m, corner_m[1] + j as f32 * cell_m];
                    let [x, z] = [0, 1].map(|axis| (at_m[axis] / self.spacing_m[axis]) as usize % self.columns[axis]);
                    let theta = patch.bend(i, j).theta;
                    let (sum, count) = &mut self.upright[x + self.columns[0] * z];
                    *sum += (1.0 - 0.5 * theta * theta).max(0.0);
                    *count += 1.0;
                }
            }
        }
        // Cells of sleeping patches are upright.
        let per_column = self.spacing_m[0] * self.spacing_m[1] / (cell_m * STRIDE as f32).powi(2);
        self.covered.iter().zip(&self.upright).map(move |(covered, (sum, count))| {
            let asleep = (per_column - count).max(0.0);
            covered * (sum + asleep) / (count + asleep).max(1.0)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use prairie_core::bend::Kinds;
    use prairie_core::grid::PatchLayout;
    use prairie_core::scene::Species;
    use prairie_core::terrain::grey_png;

    #[test]
    fn cover_is_weighted_by_height() {
        let mut scene = crate::scenes::load("meadow").unwrap().scene;
        (scene.wind.cells, scene.wind.spacing_m, scene.plants.height_m) = ([2, 4, 2], [128.0, 2.0, 128.0], 0.5);
        let tall = Species::new("tall", 1, &scene.grass, &scene.plants);
        scene.species = vec![Species { height_m: 2.0, ..tall }];
        let cover = CoverMap::from_png(&grey_png([2; 2], &[255, 1, 0, 7])).unwrap();
        let mut canopy = CanopyCover::new(&scene, &cover, scene.tallest_m());
        let still = Field::new(PatchLayout::from(&scene.patches), Kinds::one(scene.grass.waves));
        assert_eq!(canopy.fractions(&still).collect::<Vec<_>>(), [0.25, 1.0, 0.0, 0.0]);
    }
}
