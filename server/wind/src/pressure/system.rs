//! The Poisson equation of a box: its cells, edges and solids.

use std::f64::consts::PI;

use super::coloured::{Coloured, Layout, at, set};
use super::operator::Operator;
use super::regions::Regions;
use crate::separable::Edge;

/// The discrete equation `∇²p = f` at the centres of a box of cells (7-point Laplacian of the staggered grid: Harlow & Welch, Phys. Fluids 8, 1965).
///
/// In a region of air that touches no [`Edge::Dirichlet`] the pressure is determined only up to a constant, and an `f` with a nonzero mean violates
/// the compatibility condition: there the mean of `f` is dropped and the pressure has mean 0. In solid cells the pressure is 0.
#[derive(Clone, Debug)]
pub struct System {
    pub(super) operator: Operator<f64>,
    /// Couplings to the open edges of x, y and z.
    pub(super) outlets: [Coloured<f64>; 3],
    pub(super) regions: Regions,
    solid: Option<Vec<bool>>,
    pub(super) spacing_m: [f64; 3],
    pub(super) slowest: f64,
}

/// Error in the description of a [`System`].
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SystemError {
    /// An axis has no cells, or there are too many cells in all.
    #[error("cells are {0:?}; allowed: at least 1 along each axis, at most 2²⁷ in all")]
    Cells([usize; 3]),
    /// A spacing is out of range.
    #[error("spacing is {0:?} m; allowed: 1e-6 to 1e6")]
    Spacing([f64; 3]),
    /// The solid mask has the wrong length.
    #[error("the solid mask has {found} values; allowed: {expected}, one for each cell")]
    Solid {
        /// Number of cells in the box.
        expected: usize,
        /// Number of values in the mask.
        found: usize,
    },
}

impl System {
    /// A box of `cells` (x fastest, then y, then z), each `spacing_m` (m) wide. `edges` has the lower and upper edge of each axis, `None` for a
    /// periodic one. Faces of cells where `solid` is true are closed.
    ///
    /// # Errors
    /// An axis without cells, a spacing outside 1e-6 to 1e6 m, or a mask of the wrong length.
    pub fn new(cells: [usize; 3], spacing_m: [f64; 3], edges: [Option<[Edge; 2]>; 3], solid: Option<&[bool]>) -> Result<Self, SystemError> {
        let len = cells.iter().try_fold(1usize, |len, &n| len.checked_mul(n)).filter(|len| (1..=1 << 27).contains(len));
        let len = len.ok_or(SystemError::Cells(cells))?;
        if !spacing_m.iter().all(|h| (1e-6..=1e6).contains(h)) {
            return Err(SystemError::Spacing(spacing_m));
        }
        if let Some(mask) = solid.filter(|mask| mask.len() != len) {
            return Err(SystemError::Solid { expected: len, found: mask.len() });
        }

        let layout = Layout::new(cells, edges.map(|edge| edge.is_none()));
        let natural = |[x, y, z]: [usize; 3]| x - 1 + cells[0] * (y - 1 + cells[1] * (z - 1));
        let air = |cell: [usize; 3]| solid.is_none_or(|mask| !mask[natural(cell)]);
        let mut lower = [layout.zeros(), layout.zeros(), layout.zeros()];
        for cell in layout.coordinates().filter(|&cell| air(cell)) {
            let l = layout.linear(cell);
            for axis in 0..3 {
                let coupling = 1.0 / (spacing_m[axis] * spacing_m[axis]);
                // A cell that is its own neighbour feels no gradient.
                if below(cell, axis, cells, edges[axis].is_none()).is_some_and(|below| below != cell && air(below)) {
                    set(&mut lower[axis], l, coupling);
                }
            }
        }
        let outlets = outlets(&layout, spacing_m, edges, air);
        let operator = Operator::new(layout, lower, &outlets);

        let coordinates = |i: usize| [1 + i % cells[0], 1 + i / cells[0] % cells[1], 1 + i / cells[0] / cells[1]];
        let neighbours = |i: usize| {
            let (operator, l) = (&operator, layout.linear(coordinates(i)));
            (0..6).filter_map(move |face| {
                let (axis, up) = (face / 2, face % 2 == 1);
                let mut cell = coordinates(i);
                let open = at(&operator.lower[axis], if up { l + layout.stride[axis] } else { l }) > 0.0;
                let n = cells[axis];
                cell[axis] = if up { cell[axis] % n + 1 } else { (cell[axis] + n - 2) % n + 1 };
                open.then(|| natural(cell))
            })
        };
        let regions = Regions::label(
            len,
            neighbours,
            |i| outlets.iter().any(|outlet| at(outlet, layout.linear(coordinates(i))) > 0.0),
            |i| air(coordinates(i)),
        );
        let slowest = slowest_mode(cells, spacing_m, edges);
        Ok(Self { operator, outlets, regions, solid: solid.map(<[bool]>::to_vec), spacing_m, slowest })
    }

    /// Number of cells along x, y and z.
    pub fn cells(&self) -> [usize; 3] {
        self.operator.layout.cells
    }

    /// True if any cell is solid.
    pub(super) fn has_solids(&self) -> bool {
        self.solid.as_ref().is_some_and(|solid| solid.contains(&true))
    }

    /// Sets solid cells to 0.
    pub(super) fn mask(&self, natural: &mut [f64]) {
        if let Some(solid) = &self.solid {
            natural.iter_mut().zip(solid).filter(|(_, solid)| **solid).for_each(|(value, _)| *value = 0.0);
        }
    }

