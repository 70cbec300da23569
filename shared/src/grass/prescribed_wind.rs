//! Prescribed wind, which presses grass like an object (Chen & Johan, §5.3, first approach): rotor downwash, cyclones, hand-drawn winds.

use super::bending::{HELD_RAD_PER_S, bend_after_rad, bending_speed_rad_per_s};
use super::footprint::Footprint;
use super::stroke::{Pressed, Stroke};
use super::vector::{length, unit};
use super::wind_drawing::{WindDrawing, WindDrawings};
use crate::bend::Bend;
use crate::body::Motion;
use crate::grid::PatchLayout;
use crate::scene::{DrawnWind, Objects, Scene, WindShape};
use crate::terrain::HeightMap;
use std::f32::consts::TAU;
use std::sync::Arc;

/// Height above the ground at and above which a source no longer reaches the grass (m).
pub const CEILING_M: f32 = 30.0;
/// Downwash of a rotor on the ground: radius (m), speed (m/s), steady bend (rad), height of its force above the ground (m).
const DOWNWASH_RADIUS_M: f32 = 10.0;
const DOWNWASH_M_PER_S: f32 = 12.0;
const DOWNWASH_BEND_RAD: f32 = 1.2;
const DOWNWASH_STRIKE_M: f32 = 0.5;

/// Wind direction and strength over the square around a centre.
#[derive(Clone, Debug, PartialEq)]
pub enum Pattern {
    /// Away from the centre (Chen & Johan, Fig. 9a): strongest half-way to the rim, zero at the centre and outside the rim.
    Outward,
    /// About the centre, from +X towards +Z; as strong as `Outward`.
    Swirl,
    /// Drawn by hand (Chen & Johan, Fig. 9b).
    Drawn(Arc<WindDrawing>),
}

impl Pattern {
    /// The pattern of a scene's wind, or `None` when its drawing is not among `drawings`.
    pub fn new(shape: &WindShape, drawings: &WindDrawings) -> Option<Self> {
        match shape {
            WindShape::Outward => Some(Self::Outward),
            WindShape::Swirl => Some(Self::Swirl),
            WindShape::Drawn(name) => drawings.get(name).cloned().map(Self::Drawn),
        }
    }

    /// The wind vector, of length 0 to 1, at a position in units of the radius.
    pub fn at(&self, [x, z]: [f32; 2]) -> [f32; 2] {
        // The direction is (x, z)/r, so the strength is 4·r·(1 − r).
        let factor = 4.0 * (1.0 - length([x, z])).max(0.0);
        match self {
            Self::Outward => [x * factor, z * factor],
            Self::Swirl => [-z * factor, x * factor],
            Self::Drawn(drawing) => drawing.at([x, z]),
        }
    }
}

/// Wind that presses a square of grass for a while.
#[derive(Clone, Debug)]
pub struct PrescribedWind {
    /// Direction and strength over the square.
    pub pattern: Pattern,
    /// Centre on the ground (m).
    pub center_m: [f32; 2],
    /// Half the side of the square (m).
    pub radius_m: f32,
    /// Rotation of the pattern from +X towards +Z (rad).
    pub rotation_rad: f32,
    /// Strength, 1 for a source on the ground.
    pub strength: f32,
    /// Speed where the pattern is strongest, for a source on the ground (m/s).
    pub speed_m_per_s: f32,
    /// Steady bend of the grass at that speed (rad).
    pub bend_rad: f32,
    /// Height above the ground at which the wind pushes (m), h of Chen & Johan, Eq. (12).
    pub strike_height_m: f32,
    /// Duration (s).
    pub secs: f32,
}

/// Relative radius and strength on the ground of a source at `height_m`; both decrease with height. `None` from [`CEILING_M`] up.
pub fn reach(height_m: f32) -> Option<[f32; 2]> {
    let nearness = 1.0 - height_m.max(0.0) / CEILING_M;
    (nearness > 0.0).then_some([0.4 + 0.6 * nearness, nearness * nearness])
}

