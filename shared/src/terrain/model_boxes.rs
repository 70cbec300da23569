//! Boxes of the models that the covering map places (Zhang §5.5.2), the same on server and client to the last bit.

use super::{Cover, CoverMap};
use crate::hash::{folded, hash3, unit};
use crate::scene::{CoverModel, Scene};
use std::collections::HashMap;

/// Largest number of models in a world; [`model_boxes`] places no more.
pub const MODEL_BOXES_LIMIT: usize = 4096;

/// Largest number of pixels of the covering map in the rectangles around all models together, which bounds the time to clear the ground under them.
pub const MODEL_PIXELS_LIMIT: u64 = 1 << 28;

/// Upright box of one model in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModelBox {
    /// Index in [`Scene::models`].
    pub model: usize,
    /// X and Z of its middle (m).
    pub at_m: [f32; 2],
    /// Size relative to the mean of its model.
    pub scale: f32,
    /// Half of its width, height and depth (m).
    pub half_m: [f32; 3],
    /// Unit vector of its right side on the ground, X and Z; its front faces this direction turned left.
    pub along: [f32; 2],
}

/// The boxes of all models of a scene, model by model, each row by row from the north-west. They depend on the pixels of the models' own IDs alone, so
/// that [`clear_under_models`] changes nothing about them.
pub fn model_boxes(scene: &Scene, cover: &CoverMap) -> Vec<ModelBox> {
    let mut left_px = MODEL_PIXELS_LIMIT;
    let fits = |own: &ModelBox| {
        let px = own.pixels(scene.extent_m(), cover.size_px());
        left_px.checked_sub(px).inspect(|&left| left_px = left).is_some()
    };
    placed(scene, cover).take(MODEL_BOXES_LIMIT).take_while(fits).collect()
}

/// Whether the covering map of a scene places more models than [`MODEL_BOXES_LIMIT`], or over more pixels than [`MODEL_PIXELS_LIMIT`].
pub fn has_too_many_models(scene: &Scene, cover: &CoverMap) -> bool {
    placed(scene, cover).nth(model_boxes(scene, cover).len()).is_some()
}

/// Makes a gap of each pixel that the box of a model touches, except for those that place a model themselves.
pub fn clear_under_models(scene: &Scene, cover: &mut CoverMap) {
    let mut is_model = [false; 256];
    scene.models.iter().for_each(|model| is_model[usize::from(model.cover)] = true);
    for own in model_boxes(scene, cover) {
        cover.clear_where(own.bounds_m(), scene.extent_m(), |id, corner_m, side_m| {
            !is_model[usize::from(id)] && own.touches(corner_m, side_m)
        });
    }
}

fn placed(scene: &Scene, cover: &CoverMap) -> impl Iterator<Item = ModelBox> {
    let extent_m = scene.extent_m();
    let size_px = cover.size_px();
    let seed = folded(scene.seed);
    scene.models.iter().enumerate().flat_map(move |(index, model)| {
        let mut apart = Apart::new(model.apart_m);
        let places = cover.places_m(Cover::Free(model.cover), extent_m).filter(move |&at_m| apart.admits(at_m));
        places.map(move |at_m| {
            let pixel: [u32; 2] = std::array::from_fn(|axis| (at_m[axis] / extent_m[axis] * size_px[axis] as f32) as u32);
            ModelBox::new(index, model, at_m, hash3([pixel[0], pixel[1], seed ^ u32::from(model.cover)]))
        })
    })
}

impl ModelBox {
    fn new(index: usize, model: &CoverModel, at_m: [f32; 2], random: [u32; 3]) -> Self {
        let [turn, size] = [random[0], random[1]].map(|bits| 2.0 * unit(bits) - 1.0);
        let (sine, cosine) = libm::sincosf(model.heading_rad + model.heading_variation_rad * turn);
        let scale = 1.0 + model.size_variation * size;
        Self { model: index, at_m, scale, half_m: model.size_m.map(|side_m| 0.5 * side_m * scale), along: [cosine, sine] }
    }

    /// Radius of the circle around it, seen from above (m).
    pub fn radius_m(&self) -> f32 {
        let [x, _, z] = self.half_m;
        (x * x + z * z).sqrt()
    }

    /// Unit quaternion (x, y, z, w) of the turn about Y from facing north to facing its front.
    pub fn rotation(&self) -> [f32; 4] {
        let [c, s] = self.along;
        let [sine, cosine] = [1.0 - c, 1.0 + c].map(|double| (0.5 * double.max(0.0)).sqrt());
        [0.0, if s < 0.0 { sine } else { -sine }, 0.0, cosine]
    }

