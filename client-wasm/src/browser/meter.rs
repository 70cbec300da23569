//! How fast pictures come.

/// Time over which frames are counted (s).
const SPAN_SECS: f64 = 0.5;

/// Counts pictures and measures the time between them.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Meter {
    frames: u64,
    since_secs: f64,
    since_frames: u64,
    frame_secs: Option<f64>,
}

impl Meter {
    /// A picture was drawn.
    pub(super) fn drew(&mut self, now_secs: f64) {
        self.frames += 1;
        let elapsed_secs = now_secs - self.since_secs;
        if elapsed_secs >= SPAN_SECS {
            let counted = self.frames - self.since_frames;
            self.frame_secs = (self.since_frames > 0).then_some(elapsed_secs / counted as f64);
            (self.since_secs, self.since_frames) = (now_secs, self.frames);
        }
    }

    /// Pictures drawn.
    pub(super) fn frames(&self) -> u64 {
        self.frames
    }

    /// Mean time from one picture to the next (s), over the last half second or so.
    pub(super) fn frame_secs(&self) -> Option<f64> {
        self.frame_secs
    }
}
