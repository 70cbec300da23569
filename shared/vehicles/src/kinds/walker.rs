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
/// Fastest ascent on foot (m/s). Steeper ground stops one as a wall does.
const CLIMB_M_PER_S: f32 = 2.5;
/// Twice the energy per mass (m²/s²) above which one who rises has jumped: no ascent on foot reaches it within a step of the ground, and every jump exceeds it
/// until it is higher.
const JUMP_M2_PER_S2: f32 = 12.5;
const _: () = assert!(CLIMB_M_PER_S * CLIMB_M_PER_S + 2.0 * GRAVITY_M_PER_S2 * STEP_M < JUMP_M2_PER_S2);
const _: () = assert!(JUMP_M2_PER_S2 < JUMP_M_PER_S * JUMP_M_PER_S);
const GRAVITY_M_PER_S2: f32 = 9.81;
/// Steepest slope that is climbed at full walking speed, as rise over run.
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

/// Whether one who rises at `rising_m_per_s` over the ground at a clearance (m) has left the ground by a jump.
fn has_jumped(rising_m_per_s: f32, clearance_m: f32) -> bool {
    rising_m_per_s > 0.0 && rising_m_per_s * rising_m_per_s + 2.0 * GRAVITY_M_PER_S2 * clearance_m > JUMP_M2_PER_S2
}

/// Takes from a velocity as much of its way uphill as rises faster than `limit_m_per_s`, and gives its rise along the ground (m/s).
fn keep_climbable(velocity: &mut Vector, slope: [f32; 2], limit_m_per_s: f32) -> f32 {
    let along_ground = slope[0] * velocity.x + slope[1] * velocity.z;
    if along_ground <= limit_m_per_s {
        return along_ground;
    }
    let excess = (along_ground - limit_m_per_s) / (slope[0] * slope[0] + slope[1] * slope[1]);
    velocity.x -= excess * slope[0];
    velocity.z -= excess * slope[1];
    limit_m_per_s
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
        // Downhill a jump rises from the ground that sinks below it: from its slope where the step began.
        let [from_x, from_z] = [at.x - velocity.x * dt_secs, at.z - velocity.z * dt_secs];
        let slope_before = terrain.slope([from_x, from_z]);
        let sinking = (slope_before[0] * velocity.x + slope_before[1] * velocity.z).min(0.0);
        let walks = clearance < STEP_M && !has_jumped(velocity.y - sinking, clearance);
        if walks {
            let forward = if drive.lift < -PRESSED { RUN_M_PER_S } else { WALK_M_PER_S };
            let walk = if drive.throttle < 0.0 { BACKWARD_M_PER_S } else { forward } * drive.throttle * (1.0 - drive.brake);
            let wanted = Vector::new(self.heading_rad.sin() * walk, 0.0, -self.heading_rad.cos() * walk);
            let rise = (slope[0] * wanted.x + slope[1] * wanted.z) / walk.abs().max(0.01);
            let change = wanted / (rise / CLIMB).max(1.0) - Vector::new(velocity.x, 0.0, velocity.z);
            velocity += change.clamp_length_max(ACCELERATION_M_PER_S2 * dt_secs);
            let footing = (-clearance * FOOTING_PER_S.min(1.0 / dt_secs)).min(CLIMB_M_PER_S);
            let along_ground = keep_climbable(&mut velocity, slope, CLIMB_M_PER_S - footing.max(0.0));
            // One jump for each press.
            let jumps = drive.lift > PRESSED && !self.is_jumping;
            velocity.y = along_ground + if jumps { JUMP_M_PER_S + footing.max(0.0) } else { footing };
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::environment::Environment;
    use crate::lone_vehicle::LoneVehicle;
    use prairie_core::scene::{Scene, TerrainMaps};
    use prairie_core::terrain::{CoverMap, HeightMap, grey_png};
    use std::sync::Arc;

    /// Pixels of the terrain (m) and its side (m).
    const PIXEL_M: [f32; 2] = [0.5, 8.0];
    const SIDE_M: f32 = 48.0;
    /// Where the ground begins to rise (m).
    const FOOT_M: f32 = 16.0;

    /// Highest clearance (m) of a run to the east over a rise by `slope` up to `top_m` further east, then on at `slope_beyond`, and the place it reaches (m).
    /// Beyond `jumps_at_m` the jump is pressed.
    fn run(slope: f32, top_m: f32, slope_beyond: f32, jumps_at_m: f32) -> (f32, f32) {
        let [width_px, depth_px] = PIXEL_M.map(|pixel| (SIDE_M / pixel) as u32 + 1);
        let height_m = |x: f32| slope * (x - FOOT_M).clamp(0.0, top_m) + slope_beyond * (x - FOOT_M - top_m).max(0.0);
        let heights_m = (0..width_px * depth_px).map(|i| height_m((i % width_px) as f32 * PIXEL_M[0])).collect();
        let height = Arc::new(HeightMap::from_heights(width_px, depth_px, PIXEL_M, heights_m));
        let cover = Arc::new(CoverMap::from_png(&grey_png([2; 2], &[255; 4])).unwrap());
        let maps = TerrainMaps { height_map: String::new(), covering_map: String::new(), pixel_m: PIXEL_M, level_m: 0.1, base_m: 0.0 };
        let environment = Environment { height: height.clone(), cover, extent_m: [SIDE_M; 2] };
        let mut walker = LoneVehicle::new(&Scene::new(maps), environment, VehicleKind::Walker);
        walker.place([8.0, HALF_HEIGHT_M, 20.0], TAU / 4.0);
        let (mut highest_m, mut x) = (0.0_f32, 8.0);
        for _ in 0..1200 {
            let lift = if x > jumps_at_m { 1.0 } else { -1.0 };
            walker.step(Drive { throttle: 1.0, lift, ..Drive::default() }, |_| [0.0; 3]);
            let at_m = walker.motion().pose.position_m;
            x = at_m[0];
            highest_m = highest_m.max(at_m[1] - HALF_HEIGHT_M - height.height_m(x, at_m[2]));
            if x > SIDE_M - 6.0 {
                break;
            }
        }
        (highest_m, x)
    }

    #[test]
    fn steep_ground_throws_no_walker_up() {
        for (slope, top_m, slope_beyond) in
            [(0.7, 6.0, 0.0), (0.7, 6.0, -0.7), (3.0, 3.0, 0.0), (4.0, 3.0, 0.0), (5.0, 3.0, 0.0), (-0.7, 6.0, 0.7)]
        {
            let (highest_m, x) = run(slope, top_m, slope_beyond, f32::MAX);
            assert!(highest_m < STEP_M, "slopes {slope} and {slope_beyond}: {highest_m} m above the ground");
            assert!(x > SIDE_M - 6.0, "slopes {slope} and {slope_beyond}: stops at {x} m");
        }
    }

    #[test]
    fn a_jump_rises_above_a_step_on_any_slope() {
        for (slope, slope_beyond) in [(0.0, 0.0), (0.7, 0.0), (-0.7, 0.0), (0.5, 0.5)] {
            let (highest_m, _) = run(slope, 6.0, slope_beyond, FOOT_M + 2.0);
            assert!((0.5..1.2).contains(&highest_m), "slopes {slope} and {slope_beyond}: {highest_m} m above the ground");
        }
    }
}
