//! Bend atlas: the bend field around the camera in one texture. Patch `(x, z)` is stored in slot `(x mod n, z mod n)`, so that a moving camera changes only
//! the patches that enter the window. Texels: θ (rad), ωx and ωz (roots of rad/s, with their signs), difference in
//! the depth of snow (m). If the scene uses the history of the field, further layers store past states of the window.

use crate::render::gpu::constants::BEND_ATLAS_LEVELS;
use crate::render::gpu::device::Gpu;
use crate::state::{Mirror, PatchCodes};
use half::f16;
use half::slice::HalfFloatSliceExt;
use prairie_core::grid::{PatchIndex, PatchLayout};
use prairie_core::lod::PASTS;
use prairie_core::scene::{LagWay, Scene};
use prairie_core::wire::quantise::{CodeSteps, snow_m};
use std::collections::HashSet;

/// Largest side of the atlas (texels).
const SIDE_LIMIT: u32 = 1024;

/// Patches along one side of the window.
fn side(layout: &PatchLayout) -> u32 {
    (SIDE_LIMIT / layout.cells).max(2)
}

/// Maximum distance from the camera along X or Z that fits into the atlas (m).
pub fn reach_m(layout: &PatchLayout) -> f32 {
    (0.5 * side(layout) as f32 - 1.0) * layout.patch_m()
}

/// Place in the grid of patches of the first patch of a window of `side` × `side` patches around the eye.
pub(crate) fn window_corner(layout: &PatchLayout, side: u32, eye_m: [f32; 2]) -> [i64; 2] {
    eye_m.map(|m| (m / layout.patch_m()).round() as i64 - i64::from(side) / 2)
}

/// State of a slot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Slot {
    /// Position of its patch in the grid of patches; `None` if it was never filled.
    patch: Option<[i64; 2]>,
    /// Whether the newest layer is bent.
    is_bent: bool,
    /// Whether any layer may be bent.
    was_bent: bool,
}

/// Patches of the atlas whose newest layer is bent.
pub(crate) struct BentPatches {
    /// Whether all grass is bent, by the repeated patch.
    everywhere: bool,
    patch_m: f32,
    /// Places in the grid of patches.
    patches: Vec<[i64; 2]>,
}

impl BentPatches {
    /// Whether a square may show the bend of a patch; a coarse mip level spreads it by up to half a patch.
    pub(crate) fn touch(&self, corner_m: [f32; 2], side_m: f32) -> bool {
        let patch = |m: f32| (m / self.patch_m).floor() as i64;
        let low = corner_m.map(|m| patch(m - 0.5 * self.patch_m));
        let high = corner_m.map(|m| patch(m + side_m + 0.5 * self.patch_m));
        self.everywhere || self.patches.iter().any(|patch| (0..2).all(|axis| (low[axis]..=high[axis]).contains(&patch[axis])))
    }
}

pub(crate) struct BendAtlas {
    pub(crate) texture: wgpu::Texture,
    layout: PatchLayout,
    /// Patches along one side of the window.
    side: u32,
    steps: CodeSteps,
    slots: Vec<Slot>,
    pasts: Option<History>,
}

impl BendAtlas {
    pub(crate) fn new(gpu: &Gpu, layout: PatchLayout, scene: &Scene) -> Self {
        let side = side(&layout);
        let size_px = side * layout.cells;
        let pasts = History::of(scene);
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("bend atlas"),
            size: wgpu::Extent3d { width: size_px, height: size_px, depth_or_array_layers: pasts.as_ref().map_or(1, |_| 1 + PASTS as u32) },
            mip_level_count: BEND_ATLAS_LEVELS,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba16Float,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        Self { texture, layout, side, steps: CodeSteps::from(&scene.stream), slots: vec![Slot::default(); (side * side) as usize], pasts }
    }

    /// Side of the window (m), the period of the atlas.
    pub(crate) fn window_m(&self) -> f32 {
        self.side as f32 * self.layout.patch_m()
    }

    /// Distance from the camera along X or Z that the atlas covers (m).
    pub(crate) fn reach_m(&self) -> f32 {
        reach_m(&self.layout)
    }

