//! The canvas with its GPU device and renderer. It is recreated when the device is lost.

use crate::camera::Camera;
use crate::render::{Gpu, GpuError, Quality, Renderer, Split, fit_within_px};
use crate::state::Mirror;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering::Relaxed};
use std::sync::{Arc, OnceLock};
use web_sys::HtmlCanvasElement;

/// Maximum number of frames in flight on the GPU. More would delay the response to input.
const MAX_IN_FLIGHT: u32 = 2;

/// A canvas with its own GPU device.
pub(super) struct GpuCanvas {
    canvas: HtmlCanvasElement,
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    gpu: Gpu,
    renderer: Option<SceneRenderer>,
    load: Arc<GpuLoad>,
    lost: Arc<OnceLock<String>>,
    fault: Arc<OnceLock<String>>,
}

/// A renderer for one scene.
pub(super) struct SceneRenderer {
    pub(super) renderer: Renderer,
    /// [Number](Mirror::scene_number) of that scene.
    pub(super) scene_number: u32,
}

/// Load of the GPU.
#[derive(Default)]
struct GpuLoad {
    in_flight: AtomicU32,
    /// Time at which the newest frame was finished (s), and its duration (s); bits of `f64`.
    done_secs: AtomicU64,
    frame_secs: AtomicU64,
}

/// Inputs of a frame besides world and camera.
pub(super) struct FrameInput {
    /// Animation time (s), and time since the previous frame (s).
    pub(super) time_secs: f64,
    pub(super) dt_secs: f32,
    /// Variants to draw side by side, instead of one picture.
    pub(super) split: Option<Split>,
}

