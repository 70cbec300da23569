//! Cars, monsters, helicopters, sleds, balls and walkers.

use super::WindShape;
use super::allowed::Allowed::{self, OneOf, Places, Range, Text};
use serde::{Deserialize, Serialize};

/// Kind of vehicle that a user can drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum VehicleKind {
    /// Four wheels, a box of a body; leaves two-track traces at speed.
    Car,
    /// A walking creature; grass leans away from its sphere (Zhang §6.2).
    Monster,
    /// Flies; its downwash bends the grass like an object, weaker with height (Chen & Johan §5.3).
    Helicopter,
    /// A frame of any outline that glides over the land and flattens the grass; concave outlines are split (Chen & Johan §6).
    Sled,
    /// A light ball: bounces off whatever hits it, rolls, and presses the grass.
    Ball,
    /// A visitor on foot: walks, runs and jumps, and presses the grass under each foot in turn.
    Walker,
}

impl VehicleKind {
    /// All kinds, in the order of the client's buttons.
    pub const ALL: [Self; 6] = [Self::Car, Self::Monster, Self::Helicopter, Self::Sled, Self::Ball, Self::Walker];

    /// The names of all kinds, in the same order.
    pub const WORDS: &'static [&'static str] = &["car", "monster", "helicopter", "sled", "ball", "walker"];

    /// Name as a scene file and the page write it.
    pub fn name(self) -> &'static str {
        Self::WORDS[self as usize]
    }
}

/// Half the height of a sled's frame (m).
const SLED_HALF_HEIGHT_M: f32 = 0.25;

/// Radius of a ball of the default size (m).
const BALL_RADIUS_M: f32 = 0.5;

/// Contact of an object's kind with the grass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tread {
    /// Height h above the ground of its contact with the grass (m), Chen & Johan Eq. (12).
    pub strike_height_m: f32,
    /// Fraction of the bend under its weight that stays for a while.
    pub lays_share: f32,
}

/// Limits and models of the objects, and their contact with the grass.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Objects {
    /// Largest number of objects at once. Default 64, allowed 0..=1024.
    pub limit: u32,
    /// glTF file (`.glb` or `.gltf`; at most 32 MiB, 65536 vertices and 1048576 indices) of a car's model, relative to the scene file; empty for the
    /// built-in model. Default "".
    pub car_model: String,
    /// glTF file of a monster's model, relative to the scene file; empty for the built-in model. Default "".
    pub monster_model: String,
    /// Number of vehicles that drive in circles by themselves, so that an empty prairie shows tracks. Default 0, allowed 0..=1024 and at most
    /// `limit`.
    pub self_driving: u32,
    /// Speed of these vehicles (m/s); they circle as tightly as their grip allows, some 50 m wide at the default and 180 m at 20. Default 11, allowed
    /// 1..=60; no car goes faster than 32.
    pub self_driving_m_per_s: f32,
    /// Approximate distance between their start positions (m): the n-th starts √n times as far from the centre of the world. Default 4, allowed
    /// 1..=1000.
    pub self_driving_apart_m: f32,
    /// Their kind: `car`, `monster`, `helicopter`, `sled`, `ball` or `walker`. Default `car`.
    pub self_driving_kind: VehicleKind,
    /// Number of balls near the start position of the camera, for anyone to kick. Default 0, allowed 0..=64 and with `self_driving` at most `limit`.
    pub balls: u32,
    /// Radius of a ball (m). Default 0.5, allowed 0.1..=5.
    pub ball_radius_m: f32,
    /// Outline of a sled seen from above: corners [x, z] in order, x to the right and z to the back of its centre (m). It may be concave; its edges
    /// must not cross and must enclose at least 0.01 m². Default the U (−2, −2.5), (−1.2, −2.5), (−1.2, 1.7), (1.2, 1.7), (1.2, −2.5), (2, −2.5), (2,
    /// 2.5), (−2, 2.5); allowed 3..=64 corners, −20..=20 each.
    pub sled_outline_m: Vec<[f32; 2]>,
    /// Contact of a car with the grass.
    pub car: CarTread,
    /// Contact of a monster with the grass.
    pub monster: MonsterTread,
    /// Contact of a helicopter with the grass.
    pub helicopter: HelicopterTread,
    /// Contact of a sled with the grass.
    pub sled: SledTread,
    /// Contact of a ball with the grass.
    pub ball: BallTread,
    /// Contact of a walker with the grass.
    pub walker: WalkerTread,
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
            walker: WalkerTread::default(),
        }
    }
}

