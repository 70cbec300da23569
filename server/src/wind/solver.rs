//! The solver: the state of the air, and one step of it.

use glam::Vec3;
use std::ops::RangeBounds;

use super::config::{Config, ConfigError, Dust};
use super::footprint::Footprint;
use super::health::{self, Health, PlaneSums};
use super::pressure::Projection;
use super::profile::{MeanWind, Relaxation};
use super::trace::{self, Paths};
use super::{Field, Grid, Jet, Place, Real, Velocity, advect, boundary, diffuse, forcing, sources};

/// Most parts a step's diffusion is cut into; see [`StepError::TooViscous`].
pub const MAX_SUBSTEPS: u32 = 256;

/// The solver in the precision the simulation runs in.
pub type WindSolver = Solver<f32>;

/// Incompressible air in a box: velocity on a staggered grid, and dust where asked for.
///
/// ```
/// use glam::Vec3;
/// use server::wind::{Boundary, Config, Gusts, Profile, WindSolver};
///
/// let config = Config {
///     cells: [16, 1, 16],
///     spacing_m: [1.0; 3],
///     boundary: [Boundary::Wrap; 3],
///     mean_wind_m_per_s: [0.0; 3],
///     profile: Profile::Uniform,
///     gusts: Gusts { number: 0, ..Gusts::default() },
///     ..Config::default()
/// };
/// let mut wind = WindSolver::new(&config)?;
/// let k = std::f32::consts::TAU / 16.0;
/// wind.set_velocity(|[x, _, z]| [(k * z).sin(), 0.0, (k * x).sin()]);
/// let report = wind.step(0.1, &[])?;
/// assert!(report.divergence_rms_rel < 1e-6);
/// assert!(wind.velocity_at(Vec3::new(0.0, 0.5, 4.0)).x > 0.9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Solver<R: Real> {
    config: Config,
    grid: Grid<R>,
    time_secs: f64,
    velocity: Velocity<R>,
    dust: Option<Field<R>>,

    centres: Vec<[R; 4]>,
    paths: Paths<R>,
    next_velocity: Velocity<R>,
    next_dust: Option<Field<R>>,
    advection: advect::Scratch<R>,
    projection: Projection,
    mean: MeanWind,
    relaxation: Relaxation<R>,
    footprint: Footprint<R>,
    planes: Vec<PlaneSums>,
}

/// What a step did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepReport {
    /// Largest `|u|·dt/h` of any cell and axis after the step. Above 1 is stable, but blurs in time.
    pub courant: f64,
    /// Root mean square divergence over that of `|u|/h`; rounding keeps it near 1e-7 in f32.
    pub divergence_rms_rel: f64,
    /// Mean of `|u|²/2` (m²/s²).
    pub kinetic_energy_m2_per_s2: f64,
    /// Parts the diffusion of velocity was cut into; 0 without viscosity.
    pub substeps: u32,
}

/// Why a step could not be taken.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StepError {
    /// The step is no positive, finite time. Nothing was changed.
    #[error("wind: dt_secs is {dt_secs}; allowed: above 0, finite")]
    BadTimeStep {
        /// The step asked for.
        dt_secs: f32,
    },
    /// A jet with a number out of range. Nothing was changed.
    #[error("wind: jets[{index}] is {jet:?}; allowed: finite numbers, radius_m above 0, rate_per_sec 0 or more")]
    BadJet {
        /// Its place in the list.
        index: usize,
        /// The jet.
        jet: Jet,
    },
    /// The step is too long for explicit diffusion. Nothing was changed.
    #[error(
        "wind: {what} over dt_secs = {dt_secs} needs {needed:.0} diffusion substeps of at most {stable_dt_secs} s; allowed: {MAX_SUBSTEPS}. Take a shorter step, larger cells or a smaller value"
    )]
    TooViscous {
        /// The setting that asks for it.
        what: &'static str,
        /// The step asked for.
        dt_secs: f32,
        /// Substeps it would take.
        needed: f64,
        /// Longest stable substep.
        stable_dt_secs: f64,
    },
    /// The velocity stopped being a number. The state is lost: [`Solver::restore`] an earlier one.
    #[error("wind: velocity is not finite after the step at {time_secs} s, first in cell {cell:?}")]
    NotFinite {
        /// The first such cell along x, then y, then z.
        cell: [usize; 3],
        /// Time (s) before the step.
        time_secs: f64,
    },
}

