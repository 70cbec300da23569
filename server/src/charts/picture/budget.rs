//! Level of detail within a frame budget, interpolated between measurements.

use super::Shot;

/// Quality within a budget.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bought {
    /// Level of detail, from 0 (low quality) to 3 (ultra).
    pub level: f64,
    /// Mean FLIP there.
    pub flip: f64,
}

/// The highest level within `budget_ms`, for one method on one view, coarsest first; `None` where even the coarsest exceeds it. Between two levels, time is
/// interpolated logarithmically and FLIP linearly.
pub fn bought(shots: &[&Shot], budget_ms: f64) -> Option<Bought> {
    let last = shots.iter().rposition(|shot| shot.ms <= budget_ms)?;
    let here = shots[last];
    let Some(next) = shots.get(last + 1) else { return Some(Bought { level: here.level, flip: here.flip }) };
    let fraction = (budget_ms / here.ms).ln() / (next.ms / here.ms).ln();
    let between = |a: f64, b: f64| a + fraction * (b - a);
    Some(Bought { level: between(here.level, next.level), flip: between(here.flip, next.flip) })
}

#[cfg(test)]
mod tests {
    use super::super::shot::made_up;
    use super::*;

    #[test]
    fn the_best_level_within_a_budget_is_interpolated() {
        let shots = [made_up("v", "m", 0, 10.0, 0.08), made_up("v", "m", 1, 40.0, 0.04), made_up("v", "m", 2, 160.0, 0.02)];
        let shots: Vec<&Shot> = shots.iter().collect();
        assert_eq!(bought(&shots, 9.0), None);
        assert_eq!(bought(&shots, 10.0), Some(Bought { level: 0.0, flip: 0.08 }));
        let half = bought(&shots, 20.0).unwrap();
        assert!((half.level - 0.5).abs() < 1e-12 && (half.flip - 0.06).abs() < 1e-12, "{half:?}");
        assert_eq!(bought(&shots, 1000.0), Some(Bought { level: 2.0, flip: 0.02 }));
    }
}
