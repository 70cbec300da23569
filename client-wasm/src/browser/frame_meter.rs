//! Frame rate and CPU time.

/// Averaging period of the frame rate (s).
const PERIOD_SECS: f64 = 0.5;

/// Counts frames and measures the time between them.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct FrameMeter {
    frames: u64,
    since_secs: f64,
    since_frames: u64,
    frame_secs: Option<f64>,
    cpu_secs: Option<f64>,
    is_idle: bool,
    skipped: u64,
}

/// Smoothing factor of the CPU time.
const CPU_SMOOTHING: f64 = 0.05;

impl FrameMeter {
    /// Records a frame that took `cpu_secs` of CPU time.
    pub(super) fn record(&mut self, now_secs: f64, cpu_secs: f64) {
        self.cpu_secs = Some(self.cpu_secs.map_or(cpu_secs, |mean_secs| mean_secs + CPU_SMOOTHING * (cpu_secs - mean_secs)));
        if std::mem::take(&mut self.is_idle) {
            (self.since_secs, self.since_frames) = (now_secs, self.frames);
        }
        self.frames += 1;
        let elapsed_secs = now_secs - self.since_secs;
        if elapsed_secs >= PERIOD_SECS {
            let counted = self.frames - self.since_frames;
            self.frame_secs = (self.since_frames > 0).then_some(elapsed_secs / counted as f64);
            (self.since_secs, self.since_frames) = (now_secs, self.frames);
        }
    }

    /// Records a frame that was skipped because it would have equalled the previous one.
    pub(super) fn record_skipped(&mut self) {
        self.is_idle = true;
        self.skipped += 1;
    }

    /// Number of skipped frames.
    pub(super) fn skipped(&self) -> u64 {
        self.skipped
    }

    /// Whether the last frame was skipped.
    pub(super) fn is_idle(&self) -> bool {
        self.is_idle
    }

    /// Smoothed CPU time of a frame (s), over about twenty frames.
    pub(super) fn cpu_secs(&self) -> Option<f64> {
        self.cpu_secs
    }

    /// Number of frames drawn.
    pub(super) fn frames(&self) -> u64 {
        self.frames
    }

    /// Mean frame interval (s), over about half a second.
    pub(super) fn frame_secs(&self) -> Option<f64> {
        self.frame_secs
    }
}
