//! A common interface to both solvers.

use glam::Vec3;

use super::config::{Config, ConfigError};
use super::diagnostics::Diagnostics;
use super::state::{SolidError, StepError, StepReport};
use super::{Body, DragBody, Jet, Real, Solver, StableFluids};

/// Solver to use.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// [`Solver`]: a staggered grid, with the schemes selected by [`Config`].
    #[default]
    Staggered,
    /// [`StableFluids`]: the method of Zhang, for comparison.
    StableFluids,
}

/// Air in a box, solved by either method.
///
/// ```
/// use prairie_wind::{Air, Config, Method};
///
/// for method in [Method::Staggered, Method::StableFluids] {
///     let mut air = Air::<f32>::new(method, &Config { cells: [8; 3], ..Config::default() })?;
///     air.step(0.1, &[])?;
///     assert!(air.velocity_at([32.0, 8.0, 32.0])[0] > 4.0, "the mean wind blows at 5 m/s in 10 m");
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub enum Air<R: Real> {
    /// On a staggered grid.
    Staggered(Box<Solver<R>>),
    /// On a collocated grid.
    StableFluids(Box<StableFluids<R>>),
}

/// Evaluates an expression for either solver.
macro_rules! either {
    ($air:expr, $solver:ident => $what:expr) => {
        match $air {
            Self::Staggered($solver) => $what,
            Self::StableFluids($solver) => $what,
        }
    };
}

impl<R: Real> Air<R> {
    /// Checks the settings for `method`.
    ///
    /// # Errors
    /// The first setting that is out of range or not supported by the method.
    pub fn check(method: Method, config: &Config) -> Result<(), ConfigError> {
        match method {
            Method::Staggered => config.validate(),
            Method::StableFluids => StableFluids::<R>::check(config),
        }
    }

    /// Creates air that moves with the mean wind.
    ///
    /// # Errors
    /// The first setting that is out of range or not supported by the method.
    pub fn new(method: Method, config: &Config) -> Result<Self, ConfigError> {
        Ok(match method {
            Method::Staggered => Self::Staggered(Box::new(Solver::new(config)?)),
            Method::StableFluids => Self::StableFluids(Box::new(StableFluids::new(config)?)),
        })
    }

    /// The method of this solver.
    pub fn method(&self) -> Method {
        match self {
            Self::Staggered(_) => Method::Staggered,
            Self::StableFluids(_) => Method::StableFluids,
        }
    }

    /// Checks whether a solver with these settings could take steps of `dt_secs` (s) from rest, without creating it.
    ///
    /// # Errors
    /// [`StepError::BadTimeStep`] or [`StepError::TooLong`].
    pub fn check_step(method: Method, config: &Config, dt_secs: f64) -> Result<(), StepError> {
        match method {
            Method::Staggered => Solver::<R>::check_step(config, dt_secs),
            Method::StableFluids => StableFluids::<R>::check_step(dt_secs),
        }
    }

    /// Advances the air by `dt_secs` (s), driven by the mean wind, gusts, primitives and `jets`.
    ///
    /// # Errors
    /// See [`StepError`].
    pub fn step(&mut self, dt_secs: f64, jets: &[Jet]) -> Result<StepReport, StepError> {
        either!(self, air => air.step(dt_secs, jets))
    }

    /// Diagnostics of the present velocity.
    pub fn diagnostics(&self) -> Diagnostics {
        match self {
            Self::Staggered(air) => air.diagnostics,
            Self::StableFluids(air) => air.diagnostics(),
        }
    }

    /// Sets the velocity (m/s) from a function of position (m). The staggered solver projects it; [`StableFluids`] does so only in the next step.
    pub fn set_velocity(&mut self, f: impl Fn([R; 3]) -> [R; 3]) {
        either!(self, air => air.set_velocity(f))
    }

    /// Sets the concentration of dust from a function of position (m). No effect without dust in the settings.
    pub fn set_dust(&mut self, f: impl Fn([R; 3]) -> R) {
        either!(self, air => air.set_dust(f))
    }

