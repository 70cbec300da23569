//! Natural wind as noise near the cameras (Chen & Johan, §5.3, second approach).

use super::camera::Camera;
use crate::bend::{Bend, Field, TILE};
use crate::grid::{PatchIndex, PatchLayout};
use crate::scene::{NaturalWind, Scene};
use noise::{NoiseFn, Perlin};

/// Rate at which gusts change while they travel (1/s).
const CHANGE_PER_S: f64 = 0.15;
/// Bending speed that a gust gives for each radian of bend (1/s). It sets the direction of the bend, and stays small beside the speeds of struck grass.
const OMEGA_PER_THETA_PER_S: f32 = 1.0;

/// Gusts of Perlin noise that travel over the terrain.
pub(super) struct GustNoise {
    noise: Perlin,
    settings: NaturalWind,
    /// Unit vector along which the grass is pushed.
    along: [f32; 2],
    time_secs: f64,
}

impl GustNoise {
    /// The natural wind of a scene, if its strength is not zero.
    pub(super) fn new(scene: &Scene) -> Option<Self> {
        let settings = scene.natural_wind;
        let [x, z] = settings.drift_m_per_s;
        let speed = (x * x + z * z).sqrt();
        let along = if speed > 0.0 { [x / speed, z / speed] } else { [1.0, 0.0] };
        (settings.strength_rad_per_s2 > 0.0).then(|| Self { noise: Perlin::new(scene.seed as u32), settings, along, time_secs: 0.0 })
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
        let reach_m = self.settings.reach_m;
        let near = |camera: &Camera| {
            let [x, z] = camera.xz();
            let within = move |patch: &PatchIndex| {
                let [dx, dz] = [layout.center_m(*patch)[0] - x, layout.center_m(*patch)[1] - z];
                dx * dx + dz * dz < reach_m * reach_m
            };
            layout.patches_touching([x - reach_m, z - reach_m], [x + reach_m, z + reach_m]).filter(within)
        };
        let mut patches: Vec<_> = cameras.iter().flat_map(near).collect();
        patches.sort_unstable();
        patches.dedup();
        patches
    }

    /// Pushes the grass of the awake ones among `patches` for `dt_secs`. A gust accelerates θ, and ω along with it at [`OMEGA_PER_THETA_PER_S`], so that the
    /// grass leans along the drift.
    pub(super) fn push(&mut self, field: &mut Field, patches: &[PatchIndex], dt_secs: f32) {
        self.time_secs += f64::from(dt_secs);
        let layout = *field.layout();
        // A displacement over the last sub-step that changes the speed by the acceleration times `dt_secs`.
        let secs2 = dt_secs * field.between_states_secs().unwrap_or(dt_secs);
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
                    let theta = mix([mix(north, u), mix(south, u)], v);
                    Bend { theta, omega: self.along.map(|along| along * theta * OMEGA_PER_THETA_PER_S) }
                });
            }
        }
    }

    /// Displacement of the grass (rad) at the corners of a patch's tiles, row by row, by gusts that act for a time whose square is `secs2` (s²).
    fn pushes_rad(&self, layout: &PatchLayout, patch: PatchIndex, secs2: f32) -> Vec<f32> {
        let [corner_x, corner_z] = layout.corner_m(patch);
        let (tile_m, corners) = (TILE as f32 * layout.cell_m, layout.cells as usize / TILE + 1);
        let scale_m = f64::from(self.settings.scale_m);
        let most = self.settings.strength_rad_per_s2 * secs2;
        let push = |n: usize| {
            let at_m = [(n % corners) as f32 * tile_m + corner_x, (n / corners) as f32 * tile_m + corner_z];
            let [x, z] =
                [0, 1].map(|axis| (f64::from(at_m[axis]) - f64::from(self.settings.drift_m_per_s[axis]) * self.time_secs) / scale_m);
            most * (self.noise.get([x, z, self.time_secs * CHANGE_PER_S]) as f32).max(0.0)
        };
        (0..corners * corners).map(push).collect()
    }
}
