//! Everything a wind solver can be told, and what is allowed.

use super::pressure::Pressure;
use super::primitive::Primitive;
use super::{Boundary, Canopy, Grid, Real};

/// Most cells along one axis.
pub const MAX_CELLS_PER_AXIS: usize = 512;
/// Most cells in all (16 Mi: about 1.3 GB of fields).
pub const MAX_CELLS: usize = 1 << 24;

/// Settings of a [`Solver`](super::Solver). [`Config::default`] is the wind of the default scene: 256 m × 16 m × 256 m of gusty air.
#[derive(Clone, Debug, PartialEq)]
pub struct Config {
    /// Number of cells along x, y and z. Default `[32, 8, 32]`; each 1 to [`MAX_CELLS_PER_AXIS`], at most [`MAX_CELLS`] in all.
    pub cells: [usize; 3],
    /// Size of a cell (m). Default `[8, 2, 8]`; each 0.01 to 10 000.
    pub spacing_m: [f32; 3],
    /// What the faces towards smaller and larger coordinates across x, y and z do. Default: x and z wrap, free slip below and above. Both faces across an
    /// axis wrap, or neither.
    pub boundary: [[Boundary; 2]; 3],
    /// How velocity is carried along. Default [`Advection::Conservative`].
    pub advection: Advection,
    /// Share, 0 to 1, of the damping of a third-order upwind scheme in conservative advection of velocity. Default 1; 0 conserves kinetic energy, and
    /// leaves waves of two cells undamped.
    pub damping: f32,
    /// How the parts of a step are put together. Default [`TimeScheme::RungeKutta3`].
    pub time: TimeScheme,
    /// How friction spreads velocity. Default [`Diffusion::Explicit`].
    pub diffusion: Diffusion,
    /// How the divergence is taken out. Default [`Pressure::Direct`].
    pub pressure: Pressure,
    /// Eddy viscosity of the air (m²/s), default 0.2; 0 or more. Molecular viscosity is 1.5e-5; what a grid of metres needs stands for the eddies
    /// smaller than a cell.
    pub viscosity_m2_per_s: f32,
    /// Mean wind (m/s) at the reference height of the profile, default `[5, 0, 1.5]`. The y component is ignored; components across closed faces must be 0.
    pub mean_wind_m_per_s: [f32; 3],
    /// How the mean wind grows with height. Default [`Profile::Log`] over grass; over a box that wraps in y only [`Profile::Uniform`].
    pub profile: Profile,
    /// Rate (1/s) at which the mean of each layer of cells returns to the profile, default 0.2; 0 or more. It stands for the pressure gradient that
    /// drives the wind and the friction that holds it; gusts, which are departures from a layer's mean, are left alone. Only across faces that wrap.
    pub relaxation_per_sec: f32,
    /// Acceleration (m/s²) of all air, such as a mean pressure gradient gives. Default 0; −100 to 100.
    pub body_force_m_per_s2: [f32; 3],
    /// The random sources that keep the air stirred.
    pub gusts: Gusts,
    /// Winds of simple shape, superposed; at most [`MAX_PRIMITIVES`]. Default none.
    pub primitives: Vec<Primitive>,
    /// Grass that takes momentum out of the wind; `None` (default) for bare ground.
    pub canopy: Option<Canopy>,
    /// Dust carried by the wind; `None` (default) for clear air.
    pub dust: Option<Dust>,
    /// Seed of everything random. Default 1.
    pub seed: u64,
}

/// Most primitives.
pub const MAX_PRIMITIVES: usize = 64;

/// How a field is carried along by the wind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Advection {
    /// The value at the departure point, interpolated linearly (Stam, Stable Fluids, SIGGRAPH 1999; 000 §2.3.3). First order at a given Courant number: it
    /// spreads a field like a diffusivity of |u|·h/2 at small ones. Stable at any step.
    SemiLagrangian,
    /// Semi-Lagrangian forth and back, corrected by half the error of the round trip (Selle et al., J. Sci. Comput. 35, 2008). Second order; stable at any step.
    MacCormack,
    /// Back and forth error compensation and correction (Dupont & Liu, J. Comput. Phys. 190, 2003): the error of the round trip is taken off before the
    /// semi-Lagrangian step. Second order; stable at any step.
    Bfecc,
    /// Fluxes through faces: central with an upwind share for velocity, limited for dust, by Runge–Kutta 3 (see [`transport`](super::transport)).
    /// Second order; a step is cut into parts where its Courant number is too large.
    Conservative,
}

