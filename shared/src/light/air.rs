//! Atmosphere: scattering and absorption of light.
//!
//! The planet is a sphere; the density of the air depends on height only. Light is followed at four wavelengths, of which [`rgb`] makes colours. With
//! three, one for each primary, twilight is lilac: red at 680 nm passes the ozone that absorbs most of what an eye sees as red.

/// Wavelengths at which light is followed (nm).
pub const WAVELENGTHS_NM: [f64; WAVELENGTHS] = [630.0, 570.0, 510.0, 445.0];
const WAVELENGTHS: usize = 4;

/// A quantity at each of [`WAVELENGTHS_NM`].
pub type Spectrum = [f64; WAVELENGTHS];

/// Radius of the ground (m).
pub const GROUND_M: f64 = 6_360_000.0;
/// Radius of the top of the atmosphere (m).
pub const TOP_M: f64 = 6_460_000.0;
/// Rayleigh scattering by molecules at sea level (1/m): an optical depth of 0.0973 at 550 nm that varies with the wavelength to the power of −4.08, a fit to
/// Bodhaine et al. 1999. Below it, the height over which it falls to 1/e (m).
const RAYLEIGH_PER_M: Spectrum = [6.989e-6, 10.513e-6, 16.551e-6, 28.866e-6];
const RAYLEIGH_HEIGHT_M: f64 = 8000.0;
/// Vertical optical depth of haze at 550 nm: clean country air; 0.02 is a mountain top, 0.4 a hazy summer day.
const HAZE_DEPTH: f64 = 0.075;
const HAZE_HEIGHT_M: f64 = 1200.0;
/// Haze relative to 550 nm, with an Ångström exponent of 1.2.
const HAZE_COLOUR: Spectrum = [0.8496, 0.9580, 1.0948, 1.2894];
/// Single-scattering albedo of haze.
const HAZE_ALBEDO: f64 = 0.93;
/// Absorption by ozone at its densest, 25 km up (1/m); zero 15 km above and below (Hillaire 2020, Table 1). A column of 300 Dobson units with the cross-sections
/// of Serdyuchenko et al. 2014.
const OZONE_PER_M: Spectrum = [1.865e-6, 2.401e-6, 0.820e-6, 0.083e-6];

/// Linear RGB of light that has these fractions of sunlight, as [`rgb`] makes it, row by row.
///
/// Least squares over 3000 spectra of sunlight that has passed air, haze and ozone of up to 30, 30 and 60 vertical thicknesses and may have been scattered once:
/// their colours by the CIE 1931 observer (Wyman et al. 2013) differ by 0.6 % of the brightest channel (rms), at most by some 5 %.
const RGB_OF_SPECTRUM: [Spectrum; 3] =
    [[0.7860, 0.6028, -0.4757, 0.0869], [-0.0394, 0.5441, 0.6060, -0.1107], [-0.0211, -0.0841, 0.1293, 0.9759]];

/// Linear RGB (Rec. 709) of light that has these fractions of sunlight at the four wavelengths, relative to sunlight above the atmosphere, which is white. A
/// colour outside the gamut is moved to its border.
pub fn rgb(fractions: Spectrum) -> [f64; 3] {
    RGB_OF_SPECTRUM.map(|row| row.iter().zip(fractions).map(|(weight, fraction)| weight * fraction).sum::<f64>().max(0.0))
}

