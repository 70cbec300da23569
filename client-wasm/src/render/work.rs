//! What the device works through in the passes of a frame, by its own counters.

use super::gpu::Gpu;
use super::timing::Pass;
use std::ops::{AddAssign, Deref, DerefMut};
use wgpu::{BufferUsages, PipelineStatisticsTypes, QuerySet};

/// What is counted, in the order in which a device writes it.
const COUNTED: PipelineStatisticsTypes = PipelineStatisticsTypes::VERTEX_SHADER_INVOCATIONS
    .union(PipelineStatisticsTypes::CLIPPER_PRIMITIVES_OUT)
    .union(PipelineStatisticsTypes::FRAGMENT_SHADER_INVOCATIONS)
    .union(PipelineStatisticsTypes::COMPUTE_SHADER_INVOCATIONS);
/// Numbers that it is.
const NUMBERS: usize = 4;
/// Passes that one command encoder may count. With the bytes of each, a multiple of what WebGPU aligns resolved queries to.
const SLOTS: usize = 16;
const SLOTS_BYTES: u64 = (SLOTS * NUMBERS * 8) as u64;
const _: () = assert!(SLOTS_BYTES.is_multiple_of(wgpu::QUERY_RESOLVE_BUFFER_ALIGNMENT));

/// What the device worked through. How a driver counts is its own: a fragment shader that runs on blocks of pixels may count all of a block.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Runs of vertex shaders. A vertex that an index buffer names twice may run once.
    pub vertices: u64,
    /// Triangles that the clipper let through, those that face away among them.
    pub triangles: u64,
    /// Runs of fragment shaders.
    pub fragments: u64,
    /// Runs of compute shaders.
    pub compute_invocations: u64,
}

impl AddAssign for Work {
    fn add_assign(&mut self, other: Self) {
        self.vertices += other.vertices;
        self.triangles += other.triangles;
        self.fragments += other.fragments;
        self.compute_invocations += other.compute_invocations;
    }
}

/// What the device worked through in each of a frame's passes, which are those of [`PassSecs`](super::PassSecs).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PassWork {
    /// What throws shadows, as the sun sees it, in the layers that are drawn anew; without how trees sway.
    pub shadows: Work,
    /// Culling, bending and sorting of all that grows, and dust.
    pub bend: Work,
    /// Everything drawn.
    pub picture: Work,
    /// From light to colours.
    pub tone: Work,
}

impl PassWork {
    fn of(&mut self, pass: Pass) -> &mut Work {
        match pass {
            Pass::Shadows => &mut self.shadows,
            Pass::Bend => &mut self.bend,
            Pass::Picture => &mut self.picture,
            Pass::Tone => &mut self.tone,
        }
    }
}

/// Counts what the passes of a frame work through. Passes of a kind are summed up.
pub(super) struct Counter {
    queries: QuerySet,
    /// Numbers of each slot, for one command encoder after the other.
    resolved: wgpu::Buffer,
    /// The passes that took the slots of each command encoder.
    passes: Vec<Vec<Pass>>,
}

impl Counter {
    /// None where the device does not count.
    pub(super) fn new(gpu: &Gpu) -> Option<Self> {
        gpu.device.features().contains(wgpu::Features::PIPELINE_STATISTICS_QUERY).then(|| Self {
            queries: gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("work"),
                ty: wgpu::QueryType::PipelineStatistics(COUNTED),
                count: SLOTS as u32,
            }),
            resolved: resolved(gpu, 1),
            passes: Vec::new(),
        })
    }

    /// Begins a frame of so many command encoders.
    pub(super) fn begin_frame(&mut self, gpu: &Gpu, encoders: u32) {
        self.passes.clear();
        if self.resolved.size() < u64::from(encoders) * SLOTS_BYTES {
            self.resolved = resolved(gpu, encoders);
        }
    }

    /// Begins the next command encoder of a frame.
    pub(super) fn begin_encoder(&mut self) {
        self.passes.push(Vec::new());
    }

    /// The slot of a pass that begins; none before the first frame.
    fn slot(&mut self, pass: Pass) -> Option<u32> {
        let passes = self.passes.last_mut()?;
        passes.push(pass);
        Some(passes.len() as u32 - 1)
    }

    /// Has the numbers of a command encoder, whose passes are encoded, brought to where they can be read.
    pub(super) fn resolve(&self, encoder: &mut wgpu::CommandEncoder) {
        if let Some((at, passes)) = (0..).zip(&self.passes).last() {
            encoder.resolve_query_set(&self.queries, 0..passes.len() as u32, &self.resolved, at * SLOTS_BYTES);
        }
    }

    /// Where the newest frame's numbers are.
    pub(super) fn resolved(&self) -> &wgpu::Buffer {
        &self.resolved
    }

    /// Work of the newest frame, of what was read from there.
    pub(super) fn work(&self, resolved: &[u8]) -> PassWork {
        summed(&self.passes, &bytemuck::pod_collect_to_vec(resolved))
    }
}

/// Numbers of slots, summed up by the passes that took them.
fn summed(passes: &[Vec<Pass>], numbers: &[u64]) -> PassWork {
    let mut work = PassWork::default();
    for (passes, numbers) in passes.iter().zip(numbers.chunks(SLOTS * NUMBERS)) {
        for (pass, numbers) in passes.iter().zip(numbers.chunks_exact(NUMBERS)) {
            let &[vertices, triangles, fragments, compute_invocations] = numbers else { continue };
            *work.of(*pass) += Work { vertices, triangles, fragments, compute_invocations };
        }
    }
    work
}

fn resolved(gpu: &Gpu, encoders: u32) -> wgpu::Buffer {
    gpu.empty_buffer("work", u64::from(encoders) * SLOTS_BYTES, BufferUsages::QUERY_RESOLVE | BufferUsages::COPY_SRC)
}

/// A pass that can be counted.
pub(super) trait Countable {
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

/// A pass that is counted, where a counter is, until it is dropped.
pub(super) struct Counted<P: Countable> {
    pass: P,
    is_counted: bool,
}

/// Counts a pass from here on.
pub(super) fn counted<P: Countable>(counter: &mut Option<Counter>, of: Pass, mut pass: P) -> Counted<P> {
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
    fn passes_of_a_kind_are_summed_up() {
        let passes = [vec![Pass::Shadows, Pass::Shadows, Pass::Picture], vec![Pass::Bend, Pass::Picture, Pass::Tone]];
        let numbers: Vec<u64> = (0..2 * (SLOTS * NUMBERS) as u64).collect();
        let of =
            |[vertices, triangles, fragments, compute_invocations]: [u64; 4]| Work { vertices, triangles, fragments, compute_invocations };
        let second = (SLOTS * NUMBERS) as u64;
        let expected = PassWork {
            shadows: of([4, 6, 8, 10]),
            bend: of([0, 1, 2, 3].map(|n| second + n)),
            picture: of([12, 14, 16, 18].map(|n| second + n)),
            tone: of([8, 9, 10, 11].map(|n| second + n)),
        };
        assert_eq!(summed(&passes, &numbers), expected);
        assert_eq!(summed(&passes, &[]), PassWork::default(), "a lost device has no numbers");
    }
}
