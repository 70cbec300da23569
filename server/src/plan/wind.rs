//! The plan of the wind: the cheapest settings within a tolerance, or the most accurate ones within a budget.

use super::blade_pilot::Winds;
use super::fronts::Fronts;
use super::progress::Progress;
use super::settings::{WindSettings, candidates};
use crate::weather::WeatherError;
use crate::weather::pilot::WindPilot;
use prairie_core::scene::{Scene, WindAdvection, WindDiffusion, WindPressure, WindTime};
use prairie_core::terrain::{CoverMap, HeightMap};
use serde::{Deserialize, Serialize};
use std::collections::HashMap;

/// Settings whose most accurate relatives miss the tolerance by this factor are not run: fewer cells or longer steps seldom help.
const HOPELESS: f64 = 1.1;
/// Cell-sub-steps after which no more pilot runs begin: some minutes on two cores.
const WORK_LIMIT: f64 = 1e10;
/// Ratio of errors that count as equal.
const EQUAL: f64 = 1.02;
/// Allowed errors of codes of the wind (m/s).
const CODE_M_PER_S: [f64; 2] = [0.01, 1.0];
/// Ratio of the errors of codes that are tried one after the other.
const CODE_RATIO: f32 = 1.19;
/// Places whose wind bends the blades of a pilot run.
const PLACES: usize = 16;

/// Settings with their measured error and their cost.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// The settings.
    pub settings: WindSettings,
    /// Relative error of the wind that the grass feels; infinite errors are stored as `null`.
    #[serde(with = "or_infinite")]
    pub error: f64,
    /// Mean time per tick (ms).
    pub ms_per_tick: f64,
}

/// Infinite numbers in JSON.
mod or_infinite {
    use serde::{Deserialize as _, Deserializer, Serializer};

    pub(super) fn serialize<S: Serializer>(value: &f64, serializer: S) -> Result<S::Ok, S::Error> {
        if value.is_finite() { serializer.serialize_some(value) } else { serializer.serialize_none() }
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
        Ok(Option::deserialize(deserializer)?.unwrap_or(f64::INFINITY))
    }
}

/// What the wind of a scene is, and what is planned for it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WindPlan {
    /// The scene's own settings.
    pub own: Measured,
    /// The planned settings; the own ones where nothing is planned.
    pub chosen: Measured,
    /// The cheapest settings within the tolerance, whatever they cost; `None` where none is, or none was demanded.
    pub within_tolerance: Option<Measured>,
    /// Cells of the reference, and root mean square of its wind (m/s).
    pub reference: ([u32; 3], f64),
    /// Number of candidates, and of pilot runs.
    pub runs: [usize; 2],
    /// Whether the search ended since its runs had done all the work that a plan may take.
    pub is_cut: bool,
    /// Largest error of a code of the wind (m/s) with the chosen settings: where the plan sets it, half of what the tolerance leaves at the root mean square of
    /// the wind, whose codes then have 0.29 of the tolerance; coarser where the data must be less.
    pub wind_error_m_per_s: f32,
    /// Data of the wind's frames to each client (kbit/s), dust apart; `None` where it is not measured.
    #[serde(default)]
    pub kbit_per_s: Option<f64>,
    /// Error before the codes were made coarser for the data; `None` where they were not.
    #[serde(default)]
    pub error_of_finer_codes: Option<f64>,
}

/// Demands on the wind.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Demand {
    pub(super) tolerance: Option<f64>,
    pub(super) limit_ms: Option<f64>,
    pub(super) limit_kbit_per_s: Option<f64>,
}

/// Pilot runs of a scene, each run once.
pub(super) struct Search<'p> {
    scene: &'p Scene,
    pilot: &'p WindPilot<'p>,
    candidates: Vec<Priced>,
    /// The most accurate candidate of each group, and the one with the shortest step of each family.
    likes: HashMap<Group, WindSettings>,
    shortest: HashMap<Family, WindSettings>,
    known: Vec<(WindSettings, f64)>,
    /// Cell-sub-steps of all runs.
    work: f64,
    progress: &'p mut dyn Progress,
}

/// Cells, advection and time scheme, which decide most about the error.
type Group = ([u32; 3], WindAdvection, WindTime);
/// All but the step.
type Family = (Group, WindDiffusion, WindPressure, u32);

