//! Pilot runs: the error of settings of a scene's wind, measured on the scene itself against a reference run.
//!
//! All runs begin with one state, the scene's wind after its warm-up, and last [`HORIZON_SECS`]. The reference has finer cells, steps of half a tick and double
//! precision. The error is that of the horizontal wind of the lowest cells, which the grass feels, as the codes of the stream give it to the world: the root of
//! the mean square difference over places and steps, relative to the root mean square of the reference. It is the same on every machine.

use super::box_terrain::BoxTerrain;
use super::canopy_cover::CanopyCover;
use super::fixed_solids::FixedSolids;
use super::settings::settings;
use super::{WeatherError, frame_interval, initial_air, step_interval, warm_up};
use glam::Vec3;
use prairie_core::scene::{Scene, Stream, WindAdvection, WindDiffusion, WindMethod, WindPressure, WindTerrain, WindTiling, WindTime};
use prairie_core::terrain::{CoverMap, HeightMap};
use prairie_core::wind::CellGrid;
use prairie_core::wind::turbulence::RESOLVED_CELLS;
use prairie_core::wire::codec::{self, Shape};
use prairie_core::wire::quantise::CodeSteps;
use prairie_core::wire::{self, ServerMessage, TurbulenceState};
use prairie_wind::{Air, Real, StepReport, transport};

/// Duration of a pilot run (s): a gust crosses some cells in it, and errors have not yet grown by the instability of the flow.
pub(crate) const HORIZON_SECS: f64 = 2.0;
/// Largest number of cells of a reference run.
const REFERENCE_CELLS: u64 = 1 << 18;
/// Largest number of cell-sub-steps of a reference on finer cells than the scene's: minutes on two cores.
const REFERENCE_WORK: f64 = 1e10;
/// Steps of a reference run per tick.
const REFERENCE_STEPS_PER_TICK: usize = 2;
/// Largest number of places along X and Z at which the winds are compared.
const PLACES: usize = 64;
/// Sub-step of transport as a fraction of the longest stable one, as in the solver.
const SAFETY: f64 = 0.8;

/// The reference run of a scene, against which settings of its wind are measured.
pub(crate) struct WindPilot<'a> {
    height: &'a HeightMap,
    cover: &'a CoverMap,
    start: Start,
    ticks: usize,
    places_m: Vec<[f32; 2]>,
    /// Wind at the places after each tick (m/s).
    felt: Vec<Vec<[f32; 2]>>,
    /// Cells of the reference.
    pub(crate) cells: [u32; 3],
    /// Finest factor of the scene's cells along X and Z that is measured: the reference is twice as fine where it may be.
    pub(crate) finest: u32,
    /// Root mean square of the horizontal wind (m/s).
    pub(crate) rms_m_per_s: f64,
    max_speed_m_per_s: [f64; 3],
}

/// Frames of the wind of a run, as the stream would send them.
pub(crate) struct Frames {
    velocities_m_per_s: Vec<Vec<Vec3>>,
    shape: Shape,
    /// Time from one to the next (s).
    secs: f64,
    /// Whether gusts travel in them, so that each differs from the one before.
    has_gusts: bool,
}

impl Frames {
    /// Data with the codes of a stream (kbit/s), the first frame apart.
    pub(crate) fn kbit_per_s(&self, stream: &Stream) -> f64 {
        let codes = CodeSteps::from(stream);
        let coded = |frame: &Vec<Vec3>| -> Vec<i16> {
            (0..3).flat_map(|axis| frame.iter().map(move |velocity| codes.wind_code(velocity[axis]))).collect()
        };
        let all: Vec<_> = self.velocities_m_per_s.iter().map(coded).collect();
        let bytes = all.windows(2).filter(|pair| self.has_gusts || pair[0] != pair[1]);
        let bytes: usize = bytes.map(|pair| wind_message_bytes(codec::encode(self.shape, &pair[1], Some(&pair[0])))).sum();
        8e-3 * bytes as f64 / (self.secs * (all.len().max(2) - 1) as f64)
    }
}

/// The state in which all runs begin.
struct Start {
    air: Air<f64>,
    secs: f64,
}

/// A place to run the wind in.
#[derive(Clone, Copy)]
struct Land<'a> {
    height: &'a HeightMap,
    cover: &'a CoverMap,
}

