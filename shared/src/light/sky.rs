//! Sky: single scattering of sunlight in the air, and an approximation of multiple scattering.
//!
//! After Hillaire 2020: in-scattered light is integrated along rays through the air; multiply scattered light is treated as isotropic, `Ψ = L₂ / (1 −
//! f)` (Eqs 5 to 10).

use super::air::{self, Density, Spectrum};
use super::exposure::exposure;
use super::{Rgb, luminance};
use std::f64::consts::{PI, TAU};

/// Illuminance by the sun above the atmosphere (lx).
pub const SUN_LX: f32 = 128_000.0;
/// Luminance of the sky on a night with a full moon (cd/m²): 0.1 lx on the ground in total, the light of the moon included.
pub const NIGHT_CD_PER_M2: Rgb = [0.024, 0.031, 0.047];
/// Albedo of the land: grass, a little red and little blue.
pub const GROUND_ALBEDO: Rgb = [0.10, 0.13, 0.06];
/// The same at the wavelengths of [`air`](super::air).
const GROUND_SPECTRUM: Spectrum = [0.088, 0.134, 0.11, 0.06];
/// Height of the eye in the atmosphere model, and of the clouds that the sun lights (m).
const EYE_M: f64 = 300.0;
const CLOUDS_M: f64 = 6000.0;

/// Columns of the table of a sky, by heading from the sun.
pub const HEADINGS: usize = 32;
/// Rows of the table of a sky, by elevation.
pub const ELEVATIONS: usize = 40;

/// Tables of the atmosphere that do not depend on the position of the sun.
#[derive(Clone, Debug)]
pub struct Air {
    /// Transmittance of sunlight to a height (rows) from an elevation (columns).
    transmittance: Table,
    /// Multiply scattered light there, for a sun of illuminance 1 (1/sr).
    scattered: Table,
}

impl Default for Air {
    fn default() -> Self {
        Self::new()
    }
}

/// Spectra over the sine of the sun's elevation and the height in the atmosphere.
#[derive(Clone, Debug)]
struct Table {
    columns: usize,
    rows: usize,
    texels: Vec<Spectrum>,
}

/// Smallest sine of an elevation in the tables; a lower sun lights no air.
const LOWEST_UP: f64 = -0.25;

impl Table {
    fn new(columns: usize, rows: usize, of: impl Fn(f64, f64) -> Spectrum) -> Self {
        let texels = (0..columns * rows).map(|at| {
            let along = |n: usize, count: usize| n as f64 / (count - 1) as f64;
            // Denser near the horizon and near the ground, where colours change most.
            let x = along(at % columns, columns) * 2.0 - 1.0;
            let up = if x < 0.0 { -x * x * -LOWEST_UP } else { x * x };
            of(along(at / columns, rows).powi(2) * (air::TOP_M - air::GROUND_M), up)
        });
        Self { columns, rows, texels: texels.collect() }
    }

    fn at(&self, height_m: f64, up: f64) -> Spectrum {
        let x = if up < 0.0 { -(up / LOWEST_UP).min(1.0).sqrt() } else { up.min(1.0).sqrt() };
        let place = |fraction: f64, count: usize| {
            let at = fraction.clamp(0.0, 1.0) * (count - 1) as f64;
            let low = (at as usize).min(count - 2);
            (low, at - low as f64)
        };
        let (column, right) = place(0.5 + 0.5 * x, self.columns);
        let (row, above) = place((height_m / (air::TOP_M - air::GROUND_M)).max(0.0).sqrt(), self.rows);
        let texel = |c: usize, r: usize, i: usize| self.texels[(row + r) * self.columns + column + c][i];
        std::array::from_fn(|i| {
            let low = texel(0, 0, i) * (1.0 - right) + texel(1, 0, i) * right;
            let high = texel(0, 1, i) * (1.0 - right) + texel(1, 1, i) * right;
            low * (1.0 - above) + high * above
        })
    }
}

/// Marches along a ray in growing steps; passes `visit` the height, the distance, the air, and the integral of the transmittance over the step (m),
/// which is the light gained per unit of source. Returns the transmittance to the end.
fn march(height_m: f64, up: f64, length_m: f64, steps: u32, mut visit: impl FnMut(f64, f64, Density, Spectrum)) -> Spectrum {
    let mut left = Spectrum::default().map(|_| 1.0);
    for step in 0..steps {
        let [near, far] = [step, step + 1].map(|n| (f64::from(n) / f64::from(steps)).powi(2) * length_m);
        let middle = 0.5 * (near + far);
        let height = air::height_along_m(height_m, up, middle);
        let density = Density::at(height);
        let mut gain = Spectrum::default();
        for i in 0..gain.len() {
            let kept = (-density.extinction[i] * (far - near)).exp();
            gain[i] = left[i] * (1.0 - kept) / density.extinction[i].max(1e-12);
            left[i] *= kept;
        }
        visit(height, middle, density, gain);
    }
    left
}

