//! The canvas, the device that draws on it and its renderer; made anew when the device is lost.

use crate::camera::Camera;
use crate::render::{Gpu, GpuError, Quality, Renderer, Split, fitting_px};
use crate::state::Mirror;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering::Relaxed};
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
    fitted: Option<Fitted>,
    work: Arc<Work>,
    lost: Arc<OnceLock<String>>,
    fault: Arc<OnceLock<String>>,
}

/// A renderer that the device holds.
pub(super) struct Fitted {
    pub(super) renderer: Renderer,
    /// The [number](Mirror::scene_number) of the scene that it was made for.
    pub(super) scene_number: u32,
}

/// What the device is doing.
#[derive(Default)]
struct Work {
    in_flight: AtomicU32,
    /// When it was done with the newest picture (s), and how long that took (s): bits of `f64`.
    done_secs: AtomicU64,
    took_secs: AtomicU64,
}

/// What is drawn beside world and camera.
pub(super) struct Moment {
    /// Time of whatever moves by itself (s), and since the picture before (s).
    pub(super) time_secs: f64,
    pub(super) dt_secs: f32,
    /// Two ways side by side, instead of the renderer's own.
    pub(super) split: Option<Split>,
}

impl Stage {
    /// Takes a device.
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
        let [width, height] = fitting_px(wanted_px(&canvas, Quality::Low), gpu.side_limit_px());
        let config = surface.get_default_config(&adapter, width, height);
        let config = config.ok_or_else(|| no_adapter(&"the canvas takes no picture of this adapter"))?;
        surface.configure(&gpu.device, &config);

        let (lost, fault) = (Arc::new(OnceLock::new()), Arc::new(OnceLock::new()));
        let (told, complained) = (lost.clone(), fault.clone());
        gpu.device.set_device_lost_callback(move |_, reason| {
            told.get_or_init(|| reason);
        });
        gpu.device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            complained.get_or_init(|| error.to_string());
        }));
        Ok(Self { canvas, surface, config, gpu, fitted: None, work: Arc::default(), lost, fault })
    }

    /// Why the device is gone, if it is.
    pub(super) fn lost(&self) -> Option<&str> {
        self.lost.get().map(String::as_str)
    }

    /// What the device could not do since it was taken.
    pub(super) fn fault(&self) -> Option<&str> {
        self.fault.get().map(String::as_str)
    }

    /// Whether the device is still busy with earlier pictures.
    pub(super) fn is_busy(&self) -> bool {
        self.work.in_flight.load(Relaxed) >= IN_FLIGHT
    }

    /// Time for which the newest finished picture kept the device (s); 0 before the first.
    pub(super) fn work_secs(&self) -> f64 {
        f64::from_bits(self.work.took_secs.load(Relaxed))
    }

    /// A renderer for the mirror's scene, and by and by whether the device holds it.
    pub(super) fn fit(&self, quality: Quality, mirror: &Mirror) -> (Fitted, impl Future<Output = Result<(), GpuError>> + use<>) {
        let (renderer, verdict) = Renderer::fitted(&self.gpu, self.config.format, self.wanted_size_px(quality), quality, mirror);
        (Fitted { renderer, scene_number: mirror.scene_number() }, verdict)
    }

    /// Draws with this renderer from now on.
    pub(super) fn take(&mut self, fitted: Fitted) {
        self.fitted = Some(fitted);
    }

    /// The renderer, if it is for the mirror's scene.
    pub(super) fn renderer(&mut self, mirror: &Mirror) -> Option<&mut Renderer> {
        let fitted = self.fitted.as_mut().filter(|fitted| fitted.scene_number == mirror.scene_number());
        fitted.map(|fitted| &mut fitted.renderer)
    }

    /// Quality of the renderer, and number of the scene that it is for.
    pub(super) fn is_for(&self) -> Option<(Quality, u32)> {
        self.fitted.as_ref().map(|fitted| (fitted.renderer.quality(), fitted.scene_number))
    }

    /// Size of the newest picture (px).
    pub(super) fn size_px(&self) -> [u32; 2] {
        [self.config.width, self.config.height]
    }

    /// Size that the next picture will have (px): that of the canvas on its screen, as fine as the quality asks for and no larger than a texture.
    pub(super) fn wanted_size_px(&self, quality: Quality) -> [u32; 2] {
        fitting_px(wanted_px(&self.canvas, quality), self.gpu.side_limit_px())
    }

    /// Why the picture is smaller than its canvas, if it is.
    pub(super) fn shrinks(&self, quality: Quality) -> Option<String> {
        let ([width, height], [wide, high]) = (self.wanted_size_px(quality), wanted_px(&self.canvas, quality));
        let limit_px = self.gpu.side_limit_px();
        (wide > width || high > height).then(|| {
            format!("picture of {width} × {height} px instead of {wide} × {high}: the device's max_texture_dimension_2d is {limit_px}")
        })
    }

    /// Draws the mirror's world as `camera` sees it. Gives the processor's time for that (s); none without a picture.
    pub(super) fn draw(&mut self, mirror: &mut Mirror, camera: &Camera, moment: &Moment) -> Option<f64> {
        let size_px = self.wanted_size_px(self.fitted.as_ref()?.renderer.quality());
        if self.size_px() != size_px {
            [self.config.width, self.config.height] = size_px;
            self.surface.configure(&self.gpu.device, &self.config);
        }
        let renderer = &mut self.fitted.as_mut()?.renderer;
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
        let Moment { time_secs, dt_secs, .. } = *moment;
        match &moment.split {
            Some(split) => renderer.draw_split(mirror, camera, time_secs, dt_secs, &view, split),
            None => renderer.draw(mirror, camera, time_secs, dt_secs, &view),
        };
        let submitted_secs = now_secs();
        self.gpu.queue.present(frame);
        self.work.in_flight.fetch_add(1, Relaxed);
        let work = self.work.clone();
        self.gpu.queue.on_submitted_work_done(move || work.done(submitted_secs, now_secs()));
        Some(submitted_secs - begun_secs)
    }
}

impl Work {
    /// A picture is done: it kept the device since the one before was done, or since it was submitted.
    fn done(&self, submitted_secs: f64, done_secs: f64) {
        let before_secs = f64::from_bits(self.done_secs.swap(done_secs.to_bits(), Relaxed));
        self.took_secs.store((done_secs - submitted_secs.max(before_secs)).to_bits(), Relaxed);
        self.in_flight.fetch_sub(1, Relaxed);
    }
}

/// Time since the page was opened (s).
fn now_secs() -> f64 {
    web_sys::window().map_or(0.0, |window| super::page::now_secs(&window))
}

/// The canvas's size in the pixels of its screen, not finer than the quality asks for.
fn wanted_px(canvas: &HtmlCanvasElement, quality: Quality) -> [u32; 2] {
    let finest = match quality {
        Quality::Low => 1.0,
        Quality::Medium => 1.25,
        Quality::High => 2.0,
        Quality::Ultra | Quality::Reference => 3.0,
    };
    let ratio = web_sys::window().map_or(1.0, |window| window.device_pixel_ratio()).min(finest);
    [canvas.client_width(), canvas.client_height()].map(|css_px| (f64::from(css_px) * ratio).round() as u32)
}
