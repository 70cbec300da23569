// Backbone of a blade: the Bezier curve of its control points, and its outline. Twin of shared/src/plant/blade/backbone.rs.

import package::constants::{LACK_RANGE, LARGEST_BULGE, LEAST_GROWTH, RIGHT_ANGLE_LACK, SPARE, TAU};

// Greatest angular width of a blade (rad).
const WIDEST_RAD: f32 = 0.12;
// Width of a textured strip relative to the root width of a tapered one.
const WIDER: f32 = 2.6;

// Point of the backbone at a fraction `t` of the blade (m from the root): the cubic Bezier curve of Zhang, Eq. (5).
fn backbone_at(points: array<vec3<f32>, 3>, t: f32) -> vec3<f32> {
    let s = 1.0 - t;
    return 3.0 * s * s * t * points[0] + 3.0 * s * t * t * points[1] + t * t * t * points[2];
}

// Unit tangent of the backbone, upwards.
fn tangent_at(points: array<vec3<f32>, 3>, t: f32) -> vec3<f32> {
    let s = 1.0 - t;
    let along = s * s * points[0] + 2.0 * s * t * (points[1] - points[0]) + t * t * (points[2] - points[1]);
    return along / max(length(along), 1e-9);
}

// Length of a strip whose two lower control points are moved away from the root by a factor (m), and its derivative by that.
fn strip_of(points: array<vec3<f32>, 3>, bulge: f32, segments: u32) -> vec2<f32> {
    var below = vec3<f32>(0.0);
    var below_lower = vec3<f32>(0.0);
    var strip = vec2<f32>(0.0);
    for (var segment = 1u; segment <= segments; segment++) {
        let t = f32(segment) / f32(segments);
        let s = 1.0 - t;
        let lower = 3.0 * s * s * t * points[0] + 3.0 * s * t * t * points[1];
        let at = bulge * lower + t * t * t * points[2];
        let step_m = distance(at, below);
        strip += vec2<f32>(step_m, dot(at - below, lower - below_lower) / max(step_m, 1e-9));
        below = at;
        below_lower = lower;
    }
    return strip;
}

// Control points moved away from the root so that a strip of `segments` segments is as long as the blade: by one factor, and for a sharp bend the
// two lower ones farther, so that the tip hardly moves.
fn drawn_out(points: array<vec3<f32>, 3>, length_m: f32, segments: u32) -> array<vec3<f32>, 3> {
    var strip = strip_of(points, 1.0, segments);
    let lack = 1.0 - strip.x / length_m;
    let most = 1.0 + LARGEST_BULGE * (1.0 - abs(lack - RIGHT_ANGLE_LACK) / LACK_RANGE);
    var bulge = 1.0;
    if segments > 1u && most > 1.0 {
        for (var i = 0; i < 3; i++) {
            let lack_m = (1.0 - SPARE) * length_m - strip.x;
            bulge = clamp(bulge + lack_m / (max(strip.y, 0.0) + LEAST_GROWTH * length_m), 1.0, most);
            strip = strip_of(points, bulge, segments);
        }
    }
    let factor = length_m / strip.x;
    let lower = bulge * factor;
    return array<vec3<f32>, 3>(points[0] * lower, points[1] * lower, points[2] * factor);
}

// Side vector of the strip at a fraction of the blade: it turns evenly, through the smaller angle, from its own side at the root to the
// direction across the lean at the tip (Zhang, Fig. 8).
fn side_at(tip: vec3<f32>, own: f32, t: f32) -> vec3<f32> {
    let is_upright = tip.x == 0.0 && tip.z == 0.0;
    let across = select(atan2(tip.x, select(-tip.z, 1.0, is_upright)), own, is_upright);
    let turn = (fract((across - own) / (0.5 * TAU) + 0.5) - 0.5) * (0.5 * TAU);
    let angle = own + turn * t;
    return vec3<f32>(cos(angle), 0.0, sin(angle));
}

// Fraction along the blade, and -1 or 1 across it, of a vertex of a strip: two vertices per row from root to tip, but only the first in the
// last row of a pointed strip.
fn corner_of(vertex: u32, segments: u32) -> vec2<f32> {
    return vec2<f32>(f32(vertex / 2u) / f32(segments), f32(vertex % 2u) * 2.0 - 1.0);
}

// Width at a fraction of the blade, relative to the root width of a tapered one, whose last row is one point (Zhang, Fig. 5a); textured ones
// are rectangles up to the tip (Fig. 5b).
fn width_fraction(t: f32, is_textured: bool) -> f32 {
    return select((1.0 - t * t) * (0.80 + 0.55 * t), WIDER, is_textured);
}

// Width (m) at a distance from the eye: blades at the eye get narrower, so that none fills the picture.
fn width_at(width_m: f32, distance_m: f32) -> f32 {
    return min(width_m, WIDEST_RAD * distance_m);
}

// Coverage of a pixel by a strip whose middle is `border.x` away and whose half width is `border.y` (px).
fn covered(border: vec2<f32>) -> f32 {
    return clamp(min(border.x + 0.5, border.y) - max(border.x - 0.5, -border.y), 0.0, 1.0);
}
