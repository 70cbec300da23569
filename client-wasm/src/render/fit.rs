//! What a device must hold: the limits that every picture needs, and whether a renderer of some quality fits.

use super::{Gpu, GpuError, Quality, Renderer};
use crate::state::Mirror;

/// Least limits that the coarsest picture needs. WebGPU guarantees more of each, but not every adapter is WebGPU's.
pub(super) fn needed() -> wgpu::Limits {
    wgpu::Limits {
        // Bend atlas and shadow map.
        max_texture_dimension_2d: 2048,
        // Cells of the wind along an axis.
        max_texture_dimension_3d: 256,
        max_storage_buffers_per_shader_stage: 8,
        max_storage_buffer_binding_size: 16 << 20,
        max_buffer_size: 16 << 20,
        max_compute_invocations_per_workgroup: 256,
        max_compute_workgroup_size_x: 256,
        max_compute_workgroup_storage_size: 16 << 10,
        max_compute_workgroup_size_y: 1,
        max_compute_workgroup_size_z: 1,
        max_compute_workgroups_per_dimension: 65_535,
        max_inter_stage_shader_variables: 8,
        ..wgpu::Limits::downlevel_webgl2_defaults()
    }
}

/// The first of the needed limits that is not `allowed`.
pub(super) fn lacking(allowed: &wgpu::Limits) -> Option<GpuError> {
    let mut lacking = None;
    needed().check_limits_with_fail_fn(allowed, true, |name, needed, found| lacking = Some(GpuError::Limit { name, found, needed }));
    lacking
}

/// A picture's size scaled down, if need be, so that no side is longer than `limit_px`.
pub fn fitting_px(size_px: [u32; 2], limit_px: u32) -> [u32; 2] {
    let longest_px = size_px[0].max(size_px[1]);
    let scaled = |side_px: u32| (u64::from(side_px) * u64::from(limit_px) / u64::from(longest_px)) as u32;
    if longest_px > limit_px { size_px.map(|side_px| scaled(side_px).max(1)) } else { size_px.map(|side_px| side_px.max(1)) }
}

impl Renderer {
    /// A renderer with the mirror's scene loaded, and, by and by, what the device cannot hold of it; then it draws nothing sound, and a
    /// [lower](Quality::lower) quality may fit.
    pub fn fitted(
        gpu: &Gpu,
        format: wgpu::TextureFormat,
        size_px: [u32; 2],
        quality: Quality,
        mirror: &Mirror,
    ) -> (Self, impl Future<Output = Result<(), GpuError>> + use<>) {
        let memory = gpu.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let validity = gpu.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let mut renderer = Self::new(gpu, format, size_px, quality);
        renderer.load_scene(mirror);
        let found = [validity.pop(), memory.pop()];
        let verdict = async move {
            for error in found {
                if let Some(error) = error.await {
                    return Err(GpuError::TooMuch { quality: quality.name(), reason: plain(&error) });
                }
            }
            Ok(())
        };
        (renderer, verdict)
    }
}

/// An error with what caused it, in one line.
fn plain(error: &wgpu::Error) -> String {
    let mut source: &dyn std::error::Error = error;
    while let Some(cause) = source.source() {
        source = cause;
    }
    source.to_string().split_whitespace().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_webgpu_guarantees_is_enough_and_each_shortage_is_named() {
        assert_eq!(lacking(&wgpu::Limits::default()), None);
        let few = wgpu::Limits { max_storage_buffers_per_shader_stage: 4, ..wgpu::Limits::default() };
        let error = lacking(&few).expect("too few");
        assert_eq!(error, GpuError::Limit { name: "max_storage_buffers_per_shader_stage", found: 4, needed: 8 });
        assert_eq!(error.to_string(), "the graphics adapter allows max_storage_buffers_per_shader_stage up to 4; the prairie needs 8");
        let small = wgpu::Limits { max_texture_dimension_2d: 1024, ..wgpu::Limits::default() };
        assert!(matches!(lacking(&small), Some(GpuError::Limit { name: "max_texture_dimension_2d", found: 1024, needed: 2048 })));
    }

    #[test]
    fn a_picture_is_scaled_down_to_what_a_texture_holds() {
        assert_eq!(fitting_px([3840, 2160], 8192), [3840, 2160]);
        assert_eq!(fitting_px([3840, 2160], 2048), [2048, 1152]);
        assert_eq!(fitting_px([10, 9000], 2048), [2, 2048]);
        assert_eq!(fitting_px([1, 90_000], 2048), [1, 2048]);
        assert_eq!(fitting_px([0, 7], 2048), [1, 7]);
    }
}
