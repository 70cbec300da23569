//! Ball: a light sphere that objects and strong wind push along, and that a driver rolls from within.

use crate::dynamics::{Airflow, ControlStep, Controller, VehicleDynamics, encoded};
use prairie_core::body::Prism;
use prairie_core::plant::force_field::AIR_KG_PER_M3;
use prairie_core::scene::Objects;
use prairie_core::wire::Drive;
use rapier3d::prelude::*;
use serde::{Deserialize, Serialize};
use std::f32::consts::{PI, TAU};

/// Collision group of balls.
pub(super) const BALLS: Group = Group::GROUP_3;

const DENSITY_KG_PER_M3: f32 = 8.0;
const LEAST_MASS_KG: f32 = 1.0;
const RESTITUTION: f32 = 0.5;
/// Drag coefficient of a sphere, times half the density of air (kg/m³).
const DRAG_KG_PER_M3: f32 = 0.5 * AIR_KG_PER_M3 * 0.47;
/// Deceleration by rolling through grass, and additional deceleration at full brake (m/s²).
const ROLLING_M_PER_S2: f32 = 0.8;
const BRAKE_M_PER_S2: f32 = 5.0;
/// Target speed at full throttle (m/s), and acceleration towards it (m/s²). Drag keeps a light ball below the target.
const FASTEST_M_PER_S: f32 = 15.0;
const ACCELERATION_M_PER_S2: f32 = 6.0;
const TURN_RAD_PER_S: f32 = 2.0;
/// Largest gap below the ball at which it still rolls on the terrain (m).
const GAP_M: f32 = 0.05;
/// Moment of inertia of a solid sphere about its contact point, in units of m·r².
const ROLLING_INERTIA: f32 = 1.4;

/// Heights of the slices in which a ball meets the grass, in units of its radius. Each slice is about twice as wide as the next.
const SLICES: [f32; 5] = [1.0, 0.25, 0.0625, 0.015_625, 0.003_906_25];

pub(super) const DYNAMICS: VehicleDynamics = VehicleDynamics {
    body: |objects| body(objects.ball_radius_m),
    controller: |body, objects, heading_rad| Box::new(Ball::new(body, objects.ball_radius_m, heading_rad)),
    prisms,
    airflow: Airflow::Negligible,
    follows_terrain: false,
    is_round: true,
    stride_m: 0.0,
    trail_rgb: [240, 240, 240],
};

/// Controller of one ball.
#[derive(Serialize, Deserialize)]
struct Ball {
    body: RigidBodyHandle,
    radius_m: f32,
    mass_kg: f32,
    heading_rad: f32,
}

/// Mass of a ball (kg).
fn mass_kg(radius_m: f32) -> f32 {
    (DENSITY_KG_PER_M3 * 4.0 / 3.0 * PI * radius_m * radius_m * radius_m).max(LEAST_MASS_KG)
}

/// A ball is fast for its size, so its body uses continuous collision detection.
fn body(radius_m: f32) -> (RigidBodyBuilder, Vec<ColliderBuilder>) {
    let groups = InteractionGroups::new(BALLS, Group::ALL, InteractionTestMode::And);
    let collider = ColliderBuilder::ball(radius_m).mass(mass_kg(radius_m)).friction(0.9).collision_groups(groups);
    let collider = collider.restitution(RESTITUTION).restitution_combine_rule(CoefficientCombineRule::Max);
    (RigidBodyBuilder::dynamic().ccd_enabled(true), vec![collider])
}

fn prisms(objects: &Objects) -> Vec<Prism> {
    let radius_m = objects.ball_radius_m;
    // At the height q·r above its foot a ball of radius r is r·√(2q − q²) wide; only slices lower than the grass touch it.
    let slice = |q: f32| Prism::post(radius_m * (2.0 * q - q * q).sqrt(), [(q - 1.0) * radius_m, radius_m]);
    SLICES.map(slice).to_vec()
}

impl Ball {
    fn new(body: RigidBodyHandle, radius_m: f32, heading_rad: f32) -> Self {
        Self { body, radius_m, mass_kg: mass_kg(radius_m), heading_rad }
    }
}

impl Controller for Ball {
    /// Applies the drag of wind and grass, and the driver's torque.
    fn control(&mut self, drive: Drive, step: &mut ControlStep<'_>) {
        let ControlStep { dt_secs, physics, terrain, wind_m_per_s } = step;
        let dt_secs = *dt_secs;
        self.heading_rad = (self.heading_rad + drive.steer * TURN_RAD_PER_S * dt_secs) % TAU;
        let body = &mut physics.bodies[self.body];
        let at = body.translation();
        let wind_m_per_s = wind_m_per_s(at.to_array());
        let [slope_x, slope_z] = terrain.slope([at.x, at.z]);
        let up = Vector::new(-slope_x, 1.0, -slope_z).normalize_or(Vector::Y);
        let rolls = (at.y - terrain.height_m([at.x, at.z])) * up.y - self.radius_m < GAP_M;

        let resistance_m_per_s2 = if rolls { ROLLING_M_PER_S2 + drive.brake * BRAKE_M_PER_S2 } else { 0.0 };
        let wind = if rolls { Vector::from_array(wind_m_per_s).reject_from_normalized(up) } else { Vector::from_array(wind_m_per_s) };
        let inertia_kg = if rolls { ROLLING_INERTIA * self.mass_kg } else { self.mass_kg };
        let drag_per_m = DRAG_KG_PER_M3 * PI * self.radius_m * self.radius_m / inertia_kg;
        // A ball at rest stays at rest while the rolling resistance exceeds the drag.
        let is_held = drag_per_m * wind.length_squared() <= resistance_m_per_s2 && drive.throttle == 0.0;
        if body.is_sleeping() && is_held {
            return;
        }
        let rolling = |velocity: Vector| if rolls { up.cross(velocity) / self.radius_m } else { Vector::ZERO };
        // Implicit in the drag, so that no step accelerates the ball beyond the wind. The spin follows as in rolling.
        let weight = drag_per_m * (wind - body.linvel()).length() * dt_secs;
        let blown = (body.linvel() + wind * weight) / (1.0 + weight);
        let spun = (body.angvel() + rolling(wind) * weight) / (1.0 + weight);
        let kept = 1.0 - (resistance_m_per_s2 * dt_secs / blown.length().max(1e-6)).min(1.0);
        body.set_linvel(blown * kept, !is_held);
        body.set_angvel(spun * kept, !is_held);
        if rolls && drive.throttle != 0.0 {
            let wanted = Vector::new(self.heading_rad.sin(), 0.0, -self.heading_rad.cos()) * (FASTEST_M_PER_S * drive.throttle);
            let change = (wanted - body.linvel()).clamp_length_max(ACCELERATION_M_PER_S2 * dt_secs);
            body.apply_torque_impulse(up.cross(change) * (ROLLING_INERTIA * self.mass_kg * self.radius_m), true);
        }
    }

    fn assume(&mut self, _: Rotation, part_rad: f32) {
        self.heading_rad = part_rad;
    }

    /// Heading of the driver (rad).
    fn part_rad(&self) -> f32 {
        self.heading_rad
    }

    fn save(&self) -> Vec<u8> {
        encoded(self)
    }

    fn restore(&mut self, state: &[u8]) -> postcard::Result<()> {
        *self = postcard::from_bytes(state)?;
        Ok(())
    }
}
