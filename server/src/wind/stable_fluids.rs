//! The method of 000, chapter 2, under its own name: "stable fluids" (Stam, SIGGRAPH 1999; Real-Time Fluid Dynamics for Games, GDC 2003) on a collocated
//! grid. The reference everything else is compared with.

pub mod listing;
#[cfg(test)]
mod tests;

use glam::Vec3;

use super::config::{Config, ConfigError, check};
use super::footprint::Footprint;
use super::health::Health;
use super::profile::{self, MeanWind, Relaxation};
use super::sources::{self, Pushes};
use super::state::{StepError, StepReport};
use super::{Boundary, Field, Grid, Jet, Place, Real, Velocity, forcing};
use listing::{Kind, SWEEPS};

/// Incompressible air in a box as 000 has it: velocity and dust at the centres of cells within a wall of cells, diffusion and pressure by [`SWEEPS`]
/// Gauss–Seidel sweeps, linear backtraces, one after the other on one thread.
///
/// Stable at any step, first order in dt, and never free of divergence; the functions of its listings, with what had to be put right in them, are in
/// [`listing`]. Forces are those of [`Solver`](super::Solver), which is the better choice for everything but comparison. Faces wrap, slip or reflect; there
/// are no other faces, no solid cells and no canopy. Of a [`Config`] the settings `advection`, `damping`, `time`, `diffusion`, `pressure` and
/// `dust.advection` mean nothing here.
///
/// ```
/// use server::wind::{Config, StableFluids};
///
/// let mut air = StableFluids::<f32>::new(&Config { cells: [8; 3], spacing_m: [2.0; 3], ..Config::default() })?;
/// let report = air.step(0.1, &[])?;
/// assert_eq!(report.pressure_sweeps, 20);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct StableFluids<R: Real> {
    config: Config,
    grid: Grid<R>,
    time_secs: f64,
    velocity: Velocity<R>,
    /// The listings' `u0`, `v0`, `w0`; its first field is also the `x0` of dust.
    before: Velocity<R>,
    dust: Option<Field<R>>,
    p: Field<R>,
    div: Field<R>,
    mean: MeanWind,
    relaxation: Relaxation<R>,
    footprint: Footprint<R>,
    pushes: Pushes<R>,
    seam_m: Option<[f64; 2]>,
    /// What sources blow out of each cell (1/s); empty without any.
    inflow: Vec<f64>,
}

impl<R: Real> StableFluids<R> {
    /// Checks that this method can do what the settings ask for.
    ///
    /// # Errors
    /// The first setting outside of its range, a face that neither wraps, slips nor reflects, or a canopy.
    pub fn check(config: &Config) -> Result<(), ConfigError> {
        config.validate()?;
        for (axis, faces) in config.boundary.iter().enumerate() {
            let possible = faces.iter().all(|face| matches!(face, Boundary::Wrap | Boundary::FreeSlip | Boundary::Reflect));
            check(possible, format!("boundary[{axis}]"), format!("{faces:?}"), "Wrap, FreeSlip or Reflect with the method StableFluids")?;
        }
        let canopy = format!("{:?}", config.canopy);
        check(config.canopy.is_none(), "canopy", canopy, "None with the method StableFluids")
    }

    /// Air that already moves with the mean wind, without gusts.
    ///
    /// # Errors
    /// As [`StableFluids::check`].
    pub fn new(config: &Config) -> Result<Self, ConfigError> {
        Self::check(config)?;
        let grid = config.grid::<R>();
        let mean = MeanWind::new(config);
        let zeros = Field::zeros(&grid, Place::Centre);
        let still = Velocity([0, 1, 2].map(|_| zeros.clone()));
        let has_sources = config.primitives.iter().any(|primitive| primitive.is_source());
        let mut air = Self {
            time_secs: 0.0,
            velocity: still.clone(),
            before: still,
            dust: config.dust.map(|_| zeros.clone()),
            p: zeros.clone(),
            div: zeros,
            relaxation: Relaxation::new(&grid, &mean),
            footprint: Footprint::default(),
            pushes: Pushes::default(),
            seam_m: None,
            inflow: if has_sources { vec![0.0; grid.len()] } else { Vec::new() },
            config: config.clone(),
            grid,
            mean,
        };
        air.set_velocity(|[_, y, _]| mean.at(y.wide()).map(R::of));
        Ok(air)
    }

