//! Everything a wind solver can be told, and what is allowed.

use super::{Boundary, Grid, Real};

/// Most cells along one axis.
pub const MAX_CELLS_PER_AXIS: usize = 512;
/// Most cells in all (16 Mi: about 1.3 GB of fields).
pub const MAX_CELLS: usize = 1 << 24;

/// Settings of a [`WindSolver`](super::WindSolver). [`Config::default`] is the wind of the default scene: 256 m × 16 m × 256 m of gusty air.
#[derive(Clone, Debug, PartialEq)]
pub struct Config {
    /// Number of cells along x, y and z. Default `[32, 8, 32]`; each 1 to [`MAX_CELLS_PER_AXIS`], at most [`MAX_CELLS`] in all.
    pub cells: [usize; 3],
    /// Size of a cell (m). Default `[8, 2, 8]`; each 0.01 to 10 000.
    pub spacing_m: [f32; 3],
    /// What the faces across x, y and z do. Default wrap, wall, wrap.
    pub boundary: [Boundary; 3],
    /// How velocity and dust are carried along. Default [`Advection::MacCormack`].
    pub advection: Advection,
    /// Eddy viscosity of the air (m²/s), default 0.2; 0 or more. Molecular viscosity is 1.5e-5; what a grid of metres needs stands for the eddies
    /// smaller than a cell.
    pub viscosity_m2_per_s: f32,
    /// Mean wind (m/s) at the reference height of the profile, default `[5, 0, 1.5]`. The y component is ignored; components across walls must be 0.
    pub mean_wind_m_per_s: [f32; 3],
    /// How the mean wind grows with height. Default [`Profile::Log`] over grass; over a box that wraps in y only [`Profile::Uniform`].
    pub profile: Profile,
    /// Rate (1/s) at which the mean of each layer of cells returns to the profile, default 0.2; 0 or more. It stands for the pressure gradient that
    /// drives the wind and the friction that holds it; gusts, which are departures from a layer's mean, are left alone.
    pub relaxation_per_sec: f32,
    /// The random sources that keep the air stirred.
    pub gusts: Gusts,
    /// Dust carried by the wind; `None` (default) for clear air.
    pub dust: Option<Dust>,
    /// Seed of everything random. Default 1.
    pub seed: u64,
}

/// How a field is carried along by the wind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Advection {
    /// The value at the departure point, interpolated linearly (Stam, Stable Fluids, SIGGRAPH 1999; 000 §2.3.3). First order in space: at small
    /// Courant numbers it spreads a field like a diffusivity of |u|·h/2.
    SemiLagrangian,
    /// Semi-Lagrangian forth and back, corrected by half the error of the round trip (Selle et al., J. Sci. Comput. 35, 2008). Second order.
    MacCormack,
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
            boundary: [Boundary::Wrap, Boundary::Wall, Boundary::Wrap],
            advection: Advection::MacCormack,
            viscosity_m2_per_s: 0.2,
            mean_wind_m_per_s: [5.0, 0.0, 1.5],
            profile: Profile::Log { roughness_m: 0.05, reference_m: 10.0 },
            relaxation_per_sec: 0.2,
            gusts: Gusts::default(),
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
        Self { diffusivity_m2_per_s: 0.2, release_per_sec: 1.0, settling_per_sec: 0.1 }
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

fn check(ok: bool, field: impl Into<String>, value: impl std::fmt::Display, allowed: &'static str) -> Result<(), ConfigError> {
    if ok { Ok(()) } else { Err(ConfigError { field: field.into(), value: value.to_string(), allowed }) }
}

fn at_least_zero(field: &str, value: f32) -> Result<(), ConfigError> {
    check((0.0..=1.0e6).contains(&value), field, value, "0 to 1e6")
}

fn above_zero(field: &str, value: f32) -> Result<(), ConfigError> {
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
            let mean = self.mean_wind_m_per_s[axis];
            check(mean.abs() <= 200.0, format!("mean_wind_m_per_s[{axis}]"), mean, "-200 to 200")?;
            let blocked = axis != 1 && mean != 0.0 && self.boundary[axis] == Boundary::Wall;
            check(!blocked, format!("mean_wind_m_per_s[{axis}]"), mean, "0, since the box has walls across this axis")?;
            above_zero(&format!("gusts.radius_m[{axis}]"), self.gusts.radius_m[axis])?;
        }
        let total: usize = self.cells.iter().product();
        check(total <= MAX_CELLS, "cells", format!("{total} in all"), "at most 16777216 in all")?;
        at_least_zero("viscosity_m2_per_s", self.viscosity_m2_per_s)?;
        at_least_zero("relaxation_per_sec", self.relaxation_per_sec)?;
        self.profile.validate(self.boundary[1])?;
        self.gusts.validate()?;
        if let Some(dust) = &self.dust {
            at_least_zero("dust.diffusivity_m2_per_s", dust.diffusivity_m2_per_s)?;
            at_least_zero("dust.release_per_sec", dust.release_per_sec)?;
            at_least_zero("dust.settling_per_sec", dust.settling_per_sec)?;
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
        check(vertical == Boundary::Wall, "profile", format!("{self:?}"), "Uniform, since the box wraps in y and so has no ground")
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
    use super::*;

    #[test]
    fn the_default_is_allowed() {
        assert_eq!(Config::default().validate(), Ok(()));
    }

    #[test]
    fn each_bad_setting_is_named() {
        type Spoil = fn(&mut Config);
        let cases: [(&str, Spoil); 15] = [
            ("cells[1]", |c| c.cells[1] = 0),
            ("cells", |c| c.cells = [512; 3]),
            ("spacing_m[2]", |c| c.spacing_m[2] = f32::NAN),
            ("viscosity_m2_per_s", |c| c.viscosity_m2_per_s = -1.0),
            ("relaxation_per_sec", |c| c.relaxation_per_sec = f32::INFINITY),
            ("mean_wind_m_per_s[0]", |c| c.boundary[0] = Boundary::Wall),
            ("mean_wind_m_per_s[2]", |c| c.mean_wind_m_per_s[2] = f32::NAN),
            ("profile", |c| c.boundary[1] = Boundary::Wrap),
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
