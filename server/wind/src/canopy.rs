//! Drag of a grass canopy.

mod motion;

pub use motion::CanopyMotion;
pub(super) use motion::Stems;

use super::config::error::{ConfigError, above_zero, at_least_zero};
use super::solids::drag::speed_squared;
use super::{Grid, Location, Real, Velocity};

/// A layer of grass with the drag `f = −C_d·a·|u|·u`, a the frontal area per volume. The resulting shear layer causes the travelling waves over a
/// meadow (Py et al. 2006).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Canopy {
    /// Height of the grass (m). Default 0.8; above 0.
    pub height_m: f32,
    /// C_d·a of standing grass (1/m). Default 0.1; 0 or more. Meadows have 0.1 to 1.
    pub drag_per_m: f32,
    /// Motion of the grass in the wind, which acts back on it; `None` (default) for grass that keeps its place.
    pub motion: Option<CanopyMotion>,
}

impl Default for Canopy {
    fn default() -> Self {
        Self { height_m: 0.8, drag_per_m: 0.1, motion: None }
    }
}

impl Canopy {
    pub(super) fn validate(&self) -> Result<(), ConfigError> {
        above_zero("canopy.height_m", self.height_m)?;
        at_least_zero("canopy.drag_per_m", self.drag_per_m)?;
        self.motion.iter().try_for_each(CanopyMotion::validate)
    }

    /// Fraction of the layer from `low_m` to `high_m` above the ground that is inside the grass.
    fn fraction(&self, low_m: f64, high_m: f64) -> f64 {
        ((f64::from(self.height_m) - low_m) / (high_m - low_m)).clamp(0.0, 1.0)
    }
}

/// Applies canopy drag by a backward Euler step, which never reverses the flow: `u /= 1 + dt·C_d·a·|u|`. `cover` is the fraction of standing grass in each column
/// of cells, x fastest. The ghosts of `velocity` must be filled; `slowed` is a work array.
///
/// |u| is the speed at the start of the step, from the mean of the four nearest values of each other component (second order).
pub fn drag<R: Real>(grid: &Grid<R>, canopy: &Canopy, cover: &[R], dt_secs: f64, velocity: &mut Velocity<R>, slowed: &mut Velocity<R>) {
    let strides = grid.strides();
    let [nx, ny, nz] = grid.cells;
    let layer_m = grid.spacing_m[1].wide();
    for axis in 0..3 {
        let location = Location::Face(axis);
        let offset = grid.offset(location, 1).wide();
        let target = &mut slowed.0[axis];
        for j in grid.free(location, 1) {
            let middle_m = (j as f64 + offset) * layer_m;
            let fraction = canopy.fraction((middle_m - 0.5 * layer_m).max(0.0), middle_m + 0.5 * layer_m);
            if fraction == 0.0 {
                break;
            }
            let rate = R::of(dt_secs * fraction * f64::from(canopy.drag_per_m));
            for k in grid.free(location, 2) {
                for i in grid.free(location, 0) {
                    let at = grid.at([i, j, k]);
                    let squares = speed_squared(velocity, strides, axis, at, [R::zero(); 3]);
                    let standing = cover[i.min(nx - 1) + nx * k.min(nz - 1)];
                    target.data[at] = velocity.0[axis].data[at] / (R::one() + rate * standing * squares.sqrt());
                }
            }
        }
    }
    for axis in 0..3 {
        let location = Location::Face(axis);
        let offset = grid.offset(location, 1).wide();
        let (from, to) = (&slowed.0[axis], &mut velocity.0[axis]);
        for j in grid
            .free(location, 1)
            .take_while(|&j| canopy.fraction(((j as f64 + offset - 0.5) * layer_m).max(0.0), (j as f64 + offset + 0.5) * layer_m) > 0.0)
        {
            for k in grid.free(location, 2) {
                let xs = grid.free(location, 0);
                let row = grid.at([xs.start, j, k]);
                to.data[row..row + xs.len()].copy_from_slice(&from.data[row..row + xs.len()]);
            }
        }
    }
    debug_assert_eq!(cover.len(), nx * nz);
    debug_assert!(ny > 0);
}
