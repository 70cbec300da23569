//! Gusts finer than the cells of the wind solver: the turbulence of an atmospheric surface layer, as a sum of plane waves that the resolved wind carries along.
//!
//! - Spectrum: von Kármán's, with the integral length of Eurocode EN 1991-1-4:2005 (Annex B) at a height of 10 m. The waves have the wavelengths between what
//!   the solver resolves ([`RESOLVED_CELLS`] cells, Skamarock 2004) and [`SHORTEST_M`].
//! - Strength: standard deviations of 2.39 u* along and 1.92 u* across the mean wind (Panofsky & Dutton 1984), over the whole spectrum, at all heights of the
//!   surface layer; u* is the friction velocity. A scene scales them by `wind.turbulence`.
//! - Each wave is level and transverse, so the sum is free of divergence. It moves with the wind at 10 m (Taylor 1938), and turns over at the rate
//!   `(ε k²)^⅓` of eddies of its size, with the dissipation `ε = u*³/(0.4 · 10 m)` of a neutral surface layer.

use crate::hash::folded;
use crate::random::SplitMix64;
use crate::scene::Scene;
use crate::wire::TurbulenceState;
use std::f64::consts::TAU;

/// Number of waves.
pub const WAVES: usize = 24;
/// Shortest wavelength (m).
pub const SHORTEST_M: f32 = 4.0;
/// Shortest wavelength that the solver resolves (cells).
pub const RESOLVED_CELLS: f32 = 7.0;
/// Height of the wind that carries the gusts (m).
pub const REFERENCE_M: f32 = 10.0;
/// Von Kármán's constant.
pub const VON_KARMAN: f32 = 0.4;

/// Integral length of the wind along its direction (m): `300 m · (10/200)^0.52` over open grassland (roughness length 0.05 m).
const INTEGRAL_M: f64 = 63.1;
/// Integral length over the length scale of von Kármán's spectrum: `√π Γ(5/6)/Γ(1/3)`.
const INTEGRAL_PER_SCALE: f64 = 0.746_834;
/// Standard deviations along and across the mean wind, over the friction velocity.
const DEVIATIONS: [f64; 2] = [2.39, 1.92];

/// A wave, apart from its state.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Wave {
    /// Wave vector along X and Z (turns per metre).
    per_m: [f64; 2],
    /// Phase at the start (turns).
    phase: f64,
    /// Turns per metre of [`TurbulenceState::path_m`].
    per_path_m: f64,
}

/// The gusts of a scene: its waves, from the seed.
#[derive(Clone, Debug, PartialEq)]
pub struct Turbulence {
    waves: Vec<Wave>,
    /// Amplitude of each wave over the friction velocity.
    amplitude: f64,
}

/// The gusts at one moment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Gusts {
    waves: Vec<GustWave>,
}

/// A wave of velocity `across · cos τ(per_m · p + phase)`, with `across` at right angles to `per_m`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GustWave {
    /// Wave vector along X and Z (turns per metre).
    pub per_m: [f32; 2],
    /// Phase (turns), 0..1.
    pub phase: f32,
    /// Amplitude over the length of the wave vector (m²/s per turn).
    pub strength: f32,
}

impl Turbulence {
    /// The gusts of `scene`; none where `wind.turbulence` is 0 or the cells resolve [`SHORTEST_M`].
    pub fn new(scene: &Scene) -> Self {
        let [dx, _, dz] = scene.wind.spacing_m;
        let stated_m = scene.wind.turbulence_below_m;
        let longest_m = f64::from(if stated_m > 0.0 { stated_m } else { RESOLVED_CELLS * dx.max(dz) });
        let strength = f64::from(scene.wind.turbulence);
        if strength <= 0.0 || longest_m <= SHORTEST_M.into() {
            return Self { waves: Vec::new(), amplitude: 0.0 };
        }
        let band = Band::new(longest_m, SHORTEST_M.into());
        let [east, south] = unit(scene.wind.mean_m_per_s.map(f64::from));
        let mut random = SplitMix64::new(folded(scene.seed).into());
        // Each wave has a stratum of the energy and one of the directions, in every combination over all seeds: 7 and the number of waves have no common factor.
        let first = (random.next_u64() % WAVES as u64) as usize;
        let wave = |n: usize| {
            let k = band.wavenumber((n as f64 + random.unit()) / WAVES as f64);
            let [along, across] = heading((((first + 7 * n) % WAVES) as f64 + random.unit()) / WAVES as f64);
            let per_m = [along * east - across * south, along * south + across * east].map(|part| part * k / TAU);
            let turnover = libm::cbrt(k * k / f64::from(VON_KARMAN * REFERENCE_M)) / TAU;
            Wave { per_m, phase: random.unit(), per_path_m: if random.unit() < 0.5 { turnover } else { -turnover } }
        };
        let variance = DEVIATIONS.iter().map(|deviation| deviation * deviation).sum::<f64>() * band.share();
        Self { waves: (0..WAVES).map(wave).collect(), amplitude: strength * libm::sqrt(2.0 * variance / WAVES as f64) }
    }

