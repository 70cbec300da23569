//! Separate costs of two kinds of work, by regression: the GPU times whole passes only.

/// A pass: amounts of both kinds of work, and its time (ms).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Timed {
    pub(super) work: [f64; 2],
    pub(super) ms: f64,
}

/// The plane `ms = work[0] · a + work[1] · b` fitted to passes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shares {
    /// Time per unit of each kind of work (ms).
    pub(super) ms: [f64; 2],
    /// Standard error of each.
    pub(super) errors: [f64; 2],
    /// Root mean square of the relative residuals.
    pub(super) residual: f64,
}

impl Shares {
    /// Fits by least squares of the relative residuals, since times differ by orders of magnitude; `None` where the passes do not separate the two.
    pub(super) fn of(passes: &[Timed]) -> Option<Self> {
        let scaled = || passes.iter().map(|pass| pass.work.map(|work| work / pass.ms));
        let sum = |of: &dyn Fn([f64; 2]) -> f64| scaled().map(of).sum::<f64>();
        let [aa, ab, bb] = [sum(&|[a, _]| a * a), sum(&|[a, b]| a * b), sum(&|[_, b]| b * b)];
        let [a, b] = [sum(&|[a, _]| a), sum(&|[_, b]| b)];
        let determinant = aa * bb - ab * ab;
        if passes.len() < 3 || determinant <= 1e-9 * aa * bb {
            return None;
        }
        let ms = [(bb * a - ab * b) / determinant, (aa * b - ab * a) / determinant];
        let squares = sum(&|[a, b]| (a * ms[0] + b * ms[1] - 1.0).powi(2));
        let variance = squares / (passes.len() - 2) as f64;
        let errors = [bb, aa].map(|other| (variance * other / determinant).sqrt());
        Some(Self { ms, errors, residual: (squares / passes.len() as f64).sqrt() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Six passes that take 30 and 80 ms per unit of work, times a factor.
    fn made_up(factor: impl Fn(usize) -> f64) -> Vec<Timed> {
        let works = [[0.5, 2.0], [0.4, 0.5], [0.3, 0.1], [4.0, 2.0], [3.0, 0.5], [2.0, 0.1]];
        let timed = |(n, work): (usize, [f64; 2])| Timed { work, ms: (30.0 * work[0] + 80.0 * work[1]) * factor(n) };
        works.into_iter().enumerate().map(timed).collect()
    }

    #[test]
    fn an_exact_plane_is_fitted_without_residual() {
        let found = Shares::of(&made_up(|_| 1.0)).expect("the kinds of work differ");
        assert!((found.ms[0] - 30.0).abs() < 1e-9 && (found.ms[1] - 80.0).abs() < 1e-9 && found.residual < 1e-12, "{found:?}");
    }

    #[test]
    fn scatter_appears_in_residual_and_errors() {
        let found = Shares::of(&made_up(|n| if n % 2 == 0 { 1.1 } else { 0.9 })).expect("the kinds of work differ");
        assert!((0.05..0.15).contains(&found.residual) && found.errors.iter().all(|error| *error > 1.0), "{found:?}");
        assert!((found.ms[0] - 30.0).abs() < 3.0 * found.errors[0] && (found.ms[1] - 80.0).abs() < 3.0 * found.errors[1], "{found:?}");
    }

    #[test]
    fn collinear_or_too_few_measurements_give_no_fit() {
        let same = [1.0, 2.0, 4.0, 5.0].map(|times| Timed { work: [times, 3.0 * times], ms: 50.0 * times });
        assert_eq!(Shares::of(&same), None);
        assert_eq!(Shares::of(&made_up(|_| 1.0)[..2]), None);
    }
}
