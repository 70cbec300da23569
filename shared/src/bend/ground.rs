//! Contact with the ground: bent grass lies down at a right angle and goes no further.
//!
//! Waves that meet add up, so the wave equations alone bend θ beyond π/2. [`Field::with_ground_contact`](super::Field::with_ground_contact) adds the
//! unilateral constraint |θ| ≤ π/2 with an inelastic impact, time-stepped as by Moreau (1988): each sub-step ends with the projection of θ⁺ to
//! [−π/2, π/2]. The velocity is the difference of two states, so what points into the ground is lost with the projection, in that sub-step and the next.
//!
//! It takes energy and gives none. In time the loss is `(θ'/c)²`, since θ' into the ground becomes 0; and the projection to an interval brings no two cells
//! further apart, so that |∇θ|² doesn't grow either. In a sub-step, let δ be the distance by which a cell would pass the ground, v⁻ and v its motions
//! before and after (toward the ground), and D = (h/(c·dt))². The discrete energy of [`verlet`](super::verlet) then changes by `−D·δ·(v + v⁻)` without damping:
//! v is never negative, and v⁻ only where grass leaves the ground and turns back to it within one sub-step.
//!
//! Stability doesn't come from it: the schemes are bounded without it, and are tested without it. It is a bound of the deviation from the lean in the wind,
//! which the field doesn't know; a wind of 10 m/s adds up to `grass.wind_bend_rad`.

use super::patch::Patch;
use crate::scene::words;
use serde::{Deserialize, Serialize};
use std::f32::consts::FRAC_PI_2;

words! {
    /// Contact of bent grass with the ground.
    #[derive(Default)]
    GroundContact {
        /// |θ| ≤ π/2 (Moreau 1988): grass that reaches a right angle loses its motion toward the ground.
        #[default]
        Inelastic = "inelastic",
        /// None: the wave equations alone, whose waves add up to more than a right angle.
        None = "none",
    }
}

impl GroundContact {
    /// Largest |θ| of a cell after a step (rad).
    pub fn limit_rad(self) -> f32 {
        match self {
            Self::Inelastic => FRAC_PI_2,
            Self::None => f32::INFINITY,
        }
    }
}

/// θ, at most `limit_rad` away from 0; NaN stays NaN.
#[inline(always)]
pub(super) fn held(theta_rad: f32, limit_rad: f32) -> f32 {
    if theta_rad > limit_rad {
        limit_rad
    } else if theta_rad < -limit_rad {
        -limit_rad
    } else {
        theta_rad
    }
}

/// Projects the newest θ of a patch's own cells.
pub(super) fn stop(patch: &mut Patch, limit_rad: f32) {
    let side = patch.side();
    for j in 0..side {
        let row = patch.at(0, j as i64);
        patch.now[0][row..row + side].iter_mut().for_each(|theta| *theta = held(*theta, limit_rad));
    }
}
