//! The pattern of the natural wind's gusts: Perlin noise that travels with the drift and repeats.

use crate::scene::{NaturalWind, Scene};
use noise::core::perlin::perlin_3d;
use noise::permutationtable::{NoiseHasher, PermutationTable};

/// Gusts along X and Z after which the pattern repeats.
pub(super) const PERIOD_GUSTS: u32 = 8;
/// Rate at which gusts change while they travel (1/s).
const CHANGE_PER_S: f64 = 0.15;
/// Changes after which they begin again: the size of the table of the noise.
const CHANGE_PERIOD: f64 = 256.0;

/// Corners of a lattice that repeats along its first two axes.
struct RepeatingCorners(PermutationTable);

impl NoiseHasher for RepeatingCorners {
    fn hash(&self, corner: &[isize]) -> usize {
        let &[x, z, time] = corner else { return self.0.hash(corner) };
        self.0.hash(&[x.rem_euclid(PERIOD_GUSTS as isize), z.rem_euclid(PERIOD_GUSTS as isize), time])
    }
}

/// Gusts of Perlin noise that travel over the terrain.
pub(super) struct GustPattern {
    corners: RepeatingCorners,
    settings: NaturalWind,
    along: [f32; 2],
}

impl GustPattern {
    /// The gusts of a scene, if their strength is not zero.
    pub(super) fn new(scene: &Scene) -> Option<Self> {
        let settings = scene.natural_wind;
        let [x, z] = settings.drift_m_per_s;
        let speed = (x * x + z * z).sqrt();
        let along = if speed > 0.0 { [x / speed, z / speed] } else { [1.0, 0.0] };
        let corners = RepeatingCorners(PermutationTable::new(scene.seed as u32));
        (settings.strength_rad_per_s2 > 0.0).then_some(Self { corners, settings, along })
    }

    /// Unit vector along which the grass is pushed.
    pub(super) fn along(&self) -> [f32; 2] {
        self.along
    }

    /// Distance along X and Z after which the pattern repeats (m).
    pub(super) fn period_m(&self) -> f32 {
        PERIOD_GUSTS as f32 * self.settings.scale_m
    }

    /// Acceleration of the grass (rad/s²) by gusts, at a place (m) and a simulated time.
    pub(super) fn acceleration_rad_per_s2(&self, at_m: [f32; 2], time_secs: f64) -> f32 {
        let NaturalWind { strength_rad_per_s2, scale_m, drift_m_per_s, .. } = self.settings;
        // Within the period, so that corners have small numbers at any time.
        let place = |axis: usize| (f64::from(at_m[axis]) - f64::from(drift_m_per_s[axis]) * time_secs) / f64::from(scale_m);
        let [x, z] = [0, 1].map(|axis| place(axis).rem_euclid(PERIOD_GUSTS.into()));
        let change = (time_secs * CHANGE_PER_S).rem_euclid(CHANGE_PERIOD);
        strength_rad_per_s2 * (perlin_3d([x, z, change].into(), &self.corners) as f32).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::TerrainMaps;

    #[test]
    fn gusts_repeat_after_the_period_and_not_before() {
        let terrain = TerrainMaps { height_map: String::new(), covering_map: String::new(), pixel_m: [1.0; 2], level_m: 0.1, base_m: 0.0 };
        // Powers of two, so that sums of places are exact.
        let natural_wind = NaturalWind { strength_rad_per_s2: 2.0, scale_m: 16.0, drift_m_per_s: [4.0, 1.5], ..NaturalWind::default() };
        let pattern = GustPattern::new(&Scene { natural_wind, seed: 3, ..Scene::new(terrain) }).expect("gusts");
        assert_eq!(pattern.period_m(), 128.0);
        let places = || (0..40).flat_map(|i| (0..40).map(move |j| [-50.0 + 7.25 * i as f32, 3.5 * j as f32]));
        let difference = |shift_m: [f32; 2]| {
            let at = |[x, z]: [f32; 2]| pattern.acceleration_rad_per_s2([x, z], 17.5);
            places().map(|[x, z]| (at([x, z]) - at([x + shift_m[0], z + shift_m[1]])).abs()).fold(0.0, f32::max)
        };
        for shift_m in [[128.0, 0.0], [0.0, -128.0], [256.0, 128.0]] {
            assert!(difference(shift_m) < 1e-5, "{shift_m:?}: {}", difference(shift_m));
        }
        for shift_m in [[64.0, 0.0], [0.0, 64.0], [16.0, 0.0]] {
            assert!(difference(shift_m) > 0.5, "{shift_m:?}");
        }
        // Gusts that stand still change in the same way again.
        let [early, late] = [0.0, 256.0 / CHANGE_PER_S].map(|secs| {
            let settings = NaturalWind { drift_m_per_s: [0.0; 2], ..natural_wind };
            let standing = GustPattern { settings, corners: RepeatingCorners(PermutationTable::new(3)), along: [1.0, 0.0] };
            places().map(|at_m| standing.acceleration_rad_per_s2(at_m, 17.5 + secs)).collect::<Vec<_>>()
        });
        assert!(early.iter().zip(&late).all(|(a, b)| (a - b).abs() < 1e-4), "changes begin again after 256");
        assert!(pattern.acceleration_rad_per_s2([1.0, 2.0], 1e18).is_finite());
    }
}
