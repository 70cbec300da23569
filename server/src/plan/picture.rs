//! The plan of the picture: the lowest level of detail whose error in the worst of ten views of built-in scenes is within a tolerance.
//!
//! The views are drawn and compared by the figure `levels` of `prairie chart picture`, whose data are kept with the program. They do not depend on the machine.

use prairie_core::scene::Scene;
use serde::{Deserialize, Serialize};

/// Data of the figure `levels`: a view, or the worst of all; a quality, its level of detail, and the mean FLIP error against the same view in full detail.
const LEVELS: &str = include_str!("picture-levels.csv");

/// Level of detail of automatic quality, with its error.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PicturePlan {
    /// Highest level of detail.
    pub highest_detail: f32,
    /// Largest mean FLIP error over the views at that level.
    pub flip: f64,
    /// Fields that the plan has set.
    pub planned: Vec<String>,
    /// Why the tolerance is not met.
    pub conflict: Option<String>,
}

impl PicturePlan {
    pub(super) fn apply(&self, scene: &mut Scene) {
        scene.plants.highest_detail = self.highest_detail;
    }
}

/// Plans the picture of a scene for a tolerance; without one it only looks up the error.
pub(super) fn plan(scene: &Scene, stated: &[String], tolerance: Option<f64>) -> PicturePlan {
    let errors = errors();
    let own = scene.plants.highest_detail;
    let is_open = !stated.iter().any(|path| path == "plants.highest_detail");
    let highest_detail = tolerance.filter(|_| is_open).map_or(own, |tolerance| lowest_within(&errors, tolerance));
    let flip = error_at(&errors, highest_detail);
    let planned = if highest_detail == own { Vec::new() } else { vec!["plants.highest_detail".to_owned()] };
    let conflict = tolerance.filter(|tolerance| flip > *tolerance).map(|tolerance| {
        format!(
            "`accuracy.picture` = {} is missed: at level of detail {highest_detail}, {}, the worst view has {flip:.4}. The accuracy gives way",
            tolerance as f32,
            if is_open { "the highest" } else { "which the scene states" }
        )
    });
    PicturePlan { highest_detail, flip, planned, conflict }
}

/// Largest error over the views at each whole level of detail, never smaller than at a higher level.
fn errors() -> Vec<f64> {
    let mut worst: Vec<f64> = Vec::new();
    for row in LEVELS.lines().filter(|row| row.starts_with("worst,")) {
        let [_, _, level, flip] = row.split(',').collect::<Vec<_>>()[..] else { continue };
        let (Ok(level), Ok(flip)) = (level.parse::<usize>(), flip.parse::<f64>()) else { continue };
        worst.resize(worst.len().max(level + 1), 0.0);
        worst[level] = flip;
    }
    for level in (1..worst.len()).rev() {
        worst[level - 1] = worst[level - 1].max(worst[level]);
    }
    worst
}

/// Error at a level, linear between whole ones.
fn error_at(errors: &[f64], level: f32) -> f64 {
    let last = errors.len() - 1;
    let below = (level as usize).min(last);
    let part = f64::from(level) - below as f64;
    errors[below] + part * (errors[(below + 1).min(last)] - errors[below])
}

/// The lowest level whose error is within a tolerance, rounded up to a hundredth; the highest one if none is.
fn lowest_within(errors: &[f64], tolerance: f64) -> f32 {
    let Some(at) = errors.iter().position(|error| *error <= tolerance) else { return (errors.len() - 1) as f32 };
    if at == 0 {
        return 0.0;
    }
    let [above, here] = [errors[at - 1], errors[at]];
    let level = (at - 1) as f64 + (above - tolerance) / (above - here);
    ((100.0 * level).ceil() / 100.0) as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use prairie_core::scene::parse;

    #[test]
    fn the_kept_errors_are_of_ten_views_at_four_levels_and_fall_with_detail() {
        let views: std::collections::BTreeSet<_> = LEVELS.lines().skip(1).filter_map(|row| row.split(',').next()).collect();
        assert_eq!((views.len(), LEVELS.lines().count()), (11, 45));
        let errors = errors();
        let of_level =
            |level: usize| LEVELS.lines().skip(1).filter_map(move |row| row.split_once(&format!(",{level},"))?.1.parse::<f64>().ok());
        for (level, error) in errors.iter().enumerate() {
            assert!(of_level(level).count() == 11 && of_level(level).all(|flip| flip <= *error), "{errors:?}");
        }
        assert!(errors.len() == 4 && errors[0] > errors[3] && errors[3] > 0.0, "{errors:?}");
    }

    #[test]
    fn the_lowest_level_within_a_tolerance_holds_it_and_lower_ones_do_not() {
        let errors = errors();
        for part in [0.05, 0.3, 0.5, 0.8, 0.99] {
            let tolerance = errors[3] + part * (errors[0] - errors[3]);
            let level = lowest_within(&errors, tolerance);
            assert!(error_at(&errors, level) <= tolerance && error_at(&errors, level - 0.02) > tolerance, "{tolerance}: {level}");
        }
        assert_eq!([0.0, 1.0].map(|tolerance| lowest_within(&errors, tolerance)), [3.0, 0.0]);
    }

    #[test]
    fn stated_detail_is_kept_and_what_it_misses_is_told() {
        let mut scene = parse(include_str!("../../scenes/blades.toml")).unwrap();
        scene.plants.highest_detail = 0.0;
        let errors = errors();
        let tolerance = 0.5 * (errors[0] + errors[3]);
        let plan_of = |stated: &[String]| plan(&scene, stated, Some(tolerance));
        let kept = plan_of(&["plants.highest_detail".to_owned()]);
        assert!(kept.highest_detail == 0.0 && kept.planned.is_empty());
        assert!(kept.conflict.unwrap().contains("at level of detail 0, which the scene states, the worst view has "));
        let planned = plan_of(&[]);
        assert!(planned.conflict.is_none() && planned.highest_detail > 0.0 && planned.flip <= tolerance, "{planned:?}");
        assert_eq!(planned.planned, ["plants.highest_detail"]);
        assert!(plan(&scene, &[], Some(1e-4)).conflict.unwrap().contains("at level of detail 3, the highest, "));
    }
}
