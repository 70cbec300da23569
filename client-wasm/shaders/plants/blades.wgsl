// Blades as strips along cubic Bezier backbones. One instance is 64 blades as one indexed list.

import package::constants::BLADE_SHAPES;
import package::inputs::frame::{clamped, frame};
import package::inputs::grass_kinds::kinds;
import package::inputs::random::dither_at;
import package::inputs::sward_shade::shade_at;
import package::land_and_sky::grass_color::tint_of;
import package::land_and_sky::grass_light::sun_in_grass;
import package::land_and_sky::sward::{among, blade_color, straw_of};
import package::plants::backbone::{backbone_at, corner_of, covered, side_at, tangent_at, width_at, width_fraction};
import package::plants::drawn_blade::Blade;
import package::plants::opacity::LEAST_OPACITY;
import package::plants::spans::Spans;
import package::plants::strip_list::{blades, is_listed, list, listed, number_of};
import package::plants::weighted::{Weighted, weighted};

// Spans of the blades in order, in place of the lengths of the lists.
@group(1) @binding(1) var<storage, read> spans: Spans;
@group(1) @binding(3) var shapes: texture_2d<f32>;
// Keys and indices of blades far to near.
@group(1) @binding(4) var<storage, read> in_order: array<vec2<u32>>;

// Whether blades have shapes from a texture; otherwise they taper. Fixed at pipeline creation, since software drivers execute both sides
// of a branch.
override is_textured: bool = false;
// Whether blades fade into clumps or shells. If not, no fragment is discarded for it, so that devices can test depth before shading.
override fades: bool = true;
// Whether blades taper without soft borders: then the tip is a single vertex.
override are_pointed: bool = false;

struct Strip {
    @builtin(position) position: vec4<f32>,
    @location(0) color: vec3<f32>,
    @location(1) @interpolate(linear) across: f32,
    // Place in the texture of shapes, from the tip down.
    @location(2) shape: vec2<f32>,
    // Opacity where blades give way to clumps or shells.
    @location(3) shown: f32,
    // Across the strip from its middle, and its half width (px).
    @location(4) @interpolate(linear) border: vec2<f32>,
    @location(5) distance_m: f32,
}

// Minimum distance at which borders are widened (m).
const BORDER_FROM_M: f32 = 0.05;

// Drawn side of a strip, turned nearly half way to the eye: edge-on it would vanish between pixels, and this way fewer blades close the
// sward. The backbone stays as it is.
fn shown_side(side: vec3<f32>, tangent: vec3<f32>, view: vec3<f32>) -> vec3<f32> {
    let facing = cross(tangent, view);
    let toward = facing * sign(dot(facing, side) + 1e-5);
    return normalize(side * 0.55 + toward / max(length(toward), 1e-3) * 0.45);
}

fn hidden() -> Strip {
    var out: Strip;
    out.position = vec4<f32>(0.0, 0.0, 0.0, 1.0);
    return out;
}

// Position on screen (px from the centre).
fn pixel_of(clip: vec4<f32>) -> vec2<f32> {
    return clip.xy / clip.w * frame.screen_px * 0.5;
}

// Corner of a strip; with soft borders it is half a pixel wider on either side.
fn strip_of(blade: Blade, corner: vec2<f32>, has_soft_borders: bool) -> Strip {
    var out: Strip;
    let t = corner.x;
    let across = corner.y;

    let points = array<vec3<f32>, 3>(blade.low_m, blade.middle_m, blade.tip_m);
    let tip = blade.tip_m;
    let lean = tip.xz;
    let offset = backbone_at(points, t);
    let tangent = tangent_at(points, t);
    let centre = blade.root_m + offset;
    let to = centre - frame.eye_m;
    let distance_m = length(to);
    let view = to / distance_m;
    let wide = shown_side(side_at(tip, blade.side_rad, t), tangent, view);
    let slope = blade.slope;
    let up = vec3<f32>(slope.x, sqrt(max(1.0 - dot(slope, slope), 0.0)), slope.y);
    // The backbone is above the ground; the border of a wide strip need not be.
    var from_root = offset + wide * (across * 0.5 * width_at(width_fraction(t, is_textured) * blade.width, distance_m));
    from_root += up * max(-dot(from_root, up), 0.0);
    let p = blade.root_m + from_root;

    var normal = cross(wide, tangent);
    normal *= -sign(dot(normal, view) + 1e-5) / max(length(normal), 1e-3);
    let soft = normalize(normal * 0.62 + up * 0.75 + wide * (across * 0.35));

    let kind = kinds.list[u32(blade.kind_and_hue)];
    let tilt = asin(min(length(lean) / max(length(tip), 1e-3), 1.0));
    let height = offset.y / kind.height_m;
    let hue = fract(blade.kind_and_hue);
    let shade = shade_at(p.xz);
    let lit = blade.sunlight * sun_in_grass(max(height, t * 0.7), kind, shade, offset.y / shade.height_m);
    let own = blade_color(kind, tint_of(blade.drift), t, height, hue, straw_of(hue), tilt, soft, tangent, view, p, lit);
    let color = among(own, blade.about, t, distance(blade.root_m, frame.eye_m));
    out.color = color * blade.air.a + blade.air.rgb;
    out.across = across;
    let shape = floor(fract(blade.kind_and_hue * 61.0) * f32(BLADE_SHAPES));
    out.shape = vec2<f32>((shape + 0.5 + 0.48 * across) / f32(BLADE_SHAPES), 1.0 - t);
    out.position = frame.projection_from_world * vec4<f32>(p, 1.0);
    out.distance_m = distance(p, frame.eye_m);
    out.shown = select(1.0, 1.0 - smoothstep(frame.blades_fade_from_m, frame.blades_end_m, distance(blade.root_m, frame.eye_m)), fades);
    // Very near strips need no soft border.
    out.border = vec2<f32>(across, 1.0) * 100.0;
    let middle = frame.projection_from_world * vec4<f32>(centre, 1.0);
    let ahead = frame.projection_from_world * vec4<f32>(centre + tangent * 0.01, 1.0);
    if has_soft_borders && min(min(middle.w, ahead.w), out.position.w) > BORDER_FROM_M {
        let at = pixel_of(out.position);
        let along = pixel_of(ahead) - pixel_of(middle);
        let sideways = vec2<f32>(-along.y, along.x) / max(length(along), 1e-6);
        let aside = dot(at - pixel_of(middle), sideways);
        let half_px = abs(aside);
        out.border = vec2<f32>(across * (half_px + 0.5), half_px);
        let widened = at + sideways * (0.5 * select(-1.0, 1.0, aside >= 0.0));
        out.position = vec4<f32>(widened / (frame.screen_px * 0.5) * out.position.w, out.position.zw);
    }
    return out;
}

