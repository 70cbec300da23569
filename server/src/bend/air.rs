//! Air as it bends grass: the wash below a helicopter, taken as an object (001 §5.3), and the natural wind.

use super::contact::{HELD_RAD_PER_S, bending_speed_rad_per_s, for_each_cell, unit};
use super::footprint::Footprint;
use shared::bend::{Bend, CHANNELS, Coefficients, Field, Force, NODE_CELLS};
use shared::grid::{PatchIndex, PatchLayout};

/// Height of a rotor above the ground from which its wash reaches no grass (m).
pub const WASH_CEILING_M: f32 = 30.0;
/// Radius of the wash of a rotor on the ground (m), its speed (m/s), the bend it sustains (rad), the height it strikes at (m).
const WASH_RADIUS_M: f32 = 10.0;
const WASH_M_PER_S: f32 = 12.0;
const WASH_BEND_RAD: f32 = 1.2;
const WASH_STRIKE_M: f32 = 0.5;

/// The wash below a helicopter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wash {
    /// Below the rotor (m).
    pub center_m: [f32; 2],
    /// Of the area it bends (m).
    pub radius_m: f32,
    /// 1 on the ground, 0 from [`WASH_CEILING_M`] on.
    pub strength: f32,
}

impl Wash {
    /// The wash of a helicopter at `height_m` above the ground: weaker and smaller as it climbs. None above [`WASH_CEILING_M`].
    pub fn below(center_m: [f32; 2], height_m: f32) -> Option<Self> {
        let nearness = 1.0 - height_m.max(0.0) / WASH_CEILING_M;
        (nearness > 0.0).then_some(Self { center_m, radius_m: WASH_RADIUS_M * (0.4 + 0.6 * nearness), strength: nearness * nearness })
    }

    /// Bends the grass of awake patches outward (001 Fig. 9a): most halfway to the rim, not at all in the middle and at the rim. Returns
    /// the largest bending speed (rad/s).
    pub fn press(&self, field: &mut Field, dt_secs: f32) -> f32 {
        let mut largest = 0.0_f32;
        for_each_cell(field, &self.footprint(), |at_m, bend| {
            let out = [at_m[0] - self.center_m[0], at_m[1] - self.center_m[1]];
            let share = ((out[0] * out[0] + out[1] * out[1]).sqrt() / self.radius_m).min(1.0);
            let strength = self.strength * 4.0 * share * (1.0 - share);
            let limit = WASH_BEND_RAD * strength;
            if bend.theta >= limit {
                return None;
            }
            let omega = bending_speed_rad_per_s(WASH_M_PER_S * strength, bend.theta, WASH_STRIKE_M);
            let held = omega.max(HELD_RAD_PER_S);
            largest = largest.max(held);
            Some(Bend { theta: limit.min(bend.theta + omega * dt_secs), omega: unit(out)?.map(|d| d * held) })
        });
        largest
    }

    /// The square around the disc.
    pub fn footprint(&self) -> Footprint {
        let [x, z] = self.center_m;
        let r = self.radius_m;
        Footprint::around(vec![[x - r, z - r], [x + r, z - r], [x + r, z + r], [x - r, z + r]])
    }
}

/// Time in which grass follows the wind (s).
const FOLLOWS_SECS: f32 = 0.4;
/// Wind from which on grass bends no further (m/s).
const SATURATES_M_PER_S: f32 = 10.0;

/// What the wind near the ground sustains, on a grid over the world.
#[derive(Clone, Debug)]
pub struct GroundWind {
    /// Nodes along X and Z.
    pub nodes: [usize; 2],
    /// Distance between nodes (m); the first lies half of it from the origin.
    pub spacing_m: [f32; 2],
    /// Whether the grid repeats; else the nearest node holds beyond it.
    pub wraps: bool,
    /// Step of the world that it belongs to.
    pub tick: u64,
    /// Bend (rad) and bending velocity (rad/s) at the nodes, x fastest.
    pub sustained: Vec<[f32; CHANNELS]>,
}

/// Bend (rad) and bending velocity (rad/s) that a wind sustains: `θ = bend_rad·(min(|u|, 10)/10)²` leaning with the wind, at the speed
/// at which it got there.
pub fn sustained(wind_m_per_s: [f32; 2], bend_rad: f32) -> [f32; CHANNELS] {
    let [u, w] = wind_m_per_s;
    let speed = (u * u + w * w).sqrt();
    let share = speed.min(SATURATES_M_PER_S) / SATURATES_M_PER_S;
    let theta = bend_rad * share * share;
    let [x, z] = unit(wind_m_per_s).unwrap_or_default();
    [theta, x * theta / FOLLOWS_SECS, z * theta / FOLLOWS_SECS]
}

