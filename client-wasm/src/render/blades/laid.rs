//! How the strips of blades are laid over the picture: what one order needs.

use super::order::{Keys, Ordered};
use super::strips::strip_indices;
use crate::render::gpu::Gpu;
use crate::render::look::Order;
use crate::render::pipeline::{ByLamps, Draw, Maker, bind, storage, texture, uniform};
use crate::render::shaders;
use crate::render::uniforms::StripList;
use wgpu::BufferUsages;

/// Spans in order: of all but the fine blades, and of those; the word where each begins in `Spans` of `order.wgsl`.
const SPAN_WORDS: [u32; 2] = [1, 3];

/// What there is to lay: lists of fine blades and of all others, and the texture of their shapes.
pub(in crate::render) struct Listed {
    pub(in crate::render) blades: wgpu::Buffer,
    pub(in crate::render) counters: wgpu::Buffer,
    pub(super) shapes: wgpu::TextureView,
    /// Whether blades have them; else they taper.
    pub(super) are_textured: bool,
    pub(in crate::render) capacities: [u32; 2],
    /// Segments of fine blades, and of others.
    pub(super) segments: [u32; 2],
    pub(super) grid_m: f32,
}

impl Listed {
    /// Whether an order draws blades whose tips are points: those that taper, and have no soft borders.
    pub(super) fn are_pointed(&self, order: Order) -> bool {
        order == Order::Cut && !self.are_textured
    }
}

pub(in crate::render) struct Laid {
    /// While blades shrink away where the last ones end, and while they fade into what stands for far plants.
    strips: [ByLamps<wgpu::RenderPipeline>; 2],
    in_order: Option<InOrder>,
}

struct InOrder {
    ordered: Ordered,
    groups: [wgpu::BindGroup; 2],
    indices: [wgpu::Buffer; 2],
}

impl Laid {
    pub(super) fn new(maker: &Maker<'_>, order: Order, listed: &Listed) -> Self {
        let list_layout = super::list_layout(maker);
        let in_order_layout = maker.layout("blades in order", &[storage(0), storage(1), uniform(2), texture(3), storage(4)]);
        let (layout, vertex) = match order {
            Order::Cut => (&list_layout, "vs"),
            Order::Coverage | Order::Weighted => (&list_layout, "vs_soft"),
            Order::Sorted | Order::Precomputed => (&in_order_layout, "vs_in_order"),
        };
        let fragment = match order {
            Order::Cut => "fs",
            Order::Weighted => "fs_weighted",
            Order::Coverage | Order::Sorted | Order::Precomputed => "fs_soft",
        };
        let shape = [("is_textured", listed.are_textured), ("are_pointed", listed.are_pointed(order))];
        let strips = [false, true].map(|fades| {
            ByLamps::new(|lamps| {
                let module = maker.shader("blades", shaders::BLADES, &[shape[0], shape[1], ("fades", fades), lamps]);
                let draw = Draw { label: "blades", vertex, fragment: Some(fragment), ..Draw::default() };
                maker.draw_in_order(&module, Some(layout), &draw, order)
            })
        });
        let keys = match order {
            Order::Sorted => Some(Keys::Distance),
            Order::Precomputed => Some(Keys::MadeBeforehand),
            Order::Cut | Order::Coverage | Order::Weighted => None,
        };
        Self { strips, in_order: keys.map(|keys| InOrder::new(maker, keys, &in_order_layout, listed)) }
    }

    /// What orders the blades, if they are drawn far to near.
    pub(in crate::render) fn ordered(&self) -> Option<&Ordered> {
        self.in_order.as_ref().map(|in_order| &in_order.ordered)
    }

    /// Draws all strips: in order, or else list by list as `lists` has them.
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
    fn new(maker: &Maker<'_>, keys: Keys, layout: &wgpu::BindGroupLayout, listed: &Listed) -> Self {
        let gpu: &Gpu = maker.gpu;
        let [fine, others] = listed.segments;
        let segments = [others, fine];
        let indices = segments.map(|segments| strip_indices(segments, false));
        let counts = [0, 1].map(|span| indices[span].len() as u32);
        let ordered = Ordered::new(maker, keys, [&listed.blades, &listed.counters], listed.capacities, counts, listed.grid_m);
        let groups = [0, 1].map(|span| {
            let list = StripList { range: [0, 0, segments[span], SPAN_WORDS[span]], order: [0; 4] };
            let list = gpu.buffer("span", bytemuck::bytes_of(&list), BufferUsages::UNIFORM);
            let [blades, spans, list, pairs] =
                [&listed.blades, ordered.spans(), &list, ordered.pairs()].map(|buffer| buffer.as_entire_binding());
            bind(gpu, "blades in order", layout, &[blades, spans, list, wgpu::BindingResource::TextureView(&listed.shapes), pairs])
        });
        let indices = indices.map(|list| gpu.buffer("blades in order", bytemuck::cast_slice(&list), BufferUsages::INDEX));
        Self { ordered, groups, indices }
    }
}