    /// Layout of the bend field.
    pub(crate) fn layout(&self) -> &PatchLayout {
        &self.layout
    }

    /// Patches along one side of the window.
    pub(crate) fn side(&self) -> u32 {
        self.side
    }

    /// The patches that are bent now, or all if grass is bent `everywhere`.
    pub(crate) fn bent_patches(&self, everywhere: bool) -> BentPatches {
        let patches = self.slots.iter().filter(|slot| slot.is_bent).filter_map(|slot| slot.patch).collect();
        BentPatches { everywhere, patch_m: self.layout.patch_m(), patches }
    }

    /// Ages of the past layers (s), youngest first, and the index of the youngest; −1 without history.
    pub(crate) fn past(&self) -> [f32; 4] {
        self.pasts.as_ref().map_or([0.0, 0.0, 0.0, -1.0], |pasts| {
            let [a, b, c] = pasts.ages_secs;
            [a, b, c, pasts.youngest as f32]
        })
    }

    /// Updates the window around the camera, `dt_secs` after the last call. Returns the number of patches written.
    pub(crate) fn update(&mut self, gpu: &Gpu, mirror: &mut Mirror, eye_m: [f32; 2], dt_secs: f32) -> u32 {
        if let Some(pasts) = &mut self.pasts {
            pasts.update(gpu, &self.texture, dt_secs);
        }
        let dirty: HashSet<PatchIndex> = mirror.take_dirty_patches().into_iter().collect();
        let first = window_corner(&self.layout, self.side, eye_m);
        let mut written = 0;
        for dz in 0..i64::from(self.side) {
            for dx in 0..i64::from(self.side) {
                let patch = [first[0] + dx, first[1] + dz];
                let index = self.layout.index(patch[0], patch[1]);
                let codes = index.and_then(|index| mirror.patch(index));
                let origin = patch.map(|n| n.rem_euclid(i64::from(self.side)) as u32);
                let at = (origin[0] + origin[1] * self.side) as usize;
                let slot = self.slots[at];
                let (is_bent, has_moved) = (codes.is_some(), slot.patch != Some(patch));
                let is_stale = if has_moved {
                    is_bent || slot.was_bent
                } else {
                    is_bent != slot.is_bent || is_bent && index.is_some_and(|index| dirty.contains(&index))
                };
                self.slots[at] = Slot { patch: Some(patch), is_bent, was_bent: is_bent || slot.was_bent && !has_moved };
                if is_stale {
                    // The history of a patch that enters the window starts with its present state.
                    self.write(gpu, origin, codes, if has_moved { self.texture.depth_or_array_layers() } else { 1 });
                    written += 1;
                }
            }
        }
        if let Some(pasts) = self.pasts.as_mut().filter(|_| written > 0) {
            pasts.differing = PASTS;
        }
        written
    }

    /// Writes a slot in the newest `layers`.
    fn write(&self, gpu: &Gpu, slot: [u32; 2], codes: Option<&PatchCodes>, layers: u32) {
        let mut side = self.layout.cells as usize;
        let CodeSteps { theta_rad, omega_root, .. } = self.steps;
        let mut texels = vec![0.0_f32; side * side * 4];
        if let Some(codes) = codes {
            for (channel, (plane, step)) in codes.planes().into_iter().zip([theta_rad, omega_root, omega_root]).enumerate() {
                for (i, &code) in plane.iter().enumerate() {
                    texels[i * 4 + channel] = f32::from(code) * step;
                }
            }
        }
        for (i, &code) in codes.and_then(PatchCodes::snow).into_iter().flatten().enumerate() {
            texels[i * 4 + 3] = snow_m(code);
        }
        let mut rounded = vec![f16::ZERO; texels.len()];
        for level in 0..BEND_ATLAS_LEVELS {
            rounded.truncate(texels.len());
            rounded.convert_from_f32_slice(&texels);
            let [x, y] = slot.map(|n| n * side as u32);
            for layer in 0..layers {
                gpu.write_level(&self.texture, level, [x, y, layer], [side as u32; 2], bytemuck::cast_slice(&rounded));
            }
            texels = halved(&texels, side);
            side /= 2;
        }
    }
}

