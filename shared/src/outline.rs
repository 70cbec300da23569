//! Outlines seen from above: simple polygons, and their decomposition into convex parts (Chen & Johan §6).
//!
//! Triangulated by ear clipping (Meisters 1975); triangles are then merged across every diagonal whose ends both stay convex (Hertel & Mehlhorn
//! 1983), which gives at most four times the smallest number of parts.

use thiserror::Error;

/// Smallest area of an outline (m²).
const LEAST_AREA_M2: f64 = 0.01;

/// Reasons why corners are not a valid outline.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum OutlineFault {
    /// Fewer than three corners.
    #[error("has {0} corners, which enclose no area; allowed: 3 and more")]
    TooFew(usize),
    /// A coordinate that is NaN or infinite.
    #[error("has corner {number} at ({x_m}, {z_m}); allowed: finite numbers")]
    NotFinite {
        /// Index of the corner, from 1.
        number: usize,
        /// X of the corner (m).
        x_m: f32,
        /// Z of the corner (m).
        z_m: f32,
    },
    /// Two edges that cross or touch.
    #[error(
        "has edges that cross or touch, from corner {first} and from corner {second}; allowed: edges that meet at their common corners only"
    )]
    Crossing {
        /// Start corner of the first edge, from 1.
        first: usize,
        /// Start corner of the second edge, from 1.
        second: usize,
    },
    /// Too small an area.
    #[error("encloses {0:.4} m²; allowed: at least 0.01")]
    NoArea(f64),
}

/// Convex part of an outline.
#[derive(Clone, Debug, PartialEq)]
pub struct ConvexPart {
    /// Corners in order, turning from +X towards +Z (m).
    pub corners_m: Vec<[f32; 2]>,
    /// Whether the edge from each corner to the next is interior, where another part continues.
    pub seams: Vec<bool>,
}

/// Checks that corners, in either order, are a valid outline.
///
/// # Errors
/// [`OutlineFault`]: fewer than three corners, NaN or infinite coordinates, edges that cross or touch, or an area below 0.01 m².
pub fn check(corners_m: &[[f32; 2]]) -> Result<(), OutlineFault> {
    let count = corners_m.len();
    if count < 3 {
        return Err(OutlineFault::TooFew(count));
    }
    if let Some(at) = corners_m.iter().position(|corner| !corner.iter().all(|m| m.is_finite())) {
        let [x_m, z_m] = corners_m[at];
        return Err(OutlineFault::NotFinite { number: at + 1, x_m, z_m });
    }
    let area_m2 = area_m2(corners_m).abs();
    if area_m2 < LEAST_AREA_M2 {
        return Err(OutlineFault::NoArea(area_m2));
    }
    let edge = |at: usize| [corners_m[at], corners_m[(at + 1) % count]];
    for second in 0..count {
        for first in 0..second {
            let meet = match (second - first, first + count - second) {
                (1, _) => folds(corners_m[first], corners_m[second], corners_m[(second + 1) % count]),
                (_, 1) => folds(corners_m[second], corners_m[first], corners_m[first + 1]),
                _ => touch(edge(first), edge(second)),
            };
            if meet {
                return Err(OutlineFault::Crossing { first: first + 1, second: second + 1 });
            }
        }
    }
    Ok(())
}

/// Whether a point is within an outline, corners in either order; only + − × ÷ are in it. Twin of `is_in_outline` in the client's `plants/blade.wgsl`.
pub fn contains(corners_m: &[[f32; 2]], [x, z]: [f32; 2]) -> bool {
    let next = corners_m.iter().cycle().skip(1);
    let crosses = |(a, b): &(&[f32; 2], &[f32; 2])| (a[1] <= z) != (b[1] <= z) && a[0] + (b[0] - a[0]) * ((z - a[1]) / (b[1] - a[1])) > x;
    corners_m.iter().zip(next).filter(crosses).count() % 2 == 1
}

/// Convex parts of a valid outline (see [`check`]), which cover it without overlap.
pub fn convex_parts(corners_m: &[[f32; 2]]) -> Vec<ConvexPart> {
    let corners = without_straight_corners(corners_m);
    let mut parts = ears(&corners);
    merge(&corners, &mut parts);
    let part = |indices: Vec<usize>| {
        let next = indices.iter().cycle().skip(1);
        let seams = indices.iter().zip(next).map(|(&a, &b)| b != (a + 1) % corners.len()).collect();
        ConvexPart { corners_m: indices.iter().map(|&at| corners[at]).collect(), seams }
    };
    parts.into_iter().map(part).collect()
}

