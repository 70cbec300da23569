//! Cars, monsters, helicopters, sleds and balls.

use super::WindShape;
use crate::outline;
use serde::{Deserialize, Serialize};

/// What a visitor can drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum VehicleKind {
    /// Four wheels, a box of a body; leaves two-track traces at speed.
    Car,
    /// A walking creature; grass leans away from its sphere (000 §6.2).
    Monster,
    /// Flies; its downwash bends the grass like an object, weaker with height (001 §5.3).
    Helicopter,
    /// A frame of any outline that glides over the land and lays the grass; concave outlines are split (001 §6).
    Sled,
    /// A light sphere that whatever touches it sends off; rolls and presses the grass.
    Ball,
}

impl VehicleKind {
    /// All kinds, in the order of the client's buttons.
    pub const ALL: [Self; 5] = [Self::Car, Self::Monster, Self::Helicopter, Self::Sled, Self::Ball];

    /// The names of all kinds, in the same order.
    pub const WORDS: &'static [&'static str] = &["car", "monster", "helicopter", "sled", "ball"];

    /// Name as a scene file and the page write it.
    pub fn name(self) -> &'static str {
        Self::WORDS[self as usize]
    }

    /// Half extents of the body's box along its own right, up and back axes (m); of a sled and a ball, those of the default size,
    /// while [`Objects::half_extents_m`] knows the scene's.
    pub fn half_extents_m(self) -> [f32; 3] {
        match self {
            Self::Car => [0.95, 0.7, 2.2],
            Self::Monster => [0.6, 0.9, 0.6],
            Self::Helicopter => [1.1, 1.3, 3.4],
            Self::Sled => [2.0, SLED_HALF_HEIGHT_M, 2.5],
            Self::Ball => [BALL_RADIUS_M; 3],
        }
    }
}

/// Half the height of a sled's frame (m).
const SLED_HALF_HEIGHT_M: f32 = 0.25;

/// Radius of a ball of the default size (m).
const BALL_RADIUS_M: f32 = 0.5;

/// How an object of some kind meets the grass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tread {
    /// Height h above the ground at which the object strikes the grass (m), 001 Eq. (12).
    pub strike_height_m: f32,
    /// Share of the bend below its weight that stays for a while.
    pub lays_share: f32,
}

/// Limits and models of the objects, and how they meet the grass.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Objects {
    /// Most objects at once. Default 64, allowed 0..=1024.
    pub limit: u32,
    /// glTF file (`.glb` or `.gltf`; at most 32 MiB, 65536 vertices and 1048576 indices) drawn for a car, relative to the scene
    /// file; empty for the built-in model. Default "".
    pub car_model: String,
    /// glTF file drawn for a monster, relative to the scene file; empty for the built-in model. Default "".
    pub monster_model: String,
    /// Vehicles that drive by themselves in circles, so that an empty prairie shows tracks. Default 0, allowed
    /// 0..=1024 and at most `limit`.
    pub self_driving: u32,
    /// Speed that these cars keep (m/s); they circle as narrowly as their grip lets them, some 50 m wide at the default and 180 m at 20. Default
    /// 11, allowed 1..=60; no car goes faster than 32.
    pub self_driving_m_per_s: f32,
    /// Distance at which they start from each other, about (m): the n-th stands √n times as far from the middle of the world. Default 4, allowed
    /// 1..=1000.
    pub self_driving_apart_m: f32,
    /// What those are: `car`, `monster`, `helicopter`, `sled` or `ball`. Default `car`.
    pub self_driving_kind: VehicleKind,
    /// Balls that lie about near where visitors first stand, for anyone to kick. Default 0, allowed 0..=64 and with `self_driving` at most `limit`.
    pub balls: u32,
    /// Radius of a ball (m). Default 0.5, allowed 0.1..=5.
    pub ball_radius_m: f32,
    /// Outline of a sled seen from above: corners [x, z] in order, x to the right and z to the back of its middle (m). It may be
    /// concave; its edges must not cross and must enclose at least 0.01 m². Default the U (−2, −2.5), (−1.2, −2.5), (−1.2, 1.7),
    /// (1.2, 1.7), (1.2, −2.5), (2, −2.5), (2, 2.5), (−2, 2.5); allowed 3..=64 corners, −20..=20 each.
    pub sled_outline_m: Vec<[f32; 2]>,
    /// How a car meets the grass.
    pub car: CarTread,
    /// How a monster meets the grass.
    pub monster: MonsterTread,
    /// How a helicopter meets the grass.
    pub helicopter: HelicopterTread,
    /// How a sled meets the grass.
    pub sled: SledTread,
    /// How a ball meets the grass.
    pub ball: BallTread,
}

impl Default for Objects {
    fn default() -> Self {
        Self {
            limit: 64,
            car_model: String::new(),
            monster_model: String::new(),
            self_driving: 0,
            self_driving_m_per_s: 11.0,
            self_driving_apart_m: 4.0,
            self_driving_kind: VehicleKind::Car,
            balls: 0,
            ball_radius_m: BALL_RADIUS_M,
            sled_outline_m: vec![[-2.0, -2.5], [-1.2, -2.5], [-1.2, 1.7], [1.2, 1.7], [1.2, -2.5], [2.0, -2.5], [2.0, 2.5], [-2.0, 2.5]],
            car: CarTread::default(),
            monster: MonsterTread::default(),
            helicopter: HelicopterTread::default(),
            sled: SledTread::default(),
            ball: BallTread::default(),
        }
    }
}

