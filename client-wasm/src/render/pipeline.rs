//! How the passes make their bind groups and pipelines.

use super::gpu::Gpu;

/// Format of the picture before tone mapping.
pub(super) const COLOR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
/// Format of depth, reversed: 0 is infinitely far.
pub(super) const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// What all passes are made with.
pub(super) struct Maker<'a> {
    pub(super) gpu: &'a Gpu,
    pub(super) frame_layout: &'a wgpu::BindGroupLayout,
    pub(super) samples: u32,
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
}

pub(super) const ALL_STAGES: wgpu::ShaderStages = wgpu::ShaderStages::VERTEX_FRAGMENT.union(wgpu::ShaderStages::COMPUTE);

impl Maker<'_> {
    pub(super) fn layout(&self, label: &str, entries: &[wgpu::BindGroupLayoutEntry]) -> wgpu::BindGroupLayout {
        self.gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries })
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
        let to_shadow = draw.vertex.starts_with("vs_shadow");
        let compare = if to_shadow { wgpu::CompareFunction::Less } else { wgpu::CompareFunction::GreaterEqual };
        let targets = [Some(wgpu::ColorTargetState { format: COLOR, blend: draw.blend, write_mask: wgpu::ColorWrites::ALL })];
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
            multisample: wgpu::MultisampleState { count: if to_shadow { 1 } else { self.samples }, ..Default::default() },
            fragment: draw.fragment.map(|entry| wgpu::FragmentState {
                module,
                entry_point: Some(entry),
                compilation_options: Default::default(),
                targets: if to_shadow { &[] } else { &targets },
            }),
            multiview_mask: None,
            cache: None,
        })
    }
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
