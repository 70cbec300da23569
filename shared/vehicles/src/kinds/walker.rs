//! Walker: a visitor on foot, who walks, runs and jumps. Its velocity is set directly, and its feet follow the terrain.

use crate::dynamics::{Airflow, ControlStep, Controller, VehicleDynamics, encoded, heading_rad};
use crate::terrain_colliders::TERRAIN;
use prairie_core::body::Prism;
use prairie_core::scene::{Objects, VehicleKind};
use prairie_core::wire::Drive;
use rapier3d::prelude::*;
use serde::{Deserialize, Serialize};
use std::f32::consts::TAU;

const MASS_KG: f32 = 75.0;
/// Speeds at full throttle (m/s).
const WALK_M_PER_S: f32 = 1.8;
const RUN_M_PER_S: f32 = 5.0;
const BACKWARD_M_PER_S: f32 = 1.2;
/// Upward speed at the beginning of a jump (m/s), 0.65 m high.
const JUMP_M_PER_S: f32 = 3.6;
/// Lift input above which one jumps, and below whose opposite one runs.
const PRESSED: f32 = 0.5;
const TURN_RAD_PER_S: f32 = 2.4;
/// Rate of change of the walking speed (m/s²).
const ACCELERATION_M_PER_S2: f32 = 10.0;
/// Clearance below which the feet still walk on the terrain (m).
const STEP_M: f32 = 0.3;
/// Rate at which the feet approach the terrain (1/s).
const FOOTING_PER_S: f32 = 12.0;
/// Rising speed above which one has left the ground (m/s), faster than any path over the terrain.
const RISING_M_PER_S: f32 = 2.0;
/// Steepest slope that is climbed at full speed, as rise over run.
const CLIMB: f32 = 0.7;
const RADIUS_M: f32 = 0.25;
const HALF_HEIGHT_M: f32 = 0.9;
/// Distance of two steps (m).
const STRIDE_M: f32 = 2.0;
/// Distance of a foot from the middle, and half of its width, height and length (m).
const FOOT_ASIDE_M: f32 = 0.13;
const FOOT_HALF_M: [f32; 3] = [0.06, 0.05, 0.15];
/// Height of the hips over the ground (m); legs part only grass that is taller.
const HIPS_M: f32 = 0.6;

pub(super) const DYNAMICS: VehicleDynamics = VehicleDynamics {
    body,
    controller: |body, _, heading_rad| Box::new(Walker { body, heading_rad, phase_rad: 0.0, is_jumping: false }),
    prisms,
    airflow: Airflow::Negligible,
    follows_terrain: true,
    is_round: false,
    stride_m: STRIDE_M,
    trail_rgb: [129, 199, 132],
};

/// Controller of one walker.
#[derive(Serialize, Deserialize)]
struct Walker {
    body: RigidBodyHandle,
    heading_rad: f32,
    phase_rad: f32,
    is_jumping: bool,
}

/// The body does not collide with the terrain, since the feet follow it.
fn body(objects: &Objects) -> (RigidBodyBuilder, Vec<ColliderBuilder>) {
    let [radius_m, half_height_m, _] = objects.half_extents_m(VehicleKind::Walker);
    let groups = InteractionGroups::new(Group::GROUP_1, Group::ALL & !TERRAIN, InteractionTestMode::And);
    let collider = ColliderBuilder::capsule_y(half_height_m - radius_m, radius_m).mass(MASS_KG).friction(0.1).collision_groups(groups);
    (RigidBodyBuilder::dynamic().lock_rotations().can_sleep(false), vec![collider])
}

fn prisms(_: &Objects) -> Vec<Prism> {
    let foot = |x: f32| Prism::runner([x, FOOT_HALF_M[1] - HALF_HEIGHT_M, 0.0], FOOT_HALF_M);
    let trunk = Prism { bears_weight: false, ..Prism::post(RADIUS_M, [HIPS_M - HALF_HEIGHT_M, HALF_HEIGHT_M]) };
    vec![trunk, foot(-FOOT_ASIDE_M), foot(FOOT_ASIDE_M)]
}

impl Controller for Walker {
    fn control(&mut self, drive: Drive, step: &mut ControlStep<'_>) {
        let ControlStep { dt_secs, physics, terrain, .. } = step;
        let dt_secs = *dt_secs;
        let body = &mut physics.bodies[self.body];
        self.heading_rad = (self.heading_rad + drive.steer * TURN_RAD_PER_S * dt_secs) % TAU;
        body.set_rotation(Rotation::from_rotation_y(-self.heading_rad), true);

        let at = body.translation();
        let (below, slope) = (terrain.height_m([at.x, at.z]), terrain.slope([at.x, at.z]));
        let clearance = at.y - HALF_HEIGHT_M - below;
        let mut velocity = body.linvel();
        let along_ground = slope[0] * velocity.x + slope[1] * velocity.z;
        let walks = clearance < STEP_M && velocity.y - along_ground < RISING_M_PER_S;
        if walks {
            let forward = if drive.lift < -PRESSED { RUN_M_PER_S } else { WALK_M_PER_S };
            let walk = if drive.throttle < 0.0 { BACKWARD_M_PER_S } else { forward } * drive.throttle * (1.0 - drive.brake);
            let wanted = Vector::new(self.heading_rad.sin() * walk, 0.0, -self.heading_rad.cos() * walk);
            let rise = (slope[0] * wanted.x + slope[1] * wanted.z) / walk.abs().max(0.01);
            let change = wanted / (rise / CLIMB).max(1.0) - Vector::new(velocity.x, 0.0, velocity.z);
            velocity += change.clamp_length_max(ACCELERATION_M_PER_S2 * dt_secs);
            let along_ground = slope[0] * velocity.x + slope[1] * velocity.z;
            // One jump for each press.
            let jumps = drive.lift > PRESSED && !self.is_jumping;
            velocity.y = along_ground + if jumps { JUMP_M_PER_S } else { -clearance * FOOTING_PER_S.min(1.0 / dt_secs) };
            let covered = velocity.x.hypot(velocity.z) * dt_secs * if drive.throttle < 0.0 { -1.0 } else { 1.0 };
            self.phase_rad = (self.phase_rad + covered * TAU / STRIDE_M) % TAU;
            self.is_jumping = drive.lift > PRESSED;
        }
        body.set_linvel(velocity, true);
        body.set_gravity_scale(if walks { 0.0 } else { 1.0 }, true);
    }

    fn assume(&mut self, rotation: Rotation, part_rad: f32) {
        (self.heading_rad, self.phase_rad) = (heading_rad(rotation), part_rad);
    }

    /// Phase of the walk (rad): the left foot stands in the first half of a turn, the right one in the second.
    fn part_rad(&self) -> f32 {
        self.phase_rad
    }

    fn save(&self) -> Vec<u8> {
        encoded(self)
    }

    fn restore(&mut self, state: &[u8]) -> postcard::Result<()> {
        *self = postcard::from_bytes(state)?;
        Ok(())
    }
}
