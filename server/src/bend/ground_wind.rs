//! Bend of the grass in equilibrium with the wind near the ground.

use prairie_core::bend::wind_lean_rad;
use prairie_core::scene::Scene;
use prairie_core::terrain::KindMap;
use prairie_core::wind::WindTiles;
use std::sync::Arc;

/// Equilibrium lean of the grass in the wind near the ground, on the columns of the wind grid.
#[derive(Clone, Debug)]
pub struct GroundWind {
    tiles: WindTiles,
    nodes: [usize; 2],
    spacing_m: [f32; 2],
    wraps: [bool; 2],
    /// Bend of each kind of grass in a wind of 10 m/s (rad).
    bends_rad: Vec<f32>,
    kinds: Arc<KindMap>,
    /// Lean (rad, as a vector along X and Z) at the centre of each column, for grass that a wind of 10 m/s bends by 1 rad, x fastest.
    leans_rad: Vec<[f32; 2]>,
}

impl GroundWind {
    /// Still air over `scene`, with grass of the kind in `[grass]` everywhere. [`with_kinds`](Self::with_kinds) replaces the kinds.
    pub fn still(scene: &Scene) -> Self {
        let ([nx, _, nz], [dx, _, dz]) = (scene.wind.cells.map(|n| n as usize), scene.wind.spacing_m);
        let [wraps_x, _, wraps_z] = scene.wind.faces.wraps();
        Self {
            tiles: WindTiles::new(scene),
            nodes: [nx, nz],
            spacing_m: [dx, dz],
            wraps: [wraps_x, wraps_z],
            bends_rad: scene.kinds().iter().map(|grass| grass.wind_bend_rad).collect(),
            kinds: Arc::new(KindMap::uniform()),
            leans_rad: vec![[0.0; 2]; nx * nz],
        }
    }

    /// The same wind over grass of other kinds.
    pub fn with_kinds(self, kinds: KindMap) -> Self {
        Self { kinds: Arc::new(kinds), ..self }
    }

    /// Sets the wind (m/s, along X and Z) from all cells of a grid of `layers` layers, x fastest, then y, then z. Only the lowest layer is used.
    pub fn set_wind(&mut self, layers: usize, wind_m_per_s: impl Iterator<Item = [f32; 2]>) {
        let row = self.nodes[0];
        let lowest = wind_m_per_s.enumerate().filter(|(at, _)| (at / row).is_multiple_of(layers));
        for (lean, (_, wind)) in self.leans_rad.iter_mut().zip(lowest) {
            *lean = wind_lean_rad(wind, 1.0);
        }
    }

    /// Lean (rad, as a vector along X and Z) of the grass at a position, bilinear between cells. A grid that does not repeat is extended by its
    /// nearest cells.
    pub fn lean_rad(&self, [x_m, z_m]: [f32; 2]) -> [f32; 2] {
        self.row(z_m)(x_m)
    }

    /// [`lean_rad`](Self::lean_rad) as a function of X at one Z.
    pub fn row(&self, z_m: f32) -> impl Fn(f32) -> [f32; 2] {
        let along = self.box_row(z_m);
        move |x_m| {
            let lean = if self.tiles.by_patch() { self.tiles.blend([x_m, z_m], |[x_m, z_m]| self.box_row(z_m)(x_m)) } else { along(x_m) };
            let bend_rad = self.bends_rad[usize::from(self.kinds.at(x_m, z_m))];
            lean.map(|lean| lean * bend_rad)
        }
    }

    /// Lean within the wind box as a function of X at one Z.
    fn box_row(&self, z_m: f32) -> impl Fn(f32) -> [f32; 2] {
        let (north, south, weight_z) = self.between(1, z_m);
        let [north, south] = [north, south].map(|z| &self.leans_rad[z * self.nodes[0]..][..self.nodes[0]]);
        let mix = |a: [f32; 2], b: [f32; 2], weight: f32| [0, 1].map(|axis| a[axis] + (b[axis] - a[axis]) * weight);
        move |x_m| {
            let (west, east, weight_x) = self.between(0, x_m);
            mix(mix(north[west], north[east], weight_x), mix(south[west], south[east], weight_x), weight_z)
        }
    }

