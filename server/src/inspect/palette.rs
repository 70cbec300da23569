//! Colour ramps of bending angles and wind speeds, linear between stops.

/// sRGB, 0..=255.
pub(super) type Rgb = [u8; 3];

/// Colour of a bending angle (degrees, 0..=90): green when upright, straw when leaning, red when flat.
const BEND: [(f32, Rgb); 5] =
    [(0.0, [82, 116, 64]), (10.0, [136, 164, 76]), (30.0, [236, 214, 116]), (60.0, [232, 116, 44]), (90.0, [172, 24, 52])];

/// Colour of a wind speed (m/s).
const WIND: [(f32, Rgb); 4] = [(0.0, [70, 110, 190]), (4.0, [120, 190, 240]), (9.0, [245, 250, 255]), (16.0, [255, 110, 190])];

/// Colour of a bend, `degrees` from 0 (upright) to 90 (flat).
pub(super) fn bend_rgb(degrees: f32) -> Rgb {
    ramp(&BEND, degrees)
}

/// Colour of a wind speed (m/s).
pub(super) fn wind_rgb(m_per_s: f32) -> Rgb {
    ramp(&WIND, m_per_s)
}

fn ramp(stops: &[(f32, Rgb)], at: f32) -> Rgb {
    let above = stops.iter().position(|&(stop, _)| at < stop).unwrap_or(stops.len());
    if above == 0 || above == stops.len() {
        return stops[above.min(stops.len() - 1)].1;
    }
    let ((low, from), (high, to)) = (stops[above - 1], stops[above]);
    let fraction = (at - low) / (high - low);
    std::array::from_fn(|i| (f32::from(from[i]) + (f32::from(to[i]) - f32::from(from[i])) * fraction).round() as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ramp_passes_through_its_stops_and_is_constant_beyond_them() {
        for (stop, rgb) in BEND {
            assert_eq!(bend_rgb(stop), rgb);
        }
        assert_eq!(wind_rgb(-1.0), WIND[0].1);
        assert_eq!(wind_rgb(99.0), WIND[3].1);
        assert_eq!(ramp(&[(0.0, [0, 0, 0]), (2.0, [100, 200, 50])], 1.0), [50, 100, 25]);
    }
}
