//! The terrain as a triangle mesh.

use super::palette::Rgb;
use glam::Vec3;
use prairie_core::grid::PatchLayout;
use prairie_core::scene::Light;
use prairie_core::terrain::HeightMap;

/// Largest number of vertices along one side of the mesh.
const MESH_LIMIT: u32 = 192;

/// Triangle mesh of the terrain over the world's extent, with texture coordinates for a map of the whole world.
pub(super) struct TerrainMesh {
    /// Positions (m).
    pub(super) positions_m: Vec<[f32; 3]>,
    /// Texture coordinates, 0..=1 from the north-west corner.
    pub(super) texcoords: Vec<[f32; 2]>,
    /// Grey values of the hillshade.
    pub(super) shades: Vec<Rgb>,
    /// Three indices per triangle, anticlockwise seen from above.
    pub(super) triangles: Vec<[u32; 3]>,
}

impl TerrainMesh {
    /// Mesh of the terrain under `layout`, shaded by the sun of `light`.
    pub(super) fn new(layout: &PatchLayout, heights: &HeightMap, light: &Light) -> Self {
        let extent_m = layout.extent_m();
        let pixel_m = heights.pixel_m();
        let side: [u32; 2] = std::array::from_fn(|axis| ((extent_m[axis] / pixel_m[axis]).ceil() as u32 + 1).clamp(2, MESH_LIMIT));
        let sun = Vec3::from(light.sun_at(0.0).direction());

        let mut mesh = Self { positions_m: Vec::new(), texcoords: Vec::new(), shades: Vec::new(), triangles: Vec::new() };
        for j in 0..side[1] {
            for i in 0..side[0] {
                let [u, v] = [i as f32 / (side[0] - 1) as f32, j as f32 / (side[1] - 1) as f32];
                let [x, z] = [u * extent_m[0], v * extent_m[1]];
                mesh.positions_m.push([x, heights.height_m(x, z), z]);
                mesh.texcoords.push([u, v]);
                let lit = heights.normal(x, z).dot(sun).max(0.0) / sun.y.max(0.2);
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mesh_follows_the_heights_and_faces_up() {
        let layout = PatchLayout { count: [2, 3], cells: 8, cell_m: 1.0 };
        let heights = HeightMap::from_heights(2, 2, [16.0, 24.0], vec![0.0, 16.0, 0.0, 16.0]);
        let mesh = TerrainMesh::new(&layout, &heights, &Light::default());
        assert!(mesh.positions_m.iter().all(|p| (p[0] - p[1]).abs() < 1e-4));
        assert_eq!(mesh.texcoords.last(), Some(&[1.0, 1.0]));
        assert_eq!(mesh.positions_m.len(), mesh.shades.len());
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|at| Vec3::from(mesh.positions_m[at as usize]));
            assert!((b - a).cross(c - a).y > 0.0);
        }
    }
}
