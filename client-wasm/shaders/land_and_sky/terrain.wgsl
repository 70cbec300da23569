// Ground: tiles of a quadtree.

import package::constants::{BARE_PLACES, BARE_WEIGHTS, LEAF_TOP, LITTER_END_M};
import package::inputs::bend_atlas::{field_level, lean_of_field};
import package::inputs::frame::frame;
import package::inputs::grass_kinds::{kinds, kinds_blended};
import package::inputs::lamps::lamps_on;
import package::inputs::noise::{noise, noise_over};
import package::inputs::shadows::sun_visible;
import package::inputs::sward_shade::{above_horizon, shade_at, sun_over_grass};
import package::inputs::wind::{ground_wind_at, lean_of_wind};
import package::land_and_sky::clouds::cloud_light;
import package::land_and_sky::grass_color::grass_tint;
import package::land_and_sky::grass_light::{even_depth, sun_in_grass};
import package::land_and_sky::ground::{grass_fraction_over, ground_height, ground_normal, soft_fraction};
import package::land_and_sky::ground_tile::{GroundTile, kind_of_plain, tile_vertex};
import package::land_and_sky::haze::air_before;
import package::land_and_sky::sky_light::ambient;
import package::land_and_sky::snow::{depth_of_vertex, has_snow, hidden_by_grass, snow_difference, snow_light, snow_normal, sun_on_snow};
import package::land_and_sky::sward::{bare_between, sward_color};
import package::uniforms::Kind;

// Whether only grass of one kind grows, beyond the distance up to which litter is resolved. Software drivers execute both sides of a branch.
override is_plain: bool = false;

// Whether the streamed bend field may be other than 0.
override has_bend: bool = true;

@group(1) @binding(0) var<storage, read> tiles: array<GroundTile>;

struct Ground {
    @builtin(position) position: vec4<f32>,
    @location(0) p: vec3<f32>,
    // Slowly varying values: lean by the wind (rad), sunlight below the clouds; tint of the grass.
    @location(1) air: vec3<f32>,
    @location(2) tint: vec3<f32>,
    // Light and transmittance of the air before the ground. Near the eye it is interpolated over cells of up to 16 m, which only mist much thinner than that shows.
    @location(3) haze: vec4<f32>,
    // Kind of grass of plain land.
    @location(4) @interpolate(flat) kind: u32,
}

@vertex
fn vs(@builtin(vertex_index) index: u32, @builtin(instance_index) instance: u32) -> Ground {
    let tile = tiles[instance];
    let p = tile_vertex(tile, index).p;
    var out: Ground;
    out.p = vec3<f32>(p.x, ground_height(p) + depth_of_vertex(p), p.y);
    out.air = vec3<f32>(lean_of_wind(ground_wind_at(out.p), 1.0), cloud_light(p));
    out.tint = grass_tint(p);
    out.haze = air_before(out.p);
    out.kind = kind_of_plain(tile);
    out.position = frame.projection_from_world * vec4<f32>(out.p, 1.0);
    return out;
}

struct Soil {
    albedo: vec3<f32>,
    // Slope of its crumbs, X and Z.
    slope: vec2<f32>,
}

// Bare soil with crumbs, stones and dry litter, where a pixel spans `span_m`.
fn soil_at(p: vec2<f32>, span_m: f32) -> Soil {
    let coarse = noise(p / 5.1);
    let grain = noise_over(vec2<f32>(0.8 * p.x + 0.6 * p.y, 0.8 * p.y - 0.6 * p.x) / 1.3, span_m / 1.3);
    let crumbs = noise_over(p / 0.47, span_m / 0.47);
    let soil = mix(vec3<f32>(0.060, 0.042, 0.026), vec3<f32>(0.155, 0.118, 0.075), grain.r * 0.6 + coarse.g * 0.5);
    let strewn = mix(soil, vec3<f32>(0.16, 0.15, 0.055), smoothstep(0.45, 0.75, grain.a) * 0.55);
    let pebbles = smoothstep(0.70, 0.80, crumbs.g) * smoothstep(0.35, 0.60, coarse.a);
    let albedo = mix(strewn * (0.55 + 0.9 * crumbs.b), vec3<f32>(0.23, 0.21, 0.18) * (0.6 + 0.6 * crumbs.r), pebbles * 0.7);
    return Soil(albedo, 0.9 * (crumbs.rb - 0.5) + 0.5 * (grain.gb - 0.5));
}

