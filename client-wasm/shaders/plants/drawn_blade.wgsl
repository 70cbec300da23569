// Single plants as they are drawn.

// A blade or flower stem to be drawn.
struct Blade {
    // Root (m), width at the root (m).
    root: vec4<f32>,
    // Offsets of the control points from the root (m); w: angle of the side; index of its kind plus hue 0..1 as a fraction, or for a
    // flower the kind of its petals 0..1; light 0..1.
    points: array<vec4<f32>, 3>,
    // Colour of the grass around it as seen from afar; how much of that shows at its root.
    about: vec4<f32>,
    // Colour variation there, from `drift_at`; slope of the land, X and Z of its normal.
    place: vec4<f32>,
    // In-scattered light and transmittance of the air in front of it.
    air: vec4<f32>,
}
