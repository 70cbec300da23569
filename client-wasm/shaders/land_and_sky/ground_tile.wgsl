// Ground tiles, leaves of a quadtree, shared by the ground and the shells.

import package::constants::{COARSER, FINER, RANGE_SIDES, TILE_CELLS};
import package::inputs::frame::frame;
import package::land_and_sky::ground::ground_height;

struct GroundTile {
    // North-west corner, X and Z (m).
    corner_m: vec2<f32>,
    side_m: f32,
    // Two bits for each border, from the lowest: west, east, north, south; 0, `COARSER` or `FINER`, as the neighbour is. Above them the kind of grass of
    // plain land.
    borders_and_kind: u32,
}

fn kind_of_plain(tile: GroundTile) -> u32 {
    return tile.borders_and_kind >> 8u;
}

struct TileVertex {
    p: vec2<f32>,
    // Progress of the morph to the next coarser grid, 0..1.
    morph: f32,
}

// Vertex `index` of a tile. Odd vertices move onto the next coarser grid before that takes over (Strugar 2009); on a border they are where the
// coarser of both tiles has them, so that no crack opens. Vertices of the coarser tile jump back when its neighbour splits, far from the eye.
fn tile_vertex(tile: GroundTile, index: u32) -> TileVertex {
    let row = TILE_CELLS + 1u;
    let cell = vec2<u32>(index % row, index / row);
    let spacing_m = tile.side_m / f32(TILE_CELLS);
    let flat_p = tile.corner_m + vec2<f32>(cell) * spacing_m;
    let distance_m = length(vec3<f32>(flat_p.x, ground_height(flat_p), flat_p.y) - frame.eye_m);
    let by_distance = smoothstep(0.70, 0.95, distance_m / (RANGE_SIDES * tile.side_m));
    let is_end = vec4<bool>(cell.x == 0u, cell.x == TILE_CELLS, cell.y == 0u, cell.y == TILE_CELLS);
    // Corners are never odd.
    let shift = select(select(select(select(31u, 6u, is_end.w), 4u, is_end.z), 2u, is_end.y), 0u, is_end.x);
    let border = (tile.borders_and_kind >> shift) & 3u;
    let morph = select(select(by_distance, 0.0, border == FINER), 1.0, border == COARSER);
    return TileVertex(flat_p - vec2<f32>(cell & vec2<u32>(1u)) * spacing_m * morph, morph);
}
