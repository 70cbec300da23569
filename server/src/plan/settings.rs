//! Settings of the wind's solver that a plan may choose, and the candidates of a scene.

use crate::weather::pilot::{self, intervals};
use prairie_core::scene::{Scene, WIND_CELLS_LIMIT, WindAdvection, WindDiffusion, WindMethod, WindPressure, WindTiling, WindTime};
use serde::{Deserialize, Serialize};

/// Relative residuals at which iterative pressure solvers may stop.
pub(super) const TOLERANCES: [f32; 4] = [1e-1, 1e-2, 1e-3, 1e-5];
/// Ticks that a step of the solver may take.
const TICKS: [u64; 9] = [1, 2, 3, 4, 5, 6, 9, 10, 12];
/// Quarters of the scene's cells along X and Z.
const QUARTERS: [u32; 4] = [1, 2, 4, 8];
/// Largest ratio of the time between frames of the wind to that of the scene's own settings.
const FRAME_RATIO: f64 = 1.12;
/// Allowed sides of a cell (m).
const SPACINGS_M: std::ops::RangeInclusive<f32> = 0.1..=1000.0;
/// Finest factor of the scene's cells along X and Z in any plan.
pub(super) const FINEST: u32 = 2;
/// Fewest cells along an axis: what fluxes of third order reach across.
const LEAST_CELLS: u32 = 4;

/// Settings of the wind's solver.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct WindSettings {
    /// Cells along X, Y and Z.
    pub cells: [u32; 3],
    /// Advection scheme.
    pub advection: WindAdvection,
    /// Time scheme.
    pub time: WindTime,
    /// Diffusion scheme.
    pub diffusion: WindDiffusion,
    /// Pressure solver.
    pub pressure: WindPressure,
    /// Relative residual at which an iterative pressure solver stops.
    pub tolerance: f32,
    /// Ticks per step.
    pub ticks: u64,
}

impl WindSettings {
    /// The settings of a scene.
    pub fn of(scene: &Scene) -> Self {
        let wind = &scene.wind;
        let [ticks, _] = intervals(scene);
        Self {
            cells: wind.cells,
            advection: wind.advection,
            time: wind.time,
            diffusion: wind.diffusion,
            pressure: wind.pressure,
            tolerance: wind.pressure_tolerance,
            ticks,
        }
    }

    /// `scene` with these settings, and all lengths and times that would follow from its cells and steps as they were.
    pub fn applied_to(&self, scene: &Scene) -> Scene {
        let mut planned = pilot::with_lengths(scene);
        let wind = &mut planned.wind;
        let box_m = scene.wind.box_m();
        (wind.cells, wind.spacing_m) = (self.cells, std::array::from_fn(|axis| box_m[axis] / self.cells[axis] as f32));
        (wind.advection, wind.time, wind.diffusion, wind.pressure) = (self.advection, self.time, self.diffusion, self.pressure);
        wind.pressure_tolerance = self.tolerance;
        // In the middle between two whole numbers of ticks, so that rounding cannot change it.
        wind.step_secs = ((self.ticks as f32 - 0.5) / scene.tick_hz).max(0.004);
        planned
    }

    /// Number of cells.
    pub fn count(&self) -> f64 {
        self.cells.iter().map(|n| f64::from(*n)).product()
    }

    /// The settings in words.
    pub fn words(&self, method: WindMethod) -> String {
        let [x, y, z] = self.cells;
        let ticks = if self.ticks == 1 { "every tick".to_owned() } else { format!("every {} ticks", self.ticks) };
        if method == WindMethod::StableFluids {
            return format!("stable-fluids on {x} × {y} × {z} cells, {ticks}");
        }
        let residual = if self.pressure == WindPressure::Direct { String::new() } else { format!(" to {:e}", self.tolerance) };
        let Self { advection, time, diffusion, pressure, .. } = self;
        format!(
            "{} + {} + {} + {}{residual} on {x} × {y} × {z} cells, {ticks}",
            advection.word(),
            time.word(),
            diffusion.word(),
            pressure.word()
        )
    }
}

/// All settings from which the plan of `scene` chooses: what the file states is kept. The scene's own settings are the first.
pub(super) fn candidates(scene: &Scene, stated: &[String], finest: u32) -> Vec<WindSettings> {
    let own = WindSettings::of(scene);
    let is_stated = |field: &str| stated.iter().any(|path| path == field);
    let (mut all, steps) = (vec![own], steps(scene, &is_stated));
    for cells in grids(scene, &is_stated, finest) {
        for (advection, time) in pairs(scene, &is_stated) {
            for diffusion in diffusions(scene, &is_stated) {
                for (pressure, tolerance) in pressures(scene, &is_stated) {
                    let others = steps.iter().map(|&ticks| WindSettings { cells, advection, time, diffusion, pressure, tolerance, ticks });
                    all.extend(others.filter(|other| *other != own));
                }
            }
        }
    }
    all
}

