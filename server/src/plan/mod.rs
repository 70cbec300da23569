//! The plan of a scene: settings that its file leaves open, chosen for the errors and costs that `[accuracy]` and `[budget]` demand.
//!
//! Errors come from pilot runs (`weather/pilot.rs`) of the scene itself, costs from [fronts] of measured times. A setting that the file states is kept.
//! The plan is resolved into an ordinary scene before anything is made of it.

mod bend;
mod bend_pilot;
mod blade_pilot;
mod blades;
mod cache;
mod calibrate;
mod client_rows;
mod conflicts;
mod explain;
pub mod fronts;
mod picture;
mod progress;
mod settings;
mod wind;

pub use bend::BendPlan;
pub use blades::BladePlan;
pub use calibrate::calibrate;
pub use explain::explain;
pub use picture::PicturePlan;
pub use progress::{Line, Progress, Silent};
pub use settings::WindSettings;
pub use wind::{Measured, WindPlan};

use crate::scenes::{Explanation, LoadedScene, OpenScene};
use fronts::{Fronts, FrontsInUse};
use prairie_core::scene::{Accuracy, Budget, PlantCover, Scene, parse};
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
    /// Of the blades; `None` where no single blades are drawn, or nothing is measured.
    #[serde(default)]
    pub blades: Option<BladePlan>,
    /// Of the picture; `None` where nothing is measured.
    #[serde(default)]
    pub picture: Option<PicturePlan>,
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
        let wind = Err(format!("`prairie explain {}` measures it", scene.loaded.name));
        Self { wind, bend, blades: None, picture: Some(picture::plan(&scene.loaded.scene, &[], None)), conflicts: Vec::new() }
    }
}

/// Whether a scene demands something that is planned.
pub fn is_demanded(scene: &Scene) -> bool {
    let (Accuracy { wind, bend, blades, picture, .. }, Budget { server_ms, kbit_per_s, .. }) = (&scene.accuracy, scene.budget);
    [wind, bend, blades].iter().any(|tolerance| !tolerance.is_empty()) || [*picture, server_ms, kbit_per_s].iter().any(|limit| *limit > 0.0)
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
        let has_parts =
            (scene.accuracy.blades.is_empty() || plan.blades.is_some() || plan.wind.is_err() || scene.plants.cover != PlantCover::Blades)
                && (scene.accuracy.picture == 0.0 || plan.picture.is_some());
        let is_allowed = has_parts
            && plan.wind.as_ref().map_or(true, is_candidate)
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
        let [limit_ms, _, limit_kbit_per_s] = scene.budget.limits();
        // A tolerance without a budget may take half a tick: the server has other things to do.
        let half_tick_ms = tolerances.wind.map(|_| f64::from(500.0 / scene.tick_hz));
        let demand = Demand { tolerance: tolerances.wind, limit_ms: limit_ms.or(half_tick_ms), limit_kbit_per_s };
        let wind = wind::plan(scene, (height, cover), &self.stated, demand, fronts, progress).map_err(|error| error.to_string());
        let (wind, winds) = wind.map_or_else(|reason| (Err(reason), None), |(plan, winds)| (Ok(plan), Some(winds)));
        progress.start("the drives through the grass");
        let bend = bend::plan(&self.loaded, &self.stated, tolerances.bend_deg, fronts);
        let blades = winds.as_ref().and_then(|winds| blades::plan(scene, &self.stated, tolerances.blades, winds, fronts));
        let picture = picture::plan(scene, &self.stated, tolerances.picture);
        let unmeasured = (winds.is_none() && tolerances.blades.is_some()).then(|| {
            "`accuracy.blades` is not planned, since the wind in which they swing is not measured: the accuracy gives way".to_owned()
        });
        let of_blades = blades.as_ref().map_or(unmeasured, |plan| plan.conflict.clone());
        let others = [bend.conflict.clone(), of_blades, picture.conflict.clone()];
        let conflicts = wind.iter().flat_map(|plan| conflicts::of_wind(plan, demand)).chain(others.into_iter().flatten()).collect();
        Plan { wind, bend, blades, picture: Some(picture), conflicts }
    }

    /// The explanation of a plan.
    fn explained(&self, plan: &Plan, used: &FrontsInUse) -> Arc<Explanation> {
        Arc::new(explain::explain_plan(self, plan, used))
    }

    /// The scene with its plan, without tolerances and budgets but the frame time of clients: an ordinary scene.
    pub fn resolved(self, plan: &Plan) -> LoadedScene {
        let Self { mut loaded, .. } = self;
        if is_demanded(&loaded.scene) {
            plan.bend.apply(&mut loaded.scene);
            plan.blades.iter().for_each(|blades| blades.apply(&mut loaded.scene));
            plan.picture.iter().for_each(|picture| picture.apply(&mut loaded.scene));
            if let Ok(WindPlan { own, chosen, wind_error_m_per_s, .. }) = &plan.wind {
                if chosen.settings != own.settings {
                    loaded.scene = chosen.settings.applied_to(&loaded.scene);
                }
                loaded.scene.stream.wind_error_m_per_s = *wind_error_m_per_s;
            }
        }
        remove_demands(&mut loaded.scene);
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
        remove_demands(&mut self.loaded.scene);
        self.loaded
    }
}

/// Removes all tolerances and budgets but the frame time, which clients keep themselves.
fn remove_demands(scene: &mut Scene) {
    scene.accuracy = Accuracy::default();
    scene.budget = Budget { client_ms: scene.budget.client_ms, ..Budget::default() };
}

#[cfg(test)]
mod tests;
