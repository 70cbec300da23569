//! Trees and stones: their shapes, and where the covering map puts them (000 section 5.5.2).

use super::billboards::random3;
use super::mesh::{Paint, Solid};
use super::paint::Random;
use crate::state::Land;
use glam::{Mat4, Quat, Vec2, Vec3};
use shared::terrain::Cover;
use std::f32::consts::TAU;

/// Shapes of trees and of stones.
pub(super) const TREE_SHAPES: u32 = 4;
pub(super) const STONE_SHAPES: u32 = 3;
/// Most trees or stones of a world; of more, every n-th stands.
const PLACE_LIMIT: usize = 100_000;

/// Sway of a tree's top in a wind of 10 m/s and above, over its height.
const TREE_SWAY_RAD: f32 = 0.07;

/// A tree or a stone that stands somewhere.
#[derive(Clone, Copy, Debug)]
pub(super) struct Standing {
    pub(super) position_m: Vec3,
    pub(super) shape: u32,
    pub(super) is_tree: bool,
    pub(super) size_m: f32,
    pub(super) world_from_model: Mat4,
    pub(super) tint: [f32; 4],
}

/// Everything that stands on the land, with a random turn, size and offset each.
pub(super) fn standing(land: &Land) -> Vec<Standing> {
    let extent_m = land.scene().extent_m();
    let [width, depth] = land.cover().size_px();
    let pixel_m = [extent_m[0] / width as f32, extent_m[1] / depth as f32];
    let plants = &land.scene().plants;
    let mut all = Vec::new();
    for (cover, is_tree, shapes, mean_m) in
        [(Cover::Tree, true, TREE_SHAPES, plants.tree_m), (Cover::Stone, false, STONE_SHAPES, plants.stone_m)]
    {
        let places: Vec<_> = land.cover().places_m(cover, extent_m).collect();
        for &[x, z] in places.iter().step_by(places.len().div_ceil(PLACE_LIMIT).max(1)) {
            let place = [(x / pixel_m[0]) as i32, (z / pixel_m[1]) as i32];
            let [r, s] = [random3(place, 401), random3(place, 577)];
            let x = x + (r[0] - 0.5) * pixel_m[0].min(6.0);
            let z = z + (r[1] - 0.5) * pixel_m[1].min(6.0);
            let size_m = mean_m * if is_tree { 0.72 + 0.56 * r[2] } else { 0.45 + 1.1 * r[2] * r[2] };
            let ground_m = land.heights().height_m(x, z);
            let position_m = Vec3::new(x, ground_m - if is_tree { 0.1 } else { 0.12 * size_m }, z);
            let turn = Quat::from_rotation_y(s[0] * TAU);
            let lean = if is_tree { 0.0 } else { 0.3 * (s[1] - 0.5) };
            let turn = turn * Quat::from_rotation_x(lean);
            let squat = Vec3::new(size_m, size_m * if is_tree { 0.92 + 0.16 * s[1] } else { 0.75 + 0.5 * s[1] }, size_m);
            let bright = 0.82 + 0.36 * s[2];
            let warm = 0.92 + 0.2 * r[0];
            all.push(Standing {
                position_m,
                shape: (s[1] * 97.0) as u32 % shapes,
                is_tree,
                size_m,
                world_from_model: Mat4::from_scale_rotation_translation(squat, turn, position_m),
                tint: [bright * warm, bright, bright * (2.0 - warm) * 0.95, if is_tree { TREE_SWAY_RAD } else { 0.0 }],
            });
        }
    }
    all
}

/// Radius of a trunk above its foot, over the tree's height.
pub(super) const GIRTH: f32 = 0.032;

/// Where the crown of a tree one metre tall begins and ends, and half its width (m).
#[derive(Clone, Copy, Debug)]
pub(super) struct Crown {
    pub(super) low: f32,
    pub(super) high: f32,
    pub(super) wide: f32,
}

