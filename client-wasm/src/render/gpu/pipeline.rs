//! Helpers that create bind groups and pipelines.

use crate::render::gpu::device::Gpu;
use crate::render::gpu::shaders::Constant;
use std::fmt::Display;

/// Format of the picture before tone mapping.
pub(crate) const COLOR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
/// Format of depth, reversed: 0 is infinitely far.
pub(crate) const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// Creates the pipelines and bind group layouts of passes.
#[derive(Clone)]
pub(crate) struct PassFactory {
    pub(crate) gpu: Gpu,
    pub(crate) frame_layout: wgpu::BindGroupLayout,
    /// Depth pyramid of the picture, against which passes test for hidden plants and solids.
    pub(crate) pyramid: wgpu::Buffer,
    pub(crate) samples: u32,
    /// Whether more than one kind of grass grows; override `has_kinds` in WGSL.
    pub(crate) has_kinds: bool,
    /// Whether shadows have penumbras; override `soft_shadows` in WGSL.
    pub(crate) soft_shadows: bool,
    /// Whether snow lies on the land; override `has_snow` in WGSL.
    pub(crate) has_snow: bool,
}

/// Settings of a render pipeline.
pub(crate) struct DrawDescriptor<'a> {
    pub(crate) label: &'a str,
    pub(crate) vertex: &'a str,
    /// `None` draws depth only, for the shadow map.
    pub(crate) fragment: Option<&'a str>,
    pub(crate) buffers: &'a [Option<wgpu::VertexBufferLayout<'a>>],
    pub(crate) depth_write: bool,
    pub(crate) cull: Option<wgpu::Face>,
    /// `None` replaces the target.
    pub(crate) blend: Option<wgpu::BlendState>,
    /// Module of the fragment shader, if it differs from that of the vertex shader.
    pub(crate) fragment_module: Option<&'a wgpu::ShaderModule>,
}

impl Default for DrawDescriptor<'_> {
    /// Opaque, two-sided triangles without vertex buffers.
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

pub(crate) const ALL_STAGES: wgpu::ShaderStages = wgpu::ShaderStages::VERTEX_FRAGMENT.union(wgpu::ShaderStages::COMPUTE);