    /// Makes cells solid if `f` is true at their centre (m); see [`Solver::set_solid`].
    ///
    /// # Errors
    /// Those of [`Solver::set_solid`]; always with [`StableFluids`]. Nothing changes then.
    pub fn set_solid(&mut self, f: impl Fn([R; 3]) -> bool) -> Result<(), SolidError> {
        match self {
            Self::Staggered(air) => air.set_solid(f),
            Self::StableFluids(_) => Err(SolidError::Method),
        }
    }

    /// Immerses fixed walls; see [`Solver::set_walls`].
    ///
    /// # Errors
    /// Those of [`Solver::check_walls`]; always with [`StableFluids`]. Nothing changes then.
    pub fn set_walls(
        &mut self,
        distance_m: impl Fn([f64; 3]) -> f64,
        velocity_m_per_s: impl Fn([f64; 3]) -> [f64; 3],
    ) -> Result<(), SolidError> {
        match self {
            Self::Staggered(air) => air.set_walls(distance_m, velocity_m_per_s),
            Self::StableFluids(_) => Err(SolidError::Method),
        }
    }

    /// Sets fixed bodies that slow the air; see [`Solver::set_drag`]. No effect with [`StableFluids`].
    ///
    /// # Errors
    /// [`SolidError::Body`]. Nothing changes then.
    pub fn set_drag(&mut self, bodies: &[DragBody]) -> Result<(), SolidError> {
        match self {
            Self::Staggered(air) => air.set_drag(bodies),
            Self::StableFluids(_) => Ok(()),
        }
    }

    /// Sets solid bodies that may move; see [`Solver::set_bodies`]. No effect with [`StableFluids`].
    ///
    /// # Errors
    /// [`SolidError::Body`]. Nothing changes then.
    pub fn set_bodies(&mut self, bodies: &[Body]) -> Result<(), SolidError> {
        match self {
            Self::Staggered(air) => air.set_bodies(bodies),
            Self::StableFluids(_) => Ok(()),
        }
    }

    /// Sets the fraction of the canopy that stands in each column; see [`Solver::set_canopy_fraction`]. No effect with [`StableFluids`], which has no canopy.
    pub fn set_canopy_fraction(&mut self, fractions: impl Iterator<Item = f32>) {
        if let Self::Staggered(air) = self {
            air.set_canopy_fraction(fractions);
        }
    }