// Mottle of grass seen from afar, where a pixel spans `span_m`: taller grass is brighter, by the pattern of its growth in `fed`; finer tufts and their shadows
// at an angle to it, which hides their repetition. The mip levels are a step finer than pixels, since averages of four pixels lose contrast.
fn mottle_at(p: vec2<f32>, span_m: f32) -> f32 {
    let growth = noise_over(p / 14.0, 0.5 * span_m / 14.0).a;
    let tufts = noise_over(vec2<f32>(0.9285 * p.x - 0.3714 * p.y, 0.9285 * p.y + 0.3714 * p.x) / 6.9, 0.5 * span_m / 6.9).gb;
    return 1.02 + 0.3 * (growth - 0.53) + 0.2 * (tufts.x + tufts.y - 1.0);
}

// Dead leaves between the roots, resolved only near the eye: noise stretched along three directions.
fn litter_at(p: vec2<f32>, is_near: bool) -> vec3<f32> {
    let heap = noise(p / 0.83);
    // Direction; length and width of a leaf (m).
    let leaves = array<vec4<f32>, 3>(vec4<f32>(0.98, 0.19, 0.53, 0.067), vec4<f32>(0.34, -0.94, 0.47, 0.059), vec4<f32>(-0.71, 0.70, 0.61, 0.073));
    var top = 0.0;
    for (var i = 0; i < select(0, 3, is_near); i++) {
        let along = leaves[i].xy;
        let leaf = noise(vec2<f32>(dot(p, along), dot(p, vec2<f32>(-along.y, along.x))) / leaves[i].zw);
        top = max(top, select(leaf.g, leaf.b, i == 1) + 0.5 * heap.rag[i]);
    }
    return mix(vec3<f32>(0.034, 0.030, 0.012), vec3<f32>(0.125, 0.105, 0.042), smoothstep(0.72, 1.18, top)) * (0.6 + 0.8 * heap.b);
}

// Mean grass cover in front of a position, over the first 0.6 of the distance that tall grass hides at this viewing angle: few blades are tall enough to hide
// it from farther on. 0 where the position is not bare, to which it does not matter.
fn fraction_before(p: vec2<f32>, is_bare: bool, span_m: f32, view: vec3<f32>, normal: vec3<f32>, kind: Kind) -> f32 {
    let down = clamp(-dot(view, normal), 0.02, 1.0);
    let hidden_m = kind.height_m * sqrt(1.0 - down * down) / down;
    let toward_eye = -view.xz / max(length(view.xz), 1e-3);
    var sum = 0.0;
    for (var i = 0; i < select(0, 2, is_bare); i++) {
        sum += grass_fraction_over(p + select(0.15, 0.45, i == 1) * hidden_m * toward_eye, max(span_m, 0.25 * hidden_m));
    }
    return 0.5 * sum;
}

// Mean grass cover from a position towards the sun, weighted by the leaves that a ray to the sun meets in even grass. 0 where the maps of the shade tell it.
fn fraction_toward_sun(p: vec2<f32>, is_mapped: bool, span_m: f32, kind: Kind) -> f32 {
    let sun = above_horizon();
    let reach_m = LEAF_TOP * kind.height_m / sun.y * sun.xz;
    var places = BARE_PLACES;
    var weights = BARE_WEIGHTS;
    var sum = 0.0;
    for (var i = 0; i < select(2, 0, is_mapped); i++) {
        sum += weights[i] * grass_fraction_over(p + places[i] * reach_m, max(span_m, 0.4 * length(reach_m)));
    }
    return sum;
}

fn kind_of(ground: Ground) -> Kind {
    if is_plain {
        return kinds.list[ground.kind];
    }
    return kinds_blended(ground.p.xz);
}

// Visible fraction of grass, which also hides bare ground behind it.
fn fraction_at(p: vec2<f32>, span_m: f32, between: f32, view: vec3<f32>, normal: vec3<f32>, kind: Kind) -> f32 {
    if is_plain {
        return 1.0;
    }
    let own = grass_fraction_over(p, span_m);
    return max(own, between * fraction_before(p, own < 1.0, span_m, view, normal, kind));
}

