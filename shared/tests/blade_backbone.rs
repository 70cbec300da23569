//! The curve through a blade's control points and the outline about it.

use proptest::prelude::*;
use shared::plant::blade::backbone::{backbone_m, segment_points_m};
use shared::plant::blade::{LINKS, Leans, Sway};

fn lean([angle, heading]: [f32; 2]) -> [f32; 2] {
    [angle * heading.cos(), angle * heading.sin()]
}

fn distance(a: [f32; 3], b: [f32; 3]) -> f32 {
    (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f32>().sqrt()
}

/// Length of the curve of a blade of 1 m (m).
fn curve_m(points_m: &[[f32; 3]; LINKS]) -> f32 {
    const PARTS: usize = 256;
    let at = |n: usize| backbone_m(points_m, n as f32 / PARTS as f32);
    (0..PARTS).map(|n| distance(at(n), at(n + 1))).sum()
}

fn angles() -> impl Strategy<Value = [[f32; 2]; LINKS]> {
    let one = || (0.0_f32..1.5, 0.0_f32..6.3).prop_map(|(angle, heading)| [angle, heading]);
    [one(), one(), one()]
}

proptest! {
    #[test]
    fn the_curve_passes_through_the_control_points(angles in angles()) {
        let points_m = Sway::at_rest(angles.map(lean)).points_m(1.0);
        prop_assert_eq!(backbone_m(&points_m, 0.0), [0.0; 3]);
        for (n, point_m) in points_m.into_iter().enumerate() {
            prop_assert!(distance(backbone_m(&points_m, (n + 1) as f32 / 3.0), point_m) < 2e-6);
        }
    }

    #[test]
    fn the_curve_is_as_long_as_the_blade(heading in 0.0_f32..6.3, mean in 0.0_f32..1.5) {
        // As wind and weight hold it.
        let shapes: [[f32; LINKS]; 2] = [[0.63, 1.13, 1.24], [1.0; LINKS]];
        for shape in shapes {
            let leans: Leans = shape.map(|share| lean([(share * mean).min(1.5), heading]));
            let length_m = curve_m(&Sway::at_rest(leans).points_m(1.0));
            prop_assert!((0.999..1.03).contains(&length_m), "{length_m} m at {mean} rad");
        }
    }

    #[test]
    fn however_links_are_thrown_about_the_curve_is_at_most_longer_by_half(angles in angles()) {
        let length_m = curve_m(&Sway::at_rest(angles.map(lean)).points_m(1.0));
        prop_assert!((0.99..1.5).contains(&length_m), "{length_m} m");
    }

    #[test]
    fn the_outline_turns_evenly_from_its_side_to_across_its_lean(angles in angles(), side_rad in -7.0_f32..7.0, width_m in 0.001_f32..0.1) {
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
