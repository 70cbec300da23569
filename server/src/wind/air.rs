//! The air of a scene, by whichever method: one face for both.

use glam::Vec3;

use super::config::{Config, ConfigError};
use super::health::Health;
use super::state::{SolidError, StepError, StepReport};
use super::{Jet, Real, Solver, StableFluids};

/// The family of methods that moves the air.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// [`Solver`]: a staggered grid, with the schemes that [`Config`] names.
    #[default]
    Staggered,
    /// [`StableFluids`]: the method of 000, for comparison.
    StableFluids,
}

/// Air in a box, solved by either method.
///
/// ```
/// use server::wind::{Air, Config, Method};
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
    /// As 000 has it.
    StableFluids(Box<StableFluids<R>>),
}

/// The same of either method.
macro_rules! either {
    ($air:expr, $solver:ident => $what:expr) => {
        match $air {
            Self::Staggered($solver) => $what,
            Self::StableFluids($solver) => $what,
        }
    };
}

impl<R: Real> Air<R> {
    /// Checks that `method` can do what the settings ask for.
    ///
    /// # Errors
    /// The first setting outside of its range, or that the method cannot do.
    pub fn check(method: Method, config: &Config) -> Result<(), ConfigError> {
        match method {
            Method::Staggered => config.validate(),
            Method::StableFluids => StableFluids::<R>::check(config),
        }
    }

    /// Air that already moves with the mean wind, without gusts.
    ///
    /// # Errors
    /// The first setting outside of its range, or that the method cannot do.
    pub fn new(method: Method, config: &Config) -> Result<Self, ConfigError> {
        Ok(match method {
            Method::Staggered => Self::Staggered(Box::new(Solver::new(config)?)),
            Method::StableFluids => Self::StableFluids(Box::new(StableFluids::new(config)?)),
        })
    }

    /// The method that moves this air.
    pub fn method(&self) -> Method {
        match self {
            Self::Staggered(_) => Method::Staggered,
            Self::StableFluids(_) => Method::StableFluids,
        }
    }

    /// Whether air by `method` with `config` could take steps of `dt_secs` (s) from rest, asked without making any.
    ///
    /// # Errors
    /// [`StepError::BadTimeStep`] or [`StepError::TooLong`].
    pub fn check_step(method: Method, config: &Config, dt_secs: f64) -> Result<(), StepError> {
        match method {
            Method::Staggered => Solver::<R>::check_step(config, dt_secs),
            Method::StableFluids => StableFluids::<R>::check_step(dt_secs),
        }
    }

    /// Advances the air by `dt_secs` (s), driven by the mean wind, the random sources, the primitives and `jets`.
    ///
    /// # Errors
    /// See [`StepError`].
    pub fn step(&mut self, dt_secs: f64, jets: &[Jet]) -> Result<StepReport, StepError> {
        either!(self, air => air.step(dt_secs, jets))
    }

    /// Speed, divergence and energy of the air now.
    pub fn report(&self) -> Health {
        match self {
            Self::Staggered(air) => air.health,
            Self::StableFluids(air) => air.health(),
        }
    }

    /// Sets the velocity (m/s) from a function of position (m). On the staggered grid the divergence is taken out of it; the method of 000 keeps it until a step.
    pub fn set_velocity(&mut self, f: impl Fn([R; 3]) -> [R; 3]) {
        either!(self, air => air.set_velocity(f))
    }

    /// Sets the dust from a function of position (m). Clear air stays clear.
    pub fn set_dust(&mut self, f: impl Fn([R; 3]) -> R) {
        either!(self, air => air.set_dust(f))
    }

    /// Makes solid the cells whose centre (m) `f` says are. See [`Solver::set_solid`].
    ///
    /// # Errors
    /// What [`Solver::set_solid`] says, and with the method of 000 always; nothing is changed then.
    pub fn set_solid(&mut self, f: impl Fn([R; 3]) -> bool) -> Result<(), SolidError> {
        match self {
            Self::Staggered(air) => air.set_solid(f),
            Self::StableFluids(_) => Err(SolidError::Method),
        }
    }

    /// Says which share of the canopy stands in each column; see [`Solver::set_cover`]. The method of 000 has no canopy.
    pub fn set_cover(&mut self, cover: impl Iterator<Item = f32>) {
        if let Self::Staggered(air) = self {
            air.set_cover(cover);
        }
    }

    /// Cuts a box that wraps along x and z at these places (m); see [`Solver::set_seam`].
    pub fn set_seam(&mut self, seam_m: Option<[f64; 2]>) {
        either!(self, air => air.set_seam(seam_m))
    }

    /// Velocity (m/s) at a position (m) in the box, trilinear between values. Wrapped axes repeat; beyond other faces the velocity on the face holds.
    pub fn velocity_at(&self, position_m: [R; 3]) -> [R; 3] {
        either!(self, air => air.velocity_at(position_m))
    }

    /// Every value of the velocity component along `axis` (m/s) with its position (m): on faces, or at centres with the method of 000.
    pub fn samples(&self, axis: usize) -> Box<dyn Iterator<Item = ([R; 3], R)> + '_> {
        either!(self, air => Box::new(air.samples(axis)))
    }

    /// Velocities (m/s) at the centres of cells, x fastest, then y, then z: cell (i, j, k) is item `i + nx·(j + ny·k)`.
    pub fn cell_velocities(&self) -> Box<dyn Iterator<Item = Vec3> + '_> {
        either!(self, air => Box::new(air.cell_velocities()))
    }

    /// Concentration of dust at the centres of cells, in the order of [`Air::cell_velocities`]; `None` in clear air.
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
    fn what_the_method_of_000_cannot_do_is_named() {
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
    fn both_methods_move_the_same_air_the_same_way_at_first() {
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
            (air.report().kinetic_energy_m2_per_s2, air.cell_velocities().collect::<Vec<_>>())
        });
        let largest = staggered.1.iter().zip(&collocated.1).map(|(a, b)| (*a - *b).length()).fold(0.0, f32::max);
        assert!(largest < 0.03, "the speed is 1 m/s: {largest}");
        assert!(collocated.0 < staggered.0, "linear backtraces take energy out: {} {}", collocated.0, staggered.0);
    }
}
