//! Streamlines of the resolved wind, seeded on the ground.

use glam::Vec3;
use prairie_core::scene::Scene;
use prairie_core::terrain::HeightMap;
use prairie_core::wind::WindField;

/// Number of seeds along X and Z.
const SEEDS: u32 = 12;

/// Largest number of points of a streamline.
const POINT_LIMIT: usize = 96;

/// Length of a step, as a fraction of the smallest side of a cell.
const STEP_CELLS: f32 = 0.5;

/// Speed below which a streamline ends (m/s).
const CALM_M_PER_S: f32 = 0.05;

/// Seeds of the streamlines, constant during a run: 12 × 12 over the world, at the centre of the lowest cells.
pub(super) struct Streamlines {
    seeds: Vec<Vec3>,
    extent_m: [f32; 2],
    top_m: f32,
    step_m: f32,
}

impl Streamlines {
    /// The seeds of a scene.
    pub(super) fn new(scene: &Scene) -> Self {
        let (extent_m, [dx, dy, dz]) = (scene.extent_m(), scene.wind.spacing_m);
        let seed = |at: u32| {
            let [x, z] = [(at % SEEDS, 0), (at / SEEDS, 1)].map(|(n, axis)| (n as f32 + 0.5) / SEEDS as f32 * extent_m[axis]);
            Vec3::new(x, 0.5 * dy, z)
        };
        let top_m = scene.wind.cells[1] as f32 * dy;
        Self { seeds: (0..SEEDS * SEEDS).map(seed).collect(), extent_m, top_m, step_m: STEP_CELLS * dx.min(dy).min(dz) }
    }

    /// The streamlines of a wind (m), above the terrain. They end at the edges of the world, at the ground, at the top of the box, in calm air and
    /// after 96 points.
    pub(super) fn lines(&self, wind: &WindField, heights: &HeightMap) -> Vec<Vec<[f32; 3]>> {
        let velocity = |at: Vec3| Vec3::from_array(wind.resolved_at(at.to_array()));
        let is_inside = |at: Vec3| {
            (0.0..=self.extent_m[0]).contains(&at.x) && (0.0..=self.top_m).contains(&at.y) && (0.0..=self.extent_m[1]).contains(&at.z)
        };
        let raised = |at: Vec3| [at.x, at.y + heights.height_m(at.x, at.z), at.z];
        let line = |seed: &Vec3| trace(*seed, self.step_m, velocity, is_inside).into_iter().map(raised).collect::<Vec<_>>();
        self.seeds.iter().map(line).filter(|line: &Vec<_>| line.len() > 1).collect()
    }
}