impl Air {
    /// Computes the tables of the atmosphere (some 10 ms).
    pub fn new() -> Self {
        let transmittance = Table::new(96, 24, air::transmittance);
        let scattered = Table::new(32, 8, |height_m, up| scattered_often(&transmittance, height_m.clamp(10.0, 99_000.0), up));
        Self { transmittance, scattered }
    }

    /// Sunlight at a height above the sea on a surface that faces the sun: linear RGB (lx).
    fn sunlight_lx(&self, height_m: f64, up: f64) -> Rgb {
        lit(self.transmittance.at(height_m, up))
    }

    /// The sky over the eye with the sun at this elevation (some 2 ms).
    pub fn sky(&self, elevation_rad: f32) -> Sky {
        let sun_up = f64::from(elevation_rad).sin();
        let mut texels = Vec::with_capacity(HEADINGS * ELEVATIONS);
        for row in 0..ELEVATIONS {
            let up = (row as f64 / (ELEVATIONS - 1) as f64).powi(2);
            for column in 0..HEADINGS {
                let half = column as f64 / (HEADINGS - 1) as f64;
                texels.push(self.gathered(up, 1.0 - 2.0 * half * half, sun_up));
            }
        }
        let mut sky = Sky {
            elevation_rad,
            sun_lx: self.sunlight_lx(EYE_M, sun_up),
            cloud_sun_lx: self.sunlight_lx(CLOUDS_M, sun_up),
            texels,
            mean: [0.0; 3],
            up: [0.0; 3],
            toward_sun: [0.0; 3],
        };
        sky.gather();
        sky
    }

    /// Light gathered by a ray whose heading differs from the sun's by the angle with this cosine: scattering by molecules and multiple scattering,
    /// and haze without its phase function.
    fn gathered(&self, up: f64, heading_cosine: f64, sun_up: f64) -> [Rgb; 2] {
        let level = |up: f64| (1.0 - up * up).max(0.0).sqrt();
        let toward_sun = up * sun_up + level(up) * level(sun_up) * heading_cosine;
        let phase = air::rayleigh_phase(toward_sun);
        let length_m = air::to_sphere_m(EYE_M, up, air::TOP_M);
        let mut light = [Spectrum::default(); 2];
        march(EYE_M, up, length_m, 28, |height, middle, density, gain| {
            // The sun's elevation as seen from there, on a sphere.
            let sun_there = ((air::GROUND_M + EYE_M) * sun_up + middle * toward_sun) / (air::GROUND_M + height);
            let (sun, often) = (self.transmittance.at(height, sun_there), self.scattered.at(height, sun_there));
            for i in 0..gain.len() {
                let scattered = density.rayleigh[i] + density.haze[i];
                light[0][i] += gain[i] * (density.rayleigh[i] * phase * sun[i] + scattered * often[i]);
                light[1][i] += gain[i] * density.haze[i] * sun[i];
            }
        });
        light.map(lit)
    }
}

/// Colour of light with these fractions of sunlight: linear RGB, in the unit of [`SUN_LX`].
fn lit(fractions: Spectrum) -> Rgb {
    air::rgb(fractions).map(|channel| channel as f32 * SUN_LX)
}

/// Multiply scattered, isotropic light at a point of the atmosphere, for a sun of illuminance 1 (1/sr).
fn scattered_often(transmittance: &Table, height_m: f64, sun_up: f64) -> Spectrum {
    const DIRECTIONS: u32 = 48;
    let (mut second, mut passed_on) = (Spectrum::default(), Spectrum::default());
    for n in 0..DIRECTIONS {
        // Directions distributed evenly over the sphere, by the golden angle.
        let up = 1.0 - 2.0 * (f64::from(n) + 0.5) / f64::from(DIRECTIONS);
        let heading = f64::from(n) * 2.399_963;
        let toward_sun = up * sun_up + (1.0 - up * up).sqrt() * (1.0 - sun_up * sun_up).max(0.0).sqrt() * heading.cos();
        let meets_ground = up < air::horizon(height_m);
        let radius = air::GROUND_M + height_m;
        let length_m = if meets_ground {
            -radius * up - (radius * radius * (up * up - 1.0) + air::GROUND_M * air::GROUND_M).max(0.0).sqrt()
        } else {
            air::to_sphere_m(height_m, up, air::TOP_M)
        };
        let left = march(height_m, up, length_m, 16, |height, middle, density, gain| {
            let sun_there = (radius * sun_up + middle * toward_sun) / (air::GROUND_M + height);
            let sun = transmittance.at(height, sun_there);
            for i in 0..gain.len() {
                let scattered = gain[i] * (density.rayleigh[i] + density.haze[i]);
                second[i] += scattered * sun[i] / (4.0 * PI);
                passed_on[i] += scattered;
            }
        });
        if meets_ground {
            let sun_there = (radius * sun_up + length_m * toward_sun) / air::GROUND_M;
            let sun = transmittance.at(0.0, sun_there);
            (0..left.len()).for_each(|i| second[i] += left[i] * sun[i] * sun_there.max(0.0) * GROUND_SPECTRUM[i] / PI);
        }
    }
    let count = f64::from(DIRECTIONS);
    std::array::from_fn(|i| second[i] / count / (1.0 - passed_on[i] / count))
}

