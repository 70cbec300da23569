//! Jets: air moved by vehicles.

use glam::Vec3;
use prairie_core::body::Motion;
use prairie_vehicles::{Airflow, airflow};
use prairie_wind::Jet;

/// Speed (m/s), radius (m) and rate (1/s) of rotor downwash.
const DOWNWASH_M_PER_S: f32 = 10.0;
const DOWNWASH_RADIUS_M: f32 = 9.0;
const DOWNWASH_PER_S: f32 = 2.0;
/// Minimum speed of a vehicle with a wake (m/s), and radius (m) and rate (1/s) of the wake.
const WAKE_FROM_M_PER_S: f32 = 4.0;
const WAKE_RADIUS_M: f32 = 4.0;
const WAKE_PER_S: f32 = 1.0;

/// The jet of a vehicle above ground of elevation `ground_m`, if it has one.
pub(super) fn jet(motion: &Motion, ground_m: f32) -> Option<Jet> {
    let [x, y, z] = motion.to.position_m;
    let above_m = (y - ground_m).max(0.0);
    let velocity = Vec3::from_array(motion.velocity_m_per_s);
    match airflow(motion.kind) {
        Airflow::Downwash => {
            let down = velocity - Vec3::Y * DOWNWASH_M_PER_S;
            let below = Vec3::new(x, (above_m - 0.5 * DOWNWASH_RADIUS_M).max(0.5), z);
            Some(Jet { position_m: below, radius_m: DOWNWASH_RADIUS_M, velocity_m_per_s: down, rate_per_s: DOWNWASH_PER_S })
        }
        Airflow::Wake if velocity.length() > WAKE_FROM_M_PER_S => {
            let position_m = Vec3::new(x, above_m, z);
            Some(Jet { position_m, radius_m: WAKE_RADIUS_M, velocity_m_per_s: velocity, rate_per_s: WAKE_PER_S })
        }
        Airflow::Wake | Airflow::Negligible => None,
    }
}
