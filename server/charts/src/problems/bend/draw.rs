//! Random grass and objects from the ranges of Chen & Johan.

use std::f32::consts::TAU;

use prairie_core::bend::{Field, GroundContact, Kinds, Rest, Scheme, Serial, WaveParams};
use prairie_core::grid::PatchLayout;

use super::Striker;
use crate::random_winds::Random;

/// Number of steps with objects; afterwards they are gone.
pub(super) const STRIKING_STEPS: u32 = 150;
/// Number of steps of a run.
pub(super) const STEPS: u32 = 600;
/// Half of the world's side (m).
const HALF_M: f32 = 12.0 * 0.4572;

/// A random draw: grass, objects and time step.
#[derive(Clone, Debug)]
pub struct Draw {
    /// c₀ and c_ω 1–10 m/s, μ 0–1.5 m/rad, λ 0.01–1 in a step of a 60th of a second, as a rate; no stiffness.
    pub waves: WaveParams,
    /// 1/120 to 1/20 s.
    pub dt_secs: f32,
    /// One or two objects of up to 60 m/s, which bounce to and fro in a field of 24 × 24 cells.
    pub objects: Vec<Striker>,
}

/// Result of a run.
#[derive(Clone, Copy, Debug)]
pub struct Course {
    /// Largest |θ| at any time (rad).
    pub theta_max_rad: f32,
    /// Sum of θ² when the objects have gone, its largest value since, and its value at the end (rad²).
    pub squares: [f64; 3],
    /// Patches reset because a value was NaN or infinite.
    pub reset_patches: u32,
    /// Sub-steps taken.
    pub substeps: u32,
}

impl Draw {
    /// The draw with this number.
    pub fn new(number: u64) -> Self {
        let mut random = Random::new(number);
        let mut between = |low: f64, high: f64| random.between(low, high) as f32;
        let rate = |fraction: f32| -60.0 * (1.0 - fraction).ln();
        let waves = WaveParams {
            c0_m_per_s: between(1.0, 10.0),
            mu_m_per_rad: between(0.0, 1.5),
            c_omega_m_per_s: between(1.0, 10.0),
            theta_damping_per_s: rate(between(0.01, 0.9999)),
            omega_damping_per_s: rate(between(0.01, 0.9999)),
            stiffness_per_s2: 0.0,
        };
        let (dt_secs, speed, strike_height_m) = (1.0 / between(20.0, 120.0), between(0.0, 60.0), between(0.2, 0.5));
        let mut object = || {
            let (sin, cos) = between(0.0, TAU.into()).sin_cos();
            Striker {
                at_m: [0; 2].map(|_| between(-5.0, 5.0)),
                velocity_m_per_s: [speed * cos, speed * sin],
                radius_m: between(0.4, 1.2),
                strike_height_m,
            }
        };
        let mut objects = vec![object(), object()];
        objects.truncate(1 + number as usize % 2);
        Self { waves, dt_secs, objects }
    }

    /// The draw with stiff grass: κ of 0.1 to 1000 /s², also with little damping, so that |ω| oscillates.
    pub fn stiff(number: u64) -> Self {
        let mut draw = Self::new(number);
        let mut random = Random::new(!number);
        draw.waves.stiffness_per_s2 = random.scale(0.1, 1000.0) as f32;
        if random.one_in(3) {
            (draw.waves.theta_damping_per_s, draw.waves.omega_damping_per_s) = (0.3, 0.3);
        }
        draw
    }

    /// Runs the draw on one patch or on nine; the bits are the same.
    ///
    /// # Panics
    /// When the scheme rejects the step.
    pub fn run(&self, scheme: Scheme, ground_contact: GroundContact, rest: Rest, patches: u32) -> Course {
        let layout = PatchLayout { count: [patches; 2], cells: 24 / patches, cell_m: 0.4572 };
        let mut field = Field::new(layout, Kinds::one(self.waves)).with_rest(rest).with_ground_contact(ground_contact);
        if scheme == Scheme::Implicit {
            field.wake_all();
        }
        let mut objects = self.objects.clone();
        let mut course = Course { theta_max_rad: 0.0, squares: [0.0; 3], reset_patches: 0, substeps: 0 };
        for step in 0..STEPS {
            if step < STRIKING_STEPS {
                objects.iter_mut().for_each(|object| {
                    *object = moved(*object, self.dt_secs);
                    object.press(&mut field, self.dt_secs);
                });
            }
            let report = field.step(scheme, self.dt_secs, &Serial).expect("the step is of some length and can be divided");
            course.reset_patches += report.reset_patches;
            course.substeps += report.substeps;
            course.theta_max_rad = field.awake().map(|patch| patch.theta_max_rad()).fold(course.theta_max_rad, f32::max);
            if step >= STRIKING_STEPS && (step.is_multiple_of(10) || step == STEPS - 1) {
                let rows = field.awake().flat_map(|patch| patch.rows());
                let squares: f64 = rows.flat_map(|[theta, ..]| theta).map(|theta| f64::from(*theta).powi(2)).sum();
                if step == STRIKING_STEPS {
                    course.squares[0] = squares;
                }
                course.squares[1] = course.squares[1].max(squares);
                course.squares[2] = squares;
            }
        }
        course
    }
}

/// An object a step later, turned back at the edges of the world.
fn moved(object: Striker, dt_secs: f32) -> Striker {
    let Striker { mut at_m, mut velocity_m_per_s, .. } = object;
    for (at, velocity) in at_m.iter_mut().zip(&mut velocity_m_per_s) {
        *at += *velocity * dt_secs;
        if at.abs() > HALF_M {
            *velocity = -velocity.abs() * at.signum();
            *at = at.clamp(-HALF_M, HALF_M);
        }
    }
    Striker { at_m, velocity_m_per_s, ..object }
}
