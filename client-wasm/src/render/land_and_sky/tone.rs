//! Tone mapping: from light to the colours of the target.

use crate::render::gpu::device::Gpu;
use crate::render::gpu::pipeline::{PassFactory, uniform};
use crate::render::gpu::shaders;
use crate::render::gpu::uniforms::Tone;
use std::mem::offset_of;

/// Exposure before the tone curve.
const EXPOSURE: f32 = 1.15;

pub(crate) struct ToneMapping {
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
    /// Binding of the picture.
    binding: u32,
    settings: wgpu::Buffer,
    group: wgpu::BindGroup,
}

impl ToneMapping {
    /// `supersampling`: rendered pixels along each side of a pixel of the target.
    pub(crate) fn new(factory: &PassFactory, target: wgpu::TextureFormat, picture: &wgpu::TextureView, supersampling: u32) -> Self {
        let device = &factory.gpu.device;
        let module = factory.shader("tone", shaders::TONE, &[]);
        let (entry, binding) = if factory.samples > 1 { ("fs_sampled", 2) } else { ("fs", 0) };
        let layout = factory.layout("tone", &[picture_entry(binding, factory.samples), uniform(1)]);
        let encodes = if target.is_srgb() { 1.0 } else { 0.0_f32 };
        let contents = Tone { target_encodes: encodes, exposure: EXPOSURE, supersampling: supersampling as f32, _pad: [0; 4] };
        let usage = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST;
        let settings = factory.gpu.buffer("tone", bytemuck::bytes_of(&contents), usage);
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("tone"),
            bind_group_layouts: &[Some(&factory.frame_layout), Some(&layout)],
            immediate_size: 0,
        });
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("tone"),
            layout: Some(&pipeline_layout),
            vertex: wgpu::VertexState { module: &module, entry_point: Some("vs"), compilation_options: Default::default(), buffers: &[] },
            primitive: Default::default(),
            depth_stencil: None,
            multisample: Default::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some(entry),
                compilation_options: Default::default(),
                targets: &[Some(target.into())],
            }),
            multiview_mask: None,
            cache: None,
        });
        let group = group(&factory.gpu, &layout, binding, picture, &settings);
        Self { pipeline, layout, binding, settings, group }
    }

    pub(crate) fn set_picture(&mut self, gpu: &Gpu, picture: &wgpu::TextureView, supersampling: u32) {
        gpu.queue.write_buffer(&self.settings, offset_of!(Tone, supersampling) as u64, bytemuck::bytes_of(&(supersampling as f32)));
        self.group = group(gpu, &self.layout, self.binding, picture, &self.settings);
    }

    pub(crate) fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(1, &self.group, &[]);
        pass.draw(0..3, 0..1);
    }
}

fn picture_entry(binding: u32, samples: u32) -> wgpu::BindGroupLayoutEntry {
    let sample_type = wgpu::TextureSampleType::Float { filterable: false };
    let ty = wgpu::BindingType::Texture { sample_type, view_dimension: wgpu::TextureViewDimension::D2, multisampled: samples > 1 };
    wgpu::BindGroupLayoutEntry { binding, visibility: wgpu::ShaderStages::FRAGMENT, ty, count: None }
}

fn group(gpu: &Gpu, layout: &wgpu::BindGroupLayout, binding: u32, picture: &wgpu::TextureView, settings: &wgpu::Buffer) -> wgpu::BindGroup {
    let entries = [
        wgpu::BindGroupEntry { binding, resource: wgpu::BindingResource::TextureView(picture) },
        wgpu::BindGroupEntry { binding: 1, resource: settings.as_entire_binding() },
    ];
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some("tone"), layout, entries: &entries })
}
