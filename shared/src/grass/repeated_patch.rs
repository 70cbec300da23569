//! One patch of grass in the natural wind that is shown again and again where no camera is near (Chen & Johan 2010, §4.2 and §5.3).
//!
//! It holds a whole period of the gusts that push the grass near cameras, so that they are the same gusts at the same places, on coarser cells. Its state is a
//! function of the scene and the number of the step alone: everyone who follows a scene sees the same, and nothing of it is sent or saved. For that time is cut
//! into windows so long that grass recovers from a push in one: the patch shown in a window started at rest with the window before.

use super::gust_noise::{push_along, push_secs2};
use super::gust_pattern::{GustPattern, PERIOD_GUSTS};
use crate::bend::{Edges, Field, Kinds, Patch, Scheme, Serial, TILE, WaveParams};
use crate::grid::PatchLayout;
use crate::scene::Scene;

/// Cells of a gust along each axis.
const CELLS_PER_GUST: u32 = 8;
/// Cells of the patch along each axis.
const CELLS: u32 = PERIOD_GUSTS * CELLS_PER_GUST;
/// Largest number of steps in a second: the grass is far away.
const STEPS_PER_S: f32 = 30.0;
/// Length of a window in time constants of the slowest recovery: e⁻⁶ of a push is left after it, 2 mrad of 0.8 rad.
const TIME_CONSTANTS: f32 = 6.0;
/// Longest window (s).
const WINDOW_LIMIT_SECS: f32 = 120.0;
/// Latest step of a world: a million years at 240 Hz.
const TICK_LIMIT: u64 = 1 << 53;

/// Grass in the natural wind that repeats along X and Z.
pub struct RepeatedPatch {
    pattern: GustPattern,
    scheme: Scheme,
    /// Steps of the world in a step of the patch.
    ticks_per_step: u64,
    dt_secs: f32,
    window_steps: u64,
    /// Steps done, counted from a window and a step before the start of the scene.
    steps: u64,
    /// Whether they are those of the wanted step of the world.
    has_arrived: bool,
    at_rest: Field,
    shown: Field,
    /// The grass of the next window, which started at rest with this one.
    next: Field,
}

impl RepeatedPatch {
    /// The grass of a scene, of its first kind. `None` in a scene without natural wind, and if its grass needs more than 120 s to recover from a push: six times
    /// its slowest time constant, k/κ if it is well damped.
    pub fn new(scene: &Scene) -> Option<Self> {
        let pattern = GustPattern::new(scene)?;
        let waves = scene.grass.waves;
        let window_secs = TIME_CONSTANTS * slowest_secs(&waves);
        if window_secs > WINDOW_LIMIT_SECS {
            return None;
        }
        let ticks = (scene.tick_hz / STEPS_PER_S).ceil();
        let dt_secs = ticks / scene.tick_hz;
        let layout = PatchLayout { count: [1; 2], cells: CELLS, cell_m: pattern.period_m() / CELLS as f32 };
        let at_rest = Field::new(layout, Kinds::one(waves)).with_edges(Edges::Wrapped).with_ground_contact(scene.bend.ground_contact);
        // One that is stable at steps that are longer than those of the world, and in every build.
        let scheme = if scene.bend.scheme == Scheme::Implicit { Scheme::Implicit } else { Scheme::Substepped };
        let window_steps = (window_secs / dt_secs).ceil().max(1.0) as u64;
        Some(Self {
            pattern,
            scheme,
            ticks_per_step: ticks as u64,
            dt_secs,
            window_steps,
            steps: 0,
            has_arrived: false,
            shown: at_rest.clone(),
            next: at_rest.clone(),
            at_rest,
        })
    }

    /// Goes on to the grass after step `tick` of the world, by about `most_substeps` sub-steps of its scheme, and returns whether it has arrived there.
    pub fn advance_to(&mut self, tick: u64, most_substeps: u32) -> bool {
        let goal = self.window_steps + 1 + tick.min(TICK_LIMIT) / self.ticks_per_step;
        // A window begins with the step after a multiple of its steps.
        let first = ((goal - 1) / self.window_steps - 1) * self.window_steps;
        if !(first..=goal).contains(&self.steps) {
            self.steps = first;
            (self.shown, self.next) = (self.at_rest.clone(), self.at_rest.clone());
        }
        let mut substeps = 0;
        while self.steps < goal && substeps < most_substeps {
            substeps += self.step();
        }
        self.has_arrived = self.steps == goal;
        self.has_arrived
    }

    /// Steps done, and the grass to show after them; `None` on the way to the wanted step.
    pub fn shown(&self) -> Option<(u64, &Patch)> {
        self.shown.patch(0).filter(|_| self.has_arrived).map(|patch| (self.steps, patch))
    }

    /// Side of the patch (m).
    pub fn period_m(&self) -> f32 {
        self.pattern.period_m()
    }

    /// Time constant of the grass's slowest recovery (s).
    pub fn recovery_secs(&self) -> f32 {
        self.window_steps as f32 * self.dt_secs / TIME_CONSTANTS
    }

    /// Cells along each side.
    pub const fn cells() -> u32 {
        CELLS
    }

