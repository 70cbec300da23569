//! The bend field and the forces on it; a step is active regions, contact, wind, and propagation.

use super::bodies::Bodies;
use super::camera::Camera;
use super::causes::{Causes, Limits};
use super::contact::Contact;
use super::flattened::{FlattenedGrass, FlattenedState};
use super::grass_properties::GrassProperties;
use super::grass_state::{self, GrassState};
use super::gust_noise::GustNoise;
use super::prescribed_wind::{PrescribedWind, PrescribedWinds};
use super::regions::Regions;
use super::snow::{SnowField, SnowState};
use super::swept_footprint::SweptFootprint;
use super::wind_drawing::WindDrawings;
use crate::bend::{Executor, Field, FieldState, Kinds, Patch, Report, Scheme, Serial, StateError, StepError, TILE};
use crate::body::{Body, Motion, MotionError};
use crate::grid::{PatchIndex, PatchLayout};
use crate::scene::Scene;
use crate::terrain::{CoverMap, HeightMap};
use crate::wind::WindField;
use crate::wire::PatchCheck;
use crate::wire::quantise::CodeSteps;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Margin around contacts within which patches are woken (m).
const MARGIN_M: f32 = 1.0;

/// Rounds of checksums in a second, over which the patches are spread.
const CHECK_ROUNDS: u64 = 4;

/// The bend field and everything that acts on it.
pub struct BendSimulation {
    field: Field,
    scheme: Scheme,
    height: Arc<HeightMap>,
    properties: GrassProperties,
    gusts: Option<GustNoise>,
    bodies: Bodies,
    winds: PrescribedWinds,
    flattened: FlattenedGrass,
    /// `None` where no snow lies.
    snow: Option<SnowField>,
    /// Causes of the newest step.
    causes: Causes,
    rejected: Vec<MotionError>,
    rejected_count: u64,
    reset_count: u64,
    regions: Regions,
    /// Limit of awake patches of the scene.
    awake_limit: usize,
    report: Report,
    steps: CodeSteps,
}

/// A copy of the state of a [`BendSimulation`].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BendState {
    field: FieldState,
    flattened: FlattenedState,
    /// Empty where no snow lies.
    snow: SnowState,
    gusts_secs: Option<f64>,
    winds_secs: f64,
    causes: Causes,
    rejected_count: u64,
    reset_count: u64,
    evicted: u64,
    report: Report,
}

impl BendSimulation {
    /// Grass at rest, pressed by objects of these shapes, in the order of [`VehicleKind::ALL`](crate::scene::VehicleKind::ALL). A wind whose drawing is not
    /// among `drawings` is left out.
    pub fn new(scene: &Scene, height: Arc<HeightMap>, cover: &CoverMap, bodies: &[Body], drawings: &WindDrawings) -> Self {
        let (layout, settings, limit) = (PatchLayout::from(&scene.patches), scene.bend, scene.patches.awake_limit as usize);
        let field = Field::new(layout, Kinds::of(scene, cover))
            .with_edges(settings.edges)
            .with_seams(settings.seams)
            .with_rest(settings.rest())
            .with_ground_contact(settings.ground_contact)
            .with_awake_limit(limit);
        // As many tiles as in all awake patches together.
        let tile_limit = limit * (layout.cells as usize / TILE).pow(2);
        Self {
            field,
            scheme: settings.scheme,
            height,
            properties: GrassProperties::new(scene, cover),
            gusts: GustNoise::new(scene),
            bodies: Bodies::new(bodies, &scene.objects, settings.object_contact),
            winds: PrescribedWinds::new(scene, drawings),
            flattened: FlattenedGrass::new(layout, scene.grass.laid_recovery_secs, tile_limit),
            snow: SnowField::new(layout, &scene.snow, tile_limit),
            causes: Causes::default(),
            rejected: vec![],
            rejected_count: 0,
            reset_count: 0,
            regions: Regions::new(limit),
            awake_limit: limit,
            report: Report::default(),
            steps: CodeSteps::from(&scene.stream),
        }
    }

    /// The bend field.
    pub fn field(&self) -> &Field {
        &self.field
    }

    /// Scheme of the bend field.
    pub fn scheme(&self) -> Scheme {
        self.scheme
    }

    /// Diagnostics of the newest step.
    pub fn report(&self) -> Report {
        self.report
    }

    /// Number of patches so far that were put to sleep because of the limit of awake patches.
    pub fn evicted(&self) -> u64 {
        self.regions.evicted()
    }

    /// Largest number of awake patches that the scene allows.
    pub fn awake_limit(&self) -> u32 {
        self.awake_limit as u32
    }

    /// Lowers the limit of awake patches, at most to 1, or raises it again, at most to that of the scene.
    pub fn limit_awake(&mut self, patches: u32) {
        self.regions.set_limit((patches as usize).clamp(1, self.awake_limit));
    }

    /// Number of patches so far that were put to rest because their grass moved faster than the scheme can follow, or was NaN or infinite.
    pub fn reset_count(&self) -> u64 {
        self.reset_count
    }

    /// Grass that stays bent below the weight of objects.
    pub fn flattened(&self) -> &FlattenedGrass {
        &self.flattened
    }

