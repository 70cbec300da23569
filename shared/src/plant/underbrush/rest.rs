//! Rest shape of a whole component under a load: by the one-pass method of Endo et al. 2003, and in full balance.
//!
//! A component is a chain of straight sections of equal length with springs at their lower ends; its mass and the load are uniform along it. Lengths
//! are in units of the component's length L, rigidities in units of EI at its base, forces in units of EI/L², moments and rotational stiffness in
//! units of EI/L. Angles from upright are against the load: a section at π points along it.

use super::section;
use std::f64::consts::PI;

/// A load, each term times L²/EI, all in one direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Load {
    /// Uniform along the component: its weight, or the drag of the air.
    pub spread: f64,
    /// At the tip.
    pub tip: f64,
}

impl Load {
    /// Load on the section `section` of `count` from everything above its middle, times its length.
    fn held(&self, section: usize, count: usize) -> f64 {
        (self.tip + self.spread * (count as f64 - section as f64 - 0.5) / count as f64) / count as f64
    }

    /// The part of that load that rotates the section: all of it, except in the lowest.
    fn turning(&self, section: usize, count: usize) -> f64 {
        self.held(section, count) * if section == 0 { FOOT_LOAD_FRACTION } else { 1.0 }
    }
}

/// Fraction of its load that rotates the lowest section. The joint at the clamp represents half a section, so it bends by the moment in the middle of
/// that half: a quarter of the section is below.
const FOOT_LOAD_FRACTION: f64 = 0.75;

/// Rotational stiffness of the joints at the lower ends of `sections` sections, from the base, with a rigidity that falls linearly to `tip_fraction` at
/// the tip.
///
/// A joint's stiffness is the rigidity there over the distance between the centres of the sections that it joins. The base is clamped, so its joint
/// bends over half a section only and is twice as stiff: this makes the shape second-order accurate in the number of sections instead of first-order.
pub fn joints(sections: usize, tip_fraction: f64) -> Vec<f64> {
    let count = sections as f64;
    let rigidity = |joint: usize| 1.0 - (1.0 - tip_fraction) * joint as f64 / count;
    (0..sections).map(|joint| count * rigidity(joint) * if joint == 0 { 2.0 } else { 1.0 }).collect()
}

/// Rest shape by the one-pass method of Endo et al. 2003, §3.2: from the base up, each section bends under everything above its joint, assumed
/// straight, and is then fixed. Writes the rotation of each section from the unbent axis towards the load (rad). `unbent_rad` is the angle of that
/// axis from upright, 0..=π.
///
/// The spring of a section has k·d² equal to its joint's stiffness.
pub fn one_pass(joints: &[f64], load: Load, unbent_rad: f64, bends_rad: &mut [f64]) {
    let count = joints.len();
    let mut bend_rad = 0.0;
    for (section, (&joint, out)) in joints.iter().zip(bends_rad).enumerate() {
        let length = (count - section) as f64 / count as f64;
        // The weight above the joint times the distance to its centre of mass.
        let torque = load.spread * length * length / 2.0 + load.tip * length;
        if torque > 0.0 {
            bend_rad += section::bend_rad(unbent_rad + bend_rad, joint / torque);
        }
        *out = bend_rad;
    }
}

/// Rest shape: every joint balances the moment of everything above it in the bent position. Of several such shapes, it is the stable one that the
/// component reaches as the load grows from zero. Writes the rotation of each section from the unbent axis towards the load (rad). `unbent_rad` is the angle of that axis from
/// upright, 0..=π; an upright component that buckles takes the bent shape.
///
/// For a load of up to 10 across it at its tip, the tip is at most 0.2/n² of the length from that of a continuous beam, with n ≥ 6 sections: 0.3 %
/// with 8, 0.08 % with 16.
///
/// Shooting: the angle of the topmost section determines all others down to the clamp, as the moment at a joint depends only on the sections above
/// it. As long as none of them rises above the unbent axis, only one angle fits the clamp (the load's sin ψ/ψ falls with ψ: Brezis & Oswald 1986),
/// and all larger ones rise above it; so bracketing always finds this shape. Angles are measured from the load's direction, since heavy loads leave
/// differences too small for an angle from upright.
pub fn balanced(joints: &[f64], load: Load, unbent_rad: f64, bends_rad: &mut [f64]) {
    let clamp_rad = PI - unbent_rad;
    // As sin ψ ≤ ψ, angles grow no faster towards the base than if the load rotated with ψ itself.
    let mut low = clamp_rad / shoot(joints, load, 1.0, f64::INFINITY, |angle| angle, bends_rad);
    let mut excess = |tip_rad: f64| shoot(joints, load, tip_rad, clamp_rad, f64::sin, bends_rad) - clamp_rad;
    let mut excess_low = excess(low);
    // A straight upright shape would fit as well, but is unstable.
    let (mut high, mut excess_high) = (clamp_rad, 1.0);
    while excess_low < 0.0 && low > 0.0 && 2.0 * low < high {
        let more = excess(2.0 * low);
        if more > 0.0 {
            (high, excess_high) = (2.0 * low, more);
        } else {
            (low, excess_low) = (2.0 * low, more);
        }
    }
    // Ridders' method: each round at least halves the bracket.
    while excess_low < -CLOSE_RAD {
        let middle = 0.5 * (low + high);
        let at_middle = excess(middle);
        let tip_rad = middle - (middle - low) * at_middle / (at_middle * at_middle - excess_low * excess_high).sqrt();
        if middle <= low || middle >= high {
            break;
        }
        for (tip_rad, found) in [(middle, at_middle), (tip_rad, excess(tip_rad))] {
            if found <= 0.0 && tip_rad > low {
                (low, excess_low) = (tip_rad, found);
            } else if found > 0.0 && tip_rad < high {
                (high, excess_high) = (tip_rad, found);
            }
        }
    }
    excess(low);
    bends_rad.iter_mut().for_each(|angle_rad| *angle_rad = clamp_rad - *angle_rad);
}

/// Tolerance of the angle at the clamp (rad).
const CLOSE_RAD: f64 = 1e-14;

/// Angles of the sections from the load's direction, given that of the topmost; the load rotates them by `pull` of their angle. Returns the angle at
/// the clamp, or the first that exceeds `limit_rad`; sections below that are left at the limit.
fn shoot(joints: &[f64], load: Load, tip_rad: f64, limit_rad: f64, pull: impl Fn(f64) -> f64, angles_rad: &mut [f64]) -> f64 {
    let count = joints.len();
    let (mut angle_rad, mut moment) = (tip_rad, 0.0);
    for (section, (&joint, out)) in joints.iter().zip(angles_rad).enumerate().rev() {
        *out = angle_rad.min(limit_rad);
        if angle_rad <= limit_rad {
            moment += load.turning(section, count) * pull(angle_rad);
            angle_rad += moment / joint;
        }
    }
    angle_rad
}

/// Writes the bending moment at the lower end of each section under a load (in units of EI/L).
pub fn moments(load: Load, unbent_rad: f64, bends_rad: &[f64], moments: &mut [f64]) {
    let count = bends_rad.len();
    let mut moment = 0.0;
    for (section, (&bend_rad, out)) in bends_rad.iter().zip(moments).enumerate().rev() {
        moment += load.held(section, count) * (unbent_rad + bend_rad).sin();
        *out = moment;
    }
}

#[cfg(test)]
mod tests;
