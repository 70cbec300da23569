//! Shading of a blade of grass among others: a thin cylinder with normals all around it. Twins: `land_and_sky/grass_light.wgsl`.

/// Extinction coefficient of leaves with uniformly distributed orientation, per leaf area (Ross 1981).
pub const LEAF_EXTINCTION: f32 = 0.5;

/// Minimum sine of the sun's elevation in grass, so that a sun at the horizon still lights the tips.
pub const LEAST_SUN_SINE: f32 = 0.12;

/// Cosine between the direction to a light and the nearest of a blade's normals, given the cosine between that direction and the blade's tangent:
/// Bakay §3.3.1, the length of `N_l = L − (T·L) T`.
pub fn diffuse(along: f32) -> f32 {
    (1.0 - along * along).max(0.0).sqrt()
}

/// Fraction of a lamp's light that reaches a relative height in the grass: Bakay §3.3.3, `S = D/D_max · (1 − S_min) + S_min`.
pub fn self_shadow(height_fraction: f32, least: f32) -> f32 {
    height_fraction.clamp(0.0, 1.0) * (1.0 - least) + least
}

/// Fraction of sunlight that reaches a depth in the grass without meeting a leaf, by the Beer–Lambert law: `exp(−0.5 · LAI · depth /
/// sin(elevation))`, with the leaf area index `LAI` and the depth relative to the grass's height.
pub fn sun_through_leaves(leaf_area_index: f32, depth_fraction: f32, sine_of_elevation: f32) -> f32 {
    (-LEAF_EXTINCTION * leaf_area_index * depth_fraction.max(0.0) / sine_of_elevation.max(LEAST_SUN_SINE)).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
        (0..3).map(|i| a[i] * b[i]).sum()
    }

    /// The same with vectors, as in the source: projects the light on the disc of normals and takes the cosine between the two.
    #[test]
    fn diffuse_is_the_cosine_to_the_projected_normal() {
        let tangent = [0.6, 0.8, 0.0];
        for light in [[0.0, 1.0, 0.0], [0.48, 0.6, 0.64], [-0.8, 0.6, 0.0], [0.0, 0.0, 1.0]] {
            let along = dot(tangent, light);
            let projected: [f32; 3] = std::array::from_fn(|i| light[i] - along * tangent[i]);
            let length = dot(projected, projected).sqrt();
            let cosine = dot(projected, light) / length;
            assert!((diffuse(along) - cosine).abs() < 1e-6);
        }
        assert_eq!(diffuse(1.0), 0.0);
    }

    /// Highlight of a blade, given the cosine between its tangent and the half-way vector: Bakay §3.3.2, the length of `N_h = H − (T·H) T` to a power.
    fn specular(along: f32, exponent: f32) -> f32 {
        diffuse(along).powf(exponent)
    }

    #[test]
    fn a_highlight_lies_across_the_blade_and_is_narrow() {
        assert_eq!(specular(0.0, 40.0), 1.0);
        // 10° off: cos(10°)^40.
        assert!((specular(10_f32.to_radians().sin(), 40.0) - 0.5421).abs() < 2e-4);
    }

    #[test]
    fn grass_shades_itself_from_its_top_down() {
        assert_eq!([0.0, 0.5, 1.0, 2.0].map(|height| self_shadow(height, 0.2)), [0.2, 0.6, 1.0, 1.0]);
        // Half the leaves of an index of 3 above, sun overhead: e^−0.75.
        assert!((sun_through_leaves(3.0, 0.5, 1.0) - 0.472367).abs() < 1e-6);
        assert!((sun_through_leaves(3.0, 0.5, 0.5) - 0.223130).abs() < 1e-6);
    }
}
