//! Quadtree of ground tiles, finer near the camera.

use crate::render::gpu::constants::{COARSER, FINER, HILLS_FULL_M, HILLS_MEAN, HILLS_RANGE_M, HILLS_SLOPE, RANGE_SIDES, TILE_CELLS};
use crate::render::inputs::frustum::Frustum;
use bytemuck::{Pod, Zeroable};
use glam::{Vec2, Vec3, Vec3Swizzles};

/// Maximum number of tiles in a frame.
pub(crate) const TILE_LIMIT: usize = 1024;
/// Bounds of the hills beyond the edge of the map, relative to the map (m).
const HILLS_M: [f32; 2] = [-90.0, 160.0];

/// A leaf of the quadtree, as in `ground_tile.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct GroundTile {
    /// North-west corner, X and Z (m).
    pub(crate) corner_m: [f32; 2],
    pub(crate) side_m: f32,
    /// Two bits for each of [`BORDERS`], from the lowest: 0, [`COARSER`] or [`FINER`], as the neighbour is. Above them the kind of grass of plain land.
    pub(crate) borders_and_kind: u32,
}

/// Bits of the borders of a tile.
const BORDERS_BITS: u32 = 8;

/// Ways to the neighbours of a tile, in its sides.
const BORDERS: [[f32; 2]; 4] = [[-1.0, 0.0], [1.0, 0.0], [0.0, -1.0], [0.0, 1.0]];

impl GroundTile {
    /// The tile, with grass of one kind.
    pub(crate) fn with_kind(self, kind: u8) -> Self {
        Self { borders_and_kind: self.borders_and_kind | u32::from(kind) << BORDERS_BITS, ..self }
    }

    /// Kind of the grass of plain land.
    pub(crate) fn kind(&self) -> u8 {
        (self.borders_and_kind >> BORDERS_BITS) as u8
    }

    /// Block `number`, row by row, of a tile divided into `count` × `count` blocks. Without neighbours.
    pub(crate) fn part(&self, number: u32, count: u32) -> Self {
        let side_m = self.side_m / count as f32;
        let place = [number % count, number / count];
        Self { corner_m: std::array::from_fn(|axis| self.corner_m[axis] + place[axis] as f32 * side_m), side_m, borders_and_kind: 0 }
    }

    /// Smallest and largest horizontal distance from a position (m).
    pub(crate) fn distances_m(&self, at_m: Vec3) -> [f32; 2] {
        let low = Vec2::from(self.corner_m) - Vec2::new(at_m.x, at_m.z);
        let high = low + self.side_m;
        [low.max(-high).max(Vec2::ZERO).length(), low.abs().max(high.abs()).length()]
    }

    /// Whether all of it lies on a map of this extent.
    pub(crate) fn is_within(&self, extent_m: Vec2) -> bool {
        let low = Vec2::from(self.corner_m);
        low.cmpge(Vec2::ZERO).all() && (low + self.side_m).cmple(extent_m).all()
    }
}

/// Quadtree over the map and its surroundings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TerrainQuadtree {
    corner_m: Vec2,
    side_m: f32,
    finest_m: f32,
    extent_m: Vec2,
    /// Lowest and highest point of the map.
    height_m: [f32; 2],
    /// Maximum height of the grass.
    grass_m: f32,
}

impl TerrainQuadtree {
    /// Quadtree for a map of `extent_m` with pixels of `pixel_m`, heights within `height_m` and grass up to `grass_m`, and the visible hills beyond its edge.
    pub(crate) fn new(extent_m: [f32; 2], pixel_m: [f32; 2], height_m: [f32; 2], grass_m: f32, haze_m: f32) -> Self {
        let pixel = pixel_m[0].min(pixel_m[1]).clamp(1.0, 16.0);
        let finest_m = TILE_CELLS as f32 * pixel.log2().round().exp2();
        let beyond_m = (4.0 * haze_m).clamp(500.0, 8_000.0);
        let wanted = extent_m[0].max(extent_m[1]) + 2.0 * beyond_m;
        let mut side_m = finest_m;
        while side_m < wanted {
            side_m *= 2.0;
        }
        let corner_m = 0.5 * (Vec2::from(extent_m) - Vec2::splat(side_m));
        // Aligned to the finest tiles, so that the corner of the map is a vertex.
        let corner_m = (corner_m / finest_m).floor() * finest_m;
        Self { corner_m, side_m, finest_m, extent_m: extent_m.into(), height_m, grass_m }
    }

