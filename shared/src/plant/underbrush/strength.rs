//! Breaking load of a component, and the joint that breaks (Endo et al. 2003, §3.2: it breaks beyond a largest elastic force).

use super::rest::{Load, balanced, moments};
use std::f64::consts::FRAC_PI_2;

/// Fraction of its stiffness that a broken joint keeps: everything above it hangs, however light.
const BROKEN_STIFFNESS: f64 = 1e-6;

/// Strength of each joint of `sections` relative to the base, with a rigidity that falls linearly to `tip_fraction` at the tip. For a round stalk of one
/// material rigidity scales with the fourth power of the diameter and strength with the third.
pub fn fractions(sections: usize, tip_fraction: f64) -> Vec<f64> {
    let rigidity = |joint: usize| 1.0 - (1.0 - tip_fraction) * joint as f64 / sections as f64;
    (0..sections).map(|joint| rigidity(joint).sqrt() * rigidity(joint).sqrt().sqrt()).collect()
}

/// The joint with the largest moment relative to its strength, and that moment over its relative strength (in units of EI/L).
pub(super) fn weakest(fractions: &[f64], moments: &[f64]) -> (usize, f64) {
    let strains = moments.iter().zip(fractions).map(|(moment, fraction)| moment / fraction).enumerate();
    strains.fold((0, 0.0), |most, joint| if joint.1 > most.1 { joint } else { most })
}

/// The joint at which a load breaks a component whose base breaks at the moment `strength` (in units of EI/L); `None` if it withstands the load, or
/// never breaks because `strength` is 0. `unbent_rad` is the angle of the unbent axis from upright, 0..=π.
pub fn breaks(joints: &[f64], fractions: &[f64], strength: f64, load: Load, unbent_rad: f64) -> Option<usize> {
    let (mut bends_rad, mut found) = (vec![0.0; joints.len()], vec![0.0; joints.len()]);
    balanced(joints, load, unbent_rad, &mut bends_rad);
    moments(load, unbent_rad, &bends_rad, &mut found);
    let (joint, most) = weakest(fractions, &found);
    (strength > 0.0 && most > strength).then_some(joint)
}

/// The joints of a component that a growing load across it has broken; `None` if no load across it breaks it.
pub(super) fn broken_across(joints: &[f64], fractions: &[f64], strength: f64) -> Option<Vec<f64>> {
    let loads = (-8..40).map(|twofold| Load { spread: 2f64.powi(twofold), tip: 0.0 });
    let joint = loads.into_iter().find_map(|load| breaks(joints, fractions, strength, load, FRAC_PI_2))?;
    let mut broken = joints.to_vec();
    broken[joint] *= BROKEN_STIFFNESS;
    Some(broken)
}

#[cfg(test)]
mod tests {
    use super::super::rest::joints;
    use super::*;

    #[test]
    fn a_stalk_breaks_at_its_foot_under_a_load_across_it() {
        let (joints, fractions) = (joints(8, 0.5), fractions(8, 0.5));
        let at = |spread| breaks(&joints, &fractions, 0.5, Load { spread, tip: 0.0 }, FRAC_PI_2);
        // The moment at the clamp of a beam that hardly bends is half the load times its length.
        assert_eq!((at(0.9), at(1.2)), (None, Some(0)));
        assert_eq!(breaks(&joints, &fractions, 0.0, Load { spread: 1e9, tip: 0.0 }, FRAC_PI_2), None, "never");
    }

    #[test]
    fn a_stalk_with_a_thin_tip_breaks_further_up_under_what_presses_on_its_tip() {
        let (joints, fractions) = (joints(8, 0.02), fractions(8, 0.02));
        let at = |load| breaks(&joints, &fractions, 0.1, load, 0.05);
        assert_eq!(at(Load { spread: 0.0, tip: 1.0 }), Some(4));
        assert_eq!(at(Load { spread: 3.0, tip: 0.0 }), Some(0));
    }

    #[test]
    fn a_load_across_breaks_the_joint_that_bears_least() {
        let joints = joints(8, 0.02);
        let softened = |fractions: &[f64], strength: f64| {
            let broken = broken_across(&joints, fractions, strength)?;
            Some((0..8).filter(|&joint| broken[joint] < joints[joint]).collect::<Vec<_>>())
        };
        assert_eq!(softened(&fractions(8, 0.02), 0.1), Some(vec![0]));
        assert_eq!(softened(&[1.0, 1.0, 1.0, 0.01, 1.0, 1.0, 1.0, 1.0], 0.1), Some(vec![3]));
        assert_eq!(softened(&fractions(8, 0.02), 0.0), None);
    }

    #[test]
    fn the_part_above_a_broken_joint_hangs() {
        let (joints, fractions) = (joints(8, 0.5), fractions(8, 0.5));
        let broken = broken_across(&joints, &fractions, 1.0).unwrap();
        let tip_rad = |joints: &[f64]| {
            let mut bends_rad = [0.0; 8];
            balanced(joints, Load { spread: 0.2, tip: 0.0 }, 0.1, &mut bends_rad);
            bends_rad[7]
        };
        assert!(tip_rad(&joints) < 0.05 && tip_rad(&broken) > 2.5, "{} and {}", tip_rad(&joints), tip_rad(&broken));
    }
}