    /// Smallest eigenvalue, apart from that of the constant mode, of the Jacobi-scaled matrix `D⁻¹A` of the box without solids: the fraction of the
    /// slowest error mode that a Jacobi sweep removes. `1 − cos(πh)` for a unit cube open on all sides. 0 to 2.
    ///
    /// Computed as the Rayleigh quotient of the smoothest mode, which is exact except for the diagonal next to the edges.
    pub fn slowest_mode(&self) -> f64 {
        self.slowest
    }
}

/// Couplings of cells to the open edges of each axis.
fn outlets(layout: &Layout, spacing_m: [f64; 3], edges: [Option<[Edge; 2]>; 3], air: impl Fn([usize; 3]) -> bool) -> [Coloured<f64>; 3] {
    [0, 1, 2].map(|axis| {
        let mut outlet = layout.zeros();
        for (edge, end) in edges[axis].into_iter().flatten().zip([1, layout.cells[axis]]) {
            for cell in layout.coordinates().filter(|cell| edge == Edge::Dirichlet && cell[axis] == end && air(*cell)) {
                let l = layout.linear(cell);
                let sum = at(&outlet, l) + 2.0 / (spacing_m[axis] * spacing_m[axis]);
                set(&mut outlet, l, sum);
            }
        }
        outlet
    })
}

/// The neighbour of a cell towards smaller coordinates, if there is one.
pub(super) fn below(mut cell: [usize; 3], axis: usize, cells: [usize; 3], wraps: bool) -> Option<[usize; 3]> {
    cell[axis] = if cell[axis] > 1 { Some(cell[axis] - 1) } else { wraps.then_some(cells[axis]) }?;
    Some(cell)
}

/// A mode along one axis: eigenvalue of the second difference and mean of its diagonal weighted with the mode's square, both times `1/h²`.
struct Mode {
    eigenvalue: f64,
    diagonal: f64,
}

/// The smoothest mode along an axis of `n` cells, with `but_constant` the smoothest that is not constant.
fn mode(n: usize, spacing_m: f64, edges: Option<[Edge; 2]>, but_constant: bool) -> Mode {
    let open = edges.map_or(0, |edges| edges.iter().filter(|&&edge| edge == Edge::Dirichlet).count());
    let halves = match (edges, open) {
        (Some(_), 0) => f64::from(u8::from(but_constant)),
        (None, _) => 2.0 * f64::from(u8::from(but_constant)),
        (Some(_), 1) => 0.5,
        _ => 1.0,
    };
    // Half-sample sines and cosines; the phase puts the open edge, if there is one, at the origin.
    let angle = PI * halves / n as f64;
    let value = |i: usize| if open > 0 { (angle * (i as f64 + 0.5)).sin() } else { (angle * (i as f64 + 0.5)).cos() };
    // Faces of the first and the last cell: the sine's origin is an open edge, its other end open only if both are.
    let faces = match (edges, open) {
        (None, _) => [1.0, 1.0],
        (Some(_), 0) => [0.0, 0.0],
        (Some(_), 1) => [2.0, 0.0],
        _ => [2.0, 2.0],
    };
    let (mut weight, mut diagonal) = (0.0, 0.0);
    for i in 0..n {
        let square = value(i) * value(i);
        weight += square;
        diagonal += square * (if i == 0 { faces[0] } else { 1.0 } + if i + 1 == n { faces[1] } else { 1.0 });
    }
    let unit = 1.0 / (spacing_m * spacing_m);
    let diagonal = if n == 1 && edges.is_none() { 0.0 } else { unit * diagonal / weight };
    Mode { eigenvalue: unit * (2.0 - 2.0 * angle.cos()), diagonal }
}

fn slowest_mode(cells: [usize; 3], spacing_m: [f64; 3], edges: [Option<[Edge; 2]>; 3]) -> f64 {
    let quotient = |varies: Option<usize>| {
        let modes = [0, 1, 2].map(|axis| mode(cells[axis], spacing_m[axis], edges[axis], varies == Some(axis)));
        modes.iter().map(|mode| mode.eigenvalue).sum::<f64>() / modes.iter().map(|mode| mode.diagonal).sum::<f64>()
    };
    let open = edges.iter().flatten().flatten().any(|&edge| edge == Edge::Dirichlet);
    let slowest =
        if open { quotient(None) } else { (0..3).filter(|&axis| cells[axis] > 1).map(|axis| quotient(Some(axis))).fold(2.0, f64::min) };
    slowest.clamp(0.0, 2.0)
}

#[cfg(test)]
mod tests {
    use super::Edge::{Dirichlet, Neumann};
    use super::*;

    #[test]
    fn invalid_systems_are_rejected() {
        let closed = [Some([Neumann; 2]); 3];
        assert_eq!(System::new([4, 0, 4], [1.0; 3], closed, None).err(), Some(SystemError::Cells([4, 0, 4])));
        assert_eq!(System::new([usize::MAX; 3], [1.0; 3], closed, None).err(), Some(SystemError::Cells([usize::MAX; 3])));
        for spacing_m in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(System::new([2; 3], [1.0, spacing_m, 1.0], closed, None), Err(SystemError::Spacing(_))));
        }
        assert_eq!(System::new([2; 3], [1.0; 3], closed, Some(&[false; 7])).err(), Some(SystemError::Solid { expected: 8, found: 7 }));
    }

    #[test]
    fn the_slowest_mode_of_an_open_cube_is_the_textbook_one() {
        for n in [8, 16, 64] {
            let system = System::new([n; 3], [1.0 / n as f64; 3], [Some([Dirichlet; 2]); 3], None).unwrap();
            let expected = 1.0 - (PI / n as f64).cos();
            assert!((system.slowest_mode() / expected - 1.0).abs() < 2.0 / n as f64, "{n}: {} against {expected}", system.slowest_mode());
        }
    }
}
