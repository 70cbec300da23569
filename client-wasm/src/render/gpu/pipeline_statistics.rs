//! Pipeline statistics of the passes of a frame.

use crate::render::gpu::device::Gpu;
use crate::render::gpu::timestamps::Pass;
use std::ops::{AddAssign, Deref, DerefMut};
use wgpu::{BufferUsages, PipelineStatisticsTypes, QuerySet};

/// Counted quantities, in the order in which the device writes them.
const COUNTED: PipelineStatisticsTypes = PipelineStatisticsTypes::VERTEX_SHADER_INVOCATIONS
    .union(PipelineStatisticsTypes::CLIPPER_PRIMITIVES_OUT)
    .union(PipelineStatisticsTypes::FRAGMENT_SHADER_INVOCATIONS)
    .union(PipelineStatisticsTypes::COMPUTE_SHADER_INVOCATIONS);
/// Number of counted quantities.
const NUMBERS: usize = 4;
/// Maximum number of passes per command encoder. Their bytes are a multiple of the alignment of resolved queries.
const SLOTS: usize = 16;
const SLOTS_BYTES: u64 = (SLOTS * NUMBERS * 8) as u64;
const _: () = assert!(SLOTS_BYTES.is_multiple_of(wgpu::QUERY_RESOLVE_BUFFER_ALIGNMENT));

/// Pipeline statistics. Drivers count differently: one that shades blocks of pixels may count all pixels of a block.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PipelineStatistics {
    /// Vertex shader invocations. An indexed vertex that is used twice may be shaded once.
    pub vertices: u64,
    /// Triangles after clipping, back faces included.
    pub triangles: u64,
    /// Fragment shader invocations.
    pub fragments: u64,
    /// Compute shader invocations.
    pub compute_invocations: u64,
}

impl AddAssign for PipelineStatistics {
    fn add_assign(&mut self, other: Self) {
        self.vertices += other.vertices;
        self.triangles += other.triangles;
        self.fragments += other.fragments;
        self.compute_invocations += other.compute_invocations;
    }
}

/// Pipeline statistics of each kind of pass, as in [`PassSecs`](crate::render::PassSecs).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PassStatistics {
    /// Drawing of the shadow cascades that are due, without the sway of the trees.
    pub shadows: PipelineStatistics,
    /// Culling, bending and sorting of plants; motion of dust.
    pub bend: PipelineStatistics,
    /// Drawing of the picture.
    pub picture: PipelineStatistics,
    /// Tone mapping.
    pub tone: PipelineStatistics,
}

impl PassStatistics {
    fn of(&mut self, pass: Pass) -> &mut PipelineStatistics {
        match pass {
            Pass::Shadows => &mut self.shadows,
            Pass::Bend => &mut self.bend,
            Pass::Picture => &mut self.picture,
            Pass::Tone => &mut self.tone,
        }
    }
}

/// Pipeline statistics queries of a frame. Passes of a kind are summed.
pub(crate) struct StatisticsQueries {
    queries: QuerySet,
    /// Statistics of each slot, one command encoder after the other.
    resolved: wgpu::Buffer,
    /// Kinds of the passes in the slots of each command encoder.
    passes: Vec<Vec<Pass>>,
}

impl StatisticsQueries {
    /// `None` if the device has no pipeline statistics queries.
    pub(crate) fn new(gpu: &Gpu) -> Option<Self> {
        gpu.device.features().contains(wgpu::Features::PIPELINE_STATISTICS_QUERY).then(|| Self {
            queries: gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("pipeline statistics"),
                ty: wgpu::QueryType::PipelineStatistics(COUNTED),
                count: SLOTS as u32,
            }),
            resolved: resolved(gpu, 1),
            passes: Vec::new(),
        })
    }

    /// Begins a frame with `encoders` command encoders.
    pub(crate) fn begin_frame(&mut self, gpu: &Gpu, encoders: u32) {
        self.passes.clear();
        if self.resolved.size() < u64::from(encoders) * SLOTS_BYTES {
            self.resolved = resolved(gpu, encoders);
        }
    }

    /// Begins the next command encoder of a frame.
    pub(crate) fn begin_encoder(&mut self) {
        self.passes.push(Vec::new());
    }

    /// Takes a slot for a pass; `None` before the first frame.
    fn slot(&mut self, pass: Pass) -> Option<u32> {
        let passes = self.passes.last_mut()?;
        passes.push(pass);
        Some(passes.len() as u32 - 1)
    }

    /// Copies the statistics of the encoded passes to a buffer.
    pub(crate) fn resolve(&self, encoder: &mut wgpu::CommandEncoder) {
        if let Some((at, passes)) = (0..).zip(&self.passes).last() {
            encoder.resolve_query_set(&self.queries, 0..passes.len() as u32, &self.resolved, at * SLOTS_BYTES);
        }
    }

    /// Buffer of the newest statistics.
    pub(crate) fn resolved(&self) -> &wgpu::Buffer {
        &self.resolved
    }

    /// Statistics of the newest frame, from the contents of that buffer.
    pub(crate) fn statistics(&self, resolved: &[u8]) -> PassStatistics {
        summed(&self.passes, &bytemuck::pod_collect_to_vec(resolved))
    }
}

