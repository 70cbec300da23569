//! Squares of the map that are covered with grass of one kind: land needs neither bare soil nor the map of kinds there, which are half of its price in software.

use crate::render::gpu::constants::{RAGGED, RAGGED_PX_M};
use crate::state::DecodedScene;
use glam::Vec2;
use prairie_core::terrain::Cover;
use std::ops::Range;

/// Maximum number of squares along each side of the map.
const SIDE_LIMIT: f32 = 1024.0;

/// The kind of grass of each square of the map that is plain.
pub(crate) struct PlainGround {
    square_m: f32,
    /// Number of whole squares along X and Z.
    count: [usize; 2],
    /// Whether all grass is of one kind, and whole squares cover the map.
    continues: bool,
    /// Row by row; `None` where a square is not plain.
    pub(crate) kinds: Vec<Option<u8>>,
}

/// A map of pixels that covers a map of `extent_m`.
struct Pixels<'a> {
    ids: &'a [u8],
    size_px: [u32; 2],
    extent_m: [f32; 2],
}

impl PlainGround {
    /// The plain squares of at least `least_m` along each side.
    pub(crate) fn new(decoded: &DecodedScene, least_m: f32) -> Self {
        let (scene, extent_m) = (decoded.scene(), decoded.scene().extent_m());
        let mut square_m = least_m;
        while extent_m[0].max(extent_m[1]) > SIDE_LIMIT * square_m {
            square_m *= 2.0;
        }
        let cover = Pixels { ids: decoded.cover().ids(), size_px: decoded.cover().size_px(), extent_m };
        let kinds = Pixels { ids: decoded.kinds().kinds(), size_px: decoded.kinds().size_px(), extent_m };
        let count = extent_m.map(|m| (m / square_m) as usize);
        let plain = |at: usize| {
            let corner_m = [at % count[0], at / count[0]].map(|n| n as f32 * square_m);
            let is_covered = cover.within(corner_m, square_m, |_| 0.0).all(|id| scene.is_grass(Cover::from(id)));
            let mut found =
                kinds.within(corner_m, square_m, |px_m| 0.5 * (RAGGED[0] + RAGGED[1]) * px_m.clamp(RAGGED_PX_M[0], RAGGED_PX_M[1]));
            let first = found.next().filter(|_| is_covered)?;
            found.all(|kind| kind == first).then_some(first)
        };
        let continues = scene.species.is_empty() && (0..2).all(|axis| count[axis] as f32 * square_m == extent_m[axis]);
        Self { square_m, count, continues, kinds: (0..count[0] * count[1]).map(plain).collect() }
    }

    /// Kind of the grass in all squares that a region touches, if they are plain. Where grass of one kind grows, the squares at the edge of the map
    /// continue beyond it.
    pub(crate) fn kind(&self, corner_m: Vec2, side_m: f32) -> Option<u8> {
        let squares = |from_m: f32, count: usize| {
            let (first, end) = ((from_m / self.square_m).floor(), ((from_m + side_m) / self.square_m).ceil());
            let is_within = first >= 0.0 && end <= count as f32;
            let last = count.checked_sub(1)? as f32;
            (is_within || self.continues).then(|| first.clamp(0.0, last) as usize..end.clamp(1.0, last + 1.0) as usize)
        };
        let (columns, rows) = (squares(corner_m.x, self.count[0])?, squares(corner_m.y, self.count[1])?);
        let mut found = rows.flat_map(|row| &self.kinds[row * self.count[0]..][columns.clone()]);
        let first = (*found.next()?)?;
        found.all(|kind| *kind == Some(first)).then_some(first)
    }
}

impl Pixels<'_> {
    /// Values that interpolation may use in a square, with a margin (m) that depends on the size of a pixel (m).
    fn within(&self, corner_m: [f32; 2], side_m: f32, margin_m: impl Fn(f32) -> f32) -> impl Iterator<Item = u8> {
        let [columns, rows]: [Range<usize>; 2] = std::array::from_fn(|axis| {
            let px_m = self.extent_m[axis] / self.size_px[axis] as f32;
            let margin_m = margin_m(px_m) + px_m;
            let last = self.size_px[axis] as usize - 1;
            let first = ((corner_m[axis] - margin_m) / px_m).max(0.0) as usize;
            first.min(last)..(((corner_m[axis] + side_m + margin_m) / px_m) as usize).min(last) + 1
        });
        rows.flat_map(move |row| &self.ids[row * self.size_px[0] as usize..][columns.clone()]).copied()
    }
}
