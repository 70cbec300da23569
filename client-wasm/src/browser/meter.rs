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
    cpu_secs: Option<f64>,
    is_resting: bool,
    skipped: u64,
}

/// Share of a new measurement of the processor's time that counts.
const CPU_SHARE: f64 = 0.05;

impl Meter {
    /// A picture was drawn, which took the processor `cpu_secs`.
    pub(super) fn drew(&mut self, now_secs: f64, cpu_secs: f64) {
        self.cpu_secs = Some(self.cpu_secs.map_or(cpu_secs, |mean_secs| mean_secs + CPU_SHARE * (cpu_secs - mean_secs)));
        if std::mem::take(&mut self.is_resting) {
            (self.since_secs, self.since_frames) = (now_secs, self.frames);
        }
        self.frames += 1;
        let elapsed_secs = now_secs - self.since_secs;
        if elapsed_secs >= SPAN_SECS {
            let counted = self.frames - self.since_frames;
            self.frame_secs = (self.since_frames > 0).then_some(elapsed_secs / counted as f64);
            (self.since_secs, self.since_frames) = (now_secs, self.frames);
        }
    }

    /// No picture was drawn, since it would have been like the last.
    pub(super) fn rested(&mut self) {
        self.is_resting = true;
        self.skipped += 1;
    }

    /// Pictures that were not drawn for that.
    pub(super) fn skipped(&self) -> u64 {
        self.skipped
    }

    /// Whether the last picture still stands.
    pub(super) fn is_resting(&self) -> bool {
        self.is_resting
    }

    /// Mean time that a picture takes the processor (s), over the last twenty or so.
    pub(super) fn cpu_secs(&self) -> Option<f64> {
        self.cpu_secs
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
