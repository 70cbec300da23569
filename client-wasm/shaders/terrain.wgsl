// Ground: tiles of a quadtree, whose odd vertices slide onto the next coarser grid before that takes over.

const TILE_CELLS: u32 = 16u;

struct Tile {
    // North-west corner (m), side (m), distance at which the next coarser grid takes over (m).
    place: vec4<f32>,
}

@group(1) @binding(0) var<storage, read> tiles: array<Tile>;

struct Ground {
    @builtin(position) position: vec4<f32>,
    @location(0) p: vec3<f32>,
}

@vertex
fn vs(@builtin(vertex_index) index: u32, @builtin(instance_index) instance: u32) -> Ground {
    let place = tiles[instance].place;
    let row = TILE_CELLS + 1u;
    let cell = vec2<f32>(f32(index % row), f32(index / row));
    let spacing = place.z / f32(TILE_CELLS);
    let flat_p = place.xy + cell * spacing;
    let distance_m = length(vec3<f32>(flat_p.x, ground_height(flat_p), flat_p.y) - frame.eye.xyz);
    let morph = smoothstep(0.70, 0.95, distance_m / place.w);
    let odd = cell - 2.0 * floor(cell * 0.5);
    let p = flat_p - odd * spacing * morph;
    var out: Ground;
    out.p = vec3<f32>(p.x, ground_height(p), p.y);
    out.position = frame.projection_from_world * vec4<f32>(out.p, 1.0);
    return out;
}

@fragment
fn fs(ground: Ground) -> @location(0) vec4<f32> {
    let p = ground.p.xz;
    let to = ground.p - frame.eye.xyz;
    let distance_m = length(to);
    let view = to / distance_m;
    let normal = ground_normal(p);
    let share = grass_share(p);
    let sun_light = cloud_light(p) * sun_visible(ground.p + normal * 0.05);

    // Under the plants: soil and litter, dark between the blades near by.
    let grain = noise(p / 1.3);
    let coarse = noise(p / 5.1);
    let soil = mix(vec3<f32>(0.060, 0.042, 0.026), vec3<f32>(0.155, 0.118, 0.075), grain.r * 0.6 + coarse.g * 0.5);
    let litter = mix(soil, vec3<f32>(0.16, 0.15, 0.055), smoothstep(0.45, 0.75, grain.a) * 0.55);
    let bare = litter * (frame.sun_color.rgb * sun_light * max(dot(normal, frame.sun.xyz), 0.0) + ambient(normal) + lamps_on(ground.p, normal, 0.0));

    // The grass as seen from afar: the colour of its upper half, leaning as the blades do.
    let near = 1.0 - smoothstep(frame.reach.x * 0.5, frame.reach.y * 1.6, distance_m);
    let kind = kinds_blended(p);
    let lean = lean_at(ground.p, field_level(distance_m), gust_at(p), kind.tip.w);
    let tilt = length(lean);
    let tint = grass_tint(p);
    let mottle = 0.80 + 0.5 * (noise(p / 2.9).g * 0.6 + noise(p / 0.83).r * 0.4);
    let depth = mix(0.50, 0.82, smoothstep(0.02, 0.45, abs(view.y)) * -0.25 + 0.75);
    var albedo = mix(kind.root.rgb, kind.tip.rgb, depth) * tint * mix(mottle, 1.0, smoothstep(60.0, 400.0, distance_m));
    let blade_normal = normalize(normal + vec3<f32>(lean.x, 0.0, lean.y) * 0.9 - view * 0.35);
    let tangent = normalize(normal + vec3<f32>(lean.x, 0.0, lean.y) * 1.4);
    albedo *= (0.90 + 0.42 * smoothstep(0.05, 0.45, tilt)) * trodden(tilt);
    var grass = grass_light(albedo, blade_normal, tangent, view, sun_light, 0.80) + grass_lamps(albedo, blade_normal, tangent, view, ground.p, 0.7);
    let flowers = smoothstep(0.72, 0.80, noise(p / 3.7 + 0.31).b) * min(frame.blade.x * 0.25, 0.35);
    grass = mix(grass, vec3<f32>(0.45, 0.43, 0.33) * (frame.sun_color.rgb * (0.4 * sun_light) + ambient(normal)), flowers * smoothstep(20.0, 60.0, distance_m) * 0.5);
    let down = smoothstep(0.10, 0.50, -view.y);
    let under = mix(kind.root.rgb * 0.9, soil * 0.35, 0.35)
        * (frame.sun_color.rgb * sun_light * sun_in_grass(0.0, kind.root.w) + ambient(normal) * 0.55 + lamps_on(ground.p, normal, 0.0) * 0.35);
    // Short grass hides little of the ground's light.
    let deep = smoothstep(-0.25, 0.60, kind.root.w);
    grass = mix(grass, under, near * deep * mix(0.9, mix(0.45, 0.9, 1.0 - smoothstep(frame.reach.y, frame.reach.y * 2.0, distance_m)), down));
    let color = mix(bare, grass, share);
    return vec4<f32>(hazed(color, ground.p), 1.0);
}
