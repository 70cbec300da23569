// Sampling of the streamed bend field.

import package::constants::{PASTS, TAU};
import package::inputs::frame::{frame, runtime_zero, repeated};
import package::inputs::repeated_patch::repeated_lean;
import package::inputs::wind::lean_of_wind;
import package::uniforms::Kind;

@group(0) @binding(4) var bends: texture_2d_array<f32>;

// State of the bend field at a position, in a mip level and a layer of the atlas: θ (rad), ω (rad/s). Layer 0 is the newest.
fn bend_at(p: vec2<f32>, level: f32, layer: i32) -> vec3<f32> {
    let bend = textureSampleLevel(bends, repeated, p / frame.bend_window_m, layer, level);
    return vec3<f32>(bend.x, bend.yz * abs(bend.yz));
}

// Lean (rad, as a vector on the ground) of a state of the bend field.
fn lean_of_bend(bend: vec3<f32>) -> vec2<f32> {
    return bend.yz * (bend.x / max(length(bend.yz), 1e-10));
}

// Lean of the field at a position `secs` ago, given its newest state `now`.
fn earlier_lean(p: vec2<f32>, level: f32, now: vec3<f32>, kind: Kind, secs: f32) -> vec2<f32> {
    if frame.youngest_past < runtime_zero(p.x) {
        let speed = length(now.yz);
        if speed < 1e-6 {
            return vec2<f32>(0.0);
        }
        let direction = now.yz / speed;
        let reached_m = (kind.bend_m_per_s + kind.bend_m_per_rad * speed) * min(secs, 0.25 * TAU / speed);
        return direction * bend_at(p + direction * reached_m, level, 0).x;
    }
    // Earlier states of the field: the youngest is in layer `youngest_past`, each older one in the layer below, cyclically.
    var lean = lean_of_bend(now);
    var younger_secs = 0.0;
    for (var i = 0; i < PASTS && younger_secs < secs; i++) {
        let age_secs = frame.past_ages_secs[i];
        let older = lean_of_bend(bend_at(p, level, 1 + (i32(frame.youngest_past) + PASTS - 1 - i) % PASTS));
        lean = mix(lean, older, clamp((secs - younger_secs) / max(age_secs - younger_secs, 1e-6), 0.0, 1.0));
        younger_secs = age_secs;
    }
    return lean;
}

// Lean of a segment that lags the lowest by `secs`, or by less while the grass recovers. Twin of `Lag::lean_rad` in shared/src/lod/lag.rs.
fn trailing_lean(p: vec2<f32>, level: f32, now: vec3<f32>, kind: Kind, secs: f32) -> vec2<f32> {
    let lean = lean_of_bend(now);
    if secs <= 0.0 {
        return lean;
    }
    var then = lean;
    var back_secs = secs;
    for (var i = 0; i < 2; i++) {
        then = earlier_lean(p, level, now, kind, back_secs);
        if dot(then, then) <= dot(lean, lean) {
            break;
        }
        back_secs = secs * kind.rising_lag;
    }
    return then;
}

// Weight of the bend field at a position: it fades to 0 where the atlas ends.
fn field_fraction(p: vec2<f32>) -> f32 {
    let from_eye = abs(p - frame.eye_m.xz);
    return 1.0 - smoothstep(0.8, 1.0, max(from_eye.x, from_eye.y) / frame.bend_reach_m);
}

// Lean (rad) of the repeated patch at a position where the bend field counts by `fraction`.
fn far_lean(p: vec2<f32>, level: f32, fraction: f32) -> vec2<f32> {
    return repeated_lean(p, level, textureDimensions(bends).x, fraction);
}

// Lean (rad) of the bend field and the repeated patch at a position: the deviation of the grass from its pose in the wind alone.
fn lean_of_field(p: vec2<f32>, level: f32) -> vec2<f32> {
    let fraction = field_fraction(p);
    let far = far_lean(p, level, fraction);
    if fraction <= 0.0 {
        return far;
    }
    return lean_of_bend(bend_at(p, level, 0)) * fraction + far;
}

// Lean (rad) of a plant at `ground` in a wind over the ground (m/s), for a plant that a wind of 10 m/s bends by `bend_rad`.
fn lean_in(ground: vec3<f32>, level: f32, wind: vec2<f32>, bend_rad: f32) -> vec2<f32> {
    return lean_of_field(ground.xz, level) + lean_of_wind(wind, bend_rad);
}

// Mip level of the bend atlas at a distance; the last one is used beyond its end.
fn field_level(distance_m: f32) -> f32 {
    return max(log2(distance_m * frame.pixel_rad * 4.0 * 6.0), 0.0);
}
