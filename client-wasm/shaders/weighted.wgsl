// Blended without order, each fragment weighted by how near it is (McGuire & Bavoil, J. Comput. Graph. Tech. 2(2), 2013): what plants share of
// a pixel in sum, and what they leave of it.

struct Weighted {
    @location(0) sum: vec4<f32>,
    @location(1) hidden: f32,
}

// A fragment of opacity `alpha`, `distance_m` from the eye, a share `up` of its plant's length above the root: Eq. (7), and more the higher up, since in grass
// what is above hides what is below. Held below what sixteen bits bear of 50 such layers.
fn weighted(color: vec3<f32>, alpha: f32, distance_m: f32, up: f32) -> Weighted {
    let near = distance_m / 5.0;
    let far = distance_m / 200.0;
    let by_distance = clamp(10.0 / (1e-5 + near * near + pow(far, 6.0)), 1e-2, 300.0);
    let weight = alpha * by_distance * mix(0.02, 1.0, up * up);
    return Weighted(vec4<f32>(color * alpha, alpha) * weight, alpha);
}
