//! How the passes make their bind groups and pipelines.

use super::gpu::Gpu;
use super::look::Order;
use super::shaders::Constant;

/// Format of the picture before tone mapping.
pub(super) const COLOR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
/// Formats of what is blended without order: the weighted sum, and the share of a pixel that is left.
pub(super) const SUM: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
pub(super) const COVERED: wgpu::TextureFormat = wgpu::TextureFormat::R16Float;
/// Format of depth, reversed: 0 is infinitely far.
pub(super) const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// Adds a factor of the source to a factor of what is there.
const fn blended(src_factor: wgpu::BlendFactor, dst_factor: wgpu::BlendFactor) -> wgpu::BlendState {
    let component = wgpu::BlendComponent { src_factor, dst_factor, operation: wgpu::BlendOperation::Add };
    wgpu::BlendState { color: component, alpha: component }
}

/// 000 Eq. (10), in all four channels: S·Sₐ + D·(1 − Sₐ). So the alpha that is left is Sₐ² + Dₐ·(1 − Sₐ), which is not the share of a pixel that is
/// covered; nothing reads it. Light is not held to 0..1 before tone mapping.
const OVER: wgpu::BlendState = blended(wgpu::BlendFactor::SrcAlpha, wgpu::BlendFactor::OneMinusSrcAlpha);

/// What all passes are made with.
pub(super) struct Maker<'a> {
    pub(super) gpu: &'a Gpu,
    pub(super) frame_layout: &'a wgpu::BindGroupLayout,
    pub(super) samples: u32,
    /// Whether more than one kind of grass grows; `has_kinds` of `common.wgsl`.
    pub(super) has_kinds: bool,
}

/// How a pass of triangles differs from the others.
pub(super) struct Draw<'a> {
    pub(super) label: &'a str,
    pub(super) vertex: &'a str,
    /// None draws depth alone, for the shadow map.
    pub(super) fragment: Option<&'a str>,
    pub(super) buffers: &'a [Option<wgpu::VertexBufferLayout<'a>>],
    pub(super) depth_write: bool,
    pub(super) cull: Option<wgpu::Face>,
    /// How it is laid over what is there; none replaces that.
    pub(super) blend: Option<wgpu::BlendState>,
    /// Module of the fragments, where it is another one.
    pub(super) fragment_module: Option<&'a wgpu::ShaderModule>,
}

impl Default for Draw<'_> {
    /// Opaque triangles of both faces, without vertex buffers.
    fn default() -> Self {
        Self {
            label: "",
            vertex: "vs",
            fragment: Some("fs"),
            buffers: &[],
            depth_write: true,
            cull: None,
            blend: None,
            fragment_module: None,
        }
    }
}

/// A pass of which lamps light what it shows: without any lit, and with. The constant is `has_lamps` of `light.wgsl`.
pub(super) struct ByLamps<P>([P; 2]);

impl<P> ByLamps<P> {
    pub(super) fn new(make: impl Fn(Constant) -> P) -> Self {
        Self([false, true].map(|has_lamps| make(("has_lamps", has_lamps))))
    }

    /// For a frame in which there are lamps, or none.
    pub(super) fn of(&self, has_lamps: bool) -> &P {
        &self.0[usize::from(has_lamps)]
    }
}

/// A pass of what spheres of objects push aside, too: the constants are those of [`ByLamps`] and `meets_spheres` of `blade.wgsl`.
pub(super) struct BySpheres<P>([ByLamps<P>; 2]);

impl<P> BySpheres<P> {
    pub(super) fn new(make: impl Fn([Constant; 2]) -> P) -> Self {
        Self([false, true].map(|spheres| ByLamps::new(|lamps| make([lamps, ("meets_spheres", spheres)]))))
    }

    /// For a frame in which there are spheres and lamps, or none.
    pub(super) fn of(&self, has_spheres: bool, has_lamps: bool) -> &P {
        self.0[usize::from(has_spheres)].of(has_lamps)
    }
}

pub(super) const ALL_STAGES: wgpu::ShaderStages = wgpu::ShaderStages::VERTEX_FRAGMENT.union(wgpu::ShaderStages::COMPUTE);