/// A streamline from `seed` downwind, in steps of `step_m` along its length: the classical Runge-Kutta method of fourth order on the direction of the
/// velocity. The point that `is_inside` rejects is left out.
fn trace(seed: Vec3, step_m: f32, velocity: impl Fn(Vec3) -> Vec3, is_inside: impl Fn(Vec3) -> bool) -> Vec<Vec3> {
    let direction = |at: Vec3| {
        let velocity = velocity(at);
        (velocity.length() >= CALM_M_PER_S).then(|| velocity.normalize())
    };
    let next = |at: &Vec3| {
        let first = direction(*at)?;
        let second = direction(*at + 0.5 * step_m * first)?;
        let third = direction(*at + 0.5 * step_m * second)?;
        let fourth = direction(*at + step_m * third)?;
        let to = *at + step_m / 6.0 * (first + 2.0 * (second + third) + fourth);
        is_inside(to).then_some(to)
    };
    std::iter::successors(Some(seed), next).take(POINT_LIMIT).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::snapshot::WindFrame;
    use prairie_core::scene::WindBoundary;
    use prairie_core::terrain::KindMap;
    use prairie_core::wire::TurbulenceState;
    use prairie_core::wire::quantise::CodeSteps;
    use std::sync::Arc;

    /// Solid rotation about the vertical axis through (50, 50), at 0.1 rad/s.
    fn rotation(at: Vec3) -> Vec3 {
        0.1 * Vec3::new(-(at.z - 50.0), 0.0, at.x - 50.0)
    }

    fn radius(at: &Vec3) -> f32 {
        (at.x - 50.0).hypot(at.z - 50.0)
    }

    #[test]
    fn solid_rotation_gives_circles() {
        let line = trace(Vec3::new(60.0, 1.0, 50.0), 1.0, rotation, |_| true);
        assert_eq!(line.len(), POINT_LIMIT);
        assert!(line.iter().all(|at| (radius(at) - 10.0).abs() < 1e-3 && at.y == 1.0), "{line:?}");
        // 63 steps of 1 m are a turn of 62.83 m.
        assert!((line[63] - Vec3::new(60.0, 1.0, 50.17)).length() < 0.01, "{}", line[63]);
    }

    #[test]
    fn a_streamline_is_of_fourth_order() {
        // Error of the place after a quarter of a turn on a circle of 4 m, in 2, 4 and 8 steps.
        let error = |steps: usize| {
            let step_m = std::f32::consts::FRAC_PI_2 * 4.0 / steps as f32;
            (trace(Vec3::new(54.0, 0.0, 50.0), step_m, rotation, |_| true)[steps] - Vec3::new(50.0, 0.0, 54.0)).length()
        };
        let errors = [2, 4, 8].map(error);
        for pair in errors.windows(2) {
            let order = (pair[0] / pair[1]).log2();
            assert!((3.6..4.6).contains(&order), "order {order} of {errors:?}");
        }
    }

    #[test]
    fn a_streamline_ends_at_the_border_and_in_calm_air() {
        let east = |at: Vec3| Vec3::new(if at.x < 20.0 { 3.0 } else { 0.0 }, 0.0, 0.0);
        assert_eq!(trace(Vec3::ZERO, 1.0, east, |at| at.x <= 4.5).last(), Some(&Vec3::new(4.0, 0.0, 0.0)));
        assert!(trace(Vec3::ZERO, 1.0, east, |_| true).last().unwrap().x <= 20.0);
        assert_eq!(trace(Vec3::new(30.0, 0.0, 0.0), 1.0, east, |_| true).len(), 1);
    }

    #[test]
    fn streamlines_of_the_streamed_rotation_are_circles() {
        let mut scene = crate::scenes::load("meadow").unwrap().scene;
        scene.wind.cells = [64, 4, 64];
        scene.wind.spacing_m = [4.0, 4.0, 4.0];
        (scene.wind.faces.west, scene.wind.faces.east) = (WindBoundary::NoSlip, WindBoundary::NoSlip);
        (scene.wind.faces.north, scene.wind.faces.south) = (WindBoundary::NoSlip, WindBoundary::NoSlip);
        let steps = CodeSteps::from(&scene.stream);
        let about = |n: usize| (n as f32 + 0.5) * 4.0 - 128.0;
        let plane = |speed: &dyn Fn(usize, usize) -> f32| -> Vec<i16> {
            (0..64 * 4 * 64).map(|cell| steps.wind_code(speed(cell % 64, cell / 256))).collect()
        };
        let codes = [plane(&|_, k| -0.5 * about(k)), plane(&|_, _| 0.0), plane(&|i, _| 0.5 * about(i))].concat();
        let frame = WindFrame { tick: 1, cells: [64, 4, 64], turbulence: TurbulenceState::default(), codes };
        let mut wind = WindField::still(&scene, Arc::new(KindMap::uniform()));
        wind.set(&frame.codes, &frame.turbulence);
        let flat = HeightMap::from_heights(2, 2, [256.0, 256.0], vec![7.0; 4]);
        let lines = Streamlines::new(&scene).lines(&wind, &flat);
        assert!(lines.len() > 100, "{} lines", lines.len());
        for line in &lines {
            let radius_m = |at: &[f32; 3]| (at[0] - 128.0).hypot(at[2] - 128.0);
            let wanted_m = radius_m(&line[0]);
            // Away from the box's edges, beyond whose outermost centres the wind is constant.
            if (40.0..120.0).contains(&wanted_m) {
                assert!(line.iter().all(|at| (radius_m(at) - wanted_m).abs() < 0.3 && at[1] == 9.0), "{wanted_m} m: {line:?}");
            }
        }
    }
}
