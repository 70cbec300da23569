//! Settings of a wind solver, their defaults and ranges.

mod driving;
pub(crate) mod error;
mod schemes;
#[cfg(test)]
mod tests;

pub use driving::{Dust, Gusts, Profile};
pub use error::ConfigError;
pub use schemes::{Diffusion, TimeScheme};

use crate::advect::Advection;
use crate::boundary::Boundary;
use crate::canopy::Canopy;
use crate::grid::Grid;
use crate::pressure::Pressure;
use crate::primitive::Primitive;
use crate::real::Real;
use error::{at_least_zero, check};

/// Maximum number of cells along one axis.
pub const MAX_CELLS_PER_AXIS: usize = 512;
/// Maximum number of cells (16 Mi: about 1.3 GB of fields).
pub const MAX_CELLS: usize = 1 << 24;
/// Maximum number of primitives.
pub const MAX_PRIMITIVES: usize = 64;

/// Settings of a [`Solver`](crate::Solver). [`Config::default`] is the wind of the default scene: 256 m × 16 m × 256 m of gusty air.
#[derive(Clone, Debug, PartialEq)]
pub struct Config {
    /// Number of cells along x, y and z. Default `[32, 8, 32]`; each 1 to [`MAX_CELLS_PER_AXIS`], at most [`MAX_CELLS`] in all.
    pub cells: [usize; 3],
    /// Cell size along x, y and z (m). Default `[8, 2, 8]`; each 0.01 to 10 000.
    pub spacing_m: [f32; 3],
    /// Boundary conditions at the lower and upper face normal to x, y and z. Default: periodic in x and z, free slip below and above. Either both
    /// faces of an axis are periodic or neither is.
    pub boundary: [[Boundary; 2]; 3],
    /// Advection scheme of the velocity. Default [`Advection::Conservative`].
    pub advection: Advection,
    /// Upwind damping of conservative advection of velocity, as a fraction of that of a third-order upwind scheme, 0 to 1. Default 1; 0 conserves kinetic energy
    /// and leaves waves of two cells undamped.
    pub damping: f32,
    /// Time scheme. Default [`TimeScheme::RungeKutta3`].
    pub time: TimeScheme,
    /// Diffusion scheme. Default [`Diffusion::Explicit`].
    pub diffusion: Diffusion,
    /// Pressure solver. Default [`Pressure::Direct`].
    pub pressure: Pressure,
    /// Eddy viscosity of the air (m²/s), default 0.2; 0 or more. It stands for the eddies smaller than a cell; the molecular viscosity is 1.5e-5.
    pub viscosity_m2_per_s: f32,
    /// Mean wind (m/s) at the reference height of the profile, default `[5, 0, 1.5]`. The y component is ignored; components across closed faces must be 0.
    pub mean_wind_m_per_s: [f32; 3],
    /// Vertical profile of the mean wind. Default [`Profile::Log`] over grass; only [`Profile::Uniform`] in a box that is periodic in y.
    pub profile: Profile,
    /// Rate (1/s) at which the horizontal mean of each layer of cells relaxes to the profile, default 0.2; 0 or more. It stands for the large-scale pressure
    /// gradient and surface friction. Gusts, being departures from the layer mean, are not damped. Applied along periodic axes only.
    pub relaxation_per_s: f32,
    /// Uniform body force per mass (m/s²), such as a mean pressure gradient. Default 0; −100 to 100.
    pub body_force_m_per_s2: [f32; 3],
    /// Random gusts.
    pub gusts: Gusts,
    /// Superposed flow primitives; at most [`MAX_PRIMITIVES`]. Default empty.
    pub primitives: Vec<Primitive>,
    /// Drag of a grass canopy; `None` (default) for bare ground.
    pub canopy: Option<Canopy>,
    /// Dust carried by the wind; `None` (default) for clear air.
    pub dust: Option<Dust>,
    /// Seed of the random sources. Default 1.
    pub seed: u64,
}

impl Default for Config {
    fn default() -> Self {
        Self {
            cells: [32, 8, 32],
            spacing_m: [8.0, 2.0, 8.0],
            boundary: [[Boundary::Wrap; 2], [Boundary::FreeSlip; 2], [Boundary::Wrap; 2]],
            advection: Advection::Conservative,
            damping: 1.0,
            time: TimeScheme::RungeKutta3,
            diffusion: Diffusion::Explicit,
            pressure: Pressure::Direct,
            viscosity_m2_per_s: 0.2,
            mean_wind_m_per_s: [5.0, 0.0, 1.5],
            profile: Profile::Log { roughness_m: 0.05, reference_m: 10.0 },
            relaxation_per_s: 0.2,
            body_force_m_per_s2: [0.0; 3],
            gusts: Gusts::default(),
            primitives: Vec::new(),
            canopy: None,
            dust: None,
            seed: 1,
        }
    }
}

