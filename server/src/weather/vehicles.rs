//! Vehicles in the wind: bodies that the air flows round, and rotors.

use glam::{Quat, Vec3};
use prairie_core::body::Motion;
use prairie_core::scene::{Objects, Scene, WindMethod};
use prairie_vehicles::{Airflow, airflow};
use prairie_wind::{Body, Jet};

/// Speed (m/s), radius (m) and rate (1/s) of rotor downwash.
const DOWNWASH_M_PER_S: f32 = 10.0;
const DOWNWASH_RADIUS_M: f32 = 9.0;
const DOWNWASH_PER_S: f32 = 2.0;
/// Minimum speed of a vehicle with a wake (m/s), and radius (m) and rate (1/s) of the wake, for the method without bodies.
const WAKE_FROM_M_PER_S: f32 = 4.0;
const WAKE_RADIUS_M: f32 = 4.0;
const WAKE_PER_S: f32 = 1.0;

/// Drag coefficient of a vehicle: between that of a road car, 0.3, and that of a box, 1.
const DRAG_COEFFICIENT: f64 = 0.6;

/// Vehicles of a scene, as its wind meets them.
pub(super) struct Vehicles {
    objects: Objects,
    /// Whether the solver has bodies.
    has_bodies: bool,
}

impl Vehicles {
    pub(super) fn new(scene: &Scene) -> Self {
        Self { objects: scene.objects.clone(), has_bodies: scene.wind.method == WindMethod::Staggered }
    }

    /// The body of a vehicle with a velocity in the box, above ground of elevation `ground_m`, if it drags air along.
    pub(super) fn body(&self, motion: &Motion, ground_m: f32) -> Option<Body> {
        if !self.has_bodies || airflow(motion.kind) != Airflow::Wake {
            return None;
        }
        let [x, y, z] = motion.to.position_m;
        let turn = Quat::from_array(motion.to.rotation);
        let body = Body {
            centre_m: [x, (y - ground_m).max(0.0), z].map(f64::from),
            half_extents_m: self.objects.half_extents_m(motion.kind).map(f64::from),
            axes: [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| (turn * axis).to_array().map(f64::from)),
            velocity_m_per_s: motion.velocity_m_per_s.map(f64::from),
            drag_coefficient: DRAG_COEFFICIENT,
        };
        Some(body).filter(Body::is_valid)
    }

    /// The jet of a vehicle with a velocity in the box, above ground of elevation `ground_m`, if it has one: that of a rotor, and without bodies that of a wake.
    pub(super) fn jet(&self, motion: &Motion, ground_m: f32) -> Option<Jet> {
        let [x, y, z] = motion.to.position_m;
        let above_m = (y - ground_m).max(0.0);
        let velocity = Vec3::from_array(motion.velocity_m_per_s);
        match airflow(motion.kind) {
            Airflow::Downwash => {
                let down = velocity - Vec3::Y * DOWNWASH_M_PER_S;
                let below = Vec3::new(x, (above_m - 0.5 * DOWNWASH_RADIUS_M).max(0.5), z);
                Some(Jet { position_m: below, radius_m: DOWNWASH_RADIUS_M, velocity_m_per_s: down, rate_per_s: DOWNWASH_PER_S })
            }
            Airflow::Wake if !self.has_bodies && velocity.length() > WAKE_FROM_M_PER_S => {
                let position_m = Vec3::new(x, above_m, z);
                Some(Jet { position_m, radius_m: WAKE_RADIUS_M, velocity_m_per_s: velocity, rate_per_s: WAKE_PER_S })
            }
            Airflow::Wake | Airflow::Negligible => None,
        }
    }
}
