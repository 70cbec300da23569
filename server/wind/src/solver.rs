//! The solver: its state and access to it. Steps are in `step.rs`, the sub-steps of each time scheme in `time_schemes.rs`.

use glam::Vec3;

use super::boundary::BoundaryConditions;
use super::canopy::Stems;
use super::config::{Config, ConfigError};
use super::diagnostics::{self, Diagnostics, PlaneSums};
use super::diffuse::Implicit;
use super::footprint::Footprint;
use super::intensity::Moment;
use super::pressure::{Pressure, Projection};
use super::profile::{MeanWind, Relaxation};
use super::solids::{Drag, Immersed};
use super::sources::Pushes;
use super::state::{SolidError, State, StateError};
use super::trajectory::Trajectories;
use super::{Diffusion, Field, Grid, Location, Real, Velocity, advect, transport};

/// The solver in single precision.
pub type WindSolver = Solver<f32>;

/// Incompressible air in a box: velocity on a staggered grid, and optionally dust.
///
/// The lid-driven cavity at Re = 100, run for half a minute:
///
/// ```
/// use prairie_wind::{Boundary, Config, Gusts, Profile, Solver};
///
/// let lid = Boundary::Lid { velocity_m_per_s: [1.0, 0.0, 0.0] };
/// let config = Config {
///     cells: [16, 16, 1],
///     spacing_m: [1.0 / 16.0; 3],
///     boundary: [[Boundary::NoSlip; 2], [Boundary::NoSlip, lid], [Boundary::Wrap; 2]],
///     viscosity_m2_per_s: 0.01,
///     mean_wind_m_per_s: [0.0; 3],
///     profile: Profile::Uniform,
///     gusts: Gusts { number: 0, ..Gusts::default() },
///     ..Config::default()
/// };
/// let mut air = Solver::<f64>::new(&config)?;
/// air.set_velocity(|[_x, _y, _z]| [0.0; 3]);
/// while air.time_secs() < 30.0 {
///     let report = air.step(0.02, &[])?;
///     assert!(report.divergence_rms_rel < 1e-10);
/// }
/// let [u, v, w] = air.velocity_at([0.5, 0.1, 0.03]);
/// assert!(u < -0.05 && v.abs() < 0.1 && w == 0.0, "the return flow below the centre: {u}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// [`Config`] selects other schemes, for example `advection: Advection::MacCormack, time: TimeScheme::Reflection`. [`Solver::set_walls`] and [`Solver::set_bodies`] add obstacles ([`Solver::set_solid`] whole cells),
/// [`Solver::set_inflow`] sets the velocity on [`Inflow`](super::Boundary::Inflow) faces, [`Solver::samples`] returns every value with its position.
pub struct Solver<R: Real> {
    pub(super) config: Config,
    pub(super) grid: Grid<R>,
    pub(super) time_secs: f64,
    /// Time of the solver (s) at which the intensities of primitives start.
    intensity_start_secs: f64,
    pub(super) velocity: Velocity<R>,
    /// Gradient of pressure over density (m/s²) of the last step, for [`TimeScheme::RungeKutta3`](super::TimeScheme::RungeKutta3).
    pub(super) pressure_gradient: Velocity<R>,
    pub(super) dust: Option<Field<R>>,
    /// Velocity at the start of a sub-step, where dust needs it or the sub-step may be rolled back.
    pub(super) old: Option<Velocity<R>>,
    /// Pressure gradient at the start of a sub-step, for a rollback if the dust, which comes last, fails.
    pub(super) old_pressure_gradient: Option<Velocity<R>>,
    /// Fraction of the canopy that stands in each column of cells, x fastest.
    pub(super) canopy_fraction: Vec<R>,
    pub(super) stems: Option<Stems<R>>,
    pub(super) sponge_m: Option<[f64; 2]>,
    pub(super) solid: Option<Vec<bool>>,
    pub(super) immersed: Option<Immersed<R>>,
    pub(super) drag: Drag<R>,

    pub(super) boundaries: BoundaryConditions<R>,
    pub(super) stages: [Velocity<R>; 2],
    pub(super) dust_stages: [Field<R>; 2],
    pub(super) centres: Vec<[R; 4]>,
    pub(super) trajectories: Trajectories<R>,
    pub(super) advection: advect::AdvectionScratch<R>,
    pub(super) transport: transport::TransportScratch<R>,
    pub(super) projection: Projection,
    pub(super) implicit: Option<Implicit>,
    pub(super) mean: MeanWind,
    pub(super) relaxation: Relaxation<R>,
    pub(super) footprint: Footprint<R>,
    pub(super) pushes: Pushes<R>,
    /// Volume source of each cell (1/s); empty without source or sink primitives.
    pub(super) volume_sources_per_s: Vec<f64>,
    pub(super) planes: Vec<PlaneSums>,
    pub(super) diagnostics: Diagnostics,
}