impl GpuCanvas {
    /// Requests a device for the canvas.
    pub(super) async fn new(canvas: HtmlCanvasElement) -> Result<Self, GpuError> {
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
        let [width, height] = fit_within_px(wanted_px(&canvas, Quality::Low), gpu.side_limit_px());
        let config = surface.get_default_config(&adapter, width, height);
        let config = config.ok_or_else(|| no_adapter(&"the canvas does not support this adapter"))?;
        surface.configure(&gpu.device, &config);

        let (lost, fault) = (Arc::new(OnceLock::new()), Arc::new(OnceLock::new()));
        let (lost_sender, fault_sender) = (lost.clone(), fault.clone());
        gpu.device.set_device_lost_callback(move |_, reason| {
            lost_sender.get_or_init(|| reason);
        });
        gpu.device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            fault_sender.get_or_init(|| error.to_string());
        }));
        Ok(Self { canvas, surface, config, gpu, renderer: None, load: Arc::default(), lost, fault })
    }

    /// Reason why the device was lost, if it was.
    pub(super) fn lost(&self) -> Option<&str> {
        self.lost.get().map(String::as_str)
    }

    /// First uncaptured error of the device, if any.
    pub(super) fn fault(&self) -> Option<&str> {
        self.fault.get().map(String::as_str)
    }

    /// Whether the maximum number of frames is in flight.
    pub(super) fn is_busy(&self) -> bool {
        self.load.in_flight.load(Relaxed) >= MAX_IN_FLIGHT
    }

    /// GPU time of the newest finished frame (s); 0 before the first.
    pub(super) fn gpu_secs(&self) -> f64 {
        f64::from_bits(self.load.frame_secs.load(Relaxed))
    }

    /// Creates a renderer for the mirror's scene. The future resolves to an error if it exceeds what the device supports.
    pub(super) fn create_renderer(
        &self,
        quality: Quality,
        mirror: &Mirror,
    ) -> (SceneRenderer, impl Future<Output = Result<(), GpuError>> + use<>) {
        let (renderer, verdict) = Renderer::with_scene(&self.gpu, self.config.format, self.next_size_px(quality), quality, mirror);
        (SceneRenderer { renderer, scene_number: mirror.scene_number() }, verdict)
    }

    /// Uses this renderer from now on.
    pub(super) fn set_renderer(&mut self, renderer: SceneRenderer) {
        self.renderer = Some(renderer);
    }

    /// The renderer, if it was created for the mirror's scene.
    pub(super) fn renderer(&mut self, mirror: &Mirror) -> Option<&mut Renderer> {
        let current = self.renderer.as_mut().filter(|current| current.scene_number == mirror.scene_number());
        current.map(|current| &mut current.renderer)
    }

    /// Quality and scene number of the renderer.
    pub(super) fn renderer_key(&self) -> Option<(Quality, u32)> {
        self.renderer.as_ref().map(|current| (current.renderer.quality(), current.scene_number))
    }

    /// Size of the newest frame (px).
    pub(super) fn size_px(&self) -> [u32; 2] {
        [self.config.width, self.config.height]
    }

    /// Size of the next frame (px): the canvas's size on the screen at the quality's pixel ratio, limited to the maximum texture size.
    pub(super) fn next_size_px(&self, quality: Quality) -> [u32; 2] {
        fit_within_px(wanted_px(&self.canvas, quality), self.gpu.side_limit_px())
    }

    /// Explanation for the user if the frame is smaller than its canvas.
    pub(super) fn size_limitation(&self, quality: Quality) -> Option<String> {
        let ([width, height], [wide, high]) = (self.next_size_px(quality), wanted_px(&self.canvas, quality));
        let limit_px = self.gpu.side_limit_px();
        (wide > width || high > height).then(|| {
            format!("The picture is limited to {width} × {height} px instead of {wide} × {high}: the device's max_texture_dimension_2d is {limit_px}.")
        })
    }

    /// Draws the mirror's world. Returns the CPU time spent (s); `None` if no frame was drawn.
    pub(super) fn draw(&mut self, mirror: &mut Mirror, camera: &Camera, input: &FrameInput) -> Option<f64> {
        let size_px = self.next_size_px(self.renderer.as_ref()?.renderer.quality());
        if self.size_px() != size_px {
            [self.config.width, self.config.height] = size_px;
            self.surface.configure(&self.gpu.device, &self.config);
        }
        let renderer = &mut self.renderer.as_mut()?.renderer;
        if renderer.size_px() != size_px {
            renderer.resize(size_px);
        }
        let frame = match self.surface.get_current_texture() {
            wgpu::CurrentSurfaceTexture::Success(frame) | wgpu::CurrentSurfaceTexture::Suboptimal(frame) => frame,
            _ => {
                self.surface.configure(&self.gpu.device, &self.config);
                return None;
            }
        };
        let view = frame.texture.create_view(&wgpu::TextureViewDescriptor::default());
        let begun_secs = now_secs();
        let FrameInput { time_secs, dt_secs, .. } = *input;
        match &input.split {
            Some(split) => renderer.draw_split(mirror, camera, time_secs, dt_secs, &view, split),
            None => renderer.draw(mirror, camera, time_secs, dt_secs, &view),
        };
        let submitted_secs = now_secs();
        self.gpu.queue.present(frame);
        self.load.in_flight.fetch_add(1, Relaxed);
        let load = self.load.clone();
        self.gpu.queue.on_submitted_work_done(move || load.frame_done(submitted_secs, now_secs()));
        Some(submitted_secs - begun_secs)
    }
}

impl GpuLoad {
    /// Records a finished frame. Its duration counts from its submission or from the end of the previous frame, whichever is later.
    fn frame_done(&self, submitted_secs: f64, done_secs: f64) {
        let before_secs = f64::from_bits(self.done_secs.swap(done_secs.to_bits(), Relaxed));
        self.frame_secs.store((done_secs - submitted_secs.max(before_secs)).to_bits(), Relaxed);
        self.in_flight.fetch_sub(1, Relaxed);
    }
}

/// Time since the page was opened (s).
fn now_secs() -> f64 {
    web_sys::window().map_or(0.0, |window| super::page::now_secs(&window))
}

/// Size of the canvas in physical pixels (px), with the device pixel ratio limited by the quality.
fn wanted_px(canvas: &HtmlCanvasElement, quality: Quality) -> [u32; 2] {
    let ratio = web_sys::window().map_or(1.0, |window| window.device_pixel_ratio()).min(quality.max_device_pixel_ratio());
    [canvas.client_width(), canvas.client_height()].map(|css_px| (f64::from(css_px) * ratio).round() as u32)
}