    /// Side of the finest tiles (m). Its multiples are corners of tiles.
    pub(crate) fn finest_m(&self) -> f32 {
        self.finest_m
    }

    /// The same square with finest tiles of at most `finest_m`.
    pub(crate) fn finer(&self, finest_m: f32) -> Self {
        Self { finest_m: finest_m.min(self.finest_m), ..*self }
    }

    /// Tiles in view, nearest first.
    pub(crate) fn tiles(&self, eye_m: Vec3, frustum: &Frustum) -> Vec<GroundTile> {
        let mut tiles = Vec::new();
        self.collect(self.corner_m, self.side_m, eye_m, frustum, &mut tiles);
        let distance =
            |tile: &GroundTile| (Vec2::from(tile.corner_m) + 0.5 * tile.side_m - Vec2::new(eye_m.x, eye_m.z)).length() - 0.7 * tile.side_m;
        tiles.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
        tiles.truncate(TILE_LIMIT);
        tiles
    }

    fn collect(&self, corner: Vec2, side: f32, eye: Vec3, frustum: &Frustum, tiles: &mut Vec<GroundTile>) {
        let [lowest, highest] = self.height_m;
        let between = |[below, above]: [f32; 2]| [corner.extend(lowest + below).xzy(), (corner + side).extend(highest + above).xzy()];
        let outside_m = (-corner).max(corner + side - self.extent_m).max(Vec2::ZERO).length();
        let [low, high] = between(hills_m(outside_m));
        if !frustum.sees_box(low, high + self.grass_m * Vec3::Y) {
            return;
        }
        if self.splits(corner, side, eye) {
            let finer_side = 0.5 * side;
            for (x, z) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
                self.collect(corner + finer_side * Vec2::new(x, z), finer_side, eye, frustum, tiles);
            }
        } else {
            tiles.push(GroundTile { corner_m: corner.into(), side_m: side, borders_and_kind: self.borders(corner, side, eye) });
        }
    }

    /// Whether a square of the quadtree is drawn as four smaller ones.
    fn splits(&self, corner: Vec2, side: f32, eye: Vec3) -> bool {
        let [below, above] = HILLS_M;
        let low = corner.extend(self.height_m[0] + below).xzy();
        let high = (corner + side).extend(self.height_m[1] + above).xzy();
        side > self.finest_m && eye.distance(eye.clamp(low, high)) < 0.5 * RANGE_SIDES * side
    }

    /// What the neighbours of a tile are, in or out of view. Since a square splits within a distance of at least 2√2 of its halves, they differ by at most one
    /// level.
    fn borders(&self, corner: Vec2, side: f32, eye: Vec3) -> u32 {
        let wider = 2.0 * side;
        let codes = BORDERS.map(|way| {
            let beside = corner + side * Vec2::from(way);
            let around = self.corner_m + ((beside - self.corner_m) / wider).floor() * wider;
            let is_inside = beside.cmpge(self.corner_m).all() && beside.cmplt(self.corner_m + self.side_m).all();
            match is_inside {
                true if !self.splits(around, wider, eye) => COARSER,
                true if self.splits(beside, side, eye) => FINER,
                _ => 0,
            }
        });
        codes.into_iter().rev().fold(0, |borders, code| borders << 2 | code)
    }
}

