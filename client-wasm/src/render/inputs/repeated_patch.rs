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
    /// Weights of the n × n corners; corner `(x, z)` is texel `(x mod n, z mod n)`.
    pub(crate) near: wgpu::Texture,
    corners: NearCorners,
    /// Step of the repeated patch in the texture; `None` before the first.
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
            near: gpu.texture("near weights", TextureFormat::R8Unorm, [corners.side; 2], std::slice::from_ref(&corners.texels)),
            corners,
            step: None,
            per_m: repeated.map_or(0.0, |repeated| 1.0 / repeated.period_m()),
        }
    }

    /// Repetitions of the patch in a metre; 0 before the first step is shown.
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
        // On the way to a distant moment the last one stays.
        self.step = step.or(self.step);
        if self.step.is_some() && self.corners.update(mirror, eye_m, dt_secs) {
            gpu.write_level(&self.near, 0, [0; 3], [self.near.width(); 2], &self.corners.texels);
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
    /// Corners along each side of the window, one more than patches.
    side: u32,
    recovery_secs: f32,
    corners: Vec<Corner>,
    /// Weights in 255ths.
    texels: Vec<u8>,
}

impl NearCorners {
    fn new(layout: PatchLayout, patches: u32, recovery_secs: f32) -> Self {
        let side = patches + 1;
        let count = side.pow(2) as usize;
        Self { layout, side, recovery_secs, corners: vec![Corner::default(); count], texels: vec![0; count] }
    }

    /// Follows the cameras for `dt_secs`. Returns whether any texel changed.
    fn update(&mut self, mirror: &Mirror, eye_m: [f32; 2], dt_secs: f32) -> bool {
        let first = window_corner(&self.layout, self.side - 1, eye_m);
        let goals = self.goals(mirror, eye_m, first);
        let followed = 1.0 - (-dt_secs.max(0.0) / self.recovery_secs).exp();
        let side = i64::from(self.side);
        let mut has_changed = false;
        for (n, goal) in (0..).zip(goals) {
            let at = [first[0] + n % side, first[1] + n / side];
            let slot = (at[0].rem_euclid(side) + at[1].rem_euclid(side) * side) as usize;
            let corner = &mut self.corners[slot];
            let weight = if corner.at == Some(at) { corner.weight + (goal - corner.weight) * followed } else { goal };
            *corner = Corner { at: Some(at), weight };
            let texel = (weight * 255.0).round() as u8;
            has_changed |= std::mem::replace(&mut self.texels[slot], texel) != texel;
        }
        has_changed
    }

    /// Weights towards which the corners go, row by row from the window's `first`: 1 around patches that are pushed and awake.
    fn goals(&self, mirror: &Mirror, eye_m: [f32; 2], first: [i64; 2]) -> Vec<f32> {
        let side = i64::from(self.side);
        let mut goals = vec![0.0; self.corners.len()];
        for patch in mirror.pushed_patches(eye_m).into_iter().filter(|patch| mirror.patch(*patch).is_some()) {
            let place = self.layout.place(patch).map(i64::from);
            for corner in [[0, 0], [1, 0], [0, 1], [1, 1]] {
                let [x, z] = [0, 1].map(|axis| place[axis] + corner[axis] - first[axis]);
                if (0..side).contains(&x) && (0..side).contains(&z) {
                    goals[(x + z * side) as usize] = 1.0;
                }
            }
        }
        goals
    }
}