/// How advection, forces, friction and pressure make a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TimeScheme {
    /// One after the other (000 §2.3.5): first order in dt. With any advection.
    Split,
    /// Two half steps of advection through the velocity at mid-step with a reflection of the pressure's work between them (Narain, Zehnder & Thomaszewski,
    /// SIGGRAPH 2019), forces and friction in halves before and after: second order in dt, three projections. With the semi-Lagrangian family.
    Reflection,
    /// Runge–Kutta 3 with the pressure gradient of the step before, corrected by one projection at the end (Van Kan, SIAM J. Sci. Stat. Comput. 7, 1986):
    /// second order in dt. With conservative advection.
    RungeKutta3,
}

/// How friction spreads velocity, and dust is spread.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Diffusion {
    /// Explicit, cut into parts where the step is beyond its limit (`ν·dt/h² = 1/6` on cubes).
    Explicit,
    /// Backward Euler by so many Gauss–Seidel sweeps (000 §2.3.2). First order in dt, stable at any step.
    GaussSeidel {
        /// Sweeps, at least 1; 20 in 000.
        sweeps: u32,
    },
    /// Backward Euler, solved exactly by transforms. First order in dt, stable at any step; for boxes without solid cells.
    Implicit,
    /// Half a step explicit, half implicit: second order in dt, stable at any step; for boxes without solid cells.
    CrankNicolson,
}

/// Mean wind against height above the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Profile {
    /// The same at every height.
    Uniform,
    /// Logarithmic: `ln(1 + y/z₀) / ln(1 + y_ref/z₀)`, the neutral surface layer.
    Log {
        /// Roughness length z₀ (m); 0.03 to 0.1 over grass. Above 0.
        roughness_m: f32,
        /// Height y_ref (m) at which the wind is the mean wind; 10 by convention. Above 0.
        reference_m: f32,
    },
    /// Power law: `(y / y_ref)^exponent`.
    Power {
        /// 1/7 over open land. 0 to 1.
        exponent: f32,
        /// Height y_ref (m) at which the wind is the mean wind. Above 0.
        reference_m: f32,
    },
}

/// Random source cells (000 §2.3.1) that push the air, each for a life span, one after the other.
///
/// A source drifts with the mean wind at its height, so that a gust is one parcel of air, pushed while it travels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gusts {
    /// Sources alive at any time. Default 24; 0 for still air, at most 4096.
    pub number: usize,
    /// Speed (m/s) a source of greatest strength gives the air at its centre over its life, if none of it were carried away. Default 14; 0 or more.
    pub strength_m_per_s: f32,
    /// Life of a source (s). Default 6; above 0.
    pub life_secs: f32,
    /// Share of the life in which the push grows; it falls off over the rest. Default 0.15 (003 §3.2: steep attack, gentle fall-off); above 0, below 1.
    pub attack: f32,
    /// Half-widths of a source along x, y and z (m). Default `[14, 5, 14]`; above 0. One narrower than a cell is spread over the cell.
    pub radius_m: [f32; 3],
}

/// Dust or seed, as a concentration (1 = as thick as a source makes it in one second).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dust {
    /// How dust is carried along. Default [`Advection::Conservative`], which keeps its amount.
    pub advection: Advection,
    /// Diffusivity (m²/s). Default 0.2; 0 or more.
    pub diffusivity_m2_per_s: f32,
    /// Concentration a gust source adds at its centre (1/s) at the height of its push. Default 1; 0 or more.
    pub release_per_sec: f32,
    /// Rate (1/s) at which dust settles out of the air. Default 0.1; 0 or more.
    pub settling_per_sec: f32,
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
            relaxation_per_sec: 0.2,
            body_force_m_per_s2: [0.0; 3],
            gusts: Gusts::default(),
            primitives: Vec::new(),
            canopy: None,
            dust: None,
            seed: 1,
        }
    }
}

impl Default for Gusts {
    fn default() -> Self {
        Self { number: 24, strength_m_per_s: 14.0, life_secs: 6.0, attack: 0.15, radius_m: [14.0, 5.0, 14.0] }
    }
}

impl Default for Dust {
    fn default() -> Self {
        Self { advection: Advection::Conservative, diffusivity_m2_per_s: 0.2, release_per_sec: 1.0, settling_per_sec: 0.1 }
    }
}

/// A setting outside of what is allowed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("wind: {field} is {value}; allowed: {allowed}")]
pub struct ConfigError {
    /// The setting, as a path from [`Config`].
    pub field: String,
    /// What it was.
    pub value: String,
    /// What it may be.
    pub allowed: &'static str,
}

pub(super) fn check(ok: bool, field: impl Into<String>, value: impl std::fmt::Display, allowed: &'static str) -> Result<(), ConfigError> {
    if ok { Ok(()) } else { Err(ConfigError { field: field.into(), value: value.to_string(), allowed }) }
}

pub(super) fn at_least_zero(field: &str, value: f32) -> Result<(), ConfigError> {
    check((0.0..=1.0e6).contains(&value), field, value, "0 to 1e6")
}

