//! Camera, time and output columns of a frame.

use crate::camera::Camera;
use std::ops::Range;

/// Camera and time of a frame.
pub(super) struct Moment<'a> {
    pub(super) camera: &'a Camera,
    /// Drives clouds, gusts and flutter (s).
    pub(super) time_secs: f64,
    /// Time since the previous frame (s).
    pub(super) dt_secs: f32,
}

/// Columns of the output that a frame writes.
pub(super) struct OutputRegion {
    pub(super) columns: Range<u32>,
    /// Whether the other columns keep their content; otherwise they are cleared to black.
    pub(super) keeps_rest: bool,
}
