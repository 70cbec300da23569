//! One step of the air, as each time scheme lists it.

use super::boundary::Beyond;
use super::diffuse::{Portion, spread};
use super::pressure::Convergence;
use super::state::{MAX_SUBSTEPS, StepError, StepReport};
use super::transport::{self, STAGE_ENDS, STAGES, Stage};
use super::{
    Advection, Config, Diffusion, Dust, Grid, Jet, Real, Solver, TimeScheme, advect, canopy, diffuse, forcing, health, parallel, profile,
    sources, trace,
};

/// Share of the longest stable step that a substep takes, since air may be faster at its end than at its beginning.
const SAFETY: f64 = 0.8;
/// What a step that is too long for its air is said to break.
const COURANT: &str = "the Courant number of conservative advection";
const DUST_COURANT_NAME: &str = "the Courant number of conservative dust.advection";
/// Sum of Courant numbers up to which limited transport of dust makes no new extrema.
const DUST_COURANT: f64 = 0.5;

impl<R: Real> Solver<R> {
    /// Advances the air by `dt_secs` (s), driven by the mean wind, the random sources, the primitives and `jets`.
    ///
    /// # Errors
    /// See [`StepError`].
    pub fn step(&mut self, dt_secs: f64, jets: &[Jet]) -> Result<StepReport, StepError> {
        if parallel::is_worth_sharing(self.grid.padded_len()) {
            // Once on the threads that share the loops, no loop has to be handed over to them.
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
            let parts = parts(&self.config, &self.grid, self.health.fastest_m_per_s, left_secs, most)?;
            let (convergence, parts) = self.first_part(left_secs, parts, most, jets)?;
            substeps += 1;
            if parts == 1 {
                break convergence;
            }
            left_secs -= left_secs / f64::from(parts);
        };
        let spacing_m = self.grid.spacing_m.map(R::wide);
        Ok(StepReport {
            courant: (0..3).map(|axis| self.health.fastest_m_per_s[axis] * dt_secs / spacing_m[axis]).sum(),
            divergence_rms_rel: self.health.divergence_rms_rel,
            kinetic_energy_m2_per_s2: self.health.kinetic_energy_m2_per_s2,
            substeps,
            pressure_residual: convergence.residual,
            pressure_sweeps: convergence.sweeps,
        })
    }

    /// Whether a solver with `config` could take steps of `dt_secs` (s) from rest, asked without making one.
    ///
    /// # Errors
    /// [`StepError::BadTimeStep`] or [`StepError::TooLong`].
    pub fn check_step(config: &Config, dt_secs: f64) -> Result<(), StepError> {
        parts(config, &config.grid::<R>(), [0.0; 3], dt_secs, MAX_SUBSTEPS).map(|_| ())
    }

    /// Carries the dust alone for `dt_secs` (s), through the air as it is.
    ///
    /// # Errors
    /// [`StepError::BadTimeStep`] or [`StepError::TooLong`].
    pub fn step_dust(&mut self, dt_secs: f64) -> Result<(), StepError> {
        parts(&self.config, &self.grid, self.health.fastest_m_per_s, dt_secs, MAX_SUBSTEPS)?;
        if let Some(dust) = self.config.dust {
            self.stages[0].copy_from(&self.velocity);
            self.carry_dust(&dust, dt_secs)?;
        }
        Ok(())
    }

    /// Takes the first of `parts` parts of what is left of a step, or of twice as many, again and again up to `most`, where the air gets too fast on the way.
    fn first_part(&mut self, left_secs: f64, mut parts: u32, most: u32, jets: &[Jet]) -> Result<(Convergence, u32), StepError> {
        loop {
            match self.substep(left_secs / f64::from(parts), jets) {
                Err(StepError::TooLong { .. }) if 2 * parts <= most => parts *= 2,
                Err(StepError::TooLong { what, needed, stable_dt_secs, .. }) => {
                    return Err(StepError::TooLong { what, dt_secs: left_secs, needed: needed * f64::from(parts), stable_dt_secs });
                }
                done => return Ok((done?, parts)),
            }
        }
    }

