//! How brightly an eye sees a scene.

/// Share of light that a meadow throws back, about.
const REFLECTANCE: f32 = 0.18;

/// Brightness that the eye gives to the mean luminance (cd/m²) of what it sees, by G. Krawczyk, K. Myszkowski and H.-P. Seidel ("Perceptual
/// effects in real-time tone mapping", SCCG 2005, Eq. (11)): `1.03 − 2 / (2 + log10(L + 1))`. A fully adapted eye would give one value to all; this
/// one leaves dusk darker than day, and night darker still.
pub fn key(luminance_cd_per_m2: f32) -> f32 {
    1.03 - 2.0 / (2.0 + (luminance_cd_per_m2 + 1.0).log10())
}

/// Picture's brightness for each cd/m² (m²/cd), seen by an eye that has adapted to the mean of land and sky under so much light (lx): on the land, mean of
/// what lies level and of what stands up towards the sun, and from the sky on level ground.
pub fn exposure(land_lx: f32, sky_lx: f32) -> f32 {
    let adapted = (0.5 * (land_lx * REFLECTANCE + sky_lx) / std::f32::consts::PI).max(1e-4);
    key(adapted) / adapted
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values read off the paper's Fig. 1: 0.03 for the darkest night, about a half at 100 cd/m², near 0.7 in daylight.
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
