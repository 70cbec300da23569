//! The canvas and the renderer that draws on it; made anew when the graphics device is lost.

use crate::camera::Camera;
use crate::render::{Gpu, GpuError, Quality, Renderer};
use crate::state::Mirror;
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};
use std::sync::{Arc, OnceLock};
use web_sys::HtmlCanvasElement;

/// Pictures that the device may be working on; with more of them the view would lag behind the hands.
const IN_FLIGHT: u32 = 2;

/// A canvas with a device of its own.
pub(super) struct Stage {
    canvas: HtmlCanvasElement,
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    gpu: Gpu,
    renderer: Renderer,
    in_flight: Arc<AtomicU32>,
    lost: Arc<OnceLock<String>>,
}

impl Stage {
    /// Takes a device and makes the renderer.
    pub(super) async fn new(canvas: HtmlCanvasElement, quality: Quality) -> Result<Self, GpuError> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        let no_adapter = |error: &dyn std::fmt::Display| GpuError::NoAdapter(error.to_string());
        let target = wgpu::SurfaceTarget::Canvas(canvas.clone());
        let surface = instance.create_surface(target).map_err(|error| no_adapter(&error))?;
        let options = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            compatible_surface: Some(&surface),
            ..Default::default()
        };
        let adapter = instance.request_adapter(&options).await.map_err(|error| no_adapter(&error))?;
        let gpu = Gpu::from_adapter(&adapter).await?;
        let [width, height] = size_px(&canvas, quality);
        let config = surface.get_default_config(&adapter, width, height);
        let config = config.ok_or_else(|| no_adapter(&"the canvas takes no picture of this adapter"))?;
        surface.configure(&gpu.device, &config);

        let lost = Arc::new(OnceLock::new());
        let told = lost.clone();
        gpu.device.set_device_lost_callback(move |_, reason| {
            told.get_or_init(|| reason);
        });
        let renderer = Renderer::new(&gpu, config.format, [width, height], quality);
        Ok(Self { canvas, surface, config, gpu, renderer, in_flight: Arc::default(), lost })
    }

    /// Why the device is gone, if it is.
    pub(super) fn lost(&self) -> Option<&str> {
        self.lost.get().map(String::as_str)
    }

    /// Whether the device is still busy with earlier pictures.
    pub(super) fn is_busy(&self) -> bool {
        self.in_flight.load(Relaxed) >= IN_FLIGHT
    }

    /// Draws with another quality from now on.
    pub(super) fn set_quality(&mut self, quality: Quality) {
        if quality != self.renderer.quality() {
            self.renderer = Renderer::new(&self.gpu, self.config.format, self.size_px(), quality);
        }
    }

    /// Size of the picture (px).
    pub(super) fn size_px(&self) -> [u32; 2] {
        [self.config.width, self.config.height]
    }

    /// Draws the mirror's world as `camera` sees it, `dt_secs` after the picture before; returns whether there is a picture.
    pub(super) fn draw(&mut self, mirror: &mut Mirror, camera: &Camera, time_secs: f64, dt_secs: f32) -> bool {
        let size_px = size_px(&self.canvas, self.renderer.quality());
        if self.size_px() != size_px {
            [self.config.width, self.config.height] = size_px;
            self.surface.configure(&self.gpu.device, &self.config);
            self.renderer.resize(size_px);
        }
        let frame = match self.surface.get_current_texture() {
            wgpu::CurrentSurfaceTexture::Success(frame) | wgpu::CurrentSurfaceTexture::Suboptimal(frame) => frame,
            _ => {
                self.surface.configure(&self.gpu.device, &self.config);
                return false;
            }
        };
        let view = frame.texture.create_view(&wgpu::TextureViewDescriptor::default());
        self.renderer.draw(mirror, camera, time_secs, dt_secs, &view);
        self.gpu.queue.present(frame);
        self.in_flight.fetch_add(1, Relaxed);
        let in_flight = self.in_flight.clone();
        self.gpu.queue.on_submitted_work_done(move || {
            in_flight.fetch_sub(1, Relaxed);
        });
        true
    }
}

/// The canvas's size in the pixels of its screen, not finer than the quality asks for.
fn size_px(canvas: &HtmlCanvasElement, quality: Quality) -> [u32; 2] {
    let finest = match quality {
        Quality::Low => 1.0,
        Quality::Medium => 1.25,
        Quality::High => 2.0,
        Quality::Ultra => 3.0,
    };
    let ratio = web_sys::window().map_or(1.0, |window| window.device_pixel_ratio()).min(finest);
    [canvas.client_width(), canvas.client_height()].map(|css_px| (f64::from(css_px) * ratio).round().clamp(1.0, 8192.0) as u32)
}
