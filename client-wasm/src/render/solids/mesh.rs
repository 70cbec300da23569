//! Meshes created in code: solids that can be positioned, rotated and joined.

use bytemuck::{Pod, Zeroable};
use glam::{Affine3A, Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// A vertex of `objects.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct Vertex {
    pub(crate) position: [f32; 3],
    pub(crate) normal: [i8; 4],
    pub(crate) color: [u8; 4],
    pub(crate) leaf: [u16; 2],
}

pub(crate) const VERTEX_ATTRIBUTES: [wgpu::VertexAttribute; 4] =
    wgpu::vertex_attr_array![0 => Float32x3, 1 => Snorm8x4, 2 => Unorm8x4, 3 => Unorm16x2];

/// Surface colour: linear RGB and gloss, 0..=1.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Paint {
    pub(crate) rgb: [f32; 3],
    pub(crate) gloss: f32,
}

impl Paint {
    pub(crate) const fn new(r: f32, g: f32, b: f32, gloss: f32) -> Self {
        Self { rgb: [r, g, b], gloss }
    }

    /// The square root preserves dark colours in 8 bits; `objects.wgsl` squares it.
    fn bytes(self) -> [u8; 4] {
        let [r, g, b] = self.rgb.map(|v| (v.clamp(0.0, 1.0).sqrt() * 255.0 + 0.5) as u8);
        [r, g, b, (self.gloss.clamp(0.0, 1.0) * 255.0 + 0.5) as u8]
    }
}

/// A triangle mesh, anticlockwise as seen from outside.
#[derive(Clone, Debug, Default)]
pub(crate) struct Solid {
    pub(crate) vertices: Vec<Vertex>,
    pub(crate) indices: Vec<u32>,
}

impl Solid {
    pub(crate) fn vertex(&mut self, position: Vec3, normal: Vec3, paint: Paint, leaf: Vec2) -> u32 {
        let [x, y, z] = normal.normalize_or_zero().to_array().map(|v| (v * 127.0).round() as i8);
        let leaf = leaf.to_array().map(|v| (v * 65_535.0) as u16);
        self.vertices.push(Vertex { position: position.into(), normal: [x, y, z, 0], color: paint.bytes(), leaf });
        self.vertices.len() as u32 - 1
    }

    /// Adds a flat polygon, anticlockwise as seen from its front.
    pub(crate) fn polygon(&mut self, corners: &[Vec3], paint: Paint) {
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let first = self.vertices.len() as u32;
        for &corner in corners {
            self.vertex(corner, normal, paint, Vec2::ZERO);
        }
        for i in 1..corners.len() as u32 - 1 {
            self.indices.extend([first, first + i, first + i + 1]);
        }
    }

    /// Adds another solid, transformed by `at`.
    pub(crate) fn add(&mut self, other: &Self, at: Affine3A) {
        let first = self.vertices.len() as u32;
        for vertex in &other.vertices {
            let [x, y, z, _] = vertex.normal.map(f32::from);
            let normal = at.transform_vector3(Vec3::new(x, y, z)).normalize_or_zero();
            let [x, y, z] = normal.to_array().map(|v| (v * 127.0).round() as i8);
            let position = at.transform_point3(Vec3::from(vertex.position)).into();
            self.vertices.push(Vertex { position, normal: [x, y, z, 0], ..*vertex });
        }
        self.indices.extend(other.indices.iter().map(|index| index + first));
    }

    /// Adds a smooth skin through closed rings of equal length. If each ring turns anticlockwise as seen from above, the rings go upward.
    /// Ends are closed if their ring is a point or flat.
    pub(crate) fn skin(&mut self, rings: &[Vec<Vec3>], paint: Paint) {
        let n = rings[0].len();
        let at = |i: usize, j: usize| rings[i][j % n];
        let first = self.vertices.len() as u32;
        for i in 0..rings.len() {
            for j in 0..n {
                let up = at((i + 1).min(rings.len() - 1), j) - at(i.saturating_sub(1), j);
                let around = at(i, j + 1) - at(i, j + n - 1);
                let mut normal = around.cross(up);
                if normal.length_squared() < 1e-12 {
                    let centre = rings[i].iter().sum::<Vec3>() / n as f32;
                    let inner = rings[if i == 0 { 1 } else { i - 1 }].iter().sum::<Vec3>() / n as f32;
                    normal = centre - inner;
                }
                self.vertex(at(i, j), normal, paint, Vec2::ZERO);
            }
        }
        let n = n as u32;
        for i in 0..rings.len() as u32 - 1 {
            for j in 0..n {
                let (a, b) = (first + i * n + j, first + i * n + (j + 1) % n);
                self.indices.extend([a, b, a + n, a + n, b, b + n]);
            }
        }
    }

    /// Adds an ellipsoid.
    pub(crate) fn ellipsoid(&mut self, centre: Vec3, radii: Vec3, paint: Paint) {
        let (stacks, slices) = (10, 16);
        let rings: Vec<Vec<Vec3>> = (0..=stacks)
            .map(|i| {
                let (sin, cos) = (PI * i as f32 / stacks as f32).sin_cos();
                let point = |j: usize| {
                    let (s, c) = (TAU * j as f32 / slices as f32).sin_cos();
                    centre + radii * Vec3::new(c * sin, -cos, -s * sin)
                };
                (0..slices).map(point).collect()
            })
            .collect();
        self.skin(&rings, paint);
    }

