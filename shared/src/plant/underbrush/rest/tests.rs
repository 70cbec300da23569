use super::super::elastica;
use super::*;
use proptest::prelude::*;
use std::f64::consts::FRAC_PI_2;

type Way = fn(&[f64], Load, f64, &mut [f64]);

/// Tip relative to the base: distance aside, and height against the load.
fn tip(way: Way, sections: usize, tip_fraction: f64, load: Load, unbent_rad: f64) -> [f64; 2] {
    let mut bends_rad = vec![0.0; sections];
    way(&joints(sections, tip_fraction), load, unbent_rad, &mut bends_rad);
    let sum = |part: fn(f64) -> f64| bends_rad.iter().map(|bend_rad| part(unbent_rad + bend_rad)).sum::<f64>() / sections as f64;
    [sum(f64::sin), sum(f64::cos)]
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// Simpson's rule on a smooth function.
fn integral(f: impl Fn(f64) -> f64, from: f64, to: f64) -> f64 {
    let steps = 4000;
    let step = (to - from) / steps as f64;
    let weight = |i: usize| if i == 0 || i == steps { 1.0 } else { [2.0, 4.0][i % 2] };
    (0..=steps).map(|i| weight(i) * f(from + i as f64 * step)).sum::<f64>() * step / 3.0
}

/// Deflection δ/L and shortening Δ/L of a clamped beam with the load P·L²/EI across its tip (Bisshopp & Drucker 1945), by elliptic integrals of
/// modulus p between θ₁ and π/2.
fn bisshopp_drucker(load: f64) -> [f64; 2] {
    let between = |p: f64, f: &dyn Fn(f64) -> f64| {
        let first = (1.0 / (p * 2f64.sqrt())).min(1.0).asin();
        integral(|theta| f((1.0 - (p * theta.sin()).powi(2)).sqrt()), first, FRAC_PI_2)
    };
    // The modulus for which the beam has its length.
    let (mut low, mut high) = (0.5f64.sqrt(), 1.0 - 1e-9);
    for _ in 0..100 {
        let p = 0.5 * (low + high);
        if between(p, &|root| 1.0 / root) < load.sqrt() { low = p } else { high = p }
    }
    let p = 0.5 * (low + high);
    let tip_slope_sine = 2.0 * p * p - 1.0;
    [1.0 - 2.0 / load.sqrt() * between(p, &|root| root), 1.0 - (2.0 * tip_slope_sine / load).sqrt()]
}

/// Order in 1/n between the first and the last of errors at 8, 16, 32 and 64 sections.
fn order(errors: [f64; 4]) -> f64 {
    (errors[0] / errors[3]).log2() / 3.0
}

#[test]
fn the_elliptic_integrals_give_the_published_table() {
    for (load, deflection, shortening) in
        [(1.0, 0.30172, 0.05643), (2.0, 0.49346, 0.16064), (5.0, 0.71379, 0.38763), (10.0, 0.81061, 0.55500)]
    {
        let [found, shortened] = bisshopp_drucker(load);
        assert!((found - deflection).abs() < 6e-6, "deflection {found} at {load}");
        assert!((shortened - shortening).abs() < 6e-6, "shortening {shortened} at {load}");
    }
}

#[test]
fn a_cantilever_lies_as_in_bisshopp_and_drucker() {
    let exact = |load: f64| {
        let [deflection, shortening] = bisshopp_drucker(load);
        [1.0 - shortening, -deflection]
    };
    let error = |sections, load: f64| distance(tip(balanced, sections, 1.0, Load { spread: 0.0, tip: load }, FRAC_PI_2), exact(load));
    for tenths in 1..=100 {
        let load = tenths as f64 / 10.0;
        let exact = exact(load);
        for sections in [2, 4, 6, 7, 8, 12, 16] {
            let error = distance(tip(balanced, sections, 1.0, Load { spread: 0.0, tip: load }, FRAC_PI_2), exact);
            let count = sections as f64;
            assert!(error * count * count < if sections < 6 { 0.25 } else { 0.2 }, "{sections} sections at {load}: {error}");
        }
    }
    for load in [0.5, 2.0, 10.0] {
        let order = order([8, 16, 32, 64].map(|sections| error(sections, load)));
        assert!((1.9..2.1).contains(&order), "order {order} at {load}");
    }
}

#[test]
fn a_component_lies_under_its_weight_as_the_heavy_elastica() {
    let mut squares = [0.0; 4];
    for (tip_fraction, weight, unbent_rad, bound) in [
        (1.0, 2.0, 0.3, 0.016),
        (0.5, 6.0, 0.6, 0.09),
        (0.1, 6.0, 0.3, 0.09),
        (0.5, 40.0, 1.2, 0.6),
        (1.0, 12.0, 0.0, 0.8),
        (0.3, 20.0, 2.6, 0.13),
    ] {
        let exact = elastica::heavy_tip(tip_fraction, weight, unbent_rad);
        for (sections, square) in [8, 16, 32, 64].into_iter().zip(&mut squares) {
            let error = distance(tip(balanced, sections, tip_fraction, Load { spread: weight, tip: 0.0 }, unbent_rad), exact);
            let count = sections as f64;
            assert!(error * count * count < bound, "{sections} sections of weight {weight}: {error}");
            *square += error * error;
        }
    }
    let order = order(squares.map(f64::sqrt));
    assert!((1.8..2.2).contains(&order), "order {order} of {squares:?}");
}

#[test]
fn the_paper_s_pass_is_good_for_small_loads_alone() {
    let far = |sections, weight: f64, unbent_rad: f64| {
        let found = tip(one_pass, sections, 0.5, Load { spread: weight, tip: 0.0 }, unbent_rad);
        distance(found, elastica::heavy_tip(0.5, weight, unbent_rad))
    };
    let light = Load { spread: 0.0, tip: 0.05 };
    assert!(
        distance(tip(one_pass, 64, 0.5, light, 0.8), tip(balanced, 64, 0.5, light, 0.8)) < 0.001,
        "what hangs at the tip pulls the same way"
    );
    assert!(far(8, 0.5, 0.3) < 0.001 && far(8, 2.0, 0.3) < 0.015);
    // The model error doesn't vanish with more sections.
    assert!(far(8, 6.0, 0.3) > 0.2 && far(64, 6.0, 0.3) > 0.2);
    assert!(far(8, 6.0, 1.2) > 0.04 && far(64, 6.0, 1.2) > 0.04);
}

#[test]
fn an_upright_component_buckles_at_the_load_of_greenhill() {
    // A uniform column buckles under its own weight at 7.8373·EI/L² (Greenhill 1881), one with a weight at its tip at π²/4 (Euler).
    for (load, critical) in [(Load { spread: 1.0, tip: 0.0 }, 7.8373), (Load { spread: 0.0, tip: 1.0 }, PI * PI / 4.0)] {
        let times = |factor: f64| Load { spread: load.spread * factor, tip: load.tip * factor };
        let aside = |factor: f64| tip(balanced, 64, 1.0, times(factor * critical), 0.0)[0];
        assert!(aside(0.99) < 1e-9, "{}", aside(0.99));
        assert!(aside(1.01) > 0.1 && aside(1.02) > aside(1.01));
    }
}

/// Potential energy of a chain's springs and load.
fn energy(joints: &[f64], load: Load, unbent_rad: f64, bends_rad: &[f64]) -> f64 {
    let count = joints.len();
    let mut below_rad = 0.0;
    let mut sum = 0.0;
    for (section, (&joint, &bend_rad)) in joints.iter().zip(bends_rad).enumerate() {
        sum += 0.5 * joint * (bend_rad - below_rad).powi(2);
        sum += load.turning(section, count) * (unbent_rad + bend_rad).cos();
        below_rad = bend_rad;
    }
    sum
}

proptest! {
    #[test]
    fn every_joint_is_in_balance_and_the_balance_is_stable(
        sections in 1_usize..20, tip_fraction in 0.01..1.0f64, spread in 0.0..60.0f64, at_tip in 0.0..20.0f64, unbent in 0.01..PI,
        stir in proptest::array::uniform20(-1.0..1.0f64),
    ) {
        let (joints, load) = (joints(sections, tip_fraction), Load { spread, tip: at_tip });
        let mut bends = vec![0.0; sections];
        balanced(&joints, load, unbent, &mut bends);
        let mut found = vec![0.0; sections];
        moments(load, unbent, &bends, &mut found);
        found[0] -= 0.25 * load.held(0, sections) * (unbent + bends[0]).sin();
        let mut below = 0.0;
        for ((&bend, &moment), &joint) in bends.iter().zip(&found).zip(&joints) {
            prop_assert!(bend >= below - 1e-12 && unbent + bend <= PI + 1e-12, "bent to one side, and no further than the load");
            prop_assert!((joint * (bend - below) - moment).abs() < 1e-8 * (1.0 + joint), "{} and {moment}", joint * (bend - below));
            below = bend;
        }
        let stirred: Vec<f64> = bends.iter().zip(stir).map(|(bend, by)| bend + 1e-3 * by).collect();
        prop_assert!(energy(&joints, load, unbent, &stirred) > energy(&joints, load, unbent, &bends) - 1e-12);
    }

    #[test]
    fn the_shape_grows_with_the_load_without_a_jump(tip_fraction in 0.05..1.0f64, unbent in 0.1..3.1f64) {
        let joints = joints(8, tip_fraction);
        let mut before = [0.0; 8];
        for step in 0..400 {
            let mut bends = [0.0; 8];
            balanced(&joints, Load { spread: 0.05 * f64::from(step), tip: 0.0 }, unbent, &mut bends);
            prop_assert!((0..8).all(|i| bends[i] >= before[i] - 1e-9 && bends[i] - before[i] < 0.3));
            before = bends;
        }
    }

    #[test]
    fn no_load_is_too_large_or_too_small(sections in 1_usize..9, tip_fraction in 0.01..1.0f64, tenfold in -30.0..30.0f64, unbent in 0.0..=PI) {
        let joints = joints(sections, tip_fraction);
        let load = Load { spread: 10f64.powf(tenfold), tip: 0.0 };
        for way in [one_pass, balanced] {
            let mut bends = vec![f64::NAN; sections];
            way(&joints, load, unbent, &mut bends);
            prop_assert!(bends.iter().all(|bend| (-1e-12..=PI - unbent + 1e-12).contains(bend)), "{bends:?}");
            // An upper bound for small bends: the moment at the clamp, applied at all joints.
            let most = if unbent > 0.1 { load.spread / tip_fraction } else { PI };
            prop_assert!(bends.iter().all(|&bend| bend < most + 1e-12), "{bends:?}");
        }
    }
}