fn group(of: &WindSettings) -> Group {
    (of.cells, of.advection, of.time)
}

fn family(of: &WindSettings) -> Family {
    (group(of), of.diffusion, of.pressure, of.tolerance.to_bits())
}

/// Order of the candidates of a group, the most accurate first.
fn rank(of: &WindSettings) -> (u64, bool, u32, usize) {
    let diffuses = [WindDiffusion::CrankNicolson, WindDiffusion::Explicit].iter().position(|word| *word == of.diffusion).unwrap_or(2);
    (of.ticks, of.pressure != WindPressure::Direct, of.tolerance.to_bits(), diffuses)
}

/// A candidate with its cost.
#[derive(Clone, Copy)]
struct Priced {
    settings: WindSettings,
    ms_per_tick: f64,
}

/// The land of a scene.
pub(super) type Land<'a> = (&'a HeightMap, &'a CoverMap);

/// Plans the wind of `scene`, whose stream has its planned error; without a demand it only measures the scene's own settings.
///
/// # Errors
/// As for the weather of the scene.
pub(super) fn plan(
    scene: &Scene,
    (height, cover): Land<'_>,
    stated: &[String],
    demand: Demand,
    fronts: &Fronts,
    progress: &mut dyn Progress,
) -> Result<(WindPlan, Winds), WeatherError> {
    progress.start("the reference run of the wind");
    let pilot = WindPilot::new(scene, height, cover)?;
    let mut coded = scene.clone();
    let has_rule = !stated.iter().any(|path| path == "stream.wind_error_m_per_s") && pilot.rms_m_per_s > 0.0;
    if let Some(tolerance) = demand.tolerance.filter(|_| has_rule) {
        let code_m_per_s = (0.5 * tolerance * pilot.rms_m_per_s).clamp(CODE_M_PER_S[0], CODE_M_PER_S[1]);
        // Four digits are what a scene file would state.
        coded.stream.wind_error_m_per_s = ((1e4 * code_m_per_s).floor() / 1e4) as f32;
    }
    let own_error = pilot.error(scene);
    let may_coarsen = !stated.iter().any(|path| path == "stream.wind_error_m_per_s");
    let limit_kbit_per_s = demand.limit_kbit_per_s.filter(|_| may_coarsen);
    let first = Search::new(&coded, &pilot, stated, fronts, progress).plan(demand);
    let mut plan = with_data(first, &coded, &pilot, limit_kbit_per_s);
    // Others may hold the tolerance with the coarser codes.
    if let (Some(finer), Some(tolerance)) = (plan.error_of_finer_codes, demand.tolerance.filter(|tolerance| plan.chosen.error > *tolerance))
    {
        coded.stream.wind_error_m_per_s = plan.wind_error_m_per_s;
        let again = with_data(Search::new(&coded, &pilot, stated, fronts, progress).plan(demand), &coded, &pilot, limit_kbit_per_s);
        if again.chosen.error <= tolerance {
            plan = WindPlan { error_of_finer_codes: Some(finer), ..again };
        }
    }
    let winds = Winds { dt_secs: scene.dt_secs(), of_places: pilot.winds_of_places(PLACES) };
    Ok((WindPlan { own: Measured { error: own_error, ..plan.own }, ..plan }, winds))
}

/// The plan with the data of its frames, and with codes that are as much coarser as a limit of the data (kbit/s) needs and the scene allows.
fn with_data(mut plan: WindPlan, coded: &Scene, pilot: &WindPilot<'_>, limit_kbit_per_s: Option<f64>) -> WindPlan {
    let mut scene = plan.chosen.settings.applied_to(coded);
    let Some(frames) = pilot.frames(&scene) else { return plan };
    let mut kbit_per_s = frames.kbit_per_s(&scene.stream);
    let (planned_m_per_s, coarsest_m_per_s) = (plan.wind_error_m_per_s, CODE_M_PER_S[1] as f32);
    while limit_kbit_per_s.is_some_and(|limit| kbit_per_s > limit) && plan.wind_error_m_per_s < coarsest_m_per_s {
        plan.wind_error_m_per_s = ((1e4 * plan.wind_error_m_per_s * CODE_RATIO).floor() / 1e4).min(coarsest_m_per_s);
        scene.stream.wind_error_m_per_s = plan.wind_error_m_per_s;
        kbit_per_s = frames.kbit_per_s(&scene.stream);
    }
    if plan.wind_error_m_per_s > planned_m_per_s {
        plan.error_of_finer_codes = Some(plan.chosen.error);
        plan.chosen.error = pilot.error(&scene);
    }
    WindPlan { kbit_per_s: Some(kbit_per_s), ..plan }
}