    /// The gusts in a state.
    pub fn at(&self, state: &TurbulenceState) -> Gusts {
        let amplitude = self.amplitude * f64::from(state.friction_m_per_s);
        if amplitude <= 0.0 {
            return Gusts::default();
        }
        let gust = |wave: &Wave| {
            let [x, z] = wave.per_m;
            let turns = wave.phase + wave.per_path_m * state.path_m - x * state.travel_m[0] - z * state.travel_m[1];
            let phase = turns - libm::floor(turns);
            GustWave {
                per_m: wave.per_m.map(|part| part as f32),
                phase: phase as f32,
                strength: (amplitude / libm::sqrt(x * x + z * z)) as f32,
            }
        };
        Gusts { waves: self.waves.iter().map(gust).collect() }
    }
}

impl Gusts {
    /// The waves; none in still air.
    pub fn waves(&self) -> &[GustWave] {
        &self.waves
    }

    /// Gust (m/s, along X and Z) at a place (m, X and Z).
    ///
    /// Its twin on the GPU is `gust_at` in `inputs/wind.wgsl`; they differ by less than 2 mm/s within 5 km at a friction velocity of 1 m/s.
    pub fn at(&self, [x_m, z_m]: [f32; 2]) -> [f32; 2] {
        self.waves.iter().fold([0.0; 2], |[u, w], wave| {
            let [x, z] = wave.per_m;
            let speed = wave.strength * cosine(x * x_m + z * z_m + wave.phase);
            [u - z * speed, w + x * speed]
        })
    }

    /// Upper bound of the speed of a gust (m/s).
    pub fn bound_m_per_s(&self) -> f32 {
        self.waves.iter().map(|GustWave { per_m: [x, z], strength, .. }| strength * (x * x + z * z).sqrt()).sum()
    }
}

/// The wavenumbers of the waves, and the energy of von Kármán's spectrum between them.
struct Band {
    /// Natural logarithm of the first wavenumber (1/m), and the distance of the nodes of `energy`.
    first: f64,
    step: f64,
    /// Share of the spectrum's energy between the first wavenumber and each node.
    energy: Vec<f64>,
}

impl Band {
    const STEPS: usize = 400;

    fn new(longest_m: f64, shortest_m: f64) -> Self {
        let first = libm::log(TAU / longest_m);
        let step = (libm::log(TAU / shortest_m) - first) / Self::STEPS as f64;
        let density = |n: usize| spectrum(libm::exp(first + n as f64 * step)) * libm::exp(first + n as f64 * step);
        let sum = |sum: &mut f64, n: usize| {
            *sum += if n == 0 { 0.0 } else { 0.5 * (density(n - 1) + density(n)) * step };
            Some(*sum)
        };
        Self { first, step, energy: (0..=Self::STEPS).scan(0.0, sum).collect() }
    }

    /// Share of the whole spectrum's energy.
    fn share(&self) -> f64 {
        self.energy[Self::STEPS]
    }

    /// Wavenumber (rad/m) below which a `fraction` of the band's energy is.
    fn wavenumber(&self, fraction: f64) -> f64 {
        let wanted = fraction * self.share();
        let above = self.energy.partition_point(|energy| *energy <= wanted).clamp(1, Self::STEPS);
        let (low, high) = (self.energy[above - 1], self.energy[above]);
        libm::exp(self.first + self.step * ((above - 1) as f64 + (wanted - low) / (high - low)))
    }
}

/// Von Kármán's spectrum of kinetic energy over the wavenumber `k` (rad/m), normalised to an integral of 1 (von Kármán 1948).
fn spectrum(k: f64) -> f64 {
    // 55 Γ(5/6)/(9 √π Γ(1/3)), over the 3/2 of three components.
    const LEVEL: f64 = 0.968_508;
    let scale_m = INTEGRAL_M / INTEGRAL_PER_SCALE;
    let x = k * scale_m;
    LEVEL * scale_m * x * x * x * x * libm::pow(1.0 + x * x, -17.0 / 6.0)
}

/// Direction of a wave vector (along and across the mean wind) by its quantile 0..1. Uniform angles would spread the variance evenly; stretched across the
/// wind by the ratio of the variances, transverse waves have the variances of [`DEVIATIONS`].
fn heading(quantile: f64) -> [f64; 2] {
    let angle = quantile * 0.5 * TAU;
    let stretch = DEVIATIONS[0] * DEVIATIONS[0] / (DEVIATIONS[1] * DEVIATIONS[1]);
    unit([libm::cos(angle), stretch * libm::sin(angle)])
}

/// The unit vector along `[x, z]`; +X for the zero vector.
fn unit([x, z]: [f64; 2]) -> [f64; 2] {
    let length = libm::sqrt(x * x + z * z);
    if length > 0.0 { [x / length, z / length] } else { [1.0, 0.0] }
}

/// Cosine of an angle in turns, to 3e-7 of 1: the Taylor series of the sine of the angle's complement, by + − × alone.
fn cosine(turns: f32) -> f32 {
    const COEFFICIENTS: [f32; 6] = [std::f32::consts::TAU, -41.3417, 81.605_25, -76.705_86, 42.058_69, -15.094_643];
    let off = turns - turns.floor() - 0.5;
    let complement = off.abs() - 0.25;
    let square = complement * complement;
    complement * COEFFICIENTS.iter().rev().fold(0.0, |sum, coefficient| sum * square + coefficient)
}

#[cfg(test)]
mod tests;
