// Kinds of grass and their map.

import package::constants::{RAGGED, RAGGED_PX_M};
import package::inputs::frame::frame;
import package::inputs::noise::noise;
import package::inputs::world_edge::metres_outside;
import package::uniforms::{Kind, Kinds};

@group(0) @binding(12) var<uniform> kinds: Kinds;
@group(0) @binding(11) var kind_map: texture_2d<u32>;

// Whether there is more than one kind.
override has_kinds: bool = true;

// The four nearest pixels of the map of kinds, and their weights.
struct KindsAbout {
    kinds: vec4<u32>,
    fractions: vec4<f32>,
}

// Pixel of a map that repeats by mirroring at its edges.
fn mirrored(pixel: vec2<i32>, size: vec2<i32>) -> vec2<i32> {
    let at = ((pixel % (2 * size)) + 2 * size) % (2 * size);
    return min(at, 2 * size - 1 - at);
}

fn kinds_about(p: vec2<f32>) -> KindsAbout {
    let size = textureDimensions(kind_map);
    let px_m = frame.world_extent_m / vec2<f32>(size);
    // Ragged borders: the map is sampled at a small offset, which beyond the edge of the world grows with the distance from it.
    let ragged_m = clamp(px_m, vec2<f32>(RAGGED_PX_M[0]), vec2<f32>(RAGGED_PX_M[1]));
    let scales_m = array<vec2<f32>, 3>(RAGGED[0] * ragged_m, RAGGED[1] * ragged_m, vec2<f32>(metres_outside(p)));
    let sizes_m = vec3<f32>(13.0, 3.7, 830.0);
    var beside_m = vec2<f32>(0.0);
    for (var i = 0; i < 3; i++) {
        let at = p / sizes_m[i];
        beside_m += (vec2<f32>(noise(at).r, noise(at + 0.37).r) - 0.5) * scales_m[i];
    }
    let at = (p + beside_m) / px_m - 0.5;
    let low = floor(at);
    let fraction = at - low;
    let nw = mirrored(vec2<i32>(low), vec2<i32>(size));
    let se = mirrored(vec2<i32>(low) + 1, vec2<i32>(size));
    var about: KindsAbout;
    about.kinds = vec4<u32>(
        textureLoad(kind_map, nw, 0).r,
        textureLoad(kind_map, vec2<i32>(se.x, nw.y), 0).r,
        textureLoad(kind_map, vec2<i32>(nw.x, se.y), 0).r,
        textureLoad(kind_map, se, 0).r,
    );
    let west = 1.0 - fraction.x;
    let north = 1.0 - fraction.y;
    about.fractions = vec4<f32>(west * north, fraction.x * north, west * fraction.y, fraction.x * fraction.y);
    return about;
}

// Index of the kind with the greatest weight at a position.
fn kind_at(p: vec2<f32>) -> u32 {
    if !has_kinds {
        return 0u;
    }
    var about = kinds_about(p);
    var found = 0u;
    var most = 0.0;
    for (var i = 0; i < 4; i++) {
        let same = select(vec4<f32>(0.0), about.fractions, about.kinds == vec4<u32>(about.kinds[i]));
        let counts = dot(same, vec4<f32>(1.0));
        if counts > most {
            most = counts;
            found = about.kinds[i];
        }
    }
    return found;
}

// Leaf area of a kind relative to the first kind, whose leaf area is in the frame's uniforms.
fn leafiness(kind: Kind) -> f32 {
    return kind.width * kind.height_m / (kinds.list[0].width * kinds.list[0].height_m);
}

// Weighted mean of the kinds at a position, as seen from afar.
fn kinds_blended(p: vec2<f32>) -> Kind {
    if !has_kinds {
        return kinds.list[0];
    }
    var about = kinds_about(p);
    var blend: Kind;
    for (var i = 0; i < 4; i++) {
        let kind = kinds.list[about.kinds[i]];
        let fraction = about.fractions[i];
        blend.root_rgb += kind.root_rgb * fraction;
        blend.height_m += kind.height_m * fraction;
        blend.tip_rgb += kind.tip_rgb * fraction;
        blend.wind_bend_rad += kind.wind_bend_rad * fraction;
        blend.bend_m_per_s += kind.bend_m_per_s * fraction;
        blend.bend_m_per_rad += kind.bend_m_per_rad * fraction;
        blend.lag_secs += kind.lag_secs * fraction;
        blend.rising_lag += kind.rising_lag * fraction;
        blend.segments += kind.segments * fraction;
        blend.frequency_rad_per_s += kind.frequency_rad_per_s * fraction;
        blend.droop += kind.droop * fraction;
        blend.width += kind.width * fraction;
    }
    return blend;
}