/// All that a solver with the same settings needs to go on with the same bits.
#[derive(Clone, Debug, PartialEq)]
pub struct State<R> {
    /// Time since the start (s).
    pub time_secs: f64,
    /// Velocity components on their faces (m/s).
    pub velocity: [Vec<R>; 3],
    /// Dust at the centres of cells; empty without dust.
    pub dust: Vec<R>,
}

/// A state that does not fit the solver's grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("wind: state has {found} values of {what}; this grid has {expected}")]
pub struct StateError {
    /// The field in question.
    pub what: &'static str,
    /// Values in the state.
    pub found: usize,
    /// Values in the solver.
    pub expected: usize,
}

impl<R: Real> Solver<R> {
    /// Air that already moves with the mean wind, without gusts.
    ///
    /// # Errors
    /// The first setting outside of its range.
    pub fn new(config: &Config) -> Result<Self, ConfigError> {
        config.validate()?;
        let grid = config.grid::<R>();
        let mean = MeanWind::new(config);
        let dust = config.dust.map(|_| Field::zeros(&grid, Place::Centre));
        let mut solver = Self {
            time_secs: 0.0,
            velocity: Velocity::zeros(&grid),
            centres: vec![[R::zero(); 4]; grid.len()],
            paths: Paths::zeros(&grid),
            next_velocity: Velocity::zeros(&grid),
            next_dust: dust.clone(),
            advection: advect::Scratch::new(&grid),
            projection: Projection::new(&grid),
            relaxation: Relaxation::new(&grid, &mean),
            footprint: Footprint::default(),
            planes: vec![PlaneSums::default(); grid.cells[2]],
            config: config.clone(),
            grid,
            dust,
            mean,
        };
        solver.set_velocity(|[_, y, _]| mean.at(y.wide()).map(R::of));
        Ok(solver)
    }

    /// Advances the air by `dt_secs` (s), driven by the mean wind, the random sources and `jets`.
    ///
    /// # Errors
    /// See [`StepError`].
    pub fn step(&mut self, dt_secs: f32, jets: &[Jet]) -> Result<StepReport, StepError> {
        self.check(dt_secs, jets)?;
        self.begin(dt_secs)?;
        self.carry_on();
        self.finish(dt_secs, jets)
    }

    /// The first third of [`Solver::step`], for a caller who has no time for a whole step at once: `begin`, [`carry_on`](Self::carry_on)
    /// and [`finish`](Self::finish) in this order are a step, with the same bits. What is read of the air's velocity at the centres of
    /// cells meanwhile is that of the step before.
    ///
    /// # Errors
    /// See [`StepError`]; nothing was changed.
    pub fn begin(&mut self, dt_secs: f32) -> Result<(), StepError> {
        self.check(dt_secs, &[])?;
        trace::trace(&self.grid, &self.centres, R::of(dt_secs.into()), &mut self.paths);
        self.carry(..1);
        Ok(())
    }

    /// The second third of [`Solver::step`].
    pub fn carry_on(&mut self) {
        self.carry(1..);
    }

    /// The last third of [`Solver::step`].
    ///
    /// # Errors
    /// See [`StepError`].
    pub fn finish(&mut self, dt_secs: f32, jets: &[Jet]) -> Result<StepReport, StepError> {
        let substeps = self.check(dt_secs, jets)?;
        self.push(dt_secs, jets);
        boundary::close_walls(&self.grid, &mut self.velocity);
        self.diffuse(dt_secs, substeps);
        self.projection.project(&self.grid, &mut self.velocity);
        let health = self.measure(dt_secs);
        if !health.kinetic_energy_m2_per_s2.is_finite() {
            let cell = health::first_bad_cell(&self.grid, &self.centres).unwrap_or_default();
            return Err(StepError::NotFinite { cell, time_secs: self.time_secs });
        }
        self.time_secs += f64::from(dt_secs);
        let Health { courant, divergence_rms_rel, kinetic_energy_m2_per_s2 } = health;
        Ok(StepReport { courant, divergence_rms_rel, kinetic_energy_m2_per_s2, substeps: substeps.velocity })
    }

