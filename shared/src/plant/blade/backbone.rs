//! Backbone curve of a blade's control points, and the outline about it (Zhang §§3.1.1, 3.2.1 and 3.2.5). Twin of `backbone.wgsl`.

use super::LINKS;
use std::f32::consts::PI;

/// Point of the backbone at parameter `t`, 0 at the root and 1 at the tip (m from the root): the cubic Bézier curve of Zhang Eq. (5), which passes
/// through root and tip only.
pub fn backbone_m(points_m: &[[f32; 3]; LINKS], t: f32) -> [f32; 3] {
    let [a, b, c] = points_m;
    let s = 1.0 - t;
    std::array::from_fn(|i| 3.0 * s * s * t * a[i] + 3.0 * s * t * t * b[i] + t * t * t * c[i])
}

/// Control points for drawing a blade as a strip of `segments` segments between equal steps of `t`: all three are moved away from the root by the one
/// factor that makes the strip `length_m` long.
///
/// A Bézier curve is shorter than the polygon of its control points: by 0.5 % for grass that a wind of 10 m/s bends by half a radian, by 15 % with
/// one right angle. The strip's length is exact to rounding (1e-5). The curve that it approximates is longer by (θ/n)²/24 if n segments share a turn
/// of θ evenly, and by at most 1 % with seven. The curve is in the hull of root and control points, so it is above every plane through the root that
/// the control points are above.
pub fn drawn_out_m(points_m: &[[f32; 3]; LINKS], length_m: f32, segments: u32) -> [[f32; 3]; LINKS] {
    let (mut below, mut strip_m) = ([0.0; 3], 0.0);
    for segment in 1..=segments {
        let at = backbone_m(points_m, segment as f32 / segments as f32);
        let [x, y, z] = [0, 1, 2].map(|i| at[i] - below[i]);
        strip_m += (x * x + y * y + z * z).sqrt();
        below = at;
    }
    points_m.map(|point_m| point_m.map(|v| v * (length_m / strip_m)))
}

/// Two segment points (m from the root) at parameter `t` of a blade that is `width_m` wide there and whose side points along `side_rad` at the root.
/// The blade twists evenly, by θ·i/n at segment i of n, until its tip faces the direction of its lean (Zhang Fig. 8). A strip has no front, so θ is
/// the smaller of both turns, at most a right angle; an upright blade does not twist.
pub fn segment_points_m(points_m: &[[f32; 3]; LINKS], side_rad: f32, t: f32, width_m: f32) -> [[f32; 3]; 2] {
    let [x, _, z] = points_m[LINKS - 1];
    let across_rad = if x == 0.0 && z == 0.0 { side_rad } else { x.atan2(-z) };
    let turn_rad = (across_rad - side_rad + 0.5 * PI).rem_euclid(PI) - 0.5 * PI;
    let angle_rad = side_rad + turn_rad * t;
    let centre = backbone_m(points_m, t);
    [-0.5, 0.5].map(|half| {
        let out = half * width_m;
        [centre[0] + out * angle_rad.cos(), centre[1], centre[2] + out * angle_rad.sin()]
    })
}
