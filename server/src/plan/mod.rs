//! The plan of a scene: settings that its file leaves open, chosen for the errors and costs that `[accuracy]` and `[budget]` demand.
//!
//! Errors come from pilot runs (`weather/pilot.rs`) of the scene itself, costs from [fronts] of measured times. A setting that the file states is kept.
//! The plan is resolved into an ordinary scene before anything is made of it.

mod bend;
mod bend_pilot;
mod cache;
mod calibrate;
mod explain;
pub mod fronts;
mod progress;
mod settings;
mod wind;

pub use bend::BendPlan;
pub use calibrate::calibrate;
pub use explain::explain;
pub use progress::{Line, Progress, Silent};
pub use settings::WindSettings;
pub use wind::{Measured, WindPlan};

use crate::scenes::{Explanation, LoadedScene, OpenScene};
use fronts::{Fronts, FrontsInUse};
use prairie_core::scene::{Accuracy, Budget, Scene, parse};
use serde::{Deserialize, Serialize};
use std::io;
use std::path::Path;
use std::sync::Arc;
use wind::Demand;

/// The plan of a scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// Of the wind; the reason where it cannot be measured.
    pub wind: Result<WindPlan, String>,
    /// Of the bend field and its stream.
    pub bend: BendPlan,
    /// Demands that cannot be met, each with its numbers and what gives way.
    pub conflicts: Vec<String>,
}

impl Plan {
    /// The settings of a scene as they are, without errors and costs.
    fn unmeasured(scene: &OpenScene) -> Self {
        let Scene { stream, bend, .. } = &scene.loaded.scene;
        let bend = BendPlan {
            theta_error_deg: stream.theta_error_deg,
            rest_theta_rad: bend.rest_theta_rad,
            scheme: bend.scheme,
            measured_deg: None,
            ms_per_tick: None,
            planned: Vec::new(),
            conflict: None,
        };
        Self { wind: Err(format!("`prairie explain {}` measures it", scene.loaded.name)), bend, conflicts: Vec::new() }
    }
}

/// Whether a scene demands something that is planned.
pub fn is_demanded(scene: &Scene) -> bool {
    let Accuracy { wind, bend, .. } = &scene.accuracy;
    !(wind.is_empty() && bend.is_empty()) || scene.budget.server_ms > 0.0
}

impl OpenScene {
    /// The plan of the scene: as kept beside its file, or from the cache, if it was made before.
    pub fn plan(&self, used: &FrontsInUse, progress: &mut dyn Progress) -> Plan {
        let key = cache::key(self, Some(&used.fronts));
        let kept = cache::read_beside(self).into_iter().chain(cache::read(&key)).find(|plan| self.allows(plan));
        kept.unwrap_or_else(|| {
            let plan = self.plan_anew(&used.fronts, progress);
            cache::write(&key, &plan);
            plan
        })
    }

    /// Whether a plan from a file could be one of this scene: its settings are among the candidates, and the scene that they make is valid.
    fn allows(&self, plan: &Plan) -> bool {
        let scene = &self.loaded.scene;
        let is_candidate = |wind: &WindPlan| settings::candidates(scene, &self.stated, settings::FINEST).contains(&wind.chosen.settings);
        let resolved = self.clone().resolved(plan).scene;
        let is_allowed = plan.wind.as_ref().map_or(true, is_candidate)
            && parse(&resolved.to_toml()).is_ok()
            && crate::world::check(&resolved).is_empty();
        if !is_allowed {
            tracing::warn!(scene = self.loaded.name, "a plan that is kept for the scene is not valid for it, and not used");
        }
        is_allowed
    }

    /// The plan of the scene.
    pub fn plan_anew(&self, fronts: &Fronts, progress: &mut dyn Progress) -> Plan {
        let LoadedScene { scene, height, cover, .. } = &self.loaded;
        let tolerances = scene.accuracy.tolerances();
        let [limit_ms, ..] = scene.budget.limits();
        // A tolerance without a budget may take half a tick: the server has other things to do.
        let half_tick_ms = tolerances.wind.map(|_| f64::from(500.0 / scene.tick_hz));
        let demand = Demand { tolerance: tolerances.wind, limit_ms: limit_ms.or(half_tick_ms) };
        let wind = wind::plan(scene, (height, cover), &self.stated, demand, fronts, progress).map_err(|error| error.to_string());
        progress.start("the drives through the grass");
        let bend = bend::plan(&self.loaded, &self.stated, tolerances.bend_deg, fronts);
        let conflicts = wind.iter().flat_map(|plan| wind_conflicts(plan, demand)).chain(bend.conflict.clone()).collect();
        Plan { wind, bend, conflicts }
    }

