//! The codec of patches, and a closed loop: the client does the same steps of the bend field on what it has decoded, and gets the cells that differ.

use anyhow::Result;
use prairie_core::bend::{Bend, Field, Serial};
use prairie_core::wire::quantise::CodeSteps;
use prairie_core::wire::{Shape, codec};

use super::Sent;
use super::drive::{Recording, STEPS_PER_FRAME};

/// Codes of the first `planes` planes, as they are streamed to clients without a replica: differences from the frame before.
pub(super) fn codec(recording: &Recording, steps: &CodeSteps, planes: usize) -> Result<Sent> {
    let side = recording.layout.cells as usize;
    let shape = Shape { width: side, planes };
    let mut held = vec![vec![0_i16; planes * side * side]; recording.patches.len()];
    let (mut bytes, mut error_rad) = (0, 0.0_f32);
    for frame in &recording.frames {
        for (held, patch) in held.iter_mut().zip(&frame.patches) {
            let codes = patch.as_ref().map_or_else(|| vec![0; held.len()], |values| codes(values, planes, steps));
            if codes != *held {
                bytes += codec::encode(shape, &codes, Some(held)).len();
                *held = codes;
            }
            let thetas = patch.iter().flat_map(|values| &values[0]).zip(held.iter());
            error_rad = thetas.map(|(theta, code)| (theta - steps.theta_rad(*code)).abs()).fold(error_rad, f32::max);
        }
    }
    Ok(Sent { bytes, error_rad })
}

fn codes(values: &[Vec<f32>; 3], planes: usize, steps: &CodeSteps) -> Vec<i16> {
    let mut codes = vec![0; planes * values[0].len()];
    for (channel, (codes, values)) in codes.chunks_exact_mut(values[0].len()).zip(values).enumerate() {
        if channel == 0 { steps.theta_codes(values, codes) } else { steps.omega_codes(values, codes) }
    }
    codes
}

/// Corrections of the cells whose θ or ω is off by more than the error of a code. Corrections have half the steps, so that each puts its cell within the error.
pub(super) fn closed_loop(recording: &Recording, steps: &CodeSteps) -> Result<Sent> {
    let side = recording.layout.cells as usize;
    let fine = CodeSteps { theta_rad: 0.5 * steps.theta_rad, omega_root: 0.5 * steps.omega_root, ..*steps };
    let mut client = recording.at_rest.clone();
    let (mut bytes, mut error_rad) = (0, 0.0_f32);
    for frame in &recording.frames {
        for _ in 0..STEPS_PER_FRAME {
            client.step(recording.scheme, recording.dt_secs, &Serial)?;
        }
        for (index, patch) in recording.patches.iter().zip(&frame.patches) {
            let at_rest = [0, 1, 2].map(|_| vec![0.0; side * side]);
            if patch.is_none() && client.patch(*index).is_none() {
                continue;
            }
            let (corrections, error) = correct(&mut client, *index, patch.as_ref().unwrap_or(&at_rest), steps, &fine);
            if corrections.iter().any(|code| *code != 0) {
                bytes += codec::encode(Shape::patch(side), &corrections, None).len();
            }
            error_rad = error_rad.max(error);
        }
    }
    Ok(Sent { bytes, error_rad })
}

/// Corrects a patch of the client. Returns the corrections, as differences of codes, and the largest error of θ (rad) after them.
fn correct(client: &mut Field, index: u32, wanted: &[Vec<f32>; 3], steps: &CodeSteps, fine: &CodeSteps) -> (Vec<i16>, f32) {
    let (patch, mut error_rad) = (client.wake(index), 0.0_f32);
    let (side, plane) = (patch.side(), wanted[0].len());
    let mut corrections = vec![0; 3 * plane];
    for at in 0..plane {
        let (i, j) = (at % side, at / side);
        let (now, before) = (patch.bend(i, j), patch.bend_before(i, j));
        let wanted = Bend { theta: wanted[0][at], omega: [wanted[1][at], wanted[2][at]] };
        let is_off = |found: f32, wanted: f32| (found - wanted).abs() > omega_error(wanted, steps);
        if (now.theta - wanted.theta).abs() > 0.5 * steps.theta_rad || (0..2).any(|axis| is_off(now.omega[axis], wanted.omega[axis])) {
            let [held, sent] =
                [now, wanted].map(|bend| [fine.theta_code(bend.theta), fine.omega_code(bend.omega[0]), fine.omega_code(bend.omega[1])]);
            (0..3).for_each(|channel| corrections[channel * plane + at] = sent[channel] - held[channel]);
            if sent != held {
                let corrected = Bend::of_codes(sent, fine);
                patch.set(i, j, corrected, moved(before, now, corrected));
            }
        }
        error_rad = error_rad.max((patch.bend(i, j).theta - wanted.theta).abs());
    }
    (corrections, error_rad)
}

/// Largest error of a component of ω (rad/s).
fn omega_error(omega_rad_per_s: f32, steps: &CodeSteps) -> f32 {
    steps.omega_root * omega_rad_per_s.abs().sqrt() + 0.25 * steps.omega_root * steps.omega_root
}

/// The state before the correction, moved along with it, so that the motion stays.
fn moved(before: Bend, now: Bend, corrected: Bend) -> Bend {
    Bend {
        theta: before.theta + corrected.theta - now.theta,
        omega: [0, 1].map(|axis| before.omega[axis] + corrected.omega[axis] - now.omega[axis]),
    }
}
