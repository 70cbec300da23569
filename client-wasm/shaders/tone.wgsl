// Last pass: exposure, tone curve (Hable-like filmic shoulder with a soft toe), a little less saturation, dither, encoding.

@group(1) @binding(0) var picture: texture_2d<f32>;
@group(1) @binding(1) var<uniform> tone: Tone;

struct Tone {
    // 1 when the target encodes sRGB by itself; exposure; unused.
    target_encodes: vec4<f32>,
}

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

@fragment
fn fs(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let size = vec2<f32>(textureDimensions(picture));
    let uv = position.xy / frame.screen.xy;
    var color = textureSampleLevel(picture, clamped, uv, 0.0).rgb;
    let from_centre = uv - 0.5;
    color *= tone.target_encodes.y * (1.0 - 0.35 * dot(from_centre, from_centre));
    color = curve(color);
    let grey = dot(color, vec3<f32>(0.2126, 0.7152, 0.0722));
    color = clamp(mix(vec3<f32>(grey), color, 0.97), vec3<f32>(0.0), vec3<f32>(1.0));
    let dither = (random3(vec2<i32>(position.xy), 7u).x - 0.5) / 255.0;
    let shown = select(encode(color), color, tone.target_encodes.x > 0.5);
    return vec4<f32>(shown + dither, 1.0);
}
