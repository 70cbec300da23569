// Height, normal and grass cover of the ground.

import package::constants::{GROWTH_BY_COVER, GROWTH_BY_MEADOW, GROWTH_BY_SOIL, HILLS_FULL_M, HILLS_MEAN, HILLS_RANGE_M, HILLS_SLOPE};
import package::inputs::frame::{clamped, frame};
import package::inputs::noise::{noise, noise_over};
import package::inputs::world_edge::metres_outside;

@group(0) @binding(1) var heights: texture_2d<f32>;
@group(0) @binding(2) var normals: texture_2d<f32>;
@group(0) @binding(3) var cover: texture_2d<f32>;

// Hills beyond the edge of the world, so that the horizon is not flat. On software drivers an empty loop costs one iteration: work that few
// positions need is in short loops, here and below.
fn far_hills(p: vec2<f32>, outside_m: f32) -> f32 {
    var n = 0.0;
    for (var i = 0; i < select(0, 2, outside_m > 0.0); i++) {
        let found = noise(p / select(2600.0, 790.0, i == 1));
        n += select(found.r * 0.7, found.g * 0.3, i == 1);
    }
    let rise = smoothstep(0.0, HILLS_FULL_M, outside_m);
    return rise * ((n - HILLS_MEAN) * HILLS_RANGE_M + outside_m * HILLS_SLOPE);
}

fn ground_height(p: vec2<f32>) -> f32 {
    let size = frame.heights_px;
    let at = clamp(p / frame.height_spacing_m, vec2<f32>(0.0), size - 1.001);
    let low = floor(at);
    let fraction = at - low;
    let i = vec2<i32>(low);
    let nw = textureLoad(heights, i, 0).r;
    let ne = textureLoad(heights, i + vec2<i32>(1, 0), 0).r;
    let sw = textureLoad(heights, i + vec2<i32>(0, 1), 0).r;
    let se = textureLoad(heights, i + vec2<i32>(1, 1), 0).r;
    let height = mix(mix(nw, ne, fraction.x), mix(sw, se, fraction.x), fraction.y);
    return height + far_hills(p, metres_outside(p));
}

// Normal of the land, from four positions 20 m away.
fn far_normal(p: vec2<f32>, outside_m: f32) -> vec3<f32> {
    var slope = vec2<f32>(0.0);
    for (var i = 0u; i < select(0u, 4u, outside_m > 20.0); i++) {
        let way = select(vec2<f32>(20.0, 0.0), vec2<f32>(0.0, 20.0), i > 1u) * select(1.0, -1.0, (i & 1u) == 1u);
        slope += way * far_hills(p + way, outside_m);
    }
    return normalize(vec3<f32>(-slope.x, 800.0, -slope.y));
}

fn ground_normal(p: vec2<f32>) -> vec3<f32> {
    let outside_m = metres_outside(p);
    if outside_m > 20.0 {
        return far_normal(p, outside_m);
    }
    let uv = (p / frame.height_spacing_m + 0.5) / frame.heights_px;
    return normalize(textureSampleLevel(normals, clamped, uv, 0.0).xyz);
}

// Smooth grass cover from the map: 0 on bare ground, stones and at trunks.
fn soft_fraction(p: vec2<f32>) -> f32 {
    return textureSampleLevel(cover, clamped, p / frame.world_extent_m, 0.0).r;
}

// Grass cover with ragged borders.
fn grass_fraction(p: vec2<f32>) -> f32 {
    return grass_fraction_over(p, 0.0);
}

// Mean of the grass cover over `span_m`: a bare strip that is narrower makes it paler, but stays whole.
fn grass_fraction_over(p: vec2<f32>, span_m: f32) -> f32 {
    let spans_px = span_m * f32(textureDimensions(cover).x) / frame.world_extent_m.x;
    let soft = textureSampleLevel(cover, clamped, p / frame.world_extent_m, log2(max(spans_px, 1.0))).r;
    let is_border = soft > 0.0 && soft < 1.0;
    var ragged = 0.0;
    for (var i = 0; i < select(0, 2, is_border); i++) {
        let period_m = select(7.0, 2.1, i == 1);
        let found = noise_over(p / period_m, span_m / period_m);
        ragged += 0.3 * select(found.b, found.g, i == 1);
    }
    let sharp = smoothstep(0.35, 0.65, soft + (ragged - 0.3) * (1.0 - abs(2.0 * soft - 1.0)));
    return select(soft, mix(sharp, soft, smoothstep(0.15, 1.5, spans_px)), is_border);
}

// Height of grass relative to its kind, 1 on average: it varies with the nutrients that underbrush leaves in the soil and with a random
// pattern, and is low at borders with bare ground.
fn fed(p: vec2<f32>) -> f32 {
    let covered = textureSampleLevel(cover, clamped, p / frame.world_extent_m, 0.0);
    return mix(GROWTH_BY_SOIL[0], GROWTH_BY_SOIL[1], covered.g) * mix(GROWTH_BY_MEADOW[0], GROWTH_BY_MEADOW[1], noise(p / 14.0).a)
        * mix(GROWTH_BY_COVER[0], GROWTH_BY_COVER[1], smoothstep(0.35, 0.85, covered.r));
}