    /// Takes one part of a step. If it proves too long, the state is as before.
    fn substep(&mut self, dt_secs: f64, jets: &[Jet]) -> Result<Convergence, StepError> {
        if let Some(old) = &mut self.old {
            old.copy_from(&self.velocity);
        }
        if let Some(old_pull) = &mut self.old_pull {
            old_pull.copy_from(&self.pull);
        }
        let gusts = sources::sources_at(&self.config, &self.grid, &self.mean, self.time_secs + 0.5 * dt_secs);
        self.pushes.set(&self.grid, &self.config.gusts, gusts, &self.velocity, &mut self.footprint);
        let convergence = match self.config.time {
            TimeScheme::Split => self.split(dt_secs, jets)?,
            TimeScheme::Reflection => self.reflection(dt_secs, jets),
            TimeScheme::RungeKutta3 => self.runge_kutta(dt_secs, jets)?,
        };
        self.observe();
        if !self.health.kinetic_energy_m2_per_s2.is_finite() {
            let cell = health::first_bad_cell(&self.grid, &self.velocity).unwrap_or_default();
            return Err(StepError::NotFinite { cell, time_secs: self.time_secs });
        }
        if let (Some(dust), Some(old)) = (self.config.dust, &self.old) {
            let half = R::of(0.5);
            for axis in 0..3 {
                let (old, new) = (&old.0[axis].data, &self.velocity.0[axis].data);
                let mean = self.stages[0].0[axis].data.iter_mut().zip(old).zip(new);
                mean.for_each(|((mean, &old), &new)| *mean = half * (old + new));
            }
            if let Err(error) = self.carry_dust(&dust, dt_secs) {
                self.go_back();
                return Err(error);
            }
        }
        self.time_secs += dt_secs;
        Ok(convergence)
    }

    /// Takes back what a part of a step did to the air.
    fn go_back(&mut self) {
        if let Some(old) = &self.old {
            self.velocity.copy_from(old);
        }
        if let Some(old_pull) = &self.old_pull {
            self.pull.copy_from(old_pull);
        }
        self.walls.blow(self.time_secs);
        self.observe();
    }

    /// Advection, forces, friction, projection, one after the other.
    fn split(&mut self, dt_secs: f64, jets: &[Jet]) -> Result<Convergence, StepError> {
        if self.config.advection == Advection::Conservative {
            // The pressure's pull, which only Runge–Kutta 3 keeps, is 0.
            self.transport(dt_secs, 0.0)?;
        } else {
            self.trace(dt_secs);
            self.walls.blow(self.time_secs + dt_secs);
            self.along_paths(0);
            std::mem::swap(&mut self.velocity, &mut self.stages[0]);
        }
        self.force(dt_secs, self.time_secs + 0.5 * dt_secs, jets);
        self.spread(Portion::Whole, dt_secs);
        Ok(self.project(None))
    }

    /// Half the forces and friction; the air of mid-step; half a step along its paths, reflection, half a step; half the friction and forces.
    fn reflection(&mut self, dt_secs: f64, jets: &[Jet]) -> Convergence {
        let middle_secs = self.time_secs + 0.5 * dt_secs;
        self.force(0.5 * dt_secs, middle_secs, jets);
        self.spread(Portion::First, dt_secs);

        self.trace(0.5 * dt_secs);
        self.walls.blow(middle_secs);
        self.along_paths(0);
        self.projection.project(&self.grid, &mut self.stages[0], &self.inflow, None);
        self.walls.close(&mut self.stages[0]);
        health::to_centres(&self.grid, &self.stages[0], &mut self.centres);
        trace::trace(&self.grid, &self.centres, 0.5 * dt_secs, &mut self.paths);

        self.along_paths(0);
        let [even, odd] = &mut self.stages;
        odd.copy_from(even);
        // What blows in is reflected too.
        self.walls.close_with(odd, Beyond::Extended);
        self.projection.project(&self.grid, &mut self.stages[0], &self.inflow, None);
        self.walls.close(&mut self.stages[0]);
        let two = R::of(2.0);
        for axis in 0..3 {
            let (free, bound) = (&self.stages[0].0[axis].data, &self.stages[1].0[axis].data);
            let reflected = self.velocity.0[axis].data.iter_mut().zip(free).zip(bound);
            reflected.for_each(|((reflected, &free), &bound)| *reflected = two * free - bound);
        }
        self.walls.close_with(&mut self.velocity, Beyond::Kept);
        self.walls.blow(self.time_secs + dt_secs);
        self.along_paths(0);
        std::mem::swap(&mut self.velocity, &mut self.stages[0]);

        self.spread(Portion::Second, dt_secs);
        self.force(0.5 * dt_secs, middle_secs, jets);
        self.project(None)
    }