    /// Snow on the land; `None` where none lies.
    pub fn snow(&self) -> Option<&SnowField> {
        self.snow.as_ref()
    }

    /// Steps of the codes.
    pub fn code_steps(&self) -> &CodeSteps {
        &self.steps
    }

    /// Areas swept by prisms of objects in the newest step at less than `below_m` above the terrain, with their clearance (m).
    pub fn swept_below(&self, below_m: f32) -> impl Iterator<Item = (SweptFootprint, f32)> {
        let cell_m = self.field.layout().cell_m;
        self.causes.motions.iter().flat_map(move |motion| self.bodies.swept_below(motion, &self.height, below_m, cell_m))
    }

    /// Total lean of the grass at a position (rad, as a vector along X and Z): wind, flattened grass and bend field together.
    pub fn lean_rad(&self, at_m: [f32; 2], wind: &WindField) -> [f32; 2] {
        grass_state::total_lean_rad(&self.field, &self.flattened, wind, at_m)
    }

    /// Motions that the newest step rejected as invalid. They have no effect on the grass.
    pub fn rejected(&self) -> &[MotionError] {
        &self.rejected
    }

    /// Number of motions rejected so far.
    pub fn rejected_count(&self) -> u64 {
        self.rejected_count
    }

    /// Causes of the newest step.
    pub fn causes(&self) -> &Causes {
        &self.causes
    }

    /// Advances the grass by one step: active regions, contact, prescribed wind, gusts, propagation. Motions are [rounded](Motion::rounded); invalid ones are
    /// [rejected](Self::rejected).
    pub fn step(&mut self, dt_secs: f32, motions: &[Motion], cameras: &[Camera], wind: &WindField, executor: &impl Executor) {
        let motions = self.validated(motions);
        let gusty = self.gusts.as_ref().map(|gusts| gusts.patches(self.field.layout(), cameras)).unwrap_or_default();
        self.causes = Causes { motions, gusty, ..Causes::default() };
        self.advance(dt_secs, Limits::Farthest(cameras), wind, executor);
    }

    /// Advances the grass by one step by the causes of another simulation of the same scene.
    pub fn follow(&mut self, dt_secs: f32, causes: Causes, wind: &WindField, executor: &impl Executor) {
        let [evicted, dropped] = [causes.evicted.clone(), causes.dropped.clone()];
        self.causes = causes;
        self.advance(dt_secs, Limits::Given { evicted: &evicted, dropped: &dropped }, wind, executor);
    }

    fn advance(&mut self, dt_secs: f32, limits: Limits, wind: &WindField, executor: &impl Executor) {
        let layout = *self.field.layout();
        let (bodies, height, properties) = (&self.bodies, &*self.height, &self.properties);
        let motions = &self.causes.motions;
        let contacts: Vec<_> = motions.iter().flat_map(|motion| bodies.contacts(motion, height, properties, layout.cell_m)).collect();
        let winds = self.winds.step(motions.iter().filter(|motion| bodies.has_downwash(motion.kind)), height, dt_secs);
        if self.scheme == Scheme::Modal {
            // Patches put to rest because of invalid values are woken again.
            self.field.wake_all();
        } else {
            let touched = [self.touched(&contacts, &winds), self.causes.gusty.clone()].concat();
            self.causes.evicted = self.regions.update(&mut self.field, &touched, limits);
        }
        let (field, flattened) = (&mut self.field, &mut self.flattened);
        let mut grass = GrassState { field, flattened, wind, height: &self.height, properties: &self.properties };
        let from_objects = contacts.iter().flat_map(|contact| contact.strokes(&layout, dt_secs));
        let strokes: Vec<_> = from_objects.chain(winds.iter().map(|wind| wind.stroke(&layout))).collect();
        grass.press(&strokes, executor);
        if let Some(gusts) = &mut self.gusts {
            gusts.push(&mut self.field, &self.causes.gusty, dt_secs);
        }
        self.causes.dropped = self.flattened.step_within(dt_secs, limits);
        self.press_snow(dt_secs);
        self.report = self.propagate(dt_secs, executor);
        self.reset_count = self.reset_count.wrapping_add(self.report.reset_patches.into());
    }

    /// Presses the snow by all objects, one after another, and lets more drift over it.
    fn press_snow(&mut self, dt_secs: f32) {
        let Some(snow) = &mut self.snow else { return };
        let cell_m = self.field.layout().cell_m;
        for motion in &self.causes.motions {
            for (swept, clearance_m) in self.bodies.swept_below(motion, &self.height, snow.highest_m(), cell_m) {
                snow.press(&swept, clearance_m);
            }
        }
        snow.step(dt_secs);
    }

    /// Checksum of a patch's grass, bend field and flattened, of its snow, and of the number of awake patches.
    pub fn patch_checksum(&self, patch: PatchIndex) -> u16 {
        let bend = self.field.patch(patch).map_or(0, Patch::checksum) ^ self.field.awake_count() as u32;
        let stir = |sum: u32, word: u32| (sum ^ word).wrapping_mul(0x85EB_CA77).rotate_left(13);
        let sum = self.flattened.words_of(patch).fold(bend, stir);
        let sum = self.snow.iter().flat_map(|snow| snow.words_of(patch)).fold(sum, stir);
        (sum ^ (sum >> 16)) as u16
    }

