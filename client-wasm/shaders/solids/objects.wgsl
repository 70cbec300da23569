// Triangle meshes: vehicles, trees and stones, in the picture and in the shadow map.

import package::constants::{AIR_KG_PER_M3, FLUTTER_M, NO_LIMBS, WORKGROUP_SIZE};
import package::inputs::frame::{clamped, frame};
import package::inputs::lamps::{lamps_about, lamps_on};
import package::inputs::shadows::sun_visible;
import package::inputs::wind::{lean_of_wind, wind_at};
import package::land_and_sky::clouds::cloud_light;
import package::land_and_sky::grass_light::{grass_lamps, grass_light};
import package::land_and_sky::haze::{air_before, hazed};
import package::land_and_sky::snow::{has_snow, snow_light};
import package::land_and_sky::sky_light::{ambient, sky_color};
import package::solids::limbs::{bent_in_tree, BentLimb, of_limb};

// Whether the mesh may be glossy, as vehicles are. Fixed at pipeline creation.
override is_glossy: bool = true;

// Whether trees consist of components that bend. Fixed at pipeline creation.
override is_grown: bool = false;

// Distance from a lamp to its glass (m).
const GLASS_M: f32 = 0.17;

struct Instance {
    world_from_model: mat4x4<f32>,
    // Colour factor.
    tint: vec3<f32>,
    // Sway of a tree in a wind of 10 m/s and above (rad), 0 for rigid objects.
    sway_rad: f32,
    // First of its bent components, or `NO_LIMBS`.
    first_bent: u32,
    // First component of its shape, and the number of those that bend.
    first_limb: u32,
    limbs: u32,
    unused: u32,
}

// Response of a tree to the wind.
struct TreeSway {
    // Sway of its top, X and Z (rad); of a tree of components the pressure of the wind (Pa).
    top_rad: vec2<f32>,
    // Flutter of its leaves (m).
    flutter_m: f32,
    unused: f32,
}

@group(1) @binding(0) var<storage, read> instances: array<Instance>;
@group(1) @binding(1) var leaves: texture_2d<f32>;
// Response of each instance, from `sway_of`.
@group(1) @binding(2) var<storage, read> sways: array<TreeSway>;
@group(1) @binding(3) var<storage, read_write> sways_out: array<TreeSway>;
@group(1) @binding(5) var<storage, read_write> bent_limbs_out: array<BentLimb>;
// Instance and component of each invocation of `bow`; `NO_LIMBS` where there is none.
@group(1) @binding(8) var<storage, read> listed_limbs: array<vec2<u32>>;

struct Vertex {
    @location(0) position: vec3<f32>,
    @location(1) normal: vec4<f32>,
    // Square root of the linear colour; gloss, or openness of a leaf.
    @location(2) color: vec4<f32>,
    // Coordinates in the leaf texture; (0, 0) is solid.
    @location(3) leaf: vec2<f32>,
}

struct Surface {
    @builtin(position) position: vec4<f32>,
    @location(0) p: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) color: vec4<f32>,
    @location(3) leaf: vec2<f32>,
}

// Displacement of a point `up` metres above the foot of a tree by a sway (rad, as a vector on the ground: displacement of the top over the
// height): sideways with the square of the height, as a beam bends, and downwards so that the trunk keeps its length.
fn swayed(up: f32, height: f32, sway: vec2<f32>) -> vec3<f32> {
    let aside = sway * (up * up / height);
    return vec3<f32>(aside.x, -dot(sway, sway) * (2.0 / 3.0) * up * up * up / (height * height), aside.y);
}

fn sway_of(instance: Instance) -> TreeSway {
    let most = instance.sway_rad;
    let foot = instance.world_from_model[3].xyz;
    // Models are a metre tall.
    let height = length(instance.world_from_model[1].xyz);
    let held = lean_of_wind(wind_at(foot, 6.0).xz, most);
    // Taller trees sway more slowly.
    let phase = frame.time_secs * 4.5 / sqrt(height) + foot.x * 0.7 + foot.z * 1.3;
    let blown = length(held) / max(most, 1e-6);
    return TreeSway(held * (0.7 + 0.3 * sin(phase)), FLUTTER_M * min(6.0 * blown, 0.4 + 1.5 * blown), 0.0);
}