impl Maker<'_> {
    pub(super) fn layout(&self, label: &str, entries: &[wgpu::BindGroupLayoutEntry]) -> wgpu::BindGroupLayout {
        self.gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries })
    }

    /// A pass's module with values of its overrides.
    pub(super) fn shader(&self, label: &str, source: &str, constants: &[Constant]) -> wgpu::ShaderModule {
        self.gpu.shader(label, source, &[constants, &[("has_kinds", self.has_kinds)]].concat())
    }

    fn pipeline_layout(&self, label: &str, own: Option<&wgpu::BindGroupLayout>) -> wgpu::PipelineLayout {
        self.gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(label),
            bind_group_layouts: &[Some(self.frame_layout), own],
            immediate_size: 0,
        })
    }

    pub(super) fn compute(
        &self,
        label: &str,
        module: &wgpu::ShaderModule,
        entry: &str,
        own: &wgpu::BindGroupLayout,
    ) -> wgpu::ComputePipeline {
        self.gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(label),
            layout: Some(&self.pipeline_layout(label, Some(own))),
            module,
            entry_point: Some(entry),
            compilation_options: Default::default(),
            cache: None,
        })
    }

    pub(super) fn draw(&self, module: &wgpu::ShaderModule, own: Option<&wgpu::BindGroupLayout>, draw: &Draw<'_>) -> wgpu::RenderPipeline {
        let targets: &[_] = if draw.vertex.starts_with("vs_shadow") { &[] } else { &[target(COLOR, draw.blend)] };
        self.render(module, own, draw, targets, false)
    }

    /// A pass of plants that are laid over each other in an order.
    pub(super) fn draw_in_order(
        &self,
        module: &wgpu::ShaderModule,
        own: Option<&wgpu::BindGroupLayout>,
        draw: &Draw<'_>,
        order: Order,
    ) -> wgpu::RenderPipeline {
        use wgpu::BlendFactor::{One, OneMinusSrc, Zero};
        match order {
            Order::Cut => self.draw(module, own, draw),
            Order::Coverage => self.render(module, own, draw, &[target(COLOR, None)], true),
            // What comes later is nearer. Where it is not, as plants that lean cross, depth keeps the nearer one.
            Order::Sorted | Order::Precomputed => self.render(module, own, draw, &[target(COLOR, Some(OVER))], false),
            Order::Weighted => {
                let targets = [target(SUM, Some(blended(One, One))), target(COVERED, Some(blended(Zero, OneMinusSrc)))];
                self.render(module, own, &Draw { depth_write: false, ..*draw }, &targets, false)
            }
        }
    }

    fn render(
        &self,
        module: &wgpu::ShaderModule,
        own: Option<&wgpu::BindGroupLayout>,
        draw: &Draw<'_>,
        targets: &[Option<wgpu::ColorTargetState>],
        alpha_to_coverage_enabled: bool,
    ) -> wgpu::RenderPipeline {
        let to_shadow = draw.vertex.starts_with("vs_shadow");
        let compare = if to_shadow { wgpu::CompareFunction::Less } else { wgpu::CompareFunction::GreaterEqual };
        self.gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(draw.label),
            layout: Some(&self.pipeline_layout(draw.label, own)),
            vertex: wgpu::VertexState {
                module,
                entry_point: Some(draw.vertex),
                compilation_options: Default::default(),
                buffers: draw.buffers,
            },
            primitive: wgpu::PrimitiveState { cull_mode: draw.cull, ..Default::default() },
            depth_stencil: Some(wgpu::DepthStencilState {
                format: DEPTH,
                depth_write_enabled: Some(draw.depth_write),
                depth_compare: Some(compare),
                stencil: Default::default(),
                bias: Default::default(),
            }),
            multisample: wgpu::MultisampleState {
                count: if to_shadow { 1 } else { self.samples },
                alpha_to_coverage_enabled,
                ..Default::default()
            },
            fragment: draw.fragment.map(|entry| wgpu::FragmentState {
                module: draw.fragment_module.unwrap_or(module),
                entry_point: Some(entry),
                compilation_options: Default::default(),
                targets,
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}

fn target(format: wgpu::TextureFormat, blend: Option<wgpu::BlendState>) -> Option<wgpu::ColorTargetState> {
    Some(wgpu::ColorTargetState { format, blend, write_mask: wgpu::ColorWrites::ALL })
}

pub(super) fn uniform(binding: u32) -> wgpu::BindGroupLayoutEntry {
    buffer(binding, ALL_STAGES, wgpu::BufferBindingType::Uniform)
}

pub(super) fn storage(binding: u32) -> wgpu::BindGroupLayoutEntry {
    buffer(binding, ALL_STAGES, wgpu::BufferBindingType::Storage { read_only: true })
}

pub(super) fn storage_rw(binding: u32) -> wgpu::BindGroupLayoutEntry {
    buffer(binding, wgpu::ShaderStages::COMPUTE, wgpu::BufferBindingType::Storage { read_only: false })
}

pub(super) fn texture(binding: u32) -> wgpu::BindGroupLayoutEntry {
    sampled(binding, wgpu::TextureSampleType::Float { filterable: true }, wgpu::TextureViewDimension::D2)
}

pub(super) fn sampled(
    binding: u32,
    sample_type: wgpu::TextureSampleType,
    view_dimension: wgpu::TextureViewDimension,
) -> wgpu::BindGroupLayoutEntry {
    let ty = wgpu::BindingType::Texture { sample_type, view_dimension, multisampled: false };
    wgpu::BindGroupLayoutEntry { binding, visibility: ALL_STAGES, ty, count: None }
}

pub(super) fn sampler(binding: u32, kind: wgpu::SamplerBindingType) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry { binding, visibility: ALL_STAGES, ty: wgpu::BindingType::Sampler(kind), count: None }
}

fn buffer(binding: u32, visibility: wgpu::ShaderStages, ty: wgpu::BufferBindingType) -> wgpu::BindGroupLayoutEntry {
    let ty = wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None };
    wgpu::BindGroupLayoutEntry { binding, visibility, ty, count: None }
}

/// A bind group of `resources`, numbered from 0.
pub(super) fn bind(gpu: &Gpu, label: &str, layout: &wgpu::BindGroupLayout, resources: &[wgpu::BindingResource<'_>]) -> wgpu::BindGroup {
    let entries: Vec<_> = resources
        .iter()
        .enumerate()
        .map(|(binding, resource)| wgpu::BindGroupEntry { binding: binding as u32, resource: resource.clone() })
        .collect();
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some(label), layout, entries: &entries })
}

/// A bind group of buffers by their binding.
pub(super) fn bind_as(gpu: &Gpu, label: &str, layout: &wgpu::BindGroupLayout, buffers: &[(u32, &wgpu::Buffer)]) -> wgpu::BindGroup {
    let entries: Vec<_> =
        buffers.iter().map(|&(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() }).collect();
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some(label), layout, entries: &entries })
}
