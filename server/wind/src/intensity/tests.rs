use super::*;
use crate::sources::envelope;

const PULSE: Pulse = Pulse { attack_secs: 0.5, hold_secs: 0.25, fall_secs: 2.0, period_secs: 4.0 };

fn spline() -> Intensity {
    Intensity::Spline(Spline::new(6.0, vec![[0.5, 0.0], [1.0, 0.5], [1.5, 2.0], [3.0, 0.75], [5.0, 0.75]]))
}

fn all() -> [Intensity; 5] {
    [Intensity::Steady, Intensity::Gust(PULSE), Intensity::Cubic(PULSE), Intensity::Periodic { period_secs: 4.0 }, spline()]
}

/// Largest difference of two functions at 4001 times (s) from 0 to 8.
fn apart(one: impl Fn(f64) -> f64, other: impl Fn(f64) -> f64) -> f64 {
    (0..=4000).map(|n| f64::from(n) / 500.0).map(|secs| (one(secs) - other(secs)).abs()).fold(0.0, f64::max)
}

#[test]
fn a_gust_rises_linearly_holds_and_falls_as_a_parabola() {
    let gust = Intensity::Gust(PULSE);
    let formula = |secs: f64| match secs % 4.0 {
        age if age < 0.5 => age / 0.5,
        age if age < 0.75 => 1.0,
        age if age < 2.75 => ((2.75 - age) / 2.0).powi(2),
        _ => 0.0,
    };
    assert!(apart(|secs| gust.level(secs), formula) < 1e-15);
    let without_hold = Intensity::Gust(Pulse { attack_secs: 0.6, hold_secs: 0.0, fall_secs: 3.4, period_secs: 4.0 });
    assert!(apart(|secs| without_hold.level(secs), |secs| envelope(secs % 4.0 / 4.0, 0.15)) < 1e-7, "the envelope of the random gusts");
    assert!(apart(|secs| gust.level(secs), |secs| envelope(secs % 4.0 / 4.0, 0.15)) > 0.1, "with a hold it is another");
}

#[test]
fn a_pulse_happens_once_or_in_each_period_and_may_begin_or_end_at_its_peak() {
    let once = Intensity::Gust(Pulse { period_secs: 0.0, ..PULSE });
    assert_eq!([0.25, 4.25, 400.25].map(|secs| once.level(secs)), [0.5, 0.0, 0.0]);
    assert_eq!([0.25, 4.25, 400.25].map(|secs| Intensity::Gust(PULSE).level(secs)), [0.5; 3]);
    let block = Intensity::Cubic(Pulse { attack_secs: 0.0, hold_secs: 1.0, fall_secs: 0.0, period_secs: 2.0 });
    assert_eq!([0.0, 0.5, 1.0, 1.5, 2.0].map(|secs| block.level(secs)), [1.0, 1.0, 0.0, 0.0, 1.0]);
}

#[test]
fn a_cubic_rises_and_falls_by_one_polynomial_each() {
    let formula = |secs: f64| {
        let hermite = |s: f64| 3.0 * s.powi(2) - 2.0 * s.powi(3);
        match secs % 4.0 {
            age if age < 0.75 => hermite((age / 0.5).min(1.0)),
            age => hermite((1.0 - (age - 0.75) / 2.0).max(0.0)),
        }
    };
    let cubic = Intensity::Cubic(PULSE);
    assert!(apart(|secs| cubic.level(secs), formula) < 1e-15);
    assert!(apart(|secs| Intensity::Gust(PULSE).level(secs), formula) > 0.05, "a gust is another function");
}

#[test]
fn a_periodic_intensity_is_the_square_of_a_sine() {
    let periodic = Intensity::Periodic { period_secs: 4.0 };
    let sine = |secs: f64| (std::f64::consts::PI * secs / 4.0).sin().powi(2);
    let error = apart(|secs| periodic.level(secs), sine);
    println!("sine to {error:e}");
    assert!(error < 1e-13, "{error:e}");
    let both = Intensity::Cubic(Pulse { attack_secs: 2.0, hold_secs: 0.0, fall_secs: 2.0, period_secs: 4.0 });
    assert!(apart(|secs| both.level(secs), sine) > 0.009, "a cubic resembles it, but is told apart");
}