    /// The explanation of a plan.
    fn explained(&self, plan: &Plan, used: &FrontsInUse) -> Arc<Explanation> {
        Arc::new(explain::explain_plan(self, plan, used))
    }

    /// The scene with its plan, without tolerances and budgets: an ordinary scene.
    pub fn resolved(self, plan: &Plan) -> LoadedScene {
        let Self { mut loaded, .. } = self;
        if is_demanded(&loaded.scene) {
            plan.bend.apply(&mut loaded.scene);
            if let Ok(WindPlan { own, chosen, wind_error_m_per_s, .. }) = &plan.wind {
                if chosen.settings != own.settings {
                    loaded.scene = chosen.settings.applied_to(&loaded.scene);
                }
                loaded.scene.stream.wind_error_m_per_s = *wind_error_m_per_s;
            }
        }
        (loaded.scene.accuracy, loaded.scene.budget) = (Accuracy::default(), Budget::default());
        loaded
    }

    /// Keeps the plan beside `scene_file`, a copy of the scene's file, if the scene demands one.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn keep_plan(&self, scene_file: &Path) -> io::Result<()> {
        if !is_demanded(&self.loaded.scene) {
            return Ok(());
        }
        cache::write_beside(self, self.plan(&Fronts::in_use(), &mut Silent), scene_file)
    }

    /// The scene, planned if it demands that. Says on stderr and in the log what is going on.
    pub fn planned(self) -> LoadedScene {
        if !is_demanded(&self.loaded.scene) {
            return self.resolved_without_plan();
        }
        let used = Fronts::in_use();
        tracing::info!(scene = self.loaded.name, "planning the settings of the scene; {}", used.origin);
        let plan = self.plan(&used, &mut Line::default());
        for conflict in &plan.conflicts {
            tracing::warn!("the plan: {conflict}");
        }
        if let Err(reason) = &plan.wind {
            tracing::warn!("the wind of the scene is not planned: {reason}");
        }
        let explanation = self.explained(&plan, &used);
        LoadedScene { explanation, ..self.resolved(&plan) }
    }

    fn resolved_without_plan(mut self) -> LoadedScene {
        self.loaded.explanation = Arc::new(explain::explain_unmeasured(&self));
        // What remains asks for nothing that is planned.
        (self.loaded.scene.accuracy, self.loaded.scene.budget) = (Accuracy::default(), Budget::default());
        self.loaded
    }
}

/// Demands on the wind that its plan does not meet, with what they would take.
fn wind_conflicts(plan: &WindPlan, Demand { tolerance, limit_ms }: Demand) -> Vec<String> {
    let WindPlan { chosen, within_tolerance, .. } = plan;
    let mut conflicts = Vec::new();
    if plan.is_cut {
        conflicts.push(format!(
            "the search for the wind's settings ended after {} pilot runs: cheaper or more accurate ones may exist",
            plan.runs[1]
        ));
    }
    let percent = |error: f64| format!("{:.3} %", 100.0 * error);
    if let Some(tolerance) = tolerance.filter(|tolerance| chosen.error > *tolerance) {
        let demanded = percent(tolerance);
        conflicts.push(match within_tolerance {
            Some(found) => format!(
                "`accuracy.wind` = {demanded} needs `budget.server_ms` = {:.4}, and the budget, half a tick if none is stated, is {}: the accuracy gives way, with an expected error of {}",
                found.ms_per_tick,
                limit_ms.unwrap_or_default() as f32,
                percent(chosen.error)
            ),
            None => format!(
                "`accuracy.wind` = {demanded} is held by none of the settings that the scene leaves open: the chosen ones have an expected error of {}",
                percent(chosen.error)
            ),
        });
    }
    if let Some(limit_ms) = limit_ms.filter(|limit_ms| chosen.ms_per_tick > *limit_ms) {
        conflicts.push(format!(
            "`budget.server_ms` = {} is less than the cheapest of the settings that the scene leaves open costs, {:.4}: the budget gives way",
            limit_ms as f32, chosen.ms_per_tick
        ));
    }
    conflicts
}

#[cfg(test)]
mod tests;
