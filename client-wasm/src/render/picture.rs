//! Pictures without a window.

use super::timing::Timer;
use super::underbrush::Underbrush;
use super::work::Counter;
use super::{FrameStats, Gpu, Look, PassSecs, PassWork, Quality, Renderer, Split};
use crate::camera::Camera;
use crate::state::Mirror;

/// Bytes to which WebGPU aligns the rows of a copy.
const ROW_ALIGN: u32 = 256;

/// A target whose pixels can be read.
pub struct Picture {
    gpu: Gpu,
    pub(super) renderer: Renderer,
    texture: wgpu::Texture,
    buffer: wgpu::Buffer,
}

impl Picture {
    /// A picture of `size_px`, 8 bits a channel, sRGB.
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
        renderer.timer = Timer::new(gpu);
        renderer.counter = Counter::new(gpu);
        Self { renderer, gpu: gpu.clone(), texture, buffer }
    }

    /// How frames are drawn from now on.
    pub fn set_look(&mut self, look: Look) {
        self.renderer.set_look(look);
    }

    /// Draws plants at this level of detail from now on. See [`Renderer::set_level`].
    pub fn set_level(&mut self, level: f32) {
        self.renderer.set_level(level);
    }

    /// Draws a frame and waits until it is done. See [`Renderer::draw`].
    pub fn draw(&mut self, mirror: &mut Mirror, camera: &Camera, time_secs: f64, dt_secs: f32) -> FrameStats {
        let view = self.texture.create_view(&Default::default());
        let stats = self.renderer.draw(mirror, camera, time_secs, dt_secs, &view);
        self.wait();
        stats
    }

    /// Draws a frame of two looks side by side and waits until it is done. See [`Renderer::draw_split`].
    pub fn draw_split(&mut self, mirror: &mut Mirror, camera: &Camera, time_secs: f64, dt_secs: f32, split: &Split) -> FrameStats {
        let view = self.texture.create_view(&Default::default());
        let stats = self.renderer.draw_split(mirror, camera, time_secs, dt_secs, &view, split);
        self.wait();
        stats
    }

    /// How long the passes of the newest frame kept the device; none where it has no clock.
    pub fn pass_secs(&self) -> Option<PassSecs> {
        self.renderer.timer.as_ref().map(|timer| Timer::secs(&self.gpu, &read(&self.gpu, timer.resolved())))
    }

    /// What the device worked through in the passes of the newest frame, in its last part if it was split; none where it does not count.
    pub fn pass_work(&self) -> Option<PassWork> {
        self.renderer.counter.as_ref().map(|counter| counter.work(&read(&self.gpu, counter.resolved())))
    }

    /// Pixels of the newest frame: RGBA, row by row from the top.
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

    /// Blades and flowers that the newest frame bent: those that stand in view, give or take what is at its edges.
    pub fn bent_plants(&self) -> u32 {
        let scene = self.renderer.scene.as_ref();
        let counts = scene.map(|scene| bytemuck::pod_collect_to_vec::<u8, u32>(&read(&self.gpu, scene.blades.in_view())));
        counts.map_or(0, |counts| counts.iter().take(2).sum())
    }

    /// Plants of underbrush that the newest frame drew: those in view but for what thins out with distance.
    pub fn drawn_underbrush(&self) -> u32 {
        let underbrush = self.renderer.scene.as_ref().and_then(|scene| scene.underbrush.as_ref());
        underbrush.map_or(0, |underbrush| Underbrush::drawn(&read(&self.gpu, underbrush.tally())))
    }

    fn wait(&self) {
        // A lost device shows as an empty picture.
        let _ = self.gpu.device.poll(wgpu::PollType::wait_indefinitely());
    }
}

/// Bytes of a buffer on the GPU; none when the device is lost.
pub(super) fn read(gpu: &Gpu, buffer: &wgpu::Buffer) -> Vec<u8> {
    let read = gpu.empty_buffer("read", buffer.size(), wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST);
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    encoder.copy_buffer_to_buffer(buffer, 0, &read, 0, buffer.size());
    gpu.queue.submit([encoder.finish()]);
    read.slice(..).map_async(wgpu::MapMode::Read, |_| {});
    let _ = gpu.device.poll(wgpu::PollType::wait_indefinitely());
    read.slice(..).get_mapped_range().map(|bytes| bytes.to_vec()).unwrap_or_default()
}

fn row_bytes(width_px: u32) -> u32 {
    (width_px * 4).next_multiple_of(ROW_ALIGN)
}