impl Objects {
    /// How an object of `kind` meets the grass.
    pub fn tread(&self, kind: VehicleKind) -> Tread {
        let (strike_height_m, lays_share) = match kind {
            VehicleKind::Car => (self.car.strike_height_m, self.car.lays_share),
            VehicleKind::Monster => (self.monster.strike_height_m, self.monster.lays_share),
            VehicleKind::Helicopter => (self.helicopter.strike_height_m, self.helicopter.lays_share),
            VehicleKind::Sled => (self.sled.strike_height_m, self.sled.lays_share),
            VehicleKind::Ball => (self.ball.strike_height_m, self.ball.lays_share),
        };
        Tread { strike_height_m, lays_share }
    }

    /// Half extents of the body's box of `kind` along its own right, up and back axes (m).
    pub fn half_extents_m(&self, kind: VehicleKind) -> [f32; 3] {
        match kind {
            VehicleKind::Sled => {
                let reach = |axis: usize| self.sled_outline_m.iter().map(|corner| corner[axis].abs()).fold(0.0, f32::max);
                [reach(0), SLED_HALF_HEIGHT_M, reach(1)]
            }
            VehicleKind::Ball => [self.ball_radius_m; 3],
            other => other.half_extents_m(),
        }
    }

    /// Sphere of `kind` that pushes near blades aside (000 §6.2): the height of its centre above the body's, and its radius (m). A ball's is the ball, the
    /// others' sit at the foot; none for a sled, which is no round thing.
    pub fn interaction_sphere_m(&self, kind: VehicleKind) -> Option<[f32; 2]> {
        let radius_m = match kind {
            VehicleKind::Car => 1.3,
            VehicleKind::Monster => 0.9,
            VehicleKind::Helicopter => 1.5,
            VehicleKind::Sled => return None,
            VehicleKind::Ball => return Some([0.0, self.ball_radius_m]),
        };
        let [_, half_m, _] = self.half_extents_m(kind);
        Some([0.35 * radius_m - half_m, radius_m])
    }
}

/// How a car meets the grass: its wheels, and its floor above them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CarTread {
    /// Height h above the ground at which it strikes the grass (m), 001 Eq. (12). Default 0.3, allowed 0.05..=5.
    pub strike_height_m: f32,
    /// Share of the bend below the wheels that stays, and rises with `grass.laid_recovery_secs`. Default 0.5, allowed 0..=1.
    pub lays_share: f32,
}

impl Default for CarTread {
    fn default() -> Self {
        Self { strike_height_m: 0.3, lays_share: 0.5 }
    }
}

/// How a monster meets the grass.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct MonsterTread {
    /// Height h above the ground at which it strikes the grass (m), 001 Eq. (12). Default 0.4, allowed 0.05..=5.
    pub strike_height_m: f32,
    /// Share of the bend below its feet that stays, and rises with `grass.laid_recovery_secs`. Default 0.3, allowed 0..=1.
    pub lays_share: f32,
}

impl Default for MonsterTread {
    fn default() -> Self {
        Self { strike_height_m: 0.4, lays_share: 0.3 }
    }
}

/// How a helicopter meets the grass: its skids and hull on the ground, and its wash from above.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct HelicopterTread {
    /// Height h above the ground at which it strikes the grass (m), 001 Eq. (12). Default 0.5, allowed 0.05..=5.
    pub strike_height_m: f32,
    /// Share of the bend below the skids that stays, and rises with `grass.laid_recovery_secs`. Default 0.5, allowed 0..=1.
    pub lays_share: f32,
    /// Directions of the wash: `outward`, `swirl` or a drawn PNG file, as `drawn_winds.shape`. Default `outward`.
    pub wash_shape: WindShape,
}

impl Default for HelicopterTread {
    fn default() -> Self {
        Self { strike_height_m: 0.5, lays_share: 0.5, wash_shape: WindShape::Outward }
    }
}

/// How a sled meets the grass.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SledTread {
    /// Height h above the ground at which it strikes the grass (m), 001 Eq. (12). Default 0.3, allowed 0.05..=5.
    pub strike_height_m: f32,
    /// Share of the bend below its frame that stays, and rises with `grass.laid_recovery_secs`. Default 0.8, allowed 0..=1.
    pub lays_share: f32,
}

impl Default for SledTread {
    fn default() -> Self {
        Self { strike_height_m: 0.3, lays_share: 0.8 }
    }
}

/// How a ball meets the grass.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct BallTread {
    /// Height h above the ground at which it strikes the grass (m), 001 Eq. (12). Default 0.3, allowed 0.05..=5.
    pub strike_height_m: f32,
    /// Share of the bend below it that stays, and rises with `grass.laid_recovery_secs`. Default 0.1, allowed 0..=1.
    pub lays_share: f32,
}

impl Default for BallTread {
    fn default() -> Self {
        Self { strike_height_m: 0.3, lays_share: 0.1 }
    }
}

/// Notes what does not fit together in the objects of `scene`.
pub(super) fn check(objects: &Objects, misfits: &mut super::check::Misfits) {
    if objects.self_driving > objects.limit {
        let message = format!("is {}; allowed: up to `objects.limit`, {}", objects.self_driving, objects.limit);
        misfits.note(&["objects.self_driving", "objects.limit"], message);
    }
    let room = objects.limit.saturating_sub(objects.self_driving);
    if objects.balls > room {
        let message = format!("is {}; allowed: up to `objects.limit` less `objects.self_driving`, {room}", objects.balls);
        misfits.note(&["objects.balls", "objects.limit", "objects.self_driving"], message);
    }
    if let Err(fault) = outline::check(&objects.sled_outline_m) {
        misfits.note(&["objects.sled_outline_m"], fault.to_string());
    }
    if let Some(message) = objects.helicopter.wash_shape.fault() {
        misfits.note(&["objects.helicopter.wash_shape"], message);
    }
}
