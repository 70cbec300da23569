//! Trilinear sampling of values at the centres of the wind's cells.

use crate::scene::Wind;

/// Layout of values at cell centres in the wind's box: cell (i, j, k) has value number `i + nx·(j + ny·k)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellGrid {
    /// Number of cells along X, Y and Z.
    pub cells: [usize; 3],
    /// Size of a cell along X, Y and Z (m).
    pub spacing_m: [f32; 3],
    /// Whether the box is periodic along X, Y and Z.
    pub periodic: [bool; 3],
}

impl From<&Wind> for CellGrid {
    fn from(wind: &Wind) -> Self {
        Self { cells: wind.cells.map(|n| n as usize), spacing_m: wind.spacing_m, periodic: wind.faces.wraps() }
    }
}

impl CellGrid {
    /// Interpolates linearly along X, Y and Z between the eight cell centres around a point (m from the box's lower corner). `value` returns the value of a
    /// cell by its number.
    ///
    /// Periodic axes repeat; along the others, values are constant beyond the outermost centres. Exact for values linear along each axis, second order
    /// otherwise.
    pub fn trilinear<const N: usize>(&self, at_m: [f32; 3], value: impl Fn(usize) -> [f32; N]) -> [f32; N] {
        let [([west, east], u), ([down, up], v), ([north, south], w)] = [0, 1, 2].map(|axis| self.neighbours(axis, at_m[axis]));
        let [nx, ny, _] = self.cells;
        let along = |j: usize, k: usize| {
            let row = nx * (j + ny * k);
            lerp(value(row + west), value(row + east), u)
        };
        let across = |k: usize| lerp(along(down, k), along(up, k), v);
        lerp(across(north), across(south), w)
    }

    /// Cells whose centres are below and above a coordinate (m), and the fraction of the distance from the first to the second.
    fn neighbours(&self, axis: usize, at_m: f32) -> ([usize; 2], f32) {
        let at = at_m / self.spacing_m[axis] - 0.5;
        let (low, count) = (at.floor(), self.cells[axis] as i64);
        let cell = |n: i64| (if self.periodic[axis] { n.rem_euclid(count) } else { n.clamp(0, count - 1) }) as usize;
        ([cell(low as i64), cell((low as i64).saturating_add(1))], at - low)
    }
}

/// `from` at `t = 0`, `to` at `t = 1`, both to the bit.
fn lerp<const N: usize>(from: [f32; N], to: [f32; N], t: f32) -> [f32; N] {
    std::array::from_fn(|n| from[n] * (1.0 - t) + to[n] * t)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hash::hash3;
    use proptest::array::uniform3;
    use proptest::prelude::*;

    fn speed(cell: usize, component: u32) -> f32 {
        let random = hash3([cell as u32, 7, component])[0];
        20.0 * (random >> 8) as f32 / (1 << 24) as f32 - 10.0
    }

    /// The weighted mean of the eight cells around a point, in f64.
    fn reference(grid: &CellGrid, at_m: [f32; 3]) -> [f64; 2] {
        let at: [f64; 3] = std::array::from_fn(|axis| f64::from(at_m[axis]) / f64::from(grid.spacing_m[axis]) - 0.5);
        let mut sum = [0.0; 2];
        for corner in 0..8 {
            let (mut cell, mut weight) = ([0; 3], 1.0);
            for axis in 0..3 {
                let (upper, count) = (corner >> axis & 1, grid.cells[axis] as i64);
                let fraction = at[axis] - at[axis].floor();
                weight *= if upper == 1 { fraction } else { 1.0 - fraction };
                let n = at[axis].floor() as i64 + upper;
                cell[axis] = if grid.periodic[axis] { n.rem_euclid(count) } else { n.clamp(0, count - 1) } as usize;
            }
            let number = cell[0] + grid.cells[0] * (cell[1] + grid.cells[1] * cell[2]);
            (0..2).for_each(|component| sum[component] += weight * f64::from(speed(number, component as u32)));
        }
        sum
    }

    fn grids() -> impl Strategy<Value = CellGrid> {
        let cells = (1_usize..9, 1_usize..5, 1_usize..9).prop_map(|(x, y, z)| [x, y, z]);
        (cells, uniform3(0.5_f32..9.0), uniform3(any::<bool>())).prop_map(|(cells, spacing_m, periodic)| CellGrid {
            cells,
            spacing_m,
            periodic,
        })
    }

    proptest! {
        #[test]
        fn sampling_is_the_weighted_mean_of_eight_cells(grid in grids(), at in uniform3(-2.0_f32..3.0)) {
            let at_m = std::array::from_fn(|axis| at[axis] * grid.spacing_m[axis] * grid.cells[axis] as f32);
            let found = grid.trilinear(at_m, |cell| [speed(cell, 0), speed(cell, 1)]);
            let wanted = reference(&grid, at_m);
            prop_assert!((0..2).all(|n| (f64::from(found[n]) - wanted[n]).abs() < 1e-3), "{found:?} instead of {wanted:?}");
        }

        #[test]
        fn any_number_is_a_valid_position(grid in grids(), at_m in uniform3(proptest::num::f32::ANY)) {
            let [found] = grid.trilinear(at_m, |cell| [speed(cell, 0)]);
            prop_assert!(found.is_nan() || found.abs() <= 10.001, "{found}");
        }
    }

    #[test]
    fn centres_have_the_bits_of_their_cells() {
        let grid = CellGrid { cells: [4, 2, 3], spacing_m: [8.0, 2.0, 4.0], periodic: [true, false, true] };
        for (i, j, k) in (0..24).map(|n| (n % 4, n / 4 % 2, n / 8)) {
            let at_m = [8.0 * (i as f32 + 0.5), 2.0 * (j as f32 + 0.5), 4.0 * (k as f32 + 0.5)];
            assert_eq!(grid.trilinear(at_m, |cell| [speed(cell, 0)]), [speed(i + 4 * (j + 2 * k), 0)]);
        }
    }
}
