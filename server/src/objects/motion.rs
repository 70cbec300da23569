//! Where objects were and are, for the grass and the wind.

use glam::{Quat, Vec3};
use shared::scene::VehicleKind;
use thiserror::Error;

/// Position and orientation of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stand {
    /// Centre of the body's box (m).
    pub position_m: [f32; 3],
    /// Unit quaternion (x, y, z, w); the body's own axes are right +X, up +Y, forward −Z.
    pub rotation: [f32; 4],
}

impl Stand {
    /// Position on the ground (m).
    pub fn xz(&self) -> [f32; 2] {
        [self.position_m[0], self.position_m[2]]
    }

    /// World position (m) of a point given in the body's axes (m).
    pub fn point_m(&self, local_m: [f32; 3]) -> Vec3 {
        Vec3::from_array(self.position_m) + Quat::from_array(self.rotation) * Vec3::from_array(local_m)
    }
}

/// What an object did in one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// What it is.
    pub kind: VehicleKind,
    /// Before the step.
    pub from: Stand,
    /// After it.
    pub to: Stand,
    /// Velocity after it (m/s), which moves the air; the grass goes by the way from one stand to the other.
    pub velocity_m_per_s: [f32; 3],
    /// Whether it has lain still for a while, until something moves it.
    pub rests: bool,
}

/// Farthest that an object moves in one step (m): the fastest one in the longest step goes 9 m.
const WAY_LIMIT_M: f32 = 100.0;
/// How far the square of a unit quaternion's length may be from 1.
const UNIT_SLACK: f32 = 0.01;

/// Why a motion is none.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum MotionError {
    /// A vector that holds what is no number.
    #[error("`{field}` of a {} is {value:?}; allowed: finite numbers", .kind.name())]
    NotFinite {
        /// What moves.
        kind: VehicleKind,
        /// Which part of the motion, such as `velocity_m_per_s`.
        field: &'static str,
        /// What it holds.
        value: Vec<f32>,
    },
    /// A rotation that is no unit quaternion.
    #[error("`{field}` of a {} is {value:?}; allowed: a unit quaternion", .kind.name())]
    NotUnit {
        /// What moves.
        kind: VehicleKind,
        /// Which part of the motion.
        field: &'static str,
        /// What it holds.
        value: [f32; 4],
    },
    /// A leap.
    #[error("a {} moves {way_m:.1} m in one step; allowed: up to {WAY_LIMIT_M} m", .kind.name())]
    TooFar {
        /// What moves.
        kind: VehicleKind,
        /// How far (m).
        way_m: f32,
    },
}

impl Motion {
    /// The same way without any turning.
    pub fn unturned(&self) -> Self {
        let unturned = |stand: Stand| Stand { rotation: Quat::IDENTITY.to_array(), ..stand };
        Self { from: unturned(self.from), to: unturned(self.to), ..*self }
    }

    /// Whether it is the motion of a body.
    ///
    /// # Errors
    /// [`MotionError`]: numbers that are none, a rotation that is no unit quaternion, or more than 100 m in one step.
    pub fn check(&self) -> Result<(), MotionError> {
        let Self { kind, from, to, velocity_m_per_s, .. } = *self;
        let vectors: [(&str, &[f32]); 5] = [
            ("from.position_m", &from.position_m),
            ("from.rotation", &from.rotation),
            ("to.position_m", &to.position_m),
            ("to.rotation", &to.rotation),
            ("velocity_m_per_s", &velocity_m_per_s),
        ];
        if let Some((field, value)) = vectors.into_iter().find(|(_, value)| !value.iter().all(|v| v.is_finite())) {
            return Err(MotionError::NotFinite { kind, field, value: value.to_vec() });
        }
        for (field, value) in [("from.rotation", from.rotation), ("to.rotation", to.rotation)] {
            if (Quat::from_array(value).length_squared() - 1.0).abs() > UNIT_SLACK {
                return Err(MotionError::NotUnit { kind, field, value });
            }
        }
        let way_m = Vec3::from_array(from.position_m).distance(Vec3::from_array(to.position_m));
        if way_m <= WAY_LIMIT_M { Ok(()) } else { Err(MotionError::TooFar { kind, way_m }) }
    }
}
