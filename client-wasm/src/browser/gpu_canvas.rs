//! The canvas with its GPU device and renderer. It is recreated when the device is lost.

use super::start_times::StartTimes;
use crate::camera::Camera;
use crate::render::{Gpu, GpuError, NextStage, Quality, Renderer, Split, Stage, fit_within_px};
use crate::state::Mirror;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering::Relaxed};
use std::sync::{Arc, OnceLock};
use web_sys::HtmlCanvasElement;

/// Maximum number of frames in flight on the GPU. More would delay the response to input.
const MAX_IN_FLIGHT: u32 = 2;

/// Frames drawn between two variants of pipelines that are created in advance: in software each may take as long as a frame.
const VARIANT_FRAMES: u32 = 8;

/// Resolution of the first picture in software: land and sky alone would take most of the time until it is shown.
const FIRST_RESOLUTION: f32 = 0.5;

/// A canvas with its own GPU device.
pub(super) struct GpuCanvas {
    canvas: HtmlCanvasElement,
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    gpu: Gpu,
    /// The renderer that draws, perhaps before all of its scene is loaded.
    renderer: Option<SceneRenderer>,
    /// The renderer that replaces it once all of its scene is loaded.
    next: Option<SceneRenderer>,
    /// Frames submitted before the newest stage was added to either.
    frames_before_stage: u32,
    /// Frames submitted since a variant of a pipeline was created in advance.
    frames_since_variant: u32,
    load: Arc<GpuLoad>,
    times: Arc<StartTimes>,
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
    /// Frames submitted, and finished, since the device was created.
    submitted: AtomicU32,
    finished: AtomicU32,
    /// Time at which the newest frame was finished (s), and its duration (s); bits of `f64`.
    done_secs: AtomicU64,
    frame_secs: AtomicU64,
}

/// Inputs of a frame besides world and camera.
pub(super) struct FrameInput {
    /// Animation time (s), and time since the previous frame (s).
    pub(super) time_secs: f64,
    pub(super) dt_secs: f32,
    /// Fraction of the quality's resolution along each side.
    pub(super) resolution: f32,
    /// Variants to draw side by side, instead of one picture.
    pub(super) split: Option<Split>,
}

impl GpuCanvas {
    /// Requests a device for the canvas. `times` receives the times of the first pictures.
    pub(super) async fn new(canvas: HtmlCanvasElement, times: Arc<StartTimes>) -> Result<Self, GpuError> {
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
        Ok(Self {
            canvas,
            surface,
            config,
            gpu,
            renderer: None,
            next: None,
            frames_before_stage: 0,
            frames_since_variant: 0,
            load: Arc::default(),
            times,
            lost,
            fault,
        })
    }

    /// Reason why the device was lost, if it was.
    pub(super) fn lost(&self) -> Option<&str> {
        self.lost.get().map(String::as_str)
    }

    /// First uncaptured error of the device, if any.
    pub(super) fn fault(&self) -> Option<&str> {
        self.fault.get().map(String::as_str)
    }

    /// Whether the maximum number of frames is in flight: one while the scene is being loaded, so that each stage is seen before the next one.
    pub(super) fn is_busy(&self, mirror: &Mirror) -> bool {
        self.load.in_flight() >= if self.is_complete(mirror) { MAX_IN_FLIGHT } else { 1 }
    }

    /// Whether a frame with the newest stage has been finished.
    pub(super) fn has_shown_stage(&self) -> bool {
        self.load.finished.load(Relaxed).wrapping_sub(self.frames_before_stage) as i32 > 0
    }

    /// Whether the renderer that draws has loaded all of the mirror's scene.
    pub(super) fn is_complete(&self, mirror: &Mirror) -> bool {
        self.stage(mirror).is_some_and(|(_, is_last)| is_last)
    }

    /// Newest stage of the renderer that draws, and whether it is the last one of the mirror's scene.
    pub(super) fn stage(&self, mirror: &Mirror) -> Option<(Stage, bool)> {
        self.renderer.as_ref().filter(|current| current.scene_number == mirror.scene_number())?.renderer.stage(mirror)
    }

    /// GPU time of the newest finished frame (s); 0 before the first.
    pub(super) fn gpu_secs(&self) -> f64 {
        f64::from_bits(self.load.frame_secs.load(Relaxed))
    }

    /// Creates a renderer with the first stage of the mirror's scene. The future resolves to an error if it exceeds what the device supports.
    pub(super) fn create_renderer(
        &self,
        quality: Quality,
        mirror: &Mirror,
    ) -> (SceneRenderer, impl Future<Output = Result<(), GpuError>> + use<>) {
        let (renderer, verdict) = Renderer::with_land(&self.gpu, self.config.format, self.next_size_px(quality), quality, mirror);
        (SceneRenderer { renderer, scene_number: mirror.scene_number() }, verdict)
    }

