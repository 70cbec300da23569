//! A canopy slows the wind, with an inflection of the profile at its top.
//!
//! Over and in a uniform canopy, driven by an acceleration G and slowed by an eddy viscosity ν, the steady profile has a closed form: above, `ν·U″ = −G`; inside,
//! `ν·U″ = C_d·a·U² − G`. Deep in the canopy `U = U_b = √(G / C_d·a)`; one integration gives
//! `ν/2·U′² = C_d·a/3·(U − U_b)²·(U + 2U_b)`, another `U = U_b·(3·coth²θ − 2)`, with θ linear in depth.
//!
//! The shear layer at canopy height has the length `U/U′`. Where U is far above U_b, so that G is negligible, it is `√(3ν / (2·C_d·a·U))`.

use prairie_charts::air::still_air;
use prairie_charts::norms::Norms;
use prairie_charts::orders::{Order, assert_expected};
use prairie_wind::{Boundary, Canopy, Config, Solver};

const TOP_M: f64 = 16.0;
const DRAG_PER_M: f64 = 0.125;
const VISCOSITY_M2_PER_S: f64 = 0.5;
const FORCE_M_PER_S2: f64 = 0.0625;

/// The exact profile.
struct Profile {
    canopy_m: f64,
    deep_m_per_s: f64,
    top_m_per_s: f64,
    /// θ at canopy height, and its gradient with depth (1/m).
    theta: [f64; 2],
}

impl Profile {
    fn new(canopy_m: f64) -> Self {
        let deep_m_per_s = (FORCE_M_PER_S2 / DRAG_PER_M).sqrt();
        // The slope at canopy height transmits the whole force on the air above.
        let slope_per_s = FORCE_M_PER_S2 * (TOP_M - canopy_m) / VISCOSITY_M2_PER_S;
        let cubic = |u: f64| {
            DRAG_PER_M / 3.0 * (u - deep_m_per_s).powi(2) * (u + 2.0 * deep_m_per_s) - 0.5 * VISCOSITY_M2_PER_S * slope_per_s.powi(2)
        };
        let [mut low, mut high] = [deep_m_per_s, 1000.0];
        for _ in 0..100 {
            let middle = 0.5 * (low + high);
            if cubic(middle) < 0.0 { low = middle } else { high = middle }
        }
        let coth = ((low / deep_m_per_s + 2.0) / 3.0).sqrt();
        let theta = 0.5 * ((coth + 1.0) / (coth - 1.0)).ln();
        Self { canopy_m, deep_m_per_s, top_m_per_s: low, theta: [theta, (0.5 * DRAG_PER_M * deep_m_per_s / VISCOSITY_M2_PER_S).sqrt()] }
    }

    fn at(&self, height_m: f64) -> f64 {
        if height_m > self.canopy_m {
            let curvature = FORCE_M_PER_S2 / VISCOSITY_M2_PER_S;
            let rise = |height_m: f64| -0.5 * curvature * (TOP_M - height_m).powi(2);
            return self.top_m_per_s + rise(height_m) - rise(self.canopy_m);
        }
        let theta = self.theta[0] + self.theta[1] * (self.canopy_m - height_m);
        self.deep_m_per_s * (3.0 * theta.tanh().powi(-2) - 2.0)
    }

    /// U/U′ (m) at canopy height.
    fn shear_length_m(&self) -> f64 {
        self.top_m_per_s * VISCOSITY_M2_PER_S / (FORCE_M_PER_S2 * (TOP_M - self.canopy_m))
    }
}

/// Steady wind (m/s) by height (m) of the cell layers.
fn profile(canopy_m: f64, layers: usize) -> Vec<(f64, f64)> {
    let spacing_m = TOP_M / layers as f64;
    let exact = Profile::new(canopy_m);
    // The ground moves with the air at its height, as if the canopy continued below.
    let ground = Boundary::Lid { velocity_m_per_s: [exact.at(0.0) as f32, 0.0, 0.0] };
    let config = Config {
        viscosity_m2_per_s: VISCOSITY_M2_PER_S as f32,
        body_force_m_per_s2: [FORCE_M_PER_S2 as f32, 0.0, 0.0],
        canopy: Some(Canopy { height_m: canopy_m as f32, drag_per_m: DRAG_PER_M as f32, motion: None }),
        ..still_air([1, layers, 1], [16.0, spacing_m, 16.0], [[Boundary::Wrap; 2], [ground, Boundary::FreeSlip], [Boundary::Wrap; 2]])
    };
    let mut air = Solver::<f64>::new(&config).expect("settings are allowed");
    air.set_velocity(|[_, y, _]| [exact.at(y), 0.0, 0.0]);
    let dt_secs = 0.4 * spacing_m * spacing_m / VISCOSITY_M2_PER_S;
    let layer = |air: &Solver<f64>| air.samples(0).map(|(position, u)| (position[1], u)).collect::<Vec<_>>();
    let mut before = layer(&air);
    for _ in 0..1000 {
        (0..(10.0 / dt_secs) as usize).for_each(|_| assert!(air.step(dt_secs, &[]).is_ok()));
        let now = layer(&air);
        let change = Norms::of(before.iter().zip(&now).map(|(a, b)| (a.1, b.1))).linf;
        before = now;
        if change < 1e-6 {
            return before;
        }
    }
    panic!("the wind does not settle");
}
const CANOPIES_M: [f64; 3] = [4.0, 6.0, 8.0];

#[test]
fn the_profile_converges_to_the_exact_one_at_second_order() {
    let row = |canopy_m: f64| {
        let exact = Profile::new(canopy_m);
        let errors = [16, 32, 64].map(|layers| {
            let found = profile(canopy_m, layers);
            (TOP_M / layers as f64, Norms::of(found.iter().map(|&(height_m, u)| (u, exact.at(height_m)))).l2)
        });
        Order::fit("Canopy", format!("{canopy_m} m high"), "h, L2", 2.0, errors.to_vec())
    };
    assert_expected(&CANOPIES_M.map(row));
}

#[test]
fn inflection_height_and_shear_layer_thickness_match_theory() {
    for canopy_m in CANOPIES_M {
        let spacing_m = TOP_M / 32.0;
        let found = profile(canopy_m, 32);
        let curvature = |three: &[(f64, f64)]| three[0].1 - 2.0 * three[1].1 + three[2].1;
        // Below the inflection the profile curves forwards, above it backwards.
        let turns: Vec<f64> = found
            .windows(4)
            .filter(|four| curvature(&four[..3]) > 0.0 && curvature(&four[1..]) <= 0.0)
            .map(|four| 0.5 * (four[1].0 + four[2].0))
            .collect();
        let above = found.iter().position(|&(height_m, _)| height_m > canopy_m).expect("air above");
        let [(_, below), (_, above)] = [found[above - 1], found[above]];
        let length_m = 0.5 * (below + above) / ((above - below) / spacing_m);
        let exact_m = Profile::new(canopy_m).shear_length_m();
        println!("canopy of {canopy_m} m: inflection at {turns:.2?} m, U/U′ there {length_m:.3} m, in theory {exact_m:.3} m");
        assert!(turns.len() == 1 && (turns[0] - canopy_m).abs() <= 0.5 * spacing_m, "{turns:?}");
        assert!((length_m / exact_m - 1.0).abs() < 0.03, "{length_m} {exact_m}");
    }
}
