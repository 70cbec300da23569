//! Assembly of all triangles of a model's scene into one mesh.

use super::source::{COLOUR, INDICES, NORMAL, POSITION, Source};
use super::{ModelFault, PART_LIMIT};
use glam::{Mat3, Mat4, Vec3};
use gltf::Semantic;
use prairie_core::wire::Mesh;

impl Source {
    /// The transformed triangles of the default scene.
    pub(super) fn mesh(&self) -> Result<Mesh, ModelFault> {
        let scene = self.document.default_scene().or_else(|| self.document.scenes().next()).ok_or(ModelFault::Empty)?;
        let mut mesh = Mesh::default();
        let mut parts = 0;
        let mut placed = vec![false; self.document.nodes().len()];
        let mut pending: Vec<_> = scene.nodes().map(|node| (node, Mat4::IDENTITY)).collect();
        while let Some((node, parent)) = pending.pop() {
            if std::mem::replace(&mut placed[node.index()], true) {
                return Err(ModelFault::NodeTwice(node.index()));
            }
            let transform = parent * Mat4::from_cols_array_2d(&node.transform().matrix());
            for primitive in node.mesh().into_iter().flat_map(|mesh| mesh.primitives()) {
                parts += 1;
                at_most(PART_LIMIT, parts, "parts")?;
                if primitive.mode() == gltf::mesh::Mode::Triangles {
                    self.append(&mut mesh, &primitive, transform)?;
                }
            }
            pending.extend(node.children().map(|child| (child, transform)));
        }
        if mesh.indices.is_empty() { Err(ModelFault::Empty) } else { Ok(mesh) }
    }

    fn append(&self, mesh: &mut Mesh, primitive: &gltf::Primitive<'_>, transform: Mat4) -> Result<(), ModelFault> {
        let Some(vertices) = self.count(&POSITION, primitive.get(&Semantic::Positions))? else { return Ok(()) };
        at_most(Mesh::VERTEX_LIMIT, mesh.positions_m.len() + vertices, "vertices")?;
        let indices = self.count(&INDICES, primitive.indices())?.unwrap_or(vertices);
        at_most(Mesh::INDEX_LIMIT, mesh.indices.len() + indices, "indices")?;
        self.count(&NORMAL, primitive.get(&Semantic::Normals))?;
        self.count(&COLOUR, primitive.get(&Semantic::Colors(0)))?;

        let reader = primitive.reader(|buffer| self.buffers.get(buffer.index()).map(Vec::as_slice));
        let positions = reader.read_positions().into_iter().flatten();
        let positions: Vec<_> = positions.map(|position| transform.transform_point3(Vec3::from_array(position))).collect();
        let indices: Vec<u32> = match reader.read_indices() {
            Some(indices) => indices.into_u32().collect(),
            None => (0..vertices as u32).collect(),
        };
        if let Some(&index) = indices.iter().find(|&&index| index as usize >= vertices) {
            return Err(ModelFault::Index { index, vertices });
        }
        let triangles = || indices.chunks_exact(3).map(|triangle| [triangle[0], triangle[1], triangle[2]]);
        // A mirrored mesh is turned inside out by its transform.
        let mirrored = transform.determinant() < 0.0;

        let normals: Vec<Vec3> = match reader.read_normals() {
            Some(normals) => {
                let turn = Mat3::from_mat4(transform).inverse().transpose();
                normals.take(vertices).map(|normal| (turn * Vec3::from_array(normal)).normalize_or(Vec3::Y)).collect()
            }
            None => face_normals(&positions, triangles(), mirrored),
        };
        let [r, g, b, _] = primitive.material().pbr_metallic_roughness().base_color_factor();
        let base = Vec3::new(r, g, b);
        let mut tints = reader.read_colors(0).map(|colours| colours.into_rgb_f32());
        let colour = |tint: [f32; 3]| (base * Vec3::from_array(tint)).to_array().map(|c| (c * 255.0 + 0.5).clamp(0.0, 255.0) as u8);

        let first = mesh.positions_m.len() as u32;
        mesh.indices.extend(triangles().flat_map(|[a, b, c]| if mirrored { [a, c, b] } else { [a, b, c] }).map(|index| first + index));
        for (vertex, position) in positions.into_iter().enumerate() {
            mesh.positions_m.push(position.to_array());
            mesh.normals.push(normals.get(vertex).copied().unwrap_or(Vec3::Y).to_array());
            mesh.rgb.push(colour(tints.as_mut().and_then(Iterator::next).unwrap_or([1.0; 3])));
        }
        Ok(())
    }
}

fn at_most(limit: usize, found: usize, what: &'static str) -> Result<(), ModelFault> {
    if found <= limit { Ok(()) } else { Err(ModelFault::TooLarge { what, limit }) }
}

fn face_normals(positions: &[Vec3], triangles: impl Iterator<Item = [u32; 3]>, mirrored: bool) -> Vec<Vec3> {
    let mut normals = vec![Vec3::ZERO; positions.len()];
    let side = if mirrored { -1.0 } else { 1.0 };
    for triangle in triangles {
        let [a, b, c] = triangle.map(|index| positions[index as usize]);
        let area = (b - a).cross(c - a) * side;
        triangle.iter().for_each(|&index| normals[index as usize] += area);
    }
    normals.into_iter().map(|normal| normal.normalize_or(Vec3::Y)).collect()
}