impl<'p> Search<'p> {
    /// All candidates of `scene` with their costs.
    pub(super) fn new(
        scene: &'p Scene,
        pilot: &'p WindPilot<'p>,
        stated: &[String],
        fronts: &Fronts,
        progress: &'p mut dyn Progress,
    ) -> Self {
        let cost = |settings: WindSettings| fronts.ms_per_tick(scene, &settings, pilot.substeps(&settings.applied_to(scene)));
        let all = candidates(scene, stated, pilot.finest).into_iter();
        let candidates: Vec<_> = all.map(|settings| Priced { settings, ms_per_tick: cost(settings) }).collect();
        let (mut likes, mut shortest) = (HashMap::new(), HashMap::new());
        for Priced { settings, .. } in &candidates {
            let like = likes.entry(group(settings)).or_insert(*settings);
            if rank(settings) < rank(like) {
                *like = *settings;
            }
            let relative = shortest.entry(family(settings)).or_insert(*settings);
            if settings.ticks < relative.ticks {
                *relative = *settings;
            }
        }
        Self { scene, pilot, candidates, likes, shortest, known: Vec::new(), work: 0.0, progress }
    }

    /// The plan for a demand.
    pub(super) fn plan(&mut self, demand: Demand) -> WindPlan {
        let own = self.measured(self.candidates[0]);
        let within_tolerance = demand.tolerance.and_then(|tolerance| self.cheapest_within(tolerance));
        let is_affordable = |found: &Measured| demand.limit_ms.is_none_or(|limit_ms| found.ms_per_tick <= limit_ms);
        let mut chosen = match (demand.tolerance, demand.limit_ms) {
            (None, None) => own,
            (Some(_), _) if within_tolerance.as_ref().is_some_and(is_affordable) => within_tolerance.unwrap_or(own),
            (_, limit_ms) => self.most_accurate_within(limit_ms.unwrap_or(f64::INFINITY)).unwrap_or(own),
        };
        let is_cut = self.is_spent();
        if is_cut {
            chosen = self.best_known(demand).unwrap_or(chosen);
        }
        let runs = [self.candidates.len(), self.known.len()];
        let (reference, wind_error_m_per_s) = ((self.pilot.cells, self.pilot.rms_m_per_s), self.scene.stream.wind_error_m_per_s);
        WindPlan {
            own,
            chosen,
            within_tolerance,
            reference,
            runs,
            is_cut,
            wind_error_m_per_s,
            kbit_per_s: None,
            error_of_finer_codes: None,
        }
    }

    fn is_spent(&self) -> bool {
        self.work >= WORK_LIMIT
    }

    /// The best of the settings that have been run: the cheapest within tolerance and budget, else the most accurate within the budget.
    fn best_known(&self, Demand { tolerance, limit_ms, .. }: Demand) -> Option<Measured> {
        let error_of = |settings| self.known.iter().find(|(known, _)| *known == settings).map(|(_, error)| *error);
        let run = self
            .candidates
            .iter()
            .filter_map(|&Priced { settings, ms_per_tick }| error_of(settings).map(|error| Measured { settings, error, ms_per_tick }));
        let affordable: Vec<_> = run.filter(|found| limit_ms.is_none_or(|limit_ms| found.ms_per_tick <= limit_ms)).collect();
        let holding = affordable.iter().filter(|found| tolerance.is_some_and(|tolerance| found.error <= tolerance));
        let cheapest = holding.min_by(|one, other| one.ms_per_tick.total_cmp(&other.ms_per_tick));
        cheapest.or_else(|| affordable.iter().min_by(|one, other| one.error.total_cmp(&other.error))).copied()
    }

    /// Error of settings, from a pilot run if there was none yet.
    fn error(&mut self, settings: WindSettings) -> f64 {
        if let Some((_, error)) = self.known.iter().find(|(known, _)| *known == settings) {
            return *error;
        }
        let scene = settings.applied_to(self.scene);
        let error = self.pilot.error(&scene);
        self.work += self.pilot.work(&scene);
        self.known.push((settings, error));
        self.progress.ran(self.known.len(), self.candidates.len());
        error
    }

