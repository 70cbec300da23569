//! Pilot runs of the bend field: a car drives through the middle of the world in still air, and the grass swings out behind it.
//!
//! The reference takes four steps a tick by the sub-stepped scheme, and no bend counts as at rest. The error is the root mean square of the difference of the
//! bending angle over the cells along the way that are bent by more than 1° in either run, at eight moments. It is the same on every machine.

use crate::bend::pool::Pool;
use crate::scenes::LoadedScene;
use prairie_core::bend::Scheme;
use prairie_core::body::{BodyPose, Motion};
use prairie_core::grass::BendSimulation;
use prairie_core::scene::{Scene, VehicleKind};
use prairie_core::terrain::KindMap;
use prairie_core::wind::WindField;
use prairie_vehicles::bodies;
use std::sync::Arc;

/// Duration of a run, and of the drive at its start (s).
const SECS: f32 = 2.0;
const DRIVE_SECS: f32 = 1.5;
/// Speed of the car (m/s).
const SPEED_M_PER_S: f32 = 8.0;
/// Steps of the reference per tick.
const REFINEMENT: u32 = 4;
/// Moments at which the fields are compared.
const MOMENTS: u32 = 8;
/// Half-width and half-length of the compared strip (m), and least side of a world in which it fits.
const STRIP_M: [f32; 2] = [4.0, 8.0];
const LEAST_SIDE_M: f32 = 24.0;
/// Bend from which a cell is compared (rad).
const BENT_RAD: f32 = 0.017_453_3;

/// A drive through a scene.
pub(super) struct Drive<'a> {
    loaded: &'a LoadedScene,
    wind: WindField,
    reference: Vec<Vec<f32>>,
}

/// A run: bending angles (rad) along the way at each moment, and the steps of cells that it took.
struct Run {
    thetas_rad: Vec<Vec<f32>>,
    cell_steps: u64,
}

impl<'a> Drive<'a> {
    /// Runs the reference of a scene; `None` in a world that is too small, or where the car bends no grass.
    pub(super) fn new(loaded: &'a LoadedScene) -> Option<Self> {
        let scene = &loaded.scene;
        if scene.extent_m().iter().any(|side_m| *side_m < LEAST_SIDE_M) {
            return None;
        }
        let mut fine = scene.clone();
        (fine.bend.scheme, fine.bend.rest_theta_rad, fine.bend.rest_omega_rad_per_s) = (Scheme::Substepped, 0.0, 0.0);
        let wind = WindField::still(scene, Arc::new(KindMap::new(scene, &loaded.cover)));
        let mut drive = Self { loaded, wind, reference: Vec::new() };
        drive.reference = drive.run(&fine, REFINEMENT).thetas_rad;
        drive.reference.iter().flatten().any(|theta| *theta > BENT_RAD).then_some(drive)
    }

    /// Error of the settings of `scene` (degrees), and steps of cells per tick.
    pub(super) fn measure(&self, scene: &Scene) -> (f64, f64) {
        let Run { thetas_rad, cell_steps } = self.run(scene, 1);
        let pairs = thetas_rad.iter().flatten().zip(self.reference.iter().flatten());
        let (mut sum, mut count) = (0.0, 0.0);
        for (own, wanted) in pairs.filter(|(own, wanted)| own.max(**wanted) > BENT_RAD) {
            sum += (f64::from(*own) - f64::from(*wanted)).powi(2);
            count += 1.0;
        }
        let error_deg = f64::sqrt(sum / f64::max(count, 1.0)).to_degrees();
        (error_deg, cell_steps as f64 / f64::from((SECS * scene.tick_hz).round()))
    }

    fn run(&self, scene: &Scene, refinement: u32) -> Run {
        let LoadedScene { height, cover, drawings, .. } = self.loaded;
        let mut still = scene.clone();
        still.drawn_winds.clear();
        still.natural_wind.strength_rad_per_s2 = 0.0;
        let mut grass = BendSimulation::new(&still, Arc::new(height.clone()), cover, &bodies(&scene.objects), drawings);
        let ticks = (SECS * scene.tick_hz).round() as u32;
        let (dt_secs, steps) = (scene.dt_secs() / refinement as f32, ticks * refinement);
        let mut run = Run { thetas_rad: Vec::new(), cell_steps: 0 };
        for step in 1..=steps {
            let is_driving = step as f32 * dt_secs <= DRIVE_SECS;
            let motions: Vec<_> =
                is_driving.then(|| self.motion(scene, [step - 1, step].map(|n| n as f32 * dt_secs))).into_iter().collect();
            grass.step(dt_secs, &motions, &[], &self.wind, &Pool);
            run.cell_steps += grass.report().cell_steps;
            if step.is_multiple_of(refinement) && (step / refinement).is_multiple_of((ticks / MOMENTS).max(1)) {
                run.thetas_rad.push(self.thetas(scene, &grass));
            }
        }
        run
    }

    /// The car between two times (s).
    fn motion(&self, scene: &Scene, secs: [f32; 2]) -> Motion {
        let [width_m, depth_m] = scene.extent_m();
        let half_m = scene.objects.half_extents_m(VehicleKind::Car);
        let pose = |secs: f32| {
            let (x, z) = (0.5 * width_m, 0.5 * (depth_m + SPEED_M_PER_S * DRIVE_SECS) - SPEED_M_PER_S * secs);
            BodyPose { position_m: [x, self.loaded.height.height_m(x, z) + half_m[1], z], rotation: [0.0, 0.0, 0.0, 1.0] }
        };
        let [from, to] = secs.map(pose);
        Motion { kind: VehicleKind::Car, from, to, velocity_m_per_s: [0.0, 0.0, -SPEED_M_PER_S], part_rad: 0.0, is_at_rest: false }
    }

    fn thetas(&self, scene: &Scene, grass: &BendSimulation) -> Vec<f32> {
        let (cell_m, [width_m, depth_m]) = (scene.patches.cell_m, scene.extent_m());
        let along = |middle_m: f32, half_m: f32| {
            let count = (2.0 * half_m / cell_m) as u32;
            (0..count).map(move |n| middle_m - half_m + (n as f32 + 0.5) * cell_m)
        };
        let rows = along(0.5 * depth_m, STRIP_M[1]);
        rows.flat_map(|z| along(0.5 * width_m, STRIP_M[0]).map(move |x| grass.field().bend_at(x, z).theta)).collect()
    }
}

/// Time of a step of a cell by a scheme (ns), in the scene `blades`.
pub(super) fn ns_per_cell_step(scheme: Scheme) -> f64 {
    let mut loaded = crate::scenes::load("blades").expect("a built-in scene");
    loaded.scene.bend.scheme = scheme;
    let drive = Drive {
        wind: WindField::still(&loaded.scene, Arc::new(KindMap::new(&loaded.scene, &loaded.cover))),
        loaded: &loaded,
        reference: Vec::new(),
    };
    let time = |_| {
        let start = std::time::Instant::now();
        let run = drive.run(&loaded.scene, 1);
        start.elapsed().as_secs_f64() * 1e9 / run.cell_steps.max(1) as f64
    };
    (0..3).map(time).fold(f64::INFINITY, f64::min)
}
