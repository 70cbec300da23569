//! From a device to a renderer that it holds: as fine as wanted, or the next coarser that fits.

use super::app::{App, Failure};
use super::stage::Stage;
use super::with_app;
use crate::render::{GpuError, Quality};

/// What is known of what the device holds.
#[derive(Debug, Default)]
pub(super) struct Fitting {
    /// Whether an answer is awaited.
    is_asked: bool,
    /// Finest quality that the device holds, and why no finer one, once that is known.
    finest: Option<(Quality, String)>,
    /// Counts the devices: an answer of one that is gone is no answer.
    device: u32,
}

impl App {
    /// Takes a device in the background.
    pub(super) fn build_stage(&mut self) {
        self.fitting = Fitting { device: self.fitting.device + 1, ..Fitting::default() };
        let canvas = self.canvas.clone();
        wasm_bindgen_futures::spawn_local(async move {
            let stage = Stage::new(canvas).await;
            with_app(|app| match stage {
                Ok(stage) => app.stage = Some(stage),
                Err(error) => app.stage_fails(&error),
            });
        });
    }

    /// Makes a renderer for the newest scene in the quality that is wanted, unless there is one or it is being made.
    pub(super) fn fit_stage(&mut self) {
        let quality = self.fitting_quality();
        let is_due = !self.fitting.is_asked && self.failure.is_none() && self.rig.is_some();
        let Some(stage) = self.stage.as_ref().filter(|_| is_due) else { return };
        if stage.is_for() == Some((quality, self.mirror.scene_number())) {
            return;
        }
        self.fitting.is_asked = true;
        let device = self.fitting.device;
        let (fitted, verdict) = stage.fit(quality, &self.mirror);
        wasm_bindgen_futures::spawn_local(async move {
            let verdict = verdict.await;
            with_app(|app| {
                if app.fitting.device == device {
                    app.fitting.is_asked = false;
                    match (verdict, &mut app.stage) {
                        (Ok(()), Some(stage)) => stage.take(fitted),
                        (Ok(()), None) => {}
                        (Err(error), _) => app.fits_not(quality, &error),
                    }
                }
            });
        });
    }

    /// The quality that is wanted, or the finest that the device holds.
    pub(super) fn fitting_quality(&self) -> Quality {
        let wanted = self.choices.quality();
        match self.fitting.finest {
            Some((finest, _)) if finest.level() < wanted.level() => finest,
            _ => wanted,
        }
    }

    fn fits_not(&mut self, quality: Quality, error: &GpuError) {
        match quality.lower() {
            Some(lower) => self.fitting.finest = Some((lower, error.to_string())),
            None => self.stage_fails(error),
        }
    }

    fn stage_fails(&mut self, error: &GpuError) {
        let kind = if matches!(error, GpuError::Limit { .. } | GpuError::TooMuch { .. }) { "limits" } else { "failed" };
        self.failure = Some(Failure { kind, reason: error.to_string() });
    }

    /// In what the picture stays behind what is wanted, and why.
    pub(super) fn fallbacks(&self) -> Vec<String> {
        let finest = self.fitting.finest.as_ref().filter(|(finest, _)| finest.level() < self.choices.quality().level());
        let coarser = finest.map(|(finest, why)| format!("{} quality at most: {why}", finest.name()));
        let smaller = self.stage.as_ref().and_then(|stage| stage.shrinks(self.fitting_quality()));
        coarser.into_iter().chain(smaller).collect()
    }
}
