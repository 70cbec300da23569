//! Wind between the cells, at one point or at many near each other.

use multiversion::multiversion;

/// Cells from the box's corner from which on an f32 has no share of a cell left.
const FAR_CELLS: f32 = (1 << 23) as f32;

/// Wind over the ground in the cells of a box that repeats along X and Z; 8 bytes a cell.
#[derive(Clone, Debug, PartialEq)]
pub struct WindCells {
    count: [usize; 3],
    cells_per_m: [f32; 3],
    /// The parts along X and Z; cells follow along X, then Z, then up.
    cells: Vec<[f32; 2]>,
}

impl WindCells {
    /// Takes over the wind (m/s; X and Z) of `count` cells along X, up and along Z, that are `spacing_m` apart.
    ///
    /// # Panics
    /// When there is no cell.
    pub fn new(count: [usize; 3], spacing_m: [f32; 3], wind_m_per_s: impl Fn([usize; 3]) -> [f32; 2]) -> Self {
        assert!(count.iter().all(|&count| count > 0), "{count:?} cells");
        let [nx, ny, nz] = count;
        let rows = (0..ny).flat_map(|y| (0..nz).map(move |z| (y, z)));
        let cells = rows.flat_map(|(y, z)| (0..nx).map(move |x| [x, y, z]));
        Self { count, cells_per_m: spacing_m.map(f32::recip), cells: cells.map(wind_m_per_s).collect() }
    }

    /// Wind over the ground (m/s; X and Z) at a point (X, height, Z from the box's corner; m), trilinear between the centres of cells. Below the lowest
    /// centres and above the highest it is as there. What is no number, or eight million cells away along X or Z, counts as 0.
    pub fn at(&self, at_m: [f32; 3]) -> [f32; 2] {
        let (columns, x) = self.before_and_after(at_m, 0);
        let (rows, z) = self.before_and_after(at_m, 2);
        let highest = self.count[1] - 1;
        let height = (at_m[1] * self.cells_per_m[1] - 0.5).max(0.0).min(highest as f32);
        let low = height as usize;
        let row = |y: usize, z: usize| between(self.cell([columns[0], y, z]), self.cell([columns[1], y, z]), x);
        let lower = between(row(low, rows[0]), row(low, rows[1]), z);
        if low as f32 == height {
            return lower;
        }
        between(lower, between(row(low + 1, rows[0]), row(low + 1, rows[1]), z), height - low as f32)
    }

    /// The same at M times N points. Five to fifteen times as fast for those that are within a cell's length along X and Z of the centre of the cell that `near_m` is
    /// in, and between the layers of centres about it: whatever grows in one cell. There the wind differs by rounding.
    pub fn at_all<const N: usize, const M: usize>(
        &self,
        near_m: [f32; 3],
        at_m: &[[[f32; N]; 3]; M],
        wind_m_per_s: &mut [[[f32; N]; 2]; M],
    ) {
        let window = self.about(near_m);
        for (at_m, wind_m_per_s) in at_m.iter().zip(wind_m_per_s) {
            if sample(&window, at_m, wind_m_per_s) {
                continue;
            }
            for n in 0..N {
                let point_m = [at_m[0][n], at_m[1][n], at_m[2][n]];
                if !window.holds(window.place(point_m)) {
                    [wind_m_per_s[0][n], wind_m_per_s[1][n]] = self.at(point_m);
                }
            }
        }
    }

    /// The window about the cell that a point is in, up from the layer of centres below the point.
    fn about(&self, at_m: [f32; 3]) -> Window {
        let highest = self.count[1] - 1;
        let [x, z] = [0, 2].map(|axis| floor(self.place(at_m, axis)));
        let low = ((at_m[1] * self.cells_per_m[1] - 0.5).max(0.0) as usize).min(highest.saturating_sub(1));
        let [xs, zs] = [(x, 0), (z, 2)].map(|(cell, axis)| {
            let before = self.repeated(cell - 1, axis);
            let middle = self.after(before, axis);
            [before, middle, self.after(middle, axis)]
        });
        let mut layers = [[Bends::default(); 2]; 2];
        for (layer, y) in layers.iter_mut().zip([low, (low + 1).min(highest)]) {
            for (row, z) in zs.into_iter().enumerate() {
                for (column, x) in xs.into_iter().enumerate() {
                    [layer[0][row][column], layer[1][row][column]] = self.cell([x, y, z]);
                }
            }
            layer.iter_mut().for_each(bend);
        }
        let [lower, mut rise] = layers;
        for (rise, lower) in rise.as_flattened_mut().iter_mut().zip(lower.as_flattened()) {
            (0..3).for_each(|i| rise[i] -= lower[i]);
        }
        let low = low as f32;
        let centre = [x as f32 + 0.5, low + 0.5, z as f32 + 0.5];
        Window { cells_per_m: self.cells_per_m, centre, heights: [-low, highest as f32 - low], lower, rise }
    }

