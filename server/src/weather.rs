//! The wind of a scene: the solver, its rhythm, and what the rest of the world sees of it.

use crate::bend::air::GroundWind;
use crate::objects::Motion;
use crate::snapshot::WindFrame;
use crate::wind::{Boundary, Config, ConfigError, Dust, Gusts, Jet, Profile, StepError, StepReport, WindSolver};
use glam::Vec3;
use shared::scene::{Scene, VehicleKind, WindTiling};
use shared::terrain::HeightMap;
use shared::wire::Shape;
use shared::wire::quantise::{dust_code, wind_code};
use std::sync::Arc;

/// The solver takes the least number of ticks a step that is not shorter than this (s).
const STEP_SECS: f32 = 0.05;
/// Roughness length of grass (m), for the logarithmic profile.
const ROUGHNESS_M: f32 = 0.05;
/// Cell steps that the wind blows before the world starts, so that there are gusts from the beginning.
const WARM_UP_CELL_STEPS: usize = 1 << 20;
const WARM_UP_STEPS: usize = 120;
/// Speed (m/s), radius (m) and rate (1/s) of the jet below a helicopter.
const DOWNWASH_M_PER_S: f32 = 10.0;
const DOWNWASH_RADIUS_M: f32 = 9.0;
const DOWNWASH_PER_S: f32 = 2.0;
/// Slowest object that drags air along (m/s), and radius (m) and rate (1/s) of that wake.
const WAKE_FROM_M_PER_S: f32 = 4.0;
const WAKE_RADIUS_M: f32 = 4.0;
const WAKE_PER_S: f32 = 1.0;

/// The wind of a scene.
pub struct Weather {
    solver: WindSolver,
    config: Config,
    ticks_per_step: u64,
    step_secs: f32,
    report: StepReport,
    resets: u64,
    /// Whether each patch of the world shows the same box.
    is_shared: bool,
    ground: GroundWind,
    frame: Arc<WindFrame>,
}

/// Why a scene's wind cannot blow.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum WeatherError {
    /// A setting out of range, or at odds with another.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// The settings do not fit the step.
    #[error(transparent)]
    Step(#[from] StepError),
}

/// Whether a solver takes the settings of `scene`, asked without making one.
///
/// # Errors
/// As [`Weather::new`], but for a wind that is lost while it warms up.
pub fn check(scene: &Scene) -> Result<(), WeatherError> {
    let config = config(scene);
    config.validate()?;
    let (_, step_secs) = rhythm(scene);
    Ok(WindSolver::check_step(&config, step_secs)?)
}

impl Weather {
    /// The wind of `scene`, which has blown for a while.
    ///
    /// # Errors
    /// [`WeatherError`] when the solver refuses the scene's settings.
    pub fn new(scene: &Scene) -> Result<Self, WeatherError> {
        let config = config(scene);
        let mut solver = WindSolver::new(&config)?;
        let (ticks_per_step, step_secs) = rhythm(scene);
        let cells: usize = config.cells.iter().product();
        let mut report = solver.step(step_secs, &[])?;
        for _ in 1..(WARM_UP_CELL_STEPS / cells).clamp(1, WARM_UP_STEPS) {
            report = solver.step(step_secs, &[])?;
        }
        let ground = GroundWind::still(scene);
        let frame = Arc::new(WindFrame::default());
        let mut weather = Self {
            solver,
            config,
            ticks_per_step,
            step_secs,
            report,
            resets: 0,
            is_shared: scene.wind.tiling == WindTiling::Patch,
            ground,
            frame,
        };
        weather.observe(0);
        Ok(weather)
    }