pub(super) fn above_zero(field: &str, value: f32) -> Result<(), ConfigError> {
    check(value > 0.0 && value <= 1.0e6, field, value, "above 0, at most 1e6")
}

impl Config {
    /// Checks every setting.
    ///
    /// # Errors
    /// The first setting outside of its range, or at odds with another.
    pub fn validate(&self) -> Result<(), ConfigError> {
        for axis in 0..3 {
            let cells = self.cells[axis];
            check((1..=MAX_CELLS_PER_AXIS).contains(&cells), format!("cells[{axis}]"), cells, "1 to 512")?;
            let spacing = self.spacing_m[axis];
            check((0.01..=1.0e4).contains(&spacing), format!("spacing_m[{axis}]"), spacing, "0.01 to 10000")?;
            self.validate_faces(axis)?;
            let mean = self.mean_wind_m_per_s[axis];
            check(mean.abs() <= 200.0, format!("mean_wind_m_per_s[{axis}]"), mean, "-200 to 200")?;
            let blocked = axis != 1 && mean != 0.0 && self.boundary[axis].iter().any(|face| face.is_closed());
            check(!blocked, format!("mean_wind_m_per_s[{axis}]"), mean, "0, since a face across this axis is closed")?;
            let force = self.body_force_m_per_s2[axis];
            check(force.abs() <= 100.0, format!("body_force_m_per_s2[{axis}]"), force, "-100 to 100")?;
            above_zero(&format!("gusts.radius_m[{axis}]"), self.gusts.radius_m[axis])?;
        }
        let total: usize = self.cells.iter().product();
        check(total <= MAX_CELLS, "cells", format!("{total} in all"), "at most 16777216 in all")?;
        self.validate_schemes()?;
        at_least_zero("viscosity_m2_per_s", self.viscosity_m2_per_s)?;
        at_least_zero("relaxation_per_sec", self.relaxation_per_sec)?;
        self.profile.validate(self.boundary[1][0])?;
        self.gusts.validate()?;
        check(self.primitives.len() <= MAX_PRIMITIVES, "primitives", format!("a list of {}", self.primitives.len()), "at most 64")?;
        for (index, primitive) in self.primitives.iter().enumerate() {
            primitive.validate(&format!("primitives[{index}]"))?;
        }
        if let Some(canopy) = &self.canopy {
            canopy.validate()?;
        }
        if let Some(dust) = &self.dust {
            at_least_zero("dust.diffusivity_m2_per_s", dust.diffusivity_m2_per_s)?;
            at_least_zero("dust.release_per_sec", dust.release_per_sec)?;
            at_least_zero("dust.settling_per_sec", dust.settling_per_sec)?;
        }
        Ok(())
    }

    fn validate_faces(&self, axis: usize) -> Result<(), ConfigError> {
        let faces = self.boundary[axis];
        let wrapped = faces.map(|face| face == Boundary::Wrap);
        check(wrapped[0] == wrapped[1], format!("boundary[{axis}]"), format!("{faces:?}"), "Wrap on both sides, or on neither")?;
        for face in faces {
            let Boundary::Lid { velocity_m_per_s: lid } = face else { continue };
            let slides = lid[axis] == 0.0 && lid.iter().all(|speed| speed.abs() <= 200.0);
            check(
                slides,
                format!("boundary[{axis}]"),
                format!("{face:?}"),
                "a lid that moves along itself, at -200 to 200 m/s along each axis",
            )?;
        }
        Ok(())
    }

    fn validate_schemes(&self) -> Result<(), ConfigError> {
        check((0.0..=1.0).contains(&self.damping), "damping", self.damping, "0 to 1")?;
        let (time, conservative) = (format!("{:?}", self.time), self.advection == Advection::Conservative);
        match self.time {
            TimeScheme::RungeKutta3 => {
                check(conservative, "time", time, "Split or Reflection, with advection of the semi-Lagrangian family")?
            }
            TimeScheme::Reflection => check(!conservative, "time", time, "Split or RungeKutta3, with conservative advection")?,
            TimeScheme::Split => {}
        }
        if let Diffusion::GaussSeidel { sweeps } = self.diffusion {
            check((1..=100_000).contains(&sweeps), "diffusion", format!("{:?}", self.diffusion), "1 to 100000 sweeps")?;
        }
        if let Pressure::Iterative(_, effort) = self.pressure {
            let possible = effort.tolerance > 0.0 && effort.tolerance < 1.0 && (1..=100_000).contains(&effort.sweeps);
            check(possible, "pressure", format!("{:?}", self.pressure), "a tolerance above 0, below 1, and 1 to 100000 sweeps")?;
        }
        Ok(())
    }

    /// The grid these settings describe.
    pub fn grid<R: Real>(&self) -> Grid<R> {
        Grid { cells: self.cells, spacing_m: self.spacing_m.map(|h| R::of(h.into())), boundary: self.boundary }
    }
}

