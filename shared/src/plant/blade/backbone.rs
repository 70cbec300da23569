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

/// Fraction of a blade's length that its strip may lack before its control points are moved apart to lengthen it.
pub const SPARE: f32 = 0.02;

/// Fraction of its length that a strip with one right angle lacks.
pub const RIGHT_ANGLE_LACK: f32 = 0.16;

/// Deviation from that at which control points are no longer moved apart: bends in a wind lack less; zigzags, which would swing out far at their
/// corners, more.
pub const LACK_RANGE: f32 = 0.12;

/// Largest factor, less 1, by which the two lower control points are moved away from the root: that for one right angle.
pub const LARGEST_BULGE: f32 = 0.72;

/// Slope of the length of a strip by this factor, over the blade's length, that is added to the true one: for a straight blade this is 0.
pub const LEAST_GROWTH: f32 = 0.02;

/// Control points for drawing a blade as a strip of `segments` segments between equal steps of `t`, `length_m` long.
///
/// A Bézier curve is shorter than the polygon of its control points: by 0.5 % for grass that a wind of 10 m/s bends by half a radian, by 15 % with
/// one right angle. For bends that lack about as much as a right angle, the lower two are moved away from the root by one factor, in three Newton
/// steps, until the strip lacks [`SPARE`]; a last factor on all three makes its length exact to rounding (1e-5). So the tip of a blade with one right
/// angle is within 2 % of the length of its third control point, with three segments or more, and no tip is farther from it than with the last
/// factor alone.
///
/// The curve that the strip approximates is longer by (θ/n)²/24 if n segments share a turn of θ evenly, and by at most 1 % with seven. The curve is in
/// the hull of the root and the returned points, so it is above every plane through the root that `points_m` are above.
pub fn drawn_out_m(points_m: &[[f32; 3]; LINKS], length_m: f32, segments: u32) -> [[f32; 3]; LINKS] {
    let mut strip = strip_m(points_m, 1.0, segments);
    let lack = 1.0 - strip[0] / length_m;
    let most = 1.0 + LARGEST_BULGE * (1.0 - (lack - RIGHT_ANGLE_LACK).abs() / LACK_RANGE);
    let mut bulge = 1.0;
    if segments > 1 && most > 1.0 {
        for _ in 0..3 {
            let lack_m = (1.0 - SPARE) * length_m - strip[0];
            bulge = (bulge + lack_m / (strip[1].max(0.0) + LEAST_GROWTH * length_m)).clamp(1.0, most);
            strip = strip_m(points_m, bulge, segments);
        }
    }
    let factor = length_m / strip[0];
    let [low, middle, tip] = points_m;
    [low.map(|v| v * (bulge * factor)), middle.map(|v| v * (bulge * factor)), tip.map(|v| v * factor)]
}

/// Length of a strip (m) whose two lower control points are moved out by a factor, and its derivative by that.
fn strip_m([low, middle, tip]: &[[f32; 3]; LINKS], bulge: f32, segments: u32) -> [f32; 2] {
    let (mut below, mut sum) = ([[0.0; 3]; 2], [0.0; 2]);
    for segment in 1..=segments {
        let t = segment as f32 / segments as f32;
        let s = 1.0 - t;
        let lower: [f32; 3] = std::array::from_fn(|i| 3.0 * s * s * t * low[i] + 3.0 * s * t * t * middle[i]);
        let at: [f32; 3] = std::array::from_fn(|i| bulge * lower[i] + t * t * t * tip[i]);
        let [step, moved] = [[at, below[0]], [lower, below[1]]].map(|[to, from]| [to[0] - from[0], to[1] - from[1], to[2] - from[2]]);
        let step_m = (step[0] * step[0] + step[1] * step[1] + step[2] * step[2]).sqrt();
        sum[0] += step_m;
        sum[1] += (step[0] * moved[0] + step[1] * moved[1] + step[2] * moved[2]) / step_m.max(1e-9);
        below = [at, lower];
    }
    sum
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
