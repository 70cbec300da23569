//! Exposure of a scene by an adapted eye.

/// Approximate reflectance of a meadow.
const REFLECTANCE: f32 = 0.18;

/// Key value of a mean luminance (cd/m²) by Krawczyk et al. 2005, Eq. (11): `1.03 − 2 / (2 + log10(L + 1))`. For a fully adapted eye it would be
/// constant; here dusk stays darker than day, and night darker still.
pub fn key(luminance_cd_per_m2: f32) -> f32 {
    1.03 - 2.0 / (2.0 + (luminance_cd_per_m2 + 1.0).log10())
}

/// Exposure (m²/cd) of an eye adapted to the mean of land and sky. `land_lx` is the mean illuminance (lx) of a horizontal surface and one that faces
/// the sun, `sky_lx` the sky's illuminance of a horizontal surface.
pub fn exposure(land_lx: f32, sky_lx: f32) -> f32 {
    let adapted = (0.5 * (land_lx * REFLECTANCE + sky_lx) / std::f32::consts::PI).max(1e-4);
    key(adapted) / adapted
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values read off Krawczyk et al. 2005, Fig. 1: 0.03 for the darkest night, about 0.5 at 100 cd/m², near 0.7 in daylight.
    #[test]
    fn the_key_rises_from_night_to_day() {
        for (luminance, value) in [(0.0, 0.03), (100.0, 0.531), (10_000.0, 0.697)] {
            assert!((key(luminance) - value).abs() < 0.002, "{} at {luminance} cd/m²", key(luminance));
        }
    }

    #[test]
    fn less_light_is_seen_darker_though_exposed_longer() {
        let levels = [0.01, 0.25, 3.4, 100.0, 1e4, 1e5_f32];
        for pair in levels.windows(2) {
            assert!(exposure(pair[0], pair[0]) > exposure(pair[1], pair[1]));
            assert!(exposure(pair[0], pair[0]) * pair[0] < exposure(pair[1], pair[1]) * pair[1]);
        }
    }
}