#[test]
fn a_spline_goes_below_0_and_stays_within_the_range_of_its_points() {
    let both_ways = Intensity::Spline(Spline::new(4.0, vec![[0.0, 1.0], [2.0, -1.0]]));
    assert_eq!([0.0, 1.0, 2.0, 3.0, 4.0].map(|secs| both_ways.level(secs)), [1.0, 0.0, -1.0, 0.0, 1.0]);
    assert!((0..=8000).map(|n| both_ways.level(f64::from(n) / 1000.0)).all(|level| (-1.0..=1.0).contains(&level)));
}

#[test]
fn only_a_steady_intensity_acts_before_the_start() {
    for (intensity, level) in all().into_iter().zip([1.0, 0.0, 0.0, 0.0, 0.0]) {
        assert_eq!([-1e-9, -3.0, -1e9].map(|secs| intensity.level(secs)), [level; 3], "{intensity:?}");
        assert!(intensity.level(1.25) > 0.5, "{intensity:?}");
    }
}

/// Largest change of the intensity, and of its slope, over 1/1000 s in two periods.
fn jumps(intensity: &Intensity) -> [f64; 2] {
    let step_secs = 1e-3;
    let slope = |secs: f64| (intensity.level(secs + 1e-6) - intensity.level(secs)) / 1e-6;
    (0..12_000).map(|n| (f64::from(n) + 0.3) * step_secs).fold([0.0; 2], |[value, steepness], secs| {
        let change = (intensity.level(secs + step_secs) - intensity.level(secs)).abs();
        let bend = (slope(secs + step_secs) - slope(secs)).abs();
        [f64::max(value, change), f64::max(steepness, bend)]
    })
}

#[test]
fn intensities_are_continuous_as_stated() {
    let [_, gust, cubic, periodic, curve] = all().map(|intensity| jumps(&intensity));
    println!("gust {gust:?}, cubic {cubic:?}, periodic {periodic:?}, spline {curve:?}");
    for [value, _] in [gust, cubic, periodic, curve] {
        assert!(value < 0.01);
    }
    for [_, slope] in [cubic, periodic, curve] {
        assert!(slope < 0.1);
    }
    assert!(gust[1] > 1.9, "its slope jumps from 1/attack to 0: {gust:?}");
    let [value, _] = jumps(&Intensity::Gust(Pulse { attack_secs: 0.0, ..PULSE }));
    assert!(value > 0.9, "without an attack it jumps: {value}");
}

#[test]
fn a_spline_goes_through_its_points_in_every_period_and_stays_within_their_range() {
    let points = [[0.5_f32, 0.0_f32], [1.0, 0.5], [1.5, 2.0], [3.0, 0.75], [5.0, 0.75]];
    let spline = spline();
    for [secs, level] in points.map(|point| point.map(f64::from)) {
        assert!([0.0, 6.0, 600.0].into_iter().all(|start| (spline.level(start + secs) - level).abs() < 1e-12), "{secs}");
    }
    for (piece, [low, high]) in [([1.0, 1.5], [0.5, 2.0]), ([1.5, 3.0], [0.75, 2.0]), ([3.0, 5.0], [0.75, 0.75]), ([5.0, 6.5], [0.0, 0.75])]
    {
        let levels = (0..=1000).map(|n| spline.level(piece[0] + (piece[1] - piece[0]) * f64::from(n) / 1000.0));
        assert!(levels.clone().all(|level| (low - 1e-15..=high + 1e-15).contains(&level)), "{piece:?}: {levels:?}");
    }
}

/// Largest error of a spline through `n` points of `f`, one every `3/n` s from `shift` of that, at the times (s) in `range`.
fn spline_error(f: impl Fn(f64) -> f64, n: i32, shift: f64, range: [f64; 2]) -> f64 {
    let points = (0..n).map(|k| 3.0 * (f64::from(k) + shift) / f64::from(n)).map(|secs| [secs as f32, f(secs) as f32]).collect();
    let spline = Spline::new(4.0, points);
    let times = (0..=3000).map(|k| range[0] + (range[1] - range[0]) * f64::from(k) / 3000.0);
    times.map(|secs| (spline.level(secs) - f(secs)).abs()).fold(0.0, f64::max)
}

/// Slope of the logarithm of the error over 12, 24 and 48 points.
fn order(f: impl Fn(f64) -> f64 + Copy, shift: f64, range: [f64; 2]) -> f64 {
    let [coarse, middle, fine] = [12, 24, 48].map(|n| spline_error(f, n, shift, range).log2());
    assert!(coarse > middle && middle > fine);
    0.5 * (coarse - fine)
}