impl Objects {
    /// Contact of an object of `kind` with the grass.
    pub fn tread(&self, kind: VehicleKind) -> Tread {
        let (strike_height_m, lays_share) = match kind {
            VehicleKind::Car => (self.car.strike_height_m, self.car.lays_share),
            VehicleKind::Monster => (self.monster.strike_height_m, self.monster.lays_share),
            VehicleKind::Helicopter => (self.helicopter.strike_height_m, self.helicopter.lays_share),
            VehicleKind::Sled => (self.sled.strike_height_m, self.sled.lays_share),
            VehicleKind::Ball => (self.ball.strike_height_m, self.ball.lays_share),
            VehicleKind::Walker => (self.walker.strike_height_m, self.walker.lays_share),
        };
        Tread { strike_height_m, lays_share }
    }

    /// File of the scene's own model of `kind`, for kinds that can have one.
    pub fn model_file_mut(&mut self, kind: VehicleKind) -> Option<&mut String> {
        match kind {
            VehicleKind::Car => Some(&mut self.car_model),
            VehicleKind::Monster => Some(&mut self.monster_model),
            VehicleKind::Helicopter | VehicleKind::Sled | VehicleKind::Ball | VehicleKind::Walker => None,
        }
    }

    /// Resets the tread of `kind` to its default.
    pub fn reset_tread(&mut self, kind: VehicleKind) {
        match kind {
            VehicleKind::Car => self.car = CarTread::default(),
            VehicleKind::Monster => self.monster = MonsterTread::default(),
            VehicleKind::Helicopter => self.helicopter = HelicopterTread::default(),
            VehicleKind::Sled => self.sled = SledTread::default(),
            VehicleKind::Ball => self.ball = BallTread::default(),
            VehicleKind::Walker => self.walker = WalkerTread::default(),
        }
    }

    /// Half extents of the box of `kind` along its own right, up and back axes (m).
    pub fn half_extents_m(&self, kind: VehicleKind) -> [f32; 3] {
        match kind {
            VehicleKind::Car => [0.95, 0.7, 2.2],
            VehicleKind::Monster => [0.6, 0.9, 0.6],
            VehicleKind::Helicopter => [1.1, 1.3, 3.4],
            VehicleKind::Sled => {
                let reach = |axis: usize| self.sled_outline_m.iter().map(|corner| corner[axis].abs()).fold(0.0, f32::max);
                [reach(0), SLED_HALF_HEIGHT_M, reach(1)]
            }
            VehicleKind::Ball => [self.ball_radius_m; 3],
            VehicleKind::Walker => [0.25, 0.9, 0.25],
        }
    }

    /// Outline seen from above (m) and half the height (m) of a `kind` with a flat underside, under which near blades lie.
    pub fn underside_m(&self, kind: VehicleKind) -> Option<(&[[f32; 2]], f32)> {
        (kind == VehicleKind::Sled).then_some((self.sled_outline_m.as_slice(), SLED_HALF_HEIGHT_M))
    }

    /// Sphere of `kind` that pushes near blades aside (Zhang §6.2): the height of its centre above the body's, and its radius (m). For a ball it is the ball
    /// itself, for the other kinds it is at the foot; none for a sled, whose underside is [flat](Self::underside_m).
    pub fn interaction_sphere_m(&self, kind: VehicleKind) -> Option<[f32; 2]> {
        let radius_m = match kind {
            VehicleKind::Car => 1.3,
            VehicleKind::Monster => 0.9,
            VehicleKind::Helicopter => 1.5,
            VehicleKind::Walker => 0.3,
            VehicleKind::Sled => return None,
            VehicleKind::Ball => return Some([0.0, self.ball_radius_m]),
        };
        let [_, half_m, _] = self.half_extents_m(kind);
        Some([0.35 * radius_m - half_m, radius_m])
    }
}

