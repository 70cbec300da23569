//! Grids of the variables, and their coordinates.

use prairie_core::bend::TILE;
use prairie_core::grid::PatchLayout;
use prairie_core::scene::Scene;

/// Grid on which a variable is given.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Grid {
    /// Cells of the wind's box: height above the ground, Z, X.
    Air,
    /// Tiles of 8 × 8 cells of grass: Z, X.
    Tiles,
    /// Cells of grass: Z, X.
    Grass,
}

/// Cells of one size along an axis, from 0 on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axis {
    /// Name of the dimension and its coordinate.
    pub name: &'static str,
    /// Number of cells.
    pub count: usize,
    /// Size of a cell (m).
    pub spacing_m: f32,
    /// Meaning of the coordinate.
    pub long_name: &'static str,
    /// The CF axis: X, Y, or Z for the height.
    pub cf_axis: &'static str,
}

impl Axis {
    /// Centres of the cells (m).
    pub fn centers_m(&self) -> Vec<f64> {
        (0..self.count).map(|cell| (cell as f64 + 0.5) * f64::from(self.spacing_m)).collect()
    }
}

impl Grid {
    /// All grids.
    pub const ALL: [Self; 3] = [Self::Air, Self::Tiles, Self::Grass];

    /// Name in the names of files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Air => "air",
            Self::Tiles => "ground",
            Self::Grass => "grass",
        }
    }

    /// Its axes, the one along which values follow each other last: Y, Z, X, or Z, X.
    pub fn axes(self, scene: &Scene) -> Vec<Axis> {
        let layout = PatchLayout::from(&scene.patches);
        let east = |name, count, spacing_m| Axis { name, count, spacing_m, long_name: "distance east of the western edge", cf_axis: "X" };
        let south =
            |name, count, spacing_m| Axis { name, count, spacing_m, long_name: "distance south of the northern edge", cf_axis: "Y" };
        let [across, along] = layout.count.map(|patches| (patches * layout.cells) as usize);
        match self {
            Self::Air => {
                let ([nx, ny, nz], [dx, dy, dz]) = (scene.wind.cells.map(|count| count as usize), scene.wind.spacing_m);
                let up = Axis { name: "y", count: ny, spacing_m: dy, long_name: "height above the ground", cf_axis: "Z" };
                vec![up, south("wind_z", nz, dz), east("wind_x", nx, dx)]
            }
            Self::Tiles => {
                let side_m = TILE as f32 * layout.cell_m;
                vec![south("tile_z", along / TILE, side_m), east("tile_x", across / TILE, side_m)]
            }
            Self::Grass => vec![south("z", along, layout.cell_m), east("x", across, layout.cell_m)],
        }
    }

    /// Number of values of a variable at one time.
    pub fn len(self, scene: &Scene) -> usize {
        self.axes(scene).iter().map(|axis| axis.count).product()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes;

    #[test]
    fn grids_of_the_meadow_cover_its_256_metres() {
        let scene = scenes::load("meadow").unwrap().scene;
        for grid in Grid::ALL {
            for axis in grid.axes(&scene).iter().filter(|axis| axis.cf_axis != "Z") {
                assert_eq!(axis.count as f32 * axis.spacing_m, 256.0, "{}", axis.name);
                let centers_m = axis.centers_m();
                assert!(centers_m[0] == 0.5 * f64::from(axis.spacing_m) && centers_m[axis.count - 1] < 256.0);
            }
        }
        assert_eq!(Grid::ALL.map(|grid| grid.len(&scene)), [32 * 8 * 32, 128 * 128, 1024 * 1024]);
    }
}