    /// Elevation of its floor (m): the lowest of the land at its middle and its corners, so that it stands in a slope and not above it.
    pub fn floor_m(&self, height_m: impl Fn(f32, f32) -> f32) -> f32 {
        let corner = |[right, back]: [f32; 2]| {
            let [x, z] = self.in_world([right * self.half_m[0], back * self.half_m[2]]);
            height_m(x, z)
        };
        let corners = [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]].map(corner);
        corners.into_iter().fold(height_m(self.at_m[0], self.at_m[1]), f32::min)
    }

    /// Squared distance (m²) of a point from it, seen from above; 0 within.
    pub fn squared_distance_m2(&self, at_m: [f32; 2]) -> f32 {
        let [right, back] = self.own_axes([at_m[0] - self.at_m[0], at_m[1] - self.at_m[1]]);
        let [x, z] = [right.abs() - self.half_m[0], back.abs() - self.half_m[2]].map(|beyond| beyond.max(0.0));
        x * x + z * z
    }

    /// The lowest and the highest X and Z that it reaches (m).
    fn bounds_m(&self) -> [[f32; 2]; 2] {
        let [c, s] = self.along.map(f32::abs);
        let [half_x, _, half_z] = self.half_m;
        let reach = [c * half_x + s * half_z, s * half_x + c * half_z];
        [-1.0, 1.0].map(|side: f32| std::array::from_fn(|axis| self.at_m[axis] + side * reach[axis]))
    }

    /// Number of pixels of a map over a world of `extent_m` in the rectangle around it.
    fn pixels(&self, extent_m: [f32; 2], size_px: [u32; 2]) -> u64 {
        let [low_m, high_m] = self.bounds_m();
        (0..2).map(|axis| ((high_m[axis] - low_m[axis]) / extent_m[axis] * size_px[axis] as f32) as u64 + 2).product()
    }

    /// Whether it overlaps the rectangle with this north-western corner and these sides (m): no axis of either separates them.
    fn touches(&self, corner_m: [f32; 2], side_m: [f32; 2]) -> bool {
        let half: [f32; 2] = side_m.map(|side| 0.5 * side);
        let away: [f32; 2] = std::array::from_fn(|axis| corner_m[axis] + half[axis] - self.at_m[axis]);
        let [low, high] = self.bounds_m();
        let is_in_bounds = (0..2).all(|axis| away[axis].abs() < half[axis] + 0.5 * (high[axis] - low[axis]));
        let [c, s] = self.along.map(f32::abs);
        let [right, back] = self.own_axes(away);
        is_in_bounds && right.abs() < self.half_m[0] + c * half[0] + s * half[1] && back.abs() < self.half_m[2] + s * half[0] + c * half[1]
    }

    /// A vector on the ground along its right and back axes.
    fn own_axes(&self, [x, z]: [f32; 2]) -> [f32; 2] {
        let [c, s] = self.along;
        [c * x + s * z, c * z - s * x]
    }

    /// The point at a distance to the right and to the back of its middle (m).
    fn in_world(&self, [right, back]: [f32; 2]) -> [f32; 2] {
        let [c, s] = self.along;
        [self.at_m[0] + c * right - s * back, self.at_m[1] + s * right + c * back]
    }
}

/// Points at least a distance apart, each found in constant time.
struct Apart {
    apart_m: f32,
    squares: HashMap<[i32; 2], Vec<[f32; 2]>>,
}

impl Apart {
    fn new(apart_m: f32) -> Self {
        Self { apart_m, squares: HashMap::new() }
    }

    /// Whether a point is far enough from all that were admitted before; it is admitted then.
    fn admits(&mut self, at_m: [f32; 2]) -> bool {
        if self.apart_m <= 0.0 {
            return true;
        }
        let [column, row] = at_m.map(|m| (m / self.apart_m).floor() as i32);
        let is_far = |other: &[f32; 2]| {
            let [x, z] = [other[0] - at_m[0], other[1] - at_m[1]];
            x * x + z * z >= self.apart_m * self.apart_m
        };
        let mut around = (-1..=1).flat_map(|z| (-1..=1).map(move |x| [column.saturating_add(x), row.saturating_add(z)]));
        let is_admitted = around.all(|square| self.squares.get(&square).is_none_or(|others| others.iter().all(is_far)));
        if is_admitted {
            self.squares.entry([column, row]).or_default().push(at_m);
        }
        is_admitted
    }
}

#[cfg(test)]
mod tests;
