//! Trees and stones: their shapes, and their positions on the covering map with those of its models (Zhang, section 5.5.2).

use crate::render::inputs::random::{Random, random3};
use crate::render::solids::mesh::{Paint, Solid};
use crate::state::DecodedScene;
use glam::{Mat4, Quat, Vec2, Vec3};
use prairie_core::terrain::{Cover, ModelBox, model_boxes};
use std::f32::consts::TAU;

/// Number of shapes of trees and of stones.
pub(crate) const TREE_SHAPES: u32 = 4;
pub(crate) const STONE_SHAPES: u32 = 3;
/// Maximum number of trees, and of stones. If a scene has more, only every n-th is drawn.
const MODEL_LIMIT: usize = 100_000;

/// Sway of the top of a tree at 10 m/s and above, relative to its height.
const TREE_SWAY_RAD: f32 = 0.07;

/// Kind of a placed model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PlacedKind {
    Tree,
    Stone,
    /// A model of the scene's own, in its box.
    Own,
}

/// A tree, a stone or a model of the scene's own.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlacedModel {
    /// Position of its foot; of its middle for a model of the scene's own.
    pub(crate) position_m: Vec3,
    /// Number of its shape among those of its kind; the index in [`Scene::models`](prairie_core::scene::Scene::models).
    pub(crate) shape: u32,
    pub(crate) kind: PlacedKind,
    /// Mean size of its kind, of this one; the height of a model of the scene's own.
    pub(crate) size_m: f32,
    pub(crate) world_from_model: Mat4,
    pub(crate) tint: [f32; 4],
}

impl PlacedModel {
    pub(crate) fn is_tree(&self) -> bool {
        self.kind == PlacedKind::Tree
    }

    /// A model of the scene's own in its box.
    fn in_box(own: &ModelBox, decoded: &DecodedScene) -> Self {
        let ([x, z], half_m) = (own.at_m, own.half_m);
        let position_m = Vec3::new(x, own.floor_m(|x, z| decoded.heights().height_m(x, z)) + half_m[1], z);
        let turn = Quat::from_array(own.rotation());
        Self {
            position_m,
            shape: own.model as u32,
            kind: PlacedKind::Own,
            size_m: 2.0 * half_m[1],
            world_from_model: Mat4::from_scale_rotation_translation(Vec3::splat(own.scale), turn, position_m),
            tint: [1.0, 1.0, 1.0, 0.0],
        }
    }
}

/// All trees and stones, each with a random rotation, size and offset, and the models of the scene's own, where the server has them.
pub(crate) fn placed_models(decoded: &DecodedScene) -> Vec<PlacedModel> {
    let extent_m = decoded.scene().extent_m();
    let [width, depth] = decoded.cover().size_px();
    let pixel_m = [extent_m[0] / width as f32, extent_m[1] / depth as f32];
    let plants = &decoded.scene().plants;
    let boxes = model_boxes(decoded.scene(), decoded.cover());
    let mut all: Vec<_> = boxes.iter().map(|own| PlacedModel::in_box(own, decoded)).collect();
    for (cover, is_tree, shapes, mean_m) in
        [(Cover::Tree, true, TREE_SHAPES, plants.tree_m), (Cover::Stone, false, STONE_SHAPES, plants.stone_m)]
    {
        let places: Vec<_> = decoded.cover().places_m(cover, extent_m).collect();
        for &[x, z] in places.iter().step_by(places.len().div_ceil(MODEL_LIMIT).max(1)) {
            let place = [(x / pixel_m[0]) as i32, (z / pixel_m[1]) as i32];
            let [r, s] = [random3(place, 401), random3(place, 577)];
            let x = x + (r[0] - 0.5) * pixel_m[0].min(6.0);
            let z = z + (r[1] - 0.5) * pixel_m[1].min(6.0);
            let size_m = mean_m * if is_tree { 0.72 + 0.56 * r[2] } else { 0.45 + 1.1 * r[2] * r[2] };
            let ground_m = decoded.heights().height_m(x, z);
            let position_m = Vec3::new(x, ground_m - if is_tree { 0.1 } else { 0.12 * size_m }, z);
            let turn = Quat::from_rotation_y(s[0] * TAU);
            let lean = if is_tree { 0.0 } else { 0.3 * (s[1] - 0.5) };
            let turn = turn * Quat::from_rotation_x(lean);
            let squat = Vec3::new(size_m, size_m * if is_tree { 0.92 + 0.16 * s[1] } else { 0.75 + 0.5 * s[1] }, size_m);
            let bright = 0.82 + 0.36 * s[2];
            let warm = 0.92 + 0.2 * r[0];
            all.push(PlacedModel {
                position_m,
                shape: (s[1] * 97.0) as u32 % shapes,
                kind: if is_tree { PlacedKind::Tree } else { PlacedKind::Stone },
                size_m,
                world_from_model: Mat4::from_scale_rotation_translation(squat, turn, position_m),
                tint: [bright * warm, bright, bright * (2.0 - warm) * 0.95, if is_tree { TREE_SWAY_RAD } else { 0.0 }],
            });
        }
    }
    all
}

