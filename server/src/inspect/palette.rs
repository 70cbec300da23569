//! Colours of bends and speeds: ramps that are linear between stops.

/// sRGB, 0..=255.
pub(super) type Rgb = [u8; 3];

/// Colour of a bending angle (degrees, 0..=90): green while upright, straw as it leans, red when it lies.
const BEND: [(f32, Rgb); 5] =
    [(0.0, [52, 88, 48]), (12.0, [104, 140, 62]), (35.0, [230, 208, 110]), (62.0, [232, 120, 48]), (90.0, [172, 24, 52])];

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
    let share = (at - low) / (high - low);
    std::array::from_fn(|i| (f32::from(from[i]) + (f32::from(to[i]) - f32::from(from[i])) * share).round() as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ramp_meets_its_stops_and_holds_beyond_them() {
        for (stop, rgb) in BEND {
            assert_eq!(bend_rgb(stop), rgb);
        }
        assert_eq!(wind_rgb(-1.0), WIND[0].1);
        assert_eq!(wind_rgb(99.0), WIND[3].1);
        assert_eq!(ramp(&[(0.0, [0, 0, 0]), (2.0, [100, 200, 50])], 1.0), [50, 100, 25]);
    }
}
