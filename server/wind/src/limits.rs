//! Stability limits of a step, and the number of sub-steps they require.

use super::state::{MAX_SUBSTEPS, StepError};
use super::{Config, Diffusion, Dust, Grid, Real, diffuse, transport};

/// Sub-step length as a fraction of the longest stable step, since the air may be faster at its end.
const SAFETY: f64 = 0.8;
/// Maximum Courant number, summed over the axes, at which limited transport of dust creates no new extrema.
const DUST_COURANT: f64 = 0.5;

/// Limits as named in [`StepError::TooLong`].
pub(super) const COURANT: &str = "the Courant number of conservative advection";
const DUST: &str = "the Courant number of conservative dust.advection";

/// Number of sub-steps, at least 1 and at most `most`, that keeps a step within the stability limits at these speeds.
pub(super) fn substeps<R: Real>(
    config: &Config,
    grid: &Grid<R>,
    max_speed_m_per_s: [f64; 3],
    dt_secs: f64,
    most: u32,
) -> Result<u32, StepError> {
    if !(dt_secs > 0.0 && dt_secs.is_finite()) {
        return Err(StepError::BadTimeStep { dt_secs });
    }
    let explicit = config.diffusion == Diffusion::Explicit;
    let viscosity = if explicit { f64::from(config.viscosity_m2_per_s) } else { 0.0 };
    let substeps = if config.advection.uses_fluxes() {
        count("viscosity_m2_per_s", dt_secs, SAFETY * transport::stable_dt_secs(grid, [0.0; 3], viscosity), most)?;
        count(COURANT, dt_secs, SAFETY * transport::stable_dt_secs(grid, max_speed_m_per_s, viscosity), most)?
    } else {
        // Explicit diffusion has sub-steps of its own.
        count("viscosity_m2_per_s", dt_secs, diffuse::stable_dt_secs(grid, viscosity), most)?;
        1
    };
    if let Some(dust) = config.dust {
        let diffusivity = if explicit { f64::from(dust.diffusivity_m2_per_s) } else { 0.0 };
        count("dust.diffusivity_m2_per_s", dt_secs, diffuse::stable_dt_secs(grid, diffusivity), most)?;
        dust_substeps(config, &dust, grid, max_speed_m_per_s, dt_secs / f64::from(substeps))?;
    }
    Ok(substeps)
}

/// Number of dust sub-steps, at least 1, that keeps limited transport free of new extrema at these speeds.
pub(super) fn dust_substeps<R: Real>(
    config: &Config,
    dust: &Dust,
    grid: &Grid<R>,
    max_speed_m_per_s: [f64; 3],
    dt_secs: f64,
) -> Result<u32, StepError> {
    if !dust.advection.uses_fluxes() {
        return Ok(1);
    }
    let diffusivity = if config.diffusion == Diffusion::Explicit { f64::from(dust.diffusivity_m2_per_s) } else { 0.0 };
    let courant_per_s: f64 = (0..3).map(|axis| max_speed_m_per_s[axis] / grid.spacing_m[axis].wide()).sum();
    let stable_dt_secs = (courant_per_s / DUST_COURANT + diffuse::stable_dt_secs(grid, diffusivity).recip()).recip();
    count(DUST, dt_secs, stable_dt_secs, MAX_SUBSTEPS)
}

/// Number of steps of at most `stable_dt_secs` that cover `dt_secs`, at least 1.
///
/// # Errors
/// [`StepError::TooLong`] if there are more than `most`.
pub(super) fn count(what: &'static str, dt_secs: f64, stable_dt_secs: f64, most: u32) -> Result<u32, StepError> {
    let needed = (dt_secs / stable_dt_secs).ceil().max(1.0);
    if needed <= f64::from(most) { Ok(needed as u32) } else { Err(StepError::TooLong { what, dt_secs, needed, stable_dt_secs }) }
}
