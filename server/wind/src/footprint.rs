//! Smooth weights of a local force.

use super::{Field, Grid, Location, Real};

/// Weights `Π (1 − (d/r)²)²` about a centre: 1 at the centre, 0 beyond the radius along any axis. On periodic axes the nearest image counts.
///
/// A radius below the spacing is widened to it and the weights are reduced in proportion, so that the total momentum is kept.
#[derive(Clone, Debug)]
pub struct Footprint<R> {
    /// Index, weight and offset from the centre (m) along each axis.
    along: [Vec<(usize, R, R)>; 3],
}

impl<R: Real> Footprint<R> {
    /// A footprint without values, with memory for one of any size on `grid`.
    pub fn new(grid: &Grid<R>) -> Self {
        Self { along: grid.cells.map(|cells| Vec::with_capacity(cells + 1)) }
    }

    /// Largest number of values of a component along `axis` under a footprint of a radius (m).
    pub fn largest(grid: &Grid<R>, axis: usize, radius_m: f64) -> usize {
        let spacing_m = grid.spacing_m[axis].wide();
        ((2.0 * radius_m.max(spacing_m) / spacing_m) as usize + 1).min(grid.cells[axis] + 1)
    }

    /// Moves the footprint to `centre_m` on the values of a field at `location`.
    pub fn put(&mut self, grid: &Grid<R>, location: Location, centre_m: [R; 3], radius_m: [R; 3]) {
        let shape = grid.shape(location);
        for axis in 0..3 {
            let spacing = grid.spacing_m[axis];
            let radius = radius_m[axis].max(spacing);
            let height = radius_m[axis].min(spacing) / spacing;
            self.along[axis].clear();
            let offset = grid.offset(location, axis);
            let n = shape[axis] as i64;
            let index_of = |position: R| (position / spacing - offset).wide();
            let (mut first, mut last) = (index_of(centre_m[axis] - radius).ceil() as i64, index_of(centre_m[axis] + radius).floor() as i64);
            if !grid.wraps(axis) {
                (first, last) = (first.max(0), last.min(n - 1));
            } else if last - first >= n {
                first = (index_of(centre_m[axis]) - 0.5 * n as f64).ceil() as i64;
                last = first + n - 1;
            }
            for i in first..=last {
                let distance = (R::of(i as f64) + offset) * spacing - centre_m[axis];
                let reach = distance / radius;
                if reach.abs() < R::one() {
                    let fall = R::one() - reach * reach;
                    self.along[axis].push((i.rem_euclid(n) as usize, height * fall * fall, distance));
                }
            }
        }
    }

    /// Calls `f(value, weight, offset from the centre in m)` for every value under the footprint.
    pub fn for_each(&self, grid: &Grid<R>, field: &mut Field<R>, mut f: impl FnMut(&mut R, R, [R; 3])) {
        let [along_x, along_y, along_z] = &self.along;
        for &(k, z, dz) in along_z {
            for &(j, y, dy) in along_y {
                let row = grid.at([0, j, k]);
                for &(i, x, dx) in along_x {
                    f(&mut field.data[row + i], x * y * z, [dx, dy, dz]);
                }
            }
        }
    }

    /// Calls `f(index, weight, offset from the centre in m)` for every value under the footprint.
    pub fn for_each_index(&self, mut f: impl FnMut([usize; 3], R, [R; 3])) {
        let [along_x, along_y, along_z] = &self.along;
        for &(k, z, dz) in along_z {
            for &(j, y, dy) in along_y {
                along_x.iter().for_each(|&(i, x, dx)| f([i, j, k], x * y * z, [dx, dy, dz]));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Boundary::*;
    use super::*;

    fn total(radius_m: f64, centre_x: f64) -> f64 {
        let grid = Grid { cells: [16, 1, 1], spacing_m: [2.0, 1.0, 1.0], boundary: [[Wrap; 2], [FreeSlip; 2], [Wrap; 2]] };
        let mut field = Field::zeros(&grid, Location::Centre);
        let mut footprint = Footprint::new(&grid);
        footprint.put(&grid, Location::Centre, [centre_x, 0.5, 0.5], [radius_m, 1.0, 1.0]);
        footprint.for_each(&grid, &mut field, |_, weight, _| assert!((0.0..=1.0).contains(&weight)));
        footprint.for_each(&grid, &mut field, |value, weight, _| *value += weight);
        field.values(&grid).sum()
    }

    #[test]
    fn weights_continue_across_periodic_faces() {
        assert!((total(6.0, 1.0) - total(6.0, 15.0)).abs() < 1e-12);
        assert!((total(6.0, 1.0) - total(6.0, 1.0 + 5.0 * 32.0)).abs() < 1e-12);
    }

    #[test]
    fn a_narrow_footprint_keeps_its_momentum() {
        // The integral of (1 − s²)² over −1..1 is 16/15.
        assert!((total(0.5, 15.0) - 0.25 * total(2.0, 15.0)).abs() < 1e-12);
        assert!((total(12.0, 15.0) * 2.0 - 12.0 * 16.0 / 15.0).abs() < 0.05);
    }
}