/// Seconds of the warm-up of a scene's wind.
pub(crate) fn warm_up_secs(scene: &Scene) -> f64 {
    let (steps, secs) = warm_up(scene);
    steps as f64 * secs
}

/// `scene` with all lengths and times of its wind stated that would follow from its cells and steps.
pub(crate) fn with_lengths(scene: &Scene) -> Scene {
    let mut stated = scene.clone();
    let wind = &mut stated.wind;
    wind.reference_height_m = scene.wind.reference_m();
    wind.source_radius_m = scene.wind.gust_radius_m();
    wind.turbulence_below_m = turbulence_below_m(scene);
    wind.warm_up_secs = warm_up_secs(scene) as f32;
    stated
}

/// Longest wavelength (m) of the gusts below the cells.
fn turbulence_below_m(scene: &Scene) -> f32 {
    let ([dx, _, dz], stated_m) = (scene.wind.spacing_m, scene.wind.turbulence_below_m);
    if stated_m > 0.0 { stated_m } else { RESOLVED_CELLS * dx.max(dz) }
}

/// Ticks per step and per frame of a scene's wind.
pub(crate) fn intervals(scene: &Scene) -> [u64; 2] {
    let (ticks, _) = step_interval(scene);
    [ticks, frame_interval(scene.tick_hz, ticks)]
}

/// A scene with the settings of the reference, on cells `factor` times as fine along X and Z.
fn reference_scene(scene: &Scene, factor: u32) -> Scene {
    let mut fine = scene.clone();
    let wind = &mut fine.wind;
    for axis in [0, 2] {
        wind.cells[axis] *= factor;
        wind.spacing_m[axis] /= factor as f32;
    }
    (wind.method, wind.advection, wind.time) = (WindMethod::Staggered, WindAdvection::Conservative, WindTime::RungeKutta3);
    (wind.diffusion, wind.pressure) = (WindDiffusion::Explicit, WindPressure::Direct);
    fine
}

/// Sub-steps of explicit diffusion in the whole reference of `factor` times as fine cells.
fn reference_substeps(scene: &Scene, factor: u32) -> f64 {
    let [dx, dy, dz] = scene.wind.spacing_m.map(f64::from);
    let fine_m = [dx / f64::from(factor), dy, dz / f64::from(factor)];
    let steps = HORIZON_SECS * f64::from(scene.tick_hz) * REFERENCE_STEPS_PER_TICK as f64;
    let step_secs = HORIZON_SECS / steps;
    let number = f64::from(scene.wind.viscosity_m2_per_s) * step_secs * fine_m.iter().map(|side_m| 2.0 / (side_m * side_m)).sum::<f64>();
    steps * number.ceil().max(1.0)
}

/// The finest factor of the cells of a reference, and that of the settings that are measured against it.
fn factors(scene: &Scene) -> [u32; 2] {
    let [nx, ny, nz] = scene.wind.cells;
    let fits = |factor: u32| {
        let cells = u64::from(nx * factor) * u64::from(ny) * u64::from(nz * factor);
        cells <= REFERENCE_CELLS && factor * nx.max(nz) <= 512 && cells as f64 * reference_substeps(scene, factor) <= REFERENCE_WORK
    };
    let finest = [4, 2].into_iter().find(|factor| fits(*factor)).unwrap_or(1);
    [finest, (finest / 2).max(1)]
}

impl<'a> WindPilot<'a> {
    /// Runs the reference of `scene`; settings to measure must share [its lengths and times](with_lengths).
    ///
    /// # Errors
    /// As for the weather of the scene.
    pub(crate) fn new(scene: &Scene, height: &'a HeightMap, cover: &'a CoverMap) -> Result<Self, WeatherError> {
        let mut scene = with_lengths(scene);
        // Dust has no effect on the wind.
        scene.wind.dust.release_per_s = 0.0;
        let ([factor, finest], land) = (factors(&scene), Land { height, cover });
        let start = Start::new(&reference_scene(&scene, 1), land)?;
        let fine = reference_scene(&scene, factor);
        let ticks = (HORIZON_SECS * f64::from(scene.tick_hz)).round() as usize;
        let places_m = places(&fine);
        let (mut felt, mut max_speed_m_per_s) = (Vec::with_capacity(ticks), [0.0; 3]);
        let step_secs = f64::from(scene.dt_secs()) / REFERENCE_STEPS_PER_TICK as f64;
        run::<f64>(&fine, land, &start, step_secs, ticks * REFERENCE_STEPS_PER_TICK, |step, velocities, _| {
            if (step + 1) % REFERENCE_STEPS_PER_TICK == 0 {
                felt.push(felt_at(&fine, velocities, &places_m));
                let fastest = velocities.iter().fold(Vec3::ZERO, |fastest, velocity| fastest.max(velocity.abs())).to_array();
                (0..3).for_each(|axis| max_speed_m_per_s[axis] = f64::max(max_speed_m_per_s[axis], fastest[axis].into()));
            }
        })?;
        let rms_m_per_s = (felt.iter().flatten().map(square).sum::<f64>() / (ticks * places_m.len()) as f64).sqrt();
        Ok(Self { height, cover, start, ticks, places_m, felt, cells: fine.wind.cells, finest, rms_m_per_s, max_speed_m_per_s })
    }

