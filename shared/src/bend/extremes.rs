//! What stands out in a patch.

use multiversion::multiversion;

/// Lanes that gather on their own, so that the loop over a row has no chain of comparisons; a patch's side is a multiple.
const LANES: usize = 8;

/// What stands out in a patch.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Extremes {
    /// Largest |θ| (rad).
    pub theta_rad: f32,
    /// Largest |ω| (rad/s).
    pub omega_rad_per_s: f32,
    /// Sum of θ² + ω² over the cells (mixed units): how far from rest the patch is. Not finite where a value is not.
    pub activity: f32,
}

/// Gathers [`Extremes`] row by row.
#[derive(Default)]
pub(super) struct LargestOf {
    theta2: [f32; LANES],
    omega2: [f32; LANES],
    activity: [f32; LANES],
}

impl LargestOf {
    /// Takes in a row of each channel.
    pub(super) fn add(&mut self, theta: &[f32], x: &[f32], z: &[f32]) {
        gather(self, theta, x, z);
    }

    pub(super) fn extremes(&self) -> Extremes {
        let root_of_largest = |lanes: [f32; LANES]| lanes.into_iter().fold(0.0, larger).sqrt();
        Extremes {
            theta_rad: root_of_largest(self.theta2),
            omega_rad_per_s: root_of_largest(self.omega2),
            activity: self.activity.iter().sum(),
        }
    }
}

#[multiversion(targets("x86_64+avx2"))]
fn gather(largest: &mut LargestOf, theta: &[f32], x: &[f32], z: &[f32]) {
    let LargestOf { theta2: mut theta2_max, omega2: mut omega2_max, mut activity } = *largest;
    let blocks = theta.as_chunks::<LANES>().0.iter().zip(x.as_chunks::<LANES>().0).zip(z.as_chunks::<LANES>().0);
    for ((theta, x), z) in blocks {
        for i in 0..LANES {
            let (theta2, omega2) = (theta[i] * theta[i], x[i] * x[i] + z[i] * z[i]);
            theta2_max[i] = larger(theta2, theta2_max[i]);
            omega2_max[i] = larger(omega2, omega2_max[i]);
            activity[i] += theta2 + omega2;
        }
    }
    *largest = LargestOf { theta2: theta2_max, omega2: omega2_max, activity };
}

#[inline(always)]
fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}
