//! The wind of a scene: the solver, its rhythm, and what the rest of the world sees of it.

mod jets;
mod land;
mod sample;
mod settings;
mod standing;

use crate::bend::air::GroundWind;
use crate::objects::Motion;
use crate::snapshot::WindFrame;
use crate::wind::{Air, Config, ConfigError, Method, SolidError, StepError, StepReport};
use crate::world::Maps;
use glam::Vec3;
use land::Land;
use settings::settings;
use shared::bend::Field;
use shared::scene::{Scene, WindTiling};
use shared::terrain::{HeightMap, KindMap};
use shared::wind::Tiles;
use shared::wire::Shape;
use shared::wire::quantise::{dust_code, wind_code};
use standing::Standing;
use std::sync::Arc;

/// The solver takes the least number of ticks a step that is not shorter than this (s).
const STEP_SECS: f32 = 0.05;
/// Cell steps that the wind blows before the world starts, so that there are gusts from the beginning.
const WARM_UP_CELL_STEPS: usize = 1 << 20;
const WARM_UP_STEPS: usize = 120;

/// The wind of a scene.
pub struct Weather {
    air: Air<f32>,
    method: Method,
    config: Config,
    tiling: WindTiling,
    tiles: Tiles,
    /// Whether the box wraps, by axis.
    wraps: [bool; 3],
    ticks_per_step: u64,
    step_secs: f64,
    report: StepReport,
    resets: u64,
    land: Land,
    standing: Option<Standing>,
    ground: GroundWind,
    /// Wind (m/s) in the middles of layers above the ground, x fastest, then y, then z.
    velocities: Vec<Vec3>,
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
    /// The land does not fit the box.
    #[error(transparent)]
    Solid(#[from] SolidError),
}

/// Whether a solver takes the settings of `scene`, asked without making one.
///
/// # Errors
/// As [`Weather::new`], but for a land that fills the box and a wind that is lost while it warms up.
pub fn check(scene: &Scene) -> Result<(), WeatherError> {
    let (method, config) = settings(scene);
    let (_, step_secs) = rhythm(scene);
    Air::<f32>::check(method, &config)?;
    Ok(Air::<f32>::check_step(method, &config, step_secs)?)
}

impl Weather {
    /// The wind of `scene` over its land, which has blown for a while.
    ///
    /// # Errors
    /// [`WeatherError`] when the solver refuses the scene's settings.
    pub fn new(scene: &Scene, maps: &Maps) -> Result<Self, WeatherError> {
        let (method, config) = settings(scene);
        let land = Land::new(scene, &maps.height);
        let mut air = begin(method, &config, &land)?;
        let (ticks_per_step, step_secs) = rhythm(scene);
        let cells: usize = config.cells.iter().product();
        let mut report = air.step(step_secs, &[])?;
        for _ in 1..(WARM_UP_CELL_STEPS / cells).clamp(1, WARM_UP_STEPS) {
            report = air.step(step_secs, &[])?;
        }
        let mut weather = Self {
            standing: config.canopy.map(|canopy| Standing::new(scene, &maps.cover, canopy.height_m)),
            tiling: scene.wind.tiling,
            tiles: Tiles::new(scene),
            wraps: scene.wind.faces.wraps(),
            ground: GroundWind::still(scene).over(KindMap::new(scene, &maps.cover)),
            frame: Arc::default(),
            velocities: Vec::new(),
            resets: 0,
            air,
            method,
            config,
            ticks_per_step,
            step_secs,
            report,
            land,
        };
        weather.observe(0);
        Ok(weather)
    }

    /// Blows on, every so many ticks, by as much time.
    pub fn step(&mut self, tick: u64, motions: &[Motion], height: &HeightMap, grass: &Field) {
        if !tick.is_multiple_of(self.ticks_per_step) {
            return;
        }
        // What an object does to a box that every patch shows would blow in all of them.
        let motions = if self.tiling == WindTiling::Patch { &[] } else { motions };
        if self.tiling == WindTiling::Follow {
            self.follow(motions);
        }
        if let (Some(standing), WindTiling::Box | WindTiling::Follow) = (&mut self.standing, self.tiling) {
            self.air.set_cover(standing.shares(grass));
        }
        let jets: Vec<_> = motions
            .iter()
            .filter_map(|motion| {
                let [x, _, z] = motion.to.position_m;
                jets::jet(motion, self.land.zero_m(height.height_m(x, z)))
            })
            .collect();
        match self.air.step(self.step_secs, &jets) {
            Ok(report) => self.report = report,
            // The state is lost: the air starts anew from the mean wind.
            Err(_) => {
                self.air = begin(self.method, &self.config, &self.land).expect("the same settings were accepted before");
                self.resets += 1;
            }
        }
        self.observe(tick);
    }

    /// Cuts the box on the far side of the middle of all objects.
    fn follow(&mut self, motions: &[Motion]) {
        let count = motions.len() as f64;
        let seam_m = [0, 2].map(|axis| {
            let side_m = self.config.cells[axis] as f64 * f64::from(self.config.spacing_m[axis]);
            let middle_m = motions.iter().map(|motion| f64::from(motion.to.position_m[axis])).sum::<f64>() / count;
            (middle_m + 0.5 * side_m).rem_euclid(side_m)
        });
        self.air.set_seam((!motions.is_empty()).then_some(seam_m));
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

    /// Wind (m/s) in the middles of layers above the ground, x fastest, then y, then z.
    pub fn velocities(&self) -> &[Vec3] {
        &self.velocities
    }

    fn observe(&mut self, tick: u64) {
        let [nx, ny, nz] = self.config.cells;
        let cells = nx * ny * nz;
        self.velocities = self.land.above_ground(self.air.cell_velocities().collect(), Vec3::lerp);
        let mut codes = vec![0; Shape::wind(nx, self.config.dust.is_some()).planes * cells];
        for (at, velocity) in self.velocities.iter().enumerate() {
            for (plane, component) in velocity.to_array().into_iter().enumerate() {
                codes[plane * cells + at] = wind_code(component);
            }
        }
        if let Some(dust) = self.air.dust() {
            let dust = self.land.above_ground(dust.collect(), |a, b, t| a + (b - a) * t);
            codes[3 * cells..].iter_mut().zip(dust).for_each(|(code, density)| *code = dust_code(density));
        }
        self.ground.blow(ny, self.velocities.iter().map(|velocity| [velocity.x, velocity.z]));
        self.frame = Arc::new(WindFrame { tick, cells: [nx, ny, nz].map(|n| n as u32), codes });
    }
}

/// The air at its beginning, round the land where that is solid.
fn begin(method: Method, config: &Config, land: &Land) -> Result<Air<f32>, WeatherError> {
    let mut air = Air::new(method, config)?;
    if land.is_solid() {
        air.set_solid(|position_m| land.holds(position_m, config.spacing_m))?;
    }
    Ok(air)
}

/// Ticks from one step of the solver to the next, and the time that they take (s).
fn rhythm(scene: &Scene) -> (u64, f64) {
    let ticks = (STEP_SECS * scene.tick_hz).ceil().max(1.0);
    (ticks as u64, (ticks * scene.dt_secs()).into())
}

#[cfg(test)]
mod tests;
