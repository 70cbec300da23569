//! GPU time of the passes of a frame, by timestamp queries.

use crate::render::gpu::device::Gpu;
use wgpu::{BufferUsages, ComputePassTimestampWrites, QuerySet, RenderPassTimestampWrites};

/// A kind of pass; a frame may have several passes of a kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Pass {
    Shadows,
    Bend,
    Picture,
    Tone,
}

/// Number of kinds.
const PASSES: u32 = 4;

/// GPU time of each kind of pass (s). On hardware, passes may overlap.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PassSecs {
    /// Sway of the trees, and drawing of the shadow map.
    pub shadows: f64,
    /// Culling, bending and sorting of plants; motion of dust.
    pub bend: f64,
    /// Drawing of the picture.
    pub picture: f64,
    /// Tone mapping.
    pub tone: f64,
}

/// Timestamps of the passes of a frame.
pub(crate) struct TimestampQueries {
    queries: QuerySet,
    resolved: wgpu::Buffer,
}

impl TimestampQueries {
    /// `None` if the device has no timestamp queries.
    pub(crate) fn new(gpu: &Gpu) -> Option<Self> {
        gpu.device.features().contains(wgpu::Features::TIMESTAMP_QUERY).then(|| Self {
            queries: gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("passes"),
                ty: wgpu::QueryType::Timestamp,
                count: 2 * PASSES,
            }),
            resolved: gpu.empty_buffer("pass times", u64::from(2 * PASSES) * 8, BufferUsages::QUERY_RESOLVE | BufferUsages::COPY_SRC),
        })
    }

    /// Timestamps of a compute pass that is the first of its kind, and the last if `is_last`.
    pub(crate) fn of_compute(&self, pass: Pass, is_last: bool) -> ComputePassTimestampWrites<'_> {
        let [begin, end] = indices(pass);
        ComputePassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: Some(begin),
            end_of_pass_write_index: is_last.then_some(end),
        }
    }

    /// Timestamps of a render pass that is the first or the last of its kind.
    pub(crate) fn of_render(&self, pass: Pass, is_first: bool, is_last: bool) -> Option<RenderPassTimestampWrites<'_>> {
        let [begin, end] = indices(pass);
        (is_first || is_last).then(|| RenderPassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: is_first.then_some(begin),
            end_of_pass_write_index: is_last.then_some(end),
        })
    }

    /// Copies the timestamps of the encoded passes to a buffer.
    pub(crate) fn resolve(&self, encoder: &mut wgpu::CommandEncoder) {
        encoder.resolve_query_set(&self.queries, 0..2 * PASSES, &self.resolved, 0);
    }

    /// Buffer of the newest timestamps: two ticks per kind.
    pub(crate) fn resolved(&self) -> &wgpu::Buffer {
        &self.resolved
    }

    /// Durations from the contents of that buffer.
    pub(crate) fn secs(gpu: &Gpu, resolved: &[u8]) -> PassSecs {
        let ticks: Vec<u64> = bytemuck::pod_collect_to_vec(resolved);
        let tick_secs = f64::from(gpu.queue.get_timestamp_period()) * 1e-9;
        let secs = |pass: Pass| match (ticks.get(indices(pass)[0] as usize), ticks.get(indices(pass)[1] as usize)) {
            (Some(begin), Some(end)) => end.saturating_sub(*begin) as f64 * tick_secs,
            _ => 0.0,
        };
        PassSecs { shadows: secs(Pass::Shadows), bend: secs(Pass::Bend), picture: secs(Pass::Picture), tone: secs(Pass::Tone) }
    }
}

/// Query indices of the beginning and the end of a kind.
fn indices(pass: Pass) -> [u32; 2] {
    [2 * pass as u32, 2 * pass as u32 + 1]
}