impl<R: Real> Solver<R> {
    /// Creates a solver whose air moves with the mean wind.
    ///
    /// # Errors
    /// The first setting that is out of range.
    pub fn new(config: &Config) -> Result<Self, ConfigError> {
        config.validate()?;
        let grid = config.grid::<R>();
        let mean = MeanWind::new(config);
        let still = Velocity::zeros(&grid);
        let dust = Field::zeros(&grid, Location::Centre);
        let is_implicit = matches!(config.diffusion, Diffusion::Implicit | Diffusion::CrankNicolson);
        let uses_fluxes = config.advection.uses_fluxes();
        let traced_len = if !uses_fluxes || config.traces_dust() { grid.padded_len() } else { 0 };
        let dust_stage = if config.dust.is_some() { dust.clone() } else { Field { data: Vec::new(), ..dust.clone() } };
        let has_sources = config.primitives.iter().any(|primitive| primitive.is_source());
        let mut boundaries = BoundaryConditions::new(&grid, Box::new(move |[_, y, _], _| mean.at(y.max(0.0))));
        if uses_fluxes {
            boundaries.continue_backflow();
        }
        let mut solver = Self {
            time_secs: 0.0,
            intensity_start_secs: 0.0,
            velocity: still.clone(),
            pressure_gradient: still.clone(),
            dust: config.dust.map(|_| dust.clone()),
            old: (config.dust.is_some() || uses_fluxes).then(|| still.clone()),
            old_pressure_gradient: (config.dust.is_some() && uses_fluxes).then(|| still.clone()),
            canopy_fraction: vec![R::one(); grid.cells[0] * grid.cells[2]],
            stems: Stems::new(&grid, config.canopy.as_ref()),
            sponge_m: None,
            solid: None,
            immersed: None,
            drag: Drag::none(),
            boundaries,
            stages: [still.clone(), still],
            dust_stages: [dust_stage.clone(), dust_stage],
            centres: vec![[R::zero(); 4]; traced_len],
            trajectories: Trajectories::at_rest(traced_len),
            advection: advect::AdvectionScratch::new(&grid, traced_len),
            transport: transport::TransportScratch::new(&grid),
            projection: Projection::new(&grid, config.pressure, None),
            implicit: is_implicit.then(|| Implicit::new(&grid)),
            relaxation: Relaxation::new(&grid, &mean),
            footprint: Footprint::new(&grid),
            pushes: Pushes::new(&grid, &config.gusts),
            volume_sources_per_s: if has_sources { vec![0.0; grid.len()] } else { Vec::new() },
            planes: vec![PlaneSums::default(); grid.cells[2]],
            diagnostics: Diagnostics::default(),
            config: config.clone(),
            grid,
            mean,
        };
        solver.set_velocity(|[_, y, _]| mean.at(y.wide()).map(R::of));
        Ok(solver)
    }

    /// Sets the velocity (m/s) from a function of position (m), projects it, and resets the pressure gradient.
    pub fn set_velocity(&mut self, f: impl Fn([R; 3]) -> [R; 3]) {
        for (axis, field) in self.velocity.0.iter_mut().enumerate() {
            field.fill(&self.grid, |position| f(position)[axis]);
        }
        self.pressure_gradient.0.iter_mut().for_each(|field| field.data.fill(R::zero()));
        self.boundaries.update_inflow(self.time_secs);
        self.boundaries.apply(&mut self.velocity);
        self.projection.project(&self.grid, &mut self.velocity, &[], None);
        self.boundaries.apply(&mut self.velocity);
        self.measure();
    }

    /// Makes cells solid if `f` is true at their centre (m): no-slip obstacles, resolved to a cell. The velocity elsewhere is projected again.
    ///
    /// # Errors
    /// If pressure or diffusion is solved by transforms, which require a box without solid cells, or if every cell would be solid. Nothing changes then.
    pub fn set_solid(&mut self, f: impl Fn([R; 3]) -> bool) -> Result<(), SolidError> {
        let [nx, ny, nz] = self.grid.cells;
        let centre = |n: usize| self.grid.position_m(Location::Centre, [n % nx, n / nx % ny, n / (nx * ny)]);
        let solid: Vec<bool> = (0..nx * ny * nz).map(|n| f(centre(n))).collect();
        if self.config.pressure == Pressure::Direct {
            return Err(SolidError::Pressure);
        }
        if self.implicit.is_some() {
            return Err(SolidError::Diffusion);
        }
        if solid.iter().all(|&solid| solid) {
            return Err(SolidError::Full);
        }
        self.boundaries.set_solid(&solid);
        self.projection = Projection::new(&self.grid, self.config.pressure, Some(&solid));
        self.solid = Some(solid);
        self.pressure_gradient.0.iter_mut().for_each(|field| field.data.fill(R::zero()));
        self.boundaries.apply(&mut self.velocity);
        self.projection.project(&self.grid, &mut self.velocity, &[], None);
        self.boundaries.apply(&mut self.velocity);
        self.measure();
        Ok(())
    }

