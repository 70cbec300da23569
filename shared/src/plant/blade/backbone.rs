//! The curve through a blade's control points, and the outline about it (000 sections 3.1.1, 3.2.1 and 3.2.5).

use super::LINKS;
use std::f32::consts::{PI, TAU};

/// Point of the backbone at a share `t` of the blade, 0 at the root and 1 at the tip (m from the root): the cubic of 000 Eq. (5), with its inner points chosen so
/// that it passes through the control points at 1/3 and 2/3, since those are what wind and spheres act on.
pub fn backbone_m(points_m: &[[f32; 3]; LINKS], t: f32) -> [f32; 3] {
    let [a, b, c] = points_m;
    let s = 1.0 - t;
    std::array::from_fn(|i| {
        let (first, second) = (3.0 * a[i] - 1.5 * b[i] + c[i] / 3.0, -1.5 * a[i] + 3.0 * b[i] - 5.0 / 6.0 * c[i]);
        3.0 * s * s * t * first + 3.0 * s * t * t * second + t * t * t * c[i]
    })
}

/// Two segment points (m from the root) at a share `t` of a blade that is `width_m` wide there and whose side points along `side_rad` at the root: the blade turns
/// evenly, by θ·i/n at segment i of n, until at its tip it faces where it leans (000 Fig. 8).
pub fn segment_points_m(points_m: &[[f32; 3]; LINKS], side_rad: f32, t: f32, width_m: f32) -> [[f32; 3]; 2] {
    let [x, _, z] = points_m[LINKS - 1];
    // Across the lean, by the lesser of both turns.
    let across_rad = x.atan2(-z);
    let turn_rad = (across_rad - side_rad + 0.5 * PI).rem_euclid(PI) - 0.5 * PI;
    let angle_rad = (side_rad + turn_rad * t).rem_euclid(TAU);
    let centre = backbone_m(points_m, t);
    [-0.5, 0.5].map(|half| {
        let out = half * width_m;
        [centre[0] + out * angle_rad.cos(), centre[1], centre[2] + out * angle_rad.sin()]
    })
}
