//! Precomputed drawing orders (Zhang §5.4) of plants in a grass grid and of grids, so that farther ones are drawn before those that hide them.
//!
//! A grid is n × n cells of `s` metres with a plant in each, anywhere in the central fraction `q` of its cell (0: on the lattice; 1: anywhere).
//! Guarantees of the orders here, for a camera anywhere in its own grid (the tests compare all pairs with a full sort):
//! - Where a plant A is drawn before a plant B of its grid although A is nearer, the line of sight to B, seen from above, passes A at (1 − q)·s or
//!   more; if B is in another grid, at half that or more, reached when the camera is at its grid's border. So plants no wider than that, an angle of
//!   (1 − q)·s over A's distance, never hide each other wrongly.
//! - The exception is two plants in one row of a straight section ([`GridSection::Forward`], [`GridSection::Backward`]; one column of
//!   [`GridSection::Left`], [`GridSection::Right`]): seen at an angle φ from the section's axis the bound is only (1 − q)·s·cos φ − q·s·sin φ, since
//!   which end of a row is nearer depends on the camera's column. A grid two or more away is seen within 45°.
//! - Diagonal sections drawn by the [`simplified`](GridSection::simplified) sequences of Zhang §5.4.2 keep the first bound in full: there one end of
//!   every row is nearer for every camera, and the rows of the four straight sequences run so that it comes last.

use std::cmp::Reverse;

/// Section of a grid relative to the camera's, one of the nine of Zhang Fig. 17, named as in Zhang's Table 1: forward is +Z, right is +X.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GridSection {
    /// The camera's own grid; no precomputed order is valid in it.
    Camera,
    /// (0, +Z).
    Forward,
    /// (0, −Z).
    Backward,
    /// (−X, 0).
    Left,
    /// (+X, 0).
    Right,
    /// (−X, +Z).
    ForwardLeft,
    /// (+X, −Z).
    BackwardRight,
    /// (+X, +Z).
    ForwardRight,
    /// (−X, −Z).
    BackwardLeft,
}

impl GridSection {
    /// The eight sections about the camera's grid, in the order of Table 1.
    pub const AROUND: [Self; 8] = [
        Self::Forward,
        Self::Backward,
        Self::Left,
        Self::Right,
        Self::ForwardLeft,
        Self::BackwardRight,
        Self::ForwardRight,
        Self::BackwardLeft,
    ];

    /// The section of a grid at an offset from the camera's, in grids along X and Z.
    ///
    /// ```
    /// use prairie_core::lod::GridSection;
    /// assert_eq!(GridSection::of([-3, 1]), GridSection::ForwardLeft);
    /// assert_eq!(GridSection::of([0, -2]), GridSection::Backward);
    /// ```
    pub fn of([x, z]: [i32; 2]) -> Self {
        match (x.signum(), z.signum()) {
            (0, 0) => Self::Camera,
            (0, 1) => Self::Forward,
            (0, _) => Self::Backward,
            (-1, 0) => Self::Left,
            (1, 0) => Self::Right,
            (-1, 1) => Self::ForwardLeft,
            (1, -1) => Self::BackwardRight,
            (1, _) => Self::ForwardRight,
            _ => Self::BackwardLeft,
        }
    }

    /// The straight section whose sequence can be used for this one (Zhang §5.4.2); itself if it is straight.
    pub fn simplified(self) -> Self {
        match self {
            Self::ForwardLeft => Self::Forward,
            Self::BackwardRight => Self::Backward,
            Self::ForwardRight => Self::Right,
            Self::BackwardLeft => Self::Left,
            straight => straight,
        }
    }

