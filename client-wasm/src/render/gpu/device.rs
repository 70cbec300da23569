//! The GPU device: headless natively, for the canvas in a browser.

use crate::render::gpu::error::GpuError;
use crate::render::gpu::limits;
use crate::render::gpu::shaders::{self, Constant};
use std::fmt::Display;
use wgpu::util::DeviceExt;

/// Substrings in the names of software adapters; browsers reveal nothing else.
const SOFTWARE: [&str; 5] = ["llvmpipe", "lavapipe", "swiftshader", "basic render", "warp"];

/// A device and its queue.
#[derive(Clone, Debug)]
pub struct Gpu {
    /// Creates resources.
    pub device: wgpu::Device,
    /// Executes commands.
    pub queue: wgpu::Queue,
    /// Name of the adapter, for display.
    pub adapter_name: String,
    /// Whether it renders on the CPU.
    pub is_software: bool,
}

impl Gpu {
    /// A device without a window, from any Vulkan adapter, software included.
    ///
    /// # Errors
    /// [`GpuError`] if there is none.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn headless() -> Result<Self, GpuError> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        pollster::block_on(Self::request(&instance, None))
    }

    /// A device that can draw to `surface`, or to textures only.
    ///
    /// # Errors
    /// [`GpuError`] if there is none.
    pub async fn request(instance: &wgpu::Instance, surface: Option<&wgpu::Surface<'_>>) -> Result<Self, GpuError> {
        let options = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            compatible_surface: surface,
            ..Default::default()
        };
        let adapter = instance.request_adapter(&options).await.map_err(|error| GpuError::NoAdapter(error.to_string()))?;
        Self::from_adapter(&adapter).await
    }

    /// A device of `adapter` with the default limits of WebGPU, or lower ones where the adapter has less.
    ///
    /// # Errors
    /// [`GpuError::Limit`] if a limit is below the minimum; [`GpuError::NoDevice`] if the adapter refuses.
    pub async fn from_adapter(adapter: &wgpu::Adapter) -> Result<Self, GpuError> {
        Self::within(adapter, &adapter.limits()).await
    }

    /// [`from_adapter`](Self::from_adapter) with limits of at most `allowed`.
    pub(crate) async fn within(adapter: &wgpu::Adapter, allowed: &wgpu::Limits) -> Result<Self, GpuError> {
        if let Some(error) = limits::lacking(allowed) {
            return Err(error);
        }
        let required_limits = wgpu::Limits::default().or_worse_values_from(allowed);
        // Timestamp and pipeline statistics queries, where supported; browsers have no statistics.
        let required_features = adapter.features() & (wgpu::Features::TIMESTAMP_QUERY | wgpu::Features::PIPELINE_STATISTICS_QUERY);
        let descriptor = wgpu::DeviceDescriptor { label: Some("prairie"), required_features, required_limits, ..Default::default() };
        let (device, queue) = adapter.request_device(&descriptor).await.map_err(|error| GpuError::NoDevice(error.to_string()))?;
        let info = adapter.get_info();
        let names = [&info.name, &info.driver, &info.driver_info].map(|name| name.to_lowercase());
        let is_named = names.iter().any(|name| SOFTWARE.iter().any(|software| name.contains(software)));
        let is_software = info.device_type == wgpu::DeviceType::Cpu || is_named;
        Ok(Self { device, queue, adapter_name: info.name, is_software })
    }

    /// Maximum side of a texture (px).
    pub fn side_limit_px(&self) -> u32 {
        self.device.limits().max_texture_dimension_2d
    }

    pub(crate) fn buffer(&self, label: &str, contents: &[u8], usage: wgpu::BufferUsages) -> wgpu::Buffer {
        self.device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: Some(label), contents, usage })
    }

    pub(crate) fn empty_buffer(&self, label: &str, size: u64, usage: wgpu::BufferUsages) -> wgpu::Buffer {
        self.device.create_buffer(&wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: false })
    }

    /// A 2-D texture with its mip levels, finest first, each as rows of texels.
    pub(crate) fn texture(&self, label: &str, format: wgpu::TextureFormat, size_px: [u32; 2], levels: &[Vec<u8>]) -> wgpu::Texture {
        let texture = self.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d { width: size_px[0], height: size_px[1], depth_or_array_layers: 1 },
            mip_level_count: levels.len() as u32,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        for (level, texels) in levels.iter().enumerate() {
            let size = size_px.map(|side| (side >> level).max(1));
            self.write_level(&texture, level as u32, [0; 3], size, texels);
        }
        texture
    }

    /// Writes a rectangle of one mip level; `origin` has the layer last.
    pub(crate) fn write_level(&self, texture: &wgpu::Texture, level: u32, [x, y, z]: [u32; 3], size_px: [u32; 2], texels: &[u8]) {
        let row_bytes = texels.len() as u32 / size_px[1];
        self.queue.write_texture(
            wgpu::TexelCopyTextureInfo { texture, mip_level: level, origin: wgpu::Origin3d { x, y, z }, aspect: wgpu::TextureAspect::All },
            texels,
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row_bytes), rows_per_image: Some(size_px[1]) },
            wgpu::Extent3d { width: size_px[0], height: size_px[1], depth_or_array_layers: 1 },
        );
    }

    /// A shader module with values of its overrides.
    pub(crate) fn shader(&self, label: &str, source: impl Display, constants: &[Constant]) -> wgpu::ShaderModule {
        let text = shaders::with_constants(source.to_string(), constants);
        self.device.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some(label), source: wgpu::ShaderSource::Wgsl(text.into()) })
    }

    /// A texture that a pass draws to and later passes may read.
    pub(crate) fn render_target(&self, label: &str, format: wgpu::TextureFormat, size_px: [u32; 2], samples: u32) -> wgpu::TextureView {
        let descriptor = wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d { width: size_px[0], height: size_px[1], depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: samples,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT
                | wgpu::TextureUsages::TEXTURE_BINDING
                | if cfg!(test) { wgpu::TextureUsages::COPY_SRC } else { wgpu::TextureUsages::empty() },
            view_formats: &[],
        };
        self.device.create_texture(&descriptor).create_view(&Default::default())
    }
}
