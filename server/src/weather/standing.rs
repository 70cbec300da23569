//! How much grass stands in the way of the wind.

use shared::bend::Field;
use shared::scene::Scene;
use shared::terrain::{CoverMap, KindMap};

/// Places along each side of a column of the wind's cells at which the covering map is looked up.
const LOOKS: usize = 8;
/// Cells of the bend field from one that is read to the next, along x and z.
const STRIDE: usize = 4;

/// The share of each column of the wind's cells that grass covers, and stands in; grass that is half as high as the highest counts half.
pub(super) struct Standing {
    columns: [usize; 2],
    spacing_m: [f32; 2],
    /// Share that grass covers, x fastest.
    covered: Vec<f32>,
    /// Share of the covered that stands, and the number of cells it is the mean of.
    upright: Vec<(f32, f32)>,
}

impl Standing {
    /// Of grass whose tallest kind is `tallest_m` high.
    pub(super) fn new(scene: &Scene, cover: &CoverMap, tallest_m: f32) -> Self {
        let ([nx, _, nz], [hx, _, hz]) = (scene.wind.cells.map(|n| n as usize), scene.wind.spacing_m);
        let (extent_m, plants, kinds) = (scene.extent_m(), scene.kinds_of_plants(), KindMap::new(scene, cover));
        let covered = (0..nx * nz).map(|column| {
            let [x, z] = [(column % nx) as f32 * hx, (column / nx) as f32 * hz];
            let looks = (0..LOOKS * LOOKS).map(|n| [(n % LOOKS) as f32, (n / LOOKS) as f32].map(|at| (at + 0.5) / LOOKS as f32));
            // A box smaller than the world stands for all of it: its own part is as good as any other.
            let heights = looks.map(|[u, v]| {
                let [x, z] = [(x + u * hx) % extent_m[0], (z + v * hz) % extent_m[1]];
                let is_grass = scene.is_grass(cover.at(x, z, extent_m));
                if is_grass { plants[usize::from(kinds.at(x, z))].height_m / tallest_m } else { 0.0 }
            });
            heights.sum::<f32>() / (LOOKS * LOOKS) as f32
        });
        Self { columns: [nx, nz], spacing_m: [hx, hz], covered: covered.collect(), upright: vec![(0.0, 0.0); nx * nz] }
    }

    /// The share of each column that stands, x fastest: less where objects have laid the grass over. What leans with the wind counts as standing.
    ///
    /// A plant bent by θ shows the wind cos θ of its height, here `1 − θ²/2`, which is 0 from 81° on.
    pub(super) fn shares(&mut self, field: &Field) -> impl Iterator<Item = f32> + '_ {
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
        // Cells of patches at rest stand.
        let per_column = self.spacing_m[0] * self.spacing_m[1] / (cell_m * STRIDE as f32).powi(2);
        self.covered.iter().zip(&self.upright).map(move |(covered, (sum, count))| {
            let resting = (per_column - count).max(0.0);
            covered * (sum + resting) / (count + resting).max(1.0)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::bend::{Kinds, WaveParams};
    use shared::grid::PatchLayout;
    use shared::scene::Species;
    use shared::terrain::grey_png;

    #[test]
    fn grass_counts_by_its_height() {
        let mut scene = crate::scenes::load("meadow").unwrap().scene;
        (scene.wind.cells, scene.wind.spacing_m, scene.plants.height_m) = ([2, 4, 2], [128.0, 2.0, 128.0], 0.5);
        let tall = Species::new("tall", 1, &scene.grass, &scene.plants);
        scene.species = vec![Species { height_m: 2.0, ..tall }];
        let cover = CoverMap::from_png(&grey_png([2; 2], &[255, 1, 0, 7])).unwrap();
        let mut standing = Standing::new(&scene, &cover, scene.tallest_m());
        let still = Field::new(PatchLayout::from(&scene.patches), Kinds::one(WaveParams::from(&scene.grass)));
        assert_eq!(standing.shares(&still).collect::<Vec<_>>(), [0.25, 1.0, 0.0, 0.0]);
    }
}
