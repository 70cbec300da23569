// Single plants as they are drawn.

// A blade or flower stem to be drawn.
struct Blade {
    // Root (m).
    root_m: vec3<f32>,
    // Width at the root (m); of a flower head, enlargement over its true size.
    width: f32,
    // Offset of the first control point from the root (m).
    low_m: vec3<f32>,
    // Angle of the side of the strip (rad).
    side_rad: f32,
    // Offset of the second control point (m).
    middle_m: vec3<f32>,
    // Index of its kind, plus its hue 0..1 as a fraction; of a flower head, kind of its petals as a fraction 0..1.
    kind_and_hue: f32,
    // Offset of the tip (m).
    tip_m: vec3<f32>,
    // Fraction of unshadowed sunlight.
    sunlight: f32,
    // Colour of the grass around it as seen from afar; fraction of that colour that shows at its root.
    about: vec4<f32>,
    // Colour variation there, from `drift_at`.
    drift: vec2<f32>,
    // X and Z of the normal of the land.
    slope: vec2<f32>,
    // In-scattered light and transmittance of the air in front of it.
    air: vec4<f32>,
}
