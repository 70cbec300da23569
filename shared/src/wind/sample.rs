//! Wind between the cells, at eight points abreast.

use wide::{f32x4, f32x8};

/// Most numbers that the cells take, so that a place among them is exact in an f32.
const NUMBERS_LIMIT: usize = 1 << 24;

/// Wind over the ground in the cells of a box that repeats along X and Z, laid out to be read between them; 8 bytes a cell.
///
/// # Layout
/// The parts along X and Z of a cell lie side by side; cells follow along X, then Z, then up. Rows and layers begin anew at their end, so that what lies
/// on both sides of a point along a row is sixteen bytes in one piece, and no neighbour is across a border.
#[derive(Clone, Debug, PartialEq)]
pub struct WindCells {
    count: [usize; 3],
    spacing_m: [f32; 3],
    numbers: Vec<f32>,
}

impl WindCells {
    /// Takes over the wind (m/s; X and Z) of `count` cells along X, up and along Z, that are `spacing_m` apart.
    ///
    /// # Panics
    /// When there is no cell, or more than eight million.
    pub fn new(count: [usize; 3], spacing_m: [f32; 3], wind_m_per_s: impl Fn([usize; 3]) -> [f32; 2]) -> Self {
        let [nx, ny, nz] = count;
        assert!(count.iter().all(|&count| count > 0) && 2 * (nx + 1) * ny * (nz + 1) <= NUMBERS_LIMIT, "{count:?} cells");
        let rows = (0..ny).flat_map(|y| (0..=nz).map(move |z| (y, z % nz)));
        let cells = rows.flat_map(|(y, z)| (0..=nx).map(move |x| [x % nx, y, z]));
        Self { count, spacing_m, numbers: cells.flat_map(wind_m_per_s).collect() }
    }

    /// Wind over the ground (m/s; X and Z) at eight points (X, height, Z from the box's corner; m), trilinear between the centres of cells. Below the
    /// lowest centres and above the highest it is as there. What is no number counts as 0.
    pub fn at_eight(&self, at_m: [f32x8; 3]) -> [f32x8; 2] {
        let [nx, ny, nz] = self.count;
        let (row, layer) = (2 * (nx + 1), 2 * (nx + 1) * (nz + 1));
        let place = |axis: usize| at_m[axis] * f32x8::splat(1.0 / self.spacing_m[axis]) - f32x8::splat(0.5);
        let [x, east] = split(around(place(0), nx), nx);
        let [z, south] = split(around(place(2), nz), nz);
        // No layer is above the only one.
        let (above, layers) = if ny > 1 { (layer, ny - 1) } else { (0, 1) };
        let [y, up] = split(place(1), layers);
        let first = x * f32x8::splat(2.0) + z * f32x8::splat(row as f32) + y * f32x8::splat(layer as f32);
        let (first, up, south) = (first.fast_trunc_int().to_array(), up.to_array(), south.to_array());
        let pairs: [[f32; 4]; 8] = std::array::from_fn(|lane| {
            let (south, up) = (f32x4::splat(south[lane]), f32x4::splat(up[lane]));
            let between = |first: usize| {
                let [from, to] = [self.pair(first), self.pair(first + row)];
                from + (to - from) * south
            };
            let first = first[lane] as usize;
            let [low, high] = [between(first), between(first + above)];
            (low + (high - low) * up).to_array()
        });
        let [west_x, west_z, east_x, east_z] = [0, 1, 2, 3].map(|part| f32x8::from(pairs.map(|pair| pair[part])));
        [west_x + (east_x - west_x) * east, west_z + (east_z - west_z) * east]
    }

    /// Both parts in a cell and in the one east of it.
    #[inline(always)]
    fn pair(&self, first: usize) -> f32x4 {
        bytemuck::pod_read_unaligned(bytemuck::cast_slice(&self.numbers[first..first + 4]))
    }
}

