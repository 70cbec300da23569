//! Fitted orders of accuracy of the wind solver beside the formal ones.
//!
//! Each function runs its problem and returns a row per scheme; the tests assert the rows, and a document can show the same rows as a table.

mod dust;
mod ethier_steinman;
mod moving_walls;
mod taylor_green;

pub use dust::{heat_space, heat_time, rotating_gaussian};
pub use ethier_steinman::{beltrami, coarse_beltrami};
pub use moving_walls::{couette_start, oscillating_wall};
pub use taylor_green::{advection_and_time, space, time, times_of};

use std::fmt;

use crate::norms::fitted_order;

/// Every row; takes some minutes.
pub fn all() -> Vec<Order> {
    let problems = [advection_and_time, space, time, beltrami, couette_start, oscillating_wall, rotating_gaussian, heat_space, heat_time];
    problems.into_iter().flat_map(|rows| rows()).collect()
}

/// Largest allowed difference between a fitted order and the expected one.
pub const TOLERANCE: f64 = 0.1;

/// Order of convergence of one scheme.
#[derive(Clone, Debug, PartialEq)]
pub struct Order {
    /// Problem, such as `Taylor–Green`.
    pub problem: &'static str,
    /// The scheme.
    pub scheme: String,
    /// Refined quantity and norm of the error.
    pub quantity: &'static str,
    /// Order in theory.
    pub formal: f64,
    /// Order as measured, if it is not the formal one on the grids that all schemes of a problem share; the document gives the reason.
    pub pinned: Option<f64>,
    /// Slope of the least-squares line through the logarithms of `errors`.
    pub fitted: f64,
    /// Refined quantity (m or s) and remaining error, coarse to fine.
    pub errors: Vec<(f64, f64)>,
}

impl Order {
    /// Fits the order to errors.
    pub fn fit(problem: &'static str, scheme: impl Into<String>, quantity: &'static str, formal: f64, errors: Vec<(f64, f64)>) -> Self {
        Self { problem, scheme: scheme.into(), quantity, formal, pinned: None, fitted: fitted_order(&errors), errors }
    }

    /// Expects `order` instead of the formal one, if there is one.
    #[must_use]
    pub fn pinned_to(self, order: Option<f64>) -> Self {
        Self { pinned: order, ..self }
    }

    /// Whether the fitted order is the expected one within [`TOLERANCE`].
    pub fn is_expected(&self) -> bool {
        (self.fitted - self.pinned.unwrap_or(self.formal)).abs() <= TOLERANCE
    }
}

impl fmt::Display for Order {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { problem, scheme, quantity, formal, fitted, errors, .. } = self;
        write!(f, "{problem:<14} {scheme:<44} {quantity:<14} formal {formal}, fitted {fitted:.3}:")?;
        errors.iter().try_for_each(|(_, error)| write!(f, " {error:.2e}"))
    }
}

/// Prints all rows, and asserts that each fitted order is the formal one, or the one it is pinned to.
///
/// # Panics
/// If one is not.
pub fn assert_expected(rows: &[Order]) {
    rows.iter().for_each(|row| println!("{row}"));
    let off: Vec<&Order> = rows.iter().filter(|row| !row.is_expected()).collect();
    assert!(off.is_empty(), "fitted orders that are not the expected ones: {off:#?}");
}
