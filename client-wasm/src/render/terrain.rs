//! Ground: a quadtree of tiles that are finer near the camera, each the same small mesh.

use super::cull::Frustum;
use super::gpu::Gpu;
use super::pipeline::{ByLamps, Draw, Maker, bind, storage};
use super::shaders;
use bytemuck::{Pod, Zeroable};
use glam::{Vec2, Vec3, Vec3Swizzles};

/// Cells along one side of a tile; twin of `TILE_CELLS` in `terrain.wgsl`.
const TILE_CELLS: u32 = 16;
/// Vertices of a tile.
pub(super) const TILE_VERTICES: u32 = (TILE_CELLS + 1).pow(2);
/// Most tiles in a frame.
const TILE_LIMIT: usize = 1024;
/// How far hills beyond the map's edge reach below and above its own land (m).
const HILLS_M: [f32; 2] = [-90.0, 160.0];
/// A tile gives way to a coarser one at this many times its side.
const RANGE_SIDES: f32 = 2.6;

/// One tile: corner (m), side (m), distance at which the next coarser grid takes over (m).
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(super) struct Tile {
    pub(super) corner_m: [f32; 2],
    pub(super) side_m: f32,
    range_m: f32,
}

impl Tile {
    /// Least and greatest distance on the ground between it and a place (m).
    pub(super) fn distances_m(&self, at_m: Vec3) -> [f32; 2] {
        let low = Vec2::from(self.corner_m) - Vec2::new(at_m.x, at_m.z);
        let high = low + self.side_m;
        [low.max(-high).max(Vec2::ZERO).length(), low.abs().max(high.abs()).length()]
    }

    /// Whether all of it is on land of an extent.
    fn is_within(&self, extent_m: Vec2) -> bool {
        let low = Vec2::from(self.corner_m);
        low.cmpge(Vec2::ZERO).all() && (low + self.side_m).cmple(extent_m).all()
    }
}

/// The square that the quadtree covers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ground {
    corner_m: Vec2,
    side_m: f32,
    finest_m: f32,
    extent_m: Vec2,
    /// Lowest and highest of the map.
    height_m: [f32; 2],
    /// Most that grass stands over it.
    grass_m: f32,
}

impl Ground {
    /// Land of `extent_m` with pixels of `pixel_m`, heights within `height_m` and grass no taller than `grass_m`, and what is seen beyond its edge.
    pub(super) fn new(extent_m: [f32; 2], pixel_m: [f32; 2], height_m: [f32; 2], grass_m: f32, haze_m: f32) -> Self {
        let pixel = pixel_m[0].min(pixel_m[1]).clamp(1.0, 16.0);
        let finest_m = TILE_CELLS as f32 * pixel.log2().round().exp2();
        let beyond_m = (4.0 * haze_m).clamp(500.0, 8_000.0);
        let wanted = extent_m[0].max(extent_m[1]) + 2.0 * beyond_m;
        let mut side_m = finest_m;
        while side_m < wanted {
            side_m *= 2.0;
        }
        let corner_m = 0.5 * (Vec2::from(extent_m) - Vec2::splat(side_m));
        // On the grid of the finest tiles, so that the world's own corner is a vertex.
        let corner_m = (corner_m / finest_m).floor() * finest_m;
        Self { corner_m, side_m, finest_m, extent_m: extent_m.into(), height_m, grass_m }
    }

    /// The same square with tiles as fine as `finest_m` about the camera.
    pub(super) fn finer(&self, finest_m: f32) -> Self {
        Self { finest_m: finest_m.min(self.finest_m), ..*self }
    }

    /// Tiles that the view needs, nearest first.
    pub(super) fn tiles(&self, eye_m: Vec3, frustum: &Frustum) -> Vec<Tile> {
        let mut tiles = Vec::new();
        self.collect(self.corner_m, self.side_m, eye_m, frustum, &mut tiles);
        let distance =
            |tile: &Tile| (Vec2::from(tile.corner_m) + 0.5 * tile.side_m - Vec2::new(eye_m.x, eye_m.z)).length() - 0.7 * tile.side_m;
        tiles.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
        tiles.truncate(TILE_LIMIT);
        tiles
    }

