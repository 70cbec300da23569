//! Creation of the device and of renderers, stage by stage. If a quality exceeds what the device supports, the next lower one is tried.

use super::app::{App, Failure, with_app};
use super::gpu_canvas::GpuCanvas;
use crate::render::{GpuError, Quality};

impl App {
    /// Requests a device in the background.
    pub(super) fn request_device(&mut self) {
        self.support = self.support.next_device();
        let (canvas, times) = (self.canvas.clone(), self.times.clone());
        wasm_bindgen_futures::spawn_local(async move {
            let gpu = GpuCanvas::new(canvas, times).await;
            with_app(|app| match gpu {
                Ok(gpu) => app.gpu = Some(gpu),
                Err(error) => app.fail_setup(&error),
            });
        });
    }

    /// Creates a renderer for the newest scene and the current quality in the background, unless it exists, or its next stage. A stage waits for the first frame
    /// with the one before: a frame waits for all pipelines that were created before it.
    pub(super) fn update_renderer(&mut self) {
        let quality = self.supported_quality();
        let is_due = !self.support.is_pending && self.failure.is_none() && self.rig.is_some();
        let goes_on = self.options.paused || self.rests();
        // What the GPU does next delays the first picture on its way to the screen.
        let is_seen = self.times.first_secs().is_some();
        let Some(gpu) = self.gpu.as_mut().filter(|_| is_due) else { return };
        if gpu.renderer_key() != Some((quality, self.mirror.scene_number())) {
            let (renderer, verdict) = gpu.create_renderer(quality, &self.mirror);
            self.await_verdict(quality, verdict, |gpu| gpu.set_renderer(renderer));
        } else if (goes_on || is_seen && gpu.has_shown_stage())
            && let Some((stage, verdict)) = gpu.create_next_stage(&self.mirror)
        {
            self.await_verdict(quality, verdict, |gpu| gpu.add(stage));
        }
    }

    /// Calls `use_created` once the device has confirmed what was created for a quality.
    fn await_verdict(
        &mut self,
        quality: Quality,
        verdict: impl Future<Output = Result<(), GpuError>> + 'static,
        use_created: impl FnOnce(&mut GpuCanvas) + 'static,
    ) {
        self.support.is_pending = true;
        let device = self.support.device;
        wasm_bindgen_futures::spawn_local(async move {
            let verdict = verdict.await;
            with_app(|app| {
                if app.support.device == device {
                    app.support.is_pending = false;
                    match (verdict, &mut app.gpu) {
                        (Ok(()), Some(gpu)) => use_created(gpu),
                        (Ok(()), None) => {}
                        (Err(error), _) => app.reject_quality(quality, &error),
                    }
                }
            });
        });
    }

    /// Goes on with loading in an animation frame: a picture before the next stage would only delay it. Returns whether a picture would wait for a stage, or
    /// keep the first one from the screen.
    pub(super) fn loads_stage(&mut self, now_secs: f64) -> bool {
        if self.is_complete() {
            return false;
        }
        let awaits_screen = self.times.awaits_screen(now_secs);
        self.update_status();
        self.update_renderer();
        awaits_screen || self.support.is_pending
    }

    /// Whether nothing changes in the picture of the renderer that is being replaced, so that no frame follows a stage of the next one.
    fn rests(&self) -> bool {
        self.meter.is_idle() && self.gpu.as_ref().is_some_and(GpuCanvas::is_replacing)
    }

    /// Whether everything in the scene is drawn.
    pub(super) fn is_complete(&self) -> bool {
        self.gpu.as_ref().is_some_and(|gpu| gpu.is_complete(&self.mirror))
    }

    /// The chosen quality, or the highest that the device supports.
    pub(super) fn supported_quality(&self) -> Quality {
        self.support.best(self.settings.quality())
    }

    fn reject_quality(&mut self, quality: Quality, error: &GpuError) {
        if !self.support.record_failure(quality, error) {
            self.fail_setup(error);
        }
    }

    fn fail_setup(&mut self, error: &GpuError) {
        let kind = if matches!(error, GpuError::Limit { .. } | GpuError::DoesNotFit { .. }) { "limits" } else { "failed" };
        self.failure = Some(Failure { kind, reason: error.to_string() });
    }

    /// Explanations for the user where the picture is coarser or smaller than chosen.
    pub(super) fn fallbacks(&self) -> Vec<String> {
        let limit = self.support.limit_below(self.settings.quality());
        let coarser = limit.map(|(quality, reason)| format!("Quality is limited to {}: {reason}", quality.name()));
        let smaller = self.gpu.as_ref().and_then(|gpu| gpu.size_limitation(self.supported_quality()));
        coarser.into_iter().chain(smaller).collect()
    }
}
