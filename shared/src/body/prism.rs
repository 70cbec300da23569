//! Convex prisms, the parts of a vehicle's shape in contact with the grass.

use super::BodyPose;
use crate::outline::ConvexPart;
use serde::{Deserialize, Serialize};
use std::f32::consts::FRAC_1_SQRT_2;

/// A convex part of an object, as an upright prism in the body's axes. Concave objects are several prisms (Chen & Johan, §6).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Prism {
    /// Corners seen from above, in order from +X towards +Z: x to the right and z to the back (m).
    pub outline_m: Vec<[f32; 2]>,
    /// Whether the edge from each corner to the next is shared with another prism of the object.
    pub seams: Vec<bool>,
    /// Lowest and highest point along the body's up axis (m).
    pub span_m: [f32; 2],
    /// Whether it parts the grass sideways (Chen & Johan, Eq. 10) or only presses it down.
    pub parts_grass: bool,
    /// Whether it carries the object's weight and so flattens the grass for a while.
    pub bears_weight: bool,
}

impl Prism {
    /// A box about `center_m` (X, Y, Z).
    pub fn cuboid(center_m: [f32; 3], half_m: [f32; 3]) -> Self {
        let [x, y, z] = center_m;
        let [half_x, half_y, half_z] = half_m;
        let outline_m = vec![[x - half_x, z - half_z], [x + half_x, z - half_z], [x + half_x, z + half_z], [x - half_x, z + half_z]];
        Self { outline_m, seams: vec![false; 4], span_m: [y - half_y, y + half_y], parts_grass: true, bears_weight: false }
    }

    /// A row of wheels or a skid, which carries weight and only presses the grass down.
    pub fn runner(center_m: [f32; 3], half_m: [f32; 3]) -> Self {
        Self { parts_grass: false, bears_weight: true, ..Self::cuboid(center_m, half_m) }
    }

    /// An octagonal post, which carries weight and parts the grass.
    pub fn post(radius_m: f32, span_m: [f32; 2]) -> Self {
        let (r, d) = (radius_m, radius_m * FRAC_1_SQRT_2);
        let outline_m = vec![[r, 0.0], [d, d], [0.0, r], [-d, d], [-r, 0.0], [-d, -d], [0.0, -r], [d, -d]];
        Self { outline_m, seams: vec![false; 8], span_m, parts_grass: true, bears_weight: true }
    }

    /// A convex part of an outline, between ±`half_m`, which carries weight and parts the grass.
    pub fn slab(part: ConvexPart, half_m: f32) -> Self {
        Self { outline_m: part.corners_m, seams: part.seams, span_m: [-half_m, half_m], parts_grass: true, bears_weight: true }
    }

    /// Elevation of the lowest point (m) of a body at `pose`.
    pub fn lowest_m(&self, pose: &BodyPose) -> f32 {
        self.corners(pose, self.span_m).map(|corner| corner[1]).fold(f32::INFINITY, f32::min)
    }

    /// Corners in the world (m), at two heights along the body's up axis relative to the body's centre (m).
    pub fn corners(&self, pose: &BodyPose, heights_m: [f32; 2]) -> impl Iterator<Item = [f32; 3]> {
        self.outline_m.iter().flat_map(move |&[x, z]| heights_m.map(|y| pose.point_m([x, y, z])))
    }

    /// Centre of the floor in the world (m).
    pub fn foot_m(&self, pose: &BodyPose) -> [f32; 2] {
        let count = self.outline_m.len() as f32;
        let [x, z] = [0, 1].map(|axis| self.outline_m.iter().map(|corner| corner[axis]).sum::<f32>() / count);
        let foot = pose.point_m([x, self.span_m[0], z]);
        [foot[0], foot[2]]
    }
}