    /// Relative error of the settings of `scene`; infinite where the wind becomes NaN or needs too many sub-steps. 0 in still air.
    pub(crate) fn error(&self, scene: &Scene) -> f64 {
        let mut scene = scene.clone();
        scene.wind.dust.release_per_s = 0.0;
        let [ticks, _] = intervals(&scene);
        let (_, step_secs) = step_interval(&scene);
        let (steps, codes) = ((self.ticks / ticks as usize).max(1), CodeSteps::from(&scene.stream));
        let [mut difference, mut whole] = [0.0; 2];
        let land = Land { height: self.height, cover: self.cover };
        let outcome = run::<f32>(&scene, land, &self.start, step_secs, steps, |step, velocities, _| {
            let coded: Vec<_> = velocities.iter().map(|velocity| coded(&codes, *velocity)).collect();
            let felt = &self.felt[((step + 1) * ticks as usize).min(self.ticks) - 1];
            for (own, wanted) in felt_at(&scene, &coded, &self.places_m).iter().zip(felt) {
                difference += square(&[own[0] - wanted[0], own[1] - wanted[1]]);
                whole += square(wanted);
            }
        });
        match outcome {
            Ok(()) if whole == 0.0 && difference == 0.0 => 0.0,
            Ok(()) => (difference / whole).sqrt(),
            Err(_) => f64::INFINITY,
        }
    }

    /// The frames of the wind with the settings of `scene`, dust apart; `None` where the run fails.
    pub(crate) fn frames(&self, scene: &Scene) -> Option<Frames> {
        let mut scene = scene.clone();
        scene.wind.dust.release_per_s = 0.0;
        let ([ticks, frame_ticks], (_, step_secs)) = (intervals(&scene), step_interval(&scene));
        let (steps, steps_per_frame) = ((self.ticks / ticks as usize).max(1), (frame_ticks / ticks).max(1) as usize);
        let land = Land { height: self.height, cover: self.cover };
        let mut velocities_m_per_s = Vec::new();
        run::<f32>(&scene, land, &self.start, step_secs, steps, |step, velocities, _| {
            if (step + 1).is_multiple_of(steps_per_frame) {
                velocities_m_per_s.push(velocities.to_vec());
            }
        })
        .ok()?;
        let shape = Shape::wind(scene.wind.cells[0] as usize, false);
        Some(Frames { velocities_m_per_s, shape, secs: step_secs * steps_per_frame as f64, has_gusts: scene.wind.turbulence > 0.0 })
    }

    /// The wind at up to `count` places, over the ticks of the reference (m/s).
    pub(crate) fn winds_of_places(&self, count: usize) -> Vec<Vec<[f32; 2]>> {
        let stride = self.places_m.len().div_ceil(count).max(1);
        (0..self.places_m.len()).step_by(stride).map(|place| self.felt.iter().map(|felt| felt[place]).collect()).collect()
    }

    /// Cell-sub-steps of a run of `scene`.
    pub(crate) fn work(&self, scene: &Scene) -> f64 {
        let cells: f64 = scene.wind.cells.iter().map(|n| f64::from(*n)).product();
        cells * self.substeps(scene) * (self.ticks as f64 / intervals(scene)[0] as f64).max(1.0)
    }

