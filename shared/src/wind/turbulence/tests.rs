use super::*;
use crate::scene::TerrainMaps;

/// The default wind, 8 m wide cells in a wind of 5 m/s along X, with another seed.
fn scene(seed: u64) -> Scene {
    let maps = TerrainMaps { height_map: String::new(), covering_map: String::new(), pixel_m: [1.0, 1.0], level_m: 0.1, base_m: 0.0 };
    let mut scene = Scene { seed, ..Scene::new(maps) };
    scene.wind.mean_m_per_s = [5.0, 0.0];
    scene
}

/// The gusts of `count` seeds at a friction velocity of 1 m/s.
fn ensemble(count: u64) -> impl Iterator<Item = Gusts> {
    (0..count).map(|seed| Turbulence::new(&scene(seed)).at(&TurbulenceState { friction_m_per_s: 1.0, ..TurbulenceState::default() }))
}

/// Simpson's rule over the logarithm of the wavenumber, in the band of [`scene`], of the spectrum times `weight`.
fn over_band(weight: impl Fn(f64) -> f64) -> f64 {
    let (low, high, steps) = ((TAU / 56.0).ln(), (TAU / 4.0).ln(), 2000);
    let value = |n: usize| {
        let k = (low + (high - low) * n as f64 / steps as f64).exp();
        let factor = if n == 0 || n == steps { 1.0 } else { 2.0 + 2.0 * (n % 2) as f64 };
        factor * k * spectrum(k) * weight(k)
    };
    (0..=steps).map(value).sum::<f64>() * (high - low) / steps as f64 / 3.0
}

fn within(found: f64, wanted: f64, fraction: f64, what: &str) {
    assert!((found / wanted - 1.0).abs() < fraction, "{what}: {found} instead of {wanted}");
}

#[test]
fn the_spectrum_has_an_integral_of_one() {
    let sum: f64 = (0..4000).map(|n| (-12.0 + 0.005 * (n as f64 + 0.5)).exp()).map(|k| k * spectrum(k) * 0.005).sum();
    within(sum, 1.0, 0.01, "energy between 1e-5 and 3000 rad/m");
}

#[test]
fn the_variances_are_those_of_the_band() {
    let (mut squares, mut sums, mut count) = ([0.0; 2], [0.0; 2], 0.0);
    for gusts in ensemble(600) {
        for n in 0..40 {
            let gust = gusts.at([n as f32 * 131.0, n as f32 * 57.0]).map(f64::from);
            for axis in 0..2 {
                squares[axis] += gust[axis] * gust[axis];
                sums[axis] += gust[axis];
            }
            count += 1.0;
        }
    }
    for axis in 0..2 {
        let wanted = DEVIATIONS[axis] * DEVIATIONS[axis] * over_band(|_| 1.0);
        within(squares[axis] / count, wanted, 0.05, "variance");
        assert!((sums[axis] / count).abs() < 0.03 * wanted.sqrt(), "the mean is {}", sums[axis] / count);
    }
}

#[test]
fn the_energy_falls_with_the_wavenumber_as_von_karmans() {
    let bins = 9;
    let (low, step) = ((TAU / 56.0).ln(), (14.0_f64).ln() / bins as f64);
    let mut found = vec![0.0; bins];
    for gusts in ensemble(3000) {
        for GustWave { per_m: [x, z], strength, .. } in gusts.waves() {
            let square = f64::from(x * x + z * z);
            let at = (((TAU * square.sqrt()).ln() - low) / step) as usize;
            found[at.min(bins - 1)] += 0.5 * f64::from(*strength).powi(2) * square / 3000.0;
        }
    }
    let total: f64 = DEVIATIONS.iter().map(|deviation| deviation * deviation).sum();
    let middle = |n: usize| low + (n as f64 + 0.5) * step;
    let (mut found_logs, mut wanted_logs) = (Vec::new(), Vec::new());
    for (n, &energy) in found.iter().enumerate() {
        let (from, to) = ((middle(n) - 0.5 * step).exp(), (middle(n) + 0.5 * step).exp());
        let wanted = total * over_band(|k| if (from..to).contains(&k) { 1.0 } else { 0.0 });
        within(energy, wanted, 0.05, "energy of a bin");
        found_logs.push((energy / (to - from)).ln());
        wanted_logs.push((wanted / (to - from)).ln());
    }
    let slope = |logs: &[f64]| {
        let mean = logs.iter().sum::<f64>() / bins as f64;
        let off = |n: usize| n as f64 - 0.5 * (bins - 1) as f64;
        (0..bins).map(|n| off(n) * (logs[n] - mean)).sum::<f64>() / (0..bins).map(|n| off(n) * off(n) * step).sum::<f64>()
    };
    within(slope(&found_logs), slope(&wanted_logs), 0.05, "slope");
    assert!((-1.75..-1.55).contains(&slope(&found_logs)), "nearly −5/3: {}", slope(&found_logs));
}

