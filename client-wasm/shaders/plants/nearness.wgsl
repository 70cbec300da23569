// Sort keys by distance, far to near.

// 15-bit key that grows as the distance (m) falls from 400 m to 5 cm, in steps of 0.03 %.
fn nearness(distance_m: f32) -> u32 {
    return u32(clamp(log2(400.0 / max(distance_m, 1e-6)) * 2527.0, 0.0, 32767.0));
}
