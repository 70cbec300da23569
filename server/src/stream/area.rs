//! Patches in a client's area of interest: those near its camera, nearest first.

use prairie_core::grid::{PatchIndex, PatchLayout};

/// Largest number of patches sent to one client; larger radii are reduced to fit.
pub const PATCH_LIMIT: usize = 1024;

/// Patches within `radius_m` of `(x_m, z_m)` in plan view, nearest first, ties in index order.
pub fn patches_near(layout: &PatchLayout, [x_m, z_m]: [f32; 2], radius_m: f32) -> Vec<PatchIndex> {
    let radius_m = radius_m.min(layout.patch_m() * ((PATCH_LIMIT as f32).sqrt() / 2.0 - 1.0));
    let (low, high) = ([x_m - radius_m, z_m - radius_m], [x_m + radius_m, z_m + radius_m]);
    let mut near: Vec<(f32, PatchIndex)> = layout
        .patches_touching(low, high)
        .map(|patch| (distance2_m2(layout, patch, [x_m, z_m]), patch))
        .filter(|&(distance2_m2, _)| distance2_m2 <= radius_m * radius_m)
        .collect();
    near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    near.into_iter().map(|(_, patch)| patch).collect()
}

/// Squared distance from a point to a patch (m²); 0 inside it.
fn distance2_m2(layout: &PatchLayout, patch: PatchIndex, point_m: [f32; 2]) -> f32 {
    let corner_m = layout.corner_m(patch);
    (0..2)
        .map(|axis| {
            let beyond = point_m[axis] - point_m[axis].clamp(corner_m[axis], corner_m[axis] + layout.patch_m());
            beyond * beyond
        })
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAYOUT: PatchLayout = PatchLayout { count: [16, 16], cells: 8, cell_m: 1.0 };

    #[test]
    fn patches_are_sorted_by_distance_from_the_camera() {
        let near = patches_near(&LAYOUT, [20.0, 20.0], 9.0);
        assert_eq!(near[0], LAYOUT.patch_at(20.0, 20.0).unwrap());
        let distances: Vec<_> = near.iter().map(|&patch| distance2_m2(&LAYOUT, patch, [20.0, 20.0])).collect();
        assert!(distances.is_sorted());
        assert_eq!(near.len(), 9, "the camera's patch and its eight neighbours");
    }

    #[test]
    fn a_zero_radius_contains_only_the_camera_s_patch() {
        assert_eq!(patches_near(&LAYOUT, [1.0, 1.0], 0.0), [0]);
        assert!(patches_near(&LAYOUT, [-500.0, 1.0], 10.0).is_empty());
    }

    #[test]
    fn a_large_radius_over_small_patches_is_bounded() {
        let layout = PatchLayout { count: [2048, 2048], cells: 8, cell_m: 0.05 };
        let near = patches_near(&layout, [400.0, 400.0], 512.0);
        assert!(near.len() > PATCH_LIMIT / 2 && near.len() <= PATCH_LIMIT, "{}", near.len());
    }
}
