//! The ground: a mesh of the land, and the map of bends that is laid on it.

use super::palette::{Rgb, bend_rgb};
use crate::snapshot::BentPatches;
use glam::Vec3;
use shared::grid::PatchLayout;
use shared::scene::Light;
use shared::terrain::HeightMap;
use shared::wire::quantise::theta_rad;
use std::sync::Arc;

/// Most vertices along one side of the mesh.
const MESH_LIMIT: u32 = 192;

/// Most pixels along one side of the map of bends.
const MAP_LIMIT_PX: u32 = 512;

/// Triangle mesh of the land over the world's extent, with texture coordinates that stretch a map of the world over it.
pub(super) struct GroundMesh {
    /// Positions (m).
    pub(super) positions_m: Vec<[f32; 3]>,
    /// Place on the map, 0..=1, from the north-west corner.
    pub(super) texcoords: Vec<[f32; 2]>,
    /// Grey of the hillshade.
    pub(super) shades: Vec<Rgb>,
    /// Three indices a triangle, anticlockwise seen from above.
    pub(super) triangles: Vec<[u32; 3]>,
}

impl GroundMesh {
    /// Mesh of the land under `layout`, shaded by the sun of `light`.
    pub(super) fn new(layout: &PatchLayout, heights: &HeightMap, light: &Light) -> Self {
        let extent_m = layout.extent_m();
        let pixel_m = heights.pixel_m();
        let side: [u32; 2] = std::array::from_fn(|axis| ((extent_m[axis] / pixel_m[axis]).ceil() as u32 + 1).clamp(2, MESH_LIMIT));
        let (sin, cos) = light.sun_heading_rad.sin_cos();
        let (up, flat) = light.sun_elevation_rad.sin_cos();
        let sun = Vec3::new(flat * sin, up, -flat * cos);

        let mut mesh = Self { positions_m: Vec::new(), texcoords: Vec::new(), shades: Vec::new(), triangles: Vec::new() };
        for j in 0..side[1] {
            for i in 0..side[0] {
                let [u, v] = [i as f32 / (side[0] - 1) as f32, j as f32 / (side[1] - 1) as f32];
                let [x, z] = [u * extent_m[0], v * extent_m[1]];
                mesh.positions_m.push([x, heights.height_m(x, z), z]);
                mesh.texcoords.push([u, v]);
                let lit = heights.normal(x, z).dot(sun).max(0.0) / up.max(0.2);
                mesh.shades.push([(255.0 * (0.25 + 0.6 * lit).min(1.0)) as u8; 3]);
            }
        }
        for j in 0..side[1] - 1 {
            for i in 0..side[0] - 1 {
                let nw = j * side[0] + i;
                let sw = nw + side[0];
                mesh.triangles.push([nw, sw, nw + 1]);
                mesh.triangles.push([nw + 1, sw, sw + 1]);
            }
        }
        mesh
    }
}

/// Bending angles of the whole world as one image of at most 512 × 512 pixels, the north-west corner first.
///
/// A pixel is the largest |θ| of the cells that it covers, so that a narrow track stays visible however small the map is.
pub(super) struct BendMap {
    layout: PatchLayout,
    /// log₂ of the cells along one side of a pixel.
    shift: u32,
    size_px: [u32; 2],
    /// |θ| as a code of `shared::wire::quantise`, 0..=127.
    codes: Vec<u8>,
    /// The patches that it shows; none: nothing has been drawn.
    shown: Option<Arc<BentPatches>>,
}

impl BendMap {
    /// A map of grass at rest.
    pub(super) fn new(layout: PatchLayout) -> Self {
        let cells = layout.count.map(|patches| patches * layout.cells);
        let mut shift = 0;
        while (cells[0].max(cells[1]) - 1) >> shift >= MAP_LIMIT_PX {
            shift += 1;
        }
        let size_px = cells.map(|n| ((n - 1) >> shift) + 1);
        Self { layout, shift, size_px, codes: vec![0; (size_px[0] * size_px[1]) as usize], shown: None }
    }

    /// Pixels along X and Z.
    pub(super) fn size_px(&self) -> [u32; 2] {
        self.size_px
    }

    /// Metres along one side of a pixel.
    pub(super) fn pixel_m(&self) -> f32 {
        (1_u32 << self.shift) as f32 * self.layout.cell_m
    }

    /// Codes of |θ|, 0..=127, row by row.
    pub(super) fn codes(&self) -> &[u8] {
        &self.codes
    }

