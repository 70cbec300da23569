//! Stable fluids (Stam 1999; Real-Time Fluid Dynamics for Games, GDC 2003) on a collocated grid, as in chapter 2 of Zhang: the baseline for
//! comparisons.

pub mod listing;
#[cfg(test)]
mod tests;

use glam::Vec3;

use super::config::Config;
use super::config::error::{ConfigError, check};
use super::diagnostics::Diagnostics;
use super::dust::release_and_settle;
use super::footprint::Footprint;
use super::intensity::Moment;
use super::profile::{self, MeanWind, Relaxation};
use super::sources::{self, Pushes};
use super::state::{StepError, StepReport};
use super::{Boundary, Field, Grid, Jet, Location, Real, Velocity, forcing};
use listing::{Kind, SWEEPS};

/// Incompressible air in a box by the method of Zhang: velocity and dust at cell centres with one layer of wall cells, diffusion and pressure by [`SWEEPS`]
/// Gauss–Seidel sweeps, semi-Lagrangian advection, on one thread.
///
/// Stable at any step, first order in dt, and never divergence-free. [`listing`] has the functions of Zhang's listings, with their errata corrected.
/// Forces are those of [`Solver`](super::Solver), which is the better choice for everything except comparison. Faces are periodic, free-slip or
/// reflecting; there are no other faces, no solid cells and no canopy. The settings `advection`, `damping`, `time`, `diffusion`, `pressure` and
/// `dust.advection` of [`Config`] have no effect.
///
/// ```
/// use prairie_wind::{Config, StableFluids};
///
/// let mut air = StableFluids::<f32>::new(&Config { cells: [8; 3], spacing_m: [2.0; 3], ..Config::default() })?;
/// let report = air.step(0.1, &[])?;
/// assert_eq!(report.pressure_sweeps, 20);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct StableFluids<R: Real> {
    config: Config,
    grid: Grid<R>,
    pub(super) time_secs: f64,
    /// Time of the solver (s) at which the intensities of primitives start.
    intensity_start_secs: f64,
    pub(super) velocity: Velocity<R>,
    /// The listings' `u0`, `v0`, `w0`; its first field also serves as the `x0` of dust.
    pub(super) before: Velocity<R>,
    pub(super) dust: Option<Field<R>>,
    pub(super) p: Field<R>,
    div: Field<R>,
    mean: MeanWind,
    relaxation: Relaxation<R>,
    footprint: Footprint<R>,
    pushes: Pushes<R>,
    pub(super) sponge_m: Option<[f64; 2]>,
    /// Volume source of each cell (1/s); empty without source or sink primitives.
    volume_sources_per_s: Vec<f64>,
}

impl<R: Real> StableFluids<R> {
    /// Checks the settings for this method.
    ///
    /// # Errors
    /// The first setting that is out of range, a boundary condition other than periodic, free slip or reflecting, or a canopy.
    pub fn check(config: &Config) -> Result<(), ConfigError> {
        config.validate()?;
        for (axis, faces) in config.boundary.iter().enumerate() {
            let possible = faces.iter().all(|face| matches!(face, Boundary::Wrap | Boundary::FreeSlip | Boundary::Reflect));
            check(possible, format!("boundary[{axis}]"), format!("{faces:?}"), "Wrap, FreeSlip or Reflect with the method StableFluids")?;
        }
        let canopy = format!("{:?}", config.canopy);
        check(config.canopy.is_none(), "canopy", canopy, "None with the method StableFluids")
    }

    /// Creates air that moves with the mean wind.
    ///
    /// # Errors
    /// As [`StableFluids::check`].
    pub fn new(config: &Config) -> Result<Self, ConfigError> {
        Self::check(config)?;
        let grid = config.grid::<R>();
        let mean = MeanWind::new(config);
        let zeros = Field::zeros(&grid, Location::Centre);
        let still = Velocity([0, 1, 2].map(|_| zeros.clone()));
        let has_sources = config.primitives.iter().any(|primitive| primitive.is_source());
        let mut air = Self {
            time_secs: 0.0,
            intensity_start_secs: 0.0,
            velocity: still.clone(),
            before: still,
            dust: config.dust.map(|_| zeros.clone()),
            p: zeros.clone(),
            div: zeros,
            relaxation: Relaxation::new(&grid, &mean),
            footprint: Footprint::new(&grid),
            pushes: Pushes::new(&grid, &config.gusts),
            sponge_m: None,
            volume_sources_per_s: if has_sources { vec![0.0; grid.len()] } else { Vec::new() },
            config: config.clone(),
            grid,
            mean,
        };
        air.set_velocity(|[_, y, _]| mean.at(y.wide()).map(R::of));
        Ok(air)
    }

    /// Sets the velocity (m/s) at cell centres from a function of position (m). Its divergence stays until a step reduces it.
    pub fn set_velocity(&mut self, f: impl Fn([R; 3]) -> [R; 3]) {
        for (axis, field) in self.velocity.0.iter_mut().enumerate() {
            field.fill(&self.grid, |position| f(position)[axis]);
            listing::set_bound(&self.grid, Kind::Component(axis), field);
        }
    }

