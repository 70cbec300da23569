// Colours of plants.

import package::inputs::noise::noise;

// Factor on the colour of grass for a tilt (rad): trodden grass shows its pale undersides. Under the floor of a car it leans by about 1 rad, under wheels it lies.
fn trodden(tilt: f32) -> vec3<f32> {
    return mix(vec3<f32>(1.0), vec3<f32>(1.85, 1.70, 2.1), smoothstep(0.85, 1.50, tilt));
}

// Colour of a plant at a fraction `up` of its height, between its colours at the root and at the tip; hue 0..1 runs from fresh to dry.
fn plant_color(root_rgb: vec3<f32>, tip_rgb: vec3<f32>, up: f32, hue: f32) -> vec3<f32> {
    let own = mix(vec3<f32>(0.82, 0.98, 0.80), vec3<f32>(1.16, 1.04, 0.86), hue);
    return mix(root_rgb, tip_rgb, up * 0.85 + up * up * 0.15) * own;
}

// Variation of colour over the land: how lush, and how dry and reddish it is.
fn drift_at(p: vec2<f32>) -> vec2<f32> {
    let broad = noise(p / 97.0).r;
    let middle = noise(p / 31.0).a;
    let fine = noise(p / 6.3).g;
    return vec2<f32>(fine, smoothstep(0.40, 0.72, broad * 0.5 + middle * 0.35 + fine * 0.15));
}

// Factor on the colours of grass for that variation.
fn tint_of(drift: vec2<f32>) -> vec3<f32> {
    let lush = mix(vec3<f32>(0.66, 0.84, 0.72), vec3<f32>(0.84, 0.93, 0.84), drift.x);
    return mix(lush, vec3<f32>(1.28, 1.04, 1.12), drift.y * 0.85);
}

fn grass_tint(p: vec2<f32>) -> vec3<f32> {
    return tint_of(drift_at(p));
}