    /// Half the forces and friction; three stages of conservative transport under the old pressure; half the friction and forces; the correction of
    /// the pressure.
    fn runge_kutta(&mut self, dt_secs: f64, jets: &[Jet]) -> Result<Convergence, StepError> {
        let middle_secs = self.time_secs + 0.5 * dt_secs;
        let explicit = self.config.diffusion == Diffusion::Explicit;
        self.force(0.5 * dt_secs, middle_secs, jets);
        if !explicit {
            self.spread(Portion::First, dt_secs);
        }
        self.transport(dt_secs, if explicit { self.config.viscosity_m2_per_s.into() } else { 0.0 })?;
        if !explicit {
            self.spread(Portion::Second, dt_secs);
        }
        self.force(0.5 * dt_secs, middle_secs, jets);
        Ok(self.project(Some(dt_secs)))
    }

    /// Carries the velocity by fluxes through faces, under the pressure of the step before. Goes back if forces and pressure make the air too fast for that.
    fn transport(&mut self, dt_secs: f64, viscosity_m2_per_s: f64) -> Result<(), StepError> {
        let fastest_m_per_s = health::fastest_to_be(&self.grid, &self.velocity, &self.pull, dt_secs);
        let stable_dt_secs = transport::stable_dt_secs(&self.grid, fastest_m_per_s, viscosity_m2_per_s);
        if let Err(error) = count(COURANT, dt_secs, stable_dt_secs, 1) {
            self.go_back();
            return Err(error);
        }
        let looks_around =
            self.config.canopy.is_some() || self.config.diffusion != Diffusion::Explicit || self.config.time == TimeScheme::Split;
        for (number, share) in STAGES.into_iter().enumerate() {
            let [even, odd] = &mut self.stages;
            let (air, target) = match number {
                0 => (&self.velocity, even),
                1 => (&*even, odd),
                _ => (&*odd, even),
            };
            for axis in 0..3 {
                let stage = Stage {
                    grid: &self.grid,
                    air,
                    carried: &air.0[axis],
                    start: &self.velocity.0[axis],
                    pull: Some(&self.pull.0[axis]),
                    dt_secs,
                    share,
                    diffusivity_m2_per_s: viscosity_m2_per_s,
                    damping: self.config.damping.into(),
                };
                stage.run(&mut target.0[axis], &mut self.transport);
            }
            self.walls.blow(self.time_secs + STAGE_ENDS[number] * dt_secs);
            // After the last stage come forces, which close the walls again: only friction and grass look at ghosts before.
            if number < 2 || looks_around {
                self.walls.close(target);
            }
        }
        std::mem::swap(&mut self.velocity, &mut self.stages[0]);
        Ok(())
    }

    /// Traces the air of the step's beginning.
    fn trace(&mut self, dt_secs: f64) {
        health::to_centres(&self.grid, &self.velocity, &mut self.centres);
        trace::trace(&self.grid, &self.centres, dt_secs, &mut self.paths);
    }

    /// Carries the velocity along the paths into a stage.
    fn along_paths(&mut self, stage: usize) {
        for axis in 0..3 {
            let (field, target) = (&self.velocity.0[axis], &mut self.stages[stage].0[axis]);
            let close = |field: &mut _, beyond| self.walls.close_component_with(field, beyond);
            advect::advect(self.config.advection, &self.grid, &self.paths, field, target, &mut self.advection, close);
        }
        self.walls.close(&mut self.stages[stage]);
    }