/// Radius of a trunk above its foot, relative to the height of the tree.
pub(crate) const GIRTH: f32 = 0.032;

/// Lower and upper end of the crown of a tree one metre tall, and half its width (m).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Crown {
    pub(crate) low: f32,
    pub(crate) high: f32,
    pub(crate) wide: f32,
}

/// The crown of a shape: round oak, tall poplar, broad hawthorn, pine-like cone.
pub(crate) fn crown(shape: u32) -> Crown {
    let [low, high, wide] = match shape {
        0 => [0.26, 1.00, 0.42],
        1 => [0.16, 1.04, 0.21],
        2 => [0.20, 0.86, 0.50],
        _ => [0.14, 1.02, 0.30],
    };
    Crown { low, high, wide }
}

/// Level of detail of a tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum TreeDetail {
    Fine,
    /// Fewer and larger sprays of leaves, and no branches.
    Coarse,
    /// Even fewer and larger ones, and a minimal trunk.
    Distant,
}

impl TreeDetail {
    pub(crate) const ALL: [Self; 3] = [Self::Fine, Self::Coarse, Self::Distant];

    /// Sides and rings of the trunk, and sprays per clump of leaves.
    pub(super) fn counts(self) -> [usize; 3] {
        match self {
            Self::Fine => [9, 5, FINE_SPRAYS],
            Self::Coarse => [5, 5, 3],
            Self::Distant => [3, 1, 2],
        }
    }

    /// Size of a spray of leaves relative to that of a fine tree, which keeps the light of the crown.
    pub(super) fn spray_scale(self) -> f32 {
        match self {
            Self::Fine => 1.0,
            Self::Coarse => 1.6,
            Self::Distant => 1.75,
        }
    }
}

/// Sprays per clump of leaves of a fine tree; coarser trees have the first of them.
const FINE_SPRAYS: usize = 11;

/// A tree one metre tall.
pub(crate) fn tree(shape: u32, detail: TreeDetail) -> Solid {
    let mut random = Random::new(900 + u64::from(shape));
    let mut tree = Solid::default();
    let form = TreeForm::new(shape, &mut random);
    let [sides, rings, sprays] = detail.counts();
    let rings: Vec<_> = (0..=rings)
        .map(|i| {
            let t = i as f32 / rings as f32;
            (form.trunk(t), GIRTH * (1.15 - 0.85 * t) + 0.02 * (1.0 - 5.0 * t).max(0.0))
        })
        .collect();
    tree.tube(&rings, sides, BARK);
    let clumps = form.clumps(&mut tree, detail, &mut random);
    for (i, &clump) in clumps.iter().enumerate() {
        let along = i as f32 / clumps.len() as f32;
        for n in 0..FINE_SPRAYS {
            let mut spray = form.spray(clump, along, &mut random);
            if n < sprays {
                spray.size *= detail.spray_scale();
                form.add_spray(&mut tree, &spray);
            }
        }
    }
    tree
}

pub(super) const BARK: Paint = Paint::new(0.105, 0.075, 0.050, 0.0);

/// A square of leaves in a tree one metre tall.
pub(super) struct Spray {
    /// Centre of the clump it belongs to.
    clump: Vec3,
    centre: Vec3,
    /// Half its side (m).
    pub(super) size: f32,
    /// How its face differs from the direction out of the crown.
    tilt: Vec3,
    spin_rad: f32,
    hue: f32,
}

/// Shape of a tree one metre tall.
pub(super) struct TreeForm {
    shape: u32,
    pub(super) is_cone: bool,
    pub(super) crown: Crown,
    /// Bend of the trunk (m).
    bow: Vec3,
    pub(super) trunk_top: f32,
    /// Centre and half extents of the crown.
    middle: Vec3,
    half: Vec3,
    clump_size: f32,
}