    /// Place along X or Z in cells from the box's corner.
    fn place(&self, at_m: [f32; 3], axis: usize) -> f32 {
        let place = at_m[axis] * self.cells_per_m[axis];
        if place.abs() < FAR_CELLS { place } else { 0.0 }
    }

    fn cell(&self, [x, y, z]: [usize; 3]) -> [f32; 2] {
        self.cells[x + self.count[0] * (z + self.count[2] * y)]
    }

    /// Cells along X or Z whose centres a point lies between, and the share of the way from one to the other.
    fn before_and_after(&self, at_m: [f32; 3], axis: usize) -> ([usize; 2], f32) {
        let place = self.place(at_m, axis) - 0.5;
        let floor = floor(place);
        let before = self.repeated(floor, axis);
        ([before, self.after(before, axis)], place - floor as f32)
    }

    fn repeated(&self, cell: i32, axis: usize) -> usize {
        let count = self.count[axis] as i32;
        // Divisions take long, and most cells are those of the box itself.
        (if (0..count).contains(&cell) { cell } else { cell.rem_euclid(count) }) as usize
    }

    fn after(&self, cell: usize, axis: usize) -> usize {
        if cell + 1 < self.count[axis] { cell + 1 } else { 0 }
    }
}

/// As `f32::floor`, without a call.
fn floor(place: f32) -> i32 {
    let nearer_zero = place as i32;
    nearer_zero - i32::from(nearer_zero as f32 > place)
}

fn between(from: [f32; 2], to: [f32; 2], share: f32) -> [f32; 2] {
    [from[0] + (to[0] - from[0]) * share, from[1] + (to[1] - from[1]) * share]
}

/// Bilinear between 3 × 3 centres, as a line with a bend: `[m, f, n]` stands for `m + f·max(d, 0) + n·min(d, 0)` at a distance d from the middle. Each of
/// the three along Z is one along X.
type Bends = [[f32; 3]; 3];

/// From values before, at and after the middle, rows along X.
fn bend(values: &mut Bends) {
    for row in &mut *values {
        let [before, middle, after] = *row;
        *row = [middle, after - middle, middle - before];
    }
    let [before, middle, after] = *values;
    for i in 0..3 {
        (values[0][i], values[1][i], values[2][i]) = (middle[i], after[i] - middle[i], middle[i] - before[i]);
    }
}

/// Wind between the centres of a cell and those around it, from one layer to the next.
#[derive(Clone, Copy)]
struct Window {
    cells_per_m: [f32; 3],
    /// Of the cell in the middle of the lower layer (cells).
    centre: [f32; 3],
    /// Lowest and highest centres over that (cells).
    heights: [f32; 2],
    /// Either part in the lower layer.
    lower: [Bends; 2],
    /// And how much more it is in the upper one.
    rise: [Bends; 2],
}

impl Window {
    /// Cells from the centre.
    #[inline(always)]
    fn place(&self, at_m: [f32; 3]) -> [f32; 3] {
        let away = |axis: usize| at_m[axis] * self.cells_per_m[axis] - self.centre[axis];
        [away(0), away(1).max(self.heights[0]).min(self.heights[1]), away(2)]
    }

    #[inline(always)]
    fn holds(&self, [x, y, z]: [f32; 3]) -> bool {
        (x.abs() <= 1.0) & (z.abs() <= 1.0) & (0.0..=1.0).contains(&y)
    }
}

/// Finds the wind at all points that the window holds; whether these are all.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
fn sample<const N: usize>(window: &Window, at_m: &[[f32; N]; 3], wind_m_per_s: &mut [[f32; N]; 2]) -> bool {
    let window = *window;
    let mut beyond = 0;
    for n in 0..N {
        let [x, y, z] = window.place([at_m[0][n], at_m[1][n], at_m[2][n]]);
        let (x_sides, z_sides) = ([x.max(0.0), x.min(0.0)], [z.max(0.0), z.min(0.0)]);
        for (part, wind_m_per_s) in wind_m_per_s.iter_mut().enumerate() {
            wind_m_per_s[n] = bilinear(&window.lower[part], x_sides, z_sides) + bilinear(&window.rise[part], x_sides, z_sides) * y;
        }
        beyond |= u32::from(!window.holds([x, y, z]));
    }
    beyond == 0
}

#[inline(always)]
fn bilinear([middle, after, before]: &Bends, x_sides: [f32; 2], z_sides: [f32; 2]) -> f32 {
    bent(&[bent(middle, x_sides), bent(after, x_sides), bent(before, x_sides)], z_sides)
}

