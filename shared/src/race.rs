//! A race's gates on the ground, and its start light: what server and page must agree on.

use crate::scene::{AMBER_SECS, GREEN_SECS, Race, RaceGate, Scene};

/// A gate's line on the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GateLine {
    middle_m: [f64; 2],
    /// Unit vector of the direction in which it is passed.
    forward: [f64; 2],
    half_width_m: f64,
}

impl GateLine {
    /// The line of a gate.
    pub fn new(gate: &RaceGate) -> Self {
        let heading_rad = f64::from(gate.heading_rad);
        Self {
            middle_m: gate.at_m.map(f64::from),
            forward: [libm::sin(heading_rad), -libm::cos(heading_rad)],
            half_width_m: 0.5 * f64::from(gate.width_m),
        }
    }

    /// Distances (m) of a place ahead of the line and to the right of its middle, for one who passes it.
    pub fn from_gate_m(&self, place_m: [f32; 2]) -> [f64; 2] {
        let ([ahead_x, ahead_z], [x, z]) = (self.forward, [0, 1].map(|axis| f64::from(place_m[axis]) - self.middle_m[axis]));
        [ahead_x * x + ahead_z * z, ahead_x * z - ahead_z * x]
    }

    /// The place (m) `right_m` to the right of its middle.
    pub fn place_m(&self, right_m: f64) -> [f32; 2] {
        let [x, z] = self.middle_m;
        [(x - self.forward[1] * right_m) as f32, (z + self.forward[0] * right_m) as f32]
    }

    /// Half the distance between its posts (m).
    pub fn half_width_m(&self) -> f64 {
        self.half_width_m
    }

    /// Fraction, above 0 and at most 1, of the straight path between two places (m) at which it passes the gate forwards and between its posts. Two paths
    /// that follow each other never both pass it at the place where they meet.
    pub fn passage(&self, from_m: [f32; 2], to_m: [f32; 2]) -> Option<f64> {
        let ([before_m, right_before_m], [after_m, right_after_m]) = (self.from_gate_m(from_m), self.from_gate_m(to_m));
        if !(before_m < 0.0 && after_m >= 0.0) {
            return None;
        }
        let share = before_m / (before_m - after_m);
        let right_m = right_before_m + share * (right_after_m - right_before_m);
        (right_m.abs() <= self.half_width_m).then_some(share)
    }
}

/// Half the side of a post (m).
pub const POST_HALF_M: f32 = 0.09;
/// Height of the posts' tops above the foot of the higher one (m).
pub const POST_TOP_M: f32 = 4.2;
/// Depth to which posts reach below the ground (m), so that none floats on a slope.
pub const POST_DEPTH_M: f32 = 0.5;

/// A post of a gate: a square beam, upright in the ground, that vehicles and balls run into.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GatePost {
    /// X and Z of its axis (m).
    pub at_m: [f32; 2],
    /// Elevation of its ends (m): below the ground, and at the top.
    pub span_m: [f32; 2],
    /// Heading of its gate (rad), along which one side faces.
    pub heading_rad: f32,
}

impl GatePost {
    /// The left and the right post of a gate for one who passes it, given the elevation of the ground (m) at X and Z.
    pub fn pair(gate: &RaceGate, ground_m: impl Fn(f32, f32) -> f32) -> [Self; 2] {
        let line = GateLine::new(gate);
        let places_m = [-1.0, 1.0].map(|side| line.place_m(side * line.half_width_m()));
        let feet_m = places_m.map(|[x, z]| ground_m(x, z));
        let top_m = feet_m[0].max(feet_m[1]) + POST_TOP_M;
        let post = |n: usize| Self { at_m: places_m[n], span_m: [feet_m[n] - POST_DEPTH_M, top_m], heading_rad: gate.heading_rad };
        [post(0), post(1)]
    }

    /// Unit quaternion (x, y, z, w) of its turn about Y.
    pub fn rotation(&self) -> [f32; 4] {
        let (sine, cosine) = libm::sincosf(-0.5 * self.heading_rad);
        [0.0, sine, 0.0, cosine]
    }
}

/// Color of the start light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LightColor {
    /// Those who start by the light wait behind the gate.
    Red,
    /// The light is about to turn green.
    Amber,
    /// Go.
    Green,
}

impl LightColor {
    /// Its name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Red => "red",
            Self::Amber => "amber",
            Self::Green => "green",
        }
    }
}

/// The start light's program, in ticks of the world: it turns green at every multiple of its period.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StartLight {
    period: u64,
    amber: u64,
    green: u64,
}

impl StartLight {
    /// The light of a scene's race; `None` without a race, or if it has no light.
    pub fn of(scene: &Scene) -> Option<Self> {
        let Race { light_period_secs, gates, .. } = &scene.race;
        let ticks = |secs: f64| (secs * f64::from(scene.tick_hz)).round() as u64;
        let light = Self { period: ticks(f64::from(*light_period_secs)), amber: ticks(AMBER_SECS), green: ticks(GREEN_SECS) };
        (!gates.is_empty() && light.period > light.amber + light.green).then_some(light)
    }

    /// Its color after a step.
    pub fn color(&self, tick: u64) -> LightColor {
        match tick % self.period {
            since if since < self.green => LightColor::Green,
            since if since >= self.period - self.amber => LightColor::Amber,
            _ => LightColor::Red,
        }
    }

    /// The step, this or an earlier one, after which it last turned green.
    pub fn newest_green(&self, tick: u64) -> u64 {
        tick - tick % self.period
    }