fn is_fixed(scene: &Scene) -> bool {
    scene.wind.method == WindMethod::StableFluids
}

/// Divisions of the same box into cells, whose sides along X and Z differ by a factor of at most 2 from the scene's ratio.
fn grids(scene: &Scene, is_stated: &impl Fn(&str) -> bool, finest: u32) -> Vec<[u32; 3]> {
    let own = scene.wind.cells;
    let states_cells = is_stated("wind.cells") || is_stated("wind.spacing_m");
    // With one box for all patches, the offset of each patch is a number of cells.
    if states_cells && !scene.accuracy.plans_cells() || scene.wind.tiling == WindTiling::Patch {
        return vec![own];
    }
    let of = |n: u32, quarters: u32| (n * quarters).is_multiple_of(4).then(|| n * quarters / 4).filter(|n| (LEAST_CELLS..=256).contains(n));
    let mut grids = Vec::new();
    for (x, z) in QUARTERS.into_iter().flat_map(|x| QUARTERS.into_iter().map(move |z| (x, z))) {
        let (Some(nx), Some(nz)) = (of(own[0], x), of(own[2], z)) else { continue };
        let count = u64::from(nx) * u64::from(own[1]) * u64::from(nz);
        let has_room = count <= WIND_CELLS_LIMIT && u64::from(scene.wind.sources) <= count;
        let has_size = [(0, nx), (2, nz)].iter().all(|&(axis, n)| SPACINGS_M.contains(&(scene.wind.box_m()[axis] / n as f32)));
        if x.max(z) <= 4 * finest && x.max(z) <= 2 * x.min(z) && has_room && has_size {
            grids.push([nx, own[1], nz]);
        }
    }
    grids
}

fn pairs(scene: &Scene, is_stated: &impl Fn(&str) -> bool) -> Vec<(WindAdvection, WindTime)> {
    let wind = &scene.wind;
    if is_fixed(scene) {
        return vec![(wind.advection, wind.time)];
    }
    let all = WindAdvection::ALL.iter().flat_map(|advection| WindTime::ALL.iter().map(move |time| (*advection, *time)));
    all.filter(|(advection, time)| {
        let is_open = |path: &str, is_own: bool| is_own || !is_stated(path);
        time.allows(*advection)
            && is_open("wind.advection", *advection == wind.advection)
            && is_open("wind.time", *time == wind.time)
            && !(pilot::has_walls(scene) && *time == WindTime::Reflection)
    })
    .collect()
}

fn diffusions(scene: &Scene, is_stated: &impl Fn(&str) -> bool) -> Vec<WindDiffusion> {
    let own = scene.wind.diffusion;
    if is_fixed(scene) || is_stated("wind.diffusion") {
        return vec![own];
    }
    let all = [WindDiffusion::Explicit, WindDiffusion::GaussSeidel, WindDiffusion::Implicit, WindDiffusion::CrankNicolson];
    let knows_walls = |diffusion: &WindDiffusion| matches!(diffusion, WindDiffusion::Explicit | WindDiffusion::GaussSeidel);
    all.into_iter().filter(|diffusion| !pilot::has_walls(scene) || knows_walls(diffusion)).collect()
}

fn pressures(scene: &Scene, is_stated: &impl Fn(&str) -> bool) -> Vec<(WindPressure, f32)> {
    let wind = &scene.wind;
    let tolerances = if is_stated("wind.pressure_tolerance") { vec![wind.pressure_tolerance] } else { TOLERANCES.to_vec() };
    if is_fixed(scene) {
        return vec![(wind.pressure, wind.pressure_tolerance)];
    }
    let iterative = |pressure: WindPressure| tolerances.iter().map(move |tolerance| (pressure, *tolerance));
    if is_stated("wind.pressure") || pilot::has_walls(scene) {
        // Land is immersed with the direct solver and solid cells with others, which is another problem, not another error.
        return if wind.pressure == WindPressure::Direct {
            vec![(wind.pressure, wind.pressure_tolerance)]
        } else {
            iterative(wind.pressure).collect()
        };
    }
    let direct = [(WindPressure::Direct, wind.pressure_tolerance)];
    direct.into_iter().chain(iterative(WindPressure::Multigrid)).chain(iterative(WindPressure::ConjugateGradients)).collect()
}

/// Ticks per step: those whose frames are not much rarer than the scene's own.
fn steps(scene: &Scene, is_stated: &impl Fn(&str) -> bool) -> Vec<u64> {
    let own = WindSettings::of(scene);
    let [_, own_frame] = intervals(scene);
    if is_stated("wind.step_secs") {
        return vec![own.ticks];
    }
    let frame = |ticks: u64| intervals(&WindSettings { ticks, ..own }.applied_to(scene));
    TICKS.into_iter().filter(|&ticks| frame(ticks)[0] == ticks && frame(ticks)[1] as f64 <= FRAME_RATIO * own_frame as f64).collect()
}
