//! Smooth axis of a component through the joints of its sections, for plants close up (Endo et al. 2003, §7). `on_curve` in
//! `client-wasm/shaders/plants/near_leaf.wgsl` is its twin.
//!
//! Each section becomes a cubic Hermite segment. Its tangents are those of Catmull and Rom, which on sections of equal length are the centripetal ones;
//! at the foot and at the tip the curvature continues. The curve passes through the joints and lies within O(h³) of an elastica through them, where
//! straight sections of length h lie within O(h²).

use glam::Vec3;

/// Greatest departure of a tangent from its section, relative to the section. It bounds the length of the curve to 1 % more than that of the section: where
/// sections meet at more than 0.48 rad, as where a plant breaks or lies down, a corner remains.
pub const TANGENT_DEPARTURE: f32 = 0.24;

/// Departures of the tangents at both ends of a section from the section itself. `before` and `after` are the sections below and above it, none at
/// the foot and at the tip.
fn departures(before: Option<Vec3>, section: Vec3, after: Option<Vec3>) -> [Vec3; 2] {
    let below = before.or(after.map(|after| 2.0 * section - after)).unwrap_or(section);
    let above = after.or(before.map(|before| 2.0 * section - before)).unwrap_or(section);
    let most = TANGENT_DEPARTURE * section.length();
    [below, above].map(|other| (0.5 * (other - section)).clamp_length_max(most))
}

/// Point on the curve at a fraction of a section, relative to its lower end. `curving` blends from the straight section (0) to the curve (1).
pub fn point(before: Option<Vec3>, section: Vec3, after: Option<Vec3>, fraction: f32, curving: f32) -> Vec3 {
    let [below, above] = departures(before, section, after);
    let rest = 1.0 - fraction;
    section * fraction + (below * rest - above * fraction) * (curving * fraction * rest)
}

#[cfg(test)]
mod tests {
    use super::super::rest::{Load, balanced, joints};
    use super::*;

    const TIP_FRACTION: f64 = 0.2;
    const UNBENT_RAD: f64 = 0.5;
    /// Sections of the reference, a multiple of all others.
    const FINE: usize = 1920;
    const LOAD: Load = Load { spread: 6.0, tip: 0.0 };

    /// Derivative of [`point`] by the fraction.
    fn tangent(before: Option<Vec3>, section: Vec3, after: Option<Vec3>, fraction: f32, curving: f32) -> Vec3 {
        let [below, above] = departures(before, section, after);
        let rest = 1.0 - fraction;
        section + (below * (rest * (1.0 - 3.0 * fraction)) - above * (fraction * (2.0 - 3.0 * fraction))) * curving
    }

    /// Joints of a balanced component of length 1, from the foot.
    fn chain(sections: usize) -> Vec<Vec3> {
        let mut bends_rad = vec![0.0; sections];
        balanced(&joints(sections, TIP_FRACTION), LOAD, UNBENT_RAD, &mut bends_rad);
        let mut at = [0.0; 2];
        let ends = bends_rad.into_iter().map(|bend_rad| {
            let (sine, cosine) = (UNBENT_RAD + bend_rad).sin_cos();
            at = [at[0] + sine / sections as f64, at[1] + cosine / sections as f64];
            Vec3::new(at[0] as f32, at[1] as f32, 0.0)
        });
        std::iter::once(Vec3::ZERO).chain(ends).collect()
    }

