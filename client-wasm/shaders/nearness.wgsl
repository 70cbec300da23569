// How near something is, for keys that sort it far to near.

// 15 bits, growing as the distance (m) falls from 400 m to 5 cm: steps of 0.03 % of it.
fn nearness(distance_m: f32) -> u32 {
    return u32(clamp(log2(400.0 / max(distance_m, 1e-6)) * 2527.0, 0.0, 32767.0));
}
