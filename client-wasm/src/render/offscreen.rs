//! Rendering without a window.

use crate::camera::Camera;
use crate::render::FrameStats;
use crate::render::Renderer;
use crate::render::gpu::constants::GRID_CLASSES;
use crate::render::gpu::device::Gpu;
use crate::render::gpu::pipeline_statistics::{PassStatistics, StatisticsQueries};
use crate::render::gpu::readback::read;
use crate::render::gpu::timestamps::{PassSecs, TimestampQueries};
use crate::render::options::quality::Quality;
use crate::render::options::render_options::RenderOptions;
use crate::render::options::split::Split;
use crate::render::plants::underbrush::Underbrush;
use crate::state::Mirror;

/// Alignment of the rows of a texture copy in WebGPU (bytes).
const ROW_ALIGN: u32 = 256;

/// A renderer whose target is a texture that can be read back.
pub struct OffscreenRenderer {
    gpu: Gpu,
    pub(super) renderer: Renderer,
    texture: wgpu::Texture,
    buffer: wgpu::Buffer,
}

impl OffscreenRenderer {
    /// A target of `size_px` in sRGB with 8 bits per channel.
    pub fn new(gpu: &Gpu, size_px: [u32; 2], quality: Quality) -> Self {
        let format = wgpu::TextureFormat::Rgba8UnormSrgb;
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("target"),
            size: wgpu::Extent3d { width: size_px[0], height: size_px[1], depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let size = u64::from(row_bytes(size_px[0])) * u64::from(size_px[1]);
        let buffer = gpu.empty_buffer("pixels", size, wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ);
        let mut renderer = Renderer::new(gpu, format, size_px, quality);
        renderer.timestamps = TimestampQueries::new(gpu);
        renderer.statistics = StatisticsQueries::new(gpu);
        Self { renderer, gpu: gpu.clone(), texture, buffer }
    }

    /// Sets the options of the following frames.
    pub fn set_options(&mut self, options: RenderOptions) {
        self.renderer.set_options(options);
    }

    /// Sets the level of detail of plants. See [`Renderer::set_level`].
    pub fn set_level(&mut self, level: f32) {
        self.renderer.set_level(level);
    }

    /// Sets the fraction of the quality's resolution. See [`Renderer::set_resolution`].
    pub fn set_resolution(&mut self, resolution: f32) {
        self.renderer.set_resolution(resolution);
    }

    /// Draws a frame and waits for the GPU. See [`Renderer::draw`].
    pub fn draw(&mut self, mirror: &mut Mirror, camera: &Camera, time_secs: f64, dt_secs: f32) -> FrameStats {
        let view = self.texture.create_view(&Default::default());
        let stats = self.renderer.draw(mirror, camera, time_secs, dt_secs, &view);
        self.wait();
        stats
    }

    /// Draws a frame with two sets of options side by side and waits for the GPU. See [`Renderer::draw_split`].
    pub fn draw_split(&mut self, mirror: &mut Mirror, camera: &Camera, time_secs: f64, dt_secs: f32, split: &Split) -> FrameStats {
        let view = self.texture.create_view(&Default::default());
        let stats = self.renderer.draw_split(mirror, camera, time_secs, dt_secs, &view, split);
        self.wait();
        stats
    }

    /// GPU time of the passes of the newest frame; `None` if the device has no timestamp queries.
    pub fn pass_secs(&self) -> Option<PassSecs> {
        self.renderer.timestamps.as_ref().map(|queries| TimestampQueries::secs(&self.gpu, &read(&self.gpu, queries.resolved())))
    }

    /// Pipeline statistics of the newest frame, of its last side if it was split; `None` if the device has no such queries.
    pub fn pass_statistics(&self) -> Option<PassStatistics> {
        self.renderer.statistics.as_ref().map(|queries| queries.statistics(&read(&self.gpu, queries.resolved())))
    }

    /// Pixels of the newest frame as RGBA, row by row from the top; empty if the device is lost.
    pub fn rgba(&self) -> Vec<u8> {
        let [width, height] = self.renderer.size_px();
        let row = row_bytes(width);
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        encoder.copy_texture_to_buffer(
            self.texture.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &self.buffer,
                layout: wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: Some(height) },
            },
            self.texture.size(),
        );
        self.gpu.queue.submit([encoder.finish()]);
        self.buffer.slice(..).map_async(wgpu::MapMode::Read, |_| {});
        self.wait();
        let pixels = self
            .buffer
            .slice(..)
            .get_mapped_range()
            .map(|bytes| bytes.chunks_exact(row as usize).flat_map(|line| &line[..width as usize * 4]).copied().collect());
        self.buffer.unmap();
        pixels.unwrap_or_default()
    }

    /// Number of blades and flowers that the newest frame bent: those in view, and some at its edges.
    pub fn bent_plants(&self) -> u32 {
        let scene = self.renderer.scene.as_ref();
        let blades = scene.and_then(|scene| scene.blades.as_ref());
        let counts = blades.map(|blades| bytemuck::pod_collect_to_vec::<u8, u32>(&read(&self.gpu, blades.in_view())));
        counts.map_or(0, |counts| counts.iter().take(2).sum())
    }

    /// Numbers of grass grids by the classes of the map's legend: simulated blades, other single blades, clumps of 3, 5, 9 and at least 17 plants along a
    /// side, culled by the view, culled by hills. `None` if no frame has [shown](RenderOptions::shows_grids) the map.
    pub fn grid_counts(&self) -> Option<[u32; GRID_CLASSES as usize]> {
        let map = self.renderer.scene.as_ref()?.grid_map.as_ref()?;
        bytemuck::pod_collect_to_vec::<u8, u32>(&read(&self.gpu, map.counts())).try_into().ok()
    }

    /// Numbers of vehicle parts, trees, stones and models in view of the newest frame and of those drawn, and of the triangles of the latter.
    pub fn drawn_solids(&self) -> [u64; 3] {
        let objects = self.renderer.scene.as_ref().and_then(|scene| scene.objects.as_ref());
        objects.map_or([0; 3], |objects| objects.drawn(|buffer| read(&self.gpu, buffer)))
    }

    /// Number of underbrush plants that the newest frame drew: those in view, thinned out with distance.
    pub fn drawn_underbrush(&self) -> u32 {
        let underbrush = self.renderer.scene.as_ref().and_then(|scene| scene.underbrush.as_ref());
        underbrush.map_or(0, |underbrush| Underbrush::drawn(&read(&self.gpu, underbrush.counters())))
    }

    fn wait(&self) {
        // After the loss of the device, the picture is empty.
        let _ = self.gpu.device.poll(wgpu::PollType::wait_indefinitely());
    }
}

fn row_bytes(width_px: u32) -> u32 {
    (width_px * 4).next_multiple_of(ROW_ALIGN)
}