    /// Sections of a chain, each with its neighbours.
    fn sections(joints: &[Vec3]) -> impl Iterator<Item = (Vec3, [Option<Vec3>; 2], Vec3)> + '_ {
        let section = |at: usize| joints.get(at + 1).map(|&end| end - joints[at]);
        (0..joints.len() - 1)
            .map(move |at| (joints[at], [at.checked_sub(1).and_then(section), section(at + 1)], joints[at + 1] - joints[at]))
    }

    /// Greatest distance of the drawn curve from the reference, and greatest angle between their tangents (rad).
    fn apart(joints: &[Vec3], fine: &[Vec3], curving: f32) -> [f64; 2] {
        let mut most = [0.0_f64; 2];
        let per_section = (fine.len() - 1) / (joints.len() - 1);
        for (number, (start, [before, after], section)) in sections(joints).enumerate() {
            for step in 0..=20 {
                let fraction = step as f32 / 20.0;
                let at = start + point(before, section, after, fraction, curving);
                let along = tangent(before, section, after, fraction, curving).normalize();
                let place = (number * per_section + step * per_section / 20).min(fine.len() - 2);
                let way = (fine[place + 1] - fine[place]).normalize();
                // Distance across the reference: where along it the point lies does not matter.
                let off = at - fine[place];
                most[0] = most[0].max(f64::from(off.cross(way).length()));
                most[1] = most[1].max(f64::from(along.angle_between(way)));
            }
        }
        most
    }

    /// Fitted order of a quantity in the number of sections, from 6, 12 and 24 of them.
    fn order(of: impl Fn(usize) -> f64) -> f64 {
        let found = [6, 12, 24].map(of);
        println!("{found:?}");
        (found[0] / found[2]).log2() / 2.0
    }

    #[test]
    fn the_curve_lies_closer_to_the_elastica_than_sections_do() {
        let fine = chain(FINE);
        let on = |sections: usize| fine.iter().copied().step_by(FINE / sections).collect::<Vec<_>>();
        let [straight, curved] = [0.0, 1.0].map(|curving| order(|sections| apart(&on(sections), &fine, curving)[0]));
        assert!((1.8..2.2).contains(&straight), "order {straight} of straight sections");
        assert!(curved > 2.7, "order {curved} of the curve");
        // With the joints of the statics, which are themselves of second order, the tangents gain an order.
        let [straight, curved] = [0.0, 1.0].map(|curving| order(|sections| apart(&chain(sections), &fine, curving)[1]));
        assert!((0.8..1.2).contains(&straight), "order {straight} of the directions of straight sections");
        assert!(curved > 1.7, "order {curved} of the tangents");
    }

    #[test]
    fn the_curve_passes_through_joints_smoothly_and_keeps_lengths() {
        for sharpness in [0.0, 0.1, 0.3, 0.47, 1.0, 3.0_f32] {
            let joints: Vec<Vec3> = (0..=7)
                .scan(Vec3::ZERO, |at, number| {
                    let (sine, cosine) = (sharpness * (number as f32 * 1.3).sin()).sin_cos();
                    *at += Vec3::new(sine, cosine, 0.3 * sine * cosine);
                    Some(*at)
                })
                .collect();
            let of_unit_length = joints.windows(2).scan(joints[0], |at, pair| {
                *at += (pair[1] - pair[0]).normalize();
                Some(*at)
            });
            let joints: Vec<Vec3> = std::iter::once(joints[0]).chain(of_unit_length).collect();
            let mut last: Option<(Vec3, Vec3)> = None;
            for (_, [before, after], section) in sections(&joints) {
                let along = |fraction: f32| point(before, section, after, fraction, 1.0);
                assert!(along(0.0) == Vec3::ZERO && along(1.0).distance(section) < 1e-6, "through the joints");
                let length: f32 = (0..64).map(|n| along(n as f32 / 64.0).distance(along((n + 1) as f32 / 64.0))).sum();
                assert!((0.9999..1.01).contains(&length), "{length} of a section");
                let [start, end] = [0.0, 1.0].map(|fraction| tangent(before, section, after, fraction, 1.0).normalize());
                if let Some((other, below)) = last.replace((end, section))
                    && below.angle_between(section) < 2.0 * TANGENT_DEPARTURE
                {
                    assert!(other.distance(start) < 1e-5, "{other} and {start} at a joint");
                }
            }
        }
        // Without the bound the length is not kept.
        let (before, section, after) = (Vec3::new(1.0, 0.3, 0.0), Vec3::Y, Vec3::new(-1.0, 0.3, 0.0));
        let free = |t: f32| section * t + (0.5 * (before - section) * (1.0 - t) - 0.5 * (after - section) * t) * (t * (1.0 - t));
        let length: f32 = (0..64).map(|n| free(n as f32 / 64.0).distance(free((n + 1) as f32 / 64.0))).sum();
        assert!(length > 1.02, "{length}");
    }

    #[test]
    fn curves_end_as_they_bend() {
        // On a parabola with sections of equal steps along X the curve is exact, at its ends, too.
        let joints: Vec<Vec3> = (0..=5).map(|n| Vec3::new(n as f32, 0.02 * (n * n) as f32, 0.0)).collect();
        for (start, [before, after], section) in sections(&joints) {
            for fraction in [0.25, 0.5, 0.75] {
                let at = start + point(before, section, after, fraction, 1.0);
                assert!((at.y - 0.02 * at.x * at.x).abs() < 1e-6, "{at}");
            }
        }
    }
}
