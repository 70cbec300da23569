//! Air that presses grass as an object does (001 §5.3, the first approach): the wash of a helicopter, cyclones, winds drawn by hand.

use super::contact::{HELD_RAD_PER_S, bend_after_rad, bending_speed_rad_per_s, length, unit};
use super::drawing::{Drawing, Drawings};
use super::footprint::Footprint;
use super::sward::{Pressed, Sward};
use crate::objects::Motion;
use shared::bend::Bend;
use shared::scene::{DrawnWind, Scene, VehicleKind, WindShape};
use shared::terrain::HeightMap;
use std::f32::consts::TAU;
use std::sync::Arc;

/// Height above the ground from which on air reaches no grass (m).
pub const CEILING_M: f32 = 30.0;
/// The wash of a rotor on the ground: radius (m), speed (m/s), the bend it sustains (rad), the height it strikes at (m).
const WASH_RADIUS_M: f32 = 10.0;
const WASH_M_PER_S: f32 = 12.0;
const WASH_BEND_RAD: f32 = 1.2;
const WASH_STRIKE_M: f32 = 0.5;

/// Which way, and how strongly, air blows over the square around its middle.
#[derive(Clone, Debug, PartialEq)]
pub enum Pattern {
    /// Away from the middle (001 Fig. 9a): most half-way to the rim, not at all in the middle and from the rim on.
    Outward,
    /// About the middle, from +X towards +Z; as strong as `Outward`.
    Swirl,
    /// As drawn by hand (001 Fig. 9b).
    Drawn(Arc<Drawing>),
}

impl Pattern {
    /// The pattern of a scene's word; none when it names a drawing that is not among `drawings`.
    pub fn new(shape: &WindShape, drawings: &Drawings) -> Option<Self> {
        match shape {
            WindShape::Outward => Some(Self::Outward),
            WindShape::Swirl => Some(Self::Swirl),
            WindShape::Drawn(name) => drawings.get(name).cloned().map(Self::Drawn),
        }
    }

    /// The direction at a place in units of the radius, as long as the air is strong there: 0 to 1.
    pub fn at(&self, [x, z]: [f32; 2]) -> [f32; 2] {
        // Times the direction, which is (x, z)/r, this is 4·r·(1 − r).
        let share = 4.0 * (1.0 - length([x, z])).max(0.0);
        match self {
            Self::Outward => [x * share, z * share],
            Self::Swirl => [-z * share, x * share],
            Self::Drawn(drawing) => drawing.at([x, z]),
        }
    }
}

/// Air that presses grass for a while.
#[derive(Clone, Debug)]
pub struct Blow {
    /// Which way it blows.
    pub pattern: Pattern,
    /// Its middle on the ground (m).
    pub center_m: [f32; 2],
    /// Half the side of the square that it presses (m).
    pub radius_m: f32,
    /// Angle by which its pattern is turned from +X towards +Z (rad).
    pub turned_rad: f32,
    /// Its strength, 1 for a source on the ground.
    pub strength: f32,
    /// Speed of the air where it is strongest and its source on the ground (m/s).
    pub speed_m_per_s: f32,
    /// Bend that such air sustains (rad).
    pub bend_rad: f32,
    /// Height above the ground that it strikes at (m), h of 001 Eq. (12).
    pub strike_height_m: f32,
    /// How long it presses (s).
    pub secs: f32,
}

/// Radius and strength, as shares, of what a source at `height_m` above the ground does there: weaker and smaller the higher it is. None
/// from [`CEILING_M`] on.
pub fn reach(height_m: f32) -> Option<[f32; 2]> {
    let nearness = 1.0 - height_m.max(0.0) / CEILING_M;
    (nearness > 0.0).then_some([0.4 + 0.6 * nearness, nearness * nearness])
}

impl Blow {
    /// The wash of a rotor at `height_m` above the ground, for `secs`.
    pub fn wash(pattern: Pattern, center_m: [f32; 2], height_m: f32, secs: f32) -> Option<Self> {
        let [radius, strength] = reach(height_m)?;
        Some(Self {
            pattern,
            center_m,
            radius_m: WASH_RADIUS_M * radius,
            turned_rad: 0.0,
            strength,
            speed_m_per_s: WASH_M_PER_S,
            bend_rad: WASH_BEND_RAD,
            strike_height_m: WASH_STRIKE_M,
            secs,
        })
    }

    /// Bends the grass of awake patches its way, against the wind where it must. Returns the largest bending speed (rad/s).
    pub fn press(&self, sward: &mut Sward) -> f32 {
        let mut largest = 0.0_f32;
        let (sin, cos) = self.turned_rad.sin_cos();
        sward.for_each_cell(&self.footprint(), false, |at_m, bend, limit_rad| {
            let [x, z] = [0, 1].map(|axis| (at_m[axis] - self.center_m[axis]) / self.radius_m);
            let [x, z] = self.pattern.at([cos * x + sin * z, cos * z - sin * x]);
            let blows = [cos * x - sin * z, cos * z + sin * x];
            let (strength, direction) = (self.strength * length(blows), unit(blows)?);
            let limit = (self.bend_rad * strength).min(limit_rad(direction));
            if bend.theta >= limit {
                return None;
            }
            let speed = self.speed_m_per_s * strength;
            let theta = limit.min(bend_after_rad(bend.theta, speed, self.strike_height_m, self.secs));
            let held = bending_speed_rad_per_s(speed, theta, self.strike_height_m).max(HELD_RAD_PER_S);
            largest = largest.max(held);
            Some(Pressed { bend: Bend { theta, omega: direction.map(|d| d * held) }, lays_share: 0.0 })
        });
        largest
    }