/// Sums the statistics of the slots by kind of pass.
fn summed(passes: &[Vec<Pass>], numbers: &[u64]) -> PassStatistics {
    let mut work = PassStatistics::default();
    for (passes, numbers) in passes.iter().zip(numbers.chunks(SLOTS * NUMBERS)) {
        for (pass, numbers) in passes.iter().zip(numbers.chunks_exact(NUMBERS)) {
            let &[vertices, triangles, fragments, compute_invocations] = numbers else { continue };
            *work.of(*pass) += PipelineStatistics { vertices, triangles, fragments, compute_invocations };
        }
    }
    work
}

fn resolved(gpu: &Gpu, encoders: u32) -> wgpu::Buffer {
    gpu.empty_buffer("pipeline statistics", u64::from(encoders) * SLOTS_BYTES, BufferUsages::QUERY_RESOLVE | BufferUsages::COPY_SRC)
}

/// A pass that can have a pipeline statistics query.
pub(crate) trait Countable {
    fn begin(&mut self, queries: &QuerySet, slot: u32);
    fn end(&mut self);
}

impl Countable for wgpu::RenderPass<'_> {
    fn begin(&mut self, queries: &QuerySet, slot: u32) {
        self.begin_pipeline_statistics_query(queries, slot);
    }

    fn end(&mut self) {
        self.end_pipeline_statistics_query();
    }
}

impl Countable for wgpu::ComputePass<'_> {
    fn begin(&mut self, queries: &QuerySet, slot: u32) {
        self.begin_pipeline_statistics_query(queries, slot);
    }

    fn end(&mut self) {
        self.end_pipeline_statistics_query();
    }
}

/// A pass whose query, if it has one, ends when it is dropped.
pub(crate) struct Counted<P: Countable> {
    pass: P,
    is_counted: bool,
}

/// Begins the query of a pass, if statistics are collected.
pub(crate) fn counted<P: Countable>(counter: &mut Option<StatisticsQueries>, of: Pass, mut pass: P) -> Counted<P> {
    let begun = counter.as_mut().and_then(|counter| Some((counter.slot(of)?, &counter.queries)));
    if let Some((slot, queries)) = begun {
        pass.begin(queries, slot);
    }
    Counted { pass, is_counted: begun.is_some() }
}

impl<P: Countable> Deref for Counted<P> {
    type Target = P;

    fn deref(&self) -> &P {
        &self.pass
    }
}

impl<P: Countable> DerefMut for Counted<P> {
    fn deref_mut(&mut self) -> &mut P {
        &mut self.pass
    }
}

impl<P: Countable> Drop for Counted<P> {
    fn drop(&mut self) {
        if self.is_counted {
            self.pass.end();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passes_of_a_kind_are_summed() {
        let passes = [vec![Pass::Shadows, Pass::Shadows, Pass::Picture], vec![Pass::Bend, Pass::Picture, Pass::Tone]];
        let numbers: Vec<u64> = (0..2 * (SLOTS * NUMBERS) as u64).collect();
        let of = |[vertices, triangles, fragments, compute_invocations]: [u64; 4]| PipelineStatistics {
            vertices,
            triangles,
            fragments,
            compute_invocations,
        };
        let second = (SLOTS * NUMBERS) as u64;
        let expected = PassStatistics {
            shadows: of([4, 6, 8, 10]),
            bend: of([0, 1, 2, 3].map(|n| second + n)),
            picture: of([12, 14, 16, 18].map(|n| second + n)),
            tone: of([8, 9, 10, 11].map(|n| second + n)),
        };
        assert_eq!(summed(&passes, &numbers), expected);
        assert_eq!(summed(&passes, &[]), PassStatistics::default(), "a lost device has no numbers");
    }
}