/// Ring of past layers behind layer 0.
struct History {
    /// Time between layers (s): half the longest lag, so that the oldest layer is always at least that old.
    period_secs: f32,
    /// Ages, youngest first (s).
    ages_secs: [f32; PASTS],
    /// Index of the youngest layer, from 1.
    youngest: u32,
    /// Number of layers that may differ from the newest.
    differing: usize,
}

impl History {
    /// `None` if the plants of the scene sample upwind instead, or have no lag.
    fn of(scene: &Scene) -> Option<Self> {
        let lag_secs = scene.kinds().iter().map(|grass| grass.lag_secs).fold(0.0, f32::max);
        let is_wanted = scene.plants.lag == LagWay::History && lag_secs > 0.0;
        let period_secs = 0.5 * lag_secs;
        let ages_secs = std::array::from_fn(|i| i as f32 * period_secs);
        is_wanted.then_some(Self { period_secs, ages_secs, youngest: 1, differing: 0 })
    }

    /// Ages the layers. When a layer is due, the newest state replaces the oldest.
    fn update(&mut self, gpu: &Gpu, texture: &wgpu::Texture, dt_secs: f32) {
        self.ages_secs = self.ages_secs.map(|age_secs| age_secs + dt_secs.max(0.0));
        if self.ages_secs[0] < self.period_secs {
            return;
        }
        self.ages_secs.rotate_right(1);
        self.ages_secs[0] = 0.0;
        self.youngest = self.youngest % PASTS as u32 + 1;
        // In still grass all layers are equal.
        if self.differing > 0 {
            self.differing -= 1;
            copy_layer(gpu, texture, self.youngest);
        }
    }
}

/// Copies layer 0 to another, all mip levels.
fn copy_layer(gpu: &Gpu, texture: &wgpu::Texture, to: u32) {
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("past") });
    for mip_level in 0..BEND_ATLAS_LEVELS {
        let place = |z| wgpu::TexelCopyTextureInfo {
            texture,
            mip_level,
            origin: wgpu::Origin3d { x: 0, y: 0, z },
            aspect: wgpu::TextureAspect::All,
        };
        let [width, height] = [texture.width() >> mip_level, texture.height() >> mip_level];
        encoder.copy_texture_to_texture(place(0), place(to), wgpu::Extent3d { width, height, depth_or_array_layers: 1 });
    }
    gpu.queue.submit([encoder.finish()]);
}

/// The next mip level: means of 2 × 2 texels.
pub(crate) fn halved(texels: &[f32], side: usize) -> Vec<f32> {
    let half = side / 2;
    let mut coarse = Vec::with_capacity(half * half * 4);
    for z in 0..half {
        for x in 0..half {
            for channel in 0..4 {
                let at = |dx: usize, dz: usize| texels[((2 * z + dz) * side + 2 * x + dx) * 4 + channel];
                coarse.push(0.25 * (at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1)));
            }
        }
    }
    coarse
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bent_patch_touches_squares_up_to_half_a_patch_away() {
        let bent = BentPatches { everywhere: false, patch_m: 16.0, patches: vec![[1, -1]] };
        // The patch covers 16 to 32 m in X, and -16 to 0 m in Z.
        for corner_m in [[20.0, -10.0], [3.5, -8.0], [39.5, -8.0], [24.0, -28.5], [24.0, 7.5]] {
            assert!(bent.touch(corner_m, 5.0), "{corner_m:?}");
        }
        for corner_m in [[2.5, -8.0], [40.5, -8.0], [24.0, -29.5], [24.0, 8.5], [-8.0, 24.0]] {
            assert!(!bent.touch(corner_m, 5.0), "{corner_m:?}");
        }
        assert!(bent.touch([-100.0, -100.0], 200.0), "a square around the patch");
        assert!(BentPatches { everywhere: true, ..bent }.touch([500.0, 0.0], 1.0));
    }
}
