//! Sled: a gliding frame of any outline. Its velocity is set directly, and its floor follows the slope of the terrain.

use crate::dynamics::{Airflow, ControlStep, Controller, VehicleDynamics, encoded, heading_rad};
use crate::terrain_colliders::TERRAIN;
use prairie_core::body::Prism;
use prairie_core::outline::convex_parts;
use prairie_core::scene::{Objects, VehicleKind};
use prairie_core::wire::Drive;
use rapier3d::prelude::*;
use serde::{Deserialize, Serialize};
use std::f32::consts::TAU;

const GLIDE_M_PER_S: f32 = 15.0;
const BACKWARD_M_PER_S: f32 = 4.0;
const TURN_RAD_PER_S: f32 = 1.4;
/// Lateral acceleration at full steering and speed (m/s²).
const CORNER_M_PER_S2: f32 = 7.0;
/// Rate of change of the speed (m/s²).
const ACCELERATION_M_PER_S2: f32 = 6.0;
/// Gap between the floor and the terrain (m).
const GAP_M: f32 = 0.1;
/// Clearance above the gap below which the floor still glides on the terrain (m).
const STEP_M: f32 = 0.4;
/// Rates at which the floor approaches the terrain and its slope (1/s).
const FOOTING_PER_S: f32 = 12.0;
const TILTING_PER_S: f32 = 6.0;
/// Steepest slope that is climbed at full speed, as rise over run.
const CLIMB: f32 = 0.8;
const MASS_KG: f32 = 600.0;

pub(super) const DYNAMICS: VehicleDynamics = VehicleDynamics {
    body,
    controller: |body, objects, heading_rad| Box::new(Sled { body, half_height_m: half_height_m(objects), heading_rad, up: Vector::Y }),
    prisms,
    airflow: Airflow::Wake,
    follows_terrain: true,
    is_round: false,
    stride_m: 0.0,
    trail_rgb: [255, 202, 40],
};

/// Controller of one sled.
#[derive(Serialize, Deserialize)]
struct Sled {
    body: RigidBodyHandle,
    half_height_m: f32,
    heading_rad: f32,
    up: Vector,
}

fn half_height_m(objects: &Objects) -> f32 {
    objects.half_extents_m(VehicleKind::Sled)[1]
}

/// The convex parts of the outline as upright prisms. They do not collide with the terrain, since the floor follows it.
fn body(objects: &Objects) -> (RigidBodyBuilder, Vec<ColliderBuilder>) {
    let half_m = half_height_m(objects);
    let prism = |corners_m: Vec<[f32; 2]>| {
        let points: Vec<_> = corners_m.iter().flat_map(|&[x, z]| [-half_m, half_m].map(|y| Vector::new(x, y, z))).collect();
        SharedShape::convex_hull(&points).map(|shape| (Pose::IDENTITY, shape))
    };
    let prisms = convex_parts(&objects.sled_outline_m).into_iter().filter_map(|part| prism(part.corners_m)).collect();
    let groups = InteractionGroups::new(Group::GROUP_1, Group::ALL & !TERRAIN, InteractionTestMode::And);
    let collider = ColliderBuilder::compound(prisms).mass(MASS_KG).friction(0.1).collision_groups(groups);
    (RigidBodyBuilder::dynamic().lock_rotations().can_sleep(false), vec![collider])
}

fn prisms(objects: &Objects) -> Vec<Prism> {
    let half_m = half_height_m(objects);
    convex_parts(&objects.sled_outline_m).into_iter().map(|part| Prism::slab(part, half_m)).collect()
}

impl Controller for Sled {
    fn control(&mut self, drive: Drive, step: &mut ControlStep<'_>) {
        let ControlStep { dt_secs, physics, terrain, .. } = step;
        let dt_secs = *dt_secs;
        let body = &mut physics.bodies[self.body];
        let (at, mut velocity) = (body.translation(), body.linvel());
        let (below, slope) = (terrain.height_m([at.x, at.z]), terrain.slope([at.x, at.z]));

        let speed = velocity.x.hypot(velocity.z);
        let turn = drive.steer * TURN_RAD_PER_S.min(CORNER_M_PER_S2 / speed.max(1.0));
        self.heading_rad = (self.heading_rad + turn * dt_secs) % TAU;
        let upward = Vector::new(-slope[0], 1.0, -slope[1]).normalize_or(Vector::Y);
        self.up = (self.up + (upward - self.up) * (TILTING_PER_S * dt_secs).min(1.0)).normalize_or(Vector::Y);
        body.set_rotation(Rotation::from_rotation_arc(Vector::Y, self.up) * Rotation::from_rotation_y(-self.heading_rad), true);

        let clearance = at.y - self.half_height_m - GAP_M - below;
        let glides = clearance < STEP_M;
        if glides {
            let fastest = if drive.throttle < 0.0 { BACKWARD_M_PER_S } else { GLIDE_M_PER_S };
            let glide = fastest * drive.throttle * (1.0 - drive.brake);
            let wanted = Vector::new(self.heading_rad.sin() * glide, 0.0, -self.heading_rad.cos() * glide);
            let rise = (slope[0] * wanted.x + slope[1] * wanted.z) / glide.abs().max(0.01);
            let change = wanted / (rise / CLIMB).max(1.0) - Vector::new(velocity.x, 0.0, velocity.z);
            velocity += change.clamp_length_max(ACCELERATION_M_PER_S2 * dt_secs);
            velocity.y = slope[0] * velocity.x + slope[1] * velocity.z - clearance * FOOTING_PER_S.min(1.0 / dt_secs);
        }
        body.set_linvel(velocity, true);
        body.set_gravity_scale(if glides { 0.0 } else { 1.0 }, true);
    }

    fn assume(&mut self, rotation: Rotation, _: f32) {
        self.up = rotation * Vector::Y;
        self.heading_rad = heading_rad(Rotation::from_rotation_arc(Vector::Y, self.up).inverse() * rotation);
    }

    fn save(&self) -> Vec<u8> {
        encoded(self)
    }

    fn restore(&mut self, state: &[u8]) -> postcard::Result<()> {
        *self = postcard::from_bytes(state)?;
        Ok(())
    }
}