    /// Everything that drives or slows the air but friction and pressure.
    fn force(&mut self, dt_secs: f64, time_secs: f64, jets: &[Jet]) {
        let grid = &self.grid;
        if let Some(canopy) = &self.config.canopy {
            canopy::drag(grid, canopy, &self.cover, dt_secs, &mut self.velocity, &mut self.stages[0]);
        }
        self.pushes.apply(dt_secs, &mut self.velocity);
        for primitive in &self.config.primitives {
            primitive.drive(grid, time_secs, dt_secs, &mut self.velocity, &mut self.footprint);
        }
        for jet in jets {
            forcing::drive(grid, jet, dt_secs, &mut self.velocity, &mut self.footprint);
        }
        self.relaxation.apply(grid, self.config.relaxation_per_sec.into(), dt_secs, &mut self.velocity);
        if let Some(seam_m) = self.seam_m {
            profile::calm(grid, &self.mean, seam_m, dt_secs, &mut self.velocity);
        }
        for (field, &force) in self.velocity.0.iter_mut().zip(&self.config.body_force_m_per_s2) {
            let gain = R::of(f64::from(force) * dt_secs);
            if gain != R::zero() {
                field.data.iter_mut().for_each(|speed| *speed = *speed + gain);
            }
        }
        self.walls.close(&mut self.velocity);
        self.inflow.fill(0.0);
        if !self.inflow.is_empty() {
            for primitive in &self.config.primitives {
                primitive.blow(&self.grid, time_secs, &mut self.inflow, &mut self.footprint);
            }
        }
    }

    fn spread(&mut self, portion: Portion, dt_secs: f64) {
        let [a, b] = &mut self.stages;
        for (axis, field) in self.velocity.0.iter_mut().enumerate() {
            let (viscosity, scratch) = (self.config.viscosity_m2_per_s.into(), [&mut a.0[axis], &mut b.0[axis]]);
            let close = |field: &mut _| self.walls.close_component(field);
            spread(self.config.diffusion, portion, &self.grid, viscosity, dt_secs, field, scratch, self.implicit.as_mut(), close);
        }
    }

    /// Takes the divergence out; with the length of a step, what that took is added to the pressure's pull.
    fn project(&mut self, dt_secs: Option<f64>) -> Convergence {
        let pull = dt_secs.map(|dt_secs| (&mut self.pull, dt_secs.recip()));
        let convergence = self.projection.project(&self.grid, &mut self.velocity, &self.inflow, pull);
        self.walls.close(&mut self.velocity);
        convergence
    }

    /// Releases, settles and carries the dust through the air in the first stage. Changes nothing where that is too fast.
    fn carry_dust(&mut self, settings: &Dust, dt_secs: f64) -> Result<(), StepError> {
        let (grid, air) = (self.grid, &self.stages[0]);
        let parts = dust_parts(&self.config, settings, &grid, health::fastest_to_be(&grid, air, &self.pull, 0.0), dt_secs)?;
        let Some(dust) = &mut self.dust else { return Ok(()) };
        let middle_secs = self.time_secs + 0.5 * dt_secs;
        let release = f64::from(settings.release_per_sec);
        for source in sources::sources_at(&self.config, &grid, &self.mean, middle_secs) {
            sources::release(&grid, &self.config.gusts, &source, release, dt_secs, dust, &mut self.footprint);
        }
        for primitive in &self.config.primitives {
            primitive.release(&grid, middle_secs, release, dt_secs, dust, &mut self.footprint);
        }
        let left = R::of(1.0 / (1.0 + f64::from(settings.settling_per_sec) * dt_secs));
        dust.data.iter_mut().for_each(|density| *density = *density * left);
        let walls = &self.walls;
        let close = |field: &mut _| walls.close_concentration(field);
        close(dust);

        let diffusivity = f64::from(settings.diffusivity_m2_per_s);
        let [even, odd] = &mut self.dust_stages;
        let mut spread_apart = true;
        if settings.advection == Advection::Conservative {
            spread_apart = self.config.diffusion != Diffusion::Explicit;
            let in_flux = if spread_apart { 0.0 } else { diffusivity };
            let part_secs = dt_secs / f64::from(parts);
            for _ in 0..parts {
                for (number, share) in STAGES.into_iter().enumerate() {
                    let (carried, target) = match number {
                        0 => (&*dust, &mut *even),
                        1 => (&*even, &mut *odd),
                        _ => (&*odd, &mut *even),
                    };
                    let stage = Stage {
                        grid: &grid,
                        air,
                        carried,
                        start: dust,
                        pull: None,
                        dt_secs: part_secs,
                        share,
                        diffusivity_m2_per_s: in_flux,
                        damping: 0.0,
                    };
                    stage.run(target, &mut self.transport);
                    close(target);
                }
                std::mem::swap(dust, even);
            }
        } else {
            health::to_centres(&grid, air, &mut self.centres);
            trace::trace(&grid, &self.centres, dt_secs, &mut self.paths);
            advect::advect(settings.advection, &grid, &self.paths, dust, even, &mut self.advection, |field, _| close(field));
            std::mem::swap(dust, even);
            close(dust);
        }
        if spread_apart {
            spread(self.config.diffusion, Portion::Whole, &grid, diffusivity, dt_secs, dust, [even, odd], self.implicit.as_mut(), close);
        }
        Ok(())
    }
}

