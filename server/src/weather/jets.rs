//! The air that objects move.

use crate::objects::Motion;
use crate::wind::Jet;
use glam::Vec3;
use shared::scene::VehicleKind;

/// Speed (m/s), radius (m) and rate (1/s) of the jet below a helicopter.
const DOWNWASH_M_PER_S: f32 = 10.0;
const DOWNWASH_RADIUS_M: f32 = 9.0;
const DOWNWASH_PER_S: f32 = 2.0;
/// Slowest object that drags air along (m/s), and radius (m) and rate (1/s) of that wake.
const WAKE_FROM_M_PER_S: f32 = 4.0;
const WAKE_RADIUS_M: f32 = 4.0;
const WAKE_PER_S: f32 = 1.0;

/// The wash of a helicopter or the wake of what moves fast, above ground of this height (m); a ball drags too little air along to count.
pub(super) fn jet(motion: &Motion, ground_m: f32) -> Option<Jet> {
    let [x, y, z] = motion.to.position_m;
    let above_m = (y - ground_m).max(0.0);
    let velocity = Vec3::from_array(motion.velocity_m_per_s);
    if motion.kind == VehicleKind::Helicopter {
        let down = velocity - Vec3::Y * DOWNWASH_M_PER_S;
        let below = Vec3::new(x, (above_m - 0.5 * DOWNWASH_RADIUS_M).max(0.5), z);
        return Some(Jet { position_m: below, radius_m: DOWNWASH_RADIUS_M, velocity_m_per_s: down, rate_per_sec: DOWNWASH_PER_S });
    }
    let wake = Jet { position_m: Vec3::new(x, above_m, z), radius_m: WAKE_RADIUS_M, velocity_m_per_s: velocity, rate_per_sec: WAKE_PER_S };
    (motion.kind != VehicleKind::Ball && velocity.length() > WAKE_FROM_M_PER_S).then_some(wake)
}
