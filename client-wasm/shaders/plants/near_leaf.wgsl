// Underbrush close up: ribbons as smooth curves through their rows, with the veins of leaves and petals (Endo et al. 2003, section 7).

import package::constants::{BLOCK_ROWS, CURVE_PARTS, FIRST_ROW, LAST_ROW, PARALLEL, PINNATE, STREAKED, TANGENT_DEPARTURE, TAU};
import package::inputs::frame::frame;
import package::plants::leaf_fold::{fold, FOLD_MEAN};
import package::plants::ribbons::{borders, counted, drawn, shown};
import package::plants::visible_plant::lists;

// Harmonics of the profile of a vein.
const HARMONICS: u32 = 8u;
// Standard deviation of this profile, a Gaussian (distances between veins).
const VEIN_DEVIATION: f32 = 0.05;
// Brightness of midrib and veins relative to that of the leaf, and of the bulges between veins where the sun grazes them.
const MIDRIB_RGB: vec3<f32> = vec3<f32>(0.62, 0.5, 0.3);
const VEIN_RGB: vec3<f32> = vec3<f32>(0.36, 0.29, 0.14);
const BULGE: f32 = 0.18;
// Brightness of the spots of a leaf, and of the streaks of a petal.
const SPOT_RGB: vec3<f32> = vec3<f32>(0.07, 0.05, 0.08);
const STREAK: f32 = 0.16;

// Point on the axis of a ribbon, and from there to its right border (m).
struct Point {
    at: vec3<f32>,
    half: vec3<f32>,
}

struct CloseRibbon {
    @builtin(position) position: vec4<f32>,
    @location(0) color: vec3<f32>,
    // Coordinate across and 1, both times a weight: their ratio is straight on a ribbon that tapers.
    @location(1) across: vec2<f32>,
    // Fraction of its length.
    @location(2) along: f32,
    // Cosines of the angles of the sun from the axis, and from the right.
    @location(3) toward_sun: vec2<f32>,
    // As in `Border`.
    @location(4) @interpolate(flat) close: u32,
}

// Twin of `departures` in shared/src/plant/underbrush/spline.rs for one of the ends of a section. `departure` bounds it relative to the section.
fn departed(other: vec3<f32>, section: vec3<f32>, departure: f32) -> vec3<f32> {
    let off = 0.5 * (other - section);
    return off * min(1.0, departure * length(section) / max(length(off), 1e-12));
}

// Twin of `point` in shared/src/plant/underbrush/spline.rs; `ends` are those of `FIRST_ROW` and `LAST_ROW` that the section is at.
fn on_curve(before: vec3<f32>, section: vec3<f32>, after: vec3<f32>, ends: u32, fraction: f32, curving: f32, departure: f32) -> vec3<f32> {
    let is_first = (ends & FIRST_ROW) != 0u;
    let is_last = (ends & LAST_ROW) != 0u;
    let below = select(before, select(2.0 * section - after, section, is_last), is_first);
    let above = select(after, select(2.0 * section - before, section, is_first), is_last);
    let rest = 1.0 - fraction;
    let curve = departed(below, section, departure) * rest - departed(above, section, departure) * fraction;
    return section * fraction + curve * (curving * fraction * rest);
}

// Row `row` of the plant whose borders start at `first`.
fn point_of(first: u32, row: u32) -> Point {
    let left = borders[first + 2u * row].position_m;
    let right = borders[first + 2u * row + 1u].position_m;
    return Point(0.5 * (left + right), 0.5 * (right - left));
}

@vertex
fn vs_close(@builtin(vertex_index) index: u32, @builtin(instance_index) instance: u32) -> CloseRibbon {
    let list = lists.list[drawn.number];
    let vertices = 2u * CURVE_PARTS * list.rows;
    let number = instance * list.instance_plants + index / vertices;
    var out: CloseRibbon;
    if number >= counted[drawn.number] {
        out.position = vec4<f32>(0.0, 0.0, 0.0, 1.0);
        return out;
    }
    let first = 2u * BLOCK_ROWS * shown[list.first_listed + number];
    // The section above a row; that of the tip is the one below it.
    let row = index % vertices / (2u * CURVE_PARTS);
    let part = index / 2u % CURVE_PARTS;
    let is_tip = (borders[first + 2u * row].close & LAST_ROW) != 0u;
    let low = row - select(0u, 1u, is_tip);
    let fraction = select(f32(part) / f32(CURVE_PARTS), 1.0, is_tip);
    let right = index % 2u;
    let lower = borders[first + 2u * low + right];
    let upper = borders[first + 2u * low + 2u + right];
    let ends = (lower.close & FIRST_ROW) | (upper.close & LAST_ROW);
    let curving = f32((lower.close >> 8u) & 255u) / 255.0;

    let start = point_of(first, low);
    let end = point_of(first, low + 1u);
    let before = point_of(first, low - select(1u, 0u, (ends & FIRST_ROW) != 0u));
    let after = point_of(first, low + select(2u, 1u, (ends & LAST_ROW) != 0u));
    let section = end.at - start.at;
    let at = start.at + on_curve(start.at - before.at, section, after.at - end.at, ends, fraction, curving, TANGENT_DEPARTURE);
    let widening = end.half - start.half;
    let half = start.half + on_curve(start.half - before.half, widening, after.half - end.half, ends, fraction, curving, 1e9);
    let across = f32(right) * 2.0 - 1.0;
    let weight = mix(1.0, 100.0 * length(half), curving);
    out.position = frame.projection_from_world * vec4<f32>(at + half * across, 1.0);
    out.color = mix(lower.color, upper.color, fraction);
    out.across = vec2<f32>(across * weight, weight);
    out.along = mix(unpack2x16unorm(lower.close).y, unpack2x16unorm(upper.close).y, fraction);
    let axis = section / max(length(section), 1e-9);
    out.toward_sun = vec2<f32>(dot(frame.toward_sun, axis), dot(frame.toward_sun, half / max(length(half), 1e-9)));
    out.close = lower.close & 0xffffu;
    return out;
}

