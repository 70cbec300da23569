//! Car: a body on four sprung wheels with ray-cast suspension.

use super::ball::BALLS;
use crate::dynamics::{Airflow, ControlStep, Controller, VehicleDynamics, encoded};
use prairie_core::body::Prism;
use prairie_core::scene::Objects;
use prairie_core::wire::Drive;
use rapier3d::control::{DynamicRayCastVehicleController, WheelTuning};
use rapier3d::prelude::*;
use serde::{Deserialize, Serialize};

const MASS_KG: f32 = 1200.0;
/// Acceleration at full throttle from rest (m/s²); it decreases to zero at [`TOP_M_PER_S`].
const ACCELERATION_M_PER_S2: f32 = 7.0;
const TOP_M_PER_S: f32 = 32.0;
const TOP_BACKWARD_M_PER_S: f32 = 8.0;
/// Braking at full brake, and coasting (m/s²).
const BRAKE_M_PER_S2: f32 = 9.0;
const COAST_M_PER_S2: f32 = 0.8;
/// Speed below which a car without throttle brakes (m/s).
const PARK_M_PER_S: f32 = 1.5;
/// Largest steering angle (rad), and steering speed (rad/s).
const STEER_RAD: f32 = 0.55;
const STEER_RAD_PER_S: f32 = 1.8;
/// Lateral acceleration at full steering and speed (m/s²).
const CORNER_M_PER_S2: f32 = 6.5;
/// Distance between the axles (m).
const WHEELBASE_M: f32 = 2.8;
/// Time on its side or roof after which a car rolls back onto its wheels (s).
const OVERTURNED_SECS: f32 = 1.5;
/// Upward speed (m/s) and duration (s) of that roll.
const ROLL_M_PER_S: f32 = 4.5;
const ROLL_SECS: f32 = 0.8;

pub(super) const DYNAMICS: VehicleDynamics = VehicleDynamics {
    body,
    controller: |body, _, _| Box::new(Car::new(body)),
    prisms,
    airflow: Airflow::Wake,
    follows_terrain: false,
    is_round: false,
    stride_m: 0.0,
    trail_rgb: [255, 84, 66],
};

/// Controller of one car.
#[derive(Serialize, Deserialize)]
struct Car {
    wheels: DynamicRayCastVehicleController,
    steering_rad: f32,
    overturned_secs: f32,
}

/// Body with a low centre of mass; its collider leaves room for the wheels below.
fn body(_: &Objects) -> (RigidBodyBuilder, Vec<ColliderBuilder>) {
    let inertia = Vector::new(2100.0, 2300.0, 700.0);
    let mass = MassProperties::new(Vector::new(0.0, -0.4, 0.0), MASS_KG, inertia);
    let body = RigidBodyBuilder::dynamic().additional_mass_properties(mass).can_sleep(false);
    let collider = ColliderBuilder::cuboid(0.95, 0.5, 2.2).translation(Vector::new(0.0, 0.2, 0.0)).density(0.0).friction(0.4);
    (body, vec![collider, skirt()])
}

/// Wheels and bumpers, which collide with balls only.
fn skirt() -> ColliderBuilder {
    let groups = InteractionGroups::new(Group::GROUP_1, BALLS, InteractionTestMode::And);
    ColliderBuilder::cuboid(0.93, 0.3, 2.2).translation(Vector::new(0.0, -0.3, 0.0)).density(0.0).friction(0.4).collision_groups(groups)
}

fn prisms(_: &Objects) -> Vec<Prism> {
    let wheels = |x: f32| Prism::runner([x, -0.45, 0.0], [0.13, 0.25, 1.6]);
    vec![Prism::cuboid([0.0, 0.1, 0.0], [0.95, 0.5, 2.2]), wheels(-0.8), wheels(0.8)]
}

impl Car {
    fn new(chassis: RigidBodyHandle) -> Self {
        let mut wheels = DynamicRayCastVehicleController::new(chassis);
        wheels.index_up_axis = 1;
        wheels.index_forward_axis = 2;
        let tuning = WheelTuning {
            suspension_stiffness: 40.0,
            suspension_compression: 4.4,
            suspension_damping: 5.6,
            max_suspension_travel: 0.25,
            side_friction_stiffness: 1.0,
            friction_slip: 1.6,
            max_suspension_force: 1.0e5,
        };
        for (x, z) in [(-0.8, -0.5), (0.8, -0.5), (-0.8, 0.5), (0.8, 0.5)] {
            let hub = Vector::new(x, -0.05, z * WHEELBASE_M);
            wheels.add_wheel(hub, -Vector::Y, Vector::X, 0.36, 0.35, &tuning);
        }
        Self { wheels, steering_rad: 0.0, overturned_secs: 0.0 }
    }