    /// Sets the dust from a function of position (m). Clear air stays clear.
    pub fn set_dust(&mut self, f: impl Fn([R; 3]) -> R) {
        if let Some(dust) = &mut self.dust {
            dust.fill(&self.grid, f);
            listing::set_bound(&self.grid, Kind::Scalar, dust);
        }
    }

    /// Advances the air, then the dust, by `dt_secs` (s), driven by the mean wind, the random sources, the primitives and `jets`. There are no sub-steps.
    ///
    /// # Errors
    /// [`StepError::BadTimeStep`], [`StepError::BadJet`] or [`StepError::NotFinite`].
    pub fn step(&mut self, dt_secs: f64, jets: &[Jet]) -> Result<StepReport, StepError> {
        Self::check_step(dt_secs)?;
        if let Some(index) = jets.iter().position(|jet| !jet.is_valid()) {
            return Err(StepError::BadJet { index, jet: jets[index] });
        }
        self.add_sources(dt_secs, jets);
        self.vel_step(dt_secs);
        let diagnostics = self.diagnostics();
        if !diagnostics.kinetic_energy_m2_per_s2.is_finite() {
            return Err(StepError::NotFinite { cell: self.first_non_finite_cell().unwrap_or_default(), time_secs: self.time_secs });
        }
        self.dens_step(dt_secs);
        self.time_secs += dt_secs;
        let spacing_m = self.grid.spacing_m.map(R::wide);
        Ok(StepReport {
            courant: (0..3).map(|axis| diagnostics.max_speed_m_per_s[axis] * dt_secs / spacing_m[axis]).sum(),
            divergence_rms_rel: diagnostics.divergence_rms_rel,
            kinetic_energy_m2_per_s2: diagnostics.kinetic_energy_m2_per_s2,
            substeps: 1,
            pressure_residual: listing::residual(&self.grid, &self.p, &self.div),
            pressure_sweeps: SWEEPS,
        })
    }

    /// Checks a step of `dt_secs` (s): any positive, finite time is allowed.
    ///
    /// # Errors
    /// [`StepError::BadTimeStep`].
    pub fn check_step(dt_secs: f64) -> Result<(), StepError> {
        if dt_secs > 0.0 && dt_secs.is_finite() { Ok(()) } else { Err(StepError::BadTimeStep { dt_secs }) }
    }

    /// Zhang's `vel_step` after its sources.
    fn vel_step(&mut self, dt_secs: f64) {
        std::mem::swap(&mut self.before, &mut self.velocity);
        for axis in 0..3 {
            let (x, x0) = (&mut self.velocity.0[axis], &self.before.0[axis]);
            listing::diffuse(&self.grid, Kind::Component(axis), x, x0, self.config.viscosity_m2_per_s.into(), dt_secs);
        }
        self.project(SWEEPS);

        std::mem::swap(&mut self.before, &mut self.velocity);
        for axis in 0..3 {
            let (d, d0) = (&mut self.velocity.0[axis], &self.before.0[axis]);
            listing::advect(&self.grid, Kind::Component(axis), d, d0, &self.before, dt_secs);
        }
        self.project(SWEEPS);
    }

    /// Zhang's `dens_step`, with settling of dust added.
    fn dens_step(&mut self, dt_secs: f64) {
        let middle = self.moment(self.time_secs + 0.5 * dt_secs);
        let (Some(settings), Some(dust)) = (self.config.dust, &mut self.dust) else { return };
        let grid = &self.grid;
        release_and_settle(grid, &self.config, &self.mean, middle, dt_secs, dust, &mut self.footprint);
        listing::set_bound(grid, Kind::Scalar, dust);

        let other = &mut self.before.0[0];
        std::mem::swap(other, dust);
        listing::diffuse(grid, Kind::Scalar, dust, other, settings.diffusivity_m2_per_s.into(), dt_secs);
        std::mem::swap(other, dust);
        listing::advect(grid, Kind::Scalar, dust, other, &self.velocity, dt_secs);
    }

    /// Zhang's `project` alone, with `sweeps` sweeps instead of [`SWEEPS`].
    pub fn project(&mut self, sweeps: u32) {
        listing::project(&self.grid, &mut self.velocity, &mut self.p, &mut self.div, &self.volume_sources_per_s, sweeps);
    }

