//! The plan of the bending angle at the clients: rest, scheme and the codes of the stream share its tolerance, a root mean square.
//!
//! A quarter of it is the bend that counts as at rest. [Pilot runs](super::bend_pilot) measure the error of scheme and rest. The codes get the remainder, for
//! independent errors add by their squares: a code with the largest error ε has one of ε/√3 in the root mean square.

use super::bend_pilot::Drive;
use super::fronts::Fronts;
use crate::scenes::LoadedScene;
use prairie_core::bend::Scheme;
use prairie_core::scene::Scene;
use serde::{Deserialize, Serialize};

/// Share of the tolerance that counts as rest, and the largest one of scheme and rest.
const REST_SHARE: f64 = 0.25;
const SCHEME_SHARE: f64 = 0.95;
/// Allowed errors of codes (degrees), and largest allowed bend at rest (rad).
const CODE_DEG: [f64; 2] = [0.05, 5.0];
const REST_RAD: f64 = 0.1;
/// Schemes that a plan may choose: those that are stable with any grass.
const SCHEMES: [Scheme; 2] = [Scheme::Substepped, Scheme::Implicit];

/// Settings of the bend field and its stream, with their errors.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BendPlan {
    /// Largest error of a code of θ (degrees).
    pub theta_error_deg: f32,
    /// Largest bend that counts as at rest (rad).
    pub rest_theta_rad: f32,
    /// Time scheme.
    pub scheme: Scheme,
    /// Root mean square error of scheme and rest behind a car (degrees); `None` in a world that is too small for the drive.
    pub measured_deg: Option<f64>,
    /// Mean time per tick behind one car (ms); `None` where it is not known.
    pub ms_per_tick: Option<f64>,
    /// Fields that the plan has set.
    pub planned: Vec<String>,
    /// Why the tolerance is not met.
    pub conflict: Option<String>,
}

impl BendPlan {
    /// The expected root mean square error of θ (degrees).
    pub fn error_deg(&self) -> f64 {
        let measured_deg = self.measured_deg.unwrap_or_else(|| f64::from(self.rest_theta_rad).to_degrees());
        measured_deg.hypot(f64::from(self.theta_error_deg) / f64::sqrt(3.0))
    }

    pub(super) fn apply(&self, scene: &mut Scene) {
        scene.stream.theta_error_deg = self.theta_error_deg;
        (scene.bend.rest_theta_rad, scene.bend.scheme) = (self.rest_theta_rad, self.scheme);
    }
}

/// Plans codes, rest and scheme of a scene for a tolerance of the angle (degrees); without one it only measures.
pub(super) fn plan(loaded: &LoadedScene, stated: &[String], tolerance_deg: Option<f64>, fronts: &Fronts) -> BendPlan {
    let mut scene = loaded.scene.clone();
    let is_open = |field: &str| tolerance_deg.is_some() && !stated.iter().any(|path| path == field);
    let mut planned = Vec::new();
    if let Some(tolerance_deg) = tolerance_deg.filter(|_| is_open("bend.rest_theta_rad")) {
        scene.bend.rest_theta_rad = (REST_SHARE * tolerance_deg).to_radians().min(REST_RAD) as f32;
        planned.push("bend.rest_theta_rad".to_owned());
    }
    let own = scene.bend.scheme;
    let schemes = if is_open("bend.scheme") && SCHEMES.contains(&own) { SCHEMES.to_vec() } else { vec![own] };
    let share_deg = tolerance_deg.map_or(f64::INFINITY, |tolerance_deg| SCHEME_SHARE * tolerance_deg);
    let found = Drive::new(loaded).map(|drive| chosen(&drive, &scene, &schemes, share_deg, fronts));
    let (scheme, measured_deg, ms_per_tick) = match found {
        Some((scheme, error_deg, ms)) => (scheme, Some(error_deg), ms),
        None => (own, None, None),
    };
    if scheme != own {
        planned.push("bend.scheme".to_owned());
    }
    if let Some(tolerance_deg) = tolerance_deg.filter(|_| is_open("stream.theta_error_deg")) {
        let measured_deg = measured_deg.unwrap_or_else(|| f64::from(scene.bend.rest_theta_rad).to_degrees());
        let left_deg = (tolerance_deg * tolerance_deg - measured_deg * measured_deg).max(0.0).sqrt();
        // A code is never coarser than the tolerance itself, nor finer than a quarter of it, which no longer matters.
        let code_deg = (f64::sqrt(3.0) * left_deg).clamp(0.25 * tolerance_deg, tolerance_deg);
        scene.stream.theta_error_deg = ((1e3 * code_deg).floor() / 1e3).clamp(CODE_DEG[0], CODE_DEG[1]) as f32;
        planned.push("stream.theta_error_deg".to_owned());
    }
    let (theta_error_deg, rest_theta_rad) = (scene.stream.theta_error_deg, scene.bend.rest_theta_rad);
    let plan = BendPlan { theta_error_deg, rest_theta_rad, scheme, measured_deg, ms_per_tick, planned, conflict: None };
    let conflict = tolerance_deg.and_then(|tolerance_deg| conflict(&plan, tolerance_deg));
    BendPlan { conflict, ..plan }
}

/// The cheapest scheme whose error is at most `share_deg`, or else the one with the smallest error, with its error (degrees) and its time (ms).
fn chosen(drive: &Drive<'_>, scene: &Scene, schemes: &[Scheme], share_deg: f64, fronts: &Fronts) -> (Scheme, f64, Option<f64>) {
    let measured = schemes.iter().map(|&scheme| {
        let mut changed = scene.clone();
        changed.bend.scheme = scheme;
        let (error_deg, cell_steps) = drive.measure(&changed);
        (scheme, error_deg, fronts.bend_ms_per_tick(scheme, cell_steps))
    });
    let measured: Vec<_> = measured.collect();
    let cost = |found: &&(Scheme, f64, Option<f64>)| found.2.map_or(u64::MAX, |ms| (1e9 * ms) as u64);
    let within = measured.iter().filter(|(_, error_deg, _)| *error_deg <= share_deg).min_by_key(cost);
    let best = measured.iter().min_by(|one, other| one.1.total_cmp(&other.1));
    *within.or(best).expect("there is a scheme")
}

/// Why a plan misses a tolerance (degrees), with its numbers.
fn conflict(plan: &BendPlan, tolerance_deg: f64) -> Option<String> {
    let (error_deg, measured_deg) = (plan.error_deg(), plan.measured_deg.unwrap_or_default());
    (error_deg > 1.000_1 * tolerance_deg).then(|| {
        format!(
            "`accuracy.bend` = {tolerance_deg} deg is missed: {error_deg:.3} deg rms are expected, of which {measured_deg:.3} by the scheme and rest in steps of a \
             tick, and {:.3} by codes. The accuracy gives way; a larger `tick_hz` lessens the first, a smaller `stream.theta_error_deg` the second",
            f64::from(plan.theta_error_deg) / f64::sqrt(3.0)
        )
    })
}
