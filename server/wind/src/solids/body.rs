//! Solid bodies: boxes at any angle.

use super::DragBody;
use crate::grid::Grid;
use crate::real::Real;

/// A solid box, such as a vehicle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// Centre (m).
    pub centre_m: [f64; 3],
    /// Half of the sides along its own axes (m), each above 0.
    pub half_extents_m: [f64; 3],
    /// Its own axes as unit vectors in the grid.
    pub axes: [[f64; 3]; 3],
    /// Velocity (m/s).
    pub velocity_m_per_s: [f64; 3],
    /// Drag coefficient C_d, for a body that the cells do not resolve: about 1 for a box, 0.5 for a ball.
    pub drag_coefficient: f64,
}

impl Body {
    /// Smallest width, in cells, of a body that is a wall.
    pub const RESOLVED: f64 = 3.0;

    /// Whether all numbers are finite, the half extents above 0 and the drag coefficient is not below it.
    pub fn is_valid(&self) -> bool {
        self.drag().is_valid()
            && self.axes.as_flattened().iter().all(|part| part.is_finite())
            && self.half_extents_m.iter().all(|&half_m| half_m > 0.0)
    }

    /// Whether the cells of `grid` resolve the body.
    pub fn is_resolved<R: Real>(&self, grid: &Grid<R>) -> bool {
        self.is_resolved_by(grid.spacing_m.map(R::wide))
    }

    /// Whether cells with these sides (m) along x, y and z resolve the body.
    pub fn is_resolved_by(&self, spacing_m: [f64; 3]) -> bool {
        (0..3).all(|axis| {
            let widest_m = spacing_m.iter().zip(self.axes[axis]).map(|(h, part)| h * part.abs()).sum::<f64>();
            2.0 * self.half_extents_m[axis] >= Self::RESOLVED * widest_m
        })
    }

    /// Half extents (m) of the upright box around the body.
    pub(super) fn bounds_m(&self) -> [f64; 3] {
        [0, 1, 2].map(|along| (0..3).map(|axis| self.half_extents_m[axis] * self.axes[axis][along].abs()).sum())
    }

    /// Signed distance (m) of a point `offset_m` from the centre.
    pub(super) fn distance_m(&self, offset_m: [f64; 3]) -> f64 {
        let beyond = [0, 1, 2].map(|axis| {
            let along: f64 = offset_m.iter().zip(self.axes[axis]).map(|(offset, part)| offset * part).sum();
            along.abs() - self.half_extents_m[axis]
        });
        let outside = beyond.iter().map(|side| side.max(0.0) * side.max(0.0)).sum::<f64>().sqrt();
        outside + beyond.into_iter().fold(f64::NEG_INFINITY, f64::max).min(0.0)
    }

    /// The drag `½·C_d·A·|u|·u` of the body, with the area A that it turns towards each axis.
    pub fn drag(&self) -> DragBody {
        let [x, y, z] = self.half_extents_m;
        let sides_m2 = [4.0 * y * z, 4.0 * z * x, 4.0 * x * y];
        let facing_m2 = |along: usize| (0..3).map(|axis| sides_m2[axis] * self.axes[axis][along].abs()).sum::<f64>();
        DragBody {
            centre_m: self.centre_m,
            half_extents_m: self.bounds_m(),
            velocity_m_per_s: self.velocity_m_per_s,
            drag_m2: [0, 1, 2].map(|along| 0.5 * self.drag_coefficient * facing_m2(along)),
        }
    }
}