/// Places taken to the first of the boxes that repeat.
#[inline(always)]
fn around(place: f32x8, count: usize) -> f32x8 {
    let count = count as f32;
    let boxes = place * f32x8::splat(1.0 / count);
    let nearer = f32x8::from_i32x8(boxes.fast_trunc_int());
    let first = nearer - (nearer.simd_gt(boxes) & f32x8::ONE);
    place - f32x8::splat(count) * first
}

/// The cell before each place, of so many that have one after them, and the share of the way to that.
#[inline(always)]
fn split(place: f32x8, count: usize) -> [f32x8; 2] {
    let within = f32x8::ZERO.fast_max(place.fast_min(f32x8::splat(count as f32)));
    let cell = f32x8::from_i32x8(within.fast_min(f32x8::splat(count as f32 - 1.0)).fast_trunc_int());
    [cell, within - cell]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hash::hash3;
    use proptest::prelude::*;

    fn speed([x, y, z]: [usize; 3], axis: u32) -> f32 {
        let random = hash3([x as u32 + 100 * y as u32, z as u32, axis])[0];
        20.0 * (random >> 8) as f32 / (1 << 24) as f32 - 10.0
    }

    /// The eight cells about a point, in f64.
    fn trilinear(count: [usize; 3], spacing_m: [f32; 3], at_m: [f32; 3]) -> [f64; 2] {
        let place: [f64; 3] = std::array::from_fn(|axis| f64::from(at_m[axis]) / f64::from(spacing_m[axis]) - 0.5);
        let held = place[1].clamp(0.0, count[1] as f64 - 1.0);
        let place = [place[0], held, place[2]];
        let mut sum = [0.0; 2];
        for corner in 0..8 {
            let side = [corner & 1, corner >> 1 & 1, corner >> 2];
            let weight: f64 = (0..3)
                .map(|axis| if side[axis] == 1 { place[axis] - place[axis].floor() } else { 1.0 - place[axis] + place[axis].floor() })
                .product();
            let cell: [usize; 3] =
                std::array::from_fn(|axis| (place[axis].floor() as i64 + side[axis] as i64).rem_euclid(count[axis] as i64) as usize);
            (0..2).for_each(|axis| sum[axis] += weight * f64::from(speed(cell, axis as u32)));
        }
        sum
    }

    proptest! {
        #[test]
        fn wind_is_trilinear_between_cells_and_goes_round(
            count in [1_usize..9, 1_usize..5, 1_usize..9], spacing_m in [0.5_f32..9.0, 0.5_f32..9.0, 0.5_f32..9.0],
            at in proptest::array::uniform8([-2.0_f32..3.0, -0.5_f32..1.5, -2.0_f32..3.0]),
        ) {
            let cells = WindCells::new(count, spacing_m, |cell| [speed(cell, 0), speed(cell, 1)]);
            let at_m = at.map(|share| [0, 1, 2].map(|axis| share[axis] * spacing_m[axis] * count[axis] as f32));
            let found = cells.at_eight([0, 1, 2].map(|axis| f32x8::from(at_m.map(|at_m| at_m[axis])))).map(|part| part.to_array());
            for lane in 0..8 {
                let wanted = trilinear(count, spacing_m, at_m[lane]);
                for axis in 0..2 {
                    prop_assert!((f64::from(found[axis][lane]) - wanted[axis]).abs() < 1e-3, "{found:?} for {wanted:?} in lane {lane}");
                }
            }
        }

        #[test]
        fn any_number_is_a_place(at in [proptest::num::f32::ANY, proptest::num::f32::ANY, proptest::num::f32::ANY]) {
            let cells = WindCells::new([3, 2, 4], [8.0, 2.0, 8.0], |cell| [speed(cell, 0), speed(cell, 1)]);
            let found = cells.at_eight(at.map(f32x8::splat));
            prop_assert!(found.iter().all(|part| part.to_array()[0].abs() <= 10.001), "{found:?}");
        }
    }
}
