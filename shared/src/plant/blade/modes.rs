//! Modes of a blade: a chain of three rigid links of equal length and mass, with a rotational spring EI/l between links and 2EI/l at the root, where
//! half a link's curvature is lumped.
//!
//! In units of length L, rigidity EI and mass per length μ its equations for small leans q are `M q̈ + K q = Q`. All constants below follow from M
//! and K; the tests derive them.
//!
//! # Calibration
//! The uncalibrated chain swings at 3.346, 18.89 and 47.03·√(EI/(μL⁴)), 4.8, 14.3 and 23.8 % below a uniform cantilever's 3.516, 22.03 and 61.70; the
//! error falls with the square of the number of links. The rigidity of the blade is scaled by 1.104, so that its first frequency is exact *by
//! calibration*, not by the model; its second (19.85) and third (49.42) are then 9.9 and 19.9 % low. Each mode decays at its own ζ·ω.
//!
//! # Length
//! [`first_frequency_rad_per_s`] falls with the square of the length of a blade of given cross-section. Within one species longer blades are also
//! thicker: with a thickness proportional to L, EI/μ grows with L² and ω falls with 1/L. By that law a scene's `swing_hz`, given for a blade of mean
//! height, determines the frequency of every other blade.

use super::LINKS;

/// ω₁ of a uniform cantilever over √(EI/(μL⁴)): the square of the smallest root of cos x · cosh x = −1.
pub const CANTILEVER: f32 = 3.516_015_3;

/// Frequencies of the modes relative to the lowest.
pub const FREQUENCIES: [f32; LINKS] = [1.0, 5.644_860_5, 14.056_431];

/// Leans of the links in each mode, normalised to unit modal mass: row m is mode m.
pub const MODES: [[f32; LINKS]; LINKS] =
    [[1.067_929_6, 2.221_555_2, 2.567_097_4], [-4.402_434, 1.821_226_6, 8.255_183], [4.805_568, -10.494_4, 10.881_903]];

/// Amplitude of each mode in given leans, the inverse of [`MODES`] (its rows times M).
pub const AMPLITUDES: [[f32; LINKS]; LINKS] = [
    [0.263_248_8, 0.216_574_7, 0.092_608_95],
    [-0.126_404_24, -0.001_768_789_4, 0.054_115_704],
    [0.033_790_49, -0.049_749_267, 0.028_995_734],
];

/// Damping rate of each mode by drag on each control point, over `ω₁²·κ·L·|u − v|` with κ the lean per squared wind and |u − v| the speed of the air
/// relative to it.
pub const BRAKES: [[f32; LINKS]; LINKS] =
    [[0.037_274_215, 0.282_923_5, 0.336_304_8], [0.633_445_1, 0.174_204_38, 0.315_659_94], [0.754_766_8, 0.846_173_7, 0.264_419_2]];

