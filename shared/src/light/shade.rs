//! Shade that grass casts on grass and ground: the sward as columns of leaves through which a ray to the sun is followed.
//! Twins: `inputs/sward_shade.wgsl` and `land_and_sky/shade_map.wgsl`.

use super::grass::LEAST_SUN_SINE;
use crate::plant::blade::deflection::WIND_SHAPE;
use std::f32::consts::FRAC_2_PI;

/// Height of the highest leaves relative to the mean height of the blades.
pub const LEAF_TOP: f32 = 1.27;

/// Extinction relative to that of leaves at random places: blades in tufts hide each other.
pub const LEAF_CLUMPING: f32 = 0.92;

/// Steps of a ray through the sward.
pub const SHADE_STEPS: u32 = 8;
/// Length of a step relative to the one before.
pub const SHADE_RATIO: f32 = 1.5;
/// Length of the first step relative to the whole way: (r − 1)/(r⁸ − 1) for a ratio r.
pub const SHADE_FIRST: f32 = 0.020_301_348;

/// Distances towards the sun, relative to that over which a ray from the ground rises to the highest leaves, and weights, of the places whose leaves it meets: the Gauss
/// quadrature of two points for their weight, 2 (1 − s), by [`leaf_area_above`].
pub const BARE_PLACES: [f32; 2] = [0.155_051, 0.644_949];
/// Their weights.
pub const BARE_WEIGHTS: [f32; 2] = [0.636_083, 0.363_917];

/// Lean of a blade's thirds at rest by its own weight, for a droop of 1 (rad, root mean square).
pub const RESTING_RAD: f32 = 0.45;
/// Farthest lean of a blade (rad).
pub const FLAT_RAD: f32 = 1.55;
/// Fractions of a tapered blade's area in its thirds, lowest first.
pub const THIRD_AREAS: [f32; 3] = [0.426, 0.393, 0.181];

/// Fraction of the leaf area above a height relative to the mean height of the blades. Fitted to tapered blades whose lengths vary by 35 % and from tuft to tuft; within 0.04.
pub fn leaf_area_above(height: f32) -> f32 {
    let below_top = 1.0 - height.clamp(0.0, LEAF_TOP) / LEAF_TOP;
    below_top * below_top
}

/// Mean fractions of sunlight on the upper and the lower half of what rays of the eye meet in an even sward: leaves, or the ground below. `eye_depth` is the optical depth of all leaves
/// towards the eye, `sun_depth` towards the sun.
///
/// Rays of the eye end at leaf areas u above them that are distributed as K e^(−K u), K being the eye's depth, and e^(−D u) of the sunlight reaches these, D being the sun's.
pub fn sun_on_seen(eye_depth: f32, sun_depth: f32) -> [f32; 2] {
    let both = eye_depth + sun_depth;
    let parted = (-both * (std::f32::consts::LN_2 / eye_depth).min(1.0)).exp();
    let ground = (-eye_depth).exp();
    let leaves = [1.0 - parted, parted - (-both).exp()].map(|part| part * eye_depth / both);
    let floor = [(ground - 0.5).max(0.0), ground.min(0.5)].map(|part| part * (-sun_depth).exp());
    std::array::from_fn(|half| 2.0 * (leaves[half] + floor[half]))
}

