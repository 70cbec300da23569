//! One time step of the field, by the scheme that the caller chooses.

use super::halo::Seams;
use super::limits::{SUBSTEPS_LIMIT, courant_fraction, substeps};
use super::verlet::{self, Pass};
use super::{Coefficients, Damping, Executor, Field, HALO, Report, Scheme, StepError, implicit};

impl Field {
    /// Advances the field by `dt_secs`.
    ///
    /// # Errors
    /// [`StepError`] when the scheme cannot be used here or would need too many sub-steps. The field is then unchanged, except that patches with a
    /// NaN or infinite value have been put to rest.
    pub fn step(&mut self, scheme: Scheme, dt_secs: f32, executor: &impl Executor) -> Result<Report, StepError> {
        if !(dt_secs.is_finite() && dt_secs > 0.0) {
            return Err(StepError::NoStep { dt_secs });
        }
        let awake = self.patches.len();
        self.patches.retain(|patch| patch.theta_max_rad().is_finite() && patch.omega_max_rad_per_s().is_finite());
        let reset_patches = (awake - self.patches.len()) as u32;
        let report = match scheme {
            Scheme::Verlet => self.explicit(1, Damping::Plain, dt_secs, executor),
            Scheme::Substepped => self.explicit(self.substeps(dt_secs)?, Damping::Exact, dt_secs, executor),
            Scheme::Implicit => implicit::step(self, dt_secs, executor),
            Scheme::Modal => self.modal(dt_secs)?,
        };
        self.revision.0 = self.revision.0.wrapping_add(1);
        self.patches.iter_mut().for_each(|patch| patch.tiles.set_revision(self.revision.0));
        Ok(Report { reset_patches, ..report })
    }

    #[cfg(feature = "modal")]
    fn modal(&mut self, dt_secs: f32) -> Result<Report, StepError> {
        super::modal::step(self, dt_secs)
    }

    #[cfg(not(feature = "modal"))]
    fn modal(&mut self, _: f32) -> Result<Report, StepError> {
        Err(StepError::Unavailable)
    }

    /// Number of sub-steps of [`Scheme::Substepped`] in `dt_secs` at the present bending velocities.
    fn substeps(&self, dt_secs: f32) -> Result<u32, StepError> {
        let omega_max = self.omega_max_rad_per_s();
        substeps(self.kinds.waves(), self.layout.cell_m, dt_secs, omega_max, Damping::Exact).ok_or(StepError::TooFast {
            omega_rad_per_s: omega_max,
            allowed: SUBSTEPS_LIMIT,
            dt_secs,
        })
    }

    fn explicit(&mut self, count: u32, damping: Damping, dt_secs: f32, executor: &impl Executor) -> Report {
        let substep_secs = dt_secs / count as f32;
        let coefficients = |waves| Coefficients::new(waves, self.layout.cell_m, substep_secs, damping);
        let mut kinds = std::mem::take(&mut self.workspace.coefficients);
        kinds.clear();
        kinds.extend(self.kinds.waves().iter().map(coefficients));
        let omega_max = self.omega_max_rad_per_s();
        let mut report = Report {
            substeps: count,
            courant_fraction: kinds.iter().map(|k| courant_fraction(k, omega_max)).fold(0.0, f32::max),
            ..Report::default()
        };
        let mut ratio = self.dt_secs.replace(substep_secs).map_or(1.0, |last| substep_secs / last);
        let mut left = count as usize;
        while left > 0 {
            let substeps = left.min(HALO);
            report.refused += self.exchange(substeps, executor);
            let rings = (self.seams == Seams::Overlap).then_some(HALO - 1);
            let pass = Pass { kinds: &kinds, substeps, ratio, rings, limit_rad: self.ground_contact.limit_rad() };
            executor.for_each(&mut self.patches, |patch| verlet::advance(patch, &pass));
            report.cell_steps += self.patches.iter().map(|patch| patch.cells_stepped).sum::<u64>();
            (left, ratio) = (left - substeps, 1.0);
        }
        self.workspace.coefficients = kinds;
        report
    }
}