/// First natural frequency of a uniform blade (rad/s), a cantilever, from its flexural rigidity EI (N·m²), mass per length (kg/m) and length (m).
///
/// ```
/// use prairie_core::plant::blade::modes::first_frequency_rad_per_s;
/// let twice_as_long = first_frequency_rad_per_s(0.004, 0.001, 1.6) / first_frequency_rad_per_s(0.004, 0.001, 0.8);
/// assert!((twice_as_long - 0.25).abs() < 1e-6);
/// ```
pub fn first_frequency_rad_per_s(rigidity_n_m2: f32, mass_kg_per_m: f32, length_m: f32) -> f32 {
    CANTILEVER * (rigidity_n_m2 / mass_kg_per_m).sqrt() / (length_m * length_m)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plant::blade::deflection::SILHOUETTES;

    type Matrix<const N: usize = LINKS> = [[f64; N]; N];

    /// M and K of a chain of N links in units of L, EI and μ.
    fn chain<const N: usize>() -> (Matrix<N>, Matrix<N>) {
        let l = 1.0 / N as f64;
        let (mut mass, mut stiffness) = ([[0.0; N]; N], [[0.0; N]; N]);
        for link in 0..N {
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

    fn times<const N: usize>(matrix: &Matrix<N>, vector: [f64; N]) -> [f64; N] {
        matrix.map(|row| row.iter().zip(vector).map(|(a, b)| a * b).sum())
    }

    fn dot<const N: usize>(a: [f64; N], b: [f64; N]) -> f64 {
        a.iter().zip(b).map(|(a, b)| a * b).sum()
    }

    /// Leans of a chain of N links under generalised forces: each joint carries the sum of those above it.
    fn bent<const N: usize>(forces: [f64; N]) -> [f64; N] {
        let (mut leans, mut lean) = ([0.0; N], 0.0);
        for link in 0..N {
            lean += forces[link..].iter().sum::<f64>() / N as f64 * if link == 0 { 0.5 } else { 1.0 };
            leans[link] = lean;
        }
        leans
    }

    /// The three lowest frequencies of a chain of N links, over √(EI/(μL⁴)): inverse iteration, each mode orthogonalised against those below.
    fn frequencies<const N: usize>() -> [f64; 3] {
        let (mass, _) = chain::<N>();
        let mut below: Vec<[f64; N]> = vec![];
        [0, 1, 2].map(|_| {
            let mut mode: [f64; N] = std::array::from_fn(|link| 1.0 / (link + 1) as f64);
            let mut square = 0.0;
            for _ in 0..100 {
                for other in &below {
                    let fraction = dot(mode, times(&mass, *other));
                    (0..N).for_each(|link| mode[link] -= fraction * other[link]);
                }
                let size = dot(mode, times(&mass, mode)).sqrt();
                mode = mode.map(|lean| lean / size);
                let next = bent(times(&mass, mode));
                square = 1.0 / dot(next, times(&mass, mode));
                mode = next;
            }
            below.push(mode.map(|lean| lean * square));
            square.sqrt()
        })
    }

    /// Frequencies of a uniform cantilever over √(EI/(μL⁴)): squares of the roots of cos x · cosh x = −1.
    fn of_cantilever() -> [f64; 3] {
        [1.0, 4.0, 7.0].map(|from: f64| {
            let excess = |x: f64| x.cos() * x.cosh() + 1.0;
            let (mut low, mut high) = (from, from + 1.0);
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if excess(middle) * excess(low) > 0.0 { low = middle } else { high = middle }
            }
            low * low
        })
    }

    fn mode(m: usize) -> [f64; LINKS] {
        MODES[m].map(f64::from)
    }

    #[test]
    fn the_modes_are_those_of_the_chain() {
        let (mass, stiffness) = chain::<LINKS>();
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
    fn the_first_frequency_is_calibrated_and_the_others_are_low_by_what_is_said() {
        let (wanted, chain) = (of_cantilever(), frequencies::<LINKS>());
        assert!((0..3).all(|m| (wanted[m] - [3.516_015, 22.034_492, 61.697_214][m]).abs() < 1e-6), "{wanted:?}");
        for (m, [as_is, scaled]) in [[-0.048_4, 0.0], [-0.142_9, -0.099_3], [-0.237_8, -0.199_0]].into_iter().enumerate() {
            assert!((chain[m] / wanted[m] - 1.0 - as_is).abs() < 1e-4, "mode {m}: {} for {}", chain[m], wanted[m]);
            let of_blade = f64::from(FREQUENCIES[m] * CANTILEVER);
            assert!((of_blade / wanted[m] - 1.0 - scaled).abs() < 1e-4, "mode {m}: {of_blade} for {}", wanted[m]);
        }
    }

    #[test]
    fn chains_of_more_links_near_the_cantilever_with_the_square_of_their_number() {
        let wanted = of_cantilever();
        let [few, more, many] = [frequencies::<6>(), frequencies::<12>(), frequencies::<24>()];
        for m in 0..3 {
            let error = |found: [f64; 3]| 1.0 - found[m] / wanted[m];
            let orders = [error(few) / error(more), error(more) / error(many)].map(f64::log2);
            assert!(orders.iter().all(|order| (1.9..2.05).contains(order)), "mode {m}: {orders:?}");
        }
    }

    #[test]
    fn a_blade_as_much_thicker_as_it_is_longer_swings_slower_with_its_length() {
        let frequency = |length_m: f32| {
            let (width_m, thickness_m) = (0.02 * length_m.sqrt(), 0.0004 * length_m);
            first_frequency_rad_per_s(1e9 * width_m * thickness_m.powi(3) / 12.0, 800.0 * width_m * thickness_m, length_m)
        };
        for length_m in [0.1, 0.5, 2.0] {
            assert!((frequency(length_m) * length_m / frequency(1.0) - 1.0).abs() < 1e-5);
        }
    }

    #[test]
    fn drag_brakes_each_mode_by_its_deflections() {
        for (m, brakes) in BRAKES.iter().enumerate() {
            for (j, (&brake, force)) in brakes.iter().zip(SILHOUETTES).enumerate() {
                let deflection = mode(m)[..=j].iter().sum::<f64>() / LINKS as f64;
                // Of the calibrated chain, whose lowest square of a frequency is a cantilever's.
                let wanted = f64::from(force) * deflection * deflection / f64::from(CANTILEVER).powi(2);
                assert!((f64::from(brake) - wanted).abs() < 1e-5);
            }
        }
    }
}
