// Blades: cubic Bezier backbones, widened to strips. One instance is 64 blades as one indexed list.

struct List {
    // First blade of the list, capacity, segments of a blade, number of the list.
    range: vec4<u32>,
}

@group(1) @binding(0) var<storage, read> blades: array<Blade>;
@group(1) @binding(1) var<storage, read> drawn: array<u32>;
@group(1) @binding(2) var<uniform> list: List;
@group(1) @binding(3) var shapes: texture_2d<f32>;

// Shapes in the texture.
const SHAPES: f32 = 5.0;

struct Strip {
    @builtin(position) position: vec4<f32>,
    @location(0) color: vec3<f32>,
    @location(1) @interpolate(linear) across: f32,
    // Place in the texture of shapes; below zero for a tapered blade.
    @location(2) shape: vec2<f32>,
}

// What is shown of a strip's side: nearly half of it turns to the eye, since a strip that is seen edge on would vanish between pixels, and
// fewer blades close the sward so. For the picture alone; the backbone does not know of it.
fn shown_side(side: vec3<f32>, tangent: vec3<f32>, view: vec3<f32>) -> vec3<f32> {
    let facing = cross(tangent, view);
    let toward = facing * sign(dot(facing, side) + 1e-5);
    return normalize(side * 0.55 + toward / max(length(toward), 1e-3) * 0.45);
}

@vertex
fn vs(@builtin(vertex_index) index: u32, @builtin(instance_index) instance: u32) -> Strip {
    let segments = list.range.z;
    let vertices = segments * 2u + 2u;
    let number = instance * 64u + index / vertices;
    var out: Strip;
    if number >= min(drawn[list.range.w], list.range.y) {
        out.position = vec4<f32>(0.0, 0.0, 0.0, 1.0);
        return out;
    }
    let blade = blades[list.range.x + number];
    let corner = corner_of(index % vertices, segments);
    let t = corner.x;
    let across = corner.y;
    let is_textured = frame.blade.w > 0.5;

    let points = array<vec3<f32>, 3>(blade.points[0].xyz, blade.points[1].xyz, blade.points[2].xyz);
    let tip = points[2];
    let lean = tip.xz;
    let offset = backbone_at(points, t);
    let tangent = tangent_at(points, t);
    let centre = blade.root.xyz + offset;
    let view = normalize(centre - frame.eye.xyz);
    let wide = shown_side(side_at(tip, blade.points[0].w, t), tangent, view);
    let up = ground_normal(blade.root.xz);
    // The backbone is above the ground, a wide strip's border need not be.
    var from_root = offset + wide * (across * width_share(t, is_textured) * blade.root.w * 0.5);
    from_root += up * max(-dot(from_root, up), 0.0);
    let p = blade.root.xyz + from_root;

    var normal = normalize(cross(wide, tangent));
    normal = normal * -sign(dot(normal, view) + 1e-5);
    let soft = normalize(normal * 0.62 + up * 0.75 + wide * (across * 0.35));

    let kind = kinds.list[u32(blade.points[1].w)];
    let hue = fract(blade.points[1].w);
    let tint = grass_tint(blade.root.xz);
    var albedo = tint * plant_color(kind.root.rgb, kind.tip.rgb, t, hue);
    let straw = smoothstep(0.86, 0.99, hue) * 0.75;
    albedo = mix(albedo, vec3<f32>(0.38, 0.30, 0.13) * (0.35 + 0.65 * t), straw);
    // Pale ends, as of flowering grass.
    albedo = mix(albedo, albedo * vec3<f32>(1.35, 1.12, 0.95), smoothstep(0.72, 1.0, t) * smoothstep(0.3, 0.9, hue));
    let tilt = length(lean) / max(length(tip), 1e-3);
    albedo *= (0.90 + 0.42 * smoothstep(0.15, 0.6, tilt) * t) * trodden(asin(min(tilt, 1.0)));
    let height = offset.y / kind.root.w;
    // Little light is lost on the way down into short grass.
    let deep = smoothstep(0.0, 0.60, kind.root.w);
    let occlusion = mix(mix(0.60, 0.16, deep), 1.0, smoothstep(0.0, 0.85, max(height, t * 0.75)));
    let light = blade.points[2].w * sun_in_grass(max(height, t * 0.7), kind.root.w);
    let lit = grass_light(albedo, soft, tangent, view, light, occlusion) + grass_lamps(albedo, soft, tangent, view, p, height);
    out.color = hazed(lit, p);
    out.across = across;
    let shape = floor(fract(blade.points[1].w * 61.0) * SHAPES);
    out.shape = select(vec2<f32>(-1.0), vec2<f32>((shape + 0.5 + 0.48 * across) / SHAPES, 1.0 - t), is_textured);
    out.position = frame.projection_from_world * vec4<f32>(p, 1.0);
    return out;
}

@fragment
fn fs(strip: Strip) -> @location(0) vec4<f32> {
    let texel = textureSample(shapes, clamped, strip.shape);
    if strip.shape.x >= 0.0 {
        if texel.a < 0.5 {
            discard;
        }
        return vec4<f32>(strip.color * (0.3 + 0.85 * texel.r), 1.0);
    }
    // A fold along the middle: one half lighter than the other, the rib darker.
    let fold = 1.0 + 0.10 * strip.across - 0.16 * (1.0 - smoothstep(0.0, 0.35, abs(strip.across)));
    return vec4<f32>(strip.color * fold, 1.0);
}
