//! A periodic hill in a uniform wind.

use std::f64::consts::TAU;

/// A smooth periodic hill of concentration (0.5 to 1.5) advected by a uniform wind in x and z, in a periodic box of side `side_m`.
pub fn drifting_hill(side_m: f64, [x, _, z]: [f64; 3], wind_m_per_s: [f64; 2], time_secs: f64) -> f64 {
    let k = TAU / side_m;
    let (x, z) = (x - wind_m_per_s[0] * time_secs, z - wind_m_per_s[1] * time_secs);
    1.0 + 0.5 * (k * x).sin() * (k * z).cos()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problems::differences::{gradient, rate};

    #[test]
    fn the_hill_solves_the_advection_equation() {
        let wind = [1.3, -0.4];
        let hill = |position, time| drifting_hill(10.0, position, wind, time);
        for position in [[1.0, 0.0, 2.0], [7.7, 3.0, 9.1]] {
            let slope = gradient(|x| hill(x, 0.6), position, 0.1);
            let carried = wind[0] * slope[0] + wind[1] * slope[2];
            assert!((rate(|t| hill(position, t), 0.6, 0.05) + carried).abs() < 1e-10);
        }
    }
}
