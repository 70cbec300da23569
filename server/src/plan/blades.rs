//! The plan of the blades that clients draw: the integrator of their swing, and the segments of their strips.
//!
//! [Pilot runs](super::blade_pilot) measure both errors relative to the length of a blade. They count as a sum: a strip is off from its curve wherever the tip is.

use super::blade_pilot::{BladePilot, PICTURE_SECS, Winds};
use super::fronts::Fronts;
use prairie_core::scene::{BLADE_STEPS_LIMIT, BladeIntegrator, PlantCover, Scene};
use serde::{Deserialize, Serialize};

/// Largest share of the tolerance that the swing may take.
const SWING_SHARE: f64 = 0.7;
/// Allowed segments of a strip.
pub(super) const SEGMENTS: std::ops::RangeInclusive<u32> = 1..=12;

/// Integrator and segments of blades, with their errors.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BladePlan {
    /// Time integration of the swing.
    pub integrator: BladeIntegrator,
    /// Segments of a near and of a farther blade; 0 where the quality of the picture decides.
    pub segments: [u32; 2],
    /// Root mean square error of the tip over a second of swing, relative to the length.
    pub swing_error: f64,
    /// Largest distance of the coarser strip from its curve, relative to the length, apart from strips whose segments the quality of the picture decides; `None`
    /// where it decides both.
    pub strip_error: Option<f64>,
    /// Fields that the plan has set.
    pub planned: Vec<String>,
    /// Why the tolerance is not met.
    pub conflict: Option<String>,
}

impl BladePlan {
    /// Expected error relative to the length.
    pub fn error(&self) -> f64 {
        self.swing_error + self.strip_error.unwrap_or_default()
    }

    pub(super) fn apply(&self, scene: &mut Scene) {
        (scene.plants.integrator, scene.plants.blade_segments) = (self.integrator, self.segments);
    }
}

/// An integrator with the error of the tip, and the time (ns) that a blade takes in a picture.
#[derive(Clone, Copy, Debug)]
pub(super) struct Swing {
    pub(super) integrator: BladeIntegrator,
    pub(super) error: f64,
    pub(super) ns: f64,
}

/// Plans the blades of a scene in its winds; without a tolerance it only measures. `None` where no single blades are drawn.
pub(super) fn plan(scene: &Scene, stated: &[String], tolerance: Option<f64>, winds: &Winds, fronts: &Fronts) -> Option<BladePlan> {
    if scene.plants.cover != PlantCover::Blades {
        return None;
    }
    let pilot = BladePilot::new(scene, winds);
    let is_open = |field: &str| tolerance.is_some() && !stated.iter().any(|path| path == field);
    let own = scene.plants.integrator;
    let integrators = if is_open("plants.integrator") { allowed(scene) } else { vec![own] };
    let swings: Vec<Swing> = integrators.into_iter().map(|integrator| swing(scene, &pilot, integrator, fronts)).collect();
    let chosen = cheapest(&swings, tolerance.map_or(f64::INFINITY, |tolerance| SWING_SHARE * tolerance));
    let mut segments = scene.plants.blade_segments;
    if let Some(tolerance) = tolerance.filter(|_| is_open("plants.blade_segments")) {
        segments = [fewest(&pilot, tolerance - chosen.error); 2];
    }
    let strip_error = segments.into_iter().filter(|segments| *segments > 0).min().map(|coarser| pilot.strip_error(coarser));
    let changes = [("plants.integrator", chosen.integrator != own), ("plants.blade_segments", segments != scene.plants.blade_segments)];
    let planned = changes.into_iter().filter(|(_, is_changed)| *is_changed).map(|(field, _)| field.to_owned()).collect();
    let plan = BladePlan { integrator: chosen.integrator, segments, swing_error: chosen.error, strip_error, planned, conflict: None };
    let conflict = tolerance.and_then(|tolerance| conflict(&plan, tolerance));
    Some(BladePlan { conflict, ..plan })
}

/// Integrators that are stable with the blades of the scene in few enough steps.
pub(super) fn allowed(scene: &Scene) -> Vec<BladeIntegrator> {
    let all = BladeIntegrator::ALL.iter().copied();
    all.filter(|&integrator| steps(scene, integrator) <= BLADE_STEPS_LIMIT).collect()
}

/// Steps of all blades in a picture.
pub(super) fn steps(scene: &Scene, integrator: BladeIntegrator) -> u32 {
    let mut changed = scene.clone();
    changed.plants.integrator = integrator;
    (PICTURE_SECS / changed.blade_step_secs()).ceil().max(1.0) as u32
}

pub(super) fn swing(scene: &Scene, pilot: &BladePilot, integrator: BladeIntegrator, fronts: &Fronts) -> Swing {
    let steps = steps(scene, integrator);
    Swing { integrator, error: pilot.swing_error(integrator, steps), ns: f64::from(steps) * fronts.blade_ns(integrator) }
}

