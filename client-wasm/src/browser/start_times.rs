//! Times of the first pictures.

use crate::render::Stage;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

/// Animation frames of the page, without work for the GPU, after which a picture that the page has uncovered is on the screen.
const SHOWN_FRAMES: u32 = 6;

/// Times of the first pictures (s since the page was opened). The GPU's callbacks and the page's animation frames set them.
#[derive(Debug, Default)]
pub(super) struct StartTimes {
    /// Time at which the first frame of each stage was drawn.
    by_stage: [OnceLock<f64>; Stage::ALL.len()],
    complete: OnceLock<f64>,
    /// Animation frames since the first picture was uncovered.
    uncovered_frames: AtomicU32,
    shown: OnceLock<f64>,
}

impl StartTimes {
    /// Notes a finished frame that shows everything up to `stage`, which `is_last` of the scene's.
    pub(super) fn note(&self, stage: Stage, is_last: bool, now_secs: f64) {
        self.by_stage[stage as usize].get_or_init(|| now_secs);
        if is_last {
            self.complete.get_or_init(|| now_secs);
        }
    }

    /// The stages that have been drawn, each with its time (s).
    pub(super) fn drawn(&self) -> impl Iterator<Item = (Stage, f64)> {
        Stage::ALL.into_iter().filter_map(|stage| Some((stage, *self.by_stage[stage as usize].get()?)))
    }

    /// Counts an animation frame of the page. Returns whether the first picture is drawn, and on its way to the screen.
    pub(super) fn awaits_screen(&self, now_secs: f64) -> bool {
        if self.shown.get().is_some() || self.drawn().next().is_none() {
            return false;
        }
        if self.uncovered_frames.fetch_add(1, Relaxed) == SHOWN_FRAMES {
            self.shown.get_or_init(|| now_secs);
        }
        self.shown.get().is_none()
    }

    /// Time at which the first picture, of land and sky, was on the screen (s).
    pub(super) fn first_secs(&self) -> Option<f64> {
        self.shown.get().copied()
    }

    /// Time of the first picture with all stages (s).
    pub(super) fn complete_secs(&self) -> Option<f64> {
        self.complete.get().copied()
    }
}
