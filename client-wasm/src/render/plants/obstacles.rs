//! Obstacles in the wind for the force field: trunks, crowns, stones, models of the scene's own and vehicles.

use crate::render::solids::trees_and_stones;
use crate::render::solids::trees_and_stones::{PlacedKind, PlacedModel};
use crate::render::solids::vehicles::{WindBlocking, vehicle_model};
use crate::state::DecodedScene;
use glam::{Quat, Vec3};
use prairie_core::plant::force_field::{Obstacle, VolumeMesh};
use prairie_core::wire::ObjectPose;

/// Minimum width of an obstacle (m).
const LEAST_M: f32 = 0.2;
/// Radius of a stone relative to its size.
const STONE_RADIUS: f32 = 0.4;
/// Fraction of the wind's force that 2 m of a crown stop: 1 − e^(−2·0.2·0.6·2) at a drag coefficient of 0.2 for leaves of 0.6 m²/m³.
const CROWN_STOPS: f32 = 0.38;

/// Obstacles of all that the covering map of a scene places.
pub(crate) struct StaticObstacles {
    /// Sorted by X.
    obstacles: Vec<Obstacle>,
    /// Maximum extent of an obstacle along X or Z (m).
    reach_m: f32,
}

impl StaticObstacles {
    /// Obstacles of all models that are wide enough.
    pub(crate) fn new(decoded: &DecodedScene, placed: &[PlacedModel]) -> Self {
        let all = placed.iter().flat_map(|model| of_placed(decoded, model));
        let mut obstacles: Vec<Obstacle> = all.filter(|obstacle| 2.0 * obstacle.half_m[0].max(obstacle.half_m[2]) >= LEAST_M).collect();
        obstacles.sort_by(|a, b| a.at_m[0].total_cmp(&b.at_m[0]));
        let reach_m = obstacles.iter().map(reach_m).fold(0.0, f32::max);
        Self { obstacles, reach_m }
    }

    /// Obstacles that may reach into a mesh.
    pub(crate) fn near(&self, mesh: VolumeMesh) -> impl Iterator<Item = Obstacle> {
        let last = mesh.count.map(|count| count - 1);
        let (low_m, high_m) = (mesh.center_m([0; 3]), mesh.center_m(last));
        let margin_m = |axis: usize| self.reach_m + mesh.spacing_m[axis];
        let (low, high) = ([0, 2].map(|axis| low_m[axis] - margin_m(axis)), [0, 2].map(|axis| high_m[axis] + margin_m(axis)));
        let first = self.obstacles.partition_point(|obstacle| obstacle.at_m[0] < low[0]);
        let to_last = self.obstacles[first..].iter().take_while(move |obstacle| obstacle.at_m[0] <= high[0]);
        to_last.filter(move |obstacle| (low[1]..=high[1]).contains(&obstacle.at_m[2])).copied()
    }
}

/// Maximum extent of an obstacle along X or Z (m), whatever its direction.
fn reach_m(obstacle: &Obstacle) -> f32 {
    let ([half_x, _, half_z], [c, s]) = (obstacle.half_m, obstacle.along.map(f32::abs));
    (c * half_x + s * half_z).max(s * half_x + c * half_z)
}

/// A stone, the box of a model, or a tree's trunk and crown.
fn of_placed(decoded: &DecodedScene, model: &PlacedModel) -> impl Iterator<Item = Obstacle> + use<> {
    let Vec3 { x, y, z } = model.position_m;
    let (size_m, tall_m) = (model.size_m, model.world_from_model.y_axis.length());
    let foot_m = y - decoded.heights().height_m(x, z);
    let round = |above_m: f32, wide_m: f32, half_m: f32| Obstacle::round([x, foot_m + above_m, z], [wide_m, half_m, wide_m]);
    let both = if model.kind == PlacedKind::Own {
        let [half_x, half_y, half_z] = decoded.scene().models[model.shape as usize].size_m.map(|side_m| 0.5 * side_m);
        let [right, up, back] = [model.world_from_model.x_axis, model.world_from_model.y_axis, model.world_from_model.z_axis];
        let along = right.truncate().normalize_or(Vec3::X);
        let half_m = [half_x * right.length(), half_y * up.length(), half_z * back.length()];
        [Some(Obstacle { at_m: [x, foot_m, z], half_m, along: [along.x, along.z], stops: 1.0 }), None]
    } else if model.is_tree() {
        let crown = trees_and_stones::crown(model.shape);
        let trunk_m = 0.5 * crown.low * tall_m;
        let trunk =
            Obstacle { half_m: [trees_and_stones::GIRTH * size_m, trunk_m, trees_and_stones::GIRTH * size_m], ..round(trunk_m, 1.0, 1.0) };
        let middle_m = 0.5 * (crown.low + crown.high) * tall_m;
        let crown = round(middle_m, crown.wide * size_m, 0.5 * (crown.high - crown.low) * tall_m);
        [Some(trunk), Some(Obstacle { stops: CROWN_STOPS, ..crown })]
    } else {
        [Some(round(0.0, STONE_RADIUS * size_m, STONE_RADIUS * tall_m)), None]
    };
    both.into_iter().flatten()
}

/// Obstacle of a vehicle, upright as on level land.
pub(crate) fn of_pose(decoded: &DecodedScene, pose: &ObjectPose) -> Obstacle {
    let [x, y, z] = pose.position_m;
    let at_m = [x, y - decoded.heights().height_m(x, z), z];
    let objects = &decoded.scene().objects;
    match vehicle_model(pose.kind).wind_blocking {
        WindBlocking::Sphere => Obstacle::round(at_m, [objects.ball_radius_m; 3]),
        WindBlocking::Box(stops) => {
            let right = (Quat::from_array(pose.rotation) * Vec3::X * Vec3::new(1.0, 0.0, 1.0)).normalize_or(Vec3::X);
            Obstacle { at_m, half_m: objects.half_extents_m(pose.kind), along: [right.x, right.z], stops }
        }
    }
}
