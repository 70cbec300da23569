// Tone mapping: resolves samples, then exposure, filmic tone curve, slight desaturation, dither and encoding.

import package::constants::LUMINANCE;
import package::inputs::frame::runtime_zero;
import package::inputs::random::random3;
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

fn encode(linear: vec3<f32>) -> vec3<f32> {
    let low = linear * 12.92;
    let high = 1.055 * pow(max(linear, vec3<f32>(0.0)), vec3<f32>(1.0 / 2.4)) - 0.055;
    return select(high, low, linear <= vec3<f32>(0.0031308));
}

// Exposure at a pixel, with vignetting.
fn exposure_at(position: vec2<f32>, size: vec2<f32>) -> f32 {
    let from_centre = position / size - 0.5;
    return tone.exposure * (1.0 - 0.35 * dot(from_centre, from_centre));
}

// Supersampling factor.
fn fineness_at(position: vec2<f32>) -> i32 {
    return i32(tone.supersampling + runtime_zero(position.x));
}

@fragment
fn fs(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let fineness = fineness_at(position.xy);
    let exposure = exposure_at(position.xy * f32(fineness), vec2<f32>(textureDimensions(picture)));
    let first = vec2<i32>(position.xy) * fineness;
    var color = vec3<f32>(0.0);
    for (var i = 0; i < fineness * fineness; i++) {
        color += curve(textureLoad(picture, first + vec2<i32>(i % fineness, i / fineness), 0).rgb * exposure);
    }
    return shown(color / f32(fineness * fineness), position.xy);
}

// Samples are averaged after the tone curve: otherwise edges against a bright sky would be as hard as without multisampling.
@fragment
fn fs_sampled(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let fineness = fineness_at(position.xy);
    let exposure = exposure_at(position.xy * f32(fineness), vec2<f32>(textureDimensions(sampled)));
    let first = vec2<i32>(position.xy) * fineness;
    let samples = i32(textureNumSamples(sampled));
    var color = vec3<f32>(0.0);
    for (var i = 0; i < fineness * fineness; i++) {
        for (var sample = 0; sample < samples; sample++) {
            color += curve(textureLoad(sampled, first + vec2<i32>(i % fineness, i / fineness), sample).rgb * exposure);
        }
    }
    return shown(color / f32(samples * fineness * fineness), position.xy);
}

// Encoded colour of the target, dithered.
fn shown(linear: vec3<f32>, position: vec2<f32>) -> vec4<f32> {
    var color = linear;
    let grey = dot(color, LUMINANCE);
    color = clamp(mix(vec3<f32>(grey), color, 0.97), vec3<f32>(0.0), vec3<f32>(1.0));
    let dither = (random3(vec2<i32>(position), 7u).x - 0.5) / 255.0;
    return vec4<f32>(select(encode(color), color, tone.target_encodes > 0.5) + dither, 1.0);
}