/// Height of blades relative to their length, and the optical depth towards the sun per leaf area index, where wind and bend field lean them by a vector (rad) and they droop
/// by their own weight in all directions.
///
/// The depth is the mean projection of their thirds towards the sun over its sine: at the root a strip faces any direction across its axis, at the tip the one across its lean
/// (Zhang, Fig. 8), so the projection is the mean of both cases.
pub fn stance(lean_rad: [f32; 2], droop: f32, toward_sun: [f32; 3]) -> [f32; 2] {
    let toward = above_horizon(toward_sun);
    let tilt = (lean_rad[0] * lean_rad[0] + lean_rad[1] * lean_rad[1]).sqrt();
    let flat = smoothstep(0.5, 1.3, tilt);
    let (mut height, mut projected) = (0.0, 0.0);
    for third in 0..3 {
        let fraction = (third as f32 + 1.0) / 3.0;
        let shape = WIND_SHAPE[third] + (1.0 + 0.06 * fraction - WIND_SHAPE[third]) * flat;
        let rests = RESTING_RAD * droop * fraction * (1.6 - 1.1 * flat);
        for way in [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]] {
            let lean = [lean_rad[0] * shape + rests * way[0], lean_rad[1] * shape + rests * way[1]];
            let angle = (lean[0] * lean[0] + lean[1] * lean[1]).sqrt().max(1e-6);
            let level = (lean[0] * toward[0] + lean[1] * toward[2]) / angle;
            let (sin, cos) = angle.min(FLAT_RAD).sin_cos();
            let (along, across) = (sin * level + cos * toward[1], cos * level - sin * toward[1]);
            height += cos / 12.0;
            projected += 0.125 * THIRD_AREAS[third] * (FRAC_2_PI * (1.0 - along * along).max(0.0).sqrt() + across.abs());
        }
    }
    [height, LEAF_CLUMPING * projected / toward[1]]
}

/// Direction to the sun, raised to the least elevation at which it lights grass.
fn above_horizon([x, y, z]: [f32; 3]) -> [f32; 3] {
    let sine = y.max(LEAST_SUN_SINE);
    let level = ((1.0 - sine * sine).max(0.0) / (x * x + z * z).max(1e-8)).sqrt();
    [x * level, sine, z * level]
}

/// Sward at a position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Column {
    /// Elevation of the ground (m).
    pub ground_m: f32,
    /// Mean height of the blades as they lean (m).
    pub height_m: f32,
    /// Optical depth of all leaves towards the sun.
    pub depth: f32,
}

impl Column {
    /// Optical depth of the leaves between two elevations.
    fn depth_between(&self, low_m: f32, high_m: f32) -> f32 {
        let [low, high] = [low_m, high_m].map(|y| leaf_area_above((y - self.ground_m) / self.height_m));
        self.depth * (low - high)
    }
}

/// Optical depth between a point at elevation `from_m` and the sun. `column` is the sward at a distance (m) towards the sun; nothing grows higher above the ground than `top_m`.
pub fn depth_toward_sun(column: impl Fn(f32) -> Column, from_m: f32, top_m: f32, sine_of_elevation: f32) -> f32 {
    let sine = sine_of_elevation.max(LEAST_SUN_SINE);
    let rise = sine / (1.0 - sine * sine).max(1e-4).sqrt();
    let mut step_m = SHADE_FIRST * top_m / rise;
    let (mut at_m, mut depth) = (0.0, 0.0);
    for _ in 0..SHADE_STEPS {
        let end_m = at_m + step_m;
        depth += column(0.5 * (at_m + end_m)).depth_between(from_m + at_m * rise, from_m + end_m * rise);
        (at_m, step_m) = (end_m, step_m * SHADE_RATIO);
    }
    depth
}

