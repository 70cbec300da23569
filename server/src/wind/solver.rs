//! The solver: the state of the air, and what can be asked of it. The order of a step is in [`step`](super::step).

use glam::Vec3;

use super::boundary::Walls;
use super::config::{Config, ConfigError};
use super::diffuse::Implicit;
use super::footprint::Footprint;
use super::health::{self, Health, PlaneSums};
use super::pressure::{Pressure, Projection};
use super::profile::{MeanWind, Relaxation};
use super::sources::Pushes;
use super::state::{SolidError, State, StateError};
use super::trace::Paths;
use super::{Advection, Diffusion, Field, Grid, Place, Real, Velocity, advect, transport};

/// The solver in the precision the simulation runs in.
pub type WindSolver = Solver<f32>;

/// Incompressible air in a box: velocity on a staggered grid, and dust where asked for.
///
/// A lid that drags air round a square box (the lid-driven cavity), to half a minute:
///
/// ```
/// use server::wind::{Boundary, Config, Gusts, Profile, Solver};
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
/// assert!(u < -0.05 && v.abs() < 0.1 && w == 0.0, "below the middle air flows back: {u}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Other methods are chosen in [`Config`]: `advection: Advection::MacCormack, time: TimeScheme::Reflection`, for example. [`Solver::set_solid`] puts
/// obstacles in the box, [`Solver::prescribe`] says what blows through faces of [`Inflow`](super::Boundary::Inflow), [`Solver::samples`] gives every value
/// with its place.
pub struct Solver<R: Real> {
    pub(super) config: Config,
    pub(super) grid: Grid<R>,
    pub(super) time_secs: f64,
    pub(super) velocity: Velocity<R>,
    /// Gradient of the pressure over density (m/s²) of the step before, for schemes that use it.
    pub(super) pull: Velocity<R>,
    pub(super) dust: Option<Field<R>>,
    /// Velocity at the start of a part of a step, where dust is carried through the mean of old and new, or the part may prove too long.
    pub(super) old: Option<Velocity<R>>,
    /// The pull at the same time, where it may have to be taken back: with dust, which is carried last.
    pub(super) old_pull: Option<Velocity<R>>,
    pub(super) cover: Vec<R>,
    pub(super) seam_m: Option<[f64; 2]>,
    solid: Option<Vec<bool>>,