/// Parts, at least 1, to cut a part of a step into so that limited transport keeps dust within its bounds, in air of these speeds.
fn dust_parts<R: Real>(config: &Config, dust: &Dust, grid: &Grid<R>, fastest_m_per_s: [f64; 3], dt_secs: f64) -> Result<u32, StepError> {
    if dust.advection != Advection::Conservative {
        return Ok(1);
    }
    let diffusivity = if config.diffusion == Diffusion::Explicit { f64::from(dust.diffusivity_m2_per_s) } else { 0.0 };
    let courant_per_sec: f64 = (0..3).map(|axis| fastest_m_per_s[axis] / grid.spacing_m[axis].wide()).sum();
    let stable_dt_secs = (courant_per_sec / DUST_COURANT + diffuse::stable_dt_secs(grid, diffusivity).recip()).recip();
    count(DUST_COURANT_NAME, dt_secs, stable_dt_secs, MAX_SUBSTEPS)
}

/// Parts, at least 1, of at most `stable_dt_secs` that make `dt_secs`, if they are no more than `most`.
fn count(what: &'static str, dt_secs: f64, stable_dt_secs: f64, most: u32) -> Result<u32, StepError> {
    let needed = (dt_secs / stable_dt_secs).ceil().max(1.0);
    if needed <= f64::from(most) { Ok(needed as u32) } else { Err(StepError::TooLong { what, dt_secs, needed, stable_dt_secs }) }
}

/// Parts to cut a step into, at least 1, so that each is within the limits of the methods in air of these speeds.
fn parts<R: Real>(config: &Config, grid: &Grid<R>, fastest_m_per_s: [f64; 3], dt_secs: f64, most: u32) -> Result<u32, StepError> {
    if !(dt_secs > 0.0 && dt_secs.is_finite()) {
        return Err(StepError::BadTimeStep { dt_secs });
    }
    let explicit = config.diffusion == Diffusion::Explicit;
    let viscosity = if explicit { f64::from(config.viscosity_m2_per_s) } else { 0.0 };
    let parts = if config.advection == Advection::Conservative {
        count("viscosity_m2_per_s", dt_secs, SAFETY * transport::stable_dt_secs(grid, [0.0; 3], viscosity), most)?;
        count(COURANT, dt_secs, SAFETY * transport::stable_dt_secs(grid, fastest_m_per_s, viscosity), most)?
    } else {
        // Explicit friction is cut into parts of its own.
        count("viscosity_m2_per_s", dt_secs, diffuse::stable_dt_secs(grid, viscosity), most)?;
        1
    };
    if let Some(dust) = config.dust {
        let diffusivity = if explicit { f64::from(dust.diffusivity_m2_per_s) } else { 0.0 };
        count("dust.diffusivity_m2_per_s", dt_secs, diffuse::stable_dt_secs(grid, diffusivity), most)?;
        dust_parts(config, &dust, grid, fastest_m_per_s, dt_secs / f64::from(parts))?;
    }
    Ok(parts)
}