    /// Whether each cell is solid, x fastest; `None` without solid cells.
    pub fn solid(&self) -> Option<&[bool]> {
        self.solid.as_deref()
    }

    /// Sets the velocity (m/s) on [`Inflow`](super::Boundary::Inflow) faces as a function of position (m) and time (s). In a box without outflow the normal
    /// velocity is shifted so that the net flux is 0.
    pub fn set_inflow(&mut self, f: impl Fn([f64; 3], f64) -> [f64; 3] + Send + Sync + 'static) {
        self.boundaries.set_inflow(Box::new(f));
        self.boundaries.update_inflow(self.time_secs);
    }

    /// Sets the fraction, 0 to 1, of the canopy that stands in each column of cells, x fastest. Initially 1.
    pub fn set_canopy_fraction(&mut self, fractions: impl Iterator<Item = f32>) {
        self.canopy_fraction.iter_mut().zip(fractions).for_each(|(own, fraction)| *own = R::of(fraction.clamp(0.0, 1.0).into()));
    }

    /// Displacement (m) of the tops of the grass along x and z in the middle of each column of cells, x fastest; `None` if the canopy does not move.
    pub fn canopy_displacements_m(&self) -> Option<impl Iterator<Item = [R; 2]> + '_> {
        self.stems.as_ref().map(|stems| stems.displacements(&self.grid))
    }

    /// Displacement (m) and velocity (m/s) of the tops of the grass, as in [`State::stems`]; empty if the canopy does not move.
    pub fn stems(&self) -> [&[R]; 4] {
        self.stems.as_ref().map_or([&[]; 4], |stems| stems.values.each_ref().map(Vec::as_slice))
    }

    /// Pressure gradient over density (m/s²) that the next step begins with, across x, y and z, with the layout of the memory; 0 unless the time scheme is
    /// [`TimeScheme::RungeKutta3`](crate::TimeScheme::RungeKutta3).
    pub fn pressure_gradient(&self) -> [&[R]; 3] {
        self.pressure_gradient.0.each_ref().map(|field| field.data.as_slice())
    }

    /// Places a sponge layer across x and one across z at these positions (m) in a box that is periodic along both: the air there relaxes to the mean wind, so that
    /// disturbances do not re-enter. `None` (initially) for no sponge.
    pub fn set_sponge(&mut self, sponge_m: Option<[f64; 2]>) {
        self.sponge_m = sponge_m.filter(|_| self.grid.wraps(0) && self.grid.wraps(2));
    }

    /// Sets the time (s) since the start of the primitives' [intensities](super::Intensity) at the present moment. Initially they start with the solver, at time 0. It is
    /// not in a checkpoint: where intensities follow a clock of one's own, set it before each step.
    pub fn set_intensity_secs(&mut self, secs: f64) {
        self.intensity_start_secs = self.time_secs - secs;
    }

    /// The moment at a time of the solver (s).
    pub(super) fn moment(&self, secs: f64) -> Moment {
        Moment { secs, intensity_secs: secs - self.intensity_start_secs }
    }

    /// Updates the diagnostics.
    pub(super) fn measure(&mut self) {
        self.diagnostics = diagnostics::measure(&self.grid, &self.velocity, &mut self.planes);
    }

    /// Velocity (m/s) at a position (m), interpolated trilinearly between faces: second order in the spacing. Periodic axes repeat; beyond other
    /// faces the velocity is that on the face.
    pub fn velocity_at(&self, position_m: [R; 3]) -> [R; 3] {
        self.velocity.0.each_ref().map(|field| field.at(&self.grid, position_m))
    }

    /// All values of the velocity component along `axis` (m/s) with their positions (m).
    pub fn samples(&self, axis: usize) -> impl Iterator<Item = ([R; 3], R)> + '_ {
        self.velocity.0[axis].samples(&self.grid)
    }

    /// Velocities (m/s) at cell centres, x fastest, then y, then z: cell (i, j, k) is item `i + nx·(j + ny·k)`.
    pub fn cell_velocities(&self) -> impl Iterator<Item = Vec3> + '_ {
        let ([nx, ny, nz], strides) = (self.grid.cells, self.grid.strides());
        (0..ny * nz).flat_map(move |row| {
            let start = self.grid.at([0, row % ny, row / ny]);
            let mean = move |axis: usize, at: usize| {
                let data = &self.velocity.0[axis].data;
                0.5 * (data[at].wide() + data[at + strides[axis]].wide()) as f32
            };
            (start..start + nx).map(move |at| Vec3::new(mean(0, at), mean(1, at), mean(2, at)))
        })
    }

    /// Concentration of dust at cell centres, in the order of [`Solver::cell_velocities`]; `None` in clear air.
    pub fn dust(&self) -> Option<impl Iterator<Item = f32> + '_> {
        self.dust.as_ref().map(|dust| dust.values(&self.grid).map(|density| density.wide() as f32))
    }

    /// All concentrations of dust with their positions (m); empty in clear air.
    pub fn dust_samples(&self) -> impl Iterator<Item = ([R; 3], R)> + '_ {
        self.dust.iter().flat_map(|dust| dust.samples(&self.grid))
    }

    /// Sets the concentration of dust from a function of position (m). No effect without dust in the settings.
    pub fn set_dust(&mut self, f: impl Fn([R; 3]) -> R) {
        if let Some(dust) = &mut self.dust {
            dust.fill(&self.grid, f);
        }
    }

    /// Memory (bytes) of fields, work arrays and solids, except the plans of transforms and the work arrays of an iterative pressure solver or of implicit diffusion.
    pub fn memory_bytes(&self) -> usize {
        let velocities = [&self.velocity, &self.pressure_gradient, &self.stages[0], &self.stages[1]]
            .into_iter()
            .chain(&self.old)
            .chain(&self.old_pressure_gradient);
        let fields = velocities.flat_map(|velocity| &velocity.0).chain(&self.dust).chain(&self.dust_stages);
        let values: usize = fields.map(|field| field.data.len()).sum();
        let traced = 4 * (self.centres.len() + self.trajectories.backward.len() + self.trajectories.forward.len());
        let scratch =
            self.advection.values() + self.transport.values() + self.canopy_fraction.len() + self.stems.as_ref().map_or(0, Stems::len);
        let pressure = 3 * self.grid.len() + self.volume_sources_per_s.len();
        let solids =
            self.solid.as_ref().map_or(0, Vec::len) + self.immersed.as_ref().map_or(0, Immersed::memory_bytes) + self.drag.memory_bytes();
        size_of::<R>() * (values + traced + scratch)
            + size_of::<f64>() * pressure
            + self.pushes.memory_bytes()
            + self.boundaries.memory_bytes()
            + solids
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
        let values = |velocity: &Velocity<R>| velocity.0.each_ref().map(|field| field.values(&self.grid).collect());
        State {
            time_secs: self.time_secs,
            velocity: values(&self.velocity),
            pressure_gradient: values(&self.pressure_gradient),
            dust: self.dust.iter().flat_map(|dust| dust.values(&self.grid)).collect(),
            stems: self.stems.as_ref().map(|stems| stems.values.clone()).unwrap_or_default(),
        }
    }

    /// Restores a checkpoint of a solver with the same settings. Later steps are bit-identical to those of the original; with an iterative pressure solver, whose
    /// initial guess is the last potential, they agree to its tolerance.
    ///
    /// # Errors
    /// A field of the wrong size; nothing changes then.
    pub fn restore(&mut self, state: &State<R>) -> Result<(), StateError> {
        for (axis, field) in self.velocity.0.iter().enumerate() {
            StateError::check(["velocity.x", "velocity.y", "velocity.z"][axis], state.velocity[axis].len(), field.len())?;
            StateError::check(
                ["pressure_gradient.x", "pressure_gradient.y", "pressure_gradient.z"][axis],
                state.pressure_gradient[axis].len(),
                field.len(),
            )?;
        }
        StateError::check("dust", state.dust.len(), self.dust.as_ref().map_or(0, Field::len))?;
        for (n, given) in state.stems.iter().enumerate() {
            StateError::check("stems", given.len(), self.stems.as_ref().map_or(0, |stems| stems.values[n].len()))?;
        }
        if let Some(stems) = &mut self.stems {
            stems.values.clone_from(&state.stems);
        }
        for axis in 0..3 {
            self.velocity.0[axis].set_values(&self.grid, &state.velocity[axis]);
            self.pressure_gradient.0[axis].set_values(&self.grid, &state.pressure_gradient[axis]);
        }
        if let Some(dust) = &mut self.dust {
            dust.set_values(&self.grid, &state.dust);
        }
        self.time_secs = state.time_secs;
        self.boundaries.update_inflow(self.time_secs);
        self.boundaries.apply(&mut self.velocity);
        self.measure();
        Ok(())
    }
}

#[cfg(test)]
#[path = "solver_tests.rs"]
mod tests;
