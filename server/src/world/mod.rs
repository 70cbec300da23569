//! The world: one fixed step after another. It has no clock, input or output; the same commands give the same bits.

mod checkpoint;
mod command;
mod departed;

pub use checkpoint::{RestoreError, WorldState};
pub use command::Command;
pub use departed::KEPT_SECS;
pub use prairie_core::grass::Camera;

use crate::bend;
use crate::bend::halving::BendHalving;
use crate::bend::pool::Pool;
use crate::checksum::Checksum;
use crate::detail::{Decision, Decisions, Detail, DetailRange};
use crate::objects::{Environment, Objects};
use crate::plants::PlantDamage;
use crate::race::Race;
use crate::settings_error::SettingsError;
use crate::snapshot::{Diagnostics, PatchQuantiser, Snapshot};
use crate::weather::{StepErrorEstimate, Weather, pilot};
use departed::Departed;
use prairie_core::bend::Scheme;
use prairie_core::body::Motion;
use prairie_core::grass::snow::SnowField;
use prairie_core::grass::wind_drawing::WindDrawings;
use prairie_core::grass::{BendSimulation, BendState, StepRecord, prescribed_wind};
use prairie_core::grid::PatchIndex;
use prairie_core::plant::flora::Flora;
use prairie_core::plant::growth::NutrientMap;
use prairie_core::scene::Scene;
use prairie_core::terrain::{CoverMap, HeightMap};
use prairie_core::wire::{AppliedInput, Drive, ObjectId, ObjectPose, VIEW_RADIUS_LIMIT_M};
use prairie_vehicles::bodies;
use rayon::prelude::*;
use std::collections::VecDeque;
use std::sync::Arc;

/// The maps of a scene.
#[derive(Clone, Debug)]
pub struct Maps {
    /// Terrain heights.
    pub height: HeightMap,
    /// Covering map: grass, species, tree, stone or gap at each position.
    pub cover: CoverMap,
    /// Hand-drawn winds by their names in the scene.
    pub drawings: WindDrawings,
    /// Nutrients of the soil, unless they are generated.
    pub nutrients: Option<Arc<NutrientMap>>,
}

/// Number of the newest steps whose causes are kept: half a second at the highest step rate.
const STEPS_KEPT: usize = 120;

/// Objects, race, wind, grass and underbrush.
pub struct World {
    dt_secs: f32,
    tick: u64,
    height: Arc<HeightMap>,
    extent_m: [f32; 2],
    objects: Objects,
    race: Race,
    weather: Weather,
    bend: BendSimulation,
    plants: PlantDamage,
    cameras: Vec<Camera>,
    departed: Departed,
    /// Highest client number so far.
    newest_client: u32,
    /// The newest steps of the grass, oldest first.
    steps: VecDeque<Arc<StepRecord>>,
    decisions: Decisions,
    /// Only where somebody asks for the error of the bend field's step.
    halving: Option<BendHalving>,
}

impl World {
    /// The initial state of a checked scene: at rest except for the wind.
    ///
    /// # Errors
    /// [`SettingsError`] when settings that are each in range are incompatible with each other.
    pub fn new(scene: &Scene, maps: Maps) -> Result<Self, SettingsError> {
        bend::stability::check(scene)?;
        let weather = Weather::new(scene, &maps.height, &maps.cover).map_err(|error| error.in_settings(scene))?;
        Self::with_weather(scene, maps, weather)
    }

    /// The initial state, except for the weather.
    fn with_weather(scene: &Scene, maps: Maps, weather: Weather) -> Result<Self, SettingsError> {
        check_drawings(scene, &maps.drawings)?;
        let height = Arc::new(maps.height);
        let environment = Environment { height: Arc::clone(&height), cover: Arc::new(maps.cover), extent_m: scene.extent_m() };
        let plants = PlantDamage::new(Flora::new(scene, &environment.cover, maps.nutrients.as_deref()), scene.dt_secs());
        let bodies = bodies(&scene.objects);
        let bend = BendSimulation::new(scene, Arc::clone(&height), &environment.cover, &bodies, &maps.drawings);
        Ok(Self {
            dt_secs: scene.dt_secs(),
            tick: 0,
            height,
            extent_m: scene.extent_m(),
            objects: Objects::new(scene, environment),
            race: Race::new(scene),
            weather,
            bend,
            plants,
            cameras: vec![],
            departed: Departed::default(),
            newest_client: 0,
            steps: VecDeque::new(),
            decisions: Decisions::default(),
            halving: None,
        })
    }

