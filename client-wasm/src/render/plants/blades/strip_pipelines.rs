//! Pipelines that draw the strips of blades in a blend order.

use super::layout::list_layout;
use super::sort::{BladeSort, SortKeys};
use super::strips::strip_indices;
use crate::render::gpu::pipeline::{DrawDescriptor, PassFactory, bind, storage, texture, uniform};
use crate::render::gpu::shaders;
use crate::render::gpu::uniforms::StripList;
use crate::render::gpu::variants::LampVariants;
use crate::render::options::render_options::BlendOrder;
use crate::render::plants::blending::blend_pipeline;
use bytemuck::Zeroable;
use wgpu::BufferUsages;

/// Listed blades, fine ones and others, and the texture of their shapes.
pub(crate) struct BladeDrawList {
    pub(crate) blades: wgpu::Buffer,
    pub(crate) counters: wgpu::Buffer,
    pub(super) shapes: wgpu::TextureView,
    /// Whether blades use the texture; otherwise they taper.
    pub(super) are_textured: bool,
    pub(crate) capacities: [u32; 2],
    /// Segments of fine blades, and of others.
    pub(crate) segments: [u32; 2],
    pub(super) grid_m: f32,
}

impl BladeDrawList {
    /// Whether an order draws blades with pointed tips: those that taper and have no soft borders.
    pub(super) fn are_pointed(&self, order: BlendOrder) -> bool {
        order == BlendOrder::Cut && !self.are_textured
    }
}

pub(crate) struct StripPipelines {
    /// Pipelines for blades that shrink with distance, and for those that fade into clumps or shells.
    strips: [LampVariants<wgpu::RenderPipeline>; 2],
    in_order: Option<InOrder>,
}

struct InOrder {
    ordered: BladeSort,
    groups: [wgpu::BindGroup; 2],
    indices: [wgpu::Buffer; 2],
}

impl StripPipelines {
    pub(super) fn new(factory: &PassFactory, order: BlendOrder, listed: &BladeDrawList) -> Self {
        let list_layout = list_layout(factory);
        let in_order_layout = factory.layout("blades in order", &[storage(0), storage(1), uniform(2), texture(3), storage(4)]);
        let (layout, vertex) = match order {
            BlendOrder::Cut => (&list_layout, "vs"),
            BlendOrder::Coverage | BlendOrder::Weighted => (&list_layout, "vs_soft"),
            BlendOrder::Sorted | BlendOrder::Precomputed => (&in_order_layout, "vs_in_order"),
        };
        let fragment = match order {
            BlendOrder::Cut => "fs",
            BlendOrder::Weighted => "fs_weighted",
            BlendOrder::Coverage | BlendOrder::Sorted | BlendOrder::Precomputed => "fs_soft",
        };
        let shape = [("is_textured", listed.are_textured), ("are_pointed", listed.are_pointed(order))];
        let strips = [false, true].map(|fades| {
            let (factory, layout) = (factory.clone(), layout.clone());
            LampVariants::new(move |[lamps]| {
                let module = factory.shader("blades", shaders::BLADES, &[shape[0], shape[1], ("fades", fades), lamps]);
                let draw = DrawDescriptor { label: "blades", vertex, fragment: Some(fragment), ..DrawDescriptor::default() };
                blend_pipeline(&factory, &module, Some(&layout), &draw, order)
            })
        });
        let keys = match order {
            BlendOrder::Sorted => Some(SortKeys::Distance),
            BlendOrder::Precomputed => Some(SortKeys::Precomputed),
            BlendOrder::Cut | BlendOrder::Coverage | BlendOrder::Weighted => None,
        };
        Self { strips, in_order: keys.map(|keys| InOrder::new(factory, keys, &in_order_layout, listed)) }
    }

    /// The sort of the blades, if they are drawn far to near.
    pub(crate) fn ordered(&self) -> Option<&BladeSort> {
        self.in_order.as_ref().map(|in_order| &in_order.ordered)
    }

    /// Creates a variant of a pipeline for blades that fade or not, which no frame has needed yet. Returns false if there is none.
    pub(super) fn create_next(&self, fades: bool) -> bool {
        self.strips[usize::from(fades)].create_next()
    }

    /// Draws all strips: sorted, or list by list through `lists`.
    pub(super) fn draw(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        fades: bool,
        has_lamps: bool,
        lists: impl FnOnce(&mut wgpu::RenderPass<'_>),
    ) {
        pass.set_pipeline(self.strips[usize::from(fades)].of(has_lamps));
        let Some(InOrder { ordered, groups, indices }) = &self.in_order else { return lists(pass) };
        for (span, group) in groups.iter().enumerate() {
            pass.set_bind_group(1, group, &[]);
            pass.set_index_buffer(indices[span].slice(..), wgpu::IndexFormat::Uint16);
            ordered.draw(pass, span);
        }
    }
}

impl InOrder {
    fn new(factory: &PassFactory, keys: SortKeys, layout: &wgpu::BindGroupLayout, listed: &BladeDrawList) -> Self {
        let gpu = &factory.gpu;
        let [fine, others] = listed.segments;
        let segments = [others, fine];
        let indices = segments.map(|segments| strip_indices(segments, false));
        let counts = [0, 1].map(|span| indices[span].len() as u32);
        let ordered = BladeSort::new(factory, keys, [&listed.blades, &listed.counters], listed.capacities, counts, listed.grid_m);
        let groups = [0, 1].map(|span| {
            let list = StripList { segments: segments[span], number: span as u32, ..StripList::zeroed() };
            let list = gpu.buffer("span", bytemuck::bytes_of(&list), BufferUsages::UNIFORM);
            let [blades, spans, list, pairs] =
                [&listed.blades, ordered.spans(), &list, ordered.pairs()].map(|buffer| buffer.as_entire_binding());
            bind(gpu, "blades in order", layout, &[blades, spans, list, wgpu::BindingResource::TextureView(&listed.shapes), pairs])
        });
        let indices = indices.map(|list| gpu.buffer("blades in order", bytemuck::cast_slice(&list), BufferUsages::INDEX));
        Self { ordered, groups, indices }
    }
}