/// Optical properties of the air at a height, per metre.
#[derive(Clone, Copy, Debug)]
pub struct Density {
    /// Scattering by molecules (1/m).
    pub rayleigh: Spectrum,
    /// Scattering by haze (1/m).
    pub haze: Spectrum,
    /// Total scattering and absorption (1/m).
    pub extinction: Spectrum,
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
pub fn optical_depth(height_m: f64, up: f64) -> Spectrum {
    depth_of(height_m, up, |density| density.extinction)
}

/// The part of the optical depth that `of` selects.
fn depth_of(height_m: f64, up: f64, of: impl Fn(Density) -> Spectrum) -> Spectrum {
    const STEPS: u32 = 64;
    let length_m = to_sphere_m(height_m, up, TOP_M);
    let mut depth = Spectrum::default();
    for step in 0..STEPS {
        // Steps grow with distance, since the air is densest at the start.
        let [near, far] = [step, step + 1].map(|n| (f64::from(n) / f64::from(STEPS)).powi(2) * length_m);
        let part = of(Density::at(height_along_m(height_m, up, 0.5 * (near + far))));
        depth.iter_mut().zip(part).for_each(|(depth, part)| *depth += part * (far - near));
    }
    depth
}

/// Transmittance of sunlight to a height, from a sun with this sine of elevation; 0 from below the horizon, and partial while the disc, half a degree
/// wide, sets.
pub fn transmittance(height_m: f64, up: f64) -> Spectrum {
    const DISC_RAD: f64 = 0.009_3;
    let above = up - horizon(height_m);
    let shown = (above / DISC_RAD + 0.5).clamp(0.0, 1.0);
    let depth = optical_depth(height_m, up.max(horizon(height_m)));
    depth.map(|depth| shown * (-depth).exp())
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

    /// In blue, where molecules scatter most, the integral along the ray follows the air mass: to 1 % above 10° of elevation, to 3 % at 5°. At 2°,
    /// where low haze counts more (all of it is 6.2 % deeper), molecules alone follow it to 6 %.
    #[test]
    fn optical_depth_grows_with_the_air_mass() {
        let molecules = |density: Density| density.rayleigh;
        let all = |density: Density| density.extinction;
        let assert_follows = |of: fn(Density) -> Spectrum, elevation_deg: f64, bound: f64| {
            let elevation_rad = elevation_deg.to_radians();
            let found = depth_of(0.0, elevation_rad.sin(), of)[3] / depth_of(0.0, 1.0, of)[3];
            let mass = air_mass(elevation_rad);
            assert!((found / mass - 1.0).abs() < bound, "{found} instead of {mass} at {elevation_deg}°");
        };
        for (elevation_deg, bound) in [(60.0, 0.005), (30.0, 0.005), (10.0, 0.01), (5.0, 0.03)] {
            assert_follows(all, elevation_deg, bound);
            assert_follows(molecules, elevation_deg, bound);
        }
        assert_follows(molecules, 2.0, 0.06);
    }

    /// Molecules: 0.0973 at 550 nm (Bodhaine et al. 1999). Ozone: a column of 300 Dobson units with cross-sections of 3.47, 4.47, 1.53 and 0.154 · 10⁻²¹ cm².
    #[test]
    fn clear_air_is_as_deep_as_measured() {
        let (depth, ozone) = (optical_depth(0.0, 1.0), [0.0280, 0.0360, 0.0123, 0.0012]);
        for (i, nm) in WAVELENGTHS_NM.into_iter().enumerate() {
            let wanted = 0.0973 * (550.0 / nm).powf(4.08) + HAZE_DEPTH * (nm / 550.0).powf(-1.2) + ozone[i];
            assert!((depth[i] / wanted - 1.0).abs() < 0.01, "{} instead of {wanted} at {nm} nm", depth[i]);
        }
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

    /// Linear RGB by the CIE 1931 observer, in the approximation of Wyman et al. 2013, relative to the sun, a black body at 5778 K.
    fn observed(fraction: impl Fn(f64) -> f64) -> [f64; 3] {
        let lobe = |nm: f64, height: f64, peak: f64, [below, above]: [f64; 2]| {
            let off = (nm - peak) * if nm < peak { below } else { above };
            height * (-0.5 * off * off).exp()
        };
        let (mut seen, mut white) = ([0.0; 3], [0.0; 3]);
        for nm in (380..=780).step_by(5).map(f64::from) {
            let x = lobe(nm, 1.056, 599.8, [0.0264, 0.0323])
                + lobe(nm, 0.362, 442.0, [0.0624, 0.0374])
                + lobe(nm, -0.065, 501.1, [0.0490, 0.0382]);
            let y = lobe(nm, 0.821, 568.8, [0.0213, 0.0247]) + lobe(nm, 0.286, 530.9, [0.0613, 0.0322]);
            let z = lobe(nm, 1.217, 437.0, [0.0845, 0.0278]) + lobe(nm, 0.681, 459.0, [0.0385, 0.0725]);
            let sun = nm.powi(-5) / ((1.4388e7 / (nm * 5778.0)).exp() - 1.0);
            let primaries = [[3.2406, -1.5372, -0.4986], [-0.9689, 1.8758, 0.0415], [0.0557, -0.2040, 1.0570]];
            for (i, [of_x, of_y, of_z]) in primaries.into_iter().enumerate() {
                let light = sun * (of_x * x + of_y * y + of_z * z);
                white[i] += light;
                seen[i] += light * fraction(nm);
            }
        }
        std::array::from_fn(|i| (seen[i] / white[i]).max(0.0))
    }

    /// Largest difference of a channel from what an eye sees of sunlight after some vertical thicknesses of clear air and of ozone, scattered once or not, relative
    /// to the brightest channel; `by` makes a colour of the fractions of sunlight at wavelengths.
    fn colour_error([air, ozone]: [f64; 2], is_scattered: bool, by: impl Fn(&dyn Fn(f64) -> f64) -> [f64; 3]) -> f64 {
        // Cross-sections of ozone relative to that at 570 nm, by wavelength.
        let table = [
            (380.0, 0.0),
            (430.0, 0.02),
            (445.0, 0.035),
            (480.0, 0.16),
            (510.0, 0.34),
            (540.0, 0.65),
            (570.0, 1.0),
            (602.0, 1.13),
            (630.0, 0.777),
            (680.0, 0.30),
            (780.0, 0.04),
        ];
        let absorbed = |nm: f64| {
            let after = table.iter().position(|(at, _)| *at >= nm).unwrap_or(table.len() - 1).max(1);
            let [(a, low), (b, high)] = [table[after - 1], table[after]];
            low + (high - low) * (nm - a) / (b - a)
        };
        let fraction = |nm: f64| {
            let scattered = if is_scattered { (550.0 / nm).powf(4.08) } else { 1.0 };
            scattered * (-air * 0.0973 * (550.0 / nm).powf(4.08) - ozone * 0.036 * absorbed(nm)).exp()
        };
        let (found, wanted) = (by(&fraction), observed(fraction));
        let brightest = wanted.into_iter().fold(0.0, f64::max);
        (0..3).map(|i| (found[i] - wanted[i]).abs() / brightest).fold(0.0, f64::max)
    }

    /// Colours of the sun high and low, of the sky at noon and at dusk: within 5 % of the brightest channel. One wavelength for each primary is off by 40 % at
    /// dusk.
    #[test]
    fn four_wavelengths_have_the_colours_that_an_eye_sees() {
        for (thicknesses, is_scattered) in [
            ([1.0, 1.0], false),
            ([5.0, 5.0], false),
            ([20.0, 20.0], false),
            ([0.5, 0.5], true),
            ([3.0, 20.0], true),
            ([3.0, 35.0], true),
            ([8.0, 60.0], true),
        ] {
            let error = colour_error(thicknesses, is_scattered, |fraction| rgb(WAVELENGTHS_NM.map(fraction)));
            assert!(error < 0.05, "{error} after {thicknesses:?}");
        }
        let by_three = colour_error([8.0, 60.0], true, |fraction| [680.0, 550.0, 440.0].map(fraction));
        assert!(by_three > 0.3, "{by_three}");
    }
}