// Number of vertices per blade of the list.
fn vertices() -> u32 {
    return list.segments * 2u + select(2u, 1u, are_pointed);
}

fn corner_at(index: u32) -> vec2<f32> {
    return corner_of(index % vertices(), list.segments);
}

fn listed_strip(index: u32, instance: u32, has_soft_borders: bool) -> Strip {
    let number = number_of(index, instance, vertices());
    if !is_listed(number) {
        return hidden();
    }
    return strip_of(listed(number), corner_at(index), has_soft_borders);
}

@vertex
fn vs(@builtin(vertex_index) index: u32, @builtin(instance_index) instance: u32) -> Strip {
    return listed_strip(index, instance, false);
}

@vertex
fn vs_soft(@builtin(vertex_index) index: u32, @builtin(instance_index) instance: u32) -> Strip {
    return listed_strip(index, instance, true);
}

@vertex
fn vs_in_order(@builtin(vertex_index) index: u32, @builtin(instance_index) instance: u32) -> Strip {
    let number = number_of(index, instance, vertices());
    let span = spans.parts[list.number];
    if number >= span.count {
        return hidden();
    }
    let place = in_order[span.first + number].y;
    var corner = corner_at(index);
    // A blade of one segment has only its first and last row.
    if place >= spans.first_single {
        corner.x = floor(corner.x + 0.5);
    }
    return strip_of(blades[place], corner, true);
}

struct Painted {
    color: vec3<f32>,
    opacity: f32,
}

// Shading across a tapered blade: a fold along the middle, one half lighter than the other, the rib darker.
fn fold(unclipped: f32) -> f32 {
    // `across` is extrapolated on strips that reach behind the eye.
    let across = clamp(unclipped, -1.0, 1.0);
    return 1.0 + 0.10 * across - 0.16 * (1.0 - smoothstep(0.0, 0.35, abs(across)));
}

// Shading of a textured blade: the texture is dark where it ends.
fn grain(texel: vec4<f32>) -> f32 {
    return 0.3 + 0.85 * texel.r / max(texel.a, 0.05);
}

@fragment
fn fs(strip: Strip) -> @location(0) vec4<f32> {
    // Clumps and shells are dithered by the same threshold.
    if fades && strip.shown < 1.0 && strip.shown <= 1.0 - dither_at(strip.position.xy) {
        discard;
    }
    if is_textured {
        let texel = textureSampleLevel(shapes, clamped, strip.shape, 0.0);
        if texel.a < 0.5 {
            discard;
        }
        return vec4<f32>(strip.color * grain(texel), 1.0);
    }
    return vec4<f32>(strip.color * fold(strip.across), 1.0);
}

fn painted(strip: Strip) -> Painted {
    let texel = textureSample(shapes, clamped, strip.shape);
    let light = select(fold(strip.across), grain(texel), is_textured);
    return Painted(strip.color * light, covered(strip.border) * strip.shown * select(1.0, texel.a, is_textured));
}

@fragment
fn fs_soft(strip: Strip) -> @location(0) vec4<f32> {
    let paint = painted(strip);
    if paint.opacity < LEAST_OPACITY {
        discard;
    }
    return vec4<f32>(paint.color, paint.opacity);
}

@fragment
fn fs_weighted(strip: Strip) -> Weighted {
    let paint = painted(strip);
    return weighted(paint.color, paint.opacity, strip.distance_m, 1.0 - strip.shape.y);
}
