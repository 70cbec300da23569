//! Finite differences of eighth order, to verify the formulas of this folder.

/// Weights of the first derivative for offsets 1 to 4; odd.
const FIRST: [f64; 4] = [4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0];
/// Weights of the second derivative for offsets 1 to 4; even. That of the centre is −205/72.
const SECOND: [f64; 4] = [8.0 / 5.0, -1.0 / 5.0, 8.0 / 315.0, -1.0 / 560.0];

/// df/dt at `at`, from values up to four `step`s away. Error of order `step⁸`.
pub(super) fn rate(f: impl Fn(f64) -> f64, at: f64, step: f64) -> f64 {
    let pairs = FIRST.iter().zip(1..).map(|(weight, n)| weight * (f(at + f64::from(n) * step) - f(at - f64::from(n) * step)));
    pairs.sum::<f64>() / step
}

fn along(position: [f64; 3], axis: usize, value: f64) -> [f64; 3] {
    std::array::from_fn(|a| if a == axis { value } else { position[a] })
}

/// ∇f at a position.
pub(super) fn gradient(f: impl Fn([f64; 3]) -> f64, position: [f64; 3], step: f64) -> [f64; 3] {
    std::array::from_fn(|axis| rate(|value| f(along(position, axis, value)), position[axis], step))
}

/// ∇²f at a position.
pub(super) fn laplacian(f: impl Fn([f64; 3]) -> f64, position: [f64; 3], step: f64) -> f64 {
    let centre = -205.0 / 72.0 * f(position);
    let curvature = |axis: usize| {
        let at = |n: f64| f(along(position, axis, position[axis] + n * step));
        centre + SECOND.iter().zip(1..).map(|(weight, n)| weight * (at(f64::from(n)) + at(-f64::from(n)))).sum::<f64>()
    };
    (curvature(0) + curvature(1) + curvature(2)) / (step * step)
}

/// Residuals of an incompressible flow at a position and time.
pub(super) struct Residual {
    /// ∇·u (1/s).
    pub(super) divergence: f64,
    /// ∂u/∂t + (u·∇)u + ∇p − ν∇²u (m/s²).
    pub(super) momentum: [f64; 3],
}

/// Residual of the Navier–Stokes equations, by differences over `step_m` and `step_secs`.
pub(super) fn navier_stokes(
    velocity: impl Fn([f64; 3], f64) -> [f64; 3],
    pressure: impl Fn([f64; 3], f64) -> f64,
    viscosity_m2_per_s: f64,
    (position, time_secs): ([f64; 3], f64),
    (step_m, step_secs): (f64, f64),
) -> Residual {
    let slopes: [[f64; 3]; 3] = std::array::from_fn(|c| gradient(|x| velocity(x, time_secs)[c], position, step_m));
    let push = gradient(|x| pressure(x, time_secs), position, step_m);
    let carrier = velocity(position, time_secs);
    let momentum = std::array::from_fn(|c| {
        let carried: f64 = carrier.iter().zip(slopes[c]).map(|(u, slope)| u * slope).sum();
        let spread = viscosity_m2_per_s * laplacian(|x| velocity(x, time_secs)[c], position, step_m);
        rate(|t| velocity(position, t)[c], time_secs, step_secs) + carried + push[c] - spread
    });
    Residual { divergence: slopes[0][0] + slopes[1][1] + slopes[2][2], momentum }
}

#[test]
fn polynomials_of_degree_eight_are_exact() {
    let f = |[x, y, z]: [f64; 3]| x.powi(8) - 3.0 * y.powi(7) + x * z.powi(3);
    let [x, y, z] = [0.7, -0.3, 1.1];
    let found = gradient(f, [x, y, z], 0.1);
    let exact = [8.0 * x.powi(7) + z.powi(3), -21.0 * y.powi(6), 3.0 * x * z * z];
    assert!(found.iter().zip(exact).all(|(a, b)| (a - b).abs() < 1e-11), "{found:?} {exact:?}");
    let exact = 56.0 * x.powi(6) - 126.0 * y.powi(5) + 6.0 * x * z;
    assert!((laplacian(f, [x, y, z], 0.1) - exact).abs() < 1e-10);
}
