//! Waves over grass that sways, against the linear theory of Py, de Langre & Moulia (2006).

use prairie_charts::problems::honami::stability::{MeanFlow, most_amplified, wave};
use prairie_charts::problems::honami::{ALFALFA, Meadow, rigid, simulation};
use std::f64::consts::TAU;

/// Wave number (1/m) of the comparison, near that of the most amplified wave.
const K_PER_M: f64 = 2.3;

#[test]
fn waves_grow_as_in_linear_theory_with_second_order() {
    // The theory's own differences are of second order, too: its limit from two grids.
    let [coarse, fine] = [24, 48].map(|nodes| wave(&ALFALFA, &MeanFlow::new(&ALFALFA, nodes), K_PER_M));
    let limit = |of: fn(&prairie_charts::problems::honami::Wave) -> f64| of(&fine) + (of(&fine) - of(&coarse)) / 3.0;
    let [growth, frequency] = [limit(|wave| wave.growth_per_s), limit(|wave| wave.frequency_rad_per_s)];
    let found = [8, 12, 16].map(|cells| simulation::wave(&ALFALFA, K_PER_M, cells));
    let errors = found.map(|wave| (wave.growth_per_s / growth - 1.0).abs());
    let orders = [(errors[0] / errors[1]).ln() / 1.5_f64.ln(), (errors[1] / errors[2]).ln() / (4.0_f64 / 3.0).ln()];
    println!(
        "growth {growth:.4} /s, errors {errors:.4?}, orders {orders:.2?}; frequency {:.4} Hz, {:.4?}",
        frequency / TAU,
        found.map(|wave| wave.frequency_rad_per_s / TAU)
    );
    assert!(orders.iter().all(|order| (order - 2.0).abs() < 0.15), "{orders:?}");
    assert!((found[2].frequency_rad_per_s / frequency - 1.0).abs() < 0.005);
    // The waves over rigid grass are others.
    let stiff = wave(&rigid(ALFALFA), &MeanFlow::new(&ALFALFA, 24), K_PER_M);
    assert!((stiff.growth_per_s / growth - 1.0).abs() > 2.0 * errors[2], "growth over rigid grass {}", stiff.growth_per_s);
}

/// Frequency (Hz) of the most amplified wave in a wind, in theory and in the solver.
fn frequencies_hz(meadow: Meadow, wind_m_per_s: f64) -> [f64; 2] {
    let meadow = Meadow { wind_m_per_s, ..meadow };
    let best = most_amplified(&meadow, 12);
    [best, simulation::wave(&meadow, best.k_per_m, 8)].map(|wave| wave.frequency_rad_per_s / TAU)
}

#[test]
fn waves_are_drawn_to_the_frequency_of_the_grass() {
    let own_hz = f64::from(ALFALFA.motion.expect("it sways").frequency_hz);
    let winds = [4.0, 5.0, 6.0];
    let [swaying, stiff] = [ALFALFA, rigid(ALFALFA)].map(|meadow| winds.map(|wind| frequencies_hz(meadow, wind)));
    println!("swaying {swaying:.3?}, rigid {stiff:.3?} Hz in winds of {winds:?} m/s");
    for ([theory, solver], [stiff_theory, stiff_solver]) in swaying.iter().zip(&stiff) {
        assert!((solver / theory - 1.0).abs() < 0.02 && (stiff_solver / stiff_theory - 1.0).abs() < 0.02, "theory and solver agree");
        assert!(
            (solver - own_hz).abs() < 0.7 * (stiff_solver - own_hz).abs(),
            "{solver} Hz over swaying grass, {stiff_solver} Hz over rigid grass"
        );
    }
    // Over rigid grass the frequency grows with the wind, over grass that sways by less than half as much.
    let growth = |found: [[f64; 2]; 3]| found[2][1] / found[0][1] - 1.0;
    assert!((growth(stiff) - 0.5).abs() < 0.01 && growth(swaying) < 0.25, "{} and {}", growth(stiff), growth(swaying));
}