impl TreeForm {
    pub(super) fn new(shape: u32, random: &mut Random) -> Self {
        let crown = crown(shape);
        let Crown { low, high, wide } = crown;
        let is_cone = shape == 3;
        Self {
            shape,
            is_cone,
            crown,
            bow: Vec3::new(random.between(-0.05, 0.05), 0.0, random.between(-0.05, 0.05)),
            trunk_top: if is_cone { 0.92 } else { low + 0.45 * (high - low) },
            middle: Vec3::new(0.0, 0.5 * (low + high), 0.0),
            half: Vec3::new(wide, 0.5 * (high - low), wide),
            clump_size: if is_cone { 0.13 } else { 0.17 } * if shape == 1 { 0.8 } else { 1.0 },
        }
    }

    fn trunk(&self, t: f32) -> Vec3 {
        Vec3::new(self.bow.x * (t * 3.0).sin(), t * self.trunk_top, self.bow.z * (t * 2.2).sin())
    }

    /// Positions of the clumps of leaves; fine trees get branches to every second one.
    fn clumps(&self, tree: &mut Solid, detail: TreeDetail, random: &mut Random) -> Vec<Vec3> {
        let Crown { low, high, wide } = self.crown;
        let count = if self.is_cone { 30 } else { 26 };
        let mut clumps = Vec::new();
        for i in 0..count {
            let t = (i as f32 + 0.5) / count as f32;
            let angle = i as f32 * 2.399_963 + random.between(-0.3, 0.3);
            let (height, radius) = if self.is_cone {
                (low + (high - low) * t.powf(1.3), wide * (1.0 - t.powf(1.15)) * 0.85)
            } else {
                let y = 1.0 - 1.75 * t;
                (self.middle.y + self.half.y * y * 0.86, wide * (1.0 - y * y).max(0.0).sqrt() * random.between(0.62, 0.95))
            };
            let centre = Vec3::new(radius * angle.cos(), height, radius * angle.sin());
            clumps.push(centre);
            if !self.is_cone && i % 2 == 0 {
                let start = self.trunk(random.between(0.55, 0.98));
                let knee = start.lerp(centre, 0.55) - Vec3::Y * 0.02;
                if detail == TreeDetail::Fine {
                    tree.tube(&[(start, GIRTH * 0.38), (knee, GIRTH * 0.24), (centre, GIRTH * 0.08)], 5, BARK);
                }
            }
        }
        clumps
    }

    /// A random spray of leaves of a fine tree; `along` is the position of its clump from the first (0) to the last (1).
    pub(super) fn spray(&self, clump: Vec3, along: f32, random: &mut Random) -> Spray {
        let offset = Vec3::new(random.between(-1.0, 1.0), random.between(-0.8, 0.8), random.between(-1.0, 1.0));
        let size = self.clump_size * if self.is_cone { 1.0 - 0.55 * along } else { 1.0 };
        Spray {
            clump,
            centre: clump + offset * size * 0.55,
            size: size * random.between(0.55, 0.80),
            tilt: Vec3::new(random.between(-1.0, 1.0), random.between(-0.6, 1.0), random.between(-1.0, 1.0)),
            spin_rad: random.between(0.0, TAU),
            hue: random.between(0.85, 1.2),
        }
    }

    /// Adds the two triangles of a spray to a tree.
    pub(super) fn add_spray(&self, tree: &mut Solid, &Spray { clump, centre, size, tilt, spin_rad, hue }: &Spray) {
        let leaf = match self.shape {
            0 => [0.100, 0.170, 0.030],
            1 => [0.130, 0.200, 0.040],
            2 => [0.120, 0.165, 0.032],
            _ => [0.052, 0.105, 0.034],
        };
        let Crown { low, high, .. } = self.crown;
        let outward = ((centre - self.middle) / self.half).normalize_or(Vec3::Y);
        let face = (outward + tilt * 0.9).normalize_or(Vec3::Y);
        let right = Quat::from_axis_angle(face, spin_rad) * face.any_orthonormal_vector() * size;
        let up = face.cross(right);
        // It is darker deep inside the crown and near its lower end.
        let depth = ((centre - self.middle) / self.half).length().min(1.0);
        let open = (0.30 + 0.70 * depth.powf(1.5)) * (0.72 + 0.28 * ((centre.y - low) / (high - low)).clamp(0.0, 1.0));
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

/// A stone one metre across.
pub(crate) fn stone(shape: u32) -> Solid {
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
                    // A sphere cut by planes.
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