    fn measured(&mut self, Priced { settings, ms_per_tick }: Priced) -> Measured {
        Measured { settings, error: self.error(settings), ms_per_tick }
    }

    /// Candidates by cost, without iterative pressure solvers that cost more than the exact one.
    fn by_cost(&self) -> Vec<Priced> {
        let key = |of: &WindSettings| (of.cells, of.advection, of.time, of.diffusion, of.ticks);
        let is_direct = |candidate: &&Priced| candidate.settings.pressure == WindPressure::Direct;
        let direct: HashMap<_, _> =
            self.candidates.iter().filter(is_direct).map(|candidate| (key(&candidate.settings), candidate.ms_per_tick)).collect();
        let keeps = |candidate: &&Priced| {
            is_direct(candidate) || direct.get(&key(&candidate.settings)).is_none_or(|direct_ms| *direct_ms > candidate.ms_per_tick)
        };
        let mut sorted: Vec<_> = self.candidates.iter().filter(keeps).copied().collect();
        sorted.sort_by(|one, other| one.ms_per_tick.total_cmp(&other.ms_per_tick));
        sorted
    }

    /// The most accurate relatives of settings: first any with the same cells, advection and time scheme, then those that differ in their step alone.
    fn relatives(&self, of: WindSettings) -> [WindSettings; 2] {
        let [likes, shortest] = [self.likes.get(&group(&of)), self.shortest.get(&family(&of))];
        [likes.copied().unwrap_or(of), shortest.copied().unwrap_or(of)]
    }

    /// The cheapest candidate within a relative error.
    pub(super) fn cheapest_within(&mut self, tolerance: f64) -> Option<Measured> {
        for candidate in self.by_cost() {
            if self.is_spent() {
                break;
            }
            let is_hopeless = self.relatives(candidate.settings).into_iter().any(|relative| self.error(relative) > HOPELESS * tolerance);
            if !is_hopeless && self.error(candidate.settings) <= tolerance {
                return Some(self.measured(candidate));
            }
        }
        None
    }

    /// The most accurate candidate that costs at most `limit_ms`; the cheapest one if all cost more. Candidates with the same cells, advection and time scheme
    /// form a group; the groups come by the error of their most accurate member, until that is larger than the best affordable one.
    pub(super) fn most_accurate_within(&mut self, limit_ms: f64) -> Option<Measured> {
        let sorted = self.by_cost();
        let affordable: Vec<_> = sorted.iter().copied().filter(|candidate| candidate.ms_per_tick <= limit_ms).collect();
        let mut groups: Vec<(WindSettings, f64)> = Vec::new();
        for candidate in &affordable {
            if self.is_spent() {
                break;
            }
            let [like, _] = self.relatives(candidate.settings);
            if groups.iter().all(|(known, _)| *known != like) {
                groups.push((like, self.error(like)));
            }
        }
        groups.sort_by(|one, other| one.1.total_cmp(&other.1));
        let mut best: Option<Measured> = None;
        for (like, floor) in groups {
            if best.is_some_and(|best| floor > best.error) {
                break;
            }
            for candidate in &affordable {
                let [own, shortest] = self.relatives(candidate.settings);
                let is_done = best.is_some_and(|best| best.error <= EQUAL * floor);
                if own != like
                    || is_done
                    || self.is_spent()
                    || best.is_some_and(|best| self.error(shortest) > best.error.max(EQUAL * floor))
                {
                    continue;
                }
                let found = self.measured(*candidate);
                if best.is_none_or(|best| found.error < best.error) {
                    best = Some(found);
                }
            }
        }
        best.or_else(|| Some(self.measured(*sorted.first()?)))
    }

    /// The cheapest candidate within a relative error, found by running all of them.
    #[cfg(test)]
    pub(super) fn brute_force(&mut self, tolerance: f64) -> Option<Measured> {
        let all: Vec<_> = self.candidates.clone().into_iter().map(|candidate| self.measured(candidate)).collect();
        all.into_iter().filter(|found| found.error <= tolerance).min_by(|one, other| one.ms_per_tick.total_cmp(&other.ms_per_tick))
    }
}
