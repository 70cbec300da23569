//! Error norms, and the order of convergence.

/// Norms of an error over the cells of a grid, averaged per cell so that grids of different size compare.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Norms {
    /// Mean of the absolute error.
    pub l1: f64,
    /// Root of the mean square.
    pub l2: f64,
    /// Largest absolute error.
    pub linf: f64,
}

impl Norms {
    /// Norms of the differences between pairs of computed and exact values.
    pub fn of(pairs: impl IntoIterator<Item = (f64, f64)>) -> Self {
        let (mut n, mut sum, mut squares, mut largest) = (0.0, 0.0, 0.0, 0.0f64);
        for (found, exact) in pairs {
            let error = (found - exact).abs();
            n += 1.0;
            sum += error;
            squares += error * error;
            largest = largest.max(error);
        }
        Self { l1: sum / n, l2: f64::sqrt(squares / n), linf: largest }
    }
}

/// Slope of the least-squares line through (ln h, ln error): the order p in `error ≈ C·h^p`.
///
/// ```
/// use prairie_charts::norms::fitted_order;
/// assert!((fitted_order(&[(0.4, 0.32), (0.2, 0.08), (0.1, 0.02)]) - 2.0).abs() < 1e-12);
/// ```
pub fn fitted_order(spacing_and_error: &[(f64, f64)]) -> f64 {
    let n = spacing_and_error.len() as f64;
    let logs = || spacing_and_error.iter().map(|&(h, error)| (h.ln(), error.ln()));
    let (mean_x, mean_y) = logs().fold((0.0, 0.0), |(a, b), (x, y)| (a + x / n, b + y / n));
    let (covariance, variance) =
        logs().fold((0.0, 0.0), |(a, b), (x, y)| (a + (x - mean_x) * (y - mean_y), b + (x - mean_x) * (x - mean_x)));
    covariance / variance
}
