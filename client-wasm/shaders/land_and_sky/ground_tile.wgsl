// Ground tiles, leaves of a quadtree, shared by the ground and the shells.

struct GroundTile {
    // North-west corner, X and Z (m).
    corner_m: vec2<f32>,
    side_m: f32,
    // Distance at which the next coarser grid takes over (m).
    coarser_from_m: f32,
}