    /// Blows on, every so many ticks, by as much time. The thirds of the solver's step are spread over those ticks, so that no tick is
    /// much longer than another.
    pub fn step(&mut self, tick: u64, motions: &[Motion], height: &HeightMap) {
        let (ticks, phase) = (self.ticks_per_step, (tick - 1) % self.ticks_per_step + 1);
        let is_due = |third: u64| phase == (third * ticks).div_ceil(3);
        // What `begin` refuses, `finish` refuses too.
        let begun = if is_due(1) { self.solver.begin(self.step_secs) } else { Ok(()) };
        if is_due(2) {
            self.solver.carry_on();
        }
        if !is_due(3) {
            return;
        }
        // What an object does to a box that every patch shows would blow in all of them.
        let motions = if self.is_shared { &[] } else { motions };
        let jets: Vec<_> = motions.iter().filter_map(|motion| jet(motion, height)).collect();
        match begun.and_then(|()| self.solver.finish(self.step_secs, &jets)) {
            Ok(report) => self.report = report,
            // The state is lost: the air starts anew from the mean wind.
            Err(_) => {
                self.solver = WindSolver::new(&self.config).expect("the same settings were accepted before");
                self.resets += 1;
            }
        }
        self.observe(tick);
    }

    /// What the wind near the ground does to grass.
    pub fn ground(&self) -> &GroundWind {
        &self.ground
    }

    /// The newest wind, quantised.
    pub fn frame(&self) -> &Arc<WindFrame> {
        &self.frame
    }

    /// What the newest step did.
    pub fn report(&self) -> StepReport {
        self.report
    }

    /// Times that a step failed and the wind began anew from its mean.
    pub fn resets(&self) -> u64 {
        self.resets
    }

    /// Velocities at the cells' centres (m/s).
    pub fn velocities(&self) -> impl ExactSizeIterator<Item = Vec3> + '_ {
        self.solver.cell_velocities()
    }

    fn observe(&mut self, tick: u64) {
        let [nx, ny, nz] = self.config.cells;
        let cells = nx * ny * nz;
        let mut codes = vec![0; Shape::wind(nx, self.solver.dust().is_some()).planes * cells];
        for (at, velocity) in self.solver.cell_velocities().enumerate() {
            for (plane, component) in velocity.to_array().into_iter().enumerate() {
                codes[plane * cells + at] = wind_code(component);
            }
        }
        let densities = self.solver.dust().into_iter().flat_map(|dust| &dust.data);
        codes[3 * cells..].iter_mut().zip(densities).for_each(|(code, &density)| *code = dust_code(density));
        self.ground.blow(ny, self.solver.cell_velocities().map(|velocity| [velocity.x, velocity.z]));
        self.frame = Arc::new(WindFrame { tick, cells: [nx, ny, nz].map(|n| n as u32), codes });
    }
}

/// Ticks from one step of the solver to the next, and the time that they take (s).
fn rhythm(scene: &Scene) -> (u64, f32) {
    let ticks = (STEP_SECS * scene.tick_hz).ceil().max(1.0);
    (ticks as u64, ticks * scene.dt_secs())
}

fn config(scene: &Scene) -> Config {
    let wind = &scene.wind;
    let [x, _, z] = wind.faces.wraps().map(|wraps| if wraps { Boundary::Wrap } else { Boundary::Wall });
    let [hx, hy, hz] = wind.spacing_m;
    Config {
        cells: wind.cells.map(|n| n as usize),
        spacing_m: wind.spacing_m,
        boundary: [x, Boundary::Wall, z],
        viscosity_m2_per_s: wind.viscosity_m2_per_s,
        mean_wind_m_per_s: [wind.mean_m_per_s[0], 0.0, wind.mean_m_per_s[1]],
        profile: Profile::Log { roughness_m: ROUGHNESS_M, reference_m: 5.0 * hy },
        relaxation_per_sec: wind.mean_rate_per_s,
        gusts: Gusts {
            number: wind.sources as usize,
            strength_m_per_s: wind.source_m_per_s,
            radius_m: [1.75 * hx, 2.5 * hy, 1.75 * hz],
            ..Gusts::default()
        },
        dust: wind.has_dust().then_some(Dust {
            diffusivity_m2_per_s: wind.dust.diffusivity_m2_per_s,
            release_per_sec: wind.dust.release_per_s,
            settling_per_sec: wind.dust.settling_per_s,
        }),
        seed: scene.seed,
        ..Config::default()
    }
}