impl Profile {
    fn validate(&self, vertical: Boundary) -> Result<(), ConfigError> {
        match *self {
            Profile::Uniform => return Ok(()),
            Profile::Log { roughness_m, reference_m } => {
                above_zero("profile.roughness_m", roughness_m)?;
                above_zero("profile.reference_m", reference_m)?;
            }
            Profile::Power { exponent, reference_m } => {
                check((0.0..=1.0).contains(&exponent), "profile.exponent", exponent, "0 to 1")?;
                above_zero("profile.reference_m", reference_m)?;
            }
        }
        check(vertical != Boundary::Wrap, "profile", format!("{self:?}"), "Uniform, since the box wraps in y and so has no ground")
    }

    /// Share of the mean wind that blows at a height above the ground (m).
    pub fn share_at(&self, height_m: f64) -> f64 {
        match *self {
            Profile::Uniform => 1.0,
            Profile::Log { roughness_m, reference_m } => {
                let roughness = f64::from(roughness_m);
                (height_m / roughness).ln_1p() / (f64::from(reference_m) / roughness).ln_1p()
            }
            Profile::Power { exponent, reference_m } => (height_m / f64::from(reference_m)).powf(exponent.into()),
        }
    }
}

impl Gusts {
    fn validate(&self) -> Result<(), ConfigError> {
        check(self.number <= 4096, "gusts.number", self.number, "0 to 4096")?;
        at_least_zero("gusts.strength_m_per_s", self.strength_m_per_s)?;
        above_zero("gusts.life_secs", self.life_secs)?;
        check(self.attack > 0.0 && self.attack < 1.0, "gusts.attack", self.attack, "above 0, below 1")
    }
}

#[cfg(test)]
mod tests {
    use super::super::pressure::{Effort, Method};
    use super::*;

    #[test]
    fn the_default_is_allowed() {
        assert_eq!(Config::default().validate(), Ok(()));
    }

    #[test]
    fn each_bad_setting_is_named() {
        type Spoil = fn(&mut Config);
        let cases: [(&str, Spoil); 24] = [
            ("cells[1]", |c| c.cells[1] = 0),
            ("cells", |c| c.cells = [512; 3]),
            ("spacing_m[2]", |c| c.spacing_m[2] = f32::NAN),
            ("viscosity_m2_per_s", |c| c.viscosity_m2_per_s = -1.0),
            ("relaxation_per_sec", |c| c.relaxation_per_sec = f32::INFINITY),
            ("mean_wind_m_per_s[0]", |c| c.boundary[0] = [Boundary::FreeSlip; 2]),
            ("boundary[2]", |c| c.boundary[2] = [Boundary::Wrap, Boundary::NoSlip]),
            ("boundary[1]", |c| c.boundary[1][1] = Boundary::Lid { velocity_m_per_s: [0.0, 1.0, 0.0] }),
            ("damping", |c| c.damping = 1.5),
            ("time", |c| c.time = TimeScheme::Reflection),
            ("time", |c| c.advection = Advection::Bfecc),
            ("diffusion", |c| c.diffusion = Diffusion::GaussSeidel { sweeps: 0 }),
            ("pressure", |c| c.pressure = Pressure::Iterative(Method::Sor, Effort { tolerance: 0.0, sweeps: 9 })),
            ("body_force_m_per_s2[1]", |c| c.body_force_m_per_s2[1] = f32::NAN),
            ("canopy.height_m", |c| c.canopy = Some(Canopy { height_m: 0.0, ..Canopy::default() })),
            ("mean_wind_m_per_s[2]", |c| c.mean_wind_m_per_s[2] = f32::NAN),
            ("profile", |c| c.boundary[1] = [Boundary::Wrap; 2]),
            ("profile.roughness_m", |c| c.profile = Profile::Log { roughness_m: 0.0, reference_m: 10.0 }),
            ("profile.exponent", |c| c.profile = Profile::Power { exponent: 2.0, reference_m: 10.0 }),
            ("gusts.number", |c| c.gusts.number = 5000),
            ("gusts.life_secs", |c| c.gusts.life_secs = 0.0),
            ("gusts.attack", |c| c.gusts.attack = 1.0),
            ("gusts.radius_m[1]", |c| c.gusts.radius_m[1] = -2.0),
            ("dust.settling_per_sec", |c| c.dust = Some(Dust { settling_per_sec: -0.1, ..Dust::default() })),
        ];
        for (field, spoil) in cases {
            let mut config = Config::default();
            spoil(&mut config);
            let error = config.validate().expect_err(field);
            assert_eq!(error.field, field);
            assert!(error.to_string().contains("allowed"), "{error}");
        }
    }
}