    /// Uses this renderer from now on; if another one draws the same scene, only once all stages are loaded.
    pub(super) fn set_renderer(&mut self, renderer: SceneRenderer) {
        self.note_stage();
        let replaces = self.renderer.as_ref().is_some_and(|current| current.scene_number == renderer.scene_number);
        if replaces {
            self.next = Some(renderer);
        } else {
            (self.renderer, self.next) = (Some(renderer), None);
        }
    }

    /// Creates the next stage of the newest renderer, for [`add`](Self::add), or else replaces the one that draws. The future is that of
    /// [`create_renderer`](Self::create_renderer).
    pub(super) fn create_next_stage(&mut self, mirror: &Mirror) -> Option<(NextStage, impl Future<Output = Result<(), GpuError>> + use<>)> {
        let newest = self.next.as_ref().or(self.renderer.as_ref())?;
        if newest.renderer.stage(mirror).is_some_and(|(_, is_last)| !is_last) {
            return newest.renderer.create_next_stage(mirror);
        }
        if self.next.is_some() {
            self.renderer = self.next.take();
        }
        None
    }

    /// Whether another renderer is being loaded behind the one that draws.
    pub(super) fn is_replacing(&self) -> bool {
        self.next.is_some()
    }

    /// Adds a stage to the newest renderer.
    pub(super) fn add(&mut self, stage: NextStage) {
        self.note_stage();
        if let Some(newest) = self.next.as_mut().or(self.renderer.as_mut()) {
            newest.renderer.add(stage);
        }
    }

    fn note_stage(&mut self) {
        self.frames_before_stage = self.load.submitted.load(Relaxed);
    }

    /// The renderer, if it was created for the mirror's scene.
    pub(super) fn renderer(&mut self, mirror: &Mirror) -> Option<&mut Renderer> {
        let current = self.renderer.as_mut().filter(|current| current.scene_number == mirror.scene_number());
        current.map(|current| &mut current.renderer)
    }

    /// Quality and scene number of the newest renderer.
    pub(super) fn renderer_key(&self) -> Option<(Quality, u32)> {
        self.next.as_ref().or(self.renderer.as_ref()).map(|newest| (newest.renderer.quality(), newest.scene_number))
    }

    /// Size of the newest frame (px).
    pub(super) fn size_px(&self) -> [u32; 2] {
        [self.config.width, self.config.height]
    }

    /// Size at which the newest frame was rendered, before it was enlarged or averaged (px).
    pub(super) fn rendered_px(&self) -> Option<[u32; 2]> {
        self.renderer.as_ref().map(|current| current.renderer.rendered_px())
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
        let is_first = self.gpu.is_software && self.stage(mirror) == Some((Stage::Land, false));
        if self.size_px() != size_px {
            [self.config.width, self.config.height] = size_px;
            self.surface.configure(&self.gpu.device, &self.config);
        }
        let renderer = &mut self.renderer.as_mut()?.renderer;
        if renderer.size_px() != size_px {
            renderer.resize(size_px);
        }
        renderer.set_resolution(if is_first { FIRST_RESOLUTION } else { input.resolution });
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
        let stage = renderer.stage(mirror);
        self.notify_when_done(submitted_secs, stage);
        if stage.is_some_and(|(_, is_last)| is_last) {
            self.prepare_variants();
        }
        Some(submitted_secs - begun_secs)
    }

    /// Records when the frame just submitted is finished.
    fn notify_when_done(&self, submitted_secs: f64, stage: Option<(Stage, bool)>) {
        self.load.submitted.fetch_add(1, Relaxed);
        let (load, times) = (self.load.clone(), self.times.clone());
        self.gpu.queue.on_submitted_work_done(move || {
            let done_secs = now_secs();
            load.frame_done(submitted_secs, done_secs);
            stage.into_iter().for_each(|(stage, is_last)| times.note(stage, is_last, done_secs));
        });
    }

    /// Now and then creates a variant of a pipeline that no frame has needed yet.
    fn prepare_variants(&mut self) {
        self.frames_since_variant += 1;
        if self.frames_since_variant >= VARIANT_FRAMES {
            self.frames_since_variant = 0;
            self.renderer.iter().for_each(|current| _ = current.renderer.create_next_variant());
        }
    }
}

impl GpuLoad {
    /// Records a finished frame. Its duration counts from its submission or from the end of the previous frame, whichever is later.
    fn frame_done(&self, submitted_secs: f64, done_secs: f64) {
        let before_secs = f64::from_bits(self.done_secs.swap(done_secs.to_bits(), Relaxed));
        self.frame_secs.store((done_secs - submitted_secs.max(before_secs)).to_bits(), Relaxed);
        self.finished.fetch_add(1, Relaxed);
    }

    fn in_flight(&self) -> u32 {
        self.submitted.load(Relaxed).wrapping_sub(self.finished.load(Relaxed))
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