    /// The square that it presses.
    pub fn footprint(&self) -> Footprint {
        let (sin, cos) = self.turned_rad.sin_cos();
        let [x, z] = self.center_m;
        let (a, b) = (self.radius_m * (cos - sin), self.radius_m * (cos + sin));
        Footprint::around(vec![[x + a, z + b], [x - b, z + a], [x - a, z - b], [x + b, z - a]])
    }
}

/// All the air of a scene that presses grass as objects do.
#[derive(Clone, Debug)]
pub struct Blows {
    winds: Vec<(DrawnWind, Pattern)>,
    wash: Option<Pattern>,
    time_secs: f64,
}

impl Blows {
    /// The blowing air of `scene`, whose drawings have the names that the scene gives them; one that is missing blows nothing.
    pub fn new(scene: &Scene, drawings: &Drawings) -> Self {
        let wind = |wind: &DrawnWind| Some((wind.clone(), Pattern::new(&wind.shape, drawings)?));
        let wash = Pattern::new(&scene.objects.helicopter.wash_shape, drawings);
        Self { winds: scene.drawn_winds.iter().filter_map(wind).collect(), wash, time_secs: 0.0 }
    }

    /// What presses the grass in the next `dt_secs`: washes below the helicopters among `motions`, and drawn winds. One that travels far
    /// in a step presses in several places, at most a quarter of its radius apart.
    pub fn step(&mut self, motions: &[Motion], height: &HeightMap, dt_secs: f32) -> Vec<Blow> {
        let washes = motions.iter().filter(|motion| motion.kind == VehicleKind::Helicopter).filter_map(|motion| {
            let [x, z] = motion.to.xz();
            let skids_m = motion.to.position_m[1] - motion.kind.half_extents_m()[1];
            Blow::wash(self.wash.clone()?, [x, z], skids_m - height.height_m(x, z), dt_secs)
        });
        let winds = self.winds.iter().flat_map(|(wind, pattern)| blows(wind, pattern, self.time_secs, dt_secs));
        let all = washes.chain(winds).collect();
        self.time_secs += f64::from(dt_secs);
        all
    }
}

/// What a drawn wind presses in the `dt_secs` from `time_secs` on.
fn blows(wind: &DrawnWind, pattern: &Pattern, time_secs: f64, dt_secs: f32) -> Vec<Blow> {
    let Some([radius, strength]) = reach(wind.height_m) else { return vec![] };
    let radius_m = wind.radius_m * radius;
    let places = (wind.travel_m_per_s * dt_secs / (0.25 * radius_m)).ceil().max(1.0) as u16;
    let blow = |n: u16| {
        let at_secs = time_secs + f64::from(dt_secs) * (f64::from(n) + 1.0) / f64::from(places);
        Blow {
            pattern: pattern.clone(),
            center_m: place_m(&wind.path_m, f64::from(wind.travel_m_per_s) * at_secs),
            radius_m,
            turned_rad: (f64::from(wind.turns_per_s) * at_secs).fract() as f32 * TAU,
            strength,
            speed_m_per_s: wind.speed_m_per_s,
            bend_rad: wind.bend_rad,
            strike_height_m: wind.strike_height_m,
            secs: dt_secs / f32::from(places),
        }
    };
    (0..places).map(blow).collect()
}

/// The place (m) `way_m` along the closed path through `places_m`.
fn place_m(places_m: &[[f32; 2]], way_m: f64) -> [f32; 2] {
    let legs = || places_m.iter().zip(places_m.iter().cycle().skip(1)).map(|(&a, &b)| (a, b, f64::from((b[0] - a[0]).hypot(b[1] - a[1]))));
    let round_m: f64 = legs().map(|(.., length_m)| length_m).sum();
    let mut left_m = if round_m > 0.0 { way_m.rem_euclid(round_m) } else { 0.0 };
    for (a, b, length_m) in legs() {
        if left_m < length_m {
            let share = (left_m / length_m) as f32;
            return [a[0] + (b[0] - a[0]) * share, a[1] + (b[1] - a[1]) * share];
        }
        left_m -= length_m;
    }
    places_m.first().copied().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_closed_path_comes_round() {
        let square = [[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]];
        for (way_m, place) in [(0.0, [0.0, 0.0]), (4.0, [4.0, 0.0]), (13.0, [10.0, 3.0]), (37.0, [0.0, 3.0]), (44.0, [4.0, 0.0])] {
            assert_eq!(place_m(&square, way_m), place, "after {way_m} m");
        }
        assert_eq!(place_m(&[[3.0, 4.0]], 1e6), [3.0, 4.0], "one place alone");
        assert_eq!(place_m(&[[0.0, 0.0], [8.0, 0.0]], 11.0), [5.0, 0.0], "there and back");
    }

    #[test]
    fn a_wind_that_is_fast_for_its_size_presses_without_gaps() {
        let mut wind = DrawnWind::new(WindShape::Outward, vec![[0.0, 0.0], [1000.0, 0.0]]);
        (wind.radius_m, wind.travel_m_per_s) = (1.0, 60.0);
        let blows = blows(&wind, &Pattern::Outward, 0.0, 0.05);
        assert_eq!(blows.len(), 12);
        assert!((blows.iter().map(|blow| blow.secs).sum::<f32>() - 0.05).abs() < 1e-6);
        assert!(blows.windows(2).all(|pair| pair[1].center_m[0] - pair[0].center_m[0] <= 0.2501));
    }
}
