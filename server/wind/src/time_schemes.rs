//! The sub-steps of each time scheme, in order.

use super::boundary::{InflowGhosts, friction, outflow};
use super::diffuse::{Portion, diffuse, keep_signs, stable_dt_secs};
use super::pressure::Convergence;
use super::solids::Immersed;
use super::state::StepError;
use super::transport::{self, STAGE_ENDS, STAGES, Stage};
use super::{Diffusion, Jet, Real, Solver, TimeScheme, advect, canopy, diagnostics, forcing, limits, profile, trajectory};

impl<R: Real> Solver<R> {
    /// [`TimeScheme::Split`]: advection, forces, diffusion, projection.
    pub(super) fn split(&mut self, dt_secs: f64, jets: &[Jet]) -> Result<Convergence, StepError> {
        if self.config.advection.uses_fluxes() {
            // The pressure gradient, which only Runge–Kutta 3 keeps, is 0.
            self.transport(dt_secs, 0.0)?;
        } else {
            self.trace_trajectories(dt_secs);
            self.boundaries.update_inflow(self.time_secs + dt_secs);
            self.advect_into_stage(0);
            std::mem::swap(&mut self.velocity, &mut self.stages[0]);
        }
        self.force(dt_secs, self.time_secs + 0.5 * dt_secs, jets);
        self.diffuse(Portion::Whole, dt_secs);
        Ok(self.project(dt_secs, false))
    }

    /// [`TimeScheme::Reflection`]: half of forces and diffusion; mid-step velocity; half a step of advection, reflection, half a step; half of diffusion and forces;
    /// projection.
    pub(super) fn reflection(&mut self, dt_secs: f64, jets: &[Jet]) -> Convergence {
        let middle_secs = self.time_secs + 0.5 * dt_secs;
        self.force(0.5 * dt_secs, middle_secs, jets);
        self.diffuse(Portion::First, dt_secs);

        self.trace_trajectories(0.5 * dt_secs);
        self.boundaries.update_inflow(middle_secs);
        self.advect_into_stage(0);
        self.projection.project(&self.grid, &mut self.stages[0], &self.volume_sources_per_s, None);
        self.boundaries.apply(&mut self.stages[0]);
        diagnostics::interpolate_to_centres(&self.grid, &self.stages[0], &mut self.centres);
        trajectory::trace(&self.grid, &self.centres, 0.5 * dt_secs, &mut self.trajectories);

        self.advect_into_stage(0);
        let [even, odd] = &mut self.stages;
        odd.copy_from(even);
        // Inflow values are reflected too.
        self.boundaries.apply_with(odd, InflowGhosts::Extrapolated);
        self.projection.project(&self.grid, &mut self.stages[0], &self.volume_sources_per_s, None);
        self.boundaries.apply(&mut self.stages[0]);
        let two = R::of(2.0);
        for axis in 0..3 {
            let (free, bound) = (&self.stages[0].0[axis].data, &self.stages[1].0[axis].data);
            let reflected = self.velocity.0[axis].data.iter_mut().zip(free).zip(bound);
            reflected.for_each(|((reflected, &free), &bound)| *reflected = two * free - bound);
        }
        self.boundaries.apply_with(&mut self.velocity, InflowGhosts::Unchanged);
        self.boundaries.update_inflow(self.time_secs + dt_secs);
        self.advect_into_stage(0);
        std::mem::swap(&mut self.velocity, &mut self.stages[0]);

        self.diffuse(Portion::Second, dt_secs);
        self.force(0.5 * dt_secs, middle_secs, jets);
        self.project(dt_secs, false)
    }

    /// [`TimeScheme::RungeKutta3`]: half of forces and diffusion; three stages of conservative transport with the old pressure gradient; half of
    /// diffusion and forces; projection, which corrects the pressure gradient.
    pub(super) fn runge_kutta(&mut self, dt_secs: f64, jets: &[Jet]) -> Result<Convergence, StepError> {
        let middle_secs = self.time_secs + 0.5 * dt_secs;
        let explicit = self.config.diffusion == Diffusion::Explicit;
        self.force(0.5 * dt_secs, middle_secs, jets);
        if !explicit {
            self.diffuse(Portion::First, dt_secs);
        }
        self.transport(dt_secs, if explicit { self.config.viscosity_m2_per_s.into() } else { 0.0 })?;
        if !explicit {
            self.diffuse(Portion::Second, dt_secs);
        }
        self.force(0.5 * dt_secs, middle_secs, jets);
        Ok(self.project(dt_secs, true))
    }