    fn steer(&mut self, steer: f32, forward_m_per_s: f32, dt_secs: f32) {
        let grip_rad = WHEELBASE_M * CORNER_M_PER_S2 / (forward_m_per_s * forward_m_per_s).max(1.0);
        let target = steer * STEER_RAD.min(grip_rad);
        let reach = STEER_RAD_PER_S * dt_secs;
        self.steering_rad += (target - self.steering_rad).clamp(-reach, reach);
    }

    fn right_itself(&mut self, body: &mut RigidBody, dt_secs: f32) {
        let up = *body.rotation() * Vector::Y;
        let is_overturned = up.y < 0.4 && body.linvel().length() < 3.0;
        self.overturned_secs = if is_overturned { self.overturned_secs + dt_secs } else { 0.0 };
        if self.overturned_secs > OVERTURNED_SECS {
            self.overturned_secs = 0.0;
            let forward = *body.rotation() * -Vector::Z;
            let axis = if up.y > -0.9 { up.cross(Vector::Y).normalize_or_zero() } else { forward };
            let angle = up.y.clamp(-1.0, 1.0).acos();
            body.set_angvel(axis * (angle / ROLL_SECS), true);
            body.set_linvel(body.linvel() + Vector::Y * ROLL_M_PER_S, true);
        }
    }
}

impl Controller for Car {
    fn control(&mut self, drive: Drive, step: &mut ControlStep<'_>) {
        let ControlStep { dt_secs, physics, .. } = step;
        let dt_secs = *dt_secs;
        let chassis = self.wheels.chassis;
        let body = &mut physics.bodies[chassis];
        let forward_m_per_s = -(*body.rotation() * Vector::Z).dot(body.linvel());
        self.steer(drive.steer, forward_m_per_s, dt_secs);
        self.right_itself(body, dt_secs);

        let (engine, brake) = pedals(drive, forward_m_per_s);
        let steering = [-self.steering_rad, -self.steering_rad, 0.0, 0.0];
        for (wheel, steering) in self.wheels.wheels_mut().iter_mut().zip(steering) {
            wheel.steering = steering;
            wheel.engine_force = engine * 0.25 * MASS_KG;
            wheel.brake = brake * 0.25 * MASS_KG * dt_secs;
        }
        let filter = QueryFilter::only_fixed();
        let dispatcher = physics.narrow_phase.query_dispatcher();
        let queries = physics.broad_phase.as_query_pipeline_mut(dispatcher, &mut physics.bodies, &mut physics.colliders, filter);
        self.wheels.update_vehicle(dt_secs, queries);
    }

    fn assume(&mut self, _: Rotation, part_rad: f32) {
        (self.steering_rad, self.overturned_secs) = (part_rad, 0.0);
    }

    /// Steering of the front wheels (rad, + right).
    fn part_rad(&self) -> f32 {
        self.steering_rad
    }

    fn save(&self) -> Vec<u8> {
        encoded(self)
    }

    fn restore(&mut self, state: &[u8]) -> postcard::Result<()> {
        *self = postcard::from_bytes(state)?;
        Ok(())
    }
}

/// Acceleration by the engine and deceleration by the brakes (m/s²). Throttle against the motion brakes first.
fn pedals(drive: Drive, forward_m_per_s: f32) -> (f32, f32) {
    let top = if drive.throttle < 0.0 { TOP_BACKWARD_M_PER_S } else { TOP_M_PER_S };
    let along = forward_m_per_s * drive.throttle.signum();
    if drive.brake > 0.0 {
        (0.0, drive.brake * BRAKE_M_PER_S2)
    } else if drive.throttle == 0.0 {
        (0.0, if forward_m_per_s.abs() < PARK_M_PER_S { BRAKE_M_PER_S2 } else { COAST_M_PER_S2 })
    } else if along < -1.0 {
        (0.0, drive.throttle.abs() * BRAKE_M_PER_S2)
    } else {
        (drive.throttle * ACCELERATION_M_PER_S2 * (1.0 - along / top).max(0.0), 0.0)
    }
}