    /// Sets the velocity (m/s) at the centres of cells from a function of position (m). Its divergence stays, until a step takes some out.
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

    /// Advances the air by `dt_secs` (s), driven by the mean wind, the random sources, the primitives and `jets`, and then the dust. Never cut into parts.
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
        let health = self.health();
        if !health.kinetic_energy_m2_per_s2.is_finite() {
            return Err(StepError::NotFinite { cell: self.first_bad_cell().unwrap_or_default(), time_secs: self.time_secs });
        }
        self.dens_step(dt_secs);
        self.time_secs += dt_secs;
        let spacing_m = self.grid.spacing_m.map(R::wide);
        Ok(StepReport {
            courant: (0..3).map(|axis| health.fastest_m_per_s[axis] * dt_secs / spacing_m[axis]).sum(),
            divergence_rms_rel: health.divergence_rms_rel,
            kinetic_energy_m2_per_s2: health.kinetic_energy_m2_per_s2,
            substeps: 1,
            pressure_residual: listing::residual(&self.grid, &self.p, &self.div),
            pressure_sweeps: SWEEPS,
        })
    }

    /// Whether a step of `dt_secs` (s) could be taken: any that is a positive, finite time.
    ///
    /// # Errors
    /// [`StepError::BadTimeStep`].
    pub fn check_step(dt_secs: f64) -> Result<(), StepError> {
        if dt_secs > 0.0 && dt_secs.is_finite() { Ok(()) } else { Err(StepError::BadTimeStep { dt_secs }) }
    }

    /// 000's `vel_step` after its sources.
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

    /// 000's `dens_step`; dust also settles, of which 000 knows nothing.
    fn dens_step(&mut self, dt_secs: f64) {
        let (Some(settings), Some(dust)) = (self.config.dust, &mut self.dust) else { return };
        let grid = &self.grid;
        let middle_secs = self.time_secs + 0.5 * dt_secs;
        let release = f64::from(settings.release_per_sec);
        for source in sources::sources_at(&self.config, grid, &self.mean, middle_secs) {
            sources::release(grid, &self.config.gusts, &source, release, dt_secs, dust, &mut self.footprint);
        }
        for primitive in &self.config.primitives {
            primitive.release(grid, middle_secs, release, dt_secs, dust, &mut self.footprint);
        }
        let left = R::of(1.0 / (1.0 + f64::from(settings.settling_per_sec) * dt_secs));
        dust.data.iter_mut().for_each(|density| *density = *density * left);
        listing::set_bound(grid, Kind::Scalar, dust);

        let other = &mut self.before.0[0];
        std::mem::swap(other, dust);
        listing::diffuse(grid, Kind::Scalar, dust, other, settings.diffusivity_m2_per_s.into(), dt_secs);
        std::mem::swap(other, dust);
        listing::advect(grid, Kind::Scalar, dust, other, &self.velocity, dt_secs);
    }

    /// 000's `project` alone, with so many sweeps in place of the [`SWEEPS`] of a step.
    pub fn project(&mut self, sweeps: u32) {
        listing::project(&self.grid, &mut self.velocity, &mut self.p, &mut self.div, &self.inflow, sweeps);
    }

    /// 000's `add_source`, three times: everything that drives the air.
    fn add_sources(&mut self, dt_secs: f64, jets: &[Jet]) {
        let (grid, velocity, footprint) = (&self.grid, &mut self.velocity, &mut self.footprint);
        let middle_secs = self.time_secs + 0.5 * dt_secs;
        let gusts = sources::sources_at(&self.config, grid, &self.mean, middle_secs);
        self.pushes.set(grid, &self.config.gusts, gusts, velocity, footprint);
        self.pushes.apply(dt_secs, velocity);
        self.inflow.fill(0.0);
        for primitive in &self.config.primitives {
            primitive.drive(grid, middle_secs, dt_secs, velocity, footprint);
            primitive.blow(grid, middle_secs, &mut self.inflow, footprint);
        }
        for jet in jets {
            forcing::drive(grid, jet, dt_secs, velocity, footprint);
        }
        self.relaxation.apply(grid, self.config.relaxation_per_sec.into(), dt_secs, velocity);
        if let Some(seam_m) = self.seam_m {
            profile::calm(grid, &self.mean, seam_m, dt_secs, velocity);
        }
        for (axis, field) in velocity.0.iter_mut().enumerate() {
            let gain = R::of(f64::from(self.config.body_force_m_per_s2[axis]) * dt_secs);
            field.data.iter_mut().for_each(|speed| *speed = *speed + gain);
            listing::set_bound(grid, Kind::Component(axis), field);
        }
    }

    /// Cuts a box that wraps along x and z at these places (m); see [`Solver::set_seam`](super::Solver::set_seam).
    pub fn set_seam(&mut self, seam_m: Option<[f64; 2]>) {
        self.seam_m = seam_m.filter(|_| self.grid.wraps(0) && self.grid.wraps(2));
    }

    /// The state of the flow now; its divergence is that of central differences.
    pub fn health(&self) -> Health {
        let grid = &self.grid;
        let strides = grid.strides();
        let half_per_m = grid.spacing_m.map(|h| R::of(0.5) / h);
        let (mut fastest_m_per_s, mut divergence_squares, mut speed_squares) = ([0.0f64; 3], 0.0, 0.0);
        for row in self.velocity.0[0].rows(grid) {
            for at in row..row + grid.cells[0] {
                divergence_squares += listing::divergence(&self.velocity, at, strides, half_per_m).wide().powi(2);
                for (fastest, field) in fastest_m_per_s.iter_mut().zip(&self.velocity.0) {
                    let speed = field.data[at].wide();
                    *fastest = fastest.max(speed.abs());
                    speed_squares += speed * speed;
                }
            }
        }
        let smallest_m = grid.spacing_m.map(R::wide).into_iter().fold(f64::INFINITY, f64::min);
        let at_rest = speed_squares == 0.0;
        Health {
            fastest_m_per_s,
            divergence_rms_rel: if at_rest { 0.0 } else { (divergence_squares / speed_squares).sqrt() * smallest_m },
            kinetic_energy_m2_per_s2: 0.5 * speed_squares / grid.len() as f64,
        }
    }

    fn first_bad_cell(&self) -> Option<[usize; 3]> {
        let [nx, ny, _] = self.grid.cells;
        let cell = |n: usize| [n % nx, n / nx % ny, n / (nx * ny)];
        (0..self.grid.len()).map(cell).find(|&cell| self.velocity.0.iter().any(|field| !field.data[self.grid.at(cell)].is_finite()))
    }

    /// Velocity (m/s) at a position (m) in the box, trilinear between centres, with the walls' values beyond the last. Wrapped axes repeat; beyond other faces
    /// the velocity on the face holds.
    pub fn velocity_at(&self, position_m: [R; 3]) -> [R; 3] {
        self.velocity.0.each_ref().map(|field| field.at(&self.grid, position_m))
    }

    /// Every value of the velocity component along `axis` (m/s) with its position (m).
    pub fn samples(&self, axis: usize) -> impl Iterator<Item = ([R; 3], R)> + '_ {
        self.velocity.0[axis].samples(&self.grid)
    }

    /// Velocities (m/s) at the centres of cells, x fastest, then y, then z: cell (i, j, k) is item `i + nx·(j + ny·k)`.
    pub fn cell_velocities(&self) -> impl Iterator<Item = Vec3> + '_ {
        let [u, v, w] = self.velocity.0.each_ref();
        let narrow = |field: &Field<R>, at: usize| field.data[at].wide() as f32;
        let cells = move |row| (row..row + self.grid.cells[0]).map(move |at| Vec3::new(narrow(u, at), narrow(v, at), narrow(w, at)));
        u.rows(&self.grid).flat_map(cells)
    }

    /// Concentration of dust at the centres of cells, in the order of [`StableFluids::cell_velocities`]; `None` in clear air.
    pub fn dust(&self) -> Option<impl Iterator<Item = f32> + '_> {
        self.dust.as_ref().map(|dust| dust.values(&self.grid).map(|density| density.wide() as f32))
    }

    /// The velocity (m/s): three fields at the centres of cells.
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