// Ground between the roots.
fn floor_at(p: vec2<f32>, distance_m: f32, kind: Kind) -> vec3<f32> {
    let bare = kind.root_rgb * 0.7;
    if is_plain {
        return bare;
    }
    let litter_fraction = 0.8 * (1.0 - smoothstep(0.3, LITTER_END_M, distance_m));
    return mix(bare, litter_at(p, litter_fraction > 0.0), litter_fraction);
}

// Lean by the bend field (rad).
fn laid_at(p: vec2<f32>, distance_m: f32) -> vec2<f32> {
    if !has_bend {
        return vec2<f32>(0.0);
    }
    return lean_of_field(p, field_level(distance_m));
}

// Light from snow and the grass that stands out of it, of which a fraction shows its far look.
fn snowy(ground: Ground, normal: vec3<f32>, kind: Kind, grassy: f32, sun_light: f32) -> vec3<f32> {
    let p = ground.p.xz;
    let distance_m = distance(ground.p, frame.eye_m);
    let view = (ground.p - frame.eye_m) / distance_m;
    let level = field_level(distance_m);
    let difference_m = snow_difference(p, level);
    let depth_m = max(frame.snow_m + difference_m, 0.0);
    let shade = shade_at(p);
    let reached = mix(1.0, sun_on_snow(kind, depth_m, shade), grassy);
    let snow = snow_light(ground.p, snow_normal(p, level, normal), difference_m, sun_light * reached);
    let lean = laid_at(p, distance_m) + ground.air.xy * kind.wind_bend_rad;
    let grass = sward_color(ground.p, normal, kind, ground.tint, lean, view, sun_light, shade);
    return mix(snow, grass, grassy * hidden_by_grass(kind, depth_m, view, normal));
}

@fragment
fn fs(ground: Ground) -> @location(0) vec4<f32> {
    let p = ground.p.xz;
    let to = ground.p - frame.eye_m;
    let distance_m = length(to);
    let view = to / distance_m;
    let normal = ground_normal(p);
    let kind = kind_of(ground);
    let between = bare_between(distance_m, kind, view, normal);
    let span_m = distance_m * frame.pixel_rad * inverseSqrt(max(-dot(view, normal), 0.05));
    let fraction = fraction_at(p, span_m, between, view, normal, kind);
    let sun_light = ground.air.z * sun_visible(ground.p + normal * 0.05);
    if has_snow {
        let color = snowy(ground, normal, kind, fraction * between, sun_light);
        return vec4<f32>(color * ground.haze.a + ground.haze.rgb, 1.0);
    }
    let shade = shade_at(p);
    var color = vec3<f32>(0.0);
    if !is_plain && fraction < 1.0 {
        let soil = soil_at(p, span_m);
        let rough = normalize(normal + vec3<f32>(soil.slope.x, 0.0, soil.slope.y));
        let around = fraction_toward_sun(p, shade.fraction >= 1.0, span_m, kind);
        let reached = sun_over_grass(shade, 0.0, even_depth(kind) * around, kind.height_m);
        let direct = frame.sun_rgb * (sun_light * reached * max(dot(rough, frame.toward_sun), 0.0));
        // Nearby grass hides part of the sky.
        let open = 1.0 - 0.5 * smoothstep(0.0, 0.5, soft_fraction(p));
        color = soil.albedo * (direct + ambient(rough) * open + lamps_on(ground.p, rough, 0.0)) * (1.0 - fraction);
    }
    if fraction > 0.0 {
        // Far look of the grass, leaning like the blades, where no blades hide the ground; dark between blades.
        let lean = laid_at(p, distance_m) + ground.air.xy * kind.wind_bend_rad;
        let afar = sward_color(ground.p, normal, kind, ground.tint, lean, view, sun_light, shade);
        let mottle = mottle_at(p, span_m);
        let reached = frame.sun_rgb * sun_light * sun_in_grass(0.0, kind, shade, 0.0);
        let under = floor_at(p, distance_m, kind) * (reached + ambient(normal) * 0.55 + lamps_on(ground.p, normal, 0.0) * 0.35);
        let grass = afar * mix(mottle, 1.0, smoothstep(200.0, 900.0, distance_m));
        color += mix(under, grass, between) * fraction;
    }
    return vec4<f32>(color * ground.haze.a + ground.haze.rgb, 1.0);
}