impl PrescribedWind {
    /// The downwash of a rotor at `height_m` above the ground, for `secs`.
    pub fn downwash(pattern: Pattern, center_m: [f32; 2], height_m: f32, secs: f32) -> Option<Self> {
        let [radius, strength] = reach(height_m)?;
        Some(Self {
            pattern,
            center_m,
            radius_m: DOWNWASH_RADIUS_M * radius,
            rotation_rad: 0.0,
            strength,
            speed_m_per_s: DOWNWASH_M_PER_S,
            bend_rad: DOWNWASH_BEND_RAD,
            strike_height_m: DOWNWASH_STRIKE_M,
            secs,
        })
    }

    /// The stroke by which it bends grass along the wind.
    pub fn stroke(&self, layout: &PatchLayout) -> Stroke<'_> {
        let (sin, cos) = libm::sincosf(self.rotation_rad);
        Stroke::new(&self.footprint(), layout, false, move |at_m, cell| {
            let [x, z] = [0, 1].map(|axis| (at_m[axis] - self.center_m[axis]) / self.radius_m);
            let [x, z] = self.pattern.at([cos * x + sin * z, cos * z - sin * x]);
            let wind = [cos * x - sin * z, cos * z + sin * x];
            let (strength, direction) = (self.strength * length(wind), unit(wind)?);
            let (bend, limit) = (cell.bend(), (self.bend_rad * strength).min(cell.limit_rad(direction)));
            if bend.theta >= limit {
                return None;
            }
            let speed = self.speed_m_per_s * strength;
            let theta = limit.min(bend_after_rad(bend.theta, speed, self.strike_height_m, self.secs));
            let held = bending_speed_rad_per_s(speed, theta, self.strike_height_m).max(HELD_RAD_PER_S);
            Some(Pressed { bend: Bend { theta, omega: direction.map(|d| d * held) }, flattened_fraction: 0.0 })
        })
    }

    /// The square that is pressed.
    pub fn footprint(&self) -> Footprint {
        let (sin, cos) = libm::sincosf(self.rotation_rad);
        let [x, z] = self.center_m;
        let (a, b) = (self.radius_m * (cos - sin), self.radius_m * (cos + sin));
        Footprint::around(vec![[x + a, z + b], [x - b, z + a], [x - a, z - b], [x + b, z - a]])
    }
}

/// All prescribed winds of a scene.
#[derive(Clone, Debug)]
pub struct PrescribedWinds {
    winds: Vec<(DrawnWind, Pattern)>,
    downwash: Option<Pattern>,
    objects: Objects,
    time_secs: f64,
}

impl PrescribedWinds {
    /// The prescribed winds of `scene`. A wind whose drawing is not among `drawings` is left out.
    pub fn new(scene: &Scene, drawings: &WindDrawings) -> Self {
        let wind = |wind: &DrawnWind| Some((wind.clone(), Pattern::new(&wind.shape, drawings)?));
        let downwash = Pattern::new(&scene.objects.helicopter.wash_shape, drawings);
        let winds = scene.drawn_winds.iter().filter_map(wind).collect();
        Self { winds, downwash, objects: scene.objects.clone(), time_secs: 0.0 }
    }

    /// Simulated time of the next step (s).
    pub(super) fn time_secs(&self) -> f64 {
        self.time_secs
    }

    /// Sets the simulated time of the next step (s).
    pub(super) fn set_time(&mut self, time_secs: f64) {
        self.time_secs = time_secs;
    }

    /// Winds of the next `dt_secs`: downwash below `rotors`, and the drawn winds. A wind that travels far in a step is repeated along
    /// its path, at most a quarter of its radius apart.
    pub fn step<'a>(&mut self, rotors: impl Iterator<Item = &'a Motion>, height: &HeightMap, dt_secs: f32) -> Vec<PrescribedWind> {
        let downwash = rotors.filter_map(|motion| {
            let [x, z] = motion.to.xz();
            let skids_m = motion.to.position_m[1] - self.objects.half_extents_m(motion.kind)[1];
            PrescribedWind::downwash(self.downwash.clone()?, [x, z], skids_m - height.height_m(x, z), dt_secs)
        });
        let winds = self.winds.iter().flat_map(|(wind, pattern)| along_path(wind, pattern, self.time_secs, dt_secs));
        let all = downwash.chain(winds).collect();
        self.time_secs += f64::from(dt_secs);
        all
    }
}