#[inline(always)]
fn bent([middle, after, before]: &[f32; 3], [ahead, behind]: [f32; 2]) -> f32 {
    middle + after * ahead + before * behind
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hash::hash3;
    use proptest::array::uniform3;
    use proptest::prelude::*;

    fn speed([x, y, z]: [usize; 3], axis: u32) -> f32 {
        let random = hash3([x as u32 + 100 * y as u32, z as u32, axis])[0];
        20.0 * (random >> 8) as f32 / (1 << 24) as f32 - 10.0
    }

    fn gusts(count: [usize; 3], spacing_m: [f32; 3]) -> WindCells {
        WindCells::new(count, spacing_m, |cell| [speed(cell, 0), speed(cell, 1)])
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

    /// Points as they are read at once.
    fn together(cells: &WindCells, near_m: [f32; 3], points_m: [[[f32; 3]; 7]; 2]) -> [[[f32; 2]; 7]; 2] {
        let mut winds = [[[f32::NAN; 7]; 2]; 2];
        cells.at_all(near_m, &points_m.map(|points_m| [0, 1, 2].map(|axis| points_m.map(|point_m| point_m[axis]))), &mut winds);
        winds.map(|[x, z]| std::array::from_fn(|n| [x[n], z[n]]))
    }

    fn count() -> impl Strategy<Value = [usize; 3]> {
        (1_usize..9, 1_usize..5, 1_usize..9).prop_map(|(x, y, z)| [x, y, z])
    }

    proptest! {
        #[test]
        fn wind_is_trilinear_between_cells_and_goes_round(
            count in count(), spacing_m in uniform3(0.5_f32..9.0), at in [-2.0_f32..3.0, -0.5_f32..1.5, -2.0_f32..3.0],
        ) {
            let at_m = [0, 1, 2].map(|axis| at[axis] * spacing_m[axis] * count[axis] as f32);
            let (found, wanted) = (gusts(count, spacing_m).at(at_m), trilinear(count, spacing_m, at_m));
            prop_assert!((0..2).all(|axis| (f64::from(found[axis]) - wanted[axis]).abs() < 1e-3), "{found:?} instead of {wanted:?}");
        }

        #[test]
        fn points_are_read_together_as_they_are_alone(
            count in count(), spacing_m in uniform3(0.5_f32..9.0), near in [-20.0_f32..20.0, -1.0_f32..6.0, -20.0_f32..20.0],
            offsets in proptest::array::uniform2(proptest::array::uniform7(uniform3(-1.0_f32..1.0))), reach in 0.1_f32..3.0,
        ) {
            let cells = gusts(count, spacing_m);
            let place_m = |offset: [f32; 3]| [0, 1, 2].map(|axis| (near[axis] + reach * offset[axis]) * spacing_m[axis]);
            let points_m = offsets.map(|offsets| offsets.map(place_m));
            let (found, wanted) = (together(&cells, place_m([0.0; 3]), points_m), points_m.map(|points_m| points_m.map(|at_m| cells.at(at_m))));
            let differences = found.as_flattened().as_flattened().iter().zip(wanted.as_flattened().as_flattened()).map(|(a, b)| (a - b).abs());
            let most = differences.fold(0.0, |most: f32, one| if one <= most { most } else { one });
            prop_assert!(most < 1e-4, "{most} m/s: {found:?} instead of {wanted:?}");
        }

        #[test]
        fn a_window_holds_what_grows_in_its_cell(
            count in count(), cell in [-9_i32..9, -9_i32..9], near in uniform3(0.01_f32..0.99), root in [0.0_f32..1.0, 0.0_f32..1.0],
            lean in [-0.49_f32..0.49, 0.5_f32..1.5, -0.49_f32..0.49],
        ) {
            let place_m = |[x, y, z]: [f32; 3]| [8.0 * (cell[0] as f32 + x), 2.0 * y, 8.0 * (cell[1] as f32 + z)];
            let window = gusts(count, [8.0, 2.0, 8.0]).about(place_m(near));
            let point_m = place_m([root[0] + lean[0], lean[1], root[1] + lean[2]]);
            prop_assert!(window.holds(window.place(point_m)), "{point_m:?}");
        }

        #[test]
        fn any_number_is_a_place(any in uniform3(proptest::num::f32::ANY), axis in 0_usize..3) {
            let cells = gusts([3, 2, 4], [8.0, 2.0, 8.0]);
            let alone = cells.at(any);
            prop_assert!(alone.iter().all(|part| part.abs() <= 10.001), "{alone:?}");
            for none in [f32::NAN, f32::INFINITY, 1e12] {
                let [mut at_m, mut zero] = [[5.0, 1.5, 7.0]; 2];
                (at_m[axis], zero[axis]) = (none, if axis == 1 && none > 0.0 { 4.0 } else { 0.0 });
                prop_assert_eq!(cells.at(at_m), cells.at(zero));
                for near_m in [[5.0, 1.5, 7.0], at_m, any] {
                    let found = together(&cells, near_m, [[at_m; 7], [any; 7]]).map(|winds| winds[3]);
                    let wanted = [cells.at(at_m), alone];
                    prop_assert!((0..2).all(|n| (0..2).all(|part| (found[n][part] - wanted[n][part]).abs() < 1e-4)), "{found:?}, {wanted:?}");
                }
            }
        }
    }
}
