//! Setting the solids of a solver.

use super::{Body, DragBody, Immersed};
use crate::{Pressure, Real, SolidError, Solver, TimeScheme};

impl<R: Real> Solver<R> {
    /// Immerses fixed walls where the signed distance `distance_m` (m, negative inside) is not positive, with the velocity `velocity_m_per_s` (m/s) of their surface, in
    /// place of earlier ones; both are functions of position (m). No slip at the surface, whose place between the faces counts. The velocity of the air changes in
    /// the next step.
    ///
    /// # Errors
    /// As [`Solver::check_walls`]. Nothing changes then.
    pub fn set_walls(
        &mut self,
        distance_m: impl Fn([f64; 3]) -> f64,
        velocity_m_per_s: impl Fn([f64; 3]) -> [f64; 3],
    ) -> Result<(), SolidError> {
        self.check_walls()?;
        let viscosity = self.config.viscosity_m2_per_s.into();
        let cells = self.grid.len();
        let immersed = self.immersed.get_or_insert_with(|| Immersed::new(cells));
        immersed.walls.set_fixed(&self.grid, viscosity, distance_m, velocity_m_per_s);
        self.drop_walls_without_faces();
        Ok(())
    }

    /// Sets fixed bodies that slow the air within them, in place of earlier ones. Their number does not matter: the cost of a step grows with the number of cells
    /// in which there are any.
    ///
    /// # Errors
    /// [`SolidError::Body`]. Nothing changes then.
    pub fn set_drag(&mut self, bodies: &[DragBody]) -> Result<(), SolidError> {
        allow(bodies.iter().map(DragBody::is_valid))?;
        self.drag.set_fixed(&self.grid, bodies);
        Ok(())
    }

    /// Sets solid bodies that may move, in place of earlier ones: call it before each step. A body at least [`Body::RESOLVED`] cells wide along every axis is a wall, where
    /// [`Solver::check_walls`] allows it; a smaller one slows the air around it by its drag.
    ///
    /// # Errors
    /// [`SolidError::Body`]. Nothing changes then.
    pub fn set_bodies(&mut self, bodies: &[Body]) -> Result<(), SolidError> {
        allow(bodies.iter().map(Body::is_valid))?;
        let may_be_walls = self.check_walls().is_ok();
        let (grid, viscosity) = (&self.grid, self.config.viscosity_m2_per_s.into());
        let is_wall = |body: &&Body| may_be_walls && body.is_resolved(grid);
        self.drag.set_moving(grid, bodies.iter().filter(|body| !is_wall(body)).map(Body::drag));
        if self.immersed.is_none() && bodies.iter().any(|body| is_wall(&body)) {
            self.immersed = Some(Immersed::new(grid.len()));
        }
        if let Some(immersed) = &mut self.immersed {
            immersed.walls.set_moving(grid, viscosity, bodies.iter().filter(is_wall));
            self.drop_walls_without_faces();
        }
        Ok(())
    }

    /// Whether walls can be immersed with these settings.
    ///
    /// # Errors
    /// [`SolidError::Iterative`] unless pressure is solved by transforms, [`SolidError::Diffusion`] if diffusion is, [`SolidError::Reflection`] with that time
    /// scheme.
    pub fn check_walls(&self) -> Result<(), SolidError> {
        if self.config.pressure != Pressure::Direct {
            return Err(SolidError::Iterative);
        }
        if self.implicit.is_some() {
            return Err(SolidError::Diffusion);
        }
        if self.config.time == TimeScheme::Reflection {
            return Err(SolidError::Reflection);
        }
        Ok(())
    }

    /// Force of the air on all walls over its density (m⁴/s²) in the newest sub-step: the momentum that they took, including that of the air inside them.
    pub fn wall_force_m4_per_s2(&self) -> [f64; 3] {
        let force = |immersed: &Immersed<R>| immersed.walls.impulse_m4_per_s.map(|impulse| impulse / immersed.step_secs);
        self.immersed.as_ref().filter(|immersed| immersed.step_secs > 0.0).map_or([0.0; 3], force)
    }

    fn drop_walls_without_faces(&mut self) {
        if self.immersed.as_ref().is_some_and(|immersed| immersed.walls.is_empty()) {
            self.immersed = None;
        }
    }
}

/// The first body whose numbers are not allowed is an error.
fn allow(mut are_valid: impl Iterator<Item = bool>) -> Result<(), SolidError> {
    are_valid.position(|is_valid| !is_valid).map_or(Ok(()), |index| Err(SolidError::Body { index }))
}
