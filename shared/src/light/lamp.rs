//! Lamps: point lights with attenuation.

/// Shortest distance in the attenuation of a lamp (m).
pub const LEAST_LAMP_DISTANCE_M: f32 = 0.1;

/// Attenuation, illuminance (lx) per luminous intensity (cd) at a distance (m): Bakay §3.3.4, the reciprocal of the sum of a constant, a linear (1/m)
/// and a quadratic (1/m²) term. [0, 0, 1] is the inverse-square law; distances below [`LEAST_LAMP_DISTANCE_M`] count as that.
pub fn attenuation([constant, linear, quadratic]: [f32; 3], distance_m: f32) -> f32 {
    let d = distance_m.max(LEAST_LAMP_DISTANCE_M);
    1.0 / (constant + linear * d + quadratic * d * d)
}

/// Distance at which a lamp's illuminance has fallen to `least_lx` (m); beyond it the lamp is not drawn.
pub fn reach_m(candela: f32, [constant, linear, quadratic]: [f32; 3], least_lx: f32) -> f32 {
    let missing = constant - candela / least_lx;
    let most_m = 1000.0;
    if missing >= 0.0 {
        return 0.0;
    }
    let reach = if quadratic > 0.0 {
        // The positive root of q d² + l d + (c − I/E), in the form without cancellation where l is large.
        -2.0 * missing / (linear + (linear * linear - 4.0 * quadratic * missing).sqrt())
    } else if linear > 0.0 {
        -missing / linear
    } else {
        most_m
    };
    reach.min(most_m)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn falls_off_with_the_inverse_square_or_as_the_weights_say() {
        for (weights, distance_m, fraction) in [
            ([0.0, 0.0, 1.0], 1.0, 1.0),
            ([0.0, 0.0, 1.0], 5.0, 0.04),
            ([0.0, 0.0, 1.0], 0.0, 100.0),
            ([1.0, 0.0, 0.0], 70.0, 1.0),
            ([1.0, 0.5, 0.25], 4.0, 1.0 / 7.0),
        ] {
            assert!((attenuation(weights, distance_m) - fraction).abs() < 1e-5 * fraction, "{weights:?} at {distance_m} m");
        }
    }

    #[test]
    fn reaches_to_where_the_least_light_is_left() {
        for weights in [[0.0, 0.0, 1.0], [1.0, 0.5, 0.25], [0.5, 2.0, 0.0]] {
            let reach = reach_m(400.0, weights, 0.5);
            assert!((400.0 * attenuation(weights, reach) - 0.5).abs() < 1e-3, "{weights:?}: {reach} m");
        }
        assert_eq!(reach_m(400.0, [1.0, 0.0, 0.0], 0.5), 1000.0);
        assert_eq!(reach_m(0.2, [1.0, 0.0, 1.0], 0.5), 0.0);
    }
}
