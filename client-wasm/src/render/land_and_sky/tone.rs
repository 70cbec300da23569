//! Tone mapping: from light to the colours of the target.

use crate::render::gpu::pipeline::{PassFactory, uniform};
use crate::render::gpu::shaders;
use crate::render::gpu::uniforms::Tone;
use std::mem::offset_of;
use std::sync::OnceLock;

/// Exposure before the tone curve.
const EXPOSURE: f32 = 1.15;

pub(crate) struct ToneMapping {
    factory: PassFactory,
    target: wgpu::TextureFormat,
    module: wgpu::ShaderModule,
    /// Pipelines that average whole pixels, and that interpolate between pixels, created when first needed.
    pipelines: [OnceLock<wgpu::RenderPipeline>; 2],
    layout: wgpu::BindGroupLayout,
    /// Whether the picture has whole pixels for each pixel of the target.
    is_whole: bool,
    settings: wgpu::Buffer,
    group: wgpu::BindGroup,
}

impl ToneMapping {
    /// `scale`: rendered pixels per pixel of the target, along X and Y.
    pub(crate) fn new(factory: &PassFactory, target: wgpu::TextureFormat, picture: &wgpu::TextureView, scale: [f32; 2]) -> Self {
        let layout = factory.layout("tone", &[picture_entry(factory.samples), uniform(1)]);
        let encodes = if target.is_srgb() { 1.0 } else { 0.0_f32 };
        let contents = Tone { target_encodes: encodes, exposure: EXPOSURE, scale };
        let usage = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST;
        let settings = factory.gpu.buffer("tone", bytemuck::bytes_of(&contents), usage);
        let group = group(factory, &layout, picture, &settings);
        let module = factory.shader("tone", shaders::TONE, &[]);
        let pipelines = Default::default();
        Self { factory: factory.clone(), target, module, pipelines, layout, is_whole: is_whole(scale), settings, group }
    }

    fn pipeline(&self) -> &wgpu::RenderPipeline {
        self.pipelines[usize::from(!self.is_whole)].get_or_init(|| self.create_pipeline())
    }

    fn create_pipeline(&self) -> wgpu::RenderPipeline {
        let entry = match (self.factory.samples > 1, self.is_whole) {
            (false, true) => "fs",
            (false, false) => "fs_between",
            (true, true) => "fs_sampled",
            (true, false) => "fs_sampled_between",
        };
        self.factory.output_pipeline("tone", &self.module, entry, &self.layout, self.target)
    }

    /// Format of the targets.
    pub(crate) fn target(&self) -> wgpu::TextureFormat {
        self.target
    }

    pub(crate) fn set_picture(&mut self, picture: &wgpu::TextureView, scale: [f32; 2]) {
        let gpu = &self.factory.gpu;
        gpu.queue.write_buffer(&self.settings, offset_of!(Tone, scale) as u64, bytemuck::bytes_of(&scale));
        self.group = group(&self.factory, &self.layout, picture, &self.settings);
        self.is_whole = is_whole(scale);
    }

    pub(crate) fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_pipeline(self.pipeline());
        pass.set_bind_group(1, &self.group, &[]);
        pass.draw(0..3, 0..1);
    }
}

/// Whether a scale is a whole number.
fn is_whole(scale: [f32; 2]) -> bool {
    scale == scale.map(f32::round) && scale[0] >= 1.0
}

/// Binding of a picture with this number of samples per pixel.
fn picture_binding(samples: u32) -> u32 {
    if samples > 1 { 2 } else { 0 }
}

fn picture_entry(samples: u32) -> wgpu::BindGroupLayoutEntry {
    let sample_type = wgpu::TextureSampleType::Float { filterable: false };
    let ty = wgpu::BindingType::Texture { sample_type, view_dimension: wgpu::TextureViewDimension::D2, multisampled: samples > 1 };
    wgpu::BindGroupLayoutEntry { binding: picture_binding(samples), visibility: wgpu::ShaderStages::FRAGMENT, ty, count: None }
}

fn group(factory: &PassFactory, layout: &wgpu::BindGroupLayout, picture: &wgpu::TextureView, settings: &wgpu::Buffer) -> wgpu::BindGroup {
    let binding = picture_binding(factory.samples);
    let entries = [
        wgpu::BindGroupEntry { binding, resource: wgpu::BindingResource::TextureView(picture) },
        wgpu::BindGroupEntry { binding: 1, resource: settings.as_entire_binding() },
    ];
    factory.gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some("tone"), layout, entries: &entries })
}