impl PassFactory {
    pub(crate) fn layout(&self, label: &str, entries: &[wgpu::BindGroupLayoutEntry]) -> wgpu::BindGroupLayout {
        self.gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries })
    }

    /// A pass's module with values of its overrides.
    pub(crate) fn shader(&self, label: &str, source: impl Display, constants: &[Constant]) -> wgpu::ShaderModule {
        let of_scene = [("has_kinds", self.has_kinds), ("soft_shadows", self.soft_shadows), ("has_snow", self.has_snow)];
        self.gpu.shader(label, source, &[constants, &of_scene].concat())
    }

    fn pipeline_layout(&self, label: &str, own: Option<&wgpu::BindGroupLayout>) -> wgpu::PipelineLayout {
        self.gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(label),
            bind_group_layouts: &[Some(&self.frame_layout), own],
            immediate_size: 0,
        })
    }

    pub(crate) fn compute(
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

    /// Pipeline that draws to a target without depth, in its format: a triangle of the entry point `vs`, shaded by `fragment`.
    pub(crate) fn output_pipeline(
        &self,
        label: &str,
        module: &wgpu::ShaderModule,
        fragment: &str,
        own: &wgpu::BindGroupLayout,
        target: wgpu::TextureFormat,
    ) -> wgpu::RenderPipeline {
        self.gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(label),
            layout: Some(&self.pipeline_layout(label, Some(own))),
            vertex: wgpu::VertexState { module, entry_point: Some("vs"), compilation_options: Default::default(), buffers: &[] },
            primitive: Default::default(),
            depth_stencil: None,
            multisample: Default::default(),
            fragment: Some(wgpu::FragmentState {
                module,
                entry_point: Some(fragment),
                compilation_options: Default::default(),
                targets: &[Some(target.into())],
            }),
            multiview_mask: None,
            cache: None,
        })
    }

    pub(crate) fn draw(
        &self,
        module: &wgpu::ShaderModule,
        own: Option<&wgpu::BindGroupLayout>,
        draw: &DrawDescriptor<'_>,
    ) -> wgpu::RenderPipeline {
        let targets: &[_] = if draw.vertex.starts_with("vs_shadow") { &[] } else { &[color_target(COLOR, draw.blend)] };
        self.render_pipeline(module, own, draw, targets, false)
    }

    pub(crate) fn render_pipeline(
        &self,
        module: &wgpu::ShaderModule,
        own: Option<&wgpu::BindGroupLayout>,
        draw: &DrawDescriptor<'_>,
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

pub(crate) fn color_target(format: wgpu::TextureFormat, blend: Option<wgpu::BlendState>) -> Option<wgpu::ColorTargetState> {
    Some(wgpu::ColorTargetState { format, blend, write_mask: wgpu::ColorWrites::ALL })
}

pub(crate) fn uniform(binding: u32) -> wgpu::BindGroupLayoutEntry {
    buffer(binding, ALL_STAGES, wgpu::BufferBindingType::Uniform)
}

pub(crate) fn storage(binding: u32) -> wgpu::BindGroupLayoutEntry {
    buffer(binding, ALL_STAGES, wgpu::BufferBindingType::Storage { read_only: true })
}

pub(crate) fn storage_rw(binding: u32) -> wgpu::BindGroupLayoutEntry {
    buffer(binding, wgpu::ShaderStages::COMPUTE, wgpu::BufferBindingType::Storage { read_only: false })
}

pub(crate) fn texture(binding: u32) -> wgpu::BindGroupLayoutEntry {
    sampled(binding, wgpu::TextureSampleType::Float { filterable: true }, wgpu::TextureViewDimension::D2)
}

pub(crate) fn sampled(
    binding: u32,
    sample_type: wgpu::TextureSampleType,
    view_dimension: wgpu::TextureViewDimension,
) -> wgpu::BindGroupLayoutEntry {
    let ty = wgpu::BindingType::Texture { sample_type, view_dimension, multisampled: false };
    wgpu::BindGroupLayoutEntry { binding, visibility: ALL_STAGES, ty, count: None }
}

pub(crate) fn sampler(binding: u32, kind: wgpu::SamplerBindingType) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry { binding, visibility: ALL_STAGES, ty: wgpu::BindingType::Sampler(kind), count: None }
}

fn buffer(binding: u32, visibility: wgpu::ShaderStages, ty: wgpu::BufferBindingType) -> wgpu::BindGroupLayoutEntry {
    let ty = wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None };
    wgpu::BindGroupLayoutEntry { binding, visibility, ty, count: None }
}

/// A bind group of resources with bindings 0, 1, …
pub(crate) fn bind(gpu: &Gpu, label: &str, layout: &wgpu::BindGroupLayout, resources: &[wgpu::BindingResource<'_>]) -> wgpu::BindGroup {
    bind_at(gpu, label, layout, (0..).zip(resources.iter().cloned()))
}

/// A bind group of buffers, each with its binding.
pub(crate) fn bind_as(gpu: &Gpu, label: &str, layout: &wgpu::BindGroupLayout, buffers: &[(u32, &wgpu::Buffer)]) -> wgpu::BindGroup {
    bind_at(gpu, label, layout, buffers.iter().map(|&(binding, buffer)| (binding, buffer.as_entire_binding())))
}

/// A bind group of resources, each with its binding.
pub(crate) fn bind_at<'a>(
    gpu: &Gpu,
    label: &str,
    layout: &wgpu::BindGroupLayout,
    resources: impl IntoIterator<Item = (u32, wgpu::BindingResource<'a>)>,
) -> wgpu::BindGroup {
    let entries: Vec<_> = resources.into_iter().map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource }).collect();
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some(label), layout, entries: &entries })
}
