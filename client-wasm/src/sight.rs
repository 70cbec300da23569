//! Line of sight to a vehicle: the chase camera stays above the land, and out of the crowns of trees and the models of the scene's own.

use crate::render::solids::trees_and_stones::{PlacedKind, PlacedModel, crown, placed_models};
use crate::state::DecodedScene;
use glam::{Quat, Vec3};
use std::collections::HashMap;

/// Half axes of the ellipsoid of a model, relative to those of its box: its corners reach out of it, and fade in the picture.
const BOX_REACH: f32 = 1.2;

/// Side of the squares by which crowns and models are found (m); none has an effect farther from its centre.
const SQUARE_M: f32 = 40.0;

/// Reach of leaves beyond the shape of a crown, sideways and up and down, relative to the height of the tree.
const LEAF_REACH: [f32; 2] = [0.15, 0.06];
/// Clearance around leaves (m), for their sway.
const CLEARANCE_M: f32 = 0.2;

/// Distance from a crown, relative to its radius, within which the camera already begins to draw nearer, so that it does not jump.
const SOFT_FRACTION: f32 = 0.35;
/// Distance from the middle of a crown, relative to its radius, from which on it counts for a vehicle inside it.
const DEEP_FRACTION: f32 = 0.6;
/// Part of the way, from its beginning, in which a crown that is nearest to it counts less.
const BESIDE_FRACTION: f32 = 0.3;

/// Samples of the land along a line of sight.
const LAND_SAMPLES: u32 = 12;

/// Crown of a tree, or a model: an ellipsoid with vertical axis.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Ellipsoid {
    centre_m: Vec3,
    half_m: Vec3,
    /// Turn from its own axes to those of the world.
    turn: Quat,
}

impl Ellipsoid {
    fn of(placed: &PlacedModel, decoded: &DecodedScene) -> Option<Self> {
        match placed.kind {
            PlacedKind::Tree => Some(Self::of_crown(placed)),
            PlacedKind::Stone => None,
            PlacedKind::Own => {
                let (scale, turn, centre_m) = placed.world_from_model.to_scale_rotation_translation();
                let half_m = 0.5 * BOX_REACH * scale * Vec3::from_array(decoded.scene().models[placed.shape as usize].size_m);
                Some(Self { centre_m, half_m: half_m + CLEARANCE_M, turn })
            }
        }
    }

    fn of_crown(tree: &PlacedModel) -> Self {
        let crown = crown(tree.shape);
        let tall_m = tree.world_from_model.y_axis.length();
        let centre_m = tree.position_m + Vec3::Y * (0.5 * (crown.low + crown.high) * tall_m);
        let half = Vec3::new(crown.wide, 0.5 * (crown.high - crown.low), crown.wide);
        let [aside, upright] = LEAF_REACH;
        let half_m = (half + Vec3::new(aside, upright, aside)) * Vec3::new(tree.size_m, tall_m, tree.size_m);
        Self { centre_m, half_m: half_m + CLEARANCE_M, turn: Quat::IDENTITY }
    }

    /// Distance from the centre relative to that of the surface: below 1 inside.
    fn radius(&self, at_m: Vec3) -> f32 {
        self.relative(at_m).length()
    }

    /// A position (m) relative to the half axes.
    fn relative(&self, at_m: Vec3) -> Vec3 {
        (self.turn.conjugate() * (at_m - self.centre_m)) / self.half_m
    }

    /// Fraction of the way from `from_m` to `to_m` that is free. It changes smoothly as a crown approaches the line, and is whole where the way begins deep
    /// in a crown, or leads away from it.
    fn clear_fraction(&self, from_m: Vec3, to_m: Vec3) -> f32 {
        let [from, to] = [from_m, to_m].map(|m| self.relative(m));
        let way = to - from;
        let (length2, along) = (way.length_squared(), -from.dot(way));
        if length2 == 0.0 {
            return 1.0;
        }
        let nearest = (along / length2).clamp(0.0, 1.0);
        let apart = smoothstep(1.0, 1.0 + SOFT_FRACTION, (from + nearest * way).length());
        let root2 = along * along - length2 * (from.length_squared() - 1.0);
        let end = if root2 > 0.0 { ((along - root2.sqrt()) / length2).clamp(0.0, 1.0) } else { nearest };
        let counts = (1.0 - apart) * smoothstep(0.0, BESIDE_FRACTION, nearest) * smoothstep(DEEP_FRACTION, 1.0, from.length());
        1.0 - counts * (1.0 - end)
    }
}

/// Smooth step from 0 at `low` to 1 at `high`.
fn smoothstep(low: f32, high: f32, value: f32) -> f32 {
    let fraction = ((value - low) / (high - low)).clamp(0.0, 1.0);
    fraction * fraction * (3.0 - 2.0 * fraction)
}

/// The crowns of a scene's trees, and its own models.
#[derive(Clone, Debug, Default)]
pub struct Sight {
    /// Ellipsoids by the square that contains their centre.
    squares: HashMap<[i32; 2], Vec<Ellipsoid>>,
}

