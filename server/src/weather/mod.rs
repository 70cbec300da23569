//! The wind of a scene: the solver, its step interval, and the wind for other parts of the world.

mod box_terrain;
mod canopy_cover;
mod carrier;
mod checkpoint;
mod fixed_solids;
pub(crate) mod pilot;
mod rest;
mod settings;
mod step_halving;
mod vehicles;

use crate::checksum::Checksum;
use crate::settings_error::SettingsError;
use crate::snapshot::WindFrame;
use box_terrain::BoxTerrain;
use canopy_cover::CanopyCover;
use carrier::Carrier;
pub use checkpoint::{WeatherRestoreError, WeatherState};
use fixed_solids::FixedSolids;
use glam::Vec3;
use prairie_core::bend::Field;
use prairie_core::body::Motion;
use prairie_core::scene::{Scene, WindTiling};
use prairie_core::terrain::{CoverMap, HeightMap, KindMap};
use prairie_core::wind::WindField;
use prairie_core::wire::{Shape, TurbulenceState};
use prairie_wind::state::MAX_SUBSTEPS;
use prairie_wind::{Air, Body, Config, ConfigError, Jet, Method, Real, SolidError, StepError, StepReport};
use rest::Rest;
use settings::settings;
use std::sync::Arc;
use step_halving::StepHalving;
pub use step_halving::{StepErrorEstimate, StepErrors};
use vehicles::Vehicles;

/// Rate at which the wind is released to the rest of the world and to clients (Hz), rounded to whole solver steps.
const FRAME_HZ: f32 = 6.0;
/// Longest step to which a calm wind, or a loaded server, may stretch the scene's own (s), and by which factor.
const LONGEST_STEP_SECS: f64 = 0.25;
const LARGEST_STRETCH: u64 = 8;
/// Cell steps of the solver's warm-up, so that there are gusts from the start; and the largest number of warm-up steps.
const WARM_UP_CELL_STEPS: usize = 1 << 20;
const WARM_UP_STEPS: usize = 120;

/// The wind of a scene.
pub struct Weather {
    air: Air<f32>,
    method: Method,
    rest: Rest,
    config: Config,
    tiling: WindTiling,
    ticks_per_step: u64,
    /// Ticks per step from the next tick on that both have in common.
    wanted_ticks: u64,
    /// Allowed ticks per step, ascending, and the scene's own.
    allowed_ticks: Vec<u64>,
    own_ticks: u64,
    tick_hz: f32,
    dt_secs: f32,
    /// Ticks per frame.
    ticks_per_frame: u64,
    step_secs: f64,
    report: StepReport,
    resets: u64,
    terrain: BoxTerrain,
    solids: FixedSolids,
    vehicles: Vehicles,
    /// Stones, models and vehicles that are walls or slow the air, set before each step.
    bodies: Vec<Body>,
    canopy: Option<CanopyCover>,
    carrier: Carrier,
    turbulence: TurbulenceState,
    field: WindField,
    frame: Arc<WindFrame>,
    /// Only where somebody asks for the error of the step.
    halving: Option<Box<StepHalving>>,
}

