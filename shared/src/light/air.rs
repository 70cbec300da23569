//! Atmosphere: scattering and absorption of light.
//!
//! The planet is a sphere; the density of the air depends on height only. Red, green and blue stand for 680, 550 and 440 nm; the coefficients of
//! molecules and ozone are those of Hillaire 2020, Table 1.

use super::Rgb;

/// Radius of the ground (m).
pub const GROUND_M: f64 = 6_360_000.0;
/// Radius of the top of the atmosphere (m).
pub const TOP_M: f64 = 6_460_000.0;
/// Rayleigh scattering by molecules at sea level (1/m), and the height over which it falls to 1/e (m).
const RAYLEIGH_PER_M: [f64; 3] = [5.802e-6, 13.558e-6, 33.1e-6];
const RAYLEIGH_HEIGHT_M: f64 = 8000.0;
/// Vertical optical depth of haze at 550 nm: clean country air; 0.02 is a mountain top, 0.4 a hazy summer day.
const HAZE_DEPTH: f64 = 0.075;
const HAZE_HEIGHT_M: f64 = 1200.0;
/// Haze at the three wavelengths relative to 550 nm, with an Ångström exponent of 1.2.
const HAZE_COLOUR: [f64; 3] = [0.775, 1.0, 1.307];
/// Single-scattering albedo of haze.
const HAZE_ALBEDO: f64 = 0.93;
/// Absorption by ozone at its densest, 25 km up (1/m); zero 15 km above and below.
const OZONE_PER_M: [f64; 3] = [0.650e-6, 1.881e-6, 0.085e-6];

/// Optical properties of the air at a height, per metre.
#[derive(Clone, Copy, Debug)]
pub struct Density {
    /// Scattering by molecules (1/m).
    pub rayleigh: [f64; 3],
    /// Scattering by haze (1/m).
    pub haze: [f64; 3],
    /// Total scattering and absorption (1/m).
    pub extinction: [f64; 3],
}

impl Density {
    /// Properties at a height above sea level (m).
    pub fn at(height_m: f64) -> Self {
        let molecules = (-height_m / RAYLEIGH_HEIGHT_M).exp();
        let haze = HAZE_DEPTH / HAZE_HEIGHT_M * (-height_m / HAZE_HEIGHT_M).exp();
        let ozone = (1.0 - (height_m - 25_000.0).abs() / 15_000.0).max(0.0);
        let rayleigh = RAYLEIGH_PER_M.map(|scattered| scattered * molecules);
        let scattered = HAZE_COLOUR.map(|colour| colour * haze * HAZE_ALBEDO);
        let extinction = std::array::from_fn(|i| rayleigh[i] + scattered[i] / HAZE_ALBEDO + OZONE_PER_M[i] * ozone);
        Self { rayleigh, haze: scattered, extinction }
    }
}

/// Phase function of molecules (1/sr) at the cosine of a scattering angle.
pub fn rayleigh_phase(cosine: f64) -> f64 {
    3.0 / (16.0 * std::f64::consts::PI) * (1.0 + cosine * cosine)
}

/// Phase function of haze (Henyey & Greenstein 1941); twin: `haze_phase` in `land_and_sky/sky_light.wgsl`.
pub fn haze_phase(cosine: f32) -> f32 {
    let g = HAZE_FORWARD;
    (1.0 - g * g) / (4.0 * std::f32::consts::PI * (1.0 + g * g - 2.0 * g * cosine).powf(1.5))
}

/// Asymmetry of haze: mean cosine of its scattering angle.
pub const HAZE_FORWARD: f32 = 0.76;

/// Height after `distance_m` along a ray (m).
pub(super) fn height_along_m(height_m: f64, up: f64, distance_m: f64) -> f64 {
    let radius = GROUND_M + height_m;
    (radius * radius + distance_m * distance_m + 2.0 * radius * up * distance_m).sqrt() - GROUND_M
}

/// Distance along a ray to the point where it leaves a sphere about the ground's centre (m).
pub(super) fn to_sphere_m(height_m: f64, up: f64, sphere_m: f64) -> f64 {
    let radius = GROUND_M + height_m;
    let under_root = radius * radius * (up * up - 1.0) + sphere_m * sphere_m;
    -radius * up + under_root.max(0.0).sqrt()
}

