//! Trees and stones with a bound each, however they sway.

use super::flora::Standing;
use super::mesh::Solid;
use glam::Vec3;

/// Most that leaves flutter (m): 0.035 · 1.9 along (1, 0.6, −1), as `placed` in `objects.wgsl` has it.
const FLUTTER_M: f32 = 0.103;

/// A ball about a model, or about what stands somewhere.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ball {
    pub(super) middle_m: Vec3,
    pub(super) radius_m: f32,
}

impl Ball {
    /// About all shapes that a model has, its middle above its foot.
    pub(super) fn about<'a>(solids: impl Iterator<Item = &'a Solid>) -> Self {
        let places: Vec<Vec3> = solids.flat_map(|solid| &solid.vertices).map(|vertex| Vec3::from(vertex.position)).collect();
        let [low, high] = places.iter().fold([f32::MAX, f32::MIN], |[low, high], at| [low.min(at.y), high.max(at.y)]);
        let middle_m = Vec3::Y * (0.5 * (low + high));
        Self { middle_m, radius_m: places.iter().map(|at| at.distance(middle_m)).fold(0.0, f32::max) }
    }

    /// About what stands somewhere, whose model this is about, as far as the wind moves it.
    pub(super) fn of(self, standing: &Standing) -> Self {
        let placed = &standing.world_from_model;
        let [wide_m, tall_m, deep_m] = [placed.x_axis, placed.y_axis, placed.z_axis].map(|axis| axis.length());
        let [.., sway_rad] = standing.tint;
        // As `swayed` in `objects.wgsl` has it, for the top.
        let top = self.middle_m.y + self.radius_m;
        let swayed_m = tall_m * (sway_rad * top * top + 2.0 / 3.0 * sway_rad * sway_rad * top * top * top);
        let flutter_m = if standing.is_tree { FLUTTER_M } else { 0.0 };
        let radius_m = self.radius_m * wide_m.max(tall_m).max(deep_m) + swayed_m + flutter_m;
        Self { middle_m: placed.transform_point3(self.middle_m), radius_m }
    }

    /// Corners of the box about it.
    pub(super) fn corners_m(&self) -> [Vec3; 2] {
        [self.middle_m - self.radius_m, self.middle_m + self.radius_m]
    }
}