/// Bounds of the hills up to a distance from the edge of the map, relative to the map (m): those of `far_hills` in WGSL.
pub(crate) fn hills_m(outside_m: f32) -> [f32; 2] {
    let fraction = (outside_m / HILLS_FULL_M).min(1.0);
    let rise = fraction * fraction * (3.0 - 2.0 * fraction);
    [-HILLS_MEAN * HILLS_RANGE_M * rise, ((1.0 - HILLS_MEAN) * HILLS_RANGE_M + HILLS_SLOPE * outside_m) * rise]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Camera;
    use prairie_core::hash::{hash3, unit};

    #[test]
    fn tiles_within_the_map_are_distinguished_from_those_beyond_its_edge() {
        let extent_m = Vec2::new(100.0, 64.0);
        let is_within = |x: f32, z: f32| GroundTile { corner_m: [x, z], side_m: 16.0, borders_and_kind: 0 }.is_within(extent_m);
        assert!(is_within(0.0, 0.0) && is_within(80.0, 48.0) && is_within(84.0, 48.0), "on it, up to its edge");
        assert!(!is_within(-16.0, 0.0) && !is_within(-1.0, 16.0) && !is_within(16.0, -1.0), "west and north of it");
        assert!(
            !is_within(96.0, 16.0) && !is_within(84.5, 16.0) && !is_within(16.0, 49.0) && !is_within(200.0, 16.0),
            "east and south of it"
        );
    }

    #[test]
    fn tiles_of_the_map_are_visible_where_ground_or_grass_is() {
        let ground = TerrainQuadtree::new([256.0; 2], [1.0; 2], [0.0, 4.0], 1.0, 900.0);
        // A camera high over the map sees no near tiles when level, and some when it looks down.
        let seen = |pitch_rad: f32| {
            let camera = Camera { eye_m: Vec3::new(128.0, 100.0, 250.0), pitch_rad, ..Camera::default() };
            let tiles = ground.tiles(camera.eye_m, &Frustum::new(&camera.projection_from_world(1.7)));
            let is_near = |tile: &&GroundTile| tile.is_within(Vec2::splat(256.0)) && tile.distances_m(camera.eye_m)[1] < 100.0;
            tiles.iter().filter(is_near).count()
        };
        assert_eq!(seen(0.0), 0);
        assert!(seen(-1.0) > 2, "{}", seen(-1.0));
    }

    #[test]
    fn tiles_cover_the_view_exactly_once() {
        for (extent, pixel) in [([256.0, 256.0], [1.0, 1.0]), ([30_000.0, 22_000.0], [74.0, 92.0])] {
            let ground = TerrainQuadtree::new(extent, pixel, [0.0, 40.0], 2.0, 900.0);
            let eye_m = Vec3::new(extent[0] * 0.4, 20.0, extent[1] * 0.6);
            let camera = Camera { eye_m, heading_rad: 0.8, ..Camera::default() };
            let matrix = camera.projection_from_world(1.7);
            let tiles = ground.tiles(eye_m, &Frustum::new(&matrix));
            assert!(tiles.len() < 300, "{} tiles", tiles.len());
            for fraction in [0.01, 0.05, 0.2, 0.7] {
                let p = eye_m + camera.forward() * extent[0] * fraction;
                let holds = |tile: &&GroundTile| {
                    let [x, z] = tile.corner_m;
                    (x..x + tile.side_m).contains(&p.x) && (z..z + tile.side_m).contains(&p.z)
                };
                assert_eq!(tiles.iter().filter(holds).count(), 1, "{p}");
            }
        }
    }

    #[test]
    fn neighbours_differ_by_at_most_one_level_and_know_it() {
        let ground = TerrainQuadtree::new([700.0, 500.0], [1.0; 2], [0.0, 60.0], 1.0, 200.0);
        let mut coarser = 0;
        for at in 0..200 {
            let [x, y, z] = [0_u32, 1, 2].map(|axis| unit(hash3([at, axis, 3])[0]));
            let eye_m = Vec3::new(900.0 * x - 100.0, 300.0 * y * y, 700.0 * z - 100.0);
            let tiles = ground.tiles(eye_m, &Frustum::ALL);
            let covered_m2: f32 = tiles.iter().map(|tile| tile.side_m * tile.side_m).sum();
            assert_eq!(covered_m2, ground.side_m * ground.side_m, "{} tiles", tiles.len());
            for tile in &tiles {
                for (number, way) in BORDERS.into_iter().enumerate() {
                    // A point beyond the border, off its middle.
                    let beyond = Vec2::from(tile.corner_m) + tile.side_m * (0.5 + 0.501 * Vec2::from(way) + 0.25 * Vec2::from(way).perp());
                    let holds = |other: &&GroundTile| {
                        let off = beyond - Vec2::from(other.corner_m);
                        off.cmpge(Vec2::ZERO).all() && off.cmplt(Vec2::splat(other.side_m)).all()
                    };
                    let neighbour_m = tiles.iter().find(holds).map_or(tile.side_m, |other| other.side_m);
                    let code = [(2.0, COARSER), (1.0, 0), (0.5, FINER)].iter().find(|(sides, _)| sides * tile.side_m == neighbour_m);
                    assert_eq!(
                        code.map(|code| code.1),
                        Some(tile.borders_and_kind >> (2 * number) & 3),
                        "{tile:?} and {neighbour_m} m, eye at {eye_m}"
                    );
                    coarser += u32::from(neighbour_m > tile.side_m);
                }
            }
        }
        assert!(coarser > 1000, "{coarser} borders with a coarser tile");
    }
}
