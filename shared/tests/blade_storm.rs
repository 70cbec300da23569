//! A blade through a hundred thousand steps of gusts and hits: it keeps its length, stays out of the ground and of the objects that hit it, and gives the same bits.

use prairie_core::hash::hash3;
use prairie_core::plant::blade::backbone::{backbone_m, drawn_out_m};
use prairie_core::plant::blade::contact::{Sphere, settle};
use prairie_core::plant::blade::{Blade, Integrator, LINKS, Leans, Sway, advance};

const DT_SECS: f32 = 1.0 / 60.0;

/// A random number from 0 to under 1.
fn fraction(place: [u32; 3]) -> f32 {
    (hash3(place)[0] >> 8) as f32 / (1 << 24) as f32
}

fn between(low: f32, high: f32, place: [u32; 3]) -> f32 {
    low + (high - low) * fraction(place)
}

/// Wind at the control points (m/s) that drifts from one random value to the next every half a second, up to 10 m/s along each axis, and gusts by a third.
fn wind(number: u32, step: u32) -> Leans {
    let (beat, part) = (step / 30, (step % 30) as f32 / 30.0);
    std::array::from_fn(|link| {
        std::array::from_fn(|axis| {
            let [from, to] = [beat, beat + 1].map(|beat| between(-10.0, 10.0, [number, beat, axis as u32]));
            (from + (to - from) * part) * (1.0 + 0.3 * (fraction([number, step, 16 + link as u32]) - 0.5)) * (0.6 + 0.2 * link as f32)
        })
    })
}

/// Gap under a sphere over the ground, and between two of them, in lengths of the blade: room for it to pass through.
const ROOM: [f32; 2] = [0.05, 0.2];

/// Two spheres that pass the blade over ground with this normal, each from a tenth to the whole of its length in radius.
fn passing(number: u32, step: u32, length_m: f32, normal: [f32; 3]) -> [Sphere; 2] {
    const STEPS: u32 = 90;
    let (pass, part) = (step / STEPS, (step % STEPS) as f32 / STEPS as f32);
    let sphere = |side: u32, x_m: f32| {
        let random = |low: f32, high: f32, what: u32| between(low, high, [number, pass, 32 + 8 * side + what]) * length_m;
        let (radius_m, gap_m) = (random(0.1, 1.0, 0), random(ROOM[0], 0.6, 1));
        let (x_m, z_m) = (x_m + random(-1.2, 1.2, 2), (part - 0.5) * random(2.0, 8.0, 3));
        let [nx, ny, nz] = normal;
        Sphere { centre_m: [x_m, (radius_m + gap_m - nx * x_m - nz * z_m) / ny, z_m], radius_m }
    };
    let (one, mut other) = (sphere(0, 0.0), sphere(1, 0.0));
    // The other gives way along X, away from the blade.
    let away_m = if other.centre_m[0] < one.centre_m[0] { -0.02 } else { 0.02 };
    while apart_m(&one, &other) < ROOM[1] * length_m {
        other.centre_m[0] += away_m * length_m;
        other.centre_m[1] -= normal[0] / normal[1] * away_m * length_m;
    }
    [one, other]
}

fn length(of: [f32; 3]) -> f32 {
    of.iter().map(|v| v * v).sum::<f32>().sqrt()
}

fn apart_m(one: &Sphere, other: &Sphere) -> f32 {
    length([0, 1, 2].map(|i| one.centre_m[i] - other.centre_m[i])) - one.radius_m - other.radius_m
}

/// How deep the links of a blade, or the segments of its strip, lie in a sphere (m).
fn depth_m(points_m: &[[f32; 3]], sphere: &Sphere) -> f32 {
    let below_m = std::iter::once(&[0.0; 3]).chain(points_m);
    let ends = below_m.zip(points_m);
    let nearest_m = ends.map(|(from, to)| {
        let (along, aside) = ([0, 1, 2].map(|i| to[i] - from[i]), [0, 1, 2].map(|i| sphere.centre_m[i] - from[i]));
        let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let fraction = (dot(along, aside) / dot(along, along)).clamp(0.0, 1.0);
        length([0, 1, 2].map(|i| aside[i] - fraction * along[i]))
    });
    sphere.radius_m - nearest_m.fold(f32::INFINITY, f32::min)
}

/// Ends of the segments that a blade is drawn as (m from the root), from the lowest up.
fn strip_m(points_m: &[[f32; 3]; LINKS], segments: u32) -> Vec<[f32; 3]> {
    (1..=segments).map(|segment| backbone_m(points_m, segment as f32 / segments as f32)).collect()
}

fn length_m(strip_m: &[[f32; 3]]) -> f32 {
    let below_m = std::iter::once(&[0.0; 3]).chain(strip_m);
    below_m.zip(strip_m).map(|(from, to)| length([0, 1, 2].map(|i| to[i] - from[i]))).sum()
}