/// Reason why the wind of a scene cannot be simulated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum WeatherError {
    /// A setting is out of range, or incompatible with another.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// The settings are incompatible with the solver's step.
    #[error(transparent)]
    Step(#[from] StepError),
    /// The terrain does not fit into the box.
    #[error(transparent)]
    Solid(#[from] SolidError),
}

/// Checks the wind settings of `scene` without creating a solver.
///
/// # Errors
/// As [`Weather::new`], except for terrain that fills the box and a wind that diverges while it warms up.
pub fn check(scene: &Scene) -> Result<(), WeatherError> {
    let (method, config) = settings(scene);
    let (_, step_secs) = step_interval(scene);
    Air::<f32>::check(method, &config)?;
    Ok(Air::<f32>::check_step(method, &config, step_secs)?)
}

impl WeatherError {
    /// The error as one in the settings of `scene`.
    pub fn in_settings(self, scene: &Scene) -> SettingsError {
        match self {
            Self::Step(StepError::TooLong { what: "viscosity_m2_per_s", dt_secs, needed, .. }) => {
                let (viscosity, [x, y, z]) = (scene.wind.viscosity_m2_per_s, scene.wind.spacing_m);
                let message = format!(
                    "is {viscosity}, which needs {needed:.0} sub-steps of diffusion in the wind's step of {dt_secs:.3} s on cells of {x} × {y} × {z} m; \
                     allowed: {MAX_SUBSTEPS}. Take a smaller value or a larger `wind.spacing_m`"
                );
                SettingsError { field: "wind.viscosity_m2_per_s".to_owned(), message }
            }
            other => SettingsError { field: "wind".to_owned(), message: format!("makes no wind: {other}") },
        }
    }
}

impl Weather {
    /// The wind of `scene` over its terrain, after a warm-up.
    ///
    /// # Errors
    /// [`WeatherError`] when the solver rejects the scene's settings.
    pub fn new(scene: &Scene, height: &HeightMap, cover: &CoverMap) -> Result<Self, WeatherError> {
        Self::after(scene, height, cover, warm_up(scene))
    }

    /// The wind of `scene` over its terrain, after a number of steps of a duration (s).
    fn after(scene: &Scene, height: &HeightMap, cover: &CoverMap, (steps, warm_up_secs): (usize, f64)) -> Result<Self, WeatherError> {
        let (method, config) = settings(scene);
        let terrain = BoxTerrain::new(scene, height);
        let solids = FixedSolids::new(scene, height, cover, &terrain);
        let mut air = initial_air(method, &config, &terrain, &solids, height)?;
        let (ticks_per_step, step_secs) = step_interval(scene);
        let mut report = StepReport::default();
        for step in 0..steps {
            air.set_intensity_secs(warm_up_secs * (step as f64 - steps as f64));
            report = air.step(warm_up_secs, &[])?;
        }
        let mut weather = Self {
            canopy: config.canopy.map(|canopy| CanopyCover::new(scene, cover, canopy.height_m)),
            tiling: scene.wind.tiling,
            carrier: Carrier::new(&config),
            rest: Rest::new(&config, scene.stream.wind_error_m_per_s),
            turbulence: TurbulenceState::default(),
            field: WindField::still(scene, Arc::new(KindMap::new(scene, cover))),
            frame: Arc::default(),
            resets: 0,
            air,
            method,
            allowed_ticks: allowed_ticks(method, &config, ticks_per_step, scene.dt_secs()),
            own_ticks: ticks_per_step,
            wanted_ticks: ticks_per_step,
            tick_hz: scene.tick_hz,
            dt_secs: scene.dt_secs(),
            halving: None,
            config,
            ticks_per_step,
            ticks_per_frame: frame_interval(scene.tick_hz, ticks_per_step),
            step_secs,
            report,
            terrain,
            vehicles: Vehicles::new(scene),
            bodies: solids.bodies.clone(),
            solids,
        };
        weather.release(0);
        Ok(weather)
    }

    /// Advances the solver when a step of it is due at this tick, and releases a frame when that is due.
    pub fn step(&mut self, tick: u64, motions: &[Motion], height: &HeightMap, grass: &Field) {
        if !tick.is_multiple_of(self.ticks_per_step) {
            return;
        }
        // In a box that is tiled by patch, a jet would appear in every patch.
        let motions = if self.tiling == WindTiling::Patch { &[] } else { motions };
        let ground_m = |motion: &Motion| self.terrain.zero_m(height.height_m(motion.to.position_m[0], motion.to.position_m[2]));
        let in_box = |motion: &Motion| Motion { velocity_m_per_s: self.terrain.velocity_in_box(motion, height), ..*motion };
        let jets: Vec<_> = motions.iter().filter_map(|motion| self.vehicles.jet(&in_box(motion), ground_m(motion))).collect();
        self.bodies.truncate(self.solids.bodies.len());
        self.bodies.extend(motions.iter().filter_map(|motion| self.vehicles.body(&in_box(motion), ground_m(motion))));
        if !self.rests(&jets) {
            self.advance(tick, motions, &jets, height, grass);
        } else if let Some(halving) = &mut self.halving {
            halving.rest();
        }
        if tick.is_multiple_of(self.ticks_per_frame) {
            self.release(tick);
        }
        if self.wanted_ticks != self.ticks_per_step && tick.is_multiple_of(self.wanted_ticks) {
            self.set_interval(self.wanted_ticks);
        }
    }

    /// Steps the solver every so many ticks, from the next tick on at which the present step ends and such a step begins. Intervals that are not
    /// [allowed](Self::allowed_ticks) change nothing.
    pub fn step_every(&mut self, ticks: u64) {
        if self.allowed_ticks.contains(&ticks) {
            self.wanted_ticks = ticks;
        }
    }

    fn set_interval(&mut self, ticks: u64) {
        let before = self.ticks_per_step;
        (self.ticks_per_step, self.step_secs) = (ticks, (ticks as f32 * self.dt_secs).into());
        self.ticks_per_frame = frame_interval(self.tick_hz, ticks);
        if let Some(halving) = &mut self.halving {
            halving.change_step(ticks as f64 / before as f64);
        }
    }

    /// Allowed ticks per step of the solver, ascending.
    pub fn allowed_ticks(&self) -> &[u64] {
        &self.allowed_ticks
    }

    /// Ticks per step of the solver as the scene has it.
    pub fn own_ticks(&self) -> u64 {
        self.own_ticks
    }

    /// Duration of a step of the solver (s).
    pub fn step_secs(&self) -> f64 {
        self.step_secs
    }

    /// Estimates the error of the time step from now on, which costs one or two more steps a second.
    pub fn watch_errors(&mut self, height: &HeightMap) {
        // A world whose air cannot be made twice has no air.
        self.halving = StepHalving::new(self, height).ok().map(Box::new);
    }

    /// Estimated errors of the time step; none without [`watch_errors`](Self::watch_errors).
    pub fn step_errors(&self) -> StepErrors {
        self.halving.as_ref().map(|halving| halving.errors()).unwrap_or_default()
    }

    /// Whether the air is at rest and nothing drives it. Air that is nearly at rest comes to rest.
    fn rests(&mut self, jets: &[Jet]) -> bool {
        if !jets.is_empty() || !self.rest.is_undriven(&self.bodies) {
            return false;
        }
        let speeds_m_per_s = self.air.diagnostics().max_speed_m_per_s;
        if !self.rest.holds(speeds_m_per_s) {
            return false;
        }
        if speeds_m_per_s != [0.0; 3] {
            self.air.set_velocity(|_| [0.0; 3]);
            self.report = StepReport::default();
        }
        true
    }

    /// Takes a step of the solver.
    fn advance(&mut self, tick: u64, motions: &[Motion], jets: &[Jet], height: &HeightMap, grass: &Field) {
        if self.tiling == WindTiling::Follow {
            self.follow(motions);
        }
        if let (Some(canopy), WindTiling::Box | WindTiling::Follow) = (&mut self.canopy, self.tiling) {
            self.air.set_canopy_fraction(canopy.fractions(grass));
        }
        self.air.set_bodies(&self.bodies).expect("bodies that may not be set are left out");
        // The intensities follow the world's time, so that they neither run during the warm-up nor start again after a failed step.
        let intensity_secs = self.step_secs * ((tick / self.ticks_per_step) as f64 - 1.0);
        self.air.set_intensity_secs(intensity_secs);
        let mut halving = self.halving.take();
        if let Some(halving) = &mut halving {
            halving.begin(self, tick, intensity_secs, jets);
        }
        match self.air.step(self.step_secs, jets) {
            Ok(report) => self.report = report,
            // The state is invalid: the air restarts from the mean wind.
            Err(_) => {
                self.air = initial_air(self.method, &self.config, &self.terrain, &self.solids, height)
                    .expect("the same settings were accepted before");
                self.resets += 1;
                if let Some(halving) = &mut halving {
                    halving.discard();
                }
            }
        }
        if let Some(halving) = &mut halving {
            halving.end(self);
        }
        self.halving = halving;
        let velocities = self.velocities();
        self.carrier.advance(&mut self.turbulence, &velocities, self.step_secs);
    }

    /// Puts the seam of the periodic box on the side opposite to the centre of all objects.
    fn follow(&mut self, motions: &[Motion]) {
        let count = motions.len() as f64;
        let sponge_m = [0, 2].map(|axis| {
            let side_m = self.config.cells[axis] as f64 * f64::from(self.config.spacing_m[axis]);
            let middle_m = motions.iter().map(|motion| f64::from(motion.to.position_m[axis])).sum::<f64>() / count;
            (middle_m + 0.5 * side_m).rem_euclid(side_m)
        });
        self.air.set_sponge((!motions.is_empty()).then_some(sponge_m));
    }

    /// The wind at any place, that of the newest [frame](Self::frame): world and clients read the same codes, which hold until the next frame.
    pub fn field(&self) -> &WindField {
        &self.field
    }

    /// The newest wind, quantised.
    pub fn frame(&self) -> &Arc<WindFrame> {
        &self.frame
    }

    /// Diagnostics of the newest step.
    pub fn report(&self) -> StepReport {
        self.report
    }

    /// Number of restarts from the mean wind after a failed step.
    pub fn resets(&self) -> u64 {
        self.resets
    }

    /// Adds the wind to a checksum.
    pub(crate) fn hash(&self, sum: &mut Checksum) {
        sum.add(self.air.cell_velocities().flat_map(|velocity| velocity.to_array().map(f32::to_bits)));
        sum.add(self.air.stems().into_iter().flatten().map(|value| value.to_bits()));
        sum.add(self.air.pressure_gradient().into_iter().flatten().map(|value| value.to_bits()));
        sum.add(self.air.dust().into_iter().flatten().map(f32::to_bits));
        sum.add([self.frame.tick as u32]);
        let TurbulenceState { travel_m: [x_m, z_m], path_m, friction_m_per_s } = self.turbulence;
        sum.add([x_m, z_m, path_m].into_iter().flat_map(|m| [m.to_bits() as u32, (m.to_bits() >> 32) as u32]));
        sum.add([friction_m_per_s.to_bits()]);
    }

    /// Wind above the ground at the cell centres (m/s), x fastest, then y, then z, as the solver has it; the [field](Self::field) is that of the newest frame.
    pub fn velocities(&self) -> Vec<Vec3> {
        self.terrain.above_ground(self.air.cell_velocities().collect(), Vec3::lerp)
    }

    /// Concentration of dust above the ground at the cell centres; `None` in a scene without dust.
    pub fn dust(&self) -> Option<Vec<f32>> {
        Some(self.terrain.above_ground(self.air.dust()?.collect(), |a, b, t| a + (b - a) * t))
    }

    /// Releases the wind of this moment as the frame of `tick`.
    fn release(&mut self, tick: u64) {
        let [nx, ny, nz] = self.config.cells;
        let cells = nx * ny * nz;
        let (velocities, steps) = (self.velocities(), self.field.code_steps());
        let mut codes = vec![0; Shape::wind(nx, self.config.dust.is_some()).planes * cells];
        for (at, velocity) in velocities.iter().enumerate() {
            for (plane, component) in velocity.to_array().into_iter().enumerate() {
                codes[plane * cells + at] = steps.wind_code(component);
            }
        }
        if let Some(dust) = self.dust() {
            codes[3 * cells..].iter_mut().zip(dust).for_each(|(code, density)| *code = steps.dust_code(density));
        }
        self.hold(WindFrame { tick, cells: [nx, ny, nz].map(|n| n as u32), turbulence: self.turbulence, codes });
    }

    /// Makes `frame` the newest.
    fn hold(&mut self, frame: WindFrame) {
        self.field.set(&frame.codes, &frame.turbulence);
        self.frame = Arc::new(frame);
    }
}

/// The solver in its initial state, around all that does not move.
fn initial_air<R: Real>(
    method: Method,
    config: &Config,
    terrain: &BoxTerrain,
    solids: &FixedSolids,
    height: &HeightMap,
) -> Result<Air<R>, WeatherError> {
    let mut air = Air::new(method, config)?;
    solids.immerse(&mut air, config, terrain, height)?;
    air.set_bodies(&solids.bodies)?;
    Ok(air)
}

/// Ticks per solver step, and their duration (s).
fn step_interval(scene: &Scene) -> (u64, f64) {
    let ticks = (scene.wind.step_secs * scene.tick_hz).ceil().max(1.0);
    (ticks as u64, (ticks * scene.dt_secs()).into())
}

/// Ticks per frame of a solver whose step takes `ticks_per_step`.
fn frame_interval(tick_hz: f32, ticks_per_step: u64) -> u64 {
    ticks_per_step * (tick_hz / (ticks_per_step as f32 * FRAME_HZ)).round().max(1.0) as u64
}

/// Intervals to which the steps of a solver may be shortened or stretched: the scene's own one times powers of two.
fn allowed_ticks(method: Method, config: &Config, own_ticks: u64, dt_secs: f32) -> Vec<u64> {
    let shorter = std::iter::successors(Some(own_ticks), |ticks| ticks.is_multiple_of(2).then_some(ticks / 2)).skip(1);
    let longer = std::iter::successors(Some(2 * own_ticks), |ticks| Some(2 * ticks)).take_while(|&ticks| {
        let step_secs = ticks as f64 * f64::from(dt_secs);
        let is_stable = Air::<f32>::check_step(method, config, step_secs).is_ok();
        ticks <= LARGEST_STRETCH * own_ticks && step_secs <= LONGEST_STEP_SECS && is_stable
    });
    let mut allowed: Vec<u64> = shorter.chain([own_ticks]).chain(longer).collect();
    allowed.sort_unstable();
    allowed
}

/// Steps of the warm-up, and their duration (s): those of the scene's duration, or [`WARM_UP_STEPS`] of the solver, fewer of many cells.
fn warm_up(scene: &Scene) -> (usize, f64) {
    let (_, step_secs) = step_interval(scene);
    let (cells, secs): (usize, f64) = (scene.wind.cells.iter().map(|n| *n as usize).product(), scene.wind.warm_up_secs.into());
    if secs > 0.0 {
        let steps = (secs / step_secs).round().max(1.0);
        return (steps as usize, secs / steps);
    }
    ((WARM_UP_CELL_STEPS / cells).clamp(1, WARM_UP_STEPS), step_secs)
}

#[cfg(test)]
mod tests;
