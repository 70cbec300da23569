//! Interface between the physics and a kind of vehicle.

use super::terrain_colliders::TerrainColliders;
use prairie_core::body::Prism;
use prairie_core::scene::Objects;
use prairie_core::wire::Drive;
use rapier3d::prelude::*;

/// Definition of a kind of vehicle. Each kind has one file in `kinds`.
pub struct VehicleDynamics {
    /// Rigid body and colliders, for the scene's settings.
    pub body: fn(&Objects) -> (RigidBodyBuilder, Vec<ColliderBuilder>),
    /// Controller of a body that has just been placed with a heading (rad).
    pub controller: fn(RigidBodyHandle, &Objects, f32) -> Box<dyn Controller>,
    /// Prisms that can touch grass, higher ones first. A lower prism presses the grass that a higher one has bent.
    pub prisms: fn(&Objects) -> Vec<Prism>,
    /// Effect on the air.
    pub airflow: Airflow,
    /// Whether its floor follows the terrain below its centre. Others start on the highest terrain below them.
    pub follows_terrain: bool,
    /// Whether its rotation has no effect on the grass.
    pub is_round: bool,
    /// Distance of a walk cycle (m), as in [`Body`](prairie_core::body::Body); 0 for kinds without feet.
    pub stride_m: f32,
    /// Colour of its trail in recordings.
    pub trail_rgb: [u8; 3],
}

/// Effect of a vehicle on the air.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Airflow {
    /// A rotor blows air down.
    Downwash,
    /// The vehicle drags air along.
    Wake,
    /// Too little air to matter.
    Negligible,
}

/// Surroundings of a vehicle in one step.
pub struct ControlStep<'a> {
    /// Duration of the step (s).
    pub dt_secs: f32,
    /// Bodies and colliders of all objects.
    pub physics: &'a mut PhysicsWorld,
    /// The terrain.
    pub terrain: &'a TerrainColliders,
    /// Wind (m/s) at a position (m).
    pub wind_m_per_s: &'a dyn Fn([f32; 3]) -> [f32; 3],
}

/// Heading from north towards east (rad) of a rotation about the Y axis.
pub(crate) fn heading_rad(rotation: Rotation) -> f32 {
    -2.0 * libm::atan2f(rotation.y, rotation.w)
}

/// Encodes the state of a controller.
pub(crate) fn encoded(state: &impl serde::Serialize) -> Vec<u8> {
    postcard::to_allocvec(state).expect("a controller is plain data")
}

/// Moves one vehicle.
pub trait Controller: Send {
    /// Turns the driver's input into forces or velocities of the body.
    fn control(&mut self, drive: Drive, step: &mut ControlStep<'_>);

    /// The whole state, for a checkpoint.
    fn save(&self) -> Vec<u8>;

    /// Restores a state.
    ///
    /// # Errors
    /// When the bytes are not a state of this kind.
    fn restore(&mut self, state: &[u8]) -> postcard::Result<()>;

    /// Takes over a state as far as it is seen from outside: the body's rotation, and the angle of the moving part (rad).
    fn assume(&mut self, rotation: Rotation, part_rad: f32);

    /// Angle of the moving part (rad), as in [`ObjectPose`](prairie_core::wire::ObjectPose).
    fn part_rad(&self) -> f32 {
        0.0
    }
}
