//! The bend field about the camera as one texture: patch `(x, z)` lives in slot `(x mod n, z mod n)`, so that a camera that
//! moves changes only the patches that enter the window. Texels: θ, ωx, ωz. Where the scene wants it, further layers hold how the
//! window was a while ago.

use super::gpu::Gpu;
use crate::state::{Mirror, PatchCodes};
use shared::grid::{PatchIndex, PatchLayout};
use shared::lod::PASTS;
use shared::scene::{LagWay, Scene};
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
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Slot {
    /// The patch's place in the grid of patches; none before the first.
    place: Option<[i64; 2]>,
    /// Whether the newest layer has a bend.
    is_bent: bool,
    /// Whether any layer may have one.
    was_bent: bool,
}

pub(super) struct Atlas {
    pub(super) texture: wgpu::Texture,
    layout: PatchLayout,
    /// Patches along one side of the window.
    side: u32,
    slots: Vec<Slot>,
    pasts: Option<Pasts>,
}

impl Atlas {
    pub(super) fn new(gpu: &Gpu, layout: PatchLayout, scene: &Scene) -> Self {
        let side = side(&layout);
        let size_px = side * layout.cells;
        let pasts = Pasts::of(scene);
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("bend atlas"),
            size: wgpu::Extent3d { width: size_px, height: size_px, depth_or_array_layers: pasts.as_ref().map_or(1, |_| 1 + PASTS as u32) },
            mip_level_count: LEVELS,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba8Snorm,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        Self { texture, layout, side, slots: vec![Slot::default(); (side * side) as usize], pasts }
    }

    /// Side of the window (m); the atlas repeats with it.
    pub(super) fn window_m(&self) -> f32 {
        self.side as f32 * self.layout.patch_m()
    }

    /// Distance from the camera along X or Z up to which the atlas holds (m).
    pub(super) fn reach_m(&self) -> f32 {
        reach_m(&self.layout)
    }

    /// Ages of the layers that hold the past (s), youngest first, and the number of the youngest layer; −1 where none is kept.
    pub(super) fn past(&self) -> [f32; 4] {
        self.pasts.as_ref().map_or([0.0, 0.0, 0.0, -1.0], |pasts| {
            let [a, b, c] = pasts.ages_secs;
            [a, b, c, pasts.youngest as f32]
        })
    }

    /// Brings the window about the camera up to date, `dt_secs` after the last time; returns the number of patches written.
    pub(super) fn follow(&mut self, gpu: &Gpu, mirror: &mut Mirror, [eye_x_m, eye_z_m]: [f32; 2], dt_secs: f32) -> u32 {
        if let Some(pasts) = &mut self.pasts {
            pasts.follow(gpu, &self.texture, dt_secs);
        }
        let dirty: HashSet<PatchIndex> = mirror.take_dirty_patches().into_iter().collect();
        let patch_m = self.layout.patch_m();
        let first = [eye_x_m, eye_z_m].map(|m| (m / patch_m).round() as i64 - i64::from(self.side) / 2);
        let mut written = 0;
        for dz in 0..i64::from(self.side) {
            for dx in 0..i64::from(self.side) {
                let place = [first[0] + dx, first[1] + dz];
                let index = self.layout.index(place[0], place[1]);
                let codes = index.and_then(|index| mirror.patch(index));
                let origin = place.map(|n| n.rem_euclid(i64::from(self.side)) as u32);
                let at = (origin[0] + origin[1] * self.side) as usize;
                let slot = self.slots[at];
                let (is_bent, has_moved) = (codes.is_some(), slot.place != Some(place));
                let is_stale = if has_moved {
                    is_bent || slot.was_bent
                } else {
                    is_bent != slot.is_bent || is_bent && index.is_some_and(|index| dirty.contains(&index))
                };
                self.slots[at] = Slot { place: Some(place), is_bent, was_bent: is_bent || slot.was_bent && !has_moved };
                if is_stale {
                    // What enters the window has no past but its present.
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

    /// Writes a slot in so many `layers`, the newest first.
    fn write(&self, gpu: &Gpu, slot: [u32; 2], codes: Option<&PatchCodes>, layers: u32) {
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
            let [x, y] = slot.map(|n| n * side as u32);
            for layer in 0..layers {
                gpu.write_level(&self.texture, level, [x, y, layer], [side as u32; 2], bytemuck::cast_slice(&texels));
            }
            texels = halved(&texels, side);
            side /= 2;
        }
    }
}

/// The layers that hold how the window was a while ago: a ring behind layer 0.
struct Pasts {
    /// Time from one layer to the next (s): half the longest lag, so that the oldest is never younger than that.
    period_secs: f32,
    /// Youngest first (s).
    ages_secs: [f32; PASTS],
    /// Number of the youngest layer, from 1.
    youngest: u32,
    /// Layers that may differ from the newest.
    differing: usize,
}

impl Pasts {
    /// What the segments of a scene's plants want to know; none where they look upwind, or none trails.
    fn of(scene: &Scene) -> Option<Self> {
        let lag_secs = scene.kinds().iter().map(|grass| grass.lag_secs).fold(0.0, f32::max);
        let is_wanted = scene.plants.lag == LagWay::History && lag_secs > 0.0;
        let period_secs = 0.5 * lag_secs;
        let ages_secs = std::array::from_fn(|i| i as f32 * period_secs);
        is_wanted.then_some(Self { period_secs, ages_secs, youngest: 1, differing: 0 })
    }

    /// Lets the layers grow older; the newest takes the oldest's place when that is due.
    fn follow(&mut self, gpu: &Gpu, texture: &wgpu::Texture, dt_secs: f32) {
        self.ages_secs = self.ages_secs.map(|age_secs| age_secs + dt_secs.max(0.0));
        if self.ages_secs[0] < self.period_secs {
            return;
        }
        self.ages_secs.rotate_right(1);
        self.ages_secs[0] = 0.0;
        self.youngest = self.youngest % PASTS as u32 + 1;
        // In still grass all layers are the same.
        if self.differing > 0 {
            self.differing -= 1;
            copy_layer(gpu, texture, self.youngest);
        }
    }
}

/// Copies layer 0 to another, all mip levels.
fn copy_layer(gpu: &Gpu, texture: &wgpu::Texture, to: u32) {
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("past") });
    for mip_level in 0..LEVELS {
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
