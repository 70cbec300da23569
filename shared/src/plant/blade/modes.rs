//! The modes of a blade: a chain of three rigid links of one length and mass, with a rotational spring EI/l between links and 2EI/l at the root, where
//! the curvature of half a link is gathered.
//!
//! In units of length L, rigidity EI and mass per length μ its equations for small leans q are `M q̈ + K q = Q`. The rigidity is scaled so that the lowest
//! frequency is that of a uniform cantilever, 3.516·√(EI/(μL⁴)); the second is then 10 % below the cantilever's (19.85 for 22.03), the third 20 % (49.4 for
//! 61.7). All numbers below follow from M and K; the tests derive them anew.

use super::LINKS;

/// ω₁ of a uniform cantilever over √(EI/(μL⁴)): the square of the least root of cos x · cosh x = −1.
pub const CANTILEVER: f32 = 3.516_015_3;

/// Frequencies of the modes over the lowest.
pub const FREQUENCIES: [f32; LINKS] = [1.0, 5.644_860_5, 14.056_431];

/// Leans of the links in each mode, scaled so that the mode's mass is 1: row m is mode m.
pub const MODES: [[f32; LINKS]; LINKS] =
    [[1.067_929_6, 2.221_555_2, 2.567_097_4], [-4.402_434, 1.821_226_6, 8.255_183], [4.805_568, -10.494_4, 10.881_903]];

/// Amplitude of each mode in given leans, the inverse of [`MODES`] (its rows times M).
pub const AMPLITUDES: [[f32; LINKS]; LINKS] = [
    [0.263_248_8, 0.216_574_7, 0.092_608_95],
    [-0.126_404_24, -0.001_768_789_4, 0.054_115_704],
    [0.033_790_49, -0.049_749_267, 0.028_995_734],
];

/// Static amplitude of each mode for drag on each control point, where drag shares of 1 at all three give a mean lean of 1: the points' silhouettes are as
/// 1 : 0.8 : 0.3, since a blade tapers.
pub const PUSHES: [[f32; LINKS]; LINKS] = [
    [0.102_832_17, 0.253_398_63, 0.169_181_12],
    [-0.013_303_711, -0.006_240_119, 0.005_143_855],
    [0.002_341_968, -0.002_217_938, 0.000_759_244_7],
];

/// Damping rate of each mode by drag on each control point, over `ω₁²·κ·L·|u − v|` with κ the lean per squared wind and |u − v| the speed of the air past it.
pub const BRAKES: [[f32; LINKS]; LINKS] =
    [[0.036_605_84, 0.277_850_3, 0.330_274_4], [0.622_086_6, 0.171_080_67, 0.309_999_75], [0.741_232_8, 0.831_000_7, 0.259_677_8]];

/// How the links share a lean that a steady wind sustains, with a mean of 1.
pub const WIND_SHAPE: [f32; LINKS] = [0.628_742_5, 1.131_736_5, 1.239_521];

/// First natural frequency of a uniform blade (rad/s) from its flexural rigidity EI (N·m²), its mass per length (kg/m) and its length (m).
///
/// ```
/// use shared::plant::blade::modes::first_frequency_rad_per_s;
/// let twice_as_long = first_frequency_rad_per_s(0.004, 0.001, 1.6) / first_frequency_rad_per_s(0.004, 0.001, 0.8);
/// assert!((twice_as_long - 0.25).abs() < 1e-6);
/// ```
pub fn first_frequency_rad_per_s(rigidity_n_m2: f32, mass_kg_per_m: f32, length_m: f32) -> f32 {
    CANTILEVER * (rigidity_n_m2 / mass_kg_per_m).sqrt() / (length_m * length_m)
}

#[cfg(test)]
mod tests {
    use super::*;

    type Matrix = [[f64; LINKS]; LINKS];

