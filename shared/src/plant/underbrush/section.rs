//! How far one section bends under the weight of what is above it (004 §3.2).
//!
//! With φ the angle of the unbent section from upright, d the distance from its joint to the centre of mass m of all that is above the joint, and a spring
//! k between where that centre is and where it was, the balance is `k·d·sin α = m·g·sin(φ + α)`. It is one of vectors: the bent section points along
//! `k·d·a + m·g`, a the unbent axis. Of upright sections (φ = 0) those with m·g > k·d buckle, and as this spring has no torque left at half a turn they hang
//! straight down; which side they fall to is not said. A section that hangs already (φ = π) doesn't bend.

/// Angle α by which a section bends (rad, 0..=π) that is `unbent_rad` (φ, 0..=π) off upright, where `stiffness` is k·d/(m·g): the stable one of the two
/// balances, which is reached without a jump as the load grows. 004 Eq. (1) with its quadrant.
pub fn bend_rad(unbent_rad: f64, stiffness: f64) -> f64 {
    unbent_rad.sin().atan2(stiffness - unbent_rad.cos())
}

/// The angle as 004 Eq. (1) has it, by an arcsine. It is right up to a quarter turn, that is while k·d ≥ m·g·cos φ; a section that bends further is taken to
/// bend by the supplement, back towards upright. At φ = 0 it never bends.
pub fn bend_by_arcsine_rad(unbent_rad: f64, stiffness: f64) -> f64 {
    let (sine, ahead) = (unbent_rad.sin(), stiffness - unbent_rad.cos());
    let square = sine * sine;
    if square == 0.0 { 0.0 } else { (square / (ahead * ahead + square)).sqrt().asin() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    /// Torque towards the unbent angle, over m·g·d.
    fn torque(unbent_rad: f64, stiffness: f64, bend_rad: f64) -> f64 {
        stiffness * bend_rad.sin() - (unbent_rad + bend_rad).sin()
    }

    /// The balance between unbent, where the load alone pulls, and hanging, where the spring alone does.
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
        // Nearly upright and with hardly any stiffness: it hangs, and the arcsine has it a little off upright.
        let (unbent, stiffness) = (0.1, 0.1);
        assert!(bend_rad(unbent, stiffness) > FRAC_PI_2 + 1.4);
        let arcsine = bend_by_arcsine_rad(unbent, stiffness);
        assert!(arcsine < 0.12 && torque(unbent, stiffness, arcsine).abs() > 0.1);
    }
}