    /// Adds a tube along points with radii, closed at both ends.
    pub(crate) fn tube(&mut self, path: &[(Vec3, f32)], sides: usize, paint: Paint) {
        let mut rings = Vec::new();
        let count = path.len();
        for (i, &(centre, radius)) in path.iter().enumerate() {
            let along = (path[(i + 1).min(count - 1)].0 - path[i.saturating_sub(1)].0).normalize();
            let across = along.any_orthonormal_vector();
            let other = along.cross(across);
            let ring = |radius: f32| -> Vec<Vec3> {
                (0..sides)
                    .map(|j| {
                        let (s, c) = (TAU * j as f32 / sides as f32).sin_cos();
                        centre + radius * (across * c + other * s)
                    })
                    .collect()
            };
            if i == 0 {
                rings.push(ring(1e-4));
            }
            rings.push(ring(radius));
            if i == count - 1 {
                rings.push(ring(1e-4));
            }
        }
        self.skin(&rings, paint);
    }

    /// Adds a box with bevelled edges.
    pub(crate) fn block(&mut self, centre: Vec3, half: Vec3, bevel: f32, paint: Paint) {
        let profile: Vec<Vec2> =
            vec![Vec2::new(half.z, -half.y), Vec2::new(half.z, half.y), Vec2::new(-half.z, half.y), Vec2::new(-half.z, -half.y)];
        self.extrude(&profile, centre, half.x, half.x, bevel, paint);
    }

    /// Extrudes a convex profile of (back, up) corners in the Y–Z plane, anticlockwise as seen from the left (−X), to ±`half_low` at its lowest and
    /// ±`half_high` at its highest corner, with bevelled rims.
    pub(crate) fn extrude(&mut self, profile: &[Vec2], centre: Vec3, half_low: f32, half_high: f32, bevel: f32, paint: Paint) {
        let n = profile.len();
        let low = profile.iter().map(|p| p.y).fold(f32::MAX, f32::min);
        let high = profile.iter().map(|p| p.y).fold(f32::MIN, f32::max);
        let half = |p: Vec2| half_low + (half_high - half_low) * (p.y - low) / (high - low).max(1e-6);
        // Each corner becomes two, and the side faces shrink by the bevel.
        let mut rim = Vec::new();
        for i in 0..n {
            let (before, here, after) = (profile[(i + n - 1) % n], profile[i], profile[(i + 1) % n]);
            rim.push(here + (before - here).normalize() * bevel);
            rim.push(here + (after - here).normalize() * bevel);
        }
        let middle = profile.iter().sum::<Vec2>() / n as f32;
        let inner: Vec<Vec2> = rim.iter().map(|&p| p + (middle - p).normalize() * bevel).collect();
        let point = |p: Vec2, side: f32, inset: f32| centre + Vec3::new(side * (half(p) - inset), p.y, p.x);
        let count = rim.len();
        for side in [-1.0, 1.0] {
            let flip = |mut corners: Vec<Vec3>| {
                if side > 0.0 {
                    corners.reverse();
                }
                corners
            };
            self.polygon(&flip(inner.iter().map(|&p| point(p, side, 0.0)).collect()), paint);
            for i in 0..count {
                let j = (i + 1) % count;
                let corners =
                    vec![point(rim[i], side, bevel), point(rim[j], side, bevel), point(inner[j], side, 0.0), point(inner[i], side, 0.0)];
                self.polygon(&flip(corners), paint);
            }
        }
        for i in 0..count {
            let j = (i + 1) % count;
            let corners = [point(rim[j], -1.0, bevel), point(rim[i], -1.0, bevel), point(rim[i], 1.0, bevel), point(rim[j], 1.0, bevel)];
            self.polygon(&corners, paint);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Six times the enclosed volume, positive when the triangles face outward.
    fn volume6(solid: &Solid) -> f32 {
        let at = |i: u32| Vec3::from(solid.vertices[i as usize].position);
        solid.indices.chunks_exact(3).map(|t| at(t[0]).dot(at(t[1]).cross(at(t[2])))).sum()
    }

    #[test]
    fn solids_enclose_their_volume() {
        let paint = Paint::new(1.0, 1.0, 1.0, 0.0);
        let mut block = Solid::default();
        block.block(Vec3::new(1.0, 2.0, 3.0), Vec3::new(1.0, 0.5, 2.0), 0.02, paint);
        assert!((volume6(&block) / 6.0 - 8.0).abs() < 0.2, "{}", volume6(&block) / 6.0);
        let mut ball = Solid::default();
        ball.ellipsoid(Vec3::ZERO, Vec3::new(1.0, 2.0, 1.5), paint);
        let exact = 4.0 / 3.0 * PI * 3.0;
        assert!((volume6(&ball) / 6.0 / exact - 1.0).abs() < 0.1, "{}", volume6(&ball) / 6.0);
        let mut tube = Solid::default();
        tube.tube(&[(Vec3::ZERO, 0.5), (Vec3::new(0.0, 2.0, 0.0), 0.5)], 24, paint);
        assert!((volume6(&tube) / 6.0 / (PI * 0.5) - 1.0).abs() < 0.1, "{}", volume6(&tube) / 6.0);
    }
}