impl Sight {
    /// The crowns of all trees of a scene, and its own models.
    pub fn new(decoded: &DecodedScene) -> Self {
        let mut squares: HashMap<_, Vec<_>> = HashMap::new();
        for placed in placed_models(decoded) {
            if let Some(ellipsoid) = Ellipsoid::of(&placed, decoded) {
                squares.entry(square(placed.position_m)).or_default().push(ellipsoid);
            }
        }
        Self { squares }
    }

    /// Fraction of the way from `from_m` to `to_m` (m) up to the first crown or model, 0 to 1. It counts less the deeper `from_m` is inside it.
    pub fn clear_fraction(&self, from_m: Vec3, to_m: Vec3) -> f32 {
        self.near(from_m, to_m).map(|crown| crown.clear_fraction(from_m, to_m)).fold(1.0, f32::min)
    }

    /// Whether a position (m) is among leaves or in a model.
    pub fn is_in_crown(&self, at_m: Vec3) -> bool {
        self.near(at_m, at_m).any(|crown| crown.radius(at_m) < 1.0)
    }

    fn near(&self, from_m: Vec3, to_m: Vec3) -> impl Iterator<Item = &Ellipsoid> {
        let [low, high] = [from_m.min(to_m) - SQUARE_M, from_m.max(to_m) + SQUARE_M].map(square);
        let numbers = (low[0]..=high[0]).flat_map(move |x| (low[1]..=high[1]).map(move |z| [x, z]));
        numbers.filter_map(|number| self.squares.get(&number)).flatten()
    }
}

/// Number of the square that contains a position (m).
fn square(at_m: Vec3) -> [i32; 2] {
    [at_m.x, at_m.z].map(|m| (m / SQUARE_M).floor() as i32)
}

/// `eye_m`, raised until the line from `target_m` to it, and itself by `clearance_m`, is above the land. `ground_m` is the elevation at (x, z).
pub fn above_land(target_m: Vec3, eye_m: Vec3, clearance_m: f32, ground_m: impl Fn(f32, f32) -> f32) -> Vec3 {
    let short_m = |sample: u32| {
        let fraction = sample as f32 / LAND_SAMPLES as f32;
        let at_m = target_m.lerp(eye_m, fraction);
        (ground_m(at_m.x, at_m.z) + clearance_m * fraction - at_m.y) / fraction
    };
    eye_m + Vec3::Y * (1..=LAND_SAMPLES).map(short_m).fold(0.0, f32::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    const CROWN: Ellipsoid = Ellipsoid { centre_m: Vec3::new(10.0, 5.0, 0.0), half_m: Vec3::new(4.0, 3.0, 4.0), turn: Quat::IDENTITY };

    #[test]
    fn a_way_ends_at_the_surface_of_a_crown() {
        let (from, to) = (Vec3::new(0.0, 5.0, 0.0), Vec3::new(20.0, 5.0, 0.0));
        assert!((CROWN.clear_fraction(from, to) - 0.3).abs() < 1e-6);
        assert!((CROWN.clear_fraction(from, CROWN.centre_m) - 0.6).abs() < 1e-6, "into it");
        assert_eq!(CROWN.clear_fraction(from, Vec3::new(4.0, 5.0, 0.0)), 1.0, "before it");
        assert_eq!(CROWN.clear_fraction(Vec3::new(5.9, 5.0, 0.0), from), 1.0, "away from it");
        assert_eq!(CROWN.clear_fraction(CROWN.centre_m, to), 1.0, "from inside");
        assert_eq!(CROWN.clear_fraction(from, from), 1.0, "no way");
    }

    #[test]
    fn the_free_fraction_changes_smoothly_as_a_crown_passes() {
        // A vehicle and its camera, 8 m behind and above, pass by the crown or below it, along and across, at 2 cm a step.
        for (aside_m, low_m) in [(0.0, 1.0), (0.0, 2.5), (1.5, 2.5), (3.0, 2.0), (4.2, 3.0)] {
            for behind in [Vec3::new(-8.0, 2.6, 0.0), Vec3::new(5.0, 2.6, 6.0), Vec3::new(0.0, 2.6, -8.0)] {
                let fraction = |step: i32| {
                    let from = Vec3::new(-8.0 + 0.02 * step as f32, low_m, aside_m);
                    CROWN.clear_fraction(from, from + behind)
                };
                let fractions: Vec<f32> = (0..1800).map(fraction).collect();
                let largest = fractions.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f32::max);
                assert!(largest < 0.05, "a jump of {largest} at {aside_m} m, {low_m} m, {behind}");
            }
        }
    }

    #[test]
    fn the_eye_is_raised_above_a_crest() {
        let hill = |x: f32, _: f32| 3.0 * (-(x - 5.0) * (x - 5.0)).exp();
        let (target, eye) = (Vec3::new(0.0, 1.0, 0.0), Vec3::new(10.0, 2.0, 0.0));
        let raised = above_land(target, eye, 0.4, hill);
        let lowest_m = |eye: Vec3| {
            let above = |n: i32| {
                let at = target.lerp(eye, n as f32 / 200.0);
                at.y - hill(at.x, at.z)
            };
            (0..=200).map(above).fold(f32::INFINITY, f32::min)
        };
        assert!(lowest_m(raised) > 0.1 && lowest_m(eye) < -1.0, "{} and {}", lowest_m(raised), lowest_m(eye));
        assert_eq!(above_land(target, eye, 0.4, |_, _| 0.0), eye, "over flat land");
    }
}
