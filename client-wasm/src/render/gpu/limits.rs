//! Minimum limits of the device.

use crate::render::gpu::error::GpuError;

/// Minimum limits, for the coarsest quality. WebGPU guarantees more of each, but native adapters may have less.
pub(crate) fn needed() -> wgpu::Limits {
    wgpu::Limits {
        // For the bend atlas and the shadow map.
        max_texture_dimension_2d: 2048,
        // For the cells of the wind along an axis.
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

/// The first needed limit that `allowed` does not reach.
pub(crate) fn lacking(allowed: &wgpu::Limits) -> Option<GpuError> {
    let mut lacking = None;
    needed().check_limits_with_fail_fn(allowed, true, |name, needed, found| lacking = Some(GpuError::Limit { name, found, needed }));
    lacking
}

/// The size scaled down, if necessary, so that neither side exceeds `limit_px`; at least 1 × 1.
pub fn fit_within_px(size_px: [u32; 2], limit_px: u32) -> [u32; 2] {
    let longest_px = size_px[0].max(size_px[1]);
    let scaled = |side_px: u32| (u64::from(side_px) * u64::from(limit_px) / u64::from(longest_px)) as u32;
    if longest_px > limit_px { size_px.map(|side_px| scaled(side_px).max(1)) } else { size_px.map(|side_px| side_px.max(1)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn default_limits_suffice_and_each_shortage_is_named() {
        assert_eq!(lacking(&wgpu::Limits::default()), None);
        let few = wgpu::Limits { max_storage_buffers_per_shader_stage: 4, ..wgpu::Limits::default() };
        let error = lacking(&few).expect("too few");
        assert_eq!(error, GpuError::Limit { name: "max_storage_buffers_per_shader_stage", found: 4, needed: 8 });
        assert_eq!(error.to_string(), "the graphics adapter allows max_storage_buffers_per_shader_stage up to 4; Prairie needs 8");
        let small = wgpu::Limits { max_texture_dimension_2d: 1024, ..wgpu::Limits::default() };
        assert!(matches!(lacking(&small), Some(GpuError::Limit { name: "max_texture_dimension_2d", found: 1024, needed: 2048 })));
    }

    #[test]
    fn sizes_are_scaled_down_to_the_texture_limit() {
        assert_eq!(fit_within_px([3840, 2160], 8192), [3840, 2160]);
        assert_eq!(fit_within_px([3840, 2160], 2048), [2048, 1152]);
        assert_eq!(fit_within_px([10, 9000], 2048), [2, 2048]);
        assert_eq!(fit_within_px([1, 90_000], 2048), [1, 2048]);
        assert_eq!(fit_within_px([0, 7], 2048), [1, 7]);
    }
}
