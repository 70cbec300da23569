//! Contact: a blade that would penetrate the ground or a sphere is laid along it, link by link from the root (Zhang §§3.2.4 and 6.2), and a blade under a
//! flat object lies below its floor.

use super::lean::{direction, lean_of};
use super::{LINKS, Sway};
use crate::outline;

/// Smallest height of control points above the ground plane (m), if the blade is long enough for it.
pub const CLEARANCE_M: f32 = 0.015;

/// Sphere that pushes plants aside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Centre relative to the blade's root (m): X, height, Z.
    pub centre_m: [f32; 3],
    /// Radius (m).
    pub radius_m: f32,
}

/// Upright prism of any outline, such as a sled, under whose floor plants lie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slab<'a> {
    /// Centre relative to the blade's root (m): X, height, Z.
    pub centre_m: [f32; 3],
    /// Unit vectors to its right and to its back.
    pub right: [f32; 3],
    /// See `right`.
    pub back: [f32; 3],
    /// Half its height (m).
    pub half_height_m: f32,
    /// Distance of its farthest point from the centre (m).
    pub reach_m: f32,
    /// Corners seen from above in its own axes, to the right and to the back of the centre (m). It may be concave.
    pub outline_m: &'a [[f32; 2]],
}

/// Resolves the contacts of a blade of `length_m` after a step: every link keeps its length, ends above the ground plane through the root with the
/// unit normal `normal`, and passes outside of every sphere.
///
/// The lowest link that meets a sphere is turned until it is tangent to it, or ends on it if it is shorter than the tangent; the links above continue
/// in its direction, like a beam without other contacts (Zhang §6.2). A link that hangs over a sphere's centre turns away from that centre, any other
/// in the shortest direction. Where ground and spheres leave no room, the ground wins. The component of a link's rate towards an obstacle is removed.
pub fn settle(sway: &Sway, length_m: f32, normal: [f32; 3], spheres: &[Sphere]) -> Sway {
    settle_under(sway, length_m, normal, spheres, &[])
}