// Pressure of the wind on a tree of components (Pa, X and Z).
fn pressure_on(instance: Instance) -> vec2<f32> {
    let wind = wind_at(instance.world_from_model[3].xyz, 0.6 * length(instance.world_from_model[1].xyz)).xz;
    return wind * (0.5 * AIR_KG_PER_M3 * length(wind));
}

@compute @workgroup_size(WORKGROUP_SIZE)
fn blow(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x < arrayLength(&sways_out) {
        let instance = instances[id.x];
        var sway = sway_of(instance);
        if is_grown && instance.first_bent != NO_LIMBS {
            sway.top_rad = pressure_on(instance);
        }
        sways_out[id.x] = sway;
    }
}

// Axes X and Z of a tree, along X and Z of the world.
fn turn_of(instance: Instance) -> mat2x2<f32> {
    return mat2x2<f32>(normalize(instance.world_from_model[0].xz), normalize(instance.world_from_model[2].xz));
}

@compute @workgroup_size(WORKGROUP_SIZE)
fn bow(@builtin(global_invocation_id) id: vec3<u32>) {
    let listed = listed_limbs[id.x];
    if listed.x == NO_LIMBS {
        return;
    }
    let instance = instances[listed.x];
    let foot = instance.world_from_model[3].xyz;
    let tall_m = length(instance.world_from_model[1].xyz);
    let phase = foot.x * 0.7 + foot.z * 1.3;
    let bent = bent_in_tree(instance.first_limb, listed.y, sways[listed.x].top_rad, turn_of(instance), tall_m, phase);
    bent_limbs_out[instance.first_bent + listed.y] = bent;
}

// A vertex where the components of its tree, if it has any, have moved it in its model.
fn moved(vertex: Vertex, instance: Instance, sway: TreeSway) -> Vertex {
    if !is_grown || instance.first_bent == NO_LIMBS {
        return vertex;
    }
    let row = instance.first_bent + u32(round(vertex.normal.w * 127.0));
    let pressure = sway.top_rad * turn_of(instance);
    let own = of_limb(row, vertex.position, vertex.normal.xyz, vertex.leaf.x > 0.0, vec3<f32>(pressure.x, 0.0, pressure.y));
    return Vertex(own.position, vec4<f32>(own.normal, 0.0), vertex.color, vertex.leaf);
}

// Position of a moved vertex in the world.
fn placed(vertex: Vertex, instance: Instance, sway: TreeSway) -> vec3<f32> {
    var p = (instance.world_from_model * vec4<f32>(vertex.position, 1.0)).xyz;
    if instance.sway_rad > 0.0 {
        if !is_grown || instance.first_bent == NO_LIMBS {
            let foot = instance.world_from_model[3].xyz;
            let height = length(instance.world_from_model[1].xyz);
            p += swayed(max(p.y - foot.y, 0.0), height, sway.top_rad);
        }
        if vertex.leaf.x > 0.0 {
            let flutter = sin(frame.time_secs * 5.3 + dot(vertex.position, vec3<f32>(5.1, 7.7, 3.9))) * sway.flutter_m;
            p += vec3<f32>(flutter, flutter * 0.6, -flutter);
        }
    }
    return p;
}

fn surface_of(modelled: Vertex, index: u32) -> Surface {
    let instance = instances[index];
    let vertex = moved(modelled, instance, sways[index]);
    var out: Surface;
    out.p = placed(vertex, instance, sways[index]);
    out.normal = (instance.world_from_model * vec4<f32>(vertex.normal.xyz, 0.0)).xyz;
    out.color = vec4<f32>(vertex.color.rgb * vertex.color.rgb * instance.tint, vertex.color.a);
    out.leaf = vertex.leaf;
    out.position = frame.projection_from_world * vec4<f32>(out.p, 1.0);
    return out;
}

@vertex
fn vs(vertex: Vertex, @location(4) index: u32) -> Surface {
    return surface_of(vertex, index);
}

// Light of the glass in front of a lamp, which turns with its beam.
fn shining(p: vec3<f32>, normal: vec3<f32>) -> vec3<f32> {
    var light = vec3<f32>(0.0);
    for (var i = 0u; i < lamps_about(p); i++) {
        let lamp = frame.lights.lamps[i];
        if distance(p, lamp.position_m) < GLASS_M {
            light += lamp.rgb * (6.0 * smoothstep(0.2, 0.8, dot(normal, lamp.direction)));
        }
    }
    return light;
}

