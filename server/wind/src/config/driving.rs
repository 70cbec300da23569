//! Settings of the mean wind profile, gusts and dust.

use super::error::{ConfigError, above_zero, at_least_zero, check};
use crate::advect::Advection;
use crate::boundary::Boundary;

/// Vertical profile of the mean wind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Profile {
    /// The same at every height.
    Uniform,
    /// Logarithmic, for a neutral surface layer: `ln(1 + y/z₀) / ln(1 + y_ref/z₀)`.
    Log {
        /// Roughness length z₀ (m); 0.03 to 0.1 over grass. Above 0.
        roughness_m: f32,
        /// Height y_ref (m) at which the wind equals the mean wind; 10 by convention. Above 0.
        reference_m: f32,
    },
    /// Power law: `(y / y_ref)^exponent`.
    Power {
        /// 1/7 over open land. 0 to 1.
        exponent: f32,
        /// Height y_ref (m) at which the wind equals the mean wind. Above 0.
        reference_m: f32,
    },
}

/// Gusts: random sources (Zhang §2.3.1). Each pushes the air during its life and is then reborn elsewhere.
///
/// A source drifts with the mean wind at its height, so that it accelerates the same parcel of air throughout its life.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gusts {
    /// Number of sources alive at any time. Default 24; 0 for still air, at most 4096.
    pub number: usize,
    /// Speed (m/s) that the strongest source would give the air at its centre over its life, without advection. Default 14; 0 or more.
    pub strength_m_per_s: f32,
    /// Life of a source (s). Default 6; above 0.
    pub life_secs: f32,
    /// Fraction of the life during which the push grows; it decays over the rest. Default 0.15, a steep attack and a gentle decay (Bakay §3.2); above 0, below 1.
    pub attack: f32,
    /// Half-widths of a source along x, y and z (m). Default `[14, 5, 14]`; above 0. A half-width below the cell size is widened to it.
    pub radius_m: [f32; 3],
}

/// Dust, seed or another passive scalar, as a dimensionless concentration: a source of `release_per_s = 1` adds 1 at its centre in one second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dust {
    /// Advection scheme. Default [`Advection::Conservative`], which conserves the amount of dust.
    pub advection: Advection,
    /// Diffusivity (m²/s). Default 0.2; 0 or more.
    pub diffusivity_m2_per_s: f32,
    /// Release rate (1/s) of a gust source at its centre and peak. Default 1; 0 or more.
    pub release_per_s: f32,
    /// Rate (1/s) at which dust settles out of the air. Default 0.1; 0 or more.
    pub settling_per_s: f32,
}

impl Default for Gusts {
    fn default() -> Self {
        Self { number: 24, strength_m_per_s: 14.0, life_secs: 6.0, attack: 0.15, radius_m: [14.0, 5.0, 14.0] }
    }
}

impl Default for Dust {
    fn default() -> Self {
        Self { advection: Advection::Conservative, diffusivity_m2_per_s: 0.2, release_per_s: 1.0, settling_per_s: 0.1 }
    }
}

impl Profile {
    pub(super) fn validate(&self, vertical: Boundary) -> Result<(), ConfigError> {
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
        check(vertical != Boundary::Wrap, "profile", format!("{self:?}"), "Uniform, since a box that is periodic in y has no ground")
    }

    /// Mean wind at a height above the ground (m), relative to that at the reference height.
    pub fn fraction_at(&self, height_m: f64) -> f64 {
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
    pub(super) fn validate(&self) -> Result<(), ConfigError> {
        check(self.number <= 4096, "gusts.number", self.number, "0 to 4096")?;
        at_least_zero("gusts.strength_m_per_s", self.strength_m_per_s)?;
        above_zero("gusts.life_secs", self.life_secs)?;
        check(self.attack > 0.0 && self.attack < 1.0, "gusts.attack", self.attack, "above 0, below 1")?;
        (0..3).try_for_each(|axis| above_zero(&format!("gusts.radius_m[{axis}]"), self.radius_m[axis]))
    }
}

impl Dust {
    pub(super) fn validate(&self) -> Result<(), ConfigError> {
        at_least_zero("dust.diffusivity_m2_per_s", self.diffusivity_m2_per_s)?;
        at_least_zero("dust.release_per_s", self.release_per_s)?;
        at_least_zero("dust.settling_per_s", self.settling_per_s)
    }
}