    /// Whether a solver with `config` could take steps of `dt_secs` (s), asked without making one.
    ///
    /// # Errors
    /// [`StepError::BadTimeStep`] or [`StepError::TooViscous`].
    pub fn check_step(config: &Config, dt_secs: f32) -> Result<(), StepError> {
        Substeps::new(config, &config.grid::<R>(), dt_secs).map(|_| ())
    }

    fn check(&self, dt_secs: f32, jets: &[Jet]) -> Result<Substeps, StepError> {
        let substeps = Substeps::new(&self.config, &self.grid, dt_secs)?;
        match jets.iter().position(|jet| !jet.is_valid()) {
            Some(index) => Err(StepError::BadJet { index, jet: jets[index] }),
            None => Ok(substeps),
        }
    }

    /// Carries some of the fields, u, v, w and dust, along the paths.
    fn carry(&mut self, which: impl RangeBounds<usize>) {
        let velocities = self.velocity.0.iter_mut().zip(&mut self.next_velocity.0);
        let fields = velocities.chain(self.dust.iter_mut().zip(&mut self.next_dust)).enumerate();
        for (_, (field, next)) in fields.filter(|(index, _)| which.contains(index)) {
            advect::advect(self.config.advection, &self.grid, &self.paths, field, next, &mut self.advection);
            std::mem::swap(field, next);
        }
    }

    fn push(&mut self, dt_secs: f32, jets: &[Jet]) {
        let (grid, gusts, dt) = (&self.grid, &self.config.gusts, f64::from(dt_secs));
        for source in sources::sources_at(&self.config, grid, &self.mean, self.time_secs + 0.5 * dt) {
            sources::push(grid, gusts, &source, dt, &mut self.velocity, &mut self.footprint);
            if let (Some(dust), Some(Dust { release_per_sec, .. })) = (&mut self.dust, self.config.dust) {
                sources::release(grid, gusts, &source, release_per_sec.into(), dt, dust, &mut self.footprint);
            }
        }
        for jet in jets {
            forcing::drive(grid, jet, R::of(dt), &mut self.velocity, &mut self.footprint);
        }
        self.relaxation.apply(grid, self.config.relaxation_per_sec.into(), dt, &mut self.velocity);
        if let (Some(field), Some(Dust { settling_per_sec, .. })) = (&mut self.dust, self.config.dust) {
            let left = R::of(1.0 / (1.0 + f64::from(settling_per_sec) * dt));
            field.data.iter_mut().for_each(|density| *density = *density * left);
        }
    }

    fn diffuse(&mut self, dt_secs: f32, substeps: Substeps) {
        let grid = &self.grid;
        let spread = |field: &mut Field<R>, next: &mut Field<R>, diffusivity: f32, parts: u32| {
            let dt = R::of(f64::from(dt_secs) / f64::from(parts));
            for _ in 0..parts {
                diffuse::diffuse(grid, R::of(diffusivity.into()), dt, field, next);
                std::mem::swap(field, next);
            }
        };
        for (field, next) in self.velocity.0.iter_mut().zip(&mut self.next_velocity.0) {
            spread(field, next, self.config.viscosity_m2_per_s, substeps.velocity);
        }
        if let (Some(field), Some(next), Some(dust)) = (&mut self.dust, &mut self.next_dust, self.config.dust) {
            spread(field, next, dust.diffusivity_m2_per_s, substeps.dust);
        }
    }

    fn measure(&mut self, dt_secs: f32) -> Health {
        health::measure(&self.grid, &self.velocity, R::of(dt_secs.into()), &mut self.centres, &mut self.planes)
    }

    /// Sets the velocity (m/s) from a function of position (m), and takes the divergence out of it.
    pub fn set_velocity(&mut self, f: impl Fn([R; 3]) -> [R; 3]) {
        for (axis, field) in self.velocity.0.iter_mut().enumerate() {
            field.fill(&self.grid, |position| f(position)[axis]);
        }
        boundary::close_walls(&self.grid, &mut self.velocity);
        self.projection.project(&self.grid, &mut self.velocity);
        self.measure(0.0);
    }

