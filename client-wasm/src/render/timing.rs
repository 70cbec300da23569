//! How long the passes of a frame keep the device, by its own clock.

use super::gpu::Gpu;
use wgpu::{BufferUsages, ComputePassTimestampWrites, QuerySet, RenderPassTimestampWrites};

/// A pass of a frame, or several of a kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pass {
    Shadows,
    Bend,
    Picture,
    Tone,
}

/// How many there are.
const PASSES: u32 = 4;

/// Time (s) for which each of a frame's passes kept the device. On one that draws by itself, passes may overlap.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PassSecs {
    /// How trees sway, and what throws shadows, as the sun sees it.
    pub shadows: f64,
    /// Culling, bending and sorting of all that grows, and dust.
    pub bend: f64,
    /// Everything drawn.
    pub picture: f64,
    /// From light to colours.
    pub tone: f64,
}

/// Clocks the passes of a frame.
pub(super) struct Timer {
    queries: QuerySet,
    resolved: wgpu::Buffer,
}

impl Timer {
    /// None where the device has no clock.
    pub(super) fn new(gpu: &Gpu) -> Option<Self> {
        gpu.device.features().contains(wgpu::Features::TIMESTAMP_QUERY).then(|| Self {
            queries: gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("passes"),
                ty: wgpu::QueryType::Timestamp,
                count: 2 * PASSES,
            }),
            resolved: gpu.empty_buffer("pass times", u64::from(2 * PASSES) * 8, BufferUsages::QUERY_RESOLVE | BufferUsages::COPY_SRC),
        })
    }

    /// Of a compute pass that is the first of its kind, and perhaps the last.
    pub(super) fn of_compute(&self, pass: Pass, is_last: bool) -> ComputePassTimestampWrites<'_> {
        let [begin, end] = places(pass);
        ComputePassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: Some(begin),
            end_of_pass_write_index: is_last.then_some(end),
        }
    }

    /// Of a render pass that is the first, or the last, of its kind.
    pub(super) fn of_render(&self, pass: Pass, is_first: bool, is_last: bool) -> Option<RenderPassTimestampWrites<'_>> {
        let [begin, end] = places(pass);
        (is_first || is_last).then(|| RenderPassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: is_first.then_some(begin),
            end_of_pass_write_index: is_last.then_some(end),
        })
    }

    /// Has the times of a frame whose passes are encoded brought to where they can be read.
    pub(super) fn resolve(&self, encoder: &mut wgpu::CommandEncoder) {
        encoder.resolve_query_set(&self.queries, 0..2 * PASSES, &self.resolved, 0);
    }

    /// Where the newest frame's times are: two ticks a pass.
    pub(super) fn resolved(&self) -> &wgpu::Buffer {
        &self.resolved
    }

    /// Times of a frame, of what was read from there.
    pub(super) fn secs(gpu: &Gpu, resolved: &[u8]) -> PassSecs {
        let ticks: Vec<u64> = bytemuck::pod_collect_to_vec(resolved);
        let tick_secs = f64::from(gpu.queue.get_timestamp_period()) * 1e-9;
        let secs = |pass: Pass| match (ticks.get(places(pass)[0] as usize), ticks.get(places(pass)[1] as usize)) {
            (Some(begin), Some(end)) => end.saturating_sub(*begin) as f64 * tick_secs,
            _ => 0.0,
        };
        PassSecs { shadows: secs(Pass::Shadows), bend: secs(Pass::Bend), picture: secs(Pass::Picture), tone: secs(Pass::Tone) }
    }
}

/// Where a pass's begin and end are noted.
fn places(pass: Pass) -> [u32; 2] {
    [2 * pass as u32, 2 * pass as u32 + 1]
}