    /// Advances by one fixed step: commands, objects, race, wind, bend field, underbrush.
    pub fn step(&mut self, commands: &[Command]) {
        for command in commands {
            self.execute(command);
        }
        for client in self.departed.expired(self.tick, self.dt_secs) {
            self.give_up(client);
        }
        self.tick += 1;
        let (weather, height) = (&self.weather, &self.height);
        self.objects.step(self.dt_secs, |[x, y, z]| weather.field().wind_at([x, y - height.height_m(x, z), z]));
        let motions = self.objects.motions();
        self.race.step(self.tick, self.objects.driven(&motions));
        self.weather.step(self.tick, &motions, &self.height, self.bend.field());
        self.bend.step(self.dt_secs, &motions, &self.cameras, self.weather.field(), &Pool);
        if let Some(halving) = &mut self.halving {
            halving.sample(self.tick, self.dt_secs, &self.bend);
        }
        self.plants.step(self.tick, self.dt_secs, &self.bend, &self.weather);
        self.record_step(&motions);
    }

    /// Records the causes of the newest step, for replicas of the grass.
    fn record_step(&mut self, motions: &[Motion]) {
        let valid = self.objects.parts().zip(motions).filter(|(_, motion)| motion.check().is_ok());
        let record = StepRecord {
            tick: self.tick,
            wind_tick: self.weather.frame().tick,
            causes: self.bend.causes().clone(),
            objects: valid.map(|(part, _)| part).collect(),
            checks: self.bend.checks(self.tick, 1.0 / self.dt_secs, &Pool),
        };
        if self.steps.len() == STEPS_KEPT {
            self.steps.pop_front();
        }
        self.steps.push_back(Arc::new(record));
    }

    /// The present state, for clients. `quantiser` keeps the codes of the bend field and encodes only changes since its last use.
    pub fn publish(&self, quantiser: &mut PatchQuantiser) -> Snapshot {
        Snapshot {
            tick: self.tick,
            time_secs: self.tick as f64 * f64::from(self.dt_secs),
            objects: self.objects.poses(),
            inputs: self.objects.applied_inputs(),
            object_limit: self.objects.limit(),
            wind: Arc::clone(self.weather.frame()),
            patches: quantiser.quantise(self.tick, &self.bend, |patch| self.is_in_sight(patch), &Pool),
            audience: quantiser.audience().clone(),
            broken: self.plants.broken().clone(),
            standings: self.race.standings(),
            ghost: self.race.ghost(),
            steps: self.steps.iter().cloned().collect(),
            decisions: self.decisions.shown(),
            diagnostics: self.diagnostics(),
        }
    }

    /// The present state, encoded completely. [`publish`](Self::publish) is faster for repeated use.
    pub fn snapshot(&self) -> Snapshot {
        self.publish(&mut PatchQuantiser::default())
    }

    /// Whether nothing but the wind moves: there are no objects, and all patches sleep.
    pub fn is_idle(&self) -> bool {
        self.objects.is_empty() && self.bend.field().awake_count() == 0
    }

    /// Whether nothing but the wind would change: it [is idle](Self::is_idle), and no grass lies flattened.
    pub fn is_at_rest(&self) -> bool {
        self.is_idle() && self.bend.flattened().tiles() == 0
    }

    /// Poses of all objects, ascending by number.
    pub fn poses(&self) -> Vec<ObjectPose> {
        self.objects.poses()
    }

    /// The vehicle of a client.
    pub fn object_of(&self, client: u32) -> Option<ObjectId> {
        self.objects.object_of(client)
    }

    /// Clients that have a vehicle, connected or not, ascending by vehicle.
    pub fn drivers(&self) -> impl Iterator<Item = u32> {
        self.objects.drivers()
    }

    /// Clients that have left and whose vehicles are kept for their return.
    pub fn departed(&self) -> Vec<u32> {
        self.departed.clients()
    }

    /// Clients without a vehicle that have a time in the race, connected or not, ascending.
    pub fn racers_on_foot(&self) -> impl Iterator<Item = u32> {
        self.race.clients().filter(|client| self.object_of(*client).is_none())
    }

    /// A copy of the state of the grass, from which replicas start; `None` for the scheme `modal`, which clients do not have.
    pub fn bend_state(&self) -> Option<BendState> {
        (self.bend.scheme() != Scheme::Modal).then(|| self.bend.state())
    }

