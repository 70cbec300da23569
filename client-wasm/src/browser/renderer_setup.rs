//! Creation of the device and of renderers. If a quality exceeds what the device supports, the next lower one is tried.

use super::app::{App, Failure, with_app};
use super::gpu_canvas::GpuCanvas;
use crate::render::{GpuError, Quality};

impl App {
    /// Requests a device in the background.
    pub(super) fn request_device(&mut self) {
        self.support = self.support.next_device();
        let canvas = self.canvas.clone();
        wasm_bindgen_futures::spawn_local(async move {
            let gpu = GpuCanvas::new(canvas).await;
            with_app(|app| match gpu {
                Ok(gpu) => app.gpu = Some(gpu),
                Err(error) => app.fail_setup(&error),
            });
        });
    }

    /// Creates a renderer for the newest scene and the current quality in the background, unless it exists or is being created.
    pub(super) fn update_renderer(&mut self) {
        let quality = self.supported_quality();
        let is_due = !self.support.is_pending && self.failure.is_none() && self.rig.is_some();
        let Some(gpu) = self.gpu.as_ref().filter(|_| is_due) else { return };
        if gpu.renderer_key() == Some((quality, self.mirror.scene_number())) {
            return;
        }
        self.support.is_pending = true;
        let device = self.support.device;
        let (renderer, verdict) = gpu.create_renderer(quality, &self.mirror);
        wasm_bindgen_futures::spawn_local(async move {
            let verdict = verdict.await;
            with_app(|app| {
                if app.support.device == device {
                    app.support.is_pending = false;
                    match (verdict, &mut app.gpu) {
                        (Ok(()), Some(gpu)) => gpu.set_renderer(renderer),
                        (Ok(()), None) => {}
                        (Err(error), _) => app.reject_quality(quality, &error),
                    }
                }
            });
        });
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