    /// Velocity (m/s) at a position (m) in the box, trilinear between faces. Wrapped axes repeat; beyond walls the velocity at the wall holds.
    pub fn velocity_at(&self, position_m: Vec3) -> Vec3 {
        let position = position_m.to_array().map(|x| R::of(x.into()));
        Vec3::from_array(std::array::from_fn(|axis| self.velocity.0[axis].at(&self.grid, position).wide() as f32))
    }

    /// Velocities (m/s) at the centres of cells, x fastest, then y, then z: cell (i, j, k) is item `i + nx·(j + ny·k)`.
    pub fn cell_velocities(&self) -> impl ExactSizeIterator<Item = Vec3> + '_ {
        self.centres.iter().map(|&[x, y, z, _]| Vec3::new(x.wide() as f32, y.wide() as f32, z.wide() as f32))
    }

    /// Concentration of dust at the centres of cells, in the order of [`Solver::cell_velocities`]; `None` in clear air.
    pub fn dust(&self) -> Option<&Field<R>> {
        self.dust.as_ref()
    }

    /// The velocity on its faces.
    pub fn velocity(&self) -> &Velocity<R> {
        &self.velocity
    }

    /// The grid.
    pub fn grid(&self) -> &Grid<R> {
        &self.grid
    }

    /// The settings.
    pub fn config(&self) -> &Config {
        &self.config
    }

    /// Time since the start (s).
    pub fn time_secs(&self) -> f64 {
        self.time_secs
    }

    /// A copy of the state, for a checkpoint.
    pub fn state(&self) -> State<R> {
        State {
            time_secs: self.time_secs,
            velocity: [0, 1, 2].map(|axis| self.velocity.0[axis].data.clone()),
            dust: self.dust.as_ref().map_or_else(Vec::new, |dust| dust.data.clone()),
        }
    }

    /// Takes up a state of a solver with the same settings; steps then have the same bits as if it had never stopped.
    ///
    /// # Errors
    /// A field of the wrong size; the solver is then as it was.
    pub fn restore(&mut self, state: &State<R>) -> Result<(), StateError> {
        let fields = ["velocity.x", "velocity.y", "velocity.z"].into_iter().zip(&state.velocity).zip(&self.velocity.0);
        for ((what, found), expected) in fields {
            same_len(what, found.len(), expected.data.len())?;
        }
        same_len("dust", state.dust.len(), self.dust.as_ref().map_or(0, |dust| dust.data.len()))?;
        for (field, values) in self.velocity.0.iter_mut().zip(&state.velocity) {
            field.data.copy_from_slice(values);
        }
        if let Some(dust) = &mut self.dust {
            dust.data.copy_from_slice(&state.dust);
        }
        self.time_secs = state.time_secs;
        self.measure(0.0);
        Ok(())
    }
}

fn same_len(what: &'static str, found: usize, expected: usize) -> Result<(), StateError> {
    if found == expected { Ok(()) } else { Err(StateError { what, found, expected }) }
}

/// Parts the diffusion of each field is cut into.
#[derive(Clone, Copy)]
struct Substeps {
    velocity: u32,
    dust: u32,
}

impl Substeps {
    fn new<R: Real>(config: &Config, grid: &Grid<R>, dt_secs: f32) -> Result<Self, StepError> {
        if !(dt_secs > 0.0 && dt_secs.is_finite()) {
            return Err(StepError::BadTimeStep { dt_secs });
        }
        let count = |what, diffusivity: f32| {
            let stable_dt_secs = diffuse::stable_dt_secs(grid, R::of(diffusivity.into())).wide();
            let needed = (f64::from(dt_secs) / stable_dt_secs).ceil();
            if needed > f64::from(MAX_SUBSTEPS) {
                return Err(StepError::TooViscous { what, dt_secs, needed, stable_dt_secs });
            }
            Ok(needed as u32)
        };
        Ok(Self {
            velocity: count("viscosity_m2_per_s", config.viscosity_m2_per_s)?,
            dust: config.dust.map_or(Ok(0), |dust| count("dust.diffusivity_m2_per_s", dust.diffusivity_m2_per_s))?,
        })
    }
}

#[cfg(test)]
#[path = "solver_tests.rs"]
mod tests;