    /// M and K of the chain in units of L, EI and μ.
    fn chain() -> (Matrix, Matrix) {
        let l = 1.0 / LINKS as f64;
        let (mut mass, mut stiffness) = (Matrix::default(), Matrix::default());
        for link in 0..LINKS {
            // Deflection along this link is l·Σ of the leans below plus s times its own.
            for a in 0..=link {
                for b in 0..=link {
                    mass[a][b] += l.powi(3) / [1.0, 2.0, 3.0][usize::from(a == link) + usize::from(b == link)];
                }
            }
            let spring = if link == 0 { 2.0 / l } else { 1.0 / l };
            stiffness[link][link] += spring;
            if link > 0 {
                stiffness[link - 1][link - 1] += spring;
                stiffness[link - 1][link] -= spring;
                stiffness[link][link - 1] -= spring;
            }
        }
        (mass, stiffness)
    }

    fn times(matrix: &Matrix, vector: [f64; LINKS]) -> [f64; LINKS] {
        matrix.map(|row| row.iter().zip(vector).map(|(a, b)| a * b).sum())
    }

    fn dot(a: [f64; LINKS], b: [f64; LINKS]) -> f64 {
        a.iter().zip(b).map(|(a, b)| a * b).sum()
    }

    fn mode(m: usize) -> [f64; LINKS] {
        MODES[m].map(f64::from)
    }

    /// Silhouettes of the control points, scaled to a mean lean of 1.
    fn silhouettes() -> [f64; LINKS] {
        let (_, stiffness) = chain();
        let shape = WIND_SHAPE.map(f64::from);
        // K·shape = l·(sums of the silhouettes from each point up).
        let sums = times(&stiffness, shape).map(|q| q * LINKS as f64);
        [sums[0] - sums[1], sums[1] - sums[2], sums[2]]
    }

    #[test]
    fn the_modes_are_those_of_the_chain() {
        let (mass, stiffness) = chain();
        let lowest = dot(mode(0), times(&stiffness, mode(0)));
        for m in 0..LINKS {
            let value = dot(mode(m), times(&stiffness, mode(m)));
            assert!((value.sqrt() / lowest.sqrt() - f64::from(FREQUENCIES[m])).abs() < 1e-5);
            let (pulled, moved) = (times(&stiffness, mode(m)), times(&mass, mode(m)));
            assert!(pulled.iter().zip(moved).all(|(k, m)| (k - value * m).abs() < 2e-4 * value), "mode {m}");
            for n in 0..LINKS {
                let unit = f64::from(u8::from(m == n));
                assert!((dot(mode(n), times(&mass, mode(m))) - unit).abs() < 1e-5);
                assert!((dot(AMPLITUDES[m].map(f64::from), mode(n)) - unit).abs() < 1e-5);
            }
        }
    }

    #[test]
    fn the_scaled_chain_sways_as_a_cantilever_does() {
        let (_, stiffness) = chain();
        let lowest = dot(mode(0), times(&stiffness, mode(0))).sqrt();
        assert!((lowest - 3.345_68).abs() < 1e-4, "unscaled");
        let x: f64 = 1.875_104_068_711_961;
        assert!((x.cos() * x.cosh() + 1.0).abs() < 1e-12 && (f64::from(CANTILEVER) - x * x).abs() < 1e-6);
        assert!((first_frequency_rad_per_s(0.0038, 0.0012, 0.8) - 3.516_015 * (0.0038_f32 / 0.0012).sqrt() / 0.64).abs() < 1e-4);
    }

    #[test]
    fn drag_holds_and_brakes_as_the_chain_has_it() {
        let (_, stiffness) = chain();
        let areas = silhouettes();
        assert!((areas[1] / areas[0] - 0.8).abs() < 1e-4 && (areas[2] / areas[0] - 0.3).abs() < 1e-4, "{areas:?}");
        assert!((WIND_SHAPE.iter().sum::<f32>() / 3.0 - 1.0).abs() < 1e-6);
        let lowest = dot(mode(0), times(&stiffness, mode(0)));
        for m in 0..LINKS {
            let value = dot(mode(m), times(&stiffness, mode(m)));
            for j in 0..LINKS {
                let deflection = mode(m)[..=j].iter().sum::<f64>() / LINKS as f64;
                assert!((f64::from(PUSHES[m][j]) - areas[j] * deflection / value).abs() < 1e-6);
                assert!((f64::from(BRAKES[m][j]) - areas[j] * deflection * deflection / lowest).abs() < 1e-5);
            }
        }
    }
}
