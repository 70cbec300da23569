//! Colour ramps of bending angles and wind speeds, linear between stops.

/// sRGB, 0..=255.
pub(super) type Rgb = [u8; 3];

/// Colour of a bending angle (degrees, 0..=90): cividis of Nuñez et al. 2018, from dark blue (upright) to yellow (flat). It looks alike with any colour
/// vision, and its lightness rises evenly, so that it also reads in grey.
const BEND: [(f32, Rgb); 11] = [
    (0.0, [0, 34, 78]),
    (5.0, [0, 44, 102]),
    (10.0, [18, 53, 112]),
    (20.0, [59, 73, 108]),
    (30.0, [87, 93, 109]),
    (40.0, [112, 113, 115]),
    (50.0, [138, 134, 120]),
    (60.0, [165, 156, 116]),
    (70.0, [195, 179, 105]),
    (80.0, [225, 204, 85]),
    (90.0, [254, 232, 56]),
];

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

    /// Lightness L* of a colour in CIELAB, 0 (black) to 100 (white).
    fn lightness(rgb: Rgb) -> f32 {
        let linear = rgb.map(|code| {
            let value = f32::from(code) / 255.0;
            if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
        });
        let luminance = 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2];
        if luminance > 0.008_856 { 116.0 * luminance.cbrt() - 16.0 } else { 903.3 * luminance }
    }

    /// Lightness, on which colour-blind readers rely: a larger angle is lighter, and equal differences look equal.
    #[test]
    fn a_larger_bend_is_lighter() {
        let lightnesses: Vec<f32> = (0..=90).map(|degrees| lightness(bend_rgb(degrees as f32))).collect();
        let range = lightnesses[90] - lightnesses[0];
        assert!(range > 70.0, "the lightness spans only {range}");
        for (degrees, pair) in lightnesses.windows(2).enumerate() {
            let rise = (pair[1] - pair[0]) * 90.0 / range;
            assert!((0.5..1.7).contains(&rise), "from {degrees}° the lightness rises by {rise} of the mean");
        }
    }
}
