// Blades: cubic Bezier backbones, widened to tapered strips. One instance is 64 blades as one indexed list.

struct List {
    // First blade of the list, capacity, rows of two vertices below the tip, number of the list.
    range: vec4<u32>,
}

@group(1) @binding(0) var<storage, read> blades: array<Blade>;
@group(1) @binding(1) var<storage, read> drawn: array<u32>;
@group(1) @binding(2) var<uniform> list: List;
@group(1) @binding(3) var shapes: texture_2d<f32>;

// Shapes in the texture; how much wider a textured blade's strip is than a tapered one.
const SHAPES: f32 = 5.0;
const WIDER: f32 = 2.6;

struct Strip {
    @builtin(position) position: vec4<f32>,
    @location(0) color: vec3<f32>,
    @location(1) @interpolate(linear) across: f32,
    // Place in the texture of shapes; below zero for a tapered blade.
    @location(2) shape: vec2<f32>,
}

@vertex
fn vs(@builtin(vertex_index) index: u32, @builtin(instance_index) instance: u32) -> Strip {
    let rows = list.range.z;
    let vertices = rows * 2u + 1u;
    let number = instance * 64u + index / vertices;
    let local = index % vertices;
    var out: Strip;
    if number >= min(drawn[list.range.w], list.range.y) {
        out.position = vec4<f32>(0.0, 0.0, 0.0, 1.0);
        return out;
    }
    let blade = blades[list.range.x + number];
    let row = local / 2u;
    let t = f32(row) / f32(rows);
    let across = select(f32(local % 2u) * 2.0 - 1.0, 0.0, local == vertices - 1u);
    let is_textured = frame.blade.w > 0.5;

    let a = blade.points[0].xyz;
    let b = blade.points[1].xyz;
    let c = blade.points[2].xyz;
    // The curve passes through the simulated points a, b, c at one third, two thirds and the tip.
    let b1 = 3.0 * a - 1.5 * b + c / 3.0;
    let b2 = -1.5 * a + 3.0 * b - 5.0 / 6.0 * c;
    let s = 1.0 - t;
    let offset = 3.0 * s * s * t * b1 + 3.0 * s * t * t * b2 + t * t * t * c;
    let tangent = normalize(3.0 * s * s * b1 + 6.0 * s * t * (b2 - b1) + 3.0 * t * t * (c - b2) + vec3<f32>(0.0, 1e-4, 0.0));
    let centre = blade.root.xyz + offset;
    let view = normalize(centre - frame.eye.xyz);

    // The blade turns evenly from its own side at the root towards the direction in which it leans (000 section 3.2).
    let own = blade.points[0].w;
    let lean = c.xz;
    let lean_angle = atan2(lean.x, -lean.y);
    let turn = fract((lean_angle - own) / TAU + 0.5) - 0.5;
    let angle = own + turn * TAU * t * 0.5 * smoothstep(0.05, 0.35, length(lean) / max(length(c), 1e-3));
    let side = vec3<f32>(cos(angle), 0.0, sin(angle));
    let facing_side = cross(tangent, view);
    let toward = facing_side * sign(dot(facing_side, side) + 1e-5);
    let wide = normalize(side * 0.55 + toward / max(length(toward), 1e-3) * 0.45);
    let profile = select((1.0 - t * t) * (0.80 + 0.55 * t), WIDER, is_textured);
    let p = centre + wide * (across * profile * blade.root.w * 0.5);

    var normal = normalize(cross(wide, tangent));
    normal = normal * -sign(dot(normal, view) + 1e-5);
    let up = ground_normal(blade.root.xz);
    let soft = normalize(normal * 0.62 + up * 0.75 + wide * (across * 0.35));

    let kind = kinds.list[u32(blade.points[1].w)];
    let hue = fract(blade.points[1].w);
    let tint = grass_tint(blade.root.xz);
    var albedo = tint * plant_color(kind.root.rgb, kind.tip.rgb, t, hue);
    let straw = smoothstep(0.86, 0.99, hue) * 0.75;
    albedo = mix(albedo, vec3<f32>(0.38, 0.30, 0.13) * (0.35 + 0.65 * t), straw);
    // Pale ends, as of flowering grass.
    albedo = mix(albedo, albedo * vec3<f32>(1.35, 1.12, 0.95), smoothstep(0.72, 1.0, t) * smoothstep(0.3, 0.9, hue));
    let tilt = length(lean) / max(length(c), 1e-3);
    albedo *= (0.90 + 0.42 * smoothstep(0.15, 0.6, tilt) * t) * trodden(asin(min(tilt, 1.0)));
    let height = offset.y / kind.root.w;
    // Little light is lost on the way down into short grass.
    let deep = smoothstep(0.0, 0.60, kind.root.w);
    let occlusion = mix(mix(0.60, 0.16, deep), 1.0, smoothstep(0.0, 0.85, max(height, t * 0.75)));
    let light = blade.points[2].w * mix(mix(0.75, 0.30, deep), 1.0, smoothstep(0.05, 0.75, max(height, t * 0.7)));
    out.color = hazed(grass_light(albedo, soft, tangent, view, light, occlusion), p);
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
