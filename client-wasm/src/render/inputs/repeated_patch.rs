//! The grass in the natural wind where no camera is near, as a texture that repeats, and the weights by which the grass near cameras takes its place.

use crate::render::gpu::device::Gpu;
use crate::render::gpu::mipmaps::all_mipmaps;
use crate::render::inputs::bend_atlas::{BendAtlas, halved, window_corner};
use crate::state::Mirror;
use half::f16;
use half::slice::HalfFloatSliceExt;
use prairie_core::bend::Patch;
use prairie_core::grass::RepeatedPatch;
use prairie_core::grid::PatchLayout;
use std::collections::HashMap;
use wgpu::TextureFormat;

/// A corner of patches.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Corner {
    /// Its place in the grid of patches; `None` before the first frame.
    at: Option<[i64; 2]>,
    /// Weight of the grass near cameras: 1 where it is pushed by itself, 0 where the repeated patch is shown.
    weight: f32,
}

pub(crate) struct RepeatedTextures {
    /// Leans along X and Z (rad) in the first two channels.
    pub(crate) leans: wgpu::Texture,
    /// Weights of the corners; corner `(x, z)` is texel `(x mod n, z mod n)`.
    pub(crate) near: wgpu::Texture,
    corners: NearCorners,
    /// Step of the repeated patch in the texture; `None` if there is nothing to show.
    step: Option<u64>,
    /// Repetitions of the patch in a metre.
    per_m: f32,
}

impl RepeatedTextures {
    /// Textures without grass, beside an atlas.
    pub(crate) fn new(gpu: &Gpu, atlas: &BendAtlas, repeated: Option<&RepeatedPatch>) -> Self {
        // A scene without natural wind never samples it.
        let cells = repeated.map_or(1, |_| RepeatedPatch::cells());
        let levels: Vec<_> = (0..all_mipmaps([cells; 2])).map(|level| vec![0; 8 * (cells as usize >> level).pow(2)]).collect();
        let corners = NearCorners::new(*atlas.layout(), atlas.side(), repeated.map_or(1.0, RepeatedPatch::recovery_secs));
        Self {
            leans: gpu.texture("repeated patch", TextureFormat::Rgba16Float, [cells; 2], &levels),
            near: gpu.texture("near weights", TextureFormat::R8Unorm, [atlas.side(); 2], &[corners.texels()]),
            corners,
            step: None,
            per_m: repeated.map_or(0.0, |repeated| 1.0 / repeated.period_m()),
        }
    }

    /// Repetitions of the patch in a metre; 0 if nothing is shown.
    pub(crate) fn per_m(&self) -> f32 {
        if self.step.is_some() { self.per_m } else { 0.0 }
    }

    /// Adopts the repeated patch of a mirror, `dt_secs` after the last call.
    pub(crate) fn update(&mut self, gpu: &Gpu, mirror: &Mirror, eye_m: [f32; 2], dt_secs: f32) {
        let shown = mirror.repeated_patch().and_then(RepeatedPatch::shown);
        let step = shown.map(|(step, _)| step);
        if let Some((_, patch)) = shown.filter(|_| step != self.step) {
            self.write(gpu, patch);
        }
        self.step = step;
        if step.is_some() && self.corners.update(mirror, eye_m, dt_secs) {
            gpu.write_level(&self.near, 0, [0; 3], [self.near.width(); 2], &self.corners.texels());
        }
    }

    fn write(&self, gpu: &Gpu, patch: &Patch) {
        let mut side = patch.side();
        let cells = (0..side * side).map(|n| patch.bend(n % side, n / side).lean_rad());
        let mut texels: Vec<f32> = cells.flat_map(|[x, z]| [x, z, 0.0, 0.0]).collect();
        let mut rounded = vec![f16::ZERO; texels.len()];
        for level in 0..self.leans.mip_level_count() {
            rounded.truncate(texels.len());
            rounded.convert_from_f32_slice(&texels);
            gpu.write_level(&self.leans, level, [0; 3], [side as u32; 2], bytemuck::cast_slice(&rounded));
            texels = halved(&texels, side);
            side /= 2;
        }
    }
}

/// Weights of the grass near cameras at the corners of patches in a window around the eye. They follow the cameras as slowly as grass recovers: pushed grass
/// rises to its full bend while that of the repeated patch fades, and the other way round.
struct NearCorners {
    layout: PatchLayout,
    side: u32,
    recovery_secs: f32,
    corners: Vec<Corner>,
}

impl NearCorners {
    fn new(layout: PatchLayout, side: u32, recovery_secs: f32) -> Self {
        Self { layout, side, recovery_secs, corners: vec![Corner::default(); (side * side) as usize] }
    }

    fn texels(&self) -> Vec<u8> {
        self.corners.iter().map(|corner| (corner.weight * 255.0).round() as u8).collect()
    }

    /// Follows the cameras for `dt_secs`. Returns whether any corner changed.
    fn update(&mut self, mirror: &Mirror, eye_m: [f32; 2], dt_secs: f32) -> bool {
        let place = |patch| self.layout.place(patch).map(i64::from);
        // Pushed patches, and whether their grass is bent already.
        let pushed: HashMap<[i64; 2], bool> =
            mirror.pushed_patches(eye_m).into_iter().map(|patch| (place(patch), mirror.patch(patch).is_some())).collect();
        let first = window_corner(&self.layout, self.side, eye_m);
        let followed = 1.0 - (-dt_secs.max(0.0) / self.recovery_secs).exp();
        let side = i64::from(self.side);
        let mut has_changed = false;
        for at in (0..side * side).map(|n| [first[0] + n % side, first[1] + n / side]) {
            let around = [[-1, -1], [0, -1], [-1, 0], [0, 0]].map(|[dx, dz]| pushed.get(&[at[0] + dx, at[1] + dz]));
            let goal = if around.iter().any(Option::is_some) { 1.0 } else { 0.0 };
            let corner = &mut self.corners[(at[0].rem_euclid(side) + at[1].rem_euclid(side) * side) as usize];
            let weight = match corner.at == Some(at) {
                true => corner.weight + (goal - corner.weight) * followed,
                false if around.contains(&Some(&true)) => goal,
                false => 0.0,
            };
            let new = Corner { at: Some(at), weight };
            has_changed |= std::mem::replace(corner, new) != new;
        }
        has_changed
    }
}