    pub(super) walls: Walls<R>,
    pub(super) stages: [Velocity<R>; 2],
    pub(super) dust_stages: [Field<R>; 2],
    pub(super) centres: Vec<[R; 4]>,
    pub(super) paths: Paths<R>,
    pub(super) advection: advect::Scratch<R>,
    pub(super) transport: transport::Scratch<R>,
    pub(super) projection: Projection,
    pub(super) implicit: Option<Implicit>,
    pub(super) mean: MeanWind,
    pub(super) relaxation: Relaxation<R>,
    pub(super) footprint: Footprint<R>,
    pub(super) pushes: Pushes<R>,
    /// What sources blow out of each cell (1/s); empty without any.
    pub(super) inflow: Vec<f64>,
    pub(super) planes: Vec<PlaneSums>,
    pub(super) health: Health,
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
        let still = Velocity::zeros(&grid);
        let dust = Field::zeros(&grid, Place::Centre);
        let is_implicit = matches!(config.diffusion, Diffusion::Implicit | Diffusion::CrankNicolson);
        let is_conservative = config.advection == Advection::Conservative;
        let traces_paths = !is_conservative || config.dust.is_some_and(|dust| dust.advection != Advection::Conservative);
        let path_len = if traces_paths { grid.padded_len() } else { 0 };
        let dust_stage = if config.dust.is_some() { dust.clone() } else { Field { data: Vec::new(), ..dust.clone() } };
        let has_sources = config.primitives.iter().any(|primitive| primitive.is_source());
        let mut solver = Self {
            time_secs: 0.0,
            velocity: still.clone(),
            pull: still.clone(),
            dust: config.dust.map(|_| dust.clone()),
            old: (config.dust.is_some() || is_conservative).then(|| still.clone()),
            old_pull: (config.dust.is_some() && is_conservative).then(|| still.clone()),
            cover: vec![R::one(); grid.cells[0] * grid.cells[2]],
            seam_m: None,
            solid: None,
            walls: Walls::new(&grid, Box::new(move |[_, y, _], _| mean.at(y.max(0.0)))),
            stages: [still.clone(), still],
            dust_stages: [dust_stage.clone(), dust_stage],
            centres: vec![[R::zero(); 4]; path_len],
            paths: Paths::at_rest(path_len),
            advection: advect::Scratch::new(&grid, path_len),
            transport: transport::Scratch::new(&grid),
            projection: Projection::new(&grid, config.pressure, None),
            implicit: is_implicit.then(|| Implicit::new(&grid)),
            relaxation: Relaxation::new(&grid, &mean),
            footprint: Footprint::default(),
            pushes: Pushes::default(),
            inflow: if has_sources { vec![0.0; grid.len()] } else { Vec::new() },
            planes: vec![PlaneSums::default(); grid.cells[2]],
            health: Health::default(),
            config: config.clone(),
            grid,
            mean,
        };
        solver.set_velocity(|[_, y, _]| mean.at(y.wide()).map(R::of));
        Ok(solver)
    }

    /// Sets the velocity (m/s) from a function of position (m), and takes the divergence out of it. What is known of the pressure is forgotten.
    pub fn set_velocity(&mut self, f: impl Fn([R; 3]) -> [R; 3]) {
        for (axis, field) in self.velocity.0.iter_mut().enumerate() {
            field.fill(&self.grid, |position| f(position)[axis]);
        }
        self.pull.0.iter_mut().for_each(|field| field.data.fill(R::zero()));
        self.walls.blow(self.time_secs);
        self.walls.close(&mut self.velocity);
        self.projection.project(&self.grid, &mut self.velocity, &[], None);
        self.walls.close(&mut self.velocity);
        self.observe();
    }

    /// Makes solid the cells whose centre (m) `f` says are: obstacles through which no air flows and to which it sticks, in steps of a cell. Air
    /// starts anew from what it was outside of them.
    ///
    /// # Errors
    /// If the pressure is solved directly or friction by transforms, which both need a box without solid cells, or if no cell is left to the air; nothing is
    /// changed then.
    pub fn set_solid(&mut self, f: impl Fn([R; 3]) -> bool) -> Result<(), SolidError> {
        let [nx, ny, nz] = self.grid.cells;
        let centre = |n: usize| self.grid.position_m(Place::Centre, [n % nx, n / nx % ny, n / (nx * ny)]);
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
        self.walls.set_solid(&solid);
        self.projection = Projection::new(&self.grid, self.config.pressure, Some(&solid));
        self.solid = Some(solid);
        self.pull.0.iter_mut().for_each(|field| field.data.fill(R::zero()));
        self.walls.close(&mut self.velocity);
        self.projection.project(&self.grid, &mut self.velocity, &[], None);
        self.walls.close(&mut self.velocity);
        self.observe();
        Ok(())
    }

    /// Whether each cell is solid, x fastest; `None` where all is air.
    pub fn solid(&self) -> Option<&[bool]> {
        self.solid.as_deref()
    }

    /// Says what blows through faces of [`Inflow`](super::Boundary::Inflow): a velocity (m/s) as a function of position (m) and time (s). Where the box has no outflow, what
    /// comes in and what goes out are made to balance.
    pub fn prescribe(&mut self, f: impl Fn([f64; 3], f64) -> [f64; 3] + Send + Sync + 'static) {
        self.walls.prescribe(Box::new(f));
        self.walls.blow(self.time_secs);
    }

    /// Says which share, 0 to 1, of the canopy stands in each column of cells, x fastest. All of it does at first.
    pub fn set_cover(&mut self, cover: impl Iterator<Item = f32>) {
        self.cover.iter_mut().zip(cover).for_each(|(cover, share)| *cover = R::of(share.clamp(0.0, 1.0).into()));
    }

    /// Cuts a box that wraps along x and z at these places (m): the air next to the cuts is brought back to the mean wind, so that what leaves there does not
    /// come in again. `None`, at first, for no cut.
    pub fn set_seam(&mut self, seam_m: Option<[f64; 2]>) {
        self.seam_m = seam_m.filter(|_| self.grid.wraps(0) && self.grid.wraps(2));
    }

    /// Measures the new velocity.
    pub(super) fn observe(&mut self) {
        self.health = health::measure(&self.grid, &self.velocity, &mut self.planes);
    }

    /// Velocity (m/s) at a position (m) in the box, trilinear between faces: second order in the spacing. Wrapped axes repeat; beyond other faces the
    /// velocity on the face holds.
    pub fn velocity_at(&self, position_m: [R; 3]) -> [R; 3] {
        self.velocity.0.each_ref().map(|field| field.at(&self.grid, position_m))
    }

    /// Every value of the velocity component along `axis` (m/s) with its position (m).
    pub fn samples(&self, axis: usize) -> impl Iterator<Item = ([R; 3], R)> + '_ {
        self.velocity.0[axis].samples(&self.grid)
    }

    /// Velocities (m/s) at the centres of cells, x fastest, then y, then z: cell (i, j, k) is item `i + nx·(j + ny·k)`.
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

    /// Concentration of dust at the centres of cells, in the order of [`Solver::cell_velocities`]; `None` in clear air.
    pub fn dust(&self) -> Option<impl Iterator<Item = f32> + '_> {
        self.dust.as_ref().map(|dust| dust.values(&self.grid).map(|density| density.wide() as f32))
    }

    /// Every concentration of dust with its position (m); none in clear air.
    pub fn dust_samples(&self) -> impl Iterator<Item = ([R; 3], R)> + '_ {
        self.dust.iter().flat_map(|dust| dust.samples(&self.grid))
    }

    /// Sets the dust from a function of position (m). Clear air stays clear.
    pub fn set_dust(&mut self, f: impl Fn([R; 3]) -> R) {
        if let Some(dust) = &mut self.dust {
            dust.fill(&self.grid, f);
        }
    }

    /// Memory (bytes) of the fields and of what is kept for them from step to step, but for what an iterative pressure or an implicit diffusion needs beside
    /// its unknowns.
    pub fn memory_bytes(&self) -> usize {
        let velocities = [&self.velocity, &self.pull, &self.stages[0], &self.stages[1]].into_iter().chain(&self.old).chain(&self.old_pull);
        let fields = velocities.flat_map(|velocity| &velocity.0).chain(&self.dust).chain(&self.dust_stages);
        let values: usize = fields.map(|field| field.data.len()).sum();
        let traced = 4 * (self.centres.len() + self.paths.back.len() + self.paths.ahead.len());
        let scratch = self.advection.values() + self.transport.values() + self.cover.len();
        size_of::<R>() * (values + traced + scratch) + size_of::<f64>() * (3 * self.grid.len() + self.inflow.len())
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
            pull: values(&self.pull),
            dust: self.dust.iter().flat_map(|dust| dust.values(&self.grid)).collect(),
        }
    }

    /// Takes up a state of a solver with the same settings; steps then have the same bits as if it had never stopped. With an iterative pressure, whose first
    /// guess is the potential of the step before, they agree to its tolerance.
    ///
    /// # Errors
    /// A field of the wrong size; the solver is then as it was.
    pub fn restore(&mut self, state: &State<R>) -> Result<(), StateError> {
        for (axis, field) in self.velocity.0.iter().enumerate() {
            StateError::check(["velocity.x", "velocity.y", "velocity.z"][axis], state.velocity[axis].len(), field.len())?;
            StateError::check(["pull.x", "pull.y", "pull.z"][axis], state.pull[axis].len(), field.len())?;
        }
        StateError::check("dust", state.dust.len(), self.dust.as_ref().map_or(0, Field::len))?;
        for axis in 0..3 {
            self.velocity.0[axis].set_values(&self.grid, &state.velocity[axis]);
            self.pull.0[axis].set_values(&self.grid, &state.pull[axis]);
        }
        if let Some(dust) = &mut self.dust {
            dust.set_values(&self.grid, &state.dust);
        }
        self.time_secs = state.time_secs;
        self.walls.blow(self.time_secs);
        self.walls.close(&mut self.velocity);
        self.observe();
        Ok(())
    }
}

#[cfg(test)]
#[path = "solver_tests.rs"]
mod tests;
