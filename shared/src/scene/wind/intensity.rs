//! Intensity of a flow primitive over time, and checks of its fields.

use super::Primitive;
use super::words::words;
use crate::scene::checks::conflict::Conflicts;
use serde::{Deserialize, Serialize};

words! {
    /// Intensity of a flow primitive as a function of time (Bakay §3.2).
    PrimitiveIntensity {
        /// 1 at all times.
        Steady = "steady",
        /// Rises linearly, holds, and falls as a parabola.
        Gust = "gust",
        /// The square of a sine.
        Periodic = "periodic",
        /// Rises, holds and falls with a continuous slope, by one cubic polynomial each.
        Cubic = "cubic",
        /// A curve through points.
        Spline = "spline",
    }
}

use PrimitiveIntensity::{Cubic, Gust, Periodic, Spline, Steady};

/// Fraction by which rise, hold and fall may be longer than the period, since decimal fractions are rounded.
const ROUNDING: f64 = 1e-6;

/// Fewest points of a spline.
const LEAST_POINTS: usize = 2;

/// Reports fields of the primitive at `path` that its intensity does not have, lacks, or that contradict each other.
pub(super) fn check(path: &str, primitive: &Primitive, conflicts: &mut Conflicts) {
    unused(path, primitive, conflicts);
    match primitive.intensity {
        Steady => {}
        Gust | Cubic => pulse(path, primitive, conflicts),
        Periodic => period(path, primitive, conflicts),
        Spline => {
            period(path, primitive, conflicts);
            points(path, primitive, conflicts);
        }
    }
}

/// Fields that have no effect.
fn unused(path: &str, primitive: &Primitive, conflicts: &mut Conflicts) {
    let (intensity, word) = (primitive.intensity, primitive.intensity.word());
    let is_pulse = matches!(intensity, Gust | Cubic);
    let fields = [
        ("attack_secs", primitive.attack_secs, is_pulse),
        ("hold_secs", primitive.hold_secs, is_pulse),
        ("fall_secs", primitive.fall_secs, is_pulse),
        ("period_secs", primitive.period_secs, intensity != Steady),
        ("front_m_per_s", primitive.front_m_per_s, intensity != Steady),
    ];
    for (field, value, _) in fields.into_iter().filter(|(_, value, is_used)| *value != 0.0 && !is_used) {
        let message = format!("is {value}; allowed with `intensity = \"{word}\"`: 0, since that has no use for it");
        conflicts.note(&[format!("{path}.{field}"), format!("{path}.intensity")], message);
    }
    if !primitive.intensity_points.is_empty() && intensity != Spline {
        let message = format!(
            "is a list of {}; allowed with `intensity = \"{word}\"`: an empty one, since only \"spline\" has points",
            primitive.intensity_points.len()
        );
        conflicts.note(&[format!("{path}.intensity_points"), format!("{path}.intensity")], message);
    }
    if primitive.step_m != 0.0 && primitive.front_m_per_s == 0.0 {
        let message = format!("is {}; allowed with `front_m_per_s = 0`: 0, since nothing is delayed", primitive.step_m);
        conflicts.note(&[format!("{path}.step_m"), format!("{path}.front_m_per_s"), format!("{path}.intensity")], message);
    }
}

/// Rise, time at the peak and fall.
fn pulse(path: &str, primitive: &Primitive, conflicts: &mut Conflicts) {
    let Primitive { attack_secs, hold_secs, fall_secs, period_secs, intensity, .. } = primitive;
    let length_secs: f64 = [*attack_secs, *hold_secs, *fall_secs].map(f64::from).iter().sum();
    let fields = ["period_secs", "attack_secs", "hold_secs", "fall_secs", "intensity"].map(|field| format!("{path}.{field}"));
    if length_secs == 0.0 {
        let word = intensity.word();
        let message =
            format!("is {attack_secs}, and so are `hold_secs` and `fall_secs`; allowed with `intensity = \"{word}\"`: one of them above 0");
        conflicts.note(&fields[1..], message);
    } else if *period_secs != 0.0 && length_secs > f64::from(*period_secs) * (1.0 + ROUNDING) {
        let message =
            format!("is {period_secs}; allowed: 0, or at least attack_secs + hold_secs + fall_secs, which is {}", length_secs as f32);
        conflicts.note(&fields, message);
    }
}

/// The period of an intensity that must repeat.
fn period(path: &str, primitive: &Primitive, conflicts: &mut Conflicts) {
    if primitive.period_secs == 0.0 {
        let message = format!("is 0; allowed with `intensity = \"{}\"`: above 0, since it repeats", primitive.intensity.word());
        conflicts.note(&[format!("{path}.period_secs"), format!("{path}.intensity")], message);
    }
}

/// The points of a spline: enough of them, in order, within the period.
fn points(path: &str, primitive: &Primitive, conflicts: &mut Conflicts) {
    let Primitive { intensity_points: points, period_secs, .. } = primitive;
    let list = format!("{path}.intensity_points");
    if points.len() < LEAST_POINTS {
        let message = format!("is a list of {}; allowed with `intensity = \"spline\"`: {LEAST_POINTS} to 32 points", points.len());
        return conflicts.note(&[list, format!("{path}.intensity")], message);
    }
    for (n, pair) in points.windows(2).enumerate() {
        let ([before_secs, _], [secs, _]) = (pair[0], pair[1]);
        if secs <= before_secs {
            let message = format!("is at {secs} s; allowed: after {before_secs} s, the time of the point before");
            conflicts.note(&[format!("{list}[{}]", n + 1), list.clone()], message);
        }
    }
    if let Some(n) = points.iter().position(|[secs, _]| *period_secs > 0.0 && secs >= period_secs) {
        let message = format!("is at {} s; allowed: before `period_secs`, {period_secs} s, when the first point comes again", points[n][0]);
        conflicts.note(&[format!("{list}[{n}]"), list.clone(), format!("{path}.period_secs")], message);
    }
}