/// The sky for one elevation of the sun.
#[derive(Clone, Debug)]
pub struct Sky {
    /// Elevation of the sun (rad).
    pub elevation_rad: f32,
    /// Sunlight on a surface that faces the sun (lx).
    pub sun_lx: Rgb,
    /// The same at the height of clouds, which the sun lights after it has set on the ground.
    pub cloud_sun_lx: Rgb,
    /// Luminance (cd/m²) by elevation (rows: its sine is the square of the relative row) and heading from the sun (columns: the sine of its half);
    /// first the part scattered by molecules, second that of haze divided by its phase function.
    texels: Vec<[Rgb; 2]>,
    /// Irradiance over π: the mean over all normals (cd/m²).
    pub mean: Rgb,
    /// Increase for a normal straight up (cd/m²).
    pub up: Rgb,
    /// Increase for a horizontal normal towards the sun's heading (cd/m²).
    pub toward_sun: Rgb,
}

impl Sky {
    /// The table: rows of [`HEADINGS`] texels, lowest first; see [`Sky::luminance`]. Without night light.
    pub fn texels(&self) -> &[[Rgb; 2]] {
        &self.texels
    }

    /// Luminance at an elevation with this sine, in a heading that differs from the sun's by the angle with this cosine (cd/m²).
    pub fn luminance(&self, up: f32, heading_cosine: f32) -> Rgb {
        let place = |fraction: f32, count: usize| {
            let at = fraction.clamp(0.0, 1.0) * (count - 1) as f32;
            let low = (at as usize).min(count - 2);
            (low, at - low as f32)
        };
        let (column, right) = place((0.5 - 0.5 * heading_cosine).max(0.0).sqrt(), HEADINGS);
        let (row, above) = place(up.max(0.0).sqrt(), ELEVATIONS);
        let (sin, cos) = self.elevation_rad.sin_cos();
        let phase = air::haze_phase(up * sin + (1.0 - up * up).max(0.0).sqrt() * cos * heading_cosine);
        std::array::from_fn(|i| {
            let texel = |c: usize, r: usize| {
                let [molecules, haze] = self.texels[(row + r) * HEADINGS + column + c];
                molecules[i] + haze[i] * phase
            };
            let [low, high] = [0, 1].map(|r| texel(0, r) * (1.0 - right) + texel(1, r) * right);
            low * (1.0 - above) + high * above + NIGHT_CD_PER_M2[i]
        })
    }

    /// Illuminance of a surface by sky and ground, over π (cd/m²), for a normal with X towards the sun's heading and Y up: linear in the normal, as
    /// the first order of spherical harmonics (Ramamoorthi & Hanrahan 2001), and exact for normals straight up and down.
    pub fn ambient(&self, normal: [f32; 3]) -> Rgb {
        std::array::from_fn(|i| self.mean[i] + self.toward_sun[i] * normal[0] + self.up[i] * normal[1])
    }

    /// Illuminance of level ground by sun and sky together (lx).
    pub fn illuminance_lx(&self) -> f32 {
        let direct = self.elevation_rad.sin().max(0.0);
        luminance(self.sun_lx) * direct + luminance(self.ambient([0.0, 1.0, 0.0])) * std::f32::consts::PI
    }

    /// Exposure for an adapted eye (m²/cd): see [`exposure`].
    pub fn exposure(&self) -> f32 {
        let (sin, cos) = self.elevation_rad.sin_cos();
        let sky_lx = luminance(self.ambient([0.0, 1.0, 0.0])) * std::f32::consts::PI;
        exposure(luminance(self.sun_lx) * 0.5 * (sin + cos) + sky_lx, sky_lx)
    }