    /// Cells (column along X, row along Z) of a grid of `side` × `side`, far to near: the sequences of Zhang's Table 1 and Fig. 16. Straight sections
    /// go row by row, diagonal ones diagonal by diagonal; for [`GridSection::Camera`] in lattice order.
    pub fn sequence(self, side: u32) -> Vec<[u32; 2]> {
        let mut cells: Vec<[u32; 2]> = (0..side).flat_map(|row| (0..side).map(move |column| [column, row])).collect();
        cells.sort_by_key(|&[column, row]| {
            let (i, j) = (column as i32, row as i32);
            match self {
                Self::Camera => (0, 0),
                Self::Forward => (-j, i),
                Self::Backward => (j, -i),
                Self::Left => (i, j),
                Self::Right => (-i, -j),
                Self::ForwardLeft => (i - j, i),
                Self::BackwardRight => (j - i, -i),
                Self::ForwardRight => (-(i + j), -i),
                Self::BackwardLeft => (i + j, i),
            }
        });
        cells
    }
}

/// Sorts grids far to near by the squared offset from the camera's grid (Zhang §5.4.2). Along any line of sight that square grows from grid to grid,
/// so this is exact between grids.
pub fn far_to_near(grids: &mut [[i32; 2]], camera: [i32; 2]) {
    grids.sort_by_key(|&[x, z]| Reverse((x - camera[0]).pow(2) + (z - camera[1]).pow(2)));
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Largest number of cells along the side of a grid in the tests.
    const SIDE_LIMIT: u32 = 5;

    /// A plant: its grid, cell and position, in cells from the north-west corner of the camera's grid.
    #[derive(Clone, Copy, Debug)]
    struct Plant {
        grid: [i32; 2],
        cell: [u32; 2],
        at: [f64; 2],
    }

    /// A plant in each cell of a grid, at a random offset from the centre within the fraction `jitter`.
    fn plants(grid: [i32; 2], sequence: &[[u32; 2]], side: u32, jitter: f64, lots: &[f64]) -> Vec<Plant> {
        let stand = |&cell: &[u32; 2]| {
            let lot = (cell[0] + side * cell[1]) as usize * 2 + (grid[0] * 7 + grid[1] * 13).unsigned_abs() as usize;
            let at = [0, 1].map(|axis| {
                f64::from(grid[axis]) * f64::from(side) + f64::from(cell[axis]) + 0.5 + jitter * (lots[(lot + axis) % lots.len()] - 0.5)
            });
            Plant { grid, cell, at }
        };
        sequence.iter().map(stand).collect()
    }

    fn from_eye(plant: &Plant, eye: [f64; 2]) -> [f64; 2] {
        [plant.at[0] - eye[0], plant.at[1] - eye[1]]
    }

    /// Pairs of a plant and a farther one that is drawn later, each with the distance (cells) of the plant from the line of sight to the farther one; pairs
    /// in other directions are omitted.
    fn mistakes(drawn: &[Plant], eye: [f64; 2]) -> Vec<(Plant, Plant, f64)> {
        let mut found = Vec::new();
        for (at, near) in drawn.iter().enumerate() {
            let a = from_eye(near, eye);
            for far in &drawn[at + 1..] {
                let b = from_eye(far, eye);
                let length = b[0].hypot(b[1]);
                if length > a[0].hypot(a[1]) && a[0] * b[0] + a[1] * b[1] > 0.0 {
                    found.push((*near, *far, (a[0] * b[1] - a[1] * b[0]).abs() / length));
                }
            }
        }
        found
    }

    /// Smallest distance at which the line of sight to the farther passes (cells): less between grids, and in a row of a straight section.
    fn bound(near: &Plant, far: &Plant, eye: [f64; 2], jitter: f64) -> f64 {
        if near.grid != far.grid {
            return 0.5 * (1.0 - jitter);
        }
        let axis = match GridSection::of(near.grid) {
            GridSection::Forward | GridSection::Backward => 1,
            GridSection::Left | GridSection::Right => 0,
            _ => return 1.0 - jitter,
        };
        if near.cell[axis] != far.cell[axis] {
            return 1.0 - jitter;
        }
        let b = from_eye(far, eye);
        let length = b[0].hypot(b[1]);
        (1.0 - jitter) * b[axis].abs() / length - jitter * b[1 - axis].abs() / length
    }

    fn lots() -> impl Strategy<Value = Vec<f64>> {
        proptest::collection::vec(0.0..1.0, (2 * SIDE_LIMIT * SIDE_LIMIT + 1) as usize)
    }

    proptest! {
        #[test]
        fn the_order_made_for_a_section_is_exact_from_every_place_of_the_cameras_grid(
            side in 2..=SIDE_LIMIT, eye in [0.0..1.0, 0.0..1.0], offset in [-3..=3, -3..=3], jitter in 0.0..1.0, lots in lots(),
        ) {
            let eye = eye.map(|fraction: f64| fraction * f64::from(side));
            let section = GridSection::of(offset);
            prop_assume!(section != GridSection::Camera);
            for sequence in [section.sequence(side), section.simplified().sequence(side)] {
                for (near, far, passes) in mistakes(&plants(offset, &sequence, side, jitter, &lots), eye) {
                    prop_assert!(passes >= bound(&near, &far, eye, jitter) - 1e-9, "{near:?} before {far:?}: {passes}");
                }
            }
        }

        #[test]
        fn nine_sections_and_grids_far_to_near_are_exact_together(
            side in 2_u32..=3, eye in [0.0..1.0, 0.0..1.0], jitter in 0.0..1.0, simplified: bool, lots in lots(),
        ) {
            let eye = eye.map(|fraction: f64| fraction * f64::from(side));
            let mut grids: Vec<[i32; 2]> = (-2..=2).flat_map(|z| (-2..=2).map(move |x| [x, z])).collect();
            far_to_near(&mut grids, [0, 0]);
            let mut drawn = Vec::new();
            for grid in grids {
                let section = if simplified { GridSection::of(grid).simplified() } else { GridSection::of(grid) };
                let mut own = plants(grid, &section.sequence(side), side, jitter, &lots);
                if section == GridSection::Camera {
                    let distance = |plant: &Plant| from_eye(plant, eye).map(|v| v * v).iter().sum::<f64>();
                    own.sort_by(|a, b| distance(b).total_cmp(&distance(a)));
                }
                drawn.extend(own);
            }
            prop_assert_eq!(drawn.last().map(|plant| plant.grid), Some([0, 0]));
            for (near, far, passes) in mistakes(&drawn, eye) {
                prop_assert!(passes >= bound(&near, &far, eye, jitter) - 1e-9, "{near:?} before {far:?}: {passes}");
            }
        }

        #[test]
        fn every_sequence_draws_each_cell_once(side in 1_u32..20) {
            for section in GridSection::AROUND {
                let mut cells = section.sequence(side);
                cells.sort_unstable();
                cells.dedup();
                prop_assert_eq!(cells.len() as u32, side * side);
            }
        }
    }

    #[test]
    fn the_sequences_of_figure_16_begin_far_and_end_near() {
        let ends = GridSection::AROUND.map(|section| {
            let cells = section.sequence(3);
            (cells[0], cells[8])
        });
        assert_eq!(ends[4], ([0, 2], [2, 0]));
        assert_eq!(ends[5], ([2, 0], [0, 2]));
        assert_eq!(ends[6], ([2, 2], [0, 0]));
        assert_eq!(ends[7], ([0, 0], [2, 2]));
        assert_eq!(ends.map(|(first, last)| (first[1], last[1]))[..2], [(2, 0), (0, 2)]);
        assert_eq!(ends.map(|(first, last)| (first[0], last[0]))[2..4], [(0, 2), (2, 0)]);
    }

    #[test]
    fn a_sequence_of_the_wrong_section_is_caught() {
        let grid = [0, 1];
        let drawn = plants(grid, &GridSection::Backward.sequence(4), 4, 0.0, &[0.5]);
        assert!(mistakes(&drawn, [2.0, 2.0]).iter().any(|(near, far, passes)| *passes < bound(near, far, [2.0, 2.0], 0.0) - 1e-9));
    }

    #[test]
    fn the_grid_of_figure_13_is_37_away() {
        let mut grids = vec![[7, 8], [1, 9], [3, 3], [9, 8]];
        far_to_near(&mut grids, [7, 8]);
        assert_eq!(grids, [[3, 3], [1, 9], [9, 8], [7, 8]]);
    }
}