/// The corners at which the outline turns, in order from +X towards +Z.
fn without_straight_corners(corners_m: &[[f32; 2]]) -> Vec<[f32; 2]> {
    let mut corners = corners_m.to_vec();
    if area_m2(&corners) < 0.0 {
        corners.reverse();
    }
    let count = corners.len();
    let turns = |at: usize| turn(corners[(at + count - 1) % count], corners[at], corners[(at + 1) % count]) != 0.0;
    (0..count).filter(|&at| turns(at)).map(|at| corners[at]).collect()
}

/// Triangles as indices of corners.
fn ears(corners: &[[f32; 2]]) -> Vec<Vec<usize>> {
    let mut left: Vec<usize> = (0..corners.len()).collect();
    let mut triangles = vec![];
    while left.len() > 2 {
        let count = left.len();
        let around = |at: usize| [left[(at + count - 1) % count], left[at], left[(at + 1) % count]];
        let is_ear = |&at: &usize| {
            let ear = around(at);
            let [a, b, c] = ear.map(|corner| corners[corner]);
            let inside = |p: [f32; 2]| turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0;
            turn(a, b, c) > 0.0 && left.iter().all(|other| ear.contains(other) || !inside(corners[*other]))
        };
        // The remaining polygon of a valid outline always has an ear, unless rounding has made it a line.
        let Some(at) = (0..count).find(is_ear) else { break };
        triangles.push(around(at).to_vec());
        left.remove(at);
    }
    triangles
}

/// Merges parts across common diagonals while the result stays convex.
fn merge(corners: &[[f32; 2]], parts: &mut Vec<Vec<usize>>) {
    let mut one = 0;
    while one < parts.len() {
        let merged = (one + 1..parts.len()).find_map(|other| Some((other, joined(corners, &parts[one], &parts[other])?)));
        match merged {
            Some((other, whole)) => {
                parts.remove(other);
                parts[one] = whole;
            }
            None => one += 1,
        }
    }
}

/// Merges two parts with a common diagonal, if the result is convex.
fn joined(corners: &[[f32; 2]], one: &[usize], other: &[usize]) -> Option<Vec<usize>> {
    let (n, m) = (one.len(), other.len());
    let (i, j) = (0..n).find_map(|i| {
        let (a, b) = (one[i], one[(i + 1) % n]);
        (0..m).find(|&j| (other[j], other[(j + 1) % m]) == (b, a)).map(|j| (i, j))
    })?;
    // Around the first from the diagonal's end to its start, then around the second between them.
    let whole: Vec<usize> = (1..=n).map(|step| one[(i + step) % n]).chain((2..m).map(|step| other[(j + step) % m])).collect();
    let count = whole.len();
    let bulges = |at: usize| {
        let [a, b, c] = [at + count - 1, at, at + 1].map(|at| corners[whole[at % count]]);
        turn(a, b, c) >= 0.0
    };
    (0..count).all(bulges).then_some(whole)
}

/// Area (m²), positive where the corners turn from +X towards +Z.
fn area_m2(corners_m: &[[f32; 2]]) -> f64 {
    let next = corners_m.iter().cycle().skip(1);
    0.5 * corners_m.iter().zip(next).map(|(a, b)| f64::from(a[0]) * f64::from(b[1]) - f64::from(a[1]) * f64::from(b[0])).sum::<f64>()
}

/// Twice the signed area of a triangle: positive if the path `a`, `b`, `c` turns from +X towards +Z, 0 if it is straight.
fn turn(a: [f32; 2], b: [f32; 2], c: [f32; 2]) -> f64 {
    let [[ax, az], [bx, bz], [cx, cz]] = [a, b, c].map(|point| point.map(f64::from));
    (bx - ax) * (cz - az) - (bz - az) * (cx - ax)
}

/// Whether the path from `a` to `b` to `c` stops or doubles back.
fn folds(a: [f32; 2], b: [f32; 2], c: [f32; 2]) -> bool {
    let along = f64::from(b[0] - a[0]) * f64::from(c[0] - b[0]) + f64::from(b[1] - a[1]) * f64::from(c[1] - b[1]);
    a == b || b == c || turn(a, b, c) == 0.0 && along < 0.0
}