    /// Does a step. Returns its number of sub-steps.
    fn step(&mut self) -> u32 {
        if self.steps.is_multiple_of(self.window_steps) {
            self.shown = std::mem::replace(&mut self.next, self.at_rest.clone());
            self.next.wake(0);
        }
        self.steps += 1;
        let time_secs = (self.steps as f64 - (self.window_steps + 1) as f64) * f64::from(self.dt_secs);
        let pushes = accelerations_rad_per_s2(&self.pattern, time_secs);
        let mut most = 1;
        for field in [&mut self.shown, &mut self.next].into_iter().filter(|field| field.awake_count() > 0) {
            push(field, &pushes, self.pattern.along(), self.dt_secs);
            let substeps = field.step(self.scheme, self.dt_secs, &Serial).map_or(0, |report| report.substeps);
            most = most.max(substeps);
            // Grass too fast to follow, or with NaN, starts again.
            if substeps == 0 || field.awake_count() == 0 {
                *field = self.at_rest.clone();
                field.wake(0);
            }
        }
        most
    }
}

impl std::fmt::Debug for RepeatedPatch {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_struct("RepeatedPatch").field("steps", &self.steps).finish_non_exhaustive()
    }
}

/// Accelerations of the cells (rad/s²), row by row: bilinear between the corners of squares of 2 × 2 cells.
fn accelerations_rad_per_s2(pattern: &GustPattern, time_secs: f64) -> Vec<f32> {
    const SQUARES: usize = CELLS as usize / 2;
    let square_m = pattern.period_m() / SQUARES as f32;
    let corner = |n: usize| pattern.acceleration_rad_per_s2([(n % SQUARES) as f32 * square_m, (n / SQUARES) as f32 * square_m], time_secs);
    let corners: Vec<f32> = (0..SQUARES * SQUARES).map(corner).collect();
    let row = |n: usize| &corners[n % SQUARES * SQUARES..][..SQUARES];
    let mix = |a: f32, b: f32, is_second: bool| a + (b - a) * if is_second { 0.75 } else { 0.25 };
    let mut cells = Vec::with_capacity(CELLS.pow(2) as usize);
    for j in 0..CELLS as usize {
        let (north, south) = (row(j / 2), row(j / 2 + 1));
        let at = |n: usize| mix(north[n % SQUARES], south[n % SQUARES], j % 2 == 1);
        cells.extend((0..SQUARES).flat_map(|n| [false, true].map(|is_second| mix(at(n), at(n + 1), is_second))));
    }
    cells
}

/// Pushes the patch, if it is awake, by accelerations of its cells (rad/s²) along a unit vector.
fn push(field: &mut Field, accelerations: &[f32], along: [f32; 2], dt_secs: f32) {
    let secs2 = push_secs2(field, dt_secs);
    let Some(patch) = field.patch_mut(0) else { return };
    let side = CELLS as usize;
    for tile in (0..(side / TILE).pow(2)).map(|n| [n % (side / TILE), n / (side / TILE)]) {
        patch.push_tile(tile, |[u, v]| push_along(along, accelerations[(tile[1] * TILE + v) * side + tile[0] * TILE + u] * secs2));
    }
}

/// Time constant of the slowest decay of θ or ω (s): of x'' + k·x' + κ·x = 0. Infinite where nothing decays.
fn slowest_secs(waves: &WaveParams) -> f32 {
    let of = |k: f32| {
        let discriminant = k * k - 4.0 * waves.stiffness_per_s2;
        2.0 / (k - discriminant.max(0.0).sqrt())
    };
    of(waves.theta_damping_per_s).max(of(waves.omega_damping_per_s))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{NaturalWind, TerrainMaps};

    /// Largest difference (rad) between the θ of the patch that ends with a window, and of the one that takes its place, in windows that are shorter by a
    /// factor.
    fn seam_rad(shorter: u64) -> f32 {
        let terrain = TerrainMaps { height_map: String::new(), covering_map: String::new(), pixel_m: [1.0; 2], level_m: 0.1, base_m: 0.0 };
        let natural_wind = NaturalWind { strength_rad_per_s2: 2.0, scale_m: 16.0, drift_m_per_s: [4.0, 1.5], ..NaturalWind::default() };
        let mut patch = RepeatedPatch::new(&Scene { natural_wind, seed: 9, ..Scene::new(terrain) }).expect("gusts");
        patch.window_steps /= shorter;
        let mut largest_rad = 0.0_f32;
        for number in 5..9 {
            patch.advance_to(((number - 1) * patch.window_steps - 2) * patch.ticks_per_step, u32::MAX);
            assert!((patch.steps + 1).is_multiple_of(patch.window_steps), "the last step of a window");
            let rows = |field: &Field| field.patch(0).expect("awake").rows().flat_map(|[theta, ..]| theta.to_vec()).collect::<Vec<_>>();
            patch.step();
            // Both have done the same step, one from the window before, one from that window's start.
            let [ending, beginning] = [rows(&patch.shown), rows(&patch.next)];
            let difference = ending.iter().zip(&beginning).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
            largest_rad = largest_rad.max(difference);
        }
        largest_rad
    }

    /// Bound set before measuring: half a step of the codes in which grass is sent.
    #[test]
    fn a_window_begins_where_the_one_before_ends() {
        let code_rad = crate::scene::Stream::default().theta_error_deg.to_radians();
        let [whole, quarter] = [1, 4].map(seam_rad);
        println!("{whole} rad, in windows of a quarter {quarter} rad");
        assert!(whole < code_rad, "{whole} rad");
        assert!(quarter > code_rad, "{quarter} rad");
    }
}