    /// Patches that are checked after step `tick` of a world with `tick_hz` steps per second, with their checksums: each patch that is not at rest, once a
    /// second.
    pub fn checks(&self, tick: u64, tick_hz: f32, executor: &impl Executor) -> Vec<PatchCheck> {
        let ticks_per_round = (tick_hz / CHECK_ROUNDS as f32).round().max(1.0) as u64;
        if !tick.is_multiple_of(ticks_per_round) {
            return vec![];
        }
        let round = tick / ticks_per_round % CHECK_ROUNDS;
        let mut patches: Vec<_> = self.field.awake().map(Patch::index).chain(self.flattened.patches()).collect();
        patches.extend(self.snow.iter().flat_map(SnowField::patches));
        patches.retain(|patch| u64::from(*patch) % CHECK_ROUNDS == round);
        patches.sort_unstable();
        patches.dedup();
        let mut checks: Vec<_> = patches.into_iter().map(|patch| PatchCheck { patch, sum: 0 }).collect();
        executor.for_each(&mut checks, |check| check.sum = self.patch_checksum(check.patch));
        checks
    }

    /// A copy of the state.
    pub fn state(&self) -> BendState {
        let mut state = BendState::default();
        self.save_into(&mut state, &Serial);
        state
    }

    /// Copies the state into `state`, whose memory is used again.
    pub fn save_into(&self, state: &mut BendState, executor: &impl Executor) {
        self.field.save_into(&mut state.field, executor);
        self.flattened.save_into(&mut state.flattened);
        match &self.snow {
            Some(snow) => snow.save_into(&mut state.snow),
            None => state.snow = SnowState::default(),
        }
        state.causes.clone_from(&self.causes);
        (state.gusts_secs, state.winds_secs) = (self.gusts.as_ref().map(GustNoise::time_secs), self.winds.time_secs());
        (state.rejected_count, state.reset_count) = (self.rejected_count, self.reset_count);
        (state.evicted, state.report) = (self.regions.evicted(), self.report);
    }

    /// Restores a copy of the state in the same scene. The errors of the newest step's rejected motions are not part of it.
    ///
    /// # Errors
    /// [`StateError`] when the state does not fit the scene; the grass is then partly restored.
    pub fn restore(&mut self, state: BendState) -> Result<(), StateError> {
        self.field.restore(state.field)?;
        self.flattened.restore(&state.flattened)?;
        if let Some(snow) = &mut self.snow {
            snow.restore(&state.snow)?;
        }
        if let (Some(gusts), Some(secs)) = (&mut self.gusts, state.gusts_secs) {
            gusts.set_time(secs);
        }
        self.winds.set_time(state.winds_secs);
        self.regions.set_evicted(state.evicted);
        self.causes = state.causes;
        (self.rejected_count, self.reset_count, self.report) = (state.rejected_count, state.reset_count, state.report);
        Ok(())
    }

    /// Propagates the waves. Grass that needs more sub-steps than allowed is put to rest and counts as reset.
    fn propagate(&mut self, dt_secs: f32, executor: &impl Executor) -> Report {
        let mut reset_patches = 0;
        loop {
            match self.field.step(self.scheme, dt_secs, executor) {
                Ok(report) => return Report { reset_patches: report.reset_patches + reset_patches, ..report },
                Err(StepError::TooFast { omega_rad_per_s, .. }) => {
                    let is_fastest = |patch: &&Patch| patch.omega_max_rad_per_s() >= omega_rad_per_s;
                    let fastest: Vec<_> = self.field.awake().filter(is_fastest).map(Patch::index).collect();
                    reset_patches += fastest.len() as u32;
                    fastest.into_iter().for_each(|patch| self.field.sleep(patch));
                }
                // Other errors cannot occur in a checked scene: the step is positive, and the modal scheme suits the scene.
                Err(_) => return Report { reset_patches, ..Report::default() },
            }
        }
    }

    /// The valid motions, rounded. The errors of the others are kept.
    fn validated(&mut self, motions: &[Motion]) -> Vec<Motion> {
        self.rejected = motions.iter().filter_map(|motion| motion.check().err()).collect();
        self.rejected_count += self.rejected.len() as u64;
        motions.iter().filter(|motion| motion.check().is_ok()).map(Motion::rounded).collect()
    }

    /// Patches near moving objects and prescribed winds.
    fn touched(&self, contacts: &[Contact], winds: &[PrescribedWind]) -> Vec<PatchIndex> {
        let layout = self.field.layout();
        let around = |[low, high]: [[f32; 2]; 2]| layout.patches_touching(low.map(|m| m - MARGIN_M), high.map(|m| m + MARGIN_M));
        let bodies = contacts.iter().filter(|contact| !contact.is_at_rest).flat_map(|contact| around(contact.swept.bounds_m()));
        bodies.chain(winds.iter().flat_map(|wind| around(wind.footprint().bounds_m()))).collect()
    }
}
