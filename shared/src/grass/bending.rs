//! How pushed grass bends (Chen & Johan): direction (Eqs. 10–11), bending speed (Eq. 12), bend (Eq. 1), terrain limit (§4.3).

use super::footprint::Edge;
use super::vector::unit;
use std::f32::consts::FRAC_PI_2;

/// Minimum bending speed of pressed grass (rad/s). ω also stores the direction of the bend, so it stays above zero when the motion ends.
pub(super) const HELD_RAD_PER_S: f32 = 0.5;
/// Sine of the largest angle (10°) at which a side faces backward and still counts as parallel to the motion. The sides of the swept area are
/// parallel to the motion even when the object slips.
const SLIP: f32 = 0.174;

/// Largest bend (rad) of grass that leans along the unit vector `direction` on terrain of slope (∂h/∂x, ∂h/∂z): the largest bend on flat terrain
/// less the inclination of the terrain ahead, at most a right angle (Chen & Johan, §4.3).
pub fn terrain_limit_rad(theta_max_rad: f32, slope: [f32; 2], direction: [f32; 2]) -> f32 {
    let rise = slope[0] * direction[0] + slope[1] * direction[1];
    (theta_max_rad - libm::atanf(rise)).clamp(0.0, FRAC_PI_2)
}

/// Bending speed (rad/s) of grass at bend `theta_rad` that an object pushes at `speed_m_per_s` along the bend, at height `height_m`:
/// `s·cos²θ / h` (Chen & Johan, Eq. 12).
pub fn bending_speed_rad_per_s(speed_m_per_s: f32, theta_rad: f32, height_m: f32) -> f32 {
    let cos = libm::cosf(theta_rad);
    speed_m_per_s * cos * cos / height_m
}

/// Bend (rad) after `secs` in contact of grass that starts at `theta_rad`, below a right angle. Integrates Eq. (1) with the speed of Eq. (12)
/// exactly, `tan θ = tan θ₀ + s·t/h`, so the result does not depend on the number of steps.
pub fn bend_after_rad(theta_rad: f32, speed_m_per_s: f32, height_m: f32, secs: f32) -> f32 {
    libm::atanf(libm::tanf(theta_rad) + speed_m_per_s * secs / height_m)
}

/// Bending direction (Chen & Johan, Eqs. 10–11): the unit vector of motion `moves`, plus the outward normal of a side that is within `rim_m` and does
/// not face backward. Among several sides, the one most nearly parallel to the motion counts: in Fig. 7 the front corners bend grass to the sides.
pub fn direction(moves: [f32; 2], at_m: [f32; 2], sides: &[Edge], rim_m: f32) -> [f32; 2] {
    let ahead = |side: &Edge| side.normal[0] * moves[0] + side.normal[1] * moves[1];
    let near = sides.iter().filter(|side| side.depth_m(at_m) < rim_m && ahead(side) >= -SLIP);
    match near.min_by(|a, b| ahead(a).abs().total_cmp(&ahead(b).abs())) {
        Some(Edge { normal: [x, z], .. }) => unit([x + moves[0], z + moves[1]]).unwrap_or(moves),
        None => moves,
    }
}