    /// Number of steps so far.
    pub fn tick(&self) -> u64 {
        self.tick
    }

    /// Highest client number so far.
    pub fn newest_client(&self) -> u32 {
        self.newest_client
    }

    /// The wind.
    pub fn weather(&self) -> &Weather {
        &self.weather
    }

    /// The bend field and everything that acts on it.
    pub fn bend(&self) -> &BendSimulation {
        &self.bend
    }

    /// The underbrush as it has grown, if the scene has any.
    pub fn flora(&self) -> Option<&Flora> {
        self.plants.flora()
    }

    /// Checksum of the state of objects, race, wind, bend field and underbrush.
    pub fn checksum(&self) -> u64 {
        let mut sum = Checksum::default();
        self.objects.hash(&mut sum);
        self.race.hash(&mut sum);
        self.weather.hash(&mut sum);
        hash_bend(&self.bend, &mut sum);
        self.plants.hash(&mut sum);
        sum.value()
    }

    /// Checksums of the parts of the state, with their names.
    pub fn checksums(&self) -> [(&'static str, u64); 5] {
        let of = |add: &dyn Fn(&mut Checksum)| {
            let mut sum = Checksum::default();
            add(&mut sum);
            sum.value()
        };
        [
            ("objects", of(&|sum| self.objects.hash(sum))),
            ("race", of(&|sum| self.race.hash(sum))),
            ("wind", of(&|sum| self.weather.hash(sum))),
            ("bend field", of(&|sum| hash_bend(&self.bend, sum))),
            ("broken plants", of(&|sum| self.plants.hash(sum))),
        ]
    }

    fn execute(&mut self, command: &Command) {
        match command {
            Command::Spawn { client, kind } => {
                self.departed.forget(*client);
                let center_m = self.spawn_center_m(*client);
                // A vehicle that waits for its client makes room for one that is wanted. A refusal is visible in `object_of`.
                while self.objects.spawn(*client, *kind, center_m).is_none()
                    && let Some(lost) = self.departed.pop_longest()
                {
                    self.give_up(lost);
                }
            }
            Command::Remove { client } => {
                self.departed.forget(*client);
                self.objects.remove(*client);
            }
            Command::Drive { client, number, drive } => {
                self.objects.drive(*client, *drive, AppliedInput { number: *number, tick: self.tick + 1 });
            }
            Command::Cameras(cameras) => self.cameras.clone_from(cameras),
            Command::Join { client } => self.newest_client = self.newest_client.max(*client),
            Command::Leave { client } => {
                if self.objects.object_of(*client).is_some() {
                    self.objects.drive(*client, Drive::default(), AppliedInput::default());
                    self.departed.leave(*client, self.tick);
                } else {
                    self.race.forget(*client);
                }
            }
            Command::Return { client } => self.departed.forget(*client),
            Command::Adapt(decision) => self.adapt(*decision),
        }
    }

    /// Changes the detail.
    fn adapt(&mut self, decision: Decision) {
        let Detail { wind_ticks, awake_limit, .. } = decision.detail;
        self.weather.step_every(wind_ticks.into());
        self.bend.limit_awake(awake_limit);
        self.decisions.note(decision);
    }

    /// What the detail can be adapted to.
    pub fn detail_range(&self) -> DetailRange {
        let own = Detail { wind_ticks: self.weather.own_ticks() as u32, awake_limit: self.bend.awake_limit(), publish_divisor: 1 };
        DetailRange {
            wind_ticks: self.weather.allowed_ticks().iter().map(|ticks| *ticks as u32).collect(),
            own,
            tick_secs: self.dt_secs,
            may_halve_publications: true,
        }
    }

    /// Estimates the errors of the time steps of wind and bend field from now on, for the [diagnostics](Diagnostics).
    pub fn watch_errors(&mut self) {
        self.weather.watch_errors(&self.height);
        self.halving = (self.bend.scheme() != Scheme::Modal).then(BendHalving::default);
    }

    /// Removes the vehicle of a client that does not return, and its times.
    fn give_up(&mut self, client: u32) {
        self.objects.remove(client);
        self.race.forget(client);
    }

    /// Whether a patch may be within the view radius of any camera.
    fn is_in_sight(&self, patch: PatchIndex) -> bool {
        let layout = self.bend.field().layout();
        let center_m = layout.center_m(patch);
        let reach_m = VIEW_RADIUS_LIMIT_M + layout.patch_m();
        self.cameras.iter().any(|camera| (center_m[0] - camera.eye_m[0]).hypot(center_m[1] - camera.eye_m[2]) < reach_m)
    }

    /// Position around which a client's vehicles appear: below its camera, or the centre of the world.
    fn spawn_center_m(&self, client: u32) -> [f32; 2] {
        let eye = self.cameras.iter().find(|camera| camera.client == client).map(Camera::xz);
        eye.filter(|eye| (0..2).all(|axis| (0.0..=self.extent_m[axis]).contains(&eye[axis])))
            .unwrap_or(self.extent_m.map(|extent| 0.5 * extent))
    }

    fn diagnostics(&self) -> Diagnostics {
        let (wind, bend, wind_step) = (self.weather.report(), self.bend.report(), self.weather.step_errors());
        let within_horizon = |error: StepErrorEstimate| error.m_per_s2.map_or(0.0, |rate| (rate * pilot::HORIZON_SECS) as f32);
        Diagnostics {
            step_secs: 0.0,
            step_max_secs: 0.0,
            divergence_rms: wind.divergence_rms_rel as f32,
            wind_energy: wind.kinetic_energy_m2_per_s2,
            bend_activity: activity(&self.bend),
            awake_patches: self.bend.field().awake_count() as u32,
            evicted_patches: self.bend.evicted(),
            reset_patches: self.bend.reset_count(),
            laid_tiles: (self.bend.flattened().tiles() + self.bend.snow().map_or(0, SnowField::tiles)) as u32,
            dropped_tracks: self.bend.flattened().dropped() + self.bend.snow().map_or(0, SnowField::dropped),
            rejected_motions: self.bend.rejected_count(),
            wind_resets: self.weather.resets(),
            substeps: bend.substeps,
            courant: bend.courant_fraction,
            wind_step_secs: self.weather.step_secs() as f32,
            wind_step_error_m_per_s: within_horizon(wind_step.present),
            wind_doubled_error_m_per_s: within_horizon(wind_step.doubled),
            wind_step_samples: wind_step.present.samples,
            wind_doubled_samples: wind_step.doubled.samples,
            bend_step_error_deg: self.halving.as_ref().map_or(0.0, |halving| halving.error_rad().to_degrees()),
            awake_limit: self.decisions.newest().map_or(self.bend.awake_limit(), |newest| newest.detail.awake_limit),
            load_level: self.decisions.newest().map_or(0, |newest| newest.level.into()),
            decisions: self.decisions.count(),
        }
    }
}

/// Sum of θ² + ω² over all cells (mixed units).
fn activity(bend: &BendSimulation) -> f64 {
    let patches: Vec<_> = bend.field().awake().collect();
    let activities: Vec<_> = patches.par_iter().map(|patch| patch.activity()).collect();
    // `sum` of an empty list would be −0.
    activities.into_iter().fold(0.0, |sum, activity| sum + activity)
}

/// Adds the bend field and the flattened grass to a checksum.
fn hash_bend(bend: &BendSimulation, sum: &mut Checksum) {
    for patch in bend.field().awake() {
        sum.add([patch.index()]);
        for row in patch.rows().chain(patch.rows_before()) {
            sum.add(row.into_iter().flatten().map(|v| v.to_bits()));
        }
    }
    sum.add(bend.flattened().words());
    if let Some(snow) = bend.snow() {
        snow.patches().for_each(|patch| sum.add(snow.words_of(patch)));
    }
}

/// Checks that `drawings` has all wind drawings that `scene` names; otherwise the error names the first that is missing.
fn check_drawings(scene: &Scene, drawings: &WindDrawings) -> Result<(), SettingsError> {
    let mut missing = prescribed_wind::named_drawings(scene).filter(|(_, name)| !drawings.contains_key(*name));
    missing.next().map_or(Ok(()), |(field, name)| {
        Err(SettingsError { field: field.to_owned(), message: format!("names the drawing `{name}`, which is not among the maps") })
    })
}

/// All incompatibilities among the settings of `scene`, found without creating a world.
pub fn check(scene: &Scene) -> Vec<SettingsError> {
    let wind = crate::weather::check(scene).map_err(|error| error.in_settings(scene));
    bend::stability::check(scene).err().into_iter().chain(wind.err()).collect()
}