    /// Number of steps until it turns green again.
    pub fn until_green(&self, tick: u64) -> u64 {
        self.period - tick % self.period
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{TerrainMaps, parse};
    use proptest::prelude::*;
    use std::f32::consts::{FRAC_PI_2, PI};

    fn line(heading_rad: f32) -> GateLine {
        GateLine::new(&RaceGate { width_m: 8.0, ..RaceGate::new([100.0, 50.0], heading_rad) })
    }

    #[test]
    fn a_heading_is_measured_from_north_towards_east() {
        for (heading_rad, ahead, right) in
            [(0.0, [100.0, 48.0], [103.0, 50.0]), (FRAC_PI_2, [102.0, 50.0], [100.0, 53.0]), (PI, [100.0, 52.0], [97.0, 50.0])]
        {
            let line = line(heading_rad);
            let near = |found: [f64; 2], wanted: [f64; 2]| (0..2).all(|n| (found[n] - wanted[n]).abs() < 1e-5);
            assert!(near(line.from_gate_m(ahead), [2.0, 0.0]), "{heading_rad}: {:?}", line.from_gate_m(ahead));
            assert!(near(line.from_gate_m(right), [0.0, 3.0]), "{heading_rad}: {:?}", line.from_gate_m(right));
            assert!(near(line.place_m(3.0).map(f64::from), right.map(f64::from)), "{heading_rad}");
        }
    }

    #[test]
    fn only_a_way_forwards_between_the_posts_passes() {
        let north = line(0.0);
        assert_eq!(north.passage([100.0, 51.0], [100.0, 47.0]), Some(0.25));
        assert_eq!(north.passage([100.0, 47.0], [100.0, 51.0]), None, "backwards");
        assert_eq!(north.passage([104.5, 51.0], [104.5, 47.0]), None, "outside the posts");
        assert_eq!(north.passage([104.0, 51.0], [104.0, 47.0]), Some(0.25), "at a post");
        assert_eq!(north.passage([100.0, 52.0], [100.0, 51.0]), None, "not far enough");
        // The middle of the way decides, not its ends.
        assert_eq!(north.passage([98.0, 51.0], [110.0, 49.0]), Some(0.5));
        assert_eq!(north.passage([102.0, 51.0], [110.0, 49.0]), None);
    }

    #[test]
    fn posts_stand_at_the_ends_of_the_line_and_end_at_one_height() {
        let east = RaceGate { width_m: 8.0, ..RaceGate::new([20.0, 30.0], FRAC_PI_2) };
        let [left, right] = GatePost::pair(&east, |_, z| 0.1 * z);
        // North is to the left of who drives east, and lower here.
        for (post, z, foot_m) in [(left, 26.0, 2.6), (right, 34.0, 3.4)] {
            let off_m =
                [post.at_m[0] - 20.0, post.at_m[1] - z, post.span_m[0] - (foot_m - POST_DEPTH_M), post.span_m[1] - (3.4 + POST_TOP_M)];
            assert!(off_m.iter().all(|m| m.abs() < 1e-5), "{post:?}");
            let [_, y, _, w] = post.rotation();
            assert!((y + 0.5_f32.sqrt()).abs() < 1e-6 && (w - 0.5_f32.sqrt()).abs() < 1e-6, "a turn to the right about Y");
        }
    }

    proptest! {
        /// A drive that stops on the line and goes on passes it once, wherever it stops.
        #[test]
        fn two_ways_pass_once(heading_rad in -6.3_f32..6.3, stop_m in -3.0_f64..3.0) {
            let line = line(heading_rad);
            let [x, z] = line.forward;
            let at = |ahead_m: f64| [(100.0 + ahead_m * x) as f32, (50.0 + ahead_m * z) as f32];
            let ways = [line.passage(at(-5.0), at(stop_m)), line.passage(at(stop_m), at(5.0))];
            prop_assert_eq!(ways.iter().flatten().count(), 1, "{:?}", ways);
        }
    }

    #[test]
    fn the_light_is_red_then_amber_then_green() {
        let gates = "[[race.gates]]\nat_m = [1, 1]\nheading_rad = 0\n[[race.gates]]\nat_m = [9, 9]\nheading_rad = 3\n";
        let maps = "summary = ''\n[terrain]\nheight_map = 'h'\ncovering_map = 'c'\npixel_m = [1, 1]\nlevel_m = 0.1\n";
        let scene = parse(&format!("{maps}[race]\nlight_period_secs = 20\n{gates}")).unwrap();
        let light = StartLight::of(&scene).unwrap();
        let colors = [0, 599, 600, 1019, 1020, 1199, 1200].map(|tick| light.color(tick).name());
        assert_eq!(colors, ["green", "green", "red", "red", "amber", "amber", "green"]);
        assert_eq!([1199, 1200, 1300].map(|tick| light.newest_green(tick)), [0, 1200, 1200]);
        assert_eq!([0, 1199, 1200].map(|tick| light.until_green(tick)), [1200, 1, 1200]);
        let dark = parse(&format!("{maps}[race]\nlight_period_secs = 0\n{gates}")).unwrap();
        let terrain = TerrainMaps { height_map: "h".into(), covering_map: "c".into(), pixel_m: [1.0; 2], level_m: 0.1, base_m: 0.0 };
        assert_eq!([StartLight::of(&dark), StartLight::of(&Scene::new(terrain))], [None; 2]);
    }
}
