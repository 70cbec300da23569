//! Texture of flowers seen from above, for the squares of Zhang, section 3.3.

use crate::render::gpu::constants::{
    FLOWER_BASE_RGB, FLOWER_DISC_M, FLOWER_DISC_RGB, FLOWER_KINDS, FLOWER_PETAL_M, FLOWER_PETAL_WIDTH, FLOWER_PETALS, FLOWER_RISE_RAD,
    FLOWER_SQUARE, FLOWER_TIP_RGB, PETAL_ACROSS, PETAL_ALONG, PETAL_FLATTENS,
};
use crate::render::gpu::mipmaps::box_mipmaps;
use glam::Vec3;
use std::f32::consts::TAU;

/// Side of a flower's square (px).
const SIDE_PX: u32 = 64;
/// Size of the texture, with the squares of all kinds side by side (px).
pub(super) const FLOWERS_PX: [u32; 2] = [SIDE_PX * FLOWER_KINDS, SIDE_PX];
/// Mip levels, down to 4 px per square, so that kinds do not bleed into each other.
const LEVELS: usize = 5;

/// Square roots of the linear colours, and coverage. Beside the petals the colour is that of their tips, so that no level darkens towards the borders.
pub(super) fn flowers() -> Vec<Vec<u8>> {
    let [width, height] = FLOWERS_PX.map(|px| px as usize);
    let side = SIDE_PX as usize;
    let mut texels = Vec::with_capacity(width * height * 4);
    for y in 0..height {
        for x in 0..width {
            let kind = x / side;
            let at = [x % side, y].map(|px| (2.0 * (px as f32 + 0.5) / side as f32 - 1.0) * 0.5 * FLOWER_SQUARE * FLOWER_PETAL_M[kind]);
            let found = color(kind, at);
            let rgb = found.unwrap_or(Vec3::from(FLOWER_TIP_RGB[kind]));
            texels.extend(rgb.to_array().map(|linear| (linear.sqrt() * 255.0 + 0.5) as u8));
            texels.push(if found.is_some() { 255 } else { 0 });
        }
    }
    box_mipmaps::<4>(texels, FLOWERS_PX, LEVELS)
}

/// Linear colour at a place from the middle of a flower of a kind (m): of its disc, or of the topmost petal; `None` beside them.
fn color(kind: usize, [x, z]: [f32; 2]) -> Option<Vec3> {
    let from_middle_m = x.hypot(z);
    if from_middle_m < FLOWER_DISC_M[kind] {
        return Some(FLOWER_DISC_RGB[kind].into());
    }
    let petals = FLOWER_PETALS[kind];
    let along = (0..petals as u32).find_map(|petal| {
        let (sine, cosine) = (petal as f32 / petals * TAU).sin_cos();
        place_on_petal(kind, x * cosine + z * sine, z * cosine - x * sine)
    })?;
    Some(Vec3::from(FLOWER_BASE_RGB[kind]).lerp(FLOWER_TIP_RGB[kind].into(), along))
}

/// Position along a petal, 0 to 1, by the distances from the middle along its projection and across (m); `None` beside it.
fn place_on_petal(kind: usize, out_m: f32, across_m: f32) -> Option<f32> {
    let reach_m = |along: f32| FLOWER_PETAL_M[kind] * along * (FLOWER_RISE_RAD[kind] * (1.0 - PETAL_FLATTENS * along)).cos();
    [[0, 2], [2, 4]].into_iter().find_map(|[from, to]| {
        let [near_m, far_m] = [from, to].map(|row| reach_m(PETAL_ALONG[row]));
        let fraction = (out_m - near_m) / (far_m - near_m);
        let between = |ends: [f32; 2]| ends[0] + fraction * (ends[1] - ends[0]);
        let half_m = between([PETAL_ACROSS[from], PETAL_ACROSS[to]]) * FLOWER_PETAL_WIDTH[kind] * FLOWER_PETAL_M[kind];
        ((0.0..=1.0).contains(&fraction) && across_m.abs() <= half_m).then(|| between([PETAL_ALONG[from], PETAL_ALONG[to]]))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mean colour and coverage of a kind's square at a level.
    fn mean(levels: &[Vec<u8>], level: usize, kind: usize) -> (Vec3, f32) {
        let side = SIDE_PX as usize >> level;
        let texels = levels[level].chunks_exact(4).enumerate().filter(|(at, _)| at % (side * FLOWER_KINDS as usize) / side == kind);
        let (mut rgb, mut covered) = (Vec3::ZERO, 0.0);
        for (_, texel) in texels {
            let [r, g, b, a] = [0, 1, 2, 3].map(|channel| f32::from(texel[channel]) / 255.0);
            rgb += a * Vec3::new(r * r, g * g, b * b);
            covered += a;
        }
        (rgb / covered, covered / (side * side) as f32)
    }

    #[test]
    fn six_flowers_keep_their_colour_and_coverage_at_every_level() {
        let levels = flowers();
        assert_eq!(levels.len(), LEVELS);
        let all: Vec<_> = (0..FLOWER_KINDS as usize).map(|kind| mean(&levels, 0, kind)).collect();
        for (kind, (rgb, covered)) in all.iter().enumerate() {
            assert!((0.2..0.8).contains(covered), "kind {kind} covers {covered} of its square");
            for (other, (theirs, _)) in all.iter().enumerate().filter(|(other, _)| *other != kind) {
                assert!(rgb.distance(*theirs) > 0.1, "kinds {kind} and {other} look alike: {rgb} and {theirs}");
            }
            let (coarse_rgb, coarse) = mean(&levels, LEVELS - 1, kind);
            assert!(
                (coarse / covered - 1.0).abs() < 0.03 && coarse_rgb.distance(*rgb) < 0.12,
                "kind {kind}: {covered} and {coarse}, {rgb} and {coarse_rgb}"
            );
        }
    }

    #[test]
    fn the_tip_of_the_first_petal_ends_where_the_modelled_one_does() {
        for kind in 0..FLOWER_KINDS as usize {
            let reach_m = FLOWER_PETAL_M[kind] * (FLOWER_RISE_RAD[kind] * (1.0 - PETAL_FLATTENS)).cos();
            assert!(color(kind, [0.99 * reach_m, 0.0]).is_some() && color(kind, [1.01 * reach_m, 0.0]).is_none(), "kind {kind}");
        }
    }
}
