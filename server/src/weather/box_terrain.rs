//! Terrain within the wind's box: solid cells, and conversion between box heights and heights above the ground.

use prairie_core::body::Motion;
use prairie_core::scene::{Scene, WindTerrain};
use prairie_core::terrain::HeightMap;

/// Terrain relative to the floor of the wind's box.
pub(super) struct BoxTerrain {
    /// Height (m) of the ground above the floor of the box at the centre of each column of cells, x fastest. Empty when the floor follows the terrain.
    ground_m: Vec<f32>,
    floor_m: f32,
    cells: [usize; 3],
    layer_m: f32,
}

impl BoxTerrain {
    pub(super) fn new(scene: &Scene, height: &HeightMap) -> Self {
        let wind = &scene.wind;
        let (cells, [hx, layer_m, hz]) = (wind.cells.map(|n| n as usize), wind.spacing_m);
        let [floor_m, _] = height.range_m();
        let ground_m = if wind.terrain == WindTerrain::Obstacle {
            let middle = |n: usize, spacing_m: f32| (n as f32 + 0.5) * spacing_m;
            let columns = (0..cells[2]).flat_map(|k| (0..cells[0]).map(move |i| (i, k)));
            columns.map(|(i, k)| height.height_m(middle(i, hx), middle(k, hz)) - floor_m).collect()
        } else {
            Vec::new()
        };
        Self { ground_m, floor_m, cells, layer_m }
    }

    /// Whether the terrain consists of solid cells.
    pub(super) fn is_solid(&self) -> bool {
        !self.ground_m.is_empty()
    }

    /// Whether a position (m, in the box) is in a solid cell.
    pub(super) fn contains(&self, [x, y, z]: [f32; 3], spacing_m: [f32; 3]) -> bool {
        let [i, k] = [(x, spacing_m[0], self.cells[0]), (z, spacing_m[2], self.cells[2])].map(|(at, h, n)| ((at / h) as usize).min(n - 1));
        y < self.ground_m[i + self.cells[0] * k]
    }

    /// Signed distance (m, negative inside) of a position (m, in the box) from the ground, as if the ground were even around the point below it.
    pub(super) fn distance_m(&self, [x, y, z]: [f64; 3], height: &HeightMap) -> f64 {
        let [x, z] = [x, z].map(|m| m as f32);
        let above_m = y - f64::from(height.height_m(x, z) - self.floor_m);
        let steepness = height.slope(x, z).iter().map(|rise| f64::from(*rise) * f64::from(*rise)).sum::<f64>();
        above_m / (1.0 + steepness).sqrt()
    }

    /// Elevation (m) of height 0 in the box at a position whose ground has elevation `ground_m`.
    pub(super) fn zero_m(&self, ground_m: f32) -> f32 {
        if self.is_solid() { self.floor_m } else { ground_m }
    }

    /// Velocity (m/s) of an object in the box, whose floor rises and falls under the object where it follows the terrain.
    pub(super) fn velocity_in_box(&self, motion: &Motion, height: &HeightMap) -> [f32; 3] {
        let [u, v, w] = motion.velocity_m_per_s;
        if self.is_solid() {
            return [u, v, w];
        }
        let [east, south] = height.slope(motion.to.position_m[0], motion.to.position_m[2]);
        [u, v - (east * u + south * w), w]
    }

    /// Resamples cell values of the box to the centres of layers above the ground; both are x fastest, then y, then z. Above the box the value of the top cell
    /// is used, below the lowest air cell the value of that cell.
    pub(super) fn above_ground<T: Copy>(&self, cells: Vec<T>, blend: impl Fn(T, T, f32) -> T) -> Vec<T> {
        if !self.is_solid() {
            return cells;
        }
        let [nx, ny, nz] = self.cells;
        let mut above = Vec::with_capacity(cells.len());
        for k in 0..nz {
            for j in 0..ny {
                for i in 0..nx {
                    let ground_m = self.ground_m[i + nx * k];
                    let lowest = (ground_m / self.layer_m - 0.5).ceil().max(0.0);
                    let at = (ground_m / self.layer_m + j as f32).max(lowest).min((ny - 1) as f32);
                    let low = at.floor();
                    let value = |layer: usize| cells[i + nx * (layer.min(ny - 1) + ny * k)];
                    above.push(blend(value(low as usize), value(low as usize + 1), at - low));
                }
            }
        }
        above
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_wind_over_a_step_in_the_terrain_is_sampled_above_the_ground() {
        let mut scene = crate::scenes::load("meadow").unwrap().scene;
        scene.wind.cells = [2, 4, 1];
        scene.wind.spacing_m = [10.0, 2.0, 10.0];
        scene.wind.terrain = WindTerrain::Obstacle;
        let height = HeightMap::from_heights(3, 2, [10.0; 2], vec![5.0, 5.0, 11.0, 5.0, 5.0, 11.0]);
        let terrain = BoxTerrain::new(&scene, &height);
        assert_eq!(terrain.ground_m, [0.0, 3.0]);
        assert!(!terrain.contains([5.0, 1.0, 5.0], scene.wind.spacing_m) && terrain.contains([15.0, 1.0, 5.0], scene.wind.spacing_m));
        // Layer j of column i has the value 10·i + j.
        let cells: Vec<f32> = (0..8).map(|n| (n / 2) as f32 + 10.0 * (n % 2) as f32).collect();
        let above = terrain.above_ground(cells, |a, b, t| a + (b - a) * t);
        assert_eq!(above, [0.0, 11.5, 1.0, 12.5, 2.0, 13.0, 3.0, 13.0]);
    }
}