/// Allowed values of the fields of `objects`, in the order of the structs.
pub(super) const OBJECT_FIELDS: &[(&str, Allowed)] = &[
    ("objects.limit", Range(0.0, 1024.0)),
    ("objects.car_model", Text),
    ("objects.monster_model", Text),
    ("objects.self_driving", Range(0.0, 1024.0)),
    ("objects.self_driving_m_per_s", Range(1.0, 60.0)),
    ("objects.self_driving_apart_m", Range(1.0, 1000.0)),
    ("objects.self_driving_kind", OneOf(VehicleKind::WORDS)),
    ("objects.balls", Range(0.0, 64.0)),
    ("objects.ball_radius_m", Range(0.1, 5.0)),
    ("objects.sled_outline_m", Places(3, 64, -20.0, 20.0)),
    ("objects.car.strike_height_m", Range(0.05, 5.0)),
    ("objects.car.lays_share", Range(0.0, 1.0)),
    ("objects.monster.strike_height_m", Range(0.05, 5.0)),
    ("objects.monster.lays_share", Range(0.0, 1.0)),
    ("objects.helicopter.strike_height_m", Range(0.05, 5.0)),
    ("objects.helicopter.lays_share", Range(0.0, 1.0)),
    ("objects.helicopter.wash_shape", Text),
    ("objects.sled.strike_height_m", Range(0.05, 5.0)),
    ("objects.sled.lays_share", Range(0.0, 1.0)),
    ("objects.ball.strike_height_m", Range(0.05, 5.0)),
    ("objects.ball.lays_share", Range(0.0, 1.0)),
    ("objects.walker.strike_height_m", Range(0.05, 5.0)),
    ("objects.walker.lays_share", Range(0.0, 1.0)),
];

/// Contact of a car with the grass: its wheels, and its floor above them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CarTread {
    /// Height h above the ground of its contact with the grass (m), Chen & Johan Eq. (12). Default 0.3, allowed 0.05..=5.
    pub strike_height_m: f32,
    /// Fraction of the bend under the wheels that stays, and rises with `grass.laid_recovery_secs`. Default 0.5, allowed 0..=1.
    pub lays_share: f32,
}

impl Default for CarTread {
    fn default() -> Self {
        Self { strike_height_m: 0.3, lays_share: 0.5 }
    }
}

/// Contact of a monster with the grass.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct MonsterTread {
    /// Height h above the ground of its contact with the grass (m), Chen & Johan Eq. (12). Default 0.4, allowed 0.05..=5.
    pub strike_height_m: f32,
    /// Fraction of the bend under its feet that stays, and rises with `grass.laid_recovery_secs`. Default 0.3, allowed 0..=1.
    pub lays_share: f32,
}

impl Default for MonsterTread {
    fn default() -> Self {
        Self { strike_height_m: 0.4, lays_share: 0.3 }
    }
}

/// Contact of a helicopter with the grass: its skids and hull on the ground, and its wash from above.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct HelicopterTread {
    /// Height h above the ground of its contact with the grass (m), Chen & Johan Eq. (12). Default 0.5, allowed 0.05..=5.
    pub strike_height_m: f32,
    /// Fraction of the bend under the skids that stays, and rises with `grass.laid_recovery_secs`. Default 0.5, allowed 0..=1.
    pub lays_share: f32,
    /// Directions of the wash: `outward`, `swirl` or a drawn PNG file, as `drawn_winds.shape`. Default `outward`.
    pub wash_shape: WindShape,
}

impl Default for HelicopterTread {
    fn default() -> Self {
        Self { strike_height_m: 0.5, lays_share: 0.5, wash_shape: WindShape::Outward }
    }
}

/// Contact of a sled with the grass.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SledTread {
    /// Height h above the ground of its contact with the grass (m), Chen & Johan Eq. (12). Default 0.3, allowed 0.05..=5.
    pub strike_height_m: f32,
    /// Fraction of the bend under its frame that stays, and rises with `grass.laid_recovery_secs`. Default 0.8, allowed 0..=1.
    pub lays_share: f32,
}

impl Default for SledTread {
    fn default() -> Self {
        Self { strike_height_m: 0.3, lays_share: 0.8 }
    }
}

/// Contact of a ball with the grass.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct BallTread {
    /// Height h above the ground of its contact with the grass (m), Chen & Johan Eq. (12). Default 0.3, allowed 0.05..=5.
    pub strike_height_m: f32,
    /// Fraction of the bend under it that stays, and rises with `grass.laid_recovery_secs`. Default 0.1, allowed 0..=1.
    pub lays_share: f32,
}

impl Default for BallTread {
    fn default() -> Self {
        Self { strike_height_m: 0.3, lays_share: 0.1 }
    }
}

/// Contact of a walker with the grass: its feet, each while it stands, and its legs above them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct WalkerTread {
    /// Height h above the ground of its contact with the grass (m), Chen & Johan Eq. (12). Default 0.3, allowed 0.05..=5.
    pub strike_height_m: f32,
    /// Fraction of the bend under its feet that stays, and rises with `grass.laid_recovery_secs`. Default 0.6, allowed 0..=1.
    pub lays_share: f32,
}

impl Default for WalkerTread {
    fn default() -> Self {
        Self { strike_height_m: 0.3, lays_share: 0.6 }
    }
}
