//! Bend of one section under the weight of everything above it (Endo et al. 2003, §3.2).
//!
//! With φ the angle of the unbent section from upright, d the distance from its joint to the centre of the mass m above the joint, and a spring k
//! between that centre's unbent and bent position, the balance is `k·d·sin α = m·g·sin(φ + α)`. As vectors: the bent section points along `k·d·a +
//! m·g`, a the unbent axis. Upright sections (φ = 0) with m·g > k·d buckle, and as this spring exerts no torque at half a turn they hang straight
//! down, to an undetermined side. A section that already hangs (φ = π) does not bend.

/// Bend α of a section (rad, 0..=π) that is `unbent_rad` (φ, 0..=π) off upright, with `stiffness` = k·d/(m·g): the stable one of the two balances,
/// which is reached continuously as the load grows. Endo et al. 2003, Eq. (1) with the right quadrant.
pub fn bend_rad(unbent_rad: f64, stiffness: f64) -> f64 {
    unbent_rad.sin().atan2(stiffness - unbent_rad.cos())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    /// Bend by the arcsine of Endo et al. 2003, Eq. (1). It is right up to a quarter turn, that is if k·d ≥ m·g·cos φ; beyond, it gives the
    /// supplement, back towards upright. At φ = 0 it never bends.
    fn bend_by_arcsine_rad(unbent_rad: f64, stiffness: f64) -> f64 {
        let (sine, ahead) = (unbent_rad.sin(), stiffness - unbent_rad.cos());
        let square = sine * sine;
        if square == 0.0 { 0.0 } else { (square / (ahead * ahead + square)).sqrt().asin() }
    }

    /// Torque towards the unbent angle, over m·g·d.
    fn torque(unbent_rad: f64, stiffness: f64, bend_rad: f64) -> f64 {
        stiffness * bend_rad.sin() - (unbent_rad + bend_rad).sin()
    }

    /// The balance between unbent, where only the load pulls, and hanging, where only the spring does.
    fn bisected_rad(unbent_rad: f64, stiffness: f64) -> f64 {
        let (mut low, mut high) = (0.0, PI - unbent_rad);
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            if torque(unbent_rad, stiffness, middle) < 0.0 { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }

    proptest! {
        #[test]
        fn a_section_bends_to_the_balance(unbent in 0.001..PI - 0.001, tenfold in -1.0..2.0f64) {
            let stiffness = 10f64.powf(tenfold);
            let bend = bend_rad(unbent, stiffness);
            prop_assert!((bend - bisected_rad(unbent, stiffness)).abs() < 1e-9);
            let slope = (torque(unbent, stiffness, bend + 1e-6) - torque(unbent, stiffness, bend - 1e-6)) / 2e-6;
            prop_assert!(slope > 0.0, "stable");
        }

        #[test]
        fn the_balance_grows_from_none_with_the_load(unbent in 0.001..PI - 0.001) {
            let bends = (0..4000).map(|step| bend_rad(unbent, 1e3 * 0.997f64.powi(step)));
            let mut before = 0.0;
            for bend in bends {
                prop_assert!(bend >= before && bend <= PI - unbent);
                // The jump of buckling is the steepest; it is as wide as the section is off upright.
                prop_assert!(bend - before < 0.003 / unbent.sin() + 1e-3);
                before = bend;
            }
        }

        #[test]
        fn the_arcsine_agrees_up_to_a_quarter_turn_and_not_beyond(unbent in 0.001..PI - 0.001, tenfold in -1.0..2.0f64) {
            let stiffness = 10f64.powf(tenfold);
            let (bend, arcsine) = (bend_rad(unbent, stiffness), bend_by_arcsine_rad(unbent, stiffness));
            let expected = if stiffness >= unbent.cos() { bend } else { PI - bend };
            // An arcsine is ill-conditioned at a quarter turn.
            prop_assert!((arcsine - expected).abs() < 1e-7);
        }
    }

    #[test]
    fn an_upright_section_stands_or_hangs() {
        for stiffness in [1.001, 2.0, 100.0] {
            assert_eq!(bend_rad(0.0, stiffness), 0.0);
        }
        for stiffness in [0.1, 0.5, 0.999] {
            assert_eq!(bend_rad(0.0, stiffness), PI);
            assert_eq!(bend_by_arcsine_rad(0.0, stiffness), 0.0, "the paper's form can't buckle");
        }
        assert!(bend_rad(PI, 0.1) < 1e-15 && bend_rad(PI, 100.0) < 1e-15);
    }

    #[test]
    fn the_arcsine_lifts_a_limp_section() {
        // Nearly upright and with hardly any stiffness: it hangs, but by the arcsine it is only a little off upright.
        let (unbent, stiffness) = (0.1, 0.1);
        assert!(bend_rad(unbent, stiffness) > FRAC_PI_2 + 1.4);
        let arcsine = bend_by_arcsine_rad(unbent, stiffness);
        assert!(arcsine < 0.12 && torque(unbent, stiffness, arcsine).abs() > 0.1);
    }
}
