//! Natural wind as noise near the cameras (Chen & Johan, §5.3, second approach).

use super::camera::Camera;
use super::gust_pattern::GustPattern;
use crate::bend::{Bend, Field, TILE};
use crate::grid::{PatchIndex, PatchLayout};
use crate::scene::Scene;

/// Bending speed that a gust gives for each radian of bend (1/s). It sets the direction of the bend, and stays small beside the speeds of struck grass.
const OMEGA_PER_THETA_PER_S: f32 = 1.0;

/// Gusts that push the patches near cameras.
pub(super) struct GustNoise {
    pattern: GustPattern,
    reach_m: f32,
    time_secs: f64,
}

impl GustNoise {
    /// The natural wind of a scene, if its strength is not zero.
    pub(super) fn new(scene: &Scene) -> Option<Self> {
        Some(Self { pattern: GustPattern::new(scene)?, reach_m: scene.natural_wind.reach_m, time_secs: 0.0 })
    }

    /// Simulated time of the next step (s).
    pub(super) fn time_secs(&self) -> f64 {
        self.time_secs
    }

    /// Sets the simulated time of the next step (s).
    pub(super) fn set_time(&mut self, time_secs: f64) {
        self.time_secs = time_secs;
    }

    /// Patches whose centre is within reach of a camera.
    pub(super) fn patches(&self, layout: &PatchLayout, cameras: &[Camera]) -> Vec<PatchIndex> {
        patches_within(layout, self.reach_m, cameras.iter().map(Camera::xz))
    }

    /// Pushes the grass of the awake ones among `patches` for `dt_secs`. A gust accelerates θ, and ω along with it at [`OMEGA_PER_THETA_PER_S`], so that the
    /// grass leans along the drift.
    pub(super) fn push(&mut self, field: &mut Field, patches: &[PatchIndex], dt_secs: f32) {
        self.time_secs += f64::from(dt_secs);
        let layout = *field.layout();
        let secs2 = push_secs2(field, dt_secs);
        for &index in patches {
            let pushes = self.pushes_rad(&layout, index, secs2);
            let Some(patch) = field.patch_mut(index) else { continue };
            let tiles = patch.side() / TILE;
            for [x, z] in (0..tiles * tiles).map(|n| [n % tiles, n / tiles]) {
                let corner = z * (tiles + 1) + x;
                let [north, south] = [corner, corner + tiles + 1].map(|west| [pushes[west], pushes[west + 1]]);
                if north == [0.0; 2] && south == [0.0; 2] {
                    continue;
                }
                patch.push_tile([x, z], |at| {
                    let [u, v] = at.map(|n| (n as f32 + 0.5) / TILE as f32);
                    let mix = |[a, b]: [f32; 2], weight: f32| a + (b - a) * weight;
                    push_along(self.pattern.along(), mix([mix(north, u), mix(south, u)], v))
                });
            }
        }
    }

    /// Displacement of the grass (rad) at the corners of a patch's tiles, row by row, by gusts that act for a time whose square is `secs2` (s²).
    fn pushes_rad(&self, layout: &PatchLayout, patch: PatchIndex, secs2: f32) -> Vec<f32> {
        let [corner_x, corner_z] = layout.corner_m(patch);
        let (tile_m, corners) = (TILE as f32 * layout.cell_m, layout.cells as usize / TILE + 1);
        let push = |n: usize| {
            let at_m = [(n % corners) as f32 * tile_m + corner_x, (n / corners) as f32 * tile_m + corner_z];
            self.pattern.acceleration_rad_per_s2(at_m, self.time_secs) * secs2
        };
        (0..corners * corners).map(push).collect()
    }
}

/// Patches whose centre is within `reach_m` of one of `eyes_m` (X and Z), in ascending order.
pub fn patches_within(layout: &PatchLayout, reach_m: f32, eyes_m: impl IntoIterator<Item = [f32; 2]>) -> Vec<PatchIndex> {
    let near = |[x, z]: [f32; 2]| {
        let within = move |patch: &PatchIndex| {
            let [dx, dz] = [layout.center_m(*patch)[0] - x, layout.center_m(*patch)[1] - z];
            dx * dx + dz * dz < reach_m * reach_m
        };
        layout.patches_touching([x - reach_m, z - reach_m], [x + reach_m, z + reach_m]).filter(within)
    };
    let mut patches: Vec<_> = eyes_m.into_iter().flat_map(near).collect();
    patches.sort_unstable();
    patches.dedup();
    patches
}

/// Square of the time (s²) by which a push of the next step of `dt_secs` is its acceleration: over the last sub-step, so that the speed changes by the
/// acceleration times `dt_secs`.
pub(super) fn push_secs2(field: &Field, dt_secs: f32) -> f32 {
    dt_secs * field.between_states_secs().unwrap_or(dt_secs)
}

/// Displacement by a push of `theta_rad` along a unit vector.
pub(super) fn push_along(along: [f32; 2], theta_rad: f32) -> Bend {
    Bend { theta: theta_rad, omega: along.map(|along| along * theta_rad * OMEGA_PER_THETA_PER_S) }
}
