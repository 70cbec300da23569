//! Properties that every kind of vehicle defines.

use crate::render::inputs::lamps::SpotLight;
use crate::render::solids::mesh::Solid;
use glam::{Affine3A, Quat, Vec3};
use prairie_core::scene::Objects;
use prairie_core::wire::ObjectPose;

/// Model of a kind of vehicle. Forward is −Z.
pub(crate) struct VehicleModel {
    /// Shapes of its parts. The first is the body; a custom model of the scene replaces it, and the other parts are left out.
    pub(crate) parts: fn(&Objects) -> Vec<Solid>,
    /// Parts, by their number, with their positions in the vehicle's frame. A part may be placed several times.
    pub(crate) place: fn(&ObjectPose, Motion) -> Vec<(usize, Affine3A)>,
    /// Headlights that are lit when it is dark.
    pub(crate) headlights: fn(&ObjectPose) -> Vec<SpotLight>,
    pub(crate) wind_blocking: WindBlocking,
}

/// Motion that the pose of a vehicle does not include.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Motion {
    /// Distance travelled forward (m).
    pub(crate) rolled_m: f32,
    pub(crate) time_secs: f32,
}

/// How a vehicle blocks the wind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum WindBlocking {
    /// Like its collision box, which stops this fraction of the wind's force.
    Box(f32),
    /// Like a solid sphere of the scene's ball radius.
    Sphere,
}

/// A part at a position in the frame of its vehicle.
pub(super) fn part(number: usize, position_m: Vec3, rotation: Quat) -> (usize, Affine3A) {
    (number, Affine3A::from_rotation_translation(rotation, position_m))
}
