//! The heat kernel.

use std::f64::consts::PI;

/// Exact solution of `∂ρ/∂t = κ∇²ρ` for a point source in a periodic box: the sum of the kernels of all periodic images.
///
/// The solution is a product over the axes. Nothing changes along an axis that is left out, so one to three dimensions can be tested.
#[derive(Clone, Copy, Debug)]
pub struct HeatKernel {
    /// Sides of the box (m); `None` for an axis along which the heat is uniform.
    pub side_m: [Option<f64>; 3],
    /// Position of the source (m).
    pub centre_m: [f64; 3],
    /// Diffusivity κ (m²/s).
    pub diffusivity_m2_per_s: f64,
}

impl HeatKernel {
    /// Density (1/m per axis that is not left out; its integral over the box is 1) at a position (m) and time (s) above 0.
    ///
    /// Images are summed until the remainder is below rounding. Late times need more images and cost more.
    pub fn density(&self, position_m: [f64; 3], time_secs: f64) -> f64 {
        let spread = 4.0 * self.diffusivity_m2_per_s * time_secs;
        let along = |axis: usize, side: f64| {
            let distance = (position_m[axis] - self.centre_m[axis]).rem_euclid(side);
            // exp(−40) is below the rounding of a sum of order 1.
            let images = ((40.0 * spread).sqrt() / side).ceil() as i32 + 1;
            let sum: f64 = (-images..=images).map(|n| distance + f64::from(n) * side).map(|d| (-d * d / spread).exp()).sum();
            sum / (PI * spread).sqrt()
        };
        (0..3).filter_map(|axis| self.side_m[axis].map(|side| along(axis, side))).product()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problems::differences::{laplacian, rate};

    const SIDES_M: [[Option<f64>; 3]; 3] = [[Some(3.0), None, None], [Some(3.0), None, Some(2.0)], [Some(3.0), Some(4.0), Some(2.0)]];

    fn kernel(side_m: [Option<f64>; 3]) -> HeatKernel {
        HeatKernel { side_m, centre_m: [1.0, 3.5, 0.3], diffusivity_m2_per_s: 0.2 }
    }

    #[test]
    fn it_solves_the_heat_equation_in_one_to_three_dimensions() {
        for kernel in SIDES_M.map(kernel) {
            for position in [[0.0; 3], [2.9, 0.1, 1.2], [1.0, 3.5, 0.3]] {
                let changed = rate(|t| kernel.density(position, t), 1.0, 0.01);
                let spread = 0.2 * laplacian(|x| kernel.density(x, 1.0), position, 0.05);
                assert!((changed - spread).abs() < 1e-9, "{:?}: {changed} {spread}", kernel.side_m);
            }
        }
    }

    #[test]
    fn it_is_periodic_conserves_heat_and_becomes_uniform() {
        for side_m in SIDES_M {
            let (kernel, volume) = (kernel(side_m), side_m.iter().flatten().product::<f64>());
            let [x, y, z] = side_m.map(|side| side.unwrap_or(1.0));
            assert!((kernel.density([0.0; 3], 0.5) - kernel.density([x, y, z], 0.5)).abs() < 1e-14);
            assert!((kernel.density([0.4; 3], 200.0) * volume - 1.0).abs() < 1e-12);
            // Equal weights integrate a smooth periodic function to rounding.
            let n = 24;
            let cell = |i: usize, side: f64| i as f64 / n as f64 * side;
            let positions = (0..n * n * n).map(|at| [cell(at % n, x), cell(at / n % n, y), cell(at / (n * n), z)]);
            let mean = positions.map(|position| kernel.density(position, 0.5)).sum::<f64>() / (n * n * n) as f64;
            assert!((mean * volume - 1.0).abs() < 1e-12, "{}", mean * volume - 1.0);
        }
    }
}