    /// Advects the velocity by fluxes, with the pressure gradient of the previous step. Restores the state if forces and pressure make the air too fast.
    fn transport(&mut self, dt_secs: f64, viscosity_m2_per_s: f64) -> Result<(), StepError> {
        let max_speed_m_per_s = diagnostics::largest_speeds(&self.grid, &self.velocity, &self.pressure_gradient, dt_secs);
        let stable_dt_secs = transport::stable_dt_secs(&self.grid, max_speed_m_per_s, viscosity_m2_per_s);
        if let Err(error) = limits::count(limits::COURANT, dt_secs, stable_dt_secs, 1) {
            self.roll_back();
            return Err(error);
        }
        let reads_ghosts = self.config.canopy.is_some()
            || !self.drag.is_empty()
            || self.config.diffusion != Diffusion::Explicit
            || self.config.time == TimeScheme::Split;
        for (number, fraction) in STAGES.into_iter().enumerate() {
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
                    pressure_gradient: Some(&self.pressure_gradient.0[axis]),
                    dt_secs,
                    fraction,
                    diffusivity_m2_per_s: viscosity_m2_per_s,
                    damping: self.config.damping.into(),
                };
                stage.run(&mut target.0[axis], &mut self.transport);
                outflow::correct_flux(&self.grid, air, fraction * dt_secs, &mut target.0[axis]);
                friction::complete(&self.grid, viscosity_m2_per_s, fraction * dt_secs, &air.0[axis], &mut target.0[axis]);
            }
            if let Some(Immersed { walls, .. }) = &self.immersed {
                walls.bear(dt_secs, fraction * dt_secs, &self.pressure_gradient, target);
            }
            self.boundaries.update_inflow(self.time_secs + STAGE_ENDS[number] * dt_secs);
            // Forces follow the last stage and apply the boundary conditions; before them only diffusion and canopy drag read ghosts.
            if number < 2 || reads_ghosts {
                self.boundaries.apply(target);
            }
        }
        std::mem::swap(&mut self.velocity, &mut self.stages[0]);
        Ok(())
    }

    /// Traces trajectories through the velocity at the start of the step.
    fn trace_trajectories(&mut self, dt_secs: f64) {
        diagnostics::interpolate_to_centres(&self.grid, &self.velocity, &mut self.centres);
        trajectory::trace(&self.grid, &self.centres, dt_secs, &mut self.trajectories);
    }

    /// Advects the velocity along the trajectories into a stage.
    fn advect_into_stage(&mut self, stage: usize) {
        for axis in 0..3 {
            let (field, target) = (&self.velocity.0[axis], &mut self.stages[stage].0[axis]);
            let boundaries = |field: &mut _, inflow| self.boundaries.apply_to_component_with(field, inflow);
            advect::advect(self.config.advection, &self.grid, &self.trajectories, field, target, &mut self.advection, boundaries);
        }
        self.boundaries.apply(&mut self.stages[stage]);
    }

    /// Forces: drag of canopy and bodies, gusts, primitives, jets, relaxation to the mean wind, sponge layer and body force.
    fn force(&mut self, dt_secs: f64, time_secs: f64, jets: &[Jet]) {
        let moment = self.moment(time_secs);
        let grid = &self.grid;
        if let Some(stems) = &mut self.stems {
            stems.sway(grid, &self.canopy_fraction, dt_secs, &mut self.velocity, &mut self.stages[0]);
        } else if let Some(canopy) = &self.config.canopy {
            canopy::drag(grid, canopy, &self.canopy_fraction, dt_secs, &mut self.velocity, &mut self.stages[0]);
        }
        if !self.drag.is_empty() {
            if self.config.canopy.is_some() {
                self.boundaries.apply(&mut self.velocity);
            }
            self.drag.apply(grid, dt_secs, &mut self.velocity);
        }
        self.pushes.apply(dt_secs, &mut self.velocity);
        for primitive in &self.config.primitives {
            primitive.drive(grid, moment, dt_secs, &mut self.velocity, &mut self.footprint);
        }
        for jet in jets {
            forcing::drive(grid, jet, dt_secs, &mut self.velocity, &mut self.footprint);
        }
        self.relaxation.apply(grid, self.config.relaxation_per_s.into(), dt_secs, &mut self.velocity);
        if let Some(sponge_m) = self.sponge_m {
            profile::sponge(grid, &self.mean, sponge_m, dt_secs, &mut self.velocity);
        }
        for (field, &force) in self.velocity.0.iter_mut().zip(&self.config.body_force_m_per_s2) {
            let gain = R::of(f64::from(force) * dt_secs);
            if gain != R::zero() {
                field.data.iter_mut().for_each(|speed| *speed = *speed + gain);
            }
        }
        self.boundaries.apply(&mut self.velocity);
        self.volume_sources_per_s.fill(0.0);
        if !self.volume_sources_per_s.is_empty() {
            for primitive in &self.config.primitives {
                primitive.add_volume_source(&self.grid, moment, &mut self.volume_sources_per_s, &mut self.footprint);
            }
        }
    }

    fn diffuse(&mut self, portion: Portion, dt_secs: f64) {
        let viscosity = self.config.viscosity_m2_per_s.into();
        if viscosity == 0.0 {
            return;
        }
        // The old pressure gradient passes through the second half. A wave of it that Crank–Nicolson reverses would be added to the pressure, instead of replacing it, in
        // every step.
        let keeps_pressure = self.config.time == TimeScheme::RungeKutta3;
        let reverses = self.config.diffusion == Diffusion::CrankNicolson && 0.5 * dt_secs > stable_dt_secs(&self.grid, viscosity);
        let [start_secs, length_secs] = match portion {
            Portion::Whole => [self.time_secs, dt_secs],
            Portion::First => [self.time_secs, 0.5 * dt_secs],
            Portion::Second => [self.time_secs + 0.5 * dt_secs, 0.5 * dt_secs],
        };
        let [a, b] = &mut self.stages;
        for (axis, field) in self.velocity.0.iter_mut().enumerate() {
            let scratch = [&mut a.0[axis], &mut b.0[axis]];
            // Air next to a face follows it within a fraction of the step: with its velocity at another time the error would be of first order there.
            let mut boundaries = |field: &mut _, fraction: f64| {
                self.boundaries.update_inflow(start_secs + fraction * length_secs);
                self.boundaries.apply_to_component(field);
            };
            boundaries(field, 0.0);
            if let Some(implicit) = self.implicit.as_mut().filter(|_| keeps_pressure && reverses) {
                keep_signs(&self.grid, viscosity, 0.5 * dt_secs, field, scratch[0], implicit, boundaries);
                continue;
            }
            diffuse(self.config.diffusion, portion, &self.grid, viscosity, dt_secs, field, scratch, self.implicit.as_mut(), boundaries);
        }
        // Other sub-steps have the velocity on the faces at their own times.
        self.boundaries.update_inflow(if portion == Portion::First { self.time_secs } else { self.time_secs + dt_secs });
        self.boundaries.apply(&mut self.velocity);
    }

    /// Projects the velocity, around the walls that are immersed in the grid; optionally adds the correction to the pressure gradient.
    fn project(&mut self, dt_secs: f64, keeps_pressure: bool) -> Convergence {
        if let Some(Immersed { walls, .. }) = &mut self.immersed {
            walls.hold(dt_secs, &self.pressure_gradient, &mut self.velocity);
            self.boundaries.apply(&mut self.velocity);
        }
        let pressure_gradient = keeps_pressure.then_some((&mut self.pressure_gradient, dt_secs.recip()));
        let (grid, velocity, sources) = (&self.grid, &mut self.velocity, &self.volume_sources_per_s);
        let convergence = match &mut self.immersed {
            Some(Immersed { walls, iteration, step_secs }) => {
                *step_secs = dt_secs;
                let speed_m_per_s = (2.0 * self.diagnostics.kinetic_energy_m2_per_s2).sqrt();
                self.projection.project_around(grid, (walls, iteration), speed_m_per_s, velocity, sources, pressure_gradient)
            }
            None => self.projection.project(grid, velocity, sources, pressure_gradient),
        };
        self.boundaries.apply(&mut self.velocity);
        convergence
    }
}