// Fraction of a wave of that many periods per pixel that is drawn: none from two pixels a period on.
fn shows(periods_per_px: f32) -> f32 {
    return 1.0 - smoothstep(0.2, 0.5, periods_per_px);
}

// Profile of veins at whole numbers, about 1 there and of zero mean: the Fourier series of a Gaussian, without the harmonics that pixels
// of `per_px` periods do not resolve.
fn vein_profile(phase: f32, per_px: f32) -> f32 {
    let deviation = TAU * VEIN_DEVIATION;
    let fall = exp(-0.5 * deviation * deviation);
    let cosine = cos(TAU * phase);
    var sum = 0.0;
    var waves = vec2<f32>(1.0, cosine);
    // fall^(k²) from one k to the next.
    var size = fall;
    var factor = fall * fall * fall;
    for (var k = 1u; k <= HARMONICS; k++) {
        sum += size * shows(f32(k) * per_px) * waves.y;
        waves = vec2<f32>(waves.y, 2.0 * cosine * waves.y - waves.x);
        size *= factor;
        factor *= fall * fall;
    }
    return 2.0 * sqrt(TAU) * VEIN_DEVIATION * sum;
}

// Factor on the colour of a point of a ribbon, with the mean of `fold` at every fraction of its length. `pixel` are the changes of `across`
// (-1 to 1) and `along` (0 to 1) from pixel to pixel.
fn veined(close: u32, across: f32, along: f32, pixel: vec2<f32>, toward_sun: vec2<f32>) -> vec3<f32> {
    let kind = (close >> 2u) & 3u;
    let count = f32((close >> 4u) & 15u);
    let aside = abs(across);
    let is_pinnate = kind == PINNATE;
    // Side veins rise by one distance from the midrib to the border, so that as much of each cross-section is vein.
    let phase = select(count * aside, count * along - aside, is_pinnate);
    let per_px = select(count * pixel.x, count * pixel.y + pixel.x, is_pinnate);
    let vein = vein_profile(phase, per_px);
    if kind == STREAKED {
        return vec3<f32>(1.0 - STREAK * vein);
    }
    let outward = select(-1.0, 1.0, across > 0.0);
    let rises = select(toward_sun.y * outward, toward_sun.x, is_pinnate);
    let bulge = BULGE * rises * sin(TAU * phase) * shows(per_px);
    let midrib = vein_profile(0.5 * across, 0.5 * pixel.x);
    let spots = cos(TAU * across) * sin(TAU * 2.0 * along + 1.3) * shows(pixel.x + 2.0 * pixel.y);
    let strength = select(0.6, 1.0, is_pinnate);
    return vec3<f32>(FOLD_MEAN + 0.1 * across) + MIDRIB_RGB * midrib + (VEIN_RGB * vein + bulge) * strength + SPOT_RGB * spots;
}

@fragment
fn fs_close(ribbon: CloseRibbon) -> @location(0) vec4<f32> {
    let across = clamp(ribbon.across.x / max(ribbon.across.y, 1e-6), -1.0, 1.0);
    let pixel = fwidth(vec2<f32>(across, ribbon.along));
    let kind = (ribbon.close >> 2u) & 3u;
    let near = f32((ribbon.close >> 8u) & 255u) / 255.0;
    let plain = select(1.0, fold(across), kind == PINNATE || kind == PARALLEL);
    var factor = vec3<f32>(plain);
    if kind != 0u && near > 0.0 {
        factor = mix(factor, veined(ribbon.close, across, ribbon.along, pixel, ribbon.toward_sun), near);
    }
    return vec4<f32>(ribbon.color * max(factor, vec3<f32>(0.0)), 1.0);
}
