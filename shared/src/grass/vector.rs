//! Vectors on the ground, along X and Z.

/// Length of a vector.
pub fn length([x, z]: [f32; 2]) -> f32 {
    (x * x + z * z).sqrt()
}

/// The unit vector along `v`, or `None` when `v` is too short to have a direction.
pub fn unit(v: [f32; 2]) -> Option<[f32; 2]> {
    let length = length(v);
    (length > 1e-6).then(|| v.map(|c| c / length))
}

/// Sum of two vectors.
pub fn sum([ax, az]: [f32; 2], [bx, bz]: [f32; 2]) -> [f32; 2] {
    [ax + bx, az + bz]
}

/// Square of the distance between two points.
pub fn squared_distance(a: [f32; 2], b: [f32; 2]) -> f32 {
    let [x, z] = [a[0] - b[0], a[1] - b[1]];
    x * x + z * z
}