    /// How far hills of a tile may reach below and above the map's own land (m), as `far_hills` in `common.wgsl` has them.
    fn hills_m(&self, tile: &Tile) -> [f32; 2] {
        let low = Vec2::from(tile.corner_m);
        let outside_m = (-low).max(low + tile.side_m - self.extent_m).max(Vec2::ZERO).length();
        let share = (outside_m / 900.0).min(1.0);
        let rise = share * share * (3.0 - 2.0 * share);
        [-63.0 * rise, (87.0 + 0.006 * outside_m) * rise]
    }

    fn collect(&self, corner: Vec2, side: f32, eye: Vec3, frustum: &Frustum, tiles: &mut Vec<Tile>) {
        let tile = Tile { corner_m: corner.into(), side_m: side, range_m: RANGE_SIDES * side };
        let [lowest, highest] = self.height_m;
        let between = |[below, above]: [f32; 2]| [corner.extend(lowest + below).xzy(), (corner + side).extend(highest + above).xzy()];
        let [low, high] = between(self.hills_m(&tile));
        if !frustum.sees_box(low, high + self.grass_m * Vec3::Y) {
            return;
        }
        let [low, high] = between(HILLS_M);
        let nearest = eye.clamp(low, high);
        let finer_side = 0.5 * side;
        if side > self.finest_m && eye.distance(nearest) < RANGE_SIDES * finer_side {
            for (x, z) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
                self.collect(corner + finer_side * Vec2::new(x, z), finer_side, eye, frustum, tiles);
            }
        } else {
            tiles.push(tile);
        }
    }
}

pub(super) struct Terrain {
    /// Of tiles on the map, and of those that reach beyond its edge.
    pipelines: ByLamps<[wgpu::RenderPipeline; 2]>,
    extent_m: Vec2,
    indices: wgpu::Buffer,
    index_count: u32,
    tiles: wgpu::Buffer,
    /// Tiles on the map, and all of them.
    ends: [u32; 2],
    group: wgpu::BindGroup,
}

impl Terrain {
    /// For land of `extent_m`.
    pub(super) fn new(maker: &Maker<'_>, extent_m: [f32; 2]) -> Self {
        let module = maker.shader("terrain", shaders::TERRAIN, &[]);
        let layout = maker.layout("terrain", &[storage(0)]);
        let pipelines = ByLamps::new(|lamps| {
            [false, true].map(|beyond| {
                // Both have the same vertices, to the bit: they meet at the map's edge.
                let fragments = maker.shader("terrain", shaders::TERRAIN, &[lamps, ("reaches_beyond", beyond)]);
                let draw = Draw { label: "terrain", cull: Some(wgpu::Face::Back), fragment_module: Some(&fragments), ..Draw::default() };
                maker.draw(&module, Some(&layout), &draw)
            })
        });
        let indices = tile_indices();
        let size = (TILE_LIMIT * size_of::<Tile>()) as u64;
        let tiles = maker.gpu.empty_buffer("tiles", size, wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST);
        let group = bind(maker.gpu, "terrain", &layout, &[tiles.as_entire_binding()]);
        let index_buffer = maker.gpu.buffer("tile", bytemuck::cast_slice(&indices), wgpu::BufferUsages::INDEX);
        let index_count = indices.len() as u32;
        Self { pipelines, extent_m: extent_m.into(), indices: index_buffer, index_count, tiles, ends: [0; 2], group }
    }

    pub(super) fn prepare(&mut self, gpu: &Gpu, tiles: &[Tile]) {
        let (mut sorted, beyond): (Vec<Tile>, Vec<Tile>) = tiles.iter().partition(|tile| tile.is_within(self.extent_m));
        self.ends = [sorted.len() as u32, tiles.len() as u32];
        sorted.extend(beyond);
        gpu.queue.write_buffer(&self.tiles, 0, bytemuck::cast_slice(&sorted));
    }