/// The crown of a shape: round oak, tall poplar, broad hawthorn, pine-like cone.
pub(super) fn crown(shape: u32) -> Crown {
    let [low, high, wide] = match shape {
        0 => [0.26, 1.00, 0.42],
        1 => [0.16, 1.04, 0.21],
        2 => [0.20, 0.86, 0.50],
        _ => [0.14, 1.02, 0.30],
    };
    Crown { low, high, wide }
}

/// How finely a tree is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum TreeDetail {
    Fine,
    /// Fewer and larger sprays of leaves.
    Coarse,
    /// One spray for a clump of leaves, and hardly a trunk.
    Distant,
}

impl TreeDetail {
    pub(super) const ALL: [Self; 3] = [Self::Fine, Self::Coarse, Self::Distant];

    /// Sides of the trunk, its rings, and sprays of a clump of leaves.
    fn counts(self) -> [usize; 3] {
        match self {
            Self::Fine => [9, 5, 11],
            Self::Coarse => [5, 5, 3],
            Self::Distant => [3, 1, 1],
        }
    }
}

/// A tree one metre tall.
pub(super) fn tree(shape: u32, detail: TreeDetail) -> Solid {
    let mut random = Random::new(900 + u64::from(shape));
    let bark = Paint::new(0.105, 0.075, 0.050, 0.0);
    let mut tree = Solid::default();
    let Crown { low: crown_low, high: crown_high, wide: crown_wide } = crown(shape);
    let leaf = match shape {
        0 => [0.100, 0.170, 0.030],
        1 => [0.130, 0.200, 0.040],
        2 => [0.120, 0.165, 0.032],
        _ => [0.052, 0.105, 0.034],
    };
    let is_cone = shape == 3;
    let bow = Vec3::new(random.between(-0.05, 0.05), 0.0, random.between(-0.05, 0.05));
    let trunk_top = if is_cone { 0.92 } else { crown_low + 0.45 * (crown_high - crown_low) };
    let [sides, rings, cards] = detail.counts();
    let trunk = |t: f32| Vec3::new(bow.x * (t * 3.0).sin(), t * trunk_top, bow.z * (t * 2.2).sin());
    let rings: Vec<_> = (0..=rings)
        .map(|i| {
            let t = i as f32 / rings as f32;
            (trunk(t), GIRTH * (1.15 - 0.85 * t) + 0.02 * (1.0 - 5.0 * t).max(0.0))
        })
        .collect();
    tree.tube(&rings, sides, bark);
    let middle = Vec3::new(0.0, 0.5 * (crown_low + crown_high), 0.0);
    let half = Vec3::new(crown_wide, 0.5 * (crown_high - crown_low), crown_wide);
    let mut clumps = Vec::new();
    let count = if is_cone { 30 } else { 26 };
    for i in 0..count {
        let t = (i as f32 + 0.5) / count as f32;
        let angle = i as f32 * 2.399_963 + random.between(-0.3, 0.3);
        let (height, radius) = if is_cone {
            (crown_low + (crown_high - crown_low) * t.powf(1.3), crown_wide * (1.0 - t.powf(1.15)) * 0.85)
        } else {
            let y = 1.0 - 1.75 * t;
            (middle.y + half.y * y * 0.86, crown_wide * (1.0 - y * y).max(0.0).sqrt() * random.between(0.62, 0.95))
        };
        let centre = Vec3::new(radius * angle.cos(), height, radius * angle.sin());
        clumps.push(centre);
        if detail == TreeDetail::Fine && !is_cone && i % 2 == 0 {
            let start = trunk(random.between(0.55, 0.98));
            let knee = start.lerp(centre, 0.55) - Vec3::Y * 0.02;
            tree.tube(&[(start, GIRTH * 0.38), (knee, GIRTH * 0.24), (centre, GIRTH * 0.08)], 5, bark);
        }
    }
    let clump_size = if is_cone { 0.13 } else { 0.17 } * if shape == 1 { 0.8 } else { 1.0 };
    for (i, &clump) in clumps.iter().enumerate() {
        for _ in 0..cards {
            let offset = Vec3::new(random.between(-1.0, 1.0), random.between(-0.8, 0.8), random.between(-1.0, 1.0));
            let shrink = if is_cone { 1.0 - 0.55 * (i as f32 / clumps.len() as f32) } else { 1.0 };
            let centre = clump + offset * clump_size * 0.55 * shrink;
            let size = match detail {
                TreeDetail::Fine => random.between(0.55, 0.80),
                TreeDetail::Coarse => 1.05,
                TreeDetail::Distant => 1.45,
            };
            let size = clump_size * shrink * size;
            let outward = ((centre - middle) / half).normalize_or(Vec3::Y);
            let tilt = Vec3::new(random.between(-1.0, 1.0), random.between(-0.6, 1.0), random.between(-1.0, 1.0));
            let face = (outward + tilt * 0.9).normalize_or(Vec3::Y);
            let right = face.any_orthonormal_vector();
            let spin = Quat::from_axis_angle(face, random.between(0.0, TAU));
            let right = spin * right * size;
            let up = face.cross(right);
            // Deep in the crown and below it is darker.
            let depth = ((centre - middle) / half).length().min(1.0);
            let open =
                (0.30 + 0.70 * depth.powf(1.5)) * (0.72 + 0.28 * ((centre.y - crown_low) / (crown_high - crown_low)).clamp(0.0, 1.0));
            let hue = random.between(0.85, 1.2);
            let paint = Paint { rgb: [leaf[0] * hue, leaf[1], leaf[2] * (2.0 - hue)], gloss: open };
            let mut corner = |x: f32, y: f32| {
                let position = centre + right * x + up * y;
                let normal = (outward * 1.6 + (position - clump).normalize_or_zero() * 0.9 + Vec3::Y * 0.25).normalize_or(Vec3::Y);
                let leaf = Vec2::new(0.02 + 0.48 * (x + 1.0), 0.02 + 0.48 * (y + 1.0));
                tree.vertex(position, normal, paint, leaf)
            };
            let [a, b, c, d] = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
            tree.indices.extend([a, b, c, a, c, d]);
        }
    }
    tree
}

