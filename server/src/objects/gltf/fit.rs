//! Meshes turned, scaled and put on the floor of a box.

use super::ModelFault;
use glam::Vec3;
use prairie_core::scene::MODEL_SIDE_M;
use prairie_core::wire::Mesh;

/// Smallest side (in a file's own unit) that can be scaled.
const LEAST_SIDE: f32 = 1e-6;

/// The mesh turned to face −Z, scaled uniformly into a box and put on its floor.
pub(super) fn fitted(mesh: Mesh, half_extents_m: [f32; 3]) -> Result<Mesh, ModelFault> {
    let (low, high) = bounds(&mesh)?;
    let half = Vec3::from_array(half_extents_m);
    let scale = (2.0 * half / (high - low).max(Vec3::splat(LEAST_SIDE))).min_element();
    Ok(placed(mesh, (low, high), Vec3::splat(scale), half.y))
}

/// The mesh turned to face −Z and stretched to a box of this width, height and depth (m), and the box. Sides of 0 keep the proportions to the smallest
/// change of the others.
///
/// # Errors
/// [`ModelFault`] when the mesh has no extent, positions that are not finite, too many vertices or indices, or a side of the box is out of range.
pub fn stretched(mesh: Mesh, size_m: [f32; 3]) -> Result<(Mesh, [f32; 3]), ModelFault> {
    for (what, limit, found) in
        [("vertices", Mesh::COVER_VERTEX_LIMIT, mesh.positions_m.len()), ("indices", Mesh::COVER_INDEX_LIMIT, mesh.indices.len())]
    {
        if found > limit {
            return Err(ModelFault::TooLarge { what, limit });
        }
    }
    let (low, high) = bounds(&mesh)?;
    let own: [f32; 3] = (high - low).to_array();
    if own.iter().all(|side| *side < LEAST_SIDE) {
        return Err(ModelFault::NoExtent);
    }
    let given = own.iter().zip(size_m).filter(|(own, size_m)| **own >= LEAST_SIDE && *size_m > 0.0);
    let scale = given.map(|(own, size_m)| size_m / own).reduce(f32::min).unwrap_or(1.0);
    let sides: [f32; 3] = std::array::from_fn(|axis| {
        // What is flat gets the thickness of the thinnest box.
        let proportional_m = if own[axis] < LEAST_SIDE { MODEL_SIDE_M[0] } else { own[axis] * scale };
        if size_m[axis] > 0.0 { size_m[axis] } else { proportional_m }
    });
    if !sides.iter().all(|side| (MODEL_SIDE_M[0]..=MODEL_SIDE_M[1]).contains(side)) {
        return Err(ModelFault::Size(sides));
    }
    let scales: [f32; 3] = std::array::from_fn(|axis| if own[axis] < LEAST_SIDE { scale } else { sides[axis] / own[axis] });
    Ok((placed(mesh, (low, high), Vec3::from_array(scales), 0.5 * sides[1]), sides))
}

fn turned([x, y, z]: [f32; 3]) -> Vec3 {
    Vec3::new(-x, y, -z)
}

/// The lowest and the highest position of a mesh after its turn.
fn bounds(mesh: &Mesh) -> Result<(Vec3, Vec3), ModelFault> {
    let grown = |(low, high): (Vec3, Vec3), &position: &[f32; 3]| (low.min(turned(position)), high.max(turned(position)));
    let (low, high) = mesh.positions_m.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), grown);
    if !(mesh.positions_m.iter().flatten().all(|v| v.is_finite()) && (high - low).is_finite() && (high + low).is_finite()) {
        return Err(ModelFault::NotFinite);
    }
    Ok((low, high))
}

/// The mesh turned and scaled, with the middle of its floor this far below the origin (m).
fn placed(mut mesh: Mesh, (low, high): (Vec3, Vec3), scale: Vec3, floor_m: f32) -> Mesh {
    let foot = Vec3::new(0.5 * (low.x + high.x), low.y, 0.5 * (low.z + high.z));
    for position in &mut mesh.positions_m {
        *position = ((turned(*position) - foot) * scale - Vec3::Y * floor_m).to_array();
    }
    let is_uniform = scale == Vec3::splat(scale.x);
    for normal in &mut mesh.normals {
        let upright = turned(*normal);
        *normal = if is_uniform { upright } else { (upright / scale).normalize_or(Vec3::Y) }.to_array();
    }
    mesh
}
