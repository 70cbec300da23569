//! Stability limit of the explicit scheme of Chen & Johan, by bisection: constant speeds, varying speeds, road speed.

use prairie_charts::problems::bend::{Striker, size};
use prairie_core::bend::limits::courant_limit;
use prairie_core::bend::{Bend, Edges, Field, Kinds, Scheme, Serial, WaveParams};
use prairie_core::grid::PatchLayout;

const DT_SECS: f32 = 0.01;
const COUNT: usize = 32;
const STEPS: u32 = 2000;
const BISECTIONS: u32 = 11;

/// Courant number of each cell relative to the largest, row by row.
type Pattern = Vec<f32>;

fn pattern(of: impl Fn(usize, usize) -> f32) -> Pattern {
    (0..COUNT * COUNT).map(|n| of(n % COUNT, n / COUNT)).collect()
}

/// A random number below 2²⁴ for a cell.
pub(super) fn random(i: usize, j: usize) -> u32 {
    let mixed = ((i as u32 * 0x9E37_79B1) ^ (j as u32 * 0x85EB_CA77)).wrapping_mul(0xC2B2_AE3D);
    (mixed ^ (mixed >> 15)).wrapping_mul(0x2C1B_3C6D) >> 8
}

fn wave(c0_m_per_s: f32, damping_per_s: f32, stiffness_per_s2: f32) -> WaveParams {
    WaveParams {
        c0_m_per_s,
        mu_m_per_rad: 0.0,
        c_omega_m_per_s: 0.0,
        theta_damping_per_s: damping_per_s,
        omega_damping_per_s: 0.0,
        stiffness_per_s2,
    }
}

/// Four patches with periodic edges and cells of 1 m.
fn field(kinds: Kinds) -> Field {
    Field::new(PatchLayout { count: [2, 2], cells: COUNT as u32 / 2, cell_m: 1.0 }, kinds).with_edges(Edges::Wrapped)
}

/// Whether noise stays bounded at a Courant number of at most `r`; detects modes that grow by 0.1 % per step.
fn is_bounded(mut field: Field, omega: impl Fn(usize) -> f32) -> bool {
    field.start(DT_SECS, |[x, z]| {
        let (i, j) = (x as usize, z as usize);
        // The checkerboard is the first mode to fail; noise contains all others.
        let theta = 1e-3 * (random(i, j) as f32 / 2.0f32.powi(24) - 0.5) + if (i + j) % 2 == 0 { 1e-3 } else { -1e-3 };
        [Bend { theta, omega: [omega(j * COUNT + i), 0.0] }; 2]
    });
    (0..STEPS).all(|_| {
        field.step(Scheme::Verlet, DT_SECS, &Serial).unwrap();
        field.awake().all(|patch| patch.theta_max_rad() < 1.0) && field.awake_count() == 4
    })
}

/// Cause of a varying Courant number.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Cause {
    /// Kinds of grass with different speeds.
    Kinds,
    /// μ|ω| with a fixed ω.
    Bending,
}

fn holds(r: f32, pattern: &Pattern, cause: Cause, [damping, stiffness]: [f32; 2]) -> bool {
    let speed = r / DT_SECS;
    match cause {
        Cause::Kinds => {
            let mut fractions: Vec<f32> = pattern.clone();
            fractions.sort_by(f32::total_cmp);
            fractions.dedup();
            let kinds = pattern.iter().map(|fraction| fractions.iter().position(|other| other == fraction).unwrap() as u8).collect();
            let waves = fractions.iter().map(|fraction| wave(fraction * speed, damping, stiffness)).collect();
            is_bounded(field(Kinds::mapped(waves, [COUNT; 2], kinds)), |_| 0.0)
        }
        Cause::Bending => {
            // c₀ is a fifth of the largest speed. κ would change ω, too.
            assert_eq!(stiffness, 0.0);
            let least = 0.2 * speed;
            let waves = WaveParams { mu_m_per_rad: 1.0, ..wave(least, damping, 0.0) };
            is_bounded(field(Kinds::one(waves)), |n| pattern[n] * speed - least)
        }
    }
}

fn bisect(holds: impl Fn(f32) -> bool) -> f32 {
    let (mut bounded, mut fails) = (0.0, 2.0);
    assert!(!holds(fails));
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (bounded + fails);
        if holds(middle) { bounded = middle } else { fails = middle }
    }
    bounded
}

/// Largest eigenvalue of `−D·L` over the square of the largest Courant number, by power iteration, with D the squared Courant numbers of the cells: 8 where
/// all are equal. `D·L` is similar to the symmetric `D^½·L·D^½`.
fn spectral_radius(pattern: &Pattern) -> f64 {
    let mut vector: Vec<f64> = (0..COUNT * COUNT).map(|n| f64::from(random(n % COUNT, n / COUNT)) - 8e6).collect();
    let root: Vec<f64> = pattern.iter().map(|fraction| f64::from(*fraction)).collect();
    let mut radius = 0.0;
    for _ in 0..2000 {
        let scaled: Vec<f64> = vector.iter().zip(&root).map(|(v, d)| v * d).collect();
        let at = |i: usize, j: usize| scaled[j % COUNT * COUNT + i % COUNT];
        let next = |n: usize| {
            let (i, j) = (n % COUNT + COUNT, n / COUNT + COUNT);
            root[n] * (4.0 * at(i, j) - at(i + 1, j) - at(i - 1, j) - at(i, j + 1) - at(i, j - 1))
        };
        let next: Vec<f64> = (0..vector.len()).map(next).collect();
        radius = next.iter().map(|v| v * v).sum::<f64>().sqrt();
        vector = next.iter().map(|v| v / radius).collect();
    }
    radius
}