/// The air that an object moves.
fn jet(motion: &Motion, height: &HeightMap) -> Option<Jet> {
    let [x, y, z] = motion.to.position_m;
    let above_m = (y - height.height_m(x, z)).max(0.0);
    let velocity = Vec3::from_array(motion.velocity_m_per_s);
    if motion.kind == VehicleKind::Helicopter {
        let down = velocity - Vec3::Y * DOWNWASH_M_PER_S;
        let below = Vec3::new(x, (above_m - 0.5 * DOWNWASH_RADIUS_M).max(0.5), z);
        return Some(Jet { position_m: below, radius_m: DOWNWASH_RADIUS_M, velocity_m_per_s: down, rate_per_sec: DOWNWASH_PER_S });
    }
    let wake = Jet { position_m: Vec3::new(x, above_m, z), radius_m: WAKE_RADIUS_M, velocity_m_per_s: velocity, rate_per_sec: WAKE_PER_S };
    (velocity.length() > WAKE_FROM_M_PER_S).then_some(wake)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::objects::Stand;

    #[test]
    fn dust_is_shown_where_the_scene_asks_for_it() {
        let mut scene = crate::scenes::load("meadow").unwrap().scene;
        assert!(!Weather::new(&scene).unwrap().frame().has_dust(), "no byte more for clear air");
        scene.wind.dust.release_per_s = 2.0;
        let frame = Arc::clone(Weather::new(&scene).unwrap().frame());
        let dust = &frame.codes[3 * frame.volume()..];
        assert_eq!(dust.len(), frame.volume());
        assert!(dust.iter().all(|&code| code >= 0) && dust.iter().any(|&code| code > 20) && dust.contains(&0), "clouds in clear air");
    }

    #[test]
    fn an_object_blows_in_no_box_that_serves_every_patch() {
        let mut scene = crate::scenes::load("meadow").unwrap().scene;
        (scene.wind.cells, scene.wind.spacing_m, scene.wind.sources) = ([8; 3], [2.0; 3], 0);
        let height = HeightMap::from_heights(2, 2, [256.0; 2], vec![0.0; 4]);
        let stand = Stand { position_m: [64.0, 5.0, 64.0], rotation: [0.0, 0.0, 0.0, 1.0] };
        let hovering = Motion { kind: VehicleKind::Helicopter, from: stand, to: stand, velocity_m_per_s: [0.0; 3] };
        let mut strongest_updraught = |tiling| {
            scene.wind.tiling = tiling;
            let mut weather = Weather::new(&scene).unwrap();
            (1..=20).for_each(|tick| weather.step(tick, &[hovering], &height));
            weather.velocities().map(|velocity| velocity.y.abs()).fold(0.0, f32::max)
        };
        assert!(strongest_updraught(WindTiling::Box) > 0.5);
        assert!(strongest_updraught(WindTiling::Patch) < 1e-3);
    }

    #[test]
    fn a_wind_that_is_lost_begins_anew_and_is_counted() {
        let scene = crate::scenes::load("meadow").unwrap().scene;
        let height = HeightMap::from_heights(2, 2, [256.0; 2], vec![0.0; 4]);
        let mut weather = Weather::new(&scene).unwrap();
        let stand = Stand { position_m: [64.0, 5.0, 64.0], rotation: [0.0, 0.0, 0.0, 1.0] };
        let thrown = Motion { kind: VehicleKind::Helicopter, from: stand, to: stand, velocity_m_per_s: [f32::MAX; 3] };
        let mut blow = |motions: &[Motion]| {
            let ticks = weather.ticks_per_step;
            (1..=ticks).for_each(|tick| weather.step(tick, motions, &height));
            (weather.resets(), weather.velocities().all(Vec3::is_finite))
        };
        assert_eq!(blow(&[]), (0, true));
        assert_eq!(blow(&[thrown]), (1, true));
        assert_eq!(blow(&[]), (1, true));
    }
}
