//! Backbone curve of a blade's control points, and the outline about it.

use prairie_core::hash::hash3;
use prairie_core::plant::blade::backbone::{backbone_m, drawn_out_m, segment_points_m};
use prairie_core::plant::blade::contact::settle;
use prairie_core::plant::blade::deflection::WIND_SHAPE;
use prairie_core::plant::blade::lean::direction;
use prairie_core::plant::blade::{LINKS, Leans, Sway};
use proptest::prelude::*;

fn lean([angle, heading]: [f32; 2]) -> [f32; 2] {
    [angle * heading.cos(), angle * heading.sin()]
}

fn distance(a: [f32; 3], b: [f32; 3]) -> f32 {
    (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f32>().sqrt()
}

/// Length of the curve of control points, measured with this many chords (m).
fn curve_m(points_m: &[[f32; 3]; LINKS], chords: u32) -> f32 {
    let at = |n: u32| backbone_m(points_m, n as f32 / chords as f32);
    (0..chords).map(|n| distance(at(n), at(n + 1))).sum()
}

fn angles() -> impl Strategy<Value = [[f32; 2]; LINKS]> {
    let one = || (0.0_f32..1.5, 0.0_f32..6.3).prop_map(|(angle, heading)| [angle, heading]);
    [one(), one(), one()]
}

proptest! {
    #[test]
    fn the_curve_starts_along_the_lowest_link_and_ends_along_the_topmost(angles in angles()) {
        let points_m = Sway::at_rest(angles.map(lean)).points_m(1.0);
        prop_assert_eq!(backbone_m(&points_m, 0.0), [0.0; 3]);
        prop_assert!(distance(backbone_m(&points_m, 1.0), points_m[2]) < 1e-6);
        let (low, high) = (backbone_m(&points_m, 1e-3), backbone_m(&points_m, 1.0 - 1e-3));
        prop_assert!(distance(low.map(|v| v * 1e3 / 3.0), points_m[0]) < 2e-3);
        let topmost = [0, 1, 2].map(|i| points_m[2][i] - points_m[1][i]);
        prop_assert!(distance([0, 1, 2].map(|i| (points_m[2][i] - high[i]) * 1e3 / 3.0), topmost) < 3e-3);
    }

    #[test]
    fn a_drawn_blade_keeps_its_length_for_any_leans(angles in angles(), length_m in 0.05_f32..3.0, segments in 2_u32..16) {
        let points_m = Sway::at_rest(angles.map(lean)).points_m(length_m);
        let drawn_m = drawn_out_m(&points_m, length_m, segments);
        prop_assert!((curve_m(&drawn_m, segments) / length_m - 1.0).abs() < 1e-5);
        // All move along the line from the root, the lower two by one factor.
        let [bulge, factor] = [0, 2].map(|point| distance(drawn_m[point], [0.0; 3]) / distance(points_m[point], [0.0; 3]));
        prop_assert!(bulge >= factor * (1.0 - 1e-5));
        for (point, factor) in [bulge, bulge, factor].into_iter().enumerate() {
            prop_assert!(distance(drawn_m[point], points_m[point].map(|v| v * factor)) < 1e-4 * length_m);
        }
    }

    #[test]
    fn the_drawn_tip_of_a_blade_with_a_right_angle_is_where_the_blade_ends(
        below in (0.0_f32..1.5, 0.0_f32..6.3), around in 0.0_f32..6.3, is_low in any::<bool>(), segments in 3_u32..16,
    ) {
        // Straight up to the corner, from there straight at a right angle to that.
        let (along, north) = (direction(lean([below.0, below.1])), [-below.1.sin(), 0.0, below.1.cos()]);
        let up: [f32; 3] = [along[1] * north[2] - along[2] * north[1], along[2] * north[0] - along[0] * north[2], along[0] * north[1] - along[1] * north[0]];
        let across: [f32; 3] = std::array::from_fn(|i| around.cos() * north[i] + around.sin() * up[i]);
        let links = [along, if is_low { across } else { along }, across];
        let mut at = [0.0; 3];
        let points_m = links.map(|link| {
            at = std::array::from_fn(|i| at[i] + link[i] / 3.0);
            at
        });
        let off_m = distance(drawn_out_m(&points_m, 1.0, segments)[2], points_m[2]);
        prop_assert!(off_m < 0.02, "{off_m} of the length away");
        // Without the bulge, by one factor on all points, it is not.
        let strip_m = curve_m(&points_m, segments);
        prop_assert!((1.0 / strip_m - 1.0) * distance(points_m[2], [0.0; 3]) > 0.12, "{strip_m}");
    }

    #[test]
    fn a_blade_bent_by_wind_is_drawn_at_its_control_points(heading in 0.0_f32..6.3, mean in 0.0_f32..1.2) {
        let leans: Leans = WIND_SHAPE.map(|fraction| lean([fraction * mean, heading]));
        let points_m = Sway::at_rest(leans).points_m(1.0);
        let turn = (WIND_SHAPE[2] - WIND_SHAPE[0]) * mean;
        for segments in [3, 7] {
            let drawn_m = drawn_out_m(&points_m, 1.0, segments);
            prop_assert!(distance(drawn_m[2], points_m[2]) < 0.06 * turn * turn + 1e-5, "{} after a turn of {turn}", distance(drawn_m[2], points_m[2]));
            // The curve that the strip approximates, in length and position.
            let longer = curve_m(&drawn_m, 256) - 1.0;
            prop_assert!(longer < 1.4 * (turn / segments as f32).powi(2) / 24.0 + 1e-5, "{longer}");
            let n = segments as f32;
            for segment in 0..segments {
                let at = |i: f32| backbone_m(&drawn_m, (segment as f32 + i) / n);
                let [from, to] = [at(0.0), at(1.0)];
                let off_m = distance(at(0.5), [0, 1, 2].map(|i| 0.5 * (from[i] + to[i])));
                prop_assert!(off_m < 2.0 * turn / (8.0 * n * n) + 1e-5, "{off_m} m of a turn of {turn} in {n} segments");
            }
        }
    }

    #[test]
    fn no_curve_is_below_a_plane_that_its_control_points_are_above(angles in angles(), slope in [-0.8_f32..0.8, -0.8_f32..0.8], t in 0.0_f32..1.0) {
        let long = (1.0 + slope[0] * slope[0] + slope[1] * slope[1]).sqrt();
        let normal = [-slope[0] / long, 1.0 / long, -slope[1] / long];
        let points_m = settle(&Sway::at_rest(angles.map(lean)), 1.0, normal, &[]).points_m(1.0);
        let at = backbone_m(&drawn_out_m(&points_m, 1.0, 7), t);
        prop_assert!((0..3).map(|i| at[i] * normal[i]).sum::<f32>() > -1e-6);
    }

    #[test]
    fn the_outline_twists_evenly_from_its_side_to_across_its_lean(angles in angles(), side_rad in -7.0_f32..7.0, width_m in 0.001_f32..0.1) {
        const SEGMENTS: usize = 12;
        let points_m = Sway::at_rest(angles.map(lean)).points_m(1.0);
        let side = |n: usize| {
            let t = n as f32 / SEGMENTS as f32;
            let [left, right] = segment_points_m(&points_m, side_rad, t, width_m);
            let centre = backbone_m(&points_m, t);
            assert!((0..3).all(|i| (0.5 * (left[i] + right[i]) - centre[i]).abs() < 1e-6), "about the curve");
            [(right[0] - left[0]) / width_m, (right[1] - left[1]) / width_m, (right[2] - left[2]) / width_m]
        };
        let between = |a: [f32; 3], b: [f32; 3]| (a[2] * b[0] - a[0] * b[2]).atan2(a[0] * b[0] + a[2] * b[2]);
        let first = side(0);
        prop_assert!((first[0] - side_rad.cos()).abs() < 1e-3 && (first[2] - side_rad.sin()).abs() < 1e-3);
        let whole = between(side(SEGMENTS), first);
        prop_assert!(whole.abs() < 0.5 * std::f32::consts::PI + 1e-3, "by the lesser of both turns");
        for n in 1..=SEGMENTS {
            let step = between(side(n), side(n - 1));
            prop_assert!((step.abs() - whole.abs() / SEGMENTS as f32).abs() < 2e-3, "{step} of {whole}");
            prop_assert!(side(n)[1] == 0.0 && (side(n)[0].hypot(side(n)[2]) - 1.0).abs() < 2e-3);
        }
        let (tip, [x, _, z]) = (side(SEGMENTS), points_m[LINKS - 1]);
        if x.hypot(z) > 1e-3 {
            prop_assert!((tip[0] * x + tip[2] * z).abs() / x.hypot(z) < 2e-3, "across the lean");
        }
    }
}

#[test]
fn no_drawn_tip_is_farther_from_the_simulated_one_than_by_one_factor() {
    let random = |place: [u32; 3]| (hash3(place)[0] >> 8) as f32 / (1 << 24) as f32;
    for segments in [2, 3, 7] {
        for number in 0..10_000 {
            let leans = std::array::from_fn(|link| lean([1.5 * random([number, link as u32, 1]), 6.3 * random([number, link as u32, 2])]));
            let points_m = Sway::at_rest(leans).points_m(1.0);
            let off_m = distance(drawn_out_m(&points_m, 1.0, segments)[2], points_m[2]);
            let by_one_m = (1.0 / curve_m(&points_m, segments) - 1.0) * distance(points_m[2], [0.0; 3]);
            assert!(off_m <= by_one_m + 1e-5, "{off_m} instead of {by_one_m} with {segments} segments");
        }
    }
}
