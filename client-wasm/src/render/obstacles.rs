//! What stands or moves in the wind about the camera, as the force field takes it: trunks and crowns, stones, and vehicles.

use super::flora::{self, Standing};
use crate::state::Land;
use glam::{Quat, Vec3};
use shared::plant::force_field::{Mesh, Obstacle};
use shared::scene::{Objects, VehicleKind};
use shared::wire::ObjectPose;

/// Least width of what counts (m).
const LEAST_M: f32 = 0.2;
/// Radius of a stone, over its size.
const STONE_SHARE: f32 = 0.4;
/// Share of the wind's force that 2 m of a crown stop: 1 − e^(−2·0.2·0.6·2) at a drag coefficient of 0.2 for leaves of 0.6 m²/m³.
const CROWN_STOPS: f32 = 0.38;

/// Trees and stones of a world.
pub(super) struct Still {
    /// By their X.
    obstacles: Vec<Obstacle>,
    /// How far one reaches along X or Z at most (m).
    reach_m: f32,
}

impl Still {
    /// Of what stands on a land, as far as it is wide enough to count.
    pub(super) fn new(land: &Land, standing: &[Standing]) -> Self {
        let all = standing.iter().flat_map(|standing| of_standing(land, standing));
        let mut obstacles: Vec<Obstacle> = all.filter(|obstacle| 2.0 * obstacle.half_m[0] >= LEAST_M).collect();
        obstacles.sort_by(|a, b| a.at_m[0].total_cmp(&b.at_m[0]));
        let reach_m = obstacles.iter().map(|obstacle| obstacle.half_m[0]).fold(0.0, f32::max);
        Self { obstacles, reach_m }
    }

    /// Those that may reach into a mesh.
    pub(super) fn near(&self, mesh: Mesh) -> impl Iterator<Item = Obstacle> {
        let last = mesh.count.map(|count| count - 1);
        let (low_m, high_m) = (mesh.center_m([0; 3]), mesh.center_m(last));
        let margin_m = |axis: usize| self.reach_m + mesh.spacing_m[axis];
        let (low, high) = ([0, 2].map(|axis| low_m[axis] - margin_m(axis)), [0, 2].map(|axis| high_m[axis] + margin_m(axis)));
        let first = self.obstacles.partition_point(|obstacle| obstacle.at_m[0] < low[0]);
        let to_last = self.obstacles[first..].iter().take_while(move |obstacle| obstacle.at_m[0] <= high[0]);
        to_last.filter(move |obstacle| (low[1]..=high[1]).contains(&obstacle.at_m[2])).copied()
    }
}

/// A stone, or a tree's trunk and crown.
fn of_standing(land: &Land, standing: &Standing) -> impl Iterator<Item = Obstacle> + use<> {
    let Vec3 { x, y, z } = standing.position_m;
    let (size_m, tall_m) = (standing.size_m, standing.world_from_model.y_axis.length());
    let foot_m = y - land.heights().height_m(x, z);
    let round = |above_m: f32, wide_m: f32, half_m: f32| Obstacle::round([x, foot_m + above_m, z], [wide_m, half_m, wide_m]);
    let both = if standing.is_tree {
        let crown = flora::crown(standing.shape);
        let trunk_m = 0.5 * crown.low * tall_m;
        let trunk = Obstacle { half_m: [flora::GIRTH * size_m, trunk_m, flora::GIRTH * size_m], ..round(trunk_m, 1.0, 1.0) };
        let middle_m = 0.5 * (crown.low + crown.high) * tall_m;
        let crown = round(middle_m, crown.wide * size_m, 0.5 * (crown.high - crown.low) * tall_m);
        [Some(trunk), Some(Obstacle { stops: CROWN_STOPS, ..crown })]
    } else {
        [Some(round(0.0, STONE_SHARE * size_m, STONE_SHARE * tall_m)), None]
    };
    both.into_iter().flatten()
}

/// A vehicle, upright as it is on level land.
pub(super) fn of_pose(land: &Land, pose: &ObjectPose) -> Obstacle {
    let [x, y, z] = pose.position_m;
    let at_m = [x, y - land.heights().height_m(x, z), z];
    let objects: &Objects = &land.scene().objects;
    if pose.kind == VehicleKind::Ball {
        return Obstacle::round(at_m, [objects.ball_radius_m; 3]);
    }
    let right = (Quat::from_array(pose.rotation) * Vec3::X * Vec3::new(1.0, 0.0, 1.0)).normalize_or(Vec3::X);
    // Of their boxes limbs, and a tail and skids, leave much open.
    let stops = match pose.kind {
        VehicleKind::Monster => 0.7,
        VehicleKind::Helicopter => 0.5,
        VehicleKind::Car | VehicleKind::Sled | VehicleKind::Ball => 1.0,
    };
    Obstacle { at_m, half_m: objects.half_extents_m(pose.kind), along: [right.x, right.z], stops }
}
