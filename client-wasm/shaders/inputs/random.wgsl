// Random numbers and dither.

import package::constants::{HASH_INCREMENT, HASH_MULTIPLIER, UNIT_STEPS};

// Integer hash pcg3d (Jarzynski & Olano 2020). Twin of `hash3` in shared/src/hash.rs.
fn hash3(v_in: vec3<u32>) -> vec3<u32> {
    var v = v_in * HASH_MULTIPLIER + HASH_INCREMENT;
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v ^= v >> vec3<u32>(16u);
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    return v;
}

// Three random numbers in 0..1 for a cell and a number.
fn random3(place: vec2<i32>, number: u32) -> vec3<f32> {
    let h = hash3(vec3<u32>(bitcast<u32>(place.x), bitcast<u32>(place.y), number));
    return vec3<f32>(h >> vec3<u32>(8u)) / UNIT_STEPS;
}

// Interleaved gradient noise (Jimenez 2014): numbers in 0..1 that
// differ widely between neighbouring pixels.
fn gradient_noise(pixel: vec2<f32>) -> f32 {
    return fract(52.9829189 * fract(dot(pixel, vec2<f32>(0.06711056, 0.00583715))));
}

// Threshold in 0..1 for dithered fading at a pixel.
fn dither_at(pixel: vec2<f32>) -> f32 {
    return 0.01 + 0.98 * gradient_noise(floor(pixel));
}
