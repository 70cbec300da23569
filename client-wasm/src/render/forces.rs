//! The force field (004 §4.1) about the camera: the wind, where nothing keeps it away, and what objects push along, in one mesh of volumes that the underbrush
//! feels.

use super::flora::Standing;
use super::gpu::Gpu;
use super::obstacles::{Still, of_pose};
use super::wind::WindTexture;
use crate::state::Land;
use shared::plant::force_field::{Ball, Force, ForceField, Lingering, Mesh, dynamic_pressure_pa};
use shared::wire::ObjectPose;

/// Volumes of the mesh, and their size (m).
const COUNT: [usize; 3] = [64, 4, 64];
const SPACING_M: [f32; 3] = [2.0, 0.75, 2.0];
/// How impulses linger: they spread over a volume or so while they fall to 1/e in 0.3 s.
const LINGERING: Lingering = Lingering { spread_m2_per_s: 2.0, decay_per_s: 3.5 };
/// Shortest time between two steps (s), and longest that one takes up.
const STEP_SECS: f32 = 1.0 / 40.0;
const LONGEST_SECS: f32 = 0.1;
/// Steps from one look at the wind to the next: its own frames come no more often.
const WIND_STEPS: u32 = 4;
/// Slowest object that pushes (m/s).
const LEAST_M_PER_S: f32 = 0.3;

pub(super) struct Forces {
    pub(super) field: ForceField,
    still: Still,
    /// Of each volume what arrives of the wind, X and Z, and what lingers, X and Z (Pa).
    texture: wgpu::Texture,
    pub(super) view: wgpu::TextureView,
    steps: u32,
    due_secs: f32,
}

impl Forces {
    /// A field without force, over land on which `standing` stands.
    pub(super) fn new(gpu: &Gpu, land: &Land, standing: &[Standing]) -> Self {
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("forces"),
            size: wgpu::Extent3d { width: COUNT[0] as u32, height: COUNT[2] as u32, depth_or_array_layers: COUNT[1] as u32 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D3,
            format: wgpu::TextureFormat::Rgba16Float,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        let mesh = Mesh { count: COUNT, spacing_m: SPACING_M, corner: [0; 2] };
        Self {
            field: ForceField::new(mesh, LINGERING),
            still: Still::new(land, standing),
            view: texture.create_view(&Default::default()),
            texture,
            steps: 0,
            due_secs: STEP_SECS,
        }
    }

    /// Corner of the mesh and its extent along X and Z (m).
    pub(super) fn window_m(&self) -> [f32; 4] {
        let [x, z] = self.field.mesh().corner;
        [x as f32 * SPACING_M[0], z as f32 * SPACING_M[2], COUNT[0] as f32 * SPACING_M[0], COUNT[2] as f32 * SPACING_M[2]]
    }

    /// Height of the mesh (m).
    pub(super) fn height_m(&self) -> f32 {
        COUNT[1] as f32 * SPACING_M[1]
    }

    /// Takes the field through the time since the frame before, about a place on the ground.
    pub(super) fn follow(&mut self, gpu: &Gpu, land: &Land, wind: &WindTexture, poses: &[ObjectPose], at_m: [f32; 2], dt_secs: f32) {
        self.due_secs += dt_secs.max(0.0);
        if self.due_secs < STEP_SECS {
            return;
        }
        let dt_secs = std::mem::take(&mut self.due_secs).min(LONGEST_SECS);
        let corner = self.field.mesh().about(at_m).corner;
        let is_first = self.steps == 0;
        let has_moved = is_first || corner != self.field.mesh().corner;
        if has_moved {
            self.field.move_to(corner);
            self.field.stand(self.still.near(*self.field.mesh()));
        }
        self.field.step(dt_secs);
        self.field.obstruct(poses.iter().map(|pose| of_pose(land, pose)));
        if has_moved || self.steps.is_multiple_of(WIND_STEPS) {
            self.field.blow(|[x, above, z]| dynamic_pressure_pa(wind.at(land, [x, above, z])));
        }
        for pose in poses {
            let [x, y, z] = pose.position_m;
            let speed2: f32 = pose.velocity_m_per_s.iter().map(|v| v * v).sum();
            if speed2 > LEAST_M_PER_S * LEAST_M_PER_S {
                // As large as the ellipsoid in its box and its mirror image in the ground, into which no air goes either.
                let radius_m = (2.0 * land.scene().objects.half_extents_m(pose.kind).into_iter().product::<f32>()).cbrt();
                let at_m = [x, y - land.heights().height_m(x, z), z];
                Ball { at_m, radius_m, velocity_m_per_s: pose.velocity_m_per_s }.push(&mut self.field, dt_secs);
            }
        }
        // Lees go on by a volume a step; in the first picture they are there.
        (0..if is_first { COUNT[0] } else { 1 }).for_each(|_| self.field.shelter());
        self.steps += 1;
        self.write(gpu);
    }

    fn write(&self, gpu: &Gpu) {
        let texel = |Force { wind_pa, lasting_pa }| [wind_pa[0], wind_pa[2], lasting_pa[0], lasting_pa[2]].map(half);
        let texels: Vec<[u16; 4]> = self.field.forces().map(texel).collect();
        let [width, layers, rows] = COUNT.map(|n| n as u32);
        gpu.queue.write_texture(
            self.texture.as_image_copy(),
            bytemuck::cast_slice(&texels),
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(width * 8), rows_per_image: Some(rows) },
            wgpu::Extent3d { width, height: rows, depth_or_array_layers: layers },
        );
    }
}

/// An `f32` as the bits of a half, rounded towards zero; what is too small is zero, what is too large the largest.
pub(super) fn half(value: f32) -> u16 {
    let bits = value.to_bits();
    let sign = (bits >> 16 & 0x8000) as u16;
    let exponent = (bits >> 23 & 0xff) as i32 - 112;
    match exponent {
        ..=0 => sign,
        31.. => sign | 0x7bff,
        _ => sign | (exponent as u16) << 10 | (bits >> 13 & 0x3ff) as u16,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_are_those_of_the_numbers() {
        let known = [
            (0.0, 0),
            (1.0, 0x3c00),
            (-2.0, 0xc000),
            (0.333_26, 0x3555),
            (65_504.0, 0x7bff),
            (1e9, 0x7bff),
            (-1e-9, 0x8000),
            (104.0, 0x5680),
        ];
        for (value, wanted) in known {
            assert_eq!(half(value), wanted, "{value}");
        }
    }
}