/// Whether two segments have a point in common.
fn touch([a, b]: [[f32; 2]; 2], [c, d]: [[f32; 2]; 2]) -> bool {
    let between =
        |p: [f32; 2], q: [f32; 2], r: [f32; 2]| (0..2).all(|axis| (p[axis].min(q[axis])..=p[axis].max(q[axis])).contains(&r[axis]));
    let sides = [turn(a, b, c), turn(a, b, d), turn(c, d, a), turn(c, d, b)];
    let on = [between(a, b, c), between(a, b, d), between(c, d, a), between(c, d, b)];
    let crosses = sides[0] * sides[1] < 0.0 && sides[2] * sides[3] < 0.0;
    crosses || sides.into_iter().zip(on).any(|(side, on)| side == 0.0 && on)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const U: [[f32; 2]; 8] = [[-2.0, -2.5], [-1.0, -2.5], [-1.0, 1.5], [1.0, 1.5], [1.0, -2.5], [2.0, -2.5], [2.0, 2.5], [-2.0, 2.5]];

    fn assert_made_of(corners: &[[f32; 2]], parts: &[ConvexPart]) {
        let whole: f64 = parts.iter().map(|part| area_m2(&part.corners_m)).sum();
        assert!((whole - area_m2(corners).abs()).abs() < 1e-4 * whole, "areas: {whole}");
        for part in parts {
            let n = part.corners_m.len();
            let convex = (0..n).all(|i| turn(part.corners_m[i], part.corners_m[(i + 1) % n], part.corners_m[(i + 2) % n]) >= 0.0);
            assert!(convex && n == part.seams.len(), "{part:?}");
        }
        for i in 0..40 {
            for j in 0..40 {
                let p = [-5.0 + 0.25 * i as f32 + 0.013, -5.0 + 0.25 * j as f32 + 0.017];
                let covered = parts.iter().filter(|part| contains(&part.corners_m, p)).count();
                assert_eq!(covered, usize::from(contains(corners, p)), "{p:?}");
            }
        }
    }

    #[test]
    fn a_u_is_three_parts_with_two_seams() {
        assert_eq!(check(&U), Ok(()));
        for corners in [U.to_vec(), U.iter().rev().copied().collect()] {
            let parts = convex_parts(&corners);
            assert_made_of(&U, &parts);
            assert_eq!(parts.len(), 3);
            assert_eq!(parts.iter().flat_map(|part| &part.seams).filter(|&&seam| seam).count(), 4, "both sides of both seams");
        }
    }

    #[test]
    fn convex_outlines_stay_whole() {
        let hexagon = [[2.0, 0.0], [1.0, 1.7], [0.0, 1.7], [-1.0, 1.7], [-2.0, 0.0], [-1.0, -1.7], [1.0, -1.7]];
        let parts = convex_parts(&hexagon);
        assert_eq!((parts.len(), parts[0].corners_m.len()), (1, 6), "the straight corner goes");
        assert!(parts[0].seams.iter().all(|seam| !seam));
    }

    #[test]
    fn faults_of_outlines_are_reported() {
        let told = |corners: &[[f32; 2]]| check(corners).map_err(|fault| fault.to_string()).unwrap_err();
        assert!(told(&[]).starts_with("has 0 corners, which enclose no area"));
        assert!(told(&U[..2]).starts_with("has 2 corners"));
        assert!(told(&[[0.0, 0.0], [1.0, f32::NAN], [1.0, 1.0]]).starts_with("has corner 2 at (1, NaN)"));
        assert!(told(&[[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]]).starts_with("encloses 0.0000 m²"));
        assert!(told(&[[0.0, 0.0], [4.0, 4.0], [4.0, 0.0], [0.0, 3.0]]).contains("from corner 1 and from corner 3"));
        assert!(told(&[[0.0, 0.0], [4.0, 0.0], [1.0, 0.0], [1.0, 4.0]]).contains("from corner 1 and from corner 2"), "folds back");
        assert!(told(&[[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [2.0, 0.0], [0.0, 4.0]]).contains("from corner 1 and from corner 3"), "touches");
    }

    proptest! {
        /// Stars about the origin have any number of concave corners and never cross themselves.
        #[test]
        fn stars_are_made_of_their_parts(radii in prop::collection::vec(0.5f32..4.5, 3..24)) {
            let step = std::f32::consts::TAU / radii.len() as f32;
            let corners: Vec<_> = radii.iter().enumerate().map(|(i, r)| [r * (i as f32 * step).cos(), r * (i as f32 * step).sin()]).collect();
            prop_assume!(check(&corners).is_ok());
            assert_made_of(&corners, &convex_parts(&corners));
        }

        #[test]
        fn no_corners_panic(corners in prop::collection::vec([-3i8..4, -3i8..4], 0..10)) {
            let corners: Vec<_> = corners.iter().map(|corner| corner.map(f32::from)).collect();
            if check(&corners).is_ok() {
                assert_made_of(&corners, &convex_parts(&corners));
            }
        }
    }
}