impl Config {
    /// Checks every setting.
    ///
    /// # Errors
    /// The first setting that is out of range or inconsistent with another.
    pub fn validate(&self) -> Result<(), ConfigError> {
        (0..3).try_for_each(|axis| self.validate_axis(axis))?;
        let total: usize = self.cells.iter().product();
        check(total <= MAX_CELLS, "cells", format!("{total} in all"), "at most 16777216 in all")?;
        self.validate_schemes()?;
        at_least_zero("viscosity_m2_per_s", self.viscosity_m2_per_s)?;
        at_least_zero("relaxation_per_s", self.relaxation_per_s)?;
        self.profile.validate(self.boundary[1][0])?;
        self.gusts.validate()?;
        check(self.primitives.len() <= MAX_PRIMITIVES, "primitives", format!("a list of {}", self.primitives.len()), "at most 64")?;
        for (index, primitive) in self.primitives.iter().enumerate() {
            primitive.validate(&format!("primitives[{index}]"))?;
        }
        self.canopy.iter().try_for_each(Canopy::validate)?;
        self.dust.iter().try_for_each(Dust::validate)
    }

    fn validate_axis(&self, axis: usize) -> Result<(), ConfigError> {
        let cells = self.cells[axis];
        check((1..=MAX_CELLS_PER_AXIS).contains(&cells), format!("cells[{axis}]"), cells, "1 to 512")?;
        let spacing = self.spacing_m[axis];
        check((0.01..=1.0e4).contains(&spacing), format!("spacing_m[{axis}]"), spacing, "0.01 to 10000")?;
        self.validate_faces(axis)?;
        let mean = self.mean_wind_m_per_s[axis];
        check(mean.abs() <= 200.0, format!("mean_wind_m_per_s[{axis}]"), mean, "-200 to 200")?;
        let blocked = axis != 1 && mean != 0.0 && self.boundary[axis].iter().any(|face| face.blocks_flow());
        check(!blocked, format!("mean_wind_m_per_s[{axis}]"), mean, "0, since a face across this axis is closed")?;
        let force = self.body_force_m_per_s2[axis];
        check(force.abs() <= 100.0, format!("body_force_m_per_s2[{axis}]"), force, "-100 to 100")
    }

    fn validate_faces(&self, axis: usize) -> Result<(), ConfigError> {
        let faces = self.boundary[axis];
        let periodic = faces.map(|face| face == Boundary::Wrap);
        check(periodic[0] == periodic[1], format!("boundary[{axis}]"), format!("{faces:?}"), "Wrap on both sides, or on neither")?;
        for face in faces {
            let Boundary::Lid { velocity_m_per_s: lid } = face else { continue };
            let slides = lid[axis] == 0.0 && lid.iter().all(|speed| speed.abs() <= 200.0);
            let allowed = "a lid with no velocity across itself, at -200 to 200 m/s along each axis";
            check(slides, format!("boundary[{axis}]"), format!("{face:?}"), allowed)?;
        }
        Ok(())
    }

    fn validate_schemes(&self) -> Result<(), ConfigError> {
        check((0.0..=1.0).contains(&self.damping), "damping", self.damping, "0 to 1")?;
        let allowed = if self.advection.uses_fluxes() {
            "Split or RungeKutta3, with conservative advection"
        } else {
            "Split or Reflection, with semi-Lagrangian advection"
        };
        check(self.time.allows(self.advection), "time", format!("{:?}", self.time), allowed)?;
        if let Diffusion::GaussSeidel { sweeps } = self.diffusion {
            check((1..=100_000).contains(&sweeps), "diffusion", format!("{:?}", self.diffusion), "1 to 100000 sweeps")?;
        }
        if let Pressure::Iterative(_, effort) = self.pressure {
            let possible = effort.tolerance > 0.0 && effort.tolerance < 1.0 && (1..=100_000).contains(&effort.sweeps);
            check(possible, "pressure", format!("{:?}", self.pressure), "a tolerance above 0, below 1, and 1 to 100000 sweeps")?;
        }
        Ok(())
    }

    /// The grid of these settings.
    pub fn grid<R: Real>(&self) -> Grid<R> {
        Grid { cells: self.cells, spacing_m: self.spacing_m.map(|h| R::of(h.into())), boundary: self.boundary }
    }

    /// Whether dust is advected along trajectories rather than by fluxes.
    pub(crate) fn traces_dust(&self) -> bool {
        self.dust.is_some_and(|dust| !dust.advection.uses_fluxes())
    }
}
