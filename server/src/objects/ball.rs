//! A ball: a light sphere that whatever touches it sends off, and so does a gale, or that a visitor rolls from within.

use super::ground::Ground;
use rapier3d::prelude::*;
use shared::wire::Drive;
use std::f32::consts::{PI, TAU};

/// Members of the collision group of the balls.
pub(super) const BALLS: Group = Group::GROUP_3;

const DENSITY_KG_PER_M3: f32 = 8.0;
const LEAST_MASS_KG: f32 = 1.0;
const RESTITUTION: f32 = 0.5;
/// Drag coefficient of a sphere, times half the density of air (kg/m³).
const DRAG_KG_PER_M3: f32 = 0.5 * 1.2 * 0.47;
/// What grass takes from the speed of a ball that rolls through it, and what a driver's brakes take beside (m/s²).
const ROLLING_M_PER_S2: f32 = 0.8;
const BRAKE_M_PER_S2: f32 = 5.0;
/// Speed that a driver seeks at full throttle, and how hard (m/s, m/s²); drag lets a light ball reach less.
const FASTEST_M_PER_S: f32 = 15.0;
const ACCELERATION_M_PER_S2: f32 = 6.0;
const TURN_RAD_PER_S: f32 = 2.0;
/// A gap below the ball up to which it rolls on the land (m).
const GAP_M: f32 = 0.05;
/// Moment of inertia of a full sphere about the point that it rolls on, in units of m·r².
const ROLLING_SHARE: f32 = 1.4;

/// What moves one ball, beside what touches it.
pub(super) struct Ball {
    body: RigidBodyHandle,
    radius_m: f32,
    mass_kg: f32,
    heading_rad: f32,
}

/// Mass of a ball (kg).
fn mass_kg(radius_m: f32) -> f32 {
    (DENSITY_KG_PER_M3 * 4.0 / 3.0 * PI * radius_m * radius_m * radius_m).max(LEAST_MASS_KG)
}

/// Body of a ball. It flies fast for its size, so the way is swept for what it would pass through.
pub(super) fn body(radius_m: f32) -> (RigidBodyBuilder, ColliderBuilder) {
    let groups = InteractionGroups::new(BALLS, Group::ALL, InteractionTestMode::And);
    let collider = ColliderBuilder::ball(radius_m).mass(mass_kg(radius_m)).friction(0.9).collision_groups(groups);
    let collider = collider.restitution(RESTITUTION).restitution_combine_rule(CoefficientCombineRule::Max);
    (RigidBodyBuilder::dynamic().ccd_enabled(true), collider)
}

impl Ball {
    pub(super) fn new(body: RigidBodyHandle, radius_m: f32, heading_rad: f32) -> Self {
        Self { body, radius_m, mass_kg: mass_kg(radius_m), heading_rad }
    }

    /// Where its driver looks (rad).
    pub(super) fn heading_rad(&self) -> f32 {
        self.heading_rad
    }

    /// Gives its motion the drag of a wind and of the grass, and turns a driver's hands into a torque.
    pub(super) fn control(&mut self, drive: Drive, wind_m_per_s: [f32; 3], dt_secs: f32, physics: &mut PhysicsWorld, ground: &Ground) {
        self.heading_rad = (self.heading_rad + drive.steer * TURN_RAD_PER_S * dt_secs) % TAU;
        let body = &mut physics.bodies[self.body];
        let at = body.translation();
        let [slope_x, slope_z] = ground.slope([at.x, at.z]);
        let up = Vector::new(-slope_x, 1.0, -slope_z).normalize_or(Vector::Y);
        let rolls = (at.y - ground.height_m([at.x, at.z])) * up.y - self.radius_m < GAP_M;

        let resistance_m_per_s2 = if rolls { ROLLING_M_PER_S2 + drive.brake * BRAKE_M_PER_S2 } else { 0.0 };
        let wind = if rolls { Vector::from_array(wind_m_per_s).reject_from_normalized(up) } else { Vector::from_array(wind_m_per_s) };
        let inertia_kg = if rolls { ROLLING_SHARE * self.mass_kg } else { self.mass_kg };
        let drag_per_m = DRAG_KG_PER_M3 * PI * self.radius_m * self.radius_m / inertia_kg;
        // What lies still stays so while the grass holds it.
        let is_held = drag_per_m * wind.length_squared() <= resistance_m_per_s2 && drive.throttle == 0.0;
        if body.is_sleeping() && is_held {
            return;
        }
        let rolling = |velocity: Vector| if rolls { up.cross(velocity) / self.radius_m } else { Vector::ZERO };
        // Implicit in the drag, so that no step takes the ball past the wind; it turns as one that rolls with it.
        let share = drag_per_m * (wind - body.linvel()).length() * dt_secs;
        let blown = (body.linvel() + wind * share) / (1.0 + share);
        let spun = (body.angvel() + rolling(wind) * share) / (1.0 + share);
        let kept = 1.0 - (resistance_m_per_s2 * dt_secs / blown.length().max(1e-6)).min(1.0);
        body.set_linvel(blown * kept, !is_held);
        body.set_angvel(spun * kept, !is_held);
        if rolls && drive.throttle != 0.0 {
            let wanted = Vector::new(self.heading_rad.sin(), 0.0, -self.heading_rad.cos()) * (FASTEST_M_PER_S * drive.throttle);
            let change = (wanted - body.linvel()).clamp_length_max(ACCELERATION_M_PER_S2 * dt_secs);
            body.apply_torque_impulse(up.cross(change) * (ROLLING_SHARE * self.mass_kg * self.radius_m), true);
        }
    }
}
