//! How grass gives way to what touches it: direction (001 Eqs 10–11), speed (Eq. 12), bend (Eq. 1), and the terrain's limit.

use super::footprint::Edge;
use super::sward::{Pressed, Sward};
use super::swath::Swath;
use shared::bend::Bend;
use std::f32::consts::FRAC_PI_2;

/// Slower than this an object counts as standing (m/s).
pub const STANDING_M_PER_S: f32 = 0.05;
/// Speed at which grass gives way below the weight of a standing object (m/s).
const SETTLING_M_PER_S: f32 = 0.3;
/// Least bending speed of pressed grass (rad/s): its direction is that of the bend, and must outlast the motion.
pub(super) const HELD_RAD_PER_S: f32 = 0.5;
/// A side whose normal looks back by less than this (10°, as a sine) counts as one along the motion: the area that is swept has its
/// sides along the motion, however the object slips.
const SLIP: f32 = 0.174;

/// What touches the grass.
pub struct Contact {
    /// Area that is touched, and for how long.
    pub swath: Swath,
    /// Height above the ground at which it strikes (m), h of Eq. (12).
    pub strike_height_m: f32,
    /// Bend at which the grass slips below it (rad).
    pub slips_rad: f32,
    /// Whether it parts the grass sideways (Eq. 10).
    pub parts_grass: bool,
    /// Share of the bend that stays for a while, 0..=1.
    pub lays_share: f32,
    /// Whether it lies still: what it presses is laid, whole, and its patches may sleep.
    pub rests: bool,
}

/// Largest bend (rad) of grass that leans along the unit vector `direction` on land of slope (∂h/∂x, ∂h/∂z): the bend of flat land
/// less the rise of the land ahead, at most a right angle (001 §4.3).
pub fn terrain_limit_rad(theta_max_rad: f32, slope: [f32; 2], direction: [f32; 2]) -> f32 {
    let rise = slope[0] * direction[0] + slope[1] * direction[1];
    (theta_max_rad - rise.atan()).clamp(0.0, FRAC_PI_2)
}

/// Bending speed (rad/s) of grass at bend `theta_rad` that an object pushes at `speed_m_per_s` along the bend, at height `height_m`:
/// `s·cos²θ / h` (001 Eq. 12).
pub fn bending_speed_rad_per_s(speed_m_per_s: f32, theta_rad: f32, height_m: f32) -> f32 {
    let cos = theta_rad.cos();
    speed_m_per_s * cos * cos / height_m
}

/// Bend (rad) of grass at `theta_rad`, below a right angle, after `secs` in contact: Eq. (1) with the speed of Eq. (12), integrated
/// exactly, `tan θ = tan θ₀ + s·t/h`. So it does not matter into how many steps the contact is cut.
pub fn bend_after_rad(theta_rad: f32, speed_m_per_s: f32, height_m: f32, secs: f32) -> f32 {
    (theta_rad.tan() + speed_m_per_s * secs / height_m).atan()
}

/// Bending direction (001 Eqs 10–11): the moving vector `moves` (unit), plus, within `rim_m` of a side that does not face backward, the
/// side's outward normal. Near several, the one most along the motion counts: in Fig. 7 the corners in front bend to the sides.
pub fn direction(moves: [f32; 2], at_m: [f32; 2], sides: &[Edge], rim_m: f32) -> [f32; 2] {
    let ahead = |side: &Edge| side.normal[0] * moves[0] + side.normal[1] * moves[1];
    let near = sides.iter().filter(|side| side.depth_m(at_m) < rim_m && ahead(side) >= -SLIP);
    match near.min_by(|a, b| ahead(a).abs().total_cmp(&ahead(b).abs())) {
        Some(Edge { normal: [x, z], .. }) => unit([x + moves[0], z + moves[1]]).unwrap_or(moves),
        None => moves,
    }
}

/// Presses the grass of awake patches, or lays that below what rests, for a step of `dt_secs`. Returns the largest bending speed (rad/s).
pub fn press(sward: &mut Sward, contact: &Contact, dt_secs: f32) -> f32 {
    let rim_m = sward.field.layout().cell_m;
    let mut largest = 0.0_f32;
    for leg in contact.swath.legs() {
        let (rims, middle) = (if contact.parts_grass { leg.rims() } else { &[] }, leg.middle_m());
        let leg_secs = leg.share * dt_secs;
        sward.for_each_cell(&leg.cover(), contact.rests, |at_m, bend, limit_rad| {
            let passage = leg.passage(at_m)?;
            let velocity = passage.moves_m.map(|m| m / leg_secs);
            let moves = if length(velocity) > STANDING_M_PER_S { unit(velocity) } else { None };
            let direction = match moves {
                Some(moves) => leg.turned_out(direction(leg.turned_in(moves), passage.local_m, rims, rim_m)),
                None => unit(bend.omega).unwrap_or_else(|| {
                    let out = [passage.local_m[0] - middle[0], passage.local_m[1] - middle[1]];
                    unit(out).map_or([1.0, 0.0], |out| leg.turned_out(out))
                }),
            };
            let along = (velocity[0] * direction[0] + velocity[1] * direction[1]).max(SETTLING_M_PER_S);
            let terrain_rad = limit_rad(direction);
            let limit = terrain_rad.min(contact.slips_rad);
            let theta = if bend.theta >= limit {
                bend.theta.min(terrain_rad)
            } else if contact.rests {
                limit
            } else {
                limit.min(bend_after_rad(bend.theta, along, contact.strike_height_m, passage.share * leg_secs))
            };
            let held = bending_speed_rad_per_s(along, theta, contact.strike_height_m).max(HELD_RAD_PER_S);
            largest = largest.max(held);
            Some(Pressed { bend: Bend { theta, omega: direction.map(|d| d * held) }, lays_share: contact.lays_share })
        });
    }
    largest
}

pub(crate) fn length([x, z]: [f32; 2]) -> f32 {
    (x * x + z * z).sqrt()
}

/// The vector at length 1, unless it is too short to have a direction.
pub(super) fn unit(v: [f32; 2]) -> Option<[f32; 2]> {
    let length = length(v);
    (length > 1e-6).then(|| v.map(|c| c / length))
}
