// Blades: cubic Bezier backbones, widened to strips. One instance is 64 blades as one indexed list.

@group(1) @binding(3) var shapes: texture_2d<f32>;
// Keys and places of blades far to near.
@group(1) @binding(4) var<storage, read> in_order: array<vec2<u32>>;

// Whether blades have the shapes of a texture; else they taper. Known as the pipeline is made, since software drivers run what a branch leaves out.
override is_textured: bool = false;
// Whether blades fade into what stands for far plants. Where none does, no fragment is discarded for it, so that devices test depth before they shade.
override fades: bool = true;
// Whether blades taper and have no soft borders: then the tip is one vertex, since both would be in the same place.
override are_pointed: bool = false;

// Shapes in the texture.
const SHAPES: f32 = 5.0;

struct Strip {
    @builtin(position) position: vec4<f32>,
    @location(0) color: vec3<f32>,
    @location(1) @interpolate(linear) across: f32,
    // Place in the texture of shapes, from the tip down.
    @location(2) shape: vec2<f32>,
    // Share that is shown where blades give way to what stands for far plants.
    @location(3) shown: f32,
    // Across the strip from its middle, and its half width (px).
    @location(4) @interpolate(linear) border: vec2<f32>,
    @location(5) distance_m: f32,
}

// Nearest that borders are widened (m).
const BORDER_FROM_M: f32 = 0.05;
// Opacity below which nothing is drawn.
const LEAST: f32 = 0.08;

// What is shown of a strip's side: nearly half of it turns to the eye, since a strip that is seen edge on would vanish between pixels, and
// fewer blades close the sward so. For the picture alone; the backbone does not know of it.
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

// A place on the picture (px from its middle).
fn pixel_of(clip: vec4<f32>) -> vec2<f32> {
    return clip.xy / clip.w * frame.screen.xy * 0.5;
}

// A corner of a strip; one with soft borders is half a pixel wider on either side.
fn strip_of(blade: Blade, corner: vec2<f32>, has_soft_borders: bool) -> Strip {
    var out: Strip;
    let t = corner.x;
    let across = corner.y;

    let points = array<vec3<f32>, 3>(blade.points[0].xyz, blade.points[1].xyz, blade.points[2].xyz);
    let tip = points[2];
    let lean = tip.xz;
    let offset = backbone_at(points, t);
    let tangent = tangent_at(points, t);
    let centre = blade.root.xyz + offset;
    let view = normalize(centre - frame.eye.xyz);
    let wide = shown_side(side_at(tip, blade.points[0].w, t), tangent, view);
    let slope = blade.place.zw;
    let up = vec3<f32>(slope.x, sqrt(max(1.0 - dot(slope, slope), 0.0)), slope.y);
    // The backbone is above the ground, a wide strip's border need not be.
    var from_root = offset + wide * (across * width_share(t, is_textured) * blade.root.w * 0.5);
    from_root += up * max(-dot(from_root, up), 0.0);
    let p = blade.root.xyz + from_root;

    var normal = cross(wide, tangent);
    normal *= -sign(dot(normal, view) + 1e-5) / max(length(normal), 1e-3);
    let soft = normalize(normal * 0.62 + up * 0.75 + wide * (across * 0.35));

    let kind = kinds.list[u32(blade.points[1].w)];
    let tilt = asin(min(length(lean) / max(length(tip), 1e-3), 1.0));
    let height = offset.y / kind.root.w;
    let own = blade_color(
        kind, tint_of(blade.place.xy), t, height, fract(blade.points[1].w), tilt, soft, tangent, view, p, blade.points[2].w,
    );
    let color = among(own, blade.about, t, distance(blade.root.xyz, frame.eye.xyz));
    out.color = color * blade.air.a + blade.air.rgb;
    out.across = across;
    let shape = floor(fract(blade.points[1].w * 61.0) * SHAPES);
    out.shape = vec2<f32>((shape + 0.5 + 0.48 * across) / SHAPES, 1.0 - t);
    out.position = frame.projection_from_world * vec4<f32>(p, 1.0);
    out.distance_m = distance(p, frame.eye.xyz);
    out.shown = select(1.0, 1.0 - smoothstep(frame.reach.x, frame.reach.y, distance(blade.root.xyz, frame.eye.xyz)), fades);
    // What is so near has no border to speak of.
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
        out.position = vec4<f32>(widened / (frame.screen.xy * 0.5) * out.position.w, out.position.zw);
    }
    return out;
}

// Vertices of a blade of the list.
fn vertices() -> u32 {
    return list.range.z * 2u + select(2u, 1u, are_pointed);
}

fn corner_at(index: u32) -> vec2<f32> {
    return corner_of(index % vertices(), list.range.z);
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

// The list's number is that of its span.
@vertex
fn vs_in_order(@builtin(vertex_index) index: u32, @builtin(instance_index) instance: u32) -> Strip {
    let number = number_of(index, instance, vertices());
    if number >= drawn[list.range.w + 1u] {
        return hidden();
    }
    let place = in_order[drawn[list.range.w] + number].y;
    var corner = corner_at(index);
    // A blade of one segment has only its first and last row.
    if place >= drawn[5] {
        corner.x = floor(corner.x + 0.5);
    }
    return strip_of(blades[place], corner, true);
}

struct Painted {
    color: vec3<f32>,
    opacity: f32,
}

// Light of a tapered blade across: a fold along the middle, one half lighter than the other, the rib darker.
fn fold(unclipped: f32) -> f32 {
    // Not the number that it should be on strips that reach behind the eye.
    let across = clamp(unclipped, -1.0, 1.0);
    return 1.0 + 0.10 * across - 0.16 * (1.0 - smoothstep(0.0, 0.35, abs(across)));
}

// Light of a textured one: where it ends, the texture is dark.
fn grain(texel: vec4<f32>) -> f32 {
    return 0.3 + 0.85 * texel.r / max(texel.a, 0.05);
}

@fragment
fn fs(strip: Strip) -> @location(0) vec4<f32> {
    // What stands for far plants is dithered by the same number.
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
    if paint.opacity < LEAST {
        discard;
    }
    return vec4<f32>(paint.color, paint.opacity);
}

@fragment
fn fs_weighted(strip: Strip) -> Weighted {
    let paint = painted(strip);
    return weighted(paint.color, paint.opacity, strip.distance_m, 1.0 - strip.shape.y);
}