fn smoothstep(from: f32, to: f32, x: f32) -> f32 {
    let t = ((x - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Extinction of upright leaves that face all directions alike: 2/π · cot(elevation); a sun that shines along leaning blades passes them, one across them does not.
    #[test]
    fn upright_blades_hide_a_low_sun_and_flat_ones_any() {
        for elevation_rad in [0.3_f32, 0.8, 1.2] {
            let (sin, cos) = elevation_rad.sin_cos();
            let toward = [0.6 * cos, sin, 0.8 * cos];
            let depth = |lean_rad, droop| stance(lean_rad, droop, toward)[1] / LEAF_CLUMPING;
            let upright = FRAC_2_PI * cos / sin;
            assert!((depth([0.0, 0.0], 1e-3) - upright).abs() < 0.1 * upright, "{} instead of {upright}", depth([0.0, 0.0], 1e-3));
            let lean = 0.5 * std::f32::consts::PI - elevation_rad;
            let [along, against] = [0.9, -0.9].map(|part| depth([0.6 * part * lean, 0.8 * part * lean], 0.3));
            assert!(along < 0.5 * against, "{along} along the blades and {against} across");
        }
    }

    /// In a level sward alike everywhere the depth is that of its leaves above the point; the steps add up to the whole way.
    #[test]
    fn a_ray_through_an_even_sward_meets_the_leaves_above() {
        let even = Column { ground_m: 2.0, height_m: 0.7, depth: 3.0 };
        for sine in [0.05, 0.2, 0.7, 0.999_9] {
            for above_m in [0.0, 0.2, 0.5, 0.95] {
                let depth = depth_toward_sun(|_| even, 2.0 + above_m, 0.7 * LEAF_TOP, sine);
                let wanted = 3.0 * leaf_area_above(above_m / 0.7);
                assert!((depth - wanted).abs() < 2e-3, "{depth} instead of {wanted} at {above_m} m");
            }
        }
    }

    /// Against a sum over ten thousand rays of the eye.
    #[test]
    fn sunlight_on_seen_leaves_is_its_mean_over_the_rays_of_the_eye() {
        for (eye_depth, sun_depth) in [(0.3_f32, 0.5_f32), (0.6, 4.0), (1.3, 0.0), (1.5, 3.0), (8.0, 4.0), (25.0, 15.0)] {
            for (half, found) in sun_on_seen(eye_depth, sun_depth).into_iter().enumerate() {
                let rays = (0..5000).map(|ray| 0.5 * (half as f32 + (ray as f32 + 0.5) / 5000.0));
                let wanted = rays.map(|rank| (-sun_depth * (-(1.0 - rank).ln() / eye_depth).min(1.0)).exp()).sum::<f32>() / 5000.0;
                assert!((found - wanted).abs() < 1e-3, "{found} instead of {wanted} at {eye_depth}, {sun_depth}");
            }
        }
    }

    /// Ground before grass whose cover rises evenly, as averages over places do.
    #[test]
    fn two_places_find_the_shade_of_grass_on_bare_ground() {
        let sine = 0.4_f32;
        let column = Column { ground_m: 0.0, height_m: 0.7, depth: 3.0 };
        let reach_m = 0.7 * LEAF_TOP * (1.0 - sine * sine).sqrt() / sine;
        let cover = |m: f32| (m / reach_m).clamp(0.0, 1.0);
        let steps = depth_toward_sun(|m| Column { depth: 3.0 * cover(m), ..column }, 0.0, 0.7 * LEAF_TOP, sine);
        let places: f32 = BARE_PLACES.iter().zip(BARE_WEIGHTS).map(|(place, weight)| 3.0 * weight * cover(place * reach_m)).sum();
        assert!((places - steps).abs() < 0.03 * steps, "{places} instead of {steps}");
        assert!((places - 1.0).abs() < 1e-3 && (BARE_WEIGHTS.iter().sum::<f32>() - 1.0).abs() < 1e-6);
    }

    #[test]
    fn pressed_grass_shades_the_ground_beside_it_less_than_upright_grass() {
        let beside = |lean_rad: f32| {
            let [height, depth] = stance([0.0, lean_rad], 1.0, [0.98, 0.2, 0.0]);
            let column = Column { ground_m: 0.0, height_m: 0.8 * height, depth: 4.0 * depth };
            let bare = Column { depth: 0.0, ..column };
            depth_toward_sun(|m| if m < 0.5 { bare } else { column }, 0.0, 1.2, 0.2)
        };
        assert!(beside(1.5) < 0.05 && beside(0.0) > 1.0, "{} and {}", beside(1.5), beside(0.0));
    }
}