/// Cosine of the zenith angle below which rays from a height meet the ground.
pub(super) fn horizon(height_m: f64) -> f64 {
    let fraction = GROUND_M / (GROUND_M + height_m);
    -(1.0 - fraction * fraction).max(0.0).sqrt()
}

/// Optical depth from a height to the top of the atmosphere, along a ray at this cosine of the zenith angle that does not meet the ground.
pub fn optical_depth(height_m: f64, up: f64) -> [f64; 3] {
    const STEPS: u32 = 64;
    let length_m = to_sphere_m(height_m, up, TOP_M);
    let mut depth = [0.0; 3];
    for step in 0..STEPS {
        // Steps grow with distance, since the air is densest at the start.
        let [near, far] = [step, step + 1].map(|n| (f64::from(n) / f64::from(STEPS)).powi(2) * length_m);
        let extinction = Density::at(height_along_m(height_m, up, 0.5 * (near + far))).extinction;
        (0..3).for_each(|i| depth[i] += extinction[i] * (far - near));
    }
    depth
}

/// Transmittance of sunlight to a height, from a sun with this sine of elevation; 0 from below the horizon, and partial while the disc, half a degree
/// wide, sets.
pub fn transmittance(height_m: f64, up: f64) -> Rgb {
    const DISC_RAD: f64 = 0.009_3;
    let above = up - horizon(height_m);
    let shown = (above / DISC_RAD + 0.5).clamp(0.0, 1.0);
    let depth = optical_depth(height_m, up.max(horizon(height_m)));
    depth.map(|depth| (shown * (-depth).exp()) as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative optical air mass for an elevation of 0 to 90° (Kasten & Young 1989).
    fn air_mass(elevation_rad: f64) -> f64 {
        1.0 / (elevation_rad.sin() + 0.50572 * (elevation_rad.to_degrees() + 6.07995).powf(-1.6364))
    }

    /// Table values of Kasten & Young 1989.
    #[test]
    fn air_mass_is_as_tabled() {
        for (elevation_deg, tabled) in
            [(90.0, 1.0), (60.0, 1.154), (30.0, 1.994), (20.0, 2.904), (10.0, 5.586), (5.0, 10.306), (0.0, 37.92)]
        {
            let found = air_mass(f64::to_radians(elevation_deg));
            assert!((found / tabled - 1.0).abs() < 0.003, "{found} instead of {tabled} at {elevation_deg}°");
        }
    }

    /// In blue, where molecules scatter most, the integral along the ray follows the air mass: to 1 % above 10° of elevation, to 6 % at 2°.
    #[test]
    fn optical_depth_grows_with_the_air_mass() {
        let straight = optical_depth(0.0, 1.0)[2];
        for (elevation_deg, bound) in [(60.0, 0.005), (30.0, 0.005), (10.0, 0.01), (5.0, 0.03), (2.0, 0.06)] {
            let elevation_rad = f64::to_radians(elevation_deg);
            let found = optical_depth(0.0, elevation_rad.sin())[2] / straight;
            let mass = air_mass(elevation_rad);
            assert!((found / mass - 1.0).abs() < bound, "{found} instead of {mass} at {elevation_deg}°");
        }
    }

    /// Bodhaine et al. 1999: 0.0973 at 550 nm and 0.2430 at 440 nm; ozone of this column absorbs 0.028 at 550 nm.
    #[test]
    fn clear_air_is_as_deep_as_measured() {
        let [_, green, blue] = optical_depth(0.0, 1.0);
        let haze = |i: usize| HAZE_DEPTH * HAZE_COLOUR[i];
        assert!((green - haze(1) - 0.028 - 0.0973).abs() < 0.015, "{green}");
        assert!((blue - haze(2) - 0.243).abs() < 0.03, "{blue}");
    }

    #[test]
    fn phases_scatter_all_of_the_light_and_no_more() {
        let (mut molecules, mut haze) = (0.0, 0.0);
        const STEPS: i32 = 2000;
        for step in 0..STEPS {
            let cosine = (f64::from(step) + 0.5) / f64::from(STEPS) * 2.0 - 1.0;
            let ring = std::f64::consts::TAU * 2.0 / f64::from(STEPS);
            molecules += rayleigh_phase(cosine) * ring;
            haze += f64::from(haze_phase(cosine as f32)) * ring;
        }
        assert!((molecules - 1.0).abs() < 1e-4 && (haze - 1.0).abs() < 1e-3, "{molecules}, {haze}");
    }
}