    /// The nodes on either side of a coordinate, and the interpolation weight of the second.
    fn between(&self, axis: usize, at_m: f32) -> (usize, usize, f32) {
        let count = self.nodes[axis] as i64;
        let at = at_m / self.spacing_m[axis] - 0.5;
        let low = at.floor();
        let node = |n: i64| (if self.wraps[axis] { n.rem_euclid(count) } else { n.clamp(0, count - 1) }) as usize;
        (node(low as i64), node(low as i64 + 1), at - low)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use prairie_core::scene::{Grass, Species, WindTiling};
    use prairie_core::terrain::{CoverMap, grey_png};
    use prairie_core::wind::offset_cells;

    #[test]
    fn leans_are_bilinear_and_the_grid_wraps_or_is_extended() {
        let leans_rad = vec![[0.0, 0.0], [0.4, 0.0], [0.0, 0.2], [0.4, 0.2]];
        let tiles = WindTiles::new(&crate::scenes::load("meadow").unwrap().scene);
        let kinds = Arc::new(KindMap::uniform());
        let wind = GroundWind { tiles, nodes: [2, 2], spacing_m: [8.0, 4.0], wraps: [true; 2], bends_rad: vec![1.0], kinds, leans_rad };
        let close = |a: [f32; 2], b: [f32; 2]| (a[0] - b[0]).abs() < 1e-6 && (a[1] - b[1]).abs() < 1e-6;
        assert!(close(wind.lean_rad([4.0, 2.0]), [0.0, 0.0]));
        assert!(close(wind.lean_rad([6.0, 5.0]), [0.1, 0.15]));
        assert!(close(wind.lean_rad([16.0, 2.0]), [0.2, 0.0]));
        let held = GroundWind { wraps: [false, true], ..wind };
        assert!(close(held.lean_rad([16.0, 6.0 + 8.0 * 8.0]), [0.4, 0.2]));
    }

    #[test]
    fn each_kind_of_grass_leans_by_its_own_bend() {
        let mut scene = crate::scenes::load("meadow").unwrap().scene;
        let stiff = Grass { wind_bend_rad: 0.1, ..scene.grass };
        scene.species = vec![Species::new("stiff", 1, &stiff, &scene.plants)];
        // In a world of 256 m the eastern half is stiff.
        let cover = CoverMap::from_png(&grey_png([2; 2], &[255, 1, 255, 1])).unwrap();
        let mut wind = GroundWind::still(&scene).with_kinds(KindMap::new(&scene, &cover));
        let cells: u32 = scene.wind.cells.iter().product();
        wind.set_wind(scene.wind.cells[1] as usize, (0..cells).map(|_| [12.0, 0.0]));
        let [[soft, _], [stiff, _]] = [[60.0, 9.0], [190.0, 9.0]].map(|at_m| wind.lean_rad(at_m));
        assert!((soft - scene.grass.wind_bend_rad).abs() < 1e-6 && (stiff - 0.1).abs() < 1e-6, "{soft} and {stiff}");
    }

    #[test]
    fn a_box_tiled_by_patch_is_offset_in_each_patch() {
        let mut scene = crate::scenes::load("meadow").unwrap().scene;
        (scene.wind.tiling, scene.wind.cells, scene.wind.spacing_m) = (WindTiling::Patch, [8, 8, 8], [2.0; 3]);
        let mut wind = GroundWind::still(&scene);
        wind.set_wind(8, (0..512).map(|at| [(at % 8) as f32, (at / 64) as f32]));
        // The centre of the same cell in every patch.
        let leans: Vec<_> = (0..16).map(|n| wind.lean_rad([n as f32 * 16.0 + 9.0, 25.0])).collect();
        for (n, lean) in leans.iter().enumerate() {
            let [x, z] = offset_cells(scene.seed as u32, [n as i32, 1], [8, 8]);
            let found = wind.leans_rad[(((z + 12) % 8) * 8 + (x + 4) % 8) as usize];
            assert_eq!(*lean, found.map(|lean| lean * scene.grass.wind_bend_rad), "patch {n}");
        }
        assert!(leans.windows(2).any(|pair| pair[0] != pair[1]));
    }
}
