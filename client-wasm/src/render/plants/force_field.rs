//! Force field around the camera (Endo et al. 2003, §4.1): a mesh of volumes with the sheltered wind and the impulses of moving objects, which
//! bend the underbrush; grass feels the sheltered wind.

use crate::render::gpu::device::Gpu;
use crate::render::gpu::f16::half;
use crate::render::gpu::pipeline::{sampled, uniform};
use crate::render::gpu::uniforms::ForceFieldFrame;
use crate::render::inputs::wind_texture::WindTexture;
use crate::render::plants::obstacles::{StaticObstacles, of_pose};
use crate::render::solids::trees_and_stones::PlacedModel;
use crate::state::DecodedScene;
use prairie_core::plant::force_field::{Ball, Force, ForceField, Lingering, VolumeMesh, dynamic_pressure_pa};
use prairie_core::wire::ObjectPose;
use wgpu::BufferUsages;

/// Bindings of the texture and of the uniforms in `force_field.wgsl`.
const TEXTURE_BINDING: u32 = 26;
const FRAME_BINDING: u32 = 27;
/// Volumes of the mesh, and their size (m).
const COUNT: [usize; 3] = [64, 4, 64];
const SPACING_M: [f32; 3] = [2.0, 0.75, 2.0];
/// Diffusion and decay of impulses: they spread over about one volume while they fall to 1/e in 0.3 s.
const LINGERING: Lingering = Lingering { spread_m2_per_s: 2.0, decay_per_s: 3.5 };
/// Shortest time between two steps (s), and longest step.
const STEP_SECS: f32 = 1.0 / 40.0;
const LONGEST_SECS: f32 = 0.1;
/// Steps between updates of the wind: its frames arrive no more often.
const WIND_STEPS: u32 = 4;
/// Minimum speed at which an object pushes the air (m/s).
const LEAST_M_PER_S: f32 = 0.3;

pub(crate) struct CameraForceField {
    pub(crate) field: ForceField,
    still: StaticObstacles,
    /// For each volume the fractions of the wind's force that arrive along X and Z, and the pressure of the impulses, X and Z (Pa).
    texture: wgpu::Texture,
    view: wgpu::TextureView,
    frame: wgpu::Buffer,
    steps: u32,
    due_secs: f32,
}

impl CameraForceField {
    /// A field without forces.
    pub(crate) fn new(gpu: &Gpu, decoded: &DecodedScene, placed: &[PlacedModel]) -> Self {
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
        let mesh = VolumeMesh { count: COUNT, spacing_m: SPACING_M, corner: [0; 2] };
        let frame = gpu.empty_buffer("force field", size_of::<ForceFieldFrame>() as u64, BufferUsages::UNIFORM | BufferUsages::COPY_DST);
        let own = Self {
            field: ForceField::new(mesh, LINGERING),
            still: StaticObstacles::new(decoded, placed),
            view: texture.create_view(&Default::default()),
            texture,
            frame,
            steps: 0,
            due_secs: STEP_SECS,
        };
        own.write(gpu);
        own
    }

    /// Layout entries of the field in the passes that sample it.
    pub(crate) fn layout() -> [wgpu::BindGroupLayoutEntry; 2] {
        let volumes = sampled(TEXTURE_BINDING, wgpu::TextureSampleType::Float { filterable: true }, wgpu::TextureViewDimension::D3);
        [volumes, uniform(FRAME_BINDING)]
    }

    /// Its resources for these entries.
    pub(crate) fn resources(&self) -> [(u32, wgpu::BindingResource<'_>); 2] {
        [(TEXTURE_BINDING, wgpu::BindingResource::TextureView(&self.view)), (FRAME_BINDING, self.frame.as_entire_binding())]
    }

    /// Advances the field by the time since the previous frame, and moves it to a position on the ground. After a jump in time the lees are those of a steady wind, so
    /// that pages that come to the same moment in different ways show the same grass.
    pub(crate) fn update(
        &mut self,
        gpu: &Gpu,
        decoded: &DecodedScene,
        wind: &WindTexture,
        poses: &[ObjectPose],
        at_m: [f32; 2],
        dt_secs: f32,
    ) {
        let jumps = !(0.0..=LONGEST_SECS).contains(&dt_secs);
        self.due_secs += dt_secs.max(0.0);
        if self.due_secs < STEP_SECS && !jumps {
            return;
        }
        let dt_secs = std::mem::take(&mut self.due_secs).min(LONGEST_SECS);
        let corner = self.field.mesh().about(at_m).corner;
        let starts_anew = self.steps == 0 || jumps;
        let has_moved = starts_anew || corner != self.field.mesh().corner;
        if has_moved {
            self.field.move_to(corner);
            self.field.stand(self.still.near(*self.field.mesh()));
        }
        self.field.step(dt_secs);
        self.field.obstruct(poses.iter().map(|pose| of_pose(decoded, pose)));
        if has_moved || self.steps.is_multiple_of(WIND_STEPS) {
            self.field.blow(|[x, above, z]| dynamic_pressure_pa(wind.resolved_at(decoded, [x, above, z])));
        }
        for pose in poses {
            let [x, y, z] = pose.position_m;
            let speed2: f32 = pose.velocity_m_per_s.iter().map(|v| v * v).sum();
            if speed2 > LEAST_M_PER_S * LEAST_M_PER_S {
                // Volume of the ellipsoid in its box and of its mirror image in the ground, which no air enters either.
                let radius_m = (2.0 * decoded.scene().objects.half_extents_m(pose.kind).into_iter().product::<f32>()).cbrt();
                let at_m = [x, y - decoded.heights().height_m(x, z), z];
                Ball { at_m, radius_m, velocity_m_per_s: pose.velocity_m_per_s }.push(&mut self.field, dt_secs);
            }
        }
        // Lees grow by one volume per step; at the start they are computed in full.
        (0..if starts_anew { COUNT[0] } else { 1 }).for_each(|_| self.field.shelter());
        self.steps += 1;
        self.write(gpu);
    }

    fn write(&self, gpu: &Gpu) {
        let [corner_x, corner_z] = self.field.mesh().corner;
        let frame = ForceFieldFrame {
            corner_m: [corner_x as f32 * SPACING_M[0], corner_z as f32 * SPACING_M[2]],
            extent_m: [COUNT[0] as f32 * SPACING_M[0], COUNT[2] as f32 * SPACING_M[2]],
            height_m: COUNT[1] as f32 * SPACING_M[1],
            _pad: [0; 12],
        };
        gpu.queue.write_buffer(&self.frame, 0, bytemuck::bytes_of(&frame));
        let texel = |Force { arriving, lasting_pa, .. }: Force| [arriving[0], arriving[2], lasting_pa[0], lasting_pa[2]].map(half);
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