/// The drawings that `scene` names, with the fields that name them.
pub fn named_drawings(scene: &Scene) -> impl Iterator<Item = (&'static str, &str)> {
    let winds = scene.drawn_winds.iter().map(|wind| ("drawn_winds", &wind.shape));
    let shapes = winds.chain([("objects.helicopter.wash_shape", &scene.objects.helicopter.wash_shape)]);
    shapes.filter_map(|(field, shape)| match shape {
        WindShape::Drawn(name) => Some((field, name.as_str())),
        WindShape::Outward | WindShape::Swirl => None,
    })
}

/// A drawn wind at its positions during the `dt_secs` from `time_secs` on.
fn along_path(wind: &DrawnWind, pattern: &Pattern, time_secs: f64, dt_secs: f32) -> Vec<PrescribedWind> {
    let Some([radius, strength]) = reach(wind.height_m) else { return vec![] };
    let radius_m = wind.radius_m * radius;
    let positions = (wind.travel_m_per_s * dt_secs / (0.25 * radius_m)).ceil().max(1.0) as u16;
    let at = |n: u16| {
        let at_secs = time_secs + f64::from(dt_secs) * (f64::from(n) + 1.0) / f64::from(positions);
        PrescribedWind {
            pattern: pattern.clone(),
            center_m: position_on_path_m(&wind.path_m, f64::from(wind.travel_m_per_s) * at_secs),
            radius_m,
            rotation_rad: (f64::from(wind.turns_per_s) * at_secs).fract() as f32 * TAU,
            strength,
            speed_m_per_s: wind.speed_m_per_s,
            bend_rad: wind.bend_rad,
            strike_height_m: wind.strike_height_m,
            secs: dt_secs / f32::from(positions),
        }
    };
    (0..positions).map(at).collect()
}

/// The position (m) at the distance `travelled_m` along the closed path through `corners_m`.
fn position_on_path_m(corners_m: &[[f32; 2]], travelled_m: f64) -> [f32; 2] {
    let legs =
        || corners_m.iter().zip(corners_m.iter().cycle().skip(1)).map(|(&a, &b)| (a, b, f64::from(length([b[0] - a[0], b[1] - a[1]]))));
    let round_m: f64 = legs().map(|(.., length_m)| length_m).sum();
    let mut left_m = if round_m > 0.0 { travelled_m.rem_euclid(round_m) } else { 0.0 };
    for (a, b, length_m) in legs() {
        if left_m < length_m {
            let fraction = (left_m / length_m) as f32;
            return [a[0] + (b[0] - a[0]) * fraction, a[1] + (b[1] - a[1]) * fraction];
        }
        left_m -= length_m;
    }
    corners_m.first().copied().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_closed_path_repeats() {
        let square = [[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]];
        for (travelled_m, position) in [(0.0, [0.0, 0.0]), (4.0, [4.0, 0.0]), (13.0, [10.0, 3.0]), (37.0, [0.0, 3.0]), (44.0, [4.0, 0.0])] {
            assert_eq!(position_on_path_m(&square, travelled_m), position, "after {travelled_m} m");
        }
        assert_eq!(position_on_path_m(&[[3.0, 4.0]], 1e6), [3.0, 4.0], "a single position");
        assert_eq!(position_on_path_m(&[[0.0, 0.0], [8.0, 0.0]], 11.0), [5.0, 0.0], "there and back");
    }

    #[test]
    fn a_wind_that_is_fast_for_its_size_presses_without_gaps() {
        let mut wind = DrawnWind::new(WindShape::Outward, vec![[0.0, 0.0], [1000.0, 0.0]]);
        (wind.radius_m, wind.travel_m_per_s) = (1.0, 60.0);
        let winds = along_path(&wind, &Pattern::Outward, 0.0, 0.05);
        assert_eq!(winds.len(), 12);
        assert!((winds.iter().map(|wind| wind.secs).sum::<f32>() - 0.05).abs() < 1e-6);
        assert!(winds.windows(2).all(|pair| pair[1].center_m[0] - pair[0].center_m[0] <= 0.2501));
    }
}
