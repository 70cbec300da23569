//! A step of the solver: checks, sub-steps and diagnostics.

use super::canopy::Stems;
use super::pressure::Convergence;
use super::state::{MAX_SUBSTEPS, StepError, StepReport};
use super::{Config, Jet, Real, Solver, TimeScheme, diagnostics, limits, parallel, sources};

impl<R: Real> Solver<R> {
    /// Advances the air by `dt_secs` (s), driven by the mean wind, gusts, primitives and `jets`.
    ///
    /// # Errors
    /// See [`StepError`].
    pub fn step(&mut self, dt_secs: f64, jets: &[Jet]) -> Result<StepReport, StepError> {
        if parallel::is_worth_sharing(self.grid.padded_len()) {
            // Entering the thread pool once saves a hand-over per loop.
            rayon::scope(|_| self.take_step(dt_secs, jets))
        } else {
            self.take_step(dt_secs, jets)
        }
    }

    fn take_step(&mut self, dt_secs: f64, jets: &[Jet]) -> Result<StepReport, StepError> {
        if let Some(index) = jets.iter().position(|jet| !jet.is_valid()) {
            return Err(StepError::BadJet { index, jet: jets[index] });
        }
        let (mut left_secs, mut substeps) = (dt_secs, 0);
        let convergence = loop {
            let most = MAX_SUBSTEPS - substeps;
            let needed = limits::substeps(&self.config, &self.grid, self.diagnostics.max_speed_m_per_s, left_secs, most)?;
            let (convergence, taken) = self.first_substep(left_secs, needed, most, jets)?;
            substeps += 1;
            if taken == 1 {
                break convergence;
            }
            left_secs -= left_secs / f64::from(taken);
        };
        let spacing_m = self.grid.spacing_m.map(R::wide);
        Ok(StepReport {
            courant: (0..3).map(|axis| self.diagnostics.max_speed_m_per_s[axis] * dt_secs / spacing_m[axis]).sum(),
            divergence_rms_rel: self.diagnostics.divergence_rms_rel,
            kinetic_energy_m2_per_s2: self.diagnostics.kinetic_energy_m2_per_s2,
            substeps,
            pressure_residual: convergence.residual,
            pressure_sweeps: convergence.sweeps,
        })
    }

    /// Checks whether a solver with `config` could take steps of `dt_secs` (s) from rest, without creating it.
    ///
    /// # Errors
    /// [`StepError::BadTimeStep`] or [`StepError::TooLong`].
    pub fn check_step(config: &Config, dt_secs: f64) -> Result<(), StepError> {
        limits::substeps(config, &config.grid::<R>(), [0.0; 3], dt_secs, MAX_SUBSTEPS).map(|_| ())
    }

    /// Takes the first of `substeps` equal sub-steps of the rest of a step. Doubles their number, up to `most`, while the air becomes too fast for
    /// them. Returns the final number.
    fn first_substep(&mut self, left_secs: f64, mut substeps: u32, most: u32, jets: &[Jet]) -> Result<(Convergence, u32), StepError> {
        loop {
            match self.substep(left_secs / f64::from(substeps), jets) {
                Err(StepError::TooLong { .. }) if 2 * substeps <= most => substeps *= 2,
                Err(StepError::TooLong { what, needed, stable_dt_secs, .. }) => {
                    return Err(StepError::TooLong { what, dt_secs: left_secs, needed: needed * f64::from(substeps), stable_dt_secs });
                }
                done => return Ok((done?, substeps)),
            }
        }
    }

    /// Takes one sub-step. If it turns out too long, the state is unchanged.
    fn substep(&mut self, dt_secs: f64, jets: &[Jet]) -> Result<Convergence, StepError> {
        if let Some(old) = &mut self.old {
            old.copy_from(&self.velocity);
        }
        if let Some(old_pressure_gradient) = &mut self.old_pressure_gradient {
            old_pressure_gradient.copy_from(&self.pressure_gradient);
        }
        self.stems.iter_mut().for_each(Stems::keep);
        let gusts = sources::sources_at(&self.config, &self.grid, &self.mean, self.time_secs + 0.5 * dt_secs);
        self.pushes.set(&self.grid, &self.config.gusts, gusts, &self.velocity, &mut self.footprint);
        let convergence = match self.config.time {
            TimeScheme::Split => self.split(dt_secs, jets)?,
            TimeScheme::Reflection => self.reflection(dt_secs, jets),
            TimeScheme::RungeKutta3 => self.runge_kutta(dt_secs, jets)?,
        };
        self.measure();
        if !self.diagnostics.kinetic_energy_m2_per_s2.is_finite() {
            let cell = diagnostics::first_non_finite_cell(&self.grid, &self.velocity).unwrap_or_default();
            return Err(StepError::NotFinite { cell, time_secs: self.time_secs });
        }
        if let (Some(dust), Some(old)) = (self.config.dust, &self.old) {
            let half = R::of(0.5);
            for axis in 0..3 {
                let (old, new) = (&old.0[axis].data, &self.velocity.0[axis].data);
                let mean = self.stages[0].0[axis].data.iter_mut().zip(old).zip(new);
                mean.for_each(|((mean, &old), &new)| *mean = half * (old + new));
            }
            if let Err(error) = self.advance_dust(&dust, dt_secs) {
                self.roll_back();
                return Err(error);
            }
        }
        self.time_secs += dt_secs;
        Ok(convergence)
    }

    /// Restores the state before the sub-step.
    pub(super) fn roll_back(&mut self) {
        if let Some(old) = &self.old {
            self.velocity.copy_from(old);
        }
        if let Some(old_pressure_gradient) = &self.old_pressure_gradient {
            self.pressure_gradient.copy_from(old_pressure_gradient);
        }
        self.stems.iter_mut().for_each(Stems::roll_back);
        self.boundaries.update_inflow(self.time_secs);
        self.measure();
    }
}
