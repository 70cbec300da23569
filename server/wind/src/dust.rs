//! Release, settling, advection and diffusion of dust.

use super::config::Config;
use super::diffuse::{Portion, diffuse};
use super::footprint::Footprint;
use super::intensity::Moment;
use super::profile::MeanWind;
use super::state::{MAX_SUBSTEPS, StepError};
use super::transport::{STAGES, Stage};
use super::{Diffusion, Dust, Field, Grid, Real, Solver, advect, diagnostics, limits, sources, trajectory};

impl<R: Real> Solver<R> {
    /// Advances only the dust by `dt_secs` (s), in the present velocity.
    ///
    /// # Errors
    /// [`StepError::BadTimeStep`] or [`StepError::TooLong`].
    pub fn step_dust(&mut self, dt_secs: f64) -> Result<(), StepError> {
        limits::substeps(&self.config, &self.grid, self.diagnostics.max_speed_m_per_s, dt_secs, MAX_SUBSTEPS)?;
        if let Some(dust) = self.config.dust {
            self.stages[0].copy_from(&self.velocity);
            self.advance_dust(&dust, dt_secs)?;
        }
        Ok(())
    }

    /// Advances the dust in the velocity of the first stage. Leaves it unchanged if the air is too fast.
    pub(super) fn advance_dust(&mut self, settings: &Dust, dt_secs: f64) -> Result<(), StepError> {
        let (grid, air) = (&self.grid, &self.stages[0]);
        let max_speed_m_per_s = diagnostics::largest_speeds(grid, air, &self.pressure_gradient, 0.0);
        let substeps = limits::dust_substeps(&self.config, settings, grid, max_speed_m_per_s, dt_secs)?;
        self.release_and_settle(dt_secs);
        if settings.advection.uses_fluxes() {
            self.transport_dust(settings, dt_secs, substeps);
        } else {
            self.advect_dust(settings, dt_secs);
        }
        if !self.diffuses_in_fluxes(settings) {
            let Some(dust) = &mut self.dust else { return Ok(()) };
            let ([even, odd], diffusivity) = (&mut self.dust_stages, f64::from(settings.diffusivity_m2_per_s));
            let boundaries = |field: &mut _, _: f64| self.boundaries.apply_to_concentration(field);
            let (scheme, scratch) = (self.config.diffusion, [even, odd]);
            diffuse(scheme, Portion::Whole, &self.grid, diffusivity, dt_secs, dust, scratch, self.implicit.as_mut(), boundaries);
        }
        Ok(())
    }

    /// Whether the fluxes of transport include diffusion.
    fn diffuses_in_fluxes(&self, settings: &Dust) -> bool {
        settings.advection.uses_fluxes() && self.config.diffusion == Diffusion::Explicit
    }

    fn release_and_settle(&mut self, dt_secs: f64) {
        let middle = self.moment(self.time_secs + 0.5 * dt_secs);
        let (grid, Some(dust)) = (&self.grid, &mut self.dust) else { return };
        release_and_settle(grid, &self.config, &self.mean, middle, dt_secs, dust, &mut self.footprint);
        self.boundaries.apply_to_concentration(dust);
    }

    /// Advection by fluxes.
    fn transport_dust(&mut self, settings: &Dust, dt_secs: f64, substeps: u32) {
        let diffusivity_m2_per_s = if self.diffuses_in_fluxes(settings) { f64::from(settings.diffusivity_m2_per_s) } else { 0.0 };
        let (grid, air, Some(dust)) = (&self.grid, &self.stages[0], &mut self.dust) else { return };
        let [even, odd] = &mut self.dust_stages;
        let dt_secs = dt_secs / f64::from(substeps);
        for _ in 0..substeps {
            for (number, fraction) in STAGES.into_iter().enumerate() {
                let (carried, target) = match number {
                    0 => (&*dust, &mut *even),
                    1 => (&*even, &mut *odd),
                    _ => (&*odd, &mut *even),
                };
                let stage = Stage {
                    grid,
                    air,
                    carried,
                    start: dust,
                    pressure_gradient: None,
                    dt_secs,
                    fraction,
                    diffusivity_m2_per_s,
                    damping: 0.0,
                };
                stage.run(target, &mut self.transport);
                self.boundaries.apply_to_concentration(target);
            }
            std::mem::swap(dust, even);
        }
    }

    /// Advection along trajectories.
    fn advect_dust(&mut self, settings: &Dust, dt_secs: f64) {
        let (grid, air, Some(dust)) = (&self.grid, &self.stages[0], &mut self.dust) else { return };
        diagnostics::interpolate_to_centres(grid, air, &mut self.centres);
        trajectory::trace(grid, &self.centres, dt_secs, &mut self.trajectories);
        let target = &mut self.dust_stages[0];
        let boundaries = |field: &mut _, _| self.boundaries.apply_to_concentration(field);
        advect::advect(settings.advection, grid, &self.trajectories, dust, target, &mut self.advection, boundaries);
        std::mem::swap(dust, target);
        self.boundaries.apply_to_concentration(dust);
    }
}

/// Releases the dust of gusts and primitives at `middle`, the middle of a step of `dt_secs` (s), and lets dust settle.
pub(super) fn release_and_settle<R: Real>(
    grid: &Grid<R>,
    config: &Config,
    mean: &MeanWind,
    middle: Moment,
    dt_secs: f64,
    dust: &mut Field<R>,
    footprint: &mut Footprint<R>,
) {
    let Some(settings) = config.dust else { return };
    let release = f64::from(settings.release_per_s);
    for source in sources::sources_at(config, grid, mean, middle.secs) {
        sources::release(grid, &config.gusts, &source, release, dt_secs, dust, footprint);
    }
    for primitive in &config.primitives {
        primitive.release(grid, middle, release, dt_secs, dust, footprint);
    }
    let left = R::of(1.0 / (1.0 + f64::from(settings.settling_per_s) * dt_secs));
    dust.data.iter_mut().for_each(|density| *density = *density * left);
}