/// [`settle`] among slabs as well: a link that would be within a slab, or above one that it starts under, ends below its floor.
pub fn settle_under(sway: &Sway, length_m: f32, normal: [f32; 3], spheres: &[Sphere], slabs: &[Slab<'_>]) -> Sway {
    let link_m = length_m / LINKS as f32;
    let mut mended = *sway;
    let (mut below, mut tangent) = ([0.0_f32; 3], None);
    for link in 0..LINKS {
        let free = tangent.unwrap_or_else(|| direction(sway.lean_rad[link]));
        let mut along = free;
        // A sphere may push the link into another: two passes settle two spheres.
        for _ in 0..2 {
            for sphere in spheres {
                along = aside(along, below, link_m, sphere);
            }
        }
        for slab in slabs {
            along = beneath(along, below, link_m, slab);
        }
        if along != free {
            tangent = Some(along);
        }
        along = above_ground(along, below, link_m, normal);
        if along != direction(sway.lean_rad[link]) {
            let lean_rad = lean_of(along);
            mended.rate_rad_per_s[link] = without_approach(sway.rate_rad_per_s[link], sway.lean_rad[link], lean_rad);
            mended.lean_rad[link] = lean_rad;
        }
        below = add(below, along, link_m);
    }
    mended
}

/// Direction of a link from `below` that ends at least [`CLEARANCE_M`] above the ground, as close to `along` as possible.
fn above_ground(along: [f32; 3], below: [f32; 3], link_m: f32, normal: [f32; 3]) -> [f32; 3] {
    let rise = dot(along, normal);
    let needed = ((CLEARANCE_M - dot(below, normal)) / link_m).min(1.0);
    if rise >= needed { along } else { toward(along, normal, needed) }
}

/// Direction of a link from `below` that passes outside of a sphere, as close to `along` as possible.
fn aside(along: [f32; 3], below: [f32; 3], link_m: f32, sphere: &Sphere) -> [f32; 3] {
    let to = add(sphere.centre_m, below, -1.0);
    let (distance2, radius2) = (dot(to, to), sphere.radius_m * sphere.radius_m);
    let distance_m = distance2.sqrt().max(1e-6);
    let tangent2 = distance2 - radius2;
    let ahead = dot(along, to);
    let cosine = if tangent2 <= 0.0 {
        // Tangent to the sphere from its surface; from inside, more steeply outward with depth.
        -(-tangent2).sqrt() / distance_m
    } else {
        let entry2 = ahead * ahead - tangent2;
        if ahead <= 0.0 || entry2 <= 0.0 || ahead - entry2.sqrt() >= link_m {
            return along;
        }
        let tangent_m = tangent2.sqrt();
        if link_m >= tangent_m { tangent_m / distance_m } else { 0.5 * (link_m + tangent2 / link_m) / distance_m }
    };
    if ahead <= cosine * distance_m {
        return along;
    }
    let centre = to.map(|v| v / distance_m);
    let hangs_over = to[0] * to[0] + to[2] * to[2] < radius2;
    let out = if hangs_over { [-to[0], 0.0, -to[2]] } else { along };
    toward(out, centre, cosine.clamp(-1.0, 1.0))
}

/// Direction of a link from `below` that ends below the floor of a slab if it starts under the slab or ends within it, as close to `along` as possible. A
/// link that leans over the slab from beside it stays.
fn beneath(along: [f32; 3], below: [f32; 3], link_m: f32, slab: &Slab<'_>) -> [f32; 3] {
    let start = add(below, slab.centre_m, -1.0);
    let reach_m = slab.reach_m + link_m;
    if dot(start, start) > reach_m * reach_m {
        return along;
    }
    let end = add(start, along, link_m);
    let ([rx, ry, rz], [bx, by, bz]) = (slab.right, slab.back);
    let up = [by * rz - bz * ry, bz * rx - bx * rz, bx * ry - by * rx];
    let (low_m, high_m) = (dot(start, up), dot(end, up));
    let is_under = |at: [f32; 3]| outline::contains(slab.outline_m, [dot(at, slab.right), dot(at, slab.back)]);
    let meets =
        high_m > -slab.half_height_m && low_m < slab.half_height_m && (is_under(start) || (high_m < slab.half_height_m && is_under(end)));
    if meets { toward(along, up, ((-slab.half_height_m - low_m) / link_m).clamp(-1.0, 1.0)) } else { along }
}

/// Unit vector with the component `fraction` along the unit vector `axis`, and its remainder in the direction of that of `from`.
fn toward(from: [f32; 3], axis: [f32; 3], fraction: f32) -> [f32; 3] {
    let mut rest = add(from, axis, -dot(from, axis));
    if dot(rest, rest) < 1e-12 {
        // Any direction will do: take the coordinate axis most nearly perpendicular.
        let least = if axis[0].abs() < 0.6 { [1.0, 0.0, 0.0] } else { [0.0, 0.0, 1.0] };
        rest = add(least, axis, -dot(least, axis));
    }
    let across = ((1.0 - fraction * fraction).max(0.0) / dot(rest, rest)).sqrt();
    [0, 1, 2].map(|i| axis[i] * fraction + rest[i] * across)
}

/// A link's rate without its component back from the corrected lean `to` towards `from`.
fn without_approach(rate: [f32; 2], from: [f32; 2], to: [f32; 2]) -> [f32; 2] {
    let moved = [to[0] - from[0], to[1] - from[1]];
    let square = moved[0] * moved[0] + moved[1] * moved[1];
    let approach = (rate[0] * moved[0] + rate[1] * moved[1]).min(0.0) / square.max(1e-20);
    [rate[0] - approach * moved[0], rate[1] - approach * moved[1]]
}

fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn add(a: [f32; 3], b: [f32; 3], times: f32) -> [f32; 3] {
    [0, 1, 2].map(|i| a[i] + b[i] * times)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plant::blade::Leans;
    use proptest::prelude::*;

    const UP: [f32; 3] = [0.0, 1.0, 0.0];

    /// Largest depth of the links of a blade of 1 m in a sphere (m).
    fn depth_m(sway: &Sway, sphere: &Sphere) -> f32 {
        let mut below = [0.0; 3];
        let mut deepest = f32::NEG_INFINITY;
        for point in sway.points_m(1.0) {
            for step in 0..=32 {
                let fraction = step as f32 / 32.0;
                let at = [0, 1, 2].map(|i| below[i] + fraction * (point[i] - below[i]) - sphere.centre_m[i]);
                deepest = deepest.max(sphere.radius_m - dot(at, at).sqrt());
            }
            below = point;
        }
        deepest
    }

    fn lean() -> impl Strategy<Value = [f32; 2]> {
        (0.0_f32..1.5, 0.0_f32..6.3).prop_map(|(angle, heading)| [angle * heading.cos(), angle * heading.sin()])
    }

    proptest! {
        #[test]
        fn a_sphere_on_the_ground_is_left_by_every_blade_beside_it(
            leans in [lean(), lean(), lean()], x in -3.0_f32..3.0, z in -3.0_f32..3.0, radius_m in 0.2_f32..2.0, gap_m in 0.05_f32..0.5,
        ) {
            let sphere = Sphere { centre_m: [x, radius_m + gap_m, z], radius_m };
            let sway = settle(&Sway::at_rest(leans), 1.0, UP, &[sphere]);
            prop_assert!(depth_m(&sway, &sphere) < 0.01, "{} m deep: {:?}", depth_m(&sway, &sphere), sway.lean_rad);
            let points = sway.points_m(1.0);
            prop_assert!(points.iter().all(|point| point[1] > CLEARANCE_M - 1e-5), "{points:?}");
        }

        #[test]
        fn links_are_tangent_to_what_they_touch(heading in 0.0_f32..6.3, away_m in 0.1_f32..0.6) {
            // Upright blades under a ball whose centre is within reach.
            let sphere = Sphere { centre_m: [away_m * heading.cos(), 0.75, away_m * heading.sin()], radius_m: 0.7 };
            let sway = settle(&Sway::default(), 1.0, UP, &[sphere]);
            prop_assert!(depth_m(&sway, &sphere).abs() < 2e-3, "{} m deep", depth_m(&sway, &sphere));
            // Above the contact the blade is straight.
            let leans = sway.lean_rad;
            prop_assert!((leans[2][0] - leans[1][0]).hypot(leans[2][1] - leans[1][1]) < 1e-4, "{leans:?}");
        }

        #[test]
        fn slopes_are_not_passed_through(leans in [lean(), lean(), lean()], slope in [-0.8_f32..0.8, -0.8_f32..0.8]) {
            let length = (1.0 + slope[0] * slope[0] + slope[1] * slope[1]).sqrt();
            let normal = [-slope[0] / length, 1.0 / length, -slope[1] / length];
            let points = settle(&Sway::at_rest(leans), 1.0, normal, &[]).points_m(1.0);
            prop_assert!(points.iter().all(|&point| dot(point, normal) > CLEARANCE_M - 1e-4), "{points:?}");
        }
    }

    #[test]
    fn two_spheres_leave_a_gap_for_the_blade() {
        let sphere = |x: f32| Sphere { centre_m: [x, 0.6, 0.0], radius_m: 0.5 };
        let pair = [sphere(0.62), sphere(-0.58)];
        let leaning: Leans = [[0.9, 0.0]; LINKS];
        let sway = settle(&Sway::at_rest(leaning), 1.0, UP, &pair);
        for sphere in &pair {
            assert!(depth_m(&sway, sphere) < 0.01, "{} m deep: {:?}", depth_m(&sway, sphere), sway.lean_rad);
        }
    }

    /// A U of planks 0.8 m wide, half a metre high, with its floor 0.1 m above the ground and its centre at `centre_m` on the ground.
    fn sled(centre_m: [f32; 2], outline_m: &[[f32; 2]]) -> Slab<'_> {
        let [x, z] = centre_m;
        Slab { centre_m: [x, 0.35, z], right: [1.0, 0.0, 0.0], back: [0.0, 0.0, 1.0], half_height_m: 0.25, reach_m: 3.3, outline_m }
    }

    proptest! {
        #[test]
        fn blades_lie_under_a_slab_and_stand_in_its_gap(leans in [lean(), lean(), lean()], x in -3.0_f32..3.0, z in -3.0_f32..3.0) {
            let outline_m = [[-2.0, -2.5], [-1.2, -2.5], [-1.2, 1.7], [1.2, 1.7], [1.2, -2.5], [2.0, -2.5], [2.0, 2.5], [-2.0, 2.5]];
            let slab = sled([-x, -z], &outline_m);
            let sway = settle_under(&Sway::at_rest(leans), 1.0, UP, &[], &[slab]);
            let alone = settle(&Sway::at_rest(leans), 1.0, UP, &[]);
            if outline::contains(&outline_m, [x, z]) {
                let under: Vec<_> = sway.points_m(1.0).into_iter().take_while(|at| outline::contains(&outline_m, [x + at[0], z + at[2]])).collect();
                prop_assert!(under.iter().all(|at| at[1] < 0.1 + 1e-4), "{under:?}");
                prop_assert!(sway.points_m(1.0)[0][1] < 0.1 + 1e-4, "the first link ends below the floor, wherever that is");
            }
            // The control: without a slab near it the blade is as before.
            let far = sled([-x, 20.0], &outline_m);
            prop_assert_eq!(settle_under(&Sway::at_rest(leans), 1.0, UP, &[], &[far]), alone);
            // Upright ones in the gap of the U, a link and more from its planks, do not move.
            let gap = settle_under(&Sway::default(), 1.0, UP, &[], &[slab]);
            prop_assert!(outline::contains(&outline_m, [x, z]) || gap == Sway::default());
        }
    }

    #[test]
    fn a_blade_that_leans_over_a_slab_lies_on_it() {
        let square_m = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        let slab = sled([1.05, 0.0], &square_m);
        // The first link rises beside it, the others lean over its deck, 0.6 m above the ground.
        let leans: Leans = [[0.0, 0.0], [0.05, 0.0], [0.7, 0.0]];
        let sway = settle_under(&Sway::at_rest(leans), 2.4, UP, &[], &[slab]);
        assert_eq!(sway, Sway::at_rest(leans));
        // A link that ends within it goes under it.
        let into: Leans = [[0.9, 0.0]; LINKS];
        let points = settle_under(&Sway::at_rest(into), 0.9, UP, &[], &[slab]).points_m(0.9);
        assert!(points[0][0] > 0.05 && points[0][1] < 0.1 + 1e-4, "{points:?}");
    }

    #[test]
    fn a_pressed_blade_loses_the_rate_that_pressed_it() {
        let fast = Sway { lean_rad: [[1.7, 0.0]; LINKS], rate_rad_per_s: [[5.0, 2.0]; LINKS] };
        let settled = settle(&fast, 1.0, UP, &[]);
        assert!(settled.rate_rad_per_s.iter().all(|rate| rate[0].abs() < 1e-3 && (rate[1] - 2.0).abs() < 1e-3), "{settled:?}");
        let free = Sway { lean_rad: [[0.2, 0.0]; LINKS], ..fast };
        assert_eq!(settle(&free, 1.0, UP, &[]), free);
    }
}