// Light of sun, sky and lamps on a surface without gloss. `light` is the fraction of unshadowed sunlight; `openness` is that of a leaf.
fn matte(p: vec3<f32>, normal: vec3<f32>, view: vec3<f32>, albedo: vec3<f32>, openness: f32, is_leaf: bool, light: f32) -> vec3<f32> {
    if is_leaf {
        let upright = vec3<f32>(0.0, 1.0, 0.0);
        return grass_light(albedo, normal, upright, view, light, openness) + grass_lamps(albedo, normal, upright, view, p, openness);
    }
    let diffuse = max(dot(normal, frame.toward_sun), 0.0);
    return albedo * (frame.sun_rgb * light * diffuse + ambient(normal) + lamps_on(p, normal, 0.0));
}

// Depth of snow that hides stone and bark (m).
const OPAQUE_SNOW_M: f32 = 0.02;

// Fraction of a surface that snow hides: leaves that face upward, and stone, bark and roofs that are not too steep. Vehicles and gates stay bare.
fn snow_on(normal: vec3<f32>, is_leaf: bool) -> f32 {
    if is_glossy || !has_snow {
        return 0.0;
    }
    let on_leaf = frame.crown_snow * smoothstep(-0.1, 0.9, normal.y);
    let on_stone = min(frame.snow_m / OPAQUE_SNOW_M, 1.0) * smoothstep(0.6, 0.85, normal.y);
    return select(on_stone, on_leaf, is_leaf);
}

// Colour of a surface with the snow that lies on it. `light` is the fraction of unshadowed sunlight.
fn under_snow(color: vec3<f32>, p: vec3<f32>, normal: vec3<f32>, is_leaf: bool, light: f32) -> vec3<f32> {
    if is_glossy || !has_snow {
        return color;
    }
    return mix(color, snow_light(p, normal, 0.0, light), snow_on(normal, is_leaf));
}

fn sun_light_at(p: vec3<f32>, normal: vec3<f32>) -> f32 {
    return cloud_light(p.xz) * sun_visible(p + normal * 0.06);
}

// Factor on the colour of a leaf by its texture.
fn veins(texel: vec4<f32>) -> f32 {
    return 0.55 + 0.9 * texel.r;
}

// Fraction of the line of sight, from its end, in which trees do not fade: those beside the vehicle remain whole.
const WHOLE_AT_TARGET: f32 = 0.25;

// Visible fraction of a tree at a position: it fades around the line from the eye to the camera's target.
fn visible_fraction(p: vec3<f32>) -> f32 {
    let sight = frame.target_m - frame.eye_m;
    let along = dot(p - frame.eye_m, sight) / max(dot(sight, sight), 1e-3);
    let aside = distance(p, frame.eye_m + sight * clamp(along, 0.0, 1.0)) / max(frame.fade_m, 1e-3);
    let seen = max(smoothstep(0.6, 1.0, aside), smoothstep(1.0 - WHOLE_AT_TARGET, 1.0, along));
    return select(1.0, seen, frame.fade_m > 0.0);
}

// Threshold of a pixel for its visible fraction: interleaved gradient noise (Jimenez 2014).
fn threshold(pixel: vec2<f32>) -> f32 {
    return fract(52.982918 * fract(dot(pixel, vec2<f32>(0.06711056, 0.00583715))));
}

