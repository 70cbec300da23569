//! Cars, monsters and helicopters.

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
}

impl VehicleKind {
    /// All kinds, in the order of the client's buttons.
    pub const ALL: [Self; 3] = [Self::Car, Self::Monster, Self::Helicopter];

    /// Name as a scene file and the page write it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Car => "car",
            Self::Monster => "monster",
            Self::Helicopter => "helicopter",
        }
    }

    /// Half extents of the body's box along its own right, up and back axes (m).
    pub fn half_extents_m(self) -> [f32; 3] {
        match self {
            Self::Car => [0.95, 0.7, 2.2],
            Self::Monster => [0.6, 0.9, 0.6],
            Self::Helicopter => [1.1, 1.3, 3.4],
        }
    }

    /// Radius of the sphere that pushes near blades aside (000 §6.2) (m); it sits at the object's foot.
    pub fn interaction_radius_m(self) -> f32 {
        match self {
            Self::Car => 1.3,
            Self::Monster => 0.9,
            Self::Helicopter => 1.5,
        }
    }

    /// Height h above the ground at which the object strikes the grass (m), 001 Eq. (12).
    pub fn strike_height_m(self) -> f32 {
        match self {
            Self::Car => 0.3,
            Self::Monster => 0.4,
            Self::Helicopter => 0.5,
        }
    }
}

/// Limits and models of the objects.
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
    /// Cars that drive by themselves in circles, so that an empty prairie shows tracks. Default 0, allowed
    /// 0..=1024 and at most `limit`.
    pub self_driving: u32,
    /// Speed that these cars keep (m/s); they circle as narrowly as their grip lets them, some 50 m wide at the default and 180 m at 20. Default
    /// 11, allowed 1..=60; no car goes faster than 32.
    pub self_driving_m_per_s: f32,
    /// Distance at which they start from each other, about (m): the n-th stands √n times as far from the middle of the world. Default 4, allowed
    /// 1..=1000.
    pub self_driving_apart_m: f32,
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
        }
    }
}