    /// Integrates the sky over the upper hemisphere, and the ground, lit by sun and sky, over the lower.
    fn gather(&mut self) {
        const ROWS: usize = 16;
        const COLUMNS: usize = 24;
        let solid_angle = (TAU / (ROWS * COLUMNS) as f64) as f32;
        let (mut on_ground, mut toward_sun) = ([0.0_f32; 3], [0.0_f32; 3]);
        for at in 0..ROWS * COLUMNS {
            let up = ((at / COLUMNS) as f32 + 0.5) / ROWS as f32;
            let heading = (((at % COLUMNS) as f64 + 0.5) / COLUMNS as f64 * TAU) as f32;
            let light = self.luminance(up, heading.cos()).map(|light| light * solid_angle);
            let level = (1.0 - up * up).sqrt();
            for i in 0..3 {
                on_ground[i] += light[i] * up / std::f32::consts::PI;
                // (2/3) · (3/(4π)) n·∫Lω.
                toward_sun[i] += light[i] * level * heading.cos() / std::f32::consts::TAU;
            }
        }
        let direct = self.elevation_rad.sin().max(0.0);
        for i in 0..3 {
            let ground = GROUND_ALBEDO[i] * (on_ground[i] + self.sun_lx[i] * direct / std::f32::consts::PI);
            self.mean[i] = 0.5 * (on_ground[i] + ground);
            self.up[i] = 0.5 * (on_ground[i] - ground);
        }
        self.toward_sun = toward_sun;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sky(elevation_deg: f32) -> Sky {
        Air::new().sky(elevation_deg.to_radians())
    }

    /// Daylight of a clear sky (IES RP-21-84, "Recommended practice for the calculation of daylight availability"): the sun's 127.5 klx ·
    /// exp(−0.21/sin h) and 0.8 + 15.5 √(sin h) klx of the sky. The end of civil twilight has 3.4 lx (Explanatory Supplement to the Astronomical
    /// Almanac).
    #[test]
    fn the_ground_is_as_bright_as_measured() {
        let air = Air::new();
        let ground_lx = |elevation_deg: f32| air.sky(elevation_deg.to_radians()).illuminance_lx();
        for elevation_deg in [10.0, 20.0, 40.0, 60.0, 90.0_f32] {
            let up = elevation_deg.to_radians().sin();
            let wanted = 1e3 * (127.5 * (-0.21 / up).exp() * up + 0.8 + 15.5 * up.sqrt());
            let found = ground_lx(elevation_deg);
            assert!((found / wanted - 1.0).abs() < 0.2, "{found} lx at {elevation_deg}° instead of {wanted}");
        }
        let dusk = ground_lx(-6.0);
        assert!((3.4 / 2.0..3.4 * 2.0).contains(&dusk), "{dusk} lx");
    }

    #[test]
    fn the_sky_is_blue_above_and_bright_about_the_sun() {
        let sky = sky(31.5);
        let [red, green, blue] = sky.luminance(1.0, 1.0);
        assert!(blue > 1.5 * green && green > 1.5 * red, "{red}, {green}, {blue}");
        assert!(luminance(sky.luminance(0.5, 1.0)) > 2.0 * luminance(sky.luminance(0.5, -1.0)));
        let [red, _, blue] = sky.sun_lx;
        assert!(red > 1.2 * blue, "{:?}", sky.sun_lx);
    }

    #[test]
    fn a_low_sun_is_red_and_a_set_one_lights_clouds_still() {
        let setting = sky(1.0);
        assert!(setting.sun_lx[0] > 4.0 * setting.sun_lx[2], "{:?}", setting.sun_lx);
        let set = sky(-1.0);
        assert_eq!(set.sun_lx.map(|light| light < 1.0), [true; 3], "{:?}", set.sun_lx);
        assert!(set.cloud_sun_lx[0] > 500.0, "{:?}", set.cloud_sun_lx);
    }

    /// Illuminance of level ground equals the sum of the sky's table over the upper hemisphere.
    #[test]
    fn ambient_light_is_that_of_the_sky() {
        for elevation_deg in [50.0, 15.0, -2.0] {
            let sky = sky(elevation_deg);
            let mut wanted = 0.0;
            for at in 0..200 * 200 {
                let (up, heading) = (((at / 200) as f32 + 0.5) / 200.0, ((at % 200) as f32 + 0.5) / 200.0 * 6.283_185_5);
                wanted += luminance(sky.luminance(up, heading.cos())) * up * 2.0 / 40_000.0;
            }
            let found = luminance(sky.ambient([0.0, 1.0, 0.0]));
            assert!((found / wanted - 1.0).abs() < 0.03, "{found} instead of {wanted} at {elevation_deg}°");
        }
    }

    /// The ground receives less light than the sun emits.
    #[test]
    fn the_air_adds_no_light() {
        let air = Air::new();
        for elevation_deg in [2.0, 10.0, 40.0, 90.0_f32] {
            let sent = SUN_LX * elevation_deg.to_radians().sin();
            let found = air.sky(elevation_deg.to_radians()).illuminance_lx();
            assert!(found < sent, "{found} lx of {sent}");
        }
    }
}