@fragment
fn fs(surface: Surface) -> @location(0) vec4<f32> {
    let leaf = textureSample(leaves, clamped, surface.leaf);
    let is_leaf = surface.leaf.x > 0.0;
    if (is_leaf && leaf.a < 0.5) || (!is_glossy && visible_fraction(surface.p) <= threshold(surface.position.xy)) {
        discard;
    }
    let view = normalize(surface.p - frame.eye_m);
    let normal = normalize(surface.normal);
    let light = sun_light_at(surface.p, normal);
    let albedo = surface.color.rgb * select(1.0, veins(leaf), is_leaf);
    var color = matte(surface.p, normal, view, albedo, surface.color.a, is_leaf, light);
    color = under_snow(color, surface.p, normal, is_leaf, light);
    if is_glossy && !is_leaf {
        let gloss = surface.color.a;
        let half_way = normalize(frame.toward_sun - view);
        let grazing = 1.0 - clamp(dot(normal, -view), 0.0, 1.0);
        let fresnel = grazing * grazing * grazing * grazing;
        let mirrored = reflect(view, normal);
        let above = max(mirrored.y, 0.0);
        let reflected = mix(ambient(vec3<f32>(0.0, -1.0, 0.0)), sky_color(vec3<f32>(mirrored.x, above, mirrored.z)), smoothstep(-0.1, 0.15, mirrored.y));
        let sharp = pow(max(dot(normal, half_way), 0.0), mix(12.0, 160.0, gloss));
        color += gloss * (reflected * (0.06 + 0.75 * fresnel) + frame.sun_rgb * light * sharp * 1.6);
        color += shining(surface.p, normal);
    }
    return vec4<f32>(hazed(color, surface.p), 1.0);
}

// Where the shadow of a corner of a spray of leaves is sampled: at this depth below it, since the corners reach out of the crown, and this far
// towards the eye, since the leaves behind it are hidden. Both are relative to the height of the tree.
const SPRAY_FRACTION: f32 = 0.065;
const TOWARDS_EYE_FRACTION: f32 = 0.095;

// Surface lit at its vertices: most fragments of sprays of leaves are hidden or cut away.
struct Afar {
    @builtin(position) position: vec4<f32>,
    // Colour as seen through the air: the part that the texture multiplies, and the rest.
    @location(0) diffuse: vec3<f32>,
    @location(1) sheen: vec3<f32>,
    @location(2) leaf: vec2<f32>,
}

@vertex
fn vs_afar(vertex: Vertex, @location(4) index: u32) -> Afar {
    let surface = surface_of(vertex, index);
    let is_leaf = surface.leaf.x > 0.0;
    let view = normalize(surface.p - frame.eye_m);
    let normal = normalize(surface.normal);
    let height = length(instances[index].world_from_model[1].xyz);
    let shaded_at = surface.p - (normal * SPRAY_FRACTION + view * TOWARDS_EYE_FRACTION) * select(0.0, height, is_leaf);
    let light = sun_light_at(shaded_at, normal);
    let black = matte(surface.p, normal, view, vec3<f32>(0.0), surface.color.a, is_leaf, light);
    let plain = matte(surface.p, normal, view, surface.color.rgb, surface.color.a, is_leaf, light);
    let air = air_before(surface.p);
    let sheen = under_snow(black, surface.p, normal, is_leaf, light);
    return Afar(surface.position, (plain - black) * (air.a * (1.0 - snow_on(normal, is_leaf))), sheen * air.a + air.rgb, surface.leaf);
}

@fragment
fn fs_afar(afar: Afar) -> @location(0) vec4<f32> {
    let leaf = textureSample(leaves, clamped, afar.leaf);
    let is_leaf = afar.leaf.x > 0.0;
    if is_leaf && leaf.a < 0.5 {
        discard;
    }
    return vec4<f32>(afar.diffuse * select(1.0, veins(leaf), is_leaf) + afar.sheen, 1.0);
}

struct Shade {
    @builtin(position) position: vec4<f32>,
    @location(0) leaf: vec2<f32>,
}

@vertex
fn vs_shadow(vertex: Vertex, @location(4) index: u32) -> Shade {
    var out: Shade;
    let own = moved(vertex, instances[index], sways[index]);
    out.position = frame.shadow_from_world * vec4<f32>(placed(own, instances[index], sways[index]), 1.0);
    out.leaf = vertex.leaf;
    return out;
}

@vertex
fn vs_shadow_far(vertex: Vertex, @location(4) index: u32) -> Shade {
    var out: Shade;
    let own = moved(vertex, instances[index], sways[index]);
    out.position = frame.lights.far_shadow_from_world * vec4<f32>(placed(own, instances[index], sways[index]), 1.0);
    out.leaf = vertex.leaf;
    return out;
}

@fragment
fn fs_shadow(shade: Shade) {
    if shade.leaf.x > 0.0 && textureSampleLevel(leaves, clamped, shade.leaf, 0.0).a < 0.5 {
        discard;
    }
}
