// Weighted blended order-independent transparency (McGuire & Bavoil 2013).

struct Weighted {
    @location(0) sum: vec4<f32>,
    @location(1) hidden: f32,
}

// Contribution of a fragment of opacity `alpha`, `distance_m` from the eye, at fraction `up` of its plant's height: the weight of Eq. (7), which falls with
// the third power of short distances instead of the second, since near leaves hide farther ones, and is greater higher up, since in grass the upper parts
// hide the lower, darker ones. Bounded so that 50 layers fit 16-bit floats.
fn weighted(color: vec3<f32>, alpha: f32, distance_m: f32, up: f32) -> Weighted {
    let near = distance_m / 5.0;
    let far = distance_m / 200.0;
    let by_distance = clamp(10.0 / (1e-5 + near * near * near + pow(far, 6.0)), 1e-2, 300.0);
    let weight = alpha * by_distance * mix(0.02, 1.0, up * up * up);
    return Weighted(vec4<f32>(color * alpha, alpha) * weight, alpha);
}
