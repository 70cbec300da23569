// Last pass: several pixels to one, exposure, tone curve (Hable-like filmic shoulder with a soft toe), a little less saturation, dither, encoding.

@group(1) @binding(0) var picture: texture_2d<f32>;
@group(1) @binding(1) var<uniform> tone: Tone;

struct Tone {
    // 1 when the target encodes sRGB by itself; exposure; pixels of the picture along either side of one of the target; unused.
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
    let fineness = i32(tone.target_encodes.z + none_of(position.x));
    let from_centre = position.xy * tone.target_encodes.z / vec2<f32>(textureDimensions(picture)) - 0.5;
    let exposure = tone.target_encodes.y * (1.0 - 0.35 * dot(from_centre, from_centre));
    let first = vec2<i32>(position.xy) * fineness;
    var color = vec3<f32>(0.0);
    for (var i = 0; i < fineness * fineness; i++) {
        color += curve(textureLoad(picture, first + vec2<i32>(i % fineness, i / fineness), 0).rgb * exposure);
    }
    color /= f32(fineness * fineness);
    let grey = dot(color, vec3<f32>(0.2126, 0.7152, 0.0722));
    color = clamp(mix(vec3<f32>(grey), color, 0.97), vec3<f32>(0.0), vec3<f32>(1.0));
    let dither = (random3(vec2<i32>(position.xy), 7u).x - 0.5) / 255.0;
    let shown = select(encode(color), color, tone.target_encodes.x > 0.5);
    return vec4<f32>(shown + dither, 1.0);
}