/// The cheapest of the swings whose error is at most `limit`, or else the most accurate one.
pub(super) fn cheapest(swings: &[Swing], limit: f64) -> Swing {
    let within = swings.iter().filter(|swing| swing.error <= limit).min_by(|one, other| one.ns.total_cmp(&other.ns));
    let best = swings.iter().min_by(|one, other| one.error.total_cmp(&other.error));
    *within.or(best).expect("there is an integrator")
}

/// The fewest segments whose strip is within `limit` of its curve, or else the most.
fn fewest(pilot: &BladePilot, limit: f64) -> u32 {
    SEGMENTS.into_iter().find(|segments| pilot.strip_error(*segments) <= limit).unwrap_or(*SEGMENTS.end())
}

/// Why a plan misses a tolerance, with its numbers.
fn conflict(plan: &BladePlan, tolerance: f64) -> Option<String> {
    let percent = |error: f64| format!("{:.3} %", 100.0 * error);
    (plan.error() > tolerance).then(|| {
        format!(
            "`accuracy.blades` = {} is missed: {} are expected, of which {} by `plants.integrator = \"{}\"` and {} by `plants.blade_segments = [{}, {}]`. The accuracy \
             gives way",
            percent(tolerance),
            percent(plan.error()),
            percent(plan.swing_error),
            plan.integrator.word(),
            percent(plan.strip_error.unwrap_or_default()),
            plan.segments[0],
            plan.segments[1]
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::load;

    fn planned(scene: &Scene, stated: &[String], tolerance: f64) -> BladePlan {
        plan(scene, stated, Some(tolerance), &winds(), &Fronts::built_in()).unwrap()
    }

    fn winds() -> Winds {
        let gust = |place: usize| (0..=30).map(|tick| [4.0 + 0.1 * (tick * place) as f32, 0.2 * tick as f32]).collect();
        Winds { dt_secs: 1.0 / 30.0, of_places: (0..4).map(gust).collect() }
    }

    /// All integrators with all segments: none that holds the tolerance takes less time, and none with this time fewer segments.
    #[test]
    fn planned_blades_hold_their_tolerance_and_nothing_cheaper_does() {
        let mut scene = load("blades").unwrap().scene;
        let (winds, fronts) = (winds(), Fronts::built_in());
        let mut integrators = Vec::new();
        // The grass of the scene, and slow grass, for which all integrators take one step in a picture.
        for (swing_hz, damping) in [(scene.plants.swing_hz, scene.plants.swing_damping), (0.15, 0.5)] {
            (scene.plants.swing_hz, scene.plants.swing_damping) = (swing_hz, damping);
            let pilot = BladePilot::new(&scene, &winds);
            for tolerance in [0.02, 0.05, 0.1, 0.4] {
                let plan = planned(&scene, &[], tolerance);
                assert!(plan.conflict.is_none() && plan.error() <= tolerance && plan.segments[0] == plan.segments[1], "{plan:?}");
                let of = |integrator| swing(&scene, &pilot, integrator, &fronts);
                let own_ns = of(plan.integrator).ns;
                for other in allowed(&scene).into_iter().map(of).filter(|other| other.error <= SWING_SHARE * tolerance) {
                    assert!(own_ns <= other.ns, "{plan:?} {other:?}");
                }
                let coarser = plan.segments[0] - 1;
                assert!(coarser == 0 || plan.swing_error + pilot.strip_error(coarser) > tolerance, "one segment less holds it: {plan:?}");
                integrators.push(plan.integrator);
            }
        }
        assert!(integrators[..4].iter().all(|integrator| *integrator == BladeIntegrator::Exact), "{integrators:?}");
        assert!(integrators[4..].iter().all(|integrator| *integrator == BladeIntegrator::Euler), "{integrators:?}");
    }

    #[test]
    fn stated_settings_are_kept_and_what_they_miss_is_told() {
        let mut scene = load("meadow").unwrap().scene;
        (scene.plants.integrator, scene.plants.blade_segments) = (BladeIntegrator::Verlet, [2, 1]);
        let plan = planned(&scene, &["plants.integrator", "plants.blade_segments"].map(str::to_owned), 0.005);
        assert!(plan.integrator == BladeIntegrator::Verlet && plan.segments == [2, 1] && plan.planned.is_empty());
        let told = plan.conflict.unwrap();
        assert!(told.starts_with("`accuracy.blades` = 0.500 % is missed: ") && told.contains("`plants.blade_segments = [2, 1]`"), "{told}");
        assert!(super::plan(&scene, &[], None, &winds(), &Fronts::built_in()).unwrap().planned.is_empty());
        scene.plants.cover = PlantCover::Shells;
        assert!(super::plan(&scene, &[], Some(0.02), &winds(), &Fronts::built_in()).is_none());
    }
}
