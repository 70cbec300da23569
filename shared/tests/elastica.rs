//! Components of plants compared with the elastica: a beam of bending stiffness EI whose shape is exact at any bend.

use prairie_core::plant::underbrush::elastica;
use prairie_core::plant::underbrush::rest::{Load, balanced, joints};
use prairie_core::scene::parse_underbrush;
use std::f64::consts::FRAC_PI_2;

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

#[test]
fn the_elastica_has_published_values() {
    // Bisshopp & Drucker 1945: deflection and shortening under a load at the tip.
    for (load, deflection, shortening) in
        [(1.0, 0.30172, 0.05643), (2.0, 0.49346, 0.16064), (5.0, 0.71379, 0.38763), (10.0, 0.81061, 0.55500)]
    {
        let [aside, up] = elastica::tip(1.0, Load { spread: 0.0, tip: load }, FRAC_PI_2);
        assert!(distance([1.0 - aside, -up], [shortening, deflection]) < 8e-6, "{aside}, {up} at {load}");
    }
    // A light horizontal beam droops by w·L⁴/(8·EI).
    assert!((elastica::tip(1.0, Load { spread: 0.01, tip: 0.0 }, FRAC_PI_2)[1] + 0.01 / 8.0).abs() < 1e-6);
}

/// Weights over EI/L² of components, and angles of their unbent axes from upright (rad).
const LIGHT: [f64; 7] = [0.1, 0.3, 1.0, 3.0, 6.0, 12.0, 25.0];
const HEAVY: [f64; 3] = [50.0, 100.0, 200.0];
const UNBENT_RAD: [f64; 11] = [0.05, 0.1, 0.2, 0.4, 0.7, 1.0, 1.3, 1.6, 2.0, 2.5, 3.0];

/// Weight, angle, rigidity of the tip, and position of the tip.
type Case = (f64, f64, f64, [f64; 2]);

fn under_their_weight(weights: &[f64]) -> Vec<Case> {
    let angles = weights.iter().flat_map(|&weight| UNBENT_RAD.map(|unbent_rad| (weight, unbent_rad)));
    // Including upright ones that have buckled.
    let all = angles.chain(weights.iter().filter(|weight| **weight > 8.5).map(|&weight| (weight, 0.0)));
    let exact = |tip_fraction, weight, unbent_rad| elastica::tip(tip_fraction, Load { spread: weight, tip: 0.0 }, unbent_rad);
    all.flat_map(|(weight, angle)| [1.0, 0.3].map(|tip_fraction| (weight, angle, tip_fraction, exact(tip_fraction, weight, angle))))
        .collect()
}

/// Error of the tip of a component with this many sections, in each case.
fn errors(sections: usize, cases: &[Case]) -> Vec<f64> {
    let mut bends_rad = vec![0.0; sections];
    let error = |&(weight, unbent_rad, tip_fraction, exact): &Case| {
        balanced(&joints(sections, tip_fraction), Load { spread: weight, tip: 0.0 }, unbent_rad, &mut bends_rad);
        let sum = |part: fn(f64) -> f64| bends_rad.iter().map(|bend_rad| part(unbent_rad + bend_rad)).sum::<f64>() / sections as f64;
        distance([sum(f64::sin), sum(f64::cos)], exact)
    };
    cases.iter().map(error).collect()
}

/// Slope of the line through the logarithms of counts and errors, with the sign changed.
fn order(errors: &[(usize, f64)]) -> f64 {
    let logs: Vec<[f64; 2]> = errors.iter().map(|&(count, error)| [(count as f64).ln(), error.ln()]).collect();
    let mean = |axis: usize| logs.iter().map(|at| at[axis]).sum::<f64>() / logs.len() as f64;
    let [x, y] = [mean(0), mean(1)];
    -logs.iter().map(|at| (at[0] - x) * (at[1] - y)).sum::<f64>() / logs.iter().map(|at| (at[0] - x).powi(2)).sum::<f64>()
}

#[test]
fn at_every_angle_and_weight_the_error_of_a_component_falls_with_the_square_of_its_sections() {
    // Error times n², with n sections.
    for (weights, bound) in [(&LIGHT[..], 1.0), (&HEAVY, 4.0)] {
        let cases = under_their_weight(weights);
        let mut all = vec![];
        for sections in [8, 16, 32, 64] {
            let errors = errors(sections, &cases);
            for (error, case) in errors.iter().zip(&cases) {
                assert!(error * (sections * sections) as f64 <= bound, "{error} with {sections} sections: {case:?}");
            }
            all.push((sections, (errors.iter().map(|error| error * error).sum::<f64>() / cases.len() as f64).sqrt()));
        }
        let order = order(&all);
        assert!((1.9..2.25).contains(&order), "order {order} of {all:?}");
    }
}

#[test]
fn the_worked_edit_of_a_species_gives_what_the_readme_says() {
    let species = parse_underbrush(include_str!("../../server/scenes/species.toml")).expect("the species that ship");
    let mut components = species.iter().flat_map(|species| &species.components);
    let leaf =
        components.find(|component| (component.length_m, component.stiffness_n_m2) == (0.75, 0.002)).expect("the leaf of the README");
    let (length_m, unbent_rad, sections) = (f64::from(leaf.length_m), f64::from(leaf.angle_rad), leaf.sections as usize);
    for (stiffness_n_m2, [weight, aside_m, up_m, top_m, off_upright]) in
        [(0.002, [3.9, 0.50, 0.55, 0.55, 54.0]), (0.008, [1.0, 0.28, 0.70, 0.70, 23.0]), (0.001, [7.7, 0.66, 0.07, 0.18, 113.0_f64])]
    {
        let load = f64::from(leaf.mass_kg) * prairie_core::GRAVITY_M_PER_S2 * length_m * length_m / stiffness_n_m2;
        let mut bends_rad = vec![0.0; sections];
        balanced(&joints(sections, leaf.tip_stiffness_share.into()), Load { spread: load, tip: 0.0 }, unbent_rad, &mut bends_rad);
        let (mut at_m, mut highest_m) = ([0.0_f64; 2], 0.0_f64);
        for bend_rad in &bends_rad {
            let (aside, up) = (unbent_rad + bend_rad).sin_cos();
            at_m = [at_m[0] + aside * length_m / sections as f64, at_m[1] + up * length_m / sections as f64];
            highest_m = highest_m.max(at_m[1]);
        }
        let tip_rad = unbent_rad + bends_rad[sections - 1];
        assert!((load - weight).abs() < 0.1 && (tip_rad.to_degrees() - off_upright).abs() < 3.0, "{load}, {tip_rad} rad");
        assert!(distance(at_m, [aside_m, up_m]) < 0.02 && (highest_m - top_m).abs() < 0.02, "{at_m:?}, {highest_m} m");
    }
}
