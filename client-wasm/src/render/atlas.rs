//! The bend field about the camera as one texture: patch `(x, z)` lives in slot `(x mod n, z mod n)`, so that a camera that
//! moves changes only the patches that enter the window. Texels: θ, ωx, ωz.

use super::gpu::Gpu;
use crate::state::{Mirror, PatchCodes};
use shared::grid::{PatchIndex, PatchLayout};
use std::collections::HashSet;

/// Largest side of the atlas (texels).
const SIDE_LIMIT: u32 = 1024;
/// Mip levels; a patch's side is a multiple of 8 cells, so that none mixes two patches.
const LEVELS: u32 = 4;

/// Patches along one side of the window.
fn side(layout: &PatchLayout) -> u32 {
    (SIDE_LIMIT / layout.cells).max(2)
}

/// Distance from the camera along X or Z up to which the bend field can be shown (m).
pub fn reach_m(layout: &PatchLayout) -> f32 {
    (0.5 * side(layout) as f32 - 1.0) * layout.patch_m()
}

/// What a slot holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Slot {
    AtRest,
    Patch(PatchIndex),
}

pub(super) struct Atlas {
    pub(super) texture: wgpu::Texture,
    layout: PatchLayout,
    /// Patches along one side of the window.
    side: u32,
    slots: Vec<Slot>,
}

impl Atlas {
    pub(super) fn new(gpu: &Gpu, layout: PatchLayout) -> Self {
        let side = side(&layout);
        let size_px = side * layout.cells;
        let levels: Vec<_> = (0..LEVELS).map(|level| vec![0; ((size_px >> level).pow(2) * 4) as usize]).collect();
        let texture = gpu.texture("bend atlas", wgpu::TextureFormat::Rgba8Snorm, [size_px; 2], &levels);
        Self { texture, layout, side, slots: vec![Slot::AtRest; (side * side) as usize] }
    }

    /// Side of the window (m); the atlas repeats with it.
    pub(super) fn window_m(&self) -> f32 {
        self.side as f32 * self.layout.patch_m()
    }

    /// Distance from the camera along X or Z up to which the atlas holds (m).
    pub(super) fn reach_m(&self) -> f32 {
        reach_m(&self.layout)
    }

    /// Brings the window about the camera up to date; returns the number of patches written.
    pub(super) fn follow(&mut self, gpu: &Gpu, mirror: &mut Mirror, eye_x_m: f32, eye_z_m: f32) -> u32 {
        let dirty: HashSet<PatchIndex> = mirror.take_dirty_patches().into_iter().collect();
        let patch_m = self.layout.patch_m();
        let first = [eye_x_m, eye_z_m].map(|m| (m / patch_m).round() as i64 - i64::from(self.side) / 2);
        let mut written = 0;
        for dz in 0..i64::from(self.side) {
            for dx in 0..i64::from(self.side) {
                let (x, z) = (first[0] + dx, first[1] + dz);
                let index = self.layout.index(x, z);
                let codes = index.and_then(|index| mirror.patch(index));
                let wanted = index.filter(|_| codes.is_some()).map_or(Slot::AtRest, Slot::Patch);
                let origin = [x, z].map(|n| n.rem_euclid(i64::from(self.side)) as u32);
                let slot = &mut self.slots[(origin[0] + origin[1] * self.side) as usize];
                let is_stale = *slot != wanted || index.is_some_and(|index| wanted != Slot::AtRest && dirty.contains(&index));
                if is_stale {
                    *slot = wanted;
                    self.write(gpu, origin, codes);
                    written += 1;
                }
            }
        }
        written
    }

    fn write(&self, gpu: &Gpu, slot: [u32; 2], codes: Option<&PatchCodes>) {
        let mut side = self.layout.cells as usize;
        let mut texels = vec![0_i8; side * side * 4];
        if let Some(codes) = codes {
            for (channel, plane) in codes.planes().into_iter().enumerate() {
                for (i, &code) in plane.iter().enumerate() {
                    texels[i * 4 + channel] = code;
                }
            }
        }
        for level in 0..LEVELS {
            let origin = slot.map(|n| n * side as u32);
            gpu.write_level(&self.texture, level, origin, [side as u32; 2], bytemuck::cast_slice(&texels));
            texels = halved(&texels, side);
            side /= 2;
        }
    }
}

/// Means of 2 × 2 texels.
fn halved(texels: &[i8], side: usize) -> Vec<i8> {
    let half = side / 2;
    let mut coarse = Vec::with_capacity(half * half * 4);
    for z in 0..half {
        for x in 0..half {
            for channel in 0..4 {
                let at = |dx: usize, dz: usize| i16::from(texels[((2 * z + dz) * side + 2 * x + dx) * 4 + channel]);
                coarse.push(((at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1)) / 4) as i8);
            }
        }
    }
    coarse
}
