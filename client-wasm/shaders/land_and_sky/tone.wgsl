// Tone mapping: resolves samples or enlarges the picture, then exposure, filmic tone curve, slight desaturation, dither and encoding.

import package::constants::LUMINANCE;
import package::inputs::frame::runtime_zero;
import package::inputs::random::random3;
import package::land_and_sky::between::between;
import package::uniforms::Tone;

@group(1) @binding(0) var picture: texture_2d<f32>;
@group(1) @binding(1) var<uniform> tone: Tone;
// Multisampled picture, in place of `picture`.
@group(1) @binding(2) var sampled: texture_multisampled_2d<f32>;

@vertex
fn vs(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return vec4<f32>(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

// ACES filmic fit (Narkowicz 2015), at 0.6 of its exposure.
fn curve(x: vec3<f32>) -> vec3<f32> {
    let v = x * 0.6;
    return clamp((v * (2.51 * v + 0.03)) / (v * (2.43 * v + 0.59) + 0.14), vec3<f32>(0.0), vec3<f32>(1.0));
}

// sRGB, within a quarter of an 8-bit step: square roots in place of the power, which cost less in software.
fn encode(linear: vec3<f32>) -> vec3<f32> {
    let low = linear * 12.92;
    let second = sqrt(max(linear, vec3<f32>(0.0)));
    let fourth = sqrt(second);
    let high = 0.662002687 * second + 0.684122060 * fourth - 0.323583601 * sqrt(fourth) - 0.0225411470 * linear;
    return select(high, low, linear <= vec3<f32>(0.0031308));
}

// Exposure at a pixel, with vignetting.
fn exposure_at(position: vec2<f32>, size: vec2<f32>) -> f32 {
    let from_centre = position / size - 0.5;
    return tone.exposure * (1.0 - 0.35 * dot(from_centre, from_centre));
}

// Supersampling factor, where the scale is a whole number.
fn fineness_at(position: vec2<f32>) -> i32 {
    return i32(tone.scale.x + runtime_zero(position.x));
}

// Place of a pixel of the target between four pixels of the picture.
struct Between {
    // Positions of the first and last of the four.
    low: vec2<i32>,
    high: vec2<i32>,
    // Fraction of the way from the first to the last.
    way: vec2<f32>,
}

fn place_between(position: vec2<f32>, size: vec2<f32>) -> Between {
    let at = clamp(position * tone.scale - 0.5, vec2<f32>(0.0), size - 1.0);
    let low = floor(at);
    return Between(vec2<i32>(low), vec2<i32>(min(low + 1.0, size - 1.0)), at - low);
}

fn toned(at: vec2<i32>, exposure: f32) -> vec3<f32> {
    return curve(textureLoad(picture, at, 0).rgb * exposure);
}

fn toned_samples(at: vec2<i32>, exposure: f32) -> vec3<f32> {
    let samples = i32(textureNumSamples(sampled));
    var color = vec3<f32>(0.0);
    for (var sample = 0; sample < samples; sample++) {
        color += curve(textureLoad(sampled, at, sample).rgb * exposure);
    }
    return color / f32(samples);
}

@fragment
fn fs(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let fineness = fineness_at(position.xy);
    let exposure = exposure_at(position.xy * f32(fineness), vec2<f32>(textureDimensions(picture)));
    let first = vec2<i32>(position.xy) * fineness;
    var color = vec3<f32>(0.0);
    for (var i = 0; i < fineness * fineness; i++) {
        color += toned(first + vec2<i32>(i % fineness, i / fineness), exposure);
    }
    return shown(color / f32(fineness * fineness), position.xy);
}

// Samples are averaged after the tone curve: otherwise edges against a bright sky would be as hard as without multisampling.
@fragment
fn fs_sampled(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let fineness = fineness_at(position.xy);
    let exposure = exposure_at(position.xy * f32(fineness), vec2<f32>(textureDimensions(sampled)));
    let first = vec2<i32>(position.xy) * fineness;
    var color = vec3<f32>(0.0);
    for (var i = 0; i < fineness * fineness; i++) {
        color += toned_samples(first + vec2<i32>(i % fineness, i / fineness), exposure);
    }
    return shown(color / f32(fineness * fineness), position.xy);
}

// Pictures of another size are interpolated, after the tone curve too.
@fragment
fn fs_between(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let size = vec2<f32>(textureDimensions(picture));
    let exposure = exposure_at(position.xy * tone.scale, size);
    let place = place_between(position.xy, size);
    let nw = toned(place.low, exposure);
    let ne = toned(vec2<i32>(place.high.x, place.low.y), exposure);
    let sw = toned(vec2<i32>(place.low.x, place.high.y), exposure);
    let se = toned(place.high, exposure);
    return shown(between(nw, ne, sw, se, place.way), position.xy);
}

@fragment
fn fs_sampled_between(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let size = vec2<f32>(textureDimensions(sampled));
    let exposure = exposure_at(position.xy * tone.scale, size);
    let place = place_between(position.xy, size);
    let nw = toned_samples(place.low, exposure);
    let ne = toned_samples(vec2<i32>(place.high.x, place.low.y), exposure);
    let sw = toned_samples(vec2<i32>(place.low.x, place.high.y), exposure);
    let se = toned_samples(place.high, exposure);
    return shown(between(nw, ne, sw, se, place.way), position.xy);
}

// Encoded colour of the target, dithered.
fn shown(linear: vec3<f32>, position: vec2<f32>) -> vec4<f32> {
    var color = linear;
    let grey = dot(color, LUMINANCE);
    color = clamp(mix(vec3<f32>(grey), color, 0.97), vec3<f32>(0.0), vec3<f32>(1.0));
    let dither = (random3(vec2<i32>(position), 7u).x - 0.5) / 255.0;
    return vec4<f32>(select(encode(color), color, tone.target_encodes > 0.5) + dither, 1.0);
}