#[test]
fn the_integral_length_is_that_of_the_band() {
    // Correlation of the gust along X with itself at a distance along X, up to the longest wave.
    let lags = 28;
    let mut found = vec![0.0; lags + 1];
    for gusts in ensemble(3000) {
        for place in 0..4 {
            let [x_m, z_m] = [place as f32 * 311.0, place as f32 * 173.0];
            let [here, _] = gusts.at([x_m, z_m]);
            for (lag, sum) in found.iter_mut().enumerate() {
                *sum += f64::from(here * gusts.at([x_m + 2.0 * lag as f32, z_m])[0]);
            }
        }
    }
    let length = |correlations: &[f64]| {
        let inner: f64 = correlations[1..lags].iter().sum();
        2.0 * (0.5 * (correlations[0] + correlations[lags]) + inner) / correlations[0]
    };
    let correlation = |lag_m: f64| {
        let angles = 720;
        let directions: Vec<_> = (0..angles).map(|n| heading((f64::from(n) + 0.5) / f64::from(angles))).collect();
        over_band(|k| directions.iter().map(|[along, across]| across * across * (k * along * lag_m).cos()).sum::<f64>() / f64::from(angles))
    };
    let wanted: Vec<_> = (0..=lags).map(|lag| correlation(2.0 * lag as f64)).collect();
    within(length(&found), length(&wanted), 0.05, "integral length (m)");
}

#[test]
fn gusts_are_free_of_divergence() {
    for gusts in ensemble(20) {
        let (mut divergence, mut gradient) = (0.0, 0.0);
        for n in 0..50 {
            let [x, z] = [n as f32 * 7.25, n as f32 * 3.5];
            let step = 1.0 / 32.0;
            let along = |axis: usize, off: [f32; 2]| {
                (gusts.at([x + off[0], z + off[1]])[axis] - gusts.at([x - off[0], z - off[1]])[axis]) / (2.0 * step)
            };
            divergence += f64::from(along(0, [step, 0.0]) + along(1, [0.0, step])).powi(2);
            gradient += f64::from(along(0, [step, 0.0])).powi(2) + f64::from(along(0, [0.0, step])).powi(2);
        }
        assert!(divergence < 1e-6 * gradient, "{divergence} of {gradient}");
    }
}

#[test]
fn the_wind_carries_the_gusts() {
    let turbulence = Turbulence::new(&scene(3));
    let state = TurbulenceState { travel_m: [0.0; 2], path_m: 5.0, friction_m_per_s: 0.5 };
    let later = TurbulenceState { travel_m: [1200.0, -340.0], ..state };
    let close = |a: [f32; 2], b: [f32; 2]| (a[0] - b[0]).abs() < 1e-3 && (a[1] - b[1]).abs() < 1e-3;
    assert!(close(turbulence.at(&state).at([10.0, 20.0]), turbulence.at(&later).at([1210.0, -320.0])));
    assert!(!close(turbulence.at(&state).at([10.0, 20.0]), turbulence.at(&later).at([10.0, 20.0])));
    let older = TurbulenceState { path_m: 50.0, ..state };
    assert!(!close(turbulence.at(&state).at([10.0, 20.0]), turbulence.at(&older).at([10.0, 20.0])), "waves turn over");
}

#[test]
fn without_strength_or_wind_there_are_no_waves() {
    let mut off = scene(1);
    off.wind.turbulence = 0.0;
    let windy = TurbulenceState { friction_m_per_s: 1.0, ..TurbulenceState::default() };
    assert!(Turbulence::new(&off).at(&windy).waves().is_empty());
    assert!(Turbulence::new(&scene(1)).at(&TurbulenceState::default()).waves().is_empty());
    let mut fine = scene(1);
    fine.wind.spacing_m = [0.5; 3];
    assert!(Turbulence::new(&fine).at(&windy).waves().is_empty(), "the cells resolve all of it");
    assert_eq!(Gusts::default().at([3.0, 4.0]), [0.0; 2]);
}

#[test]
fn the_cosine_is_accurate_for_any_angle() {
    let worst = (-4000..4000).map(|n| n as f32 * 0.01371).map(|turns| (f64::from(cosine(turns)) - (f64::from(turns) * TAU).cos()).abs());
    assert!(worst.fold(0.0, f64::max) < 3e-7);
}

/// The bits that server and page must agree on.
#[test]
fn the_bits_of_a_gust_are_pinned() {
    let state = TurbulenceState { travel_m: [12_345.678, -987.654], path_m: 432.1, friction_m_per_s: 0.625 };
    let gusts = Turbulence::new(&scene(7)).at(&state);
    let bits: Vec<_> = (0..64).flat_map(|n| gusts.at([n as f32 * 61.7, n as f32 * 33.1])).map(f32::to_bits).collect();
    let hash = bits.iter().fold(0xcbf2_9ce4_8422_2325_u64, |hash, &word| (hash ^ u64::from(word)).wrapping_mul(0x0100_0000_01b3));
    assert_eq!(format!("{hash:016x}"), "48b0601fa47cbacc");
}