    /// Vertices that [`draw`](Self::draw) feeds in.
    pub(super) fn vertices(&self) -> u64 {
        u64::from(self.ends[1] * TILE_VERTICES)
    }

    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, has_lamps: bool) {
        pass.set_bind_group(1, &self.group, &[]);
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint16);
        let [within, all] = self.ends;
        for (pipeline, tiles) in self.pipelines.of(has_lamps).iter().zip([0..within, within..all]) {
            pass.set_pipeline(pipeline);
            pass.draw_indexed(0..self.index_count, 0, tiles);
        }
    }
}

/// Two triangles a cell, anticlockwise seen from above.
pub(super) fn tile_indices() -> Vec<u16> {
    let row = TILE_CELLS as u16 + 1;
    let cells = (0..TILE_CELLS as u16).flat_map(|z| (0..TILE_CELLS as u16).map(move |x| z * row + x));
    cells.flat_map(|nw| [nw, nw + row, nw + 1, nw + 1, nw + row, nw + row + 1]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Camera;

    #[test]
    fn tiles_are_on_the_map_or_reach_beyond_its_edge() {
        let extent_m = Vec2::new(100.0, 64.0);
        let is_within = |x: f32, z: f32| Tile { corner_m: [x, z], side_m: 16.0, range_m: 0.0 }.is_within(extent_m);
        assert!(is_within(0.0, 0.0) && is_within(80.0, 48.0) && is_within(84.0, 48.0), "on it, up to its edge");
        assert!(!is_within(-16.0, 0.0) && !is_within(-1.0, 16.0) && !is_within(16.0, -1.0), "west and north of it");
        assert!(
            !is_within(96.0, 16.0) && !is_within(84.5, 16.0) && !is_within(16.0, 49.0) && !is_within(200.0, 16.0),
            "east and south of it"
        );
    }

    #[test]
    fn tiles_of_the_map_are_seen_where_land_and_grass_are() {
        let ground = Ground::new([256.0; 2], [1.0; 2], [0.0, 4.0], 1.0, 900.0);
        // An eye high over the map that looks level sees none of it near by, and one that looks down some.
        let seen = |pitch_rad: f32| {
            let camera = Camera { eye_m: Vec3::new(128.0, 100.0, 250.0), pitch_rad, ..Camera::default() };
            let tiles = ground.tiles(camera.eye_m, &Frustum::new(&camera.projection_from_world(1.7)));
            let is_near = |tile: &&Tile| tile.is_within(Vec2::splat(256.0)) && tile.distances_m(camera.eye_m)[1] < 100.0;
            tiles.iter().filter(is_near).count()
        };
        assert_eq!(seen(0.0), 0);
        assert!(seen(-1.0) > 2, "{}", seen(-1.0));
    }

    #[test]
    fn tiles_in_view_cover_what_is_in_view_once() {
        for (extent, pixel) in [([256.0, 256.0], [1.0, 1.0]), ([30_000.0, 22_000.0], [74.0, 92.0])] {
            let ground = Ground::new(extent, pixel, [0.0, 40.0], 2.0, 900.0);
            let eye_m = Vec3::new(extent[0] * 0.4, 20.0, extent[1] * 0.6);
            let camera = Camera { eye_m, heading_rad: 0.8, ..Camera::default() };
            let matrix = camera.projection_from_world(1.7);
            let tiles = ground.tiles(eye_m, &Frustum::new(&matrix));
            assert!(tiles.len() < 300, "{} tiles", tiles.len());
            for share in [0.01, 0.05, 0.2, 0.7] {
                let p = eye_m + camera.forward() * extent[0] * share;
                let holds = |tile: &&Tile| {
                    let [x, z] = tile.corner_m;
                    (x..x + tile.side_m).contains(&p.x) && (z..z + tile.side_m).contains(&p.z)
                };
                assert_eq!(tiles.iter().filter(holds).count(), 1, "{p}");
            }
        }
    }
}