    /// Displacement (m) of the tops of the grass; see [`Solver::canopy_displacements_m`]. `None` if the canopy does not move, or with [`StableFluids`].
    pub fn canopy_displacements_m(&self) -> Option<impl Iterator<Item = [R; 2]> + '_> {
        match self {
            Self::Staggered(air) => air.canopy_displacements_m(),
            Self::StableFluids(_) => None,
        }
    }

    /// Displacement (m) and velocity (m/s) of the tops of the grass, as in [`State::stems`](super::state::State::stems); empty if the canopy does not move, or with
    /// [`StableFluids`].
    pub fn stems(&self) -> [&[R]; 4] {
        match self {
            Self::Staggered(air) => air.stems(),
            Self::StableFluids(_) => [&[]; 4],
        }
    }

    /// Pressure gradient over density (m/s²) that the next step begins with, across x, y and z, with the layout of the solver's memory; empty with [`StableFluids`].
    pub fn pressure_gradient(&self) -> [&[R]; 3] {
        match self {
            Self::Staggered(air) => air.pressure_gradient(),
            Self::StableFluids(_) => [&[]; 3],
        }
    }

    /// Places sponge layers across x and z at these positions (m); see [`Solver::set_sponge`].
    pub fn set_sponge(&mut self, sponge_m: Option<[f64; 2]>) {
        either!(self, air => air.set_sponge(sponge_m))
    }

    /// Sets the time (s) since the start of the primitives' intensities at the present moment; see [`Solver::set_intensity_secs`].
    pub fn set_intensity_secs(&mut self, secs: f64) {
        either!(self, air => air.set_intensity_secs(secs))
    }

    /// Velocity (m/s) at a position (m), interpolated trilinearly. Periodic axes repeat; beyond other faces the velocity is that on the face.
    pub fn velocity_at(&self, position_m: [R; 3]) -> [R; 3] {
        either!(self, air => air.velocity_at(position_m))
    }

    /// All values of the velocity component along `axis` (m/s) with their positions (m): on faces, or at centres with [`StableFluids`].
    pub fn samples(&self, axis: usize) -> Box<dyn Iterator<Item = ([R; 3], R)> + '_> {
        either!(self, air => Box::new(air.samples(axis)))
    }

    /// Velocities (m/s) at cell centres, x fastest, then y, then z: cell (i, j, k) is item `i + nx·(j + ny·k)`.
    pub fn cell_velocities(&self) -> Box<dyn Iterator<Item = Vec3> + '_> {
        either!(self, air => Box::new(air.cell_velocities()))
    }

    /// Concentration of dust at cell centres, in the order of [`Air::cell_velocities`]; `None` in clear air.
    pub fn dust(&self) -> Option<Box<dyn Iterator<Item = f32> + '_>> {
        fn boxed<'a>(dust: impl Iterator<Item = f32> + 'a) -> Box<dyn Iterator<Item = f32> + 'a> {
            Box::new(dust)
        }
        either!(self, air => air.dust().map(boxed))
    }

    /// Time since the start (s).
    pub fn time_secs(&self) -> f64 {
        either!(self, air => air.time_secs())
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Boundary, Canopy, Gusts, Profile};
    use super::*;

    #[test]
    fn settings_that_stable_fluids_lacks_are_rejected() {
        let faces = [Boundary::NoSlip, Boundary::Inflow, Boundary::Outflow, Boundary::Lid { velocity_m_per_s: [1.0, 0.0, 0.0] }];
        for face in faces {
            let config = Config { boundary: [[Boundary::Wrap; 2], [Boundary::FreeSlip, face], [Boundary::Wrap; 2]], ..Config::default() };
            assert!(Air::<f32>::new(Method::Staggered, &config).is_ok());
            let error = Air::<f32>::new(Method::StableFluids, &config).err().expect("refused");
            assert_eq!(error.field, "boundary[1]");
        }
        let config = Config { canopy: Some(Canopy::default()), ..Config::default() };
        assert_eq!(Air::<f32>::new(Method::StableFluids, &config).err().expect("refused").field, "canopy");
        let mut air = Air::<f32>::new(Method::StableFluids, &Config::default()).unwrap();
        assert_eq!(air.set_solid(|_| false), Err(SolidError::Method));
        assert!(matches!(air.step(0.0, &[]), Err(StepError::BadTimeStep { .. })));
    }

    #[test]
    fn both_methods_agree_over_a_short_time() {
        let config = Config {
            cells: [32, 1, 32],
            spacing_m: [1.0; 3],
            boundary: [[Boundary::Wrap; 2]; 3],
            profile: Profile::Uniform,
            mean_wind_m_per_s: [0.0; 3],
            gusts: Gusts { number: 0, ..Gusts::default() },
            ..Config::default()
        };
        let k = std::f64::consts::TAU / 32.0;
        let [staggered, collocated] = [Method::Staggered, Method::StableFluids].map(|method| {
            let mut air = Air::<f64>::new(method, &config).unwrap();
            air.set_velocity(|[x, _, z]| [(k * x).sin() * (k * z).cos(), 0.0, -(k * x).cos() * (k * z).sin()]);
            for _ in 0..20 {
                air.step(0.05, &[]).unwrap();
            }
            assert_eq!(air.samples(0).count(), 32 * 32);
            assert!((air.time_secs() - 1.0).abs() < 1e-12);
            (air.diagnostics().kinetic_energy_m2_per_s2, air.cell_velocities().collect::<Vec<_>>())
        });
        let largest = staggered.1.iter().zip(&collocated.1).map(|(a, b)| (*a - *b).length()).fold(0.0, f32::max);
        assert!(largest < 0.03, "the speed is 1 m/s: {largest}");
        assert!(collocated.0 < staggered.0, "linear interpolation dissipates energy: {} {}", collocated.0, staggered.0);
    }
}