    /// The map in colours, three bytes a pixel.
    pub(super) fn rgb(&self) -> Vec<u8> {
        let colours: [Rgb; 128] = std::array::from_fn(|code| bend_rgb(degrees(code as u8)));
        self.codes.iter().flat_map(|&code| colours[usize::from(code.min(127))]).collect()
    }

    /// Takes over the patches of a snapshot; false when they are those that it shows already.
    pub(super) fn update(&mut self, patches: &Arc<BentPatches>) -> bool {
        if self.shown.as_ref().is_some_and(|shown| same(shown, patches)) {
            return false;
        }
        self.codes.fill(0);
        for (&index, patch) in patches.range(..self.layout.patches() as u32) {
            self.draw(index, &patch.codes);
        }
        self.shown = Some(Arc::clone(patches));
        true
    }

    fn draw(&mut self, patch: u32, codes: &[i8]) {
        let cells = self.layout.cells;
        let [x0, z0] = self.layout.place(patch).map(|n| n * cells);
        for (row, z) in codes.chunks_exact(cells as usize).take(cells as usize).zip(z0..) {
            let first = (z >> self.shift) * self.size_px[0];
            for (code, x) in row.iter().zip(x0..) {
                let pixel = &mut self.codes[(first + (x >> self.shift)) as usize];
                *pixel = (*pixel).max(code.unsigned_abs().min(127));
            }
        }
    }
}

/// Angle of a code of |θ| (degrees).
pub(super) fn degrees(code: u8) -> f32 {
    theta_rad(code.min(127) as i8).to_degrees()
}

fn same(a: &BentPatches, b: &BentPatches) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|((i, a), (j, b))| i == j && Arc::ptr_eq(a, b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::snapshot::PatchCodes;

    fn bent(index: u32, cells: usize, theta: impl Fn(usize, usize) -> i8) -> Arc<BentPatches> {
        let mut codes: Vec<i8> = (0..cells * cells).map(|at| theta(at % cells, at / cells)).collect();
        codes.resize(3 * cells * cells, 99);
        Arc::new(BentPatches::from([(index, Arc::new(PatchCodes { tick: 1, codes }))]))
    }

    #[test]
    fn a_cell_lands_on_its_own_pixel() {
        let mut map = BendMap::new(PatchLayout { count: [2, 2], cells: 8, cell_m: 0.5 });
        assert_eq!((map.size_px(), map.pixel_m()), ([16, 16], 0.5));
        let patches = bent(3, 8, |i, j| if (i, j) == (5, 2) { -40 } else { 0 });
        assert!(map.update(&patches));
        let marked: Vec<_> = (0..256).filter(|&at| map.codes()[at] != 0).collect();
        assert_eq!((marked.as_slice(), map.codes()[marked[0]]), ([(8 + 2) * 16 + 8 + 5].as_slice(), 40));
        assert!(!map.update(&patches));
        assert!(map.update(&Arc::default()) && map.codes().iter().all(|&code| code == 0));
    }

    #[test]
    fn a_large_world_keeps_its_narrow_tracks() {
        let mut map = BendMap::new(PatchLayout { count: [16, 3], cells: 64, cell_m: 0.25 });
        assert_eq!((map.size_px(), map.pixel_m()), ([512, 96], 0.5));
        map.update(&bent(17, 64, |i, _| if i == 9 { 127 } else { -3 }));
        assert!((32..64).all(|row| map.codes()[row * 512 + 32 + 4] == 127 && map.codes()[row * 512 + 32 + 5] == 3));
        assert_eq!(map.rgb().len(), 3 * 512 * 96);
        let huge = BendMap::new(PatchLayout { count: [2048, 1], cells: 256, cell_m: 1.0 });
        assert_eq!(huge.size_px(), [512, 1]);
    }

    #[test]
    fn the_mesh_follows_the_land_and_faces_up() {
        let layout = PatchLayout { count: [2, 3], cells: 8, cell_m: 1.0 };
        let heights = HeightMap::from_heights(2, 2, [16.0, 24.0], vec![0.0, 16.0, 0.0, 16.0]);
        let mesh = GroundMesh::new(&layout, &heights, &Light::default());
        assert!(mesh.positions_m.iter().all(|p| (p[0] - p[1]).abs() < 1e-4));
        assert_eq!(mesh.texcoords.last(), Some(&[1.0, 1.0]));
        assert_eq!(mesh.positions_m.len(), mesh.shades.len());
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|at| Vec3::from(mesh.positions_m[at as usize]));
            assert!((b - a).cross(c - a).y > 0.0);
        }
    }
}
