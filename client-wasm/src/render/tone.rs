//! Last pass: from light to the target's colours.

use super::gpu::Gpu;
use super::pipeline::{Maker, uniform};
use super::shaders;

/// Exposure before the tone curve.
const EXPOSURE: f32 = 1.15;

pub(super) struct Tone {
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
    /// Where the picture is bound.
    binding: u32,
    settings: wgpu::Buffer,
    group: wgpu::BindGroup,
}

impl Tone {
    /// `fineness` pixels of the picture along either side of one of the target.
    pub(super) fn new(maker: &Maker<'_>, target: wgpu::TextureFormat, picture: &wgpu::TextureView, fineness: u32) -> Self {
        let device = &maker.gpu.device;
        let module = maker.shader("tone", shaders::TONE, &[]);
        let (entry, binding) = if maker.samples > 1 { ("fs_sampled", 2) } else { ("fs", 0) };
        let layout = maker.layout("tone", &[picture_entry(binding, maker.samples), uniform(1)]);
        let encodes = if target.is_srgb() { 1.0 } else { 0.0_f32 };
        let contents: [f32; 4] = [encodes, EXPOSURE, fineness as f32, 0.0];
        let usage = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST;
        let settings = maker.gpu.buffer("tone", bytemuck::bytes_of(&contents), usage);
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("tone"),
            bind_group_layouts: &[Some(maker.frame_layout), Some(&layout)],
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
        let group = group(maker.gpu, &layout, binding, picture, &settings);
        Self { pipeline, layout, binding, settings, group }
    }

    pub(super) fn set_picture(&mut self, gpu: &Gpu, picture: &wgpu::TextureView, fineness: u32) {
        gpu.queue.write_buffer(&self.settings, 8, bytemuck::bytes_of(&(fineness as f32)));
        self.group = group(gpu, &self.layout, self.binding, picture, &self.settings);
    }

    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
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