/// A stone one metre across.
pub(super) fn stone(shape: u32) -> Solid {
    let mut random = Random::new(40 + u64::from(shape));
    let (stacks, slices) = (9, 14);
    let planes: Vec<(Vec3, f32)> = (0..9)
        .map(|_| {
            let normal = Vec3::new(random.between(-1.0, 1.0), random.between(-0.5, 1.0), random.between(-1.0, 1.0));
            (normal.normalize_or(Vec3::Y), random.between(0.58, 0.86))
        })
        .collect();
    let mut stone = Solid::default();
    let rings: Vec<Vec<Vec3>> = (0..=stacks)
        .map(|i| {
            let (sin, cos) = (std::f32::consts::PI * i as f32 / stacks as f32).sin_cos();
            (0..slices)
                .map(|j| {
                    let (s, c) = (TAU * j as f32 / slices as f32).sin_cos();
                    let direction = Vec3::new(c * sin, -cos, -s * sin);
                    // A ball cut by planes.
                    let cut = planes.iter().fold(1.0_f32, |radius, &(normal, depth)| {
                        let along = direction.dot(normal);
                        if along > 0.0 { radius.min(depth / along) } else { radius }
                    });
                    let rough = 1.0 + 0.05 * (direction.x * 9.0 + shape as f32).sin() * (direction.z * 11.0).cos();
                    direction * (0.5 * cut * rough)
                })
                .collect()
        })
        .collect();
    stone.skin(&rings, Paint::new(0.26, 0.25, 0.225, 0.0));
    for vertex in &mut stone.vertices {
        let moss = (f32::from(vertex.normal[1]) / 127.0 - 0.55).max(0.0) * 1.6 * random.between(0.3, 1.0);
        let grey = random.between(0.85, 1.12);
        let base = [0.26 * grey, 0.25 * grey, 0.225 * grey];
        let green = [0.13, 0.17, 0.06];
        for channel in 0..3 {
            let mixed = base[channel] + (green[channel] - base[channel]) * moss.min(1.0);
            vertex.color[channel] = (mixed.sqrt() * 255.0) as u8;
        }
    }
    stone
}