impl GroundWind {
    /// Writes what the wind sustains at the nodes of a patch into `out`.
    fn sample(&self, layout: &PatchLayout, patch: PatchIndex, out: &mut Force) {
        let [corner_x, corner_z] = layout.corner_m(patch);
        let step_m = NODE_CELLS as f32 * layout.cell_m;
        let columns: Vec<_> = (0..out.per_side).map(|i| self.between(0, corner_x + i as f32 * step_m)).collect();
        for j in 0..out.per_side {
            let (north, south, share_z) = self.between(1, corner_z + j as f32 * step_m);
            let (north, south) = (&self.sustained[north * self.nodes[0]..], &self.sustained[south * self.nodes[0]..]);
            for (i, &(west, east, share_x)) in columns.iter().enumerate() {
                let [nw, ne, sw, se] = [north[west], north[east], south[west], south[east]];
                for channel in 0..CHANNELS {
                    let n = nw[channel] + (ne[channel] - nw[channel]) * share_x;
                    let s = sw[channel] + (se[channel] - sw[channel]) * share_x;
                    out.nodes[channel][j * out.per_side + i] = n + (s - n) * share_z;
                }
            }
        }
    }

    /// The nodes on either side of a coordinate, and how far it is from the first to the second.
    fn between(&self, axis: usize, at_m: f32) -> (usize, usize, f32) {
        let count = self.nodes[axis] as i64;
        let at = at_m / self.spacing_m[axis] - 0.5;
        let low = at.floor();
        let share = at - low;
        let node = |n: i64| (if self.wraps { n.rem_euclid(count) } else { n.clamp(0, count - 1) }) as usize;
        (node(low as i64), node(low as i64 + 1), share)
    }
}

/// How the natural wind holds one patch: the bend that its grass would have from wind alone, at nodes.
///
/// The grass follows what the wind sustains within 0.4 s. The force is what the Verlet scheme needs to carry exactly this
/// bend: `F = (W⁺ − W) − (1 − λ)·(W − W⁻) + κ·dt²·W`. The scheme being linear in θ and ω, tracks and gusts add up: a gust passes over a
/// track without wiping it out, and grass that rises again rises to where the wind holds it.
#[derive(Clone, Debug)]
pub struct Sway {
    now: Force,
    before: Force,
    target: Force,
    force: Force,
    /// Step of the wind that the target is of; none: still air.
    aimed_at: Option<u64>,
    /// Sub-step (s) between the two states; none before the first.
    dt_secs: Option<f32>,
}

impl Sway {
    /// Grass upright in still air, on a patch of `side × side` cells.
    pub fn new(side: usize) -> Self {
        let zero = Force::zero(side);
        Self { now: zero.clone(), before: zero.clone(), target: zero.clone(), force: zero, aimed_at: None, dt_secs: None }
    }

    /// Takes the wind on; none: still air.
    pub fn aim(&mut self, wind: Option<&GroundWind>, layout: &PatchLayout, patch: PatchIndex) {
        let aimed_at = wind.map(|wind| wind.tick);
        if aimed_at == self.aimed_at {
            return;
        }
        self.aimed_at = aimed_at;
        match wind {
            Some(wind) => wind.sample(layout, patch, &mut self.target),
            None => self.target.nodes.iter_mut().for_each(|nodes| nodes.fill(0.0)),
        }
    }

    /// Largest bend (rad) or bending velocity (rad/s) of any node.
    pub fn largest(&self) -> f32 {
        self.now.nodes.iter().flatten().fold(0.0, |largest, value| value.abs().max(largest))
    }

    /// Follows the wind for a sub-step and returns the force that carries the grass along.
    pub fn advance(&mut self, k: &Coefficients) -> &Force {
        let dt_secs = k.dt_secs;
        let share = dt_secs / (FOLLOWS_SECS + dt_secs);
        let ratio = self.dt_secs.replace(dt_secs).map_or(1.0, |last| dt_secs / last);
        for channel in 0..CHANNELS {
            let memory = 1.0 - if channel == 0 { k.lambda_theta } else { k.lambda_omega };
            let targets = self.target.nodes[channel].iter();
            let states = self.now.nodes[channel].iter_mut().zip(&mut self.before.nodes[channel]);
            for ((target, (now, before)), force) in targets.zip(states).zip(&mut self.force.nodes[channel]) {
                let next = *now + (target - *now) * share;
                *force = (next - *now) - memory * ratio * (*now - *before) + k.restoring * *now;
                *before = *now;
                *now = next;
            }
        }
        &self.force
    }
}
