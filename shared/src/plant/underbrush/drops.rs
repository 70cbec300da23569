//! Raindrops that make leaves and flowers tremble (Endo et al. 2003, §1).
//!
//! As a steady pressure rain is negligible: 50 mm/h is 0.09 Pa. But a drop that strikes a leaf transfers its momentum at once, and moves the tip by
//! millimetres. The component is modelled as Rayleigh's cantilever: a force at its tip that moves the tip by 1 moves the point at the fraction s of
//! its length by (3s² − s³)/2; it has the effective mass 33/140 at the tip and the stiffness 3EI/L³ there. It returns without overshoot, as in
//! [`constraint`](super::constraint), but with its own time constant 1/ω: t seconds after a strike its tip is displaced by
//! `speed_m_per_s`·t·e^(−t/`settle_secs`).

use crate::scene::Component;

/// Mass of a raindrop (kg): a sphere of water 2 mm across. In heavy rain, 50 mm/h, half of the water falls in larger ones (Marshall & Palmer 1948).
pub const DROP_KG: f32 = 4.19e-6;

/// Terminal speed of such a drop (m/s; Gunn & Kinzer 1949).
pub const DROP_M_PER_S: f32 = 6.49;

/// Drops per square metre and second (1/(m²·s)) at a rainfall rate (mm/h): 3300 at 50 mm/h.
pub fn drops_per_m2_per_s(rate_mm_per_h: f32) -> f32 {
    // A millimetre of rain is a kilogram per square metre.
    rate_mm_per_h / 3600.0 / DROP_KG
}

/// Response of a component to a drop that strikes its tip.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Struck {
    /// Initial speed of the tip (m/s).
    pub speed_m_per_s: f32,
    /// Time of the largest displacement (s).
    pub settle_secs: f32,
}

impl Struck {
    /// Response of a component at a relative size: length scales with it, mass with its third power, rigidity with its fourth. The drop stays on it.
    pub fn new(component: &Component, size: f32) -> Self {
        let (length_m, mass_kg) = (component.length_m * size, component.mass_kg * size.powi(3));
        let moved_kg = 33.0 / 140.0 * mass_kg;
        // A force at the tip weighs rigidities by (1 − s)², on average at a quarter of the length.
        let rigidity_n_m2 = component.stiffness_n_m2 * size.powi(4) * (0.75 + 0.25 * component.tip_stiffness_share);
        let stiffness_n_per_m = 3.0 * rigidity_n_m2 / length_m.powi(3);
        Self { speed_m_per_s: DROP_KG * DROP_M_PER_S / (moved_kg + DROP_KG), settle_secs: (moved_kg / stiffness_n_per_m).sqrt() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::ComponentKind;

    fn leaf() -> Component {
        let mut leaf = Component::new("leaf", ComponentKind::Leaf);
        (leaf.length_m, leaf.mass_kg, leaf.stiffness_n_m2, leaf.tip_stiffness_share) = (0.42, 0.0005, 0.0003, 1.0);
        leaf
    }

    #[test]
    fn rain_brings_its_water_and_momentum() {
        let drops = drops_per_m2_per_s(50.0);
        assert!((drops * DROP_KG * 3600.0 - 50.0).abs() < 1e-3, "{drops} drops");
        assert!((drops * DROP_KG * DROP_M_PER_S - 0.09).abs() < 0.001, "Pa");
        let ball_kg = 1000.0 * std::f32::consts::PI / 6.0 * 0.002_f32.powi(3);
        assert!((DROP_KG / ball_kg - 1.0).abs() < 0.001);
    }

    #[test]
    fn a_leaf_keeps_the_momentum_and_swings_in_its_own_time() {
        let struck = Struck::new(&leaf(), 1.0);
        // By hand: 2.72e-5 N·s on 0.118 g and the drop.
        assert!((struck.speed_m_per_s - 2.719e-5 / (1.1786e-4 + 4.19e-6)).abs() < 1e-3, "{struck:?}");
        // The first mode of a uniform cantilever has ω = 3.516·√(EI/mL³).
        let exact_secs = (0.0005_f32 * 0.42_f32.powi(3) / 0.0003).sqrt() / 3.516;
        assert!((struck.settle_secs / exact_secs - 1.0).abs() < 0.02, "{struck:?} for {exact_secs} s");
        let farthest_m = struck.speed_m_per_s * struck.settle_secs / std::f32::consts::E;
        assert!((0.005..0.015).contains(&farthest_m), "a drop on the tip of a grass leaf is seen a metre away: {farthest_m} m");
    }

    #[test]
    fn a_tapered_leaf_is_as_stiff_as_its_bend_says() {
        for fraction in [0.1_f32, 0.3, 1.0] {
            // Compliance at the tip: ∫ (1 − s)²/EI(s) ds.
            let n = 10_000;
            let compliance: f64 = (0..n)
                .map(|i| {
                    let s = (f64::from(i) + 0.5) / f64::from(n);
                    (1.0 - s).powi(2) / (1.0 - (1.0 - f64::from(fraction)) * s) / f64::from(n)
                })
                .sum();
            let tapered = Struck::new(&Component { tip_stiffness_share: fraction, ..leaf() }, 1.0);
            let exact_secs = Struck::new(&leaf(), 1.0).settle_secs * (3.0 * compliance).sqrt() as f32;
            assert!((tapered.settle_secs / exact_secs - 1.0).abs() < 0.05, "{} for {exact_secs} s", tapered.settle_secs);
        }
    }

    #[test]
    fn smaller_ones_fly_faster_and_settle_sooner() {
        let [one, half] = [1.0, 0.5].map(|size| Struck::new(&leaf(), size));
        assert!(half.speed_m_per_s > 6.0 * one.speed_m_per_s && (half.settle_secs / one.settle_secs - 0.5).abs() < 1e-5);
    }
}