#[test]
fn a_spline_has_its_order_and_reproduces_parabolas() {
    let parabola = |secs: f64| 0.25 * secs + 0.125 * secs * secs;
    let exact = spline_error(parabola, 24, 0.0, [0.5, 2.5]);
    assert!(exact < 1e-14, "{exact:e}");
    let cubic = |secs: f64| 0.25 * secs + secs.powi(3) / 16.0;
    assert!(spline_error(cubic, 24, 0.0, [0.5, 2.5]) > 1e-6, "it does not reproduce cubics");
    let monotone = order(cubic, 0.0, [0.5, 2.5]);
    let at_peak = order(|secs| (2.0 * (secs - 0.75)).cos(), 0.3, [0.5, 1.1]);
    println!("order {monotone:.3} where monotone, {at_peak:.3} at a peak");
    assert!((2.9..3.1).contains(&monotone), "{monotone}");
    assert!((1.5..2.5).contains(&at_peak), "{at_peak}");
}

#[test]
fn a_front_delays_by_distance_and_in_rings() {
    let front = Front { speed_m_per_s: 8.0, step_m: 0.0 };
    let rings = Front { step_m: 3.0, ..front };
    for distance_m in [0.0, 1.0, 2.9, 3.1, 100.0] {
        assert_eq!(front.delay_secs(distance_m), distance_m / 8.0);
        assert_eq!(rings.delay_secs(distance_m), (distance_m / 3.0).floor() * 3.0 / 8.0);
    }
    assert_eq!(rings.delay_secs(3.5), rings.delay_secs(5.5));
    assert_ne!(front.delay_secs(3.5), front.delay_secs(5.5));
    assert_eq!(Front { step_m: 3.0, ..Front::default() }.delay_secs(100.0), 0.0);
}

#[test]
fn each_bad_setting_is_named() {
    let of = |intensity: Intensity| intensity.validate("intensity").err().map(|error| error.to_string());
    let curve = |period_secs, points: &[[f32; 2]]| of(Intensity::Spline(Spline::new(period_secs, points.to_vec())));
    assert!(all().into_iter().all(|intensity| of(intensity).is_none()));
    let rounded = Pulse { attack_secs: 0.6, hold_secs: 0.4, fall_secs: 3.0, period_secs: 4.0 };
    assert_eq!(of(Intensity::Gust(rounded)), None, "decimal fractions fill a period");
    let cases = [
        (of(Intensity::Gust(Pulse { attack_secs: -1.0, ..PULSE })), "intensity.attack_secs"),
        (of(Intensity::Gust(Pulse { attack_secs: 0.0, hold_secs: 0.0, fall_secs: 0.0, ..PULSE })), "intensity.attack_secs"),
        (of(Intensity::Cubic(Pulse { hold_secs: f32::NAN, ..PULSE })), "intensity.hold_secs"),
        (of(Intensity::Cubic(Pulse { fall_secs: f32::INFINITY, ..PULSE })), "intensity.fall_secs"),
        (of(Intensity::Cubic(Pulse { period_secs: 2.7, ..PULSE })), "intensity.period_secs"),
        (of(Intensity::Periodic { period_secs: 0.0 }), "intensity.period_secs"),
        (curve(f32::NAN, &[[0.0, 0.0], [1.0, 1.0]]), "intensity.period_secs"),
        (curve(2.0, &[[0.0, 0.0]]), "intensity.points"),
        (curve(2.0, &[[0.0, 0.0], [0.0, 1.0]]), "intensity.points[1][0]"),
        (curve(2.0, &[[0.0, 0.0], [2.0, 1.0]]), "intensity.points[1][0]"),
        (curve(2.0, &[[f32::NAN, 0.0], [1.0, 1.0]]), "intensity.points[0][0]"),
        (curve(2.0, &[[0.0, 0.0], [1.0, 11.0]]), "intensity.points[1][1]"),
    ];
    for (message, field) in cases {
        let message = message.expect(field);
        assert!(message.starts_with(&format!("wind: {field} is ")) && message.contains("allowed: "), "{message}");
    }
    let front = |front: Front| front.validate("front").unwrap_err().field;
    assert_eq!(front(Front { speed_m_per_s: -1.0, step_m: 0.0 }), "front.speed_m_per_s");
    assert_eq!(front(Front { speed_m_per_s: 1.0, step_m: f32::NAN }), "front.step_m");
}