/// Damping rate k (1/s) for λ per step; λ = 1 removes the whole velocity.
fn damping_per_s(lambda: f32) -> f32 {
    if lambda < 1.0 { -(1.0 - lambda).ln() / DT_SECS } else { 1e6 }
}

#[test]
fn constant_speeds_become_unstable_at_the_bound() {
    let even = pattern(|_, _| 1.0);
    for lambda in [0.0, 0.1, 0.5, 1.0] {
        for restoring in [0.0, 0.3] {
            let bound = courant_limit(lambda, restoring);
            let constants = [damping_per_s(lambda), restoring / (DT_SECS * DT_SECS)];
            let found = bisect(|r| holds(r, &even, Cause::Kinds, constants));
            println!("λ = {lambda}, κ·dt² = {restoring}: fails at {found:.4}, bound {bound:.4}");
            assert!((found / bound - 1.0).abs() < 0.02, "λ = {lambda}, κ·dt² = {restoring}: fails at {found}, bound {bound}");
            let plain = ((2.0 - lambda) / 4.0).sqrt();
            assert!(restoring > 0.0 || (bound - plain).abs() < 1e-6, "r ≤ √((2 − λ)/4)");
        }
    }
}

/// The bound with the largest speed is safe for any pattern; the spectral radius of the pattern gives its margin.
#[test]
fn varying_speeds_become_unstable_at_their_spectral_radius_and_never_below_the_bound() {
    let low = 0.3;
    let two = |is_high: bool| if is_high { 1.0 } else { low };
    let patterns = [
        ("stripes of 1 cell", pattern(|i, _| two(i % 2 == 0))),
        ("stripes of 4 cells", pattern(|i, _| two(i / 4 % 2 == 0))),
        ("stripes of 16 cells", pattern(|_, j| two(j < 16))),
        ("checkerboard", pattern(|i, j| two((i + j) % 2 == 0))),
        ("checkerboard of 4 cells", pattern(|i, j| two((i / 4 + j / 4) % 2 == 0))),
        ("random, half and half", pattern(|i, j| two(random(i, j).is_multiple_of(2)))),
        ("one fast cell", pattern(|i, j| two(i == 7 && j == 9))),
    ];
    println!("{:<24} {:<8} {:>4} {:>8} {:>9} {:>8} {:>16}", "pattern", "cause", "λ", "bound", "predicted", "fails at", "fails over bound");
    for (name, pattern) in &patterns {
        let radius = spectral_radius(pattern);
        for cause in [Cause::Kinds, Cause::Bending] {
            for lambda in [0.0, 1.0] {
                let bound = courant_limit(lambda, 0.0);
                let predicted = bound * (8.0 / radius).sqrt() as f32;
                let found = bisect(|r| holds(r, pattern, cause, [damping_per_s(lambda), 0.0]));
                let cause_name = format!("{cause:?}");
                println!("{name:<24} {cause_name:<8} {lambda:>4} {bound:>8.4} {predicted:>9.4} {found:>8.4} {:>16.3}", found / bound);
                assert!((found / predicted - 1.0).abs() < 0.02, "{name}, {cause:?}, λ = {lambda}: {found} for {predicted}");
                assert!(found > 0.98 * bound, "{name}, {cause:?}, λ = {lambda}: {found} below the bound {bound}");
            }
        }
    }
}

/// A car at 20 m/s bends grass struck at 0.3 m at 67 rad/s: by Eq. (4) the wave runs at over 100 m/s, four times as fast as a step of a 60th allows.
#[test]
fn at_road_speed_the_original_scheme_blows_up_and_sub_steps_do_not() {
    const TICK_SECS: f32 = 1.0 / 60.0;
    let grass = WaveParams {
        c0_m_per_s: 5.0,
        mu_m_per_rad: 1.5,
        c_omega_m_per_s: 5.0,
        theta_damping_per_s: 3.0,
        omega_damping_per_s: 6.0,
        stiffness_per_s2: 0.0,
    };
    let drive = |scheme: Scheme| {
        let mut field = Field::new(PatchLayout { count: [4, 4], cells: 16, cell_m: 0.4572 }, Kinds::one(grass));
        let (mut reset, mut most) = (0, 0.0f32);
        for step in 0..60 {
            let at_m = [-10.0 + 20.0 * TICK_SECS * step as f32, 1.0];
            let car = Striker { at_m, velocity_m_per_s: [20.0, 0.0], radius_m: 1.0, strike_height_m: 0.3 };
            car.press(&mut field, TICK_SECS);
            reset += field.step(scheme, TICK_SECS, &Serial).unwrap().reset_patches;
            most = field.awake().map(|patch| patch.theta_max_rad()).fold(most, f32::max);
        }
        assert_eq!(size(&field), [64; 2]);
        (reset, most)
    };
    let (reset, most) = drive(Scheme::Verlet);
    println!("Verlet: {reset} patches reset, θ up to {most:.1e} rad");
    assert!(reset > 0 || most > 1e3, "the original parameters must blow up: {most}");
    let (reset, most) = drive(Scheme::Substepped);
    println!("sub-stepped: {reset} patches reset, θ up to {most:.2} rad");
    assert!(reset == 0 && most < 3.0 * std::f32::consts::FRAC_PI_2, "{most}");
}