/// A blade, the slope that it stands on, and its lean without wind.
fn grown(number: u32) -> (Blade, [f32; 3], Leans) {
    let random = |low: f32, high: f32, what: u32| between(low, high, [number, what, 99]);
    let slope = [random(-0.6, 0.6, 0), random(-0.6, 0.6, 1)];
    let long = (1.0 + slope[0] * slope[0] + slope[1] * slope[1]).sqrt();
    let blade = Blade {
        length_m: random(0.2, 1.5, 2),
        frequency_rad_per_s: random(4.0, 25.0, 3),
        damping_ratio: random(0.02, 0.5, 4),
        lean_per_wind2: random(0.001, 0.01, 5),
    };
    let droop = [random(-0.4, 0.4, 6), random(-0.4, 0.4, 7)];
    (blade, [-slope[0] / long, 1.0 / long, -slope[1] / long], [0.6, 1.0, 1.4].map(|fraction| droop.map(|lean| fraction * lean)))
}

#[test]
fn a_storm_of_gusts_and_hits_leaves_a_blade_whole() {
    let (mut hits, mut cut) = (0, 0);
    let (mut deepest, mut deepest_drawn, mut longest) = (0.0_f32, 0.0_f32, 0.0_f32);
    for number in 0..4 {
        let (blade, normal, held) = grown(number);
        let mut sway = Sway::at_rest(held);
        for step in 0..100_000 {
            let spheres = passing(number, step, blade.length_m, normal);
            sway = advance(&sway, &blade, &held, &wind(number, step), Integrator::Exact, DT_SECS);
            let touched = spheres.iter().any(|sphere| depth_m(&sway.points_m(blade.length_m), sphere) > 0.0);
            sway = settle(&sway, blade.length_m, normal, &spheres);
            assert!(sway.lean_rad.iter().chain(&sway.rate_rad_per_s).flatten().all(|value| value.is_finite()), "{sway:?}");
            let points_m = sway.points_m(blade.length_m);
            let mut below_m = [0.0; 3];
            for point_m in points_m {
                let link_m = length([0, 1, 2].map(|i| point_m[i] - below_m[i]));
                assert!((link_m * 3.0 / blade.length_m - 1.0).abs() < 1e-5, "{link_m} m of {}", blade.length_m);
                let height_m: f32 = (0..3).map(|i| point_m[i] * normal[i]).sum();
                assert!(height_m > 0.0, "{height_m} m at step {step} of blade {number}");
                below_m = point_m;
            }
            let deep = |points_m: &[[f32; 3]]| spheres.iter().map(|sphere| depth_m(points_m, sphere)).fold(0.0, f32::max) / blade.length_m;
            hits += u32::from(touched);
            deepest = deepest.max(deep(&points_m));
            for segments in [3, 7] {
                let strip_m = strip_m(&drawn_out_m(&points_m, blade.length_m, segments), segments);
                assert!((length_m(&strip_m) / blade.length_m - 1.0).abs() < 1e-5, "{} m of {}", length_m(&strip_m), blade.length_m);
                let height_m = strip_m.iter().map(|point_m| (0..3).map(|i| point_m[i] * normal[i]).sum()).fold(f32::INFINITY, f32::min);
                assert!(height_m > 0.0, "drawn at {height_m} m at step {step} of blade {number}");
                let depth = deep(&strip_m);
                cut += u32::from(depth > 0.01);
                deepest_drawn = deepest_drawn.max(depth);
            }
            let curve_m = strip_m(&drawn_out_m(&points_m, blade.length_m, 7), 64);
            longest = longest.max(length_m(&curve_m) / blade.length_m);
        }
    }
    assert!(hits > 20_000, "{hits} hits");
    assert!(deepest < 0.01, "{deepest} of the length deep");
    // The drawn curve rounds the corners between links that touch a sphere: one strip of 200 enters a sphere by more than that.
    assert!(cut < 800_000 / 200 && deepest_drawn < 0.2, "{cut} strips cut spheres, by up to {deepest_drawn} of the length");
    // The curve that seven segments approximate.
    assert!(longest < 1.01, "{longest} of the length");
}

#[test]
fn the_same_storm_gives_the_same_bits_everywhere() {
    // FNV-1a over all leans and rates. Only + − × ÷ and roots are in it, so that it is the same on every machine.
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    for number in 0..4 {
        let (blade, normal, held) = grown(number);
        let mut sway = Sway::at_rest(held);
        for step in 0..1000 {
            sway = advance(&sway, &blade, &held, &wind(number, step), Integrator::Exact, DT_SECS);
            sway = settle(&sway, blade.length_m, normal, &passing(number, step, blade.length_m, normal));
            for value in sway.lean_rad.iter().chain(&sway.rate_rad_per_s).flatten() {
                hash = (hash ^ u64::from(value.to_bits())).wrapping_mul(0x0100_0000_01b3);
            }
        }
    }
    assert_eq!(hash, 0xd83e_ed89_2bbe_8e09, "{hash:#018x}");
}