    /// Sub-steps that transport takes in a step of `scene` at the highest speeds of the reference; 1 for other advection.
    pub(crate) fn substeps(&self, scene: &Scene) -> f64 {
        let (_, config) = settings(scene);
        if !config.advection.uses_fluxes() {
            return 1.0;
        }
        let viscosity = if scene.wind.diffusion == WindDiffusion::Explicit { f64::from(config.viscosity_m2_per_s) } else { 0.0 };
        let stable_secs = SAFETY * transport::stable_dt_secs(&config.grid::<f64>(), self.max_speed_m_per_s, viscosity);
        (step_interval(scene).1 / stable_secs).ceil().max(1.0)
    }
}

impl Start {
    /// The wind of `scene` after its warm-up.
    fn new(scene: &Scene, land: Land<'_>) -> Result<Self, WeatherError> {
        let (steps, step_secs) = warm_up(scene);
        let (mut air, _) = air::<f64>(scene, land)?;
        for step in 0..steps {
            air.set_intensity_secs(step_secs * (step as f64 - steps as f64));
            air.step(step_secs, &[])?;
        }
        Ok(Self { secs: air.time_secs(), air })
    }
}

/// The air of a scene in its box, with the mean wind.
fn air<R: Real>(scene: &Scene, Land { height, cover }: Land<'_>) -> Result<(Air<R>, BoxTerrain), WeatherError> {
    let (method, config) = settings(scene);
    let terrain = BoxTerrain::new(scene, height);
    let solids = FixedSolids::new(scene, height, cover, &terrain);
    Ok((initial_air(method, &config, &terrain, &solids, height)?, terrain))
}

/// Runs the wind of `scene` from `start`, and shows the velocities above the ground after each step.
fn run<R: Real>(
    scene: &Scene,
    land: Land<'_>,
    start: &Start,
    step_secs: f64,
    steps: usize,
    mut show: impl FnMut(usize, &[Vec3], StepReport),
) -> Result<(), WeatherError> {
    let (mut air, terrain) = air::<R>(scene, land)?;
    air.set_velocity(|position_m| start.air.velocity_at(position_m.map(R::wide)).map(R::of));
    let mut state = air.state();
    state.time_secs = start.secs;
    air.restore(&state).expect("a state of the same box");
    let (_, config) = settings(scene);
    if let (Some(canopy), WindTiling::Box | WindTiling::Follow) = (config.canopy, scene.wind.tiling) {
        air.set_canopy_fraction(CanopyCover::new(scene, land.cover, canopy.height_m).at_rest());
    }
    for step in 0..steps {
        air.set_intensity_secs(step_secs * step as f64);
        let report = air.step(step_secs, &[])?;
        show(step, &terrain.above_ground(air.cell_velocities().collect(), Vec3::lerp), report);
    }
    Ok(())
}

/// Places at centres of cells of `scene` (m, X and Z), at most [`PLACES`] along each axis.
fn places(scene: &Scene) -> Vec<[f32; 2]> {
    let [nx, _, nz] = scene.wind.cells.map(|n| n as usize);
    let [hx, _, hz] = scene.wind.spacing_m;
    let along = |n: usize, h: f32| (0..n).step_by(n.div_ceil(PLACES)).map(move |i| (i as f32 + 0.5) * h);
    along(nz, hz).flat_map(|z| along(nx, hx).map(move |x| [x, z])).collect()
}

/// The horizontal wind of the lowest cells at places.
fn felt_at(scene: &Scene, velocities: &[Vec3], places_m: &[[f32; 2]]) -> Vec<[f32; 2]> {
    let grid = CellGrid::from(&scene.wind);
    places_m.iter().map(|[x, z]| grid.trilinear([*x, 0.0, *z], |cell| [velocities[cell].x, velocities[cell].z])).collect()
}

/// A velocity as the codes of the stream give it to the world.
fn coded(steps: &CodeSteps, velocity: Vec3) -> Vec3 {
    Vec3::from_array(velocity.to_array().map(|speed| steps.wind_m_per_s(steps.wind_code(speed))))
}

/// Size of the message with a frame of the wind (bytes).
fn wind_message_bytes(payload: Vec<u8>) -> usize {
    wire::encode(&ServerMessage::Wind { tick: 0, seq: 0, key: false, turbulence: TurbulenceState::default(), payload }).len()
}

fn square([u, w]: &[f32; 2]) -> f64 {
    f64::from(*u) * f64::from(*u) + f64::from(*w) * f64::from(*w)
}

/// Whether the land is an obstacle to the wind of `scene`, which few schemes know.
pub(crate) fn has_walls(scene: &Scene) -> bool {
    scene.wind.terrain == WindTerrain::Obstacle
}