    /// Zhang's `add_source`: all forcing.
    fn add_sources(&mut self, dt_secs: f64, jets: &[Jet]) {
        let middle = self.moment(self.time_secs + 0.5 * dt_secs);
        let (grid, velocity, footprint) = (&self.grid, &mut self.velocity, &mut self.footprint);
        let gusts = sources::sources_at(&self.config, grid, &self.mean, middle.secs);
        self.pushes.set(grid, &self.config.gusts, gusts, velocity, footprint);
        self.pushes.apply(dt_secs, velocity);
        self.volume_sources_per_s.fill(0.0);
        for primitive in &self.config.primitives {
            primitive.drive(grid, middle, dt_secs, velocity, footprint);
            primitive.add_volume_source(grid, middle, &mut self.volume_sources_per_s, footprint);
        }
        for jet in jets {
            forcing::drive(grid, jet, dt_secs, velocity, footprint);
        }
        self.relaxation.apply(grid, self.config.relaxation_per_s.into(), dt_secs, velocity);
        if let Some(sponge_m) = self.sponge_m {
            profile::sponge(grid, &self.mean, sponge_m, dt_secs, velocity);
        }
        for (axis, field) in velocity.0.iter_mut().enumerate() {
            let gain = R::of(f64::from(self.config.body_force_m_per_s2[axis]) * dt_secs);
            field.data.iter_mut().for_each(|speed| *speed = *speed + gain);
            listing::set_bound(grid, Kind::Component(axis), field);
        }
    }

    /// Sets the time (s) since the start of the primitives' intensities at the present moment; see [`Solver::set_intensity_secs`](super::Solver::set_intensity_secs).
    pub fn set_intensity_secs(&mut self, secs: f64) {
        self.intensity_start_secs = self.time_secs - secs;
    }

    /// The moment at a time of the solver (s).
    fn moment(&self, secs: f64) -> Moment {
        Moment { secs, intensity_secs: secs - self.intensity_start_secs }
    }

    /// Places sponge layers at these positions (m); see [`Solver::set_sponge`](super::Solver::set_sponge).
    pub fn set_sponge(&mut self, sponge_m: Option<[f64; 2]>) {
        self.sponge_m = sponge_m.filter(|_| self.grid.wraps(0) && self.grid.wraps(2));
    }

    /// Diagnostics of the present velocity, with the divergence by central differences.
    pub fn diagnostics(&self) -> Diagnostics {
        let grid = &self.grid;
        let strides = grid.strides();
        let half_per_m = grid.spacing_m.map(|h| R::of(0.5) / h);
        let (mut max_speed_m_per_s, mut divergence_squares, mut speed_squares) = ([0.0f64; 3], 0.0, 0.0);
        for row in self.velocity.0[0].rows(grid) {
            for at in row..row + grid.cells[0] {
                divergence_squares += listing::divergence(&self.velocity, at, strides, half_per_m).wide().powi(2);
                for (fastest, field) in max_speed_m_per_s.iter_mut().zip(&self.velocity.0) {
                    let speed = field.data[at].wide();
                    *fastest = fastest.max(speed.abs());
                    speed_squares += speed * speed;
                }
            }
        }
        let smallest_m = grid.spacing_m.map(R::wide).into_iter().fold(f64::INFINITY, f64::min);
        let at_rest = speed_squares == 0.0;
        Diagnostics {
            max_speed_m_per_s,
            divergence_rms_rel: if at_rest { 0.0 } else { (divergence_squares / speed_squares).sqrt() * smallest_m },
            kinetic_energy_m2_per_s2: 0.5 * speed_squares / grid.len() as f64,
        }
    }

    fn first_non_finite_cell(&self) -> Option<[usize; 3]> {
        let [nx, ny, _] = self.grid.cells;
        let cell = |n: usize| [n % nx, n / nx % ny, n / (nx * ny)];
        (0..self.grid.len()).map(cell).find(|&cell| self.velocity.0.iter().any(|field| !field.data[self.grid.at(cell)].is_finite()))
    }

    /// Velocity (m/s) at a position (m) in the box, interpolated trilinearly between cell centres and, beyond the outermost, wall values. Periodic
    /// axes repeat; beyond other faces the velocity is that on the face.
    pub fn velocity_at(&self, position_m: [R; 3]) -> [R; 3] {
        self.velocity.0.each_ref().map(|field| field.at(&self.grid, position_m))
    }

    /// All values of the velocity component along `axis` (m/s) with their positions (m).
    pub fn samples(&self, axis: usize) -> impl Iterator<Item = ([R; 3], R)> + '_ {
        self.velocity.0[axis].samples(&self.grid)
    }

    /// Velocities (m/s) at cell centres, x fastest, then y, then z: cell (i, j, k) is item `i + nx·(j + ny·k)`.
    pub fn cell_velocities(&self) -> impl Iterator<Item = Vec3> + '_ {
        let [u, v, w] = self.velocity.0.each_ref();
        let narrow = |field: &Field<R>, at: usize| field.data[at].wide() as f32;
        let cells = move |row| (row..row + self.grid.cells[0]).map(move |at| Vec3::new(narrow(u, at), narrow(v, at), narrow(w, at)));
        u.rows(&self.grid).flat_map(cells)
    }

    /// Concentration of dust at cell centres, in the order of [`StableFluids::cell_velocities`]; `None` in clear air.
    pub fn dust(&self) -> Option<impl Iterator<Item = f32> + '_> {
        self.dust.as_ref().map(|dust| dust.values(&self.grid).map(|density| density.wide() as f32))
    }

    /// The velocity (m/s): three fields at cell centres.
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
}
