//! The shape of a whole component under a load, 004's way and in full balance.
//!
//! A component is a chain of straight sections of equal length with springs at their lower ends; its mass is spread evenly along it, and so is the load.
//! Lengths are in units of the component's length L, rigidities in units of EI at its foot, forces in units of EI/L², moments and rotation stiffness in
//! units of EI/L. Angles from upright are against the load: a section at π points along it.

use super::section;
use std::f64::consts::PI;

/// A load, each part times L²/EI: all act in one direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Load {
    /// Spread evenly along the component; its weight, or the drag of the air.
    pub spread: f64,
    /// At its tip.
    pub tip: f64,
}

impl Load {
    /// What the section `section` of `count` holds, which is all that is above its middle, times its length.
    fn held(&self, section: usize, count: usize) -> f64 {
        (self.tip + self.spread * (count as f64 - section as f64 - 0.5) / count as f64) / count as f64
    }

    /// What of that turns it.
    fn turning(&self, section: usize, count: usize) -> f64 {
        self.held(section, count) * if section == 0 { FOOT_LOAD_SHARE } else { 1.0 }
    }
}

/// Share of its load that turns the lowest section. The joint at the clamp stands for half a section, so that it bends by the moment in the middle of that
/// half: a quarter of the section is below.
const FOOT_LOAD_SHARE: f64 = 0.75;

/// Rotation stiffness of the joints at the lower ends of `sections` sections, foot first, where the rigidity falls linearly to `tip_share` at the tip.
///
/// A joint has the rigidity at its place over the distance between the middles of the sections that it joins. The foot is clamped, so that its joint bends
/// over half a section only and is twice as stiff: with this the shape converges with the square of the number of sections, else with the number alone.
pub fn joints(sections: usize, tip_share: f64) -> Vec<f64> {
    let count = sections as f64;
    let rigidity = |joint: usize| 1.0 - (1.0 - tip_share) * joint as f64 / count;
    (0..sections).map(|joint| count * rigidity(joint) * if joint == 0 { 2.0 } else { 1.0 }).collect()
}

/// The rest shape as in 004 §3.2: from the foot up, each section bends under all that is above its joint, taken to be straight, and is then fixed. Writes
/// for each section how far it is turned from the unbent axis towards the load (rad). `unbent_rad` is the angle of that axis from upright, 0..=π.
///
/// The spring of a section is such that k·d² is its joint's stiffness.
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

/// The rest shape in which every joint balances the moment of all that is above it as it then lies: the stable shape that is reached without a jump as the
/// load grows. Writes for each section how far it is turned from the unbent axis towards the load (rad). `unbent_rad` is the angle of that axis from
/// upright, 0..=π; an upright component that cannot stand takes the bent shape.
///
/// Where a load across it at its tip is up to 10, the tip is at most 0.2/n² of the length off that of a continuous beam, n the number of sections, at
/// least 6: 0.3 % with 8, 0.08 % with 16.
///
/// Shooting: the angle of the topmost section gives all others down to the clamp, as the moment at a joint depends on the sections above it alone. While
/// none of them rises above the unbent axis, there is but one angle that fits the clamp (the load's sin ψ/ψ falls with ψ: Brezis & Oswald, Nonlinear
/// Analysis 10, 1986), and all larger ones rise above it; so a bracket finds the shape always, and no other. Angles are measured from the load's
/// direction, where heavy loads leave differences too small for an angle from upright.
pub fn balanced(joints: &[f64], load: Load, unbent_rad: f64, bends_rad: &mut [f64]) {
    let clamp_rad = PI - unbent_rad;
    // As sin ψ ≤ ψ, angles grow no faster towards the foot than where the load turns with ψ itself.
    let mut low = clamp_rad / shoot(joints, load, 1.0, f64::INFINITY, |angle| angle, bends_rad);
    let mut excess = |tip_rad: f64| shoot(joints, load, tip_rad, clamp_rad, f64::sin, bends_rad) - clamp_rad;
    let mut excess_low = excess(low);
    // A straight upright shape would fit as well, but falls over.
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

/// How closely a shape fits its clamp (rad).
const CLOSE_RAD: f64 = 1e-14;

/// Angles of the sections from the load's direction that follow from that of the topmost; the load turns them with `pull` of their angle. Returns the
/// angle that fits the clamp, or the first that exceeds `limit_rad`; sections below that are left at the limit.
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

/// Writes the bending moment at the lower end of each section that a load causes in a shape (in units of EI/L).
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
